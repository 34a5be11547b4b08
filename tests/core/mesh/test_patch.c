/* Connected patches: what each is, and what is no patch. */
#include "invariants.h"

#include <stdlib.h>

static void every_fixture_holds(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        for (int32_t holes = SKINSLIDE_HOLES_PINNED; holes <= SKINSLIDE_HOLES_FREE; holes++) {
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){.holes = (skinslide_holes)holes});
            assert_patch_holds(patch);
            assert_int_equal(patch->loop_count, 1 + f.holes);
            ss_patch_destroy(patch);
        }
        free_mesh(&f.mesh);
    }
}

/* 3 x 3 vertices: 8 on the boundary, vertex 4 free. The loop follows faces, counter-clockwise, from its lowest vertex. */
static void a_small_patch_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    assert_int_equal(patch->vertex_count, 9);
    assert_int_equal(patch->faces.edge_count, 12);
    assert_int_equal(patch->free_count, 1);
    assert_int_equal(patch->free_vertex[0], 4);
    assert_same_bytes(patch->loop_vertex, ((int32_t[]){0, 1, 2, 5, 8, 7, 6, 3}), 8 * sizeof(int32_t));
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* The outer circle of the annulus, twice as long as the inner, is loop 0 whichever has the lower vertices. */
static void the_longest_loop_is_the_outer_one(void **state) {
    (void)state;
    test_mesh mesh = annulus(12, 3);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    assert_int_equal(patch->vertex_loop[0], 0);
    ss_patch_destroy(patch);
    for (int32_t v = 0; v < 24; v++) /* swap the outer circle with the inner */
        for (int k = 0; k < 3 && v < 12; k++) {
            float swap = mesh.points[3 * v + k];
            mesh.points[3 * v + k] = mesh.points[3 * (v + 36) + k];
            mesh.points[3 * (v + 36) + k] = swap;
        }
    patch = patch_of(&mesh, (skinslide_patch_setup){0});
    assert_int_equal(patch->vertex_loop[0], 1);
    assert_int_equal(patch->vertex_loop[36], 0);
    assert_patch_holds(patch);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* An edge of no length counts 1e-6 of the mean: here edges 0-1 of length 0, 1-2 and 0-2 of 3, so a mean of 2. */
static void edges_of_no_length_are_clamped(void **state) {
    (void)state;
    const float points[] = {0, 0, 0, 0, 0, 0, 3, 0, 0};
    test_mesh mesh = copy_mesh(3, 1, (int32_t[]){3}, (int32_t[]){0, 1, 2}, points);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    assert_int_equal(patch->zero_length_edges, 1);
    assert_near(patch->shortest, 2e-6, 1e-20); /* products rounded once or twice */
    assert_near(patch->rest_length[0], 2e-6, 1e-20);
    assert_near(patch->rest_length[1], 3, 0);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void expect_patch(const test_mesh *mesh, const char *text) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh->face_count);
    skinslide_error error;
    ss_patch *patch = NULL;
    const ss_piece piece = {.faces = faces, .face_count = mesh->face_count, .count = 1};
    skinslide_status status = ss_patch_create(&view, NULL, &setup, 0, &piece, &patch, &error);
    free(faces);
    assert_true((patch == NULL) == (status != SKINSLIDE_OK));
    if (!status)
        status = ss_check_disk(patch, &error);
    assert_fails(status, &error, SKINSLIDE_BAD_PATCH, text);
    ss_patch_destroy(patch);
}

static void expect_patch_of(int32_t vertices, int32_t face_count, const int32_t *counts, const int32_t *indices,
                            const char *text) {
    float points[3 * 16];
    dice d = {4};
    for (int k = 0; k < 48; k++)
        points[k] = (float)roll_share(&d);
    test_mesh mesh = copy_mesh(vertices, face_count, counts, indices, points);
    expect_patch(&mesh, text);
    free_mesh(&mesh);
}

