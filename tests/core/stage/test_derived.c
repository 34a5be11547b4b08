/* What follows from points: which vectors are carried, which poses a rate takes, and what is blocked or warned of, with why. */
#include "records.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
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
    const skinslide_value good = vectors("x", VERTICES), few = vectors("primvars:normals", 5), none = blocked_of("x");
    take(&s, "primvars:", "normals", painted_as(vectors("primvars:normals", VERTICES), "vertex"), frames, 4);
    take(&s, "", "normals", vectors("normals", VERTICES), frames, 4);
    take(&s, "", "velocities", vectors("velocities", VERTICES), frames, 4);
    assert_ok(skinslide_stage_derived_check(s.derived, primvar, &good, &error), &error);
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

/* Indices that are out of range at a later sample, and vectors that could not be turned, whether they would be or not. */
static void later_samples_that_cannot_be_carried(void **state) {
    (void)state;
    static const float too_long[3 * VERTICES] = {[7] = FLT_MAX};
    const int32_t far[VERTICES] = {99};
    const skinslide_value indices = array_of("indices", SKINSLIDE_VALUE_INT32, 1, VERTICES, far);
    const skinslide_value bad[] = {indexed_by(vectors("primvars:normals", 1), &indices),
                                   array_of("primvars:normals", SKINSLIDE_VALUE_FLOAT, 3, VERTICES, too_long)};
    static const char *const says[] = {"primvars:normals:indices[0] is 99, but primvars:normals has 1 values",
                                       "vector 2 is too long to be carried: (0, 3.40282e+38, 0)"};
    const skinslide_stage_input *input = input_of(SKINSLIDE_STAGE_DERIVED, "primvars:", "normals");
    for (int i = 0; i < 2; i++) {
        scene s = set_up();
        take(&s, "primvars:", "normals", painted_as(vectors("primvars:normals", VERTICES), "vertex"), frames, 4);
        assert_ok(skinslide_stage_derived_check(s.derived, input, &bad[i], &error), &error);
        expect(&s, 0, "primvars:normals", 0, says[i]);
        tear_down(&s);
    }
}

