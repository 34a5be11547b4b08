/* Paint as tools leave it comes to the same as paint as the schema has it: under other names, of other types, as a channel of
 * colours, by face corner. */
#include "records.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
#define WEIGHT  "primvars:skinSlide:elbow:weight"
#define FACES   "primvars:skinSlide:elbow:patch"
#define DENSITY "primvars:skinSlide:elbow:forceDensity"
enum { VERTICES = 6, CORNERS = 8 };

/* 2 x 1 quads: corners 0 1 4 3 and 1 2 5 4. */
static patch_scene set_up(const char *name, const char *channel, bool fold) {
    patch_scene s = {quad_grid(2, 1), NULL, NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    assert_ok(mesh_takes(s.mesh, "foldCase", single_of("fold", SKINSLIDE_VALUE_BOOL, &(uint8_t){fold}), &error), &error);
    assert_ok(skinslide_stage_patch_create(s.mesh, name, NULL, &s.patch, &error), &error);
    assert_ok(patch_takes(s.patch, "paintChannel", text_of("skinSlide:elbow:paintChannel", channel), &error), &error);
    assert_ok(patch_takes(s.patch, "patch", painted_as(INTS(FACES, 1, 1), "uniform"), &error), &error);
    s.controls = scene_controls(s.patch);
    return s;
}

static const float *weight(patch_scene *s, skinslide_value value) {
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    assert_ok(controls_take(s->controls, "weight", value, &error), &error);
    assert_ok(skinslide_stage_controls_get(s->controls, &out, &error), &error);
    return out.weight;
}

static void refuses(patch_scene *s, skinslide_value value, const char *text) {
    assert_fails(controls_take(s->controls, "weight", value, &error), &error, SKINSLIDE_BAD_CONTROL, text);
}

#define EXPECT_FLOATS(actual, ...) assert_same_bytes(actual, ((float[]){__VA_ARGS__}), sizeof((float[]){__VA_ARGS__}))

/* ---- Names ---- */

static int32_t found(const patch_scene *s, const char *input, const char *const *names, int32_t count) {
    skinslide_stage_group group = strcmp(input, "patch") == 0 ? SKINSLIDE_STAGE_PATCH : SKINSLIDE_STAGE_CONTROLS;
    const char *sorted[16];
    for (int32_t i = 0; i < count; i++)
        sorted[i] = names[i];
    skinslide_stage_sort_names(sorted, count);
    int32_t place = skinslide_stage_patch_property(s->patch, input_of(group, NULL, input), sorted, count), own = -1;
    for (int32_t i = 0; i < count && place >= 0; i++)
        own = names[i] == sorted[place] ? i : own;
    return own;
}

static void names_as_tools_leave_them(void **state) {
    (void)state;
    static const char *const names[] = {"primvars:skinSlide_left_elbow_weight",      "primvars:skinSlide_left_elbow_weight_",
                                        "primvars:skinslide_left_elbow_hold",        "skinSlide_left_elbow_maxDistance",
                                        "primvars_skinSlide_left_elbow_maxDistance", "primvars:skinSlide_left_elbow_patch",
                                        "primvars:skinSlide_left_elbow_envelope",    NULL};
    patch_scene s = set_up("left:elbow", "none", false);
    assert_int_equal(found(&s, "weight", names, 8), 0);
    assert_int_equal(found(&s, "patch", names, 8), 5);
    assert_int_equal(found(&s, "hold", names, 8), -1);
    assert_int_equal(found(&s, "maxDistance", names, 8), -1);
    assert_int_equal(found(&s, "envelope", names, 8), -1); /* no paint */
    assert_int_equal(found(&s, "weight", NULL, 0), -1);
    assert_int_equal(skinslide_stage_patch_property(NULL, NULL, names, 8), -1);
    end_scene(&s);
}

/* The schema's own name is the best, then that with underscores, then another case; of two that are as good the first by
 * letters, in whichever order they come. */
static void the_best_name_counts(void **state) {
    (void)state;
    static const char *const names[] = {"primvars:skinslide:elbow:WEIGHT", "primvars:SKINSLIDE_elbow_weight",
                                        "primvars:skinSlide_elbow_weight", "primvars:skinSlide:elbow_weight", WEIGHT};
    patch_scene folds = set_up("elbow", "none", true), keeps = set_up("elbow", "none", false);
    assert_int_equal(found(&folds, "weight", names, 5), 4);
    assert_int_equal(found(&folds, "weight", names, 4), 3);
    assert_int_equal(found(&folds, "weight", names, 3), 2);
    assert_int_equal(found(&folds, "weight", names, 2), 1);
    assert_int_equal(found(&folds, "weight", names, 1), 0);
    assert_int_equal(found(&keeps, "weight", names, 2), -1);
    end_scene(&folds), end_scene(&keeps);
}

/* ---- Types ---- */

static void halves_and_doubles(void **state) {
    (void)state;
    const uint16_t halves[VERTICES] = {0, 0x3800, 0x3C00, 0x3400, 0, 0x3C00}; /* 0, 1/2, 1, 1/4, 0, 1 */
    const double doubles[VERTICES] = {0.1, 0.5, 1, 0.25, 0, 1.0 / 3};
    patch_scene s = set_up("elbow", "none", false);
    EXPECT_FLOATS(weight(&s, painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_HALF, 1, VERTICES, halves), "vertex")), 0, 0.5f, 1,
                  0.25f, 0, 1);
    EXPECT_FLOATS(weight(&s, painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_DOUBLE, 1, VERTICES, doubles), "varying")), 0.1f, 0.5f,
                  1, 0.25f, 0, 1.0f / 3);
    EXPECT_FLOATS(weight(&s, single_of(WEIGHT, SKINSLIDE_VALUE_DOUBLE, doubles)), 0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f);
    end_scene(&s);
}

