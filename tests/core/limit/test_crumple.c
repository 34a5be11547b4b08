/* Shorter normals where a pose crumples the surface: how near to one line tangents come, beside rest. */
#include "support.h"

static double length_at(double square, double at_rest) {
    double normal[3] = {0.36, 0.48, 0.8};
    ss_shorten_flat(square, at_rest, normal);
    return ss_length(normal);
}

/* Skin that is bent but not crumpled is not held along itself by so much as a bit. */
static void what_is_hardly_flatter_than_at_rest_keeps_its_bits(void **state) {
    (void)state;
    const double unit[3] = {0.36, 0.48, 0.8};
    for (int rest = 1; rest <= 10; rest++)
        for (int share = 851; share <= 4000; share += 7) {
            double normal[3] = {unit[0], unit[1], unit[2]};
            ss_shorten_flat(1e-4 * rest * share, 0.1 * rest, normal);
            assert_same_bytes(normal, unit, sizeof unit);
        }
}

static void further_down_they_shorten_to_nothing_without_a_jump(void **state) {
    (void)state;
    enum { STEPS = 4000 };
    double before = 1;
    for (int k = STEPS; k >= 1; k--) {
        double length = length_at(0.8 * k / STEPS, 0.8);
        assert_true(length <= before);
        assert_near(length, before, 4.0 / STEPS);
        before = length;
    }
    assert_true(before < 1e-9);
    assert_true(length_at(0, 0.8) == 0 && length_at(0, 0) == 0);
    assert_true(length_at(0.37 * 0.8, 0.8) > 0.5 && length_at(0.3 * 0.8, 0.8) < 0.5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_hardly_flatter_than_at_rest_keeps_its_bits),
        cmocka_unit_test(further_down_they_shorten_to_nothing_without_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
