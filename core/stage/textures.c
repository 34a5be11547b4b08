/* One map of a patch: an image, or the tiles of a UDIM, sampled at the mesh's texture coordinates. Files are the reader's to
 * find and to read: here is what they are asked for, and what they come to.
 *
 *     take (asset) ─► find_tiles (coordinates) ─► give (file) for each tile ─► values */
#include "stage.h"

#include "paint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char udim[] = "<UDIM>";
enum { LONGEST_TILE = 5 };                     /* digits of a number */
static const int64_t largest_file = 4LL << 30; /* bytes */

typedef struct held_image {
    char *path;
    skinslide_image *image;
} held_image;

typedef struct held_images {
    held_image *images;
    int32_t count;
} held_images;

struct ss_texture {
    const ss_input *input;
    const skinslide_stage_patch *patch;
    ss_memory memory; /* of the current asset */
    const char *name; /* of the attribute */
    const char *asset;
    int32_t *tiles; /* [tile_count], ascending; NULL: not known yet */
    int32_t tile_count, given, found, missing;
    skinslide_stage_need need;
    held_images held, before;
    int32_t times_taken;
    bool authored;
    float *values; /* [vertex_count], of memory of its own; NULL before the first asset */
    bool sampled;
    skinslide_stage_texture map;
};

/* ---- Life ---- */

static void destroy_images(held_images *held) {
    for (int32_t i = 0; i < held->count; i++) {
        free(held->images[i].path);
        skinslide_image_destroy(held->images[i].image);
    }
    free(held->images);
    *held = (held_images){0};
}

ss_texture *ss_texture_create(const ss_input *input, const skinslide_stage_patch *patch) {
    ss_texture *texture = calloc(1, sizeof *texture);
    if (texture)
        *texture = (ss_texture){.input = input, .patch = patch};
    return texture;
}

void ss_texture_destroy(ss_texture *texture) {
    if (!texture)
        return;
    destroy_images(&texture->held);
    destroy_images(&texture->before);
    ss_free(&texture->memory);
    free(texture->values);
    free(texture);
}

static void forget(ss_texture *texture) {
    ss_free(&texture->memory);
    texture->memory = (ss_memory){0};
    texture->asset = NULL, texture->tiles = NULL;
    texture->tile_count = texture->given = texture->found = 0, texture->missing = -1;
    texture->sampled = false;
}

void ss_texture_drop(ss_texture *texture) {
    forget(texture);
    destroy_images(&texture->held);
}

/* Goes on to another time, of whose files nothing is known; images of the time before are still held. */
static void pass_on(ss_texture *texture) {
    forget(texture);
    destroy_images(&texture->before);
    texture->before = texture->held, texture->held = (held_images){0};
    texture->times_taken++;
}

static skinslide_status copy_names(ss_texture *texture, const char *name, const char *asset, skinslide_error *error) {
    texture->name = ss_copy_text(&texture->memory, name);
    texture->asset = ss_copy_text(&texture->memory, asset);
    if (!texture->values)
        texture->values = calloc((size_t)texture->patch->mesh->vertex_count + 1, sizeof *texture->values);
    if (!texture->memory.failed && texture->values)
        return SKINSLIDE_OK;
    forget(texture);
    return ss_out_of_memory(error);
}

skinslide_status ss_texture_take(ss_texture *texture, const ss_record *record, skinslide_error *error) {
    char shown[256];
    const skinslide_value *value = &record->value;
    pass_on(texture);
    texture->authored = value->type != SKINSLIDE_VALUE_NONE;
    if (!ss_has_value(record))
        return SKINSLIDE_OK;
    if (value->type != SKINSLIDE_VALUE_ASSET || value->is_array)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " is %s; it must be an asset", SS_NAME(value->name),
                       ss_shown(record, shown));
    const char *path = value->data;
    return *path ? copy_names(texture, value->name, path, error) : SKINSLIDE_OK;
}

skinslide_status ss_texture_repeat(ss_texture *texture, const ss_texture *of, skinslide_error *error) {
    pass_on(texture);
    texture->authored = true;
    return copy_names(texture, of->name, of->asset, error);
}

bool ss_texture_authored(const ss_texture *texture) {
    return texture && texture->authored;
}

bool ss_texture_wanted(const ss_texture *texture) {
    return texture && texture->asset;
}

/* ---- Tiles ---- */

