/* Paint and weights, by hand on two triangles 0 1 2 and 0 2 3 of a unit square: edges 0-1, 0-2, 0-3, 1-2, 2-3, of which 0-2 is
 * the diagonal. */
#include "support.h"

#include <math.h>

static test_mesh two_triangles(void) {
    const float points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    return copy_mesh(4, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 0, 2, 3}, points);
}

/* Paints of small numbers are exact. */
static void expect_paint(const skinslide_controls *controls, const double expected[5]) {
    test_mesh mesh = two_triangles();
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double paint[5];
    ss_edge_paint edges[5];
    ss_paint(patch, controls, edges, paint);
    for (int e = 0; e < 5; e++)
        assert_near(paint[e], expected[e], 0);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void paint_by_hand(void **state) {
    (void)state;
    const float by_vertex[] = {1, 2, 3, 4}, by_face[] = {2, 6}, by_edge[] = {5, 0.5f};
    const int32_t pairs[] = {2, 0, 2, 3};
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    expect_paint(&controls, (double[]){1, 1, 1, 1, 1});
    controls.vertex_density = by_vertex; /* the mean of an edge's ends */
    expect_paint(&controls, (double[]){1.5, 2, 2.5, 2.5, 3.5});
    controls.vertex_density = NULL, controls.face_density = by_face; /* the mean of its faces: only 0-2 has two */
    expect_paint(&controls, (double[]){2, 4, 6, 2, 6});
    controls.face_density = NULL, controls.edges = pairs, controls.edge_density = by_edge, controls.edge_count = 2;
    expect_paint(&controls, (double[]){1, 5, 1, 1, 0.5});
    controls.vertex_density = by_vertex, controls.face_density = by_face; /* all multiply */
    expect_paint(&controls, (double[]){3, 40, 15, 5, 10.5});
}

/* Free vertices of 3 x 3 quads: 5, 6, 9, 10. Weights of 1.5 and -2 count, one of a fixed vertex does not. */
static void weights_are_clamped_and_counted(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    float weight[16] = {[0] = 9, [5] = 0.25f, [6] = 1.5f, [9] = -2, [10] = 1};
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    double weights[4];
    controls.weight = weight, controls.envelope = 0.5f;
    assert_int_equal(ss_control_weights(patch, &controls, weights), 2);
    for (int32_t i = 0; i < 4; i++) {
        static const double expected[16] = {[5] = 0.125, [6] = 0.5, [9] = 0, [10] = 0.5};
        assert_near(weights[i], expected[patch->mesh_vertex[patch->free_vertex[i]]], 0);
    }
    controls.weight = NULL, controls.envelope = 2;
    assert_int_equal(ss_control_weights(patch, &controls, weights), 1);
    assert_near(weights[3], 1, 0);
    controls.envelope = -INFINITY;
    assert_int_equal(ss_control_weights(patch, &controls, weights), 1);
    assert_near(weights[3], 0, 0);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* The same two triangles, split along the diagonal, with other paint on each copy of 0 and of 2. */
static void copies_count_as_their_mean(void **state) {
    (void)state;
    const float points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0};
    const float by_vertex[] = {1, 2, 3, 4, 3, 5}, by_edge[] = {5, 7, 0.5f}, limits[] = {1, 2, 3, 4, 0.5f, 6};
    const int32_t weld[] = {0, 1, 2, 3, 0, 2}, pairs[] = {2, 0, 4, 5, 5, 3}, faces[] = {0, 1};
    const float weights[] = {1, 1, 0.25f, 1, 1, -2};
    test_mesh mesh = copy_mesh(6, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 4, 5, 3}, points);
    skinslide_mesh view = view_of(&mesh);
    skinslide_patch_setup setup = setup_of(faces, 2);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    skinslide_error error;
    ss_patch *patch;
    ss_edge_paint edges[5];
    double paint[5], values[4];
    const ss_piece piece = {.faces = faces, .face_count = 2, .count = 1};
    view.weld = weld;
    assert_ok(ss_patch_create(&view, NULL, &setup, 0, &piece, &patch, &error), &error);
    assert_int_equal(patch->vertex_count, 4);
    controls.vertex_density = by_vertex; /* 2, 2, 4, 4 */
    ss_paint(patch, &controls, edges, paint);
    for (int e = 0; e < 5; e++)
        assert_near(paint[e], ((double[]){2, 3, 3, 3, 4})[e], 0);
    controls.vertex_density = NULL, controls.edges = pairs, controls.edge_density = by_edge, controls.edge_count = 3;
    ss_paint(patch, &controls, edges, paint);
    for (int e = 0; e < 5; e++)
        assert_near(paint[e], ((double[]){1, 6, 1, 1, 0.5})[e], 0);
    controls.hold = by_vertex;
    ss_control_holds(patch, &controls, values);
    for (int v = 0; v < 4; v++)
        assert_near(values[v], ((double[]){2, 2, 4, 4})[v], 0);
    /* Of a fixed vertex they do not count: free ones are made of it. */
    patch->free_count = 1, patch->free_vertex[0] = 2;
    controls.weight = weights, controls.max_distance = limits;
    assert_int_equal(ss_control_weights(patch, &controls, values), 1);
    assert_near(values[0], 0.125, 0); /* each within 0 to 1 */
    patch->free_vertex[0] = 0;
    assert_true(ss_control_limits(patch, &controls, values));
    assert_near(values[0], 0.5, 0);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paint_by_hand),
        cmocka_unit_test(weights_are_clamped_and_counted),
        cmocka_unit_test(copies_count_as_their_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
