/* Textures painted in a mesh's texture coordinates: bilinear samples at the corners of faces, as one value for each vertex. */
#include "paint.h"

#include <math.h>

/* Faces of a mesh, and where their corners begin. */
typedef struct corners {
    const skinslide_texture_layout *layout;
    int32_t *start; /* [mesh face_count + 1] */
} corners;

static skinslide_status check(const skinslide_texture_layout *layout, skinslide_error *error) {
    if (!layout->st || layout->face_count < 0 || (layout->face_count && !layout->faces))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no texture coordinates, or no faces");
    return ss_check_faces(layout->mesh->face_count, layout->faces, layout->face_count, error);
}

skinslide_status ss_check_st(const float st[2], int32_t face, skinslide_error *error) {
    if (isfinite(st[0]) && isfinite(st[1]))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "face %d has st (%g, %g)", face, st[0], st[1]);
}

skinslide_status ss_take_layout(const skinslide_texture_layout **layout, ss_taken_layout *own, skinslide_error *error) {
    own->layout = (skinslide_texture_layout)SKINSLIDE_TEXTURE_LAYOUT_DEFAULT;
    if (!*layout)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no layout");
    skinslide_status status = ss_take(*layout, "skinslide_texture_layout", &own->layout, sizeof own->layout, error);
    *layout = &own->layout;
    if (!status)
        status = ss_take_mesh(&own->layout.mesh, &own->mesh, error);
    return status ? status : check(*layout, error);
}

static skinslide_status list_corners(const skinslide_texture_layout *layout, ss_memory *memory, corners *out,
                                     skinslide_error *error) {
    const skinslide_mesh *mesh = layout->mesh;
    *out = (corners){layout, SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1)};
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t f = 0; f < mesh->face_count; f++)
        out->start[f + 1] = out->start[f] + mesh->face_counts[f];
    return SKINSLIDE_OK;
}

/* ---- Tiles ---- */

/* The tile that a coordinate is in, as a whole number; on a border, the one on the side of the middle. */
static double tile_of(double coordinate, double middle) {
    double whole = floor(coordinate);
    return whole == coordinate && middle < whole ? whole - 1 : whole;
}

/* The tile of every corner of a face, in tiles [index_count]. */
static skinslide_status face_tiles(const corners *c, int32_t face, int32_t *tiles, skinslide_error *error) {
    double middle[2] = {0, 0};
    int32_t begin = c->start[face], end = c->start[face + 1];
    for (int32_t i = begin; i < end; i++) {
        const float *st = c->layout->st + 2 * (int64_t)i;
        skinslide_status status = ss_check_st(st, face, error);
        if (status)
            return status;
        middle[0] += (double)st[0] / (end - begin), middle[1] += (double)st[1] / (end - begin);
    }
    for (int32_t i = begin; i < end; i++) {
        const float *st = c->layout->st + 2 * (int64_t)i;
        double column = tile_of(st[0], middle[0]), row = tile_of(st[1], middle[1]);
        if (column < 0 || column >= SS_TILE_COLUMNS || row < 0 || row >= SS_TILE_ROWS)
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "face %d has st (%g, %g), which is in no UDIM tile", face, st[0],
                           st[1]);
        tiles[i] = SS_FIRST_TILE + (int32_t)column + SS_TILE_COLUMNS * (int32_t)row;
    }
    return SKINSLIDE_OK;
}

skinslide_status skinslide_texture_tiles(const skinslide_texture_layout *layout, int32_t *tiles, skinslide_error *error) {
    ss_taken_layout taken;
    skinslide_status status = ss_take_layout(&layout, &taken, error);
    if (status || !tiles)
        return status ? status : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the tiles");
    ss_memory memory = {0};
    corners c;
    int32_t *found = SS_NEW(&memory, int32_t, layout->mesh->index_count);
    status = list_corners(layout, &memory, &c, error);
    for (int32_t i = 0; !status && i < layout->face_count; i++)
        status = face_tiles(&c, layout->faces[i], found, error);
    for (int32_t i = 0; !status && i < layout->mesh->index_count; i++)
        tiles[i] = found[i];
    ss_free(&memory);
    return status;
}

