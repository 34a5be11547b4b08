/* Normals of slid points, where a face moved: area-weighted means of face normals. */
#include "mesh.h"

#include <math.h>

typedef struct work {
    const skinslide_mesh *mesh;
    int32_t *face_start;   /* [face_count + 1] */
    uint8_t *face_moved;   /* [face_count] a vertex of it slid */
    double (*area)[3];     /* [face_count] twice the area vector of the slid face */
    int32_t *vertex_start; /* [vertex_count + 1] corners of each vertex ... */
    int32_t *corner;       /* [index_count] ... in here */
    int32_t *corner_face;  /* [index_count] */
} work;

static bool vertex_moved(const float *cached, const float *slid, int32_t vertex) {
    for (int k = 0; k < 3; k++)
        if (cached[3 * (int64_t)vertex + k] != slid[3 * (int64_t)vertex + k])
            return true;
    return false;
}

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

static void measure_faces(work *w, const float *cached, const float *slid, double sign) {
    const skinslide_mesh *mesh = w->mesh;
    for (int32_t f = 0; f < mesh->face_count; f++) {
        const int32_t *vertices = mesh->face_indices + w->face_start[f];
        for (int32_t k = 0; k < mesh->face_counts[f] && !w->face_moved[f]; k++)
            w->face_moved[f] = vertex_moved(cached, slid, vertices[k]);
        if (mesh->face_counts[f] >= 3)
            ss_area_vector(vertices, mesh->face_counts[f], slid, w->area[f]);
        for (int k = 0; k < 3; k++)
            w->area[f][k] *= sign;
    }
}

/* Corners by vertex, in the order of faces. */
static void list_corners(work *w) {
    const skinslide_mesh *mesh = w->mesh;
    for (int32_t f = 0; f < mesh->face_count; f++) {
        w->face_start[f + 1] = w->face_start[f] + mesh->face_counts[f];
        for (int32_t c = w->face_start[f]; c < w->face_start[f + 1]; c++) {
            w->corner_face[c] = f;
            w->vertex_start[mesh->face_indices[c] + 1]++;
        }
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        w->vertex_start[v + 1] += w->vertex_start[v];
    for (int32_t c = mesh->index_count - 1; c >= 0; c--)
        w->corner[--w->vertex_start[mesh->face_indices[c] + 1]] = c;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        w->vertex_start[v] = w->vertex_start[v + 1];
    w->vertex_start[mesh->vertex_count] = mesh->index_count;
}

/* Writes the unit vector of sum, unless it has no length. */
static void write_normal(const double sum[3], float *normal) {
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int k = 0; k < 3 && length > 0; k++)
        normal[k] = (float)(sum[k] / length);
}

static double dot(const float *a, const float *b) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Within a quarter of a degree, whatever their lengths: caches round normals. */
static bool same_normal(const float *a, const float *b) {
    double product = dot(a, b);
    return a == b || (product > 0 && product * product > (1 - 2e-5) * dot(a, a) * dot(b, b));
}

/* Sums faces around a vertex. With normals of corners, only those that share the normal of one corner. */
static bool sum_around(const work *w, int32_t vertex, const float *corner_normals, const float *normal, double sum[3]) {
    bool moved = false;
    sum[0] = sum[1] = sum[2] = 0;
    for (int32_t i = w->vertex_start[vertex]; i < w->vertex_start[vertex + 1]; i++) {
        int32_t c = w->corner[i], face = w->corner_face[c];
        if (corner_normals && !same_normal(corner_normals + 3 * (int64_t)c, normal))
            continue;
        moved |= w->face_moved[face];
        for (int k = 0; k < 3; k++)
            sum[k] += w->area[face][k];
    }
    return moved;
}

static void vertex_normals(const work *w, float *normals) {
    double sum[3];
    for (int32_t v = 0; v < w->mesh->vertex_count; v++)
        if (sum_around(w, v, NULL, NULL, sum))
            write_normal(sum, normals + 3 * (int64_t)v);
}

/* before: a copy of the cache's normals. */
static void corner_normals(const work *w, const float *before, float *normals) {
    double sum[3];
    for (int32_t c = 0; c < w->mesh->index_count; c++)
        if (sum_around(w, w->mesh->face_indices[c], before, before + 3 * (int64_t)c, sum))
            write_normal(sum, normals + 3 * (int64_t)c);
}

static void face_normals(const work *w, float *normals) {
    for (int32_t f = 0; f < w->mesh->face_count; f++)
        if (w->face_moved[f])
            write_normal(w->area[f], normals + 3 * (int64_t)f);
}

static skinslide_status allocate(ss_memory *memory, work *w, float **before, skinslide_error *error) {
    const skinslide_mesh *mesh = w->mesh;
    w->face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    w->face_moved = SS_NEW(memory, uint8_t, mesh->face_count);
    w->area = ss_new(memory, mesh->face_count, sizeof *w->area);
    w->vertex_start = SS_NEW(memory, int32_t, (int64_t)mesh->vertex_count + 1);
    w->corner = SS_NEW(memory, int32_t, mesh->index_count);
    w->corner_face = SS_NEW(memory, int32_t, mesh->index_count);
    *before = SS_NEW(memory, float, 3 * (int64_t)mesh->index_count);
    return memory->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

skinslide_status skinslide_normals(const skinslide_mesh *mesh, const float *cached, const float *slid,
                                   skinslide_normals_layout layout, skinslide_bool left_handed, float *normals,
                                   skinslide_error *error) {
    ss_taken_mesh taken;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (status)
        return status;
    if (!cached || !slid || !normals || (unsigned)layout > SKINSLIDE_NORMALS_UNIFORM)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points or normals, or no such layout of normals");
    ss_memory memory = {0};
    work w = {.mesh = mesh};
    float *before;
    status = allocate(&memory, &w, &before, error);
    if (!status) {
        list_corners(&w);
        measure_faces(&w, cached, slid, left_handed ? -1 : 1);
        if (layout == SKINSLIDE_NORMALS_VERTEX)
            vertex_normals(&w, normals);
        if (layout == SKINSLIDE_NORMALS_UNIFORM)
            face_normals(&w, normals);
        for (int64_t i = 0; layout == SKINSLIDE_NORMALS_FACE_VARYING && i < 3 * (int64_t)mesh->index_count; i++)
            before[i] = normals[i];
        if (layout == SKINSLIDE_NORMALS_FACE_VARYING)
            corner_normals(&w, before, normals);
    }
    ss_free(&memory);
    return status;
}
