/* The scale of a patch: by selection what sorting gives. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

static int by_z(const void *a, const void *b) {
    const ss_weighted *x = a, *y = b;
    return x->z != y->z ? (x->z > y->z) - (x->z < y->z) : (x->k > y->k) - (x->k < y->k);
}

/* The point of balance of sum k f((z - mu) / width), which is nearly linear about the median where values are dense, after as
 * many steps from the median of the sorted values. */
static double sorted_scale(ss_weighted *values, int32_t count) {
    double half = 0, before = 0, middle = 0;
    qsort(values, (size_t)count, sizeof *values, by_z);
    for (int32_t i = 0; i < count; i++)
        half += values[i].k / 2;
    for (int32_t i = 0; i < count; before += values[i].k, i++) {
        double here = before + values[i].k / 2, last = i > 0 ? before - values[i - 1].k / 2 : -INFINITY;
        if (last < half && half <= here)
            middle = i > 0 ? values[i].z + (here - half) / (here - last) * (values[i - 1].z - values[i].z) : values[0].z;
    }
    if (before - values[count - 1].k / 2 < half)
        middle = values[count - 1].z;
    for (int round = 0; round < 6; round++) {
        double sum = 0, all = 0;
        for (int32_t i = 0; i < count; i++) {
            double off = values[i].z - middle, weight = values[i].k / sqrt(1 + off / 0.02 * (off / 0.02));
            sum += weight * off, all += weight;
        }
        middle += sum / all;
    }
    return middle;
}

/* Values that repeat, rise, fall or are in no order, with the same density or with others. */
static double roll_value(dice *d, int kind, int32_t i) {
    double roll = roll_between(d, -1, 1);
    return kind == 0 ? roll : kind == 1 ? 0.01 * i : kind == 2 ? -0.01 * i : kind == 3 ? floor(3 * roll) : 0.3;
}

static void selection_finds_what_sorting_does(void **state) {
    (void)state;
    dice d = {5};
    for (int32_t count = 1; count < 200; count += 1 + count / 8)
        for (int kind = 0; kind < 5; kind++)
            for (int dense = 0; dense < 2; dense++) {
                ss_weighted values[200], sorted[200];
                for (int32_t i = 0; i < count; i++)
                    sorted[i] = values[i] = (ss_weighted){roll_value(&d, kind, i), dense ? exp(roll_between(&d, -4, 4)) : 1};
                assert_near(ss_find_scale(values, count), sorted_scale(sorted, count), 1e-12);
            }
    assert_true(ss_find_scale(NULL, 0) == 0);
}

/* If less than half of a patch stretches, however much, the scale stays about that of the rest. */
static void few_have_no_say(void **state) {
    (void)state;
    for (double stretch = 0.5; stretch < 1e3; stretch *= 10) {
        ss_weighted values[100];
        for (int32_t i = 0; i < 100; i++)
            values[i] = (ss_weighted){i % 5 < 2 ? stretch : 0.001 * (i % 7), 1};
        assert_near(ss_find_scale(values, 100), 0, 0.03);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(selection_finds_what_sorting_does),
        cmocka_unit_test(few_have_no_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
