"""What a slide did by vertex: primvars of a bake with diagnostics, and numbers worked out anew with numpy."""

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdValidation, Vt

import skinslide
import stages
from skinslide import Controls, PatchSetup, Slider, SliderError, StageProblems, bake, bake_to_file, stitch
from skinslide.command.cli import main
from skinslide.stage.opening import open_stage
from stages import FRAMES, MESH

STRETCH, SLIDE = "primvars:skinSlide:stretch", "primvars:skinSlide:slide"
LARGEST, SMALLEST = "primvars:skinSlide:largestStretch", "primvars:skinSlide:smallestStretch"
AREA, DIRECTION = "primvars:skinSlide:areaRatio", "primvars:skinSlide:stretchDirection"
OTHER = "/World/prop/still_GEO"
PLACES = ["root", "session"]
Types = Sdf.ValueTypeNames


def edges_of(faces: np.ndarray) -> np.ndarray:
    """The edges of some faces of the sheet, (k, 2), each once."""
    sheet = stages.grid()
    corners = sheet.indices.reshape(-1, 4)[faces]
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    return np.unique(np.sort(sides, axis=1), axis=0)


def stretch_of(edges: np.ndarray, points: np.ndarray) -> np.ndarray:
    """RMS of log(length / rest length) over the edges at each vertex of the sheet."""
    rest, points = stages.grid().points.astype(np.float64), points.astype(np.float64)
    lengths = [np.linalg.norm(pose[edges[:, 0]] - pose[edges[:, 1]], axis=1) for pose in (points, rest)]
    squares, count = np.zeros(len(rest)), np.zeros(len(rest))
    for end in edges.T:
        np.add.at(squares, end, np.log(lengths[0] / lengths[1]) ** 2)
        np.add.at(count, end, 1)
    return np.sqrt(squares / np.maximum(count, 1))


def overlapping_stage() -> tuple[Usd.Stage, UsdGeom.Mesh, list[np.ndarray]]:
    """Two patches that share a column of faces and leave one out."""
    faces = [stages.block(6, range(0, 3), range(6)), stages.block(6, range(2, 5), range(6))]
    stage, mesh = stages.patched_stage(faces=faces[0])
    stages.add_patch(mesh, faces[1], "other")
    return stage, mesh, faces


def samples(path, name: str, mesh: str = MESH) -> dict[float, np.ndarray]:
    layer, at = Sdf.Layer.OpenAsAnonymous(str(path)), f"{mesh}.{name}"
    return {time: np.array(layer.QueryTimeSample(at, time)) for time in layer.ListTimeSamplesForPath(at)}


# ---- The numbers ----


def test_primvars_against_numpy(tmp_path):
    stage, mesh, faces = overlapping_stage()
    bake_to_file(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "slid.usdc", diagnostics=True)
    edges = edges_of(np.unique(np.concatenate(faces)))
    points, found = samples(tmp_path / "slid.usdc", "points"), samples(tmp_path / "slid.usdc", STRETCH)
    slides = samples(tmp_path / "slid.usdc", SLIDE)
    assert list(found) == list(slides) == list(FRAMES)
    for frame in FRAMES:
        cached = np.asarray(mesh.GetPointsAttr().Get(frame))
        # Rounded to float; stretch is up to 1.
        np.testing.assert_allclose(found[frame], stretch_of(edges, points[frame]), atol=1e-6)
        distance = np.linalg.norm(points[frame].astype(np.float64) - cached, axis=1)
        np.testing.assert_allclose(slides[frame], distance, rtol=1e-6, atol=1e-12)
    assert found[FRAMES[2]].max() > 0.05 and slides[FRAMES[2]].max() > 0.01
    outside = np.setdiff1d(np.arange(49), edges)
    assert outside.size and not found[FRAMES[2]][outside].any()


def test_rest_gives_zeros_bit_for_bit(tmp_path):
    stage, _mesh, _faces = overlapping_stage()
    bake_to_file(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "slid.usdc", diagnostics=True)
    for name in (STRETCH, SLIDE):
        assert samples(tmp_path / "slid.usdc", name)[FRAMES[0]].tobytes() == bytes(4 * 49)


