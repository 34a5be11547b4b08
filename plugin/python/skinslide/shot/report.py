"""What sliding did, patch by patch: for people as a table, for programs as a dictionary."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from skinslide.arrays.native import degradation_text, degradations, version
from skinslide.arrays.records import PatchInfo, PatchResult, Roughness
from skinslide.problems import Problem, counted, frame_text, lines_text, problem_lines
from skinslide.shot.rows import Moments, Rows

if TYPE_CHECKING:
    from skinslide.stage.mesh import PatchedMesh

STAGES = ("density", "embed", "relax", "locate", "interpolate")

# Counts that say a result is less than it should be.
_EDGES, _FACES = ("edge", "edges"), ("face", "faces")
_AT_REST = {
    "zero_length_edges": (_EDGES, "of no length at rest, taken as 1e-6 of the mean edge"),
    "collapsed_faces": (_FACES, "of no area in the rest embedding"),
    "folded_faces": (_FACES, "turned over in the rest embedding"),
}


_NO_STRETCH = 1e-4  # less is not to be seen
_PLANAR = ("unit", "fast")  # rules by which a patch is laid out in a plane


RECORD = 1  # the version of what --json prints: more where a name goes or means something else
# Of a frame: what a bake's limits are set to.
MEASURES: dict[str, Callable[[PatchResult], float]] = {
    "folded": lambda result: result.folded_faces,
    "clamped": lambda result: result.clamped_vertices,
    "stretch": lambda result: result.stretch_after,
    "added_stretch": lambda result: result.stretch_after - result.stretch_before,
}


def whole(document: Any) -> Any:
    """A document in which lists replace the parts that are made only when they are asked for."""
    if isinstance(document, dict):
        return {name: whole(value) for name, value in document.items()}
    return [whole(value) for value in document] if isinstance(document, list | Iterator) else document


@dataclass
class PatchReport:
    """One patch over all frames.

    Attributes:
        info: What the patch is.
        frames: Stage times, ascending; None is the default time.
        results: What happened at each of them.
        motion: How roughly the patch moves at each of them that is between two others.
        least: The least stretch that a search found at each of them, where it was asked for.
        rule: By which it slides.
        interpolation: linear, meanValue or limit.
    """

    info: PatchInfo
    frames: list[float | None] = field(default_factory=list)
    results: Rows[PatchResult] = field(default_factory=lambda: Rows(PatchResult))
    motion: Moments[Roughness] = field(default_factory=lambda: Moments(Roughness))
    least: dict[float | None, float] = field(default_factory=dict)
    rule: str = ""
    interpolation: str = ""

    def column(self, name: str) -> np.ndarray:
        """A field of the results, frame by frame.

        Args:
            name: The field.

        Returns:
            Its values (frames,).
        """
        return self.results.column(name)

    @property
    def worst(self) -> int:
        """The index of the frame with the most stretch in the cache."""
        return int(np.argmax(self.column("stretch_before")))

    @property
    def change(self) -> float | None:
        """Of stretch by sliding, at the worst frame, as a share of the cache's; None where the cache has none."""
        worst = self.results[self.worst]
        return worst.stretch_after / worst.stretch_before - 1 if worst.stretch_before > _NO_STRETCH else None

    @property
    def roughness(self) -> float | None:
        """The largest second difference in time of the result over that of the cache; None of fewer than three frames.

        Neither counts as less than a hundredth of the mean edge at rest, or than rounding may explain: so that skin at
        rest has a roughness of 1, and a cache that moves evenly, as linear blends of shapes do, makes it no endless
        one.
        """
        if not self.motion:
            return None
        least, before, after = (max(self.motion.rows.column(name).tolist()) for name in ("least", "before", "after"))
        return max(least, after) / max(least, before)

    @property
    def steady_roughness(self) -> float | None:
        """The same; None where frames are so far apart that it says little of the shot."""
        return None if far_apart(self.frames) else self.roughness

    @property
    def roughest(self) -> float | None:
        """The frame at which the result moves most roughly; None of fewer than three frames."""
        after = self.motion.rows.column("after").tolist()
        return max(zip(after, self.motion, strict=True), key=itemgetter(0), default=(0, None))[1]

    def share(self, frame: float | None) -> float | None:
        """Of the stretch that can be removed at a frame, what sliding removes.

        Args:
            frame: The stage time.

        Returns:
            1 where nothing is left to gain, below 0 where sliding adds stretch; None where there is none to remove, or
            it was not searched for.
        """
        return self._share(frame, self.results[self.frames.index(frame)])

    def _share(self, frame: float | None, result: PatchResult) -> float | None:
        least = min(self.least.get(frame, np.inf), result.stretch_after)
        most = result.stretch_before - least
        return (result.stretch_before - result.stretch_after) / most if self.least and most > _NO_STRETCH else None

    @property
    def shares(self) -> list[float]:
        """The share at each frame that has one."""
        found = map(self._share, self.frames, self.results) if self.least else ()
        return [share for share in found if share is not None]

    def most(self, measure: str) -> tuple[float, float | None] | None:
        """How much of what a limit may be set to the patch has at most, and the frame.

        Args:
            measure: folded, clamped, stretch, added_stretch or roughness.

        Returns:
            The value and the frame; None where there is none, as roughness of fewer than three frames.
        """
        if measure == "roughness":
            return None if self.roughness is None else (self.roughness, self.roughest)
        values = [MEASURES[measure](result) for result in self.results]
        index = int(np.argmax(values))
        return values[index], self.frames[index]

    def milliseconds(self) -> dict[str, np.ndarray]:
        """Time by stage of the walk and in total, frame by frame, (frames,) each."""
        stages = {stage: 1e3 * self.column(f"{stage}_seconds") for stage in STAGES}
        return {**stages, "total": np.sum(list(stages.values()), axis=0)}

    @property
    def label(self) -> str:
        """The patch's name, with its piece where it has several."""
        info = self.info
        return info.name if info.piece_count == 1 else f"{info.name} ({info.piece + 1} of {info.piece_count})"

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON, with the largest and the mean of each field of the results."""
        return whole(self.document())

    def document(self) -> dict[str, Any]:
        """The same, of which each frame is there when it is asked for."""
        fields = {name: self.column(name) for name in PatchResult._fields}
        worst = self.results[self.worst]
        return {
            **self.info._asdict(),
            "rule": self.rule,
            "interpolation": self.interpolation,
            "max": {name: values.max().item() for name, values in fields.items()},
            "mean": {name: values.mean().item() for name, values in fields.items()},
            "frames": map(self._frame_dict, self.frames, self.results),
            "least_share": min(self.shares, default=None),
            "median_share": float(np.median(self.shares)) if self.shares else None,
            "roughness": self.roughness,
            "roughest_frame": self.roughest,
            "worst_frame": self.frames[self.worst],
            "worst_frame_stretch_before": worst.stretch_before,
            "worst_frame_stretch_after": worst.stretch_after,
        }

    def _frame_dict(self, frame: float | None, result: PatchResult) -> dict[str, Any]:
        motion = self.motion.get(frame)
        return {
            "frame": frame,
            **{name: getattr(result, name) for name in _OF_A_FRAME},
            "second_difference_before": motion.before if motion else None,
            "second_difference_after": motion.after if motion else None,
            "least_stretch": self.least.get(frame),
            "share": self._share(frame, result),
        }

    def problems(self, prim: str) -> list[Problem]:
        """A warning for each kind of degradation.

        Args:
            prim: The path of the mesh.

        Returns:
            The warnings.
        """
        counts = [(getattr(self.info, name), words, text) for name, (words, text) in _AT_REST.items()]
        at_rest = [(None, f"{counted(count, *words)} {text}") for count, words, text in counts if count]
        warned = [Problem("warning", prim, self.label, *warning) for warning in [*at_rest, *self._degraded()]]
        return warned + self._stretched(prim)

    def _stretched(self, prim: str) -> list[Problem]:
        """A warning where sliding adds stretch, as on a smile, or a closed tube embedded from its open end."""
        added = self.column("stretch_after") - self.column("stretch_before")
        if not (added > _NO_STRETCH).any():
            return []
        worst = added.argmax()
        before = stretch_text(self.results[worst].stretch_before)
        after = stretch_text(self.results[worst].stretch_after)
        remedy = "; the rule even may take some out" if self.rule in _PLANAR else ""
        message = f"sliding adds stretch: {before} in the cache, {after} slid{_share(added > _NO_STRETCH)}{remedy}"
        return [Problem("warning", prim, self.label, self.frames[worst], message)]

    def _degraded(self) -> Iterator[tuple[float | None, str]]:
        """Of each kind that there is, the frame at which there is most of it, and what to say."""
        for kind, name in enumerate(degradations()):
            counts = self.column(name)
            if counts.any():
                yield self.frames[counts.argmax()], degradation_text(kind, counts.max().item()) + _share(counts)


def _share(found: np.ndarray) -> str:
    """In how many of some frames something is; nothing to say of one."""
    if len(found) == 1:
        return ""
    return f" (at {np.count_nonzero(found)} of {len(found)} frames, most at this one)"


def stretch_text(stretch: float) -> str:
    return f"{stretch:.4f}"


def roughness_text(roughness: float | None) -> str:
    return "-" if roughness is None else f"{roughness:.2f}"


def milliseconds_text(milliseconds: float) -> str:
    return f"{milliseconds:.2f}"


def time_text(frame: float | None) -> str:
    return "default" if frame is None else frame_text(frame)


_OF_A_FRAME = ("stretch_before", "stretch_after", "slid_vertices", "largest_slide", "clamped_vertices", "folded_faces")


@dataclass
class MeshReport:
    """One mesh over all frames.

    Attributes:
        path: Of the prim.
        vertex_count: Of the mesh.
        rest_source: Where the rest points were found, such as primvars:Pref.
        welded: Points that are one with others, since they are in one place.
        patches: Those that were slid, in the order of the set-ups and their pieces.
    """

    path: str
    vertex_count: int
    rest_source: str
    welded: int
    patches: list[PatchReport]

    @classmethod
    def start(cls, mesh: PatchedMesh, pieces: Sequence[PatchInfo]) -> MeshReport:
        """A report without frames.

        Args:
            mesh: What is slid.
            pieces: Those of its patches.

        Returns:
            The report.
        """
        patches = []
        for piece in pieces:
            patch = mesh.patches[piece.setup]
            patches.append(PatchReport(piece, rule=patch.rule, interpolation=mesh.interpolation_of(patch)))
        return cls(mesh.path, mesh.vertex_count, mesh.rest_source, mesh.weld.info.welded_points, patches)

    def add(self, frame: float | None, results: Sequence[PatchResult]) -> None:
        """Takes in one frame.

        Args:
            frame: The stage time; None is the default time.
            results: What happened to each patch.
        """
        for patch, result in zip(self.patches, results, strict=True):
            patch.frames.append(frame)
            patch.results.append(result)

    def add_least(self, frame: float | None, least: Sequence[float]) -> None:
        """Takes in the least stretch that a search found at a frame.

        Args:
            frame: The stage time.
            least: Of each patch.
        """
        for patch, own in zip(self.patches, least, strict=True):
            patch.least[frame] = own

    def add_motion(self, frame: float | None, roughness: Sequence[Roughness]) -> None:
        """Takes in how it moves at a frame, once it has been slid before and after it, too.

        Args:
            frame: The stage time.
            roughness: Of each patch.
        """
        for patch, own in zip(self.patches, roughness, strict=True):
            patch.motion.add(frame, own)

    @property
    def frame_count(self) -> int:
        """How many frames were slid."""
        return max((len(patch.frames) for patch in self.patches), default=0)

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return whole(self.document())

    def document(self) -> dict[str, Any]:
        """The same, of which each patch is there when it is asked for."""
        return {
            "prim": self.path,
            "vertex_count": self.vertex_count,
            "rest": self.rest_source,
            "welded": self.welded,
            "frames": self.patches[0].frames if self.patches else [],
            "patches": (patch.document() for patch in self.patches),
        }


class Made(Protocol):
    """What is to be said of something that was made of the slid frames, such as pictures."""

    def as_dict(self) -> dict[str, Any]: ...

    def lines(self, meshes: Sequence[MeshReport]) -> list[str]: ...


@dataclass
class BakeReport:
    """Every mesh that was slid.

    Attributes:
        warnings: What reading the stage warned of.
        meshes: One for each mesh.
        made: What was made of the frames beside a layer, such as pictures.
        resumed: Whether the layer was there already, whole and of the same, and nothing was slid.
    """

    warnings: list[Problem]
    meshes: list[MeshReport] = field(default_factory=list)
    made: list[Made] = field(default_factory=list)
    resumed: bool = False

    @property
    def frame_count(self) -> int:
        """How many frames of all meshes were slid."""
        return sum(mesh.frame_count for mesh in self.meshes)

    @property
    def problems(self) -> list[Problem]:
        """The warnings, and every degradation."""
        patches = [(mesh.path, patch) for mesh in self.meshes for patch in mesh.patches]
        return self.warnings + [problem for prim, patch in patches for problem in patch.problems(prim)]

    def as_dict(self) -> dict[str, Any]:
        """What `--json` prints, as record.schema.json beside this file says."""
        return whole(self.document())

    def document(self) -> dict[str, Any]:
        """The same, of which each mesh is there when it is asked for: to be written piece by piece."""
        return {
            "record": RECORD,
            "version": version(),
            "resumed": self.resumed,
            "worst": {name: self._worst(name) for name in (*MEASURES, "roughness")},
            "meshes": (mesh.document() for mesh in self.meshes),
            "problems": [problem.as_dict() for problem in self.problems],
            **{name: value for made in self.made for name, value in made.as_dict().items()},
        }

    def _worst(self, measure: str) -> dict[str, Any] | None:
        """Where most of a measure is; None where it is nowhere."""
        found = [
            (*most, mesh.path, patch.label)
            for mesh in self.meshes
            for patch in mesh.patches
            if (most := patch.most(measure)) is not None
        ]
        if not found:
            return None
        value, frame, prim, patch = max(found, key=lambda each: each[0])
        return {"value": value, "prim": prim, "patch": patch, "frame": frame}

    def text(self) -> str:
        """The table for a terminal, every problem, and what was made."""
        if self.resumed:
            return lines_text(problem_lines(self.problems))
        rows = [_HEADINGS, *(_row(patch) for mesh in self.meshes for patch in mesh.patches)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [_line(_HEADINGS, widths)]
        for mesh in self.meshes:
            counts = f"{mesh.vertex_count} points, {counted(mesh.frame_count, 'frame')}"
            lines.append(f"{mesh.path}: {counts}, rest from {mesh.rest_source}")
            lines.extend(_line(_row(patch), widths) for patch in mesh.patches)
            lines.extend(_share_line(patch) for patch in mesh.patches if patch.shares)
        made = [line for made in self.made for line in made.lines(self.meshes)]
        legend = [_LEGEND] if len(rows) > 1 else []
        return lines_text([*lines, *legend, *problem_lines(self.problems), *made])


_HEADINGS = [
    "patch",
    "rule",
    "interpolation",
    "shape",
    "vertices",
    "stretch",
    "slid",
    "change",
    "at frame",
    "rough",
    "folded",
    "clamped",
    "ms/frame",
]
_LEGEND = (
    "stretch, slid: RMS of log(edge length / rest length) in the cache and slid, at the frame where the cache has "
    "most; --help says what the others are"
)


def _row(patch: PatchReport) -> list[str]:
    worst = patch.results[patch.worst]
    return [
        f"  {patch.label}",
        patch.rule,
        patch.interpolation,
        shape_text(patch.info),
        str(patch.info.vertex_count),
        stretch_text(worst.stretch_before),
        stretch_text(worst.stretch_after),
        "-" if patch.change is None else f"{patch.change:+.0%}",
        time_text(patch.frames[patch.worst]),
        roughness_text(patch.steady_roughness),
        str(patch.column("folded_faces").max()),
        str(patch.column("clamped_vertices").max()),
        milliseconds_text(patch.milliseconds()["total"].mean()),
    ]


def far_apart(frames: Iterable[float | None]) -> bool:
    """Whether some of these frames, ascending, are more than one apart, as no bake of a whole shot has them."""
    return any(after - before > 1 + 1e-6 for before, after in pairwise(each for each in frames if each is not None))


def shape_text(info: PatchInfo) -> str:
    """What a patch is like, by its number of holes and its Euler characteristic, which is even where it is closed.

    A surface of g handles has 2 - 2 g, less one for each of its borders.
    """
    characteristic = info.vertex_count - info.edge_count + info.face_count
    borders = info.hole_count + (characteristic + info.hole_count) % 2
    handles = (2 - borders - characteristic) // 2
    shape = counted(info.hole_count, "hole") if info.hole_count else "disk" if borders else "closed"
    return f"{shape}, {counted(handles, 'handle')}" if handles > 0 else shape


def share_text(least: float, median: float) -> str:
    return f"of the stretch that can be removed, {least:.2f} at least, {median:.2f} in the median frame"


def _share_line(patch: PatchReport) -> str:
    return f"  {patch.label}: {share_text(min(patch.shares), float(np.median(patch.shares)))}"


def _line(cells: list[str], widths: list[int]) -> str:
    first, *others = (cell.rjust(width) for cell, width in zip(cells, widths, strict=True))
    return "  ".join([cells[0].ljust(len(first)), *others])
