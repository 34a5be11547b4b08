/* Faces and how they meet. */
#include "invariants.h"

#include <math.h>
#include <stdlib.h>

static skinslide_status take_all(const test_mesh *mesh, ss_memory *memory, ss_faces *faces, skinslide_error *error) {
    skinslide_mesh view = view_of(mesh);
    int32_t *chosen = all_faces(mesh);
    skinslide_status status = ss_take_faces(&view, NULL, chosen, mesh->face_count, "patch p", memory, faces, error);
    free(chosen);
    return status;
}

/* Every fixture's sides pair up, and its edges number V + F + loops - 2 less what isolated vertices and pieces change. */
static void sides_pair_up(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_memory memory = {0};
        ss_faces faces;
        skinslide_error error;
        assert_ok(take_all(&f.mesh, &memory, &faces, &error), &error);
        assert_int_equal(faces.face_count, f.mesh.face_count);
        assert_int_equal(faces.corner_count, f.mesh.index_count);
        assert_faces_hold(&faces);
        ss_free(&memory);
        free_mesh(&f.mesh);
    }
}

/* Two triangles 0 1 2 and 0 2 3. Edges by their ends: 0-1, 0-2, 0-3, 1-2, 2-3. */
static void edges_are_numbered_by_their_ends(void **state) {
    (void)state;
    const int32_t counts[] = {3, 3}, indices[] = {0, 1, 2, 0, 2, 3}, expected[] = {0, 3, 1, 1, 4, 2};
    const float points[12] = {0};
    test_mesh mesh = copy_mesh(4, 2, counts, indices, points);
    ss_memory memory = {0};
    ss_faces faces;
    skinslide_error error;
    assert_ok(take_all(&mesh, &memory, &faces, &error), &error);
    assert_int_equal(faces.edge_count, 5);
    assert_same_bytes(faces.corner_edge, expected, sizeof expected);
    assert_int_equal(faces.corner_twin[2], 3);
    assert_int_equal(faces.corner_twin[0], -1);
    ss_free(&memory);
    free_mesh(&mesh);
}

static void drop_chequered(const test_mesh *mesh, int32_t *chosen, int32_t *count) {
    for (int32_t f = 0; f < mesh->face_count; f++)
        if ((f / 2) % 2 == 0)
            chosen[(*count)++] = f;
}

/* A row of eight quads, of which 0 1, 4 5 are taken: two pieces, numbered by their lowest face. */
static void pieces_are_numbered_by_their_lowest_face(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 1);
    skinslide_mesh view = view_of(&mesh);
    int32_t chosen[8], count = 0, piece[8], stack[8];
    drop_chequered(&mesh, chosen, &count);
    ss_memory memory = {0};
    ss_faces faces;
    skinslide_error error;
    assert_ok(ss_take_faces(&view, NULL, chosen, count, "patch p", &memory, &faces, &error), &error);
    assert_int_equal(ss_number_pieces(&faces, piece, stack), 2);
    assert_same_bytes(piece, ((int32_t[]){0, 0, 1, 1}), 4 * sizeof *piece);
    ss_free(&memory);
    free_mesh(&mesh);
}

static void expect_taking(int32_t vertices, int32_t face_count, const int32_t *counts, const int32_t *indices,
                          skinslide_status expected, const char *text) {
    const float points[3 * 16] = {0};
    test_mesh mesh = copy_mesh(vertices, face_count, counts, indices, points);
    ss_memory memory = {0};
    ss_faces faces;
    skinslide_error error;
    skinslide_status status = take_all(&mesh, &memory, &faces, &error);
    ss_free(&memory);
    free_mesh(&mesh);
    assert_fails(status, &error, expected, text);
}

static void bad_faces_are_named(void **state) {
    (void)state;
    expect_taking(3, 1, (int32_t[]){2}, (int32_t[]){0, 1}, SKINSLIDE_BAD_MESH,
                  "patch p: face 0 has 2 vertices; a face needs 3");
    expect_taking(4, 2, (int32_t[]){3, 4}, (int32_t[]){0, 1, 2, 0, 3, 2, 3}, SKINSLIDE_BAD_MESH,
                  "patch p: face 1 has vertex 3 more than once");
    expect_taking(5, 3, (int32_t[]){3, 3, 3}, (int32_t[]){0, 1, 2, 1, 0, 3, 0, 1, 4}, SKINSLIDE_BAD_PATCH,
                  "patch p: edge 0-1 has 3 faces");
    expect_taking(4, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 0, 1, 3}, SKINSLIDE_BAD_PATCH,
                  "patch p: faces 0 and 1 are wound against each other at edge 0-1");
}

/* The face alone, with a neighbour at each side, and the second time wound the other way round. */
static void a_face_twice_is_named(void **state) {
    (void)state;
    const char *text = "patch p: faces 0 and 1 have the same vertices";
    expect_taking(3, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 1, 2, 0}, SKINSLIDE_BAD_PATCH, text);
    expect_taking(4, 3, (int32_t[]){4, 4, 3}, (int32_t[]){0, 1, 2, 3, 3, 0, 1, 2, 1, 0, 2}, SKINSLIDE_BAD_PATCH, text);
    expect_taking(4, 3, (int32_t[]){4, 4, 3}, (int32_t[]){0, 1, 2, 3, 3, 2, 1, 0, 1, 0, 2}, SKINSLIDE_BAD_PATCH, text);
    expect_taking(5, 2, (int32_t[]){4, 4}, (int32_t[]){0, 1, 2, 3, 0, 1, 4, 3}, SKINSLIDE_BAD_PATCH,
                  "patch p: faces 0 and 1 are wound against each other at edge 0-1");
}

