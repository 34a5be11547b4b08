/* Force densities, by hand on two triangles 0 1 2 and 0 2 3 of a unit square: edges 0-1, 0-2, 0-3, 1-2, 2-3, of which 0-2 is
 * the diagonal. */
#include "support.h"

#include <math.h>

static test_mesh two_triangles(void) {
    const float points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    return copy_mesh(4, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 0, 2, 3}, points);
}

static void densities_of(skinslide_rule rule, const float *points, const double paint[5], double density[5]) {
    test_mesh mesh = two_triangles();
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.rule = rule});
    double lengths[5];
    ss_edge_lengths(patch, points ? points : mesh.points, lengths);
    ss_force_density(patch, lengths, paint, density);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* Only ratios matter: 1/l of sides of 1 and of a diagonal of sqrt(2), times paint. A few roundings of 1e-16 each. */
static void the_unit_rule_by_hand(void **state) {
    (void)state;
    double q[5];
    densities_of(SKINSLIDE_RULE_UNIT, NULL, (double[]){1, 1, 1, 3, 1}, q);
    assert_near(q[1] / q[0], sqrt(0.5), 1e-15);
    assert_near(q[2] / q[0], 1, 0);
    assert_near(q[3] / q[0], 3, 1e-15);
    assert_near(q[4] / q[0], 1, 0);
}

/* m = 2: sides 2 - 1 + 2e-4, the diagonal 2 - 2 + 2e-4. Its own density is a difference: 1e-12 of its size. */
static void the_fast_rule_by_hand(void **state) {
    (void)state;
    double q[5];
    densities_of(SKINSLIDE_RULE_FAST, NULL, (double[]){1, 1, 1, 3, 7}, q);
    assert_near(q[1] / q[0], 2e-4 / (1 + 2e-4), 1e-15);
    assert_near(q[2] / q[0], 1, 1e-15);
    assert_near(q[3] / q[0], 3, 1e-15);
    assert_near(q[4] / q[0], 7, 1e-15);
}

/* All points of a pose in one place: every edge has the shortest length there is, so all densities are the same, and > 0. */
static void a_pose_in_one_place_has_densities(void **state) {
    (void)state;
    const float nowhere[12] = {0};
    for (int32_t rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_FAST; rule++) {
        double q[5];
        densities_of((skinslide_rule)rule, nowhere, (double[]){1, 1, 1, 1, 1}, q);
        for (int e = 0; e < 5; e++) {
            assert_true(q[e] > 0 && isfinite(q[e]));
            assert_near(q[e], q[0], 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_unit_rule_by_hand),
        cmocka_unit_test(the_fast_rule_by_hand),
        cmocka_unit_test(a_pose_in_one_place_has_densities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