/* A 3 x 3 torus of quads without one of them. */
static test_mesh torus_with_a_hole(void) {
    int32_t counts[8], indices[32];
    float points[27];
    dice d = {9};
    for (int32_t f = 0; f < 8; f++) {
        int32_t i = f % 3, j = f / 3, right = (i + 1) % 3, up = (j + 1) % 3;
        int32_t quad[4] = {3 * j + i, 3 * j + right, 3 * up + right, 3 * up + i};
        counts[f] = 4;
        for (int k = 0; k < 4; k++)
            indices[4 * f + k] = quad[k];
    }
    for (int k = 0; k < 27; k++)
        points[k] = (float)roll_share(&d);
    return copy_mesh(9, 8, counts, indices, points);
}

static void what_is_no_patch_is_named(void **state) {
    (void)state;
    expect_patch_of(
        4, 4, (int32_t[]){3, 3, 3, 3}, (int32_t[]){0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3},
        "patch all: the patch is closed; rules unit and fast need a boundary to hold on to, relaxed and even do not");
    /* Two triangles that meet at vertex 2 only, then joined by a third beside them. */
    expect_patch_of(6, 4, (int32_t[]){3, 3, 3, 3}, (int32_t[]){0, 1, 2, 2, 3, 4, 1, 0, 5, 4, 3, 5},
                    "patch all: the boundary touches itself at vertex 2");
    /* Two closed tetrahedra that share vertex 0. */
    expect_patch_of(7, 8, (int32_t[]){3, 3, 3, 3, 3, 3, 3, 3},
                    (int32_t[]){0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6},
                    "patch all: vertex 0 joins faces that share no edge there");
    test_mesh torus = torus_with_a_hole();
    expect_patch(&torus,
                 "patch all: the patch has 1 handle(s); rules unit and fast need a disk with holes, relaxed and even do not");
    free_mesh(&torus);
    test_mesh point = quad_grid(2, 2);
    for (int k = 0; k < 27; k++)
        point.points[k] = 5;
    expect_patch(&point, "patch all: all its rest points are in one place");
    free_mesh(&point);
}

static void expect_split(int32_t vertices, int32_t face_count, const int32_t *indices, int32_t expected, int32_t split) {
    const int32_t counts[8] = {3, 3, 3, 3, 3, 3, 3, 3};
    const float points[21] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1};
    test_mesh mesh = copy_mesh(vertices, face_count, counts, indices, points);
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.rule = SKINSLIDE_RULE_EVEN;
    ss_patch *patch = patch_of(&mesh, choices);
    assert_surface_holds(patch);
    assert_int_equal(patch->vertex_count, expected);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        split -= patch->split[v];
    assert_int_equal(split, 0);
    for (int32_t c = 0; c < mesh.index_count; c++)
        assert_int_equal(ss_patch_mesh_edge(patch, indices[c], indices[c % 3 == 2 ? c - 2 : c + 1]),
                         patch->faces.corner_edge[c]);
    assert_int_equal(ss_patch_mesh_edge(patch, 2, 6), -1);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* By a rule without a plane every fan of faces has a vertex of its own. */
static void vertices_are_split(void **state) {
    (void)state;
    /* Two pairs of triangles that meet at vertices 2 and 5 only. */
    expect_split(6, 4, (int32_t[]){0, 1, 2, 2, 3, 4, 1, 0, 5, 4, 3, 5}, 8, 4);
    /* Two closed tetrahedra that share vertex 0. */
    expect_split(7, 8, (int32_t[]){0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6}, 8, 2);
}

static void destroying_nothing_is_nothing(void **state) {
    (void)state;
    ss_patch_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_fixture_holds),
        cmocka_unit_test(a_small_patch_by_hand),
        cmocka_unit_test(the_longest_loop_is_the_outer_one),
        cmocka_unit_test(edges_of_no_length_are_clamped),
        cmocka_unit_test(what_is_no_patch_is_named),
        cmocka_unit_test(vertices_are_split),
        cmocka_unit_test(destroying_nothing_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
