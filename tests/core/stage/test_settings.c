/* Settings of a patch: the schema's fallbacks, what was authored, what a shot sets in its place, and what is refused. */
#include "records.h"

#include <math.h>
#include <string.h>

static skinslide_error error;

static patch_scene set_up(const skinslide_stage_live *live) {
    static const uint8_t chosen[4] = {1, 1, 1, 1};
    patch_scene s = {quad_grid(2, 2), NULL, NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    assert_ok(skinslide_stage_patch_create(s.mesh, "elbow", live, &s.patch, &error), &error);
    skinslide_value faces = painted_as(array_of("patch", SKINSLIDE_VALUE_BOOL, 1, 4, chosen), "uniform");
    assert_ok(patch_takes(s.patch, "patch", faces, &error), &error);
    s.controls = scene_controls(s.patch);
    return s;
}

static skinslide_patch_setup setup_of_scene(patch_scene *s) {
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    assert_ok(skinslide_stage_patch_get(s->patch, s->controls, &setup, &error), &error);
    return setup;
}

/* The same whether nothing was given, or each input with no value. */
static void fallbacks_are_those_of_the_schema(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    for (int32_t given = 0; given < 2; given++) {
        skinslide_patch_setup setup = setup_of_scene(&s);
        assert_string_equal(setup.name, "elbow");
        assert_int_equal(setup.face_count, 4);
        assert_null(setup.corners);
        assert_int_equal(setup.boundary, SKINSLIDE_BOUNDARY_AUTO);
        assert_int_equal(setup.holes, SKINSLIDE_HOLES_PINNED);
        assert_int_equal(setup.rule, SKINSLIDE_RULE_UNIT);
        assert_int_equal(setup.interpolation, SKINSLIDE_INTERPOLATION_AUTO);
        const skinslide_controls none = SKINSLIDE_CONTROLS_DEFAULT;
        assert_true(setup.controls->envelope == none.envelope);
        assert_true(!setup.controls->weight && !setup.controls->vertex_density && !setup.controls->face_density);
        assert_true(!setup.controls->max_distance && !setup.controls->edges && !setup.controls->edge_density);
        const skinslide_stage_input *input = NULL;
        while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_PATCH, input)) != NULL)
            if (strcmp(input->name, "patch") != 0)
                assert_ok(skinslide_stage_patch_take(s.patch, input, NULL, &error), &error);
        while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_CONTROLS, input)) != NULL)
            assert_ok(skinslide_stage_controls_take(s.controls, input, NULL, &error), &error);
    }
    end_scene(&s);
}

static void what_was_authored_comes_back(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    assert_ok(patch_takes(s.patch, "boundary", text_of("boundary", "circle"), &error), &error);
    assert_ok(patch_takes(s.patch, "holes", text_of("holes", "free"), &error), &error);
    assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "relaxed"), &error), &error);
    assert_ok(patch_takes(s.patch, "interpolation", text_of("interpolation", "meanValue"), &error), &error);
    assert_ok(patch_takes(s.patch, "corners", INTS("corners", 0, 2, 8, 6), &error), &error);
    skinslide_patch_setup setup = setup_of_scene(&s);
    assert_int_equal(setup.boundary, SKINSLIDE_BOUNDARY_CIRCLE);
    assert_int_equal(setup.holes, SKINSLIDE_HOLES_FREE);
    assert_int_equal(setup.rule, SKINSLIDE_RULE_RELAXED);
    assert_int_equal(setup.interpolation, SKINSLIDE_INTERPOLATION_MEAN_VALUE);
    assert_same_bytes(setup.corners, ((int32_t[]){0, 2, 8, 6}), 16);
    end_scene(&s);
}

static void only_some_interpolations_need_subdivision(void **state) {
    (void)state;
    static const char *const tokens[] = {"auto", "linear", "meanValue", "limit"};
    static const int32_t needs[] = {1, 0, 0, 1};
    for (int32_t own = 0; own < 4; own++)
        for (int32_t over = -1; over < 4; over++) {
            skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;
            live.interpolation = over;
            patch_scene s = set_up(&live);
            assert_ok(patch_takes(s.patch, "interpolation", text_of("interpolation", tokens[own]), &error), &error);
            assert_int_equal(skinslide_stage_patch_needs_subdivision(s.patch), needs[over < 0 ? own : over]);
            assert_int_equal(setup_of_scene(&s).interpolation, over < 0 ? own : over);
            end_scene(&s);
        }
}