def test_strain_of_a_uniform_stretch(tmp_path):
    """The envelope is 0, so that skin stays in the cache, which is stretched by known factors along two ways at an
    angle: in st, which is turned against the sheet, the larger's angle is less by the turn."""
    (large, small), angle, turn = (1.5, 0.8), 0.7, 0.4
    shape = stages.grid()
    stage, mesh = stages.patched_stage(shape)
    ways = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0]])
    stretch = large * np.outer(ways[0], ways[0]) + small * np.outer(ways[1], ways[1])
    flat = shape.points * [1, 1, 0]
    mesh.GetPointsAttr().Set(stages.vectors(flat))
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(stages.vectors(flat @ stretch if frame > FRAMES[0] else flat), frame)
    stages.set_property(mesh, "envelope", 0.0)
    across = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    st = Vt.Vec2fArray.FromNumpy((flat[shape.indices][:, :2] @ across).astype(np.float32))
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "faceVarying", st)
    output = tmp_path / "slid.usdc"
    bake_to_file(stages.save(stage, tmp_path / "shot.usda"), output, diagnostics=True)
    for name, value in ((LARGEST, large), (SMALLEST, small), (AREA, large * small)):
        found = samples(output, name)
        np.testing.assert_allclose(found[FRAMES[0]], 1, atol=1e-6)
        np.testing.assert_allclose(found[FRAMES[1]], value, rtol=1e-5)
    directions = samples(output, DIRECTION)
    expected = [np.cos(2 * (angle - turn)), np.sin(2 * (angle - turn))]
    np.testing.assert_allclose(directions[FRAMES[1]], np.tile(expected, (len(shape.indices), 1)), atol=1e-4)
    assert not directions[FRAMES[0]].any()
    layer = Sdf.Layer.OpenAsAnonymous(str(output))
    spec = layer.GetAttributeAtPath(f"{MESH}.{DIRECTION}")
    assert (spec.typeName, spec.GetInfo("interpolation")) == (Types.Float2Array, "faceVarying")


def test_without_texture_coordinates_there_is_no_direction(tmp_path):
    stage, _mesh, _faces = overlapping_stage()
    bake_to_file(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "slid.usdc", diagnostics=True)
    layer = Sdf.Layer.OpenAsAnonymous(str(tmp_path / "slid.usdc"))
    assert layer.GetAttributeAtPath(f"{MESH}.{LARGEST}") and not layer.GetAttributeAtPath(f"{MESH}.{DIRECTION}")


def test_texture_coordinates_that_cannot_be(tmp_path, capfd):
    stage, mesh, _faces = overlapping_stage()
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "faceVarying", Vt.Vec2fArray(3))
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["bake", path, "-o", str(tmp_path / "slid.usdc"), "--diagnostics"]) == 3
    assert f"error: {MESH}: " in capfd.readouterr().err and not (tmp_path / "slid.usdc").exists()


def test_density_against_numpy():
    """Two patches painted differently: at a vertex each one's mean over its edges, then the mean of both."""
    sheet, dice = stages.grid(), np.random.default_rng(2)
    _stage, _mesh, faces = overlapping_stage()
    paint = [dice.uniform(0.2, 5, 49).astype(np.float32) for _ in faces]
    setups = [
        PatchSetup(name, chosen, controls=Controls(vertex_density=painted))
        for name, chosen, painted in zip("ab", faces, paint, strict=True)
    ]
    slider = Slider(sheet.counts, sheet.indices, sheet.points, setups)
    means = []
    for chosen, painted in zip(faces, paint, strict=True):
        sums, count, edges = np.zeros(49), np.zeros(49), edges_of(chosen)
        for end in edges.T:
            np.add.at(sums, end, painted.astype(np.float64)[edges].mean(axis=1))
            np.add.at(count, end, 1)
        means.append(np.where(count > 0, sums / np.maximum(count, 1), np.nan))
    covered = np.isfinite(means)
    both = np.where(covered.any(axis=0), np.nansum(means, axis=0) / np.maximum(covered.sum(axis=0), 1), 1)
    found = slider.diagnose(sheet.points, sheet.points)
    np.testing.assert_allclose(found.force_density, both, rtol=1e-6)
    one = slider.diagnose(sheet.points, sheet.points, chosen=[False, True])
    np.testing.assert_allclose(one.force_density, np.nan_to_num(means[1], nan=1), rtol=1e-6)
    plain = slider.diagnose(sheet.points, sheet.points, [Controls(), Controls()])
    assert (plain.force_density == 1).all()


