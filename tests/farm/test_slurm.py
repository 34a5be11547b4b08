"""Jobs of Slurm, submitted to a real one: tasks that are killed and requeued, and the layer of one bake."""

import subprocess
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

import slurm
from jobs import baking, content, kill_baking, tool, wait_until

pytestmark = pytest.mark.skipif(bool(slurm.why_not()), reason=f"Slurm: {slurm.why_not()}")

_SECONDS_APART = 2


@pytest.fixture(scope="module")
def environment():
    with slurm.running() as environment:
        yield environment


class Submitted:
    """A job of four tasks, and what comes after them."""

    def __init__(self, shot: Path, environment: dict[str, str], *words: str | Path, sbatch: Sequence[str] = ()):
        self.folder, self._environment, self._requeued = shot.parent, environment, dict[str, float]()
        tool("farm", shot, "-o", self.folder / "slid.usdc", "--chunk", "2", "--format", "slurm", *words)
        lines = self.run("bash", self.folder / "slid.slurm.sh", *sbatch).splitlines()
        self.ids = dict(line.split() for line in lines)

    def run(self, *words: str | Path) -> str:
        done = subprocess.run(words, env=self._environment, capture_output=True, text=True, check=True)
        return done.stdout

    def states(self) -> dict[str, str]:
        """Of every task that the queue knows, and of what comes after."""
        told = self.run("squeue", "--array", "--states=all", "--noheader", "--format=%i %T").splitlines()
        return dict(line.split() for line in told)

    def wait(self, task: str, *states: str) -> None:
        wait_until(lambda: self._hurried().get(task) in states, f"{task} that is {states}", 0.1)

    def _hurried(self) -> dict[str, str]:
        """The states, after which tasks that were requeued wait for seconds alone.

        Slurm leaves two minutes to what may be left of a task, and may set them after it is pending. A task that begins
        in the second in which it ended is refused by slurmd, as one that is not to run any more.
        """
        found = self.states()
        for task, since in self._requeued.items():
            if found.get(task) == "PENDING" and time.monotonic() > since + _SECONDS_APART:
                # It may have begun since, which is an error of the command.
                update = ["scontrol", "update", f"JobId={task}", "StartTime=now"]
                subprocess.run(update, env=self._environment, capture_output=True)
        return found

    def task(self, number: int) -> str:
        return f"{self.ids['bake']}_{number}"

    def chunk(self, number: int) -> Path:
        return self.folder / f"slid.chunk{number}.usdc"

    def requeue(self, task: str) -> None:
        self.run("scontrol", "requeue", task)
        self._requeued[task] = time.monotonic()
        self.wait(task, "PENDING")

    def said(self, task: str) -> str:
        return (self.folder / f"slid.slurm.{task}.log").read_text()


@pytest.fixture
def job(shot, environment) -> Submitted:
    return Submitted(shot, environment)


def test_tasks_that_are_killed_and_requeued(job, whole):
    """One as when a machine goes down, one by its queue; the others are baked once."""
    kill_baking(job.folder, "slid.chunk1.usdc")
    job.wait(job.task(1), "FAILED")
    job.requeue(job.task(1))
    wait_until(lambda: baking(job.chunk(3)), "task 3", 0.02)
    earlier = set(baking(job.chunk(3)))
    job.requeue(job.task(3))
    wait_until(lambda: not earlier.intersection(baking(job.chunk(3))), "end of what was requeued")
    job.wait(job.ids["stitch"], "COMPLETED")
    assert content(job.folder / "slid.usdc") == whole
    assert job.said(job.task(2)).count("frames/s") and not job.said(job.task(2)).count("whole already")
    assert list(job.folder.glob("slid.chunk*.usdc")) and not job.states().get(job.task(5))


def test_a_task_that_fails_is_named_and_tried_again(job, whole):
    """Submitted once more, the job bakes what is missing."""
    job.chunk(4).mkdir()
    job.wait(job.ids["stitch"], "FAILED")
    assert f"error: output {job.chunk(4)}: is a folder" in job.said(job.task(4))
    assert f"error: cannot open {job.chunk(4)}: it is a folder" in job.said(job.ids["stitch"])
    assert not (job.folder / "slid.usdc").exists()
    job.chunk(4).rmdir()
    before = [job.chunk(number).stat().st_ino for number in (1, 2, 3)]
    again = Submitted(job.folder / "shot.usda", job._environment)
    again.wait(again.ids["stitch"], "COMPLETED")
    assert [job.chunk(number).stat().st_ino for number in (1, 2, 3)] == before
    assert content(job.folder / "slid.usdc") == whole


def test_more_chunks_than_an_array_has_tasks(shot, whole, environment):
    """A task bakes several: what it has baked before it is killed, it does not bake again."""
    count = 2 * slurm.MOST_TASKS
    job = Submitted(shot, environment, "--chunk", "1")
    kill_baking(job.folder, f"slid.chunk{slurm.MOST_TASKS + 1}.usdc")
    job.wait(job.task(1), "FAILED")
    assert f"/slid.chunk{count}.usdc" in (job.folder / "slid.slurm.sh").read_text()
    first = job.chunk(1).stat().st_ino
    job.requeue(job.task(1))
    job.wait(job.ids["stitch"], "COMPLETED")
    assert job.chunk(1).stat().st_ino == first and job.said(job.task(1)).count("is whole already") == 1
    assert len(list(job.folder.glob("slid.chunk*.usdc"))) == count
    assert job.task(slurm.MOST_TASKS + 1) not in job.states()
    assert content(job.folder / "slid.usdc") == whole


def test_a_chunk_that_fails_does_not_keep_a_task_from_the_others(shot, environment):
    job = Submitted(shot, environment, "--chunk", "1")
    job.chunk(slurm.MOST_TASKS).mkdir()
    job.wait(job.task(slurm.MOST_TASKS), "FAILED")
    assert job.chunk(2 * slurm.MOST_TASKS).is_file()


def test_a_task_out_of_range(shot, environment):
    job = Submitted(shot, environment, "--chunk", "4", sbatch=["--array=3"])
    job.wait(job.task(3), "FAILED")
    assert "error: --chunk 3/2: the part must be from 1 to 2" in job.said(job.task(3))
    assert not job.chunk(3).exists()


def test_pictures_are_drawn_though_stitching_failed(shot, environment):
    """Else they would never be: Slurm does not begin what waits for a job that has failed, though that is requeued."""
    page = shot.parent / "page.html"
    job = Submitted(shot, environment, "--html", page, "--chunk", "1", "--frames", "1001:1002")
    job.chunk(2).mkdir()
    job.wait(job.ids["stitch"], "FAILED")
    job.wait(job.ids["draw"], "COMPLETED")
    assert page.read_text().rstrip().endswith("</html>")
    job.chunk(2).rmdir()
    for each in (job.task(2), job.ids["stitch"]):
        job.requeue(each)
        job.wait(each, "COMPLETED")
    assert (shot.parent / "slid.usdc").exists()
