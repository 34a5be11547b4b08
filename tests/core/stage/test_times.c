/* Times: merged in order, the one given first kept of those that noise sets apart; written as people write frames. */
#include "records.h"

#include <float.h>
#include <math.h>
#include <string.h>

static skinslide_error error;

static void expect_merged(int64_t count, const double *times, int64_t expected_count, const double *expected) {
    double merged[8];
    memcpy(merged, times, (size_t)count * sizeof *merged);
    assert_ok(skinslide_stage_merge_times(merged, &count, &error), &error);
    assert_int_equal(count, expected_count);
    for (int64_t i = 0; i < count; i++)
        assert_true(merged[i] == expected[i]);
}

#define TIMES(...)                                                                                                             \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]) {                                                             \
        __VA_ARGS__                                                                                                            \
    }

static void times_are_merged_in_order(void **state) {
    (void)state;
    expect_merged(0, (double[]){0}, 0, (double[]){0});
    expect_merged(TIMES(3, 1, 2), TIMES(1, 2, 3));
    expect_merged(TIMES(1, 2, 1, 2), TIMES(1, 2));
    expect_merged(TIMES(1, 1 + 1e-5), TIMES(1, 1 + 1e-5));
}

/* Noise on either side of a time: the first one given stays, to the bit. */
static void the_first_given_stays(void **state) {
    (void)state;
    expect_merged(TIMES(1, 1 + 1e-9, 2 - 1e-9, 2), TIMES(1, 2 - 1e-9));
    expect_merged(TIMES(1 + 1e-9, 1), TIMES(1 + 1e-9));
    expect_merged(TIMES(5, 1 + 1e-9, 1 - 1e-9, 1), TIMES(1 + 1e-9, 5));
}

static void times_that_are_none(void **state) {
    (void)state;
    double times[2] = {1, NAN};
    int64_t count = 2, negative = -1;
    assert_fails(skinslide_stage_merge_times(times, &count, &error), &error, SKINSLIDE_BAD_ARGUMENT, "time 1 is nan");
    assert_int_equal(count, 2);
    assert_int_equal(skinslide_stage_merge_times(NULL, &count, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_merge_times(times, &negative, &error), SKINSLIDE_BAD_ARGUMENT);
}

static void expect_between(int64_t count, const double *times, int64_t expected_count, const double *expected) {
    double between[8];
    int64_t counted = -1, found = -1;
    assert_ok(skinslide_stage_times_between(times, count, NULL, &counted, &error), &error);
    assert_ok(skinslide_stage_times_between(times, count, between, &found, &error), &error);
    assert_int_equal(counted, expected_count);
    assert_int_equal(found, expected_count);
    for (int64_t i = 0; i < expected_count; i++)
        assert_true(between[i] == expected[i]);
}

static void frames_between_samples_that_are_more_than_one_apart(void **state) {
    (void)state;
    expect_between(0, NULL, 0, NULL);
    expect_between(TIMES(1, 2, 3), 0, NULL);
    expect_between(TIMES(1.5, 2.25), 0, NULL);
    expect_between(TIMES(1, 3, 4, 6.5), TIMES(2, 5, 6));
    expect_between(TIMES(-1.5, 0.75), TIMES(-1, 0));
}

/* A sample that noise has moved off a frame is that frame. */
static void noise_makes_no_frame(void **state) {
    (void)state;
    expect_between(TIMES(1, 2 + 1e-9), 0, NULL);
    expect_between(TIMES(1 - 1e-9, 3 + 1e-9), TIMES(2));
    expect_between(TIMES(1 + 1e-9, 3 - 1e-9), TIMES(2));
}

static void frames_that_are_too_many(void **state) {
    (void)state;
    int64_t count = -1;
    const double times[] = {-4e6, 0, 7e6}, far[] = {-DBL_MAX, DBL_MAX};
    const char *message =
        "by frame 7000000 there are more than 10000000 frames between samples; name the frames that are wanted";
    assert_fails(skinslide_stage_times_between(times, 3, NULL, &count, &error), &error, SKINSLIDE_BAD_ARGUMENT, message);
    assert_int_equal(count, -1);
    assert_int_equal(skinslide_stage_times_between(far, 2, NULL, &count, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_times_between(NULL, 1, NULL, &count, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_times_between(times, -1, NULL, &count, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_times_between(times, 2, NULL, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
}

static void expect_text(double frame, const char *expected) {
    char text[32];
    skinslide_stage_frame_text(frame, text);
    assert_string_equal(text, expected);
}

static void frames_as_people_write_them(void **state) {
    (void)state;
    expect_text(1012, "1012");
    expect_text(1012.25, "1012.25");
    expect_text(1012 + 1e-9, "1012");
    expect_text(-0.5, "-0.5");
    expect_text(-1e-9, "0");
    expect_text(1.0 / 3, "0.333333");
    expect_text(1e300, "1e+300");
    expect_text(999999999999999, "999999999999999");
    expect_text(-DBL_MAX, "-1.79769e+308");
    expect_text(NAN, "nan");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_are_merged_in_order),   cmocka_unit_test(the_first_given_stays),
        cmocka_unit_test(times_that_are_none),         cmocka_unit_test(frames_between_samples_that_are_more_than_one_apart),
        cmocka_unit_test(noise_makes_no_frame),        cmocka_unit_test(frames_that_are_too_many),
        cmocka_unit_test(frames_as_people_write_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
