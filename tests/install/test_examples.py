"""The example stages: what each promises of its cache, its patch and its opinions. No slid result is looked at here."""

import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdValidation

import skinslide
from repository import EXAMPLES, load
from skinslide.stage.reading import read_moving

MESH_PATH = "/World/char/geo/body_GEO"
# Example → its patch, and how many boundary loops that has: eyes, nostrils and mouth are holes of the face.
PATCHES = {
    "elbow": ("elbow_L", 1),
    "fine_elbow": ("elbow_L", 1),
    "bicep": ("bicep_L", 1),
    "face": ("face", 6),
    "finger": ("index_L", 1),
    "sleeve": ("sleeve_L", 2),
    "chequer": ("sheet", 1),
    "bump": ("sheet", 1),
}
REST_PRIMVARS = {"bicep": "rest", "face": "Pref", "finger": "pref", "sleeve": "__Pref"}
FLEXED = ("elbow", "fine_elbow", "sleeve", "bicep")
# Faces and points of the examples that are not MakeHuman's body as it comes.
SIZES = {"fine_elbow": (53512, 53514), "chequer": (4096, 4225), "bump": (1024, 1089)}


class Made:
    """One example, made and opened, with what the tests read from it as arrays."""

    def __init__(self, name: str, path: Path):
        self.name, self.path = name, path
        self.patch_name, self.loop_count = PATCHES[name]
        self.stage = Usd.Stage.Open(str(self.path))
        self.prim = self.stage.GetPrimAtPath(MESH_PATH)
        self.mesh = UsdGeom.Mesh(self.prim)
        self.primvars = UsdGeom.PrimvarsAPI(self.prim)
        self.faces = np.array(self.mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 4)
        self.times = self.mesh.GetPointsAttr().GetTimeSamples()

    def points(self, time: float) -> np.ndarray:
        return np.array(self.mesh.GetPointsAttr().Get(time))

    def rest(self) -> np.ndarray:
        if self.name in REST_PRIMVARS:
            return np.array(self.primvars.GetPrimvar(REST_PRIMVARS[self.name]).Get())
        return np.array(self.mesh.GetPointsAttr().Get())

    def region(self) -> np.ndarray:
        """The patch's faces, read by the rules of the schema, as a bool mask."""
        paint = self.primvars.GetPrimvar(f"skinSlide:{self.patch_name}:patch")
        if paint.HasValue():
            values = np.array(paint.Get()) > 0
            return values if paint.GetInterpolation() == UsdGeom.Tokens.uniform else values[self.faces].all(axis=1)
        subset = UsdGeom.Subset(self.stage.GetPrimAtPath(f"{MESH_PATH}/{self.patch_name}"))
        assert subset.GetElementTypeAttr().Get() == UsdGeom.Tokens.face
        mask = np.zeros(len(self.faces), dtype=bool)
        mask[np.array(subset.GetIndicesAttr().Get())] = True
        return mask


@pytest.fixture(scope="session")
def made(example_stage):
    """Makes and opens each example once, when a test first asks for it by name."""
    found = {}

    def get(name: str) -> Made:
        if name not in found:
            found[name] = Made(name, example_stage(name))
        return found[name]

    return get


@pytest.fixture(params=PATCHES)
def example(request, made) -> Made:
    return made(request.param)


def boundary_edges(quads: np.ndarray) -> dict[int, list[int]]:
    """Boundary points and the boundary points that follow each, by counting how many quads use each edge."""
    uses = defaultdict(list)
    for quad in quads.tolist():
        for a, b in zip(quad, quad[1:] + quad[:1], strict=True):
            uses[frozenset((a, b))].append((a, b))
    follows = defaultdict(list)
    for directed in uses.values():
        assert len(directed) <= 2, "an edge has three faces"
        if len(directed) == 1:
            follows[directed[0][0]].append(directed[0][1])
    return follows


def count_pieces(quads: np.ndarray) -> int:
    """How many edge-connected pieces the quads fall into."""
    at_edge, pieces = defaultdict(list), 0
    for face, quad in enumerate(quads.tolist()):
        for a, b in zip(quad, quad[1:] + quad[:1], strict=True):
            at_edge[frozenset((a, b))].append(face)
    touching = defaultdict(set)
    for sharing in at_edge.values():
        for face in sharing:
            touching[face].update(sharing)
    left = set(range(len(quads)))
    while left:
        pieces, front = pieces + 1, [left.pop()]
        while front:
            reached = touching[front.pop()] & left
            left -= reached
            front.extend(reached)
    return pieces


