/* A mesh with all its patches. skinslide_slide is one frame, its stages in order: read this first. */
#include "slide.h"

#include <math.h>
#include <string.h>

/* ---- Stages of one patch ---- */

/* Paint, weights, limits, holds and responses: the set-up's, or this frame's own. */
static void apply_controls(const ss_part *part, ss_patch_work *work, const skinslide_controls *controls, ss_room *room,
                           skinslide_patch_result *result) {
    ss_frame *frame = &work->frame;
    frame->paint = part->paint, frame->weights = part->weights, frame->limits = part->limited ? part->limits : NULL;
    frame->holds = part->holds;
    frame->stretch_response = part->stretch_response, frame->compression_response = part->compression_response;
    result->clamped_weights = part->clamped_weights;
    if (!controls)
        return;
    result->clamped_weights = ss_control_weights(part->patch, controls, work->own_weights);
    frame->weights = work->own_weights;
    frame->limits = ss_control_limits(part->patch, controls, work->own_limits) ? work->own_limits : NULL;
    ss_control_holds(part->patch, controls, work->own_holds);
    frame->holds = work->own_holds;
    frame->stretch_response = controls->stretch_response, frame->compression_response = controls->compression_response;
    ss_begin_turn(room);
    ss_paint(part->patch, controls, SS_TAKE(room, ss_edge_paint, part->patch->faces.edge_count), work->own_paint);
    if (memcmp(work->own_paint, part->paint, (size_t)part->patch->faces.edge_count * sizeof *part->paint) != 0)
        frame->paint = work->own_paint;
}

/* Edge lengths as ss_edge_lengths takes them; scratch comes from the room, in its current turn. */
static int32_t take_lengths(ss_room *room, const ss_patch *patch, const float *points, double *lengths) {
    return ss_edge_lengths_at_once(patch, points, ss_take_room(room, patch->vertex_count, sizeof(double[4])), lengths);
}

/* Begins a frame of a patch, as far as its rule can before other patches have begun: a device may go on meanwhile. */
static skinslide_status start_patch(skinslide_workspace *workspace, int32_t p, const float *points,
                                    const skinslide_controls *controls, skinslide_error *error) {
    const ss_part *part = &workspace->slider->parts[p];
    ss_patch_work *work = &workspace->patches[p];
    skinslide_patch_result *result = &workspace->results[p];
    double time = ss_now();
    apply_controls(part, work, controls, &workspace->room, result);
    ss_begin_turn(&workspace->room);
    result->zero_length_edges = take_lengths(&workspace->room, part->patch, points, work->lengths);
    work->frame.points = points, work->frame.lengths = work->lengths, work->frame.stop = &workspace->stop;
    ss_lap(&time, &result->density_seconds);
    return part->rest->rule->start(work->slide, &work->frame, result, error);
}

/* Sums weight times displacement, and weight, over the patches of each vertex. */
static void add_displacement(const ss_patch *patch, const ss_patch_work *work, double (*sum)[4]) {
    const int32_t *mesh_vertex = patch->mesh_vertex, *free_vertex = patch->free_vertex, count = patch->free_count;
    const double(*own)[3] = (const double(*)[3])work->displacement, *weights = work->frame.weights;
    for (int32_t i = 0; i < count; i++) {
        double weight = ss_blend_weight(weights[i]);
        ss_loose_two *total = (ss_loose_two *)sum[mesh_vertex[free_vertex[i]]];
        total[0] += weight * (ss_two){own[i][0], own[i][1]}, total[1] += weight * (ss_two){own[i][2], 1};
    }
}

/* Finds where each vertex slides to, and its displacement on the deformed mesh. */
static skinslide_status slide_patch(skinslide_workspace *workspace, int32_t p, skinslide_error *error) {
    const ss_part *part = &workspace->slider->parts[p];
    ss_patch_work *work = &workspace->patches[p];
    const ss_slide *slide = work->slide;
    skinslide_patch_result *result = &workspace->results[p];
    skinslide_status status = part->rest->rule->finish(work->slide, &work->frame, result, error);
    if (status)
        return status;
    double time = ss_now();
    ss_begin_turn(&workspace->room);
    ss_lay_out_displacement(work, part->patch, &workspace->room);
    ss_interpolate(part->patch, &slide->flat, slide->places, work->frame.points, work->corner_weights, work->displacement);
    if (work->cage)
        result->damped_vertices = ss_move_cage(work->cage, &work->frame, slide, work->displacement);
    ss_lap(&time, &result->interpolate_seconds);
    add_displacement(part->patch, work, workspace->sum);
    return SKINSLIDE_OK;
}

