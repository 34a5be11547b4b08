/* Controls of a patch: paint expanded, off the patch replaced, by frame without copies of what stays; and what is refused. */
#include "records.h"

#include <math.h>
#include <string.h>

static skinslide_error error;
#define WEIGHT   "primvars:skinSlide:elbow:weight"
#define DENSITY  "primvars:skinSlide:elbow:forceDensity"
#define FARTHEST "primvars:skinSlide:elbow:maxDistance"
enum { VERTICES = 6, FACES = 2 };

/* 2 x 1 quads, of which the patch has the first: vertices 0, 1, 3, 4. */
static patch_scene set_up(const skinslide_stage_live *live) {
    patch_scene s = {quad_grid(2, 1), NULL, NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    assert_ok(skinslide_stage_patch_create(s.mesh, "elbow", live, &s.patch, &error), &error);
    assert_ok(patch_takes(s.patch, "patch", painted_as(INTS("patch", 1, 0), "uniform"), &error), &error);
    s.controls = scene_controls(s.patch);
    return s;
}

static void takes(skinslide_stage_controls *controls, const char *name, skinslide_value value) {
    assert_ok(controls_take(controls, name, value, &error), &error);
}

static skinslide_controls got(skinslide_stage_controls *controls) {
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    assert_ok(skinslide_stage_controls_get(controls, &out, &error), &error);
    return out;
}

#define EXPECT_FLOATS(actual, ...) assert_same_bytes(actual, ((float[]){__VA_ARGS__}), sizeof((float[]){__VA_ARGS__}))

/* ---- Values ---- */

static void paint_by_vertex(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    takes(s.controls, "weight", painted_as(FLOATS(WEIGHT, 0.25f, 0.5f, NAN, 0, 2, -INFINITY), "vertex"));
    takes(s.controls, "forceDensity", painted_as(FLOATS(DENSITY, 1, 2, 0, 3, 4, NAN), "vertex"));
    takes(s.controls, "maxDistance", painted_as(FLOATS(FARTHEST, 0, 1, -1, INFINITY, 2, NAN), "vertex"));
    skinslide_controls out = got(s.controls);
    EXPECT_FLOATS(out.weight, 0.25f, 0.5f, 0, 0, 2, 0);
    EXPECT_FLOATS(out.vertex_density, 1, 2, 1, 3, 4, 1);
    EXPECT_FLOATS(out.max_distance, 0, 1, 0, INFINITY, 2, 0);
    assert_null(out.face_density);
    end_scene(&s);
}

static void paint_that_is_constant(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    takes(s.controls, "weight", FLOATS(WEIGHT, 0.5f));
    takes(s.controls, "maxDistance", painted_as(NUMBER(FARTHEST, 3), "constant"));
    takes(s.controls, "forceDensity", NUMBER(DENSITY, 7)); /* changes no ratio */
    skinslide_controls out = got(s.controls);
    EXPECT_FLOATS(out.weight, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f);
    EXPECT_FLOATS(out.max_distance, 3, 3, 3, 3, 3, 3);
    assert_true(!out.vertex_density && !out.face_density);
    end_scene(&s);
}

static void density_by_face(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    takes(s.controls, "forceDensity", painted_as(FLOATS(DENSITY, 5, -1), "uniform"));
    skinslide_controls out = got(s.controls);
    EXPECT_FLOATS(out.face_density, 5, 1);
    assert_null(out.vertex_density);
    end_scene(&s);
}

static void indexed_paint(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    const skinslide_value indices = INTS(WEIGHT ":indices", 1, 1, 0, 0, 1, 0), bad = INTS(WEIGHT ":indices", 1, 1, 0, 0, 1, 2);
    takes(s.controls, "weight", indexed_by(painted_as(FLOATS(WEIGHT, 0.25f, 0.75f), "vertex"), &indices));
    EXPECT_FLOATS(got(s.controls).weight, 0.75f, 0.75f, 0, 0.25f, 0.75f, 0);
    assert_fails(controls_take(s.controls, "weight", indexed_by(painted_as(FLOATS(WEIGHT, 0, 1), "vertex"), &bad), &error),
                 &error, SKINSLIDE_BAD_CONTROL, WEIGHT ":indices[5] is 2, but " WEIGHT " has 2 values");
    end_scene(&s);
}

static void painted_edges(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    assert_ok(patch_takes(s.patch, "edges", INTS("edges", 0, 1, 1, 4), &error), &error);
    takes(s.controls, "edgeForceDensities", FLOATS("factors", 2, 0.5f));
    skinslide_controls out = got(s.controls);
    assert_int_equal(out.edge_count, 2);
    assert_same_bytes(out.edges, ((int32_t[]){0, 1, 1, 4}), 16);
    EXPECT_FLOATS(out.edge_density, 2, 0.5f);
    end_scene(&s);
}

static void envelopes(void **state) {
    (void)state;
    const double doubled = 0.5;
    const uint8_t yes = 1;
    patch_scene s = set_up(NULL);
    takes(s.controls, "envelope", NUMBER("envelope", -2));
    assert_true(got(s.controls).envelope == -2);
    takes(s.controls, "envelope", single_of("envelope", SKINSLIDE_VALUE_DOUBLE, &doubled));
    assert_true(got(s.controls).envelope == 0.5f);
    takes(s.controls, "envelope", single_of("envelope", SKINSLIDE_VALUE_BOOL, &yes));
    assert_true(got(s.controls).envelope == 1);
    takes(s.controls, "envelope", blocked_of("envelope"));
    assert_true(got(s.controls).envelope == 1);
    end_scene(&s);
}

static void a_shot_scales_envelopes(void **state) {
    (void)state;
    skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;
    live.envelope = 0.3;
    patch_scene s = set_up(&live);
    assert_true(got(s.controls).envelope == 0.3f);
    takes(s.controls, "envelope", NUMBER("envelope", 0.1f));
    assert_true(got(s.controls).envelope == (float)((double)0.1f * 0.3));
    end_scene(&s);
}

/* ---- Frames ---- */

/* What a frame does not bring is the base's own memory; what it brings takes no more memory at the next frame. */
static void frames_begin_with_their_base(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    takes(s.controls, "weight", painted_as(FLOATS(WEIGHT, 1, 1, 1, 1, 1, 1), "vertex"));
    takes(s.controls, "maxDistance", NUMBER(FARTHEST, 3));
    takes(s.controls, "envelope", NUMBER("envelope", 0.5f));
    skinslide_controls base = got(s.controls);
    skinslide_stage_controls *frame = NULL;
    assert_ok(skinslide_stage_controls_create(s.patch, s.controls, &frame, &error), &error);
    skinslide_controls out = got(frame);
    assert_ptr_equal(out.weight, base.weight);
    assert_true(out.envelope == 0.5f);
    takes(frame, "weight", painted_as(FLOATS(WEIGHT, 2, 3, 0, 4, 5, 0), "vertex"));
    out = got(frame);
    EXPECT_FLOATS(out.weight, 2, 3, 0, 4, 5, 0);
    assert_ptr_equal(out.max_distance, base.max_distance);
    EXPECT_FLOATS(base.weight, 1, 1, 0, 1, 1, 0);
    const float *memory = out.weight;
    takes(frame, "weight", painted_as(FLOATS(WEIGHT, 9, 9, 9, 9, 9, 9), "vertex"));
    assert_ptr_equal(got(frame).weight, memory);
    takes(frame, "weight", nothing_of(WEIGHT));
    assert_null(got(frame).weight);
    skinslide_stage_controls_destroy(frame);
    end_scene(&s);
}

static void a_base_of_another_patch_is_refused(void **state) {
    (void)state;
    patch_scene a = set_up(NULL), b = set_up(NULL);
    skinslide_stage_controls *frame = NULL;
    assert_int_equal(skinslide_stage_controls_create(b.patch, a.controls, &frame, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_null(frame);
    end_scene(&a), end_scene(&b);
}

/* ---- What is refused ---- */

static void expect(patch_scene *s, const char *name, skinslide_value value, const char *text) {
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    assert_fails(controls_take(s->controls, name, value, &error), &error, SKINSLIDE_BAD_CONTROL, text);
    assert_int_equal(skinslide_stage_controls_get(s->controls, &out, &error), SKINSLIDE_BAD_ARGUMENT);
}

static void bad_paint_is_named(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    skinslide_value good = painted_as(FLOATS(WEIGHT, 1, 1, 1, 1, 1, 1), "vertex"), wide = painted_as(good, "vertex");
    wide.width = 2, wide.type_name = "float2[]";
    expect(&s, "weight", painted_as(INTS(WEIGHT, 1), "vertex"), WEIGHT " is int[]; it must be float[]");
    expect(&s, "weight", wide,
           WEIGHT " is float2[]; it must be float[], or skinSlide:elbow:paintChannel must name the channel that counts");
    expect(&s, "weight", other_of(WEIGHT, "string"), WEIGHT " is string; it must be float[]");
    expect(&s, "weight", painted_as(good, "uniform"),
           WEIGHT " has interpolation uniform; it must be vertex, faceVarying or constant");
    expect(&s, "weight", painted_as(good, "faceVarying"), WEIGHT " has 6 values, but the mesh has 8 face corners");
    expect(&s, "forceDensity", painted_as(good, "sideways"),
           WEIGHT " has interpolation sideways; it must be vertex, faceVarying, uniform or constant");
    expect(&s, "weight", painted_as(blocked_of(WEIGHT), "vertex"), WEIGHT " has no value");
    expect(&s, "weight", painted_as(FLOATS(WEIGHT, 1, 1), "vertex"), WEIGHT " has 2 values, but the mesh has 6 points");
    expect(&s, "forceDensity", painted_as(FLOATS(DENSITY, 1), "uniform"), DENSITY " has 1 values, but the mesh has 2 faces");
    expect(&s, "weight", painted_as(good, NULL), WEIGHT " has interpolation constant but 6 values; is vertex missing?");
    expect(&s, "weight", painted_as(FLOATS(WEIGHT, 1, NAN, 1, 1, 1, 1), "vertex"), WEIGHT "[1] is nan; it must be a number");
    expect(&s, "weight", FLOATS(WEIGHT, INFINITY), WEIGHT "[0] is inf; it must be a number");
    expect(&s, "maxDistance", painted_as(FLOATS(FARTHEST, 1, 1, 1, 1, -1, 1), "vertex"),
           FARTHEST "[4] is -1; it must be 0 or more");
    expect(&s, "maxDistance", FLOATS(FARTHEST, NAN), FARTHEST "[0] is nan; it must be 0 or more");
    expect(&s, "forceDensity", painted_as(FLOATS(DENSITY, 0, 1), "uniform"), DENSITY "[0] is 0; it must be finite and above 0");
    expect(&s, "forceDensity", painted_as(FLOATS(DENSITY, 1, 1, 1, INFINITY, 1, 1), "vertex"),
           DENSITY "[3] is inf; it must be finite and above 0");
    expect(&s, "forceDensity", FLOATS(DENSITY, 0), DENSITY "[0] is 0; it must be finite and above 0");
    end_scene(&s);
}

static void bad_envelopes_are_named(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    expect(&s, "envelope", text_of("envelope", "x"), "envelope is 'x'; it must be a float");
    expect(&s, "envelope", FLOATS("envelope", 1), "envelope is [1]; it must be a float");
    expect(&s, "envelope", FLOATS("envelope", 1, 0.5f, 3, 4, 5), "envelope is [1, 0.5, 3, 4, ...]; it must be a float");
    expect(&s, "envelope", other_of("envelope", "matrix4d"), "envelope is matrix4d; it must be a float");
    expect(&s, "envelope", NUMBER("envelope", NAN), "envelope is nan");
    end_scene(&s);
}

static void bad_edge_densities_are_named(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    assert_ok(patch_takes(s.patch, "edges", INTS("edges", 0, 1, 1, 4), &error), &error);
    expect(&s, "edgeForceDensities", nothing_of("factors"), "factors has 0 values, but skinSlide:elbow:edges has 2 pairs");
    expect(&s, "edgeForceDensities", FLOATS("factors", 1, 1, 1), "factors has 3 values, but skinSlide:elbow:edges has 2 pairs");
    expect(&s, "edgeForceDensities", FLOATS("factors", 1, 0), "factors[1], for edge 1-4, is 0; it must be finite and above 0");
    expect(&s, "edgeForceDensities", INTS("factors", 1, 1), "factors is not an array of float");
    expect(&s, "edgeForceDensities", NUMBER("factors", 1), "factors is not an array of float");
    end_scene(&s);
}

/* A frame that fails leaves the next one as it would be. */
static void what_was_refused_may_be_given_again(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    takes(s.controls, "weight", FLOATS(WEIGHT, 1));
    expect(&s, "weight", FLOATS(WEIGHT, NAN), WEIGHT "[0] is nan; it must be a number");
    takes(s.controls, "weight", FLOATS(WEIGHT, 0.5f));
    assert_true(got(s.controls).weight[5] == 0.5f);
    end_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paint_by_vertex),
        cmocka_unit_test(paint_that_is_constant),
        cmocka_unit_test(density_by_face),
        cmocka_unit_test(indexed_paint),
        cmocka_unit_test(painted_edges),
        cmocka_unit_test(envelopes),
        cmocka_unit_test(a_shot_scales_envelopes),
        cmocka_unit_test(frames_begin_with_their_base),
        cmocka_unit_test(a_base_of_another_patch_is_refused),
        cmocka_unit_test(bad_paint_is_named),
        cmocka_unit_test(bad_envelopes_are_named),
        cmocka_unit_test(bad_edge_densities_are_named),
        cmocka_unit_test(what_was_refused_may_be_given_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
