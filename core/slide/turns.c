/* How the skin turned in the frame that a workspace slid last. Of each vertex, n the smooth normals of the cache:
 *
 *     turn(v) = least rotation from n(own place) to n(place it slid to)
 *
 * n is blended between vertices by the weights of a place; where patches overlap, so are the normals, as displacements are. */
#include "slide.h"

#include <string.h>

static skinslide_status need_memory(skinslide_workspace *workspace, skinslide_error *error) {
    if (workspace->normal)
        return SKINSLIDE_OK;
    double(*normal)[3] = ss_new(&workspace->turning, workspace->slider->vertex_count, sizeof *normal);
    workspace->target = ss_new(&workspace->turning, workspace->slider->vertex_count, sizeof *workspace->target);
    if (!workspace->turning.failed)
        workspace->normal = normal;
    else
        ss_free(&workspace->turning), workspace->turning.failed = false;
    return workspace->normal ? SKINSLIDE_OK : ss_out_of_memory(error);
}

/* The normal at a place. */
static void blend_normal(const skinslide_workspace *workspace, const ss_patch *patch, const ss_place *place, double out[3]) {
    const int32_t *v = patch->triangles.vertex[place->triangle];
    for (int k = 0; k < 3; k++)
        ss_add(place->weight[k], workspace->normal[patch->mesh_vertex[v[k]]], out);
    ss_normalise(out);
}

static void add_targets(const skinslide_workspace *workspace, int32_t p) {
    const ss_patch *patch = workspace->slider->parts[p].patch;
    const ss_patch_work *work = &workspace->patches[p];
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t vertex = patch->mesh_vertex[patch->free_vertex[i]];
        const ss_place *place = &work->slide->places[i];
        double normal[3] = {0, 0, 0};
        if (place->triangle == SS_STAYS)
            memcpy(normal, workspace->normal[vertex], sizeof normal);
        else
            blend_normal(workspace, patch, place, normal);
        ss_add(ss_blend_weight(work->frame.weights[i]), normal, workspace->target[vertex]);
    }
}

/* Exactly 0 where the vertex did not move. */
static void turn_vertex(const skinslide_workspace *workspace, int32_t vertex, float out[3]) {
    int32_t one = ss_welded(workspace->slider, vertex);
    const double *displacement = workspace->sum[one];
    double turn[3] = {0, 0, 0};
    if (ss_length(displacement) > 0)
        ss_least_turn(workspace->normal[one], workspace->target[one], turn);
    for (int k = 0; k < 3; k++)
        out[k] = (float)turn[k];
}

skinslide_status skinslide_workspace_turns(skinslide_workspace *workspace, const float *points, float *turns,
                                           skinslide_error *error) {
    if (!workspace || !turns)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no workspace, or no place for the turns");
    const skinslide_slider *slider = workspace->slider;
    skinslide_status status = ss_check_reads(slider, points, "points", error);
    if (!status)
        status = ss_check_frame(workspace, error);
    if (!status)
        status = need_memory(workspace, error);
    if (status)
        return status;
    ss_smooth_normals(&slider->around, points, slider->vertex_count, workspace->normal);
    const ss_list *own = &slider->own;
    for (int32_t i = 0; i < own->span_count; i++)
        memset(workspace->target[own->spans[i].first], 0, (size_t)ss_span_size(&own->spans[i]) * sizeof *workspace->target);
    for (int32_t p = 0; p < slider->part_count; p++)
        add_targets(workspace, p);
    for (int32_t i = 0; i < own->span_count; i++)
        for (int32_t v = own->spans[i].first; v < own->spans[i].end; v++)
            ss_normalise(workspace->target[v]);
    memset(turns, 0, (size_t)slider->vertex_count * sizeof(float[3]));
    for (int32_t i = 0; i < own->span_count; i++)
        for (int32_t v = own->spans[i].first; v < own->spans[i].end; v++)
            turn_vertex(workspace, v, turns + 3 * (int64_t)v);
    return SKINSLIDE_OK;
}