/* ---- The blend ---- */

static void clear_sums(skinslide_workspace *workspace) {
    const ss_list *own = &workspace->slider->own;
    for (int32_t i = 0; i < own->span_count; i++)
        memset(workspace->sum[own->spans[i].first], 0, (size_t)ss_span_size(&own->spans[i]) * sizeof *workspace->sum);
}

/* From a sum over patches to the displacement of a vertex. Its weight is then 1 or 0: to do it again changes nothing. */
static inline void blend(double sum[4]) {
    if (sum[3] > 0 && sum[3] != 1)
        sum[0] /= sum[3], sum[1] /= sum[3], sum[2] /= sum[3], sum[3] = 1;
}

/* The length of a way along one axis after the other: 0 exactly if it leads nowhere. */
static inline double along_axes(const double displacement[3]) {
    return fabs(displacement[0]) + fabs(displacement[1]) + fabs(displacement[2]);
}

typedef int64_t two_bits __attribute__((vector_size(16)));

/* Where a vertex goes, by its displacement, if that is any: else -0 is added, which leaves the bits of all numbers. */
SS_INLINE void go(const float here[3], const double displacement[3], double any, float out[3]) {
    const ss_two each = {any, any};
    const two_bits minus = (each == 0) & INT64_MIN;
    ss_two first = *(const ss_loose_two *)displacement, last = {displacement[2], 0};
    first = (ss_two){here[0], here[1]} + (ss_two)((two_bits)first | minus);
    last = (ss_two){here[2], 0} + (ss_two)((two_bits)last | minus);
    out[0] = (float)first[0], out[1] = (float)first[1], out[2] = (float)last[0];
}

/* Where a vertex goes; a welded one goes with the vertex that it is one with. */
SS_INLINE void land(const skinslide_workspace *workspace, const float *points, int32_t vertex, float out[3]) {
    double *sum = workspace->sum[ss_welded(workspace->slider, vertex)], own[3];
    const double *displacement = sum;
    blend(sum);
    if (workspace->slider->space)
        ss_take_back(workspace->slider, sum, own), displacement = own;
    go(points + 3 * (int64_t)vertex, displacement, along_axes(sum), out);
}

static skinslide_status check_landing(const skinslide_workspace *workspace, const ss_patch *patch, int32_t vertex,
                                      const float *points, skinslide_error *error) {
    float to[3];
    land(workspace, points, vertex, to);
    if (ss_is_finite(to))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_POINTS, "%s: vertex %d slides to where it is not finite: (%g, %g, %g)", patch->label,
                   vertex, to[0], to[1], to[2]);
}

static skinslide_status check_landings(const skinslide_workspace *workspace, const ss_patch *patch, const float *points,
                                       skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t i = 0; i < patch->free_count && !status; i++) {
        int32_t vertex = patch->free_vertex[i];
        for (int32_t k = patch->copy_start[vertex]; k < patch->copy_start[vertex + 1] && !status; k++)
            status = check_landing(workspace, patch, patch->copy[k], points, error);
    }
    return status;
}

/* Names the first vertex of a patch that lands beyond what a float can hold. */
static skinslide_status refuse_landing(const skinslide_workspace *workspace, const float *points, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t p = 0; p < workspace->slider->part_count && !status; p++)
        status = check_landings(workspace, workspace->slider->parts[p].patch, points, error);
    return status;
}

/* Writes all points or, where a float cannot hold one, none. */
static skinslide_status write_points(const skinslide_workspace *workspace, const float *points, float *slid,
                                     skinslide_error *error) {
    const ss_list *own = &workspace->slider->own;
    float(*landed)[3] = workspace->landed;
    for (int32_t i = 0; i < own->span_count; i++)
        for (int32_t v = own->spans[i].first; v < own->spans[i].end; v++)
            land(workspace, points, v, *landed++);
    bool finite = ss_all_finite(3 * (int64_t)own->count, *workspace->landed);
    skinslide_status status = finite ? SKINSLIDE_OK : refuse_landing(workspace, points, error);
    if (status)
        return status;
    if (slid != points)
        memcpy(slid, points, (size_t)workspace->slider->vertex_count * sizeof(float[3]));
    landed = workspace->landed;
    for (int32_t i = 0; i < own->span_count; landed += ss_span_size(&own->spans[i++]))
        memcpy(slid + 3 * (int64_t)own->spans[i].first, landed, (size_t)ss_span_size(&own->spans[i]) * sizeof *landed);
    return SKINSLIDE_OK;
}