/* A ladder of quads whose last side is glued to the first: vertices 2 i and 2 i + 1 are rung i. */
static void expect_strip(int32_t rungs, bool twisted, int32_t turned, skinslide_status expected, const char *text) {
    int32_t counts[16], indices[64];
    for (int32_t f = 0; f < rungs; f++) {
        int32_t next = (f + 1) % rungs, twist = twisted && f + 1 == rungs;
        int32_t face[4] = {2 * f, 2 * f + 1, 2 * next + !twist, 2 * next + twist};
        counts[f] = 4;
        for (int32_t k = 0; k < 4; k++)
            indices[4 * f + k] = face[f == turned ? 3 - k : k];
    }
    expect_taking(2 * rungs, rungs, counts, indices, expected, text);
}

static void one_sided_patches_are_named(void **state) {
    (void)state;
    expect_strip(5, true, -1, SKINSLIDE_BAD_PATCH,
                 "patch p: it has one side only, like a Moebius strip: faces cannot be wound alike at edge 0-1");
    expect_strip(5, true, 2, SKINSLIDE_BAD_PATCH, "patch p: it has one side only, like a Moebius strip...");
    expect_strip(5, false, 2, SKINSLIDE_BAD_PATCH, "patch p: faces 1 and 2 are wound against each other at edge 4-5");
}

static void expect_mesh(skinslide_mesh mesh, skinslide_status expected, const char *text) {
    skinslide_error error;
    assert_fails(ss_check_mesh(&mesh, &error), &error, expected, text);
}

static void bad_meshes_are_named(void **state) {
    (void)state;
    const int32_t counts[] = {3, 4}, indices[] = {0, 1, 2, 0, 2, 3, 4}, outside[] = {0, 1, 2, 0, 2, 3, 5};
    const int32_t below[] = {0, 1, 2, 0, -1, 3, 4}, negative[] = {3, -4};
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), -1, 2, 7, counts, indices, NULL, NULL, NULL, NULL},
                SKINSLIDE_BAD_ARGUMENT, "no mesh, or a negative count in it");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 0, 0, counts, indices, NULL, NULL, NULL, NULL}, SKINSLIDE_BAD_MESH,
                "the mesh has no faces");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 2, 7, NULL, indices, NULL, NULL, NULL, NULL},
                SKINSLIDE_BAD_ARGUMENT, "the mesh has no array of face counts or indices");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 2, 8, counts, indices, NULL, NULL, NULL, NULL}, SKINSLIDE_BAD_MESH,
                "face counts add up to 7, but there are 8 face indices");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 2, 7, counts, outside, NULL, NULL, NULL, NULL}, SKINSLIDE_BAD_MESH,
                "face 1 has vertex 5, but the mesh has 5 vertices");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 2, 7, counts, below, NULL, NULL, NULL, NULL}, SKINSLIDE_BAD_MESH,
                "face 1 has vertex -1, but the mesh has 5 vertices");
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 5, 2, 7, negative, indices, NULL, NULL, NULL, NULL},
                SKINSLIDE_BAD_MESH, "face 1 has -4 vertices");
}

/* Counts whose sum does not fit 32 bits must not wrap around to the count of indices. */
static void counts_that_would_wrap_are_refused(void **state) {
    (void)state;
    const int32_t counts[] = {INT32_MAX, INT32_MAX, 5}, indices[] = {0, 1, 2};
    expect_mesh((skinslide_mesh){sizeof(skinslide_mesh), 3, 3, 3, counts, indices, NULL, NULL, NULL, NULL}, SKINSLIDE_BAD_MESH,
                "face counts add up to 4294967299, but there are 3 face indices");
}

static void points_that_are_not_finite_are_named(void **state) {
    (void)state;
    float points[] = {0, 0, 0, 0, INFINITY, 0, 0, 0, NAN};
    skinslide_error error;
    assert_fails(ss_check_points(points, 3, "points", &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 1 is not finite: (0, inf, 0)");
    points[4] = 0;
    assert_fails(ss_check_points(points, 3, "rest points", &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: vertex 2 is not finite: (0, 0, ...");
    assert_fails(ss_check_points(NULL, 3, "points", &error), &error, SKINSLIDE_BAD_ARGUMENT, "no points");
    points[8] = 0;
    assert_int_equal(ss_check_points(points, 3, "points", &error), SKINSLIDE_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_pair_up),
        cmocka_unit_test(edges_are_numbered_by_their_ends),
        cmocka_unit_test(pieces_are_numbered_by_their_lowest_face),
        cmocka_unit_test(bad_faces_are_named),
        cmocka_unit_test(a_face_twice_is_named),
        cmocka_unit_test(one_sided_patches_are_named),
        cmocka_unit_test(bad_meshes_are_named),
        cmocka_unit_test(counts_that_would_wrap_are_refused),
        cmocka_unit_test(points_that_are_not_finite_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
