/* The other side of a symmetric mesh: which face and which vertices mirror those of a patch. */
#include "paint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NAMED 8 /* vertices in a message */

typedef struct place {
    float coordinate;
    int32_t vertex;
} place;

typedef struct mirror {
    const skinslide_mesh *mesh;
    int axis, along; /* along: an axis of the plane, by which vertices are sorted */
    double plane, tolerance;
    int32_t place_count;
    place *places;         /* [place_count] ascending */
    int32_t *face_start;   /* [face_count + 1] */
    int32_t *vertex_start; /* [vertex_count + 1] */
    int32_t *corner;       /* [index_count] corners at each vertex */
    int32_t *corner_face;  /* [index_count] */
    int32_t *vertex;       /* [vertex_count] found so far, -1: none */
    uint8_t *taken;        /* [face_count] */
} mirror;

/* ---- Vertices by place ---- */

static int by_coordinate(const void *a, const void *b) {
    const place *x = a, *y = b;
    if (x->coordinate != y->coordinate)
        return x->coordinate < y->coordinate ? -1 : 1;
    return x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

int ss_sort_along(const skinslide_mesh *mesh, int axis, double *tolerance) {
    double size[3];
    ss_measure_rest(mesh, size);
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    if (*tolerance < 0)
        *tolerance = 1e-4 * fmax(fmax(size[0], size[1]), size[2]);
    return size[a] >= size[b] ? a : b;
}

/* Of the points that are finite. */
static void sort_places(mirror *m) {
    for (int32_t v = 0; v < m->mesh->vertex_count; v++) {
        const float *at = m->mesh->rest_points + 3 * (int64_t)v;
        if (ss_is_finite(at))
            m->places[m->place_count++] = (place){at[m->along], v};
    }
    qsort(m->places, (size_t)m->place_count, sizeof *m->places, by_coordinate);
}

/* The first place with a coordinate of at least low. */
static int32_t first_place(const mirror *m, double low) {
    int32_t begin = 0, end = m->place_count;
    while (begin < end) {
        int32_t middle = begin + (end - begin) / 2;
        if (m->places[middle].coordinate < low)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/* Distance between the mirror image of one vertex and another. */
static double distance(const mirror *m, int32_t vertex, int32_t other) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double a = m->mesh->rest_points[3 * (int64_t)vertex + k], b = m->mesh->rest_points[3 * (int64_t)other + k];
        double off = k == m->axis ? 2 * m->plane - a - b : a - b;
        sum += off * off;
    }
    return sqrt(sum);
}

/* The next place, from one on, whose vertex is within tolerance of the mirror image of vertex; -1 where there is none. */
static int32_t next_candidate(const mirror *m, int32_t vertex, int32_t from) {
    double high = m->mesh->rest_points[3 * (int64_t)vertex + m->along] + m->tolerance;
    for (int32_t p = from; p < m->place_count && m->places[p].coordinate <= high; p++)
        if (distance(m, vertex, m->places[p].vertex) <= m->tolerance)
            return p;
    return -1;
}

static int32_t first_candidate(const mirror *m, int32_t vertex) {
    return next_candidate(m, vertex, first_place(m, m->mesh->rest_points[3 * (int64_t)vertex + m->along] - m->tolerance));
}

/* ---- Corners ---- */

static void list_corners(mirror *m) {
    const skinslide_mesh *mesh = m->mesh;
    ss_start_faces(mesh, m->face_start);
    for (int32_t f = 0; f < mesh->face_count; f++)
        for (int32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++)
            m->corner_face[c] = f;
    for (int32_t c = 0; c < mesh->index_count; c++)
        m->vertex_start[mesh->face_indices[c] + 1]++;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        m->vertex_start[v + 1] += m->vertex_start[v];
    for (int32_t c = mesh->index_count - 1; c >= 0; c--) /* backwards, so that vertex_start ends where it began */
        m->corner[--m->vertex_start[mesh->face_indices[c] + 1]] = c;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        m->vertex_start[v] = m->vertex_start[v + 1];
    m->vertex_start[mesh->vertex_count] = mesh->index_count;
}

/* ---- Faces ---- */

/* The vertex of a face n corners before (turn -1) or after (turn 1) one of its corners. */
static int32_t vertex_from(const mirror *m, int32_t corner, int32_t n, int turn) {
    int32_t face = m->corner_face[corner], start = m->face_start[face], count = m->face_start[face + 1] - start;
    return m->mesh->face_indices[start + (corner - start + turn * n + count) % count];
}

/* How far a face is from mirroring another, if the other's first corner corresponds to a corner of it: the sum of distances of
 * their corners; INFINITY where it mirrors it not at all. */
static double misfit(const mirror *m, int32_t face, int32_t corner, int turn) {
    int32_t start = m->face_start[face], count = m->face_start[face + 1] - start, other = m->corner_face[corner];
    if (m->face_start[other + 1] - m->face_start[other] != count || m->taken[other])
        return INFINITY;
    double sum = 0;
    for (int32_t n = 0; n < count; n++) {
        int32_t vertex = m->mesh->face_indices[start + n], image = vertex_from(m, corner, n, turn);
        double off = distance(m, vertex, image);
        if (off > m->tolerance || (m->vertex[vertex] >= 0 && m->vertex[vertex] != image))
            return INFINITY;
        sum += off;
    }
    return sum;
}

/* The corner that mirrors the first of a face, and which way round; -1 where there is none. Mirrored faces run the other way
 * round, which is preferred: a flat sheet with a back has faces of both ways in one place. */
static int32_t find_corner(const mirror *m, int32_t face, int *turn) {
    int32_t vertex = m->mesh->face_indices[m->face_start[face]], best = -1;
    for (*turn = -1; *turn <= 1; *turn += 2) {
        double least = INFINITY;
        for (int32_t p = first_candidate(m, vertex); p >= 0; p = next_candidate(m, vertex, p + 1))
            for (int32_t i = m->vertex_start[m->places[p].vertex]; i < m->vertex_start[m->places[p].vertex + 1]; i++) {
                double off = misfit(m, face, m->corner[i], *turn);
                if (off < least)
                    least = off, best = m->corner[i];
            }
        if (best >= 0)
            return best;
    }
    return -1;
}

static bool mirror_face(mirror *m, int32_t face, int32_t *out) {
    int turn;
    int32_t count = m->face_start[face + 1] - m->face_start[face], corner = count ? find_corner(m, face, &turn) : -1;
    if (corner < 0)
        return false;
    for (int32_t n = 0; n < count; n++)
        m->vertex[m->mesh->face_indices[m->face_start[face] + n]] = vertex_from(m, corner, n, turn);
    *out = m->corner_face[corner];
    m->taken[*out] = 1;
    return true;
}

/* ---- What has no counterpart ---- */

/* Vertices of the faces without a candidate, each once, ascending: marked in lost [vertex_count]. */
static int32_t find_lost(const mirror *m, const int32_t *faces, int32_t face_count, uint8_t *lost) {
    int32_t count = 0;
    for (int32_t i = 0; i < face_count; i++)
        for (int32_t c = m->face_start[faces[i]]; c < m->face_start[faces[i] + 1]; c++) {
            int32_t vertex = m->mesh->face_indices[c];
            if (!lost[vertex] && first_candidate(m, vertex) < 0)
                lost[vertex] = 1, count++;
        }
    return count;
}

static skinslide_status name_lost(const mirror *m, const uint8_t *lost, int32_t count, skinslide_error *error) {
    char list[128];
    int used = 0;
    int32_t named = 0;
    for (int32_t v = 0; v < m->mesh->vertex_count && named < NAMED; v++)
        if (lost[v])
            used += snprintf(list + used, sizeof list - (size_t)used, "%s%d", named++ ? ", " : "", v);
    if (count > named)
        snprintf(list + used, sizeof list - (size_t)used, " and %d more", count - named);
    return ss_fail(error, SKINSLIDE_BAD_MESH, "point%s %s ha%s no mirror image within %g beyond %c = %g", count > 1 ? "s" : "",
                   list, count > 1 ? "ve" : "s", m->tolerance, ss_axis_name(m->axis), m->plane);
}

static skinslide_status allocate(mirror *m, ss_memory *memory, uint8_t **lost, skinslide_error *error) {
    const skinslide_mesh *mesh = m->mesh;
    m->places = SS_NEW(memory, place, mesh->vertex_count);
    m->face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    m->vertex_start = SS_NEW(memory, int32_t, (int64_t)mesh->vertex_count + 1);
    m->corner = SS_NEW(memory, int32_t, mesh->index_count);
    m->corner_face = SS_NEW(memory, int32_t, mesh->index_count);
    m->vertex = SS_NEW(memory, int32_t, mesh->vertex_count);
    m->taken = SS_NEW(memory, uint8_t, mesh->face_count);
    *lost = SS_NEW(memory, uint8_t, mesh->vertex_count);
    return memory->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

skinslide_status ss_take_mirror(const skinslide_mesh *mesh, const skinslide_mirror_options *options, const int32_t *faces,
                                int32_t face_count, skinslide_mirror_options *own, skinslide_error *error) {
    skinslide_status status = ss_check_used(mesh, mesh->rest_points, "rest points", error);
    if (!status)
        status = ss_take(options, "skinslide_mirror_options", own, sizeof *own, error);
    if (status)
        return status;
    if (own->axis < 0 || own->axis > 2 || !isfinite(own->plane) || !isfinite(own->tolerance))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "axis %d, plane %g, tolerance %g", own->axis, own->plane, own->tolerance);
    return ss_check_faces(mesh->face_count, faces, face_count, error);
}

/* Fills m->vertex, and mirror_faces of the caller's. */
static skinslide_status mirror_faces_of(mirror *m, const int32_t *faces, int32_t face_count, uint8_t *lost,
                                        int32_t *mirror_faces, skinslide_error *error) {
    list_corners(m);
    sort_places(m);
    for (int32_t v = 0; v < m->mesh->vertex_count; v++)
        m->vertex[v] = -1;
    int32_t count = find_lost(m, faces, face_count, lost);
    if (count)
        return name_lost(m, lost, count, error);
    for (int32_t i = 0; i < face_count; i++)
        if (!mirror_face(m, faces[i], &mirror_faces[i]))
            return ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has no mirror image beyond %c = %g, though its points have",
                           faces[i], ss_axis_name(m->axis), m->plane);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_mirror(const skinslide_mesh *mesh, const skinslide_mirror_options *options, const int32_t *faces,
                                  int32_t face_count, int32_t *mirror_faces, int32_t *mirror_vertices, skinslide_error *error) {
    ss_taken_mesh taken;
    skinslide_mirror_options own = SKINSLIDE_MIRROR_OPTIONS_DEFAULT;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (!status)
        status = ss_take_mirror(mesh, options, faces, face_count, &own, error);
    if (status || !mirror_faces || !mirror_vertices)
        return status ? status : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for what is found");
    ss_memory memory = {0};
    mirror m = {.mesh = mesh, .axis = own.axis, .plane = own.plane, .tolerance = own.tolerance};
    m.along = ss_sort_along(mesh, m.axis, &m.tolerance);
    uint8_t *lost;
    status = allocate(&m, &memory, &lost, error);
    int32_t *found = SS_NEW(&memory, int32_t, face_count);
    if (!status)
        status = memory.failed ? ss_out_of_memory(error) : mirror_faces_of(&m, faces, face_count, lost, found, error);
    for (int32_t i = 0; !status && i < face_count; i++)
        mirror_faces[i] = found[i];
    for (int32_t v = 0; !status && v < mesh->vertex_count; v++)
        mirror_vertices[v] = m.vertex[v];
    ss_free(&memory);
    return status;
}