def test_bad_arrays():
    sheet = stages.grid()
    slider = Slider(sheet.counts, sheet.indices, sheet.points, [PatchSetup("a", sheet.all_faces)])
    with pytest.raises(SliderError, match="slid: the shape is 48 x 3"):
        slider.diagnose(sheet.points, sheet.points[:-1])
    with pytest.raises(SliderError, match="chosen: 2 given for 1 patches"):
        slider.diagnose(sheet.points, sheet.points, chosen=[True, True])
    with pytest.raises(SliderError, match="controls: 0 given for 1 patches"):
        slider.diagnose(sheet.points, sheet.points, [])


# ---- In a layer ----


def test_beside_the_points(tmp_path):
    """The rest of the layer is as without diagnostics, and USD finds nothing wrong with it."""
    stage, _mesh, _faces = overlapping_stage()
    shot = stages.save(stage, tmp_path / "shot.usda")
    plain, measured = tmp_path / "plain.usda", tmp_path / "slid.usda"
    bake_to_file(shot, plain)
    assert main(["bake", str(shot), "-o", str(measured), "--diagnostics", "--quiet"]) == 0
    layer = Sdf.Layer.OpenAsAnonymous(str(measured))
    over = layer.GetPrimAtPath(MESH)
    for name in (STRETCH, SLIDE, LARGEST, SMALLEST, AREA):
        spec = layer.GetAttributeAtPath(f"{MESH}.{name}")
        assert (spec.typeName, spec.GetInfo("interpolation")) == (Types.FloatArray, "vertex")
        over.RemoveProperty(spec)
    other = Sdf.Layer.OpenAsAnonymous(str(plain))
    layer.customLayerData = other.customLayerData  # which says that it was asked for
    assert layer.ExportToString() == other.ExportToString()
    composed = Usd.Stage.CreateInMemory()
    composed.GetRootLayer().subLayerPaths = [str(measured), str(shot)]
    primvar = UsdGeom.PrimvarsAPI(composed.GetPrimAtPath(MESH)).GetPrimvar("skinSlide:stretch")
    assert len(primvar.Get(FRAMES[2])) == 49 and primvar.GetInterpolation() == "vertex"
    opened = Usd.Stage.Open(str(measured))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = UsdValidation.ValidationContext(validators).Validate(opened)
    assert [error.GetMessage() for error in errors if "skinSlide" in error.GetMessage()] == []


def test_a_mesh_without_samples(tmp_path):
    stage = stages.new_stage()
    still = stages.add_mesh(stage, stages.grid(), OTHER, frames=[], rest="Pref")
    still.GetPointsAttr().Set(stages.vectors(stages.grid().moved(FRAMES[2])))
    stages.add_patch(still, stages.annulus())
    shot = stages.save(stage, tmp_path / "shot.usda")
    bake_to_file(shot, tmp_path / "slid.usda", diagnostics=True)
    layer = Sdf.Layer.OpenAsAnonymous(str(tmp_path / "slid.usda"))
    points = np.array(layer.GetAttributeAtPath(f"{OTHER}.points").default)
    found = np.array(layer.GetAttributeAtPath(f"{OTHER}.{STRETCH}").default)
    np.testing.assert_allclose(found, stretch_of(edges_of(stages.annulus()), points), atol=1e-6)


def test_the_same_on_any_number_of_threads_and_in_chunks(tmp_path):
    stage, _mesh, _faces = overlapping_stage()
    shot = stages.save(stage, tmp_path / "shot.usda")
    bake_to_file(shot, tmp_path / "one.usda", diagnostics=True)
    bake_to_file(shot, tmp_path / "many.usda", diagnostics=True, jobs=4)
    assert (tmp_path / "one.usda").read_text() == (tmp_path / "many.usda").read_text()
    chunks = [tmp_path / "a.usda", tmp_path / "b.usda"]
    for chunk, frames in zip(chunks, ("1001", "1002-1003"), strict=True):
        bake_to_file(shot, chunk, frames=frames, diagnostics=True)
    stitch(chunks, tmp_path / "stitched.usda")
    assert (tmp_path / "stitched.usda").read_text() == (tmp_path / "one.usda").read_text()


