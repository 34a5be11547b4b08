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

/* Of whatever count, of quotients near 1 and far from it, and with what is not normal among them. Each log is a few units in
 * the last place off, and so is its square; the sums are of at most 100. */
static void squares_are_those_of_logarithms(void **state) {
    (void)state;
    enum { COUNT = 100 };
    double x[COUNT], y[COUNT];
    for (int i = 0; i < COUNT; i++) {
        y[i] = 0.3 + i / 89.0;
        x[i] = i % 3 ? y[i] * (1 + (i % 3 - 1.5) * pow(0.7, i)) : ldexp(1 + i / 97.0, i % 40 - 20);
    }
    for (int k = 0; k < 2; k++) {
        double sum = 0;
        for (int32_t count = 0; count < COUNT; count++) {
            double found = ss_sum_squared_logs(count, x, y), plain = ss_sum_squared_logs_plain(count, x, y);
            assert_near(found, sum, 16 * DBL_EPSILON * sum);
            assert_memory_equal(&found, &plain, sizeof found);
            sum += log(x[count] / y[count]) * log(x[count] / y[count]);
        }
        x[5] = 0x1p-1060, y[50] = 0x1p-1022;
    }
}

/* Of one quotient at a time, so that no sum hides its error. The quotient here is half a unit off, by which its logarithm is,
 * too, however near 0 that is. */
static void each_square_has_its_digits(void **state) {
    (void)state;
    for (double y = 1; y < 2; y += 0.0137)
        for (double quotient = 0.2; quotient < 5; quotient *= 1.0071) {
            double x = quotient * y, logarithm = log(x / y);
            assert_near(ss_sum_squared_logs(1, &x, &y), logarithm * logarithm,
                        8 * DBL_EPSILON * (logarithm * logarithm + fabs(logarithm)));
        }
}

static void the_same_has_none(void **state) {
    (void)state;
    double x[20];
    for (int i = 0; i < 20; i++)
        x[i] = pow(7, i - 9);
    assert_true(ss_sum_squared_logs(20, x, x) == 0);
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
        cmocka_unit_test(squares_are_those_of_logarithms),
        cmocka_unit_test(each_square_has_its_digits),
        cmocka_unit_test(the_same_has_none),
        cmocka_unit_test(exponentials_are_those_of_the_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
