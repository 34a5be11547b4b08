/* Faces and how they meet: edges, twins, connected pieces. */
#include "mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

int ss_ascending(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return x < y ? -1 : x > y;
}

int ss_ascending_pairs(const void *a, const void *b) {
    const int32_t *x = a, *y = b;
    return x[0] != y[0] ? ss_ascending(x, y) : ss_ascending(x + 1, y + 1);
}

/* ---- Checks ---- */

skinslide_status ss_refuse_vertex(const char *what, int32_t vertex, const float *numbers, int width, skinslide_status status,
                                  skinslide_error *error) {
    char shown[96];
    if (width == 3)
        snprintf(shown, sizeof shown, "(%g, %g, %g)", (double)numbers[0], (double)numbers[1], (double)numbers[2]);
    else
        snprintf(shown, sizeof shown, "%g", (double)numbers[0]);
    return ss_fail(error, status, "%s: vertex %d is not finite: %s", what, vertex, shown);
}

skinslide_status ss_check_points(const float *points, int32_t vertex_count, const char *what, skinslide_error *error) {
    if (!points)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no %s", what);
    for (int64_t i = 0; i < 3 * (int64_t)vertex_count; i++)
        if (!isfinite(points[i]))
            return ss_refuse_vertex(what, (int32_t)(i / 3), points + i / 3 * 3, 3, SKINSLIDE_BAD_POINTS, error);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_used(const skinslide_mesh *mesh, const float *points, const char *what, skinslide_error *error) {
    if (!points)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no %s", what);
    int32_t first = INT32_MAX;
    for (int32_t c = 0; c < mesh->index_count; c++) {
        const int32_t used[2] = {mesh->face_indices[c], ss_one(mesh, mesh->face_indices[c])};
        for (int k = 0; k < 2; k++)
            first = used[k] < first && !ss_is_finite(points + 3 * (int64_t)used[k]) ? used[k] : first;
    }
    if (first == INT32_MAX)
        return SKINSLIDE_OK;
    return ss_refuse_vertex(what, first, points + 3 * (int64_t)first, 3, SKINSLIDE_BAD_POINTS, error);
}

/* A vertex that others are one with must be one with itself. */
static skinslide_status check_weld(const skinslide_mesh *mesh, skinslide_error *error) {
    for (int32_t v = 0; mesh->weld && v < mesh->vertex_count; v++) {
        int32_t one = mesh->weld[v];
        if (one < 0 || one >= mesh->vertex_count || mesh->weld[one] != one)
            return ss_fail(error, SKINSLIDE_BAD_MESH, "weld: vertex %d is one with %d, which is none or is one with another", v,
                           one);
    }
    return SKINSLIDE_OK;
}

void ss_measure_rest(const skinslide_mesh *mesh, double size[3]) {
    for (int k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            const float *here = mesh->rest_points + 3 * (int64_t)v;
            if (ss_is_finite(here))
                low = here[k] < low ? here[k] : low, high = here[k] > high ? here[k] : high;
        }
        size[k] = high >= low ? (double)high - low : 0;
    }
}

skinslide_status ss_check_face_counts(const int32_t *counts, int32_t face_count, skinslide_error *error) {
    for (int32_t f = 0; f < face_count; f++)
        if (counts[f] < 0)
            return ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has %d vertices", f, counts[f]);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_members(const int32_t *indices, int32_t count, int32_t end, const char *what, skinslide_status status,
                                  skinslide_error *error) {
    for (int32_t i = 0; i < count; i++)
        if (indices[i] < 0 || indices[i] >= end)
            return ss_fail(error, status, "%s%d is not one of the mesh's %d", what, indices[i], end);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_faces(int32_t mesh_face_count, const int32_t *faces, int32_t face_count, skinslide_error *error) {
    if (face_count < 0 || (face_count && !faces))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no faces");
    return ss_check_members(faces, face_count, mesh_face_count, "face ", SKINSLIDE_BAD_ARGUMENT, error);
}

skinslide_status ss_refuse_repeated(const char *label, const char *element, skinslide_status status, skinslide_error *error) {
    return ss_fail(error, status, "%s: %s is listed more than once", label, element);
}

skinslide_status ss_check_mesh(const skinslide_mesh *mesh, skinslide_error *error) {
    if (!mesh || mesh->vertex_count < 0 || mesh->face_count < 0 || mesh->index_count < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or a negative count in it");
    if (mesh->face_count == 0)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "the mesh has no faces");
    if (!mesh->face_counts || !mesh->face_indices)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the mesh has no array of face counts or indices");
    int64_t corners = 0;
    skinslide_status status = ss_check_face_counts(mesh->face_counts, mesh->face_count, error);
    if (status)
        return status;
    for (int32_t f = 0; f < mesh->face_count; f++)
        corners += mesh->face_counts[f];
    if (corners != mesh->index_count)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "face counts add up to %lld, but there are %d face indices",
                       (long long)corners, mesh->index_count);
    for (int32_t f = 0, c = 0; f < mesh->face_count; f++)
        for (int32_t end = c + mesh->face_counts[f]; c < end; c++)
            if (mesh->face_indices[c] < 0 || mesh->face_indices[c] >= mesh->vertex_count)
                return ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has vertex %d, but the mesh has %d vertices", f,
                               mesh->face_indices[c], mesh->vertex_count);
    return check_weld(mesh, error);
}

