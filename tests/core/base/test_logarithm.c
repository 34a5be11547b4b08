/* Logarithm and exponential against the C library's, whose own error is under one unit in the last place. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void one_has_none(void **state) {
    (void)state;
    assert_true(ss_log(1) == 0 && ss_exp(0) == 1);
}

/* A quotient and a product are each off by half a unit, and so are three sums. */
static void logarithms_are_those_of_the_library(void **state) {
    (void)state;
    for (double x = 1e-12; x < 1e12; x *= 1.00137)
        assert_near(ss_log(x), log(x), 3 * DBL_EPSILON * fabs(log(x)));
    for (double off = 0x1p-52; off < 0.5; off *= 1.7) {
        assert_near(ss_log(1 + off), log(1 + off), 3 * DBL_EPSILON * fabs(log(1 + off)));
        assert_near(ss_log(1 - off), log(1 - off), 3 * DBL_EPSILON * fabs(log(1 - off)));
    }
    assert_near(ss_log(0x1p-1074), log(0x1p-1074), 1e-12);
    assert_near(ss_log(DBL_MAX), log(DBL_MAX), 1e-12);
}

/* Also if one of them is not a normal number, and on processors with and without AVX2. */
static void several_are_each_to_the_bit(void **state) {
    (void)state;
    enum { COUNT = 1000 };
    double x[COUNT], several[COUNT];
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < COUNT; i++)
            x[i] = ldexp(1 + i / 997.0, i % 2040 - 1020);
        if (k % 2)
            x[300] = 0x1p-1060;
        memcpy(several, x, sizeof x);
        (k < 2 ? ss_logs : ss_logs_plain)(COUNT, several);
        for (int i = 0; i < COUNT; i++) {
            double one = ss_log(x[i]);
            assert_memory_equal(&several[i], &one, sizeof one);
        }
    }
}

/* For any count, and with numbers among them that are not normal. */
static void squares_are_summed_in_their_order(void **state) {
    (void)state;
    enum { COUNT = 100 };
    double x[COUNT], y[COUNT];
    for (int i = 0; i < COUNT; i++)
        x[i] = ldexp(1 + i / 97.0, i % 40 - 20), y[i] = 1 + i / 89.0;
    for (int k = 0; k < 4; k++) {
        double sum = 0;
        if (k % 2)
            x[5] = 0x1p-1060;
        for (int32_t count = 0; count < COUNT; count++) {
            double found = (k < 2 ? ss_sum_squared_logs : ss_sum_squared_logs_plain)(count, x, y);
            assert_memory_equal(&found, &sum, sizeof sum);
            double logarithm = ss_log(x[count] / y[count]);
            sum += logarithm * logarithm;
        }
        x[5] = 3;
    }
}

static void exponentials_are_those_of_the_library(void **state) {
    (void)state;
    for (double x = -700; x < 700; x += 0.37)
        assert_near(ss_exp(x), exp(x), 4 * DBL_EPSILON * exp(x));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_has_none),
        cmocka_unit_test(logarithms_are_those_of_the_library),
        cmocka_unit_test(several_are_each_to_the_bit),
        cmocka_unit_test(squares_are_summed_in_their_order),
        cmocka_unit_test(exponentials_are_those_of_the_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
