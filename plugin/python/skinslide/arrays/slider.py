"""A slider for a mesh and its patches, on numpy arrays. No USD here.

The manual is `skinslide.h`. Arrays of other types are converted if that loses no more than digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from skinslide._core import ffi, lib
from skinslide.arrays.apart import apart, together
from skinslide.arrays.checks import all_of, as_array, check_count, real, whole
from skinslide.arrays.lookup import Lookup
from skinslide.arrays.native import Handle, call, new, new_array, read, text, writable
from skinslide.arrays.records import LookupInfo, PatchInfo, PatchResult, Roughness
from skinslide.arrays.setups import Controls, PatchSetup, Sample, Subdivision
from skinslide.arrays.structs import Arguments, Sizes
from skinslide.arrays.workspaces import Workspaces
from skinslide.problems import SliderError


class Frame(NamedTuple):
    """A slid frame.

    Attributes:
        points: float32 (V, 3).
        patches: What happened to each of the slider's patches, if it was measured; else none.
        embeddings: Each patch laid out in the plane, float64 (patch vertices, 2), if asked for; else None.
        turns: How the skin turned under each vertex, float32 (V, 3), if asked for: see `carry`; else None.
    """

    points: np.ndarray
    patches: tuple[PatchResult, ...]
    embeddings: tuple[np.ndarray, ...] | None
    turns: np.ndarray | None


class Diagnostics(NamedTuple):
    """What a slide did to each vertex, float32 (V,) each.

    Attributes:
        stretch_before: RMS of log(length / rest length) over the edges of patches at the vertex, in the cache.
        stretch_after: The same after sliding.
        slide: How far it slid, in the mesh's units.
        force_density: The mean multiplier of those edges, as painted.
    """

    stretch_before: np.ndarray
    stretch_after: np.ndarray
    slide: np.ndarray
    force_density: np.ndarray


class Slider:
    """A mesh with all its patches. Immutable; any number of threads may slide frames at once.

    Faces of a set-up that fall into several connected pieces become several patches; `patches` describes each.
    """

    def __init__(
        self,
        face_counts: npt.ArrayLike,
        face_indices: npt.ArrayLike,
        rest_points: npt.ArrayLike,
        patches: Sequence[PatchSetup],
        *,
        lookup: str | Lookup = "auto",
        subdivision: Subdivision | None = None,
        weld: npt.ArrayLike | None = None,
        space: npt.ArrayLike | None = None,
        jobs: int = 1,
    ):
        """Builds every patch at rest.

        Args:
            face_counts: Vertices of each face (F,).
            face_indices: Vertices (sum of counts,), face by face.
            rest_points: The pose in which nothing slides (V, 3).
            patches: The set-ups.
            lookup: How rest vertices are looked up: auto, egl, exact, or a Lookup.
            subdivision: How the mesh is subdivided, which the interpolation limit needs; None: not at all.
            weld: The point that each point is one with (V,), most with themselves, as `find_weld` returns it; None: no
                points are welded.
            space: The matrix (3, 3) that takes points, as rows, to where lengths are measured, such as the world, where
                a mesh may be scaled more one way than another; None: the mesh's own space.
            jobs: How many threads build set-ups at once; the slider does not depend on it.

        Raises:
            SliderError: The mesh or a set-up cannot be slid; the message names patch and element.
        """
        native = Arguments()
        mesh = native.mesh(face_counts, face_indices, rest_points, subdivision, weld, space)
        self._sizes = Sizes(mesh.vertex_count, mesh.face_count)
        options = Lookup.of(lookup).options()
        given = all_of("patches", patches, PatchSetup)
        self._names = tuple(patch.name for patch in given)
        setups = new_array("patch_setup", len(given))
        for setup, patch in zip(setups, given, strict=True):
            native.fill_setup(setup, patch, self._sizes)
        self._slider = apart(_create, native, mesh, setups, len(given), whole(jobs, "jobs"))
        self.patches = tuple(self._info(i) for i in range(lib.skinslide_slider_patch_count(self._slider.pointer)))
        self._workspaces = Workspaces(self._slider, options)

    def slide(
        self,
        points: npt.ArrayLike,
        controls: Sequence[Controls] | None = None,
        *,
        embeddings: bool = False,
        turns: bool = False,
        measures: bool = True,
    ) -> Frame:
        """Slides one frame.

        Args:
            points: Of the deformed mesh (V, 3).
            controls: One for each set-up; None: the set-ups' own.
            embeddings: Whether to return the frame's embeddings.
            turns: Whether to return how the skin turned.
            measures: Whether to measure each patch; without, a frame is faster, and its `patches` is empty.

        Returns:
            The frame.

        Raises:
            SliderError: The points or controls cannot be slid; the message names patch and element.
        """
        native = Arguments()
        cached = native.points(points, self._sizes.vertices, "points")
        given = native.frame_controls(controls, self._names, self._sizes)
        slid = np.empty((self._sizes.vertices, 3), np.float32)
        results = new_array("patch_result", len(self.patches)) if measures else ffi.NULL
        workspace = self._workspaces.take()
        try:
            call(lib.skinslide_slide, workspace.pointer, cached, given, writable("float[]", slid), results)
            planes = self._frame_embeddings(workspace) if embeddings else None
            turned = self._frame_turns(workspace, cached) if turns else None
        finally:
            self._workspaces.give_back(workspace)
        measured = tuple(read(PatchResult, result) for result in results) if measures else ()
        return Frame(slid, measured, planes, turned)

    def stop(self) -> None:
        """Makes the frames that are being slid, on any thread, and all later ones fail soon.

        They raise a SliderError with the status INTERRUPTED.
        """
        self._workspaces.stop()

    def diagnose(
        self,
        cached: npt.ArrayLike,
        slid: npt.ArrayLike,
        controls: Sequence[Controls] | None = None,
        *,
        chosen: Sequence[bool] | None = None,
    ) -> Diagnostics:
        """Measures what a slide did.

        Args:
            cached: Points before it (V, 3).
            slid: Points after it (V, 3).
            controls: One for each set-up; None: the set-ups' own.
            chosen: For each set-up, whether its patches count; None: all do.

        Returns:
            What it did to each vertex.

        Raises:
            SliderError: The points or controls cannot be used.
        """
        native, count = Arguments(), self._sizes.vertices
        before, after = native.points(cached, count, "cached"), native.points(slid, count, "slid")
        given = native.frame_controls(controls, self._names, self._sizes)
        wanted = ffi.NULL
        if chosen is not None:
            flags = as_array(chosen, np.bool_, (-1,), "chosen").tolist()
            check_count("BAD_ARGUMENT", "chosen", (len(flags), "given"), (len(self._names), "patches"))
            wanted = ffi.new("uint8_t[]", flags)
        result = Diagnostics(*(np.empty(count, np.float32) for _ in Diagnostics._fields))
        arrays, buffers = new("diagnostics"), [writable("float[]", array) for array in result]
        for name, buffer in zip(Diagnostics._fields, buffers, strict=True):
            setattr(arrays, name, buffer)
        call(lib.skinslide_diagnose, self._slider.pointer, given, wanted, before, after, arrays)
        return result

    def least_stretch(self, points: npt.ArrayLike) -> tuple[float, ...]:
        """Searches for the least stretch that a pose allows, from the cache and from where a slide leaves skin: slow.

        Args:
            points: Of the deformed mesh (V, 3).

        Returns:
            For each patch the RMS of log(length / rest length), as in `PatchResult`.

        Raises:
            SliderError: The points cannot be slid; the message names patch and element.
        """
        least = np.empty(len(self.patches))
        with self._slid(points) as (workspace, cached):
            call(lib.skinslide_workspace_least_stretch, workspace.pointer, cached, writable("double[]", least))
        return tuple(least.tolist())

    def lookup(self) -> LookupInfo:
        """Says which lookup its frames have, and on which device.

        Returns:
            That of the next frame; its reason says how the device failed last, if it did.
        """
        info, device = new("lookup_info"), new("device_info")
        with self._workspaces.taken() as workspace:
            call(lib.skinslide_workspace_lookup, workspace.pointer, info, device)
        return read(LookupInfo, info[0], device[0])

    def check_points(self, points: npt.ArrayLike) -> str:
        """Checks whether a frame can be slid.

        Args:
            points: Of the deformed mesh (V, 3).

        Returns:
            A warning of points that are not finite and stay as they are, since no patch uses them; or "".

        Raises:
            SliderError: The points cannot be slid; the message names the element.
        """
        native, passed, warning = Arguments(), ffi.new("int32_t *"), ffi.new("skinslide_error *")
        given = native.points(points, self._sizes.vertices, "points")
        call(lib.skinslide_slider_check_points, self._slider.pointer, given, passed, warning)
        return text(warning.message) if passed[0] else ""

    def roughness(self, samples: Sequence[Sample]) -> tuple[Roughness, ...]:
        """Measures how roughly each patch moves at the middle of three times.

        Args:
            samples: Of the three times, ascending.

        Returns:
            One for each patch.

        Raises:
            SliderError: The samples cannot be used.
        """
        native, results = Arguments(), new_array("roughness", len(self.patches))
        given = native.samples(samples, 3, self._sizes.vertices, "roughness")
        call(lib.skinslide_measure_roughness, self._slider.pointer, given, results)
        return tuple(read(Roughness, result) for result in results)

    def vertices(self, patch: int) -> np.ndarray:
        """The mesh vertices of a patch.

        Args:
            patch: Its index in `patches`.

        Returns:
            int32 (patch vertices,), ascending.

        Raises:
            SliderError: There is no such patch.
        """
        return self._patch_array(lib.skinslide_slider_patch_vertices, patch, "vertex_count", np.int32)

    def faces(self, patch: int) -> np.ndarray:
        """The mesh faces of a patch.

        Args:
            patch: Its index in `patches`.

        Returns:
            int32 (patch faces,), ascending.

        Raises:
            SliderError: There is no such patch.
        """
        return self._patch_array(lib.skinslide_slider_patch_faces, patch, "face_count", np.int32)

    def neighbours(
        self, patch: int, points: npt.ArrayLike, others: npt.ArrayLike, tolerance: float = 0
    ) -> tuple[int, int]:
        """Counts the vertices of a patch that have a point of another mesh in their place.

        Args:
            patch: Its index in `patches`.
            points: Of the mesh, in some pose (V, 3).
            others: Of the other mesh in that pose, in the same space (n, 3).
            tolerance: The distance within which points are in one place.

        Returns:
            How many of them stay, and how many may slide, away from the other mesh.

        Raises:
            SliderError: There is no such patch, or points are not finite.
        """
        self._check_patch(patch)
        native, found = Arguments(), new("neighbours")
        own, other = native.points(points, self._sizes.vertices, "points"), native.points(others, -1, "others")
        count, within = len(np.asarray(others)), real(tolerance, "tolerance")
        call(lib.skinslide_slider_neighbours, self._slider.pointer, patch, own, other, count, within, found)
        return found.held, found.loose

    def embedding(self, patch: int) -> np.ndarray:
        """The rest embedding of a patch in the unit square.

        Args:
            patch: Its index in `patches`.

        Returns:
            float64 (patch vertices, 2).

        Raises:
            SliderError: There is no such patch, or its rule has no embedding.
        """
        return self._patch_array(lib.skinslide_slider_embedding, patch, "vertex_count", np.float64, 2)

    def id_buffer(self, points: npt.ArrayLike, patch: int) -> np.ndarray:
        """The texture of faces of the lookup egl for a frame.

        Args:
            points: Of the deformed mesh (V, 3).
            patch: Its index in `patches`.

        Returns:
            uint32 (side, side), rows from v = 0 on: 1 + patch face, 0 for none.

        Raises:
            SliderError: There is no such patch, or the slider's lookup or the patch's rule has no texture.
        """
        self._check_patch(patch)
        side = ffi.new("int32_t *")
        with self._slid(points) as (workspace, _):
            call(lib.skinslide_workspace_id_buffer, workspace.pointer, patch, side, ffi.NULL)
            texels = np.empty((side[0], side[0]), np.uint32)
            call(lib.skinslide_workspace_id_buffer, workspace.pointer, patch, side, writable("uint32_t[]", texels))
        return texels

    @contextmanager
    def _slid(self, points: npt.ArrayLike) -> Iterator[tuple[Handle, Any]]:
        """A workspace that has slid a frame with the set-ups' own controls, and the points that it slid."""
        native = Arguments()
        cached = native.points(points, self._sizes.vertices, "points")
        slid = ffi.new("float[]", 3 * self._sizes.vertices)
        with self._workspaces.taken() as workspace:
            call(lib.skinslide_slide, workspace.pointer, cached, ffi.NULL, slid, ffi.NULL)
            yield workspace, cached

    def _info(self, patch: int) -> PatchInfo:
        info = new("patch_info")
        call(lib.skinslide_slider_patch_info, self._slider.pointer, patch, info)
        return read(PatchInfo, info[0])

    def _check_patch(self, patch: int) -> None:
        if not 0 <= whole(patch, "patch") < len(self.patches):
            raise SliderError("BAD_ARGUMENT", f"there is no patch {patch}; patches are 0 to {len(self.patches) - 1}")

    def _patch_array(self, function: Any, patch: int, size: str, dtype: type, width: int | None = None) -> np.ndarray:
        self._check_patch(patch)
        count = getattr(self.patches[patch], size)
        array = np.empty(count if width is None else (count, width), dtype)
        call(function, self._slider.pointer, patch, writable("int32_t[]" if dtype == np.int32 else "double[]", array))
        return array

    def _frame_embeddings(self, workspace: Handle) -> tuple[np.ndarray, ...]:
        arrays = tuple(np.empty((patch.vertex_count, 2)) for patch in self.patches)
        for i, array in enumerate(arrays):
            call(lib.skinslide_workspace_embedding, workspace.pointer, i, writable("double[]", array))
        return arrays

    def _frame_turns(self, workspace: Handle, cached: Any) -> np.ndarray:
        turns = np.empty((self._sizes.vertices, 3), np.float32)
        call(lib.skinslide_workspace_turns, workspace.pointer, cached, writable("float[]", turns))
        return turns


def _create(_native: Arguments, mesh: Any, setups: Any, count: int, jobs: int) -> Handle:
    """Makes a slider, its set-ups on several threads. `_native` keeps alive the memory that the structs point into."""
    begun, out = ffi.new("skinslide_build **"), ffi.new("skinslide_slider **")
    call(lib.skinslide_build_create, ffi.addressof(mesh), setups, count, begun)
    build = Handle(begun[0], lib.skinslide_build_destroy)
    if jobs > 1:
        together(lambda setup: lib.skinslide_build_setup(build.pointer, setup), count, jobs)
    call(lib.skinslide_build_finish, build.pointer, out)
    return Handle(out[0], lib.skinslide_slider_destroy)