/* The patch's faces, or those of the whole mesh if it has none yet. */
static const int32_t *faces_of(const skinslide_stage_patch *patch, ss_memory *scratch, int32_t *count) {
    *count = patch->faces.count ? patch->faces.count : patch->mesh->taken[SS_ROW_FACE_COUNTS].array.count;
    if (patch->faces.count)
        return patch->faces.values;
    int32_t *all = SS_NEW(scratch, int32_t, *count);
    for (int32_t face = 0; all && face < *count; face++)
        all[face] = face;
    return all;
}

/* Reports an error of the core as one of the map. */
static skinslide_status of_map(const ss_texture *texture, const char *file, skinslide_status status,
                               const skinslide_error *inner, skinslide_error *error) {
    if (status == SKINSLIDE_OUT_OF_MEMORY)
        return ss_out_of_memory(error);
    return ss_fail(error, status, SS_NAMED ": " SS_FILED ": %s", SS_NAME(texture->name), SS_FILE(file), inner->message);
}

/* Lists the tiles that corners lie in, each once. */
static void list_tiles(ss_texture *texture, const int32_t *numbers, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        int32_t k = 0, number = numbers[i];
        while (k < texture->tile_count && texture->tiles[k] < number)
            k++;
        if (!number || (k < texture->tile_count && texture->tiles[k] == number))
            continue;
        memmove(texture->tiles + k + 1, texture->tiles + k, (size_t)(texture->tile_count - k) * sizeof *texture->tiles);
        texture->tiles[k] = number;
        texture->tile_count++;
    }
}

static skinslide_status find_udim_tiles(ss_texture *texture, const float *st, skinslide_error *error) {
    ss_memory scratch = {0};
    skinslide_error inner;
    skinslide_mesh mesh = ss_faces_of(texture->patch->mesh);
    int32_t face_count;
    const int32_t *faces = faces_of(texture->patch, &scratch, &face_count);
    int32_t *numbers = SS_NEW(&scratch, int32_t, mesh.index_count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(&inner) : SKINSLIDE_OK;
    if (!status)
        status = skinslide_texture_tiles(
            &(skinslide_texture_layout){sizeof(skinslide_texture_layout), &mesh, faces, face_count, st}, numbers, &inner);
    if (!status)
        list_tiles(texture, numbers, mesh.index_count);
    else
        status = of_map(texture, texture->asset, status, &inner, error);
    ss_free(&scratch);
    return status;
}

/* The path, in which a tile's number takes the place of <UDIM>. */
static const char *path_of_tile(ss_texture *texture, int32_t tile) {
    const char *found = strstr(texture->asset, udim);
    if (!found)
        return texture->asset;
    size_t size = strlen(texture->asset) + LONGEST_TILE + 1;
    char *path = SS_NEW(&texture->memory, char, (int64_t)size);
    if (path)
        snprintf(path, size, "%.*s%d%s", (int)(found - texture->asset), texture->asset, tile, found + strlen(udim));
    return path;
}

static skinslide_status ask_for_next(ss_texture *texture, skinslide_error *error) {
    if (texture->given == texture->tile_count)
        return SKINSLIDE_OK;
    int32_t tile = texture->tiles[texture->given];
    texture->need = (skinslide_stage_need){&texture->input->shown, path_of_tile(texture, tile), tile, largest_file};
    return texture->need.path ? SKINSLIDE_OK : ss_out_of_memory(error);
}

const skinslide_stage_need *ss_texture_need(const ss_texture *texture) {
    return texture && texture->tiles && texture->given < texture->tile_count ? &texture->need : NULL;
}

/* Begins anew: the same asset may get other coordinates, and then its files are asked for again. */
static void begin(ss_texture *texture) {
    if (texture->held.images) {
        destroy_images(&texture->before);
        texture->before = texture->held, texture->held = (held_images){0};
    }
    texture->given = texture->found = 0, texture->missing = -1;
    texture->sampled = false;
}

static skinslide_status find_tiles(ss_texture *texture, const float *st, skinslide_error *error) {
    begin(texture);
    bool is_udim = strstr(texture->asset, udim) != NULL;
    /* at most one tile for each corner */
    int32_t most = is_udim ? ss_faces_of(texture->patch->mesh).index_count : 1;
    texture->tile_count = is_udim ? 0 : 1;
    texture->tiles = SS_NEW(&texture->memory, int32_t, most);
    if (!texture->tiles)
        return ss_out_of_memory(error);
    skinslide_status status = is_udim ? find_udim_tiles(texture, st, error) : SKINSLIDE_OK;
    if (status)
        return status;
    texture->held.images = calloc((size_t)texture->tile_count + 1, sizeof *texture->held.images);
    return texture->held.images ? ask_for_next(texture, error) : ss_out_of_memory(error);
}

/* ---- Files ---- */

static held_image *find_held(held_images *held, const char *path) {
    for (int32_t i = 0; path && i < held->count; i++)
        if (held->images[i].path && strcmp(held->images[i].path, path) == 0)
            return &held->images[i];
    return NULL;
}

bool ss_texture_holds(const ss_texture *texture, const char *path) {
    held_images before = texture->before;
    return find_held(&before, path) != NULL;
}

static skinslide_status decode(const ss_texture *texture, const skinslide_stage_file *file, skinslide_image **image,
                               skinslide_error *error) {
    skinslide_error inner;
    const char *channel = texture->patch->taken[texture->input->channel].word;
    uint64_t size = file->byte_count > 0 ? (uint64_t)file->byte_count : 0;
    skinslide_status status = ss_check_most("has ", size, "bytes", (uint64_t)largest_file, SKINSLIDE_BAD_CONTROL, &inner);
    if (status)
        return of_map(texture, file->path, status, &inner, error);
    if (!file->bytes && !file->descriptor)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED ": " SS_FILED ": %s%s%.160s", SS_NAME(texture->name),
                       SS_FILE(file->path), skinslide_stage_phrase(SKINSLIDE_PHRASE_UNREADABLE), file->reason ? ": " : "",
                       file->reason ? file->reason : "");
    status = file->bytes ? skinslide_exr_decode(file->bytes, file->byte_count, channel, image, &inner)
                         : skinslide_exr_read(*file->descriptor, file->offset, file->byte_count, channel, image, &inner);
    return status ? of_map(texture, file->path, status, &inner, error) : SKINSLIDE_OK;
}

