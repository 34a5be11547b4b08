/* Which points of a mesh sliding reads: those of the faces that touch its patches, which slide, or on which normals and limit
 * points depend. Others are copied as they are, whatever they hold, and cost a frame nothing. */
#include "slide.h"

#include <stdio.h>

static bool is_at_patch(const skinslide_mesh *mesh, const int32_t *vertices, int32_t count, const uint8_t *chosen) {
    for (int32_t k = 0; k < count; k++)
        if (chosen[ss_one(mesh, vertices[k])])
            return true;
    return false;
}

static void mark_reads(const skinslide_mesh *mesh, const uint8_t *chosen, uint8_t *reads) {
    for (int32_t f = 0, c = 0; f < mesh->face_count; c += mesh->face_counts[f++]) {
        const int32_t *vertices = mesh->face_indices + c;
        if (!is_at_patch(mesh, vertices, mesh->face_counts[f], chosen))
            continue;
        for (int32_t k = 0; k < mesh->face_counts[f]; k++)
            reads[vertices[k]] = reads[ss_one(mesh, vertices[k])] = 1;
    }
}

static bool begins_span(const uint8_t *marked, int32_t vertex) {
    return marked[vertex] && (vertex == 0 || !marked[vertex - 1]);
}

static bool list_marked(ss_memory *memory, const uint8_t *marked, int32_t vertex_count, ss_list *list) {
    for (int32_t v = 0; v < vertex_count; v++)
        list->count += marked[v], list->span_count += begins_span(marked, v);
    list->spans = SS_NEW(memory, ss_span, list->span_count);
    for (int32_t v = 0, i = 0; list->spans && v < vertex_count; v++) {
        if (begins_span(marked, v))
            list->spans[i++].first = v;
        if (marked[v])
            list->spans[i - 1].end = v + 1;
    }
    return list->spans != NULL;
}

bool ss_list_vertices(skinslide_slider *slider, const skinslide_mesh *mesh, const uint8_t *chosen) {
    ss_memory scratch = {0};
    uint8_t *marked = SS_NEW(&scratch, uint8_t, mesh->vertex_count);
    for (int32_t v = 0; marked && v < mesh->vertex_count; v++)
        marked[v] = chosen[ss_one(mesh, v)];
    bool done = marked && list_marked(&slider->memory, marked, mesh->vertex_count, &slider->own);
    if (done) {
        mark_reads(mesh, chosen, marked);
        done = list_marked(&slider->memory, marked, mesh->vertex_count, &slider->reads);
    }
    ss_free(&scratch);
    return done;
}

static skinslide_status refuse_point(const ss_span *span, const float *points, const char *what, skinslide_error *error) {
    int32_t v = span->first;
    while (ss_is_finite(points + 3 * (int64_t)v))
        v++;
    return ss_refuse_vertex(what, v, points + 3 * (int64_t)v, 3, SKINSLIDE_BAD_POINTS, error);
}

skinslide_status ss_check_reads(const skinslide_slider *slider, const float *points, const char *what, skinslide_error *error) {
    if (!points)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no %s", what);
    for (int32_t i = 0; i < slider->reads.span_count; i++) {
        const ss_span *span = &slider->reads.spans[i];
        if (!ss_all_finite(3 * (int64_t)ss_span_size(span), points + 3 * (int64_t)span->first))
            return refuse_point(span, points, what, error);
    }
    return SKINSLIDE_OK;
}

static void warn(skinslide_error *warning, const float *points, int32_t count, int32_t first) {
    const float *at = points + 3 * (int64_t)first;
    const char *words = count == 1 ? "1 point that no patch uses is not finite, and stays as it is"
                                   : "points that no patch uses are not finite, and stay as they are";
    char number[16] = "";
    if (count > 1)
        snprintf(number, sizeof number, "%d ", count);
    ss_fail(warning, SKINSLIDE_BAD_POINTS, "%s%s: vertex %d%s at (%g, %g, %g)", number, words, first,
            count > 1 ? ", the first," : "", (double)at[0], (double)at[1], (double)at[2]);
}

skinslide_status skinslide_slider_check_points(const skinslide_slider *slider, const float *points, int32_t *passed,
                                               skinslide_error *warning, skinslide_error *error) {
    if (!slider || !passed)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no slider, or no place for how many points pass");
    skinslide_status status = ss_check_reads(slider, points, "points", error);
    int32_t count = 0, first = -1;
    for (int32_t v = 0; v < slider->vertex_count && !status; v++)
        if (!ss_is_finite(points + 3 * (int64_t)v))
            first = count++ ? first : v;
    if (!status)
        *passed = count;
    if (!status && count)
        warn(warning, points, count, first);
    return status;
}