def test_the_cache_lies_under_a_payload_with_an_offset(example):
    assert example.prim.IsA(UsdGeom.Mesh)
    payload = example.stage.GetRootLayer().GetPrimAtPath("/World/char").payloadList.prependedItems[0]
    assert payload.assetPath == "./cache.usdc" and payload.layerOffset.offset == 1000
    cache = Usd.Stage.Open(str(example.path.with_name("cache.usdc")))
    prim = cache.GetPrimAtPath(MESH_PATH.removeprefix("/World"))
    assert UsdGeom.Mesh(prim).GetPointsAttr().GetTimeSamples() == list(range(1, 25))
    # The set-up is the shot's, not the cache's.
    assert not [name for name in prim.GetPropertyNames() if "skinSlide" in name]


def test_samples_lie_at_the_shot_s_frames(example):
    stage = example.stage
    assert example.times == list(range(1001, 1025)) == example.mesh.GetExtentAttr().GetTimeSamples()
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (1001, 1024)
    assert stage.GetTimeCodesPerSecond() == 24
    assert stage.GetDefaultPrim().GetPath() == "/World"
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 0.01


def test_every_sample_has_finite_points_within_its_extent(example):
    count = int(example.faces.max()) + 1
    for time in example.times:
        points = example.points(time)
        assert points.shape == (count, 3) and np.isfinite(points).all()
        low, high = example.mesh.GetExtentAttr().Get(time)
        # Extent is the minimum and maximum of those same floats.
        assert (points.min(axis=0) == low).all() and (points.max(axis=0) == high).all()


def test_the_first_frame_is_the_rest_pose_and_later_ones_move(example):
    rest = example.rest()
    # A metre or so from the origin a float is good to 1e-5 cm, and a skinned point is the sum of a few.
    np.testing.assert_allclose(example.points(1001), rest, atol=1e-4)
    patch_points = np.unique(example.faces[example.region()])
    assert np.linalg.norm(example.points(1012)[patch_points] - rest[patch_points], axis=1).max() > 0.5


def test_st_covers_every_corner_inside_the_unit_square(example):
    st = example.primvars.GetPrimvar("st")
    assert st.GetTypeName().cppTypeName == "VtArray<GfVec2f>" and st.GetInterpolation() == UsdGeom.Tokens.faceVarying
    corners = np.array(st.ComputeFlattened())
    assert corners.shape == (example.faces.size, 2)
    assert corners.min() >= 0 and corners.max() <= 1
    quads = corners.reshape(-1, 4, 2)[example.region()]
    (ax, ay), (bx, by) = (quads[:, 2] - quads[:, 0]).T, (quads[:, 3] - quads[:, 1]).T
    assert (np.abs(ax * by - ay * bx) > 0).all(), "a face of the patch has no texture to stretch"


def test_the_subdivision_scheme_is_the_production_one(example):
    expected = UsdGeom.Tokens.none if example.name == "chequer" else UsdGeom.Tokens.catmullClark
    assert example.mesh.GetSubdivisionSchemeAttr().Get() == expected
    assert not example.mesh.GetNormalsAttr().IsAuthored()


def test_the_schema_is_applied_once_under_the_patch_s_name(example):
    applied = example.prim.GetMetadata("apiSchemas").GetAppliedItems()
    assert [item for item in applied if item.startswith("SkinSlideAPI")] == [f"SkinSlideAPI:{example.patch_name}"]


def test_the_patch_is_a_connected_disk_with_the_right_holes(example):
    quads = example.faces[example.region()]
    assert count_pieces(quads) == 1
    follows = boundary_edges(quads)
    assert all(len(after) == 1 for after in follows.values()), "the boundary touches itself"
    after, loops = {a: b[0] for a, b in follows.items()}, 0
    while after:
        at, loops = next(iter(after)), loops + 1
        while at in after:
            at = after.pop(at)
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edge_count = len(np.unique(edges, axis=0))
    assert loops == example.loop_count
    # V - E + F = 2 - 2 genus - loops.
    assert len(np.unique(quads)) - edge_count + len(quads) == 2 - example.loop_count, "the patch has a handle"


def test_the_human_keeps_its_faces(example):
    assert (len(example.faces), len(example.rest())) == SIZES.get(example.name, (13378, 13380))


def test_points_outside_the_region_of_the_slide_have_no_weight(made):
    bicep = made("bicep")
    weight = np.array(bicep.primvars.GetPrimvar("skinSlide:bicep_L:weight").Get())
    quads = bicep.faces[bicep.region()]
    assert weight.min() == 0 and weight.max() == 1
    assert set(np.flatnonzero(weight)) <= set(quads.ravel().tolist()) - set(boundary_edges(quads))