/* Holds the image of a file: that of the time before if it is the same file, else a decoded one. */
static skinslide_status hold(ss_texture *texture, const skinslide_stage_file *file, skinslide_error *error) {
    held_image *own = &texture->held.images[texture->held.count], *held = find_held(&texture->before, file->path);
    if (held) {
        *own = *held;
        *held = (held_image){0};
        texture->held.count++;
        return SKINSLIDE_OK;
    }
    own->path = calloc(strlen(file->path) + 1, 1);
    if (!own->path)
        return ss_out_of_memory(error);
    strcpy(own->path, file->path);
    texture->held.count++;
    return decode(texture, file, &own->image, error);
}

/* Fails: there is no file at all, or a tile is missing among others. */
static skinslide_status is_missing(ss_texture *texture, skinslide_error *error) {
    int32_t tile = texture->tiles[texture->missing];
    const char *missing = skinslide_stage_phrase(SKINSLIDE_PHRASE_NO_FILE);
    if (!tile || !texture->found)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED ": " SS_FILED ": %s", SS_NAME(texture->name),
                       SS_FILE(texture->asset), missing);
    const char *path = path_of_tile(texture, tile);
    if (!path)
        return ss_out_of_memory(error);
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED ": " SS_FILED ": %s, and the patch has texture coordinates in it",
                   SS_NAME(texture->name), SS_FILE(path), missing);
}

/* ---- Values ---- */

/* A tile's path, in which <UDIM> takes the place of its number again. */
static const char *shown_path(ss_texture *texture) {
    if (!texture->held.count)
        return texture->asset;
    const char *path = texture->held.images[0].path;
    char number[LONGEST_TILE + 8], *shown = SS_NEW(&texture->memory, char, (int64_t)(strlen(path) + sizeof udim));
    const char *found = NULL;
    snprintf(number, sizeof number, "%d", texture->tiles[0]);
    for (const char *at = path; texture->tiles[0] && (at = strstr(at, number)); at++)
        found = at;
    if (shown && found)
        snprintf(shown, strlen(path) + sizeof udim, "%.*s%s%s", (int)(found - path), path, udim, found + strlen(number));
    else if (shown)
        strcpy(shown, path);
    return shown;
}

