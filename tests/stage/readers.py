"""A stage through both readers: the tool, which bakes it, and the file format, which computes its layer.

The stage of a row is cache.usda, and x.skinslide, which sublayers it.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from pxr import Sdf, Usd

import skinslide
import stages
from digests import Contents, Values, contents
from edits import CARRIED, LEFT, RATES, Scene
from layers import said
from skinslide.command.cli import main

# What a bake writes, and a layer computes, for each mesh; and primvars of the rows that it might.
OUTPUTS = {"points", "extent", "normals", "velocities", "accelerations"}
for _name in (*CARRIED, *RATES, *LEFT):
    OUTPUTS |= {f"primvars:{_name}", f"primvars:{_name}:indices"}


class Sentence(NamedTuple):
    """What is said of a stage, without what each reader puts around it."""

    prim: str
    patch: str | None
    frame: str | None
    text: str


# How the readers differ in what they put around a sentence, all of it. The tool says
#     error: PRIM: patch NAME: frame 1002: SENTENCE
# and a layer
#     x.skinslide: PRIM: frame 1002: patch NAME: SENTENCE; the points are those of the cache
# with a frame also where the set-up is bad, which shows there when the first frame is asked for.
_AROUND = re.compile(
    r"(?:error: |warning: |(?:/.*/)?x\.skinslide: )"
    r"(?:(?P<prim>/[^:]*): )?"
    r"(?:frame (?P<early>[^:]+): )?"
    r"(?:patch (?P<patch>.+?)(?: \((?P<piece>piece \d+ of \d+)\))?: )?"
    r"(?:frame (?P<late>[^:]+): )?"
    r"(?P<text>.*?)"
    r"(?:; the points are those of the cache)?",
    re.DOTALL,
)


def sentence(line: str) -> Sentence | None:
    found = _AROUND.fullmatch(line)
    if not found:
        return None
    piece = f"{found['piece']}: " if found["piece"] else ""
    return Sentence(found["prim"] or "", found["patch"], found["early"] or found["late"], piece + found["text"])


@dataclass(frozen=True)
class Opened:
    """A .skinslide file that was opened, and all of it computed."""

    layer: Contents  # what it computes, sample by sample
    flat: Contents  # the same of the flattened stage
    said: list[Sentence]


def save(scene: Scene, file: str | None) -> Path:
    cache, path = stages.save(scene.stage, scene.folder / "cache.usda"), scene.folder / "x.skinslide"
    path.write_text(cache.read_text() if file is None else file)
    return path


def opened(path: Path) -> Opened:
    with said() as messages:
        stage = Usd.Stage.Open(str(path))
        layer = outputs(stage.GetRootLayer())
        flat = outputs(stage.Flatten())
    ours = [each for each in map(sentence, messages) if each]
    return Opened(layer, _same_times(flat, layer), ours)


def _same_times(flat: Contents, layer: Contents) -> Contents:
    """A flattened stage without what it has from weaker layers."""
    return {
        path: Values(flat[path].type_name, {time: flat[path].at[time] for time in values.at if time in flat[path].at})
        for path, values in layer.items()
        if path in flat
    }


def cached(path: Path) -> Contents:
    """The points below a file, as the cache has them."""
    stage = Usd.Stage.Open(Sdf.Layer.FindOrOpen(str(path), {"live": "0"}))
    return {name: value for name, value in outputs(stage.Flatten()).items() if name.endswith(".points")}


def baked(path: Path) -> tuple[Contents, list[Sentence]]:
    """What a bake holds, and what it warns of."""
    output = path.with_name("baked.usdc")
    report = skinslide.bake_to_file(path, output)
    warned = [sentence(str(problem)) for problem in [*report.problems, *report.warnings]]
    return outputs(Sdf.Layer.FindOrOpen(str(output))), [each for each in warned if each]


def outputs(layer: Sdf.Layer) -> Contents:
    """What OUTPUTS of a layer hold; without the default where there are samples, which are stronger."""
    return {
        path: Values(type_name, {time: value for time, value in at.items() if time != "default" or len(at) == 1})
        for path, (type_name, at) in contents(layer).items()
        if path.rpartition(".")[2] in OUTPUTS
    }


def command(capfd, *arguments: str) -> tuple[int, list[Sentence]]:
    """The exit code of the command, and the errors that it names."""
    code = main([str(argument) for argument in arguments])
    lines = [line for stream in capfd.readouterr() for line in stream.splitlines() if line.startswith("error: ")]
    return code, [each for each in map(sentence, lines) if each]
