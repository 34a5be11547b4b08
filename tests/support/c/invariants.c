/* See invariants.h. */
#include "invariants.h"

#include <stdlib.h>

static int32_t side_end(const ss_faces *faces, int32_t corner) {
    return faces->corner_vertex[ss_next_corner(faces, corner)];
}

static void check_corner(const ss_faces *faces, int32_t c) {
    assert_int_equal(ss_previous_corner(faces, ss_next_corner(faces, c)), c);
    assert_in_range(faces->corner_edge[c], 0, faces->edge_count - 1);
    int32_t twin = faces->corner_twin[c];
    if (twin < 0)
        return;
    assert_int_equal(faces->corner_twin[twin], c);
    assert_int_equal(faces->corner_edge[twin], faces->corner_edge[c]);
    assert_int_equal(faces->corner_vertex[twin], side_end(faces, c));
    assert_int_equal(side_end(faces, twin), faces->corner_vertex[c]);
}

void assert_faces_hold(const ss_faces *faces) {
    assert_int_equal(faces->face_start[0], 0);
    assert_int_equal(faces->face_start[faces->face_count], faces->corner_count);
    for (int32_t f = 0; f < faces->face_count; f++)
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1]; c++) {
            assert_int_equal(faces->corner_face[c], f);
            check_corner(faces, c);
        }
}

/* The ends of each edge, lower first, sort after those of the edge before, and each side is between the ends of its edge. */
static void check_edges(const ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    for (int32_t e = 0; e < faces->edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e], *u = e ? patch->edge_vertex[e - 1] : NULL;
        assert_true(v[0] < v[1]);
        assert_true(!u || u[0] < v[0] || (u[0] == v[0] && u[1] < v[1]));
        assert_int_equal(ss_patch_edge(patch, v[1], v[0]), e);
        assert_true(patch->rest_length[e] >= patch->shortest);
    }
    for (int32_t c = 0; c < faces->corner_count; c++)
        assert_int_equal(ss_patch_edge(patch, faces->corner_vertex[c], side_end(faces, c)), faces->corner_edge[c]);
}

static int32_t boundary_sides(const ss_faces *faces) {
    int32_t sides = 0;
    for (int32_t c = 0; c < faces->corner_count; c++)
        sides += faces->corner_twin[c] < 0;
    return sides;
}

/* Each vertex of a loop leads to the next by its boundary side; every boundary side is in one loop, once. */
static void check_loops(const ss_patch *patch) {
    int32_t sides = 0;
    for (int32_t loop = 0; loop < patch->loop_count; loop++) {
        int32_t begin = patch->loop_start[loop], end = patch->loop_start[loop + 1];
        assert_true(end - begin >= 3);
        for (int32_t i = begin; i < end; i++, sides++) {
            int32_t v = patch->loop_vertex[i], corner = patch->vertex_corner[v];
            assert_int_equal(patch->vertex_loop[v], loop);
            assert_true(patch->faces.corner_twin[corner] < 0);
            assert_int_equal(side_end(&patch->faces, corner), patch->loop_vertex[i + 1 < end ? i + 1 : begin]);
        }
    }
    assert_int_equal(sides, boundary_sides(&patch->faces));
}

static void check_free(const ss_patch *patch) {
    int32_t fixed = 0;
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        bool outer = patch->vertex_loop[v] == 0, hole = patch->vertex_loop[v] > 0;
        bool hold = (outer && patch->setup->holes != SKINSLIDE_HOLES_FREE_ALL) ||
                    (hole && patch->setup->holes == SKINSLIDE_HOLES_PINNED) || patch->split[v] ||
                    (patch->shared[v] && (outer || hole || !ss_has_plane(patch->setup->rule)));
        assert_int_equal(patch->fixed[v], hold);
        fixed += hold;
    }
    assert_int_equal(fixed + patch->free_count, patch->vertex_count);
    uint8_t *seen = calloc((size_t)patch->vertex_count, 1);
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i], before = patch->free_before[i];
        assert_false(patch->fixed[v] || seen[v]);
        seen[v] = 1;
        assert_true(before < i);
        if (before >= 0)
            assert_true(ss_patch_edge(patch, v, patch->free_vertex[before]) >= 0);
    }
    free(seen);
}

/* Patch vertices of one mesh vertex are numbered one after the other, and marked as split. */
static void check_vertices(const ss_patch *patch) {
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        int32_t own = patch->mesh_vertex[v], first = ss_patch_vertex(patch, own);
        assert_int_equal(patch->faces.corner_vertex[patch->vertex_corner[v]], v);
        assert_int_equal(patch->mesh_vertex[first], own);
        assert_true(first == 0 || patch->mesh_vertex[first - 1] < own);
        assert_true(v == 0 || patch->mesh_vertex[v - 1] <= own);
        assert_int_equal(patch->split[v], v > first || (v + 1 < patch->vertex_count && patch->mesh_vertex[v + 1] == own));
    }
}

void assert_surface_holds(const ss_patch *patch) {
    assert_faces_hold(&patch->faces);
    check_vertices(patch);
    check_edges(patch);
    check_loops(patch);
    check_free(patch);
}

void assert_patch_holds(const ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    assert_surface_holds(patch);
    assert_int_equal(patch->vertex_count - faces->edge_count + faces->face_count + patch->loop_count, 2);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        assert_false(patch->split[v]);
}
