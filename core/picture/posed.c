/* A tessellated mesh in a pose: where its vertices are, their normals, and the values at them. */
#include "picture.h"

#include <math.h>

/* ---- Linear in a face ---- */

/* Weights of the corners of a face of n at a place of its limit surface. */
static void linear_weights(const ss_parameter *at, int32_t n, double *weights) {
    double s = at->st[0], t = at->st[1];
    for (int32_t k = 0; k < n; k++)
        weights[k] = at->corner >= 0 ? s * t / n : 0;
    if (at->corner >= 0) {
        weights[at->corner] += (1 - s) * (1 - t) + 0.5 * s * (1 - t) + 0.5 * (1 - s) * t;
        weights[(at->corner + 1) % n] += 0.5 * s * (1 - t);
        weights[(at->corner + n - 1) % n] += 0.5 * (1 - s) * t;
    } else if (n == 4) {
        weights[0] = (1 - s) * (1 - t), weights[1] = s * (1 - t), weights[2] = s * t, weights[3] = (1 - s) * t;
    } else {
        weights[0] = 1 - s - t, weights[1] = s, weights[2] = t;
    }
}

void ss_blend(const skinslide_tessellation *own, const ss_grid *grid, int32_t vertex, const float *values, int32_t width,
              bool by_corner, double *weights, float *out) {
    int32_t n = ss_face_size(own, grid->face), start = own->face_start[grid->face];
    for (int32_t k = 0; k < n; k++)
        weights[k] = k == vertex - grid->first_vertex;
    if (grid->side)
        linear_weights(&own->at[vertex], n, weights);
    for (int32_t i = 0; i < width; i++) {
        double sum = 0;
        for (int32_t k = 0; k < n; k++) {
            int64_t place = by_corner ? start + k : own->corner_vertex[start + k];
            sum += weights[k] == 0 ? 0 : weights[k] * values[width * place + i];
        }
        out[i] = (float)sum;
    }
}

/* ---- Fans ---- */

/* Weighted by area, from fans of all faces, for those that are drawn flat. */
static void add_fan_normal(const int32_t *vertices, int32_t n, const float *points, double (*normals)[3]) {
    double area[3];
    ss_area_vector(vertices, n, points, area);
    for (int32_t k = 0; k < n; k++)
        for (int i = 0; i < 3; i++)
            normals[vertices[k]][i] += area[i];
}

static void find_normals(const skinslide_tessellation *own, const float *points, double (*normals)[3]) {
    for (int32_t v = 0; v < own->mesh_vertex_count; v++)
        normals[v][0] = normals[v][1] = normals[v][2] = 0;
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        if (ss_face_size(own, f) >= 3)
            add_fan_normal(own->corner_vertex + own->face_start[f], ss_face_size(own, f), points, normals);
}

static void pose_fan(const skinslide_tessellation *own, const ss_grid *grid, const float *points, const double origin[3],
                     ss_tessellation_work *work) {
    for (int32_t k = 0; k < ss_face_size(own, grid->face); k++) {
        int32_t v = own->corner_vertex[own->face_start[grid->face] + k];
        ss_posed_vertex *out = &work->vertices[grid->first_vertex + k];
        const double *n = work->normals[v];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < 3; i++) {
            out->place[i] = (float)(points[3 * (int64_t)v + i] - origin[i]);
            out->normal[i] = (float)(length > 0 ? n[i] / length : 0);
        }
    }
}

/* ---- Grids ---- */

uint32_t ss_on_side(const ss_grid *grid, int side, int32_t step) {
    int32_t row = grid->side + 1, m = grid->side;
    int32_t place = side == 0 ? step : side == 1 ? step * row + m : side == 2 ? m * row + m - step : (m - step) * row;
    return (uint32_t)(grid->first_vertex + place);
}

/* Puts a vertex on the straight line between two others, where a coarser neighbour has its edge. */
static void put_between(ss_posed_vertex *vertex, const ss_posed_vertex *a, const ss_posed_vertex *b, float share) {
    for (int i = 0; i < 3; i++) {
        vertex->place[i] = a->place[i] + share * (b->place[i] - a->place[i]);
        vertex->normal[i] = a->normal[i] + share * (b->normal[i] - a->normal[i]);
    }
}

