/* Smooth normals of a pose: at a vertex the mean of the normals of all faces there, of a patch or not, by the sine of half the
 * angle that each has there, which plain arithmetic gives. */
#include "mesh.h"

#include <string.h>

void ss_area_vector(const int32_t *vertices, int32_t count, const float *points, double out[3]) {
    const float *o = points + 3 * (int64_t)vertices[0];
    out[0] = out[1] = out[2] = 0;
    for (int32_t k = 1; k + 1 < count; k++) {
        const float *p = points + 3 * (int64_t)vertices[k], *q = points + 3 * (int64_t)vertices[k + 1];
        double a[3] = {(double)p[0] - o[0], (double)p[1] - o[1], (double)p[2] - o[2]};
        double b[3] = {(double)q[0] - o[0], (double)q[1] - o[1], (double)q[2] - o[2]};
        for (int i = 0; i < 3; i++)
            out[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}

/* ---- Faces around vertices ---- */

static bool has_chosen(const skinslide_mesh *mesh, const int32_t *vertices, int32_t count, const uint8_t *chosen) {
    for (int32_t k = 0; k < count; k++)
        if (chosen[ss_one(mesh, vertices[k])])
            return true;
    return false;
}

bool ss_take_around(const skinslide_mesh *mesh, const uint8_t *chosen, ss_memory *memory, ss_around *out) {
    int32_t corner_count = 0;
    for (int32_t f = 0, c = 0; f < mesh->face_count; c += mesh->face_counts[f++])
        if (has_chosen(mesh, mesh->face_indices + c, mesh->face_counts[f], chosen))
            out->face_count++, corner_count += mesh->face_counts[f];
    out->face_start = SS_NEW(memory, int32_t, (int64_t)out->face_count + 1);
    out->corner_vertex = SS_NEW(memory, int32_t, corner_count);
    if (memory->failed)
        return false;
    for (int32_t f = 0, c = 0, taken = 0; f < mesh->face_count; c += mesh->face_counts[f++]) {
        int32_t n = mesh->face_counts[f], start = out->face_start[taken];
        if (!has_chosen(mesh, mesh->face_indices + c, n, chosen))
            continue;
        for (int32_t k = 0; k < n; k++)
            out->corner_vertex[start + k] = ss_one(mesh, mesh->face_indices[c + k]);
        out->face_start[++taken] = start + n;
    }
    return true;
}

/* ---- Normals ---- */

/* A unit vector from one vertex to another; of no length where they coincide. */
static void towards(const float *points, int32_t from, int32_t to, double out[3]) {
    const float *p = points + 3 * (int64_t)from, *q = points + 3 * (int64_t)to;
    for (int k = 0; k < 3; k++)
        out[k] = (double)q[k] - p[k];
    ss_normalise(out);
}

/* The sine of half the angle of a face at its corner k: half the distance between unit vectors along its sides. */
static double half_angle(const int32_t *vertices, int32_t count, int32_t k, const float *points) {
    double next[3], last[3], between[3];
    towards(points, vertices[k], vertices[(k + 1) % count], next);
    towards(points, vertices[k], vertices[(k + count - 1) % count], last);
    ss_subtract(next, last, between);
    return ss_length(between) / 2;
}

static void add_face(const int32_t *vertices, int32_t count, const float *points, double (*normal)[3]) {
    double area[3];
    ss_area_vector(vertices, count, points, area);
    double size = ss_length(area);
    if (!(size > 0 && isfinite(size)))
        return;
    ss_normalise(area);
    for (int32_t k = 0; k < count; k++)
        ss_add(half_angle(vertices, count, k, points), area, normal[vertices[k]]);
}

void ss_smooth_normals(const ss_around *around, const float *points, int32_t vertex_count, double (*normal)[3]) {
    memset(normal, 0, (size_t)vertex_count * sizeof *normal);
    for (int32_t f = 0; f < around->face_count; f++) {
        int32_t start = around->face_start[f], count = around->face_start[f + 1] - start;
        if (count >= 3)
            add_face(around->corner_vertex + start, count, points, normal);
    }
    for (int32_t v = 0; v < vertex_count; v++)
        ss_normalise(normal[v]);
}
