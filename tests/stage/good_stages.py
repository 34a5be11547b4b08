"""The table of stages that slide. Baked, and opened as a .skinslide file, they are the same bytes."""

import good_derived
import good_even
import good_meshes
import good_paint
import good_settings
import good_textures

GOOD = [
    *good_meshes.CHOSEN,
    *good_meshes.POINTS,
    *good_meshes.FAULTS,
    *good_meshes.REST,
    *good_meshes.TIMES,
    *good_settings.CONTROLS,
    *good_settings.SETTINGS,
    *good_paint.PAINT,
    *good_textures.TEXTURES,
    *good_derived.DERIVED,
    *good_even.EVEN,
]
