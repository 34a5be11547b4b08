/* The table of all that is read: every input once, each choice in the order of the core's enum. */
#include "records.h"

#include <string.h>

static const skinslide_stage_group groups[] = {SKINSLIDE_STAGE_MESH,     SKINSLIDE_STAGE_SUBDIVISION, SKINSLIDE_STAGE_PATCH,
                                               SKINSLIDE_STAGE_CONTROLS, SKINSLIDE_STAGE_DERIVED,     SKINSLIDE_STAGE_LIVE};
enum { GROUPS = 6 };

static void each_input_is_there_once(void **state) {
    (void)state;
    for (int32_t g = 0; g < GROUPS; g++) {
        const skinslide_stage_input *a = NULL;
        int32_t count = 0;
        while ((a = skinslide_stage_next_input(groups[g], a)) != NULL) {
            assert_int_equal(a->group, groups[g]);
            assert_true(*a->name && *a->type_name);
            assert_int_equal(a->is_primvar, strncmp(a->prefix, "primvars:", 9) == 0);
            assert_int_equal(a->tokens != NULL, a->tokens && a->tokens[0] && a->tokens[1]);
            const skinslide_stage_input *b = a;
            while ((b = skinslide_stage_next_input(groups[g], b)) != NULL)
                assert_true(strcmp(a->name, b->name) != 0 || strcmp(a->prefix, b->prefix) != 0 || a->when != b->when);
            count++;
        }
        assert_true(count > 0);
    }
}

static void what_is_of_no_group_ends_a_walk(void **state) {
    (void)state;
    assert_null(skinslide_stage_next_input((skinslide_stage_group)99, NULL));
    assert_null(skinslide_stage_next_input((skinslide_stage_group)-1, NULL));
    const skinslide_stage_input *of_mesh = skinslide_stage_next_input(SKINSLIDE_STAGE_MESH, NULL), copy = *of_mesh;
    assert_null(skinslide_stage_next_input(SKINSLIDE_STAGE_PATCH, of_mesh));
    assert_null(skinslide_stage_next_input(SKINSLIDE_STAGE_MESH, &copy));
}

static void expect_token(skinslide_stage_group group, const char *name, int32_t value, const char *token) {
    assert_string_equal(input_of(group, NULL, name)->tokens[value], token);
}

static void tokens_are_in_the_order_of_enums(void **state) {
    (void)state;
    const skinslide_stage_group patch = SKINSLIDE_STAGE_PATCH, surface = SKINSLIDE_STAGE_SUBDIVISION;
    expect_token(patch, "boundary", SKINSLIDE_BOUNDARY_AUTO, "auto");
    expect_token(patch, "boundary", SKINSLIDE_BOUNDARY_SQUARE, "square");
    expect_token(patch, "boundary", SKINSLIDE_BOUNDARY_CIRCLE, "circle");
    expect_token(patch, "holes", SKINSLIDE_HOLES_PINNED, "pinned");
    expect_token(patch, "holes", SKINSLIDE_HOLES_FREE, "free");
    expect_token(patch, "holes", SKINSLIDE_HOLES_FREE_ALL, "freeAll");
    expect_token(patch, "forceDensityRule", SKINSLIDE_RULE_UNIT, "unit");
    expect_token(patch, "forceDensityRule", SKINSLIDE_RULE_FAST, "fast");
    expect_token(patch, "forceDensityRule", SKINSLIDE_RULE_RELAXED, "relaxed");
    expect_token(patch, "forceDensityRule", SKINSLIDE_RULE_EVEN, "even");
    const skinslide_stage_group both[] = {patch, SKINSLIDE_STAGE_LIVE};
    for (int32_t i = 0; i < 2; i++) {
        expect_token(both[i], "interpolation", SKINSLIDE_INTERPOLATION_AUTO, "auto");
        expect_token(both[i], "interpolation", SKINSLIDE_INTERPOLATION_LINEAR, "linear");
        expect_token(both[i], "interpolation", SKINSLIDE_INTERPOLATION_MEAN_VALUE, "meanValue");
        expect_token(both[i], "interpolation", SKINSLIDE_INTERPOLATION_LIMIT, "limit");
    }
    expect_token(SKINSLIDE_STAGE_LIVE, "lookup", SKINSLIDE_LOOKUP_AUTO, "auto");
    expect_token(SKINSLIDE_STAGE_LIVE, "lookup", SKINSLIDE_LOOKUP_EGL, "egl");
    expect_token(SKINSLIDE_STAGE_LIVE, "lookup", SKINSLIDE_LOOKUP_EXACT, "exact");
    expect_token(surface, "subdivisionScheme", SKINSLIDE_SCHEME_NONE, "none");
    expect_token(surface, "subdivisionScheme", SKINSLIDE_SCHEME_CATMULL_CLARK, "catmullClark");
    expect_token(surface, "subdivisionScheme", SKINSLIDE_SCHEME_LOOP, "loop");
    expect_token(surface, "subdivisionScheme", SKINSLIDE_SCHEME_BILINEAR, "bilinear");
    expect_token(surface, "interpolateBoundary", SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER, "edgeAndCorner");
    expect_token(surface, "interpolateBoundary", SKINSLIDE_BOUNDARY_RULE_EDGE_ONLY, "edgeOnly");
    expect_token(surface, "interpolateBoundary", SKINSLIDE_BOUNDARY_RULE_NONE, "none");
    expect_token(surface, "triangleSubdivisionRule", SKINSLIDE_TRIANGLE_RULE_CATMULL_CLARK, "catmullClark");
    expect_token(surface, "triangleSubdivisionRule", SKINSLIDE_TRIANGLE_RULE_SMOOTH, "smooth");
}