/* Closes the gap along a side beyond which a face may have fewer cells. Vertices that take their place from another are already
 * joined. */
static void join_side(const skinslide_tessellation *own, const ss_grid *grid, int side, ss_posed_vertex *vertices) {
    int32_t stride = grid->corner < 0 ? grid->side / 2 : grid->side;
    for (int32_t step = 0; step < grid->side; step++) {
        uint32_t v = ss_on_side(grid, side, step);
        int32_t begin = step - step % stride;
        if (step > begin && own->same_as[v] == v)
            put_between(&vertices[v], &vertices[ss_on_side(grid, side, begin)],
                        &vertices[ss_on_side(grid, side, begin + stride)], (float)(step - begin) / (float)stride);
    }
}

static void pose_grid(const skinslide_tessellation *own, const ss_grid *grid, const float *points, const double origin[3],
                      ss_tessellation_work *work) {
    ss_limit_prepare(own->surfaces, grid->surface, points, origin, work->patch_points);
    for (int32_t v = grid->first_vertex; v < grid->first_vertex + ss_grid_size(own, grid); v++) {
        double place[3], normal[3];
        ss_limit_normal(own->surfaces, grid->surface, &own->at[v], work->patch_points, place, normal);
        const ss_posed_vertex *same = &work->vertices[own->same_as[v]];
        for (int i = 0; i < 3; i++) {
            work->vertices[v].normal[i] = (float)normal[i];
            work->vertices[v].place[i] = own->same_as[v] == (uint32_t)v ? (float)place[i] : same->place[i];
        }
    }
    for (int side = 0; side < 4; side++)
        if (grid->coarse >> side & 1)
            join_side(own, grid, side, work->vertices);
}

/* ---- All ---- */

void ss_tessellate_values(const skinslide_tessellation *own, const float *values, int32_t place, ss_tessellation_work *work) {
    for (int32_t p = 0; p < own->grid_count; p++) {
        const ss_grid *grid = &own->grids[p];
        for (int32_t v = grid->first_vertex; v < grid->first_vertex + ss_grid_size(own, grid) && !work->skipped[p]; v++)
            ss_blend(own, grid, v, values, 1, false, work->weights, &work->vertices[v].values[place]);
    }
}

void ss_find_middle(const skinslide_tessellation *own, const float *points, double middle[3]) {
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t c = 0; c < own->face_start[own->mesh_face_count]; c++) {
            double at = points[3 * (int64_t)own->corner_vertex[c] + k];
            low = fmin(low, at), high = fmax(high, at);
        }
        middle[k] = low <= high ? 0.5 * (low + high) : 0;
    }
}

skinslide_status ss_check_value(int32_t mesh_vertex, float value, skinslide_error *error) {
    return isfinite(value) ? SKINSLIDE_OK
                           : ss_fail(error, SKINSLIDE_BAD_POINTS, "vertex %d has the value %g", mesh_vertex, (double)value);
}

bool ss_tessellation_work_allocate(const skinslide_tessellation *own, ss_tessellation_work *work) {
    ss_memory *memory = &work->memory;
    work->patch_points = SS_NEW(memory, double, own->surfaces ? ss_limit_surfaces_scratch(own->surfaces) : 0);
    work->normals = ss_new(memory, own->mesh_vertex_count, sizeof *work->normals);
    work->weights = SS_NEW(memory, double, own->largest_face);
    work->vertices = SS_NEW(memory, ss_posed_vertex, own->vertex_count);
    work->skipped = SS_NEW(memory, uint8_t, own->grid_count);
    return !memory->failed;
}

void ss_tessellate(const skinslide_tessellation *own, const float *points, const double origin[3], ss_tessellation_work *work) {
    if (!own->surfaces || own->flat_faces)
        find_normals(own, points, work->normals);
    for (int32_t p = 0; p < own->grid_count; p++)
        if (!work->skipped[p])
            (own->grids[p].side ? pose_grid : pose_fan)(own, &own->grids[p], points, origin, work);
}