/* ---- Samples ---- */

/* The texel that a wrap puts at a place along a side of count texels; -1: black. */
static double wrapped(double place, int32_t count, skinslide_wrap wrap) {
    if (place >= 0 && place < count)
        return place;
    if (wrap == SKINSLIDE_WRAP_BLACK)
        return -1;
    if (wrap == SKINSLIDE_WRAP_CLAMP)
        return place < 0 ? 0 : count - 1;
    double period = wrap == SKINSLIDE_WRAP_MIRROR ? 2.0 * count : count;
    double within = fmod(place, period);
    within += within < 0 ? period : 0;
    return within < count ? within : period - 1 - within;
}

/* The two texels about a coordinate, in texels from the first one's centre, and the share of the second. */
static double texels_about(double coordinate, int32_t count, skinslide_wrap wrap, double texels[2]) {
    double place = coordinate * count - 0.5, first = floor(place);
    texels[0] = wrapped(first, count, wrap);
    texels[1] = wrapped(first + 1, count, wrap);
    return place - first;
}

/* A texel of weight 0 does not count, even if it is NaN. */
static double sample(const skinslide_image *image, double s, double t) {
    double columns[2], rows[2], sum = 0;
    double share_s = texels_about(s, image->width, image->wrap_s, columns);
    double share_t = texels_about(1 - t, image->height, image->wrap_t, rows);
    for (int k = 0; k < 4; k++) {
        double column = columns[k & 1], row = rows[k >> 1];
        double share = (k & 1 ? share_s : 1 - share_s) * (k >> 1 ? share_t : 1 - share_t);
        if (share > 0 && column >= 0 && row >= 0)
            sum += share * image->pixels[(int64_t)row * image->width + (int64_t)column];
    }
    return sum;
}

static const skinslide_texture_tile *find_tile(const skinslide_texture_tile *tiles, int32_t tile_count, int32_t number) {
    for (int32_t k = 0; k < tile_count; k++)
        if (tiles[k].number == number || tiles[k].number == 0)
            return &tiles[k];
    return NULL;
}

/* The texture beyond the border of a numbered tile is another tile's, so its image is clamped whatever the file says. */
static double sample_tile(const skinslide_texture_tile *tile, const float st[2]) {
    if (tile->number == 0)
        return sample(tile->image, st[0], st[1]);
    skinslide_image image = *tile->image;
    image.wrap_s = image.wrap_t = SKINSLIDE_WRAP_CLAMP;
    int32_t place = tile->number - SS_FIRST_TILE;
    return sample(&image, st[0] - (double)(place % SS_TILE_COLUMNS), st[1] - (double)(place / SS_TILE_COLUMNS));
}

/* Adds the samples of a face's corners to their vertices: sum and count. */
static skinslide_status sample_face(const corners *c, int32_t face, const int32_t *numbers, const skinslide_texture_tile *tiles,
                                    int32_t tile_count, double (*sums)[2], skinslide_error *error) {
    for (int32_t i = c->start[face]; i < c->start[face + 1]; i++) {
        const float *st = c->layout->st + 2 * (int64_t)i;
        skinslide_status status = ss_check_st(st, face, error);
        if (status)
            return status;
        const skinslide_texture_tile *tile = find_tile(tiles, tile_count, numbers[i]);
        if (!tile)
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "face %d has st (%g, %g), but there is no tile %d", face, st[0], st[1],
                           numbers[i]);
        double value = sample_tile(tile, st);
        if (!isfinite((float)value))
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "the map is %g at st (%g, %g), on face %d",
                           isnan(value) ? (double)NAN : value, st[0], st[1], face);
        int32_t vertex = c->layout->mesh->face_indices[i];
        sums[vertex][0] += value, sums[vertex][1] += 1;
    }
    return SKINSLIDE_OK;
}

