/* The box around points. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <string.h>

static skinslide_error error;

static void by_hand(void **state) {
    (void)state;
    const float points[3][3] = {{1, -2, 3}, {-1, 5, 3}, {0, 0, 7}}, expected[2][3] = {{-1, -2, 3}, {1, 5, 7}};
    float found[2][3];
    assert_ok(skinslide_extent(&points[0][0], 3, &found[0][0], &error), &error);
    assert_same_bytes(found, expected, sizeof found);
}

/* Of the two zeros, the first. */
static void bits_are_kept(void **state) {
    (void)state;
    const float points[2][3] = {{-0.0f, 0, FLT_MIN}, {0, -0.0f, INFINITY}},
                expected[2][3] = {{-0.0f, 0, FLT_MIN}, {-0.0f, 0, INFINITY}};
    float found[2][3];
    assert_ok(skinslide_extent(&points[0][0], 2, &found[0][0], &error), &error);
    assert_same_bytes(found, expected, sizeof found);
}

static void what_is_no_number_does_not_count(void **state) {
    (void)state;
    const float points[2][3] = {{NAN, 1, NAN}, {2, NAN, NAN}}, expected[2][3] = {{2, 1, FLT_MAX}, {2, 1, -FLT_MAX}};
    float found[2][3];
    assert_ok(skinslide_extent(&points[0][0], 2, &found[0][0], &error), &error);
    assert_same_bytes(found, expected, sizeof found);
    assert_ok(skinslide_extent(NULL, 0, &found[0][0], &error), &error);
    for (int k = 0; k < 3; k++)
        assert_true(found[0][k] == FLT_MAX && found[1][k] == -FLT_MAX);
}

static void bad_arguments(void **state) {
    (void)state;
    const float point[3] = {0};
    float found[6] = {1};
    const char *text = "no points, a negative count of them, or no place for their extent";
    assert_fails(skinslide_extent(NULL, 1, found, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_extent(point, -1, found, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_extent(point, 1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_true(found[0] == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(bits_are_kept),
        cmocka_unit_test(what_is_no_number_does_not_count),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
