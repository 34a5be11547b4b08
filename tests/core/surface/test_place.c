/* Weights of a triangle's vertices: they sum to one and give the point back, inside, on sides and at corners. */
#include "queries.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A cross product of sides of length l, of coordinates near 1, is off by a few eps l; divided by the area a and times l again:
 * a few eps l^2 / a. */
static void check_place(const ss_patch *patch, const double (*uv)[2], const ss_place *place) {
    const int32_t *v = patch->triangles.vertex[place->triangle];
    const double *a = uv[v[0]], *b = uv[v[1]], *c = uv[v[2]];
    double side = longest_side(a, b, c), area = fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    for (int k = 0; k < 3; k++)
        assert_true(place->weight[k] >= 0 && place->weight[k] <= 1);
    expect_point(uv, v, 3, place->weight, place->uv, fmin(16 * DBL_EPSILON * (1 + side * side / area), side + DBL_EPSILON));
}

static void weights_give_the_point_back(void **state) {
    (void)state;
    dice d = {1};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        float *points = random_pose(&f.mesh, (uint64_t)i);
        double(*own)[2] = embedding_of(patch, f.mesh.points, points);
        const double(*uv)[2] = (const double(*)[2])own;
        for (int k = 0; k < 400; k++) {
            double p[2];
            bool inside;
            random_query(&patch->faces, uv, &d, p);
            ss_place place = search_all(patch, uv, p, &inside);
            check_place(patch, uv, &place);
        }
        free(own), free(points);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
}

/* At a corner one weight is 1 and the others 0; on a side of an axis-parallel square only its two ends weigh: exactly. */
static void corners_and_sides_are_exact(void **state) {
    (void)state;
    test_mesh mesh = polygon(4);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    const double uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int k = 0; k < 4; k++) {
        int32_t triangle = ss_triangle_of_side(patch, k), next = (k + 1) % 4;
        const int32_t *v = patch->triangles.vertex[triangle];
        const double side[2] = {0.75 * uv[k][0] + 0.25 * uv[next][0], 0.75 * uv[k][1] + 0.25 * uv[next][1]};
        ss_place corner = place_at(patch, uv, triangle, uv[k]), between = place_at(patch, uv, triangle, side);
        for (int j = 0; j < 3; j++) {
            assert_near(corner.weight[j], v[j] == k, 0);
            assert_near(between.weight[j], v[j] == k ? 0.75 : v[j] == next ? 0.25 : 0, 0);
        }
        assert_int_equal(v[ss_place_corner(&corner)], k);
        assert_int_equal(ss_place_corner(&between), -1);
    }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* A quarter along each side of each triangle. */
static void check_sides(const ss_patch *patch, const double (*uv)[2]) {
    for (int32_t t = 0; t < patch->triangles.count; t++)
        for (int k = 0; k < 3; k++) {
            ss_place place = {t, {k == 0 ? 0.75 : 0, k == 1 ? 0.75 : 0, k == 2 ? 0.75 : 0}, {0, 0}}, settled;
            place.weight[(k + 1) % 3] = 0.25;
            settled = place;
            ss_place_settle(patch, uv, &settled);
            for (int j = 0; j < 3; j++)
                assert_near(settled.weight[j], place.weight[j], 1e-6);
        }
}

static void check_vertices(const ss_patch *patch, const double (*uv)[2]) {
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        ss_place place = ss_place_of_vertex(patch, uv, v), settled = place;
        assert_int_equal(patch->triangles.vertex[place.triangle][ss_place_corner(&place)], v);
        ss_place_settle(patch, uv, &settled);
        assert_same_place(&settled, &place);
    }
}

/* Walked to, and then settled: also where the patch is so small in the plane, or so narrow, as a rule may lay it out, that no
 * triangle has an area to speak of. */
static void a_place_stays_where_it_is(void **state) {
    (void)state;
    static const double squeezes[][2] = {{1, 1}, {DBL_EPSILON, DBL_EPSILON}, {1, 0}, {0, 0}, {1, 1e-14}};
    test_mesh mesh = grid_with_holes(false);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    for (size_t i = 0; i < sizeof squeezes / sizeof *squeezes; i++) {
        double(*uv)[2] = embedding_of(patch, mesh.points, mesh.points);
        for (int32_t v = 0; v < patch->vertex_count; v++)
            for (int k = 0; k < 2; k++)
                uv[v][k] = 0.5 + squeezes[i][k] * (uv[v][k] - 0.5);
        check_vertices(patch, (const double(*)[2])uv);
        check_sides(patch, (const double(*)[2])uv);
        free(uv);
    }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* Triangles of no area, and corners in one place: weights stay between 0 and 1 and sum to one. */
static void faces_of_no_area_have_weights(void **state) {
    (void)state;
    test_mesh mesh = polygon(3);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    dice d = {3};
    for (int i = 0; i < 1000; i++) {
        double uv[3][2], x = roll_share(&d), y = roll_share(&d);
        for (int k = 0; k < 3; k++) {
            double share = i % 3 ? roll_below(&d, 5) / 4.0 : 0;
            uv[k][0] = share * x, uv[k][1] = i % 2 ? share * x : share * y;
        }
        const double p[2] = {roll_share(&d) * x, roll_share(&d) * x};
        ss_place place = place_at(patch, (const double(*)[2])uv, 0, p);
        assert_near(place.weight[0] + place.weight[1] + place.weight[2], 1, 2 * DBL_EPSILON);
        for (int k = 0; k < 3; k++)
            assert_true(place.weight[k] >= 0 && place.weight[k] <= 1);
    }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_give_the_point_back),
        cmocka_unit_test(corners_and_sides_are_exact),
        cmocka_unit_test(a_place_stays_where_it_is),
        cmocka_unit_test(faces_of_no_area_have_weights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
