/* What follows from points: which normals count, which poses a rate takes, and what is blocked, with why. */
#include "records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
enum { VERTICES = 9, CORNERS = 16, FACES = 4 };
static const double frames[] = {1, 2, 3, 4};

typedef struct scene {
    test_mesh grid; /* 2 x 2 quads */
    skinslide_stage_mesh *mesh;
    skinslide_stage_derived *derived;
} scene;

static scene set_up_at(const double *times, int64_t count, double rate) {
    scene s = {quad_grid(2, 2), NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    assert_ok(skinslide_stage_derived_create(s.mesh, times, count, rate, &s.derived, &error), &error);
    return s;
}

static scene set_up(void) {
    return set_up_at(frames, 4, 24);
}

static void tear_down(scene *s) {
    skinslide_stage_derived_destroy(s->derived);
    skinslide_stage_mesh_destroy(s->mesh);
    free_mesh(&s->grid);
}

static skinslide_value vectors(const char *name, int64_t count) {
    static const float up[3 * CORNERS] = {0, 0, 1, 0, 0, 1};
    return array_of(name, SKINSLIDE_VALUE_FLOAT, 3, count, up);
}

static void take(scene *s, const char *prefix, const char *name, skinslide_value value, const double *times, int64_t count) {
    const skinslide_stage_input *input = input_of(SKINSLIDE_STAGE_DERIVED, prefix, name);
    assert_ok(skinslide_stage_derived_take(s->derived, input, &value, times, count, &error), &error);
}

static void expect(const scene *s, int32_t number, const char *name, int32_t pose_count, const char *reason) {
    const skinslide_stage_output *output = skinslide_stage_derived_output(s->derived, number);
    assert_non_null(output);
    assert_string_equal(output->name, name);
    assert_int_equal(output->pose_count, pose_count);
    if (reason)
        assert_string_equal(output->reason, reason);
    else
        assert_null(output->reason);
}

static void expect_no_more(const scene *s, int32_t count) {
    assert_null(skinslide_stage_derived_output(s->derived, count));
    assert_null(skinslide_stage_derived_output(s->derived, -1));
}

/* ---- Normals ---- */

static void normals_of_every_layout(void **state) {
    (void)state;
    static const char *const layouts[] = {"vertex", "varying", "faceVarying", "uniform"};
    static const int32_t counts[] = {VERTICES, VERTICES, CORNERS, FACES};
    for (int i = 0; i < 4; i++) {
        scene s = set_up();
        take(&s, "", "normals", painted_as(vectors("normals", counts[i]), layouts[i]), frames, 4);
        expect(&s, 0, "normals", 1, NULL);
        assert_int_equal(skinslide_stage_derived_output(s.derived, 0)->count, counts[i]);
        assert_string_equal(skinslide_stage_derived_output(s.derived, 0)->type_name, "normal3f[]");
        expect_no_more(&s, 1);
        tear_down(&s);
    }
}

/* The attribute is by vertex where it does not say, a primvar constant; and constant ones do not follow from points. */
static void fallbacks_of_interpolation(void **state) {
    (void)state;
    scene s = set_up();
    take(&s, "primvars:", "normals", nothing_of("primvars:normals"), NULL, 0);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4);
    expect(&s, 0, "normals", 1, NULL);
    tear_down(&s);
    s = set_up();
    take(&s, "primvars:", "normals", vectors("primvars:normals", 1), frames, 4);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4); /* hidden by the primvar */
    expect_no_more(&s, 0);
    tear_down(&s);
    s = set_up();
    take(&s, "", "normals", painted_as(vectors("normals", 1), "constant"), frames, 4);
    expect_no_more(&s, 0);
    tear_down(&s);
}