@pytest.mark.parametrize("name", ["chequer", "bump"])
def test_the_sheet_s_corners_are_its_corners(made, name):
    sheet = made(name)
    corners = list(sheet.prim.GetAttribute("skinSlide:sheet:corners").Get())
    # Anticlockwise seen from above, which is from the left-front corner to the right, then to the back.
    assert sheet.rest()[corners].tolist() == [[-50, 0, 50], [50, 0, 50], [50, 0, -50], [-50, 0, -50]]


@pytest.mark.parametrize("name", FLEXED)
def test_the_arm_bends_towards_the_shoulder(made, name):
    """The skin at the wrist comes nearer to the shoulder at every frame, and stays as far from the elbow."""
    arm, maker = made(name), load("elbow/make.py")
    points = maker.makehuman.read_mesh().points + maker.makehuman.read_offsets(maker.makehuman.YOUNG_MAN)
    joints = maker.left_arm(points)
    wrist = int(np.linalg.norm(arm.rest() - joints.wrist, axis=1).argmin())
    path = np.array([arm.points(time)[wrist] for time in arm.times])
    assert (np.diff(np.linalg.norm(path - joints.shoulder, axis=1)) < 0).all()
    # The wrist turns rigidly with the forearm: what is left is the rounding of points to float.
    reach = np.linalg.norm(path - joints.elbow, axis=1)
    np.testing.assert_allclose(reach, reach[0], atol=1e-4)


def test_the_same_bytes_every_time(made, tmp_path):
    elbow = made("elbow")
    load("elbow/make.py").make(tmp_path)
    for name in ("cache.usdc", "stage.usda"):
        assert (tmp_path / name).read_bytes() == elbow.path.with_name(name).read_bytes()


def test_usd_s_own_validation_finds_nothing(example):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert validators
    errors = UsdValidation.ValidationContext(validators).Validate(example.stage)
    assert [f"{error.GetName()}: {error.GetMessage()}" for error in errors] == []


def test_the_command_makes_its_folder_and_names_the_stage(tmp_path):
    script, folder = EXAMPLES / "chequer/make.py", tmp_path / "new" / "folder"
    ran = subprocess.run([sys.executable, script, folder], capture_output=True, text=True, check=True)
    assert ran.stdout == f"{folder / 'stage.usda'}\n"
    assert {path.name for path in folder.iterdir()} == {"cache.usdc", "stage.usda"}


def test_without_the_data_the_command_says_how_to_get_it(tmp_path):
    script = EXAMPLES / "elbow/make.py"
    hide = f"import pathlib, runpy, sys; sys.path.insert(0, {str(EXAMPLES)!r})\n"
    hide += f"from makers import fetch; fetch.FOLDER = pathlib.Path({str(tmp_path / 'nowhere')!r})\n"
    hide += f"sys.argv = ['make.py', {str(tmp_path / 'out')!r}]; runpy.run_path({str(script)!r}, run_name='__main__')"
    ran = subprocess.run([sys.executable, "-c", hide], capture_output=True, text=True)
    assert ran.returncode == 1
    assert ran.stderr.count("\n") == 1 and f"python {EXAMPLES / 'makers/fetch.py'}" in ran.stderr
    assert not (tmp_path / "out").exists()


def test_the_shot_plays_live(tmp_path):
    path = load("shot/make.py").make(tmp_path)
    played = subprocess.run(
        [sys.executable, EXAMPLES / "shot/play.py", path], capture_output=True, text=True, check=True
    )
    *frames, half = [line.split() for line in played.stdout.splitlines()]
    assert [int(cells[0]) for cells in frames] == list(range(1001, 1025))
    slides = [float(cells[1]) for cells in frames]
    assert slides[0] == 0 and slides[-1] > 0.5
    # With one arm halfway they are about half as far apart.
    assert float(half[1]) == pytest.approx(slides[-1] / 2, rel=0.2)


# ---- With nothing painted ----


@pytest.mark.parametrize("name", ["body", "fingers", "trunk", "torus"])
def test_a_shot_that_nobody_painted(name, example_stage, tmp_path):
    """It is no set-up before `setup --whole`, and then each patch stretches less, with nothing folded."""
    shot, output = example_stage(name), tmp_path / "stage.usda"
    stage = Usd.Stage.Open(str(shot))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH_PATH))
    assert shot.name == "shot.usda" and not mesh.GetPrim().GetAppliedSchemas()
    points = mesh.GetPointsAttr()
    assert np.array_equal(np.array(points.Get()), np.array(points.Get(1001)))
    (checked,) = skinslide.setup_to_file(shot, output, whole=True).meshes
    assert {patch.name for patch in checked.patches} == {"skin"}
    assert len(checked.patches) == (4 if name == "body" else 1)
    report = skinslide.bake_to_file(output, tmp_path / "slid.usdc", frames="1012" if name == "torus" else "1024")
    for patch in report.meshes[0].patches:
        (result,) = patch.results
        assert result.stretch_after < 0.85 * result.stretch_before and result.folded_faces == 0


