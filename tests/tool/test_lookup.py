"""Both lookups through the tool: the same bytes of every example at every resolution; what `check` says."""

import json

import numpy as np
import pytest

import skinslide
import stages
from repository import load
from skinslide import Lookup, SliderError
from skinslide.command.cli import main

NAMES = ("elbow", "bicep", "face", "finger", "sleeve", "chequer")
SIDES = (256, 512, 1024, 2048, 4096)


@pytest.fixture(scope="module")
def tool():
    return load("measure/lookup.py")


@pytest.fixture
def shot(tmp_path):
    stage, _mesh = stages.patched_stage()
    return stages.save(stage, tmp_path / "shot.usda")


@pytest.mark.parametrize("name", NAMES)
def test_examples_have_the_same_bytes_at_every_resolution(name, tool, example_stage):
    mesh = tool.open_mesh(example_stage(name))
    exact = [frame.points.tobytes() for frame in tool.frames(mesh, "exact")]
    for side in SIDES:
        found = np.zeros(4, int)
        for frame, expected in zip(tool.frames(mesh, Lookup("egl", resolution=side)), exact, strict=True):
            assert frame.points.tobytes() == expected
            assert not any(patch.lost_textures for patch in frame.patches)
            found += [sum(getattr(patch, field) for patch in frame.patches) for field in tool.FOUND]
        shares = 100 * found / found.sum()
        print(f"{name} at {side}: centre {shares[0]:.2f} %, 3x3 {shares[1]:.2f} %, walked {shares[2]:.2f} %")
        # From here on few faces are below a texel; what is left are thin wedges.
        assert side < 1024 or shares[2] + shares[3] < 2


def test_a_bake_is_the_same(shot, tmp_path):
    for lookup in ("egl", "exact", "auto"):
        assert main(["bake", str(shot), "-o", str(tmp_path / f"{lookup}.usda"), "--quiet", "--lookup", lookup]) == 0
    layers = {(tmp_path / f"{lookup}.usda").read_bytes() for lookup in ("egl", "exact", "auto")}
    assert len(layers) == 1


def test_check_says_what_it_chose(shot, capfd):
    device = skinslide.choose_lookup("egl")
    assert main(["check", str(shot)]) == 0
    said = capfd.readouterr().out
    assert ("lookup exact: no hardware EGL device" if device.software else "lookup egl\n") in said
    for words in (device.device_name, device.renderer, device.driver):
        assert words in said
    assert main(["check", str(shot), "--lookup", "egl", "--json"]) == 0
    told = json.loads(capfd.readouterr().out)["lookup"]
    assert (told["lookup"], told["renderer"], told["driver"]) == ("egl", device.renderer, device.driver)


def test_the_device_comes_from_the_environment(shot, monkeypatch, capfd):
    command = ["check", str(shot), "--lookup", "egl"]
    monkeypatch.setenv("SKINSLIDE_EGL_DEVICE", "999")
    assert main(command) == 2
    assert "there is no EGL device 999" in capfd.readouterr().err
    assert main([*command, "--egl-device", "0"]) == 0
    monkeypatch.setenv("SKINSLIDE_EGL_DEVICE", "first")
    assert main(command) == 2
    assert "SKINSLIDE_EGL_DEVICE: 'first' is not a whole number" in capfd.readouterr().err
    monkeypatch.setenv("SKINSLIDE_EGL_DEVICE", "")
    assert main(command) == 0


def test_auto_is_predictable():
    """What auto leads to follows from the device, and does not change."""
    device = skinslide.choose_lookup("egl")
    chosen = {skinslide.choose_lookup("auto") for _ in range(3)}
    assert [info.lookup for info in chosen] == ["exact" if device.software else "egl"]
    assert skinslide.choose_lookup("exact").lookup == "exact"


@pytest.mark.parametrize("lookup", ["auto", "egl", "exact"])
def test_a_slider_says_what_it_chose(lookup, tool, example_stage):
    slider = tool.open_mesh(example_stage("chequer")).slider(Lookup(lookup))
    assert slider.lookup() == skinslide.choose_lookup(lookup)


@pytest.mark.parametrize("lookup", [Lookup("egl", resolution=-1), Lookup("egl", device=-2), Lookup("guess")])
def test_lookups_that_cannot_be(lookup):
    with pytest.raises(SliderError) as error:
        skinslide.choose_lookup(lookup)
    assert error.value.status == "BAD_ARGUMENT"


def test_id_buffer_is_of_the_faces(tool, example_stage):
    mesh = tool.open_mesh(example_stage("chequer"))
    slider = mesh.slider(Lookup("egl", resolution=256))
    texels = slider.id_buffer(mesh.rest_points, 0)
    assert texels.shape == (256, 256)
    # The sheet is a grid of 64 x 64 squares, which rest in the unit square as they are: 4 x 4 texels each.
    assert (np.unique(texels, return_counts=True)[1] == 16).all() and len(np.unique(texels)) == 64 * 64
    with pytest.raises(SliderError, match="exact"):
        mesh.slider("exact").id_buffer(mesh.rest_points, 0)
