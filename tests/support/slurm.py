"""Slurm on one machine, on loopback, without systemd: three daemons, which are stopped by their process ids."""

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue")
MOST_TASKS = 4  # in an array
_LATE = 30  # seconds

_CONFIGURATION = """\
ClusterName=skinslide
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
MaxArraySize={array}
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE
"""


def why_not() -> str | None:
    """Why there is no Slurm to be had here."""
    missing = [program for program in PROGRAMS if not shutil.which(program)]
    if missing:
        return f"{', '.join(missing)}: not installed (on Debian 12: slurm-wlm)"
    return None if os.geteuid() == 0 else "munged and slurmd are started by root alone"


@contextmanager
def running() -> Iterator[dict[str, str]]:
    """The environment in which Slurm's commands find it."""
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)  # munged refuses a socket that others cannot reach
        yield from _running(Path(folder))


def _running(folder: Path) -> Iterator[dict[str, str]]:
    for name in ("state", "spool"):
        (folder / name).mkdir()
    (folder / "key").write_bytes(os.urandom(1024))
    (folder / "key").chmod(0o400)
    host = socket.gethostname().split(".")[0]
    values = {"folder": folder, "host": host, "ports": _free_ports(2), "array": MOST_TASKS + 1}
    (folder / "slurm.conf").write_text(_CONFIGURATION.format(**values))
    environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
    files = {"key-file": "key", "socket": "munge.socket", "pid-file": "munge.pid", "log-file": "munge.log"}
    munge = [f"--{option}={folder / name}" for option, name in {**files, "seed-file": "seed"}.items()]
    daemons: list[subprocess.Popen[bytes]] = []

    def start(*words: str) -> None:
        with (folder / f"{words[0]}.out").open("wb") as log:
            daemons.append(subprocess.Popen(words, env=environment, stdout=log, stderr=subprocess.STDOUT))

    try:
        start("munged", "--foreground", *munge)
        _wait(folder, lambda: (folder / "munge.socket").exists())
        start("slurmctld", "-D")
        start("slurmd", "-D")
        _wait(folder, lambda: b"idle" in subprocess.run(["sinfo"], env=environment, capture_output=True).stdout)
        yield environment
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
        for daemon in daemons:
            daemon.wait(_LATE)


def _wait(folder: Path, ready) -> None:
    end = time.monotonic() + _LATE
    while not ready():
        logs = "\n".join(log.read_text() for log in folder.glob("*.out"))
        assert time.monotonic() < end, f"Slurm does not start: {logs}"
        time.sleep(0.1)


def _free_ports(count: int) -> list[int]:
    sockets = [socket.socket() for _ in range(count)]
    try:
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]
    finally:
        for each in sockets:
            each.close()