static skinslide_status check_tile(const skinslide_texture_tile *tile, int32_t k, int32_t tile_count, skinslide_error *error) {
    const skinslide_image *image = tile->image;
    bool numbered = tile->number >= SS_FIRST_TILE && tile->number < SS_FIRST_TILE + SS_TILE_COLUMNS * SS_TILE_ROWS;
    if (!numbered && (tile->number != 0 || tile_count != 1))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "tile %d has the number %d", k, tile->number);
    if (!image || image->width < 1 || image->height < 1 || !image->pixels || (unsigned)image->wrap_s > SKINSLIDE_WRAP_BLACK ||
        (unsigned)image->wrap_t > SKINSLIDE_WRAP_BLACK)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "tile %d has no image", k);
    return SKINSLIDE_OK;
}

/* The caller's tiles with their images: own and images are [tile_count]. */
static skinslide_status take_tiles(const skinslide_texture_tile *tiles, int32_t tile_count, skinslide_texture_tile *own,
                                   skinslide_image *images, skinslide_error *error) {
    const skinslide_texture_tile standard = SKINSLIDE_TEXTURE_TILE_DEFAULT;
    skinslide_status status = ss_take_all(tiles, tile_count, "skinslide_texture_tile", own, sizeof *own, &standard, error);
    for (int32_t k = 0; k < tile_count && !status; k++) {
        images[k] = (skinslide_image)SKINSLIDE_IMAGE_DEFAULT;
        status = ss_take(own[k].image, "skinslide_image", &images[k], sizeof *images, error);
        own[k].image = own[k].image ? &images[k] : NULL;
        if (!status)
            status = check_tile(&own[k], k, tile_count, error);
    }
    return status;
}

/* skinslide_texture_sample, once the tiles are taken. */
static skinslide_status sample_all(const skinslide_texture_layout *layout, const skinslide_texture_tile *tiles,
                                   int32_t tile_count, float *values, ss_memory *memory, skinslide_error *error) {
    corners c;
    int32_t *numbers = SS_NEW(memory, int32_t, layout->mesh->index_count);
    double(*sums)[2] = ss_new(memory, layout->mesh->vertex_count, sizeof *sums);
    skinslide_status status = list_corners(layout, memory, &c, error);
    for (int32_t i = 0; !status && tiles[0].number && i < layout->face_count; i++)
        status = face_tiles(&c, layout->faces[i], numbers, error);
    for (int32_t i = 0; !status && i < layout->face_count; i++)
        status = sample_face(&c, layout->faces[i], numbers, tiles, tile_count, sums, error);
    for (int32_t v = 0; !status && v < layout->mesh->vertex_count; v++)
        values[v] = sums[v][1] > 0 ? (float)(sums[v][0] / sums[v][1]) : 1;
    return status;
}

skinslide_status skinslide_texture_sample(const skinslide_texture_layout *layout, const skinslide_texture_tile *tiles,
                                          int32_t tile_count, float *values, skinslide_error *error) {
    ss_taken_layout taken;
    skinslide_status status = ss_take_layout(&layout, &taken, error);
    if (status || !values || !tiles || tile_count < 1)
        return status ? status : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, values ? "no tiles" : "no place for the values");
    ss_memory memory = {0};
    skinslide_texture_tile *own = SS_NEW(&memory, skinslide_texture_tile, tile_count);
    skinslide_image *images = SS_NEW(&memory, skinslide_image, tile_count);
    status = memory.failed ? ss_out_of_memory(error) : take_tiles(tiles, tile_count, own, images, error);
    if (!status)
        status = sample_all(layout, own, tile_count, values, &memory, error);
    ss_free(&memory);
    return status;
}
