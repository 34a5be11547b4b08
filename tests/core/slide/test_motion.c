/* Velocities and accelerations of slid points: the cache's, plus those of the displacement. */
#include "support.h"

#include <math.h>
#include <string.h>

static skinslide_error error;

/* A displacement of d = a + b t + c t^2 at uneven times: its velocity between two is b + c (t0 + t1), its acceleration 2 c, at
 * any times. Small whole numbers and quarters, exact in float. */
enum { A = 1, B = 3, C = 2 };
static const double times[3] = {-0.5, 0.25, 1.5};

typedef struct moves {
    float cached[3][3], slid[3][3];
    skinslide_sample samples[3];
} moves;

static void make_moves(moves *m) {
    for (int i = 0; i < 3; i++) {
        float displacement = (float)(A + B * times[i] + C * times[i] * times[i]);
        for (int k = 0; k < 3; k++) {
            m->cached[i][k] = (float)(i + k);
            m->slid[i][k] = m->cached[i][k] + (k == 2 ? 5 : (k + 1) * displacement); /* the third does not change */
        }
        m->samples[i] = (skinslide_sample){sizeof(skinslide_sample), times[i], m->cached[i], m->slid[i]};
    }
}

static void velocities_by_hand(void **state) {
    (void)state;
    moves m;
    float rates[3] = {10, -10, -0.0f};
    make_moves(&m);
    assert_ok(skinslide_velocities(1, m.samples, rates, &error), &error);
    double rate = B + C * (times[0] + times[1]);
    assert_near(rates[0], 10 + rate, 0);
    assert_near(rates[1], -10 + 2 * rate, 0);
    assert_same_bytes(&rates[2], &(float){-0.0f}, sizeof(float));
}

static void accelerations_by_hand(void **state) {
    (void)state;
    moves m;
    float rates[3] = {10, -10, -0.0f};
    make_moves(&m);
    assert_ok(skinslide_accelerations(1, m.samples, rates, &error), &error);
    assert_near(rates[0], 10 + 2 * C, 0);
    assert_near(rates[1], -10 + 4 * C, 0);
    assert_same_bytes(&rates[2], &(float){-0.0f}, sizeof(float));
}

static void bad_samples(void **state) {
    (void)state;
    moves m;
    float rates[3] = {1, 2, 3};
    make_moves(&m);
    m.samples[1].seconds = times[0];
    assert_fails(skinslide_velocities(1, m.samples, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "sample times do not ascend: -0.5 s, then -0.5 s");
    m.samples[1].seconds = NAN;
    assert_fails(skinslide_accelerations(1, m.samples, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "sample 1 has no points, or no finite time");
    make_moves(&m);
    m.samples[0].slid = NULL;
    assert_fails(skinslide_velocities(1, m.samples, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "sample 0 has no points, or no finite time");
    make_moves(&m);
    m.samples[2].seconds = 0;
    assert_fails(skinslide_accelerations(1, m.samples, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "sample times do not ascend: 0.25 s, then 0 s");
    const char *text = "no samples, no rates to correct, or a negative count";
    assert_fails(skinslide_velocities(1, NULL, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_accelerations(1, m.samples, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_velocities(-1, m.samples, rates, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_true(rates[0] == 1 && rates[1] == 2 && rates[2] == 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(velocities_by_hand),
        cmocka_unit_test(accelerations_by_hand),
        cmocka_unit_test(bad_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
