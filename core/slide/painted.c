/* The artist's controls: what every edge pulls with, and how far each vertex goes. */
#include "slide.h"

#include <math.h>
#include <stdio.h>

/* ---- Checks that name mesh elements ---- */

static bool is_positive(float value) {
    return value > 0 && !isinf(value);
}

/* The value of something, such as "hold of vertex 3". */
static skinslide_status refuse(const char *name, const char *of, float value, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: %s is %g; it must be finite and > 0", name, of, value);
}

static skinslide_status check_all(const float *values, int32_t count, const char *name, const char *elements,
                                  skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    char of[64];
    for (int32_t i = 0; values && i < count && !status; i++)
        if (!is_positive(values[i])) {
            snprintf(of, sizeof of, "%s %d", elements, i);
            status = refuse(name, of, values[i], error);
        }
    return status;
}

static skinslide_status check_edge_density(const char *name, const skinslide_controls *controls, skinslide_error *error) {
    if (controls->edge_count < 0 || (controls->edge_count > 0 && (!controls->edges || !controls->edge_density)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "patch %s: edges without force densities, or the reverse", name);
    skinslide_status status = SKINSLIDE_OK;
    char of[64];
    for (int32_t i = 0; i < controls->edge_count && !status; i++)
        if (!is_positive(controls->edge_density[i])) {
            const int32_t *edge = controls->edges + 2 * i;
            snprintf(of, sizeof of, "force density of edge %d-%d", edge[0], edge[1]);
            status = refuse(name, of, controls->edge_density[i], error);
        }
    return status;
}

static skinslide_status check_response(float response, const char *name, const char *of, skinslide_error *error) {
    if (response >= 0 && response <= 1)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: response to %s is %g; it must be between 0 and 1", name, of,
                   response);
}

skinslide_status ss_check_controls(const skinslide_mesh *mesh, const char *name, const skinslide_controls *controls,
                                   skinslide_error *error) {
    skinslide_status status = check_all(controls->vertex_density, mesh->vertex_count, name, "force density of vertex", error);
    if (!status)
        status = check_all(controls->face_density, mesh->face_count, name, "force density of face", error);
    if (!status)
        status = check_edge_density(name, controls, error);
    if (status)
        return status;
    for (int32_t v = 0; controls->weight && v < mesh->vertex_count; v++)
        if (isnan(controls->weight[v]))
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: weight of vertex %d is not a number", name, v);
    for (int32_t v = 0; controls->max_distance && v < mesh->vertex_count; v++)
        if (!(controls->max_distance[v] >= 0))
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: largest distance of vertex %d is %g; it must be >= 0", name,
                           v, controls->max_distance[v]);
    if (isnan(controls->envelope))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: envelope is not a number", name);
    status = check_all(controls->hold, mesh->vertex_count, name, "hold of vertex", error);
    if (!status)
        status = check_response(controls->stretch_response, name, "stretch", error);
    return status ? status : check_response(controls->compression_response, name, "compression", error);
}

/* ---- Paint ---- */

/* The mean over the copies of a patch vertex; of one, its value to the bit. */
static double mean_of(const ss_patch *patch, const float *values, int32_t vertex) {
    double sum = 0;
    for (int32_t i = patch->copy_start[vertex]; i < patch->copy_start[vertex + 1]; i++)
        sum += values[patch->copy[i]];
    return sum / (patch->copy_start[vertex + 1] - patch->copy_start[vertex]);
}

static void paint_vertices(const ss_patch *patch, const float *density, double *paint) {
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        paint[e] *= 0.5 * (mean_of(patch, density, v[0]) + mean_of(patch, density, v[1]));
    }
}

/* An edge takes the mean of the faces of the patch that it bounds: one or two. */
static void paint_faces(const ss_patch *patch, const float *density, double *paint) {
    const ss_faces *faces = &patch->faces;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t twin = faces->corner_twin[c];
        double here = density[patch->mesh_face[faces->corner_face[c]]];
        if (twin < 0)
            paint[faces->corner_edge[c]] *= here;
        else if (c < twin)
            paint[faces->corner_edge[c]] *= 0.5 * (here + density[patch->mesh_face[faces->corner_face[twin]]]);
    }
}

/* Edges of other pieces of the set-up are skipped here: the slider checks that every edge is in some piece. */
static void paint_edges(const ss_patch *patch, const skinslide_controls *controls, ss_edge_paint *edges, double *paint) {
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        edges[e] = (ss_edge_paint){0, 0};
    for (int32_t i = 0; i < controls->edge_count; i++) {
        int32_t edge = ss_patch_mesh_edge(patch, controls->edges[2 * i], controls->edges[2 * i + 1]);
        if (edge >= 0)
            edges[edge].sum += controls->edge_density[i], edges[edge].count++;
    }
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        if (edges[e].count > 0)
            paint[e] *= edges[e].sum / edges[e].count;
}

void ss_paint(const ss_patch *patch, const skinslide_controls *controls, ss_edge_paint *edges, double *paint) {
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        paint[e] = 1;
    if (controls->vertex_density)
        paint_vertices(patch, controls->vertex_density, paint);
    if (controls->face_density)
        paint_faces(patch, controls->face_density, paint);
    if (controls->edge_count > 0)
        paint_edges(patch, controls, edges, paint);
}

/* ---- Weights ---- */

static double clamped_share(double value, int32_t *clamped) {
    *clamped += value < 0 || value > 1;
    return value < 0 ? 0 : value > 1 ? 1 : value;
}

static double mean_share(const ss_patch *patch, const float *values, int32_t vertex, int32_t *clamped) {
    double sum = 0;
    for (int32_t i = patch->copy_start[vertex]; i < patch->copy_start[vertex + 1]; i++)
        sum += clamped_share(values[patch->copy[i]], clamped);
    return sum / (patch->copy_start[vertex + 1] - patch->copy_start[vertex]);
}

int32_t ss_control_weights(const ss_patch *patch, const skinslide_controls *controls, double *weights) {
    int32_t clamped = 0;
    double envelope = clamped_share(controls->envelope, &clamped);
    for (int32_t i = 0; i < patch->free_count; i++)
        weights[i] = envelope * (controls->weight ? mean_share(patch, controls->weight, patch->free_vertex[i], &clamped) : 1);
    return clamped;
}

static double smallest_of(const ss_patch *patch, const float *values, int32_t vertex) {
    double smallest = INFINITY;
    for (int32_t i = patch->copy_start[vertex]; i < patch->copy_start[vertex + 1]; i++)
        smallest = fmin(smallest, values[patch->copy[i]]);
    return smallest;
}

bool ss_control_limits(const ss_patch *patch, const skinslide_controls *controls, double *limits) {
    bool any = false;
    for (int32_t i = 0; i < patch->free_count; i++) {
        limits[i] = controls->max_distance ? smallest_of(patch, controls->max_distance, patch->free_vertex[i]) : INFINITY;
        any = any || !isinf(limits[i]);
    }
    return any;
}

void ss_control_holds(const ss_patch *patch, const skinslide_controls *controls, double *holds) {
    for (int32_t v = 0; v < patch->vertex_count; v++)
        holds[v] = controls->hold ? mean_of(patch, controls->hold, v) : 1;
}
