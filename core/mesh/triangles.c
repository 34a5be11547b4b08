/* The fan triangles of a patch's faces, as `linear` interpolates in them, and how they meet. */
#include "mesh.h"

/* The triangle of the fan that has the side which begins at a corner. */
static int32_t fan_of_side(const ss_faces *faces, int32_t corner) {
    int32_t face = faces->corner_face[corner], side = corner - faces->face_start[face], last = ss_fan_size(faces, face) - 1;
    return side == 0 ? 0 : side - 1 > last ? last : side - 1;
}

int32_t ss_triangle_of_side(const ss_patch *patch, int32_t corner) {
    return patch->triangles.first_triangle[patch->faces.corner_face[corner]] + fan_of_side(&patch->faces, corner);
}

int ss_triangle_corner(const ss_patch *patch, int32_t triangle, int32_t vertex) {
    const int32_t *v = patch->triangles.vertex[triangle];
    return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

static int32_t across(const ss_patch *patch, int32_t corner) {
    int32_t twin = patch->faces.corner_twin[corner];
    return twin < 0 ? -1 : ss_triangle_of_side(patch, twin);
}

static void number_triangles(ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    ss_triangles *triangles = &patch->triangles;
    for (int32_t f = 0, t = 0; f < faces->face_count; f++) {
        triangles->first_triangle[f] = t;
        for (int32_t k = 0; k < ss_fan_size(faces, f); k++, t++) {
            ss_fan(faces, f, k, triangles->vertex[t]);
            triangles->face[t] = f;
        }
    }
}

static void join_triangles(ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    ss_triangles *triangles = &patch->triangles;
    for (int32_t t = 0; t < triangles->count; t++) {
        int32_t face = triangles->face[t], k = t - triangles->first_triangle[face], corner = faces->face_start[face];
        triangles->neighbour[t][0] = k == 0 ? across(patch, corner) : t - 1;
        triangles->neighbour[t][1] = across(patch, corner + k + 1);
        triangles->neighbour[t][2] = k == ss_fan_size(faces, face) - 1 ? across(patch, corner + k + 2) : t + 1;
        for (int j = 0; j < 3; j++)
            if (triangles->vertex_triangle[triangles->vertex[t][j]] < 0 || triangles->neighbour[t][j] < 0)
                triangles->vertex_triangle[triangles->vertex[t][j]] = t;
    }
}

bool ss_list_triangles(ss_patch *patch) {
    ss_memory *memory = &patch->memory;
    ss_triangles *triangles = &patch->triangles;
    int32_t count = patch->faces.corner_count - 2 * patch->faces.face_count;
    triangles->count = count;
    triangles->vertex = ss_new(memory, count, sizeof *triangles->vertex);
    triangles->neighbour = ss_new(memory, count, sizeof *triangles->neighbour);
    triangles->face = SS_NEW(memory, int32_t, count);
    triangles->first_triangle = SS_NEW(memory, int32_t, patch->faces.face_count);
    triangles->vertex_triangle = SS_NEW(memory, int32_t, patch->vertex_count);
    if (memory->failed)
        return false;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        triangles->vertex_triangle[v] = -1;
    number_triangles(patch);
    join_triangles(patch);
    return true;
}
