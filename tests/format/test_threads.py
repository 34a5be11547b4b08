"""Threads may open, read and drop stages with `.skinslide` layers, whatever lock of Python or of USD they hold."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Tf, UsdGeom, Vt

from layers import HEAD, make, open_mesh, points, said, write
from repository import ROOT
from stages import FRAMES, grid, patched_stage, save, vectors

PROGRAM = Path(__file__).parent / "open_and_drop.py"


# A hang takes Python's lock with it, so it shows from outside only. For longer: open_and_drop.py by hand.
@pytest.mark.parametrize("threads", [2, 3, 8])
def test_threads_that_open_and_drop_do_not_hang(tmp_path, threads):
    done = subprocess.run(
        [sys.executable, PROGRAM, tmp_path, str(threads), "3", "--listen"],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests" / "support")},
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[0]) > threads


def other_rate(folder: Path) -> Path:
    stage, _ = patched_stage(grid())
    stage.SetTimeCodesPerSecond(30)
    save(stage, folder / "cache.usda")
    return write(folder / "x.skinslide", head='defaultPrim = "World"')


def by_expression(folder: Path) -> Path:
    make(folder)
    head = f'{HEAD}; expressionVariables = {{ string CACHE = "cache" }}'
    return write(folder / "x.skinslide", head=head, cache='`"./${CACHE}.usda"`')


def above_another(folder: Path) -> Path:
    make(folder)
    return write(folder / "above.skinslide", cache="./x.skinslide")


def with_all_that_is_derived(folder: Path) -> Path:
    def edit(mesh: UsdGeom.Mesh) -> None:
        mesh.CreateNormalsAttr(vectors(np.tile([0, 0, 1], (49, 1))))
        for frame in FRAMES:
            mesh.CreateVelocitiesAttr().Set(vectors(np.ones((49, 3))), frame)
        mesh.CreateAccelerationsAttr().Set(Vt.Vec3fArray(49), 1001)

    return make(folder, edit, over="float3[] extent = [(0, 0, 0), (1, 1, 1)]")


@pytest.mark.parametrize("lay", [make, other_rate, by_expression, above_another, with_all_that_is_derived])
def test_what_is_opened_is_not_announced(tmp_path, lay: Callable[[Path], Path]):
    """Whoever announces frees dead listeners, and waits for Python's lock with that of all listeners."""
    path, heard = lay(tmp_path), []
    key = Tf.Notice.RegisterGlobally(Sdf.Notice.Base, lambda notice, _sender: heard.append(type(notice).__name__))
    with said():
        _stage, mesh = open_mesh(path)
        assert len(points(mesh, mesh.GetPointsAttr().GetTimeSamples()[1])) == 49
    assert heard == []
    key.Revoke()


def test_a_reload_announces_the_layer_that_is_reloaded_alone(tmp_path):
    layer, heard = Sdf.Layer.FindOrOpen(str(make(tmp_path))), []
    key = Tf.Notice.RegisterGlobally(Sdf.Notice.LayersDidChange, lambda notice, _: heard.extend(notice.GetLayers()))
    assert layer.Reload(force=True)
    assert set(heard) == {layer}
    key.Revoke()
