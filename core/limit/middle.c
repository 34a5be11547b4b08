/* Where the middle of a face is looked up. With a plane, at the mean of its corners' queries; without one, by a walk over rest
 * from its own place, as far as its corners went on average. It stays if all of them do. */
#include "limit.h"

#include <stdlib.h>

struct ss_middles {
    ss_memory memory;
    const ss_patch *patch;
    const int32_t *free_index;
    ss_locator *locator;
    const ss_slide *slide;
    double (*way)[3]; /* [free_count] from each vertex's own place on rest to where it is looked up */
};

skinslide_status ss_middles_create(const ss_patch *patch, const int32_t *free_index, ss_middles **out, skinslide_error *error) {
    ss_middles *middles = calloc(1, sizeof *middles);
    if (!middles)
        return ss_out_of_memory(error);
    middles->patch = patch, middles->free_index = free_index;
    middles->way = ss_new(&middles->memory, patch->free_count, sizeof *middles->way);
    skinslide_status status = middles->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_locator_create(patch, &middles->locator, error);
    if (status)
        ss_middles_destroy(middles);
    else
        *out = middles;
    return status;
}

void ss_middles_destroy(ss_middles *middles) {
    if (!middles)
        return;
    ss_locator_destroy(middles->locator);
    ss_free(&middles->memory);
    free(middles);
}

static bool stays(const ss_middles *middles, int32_t vertex) {
    int32_t i = middles->free_index[vertex];
    return i < 0 || middles->slide->places[i].triangle == SS_STAYS;
}

/* ---- In the plane ---- */

/* Starts where one of its corners was found. */
static ss_place look_up(const ss_middles *middles, int32_t face) {
    const ss_patch *patch = middles->patch;
    int32_t begin = patch->faces.face_start[face], end = patch->faces.face_start[face + 1];
    int32_t near = patch->triangles.first_triangle[face];
    double mean[2] = {0, 0};
    for (int32_t c = begin; c < end; c++) {
        int32_t vertex = patch->faces.corner_vertex[c], i = middles->free_index[vertex];
        const double *at = i < 0 ? middles->slide->flat.uv[vertex] : middles->slide->asked[i];
        if (!stays(middles, vertex))
            near = middles->slide->places[i].triangle;
        for (int k = 0; k < 2; k++)
            mean[k] += at[k] / (end - begin);
    }
    return ss_locate_near(middles->locator, near, mean);
}

/* ---- Over rest ---- */

static void list_ways(ss_middles *middles) {
    const ss_posed *rest = &middles->slide->rest->ground->pose;
    for (int32_t i = 0; i < middles->patch->free_count; i++) {
        int32_t vertex = middles->patch->free_vertex[i];
        double at[3];
        middles->way[i][0] = middles->way[i][1] = middles->way[i][2] = 0;
        if (stays(middles, vertex))
            continue;
        ss_place_point(rest, &middles->slide->places[i], at);
        ss_subtract(at, rest->point[vertex], middles->way[i]);
    }
}

static ss_place walk(const ss_middles *middles, int32_t face) {
    const ss_faces *faces = &middles->patch->faces;
    int32_t begin = faces->face_start[face], end = faces->face_start[face + 1];
    ss_place place = ss_flat_middle(middles->patch, &middles->slide->flat, face);
    double mean[3] = {0, 0, 0};
    for (int32_t c = begin; c < end; c++) {
        int32_t i = middles->free_index[faces->corner_vertex[c]];
        if (i >= 0)
            ss_add(1.0 / (end - begin), middles->way[i], mean);
    }
    ss_walk_turned_from(middles->slide->rest->ground, mean, &place);
    return place;
}

/* ---- One frame ---- */

void ss_middles_set(ss_middles *middles, const ss_slide *slide) {
    middles->slide = slide;
    if (slide->flat.uv)
        ss_locator_set(middles->locator, slide->flat.uv, slide->regular);
    else
        list_ways(middles);
}

ss_place ss_middle(const ss_middles *middles, int32_t face) {
    const ss_faces *faces = &middles->patch->faces;
    for (int32_t c = faces->face_start[face]; c < faces->face_start[face + 1]; c++)
        if (!stays(middles, faces->corner_vertex[c]))
            return middles->slide->flat.uv ? look_up(middles, face) : walk(middles, face);
    return (ss_place){.triangle = SS_STAYS};
}