def test_chunks_with_and_without_do_not_fit(tmp_path):
    stage, _mesh, _faces = overlapping_stage()
    shot = stages.save(stage, tmp_path / "shot.usda")
    chunks = [tmp_path / "a.usda", tmp_path / "b.usda"]
    bake_to_file(shot, chunks[0], frames="1001", diagnostics=True)
    bake_to_file(shot, chunks[1], frames="1002-1003")
    with pytest.raises(StageProblems, match=f"{SLIDE} is in {chunks[0]}, not in both"):
        stitch(chunks, tmp_path / "stitched.usda")
    assert not (tmp_path / "stitched.usda").exists()


# ---- On a stage ----


def edited(where: str) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    stage, mesh, _faces = overlapping_stage()
    if where == "session":
        stage.SetEditTarget(stage.GetSessionLayer())
    return stage, mesh


def texts(stage: Usd.Stage) -> list[str]:
    return [layer.ExportToString() for layer in stage.GetLayerStack()]


@pytest.mark.parametrize("where", PLACES)
def test_bakes_over_bakes(where, tmp_path):
    stage, mesh = edited(where)
    bake(stage, diagnostics=True)
    bake_to_file(stages.save(overlapping_stage()[0], tmp_path / "shot.usda"), tmp_path / "slid.usdc", diagnostics=True)
    for name in (STRETCH, SLIDE):
        attribute, expected = mesh.GetPrim().GetAttribute(name), samples(tmp_path / "slid.usdc", name)
        assert {time: np.array(attribute.Get(time)).tobytes() for time in attribute.GetTimeSamples()} == {
            time: value.tobytes() for time, value in expected.items()
        }
        assert attribute.GetMetadata("interpolation") == "vertex"
    once = texts(stage)
    bake(stage, diagnostics=True)
    assert texts(stage) == once
    bake(stage)
    assert not mesh.GetPrim().HasAttribute(STRETCH) and not mesh.GetPrim().HasAttribute(SLIDE)
    never, _ = edited(where)
    bake(never)
    assert texts(stage) == texts(never)


@pytest.mark.parametrize("where", PLACES)
def test_a_primvar_of_that_name_comes_back(where):
    stage, mesh = edited("root")
    stages.set_primvar(mesh, "skinSlide:stretch", Types.FloatArray, "uniform", [0.5] * 36)
    if where == "session":
        stage.SetEditTarget(stage.GetSessionLayer())
    bake(stage, diagnostics=True)
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skinSlide:stretch")
    assert primvar.GetInterpolation() == "vertex" and len(primvar.Get(FRAMES[1])) == 49
    bake(stage)
    assert primvar.GetInterpolation() == "uniform" and list(primvar.Get(FRAMES[1])) == [0.5] * 36