/* A double may be too large for a float. */
static void doubles_beyond_floats(void **state) {
    (void)state;
    const double large[VERTICES] = {0, 1e300}, small = 1e-300;
    patch_scene s = set_up("elbow", "none", false);
    refuses(&s, painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_DOUBLE, 1, VERTICES, large), "vertex"),
            WEIGHT "[1] is 1e+300; it must be a number");
    assert_fails(controls_take(s.controls, "forceDensity", single_of(DENSITY, SKINSLIDE_VALUE_DOUBLE, &small), &error), &error,
                 SKINSLIDE_BAD_CONTROL, DENSITY "[0] is 1e-300; it must be finite and above 0");
    end_scene(&s);
}

static skinslide_value colours(int32_t width, const char *type_name, int64_t count, const float *numbers) {
    skinslide_value value = painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_FLOAT, width, count, numbers), "vertex");
    value.type_name = type_name;
    return value;
}

static void a_channel_of_colours(void **state) {
    (void)state;
    const float numbers[2 * VERTICES] = {0, 0.1f, 1, 0.2f, 2, 0.3f, 3, 0.4f, 4, 0.5f, 5, 0.6f};
    const skinslide_value indices = INTS(WEIGHT ":indices", 1, 0, 0, 0, 0, 2);
    patch_scene red = set_up("elbow", "r", false), green = set_up("elbow", "g", false), blue = set_up("elbow", "b", false),
                none = set_up("elbow", "none", false);
    const skinslide_value pairs = colours(2, "float2[]", VERTICES, numbers);
    EXPECT_FLOATS(weight(&red, pairs), 0, 1, 2, 3, 4, 5);
    EXPECT_FLOATS(weight(&green, pairs), 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f);
    EXPECT_FLOATS(weight(&green, indexed_by(colours(2, "float2[]", 3, numbers), &indices)), 0.2f, 0.1f, 0.1f, 0.1f, 0.1f, 0.3f);
    EXPECT_FLOATS(weight(&green, painted_as(colours(3, "color3f[]", 1, numbers), "constant")), 0.1f, 0.1f, 0.1f, 0.1f, 0.1f,
                  0.1f);
    refuses(&blue, pairs, WEIGHT " is float2[], which has no channel b; skinSlide:elbow:paintChannel names it");
    refuses(&none, pairs,
            WEIGHT " is float2[]; it must be float[], or skinSlide:elbow:paintChannel must name the channel that counts");
    end_scene(&red), end_scene(&green), end_scene(&blue), end_scene(&none);
}

/* ---- Face corners ---- */

static skinslide_value corners(float a, float b) {
    static float numbers[CORNERS];
    for (int32_t i = 0; i < CORNERS; i++)
        numbers[i] = i < CORNERS / 2 ? a : b;
    return painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_FLOAT, 1, CORNERS, numbers), "faceVarying");
}

