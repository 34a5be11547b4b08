/* Weights of corners: they sum to one and give the point back, inside, on sides and at corners. */
#include "queries.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Mean value coordinates of the polygon are positive in a convex one; the same bound, with its thinnest triangle's area. */
static void check_mean_value(const ss_patch *patch, const double (*uv)[2], const ss_place *place) {
    const ss_faces *faces = &patch->faces;
    int32_t face = patch->triangles.face[place->triangle], begin = faces->face_start[face],
            n = faces->face_start[face + 1] - begin;
    const int32_t *corners = faces->corner_vertex + begin;
    double weights[16], side = 0, area = INFINITY;
    for (int32_t k = 0; k < n; k++) {
        const double *a = uv[corners[k]], *b = uv[corners[(k + 1) % n]], *c = uv[corners[(k + 2) % n]];
        side = fmax(side, longest_side(a, b, c));
        area = fmin(area, fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])));
    }
    const ss_flat flat = {uv, NULL};
    if (!ss_mean_value_weights(patch, &flat, face, place->uv, weights))
        return; /* linear takes over: only where rounding put the point outside */
    for (int32_t k = 0; k < n; k++)
        assert_true(weights[k] >= -1e-12 && weights[k] <= 1 + 1e-12);
    expect_point(uv, corners, n, weights, place->uv, fmin(64 * DBL_EPSILON * (1 + side * side / area), side + DBL_EPSILON));
}

static void check_patch(const ss_patch *patch, const double (*uv)[2], dice *d) {
    for (int i = 0; i < 400; i++) {
        double p[2];
        bool inside;
        random_query(&patch->faces, uv, d, p);
        ss_place place = search_all(patch, uv, p, &inside);
        check_mean_value(patch, uv, &place);
    }
}

static void weights_give_the_point_back(void **state) {
    (void)state;
    dice d = {1};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t square = 0; square < 2; square++) {
            fixture f = make_fixture(i);
            ss_patch *patch =
                patch_of(&f.mesh, (skinslide_patch_setup){.boundary = f.square && square ? SKINSLIDE_BOUNDARY_SQUARE
                                                                                         : SKINSLIDE_BOUNDARY_CIRCLE});
            float *points = random_pose(&f.mesh, (uint64_t)i);
            double(*uv)[2] = embedding_of(patch, f.mesh.points, points);
            check_patch(patch, (const double(*)[2])uv, &d);
            free(uv), free(points);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

/* At a corner one weight is 1 and the others 0; on a side of an axis-parallel square only its two ends weigh: exactly. */
static void corners_and_sides_are_exact(void **state) {
    (void)state;
    const double uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const ss_flat square = {NULL, uv};
    test_mesh mesh = polygon(4);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    for (int k = 0; k < 4; k++) {
        double weights[4];
        int32_t next = (k + 1) % 4;
        assert_true(ss_mean_value_weights(patch, &square, 0, uv[k], weights));
        for (int j = 0; j < 4; j++)
            assert_near(weights[j], j == k, 0);
        const double side[2] = {0.75 * uv[k][0] + 0.25 * uv[next][0], 0.75 * uv[k][1] + 0.25 * uv[next][1]};
        assert_true(ss_mean_value_weights(patch, &square, 0, side, weights));
        for (int j = 0; j < 4; j++)
            assert_near(weights[j], j == k ? 0.75 : j == next ? 0.25 : 0, 0);
    }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* In the middle of a square all four weigh the same by symmetry; at (1/2, y) left and right do. */
static void mean_value_by_symmetry(void **state) {
    (void)state;
    const double uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, middle[2] = {0.5, 0.5}, lower[2] = {0.5, 0.25};
    const ss_flat square = {NULL, uv};
    test_mesh mesh = polygon(4);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double weights[4];
    assert_true(ss_mean_value_weights(patch, &square, 0, middle, weights));
    for (int k = 0; k < 4; k++)
        assert_near(weights[k], 0.25, DBL_EPSILON);
    assert_true(ss_mean_value_weights(patch, &square, 0, lower, weights));
    assert_near(weights[0], weights[1], DBL_EPSILON);
    assert_near(weights[2], weights[3], DBL_EPSILON);
    assert_near(weights[0] + weights[1], 0.75, 4 * DBL_EPSILON); /* linear precision in y */
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* In faces that turned over or cross themselves, as free holes can leave them, a slid vertex still stays near its face: no
 * weight is far outside 0..1. */
static void tangled_faces_do_not_throw_points_away(void **state) {
    (void)state;
    test_mesh mesh = polygon(4);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    dice d = {4};
    for (int i = 0; i < 200000; i++) {
        double uv[4][2], weights[4], p[2] = {roll_share(&d), roll_share(&d)};
        for (int k = 0; k < 4; k++)
            uv[k][0] = roll_share(&d), uv[k][1] = roll_share(&d);
        const double(*view)[2] = (const double(*)[2])uv;
        if (ss_triangle_holding(patch, 0, view, p) < 0 || !ss_mean_value_weights(patch, &(ss_flat){view, NULL}, 0, p, weights))
            continue;
        for (int k = 0; k < 4; k++)
            assert_true(weights[k] > -100 && weights[k] < 100);
    }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* Looked up at the place of another vertex, a vertex goes to that vertex's point; where it stays, nowhere. */
static void displacements_lead_to_the_vertex(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    float *points = shaken(&mesh, 3, 0.4);
    for (int32_t rule = SKINSLIDE_INTERPOLATION_LINEAR; rule <= SKINSLIDE_INTERPOLATION_MEAN_VALUE; rule++) {
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.interpolation = (skinslide_interpolation)rule});
        double(*uv)[2] = embedding_of(patch, mesh.points, mesh.points), weights[4], displacement[4][3];
        ss_place places[4];
        for (int i = 0; i < 4; i++)
            places[i] = ss_place_staying(uv[patch->free_vertex[i]]);
        bool inside;
        int32_t from = patch->free_vertex[0], to = patch->free_vertex[3];
        places[0] = search_all(patch, (const double(*)[2])uv, uv[to], &inside);
        assert_true(inside);
        ss_interpolate(patch, &(ss_flat){(const double(*)[2])uv, NULL}, places, points, weights, displacement);
        for (int k = 0; k < 3; k++) {
            double expected = (double)points[3 * patch->mesh_vertex[to] + k] - points[3 * patch->mesh_vertex[from] + k];
            assert_near(displacement[0][k], expected, 1e-15); /* weights are 1 and 0 up to rounding, of points under 4 apart */
            assert_near(displacement[1][k], 0, 0);
        }
        free(uv);
        ss_patch_destroy(patch);
    }
    free(points);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_give_the_point_back),      cmocka_unit_test(corners_and_sides_are_exact),
        cmocka_unit_test(mean_value_by_symmetry),           cmocka_unit_test(tangled_faces_do_not_throw_points_away),
        cmocka_unit_test(displacements_lead_to_the_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