skinslide_status ss_take_mesh(const skinslide_mesh **mesh, ss_taken_mesh *own, skinslide_error *error) {
    *own = (ss_taken_mesh){SKINSLIDE_MESH_DEFAULT, SKINSLIDE_SUBDIVISION_DEFAULT};
    skinslide_status status = ss_take(*mesh, "skinslide_mesh", &own->mesh, sizeof own->mesh, error);
    const skinslide_subdivision *subdivision = own->mesh.subdivision;
    if (!status)
        status = ss_take(subdivision, "skinslide_subdivision", &own->subdivision, sizeof own->subdivision, error);
    own->mesh.subdivision = subdivision ? &own->subdivision : NULL;
    *mesh = *mesh ? &own->mesh : NULL;
    return status ? status : ss_check_mesh(*mesh, error);
}

/* ---- Edges: sides sorted by their ends ---- */

static int by_ends(const void *a, const void *b) {
    const ss_side *x = a, *y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    return x->corner < y->corner ? -1 : x->corner > y->corner;
}

static void list_sides(const ss_faces *faces, ss_side *sides) {
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t a = faces->corner_vertex[c], b = faces->corner_vertex[ss_next_corner(faces, c)];
        sides[c] = (ss_side){a < b ? a : b, a < b ? b : a, c};
    }
    qsort(sides, (size_t)faces->corner_count, sizeof *sides, by_ends);
}

/* Whether an edge has one side, or two that go opposite ways. */
static bool is_sound(const ss_faces *faces, const ss_side *sides, int32_t count) {
    return count == 1 || (count == 2 && faces->corner_vertex[sides[0].corner] != faces->corner_vertex[sides[1].corner]);
}

/* Numbers the edges and pairs their sides. mesh_face names faces in messages. */
static skinslide_status pair_sides(ss_faces *faces, const ss_side *sides, const int32_t *mesh_face, const char *label,
                                   skinslide_error *error) {
    int32_t end;
    for (int32_t i = 0; i < faces->corner_count; i = end) {
        for (end = i; end < faces->corner_count && sides[end].low == sides[i].low && sides[end].high == sides[i].high; end++)
            faces->corner_edge[sides[end].corner] = faces->edge_count;
        faces->edge_count++;
        if (!is_sound(faces, sides + i, end - i))
            return ss_refuse_edge(faces, sides + i, end - i, mesh_face, label, error);
        int32_t first = sides[i].corner, second = end - i == 2 ? sides[i + 1].corner : -1;
        faces->corner_twin[first] = second;
        if (second >= 0)
            faces->corner_twin[second] = first;
    }
    return SKINSLIDE_OK;
}

bool ss_number_edges(ss_faces *faces) {
    ss_memory scratch = {0};
    ss_side *sides = SS_NEW(&scratch, ss_side, faces->corner_count);
    if (scratch.failed)
        return false;
    list_sides(faces, sides);
    faces->edge_count = 0;
    for (int32_t i = 0; i < faces->corner_count; i++) {
        bool same = i > 0 && sides[i].low == sides[i - 1].low && sides[i].high == sides[i - 1].high;
        faces->edge_count += !same;
        faces->corner_edge[sides[i].corner] = faces->edge_count - 1;
    }
    ss_free(&scratch);
    return true;
}