static void primvars_win_and_lose_their_indices(void **state) {
    (void)state;
    scene s = set_up();
    const int32_t zeros[CORNERS] = {0};
    const skinslide_value indices = array_of("primvars:normals:indices", SKINSLIDE_VALUE_INT32, 1, CORNERS, zeros);
    skinslide_value primvar = painted_as(indexed_by(vectors("primvars:normals", 1), &indices), "faceVarying");
    primvar.type_name = "vector3f[]";
    take(&s, "primvars:", "normals", primvar, frames, 4);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4);
    expect(&s, 0, "primvars:normals", 1, NULL);
    assert_string_equal(skinslide_stage_derived_output(s.derived, 0)->type_name, "vector3f[]"); /* as it came */
    assert_string_equal(skinslide_stage_derived_output(s.derived, 0)->hidden, "normals");
    expect(&s, 1, "primvars:normals:indices", 0, NULL);
    assert_string_equal(skinslide_stage_derived_output(s.derived, 1)->type_name, "int[]");
    expect_no_more(&s, 2);
    tear_down(&s);
}

/* Were primvars:normals blocked alone, normals would be read. */
static void bad_normals_are_blocked_with_what_they_hide(void **state) {
    (void)state;
    scene s = set_up();
    take(&s, "primvars:", "normals", painted_as(vectors("primvars:normals", 3), "faceVarying"), frames, 4);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4);
    expect(&s, 0, "primvars:normals", 0, "primvars:normals has 3 values, but the mesh has 16 face corners");
    expect(&s, 1, "normals", 0, NULL);
    expect_no_more(&s, 2);
    tear_down(&s);
}

static void why_normals_are_blocked(void **state) {
    (void)state;
    const struct {
        skinslide_value value;
        const char *reason;
    } cases[] = {
        {vectors("normals", 3), "normals has 3 values, but the mesh has 9 points"},
        {painted_as(vectors("normals", 3), "uniform"), "normals has 3 values, but the mesh has 4 faces"},
        {painted_as(vectors("normals", 3), "sideways"),
         "normals has interpolation sideways; it must be vertex, varying, faceVarying or uniform"},
        {other_of("normals", "token"), "normals is not an array of points"},
        {blocked_of("normals"), "there is no value"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene s = set_up();
        take(&s, "", "normals", cases[i].value, frames, 4);
        expect(&s, 0, "normals", 0, cases[i].reason);
        tear_down(&s);
    }
}

/* A later sample that has another length, as the first could, blocks them at all times. */
static void later_samples_are_looked_at(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_stage_input *primvar = input_of(SKINSLIDE_STAGE_DERIVED, "primvars:", "normals");
    const skinslide_stage_input *velocities = input_of(SKINSLIDE_STAGE_DERIVED, "", "velocities");
    const int32_t far[VERTICES] = {99};
    const skinslide_value indices = array_of("indices", SKINSLIDE_VALUE_INT32, 1, VERTICES, far);
    const skinslide_value good = vectors("x", VERTICES), few = vectors("primvars:normals", 5), none = blocked_of("x");
    const skinslide_value indexed = indexed_by(vectors("x", 1), &indices); /* which are not looked at yet */
    take(&s, "primvars:", "normals", painted_as(vectors("primvars:normals", VERTICES), "vertex"), frames, 4);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4);
    take(&s, "", "velocities", vectors("velocities", VERTICES), frames, 4);
    assert_ok(skinslide_stage_derived_check(s.derived, primvar, &good, &error), &error);
    assert_ok(skinslide_stage_derived_check(s.derived, primvar, &indexed, &error), &error);
    assert_ok(skinslide_stage_derived_check(s.derived, velocities, &good, &error), &error);
    expect(&s, 0, "primvars:normals", 1, NULL);
    expect(&s, 1, "velocities", 2, NULL);
    assert_ok(skinslide_stage_derived_check(s.derived, primvar, &few, &error), &error);
    assert_ok(skinslide_stage_derived_check(s.derived, primvar, &few, &error), &error);
    assert_ok(skinslide_stage_derived_check(s.derived, velocities, &none, &error), &error);
    expect(&s, 0, "primvars:normals", 0, "primvars:normals has 5 values, but the mesh has 9 points");
    expect(&s, 1, "velocities", 0, "there is no value");
    expect(&s, 2, "normals", 0, NULL);
    expect_no_more(&s, 3);
    tear_down(&s);
}

