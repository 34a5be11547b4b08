/* A mesh with all its patches. skinslide_slide is one frame, its stages in order: read this first. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "slider.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Adds the seconds since *since to *sum, and sets it to now. */
static void lap(double *since, double *sum) {
    double time = now();
    *sum += time - *since;
    *since = time;
}

/* ---- Stages of one patch ---- */

/* Paint, weights and rest embedding: the set-up's, or this frame's own. Paint that differs costs an embedding of rest. */
static skinslide_status apply_controls(const ss_part *part, ss_patch_work *work, const skinslide_controls *controls,
                                       skinslide_patch_result *result, skinslide_error *error) {
    work->paint = part->paint, work->weights = part->weights, work->rest_uv = (const double(*)[2])part->rest_uv;
    work->limits = part->limits, work->limited = part->limited;
    result->clamped_weights = part->clamped_weights;
    if (!controls)
        return SKINSLIDE_OK;
    work->weights = work->own_weights;
    result->clamped_weights = ss_slide_weights(part->patch, controls, work->own_weights);
    ss_paint(part->patch, controls, work->own_paint);
    work->limits = work->own_limits, work->limited = ss_slide_limits(part->patch, controls, work->own_limits);
    if (memcmp(work->own_paint, part->paint, (size_t)part->patch->faces.edge_count * sizeof *part->paint) == 0)
        return SKINSLIDE_OK;
    work->paint = work->own_paint;
    if (work->relaxer) /* its plane knows no paint */
        return SKINSLIDE_OK;
    work->rest_uv = (const double(*)[2])work->own_rest_uv;
    ss_force_density(part->patch, part->patch->rest_length, work->paint, work->density);
    return ss_embed(part->system, work->factor, work->density, work->own_rest_uv, error);
}

/* u = lerp(own place in Ud, rest place in U0, weight): what each free vertex is looked up at. */
static void make_queries(const ss_patch *patch, ss_patch_work *work) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        const double *own = work->uv[patch->free_vertex[i]], *rest = work->rest_uv[patch->free_vertex[i]];
        double weight = work->weights[i];
        for (int k = 0; k < 2; k++)
            work->queries[i][k] = weight == 1 ? rest[k] : own[k] + weight * (rest[k] - own[k]);
    }
}

/* The frame's embedding; its texture is being drawn while what follows goes on. */
static skinslide_status embed_patch(skinslide_workspace *workspace, int32_t p, const float *points,
                                    const skinslide_controls *controls, skinslide_error *error) {
    const ss_part *part = &workspace->slider->parts[p];
    const ss_patch *patch = part->patch;
    ss_patch_work *work = &workspace->patches[p];
    skinslide_patch_result *result = &workspace->results[p];
    double time = now();
    skinslide_status status = apply_controls(part, work, controls, result, error);
    if (status)
        return status;
    result->zero_length_edges = ss_edge_lengths(patch, points, work->lengths);
    ss_force_density(patch, work->lengths, work->paint, work->density);
    lap(&time, &result->density_seconds);

    if (work->relaxer) {
        memcpy(work->uv, part->rest_uv, (size_t)patch->vertex_count * sizeof *work->uv);
        return SKINSLIDE_OK;
    }
    if ((status = ss_embed(part->system, work->factor, work->density, work->uv, error)))
        return status;
    lap(&time, &result->embed_seconds);

    ss_layout layout = ss_lay_out(patch, (const double(*)[2])work->uv);
    result->folded_faces = layout.folded;
    work->regular = layout.regular;
    make_queries(patch, work);
    if (workspace->idbuffer && layout.regular)
        ss_idbuffer_draw(workspace->idbuffer, p, (const double(*)[2])work->uv, (const double(*)[2])work->queries);
    lap(&time, &result->locate_seconds);
    return SKINSLIDE_OK;
}

/* Where each vertex is in it, no farther than the artist lets it. */
static void locate_patch(skinslide_workspace *workspace, int32_t p, const float *points) {
    const ss_patch *patch = workspace->slider->parts[p].patch;
    ss_patch_work *work = &workspace->patches[p];
    skinslide_patch_result *result = &workspace->results[p];
    const double(*uv)[2] = (const double(*)[2])work->uv;
    bool asked = workspace->idbuffer && work->regular && patch->free_count > 0;
    bool proposed = asked && ss_idbuffer_candidates(workspace->idbuffer, p, work->candidates);
    ss_located located = ss_locate(work->locator, uv, work->regular, (const double(*)[2])work->queries,
                                   proposed ? (const ss_candidates *)work->candidates : NULL, work->locations);
    result->lost_textures = asked && !proposed;
    result->found_in_centre = located.centre;
    result->found_in_3x3 = located.around;
    result->walked_vertices = located.walked;
    result->searched_vertices = located.searched;
    result->clamped_vertices = located.clamped;
    result->walk_steps = located.steps;
    if (work->limited)
        result->clamped_vertices += ss_travel(work->traveller, points, uv, (ss_allowance){NULL, work->limits}, work->locations);
}

static bool slides_fully(const ss_patch *patch, const double *weights) {
    for (int32_t i = 0; i < patch->free_count; i++)
        if (weights[i] != 1)
            return false;
    return true;
}

/* The same by the relaxed rule. */
static void relax_patch(skinslide_workspace *workspace, int32_t p, const float *points) {
    ss_patch_work *work = &workspace->patches[p];
    skinslide_patch_result *result = &workspace->results[p];
    const double(*uv)[2] = (const double(*)[2])work->uv;
    result->relax_steps = ss_relax(work->relaxer, points, work->paint, work->locations);
    if (work->limited || !slides_fully(workspace->slider->parts[p].patch, work->weights))
        result->clamped_vertices =
            ss_travel(work->traveller, points, uv, (ss_allowance){work->weights, work->limits}, work->locations);
    result->folded_faces = ss_count_turned(work->relaxer, work->locations);
}

