/* ss_orient is exact: against whole numbers of 128 bits, which hold every product of its coordinates. */
#include "support.h"

#include <math.h>

__extension__ typedef __int128 wide;

/* Coordinates in units of 2^-60, under 2^60: a difference has 61 bits, a product 122, a sum of two 123. */
static int exact(const int64_t a[2], const int64_t b[2], const int64_t c[2]) {
    wide left = (wide)(a[0] - c[0]) * (b[1] - c[1]), right = (wide)(a[1] - c[1]) * (b[0] - c[0]);
    return (left > right) - (left < right);
}

/* A coordinate that a double holds exactly whatever the power of two: 53 bits at most. */
static void to_doubles(const int64_t p[2], double unit, double out[2]) {
    out[0] = (double)p[0] * unit, out[1] = (double)p[1] * unit;
}

static int oriented(const int64_t a[2], const int64_t b[2], const int64_t c[2], double unit) {
    double x[2], y[2], z[2];
    to_doubles(a, unit, x), to_doubles(b, unit, y), to_doubles(c, unit, z);
    int turn = ss_orient(x, y, z);
    assert_int_equal(ss_orient(y, z, x), turn);
    assert_int_equal(ss_orient(z, x, y), turn);
    assert_int_equal(ss_orient(y, x, z), -turn);
    return turn;
}

static void check_all_scales(const int64_t a[2], const int64_t b[2], const int64_t c[2]) {
    int expected = exact(a, b, c);
    assert_int_equal(oriented(a, b, c, 0x1p-60), expected);
    assert_int_equal(oriented(a, b, c, 0x1p-210), expected); /* faces that crowd together */
}

static void random_point(dice *d, int32_t bits, int64_t out[2]) {
    out[0] = (int64_t)(roll(d) >> (64 - bits)), out[1] = (int64_t)(roll(d) >> (64 - bits));
}

/* The nearest below that a double holds: 53 bits. */
static int64_t representable(int64_t x) {
    int64_t unit = 1;
    while (x / unit >= (int64_t)1 << 53)
        unit *= 2;
    return x / unit * unit;
}

static void random_points(void **state) {
    (void)state;
    dice d = {1};
    for (int i = 0; i < 100000; i++) {
        int64_t a[2], b[2], c[2];
        random_point(&d, 53, a), random_point(&d, 53, b), random_point(&d, 53, c);
        check_all_scales(a, b, c);
    }
}

/* Points on the line of two others up to rounding, and a few units off it. */
static void points_almost_on_a_line(void **state) {
    (void)state;
    dice d = {2};
    int zeros = 0;
    for (int i = 0; i < 200000; i++) {
        int64_t a[2], b[2], c[2];
        random_point(&d, 52, a), random_point(&d, 52, b);
        double share = roll_share(&d);
        for (int k = 0; k < 2; k++)
            c[k] = a[k] + (int64_t)(share * (double)(b[k] - a[k])) + roll_below(&d, 5) - 2;
        c[0] = c[0] < 0 ? 0 : c[0], c[1] = c[1] < 0 ? 0 : c[1];
        check_all_scales(a, b, c);
        zeros += exact(a, b, c) == 0;
    }
    /* Points of few bits are often exactly on the line. */
    for (int i = 0; i < 100000; i++) {
        int64_t a[2], b[2], c[2];
        random_point(&d, 3, a), random_point(&d, 3, b), random_point(&d, 3, c);
        check_all_scales(a, b, c);
        zeros += exact(a, b, c) == 0;
    }
    assert_true(zeros > 1000);
}

/* Coordinates of very different size: 20 bits, shifted by up to 33. */
static void points_of_mixed_sizes(void **state) {
    (void)state;
    dice d = {3};
    for (int i = 0; i < 200000; i++) {
        int64_t p[3][2];
        for (int k = 0; k < 6; k++)
            p[k / 2][k % 2] = (int64_t)(roll(&d) >> 44) << roll_below(&d, 34);
        check_all_scales(p[0], p[1], p[2]);
    }
}

/* From a point near the corner to a point far away, with bits that their difference has no room for, and points on that line as
 * exactly as they can be. */
static void differences_that_are_rounded(void **state) {
    (void)state;
    dice d = {5};
    for (int i = 0; i < 200000; i++) {
        int64_t a[2], b[2], c[2];
        random_point(&d, 40 + roll_below(&d, 14), a), random_point(&d, 60, b);
        double share = ldexp(roll_share(&d), -roll_below(&d, 10));
        for (int k = 0; k < 2; k++) {
            b[k] = representable(b[k]);
            c[k] = representable(a[k] + (int64_t)(share * (double)(b[k] - a[k])));
        }
        check_all_scales(a, b, c);
    }
}

static void points_of_one_place(void **state) {
    (void)state;
    const double a[2] = {0.1, 0.7}, b[2] = {0.3, 0.2};
    assert_int_equal(ss_orient(a, a, b), 0);
    assert_int_equal(ss_orient(a, b, a), 0);
    assert_int_equal(ss_orient(b, a, a), 0);
    assert_int_equal(ss_orient(a, a, a), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_points),         cmocka_unit_test(points_almost_on_a_line),
        cmocka_unit_test(points_of_mixed_sizes), cmocka_unit_test(differences_that_are_rounded),
        cmocka_unit_test(points_of_one_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