static void names_that_a_patch_may_have(void **state) {
    (void)state;
    static const char *const good[] = {"elbow_L", "left:elbow", "lively", "rest", "restPointsOfMine"};
    static const char *const bad[] = {"", "live", "live:elbow", "cached", "cached:points", "restPoints"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_true(skinslide_stage_can_name_patch(good[i]));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(skinslide_stage_can_name_patch(bad[i]));
    assert_false(skinslide_stage_can_name_patch(NULL));
    assert_string_equal(skinslide_stage_schema(), "SkinSlideAPI");
}

static skinslide_error error;

static void refused(const skinslide_stage_input *input, skinslide_value value, skinslide_status status, const char *message) {
    assert_fails(skinslide_stage_check_value(input, &value, &error), &error, status, message);
}

static void accepted(const skinslide_stage_input *input, skinslide_value value) {
    assert_ok(skinslide_stage_check_value(input, &value, &error), &error);
}

static void what_may_be_authored_whatever_the_mesh(void **state) {
    (void)state;
    const skinslide_stage_input *holes = input_of(SKINSLIDE_STAGE_PATCH, NULL, "holes"),
                                *lookup = input_of(SKINSLIDE_STAGE_LIVE, NULL, "lookup"),
                                *corners = input_of(SKINSLIDE_STAGE_PATCH, NULL, "corners"),
                                *edges = input_of(SKINSLIDE_STAGE_PATCH, NULL, "edges");
    static const int32_t points[4] = {3, 0, 7, INT32_MAX - 1}, below[4] = {3, 0, -1, 7}, twice[4] = {3, 0, 3, 7};
    accepted(holes, text_of("holes", "free"));
    accepted(lookup, text_of("lookup", "exact"));
    accepted(corners, array_of("corners", SKINSLIDE_VALUE_INT32, 1, 4, points));
    accepted(edges, array_of("edges", SKINSLIDE_VALUE_INT32, 1, 4, points));
    accepted(input_of(SKINSLIDE_STAGE_LIVE, NULL, "envelope"), text_of("envelope", "of another kind"));
    refused(holes, text_of("holes", "open"), SKINSLIDE_BAD_CONTROL, "holes is 'open'; it must be one of pinned, free, freeAll");
    refused(lookup, text_of("lookup", "open"), SKINSLIDE_BAD_CONTROL, "lookup is 'open'; it must be one of auto, egl, exact");
    refused(corners, array_of("corners", SKINSLIDE_VALUE_INT32, 1, 3, points), SKINSLIDE_BAD_CONTROL,
            "corners has 3 values; it must have 4");
    refused(corners, array_of("corners", SKINSLIDE_VALUE_INT32, 1, 4, below), SKINSLIDE_BAD_CONTROL,
            "corners[2] is -1; points are numbered from 0");
    refused(corners, array_of("corners", SKINSLIDE_VALUE_INT32, 1, 4, twice), SKINSLIDE_BAD_CONTROL,
            "corners has point 3 more than once");
    refused(edges, array_of("edges", SKINSLIDE_VALUE_INT32, 1, 4, below), SKINSLIDE_BAD_CONTROL,
            "edges[2] is -1; points are numbered from 0");
    refused(edges, array_of("edges", SKINSLIDE_VALUE_INT32, 1, 3, points), SKINSLIDE_BAD_CONTROL,
            "edges has 3 values; it must hold pairs of point indices");
    refused(input_of(SKINSLIDE_STAGE_MESH, NULL, "points"), text_of("points", "x"), SKINSLIDE_BAD_ARGUMENT,
            "no input of a patch, or of what is live");
    refused(NULL, text_of("points", "x"), SKINSLIDE_BAD_ARGUMENT, "no input of a patch, or of what is live");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_may_be_authored_whatever_the_mesh),
        cmocka_unit_test(each_input_is_there_once),
        cmocka_unit_test(what_is_of_no_group_ends_a_walk),
        cmocka_unit_test(tokens_are_in_the_order_of_enums),
        cmocka_unit_test(names_that_a_patch_may_have),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