static void expect(const char *name, skinslide_value value, const char *text) {
    patch_scene s = set_up(NULL);
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    assert_fails(patch_takes(s.patch, name, value, &error), &error, SKINSLIDE_BAD_CONTROL, text);
    assert_int_equal(skinslide_stage_patch_get(s.patch, s.controls, &setup, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_ok(patch_takes(s.patch, name, nothing_of(name), &error), &error);
    assert_ok(skinslide_stage_patch_get(s.patch, s.controls, &setup, &error), &error);
    end_scene(&s);
}

static void bad_tokens_are_named(void **state) {
    (void)state;
    expect("boundary", text_of("skinSlide:elbow:boundary", "oval"),
           "skinSlide:elbow:boundary is 'oval'; it must be one of auto, square, circle");
    expect("holes", text_of("holes", ""), "holes is ''; it must be one of pinned, free, freeAll");
    expect("forceDensityRule", text_of("rule", "slow"), "rule is 'slow'; it must be one of unit, fast, relaxed, even");
    expect("interpolation", text_of("interpolation", "Linear"),
           "interpolation is 'Linear'; it must be one of auto, linear, meanValue, limit");
    expect("boundary", text_of("boundary", "z\n\x1b[2J\xc3\xa9"),
           "boundary is 'z\\n\\x1b[2J\xc3\xa9'; it must be one of auto, square, circle");
    expect("boundary", NUMBER("boundary", 1), "boundary is '1'; it must be one of auto, square, circle");
    expect("boundary", other_of("boundary", "token[]"), "boundary is token[]; it must be one of auto, square, circle");
    expect("mapSt", NUMBER("mapSt", 3), "mapSt is 3; it must be a token");
    expect("weightMapChannel", other_of("weightMapChannel", "string[]"), "weightMapChannel is string[]; it must be a token");
}

static void bad_numbers_are_named(void **state) {
    (void)state;
    expect("grow", NUMBER("grow", -1), "grow is -1; it must be 0 or more");
    expect("grow", NUMBER("grow", NAN), "grow is nan; it must be 0 or more");
    expect("grow", text_of("grow", "far"), "grow is 'far'; it must be a float");
}

static void expect_unread(const patch_scene *s, const char *first, const char *second) {
    const skinslide_stage_input *input = NULL;
    const char *names[] = {first, second};
    for (int i = 0; i < 2 && names[i]; i++) {
        input = skinslide_stage_next_unread(s->patch, s->controls, input);
        assert_non_null(input);
        assert_string_equal(input->name, names[i]);
    }
    assert_null(skinslide_stage_next_unread(s->patch, s->controls, input));
}

static void what_a_rule_does_not_read_is_known(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    expect_unread(&s, NULL, NULL);
    assert_ok(patch_takes(s.patch, "boundary", text_of("boundary", "square"), &error), &error);
    assert_ok(patch_takes(s.patch, "corners", INTS("corners", 0, 2, 8, 6), &error), &error);
    expect_unread(&s, NULL, NULL);
    assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "even"), &error), &error);
    expect_unread(&s, "boundary", "corners");
    assert_ok(patch_takes(s.patch, "boundary", text_of("boundary", "auto"), &error), &error);
    assert_ok(patch_takes(s.patch, "corners", nothing_of("corners"), &error), &error);
    assert_ok(patch_takes(s.patch, "grow", NUMBER("grow", 1), &error), &error);
    assert_ok(controls_take(s.controls, "hold", painted_as(FLOATS("hold", 2), "constant"), &error), &error);
    expect_unread(&s, NULL, NULL);
    assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "unit"), &error), &error);
    expect_unread(&s, "grow", "hold");
    end_scene(&s);
}

static void bad_corners_and_edges_are_named(void **state) {
    (void)state;
    expect("corners", FLOATS("corners", 1), "corners is not an array of int");
    expect("corners", NUMBER("corners", 1), "corners is not an array of int");
    expect("corners", INTS("corners", 0, 2, 8), "corners has 3 values; it must have 4");
    expect("corners", INTS("corners", 0, 2, 8, 9), "corners[3] is 9, but the mesh has 9 points");
    expect("corners", INTS("corners", -1, 2, 8, 9), "corners[0] is -1, but the mesh has 9 points");
    expect("corners", INTS("corners", 0, 2, 8, 2), "corners has point 2 more than once");
    expect("edges", INTS("edges", 0, 1, 2), "edges has 3 values; it must hold pairs of point indices");
    expect("edges", FLOATS("edges", 0, 1), "edges is not an array of int");
}

static void expect_later(patch_scene *s, const char *name, skinslide_value later, const char *text) {
    const skinslide_stage_input *input = input_of(SKINSLIDE_STAGE_PATCH, NULL, name);
    skinslide_status status = skinslide_stage_patch_check(s->patch, input, &later, 1002, &error);
    if (text)
        assert_fails(status, &error, SKINSLIDE_BAD_CONTROL, text);
    else
        assert_ok(status, &error);
}

static void indices_must_stay_the_same(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    assert_ok(patch_takes(s.patch, "corners", INTS("corners", 0, 2, 8, 6), &error), &error);
    expect_later(&s, "corners", INTS("corners", 0, 2, 8, 6), NULL);
    expect_later(&s, "corners", INTS("corners", 0, 2, 6, 8), "corners changes at frame 1002; it must stay the same over time");
    expect_later(&s, "edges", nothing_of("edges"), NULL);
    expect_later(&s, "edges", INTS("edges", 0, 1), "edges changes at frame 1002; it must stay the same over time");
    end_scene(&s);
}

