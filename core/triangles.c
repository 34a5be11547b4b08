/* The deformed patch as a surface to slide on: the fan triangles of its faces, as `linear` interpolates in them, how they meet,
 * and how they lie in a pose. */
#include "site.h"

#include <stdlib.h>
#include <string.h>

static int32_t triangle_of_side(const ss_surface *surface, int32_t corner) {
    const ss_faces *faces = &surface->patch->faces;
    return surface->first_triangle[faces->corner_face[corner]] + ss_fan_of_side(faces, corner);
}

static int32_t across(const ss_surface *surface, int32_t corner) {
    int32_t twin = surface->patch->faces.corner_twin[corner];
    return twin < 0 ? -1 : triangle_of_side(surface, twin);
}

static void number_triangles(ss_surface *surface) {
    const ss_faces *faces = &surface->patch->faces;
    for (int32_t f = 0, t = 0; f < faces->face_count; f++) {
        surface->first_triangle[f] = t;
        for (int32_t k = 0; k < ss_fan_size(faces, f); k++, t++) {
            ss_fan(faces, f, k, surface->vertex[t]);
            surface->face[t] = f;
        }
    }
}

static void join_triangles(ss_surface *surface) {
    const ss_faces *faces = &surface->patch->faces;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        int32_t face = surface->face[t], k = t - surface->first_triangle[face], corner = faces->face_start[face];
        surface->neighbour[t][0] = k == 0 ? across(surface, corner) : t - 1;
        surface->neighbour[t][1] = across(surface, corner + k + 1);
        surface->neighbour[t][2] = k == ss_fan_size(faces, face) - 1 ? across(surface, corner + k + 2) : t + 1;
        for (int j = 0; j < 3; j++)
            if (surface->vertex_triangle[surface->vertex[t][j]] < 0 || surface->neighbour[t][j] < 0)
                surface->vertex_triangle[surface->vertex[t][j]] = t;
    }
}

skinslide_status ss_surface_create(const ss_patch *patch, ss_surface **out, skinslide_error *error) {
    ss_surface *surface = calloc(1, sizeof *surface);
    if (!surface)
        return ss_out_of_memory(error);
    ss_memory *memory = &surface->memory;
    int32_t count = patch->faces.corner_count - 2 * patch->faces.face_count;
    surface->patch = patch;
    surface->triangle_count = count;
    surface->vertex = ss_new(memory, count, sizeof *surface->vertex);
    surface->neighbour = ss_new(memory, count, sizeof *surface->neighbour);
    surface->face = SS_NEW(memory, int32_t, count);
    surface->first_triangle = SS_NEW(memory, int32_t, patch->faces.face_count);
    surface->vertex_triangle = SS_NEW(memory, int32_t, patch->vertex_count);
    if (memory->failed) {
        ss_surface_destroy(surface);
        return ss_out_of_memory(error);
    }
    for (int32_t v = 0; v < patch->vertex_count; v++)
        surface->vertex_triangle[v] = -1;
    number_triangles(surface);
    join_triangles(surface);
    *out = surface;
    return SKINSLIDE_OK;
}

void ss_surface_destroy(ss_surface *surface) {
    if (!surface)
        return;
    ss_free(&surface->memory);
    free(surface);
}

int ss_triangle_corner(const ss_surface *surface, int32_t triangle, int32_t vertex) {
    const int32_t *v = surface->vertex[triangle];
    return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

/* ---- A pose ---- */

bool ss_shape_allocate(ss_memory *memory, const ss_surface *surface, ss_shape *pose) {
    int32_t vertices = surface->patch->vertex_count;
    pose->surface = surface;
    pose->point = ss_new(memory, vertices, sizeof *pose->point);
    pose->normal = ss_new(memory, vertices, sizeof *pose->normal);
    pose->blunt_normal = ss_new(memory, vertices, sizeof *pose->blunt_normal);
    pose->facet = SS_NEW(memory, ss_facet, surface->triangle_count);
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
}

/* Not moved to the patch's centre: so differences are those of ss_edge_lengths, to the bit, and rest has no stretch at all. */
static void set_points(ss_shape *pose, const float *points) {
    const ss_patch *patch = pose->surface->patch;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            pose->point[v][k] = points[3 * (int64_t)patch->mesh_vertex[v] + k];
}

static void normalise_all(double (*normal)[3], int32_t count) {
    for (int32_t v = 0; v < count; v++)
        ss_normalise(normal[v]);
}

static void set_facets(ss_shape *pose) {
    const ss_surface *surface = pose->surface;
    int32_t vertices = surface->patch->vertex_count;
    memset(pose->normal, 0, (size_t)vertices * sizeof *pose->normal);
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *v = surface->vertex[t];
        ss_facet *facet = &pose->facet[t];
        measure_facet(pose->point[v[0]], pose->point[v[1]], pose->point[v[2]], facet);
        for (int j = 0; j < 3; j++)
            ss_add(1, facet->normal, pose->normal[v[j]]);
        ss_normalise(facet->normal);
    }
    normalise_all(pose->normal, vertices);
}

/* Each edge in turn brings the normals of its ends nearer to each other: an average over neighbours that needs no second array.
 */
static void blunt_normals(ss_shape *pose) {
    const ss_patch *patch = pose->surface->patch;
    memcpy(pose->blunt_normal, pose->normal, (size_t)patch->vertex_count * sizeof *pose->normal);
    for (int round = 0; round < 3; round++) {
        for (int32_t e = 0; e < patch->faces.edge_count; e++) {
            double *a = pose->blunt_normal[patch->edge_vertex[e][0]], *b = pose->blunt_normal[patch->edge_vertex[e][1]];
            double before[3] = {a[0], a[1], a[2]};
            ss_add(1, b, a);
            ss_add(1, before, b);
        }
        normalise_all(pose->blunt_normal, patch->vertex_count);
    }
}

void ss_shape_set(ss_shape *pose, const float *points) {
    pose->manner = SS_ROUND;
    set_points(pose, points);
    set_facets(pose);
    blunt_normals(pose);
}

void ss_shape_set_plane(ss_shape *pose, const double (*uv)[2]) {
    pose->manner = SS_ROUND;
    for (int32_t v = 0; v < pose->surface->patch->vertex_count; v++)
        pose->point[v][0] = uv[v][0], pose->point[v][1] = uv[v][1], pose->point[v][2] = 0;
    set_facets(pose);
}
