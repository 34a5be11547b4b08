"""A job as a script that hands it to Slurm: an array of tasks, and what runs once they have ended.

Each step waits until what is before it has ended, however: stitching names what is not there, and is run again with
`scontrol requeue`, as a task is. After `afterok` a step would wait for ever for one that failed and was requeued.

Slurm has no task of a number that is not below its MaxArraySize, 1001 unless it was set up otherwise: where there are
more chunks, each task bakes several, one after the other.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from skinslide.queues.steps import Job

_CHUNK = "$skinslide_chunk"

_SCRIPT = """\
#!/usr/bin/env bash
# {name}: {count} chunks of frames, each baked by a task, or several where Slurm has no more tasks; then one that puts
# them together.
#     bash {file} [options of sbatch, such as --partition=long]
# Prints the ids of the jobs. A task that failed, and then stitch, is run again by: scontrol requeue ID
set -euo pipefail

submit() {{ sbatch --parsable --chdir={folder} --requeue --open-mode=append "$@"; }}

tasks=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')
tasks=$((tasks - 1 < {count} ? tasks - 1 : {count}))
bake=$(submit --job-name={bake} --array=1-"$tasks" --output={log}.%A_%a.log "$@" <<'TASK'
#!/usr/bin/env bash
skinslide_chunk=$SLURM_ARRAY_TASK_ID code=0
while
    {bake_words} || code=$?
    (((skinslide_chunk += SLURM_ARRAY_TASK_MAX) <= {count}))
do :; done
exit $code
TASK
)
bake=${{bake%%;*}}
echo "bake $bake"
{after}"""

_AFTER = """\

{step}=$(submit --job-name={name} --dependency=afterany:"${waits}" --output={log}.%j.log "$@" <<'TASK'
#!/usr/bin/env bash
exec {words}
TASK
)
{step}=${{{step}%%;*}}
echo "{step} ${step}"
"""


def script(job: Job) -> str:
    folder, stem = str(job.folder), job.layer.stem
    log = shlex.quote(f"{stem}.slurm".replace("%", "%%"))
    bake = job.bake(str(job.stage), folder, _CHUNK)
    after = _after(job, "stitch", "bake", job.stitch(folder), log)
    if job.drawing:
        after += _after(job, "draw", "stitch", job.preview(str(job.stage), folder), log)
    return _SCRIPT.format(
        name=job.name,
        count=job.count,
        file=shlex.quote(f"{stem}.slurm.sh"),
        folder=shlex.quote(folder),
        bake=shlex.quote(f"{job.name} bake"),
        log=log,
        bake_words=_line(job.tool, bake),
        after=after,
    )


def _after(job: Job, step: str, waits: str, words: Sequence[str], log: str) -> str:
    """A step that begins once another has ended."""
    name = shlex.quote(f"{job.name} {step}")
    return _AFTER.format(step=step, name=name, waits=waits, log=log, words=_line(job.tool, words))


def _line(tool: str, words: Sequence[str]) -> str:
    """A command for a shell that knows the number of the chunk."""
    return " ".join(f'"{_CHUNK}"'.join(map(_quoted, word.split(_CHUNK))) for word in [tool, *words])


def _quoted(part: str) -> str:
    return shlex.quote(part) if part else ""