/* Values that are not finite pass, with a warning. */
static void faults_are_counted(void **state) {
    (void)state;
    float faulty[3 * VERTICES] = {[1] = NAN};
    scene s = set_up();
    skinslide_error warning;
    int32_t faults = 7;
    const skinslide_value good = painted_as(vectors("primvars:normals", VERTICES), "vertex"), few = vectors("x", 5);
    const skinslide_value bad = array_of("primvars:normals", SKINSLIDE_VALUE_FLOAT, 3, VERTICES, faulty);
    take(&s, "primvars:", "normals", good, frames, 4);
    const skinslide_stage_output *output = skinslide_stage_derived_output(s.derived, 0);
    assert_ok(skinslide_stage_derived_faults(s.derived, output, &good, &faults, &warning, &error), &error);
    assert_int_equal(faults, 0);
    assert_ok(skinslide_stage_derived_faults(s.derived, output, &few, &faults, NULL, &error), &error);
    assert_int_equal(faults, 0);
    assert_ok(skinslide_stage_derived_faults(s.derived, output, &bad, &faults, &warning, &error), &error);
    assert_int_equal(faults, 1);
    assert_string_equal(warning.message,
                        "primvars:normals has 1 value that is not finite, which passes as it is: number 0 is (0, nan, 0)");
    faulty[6] = INFINITY;
    assert_ok(skinslide_stage_derived_faults(s.derived, output, &bad, &faults, &warning, &error), &error);
    assert_string_equal(warning.message, "primvars:normals has 2 values that are not finite, which pass as they are: number 0, "
                                         "the first, is (0, nan, 0)");
    assert_fails(skinslide_stage_derived_faults(NULL, output, &bad, &faults, &warning, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no such output, or no place for how many faults it has");
    tear_down(&s);
}

static const skinslide_stage_output *only_output(const scene *s) {
    expect_no_more(s, 1);
    return skinslide_stage_derived_output(s->derived, 0);
}

/* Normals are carried as skinslide_carry does it. */
static void normals_are_carried(void **state) {
    (void)state;
    scene s = set_up();
    float turns[3 * VERTICES] = {0}, out[3 * VERTICES], expected[3 * VERTICES];
    turns[3] = 0.25f, turns[7] = 0.5f;
    const skinslide_value value = vectors("normals", VERTICES);
    const skinslide_stage_pose pose = {sizeof(skinslide_stage_pose), 2, s.grid.points, s.grid.points, turns};
    skinslide_mesh view = view_of(&s.grid);
    take(&s, "", "normals", value, frames, 4);
    const skinslide_stage_output *output = only_output(&s);
    assert_true(output->is_carried && !output->is_double);
    assert_ok(skinslide_stage_derived_value(s.derived, output, &value, &pose, 1, out, &error), &error);
    memcpy(expected, value.data, sizeof expected);
    assert_ok(skinslide_carry(&view, turns, SKINSLIDE_NORMALS_VERTEX, expected, &error), &error);
    assert_same_bytes(out, expected, sizeof out);
    skinslide_stage_pose without = pose;
    without.turns = NULL;
    assert_fails(skinslide_stage_derived_value(s.derived, output, &value, &without, 1, out, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "the pose has no turns");
    tear_down(&s);
}

/* Primvars of doubles stay doubles; where nothing turns, with their bits. Indices are applied. */
static void doubles_are_carried(void **state) {
    (void)state;
    scene s = set_up();
    const double pair[6] = {1.0 / 3, 0, 1e-300, 0, 2.0 / 3, 0};
    const int32_t places[VERTICES] = {0, 1, 0, 1, 0, 1, 0, 1, 0};
    const skinslide_value indices = array_of("indices", SKINSLIDE_VALUE_INT32, 1, VERTICES, places);
    skinslide_value value = painted_as(array_of("primvars:normals", SKINSLIDE_VALUE_DOUBLE, 3, 2, pair), "vertex");
    value = indexed_by(value, &indices);
    float turns[3 * VERTICES] = {0};
    double out[3 * VERTICES];
    turns[0] = (float)sqrt(0.5); /* 90 degrees about x */
    const skinslide_stage_pose pose = {sizeof(skinslide_stage_pose), 2, s.grid.points, s.grid.points, turns};
    take(&s, "primvars:", "normals", value, frames, 4);
    const skinslide_stage_output *output = skinslide_stage_derived_output(s.derived, 0);
    assert_true(output->is_carried && output->is_double);
    assert_ok(skinslide_stage_derived_value(s.derived, output, &value, &pose, 1, out, &error), &error);
    assert_true(out[0] == 1.0 / 3 && fabs(out[1]) < 1e-299);
    for (int v = 1; v < VERTICES; v++)
        assert_same_bytes(out + 3 * v, pair + 3 * places[v], sizeof(double[3]));
    tear_down(&s);
}

static void expect_warning(const scene *s, int32_t number, const char *text) {
    const char *said = skinslide_stage_derived_warning(s->derived, number);
    if (text)
        assert_string_equal(said, text);
    else
        assert_null(said);
}

/* Vectors of one pose on points that have several. */
static void static_vectors_are_warned_of(void **state) {
    (void)state;
    const char *said = "normals has one value for all frames, but points moves: it belongs to one pose alone";
    for (int points = 1; points <= 4; points += 3)
        for (int times = 0; times <= 2; times++) {
            scene s = set_up_at(frames, points, 24);
            take(&s, "", "normals", vectors("normals", VERTICES), frames, times);
            expect(&s, 0, "normals", 1, NULL);
            expect_warning(&s, 0, points > 1 && times < 2 ? said : NULL);
            expect_warning(&s, 1, NULL);
            expect_warning(&s, -1, NULL);
            tear_down(&s);
        }
}

/* ---- Primvars that are offered ---- */

static const skinslide_stage_input *offer(scene *s, const char *name, const char *type, const char *interpolation,
                                          int32_t size) {
    const skinslide_stage_input *input = NULL;
    assert_ok(skinslide_stage_derived_offer(s->derived, name, type, interpolation, size, &input, &error), &error);
    return input;
}

static void offered_primvars_are_inputs(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_stage_input *tangents = offer(&s, "primvars:tangents", "float3[]", "vertex", 1);
    const skinslide_stage_input *velocities = offer(&s, "primvars:v", "vector3f[]", "vertex", 1);
    assert_string_equal(tangents->name, "tangents");
    assert_string_equal(tangents->prefix, "primvars:");
    assert_string_equal(tangents->type_name, "float3[]");
    assert_true(tangents->is_primvar && !tangents->is_inherited && tangents->group == SKINSLIDE_STAGE_DERIVED);
    skinslide_value value = painted_as(vectors("primvars:tangents", VERTICES), "vertex");
    value.type_name = "float3[]";
    assert_ok(skinslide_stage_derived_take(s.derived, tangents, &value, frames, 4, &error), &error);
    assert_fails(skinslide_stage_derived_take(s.derived, tangents, &value, frames, 4, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "nothing to derive into, no input of that, one taken twice, or no times");
    value.name = "primvars:v", value.type_name = "vector3f[]";
    assert_ok(skinslide_stage_derived_take(s.derived, velocities, &value, frames, 4, &error), &error);
    expect(&s, 0, "primvars:tangents", 1, NULL);
    assert_string_equal(skinslide_stage_derived_output(s.derived, 0)->type_name, "float3[]");
    expect(&s, 1, "primvars:v", 2, NULL);
    assert_false(skinslide_stage_derived_output(s.derived, 1)->is_carried);
    value = painted_as(vectors("primvars:tangents", 5), "vertex");
    assert_ok(skinslide_stage_derived_check(s.derived, tangents, &value, &error), &error);
    expect(&s, 0, "primvars:tangents", 0, "primvars:tangents has 5 values, but the mesh has 9 points");
    assert_false(skinslide_stage_derived_output(s.derived, 0)->is_carried);
    expect_no_more(&s, 2);
    tear_down(&s);
}

/* Which primvars follow, as what, and the warnings about those that only seem to. */
static void which_primvars_follow(void **state) {
    (void)state;
    static const char *const names[] = {"normal",     "N",         "tangents",  "tangent",  "tangentU",    "TANGENTV",
                                        "bitangents", "bitangent", "binormals", "binormal", "a:b:tangents"};
    static const char *const types[] = {"float3[]", "half3[]", "double3[]", "normal3f[]", "vector3h[]", "vector3d[]"};
    scene s = set_up();
    char name[64];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
            snprintf(name, sizeof name, "primvars:%s", names[i]);
            assert_non_null(offer(&s, name, types[t], t % 2 ? "vertex" : "faceVarying", 1));
        }
    for (size_t t = 0; t < 6; t++)
        assert_int_equal(offer(&s, "primvars:flow", types[t], "uniform", 1) != NULL, t >= 3);
    assert_non_null(offer(&s, "primvars:velocity", "float3[]", "varying", 1));
    assert_non_null(offer(&s, "primvars:acceleration", "float3[]", "vertex", 1));
    expect_warning(&s, 0, NULL);
    tear_down(&s);
}

static void which_primvars_do_not(void **state) {
    (void)state;
    static const char *const primvars[][3] = {
        {"primvars:normals", "normal3f[]", "vertex"},                 /* of the table */
        {"normals", "normal3f[]", "vertex"},                          /* no primvar */
        {"primvars:skinSlide:elbow:normals", "normal3f[]", "vertex"}, /* ours */
        {"primvars:skel:tangents", "vector3f[]", "vertex"},           /* UsdSkel's */
        {"primvars:Nref", "normal3f[]", "vertex"},                    /* of rest */
        {"primvars:__Nref", "normal3f[]", "vertex"},
        {"primvars:restNormals", "normal3f[]", "vertex"},
        {"primvars:N_rest", "normal3f[]", "vertex"},
        {"primvars:tangents", "vector3f[]", "constant"},
        {"primvars:tangents", "vector3f[]", NULL}, /* which is constant */
        {"primvars:tangents", "vector3f", "vertex"},
        {"primvars:displayColor", "color3f[]", "vertex"},
        {"primvars:tangents", "color3f[]", "vertex"},
        {"primvars:v", "float[]", "vertex"},
        {"primvars:Pref", "point3f[]", "vertex"},
        {"primvars:n", "float3[]", "vertex"}, /* N is a name, n is not */
    };
    scene s = set_up();
    for (size_t i = 0; i < sizeof primvars / sizeof *primvars; i++)
        assert_null(offer(&s, primvars[i][0], primvars[i][1], primvars[i][2], 1));
    expect_warning(&s, 0, NULL);
    tear_down(&s);
}

static void what_nobody_knows_how_to_carry(void **state) {
    (void)state;
    static const struct {
        const char *name, *type, *interpolation;
        int32_t size;
        const char *said;
    } cases[] = {
        {"primvars:tangents", "float4[]", "vertex", 1,
         "primvars:tangents is float4[] and stays as it is while the skin slides: make it normal3f[] or vector3f[] if it lies "
         "along the surface"},
        {"primvars:tangentFrame", "quatf[]", "vertex", 1,
         "primvars:tangentFrame is quatf[] and stays as it is while the skin slides: make it normal3f[] or vector3f[] if it "
         "lies "
         "along the surface"},
        {"primvars:bentNormals", "float3[]", "vertex", 1,
         "primvars:bentNormals is float3[] and stays as it is while the skin slides: make it normal3f[] or vector3f[] if it "
         "lies "
         "along the surface"},
        {"primvars:flow", "vector3f[]", "vertex", 2,
         "primvars:flow has elementSize 2 and stays as it is while the skin slides"},
        {"primvars:v", "vector3f[]", "faceVarying", 1,
         "primvars:v has interpolation faceVarying and stays as it is while the skin slides"},
    };
    scene s = set_up();
    for (int32_t i = 0; i < (int32_t)(sizeof cases / sizeof *cases); i++) {
        assert_null(offer(&s, cases[i].name, cases[i].type, cases[i].interpolation, cases[i].size));
        expect_warning(&s, i, cases[i].said);
    }
    expect_no_more(&s, 0);
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
    const skinslide_stage_pose poses[] = {{sizeof(skinslide_stage_pose), 1, cached, slid[0], NULL},
                                          {sizeof(skinslide_stage_pose), 2, cached, slid[1], NULL},
                                          {sizeof(skinslide_stage_pose), 3, cached, slid[2], NULL}};
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

/* If samples are far apart, rates are found from frame to frame, even where there are too few samples. */
static void rates_from_frame_to_frame(void **state) {
    (void)state;
    const double far[] = {1, 4};
    scene s = set_up_at(far, 2, 24);
    assert_ok(skinslide_stage_derived_fill(s.derived, &error), &error);
    assert_ok(skinslide_stage_derived_fill(s.derived, &error), &error);
    take(&s, "", "velocities", vectors("velocities", VERTICES), far, 2);
    take(&s, "", "accelerations", vectors("accelerations", VERTICES), far, 2);
    EXPECT_TIMES(&s, 0, 1, 1, 2);
    EXPECT_TIMES(&s, 0, 2, 1, 3);
    EXPECT_TIMES(&s, 0, 4, 3, 4);
    EXPECT_TIMES(&s, 1, 2, 1, 2, 3);
    tear_down(&s);
    assert_fails(skinslide_stage_derived_fill(NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "nothing derived");
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
    assert_ok(skinslide_stage_derived_take(s.derived, normals, &value, frames, 4, &error), &error);
    assert_int_equal(skinslide_stage_derived_take(s.derived, normals, &value, frames, 4, &error), SKINSLIDE_BAD_ARGUMENT);
    const skinslide_stage_input *input = normals;
    const char *none = "nothing to derive into, no name or type, or no place for the input";
    assert_fails(skinslide_stage_derived_offer(NULL, "primvars:N", "normal3f[]", "vertex", 1, &input, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_stage_derived_offer(s.derived, NULL, "normal3f[]", "vertex", 1, &input, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_stage_derived_offer(s.derived, "primvars:N", NULL, "vertex", 1, &input, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_stage_derived_offer(s.derived, "primvars:N", "normal3f[]", "vertex", 1, NULL, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, none);
    assert_true(input == normals);
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
        cmocka_unit_test(later_samples_that_cannot_be_carried),
        cmocka_unit_test(faults_are_counted),
        cmocka_unit_test(normals_are_carried),
        cmocka_unit_test(doubles_are_carried),
        cmocka_unit_test(static_vectors_are_warned_of),
        cmocka_unit_test(offered_primvars_are_inputs),
        cmocka_unit_test(which_primvars_follow),
        cmocka_unit_test(which_primvars_do_not),
        cmocka_unit_test(what_nobody_knows_how_to_carry),
        cmocka_unit_test(poses_that_a_value_takes),
        cmocka_unit_test(rates_are_recomputed),
        cmocka_unit_test(rates_from_frame_to_frame),
        cmocka_unit_test(why_rates_are_blocked),
        cmocka_unit_test(arguments_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
