"""Shot: two of the elbow's arms side by side, opened from one `.skinslide` file: one as cached, one whose skin slides.

`elbow.skinslide` is the elbow's stage by another name: the cache and a patch on it. `shot.usda` payloads it twice, and
`skinSlide:live:envelope` on each payloading prim is the share of the slide that is applied there. Nothing is baked:
points are computed when a frame is asked for. Play it with play.py, or open it in usdview from a Python that imports
skinslide.
"""

import sys
from pathlib import Path

from pxr import Sdf, UsdGeom

import skinslide  # noqa: F401 (registers the file format)

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from elbow.make import make as make_elbow
from makers.command import main
from makers.stage import FIRST_SHOT_FRAME, new_stage

ENVELOPES = {"stuck": 0.0, "slid": 1.0}
APART = 200.0  # cm


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    make_elbow(folder).replace(folder / "elbow.skinslide")
    stage = new_stage("World", FIRST_SHOT_FRAME)
    UsdGeom.Xform.Define(stage, "/World")
    for number, (name, envelope) in enumerate(ENVELOPES.items()):
        character = UsdGeom.Xform.Define(stage, f"/World/{name}")
        character.AddTranslateOp().Set((number * APART, 0, 0))
        character.GetPrim().GetPayloads().AddPayload("./elbow.skinslide")
        live = character.GetPrim().CreateAttribute(
            "skinSlide:live:envelope", Sdf.ValueTypeNames.Float, custom=True, variability=Sdf.VariabilityUniform
        )
        live.Set(envelope)
    stage.GetRootLayer().Export(str(folder / "shot.usda"))
    return folder / "shot.usda"


if __name__ == "__main__":
    main(make, __doc__)
