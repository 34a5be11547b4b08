"""Where a name is misspelt, a message lists what there is, and what is most like it first."""

import pytest
from pxr import Sdf, UsdGeom

import stages
from skinslide.command.cli import main
from skinslide.problems import in_place_of
from stages import MESH, PATCH

CAMERA, CURVE = "/World/shot_CAM", "/World/tendon_CRV"
AIM = f"--prim {MESH} --patch {PATCH}"
NEW = f"--prim {MESH} --patch other"
PRIMVARS = "there are elbowMask, bicepMask and tendon"
PINS = "there are bicep, bicepMask, elbow, tendon and elbowMask"
SUBSETS = "there are bicep and elbow"
MESHES = f"of type Mesh there are {MESH} and /World/hat_GEO"
COMMANDS = {
    "primvar": (f"setup shot.usda -o o.usda {NEW} --primvar ElbowMsk", f"no primvar ElbowMsk on the mesh; {PRIMVARS}"),
    "subset": (f"setup shot.usda -o o.usda {NEW} --subset biceps", f"no GeomSubset biceps under the mesh; {SUBSETS}"),
    "weight": (
        f"setup shot.usda -o o.usda {NEW} --faces 0-8 --weight elbowMas",
        f"no primvar elbowMas on the mesh; {PRIMVARS}",
    ),
    "pin": (f"setup shot.usda -o o.usda {NEW} --faces 0-8 --pin bicepp", f"nor a primvar bicepp on it; {PINS}"),
    "pin of any": ("setup shot.usda -o o.usda --whole --pin bicepp", f"GeomSubset or a primvar bicepp; {PINS}"),
    "mesh": (f"setup shot.usda -o o.usda --prim {MESH}s --patch other --faces 0-8", f"no such prim; {MESHES}"),
    "no mesh": (
        "setup shot.usda -o o.usda --prim /World --patch other --faces 0-8",
        "not a Mesh; of type Mesh there are /World/hat_GEO and ",
    ),
    "painted primvar": (f"paint shot.usda -o o.usda {AIM} --value 2 --primvar ElbowMsk", PRIMVARS),
    "painted subset": (f"paint shot.usda -o o.usda {AIM} --value 2 --subset biceps", SUBSETS),
    "painted patch": (
        f"paint shot.usda -o o.usda --prim {MESH} --patch elbw_L --value 2 --primvar tendon",
        f"no such patch on the mesh; there are {PATCH} and knee_L",
    ),
    "curve": (
        f"paint shot.usda -o o.usda {AIM} --value 2 --curve /World/tendon --within 1",
        f"curve /World/tendon: there is no such prim; of type BasisCurves there is {CURVE}",
    ),
    "no curve": (
        f"paint shot.usda -o o.usda {AIM} --value 2 --curve {CAMERA} --within 1",
        f"curve {CAMERA}: is a Camera, not a BasisCurves; of type BasisCurves there is {CURVE}",
    ),
    "mirrored patch": (
        f"mirror shot.usda -o o.usda --prim {MESH} --patch kne_L",
        f"no such patch on the mesh; there are knee_L and {PATCH}",
    ),
    "mesh of a bake": (f"bake shot.usda -o o.usda --prim {MESH}s", f"no such prim; {MESHES}"),
    "mesh of a check": (f"check shot.usda --prim {MESH}s", f"no such prim; {MESHES}"),
    "patch of pictures": ("preview shot.usda -o drawn --patch kne_L", f"no mesh has it; there are knee_L and {PATCH}"),
    "camera": (
        "preview shot.usda -o drawn --camera /World/shotcam",
        f"camera /World/shotcam: there is no such prim; of type Camera there is {CAMERA}",
    ),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    stage, mesh = stages.patched_stage()
    stages.add_patch(mesh, stages.block(6, range(2), range(2)), "knee_L")
    for name in ("bicep", "elbow"):
        UsdGeom.Subset.Define(stage, f"{MESH}/{name}").CreateIndicesAttr([7, 8])
    for name in ("bicepMask", "elbowMask", "tendon"):
        stages.set_primvar(mesh, name, Sdf.ValueTypeNames.FloatArray, "vertex", [1.0] * 49)
    UsdGeom.Mesh.Define(stage, "/World/hat_GEO")
    UsdGeom.Camera.Define(stage, CAMERA)
    UsdGeom.BasisCurves.Define(stage, CURVE)
    stages.save(stage, tmp_path / "shot.usda")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("command", "says"), COMMANDS.values(), ids=COMMANDS)
def test_what_there_is_is_listed(command, says, folder, capsys):
    assert main(command.split()) == 3
    assert says in "".join(capsys.readouterr())
    assert [each.name for each in folder.iterdir()] == ["shot.usda"]


@pytest.mark.parametrize(
    ("there", "says"),
    [
        ([], "there are none"),
        (["mask"], "there is mask"),
        (["hand", "arm", "knee"], "there are knee, hand and arm"),
        (map(str, range(100)), "there are 0, 1, 2, 3, 4, 5, 6, 7 and 92 more"),
    ],
)
def test_they_are_few_and_the_nearest_first(there, says):
    assert in_place_of("Kneee", there) == says