/* As skinslide_normals makes them. */
static void normals_are_recomputed(void **state) {
    (void)state;
    scene s = set_up();
    float *slid = bumped(&s.grid, 1, 1, 1, 0.5), out[3 * VERTICES], expected[3 * VERTICES];
    const skinslide_value value = vectors("normals", VERTICES);
    const skinslide_stage_pose pose = {sizeof(skinslide_stage_pose), 2, s.grid.points, slid};
    skinslide_mesh view = view_of(&s.grid);
    take(&s, "", "normals", value, frames, 4);
    const skinslide_stage_output *output = skinslide_stage_derived_output(s.derived, 0);
    assert_ok(skinslide_stage_derived_value(s.derived, output, &value, &pose, 1, out, &error), &error);
    memcpy(expected, value.data, sizeof expected);
    assert_ok(skinslide_normals(&view, s.grid.points, slid, SKINSLIDE_NORMALS_VERTEX, 0, expected, &error), &error);
    assert_same_bytes(out, expected, sizeof out);
    free(slid);
    tear_down(&s);
}

/* ---- Rates ---- */

static void expect_times(const scene *s, int32_t number, double time, int32_t count, const double *expected) {
    double times[3];
    const skinslide_stage_output *output = skinslide_stage_derived_output(s->derived, number);
    assert_int_equal(skinslide_stage_derived_times(s->derived, output, time, times), count);
    for (int32_t i = 0; i < count; i++)
        assert_true(times[i] == expected[i]);
}

#define EXPECT_TIMES(s, number, time, ...)                                                                                     \
    expect_times(s, number, time, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})

static void poses_that_a_value_takes(void **state) {
    (void)state;
    scene s = set_up();
    take(&s, "", "velocities", vectors("velocities", VERTICES), frames, 4);
    take(&s, "", "accelerations", vectors("accelerations", VERTICES), frames, 4);
    expect(&s, 0, "velocities", 2, NULL);
    expect(&s, 1, "accelerations", 3, NULL);
    EXPECT_TIMES(&s, 0, 2.0, 1, 3);
    EXPECT_TIMES(&s, 0, 2.5, 2, 3);
    EXPECT_TIMES(&s, 0, 1.0, 1, 2);
    EXPECT_TIMES(&s, 0, 4.0, 3, 4);
    EXPECT_TIMES(&s, 0, 2.0 + 1e-9, 1, 3);
    EXPECT_TIMES(&s, 1, 2.0, 1, 2, 3);
    EXPECT_TIMES(&s, 1, 2.5, 2, 2.5, 3);
    EXPECT_TIMES(&s, 1, 1.0, 1, 2, 3);
    EXPECT_TIMES(&s, 1, 4.0, 2, 3, 4);
    EXPECT_TIMES(&s, 1, 0.0, 0, 1, 2);
    EXPECT_TIMES(&s, 1, 9.0, 3, 4, 9);
    tear_down(&s);
}

/* Points that drift by one unit a frame more than the cache's, at 24 frames a second. */
static void rates_are_recomputed(void **state) {
    (void)state;
    scene s = set_up();
    float slid[3][3 * VERTICES], cached[3 * VERTICES] = {0}, out[3 * VERTICES];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3 * VERTICES; i++)
            slid[k][i] = (float)(k * k);
    const skinslide_stage_pose poses[] = {{sizeof(skinslide_stage_pose), 1, cached, slid[0]},
                                          {sizeof(skinslide_stage_pose), 2, cached, slid[1]},
                                          {sizeof(skinslide_stage_pose), 3, cached, slid[2]}};
    const float zeros[3 * VERTICES] = {0};
    const skinslide_value value = array_of("velocities", SKINSLIDE_VALUE_FLOAT, 3, VERTICES, zeros);
    take(&s, "", "velocities", value, frames, 4);
    take(&s, "", "accelerations", value, frames, 4);
    const skinslide_stage_output *velocities = skinslide_stage_derived_output(s.derived, 0);
    assert_ok(skinslide_stage_derived_value(s.derived, velocities, &value, poses, 2, out, &error), &error);
    assert_near((double)out[0], 24, 1e-4); /* (1 - 0) / (1 / 24) */
    const skinslide_stage_output *accelerations = skinslide_stage_derived_output(s.derived, 1);
    assert_ok(skinslide_stage_derived_value(s.derived, accelerations, &value, poses, 3, out, &error), &error);
    assert_near((double)out[0], 2 * 24 * 24, 1e-2); /* (4 - 2 * 1 + 0) / (1 / 24)^2 */
    assert_fails(skinslide_stage_derived_value(s.derived, accelerations, &value, poses, 2, out, &error), &error,
                 SKINSLIDE_BAD_POINTS, "that takes 3 samples of points, and there are 2");
    const skinslide_value less = vectors("velocities", 5), none = blocked_of("velocities");
    assert_fails(skinslide_stage_derived_value(s.derived, velocities, &less, poses, 2, out, &error), &error,
                 SKINSLIDE_BAD_POINTS, "velocities has 5 values, but the mesh has 9 points");
    assert_fails(skinslide_stage_derived_value(s.derived, velocities, &none, poses, 2, out, &error), &error,
                 SKINSLIDE_BAD_POINTS, "there is no value");
    tear_down(&s);
}

