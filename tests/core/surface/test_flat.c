/* Faces laid flat, in one plane and each in its own. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 9 };

/* Corners of a convex polygon: on an ellipse, in order, none nearer than a fifth of an even share to the next. */
static void roll_polygon(int32_t n, dice *d, double out[MOST][2]) {
    for (int32_t k = 0; k < n; k++) {
        double turn = 2 * acos(-1) * (k + 0.8 * roll_share(d)) / n;
        out[k][0] = 3 * cos(turn), out[k][1] = sin(turn);
    }
}

/* The place found for the middle is where the mean of the corners is, whichever way they are given. A thin triangle of the fan
 * loses some digits. */
static void middles_are_means_of_corners(void **state) {
    (void)state;
    dice d = {1};
    for (int32_t n = 3; n <= MOST; n++) {
        test_mesh mesh = polygon(n);
        ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
        for (int i = 0; i < 50; i++) {
            double corner[MOST][2], uv[MOST][2], mean[2] = {0, 0}, there[2];
            roll_polygon(n, &d, corner);
            for (int32_t c = 0; c < n; c++)
                for (int k = 0; k < 2; k++)
                    uv[patch->faces.corner_vertex[c]][k] = corner[c][k], mean[k] += corner[c][k] / n;
            const ss_flat own = {NULL, (const double(*)[2])corner}, plane = {(const double(*)[2])uv, NULL};
            ss_place middle = ss_flat_middle(patch, &own, 0), again = ss_flat_middle(patch, &plane, 0);
            assert_int_equal(again.triangle, middle.triangle);
            assert_same_bytes(again.weight, middle.weight, sizeof middle.weight);
            assert_near(middle.weight[0] + middle.weight[1] + middle.weight[2], 1, 1e-15);
            assert_true(middle.weight[0] >= 0 && middle.weight[1] >= 0 && middle.weight[2] >= 0);
            ss_flat_place(patch, &own, &middle, there);
            ss_place_in_plane(patch, plane.uv, &middle, again.uv);
            for (int k = 0; k < 2; k++) {
                assert_near(there[k], mean[k], 1e-12);
                assert_near(again.uv[k], mean[k], 1e-12);
            }
        }
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

/* A face of no area has its middle in it all the same. */
static void a_face_in_a_point(void **state) {
    (void)state;
    test_mesh mesh = polygon(4);
    ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
    const double corner[4][2] = {{1, 1}, {1, 1}, {1, 1}, {1, 1}};
    ss_place middle = ss_flat_middle(patch, &(ss_flat){NULL, corner}, 0);
    assert_true(middle.triangle == 0 && middle.weight[0] == 1 && middle.weight[1] == 0 && middle.weight[2] == 0);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(middles_are_means_of_corners),
        cmocka_unit_test(a_face_in_a_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
