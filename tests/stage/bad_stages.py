"""The table of stages that cannot be slid, each with the sentence that both readers say of it."""

import bad_even
import bad_meshes
import bad_settings
import bad_textures
import bad_types

BAD = [
    *bad_meshes.FINDING,
    *bad_meshes.CHOSEN,
    *bad_meshes.GEOMETRY,
    *bad_types.TYPES,
    *bad_settings.CONTROLS,
    *bad_settings.SETTINGS,
    *bad_textures.TEXTURES,
    *bad_even.EVEN,
]