/* ---- The faces of a patch ---- */

/* Checks face `own` of the patch, which is `face` of the mesh. sorted is scratch of its size. */
static skinslide_status check_face(const ss_faces *faces, int32_t own, int32_t face, int32_t *sorted, const char *label,
                                   skinslide_error *error) {
    int32_t count = faces->face_start[own + 1] - faces->face_start[own];
    if (count < 3)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "%s: face %d has %d vertices; a face needs 3", label, face, count);
    for (int32_t k = 0; k < count; k++)
        sorted[k] = faces->corner_vertex[faces->face_start[own] + k];
    qsort(sorted, (size_t)count, sizeof *sorted, ss_ascending);
    for (int32_t k = 1; k < count; k++)
        if (sorted[k] == sorted[k - 1])
            return ss_fail(error, SKINSLIDE_BAD_MESH, "%s: face %d has vertex %d more than once", label, face, sorted[k]);
    return SKINSLIDE_OK;
}

const int32_t *ss_list_starts(const skinslide_mesh *mesh, ss_memory *memory) {
    int32_t *face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    if (face_start)
        ss_start_faces(mesh, face_start);
    return face_start;
}

skinslide_status ss_take_faces(const skinslide_mesh *mesh, const int32_t *face_start, const int32_t *chosen, int32_t count,
                               const char *label, ss_memory *memory, ss_faces *faces, skinslide_error *error) {
    ss_memory scratch = {0};
    if (!face_start && !(face_start = ss_list_starts(mesh, &scratch)))
        return ss_out_of_memory(error);
    int32_t corners = 0;
    for (int32_t f = 0; f < count; f++)
        corners += mesh->face_counts[chosen[f]];
    *faces = (ss_faces){.face_count = count, .corner_count = corners};
    faces->face_start = SS_NEW(memory, int32_t, (int64_t)count + 1);
    faces->corner_vertex = SS_NEW(memory, int32_t, corners);
    faces->corner_face = SS_NEW(memory, int32_t, corners);
    faces->corner_twin = SS_NEW(memory, int32_t, corners);
    faces->corner_edge = SS_NEW(memory, int32_t, corners);
    ss_side *sides = SS_NEW(&scratch, ss_side, corners);
    int32_t *sorted = SS_NEW(&scratch, int32_t, corners);
    skinslide_status status = memory->failed || scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t f = 0, c = 0; f < count && !status; f++) {
        const int32_t *vertices = mesh->face_indices + face_start[chosen[f]];
        for (int32_t k = 0; k < mesh->face_counts[chosen[f]]; k++, c++) {
            faces->corner_vertex[c] = ss_one(mesh, vertices[k]);
            faces->corner_face[c] = f;
        }
        faces->face_start[f + 1] = c;
        status = check_face(faces, f, chosen[f], sorted, label, error);
    }
    if (!status) {
        list_sides(faces, sides);
        status = pair_sides(faces, sides, chosen, label, error);
    }
    ss_free(&scratch);
    return status;
}

int32_t ss_number_pieces(const ss_faces *faces, int32_t *piece_of_face, int32_t *stack) {
    int32_t pieces = 0;
    for (int32_t f = 0; f < faces->face_count; f++)
        piece_of_face[f] = -1;
    for (int32_t seed = 0; seed < faces->face_count; seed++) {
        if (piece_of_face[seed] >= 0)
            continue;
        int32_t top = 0;
        stack[top++] = seed;
        piece_of_face[seed] = pieces;
        while (top) {
            int32_t f = stack[--top];
            for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1]; c++) {
                int32_t g = faces->corner_twin[c] < 0 ? f : faces->corner_face[faces->corner_twin[c]];
                if (piece_of_face[g] < 0) {
                    piece_of_face[g] = pieces;
                    stack[top++] = g;
                }
            }
        }
        pieces++;
    }
    return pieces;
}

int32_t ss_largest_face(const ss_faces *faces) {
    int32_t largest = 3;
    for (int32_t f = 0; f < faces->face_count; f++)
        largest = ss_fan_size(faces, f) + 2 > largest ? ss_fan_size(faces, f) + 2 : largest;
    return largest;
}