def indexed_stage() -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A cache that has stretch of its own, one value for all faces, by index."""
    stage, mesh = edited("root")
    stages.set_primvar(mesh, "skinSlide:stretch", Types.FloatArray, "uniform", [0.5])
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skinSlide:stretch").SetIndices([0] * 36)
    return stage, mesh


def assert_by_vertex(mesh: UsdGeom.Mesh) -> None:
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skinSlide:stretch")
    for frame in FRAMES:
        assert len(primvar.ComputeFlattened(frame)) == 49
        assert list(primvar.ComputeFlattened(frame)) == list(mesh.GetPrim().GetAttribute(STRETCH).Get(frame))


@pytest.mark.parametrize("where", PLACES)
def test_indices_of_a_primvar_of_that_name(where):
    """They would choose among the values that the bake writes, so they go with what they chose from, and come back."""
    stage, mesh = indexed_stage()
    if where == "session":
        stage.SetEditTarget(stage.GetSessionLayer())
    bake(stage, diagnostics=True)
    assert_by_vertex(mesh)
    bake(stage, diagnostics=True)
    assert_by_vertex(mesh)
    bake(stage)
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skinSlide:stretch")
    assert list(primvar.ComputeFlattened(FRAMES[1])) == [0.5] * 36


def test_indices_of_a_primvar_of_that_name_below_a_layer(tmp_path):
    """In one bake, and in chunks that are stitched together."""
    stage, _mesh = indexed_stage()
    shot = stages.save(stage, tmp_path / "shot.usda")
    bake_to_file(shot, tmp_path / "whole.usda", diagnostics=True)
    for chunk, frames in ("a", "1001"), ("b", "1002-1003"):
        bake_to_file(shot, tmp_path / f"{chunk}.usda", diagnostics=True, frames=frames)
    stitch([tmp_path / "a.usda", tmp_path / "b.usda"], tmp_path / "stitched.usda")
    assert (tmp_path / "whole.usda").read_bytes() == (tmp_path / "stitched.usda").read_bytes()
    opened = Usd.Stage.Open(str(shot))
    opened.GetSessionLayer().subLayerPaths.append(str(tmp_path / "whole.usda"))
    assert_by_vertex(UsdGeom.Mesh(opened.GetPrimAtPath(MESH)))


@pytest.mark.parametrize("where", PLACES)
@pytest.mark.parametrize("baked", [False, True])
def test_a_bake_that_fails_leaves_nothing(where, baked, monkeypatch):
    stage, _mesh = edited(where)
    if baked:
        bake(stage, diagnostics=True)
    before, authored = texts(stage), Usd.Attribute.Set

    def fail(self, *arguments):
        if self.GetName() == STRETCH:
            raise KeyboardInterrupt
        return authored(self, *arguments)

    monkeypatch.setattr(Usd.Attribute, "Set", fail)
    with pytest.raises(KeyboardInterrupt):
        bake(stage, diagnostics=True)
    assert texts(stage) == before


@pytest.mark.parametrize("baker", ["file", "stage"])
def test_a_primvar_of_another_type(baker, tmp_path):
    stage, mesh = edited("root")
    stages.set_primvar(mesh, "skinSlide:slide", Types.DoubleArray, "vertex", [0.5] * 49)
    shot, before = stages.save(stage, tmp_path / "shot.usda"), texts(stage)
    with pytest.raises(StageProblems, match=f"{MESH}: {SLIDE} is double\\[\\]; a bake with diagnostics writes float"):
        if baker == "file":
            bake_to_file(shot, tmp_path / "out.usda", diagnostics=True)
        else:
            bake(stage, diagnostics=True)
    assert texts(stage) == before and not (tmp_path / "out.usda").exists()
    bake_to_file(shot, tmp_path / "out.usda")


@pytest.mark.parametrize("what", ["a relationship", "of elementSize 3"])
def test_what_no_primvar_can_be_written_over(what, tmp_path):
    stage, mesh = edited("root")
    if what == "a relationship":
        mesh.GetPrim().CreateRelationship(SLIDE)
    else:
        UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("skinSlide:slide", Types.FloatArray, "vertex", 3).Set([0.5] * 147)
    shot = stages.save(stage, tmp_path / "shot.usda")
    with pytest.raises(StageProblems, match=f"{MESH}: {SLIDE} is {what}; a bake with diagnostics writes"):
        bake_to_file(shot, tmp_path / "out.usda", diagnostics=True)
    assert not (tmp_path / "out.usda").exists()


def test_through_a_skinslide_file(tmp_path):
    """Baked from such a file, and into the session layer above its text, several times."""
    stage, _mesh = stages.patched_stage()
    stages.save(stage, tmp_path / "cache.usda")
    expected = tmp_path / "expected.usdc"
    bake_to_file(tmp_path / "cache.usda", expected, diagnostics=True)
    text = '#usda 1.0\n(timeCodesPerSecond = 24; subLayers = [@./cache.usda@])\nover "World" {}\n'
    (tmp_path / "x.skinslide").write_text(text)
    bake_to_file(tmp_path / "x.skinslide", tmp_path / "slid.usdc", diagnostics=True)
    opened = open_stage(tmp_path / "x.skinslide")
    opened.SetEditTarget(opened.GetSessionLayer())
    bake(opened, diagnostics=True)
    prim = opened.GetPrimAtPath(MESH)
    for name in ("points", STRETCH, SLIDE):
        for time, value in samples(expected, name).items():
            assert samples(tmp_path / "slid.usdc", name)[time].tobytes() == value.tobytes()
            assert np.array(prim.GetAttribute(name).Get(time)).tobytes() == value.tobytes()
    after = texts(opened)
    bake(opened, diagnostics=True)
    assert texts(opened) == after


def test_names_are_no_patches():
    stage, mesh = edited("root")
    bake(stage, diagnostics=True)
    report = skinslide.check(stage)
    assert not any("not applied" in str(problem) for problem in report.problems)
    stages.add_patch(mesh, stages.annulus(), "stretch")
    bake(stage, diagnostics=True)
    assert len(mesh.GetPrim().GetAttribute(STRETCH).Get(FRAMES[1])) == 49
