/* Takes and checks the looks of a figure, target by target. */
#include "canvas.h"

#include "paint.h"

#include <math.h>

enum { MOST_TILES = 1000 };

skinslide_status ss_check_scale(float lowest, float highest, skinslide_error *error) {
    float range = highest - lowest;
    if (range > 0 && isnormal(range) && isnormal(1 / range))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a scale from %g to %g", (double)lowest, (double)highest);
}

static skinslide_status check_values(const ss_drawing *drawn, const skinslide_look *look, skinslide_error *error) {
    if (!look->values && !(drawn->figure->squares > 0 && isfinite(drawn->figure->squares)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a chequer of %g squares", (double)drawn->figure->squares);
    skinslide_status status = look->values ? ss_check_scale(look->lowest, look->highest, error) : SKINSLIDE_OK;
    for (int32_t v = 0; look->values && v < drawn->mesh->mesh_vertex_count && !status; v++)
        status = ss_check_value(v, look->values[v], error);
    return status;
}

static skinslide_status check_tile(const ss_drawing *drawn, const skinslide_colour_tile *tile, skinslide_error *error) {
    int32_t most = drawn->canvas->largest_texture;
    if (drawn->mesh->in_space)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "there is no st for the tiles of a texture");
    if (!tile->pixels || tile->number < SS_FIRST_TILE || tile->number >= SS_FIRST_TILE + SS_TILE_COLUMNS * SS_TILE_ROWS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "tile %d has no pixels, or no place in a UDIM", tile->number);
    if (tile->width < 1 || tile->height < 1 || tile->width > most || tile->height > most)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "tile %d has %d by %d pixels; each side may have 1 to %d", tile->number,
                       tile->width, tile->height, most);
    return SKINSLIDE_OK;
}

static skinslide_status take_tiles(ss_drawing *drawn, ss_target_look *look, skinslide_error *error) {
    const skinslide_colour_tile standard = SKINSLIDE_COLOUR_TILE_DEFAULT;
    int32_t count = look->own.tile_count;
    if (count < 0 || count > MOST_TILES || (count > 0 && !look->own.tiles))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%d tiles of a texture; there may be 0 to %d", count, MOST_TILES);
    look->tiles = SS_NEW(&drawn->work.memory, skinslide_colour_tile, count);
    look->textures = SS_NEW(&drawn->work.memory, GLuint, count);
    if (drawn->work.memory.failed)
        return ss_out_of_memory(error);
    skinslide_status status =
        ss_take_all(look->own.tiles, count, "skinslide_colour_tile", look->tiles, sizeof *look->tiles, &standard, error);
    for (int32_t i = 0; i < count && !status; i++)
        status = check_tile(drawn, &look->tiles[i], error);
    return status;
}

skinslide_status ss_take_looks(ss_drawing *drawn, skinslide_error *error) {
    const skinslide_figure *figure = drawn->figure;
    const skinslide_look standard = SKINSLIDE_LOOK_DEFAULT;
    skinslide_look others[SKINSLIDE_MOST_TARGETS];
    int32_t most = drawn->canvas->targets - 1;
    if (figure->other_count < 0 || figure->other_count > most || (figure->other_count > 0 && !figure->others))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%d other looks; the canvas has targets for %d", figure->other_count,
                       most);
    skinslide_status status =
        ss_take_all(figure->others, figure->other_count, "skinslide_look", others, sizeof *others, &standard, error);
    drawn->look_count = 1 + figure->other_count;
    for (int32_t i = 0; i < drawn->look_count && !status; i++) {
        const skinslide_look first = {sizeof first,    figure->values, figure->lowest,
                                      figure->highest, figure->tiles,  figure->tile_count};
        drawn->looks[i].own = i ? others[i - 1] : first;
        status = check_values(drawn, &drawn->looks[i].own, error);
        if (!status)
            status = take_tiles(drawn, &drawn->looks[i], error);
    }
    return status;
}