@pytest.mark.parametrize(("name", "handles"), [("trunk", 0), ("torus", 1)])
def test_bodies_that_are_closed(name, handles, example_stage):
    """Every edge has two faces that run it opposite ways, and faces look outwards."""
    stage = Usd.Stage.Open(str(example_stage(name)))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH_PATH))
    points, faces = np.array(mesh.GetPointsAttr().Get()), np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 4)
    sides = [tuple(side) for face in faces.tolist() for side in zip(face, face[1:] + face[:1], strict=True)]
    assert len(set(sides)) == len(sides) and {side[::-1] for side in sides} == set(sides)
    assert len(points) - len(sides) // 2 + len(faces) == 2 - 2 * handles
    a, b, c, d = (points[faces[:, k]].astype(np.float64) for k in range(4))
    assert np.einsum("ij,ij->i", a, np.cross(b - a, c - a) + np.cross(c - a, d - a)).sum() > 0


# ---- Skinned by UsdSkel ----


def test_the_character_is_what_an_exporter_would_write(example_stage):
    stage = Usd.Stage.Open(str(example_stage("character")))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH_PATH))
    points, normals = np.array(mesh.GetPointsAttr().Get()), np.array(mesh.GetNormalsAttr().Get())
    places, which = np.unique(points, axis=0, return_inverse=True)
    assert not mesh.GetPointsAttr().GetTimeSamples() and not mesh.GetPrim().HasAPI("SkinSlideAPI")
    assert len(points) == len(normals) == 14517 and len(places) == 13380
    first = np.unique(which.ravel(), return_index=True)[1]
    np.testing.assert_array_equal(normals, normals[first][which.ravel()])  # one in one place


def test_the_character_bends_as_the_elbow_does(example_stage, made):
    """Skinned by USD as by the maker of the cache, but for a few points of more joints than it has."""
    stage, elbow = Usd.Stage.Open(str(example_stage("character"))), made("elbow")
    mesh = read_moving(stage.GetPrimAtPath(MESH_PATH))
    for frame in (1001, 1024):
        ours, its = mesh.points_at(Usd.TimeCode(frame)), elbow.points(frame)
        nearest = np.sort(np.unique(ours, axis=0), axis=0) - np.sort(np.unique(its, axis=0), axis=0)
        assert np.abs(nearest).max() < 0.05  # cm


def test_the_character_set_up_by_a_joint_plays_as_it_is_baked(example_stage, tmp_path):
    shot, folder = example_stage("character"), tmp_path / "character"
    shutil.copytree(shot.parent, folder)
    report = skinslide.setup_to_file(
        folder / "shot.usda", folder / "stage.usda", MESH_PATH, "elbow_L", joint="lowerarm01_L"
    )
    assert report.meshes[0].welded > 0
    baked = skinslide.bake_to_file(folder / "stage.usda", folder / "slid.usdc")
    skinslide.cache(folder / "stage.usda", folder / "skinned.usdc")
    worst = baked.meshes[0].patches[0]
    assert worst.change < -0.3 and worst.column("folded_faces").max() == 0
    play = [sys.executable, EXAMPLES / "character/play.py", folder]
    *_, same, skinned = subprocess.run(play, capture_output=True, text=True, check=True).stdout.splitlines()
    assert same == "live as baked, to the bit: 24 of 24 frames"
    assert skinned == "skinned by UsdSkel: 1 mesh of the character, 0 below its bake"


@pytest.mark.parametrize("script", ["normals", "surface"])
def test_what_is_measured_of_the_character(script, example_stage, tmp_path):
    shot, output = example_stage("character"), tmp_path / "character" / "stage.usda"
    output.parent.mkdir()
    skinslide.setup_to_file(shot, output, MESH_PATH, "elbow_L", joint="lowerarm01_L")
    measure = [sys.executable, EXAMPLES / f"measure/{script}.py", output]
    (*_, cells) = subprocess.run(measure, capture_output=True, text=True, check=True).stdout.splitlines()
    name, *numbers = cells.split()
    assert name == "character"
    if script == "normals":
        largest, turned, jump, seams, slid_seams = map(float, numbers)
        assert largest > 1 and turned > 1 and (jump, seams, slid_seams) == (0, 0, 0)
    else:
        assert int(numbers[0]) > 100 and float(numbers[2]) < 1e-4 and int(numbers[3]) == 0
