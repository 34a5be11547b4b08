/* Where the outer boundary goes. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

/* Measured against long double; 1e-15 is nine units in the last place of numbers near 1, and the quarters are exact. */
static void the_circle_is_cos_and_sin(void **state) {
    (void)state;
    const long double whole = 2 * acosl(-1);
    for (int i = 0; i < 200000; i++) {
        double turns = i / 200000.0, p[2];
        ss_circle(turns, p);
        assert_near(p[0], (double)cosl(whole * turns), 1e-15);
        assert_near(p[1], (double)sinl(whole * turns), 1e-15);
    }
    static const double quarters[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (int k = 0; k < 4; k++) {
        double p[2];
        ss_circle(0.25 * k, p);
        assert_true(p[0] == quarters[k][0] && p[1] == quarters[k][1]);
    }
}

/* Vertices of a loop stand at their share of the arc: of a hexagon with sides 1 1 1 2 2 1, at 0 1 2 3 5 7 of 8. */
static test_mesh line_hexagon(void) {
    static const float stops[] = {0, 1, 2, 3, 1, -1};
    float points[18] = {0};
    for (int k = 0; k < 6; k++)
        points[3 * k] = stops[k];
    return copy_mesh(6, 1, (int32_t[]){6}, (int32_t[]){0, 1, 2, 3, 4, 5}, points);
}

static void places_on_the_circle_are_shares_of_the_arc(void **state) {
    (void)state;
    static const double shares[] = {0, 1, 2, 3, 5, 7};
    test_mesh mesh = line_hexagon();
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double(*uv)[2] = held_uv_of(patch, mesh.points);
    for (int32_t v = 0; v < 6; v++) {
        double angle = 2 * acos(-1) * shares[v] / 8;
        assert_near(uv[v][0], 0.5 + 0.5 * cos(angle), 1e-15);
        assert_near(uv[v][1], 0.5 + 0.5 * sin(angle), 1e-15);
    }
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void expect_uv(double (*uv)[2], int32_t vertex, double u, double v) {
    assert_near(uv[vertex][0], u, 0);
    assert_near(uv[vertex][1], v, 0);
}

/* 5 x 3 vertices with corners at the ends, listed out of order. The lowest position of the loop goes to (0,0), and the others
 * follow as faces turn. Quarters and halves are exact in binary, so places are too. */
static void corners_go_to_the_square(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(4, 2);
    const int32_t corners[4] = {14, 0, 10, 4};
    for (int32_t boundary = SKINSLIDE_BOUNDARY_AUTO; boundary <= SKINSLIDE_BOUNDARY_SQUARE; boundary++) {
        ss_patch *patch =
            patch_of(&mesh, (skinslide_patch_setup){.corners = corners, .boundary = (skinslide_boundary)boundary});
        double(*uv)[2] = held_uv_of(patch, mesh.points);
        expect_uv(uv, 0, 0, 0), expect_uv(uv, 4, 1, 0), expect_uv(uv, 14, 1, 1), expect_uv(uv, 10, 0, 1);
        expect_uv(uv, 1, 0.25, 0), expect_uv(uv, 9, 1, 0.5), expect_uv(uv, 13, 0.75, 1), expect_uv(uv, 5, 0, 0.5);
        free(uv);
        ss_patch_destroy(patch);
    }
    free_mesh(&mesh);
}

/* A circle that is asked for is a circle, corners or not. */
static void a_circle_ignores_corners(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(4, 2);
    ss_patch *round = patch_of(&mesh, (skinslide_patch_setup){0});
    ss_patch *patch =
        patch_of(&mesh, (skinslide_patch_setup){.corners = (int32_t[]){14, 0, 10, 4}, .boundary = SKINSLIDE_BOUNDARY_CIRCLE});
    double(*uv)[2] = held_uv_of(patch, mesh.points);
    double(*circle)[2] = held_uv_of(round, mesh.points);
    assert_same_bytes(uv, circle, (size_t)patch->vertex_count * sizeof *uv);
    free(uv), free(circle);
    ss_patch_destroy(patch), ss_patch_destroy(round);
    free_mesh(&mesh);
}

/* Of a square grid the sharpest vertex is a corner, and the quarters of the arc from it are the others. */
static void corners_of_a_square_are_found(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(6, 6);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
    double(*uv)[2] = held_uv_of(patch, mesh.points);
    expect_uv(uv, 0, 0, 0), expect_uv(uv, 6, 1, 0), expect_uv(uv, 48, 1, 1), expect_uv(uv, 42, 0, 1);
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* A square of side 2, all of whose triangles meet at the middle of its lower side, vertex 0. The others follow from the lower
 * right corner, 1, by quarters: 9 is the upper right, 17 the upper left, 25 the lower left corner. */
static test_mesh fanned_square(void) {
    float points[3 * 26] = {1, 0, 0};
    int32_t counts[24], indices[3 * 24];
    for (int i = 0; i < 25; i++) {
        float along = 0.25f * (float)(i % 8), *p = points + 3 * (i + 1);
        p[0] = i < 8 ? 2 : i < 16 ? 2 - along : 0;
        p[1] = i < 8 ? along : i < 16 ? 2 : i < 24 ? 2 - along : 0;
    }
    for (int f = 0; f < 24; f++)
        counts[f] = 3, indices[3 * f] = 0, indices[3 * f + 1] = f + 1, indices[3 * f + 2] = f + 2;
    return copy_mesh(26, 24, counts, indices, points);
}

/* Half a turn is not sharp because many thin faces share it. */
static void sharpness_is_of_the_whole_angle(void **state) {
    (void)state;
    test_mesh mesh = fanned_square();
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
    double(*uv)[2] = held_uv_of(patch, mesh.points);
    for (int corner = 1; corner < 26; corner += 8)
        for (int axis = 0; axis < 2; axis++)
            assert_true(uv[corner][axis] == 0 || uv[corner][axis] == 1);
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* A hexagon on a line, with sides 1 1 1 1.6 2.4 1, is sharpest at vertex 3, which comes before 5. From there vertices 4 5 0 1 2
 * are at 1.6, 4, 5, 6 and 7 of 8: nearest to the quarters are 4, 5 and 1. The first of these along the loop, 1, goes to (0,0).
 */
static void corners_are_the_nearest_to_the_quarters(void **state) {
    (void)state;
    test_mesh mesh = line_hexagon();
    mesh.points[12] = 1.4f;
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
    double(*uv)[2] = held_uv_of(patch, mesh.points);
    expect_uv(uv, 1, 0, 0), expect_uv(uv, 3, 1, 0), expect_uv(uv, 4, 1, 1), expect_uv(uv, 5, 0, 1);
    expect_uv(uv, 2, 0.5, 0), expect_uv(uv, 0, 0, 0.5);
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static int32_t count_at_corners(const ss_patch *patch, double (*uv)[2]) {
    int32_t count = 0;
    for (int32_t i = 0; i < patch->loop_start[1]; i++) {
        const double *at = uv[patch->loop_vertex[i]];
        count += (at[0] == 0 || at[0] == 1) && (at[1] == 0 || at[1] == 1);
        assert_true(at[0] == 0 || at[0] == 1 || at[1] == 0 || at[1] == 1);
        assert_true(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1);
    }
    return count;
}

/* Whatever the loop, four vertices of it are chosen, one at each corner, and all others are on the sides between. */
static void four_corners_are_always_chosen(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        if (f.square) {
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
            double(*uv)[2] = held_uv_of(patch, f.mesh.points);
            assert_int_equal(count_at_corners(patch, uv), 4);
            free(uv);
            ss_patch_destroy(patch);
        }
        free_mesh(&f.mesh);
    }
    for (int32_t sides = 4; sides < 9; sides++)
        for (uint64_t seed = 0; seed < 50; seed++) {
            test_mesh mesh = polygon(sides);
            dice d = {seed};
            for (int k = 0; k < 3 * sides; k++) /* very uneven sides */
                mesh.points[k] = (float)pow(10, roll_between(&d, -5, 5));
            ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
            double(*uv)[2] = held_uv_of(patch, mesh.points);
            assert_int_equal(count_at_corners(patch, uv), 4);
            free(uv);
            ss_patch_destroy(patch);
            free_mesh(&mesh);
        }
}

static void expect_corners(const test_mesh *mesh, const int32_t corners[4], const char *text) {
    skinslide_mesh view = view_of(mesh);
    const int32_t faces[4] = {0, 1, 2, 3};
    skinslide_patch_setup setup = setup_of(faces, mesh->face_count);
    setup.corners = corners, setup.boundary = SKINSLIDE_BOUNDARY_SQUARE;
    skinslide_error error;
    ss_patch *patch = NULL;
    const ss_piece piece = {.faces = faces, .face_count = mesh->face_count, .count = 1};
    assert_ok(ss_patch_create(&view, NULL, &setup, 0, &piece, &patch, &error), &error);
    double uv[9][2];
    assert_fails(ss_place_boundary(patch, setup.boundary, mesh->points, uv, &error), &error, SKINSLIDE_BAD_CONTROL, text);
    ss_patch_destroy(patch);
}

static void bad_corners_are_named(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2), triangle = polygon(3);
    expect_corners(&mesh, (int32_t[]){0, 2, 4, 8}, "patch all: corner 4 is not on its outer boundary");
    expect_corners(&mesh, (int32_t[]){0, 2, 99, 8}, "patch all: corner 99 is not on its outer boundary");
    expect_corners(&mesh, (int32_t[]){0, 2, -1, 8}, "patch all: corner -1 is not on its outer boundary");
    expect_corners(&mesh, (int32_t[]){0, 2, 8, 2}, "patch all: corner 2 is listed more than once");
    expect_corners(&triangle, NULL, "patch all: a square boundary needs 4 vertices on the outer loop, which has 3");
    free_mesh(&mesh), free_mesh(&triangle);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_circle_is_cos_and_sin),       cmocka_unit_test(places_on_the_circle_are_shares_of_the_arc),
        cmocka_unit_test(corners_go_to_the_square),        cmocka_unit_test(a_circle_ignores_corners),
        cmocka_unit_test(corners_of_a_square_are_found),   cmocka_unit_test(corners_are_the_nearest_to_the_quarters),
        cmocka_unit_test(four_corners_are_always_chosen),  cmocka_unit_test(bad_corners_are_named),
        cmocka_unit_test(sharpness_is_of_the_whole_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