/* ---- Measures of the result ---- */

static void measure_slide(const ss_patch *patch, const double (*displacement)[4], skinslide_patch_result *result) {
    double largest = 0; /* squared */
    int32_t slid = 0;
    for (int32_t i = 0; i < patch->free_count; i++) {
        const double *d = displacement[patch->mesh_vertex[patch->free_vertex[i]]];
        slid += along_axes(d) != 0;
        largest = ss_most(ss_dot(d, d), largest);
    }
    result->slid_vertices = slid;
    result->largest_slide = sqrt(largest);
}

/* RMS over edges of log(length / rest length). */
static double stretch_of(const ss_patch *patch, const double *lengths) {
    int32_t count = patch->faces.edge_count;
    return sqrt(ss_sum_squared_logs(count, lengths, patch->rest_length) / count);
}

static void measure_patch(skinslide_workspace *workspace, int32_t p, const float *slid) {
    const ss_patch *patch = workspace->slider->parts[p].patch;
    skinslide_patch_result *result = &workspace->results[p];
    measure_slide(patch, (const double(*)[4])workspace->sum, result);
    ss_begin_turn(&workspace->room);
    double *lengths = SS_TAKE(&workspace->room, double, patch->faces.edge_count);
    take_lengths(&workspace->room, patch, slid, lengths);
    result->stretch_before = stretch_of(patch, workspace->patches[p].lengths);
    result->stretch_after = stretch_of(patch, lengths);
}

static void measure(skinslide_workspace *workspace, const float *slid) {
    ss_bring(workspace->slider, &slid, workspace->after);
    for (int32_t p = 0; p < workspace->slider->part_count; p++)
        measure_patch(workspace, p, slid);
}

/* ---- One frame ---- */

skinslide_status ss_go_on(skinslide_workspace *workspace, skinslide_status status, skinslide_error *error) {
    if (!ss_is_set(&workspace->stop))
        return status;
    ss_set(&workspace->stop, 0);
    return ss_fail(error, SKINSLIDE_INTERRUPTED, "the frame was interrupted");
}

/* Takes points to where lengths are measured; they must be finite there too. */
static skinslide_status enter(const skinslide_slider *slider, const float **points, float *room, skinslide_error *error) {
    ss_bring(slider, points, room);
    return slider->space ? ss_check_reads(slider, *points, "points where lengths are taken", error) : SKINSLIDE_OK;
}

/* Checks what a frame is given, takes its controls, and its points to where lengths are measured. */
static skinslide_status begin_frame(skinslide_workspace *workspace, const float **points, const skinslide_controls *controls,
                                    const skinslide_patch_result *results, skinslide_error *error) {
    const skinslide_slider *slider = workspace->slider;
    skinslide_status status = ss_check_reads(slider, *points, "points", error);
    if (!status && controls)
        status = ss_take_frame_controls(slider, controls, workspace->controls, error);
    if (!status && controls)
        status = ss_need_controls(workspace, error);
    if (!status && results && slider->part_count > 0)
        status = ss_check_size(results, "skinslide_patch_result", error);
    return status ? status : enter(slider, points, workspace->before, error);
}

skinslide_status skinslide_slide(skinslide_workspace *workspace, const float *points, const skinslide_controls *controls,
                                 float *slid, skinslide_patch_result *results, skinslide_error *error) {
    if (!workspace || !points || !slid)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no workspace, points, or place for the slid points");
    const skinslide_slider *slider = workspace->slider;
    const float *before = points;
    skinslide_status status = begin_frame(workspace, &before, controls, results, error);
    if ((status = ss_go_on(workspace, status, error)))
        return status;
    workspace->has_frame = false;
    for (int32_t p = 0; p < slider->part_count; p++) {
        const skinslide_controls *own = controls ? &workspace->controls[slider->parts[p].patch->setup_index] : NULL;
        workspace->results[p] = (skinslide_patch_result)SKINSLIDE_PATCH_RESULT_DEFAULT;
        if ((status = ss_go_on(workspace, start_patch(workspace, p, before, own, error), error)))
            return status;
    }
    clear_sums(workspace);
    for (int32_t p = 0; p < slider->part_count; p++)
        if ((status = ss_go_on(workspace, slide_patch(workspace, p, error), error)))
            return status;
    if ((status = write_points(workspace, points, slid, error)))
        return status;
    if (results) {
        measure(workspace, slid);
        ss_give_all(workspace->results, slider->part_count, sizeof *workspace->results, results);
    }
    workspace->has_frame = true;
    return SKINSLIDE_OK;
}
