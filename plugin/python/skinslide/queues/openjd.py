"""A job as a template of Open Job Description, which `openjd run` runs on one machine and AWS Deadline Cloud on many.

What names a place is a parameter, so that a template goes to machines that have it elsewhere: -p Stage=..., for one.
A path's default must be below the template; a stage that is not is named as it is on the disks that machines share.
It is JSON, which is YAML too.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from skinslide.problems import UsageError
from skinslide.queues.steps import Job

_LONGEST = 1024  # of a parameter's value
_MOST_NAME = 128  # of the job
_STAGE, _FOLDER, _CHUNK = "{{Param.Stage}}", "{{Param.Folder}}", "{{Task.Param.Chunk}}"


def template(job: Job) -> str:
    """Raises UsageError for what a template cannot hold."""
    for word in [job.layer.name, *job.sliding, *job.baking, *map(str, job.drawing.values())]:
        if "{{" in word:
            raise UsageError(f"{word!r}: Open Job Description would replace what stands in {{{{ }}}}")
    steps = [
        {
            "name": "Bake",
            "parameterSpace": {
                "taskParameterDefinitions": [{"name": "Chunk", "type": "INT", "range": f"1-{job.count}"}]
            },
            "script": _run(job.bake(_STAGE, _FOLDER, _CHUNK)),
        },
        _after("Bake", "Stitch", job.stitch(_FOLDER)),
        *([_after("Stitch", "Draw", job.preview(_STAGE, _FOLDER))] if job.drawing else []),
    ]
    found = {
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name[:_MOST_NAME],
        "parameterDefinitions": [
            _stage(job),
            _path("Folder", ".", "DIRECTORY", "INOUT"),
            _text("Skinslide", job.tool),
        ],
        "steps": steps,
    }
    return json.dumps(found, indent=2) + "\n"


def _stage(job: Job) -> dict[str, Any]:
    if job.stage.is_relative_to(job.folder):
        return _path("Stage", str(job.stage.relative_to(job.folder)), "FILE", "IN")
    return _text("Stage", str(job.stage))


def _text(name: str, default: str) -> dict[str, Any]:
    return {"name": name, "type": "STRING", "default": _fitting(default)}


def _path(name: str, default: str, kind: str, flow: str) -> dict[str, Any]:
    return {"name": name, "type": "PATH", "objectType": kind, "dataFlow": flow, "default": _fitting(default)}


def _fitting(value: str) -> str:
    if len(value) > _LONGEST:
        raise UsageError(f"{value[:40]}...: is longer than the {_LONGEST} characters that Open Job Description takes")
    return value


def _after(other: str, name: str, words: Sequence[str]) -> dict[str, Any]:
    return {"name": name, "dependencies": [{"dependsOn": other}], "script": _run(words)}


def _run(words: Sequence[str]) -> dict[str, Any]:
    """A command that is told to end, and then has two minutes to leave its output as it was."""
    ended = {"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 120}
    return {"actions": {"onRun": {"command": "{{Param.Skinslide}}", "args": list(words), "cancelation": ended}}}