/* Queries are where vertices went, which is elsewhere than asked where they were relaxed or held back. */
static void follow_locations(const ss_patch *patch, ss_patch_work *work) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        bool stays = work->locations[i].face == SS_STAYS;
        memcpy(work->queries[i], stays ? work->uv[patch->free_vertex[i]] : work->locations[i].uv, sizeof *work->queries);
    }
}

/* Where each vertex belongs, and so on the deformed mesh. */
static void slide_patch(skinslide_workspace *workspace, int32_t p, const float *points) {
    const ss_patch *patch = workspace->slider->parts[p].patch;
    ss_patch_work *work = &workspace->patches[p];
    skinslide_patch_result *result = &workspace->results[p];
    const double(*uv)[2] = (const double(*)[2])work->uv;
    double time = now();
    (work->relaxer ? relax_patch : locate_patch)(workspace, p, points);
    if (work->relaxer || work->limited)
        follow_locations(patch, work);
    lap(&time, work->relaxer ? &result->relax_seconds : &result->locate_seconds);

    ss_interpolate(patch, uv, work->locations, points, work->corner_weights, work->displacement);
    if (work->cage) {
        ss_frame frame = {points, work->lengths, uv, (const double(*)[2])work->queries, work->locations};
        result->damped_vertices = ss_move_cage(work->cage, &frame, work->displacement);
    }
    lap(&time, &result->interpolate_seconds);
}

/* ---- The blend ---- */

/* A vertex of no weight keeps its limit point, for which it follows its neighbours, but has no say where patches overlap. */
static const double least_weight = 1e-30;

/* Sums weight times displacement, and weight, over the patches of each vertex. */
static void add_displacement(const ss_patch *patch, const ss_patch_work *work, double (*sum)[4]) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        double *total = sum[patch->mesh_vertex[patch->free_vertex[i]]], weight = fmax(work->weights[i], least_weight);
        for (int k = 0; k < 3; k++)
            total[k] += weight * work->displacement[i][k];
        total[3] += weight;
    }
}

/* sum: from sums over patches to the displacement of each vertex. */
static void blend(skinslide_workspace *workspace) {
    const skinslide_slider *slider = workspace->slider;
    memset(workspace->sum, 0, (size_t)slider->vertex_count * sizeof *workspace->sum);
    for (int32_t p = 0; p < slider->part_count; p++)
        add_displacement(slider->parts[p].patch, &workspace->patches[p], workspace->sum);
    for (int32_t v = 0; v < slider->vertex_count; v++)
        for (int k = 0; k < 3 && workspace->sum[v][3] > 0; k++)
            workspace->sum[v][k] /= workspace->sum[v][3];
}

static bool moves(const double displacement[3]) {
    return displacement[0] != 0 || displacement[1] != 0 || displacement[2] != 0;
}

static void write_points(const skinslide_workspace *workspace, const float *points, float *slid) {
    for (int32_t v = 0; v < workspace->slider->vertex_count; v++) {
        const double *displacement = workspace->sum[v];
        bool moved = moves(displacement);
        for (int k = 0; k < 3; k++) {
            float here = points[3 * (int64_t)v + k];
            slid[3 * (int64_t)v + k] = moved ? (float)(here + displacement[k]) : here;
        }
    }
}

/* ---- Measures of the result ---- */

static void measure_slide(const ss_patch *patch, const double (*displacement)[4], skinslide_patch_result *result) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        const double *d = displacement[patch->mesh_vertex[patch->free_vertex[i]]];
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        result->slid_vertices += moves(d);
        result->largest_slide = length > result->largest_slide ? length : result->largest_slide;
    }
}

/* RMS over edges of log(length / rest length). */
static double stretch(const ss_patch *patch, const double *lengths) {
    double sum = 0;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double stretched = log(lengths[e] / patch->rest_length[e]);
        sum += stretched * stretched;
    }
    return sqrt(sum / patch->faces.edge_count);
}

/* ---- One frame ---- */

skinslide_status skinslide_slide(skinslide_workspace *workspace, const float *points, const skinslide_controls *controls,
                                 float *slid, skinslide_patch_result *results, skinslide_error *error) {
    if (!workspace || !points || !slid)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no workspace, points, or place for the slid points");
    const skinslide_slider *slider = workspace->slider;
    skinslide_status status = ss_check_points(points, slider->vertex_count, "points", error);
    if (!status && controls)
        status = ss_check_frame_controls(slider, controls, error);
    if (status)
        return status;
    workspace->has_frame = false;
    for (int32_t p = 0; p < slider->part_count; p++) {
        const skinslide_controls *own = controls ? &controls[slider->parts[p].patch->setup_index] : NULL;
        workspace->results[p] = (skinslide_patch_result){0};
        if ((status = embed_patch(workspace, p, points, own, error)))
            return status;
    }
    for (int32_t p = 0; p < slider->part_count; p++) {
        slide_patch(workspace, p, points);
        workspace->results[p].stretch_before = stretch(slider->parts[p].patch, workspace->patches[p].lengths);
    }
    blend(workspace);
    write_points(workspace, points, slid);
    for (int32_t p = 0; p < slider->part_count; p++) {
        const ss_patch *patch = slider->parts[p].patch;
        measure_slide(patch, (const double(*)[4])workspace->sum, &workspace->results[p]);
        ss_edge_lengths(patch, slid, workspace->patches[p].lengths);
        workspace->results[p].stretch_after = stretch(patch, workspace->patches[p].lengths);
        if (results)
            results[p] = workspace->results[p];
    }
    workspace->has_frame = true;
    return SKINSLIDE_OK;
}