/* Points 1 and 4 have a corner of each face. */
static void corners_are_averaged(void **state) {
    (void)state;
    const float numbers[2] = {0.25f, 0.75f};
    const skinslide_value indices = INTS(WEIGHT ":indices", 0, 0, 0, 0, 1, 1, 1, 1);
    patch_scene s = set_up("elbow", "none", false);
    EXPECT_FLOATS(weight(&s, corners(0.25f, 0.75f)), 0.25f, 0.5f, 0.75f, 0.25f, 0.5f, 0.75f);
    skinslide_value indexed = painted_as(array_of(WEIGHT, SKINSLIDE_VALUE_FLOAT, 1, 2, numbers), "faceVarying");
    EXPECT_FLOATS(weight(&s, indexed_by(indexed, &indices)), 0.25f, 0.5f, 0.75f, 0.25f, 0.5f, 0.75f);
    refuses(&s, corners(1, NAN), WEIGHT "[1] is nan; it must be a number");
    end_scene(&s);
}

/* A point is chosen if one of its corners is. */
static void faces_by_corner(void **state) {
    (void)state;
    patch_scene s = set_up("elbow", "none", false);
    skinslide_value value = corners(0, 1);
    int32_t count = 0;
    value.name = FACES;
    assert_ok(patch_takes(s.patch, "patch", value, &error), &error);
    const int32_t *faces = skinslide_stage_patch_faces(s.patch, &count);
    assert_int_equal(count, 1);
    assert_int_equal(faces[0], 1);
    end_scene(&s);
}

/* ---- What is said ---- */

static void expect_said(const patch_scene *s, const char *input, skinslide_value value, const char *text) {
    char said[512] = "";
    skinslide_stage_group group = strcmp(input, "patch") == 0 ? SKINSLIDE_STAGE_PATCH : SKINSLIDE_STAGE_CONTROLS;
    assert_int_equal(skinslide_stage_patch_describe(s->patch, input_of(group, NULL, input), &value, said), *text != 0);
    assert_string_equal(said, text);
}

static void what_was_taken_is_said(void **state) {
    (void)state;
    const float numbers[3 * CORNERS] = {0};
    skinslide_value wide = colours(3, "color3f[]", CORNERS, numbers);
    patch_scene s = set_up("elbow", "g", false);
    expect_said(&s, "weight", FLOATS(WEIGHT, 1), "");
    expect_said(&s, "weight", nothing_of("primvars:skinSlide_elbow_weight"), "");
    expect_said(&s, "patch", painted_as(INTS(FACES, 1, 1), "uniform"), "");
    expect_said(&s, "envelope", NUMBER("skinSlide:elbow:envelope", 1), "");
    expect_said(&s, "weight", FLOATS("primvars:skinSlide_elbow_weight", 1),
                "weight comes from primvars:skinSlide_elbow_weight, float[]");
    expect_said(&s, "weight", painted_as(wide, "faceVarying"),
                "weight comes from " WEIGHT ", color3f[], channel g, the mean over the face corners at each point");
    end_scene(&s);
}

/* So many names that looking through all of them for each input would not end. */
static void names_without_number(void **state) {
    (void)state;
    enum { MANY = 100000 };
    char(*texts)[40] = calloc(MANY, sizeof *texts);
    const char **names = calloc(MANY, sizeof *names);
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    for (int32_t i = 0; i < MANY; i++) {
        snprintf(texts[i], sizeof *texts, "primvars:skinSlide_p%d_weight", i);
        names[i] = texts[i];
    }
    skinslide_stage_sort_names(names, MANY);
    for (int32_t i = 0; i < MANY; i++) {
        skinslide_stage_patch *patch = NULL;
        char name[16];
        snprintf(name, sizeof name, "p%d", i);
        assert_ok(skinslide_stage_patch_create(mesh, name, NULL, &patch, &error), &error);
        int32_t place = skinslide_stage_patch_property(patch, input_of(SKINSLIDE_STAGE_CONTROLS, NULL, "weight"), names, MANY);
        assert_true(place >= 0 && names[place] == texts[i]);
        skinslide_stage_patch_destroy(patch);
    }
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
    free(texts), free(names);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_without_number),   cmocka_unit_test(names_as_tools_leave_them),
        cmocka_unit_test(the_best_name_counts),   cmocka_unit_test(halves_and_doubles),
        cmocka_unit_test(doubles_beyond_floats),  cmocka_unit_test(a_channel_of_colours),
        cmocka_unit_test(corners_are_averaged),   cmocka_unit_test(faces_by_corner),
        cmocka_unit_test(what_was_taken_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