/* Of choices and words the first sample counts, whatever comes after it. */
static void only_tokens_may_change(void **state) {
    (void)state;
    const skinslide_stage_input *input = NULL;
    while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_PATCH, input)) != NULL) {
        bool is_choice = strcmp(input->type_name, "token") == 0;
        assert_int_equal(input->when, is_choice ? SKINSLIDE_STAGE_FIRST : SKINSLIDE_STAGE_STILL);
    }
}

static void a_patch_without_faces_gives_nothing(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_stage_patch *patch = NULL;
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    assert_ok(skinslide_stage_patch_create(mesh, "elbow", NULL, &patch, &error), &error);
    skinslide_stage_controls *controls = scene_controls(patch);
    assert_fails(skinslide_stage_patch_get(patch, controls, &setup, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the faces of the patch were not given");
    skinslide_stage_controls_destroy(controls);
    skinslide_stage_patch_destroy(patch);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

static void inputs_of_another_group_are_refused(void **state) {
    (void)state;
    patch_scene s = set_up(NULL);
    const skinslide_stage_input *envelope = input_of(SKINSLIDE_STAGE_CONTROLS, NULL, "envelope");
    const skinslide_stage_input *holes = input_of(SKINSLIDE_STAGE_PATCH, NULL, "holes");
    assert_int_equal(skinslide_stage_patch_take(s.patch, envelope, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_controls_take(s.controls, holes, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_mesh_take(s.mesh, holes, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_patch_take(s.patch, NULL, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    end_scene(&s);
}

/* ---- What a shot sets ---- */

static skinslide_status live_takes(skinslide_stage_live *live, const char *name, skinslide_value value) {
    return skinslide_stage_live_take(live, input_of(SKINSLIDE_STAGE_LIVE, NULL, name), &value, &error);
}

static void what_is_live_is_taken(void **state) {
    (void)state;
    skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;
    assert_ok(live_takes(&live, "envelope", nothing_of("skinSlide:live:envelope")), &error);
    assert_ok(live_takes(&live, "interpolation", nothing_of("skinSlide:live:interpolation")), &error);
    assert_true(live.envelope == 1 && live.interpolation == -1 && live.lookup == SKINSLIDE_LOOKUP_AUTO);
    assert_ok(live_takes(&live, "envelope", NUMBER("skinSlide:live:envelope", 0.25f)), &error);
    assert_ok(live_takes(&live, "interpolation", text_of("skinSlide:live:interpolation", "linear")), &error);
    assert_ok(live_takes(&live, "lookup", text_of("skinSlide:live:lookup", "exact")), &error);
    assert_true(live.envelope == 0.25 && live.interpolation == SKINSLIDE_INTERPOLATION_LINEAR);
    assert_int_equal(live.lookup, SKINSLIDE_LOOKUP_EXACT);
}

static void what_cannot_be_live_is_named_and_left(void **state) {
    (void)state;
    skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;
    assert_fails(live_takes(&live, "envelope", text_of("skinSlide:live:envelope", "half")), &error, SKINSLIDE_BAD_CONTROL,
                 "skinSlide:live:envelope is 'half'; it must be a float");
    assert_fails(live_takes(&live, "envelope", other_of("skinSlide:live:envelope", "float[]")), &error, SKINSLIDE_BAD_CONTROL,
                 "skinSlide:live:envelope is float[]; it must be a float");
    assert_fails(live_takes(&live, "envelope", NUMBER("skinSlide:live:envelope", NAN)), &error, SKINSLIDE_BAD_CONTROL,
                 "skinSlide:live:envelope is nan");
    assert_fails(live_takes(&live, "interpolation", text_of("skinSlide:live:interpolation", "cubic")), &error,
                 SKINSLIDE_BAD_CONTROL,
                 "skinSlide:live:interpolation is 'cubic'; it must be one of auto, linear, meanValue, limit");
    assert_fails(live_takes(&live, "lookup", NUMBER("skinSlide:live:lookup", 1)), &error, SKINSLIDE_BAD_CONTROL,
                 "skinSlide:live:lookup is '1'; it must be one of auto, egl, exact");
    assert_true(live.envelope == 1 && live.interpolation == -1 && live.lookup == SKINSLIDE_LOOKUP_AUTO);
    live.size = 0;
    assert_int_equal(live_takes(&live, "lookup", text_of("lookup", "egl")), SKINSLIDE_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fallbacks_are_those_of_the_schema),
        cmocka_unit_test(what_was_authored_comes_back),
        cmocka_unit_test(only_some_interpolations_need_subdivision),
        cmocka_unit_test(bad_tokens_are_named),
        cmocka_unit_test(bad_numbers_are_named),
        cmocka_unit_test(what_a_rule_does_not_read_is_known),
        cmocka_unit_test(bad_corners_and_edges_are_named),
        cmocka_unit_test(indices_must_stay_the_same),
        cmocka_unit_test(only_tokens_may_change),
        cmocka_unit_test(a_patch_without_faces_gives_nothing),
        cmocka_unit_test(inputs_of_another_group_are_refused),
        cmocka_unit_test(what_is_live_is_taken),
        cmocka_unit_test(what_cannot_be_live_is_named_and_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
