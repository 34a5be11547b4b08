/* The chart of the relaxed rule: the patch laid out in the plane at rest. Places slide in it, where skin has neither folds nor
 * creases, however crumpled a pose may be; and how a pose lies over it is blended from vertex to vertex, so that what is found
 * there changes smoothly with the place and with the pose. */
#include "relax.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Gradients ---- */

/* Of the linear map that takes the triangle in the plane to another place: first and second are its sides there. */
static void triangle_gradient(const ss_facet *plane, const double first[3], const double second[3], double out[2][3]) {
    for (int j = 0; j < 2; j++) {
        double a = plane->gram[0] * plane->first[j] + plane->gram[1] * plane->second[j];
        double b = plane->gram[1] * plane->first[j] + plane->gram[2] * plane->second[j];
        for (int k = 0; k < 3; k++)
            out[j][k] = a * first[k] + b * second[k];
    }
}

void ss_chart_gradient(const ss_chart *chart, const double (*points)[3], double (*gradient)[2][3]) {
    const ss_triangles *triangles = &chart->patch->triangles;
    double first[3], second[3], own[2][3];
    memset(gradient, 0, (size_t)chart->patch->vertex_count * sizeof *gradient);
    for (int32_t t = 0; t < triangles->count; t++) {
        const int32_t *v = triangles->vertex[t];
        ss_subtract(points[v[1]], points[v[0]], first);
        ss_subtract(points[v[2]], points[v[0]], second);
        triangle_gradient(&chart->plane.facet[t], first, second, own);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 2; j++)
                ss_add(chart->share[t][k], own[j], gradient[v[k]][j]);
    }
}

/* ---- Creation ---- */

static void set_shares(ss_chart *chart, double *sums) {
    const ss_triangles *triangles = &chart->patch->triangles;
    for (int32_t t = 0; t < triangles->count; t++)
        for (int k = 0; k < 3 && chart->plane.facet[t].has_area; k++) {
            chart->share[t][k] = ss_half_angle(&chart->plane, t, k);
            sums[triangles->vertex[t][k]] += chart->share[t][k];
        }
    for (int32_t t = 0; t < triangles->count; t++)
        for (int k = 0; k < 3 && chart->plane.facet[t].has_area; k++)
            chart->share[t][k] /= sums[triangles->vertex[t][k]];
}

static void set_edges(ss_chart *chart, const double (*rest)[3], const double (*gradient)[2][3]) {
    const ss_patch *patch = chart->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        double vector[3], u = chart->uv[v[1]][0] - chart->uv[v[0]][0], w = chart->uv[v[1]][1] - chart->uv[v[0]][1];
        double square = patch->rest_length[e] * patch->rest_length[e];
        ss_subtract(rest[v[1]], rest[v[0]], vector);
        for (int end = 0; end < 2; end++)
            for (int j = 0; j < 2; j++)
                chart->slope[e][end][j] = ss_dot(vector, gradient[v[end]][j]) / square;
        chart->inverse_square[e] = 1 / fmax(u * u + w * w, 1e-24);
    }
}

double ss_chart_area(const ss_chart *chart, int32_t face, const double (*uv)[2]) {
    const ss_faces *faces = &chart->patch->faces;
    const int32_t *v = faces->corner_vertex + faces->face_start[face];
    const double *first = uv[v[0]];
    double area = 0;
    for (int32_t k = 1; k <= ss_fan_size(faces, face); k++) {
        const double *p = uv[v[k]], *q = uv[v[k + 1]];
        area += 0.5 * ((p[0] - first[0]) * (q[1] - first[1]) - (p[1] - first[1]) * (q[0] - first[0]));
    }
    return area;
}

static skinslide_status fill(ss_chart *chart, const float *rest_points, skinslide_error *error) {
    const ss_patch *patch = chart->patch;
    ss_memory scratch = {0};
    double *sums = SS_NEW(&scratch, double, patch->vertex_count);
    double(*rest)[3] = ss_new(&scratch, patch->vertex_count, sizeof *rest);
    double(*gradient)[2][3] = ss_new(&scratch, patch->vertex_count, sizeof *gradient);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        ss_posed_set_plane(&chart->plane, chart->uv);
        ss_take_points(patch, rest_points, rest);
        set_shares(chart, sums);
        ss_chart_gradient(chart, (const double(*)[3])rest, gradient);
        set_edges(chart, (const double(*)[3])rest, (const double(*)[2][3])gradient);
        for (int32_t f = 0; f < patch->faces.face_count; f++)
            chart->area[f] = ss_chart_area(chart, f, chart->uv);
    }
    ss_free(&scratch);
    return status;
}

/* Where the patch is laid out: uv [vertex_count][2]. */
static skinslide_status lay_out(const ss_patch *patch, const float *rest_points, double (*uv)[2], skinslide_error *error) {
    ss_memory scratch = {0};
    uint8_t *fixed = SS_NEW(&scratch, uint8_t, patch->vertex_count);
    double *density = SS_NEW(&scratch, double, patch->faces.edge_count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_check_disk(patch, error);
    if (!status)
        status = ss_place_boundary(patch, SKINSLIDE_BOUNDARY_CIRCLE, rest_points, uv, error);
    if (!status)
        status = ss_place_holes(patch, rest_points, uv, error);
    if (!status) {
        for (int32_t v = 0; v < patch->vertex_count; v++)
            fixed[v] = patch->vertex_loop[v] >= 0;
        ss_force_density(patch, patch->rest_length, NULL, density);
        ss_net net = ss_net_of(patch, fixed);
        status = ss_embed_once(&net, patch->label, density, uv, error);
    }
    ss_free(&scratch);
    return status;
}

skinslide_status ss_chart_create(const ss_patch *patch, const float *rest_points, ss_chart **out, skinslide_error *error) {
    ss_chart *chart = calloc(1, sizeof *chart);
    if (!chart)
        return ss_out_of_memory(error);
    ss_memory *memory = &chart->memory;
    double(*uv)[2] = ss_new(memory, patch->vertex_count, sizeof *uv);
    chart->patch = patch, chart->uv = (const double(*)[2])uv;
    chart->share = ss_new(memory, patch->triangles.count, sizeof *chart->share);
    chart->slope = ss_new(memory, patch->faces.edge_count, sizeof *chart->slope);
    chart->inverse_square = SS_NEW(memory, double, patch->faces.edge_count);
    chart->area = SS_NEW(memory, double, patch->faces.face_count);
    bool allocated = ss_posed_allocate(memory, patch, &chart->plane);
    skinslide_status status = allocated ? lay_out(patch, rest_points, uv, error) : ss_out_of_memory(error);
    if (!status)
        status = fill(chart, rest_points, error);
    if (status)
        ss_chart_destroy(chart);
    else
        *out = chart;
    return status;
}

void ss_chart_destroy(ss_chart *chart) {
    if (!chart)
        return;
    ss_free(&chart->memory);
    free(chart);
}
