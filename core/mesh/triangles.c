/* The deformed patch as a surface to slide on: the fan triangles of its faces, as `linear` interpolates in them, how they meet,
 * and how they lie in a pose. */
#include "patch.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

/* ---- Fans ---- */

int32_t ss_fan_of_side(const ss_faces *faces, int32_t corner) {
    int32_t face = faces->corner_face[corner], side = corner - faces->face_start[face], last = ss_fan_size(faces, face) - 1;
    return side == 0 ? 0 : side - 1 > last ? last : side - 1;
}

int32_t ss_largest_face(const ss_faces *faces) {
    int32_t largest = 3;
    for (int32_t f = 0; f < faces->face_count; f++)
        largest = ss_fan_size(faces, f) + 2 > largest ? ss_fan_size(faces, f) + 2 : largest;
    return largest;
}

/* ---- All the triangles of a patch ---- */

static int32_t triangle_of_side(const ss_triangles *triangles, int32_t corner) {
    const ss_faces *faces = &triangles->patch->faces;
    return triangles->first_triangle[faces->corner_face[corner]] + ss_fan_of_side(faces, corner);
}

static int32_t across(const ss_triangles *triangles, int32_t corner) {
    int32_t twin = triangles->patch->faces.corner_twin[corner];
    return twin < 0 ? -1 : triangle_of_side(triangles, twin);
}

static void number_triangles(ss_triangles *triangles) {
    const ss_faces *faces = &triangles->patch->faces;
    for (int32_t f = 0, t = 0; f < faces->face_count; f++) {
        triangles->first_triangle[f] = t;
        for (int32_t k = 0; k < ss_fan_size(faces, f); k++, t++) {
            ss_fan(faces, f, k, triangles->vertex[t]);
            triangles->face[t] = f;
        }
    }
}

static void join_triangles(ss_triangles *triangles) {
    const ss_faces *faces = &triangles->patch->faces;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        int32_t face = triangles->face[t], k = t - triangles->first_triangle[face], corner = faces->face_start[face];
        triangles->neighbour[t][0] = k == 0 ? across(triangles, corner) : t - 1;
        triangles->neighbour[t][1] = across(triangles, corner + k + 1);
        triangles->neighbour[t][2] = k == ss_fan_size(faces, face) - 1 ? across(triangles, corner + k + 2) : t + 1;
        for (int j = 0; j < 3; j++)
            if (triangles->vertex_triangle[triangles->vertex[t][j]] < 0 || triangles->neighbour[t][j] < 0)
                triangles->vertex_triangle[triangles->vertex[t][j]] = t;
    }
}

skinslide_status ss_triangles_create(const ss_patch *patch, ss_triangles **out, skinslide_error *error) {
    ss_triangles *triangles = calloc(1, sizeof *triangles);
    if (!triangles)
        return ss_out_of_memory(error);
    ss_memory *memory = &triangles->memory;
    int32_t count = patch->faces.corner_count - 2 * patch->faces.face_count;
    triangles->patch = patch;
    triangles->triangle_count = count;
    triangles->vertex = ss_new(memory, count, sizeof *triangles->vertex);
    triangles->neighbour = ss_new(memory, count, sizeof *triangles->neighbour);
    triangles->face = SS_NEW(memory, int32_t, count);
    triangles->first_triangle = SS_NEW(memory, int32_t, patch->faces.face_count);
    triangles->vertex_triangle = SS_NEW(memory, int32_t, patch->vertex_count);
    if (memory->failed) {
        ss_triangles_destroy(triangles);
        return ss_out_of_memory(error);
    }
    for (int32_t v = 0; v < patch->vertex_count; v++)
        triangles->vertex_triangle[v] = -1;
    number_triangles(triangles);
    join_triangles(triangles);
    *out = triangles;
    return SKINSLIDE_OK;
}

void ss_triangles_destroy(ss_triangles *triangles) {
    if (!triangles)
        return;
    ss_free(&triangles->memory);
    free(triangles);
}

int ss_triangle_corner(const ss_triangles *triangles, int32_t triangle, int32_t vertex) {
    const int32_t *v = triangles->vertex[triangle];
    return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

/* ---- A pose ---- */

bool ss_posed_allocate(ss_memory *memory, const ss_triangles *triangles, ss_posed *pose) {
    int32_t vertices = triangles->patch->vertex_count;
    pose->triangles = triangles;
    pose->point = ss_new(memory, vertices, sizeof *pose->point);
    pose->facet = SS_NEW(memory, ss_facet, triangles->triangle_count);
    return !memory->failed;
}

static void measure_facet(const double *a, const double *b, const double *c, ss_facet *facet) {
    ss_subtract(b, a, facet->first);
    ss_subtract(c, a, facet->second);
    ss_cross(facet->first, facet->second, facet->normal);
    double square = ss_dot(facet->normal, facet->normal);
    facet->has_area = square > 0 && isfinite(1 / square);
    facet->gram[0] = facet->has_area ? ss_dot(facet->second, facet->second) / square : 0;
    facet->gram[1] = facet->has_area ? -ss_dot(facet->first, facet->second) / square : 0;
    facet->gram[2] = facet->has_area ? ss_dot(facet->first, facet->first) / square : 0;
    ss_normalise(facet->normal);
}

static void set_facets(ss_posed *pose) {
    for (int32_t t = 0; t < pose->triangles->triangle_count; t++) {
        const int32_t *v = pose->triangles->vertex[t];
        measure_facet(pose->point[v[0]], pose->point[v[1]], pose->point[v[2]], &pose->facet[t]);
    }
}

/* Not moved to the patch's centre: so differences are those of ss_edge_lengths, to the bit, and rest has no stretch at all. */
void ss_take_points(const ss_patch *patch, const float *points, double (*out)[3]) {
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            out[v][k] = points[3 * (int64_t)patch->mesh_vertex[v] + k];
}

void ss_posed_set(ss_posed *pose, const float *points) {
    ss_take_points(pose->triangles->patch, points, pose->point);
    set_facets(pose);
}

void ss_posed_set_plane(ss_posed *pose, const double (*uv)[2]) {
    for (int32_t v = 0; v < pose->triangles->patch->vertex_count; v++)
        pose->point[v][0] = uv[v][0], pose->point[v][1] = uv[v][1], pose->point[v][2] = 0;
    set_facets(pose);
}