static skinslide_status describe(ss_texture *texture, skinslide_error *error) {
    skinslide_stage_tile *tiles = SS_NEW(&texture->memory, skinslide_stage_tile, texture->held.count);
    const char *channel = texture->held.count ? texture->held.images[0].image->channel : "";
    texture->map = (skinslide_stage_texture){.name = texture->name,
                                             .file = shown_path(texture),
                                             .channel = ss_copy_text(&texture->memory, channel),
                                             .st = texture->patch->st,
                                             .tile_count = texture->held.count,
                                             .tiles = tiles};
    if (texture->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t i = 0; i < texture->held.count; i++) {
        const skinslide_image *image = texture->held.images[i].image;
        tiles[i] = (skinslide_stage_tile){texture->tiles[i], image->width, image->height};
    }
    return SKINSLIDE_OK;
}

/* Samples the map at the corners of the patch's faces; the values are 1 if it has no faces. */
static skinslide_status sample(ss_texture *texture, const float *st, skinslide_error *error) {
    ss_memory scratch = {0};
    skinslide_error inner;
    skinslide_mesh mesh = ss_faces_of(texture->patch->mesh);
    int32_t face_count;
    const int32_t *faces = faces_of(texture->patch, &scratch, &face_count);
    skinslide_texture_tile *tiles = SS_NEW(&scratch, skinslide_texture_tile, texture->held.count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(&inner) : SKINSLIDE_OK;
    for (int32_t i = 0; !status && i < texture->held.count; i++)
        tiles[i] = (skinslide_texture_tile){sizeof(skinslide_texture_tile), texture->held.images[i].image, texture->tiles[i]};
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        texture->values[v] = 1;
    if (!status && texture->held.count)
        status = skinslide_texture_sample(
            &(skinslide_texture_layout){sizeof(skinslide_texture_layout), &mesh, faces, face_count, st}, tiles,
            texture->held.count, texture->values, &inner);
    ss_free(&scratch);
    return status ? of_map(texture, texture->map.file, status, &inner, error) : SKINSLIDE_OK;
}

skinslide_status ss_texture_check(const ss_texture *texture, bool multiplied, int32_t vertex, float value,
                                  skinslide_error *error) {
    int32_t count, row = texture->input->multiplies;
    const ss_input *paint = &ss_inputs(SKINSLIDE_STAGE_CONTROLS, &count)[row];
    if (ss_in_range(paint->range, (double)value))
        return SKINSLIDE_OK;
    char name[256] = "";
    if (multiplied)
        ss_name_property(SKINSLIDE_STAGE_CONTROLS, row, texture->patch->name, name);
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "%s%s" SS_NAMED ": " SS_FILED " at point %d is %g; it must be %s", name,
                   multiplied ? " times " : "", SS_NAME(texture->name), SS_FILE(texture->map.file), vertex, (double)value,
                   paint->wanted);
}

static skinslide_status check_values(const ss_texture *texture, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t v = 0; v < texture->patch->mesh->vertex_count && !status; v++)
        status = ss_texture_check(texture, false, v, texture->values[v], error);
    return status;
}

static skinslide_status finish(ss_texture *texture, const float *st, skinslide_error *error) {
    if (texture->missing >= 0)
        return is_missing(texture, error);
    skinslide_status status = describe(texture, error);
    if (!status)
        status = sample(texture, st, error);
    if (!status)
        status = check_values(texture, error);
    texture->sampled = !status;
    destroy_images(&texture->before);
    if (texture->times_taken < 2) /* nobody knows yet that there is a next time */
        destroy_images(&texture->held);
    return status;
}

skinslide_status ss_texture_find_tiles(ss_texture *texture, const float *st, skinslide_error *error) {
    skinslide_status status = find_tiles(texture, st, error);
    if (!status && !texture->tile_count)
        status = finish(texture, st, error);
    if (status)
        ss_texture_drop(texture);
    return status;
}

skinslide_status ss_texture_give(ss_texture *texture, const float *st, const skinslide_stage_file *file,
                                 skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    if (file->path && texture->missing < 0)
        status = hold(texture, file, error);
    else if (!file->path && texture->missing < 0)
        texture->missing = texture->given;
    texture->found += file->path != NULL;
    texture->given++;
    if (!status)
        status = texture->given == texture->tile_count ? finish(texture, st, error) : ask_for_next(texture, error);
    if (status)
        ss_texture_drop(texture);
    return status;
}

const float *ss_texture_values(const ss_texture *texture) {
    return texture && texture->sampled ? texture->values : NULL;
}

const skinslide_stage_texture *ss_texture_shown(const ss_texture *texture) {
    return texture && texture->sampled ? &texture->map : NULL;
}