static void why_rates_are_blocked(void **state) {
    (void)state;
    static const double rates[] = {0, -24, NAN, INFINITY};
    static const char *const said[] = {"the stage has 0 time codes per second", "the stage has -24 time codes per second",
                                       "the stage has nan time codes per second", "the stage has inf time codes per second"};
    const double others[] = {1, 2.5, 4}, two[] = {1, 1 + 1e-9, 2};
    skinslide_value value = vectors("velocities", VERTICES);
    for (int i = 0; i < 4; i++) {
        scene s = set_up_at(frames, 4, rates[i]);
        take(&s, "", "velocities", value, frames, 4);
        expect(&s, 0, "velocities", 0, said[i]);
        tear_down(&s);
    }
    scene s = set_up();
    take(&s, "", "velocities", value, others, 3);
    take(&s, "", "accelerations", value, NULL, 0);
    expect(&s, 0, "velocities", 0, "their samples are at other times than those of points");
    expect(&s, 1, "accelerations", 0, "their samples are at other times than those of points");
    tear_down(&s);
    s = set_up_at(two, 3, 24); /* which are two, but for noise */
    take(&s, "", "velocities", value, two, 3);
    take(&s, "", "accelerations", value, two, 3);
    expect(&s, 0, "velocities", 2, NULL);
    expect(&s, 1, "accelerations", 0, "that takes 3 samples of points, and there are 2");
    tear_down(&s);
    s = set_up();
    take(&s, "", "velocities", vectors("velocities", 5), frames, 4);
    expect(&s, 0, "velocities", 0, "velocities has 5 values, but the mesh has 9 points");
    tear_down(&s);
}

static void arguments_that_are_none(void **state) {
    (void)state;
    scene s = set_up();
    float out[3 * CORNERS];
    const skinslide_value value = painted_as(vectors("normals", VERTICES), "vertex");
    const skinslide_stage_input *normals = input_of(SKINSLIDE_STAGE_DERIVED, "", "normals");
    skinslide_stage_output copy = {0};
    assert_int_equal(skinslide_stage_derived_take(s.derived, normals, &value, NULL, 3, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_derived_take(s.derived, NULL, &value, frames, 4, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_derived_value(s.derived, &copy, &value, NULL, 0, out, &error), SKINSLIDE_BAD_ARGUMENT);
    for (int i = 0; i < 99; i++) /* taken again and again, it ends */
        if (skinslide_stage_derived_take(s.derived, normals, &value, frames, 4, &error))
            break;
    assert_int_equal(error.status, SKINSLIDE_BAD_ARGUMENT);
    tear_down(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_of_every_layout),
        cmocka_unit_test(fallbacks_of_interpolation),
        cmocka_unit_test(primvars_win_and_lose_their_indices),
        cmocka_unit_test(bad_normals_are_blocked_with_what_they_hide),
        cmocka_unit_test(why_normals_are_blocked),
        cmocka_unit_test(later_samples_are_looked_at),
        cmocka_unit_test(normals_are_recomputed),
        cmocka_unit_test(poses_that_a_value_takes),
        cmocka_unit_test(rates_are_recomputed),
        cmocka_unit_test(why_rates_are_blocked),
        cmocka_unit_test(arguments_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
