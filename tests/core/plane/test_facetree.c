/* The tree of faces against all faces, one by one. */
#include "queries.h"

#include <math.h>
#include <stdlib.h>

enum { QUERIES = 300 };

static double distance(const double a[2], const double b[2]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

/* The same face and triangle where p is in one; else the same nearest face, at the same distance but for the rounding of
 * numbers under 2. */
static void compare(const ss_face_tree *tree, const ss_patch *patch, const double (*uv)[2], const double p[2]) {
    bool inside;
    ss_place expected = search_all(patch, uv, p, &inside), found = {.triangle = -7};
    assert_int_equal(ss_face_tree_holding(tree, p, &found), inside);
    if (inside) {
        assert_same_place(&found, &expected);
        assert_true(found.uv[0] == p[0] && found.uv[1] == p[1]);
        return;
    }
    assert_int_equal(found.triangle, -7);
    double away = ss_face_tree_nearest(tree, p, &found);
    assert_near(away, distance(p, expected.uv), 1e-15);
    assert_near(distance(p, found.uv), away, 1e-15);
    assert_in_range(found.triangle, 0, patch->triangles.count - 1);
    assert_int_equal(patch->triangles.face[found.triangle], patch->triangles.face[expected.triangle]);
}

static void compare_on(const ss_patch *patch, double (*uv)[2], uint64_t seed) {
    ss_face_tree *tree = NULL;
    skinslide_error error;
    dice d = {seed};
    const double(*view)[2] = (const double(*)[2])uv;
    assert_ok(ss_face_tree_create(patch, &tree, &error), &error);
    ss_face_tree_build(tree, view);
    for (int i = 0; i < QUERIES; i++) {
        double p[2];
        random_query(&patch->faces, view, &d, p);
        compare(tree, patch, view, p);
    }
    ss_face_tree_destroy(tree);
    free(uv);
}

static void on_every_fixture(double (*(*make)(const ss_patch *patch, const test_mesh *mesh, uint64_t seed))[2]) {
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t holes = 0; holes < 2; holes++) {
            fixture f = make_fixture(i);
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){.holes = (skinslide_holes)holes});
            compare_on(patch, make(patch, &f.mesh, (uint64_t)i), (uint64_t)i);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

static double (*embedded(const ss_patch *patch, const test_mesh *mesh, uint64_t seed))[2] {
    float *points = random_pose(mesh, seed);
    double(*uv)[2] = embedding_of(patch, mesh->points, points);
    free(points);
    return uv;
}

static double (*in_a_tangle(const ss_patch *patch, const test_mesh *mesh, uint64_t seed))[2] {
    (void)mesh;
    return tangled(patch, seed);
}

/* Faces on one line have no area: none holds anything, and the nearest is found. */
static double (*on_a_line(const ss_patch *patch, const test_mesh *mesh, uint64_t seed))[2] {
    double(*uv)[2] = in_a_tangle(patch, mesh, seed);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        uv[v][1] = uv[v][0];
    return uv;
}

static double (*in_one_place(const ss_patch *patch, const test_mesh *mesh, uint64_t seed))[2] {
    double(*uv)[2] = in_a_tangle(patch, mesh, seed);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        uv[v][0] = uv[v][1] = 0.3;
    return uv;
}

static void embeddings(void **state) {
    (void)state;
    on_every_fixture(embedded);
}

static void tangles(void **state) {
    (void)state;
    on_every_fixture(in_a_tangle);
}

static void lines(void **state) {
    (void)state;
    on_every_fixture(on_a_line);
}

static void places(void **state) {
    (void)state;
    on_every_fixture(in_one_place);
}

/* One face to a few leaves' worth: every shape of a small tree. */
static void trees_of_few_faces(void **state) {
    (void)state;
    for (int32_t faces = 1; faces <= 40; faces++) {
        test_mesh mesh = quad_grid(faces, 1);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        compare_on(patch, tangled(patch, (uint64_t)faces), (uint64_t)faces);
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(embeddings),         cmocka_unit_test(tangles), cmocka_unit_test(lines), cmocka_unit_test(places),
        cmocka_unit_test(trees_of_few_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
