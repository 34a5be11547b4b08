"""Rows of the tables: stages by what is special about each, made as a .skinslide file and what is below it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import stages
from edits import Edit, Scene, nothing, text
from readers import save
from stages import MESH, PATCH

# How a .skinslide file leaves to the bake what it cannot read.
CANNOT_READ = "which a .skinslide file cannot read; bake the stage instead"


@dataclass(frozen=True)
class Good:
    """A stage that slides."""

    name: str
    edit: Edit = nothing
    shape: Callable[[], stages.Shape] = stages.grid
    faces: Callable[[], np.ndarray] | None = None
    rest: str = "points"  # see stages.add_mesh
    file: str | None = text()  # of the .skinslide file; None: the stage itself
    slides: bool = True  # whether anything moves
    blocked: tuple[str, ...] = ()  # attributes of the mesh that are blocked
    warns: str = ""  # part of what both say
    refuses: str = ""  # what a .skinslide file says of what it cannot read; the bake can


@dataclass(frozen=True)
class Bad:
    """A stage that cannot be slid."""

    name: str
    edit: Edit
    says: str  # {folder}: where the stage is; of a sentence that ends in "..." only how it begins is known
    patch: str | None = PATCH  # None: the mesh as a whole is to blame
    frame: str | None = None  # only there does it show
    prim: str = MESH
    shape: Callable[[], stages.Shape] = stages.grid
    faces: Callable[[], np.ndarray] | None = None
    rest: str = "points"
    file: str | None = text()
    may_slide: bool = False  # a layer says so, and may slide what it can


def named(table: Iterable[Good | Bad]) -> list:
    """The rows of a table as parameters."""
    return [pytest.param(row, id=row.name) for row in table]


def made(row: Good | Bad, folder: Path) -> Path:
    """The .skinslide file of a row, and what is below it."""
    stage, mesh = stages.patched_stage(row.shape(), row.faces() if row.faces else None, rest=row.rest)
    scene = Scene(folder, stage, mesh)
    row.edit(scene)
    return save(scene, row.file)
