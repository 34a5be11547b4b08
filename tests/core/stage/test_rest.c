/* Rest points: the first candidate that is authored counts, good or bad. */
#include "records.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static skinslide_error error;
static const char *const candidates[] = {"restPoints", "rest", "pref", "Pref", "__Pref"};

/* A mesh of one triangle, whose rest points were not taken. */
static skinslide_stage_mesh *triangle(void) {
    static const float points[9];
    skinslide_stage_mesh *mesh = NULL;
    assert_ok(skinslide_stage_mesh_create(&mesh, &error), &error);
    assert_ok(mesh_takes(mesh, "points", array_of("points", SKINSLIDE_VALUE_FLOAT, 3, 3, points), &error), &error);
    assert_ok(mesh_takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3), &error), &error);
    assert_ok(mesh_takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2), &error), &error);
    return mesh;
}

/* Nine numbers from one on. */
static skinslide_value rest_of(const char *name, float first) {
    static float numbers[8][9];
    static int32_t used;
    float *own = numbers[used++ % 8];
    for (int i = 0; i < 9; i++)
        own[i] = first + (float)i;
    return painted_as(array_of(name, SKINSLIDE_VALUE_FLOAT, 3, 3, own), "vertex");
}

static skinslide_status take_default(skinslide_stage_mesh *mesh, skinslide_value value) {
    const skinslide_stage_input *input = NULL, *last = NULL;
    while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_MESH, input)) != NULL)
        if (strcmp(input->name, "points") == 0)
            last = input;
    assert_int_equal(last->when, SKINSLIDE_STAGE_DEFAULT_TIME);
    return skinslide_stage_mesh_take(mesh, last, &value, &error);
}

/* Each candidate alone, before the default of points. */
static void each_candidate_counts(void **state) {
    (void)state;
    static const char *const names[] = {"skinSlide:restPoints", "primvars:rest", "primvars:pref", "primvars:Pref",
                                        "primvars:__Pref"};
    for (int32_t own = 0; own <= 5; own++) {
        skinslide_stage_mesh *mesh = triangle();
        skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
        for (int32_t i = 0; i < 5; i++)
            assert_ok(mesh_takes(mesh, candidates[i], i >= own ? rest_of(names[i], (float)i) : nothing_of(names[i]), &error),
                      &error);
        assert_ok(take_default(mesh, rest_of("points", 5)), &error);
        assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
        assert_true(out.rest_points[0] == (float)own && out.rest_points[8] == (float)own + 8);
        assert_string_equal(skinslide_stage_mesh_rest_source(mesh), own < 5 ? names[own] : "points (default)");
        skinslide_stage_mesh_destroy(mesh);
    }
}

/* Which points faces have is not known then. */
static void without_faces_no_point_is_warned_of(void **state) {
    (void)state;
    const float points[6] = {0, 0, 0, NAN, 0, 0};
    skinslide_stage_mesh *mesh = NULL;
    assert_ok(skinslide_stage_mesh_create(&mesh, &error), &error);
    assert_ok(mesh_takes(mesh, "points", array_of("points", SKINSLIDE_VALUE_FLOAT, 3, 2, points), &error), &error);
    skinslide_value rest = painted_as(array_of("primvars:rest", SKINSLIDE_VALUE_FLOAT, 3, 2, points), "vertex");
    assert_ok(mesh_takes(mesh, "rest", rest, &error), &error);
    assert_null(skinslide_stage_mesh_rest_warning(mesh));
    skinslide_stage_mesh_destroy(mesh);
}

/* The mesh has the three points of a triangle, and a fourth. */
static void points_of_no_face_may_be_anything(void **state) {
    (void)state;
    static const float four[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5};
    for (int32_t v = 0; v < 4; v++) {
        skinslide_stage_mesh *mesh = NULL;
        float points[12];
        char says[128];
        memcpy(points, four, sizeof points);
        assert_ok(skinslide_stage_mesh_create(&mesh, &error), &error);
        assert_ok(mesh_takes(mesh, "points", array_of("points", SKINSLIDE_VALUE_FLOAT, 3, 4, four), &error), &error);
        assert_ok(mesh_takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3), &error), &error);
        assert_ok(mesh_takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2), &error), &error);
        points[3 * v] = NAN;
        skinslide_value rest = painted_as(array_of("primvars:rest", SKINSLIDE_VALUE_FLOAT, 3, 4, points), "vertex");
        snprintf(says, sizeof says, "rest points: primvars:rest[%d] is (nan, %g, %g)%s", v, (double)four[3 * v + 1],
                 (double)four[3 * v + 2], v < 3 ? "" : ", which counts for nothing, since no face has it");
        skinslide_status status = mesh_takes(mesh, "rest", rest, &error);
        if (v < 3) {
            assert_fails(status, &error, SKINSLIDE_BAD_POINTS, says);
            assert_null(skinslide_stage_mesh_rest_warning(mesh));
        } else {
            assert_ok(status, &error);
            assert_string_equal(skinslide_stage_mesh_rest_warning(mesh), says);
            assert_ok(skinslide_stage_mesh_check(mesh, input_of(SKINSLIDE_STAGE_MESH, NULL, "rest"), &rest, 1002, &error),
                      &error);
        }
        skinslide_stage_mesh_destroy(mesh);
    }
}

static void a_bad_candidate_is_not_passed_over(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = triangle();
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    skinslide_value uniform = painted_as(rest_of("primvars:rest", 0), "uniform");
    assert_ok(mesh_takes(mesh, "restPoints", nothing_of("skinSlide:restPoints"), &error), &error);
    assert_fails(mesh_takes(mesh, "rest", uniform, &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: primvars:rest has interpolation uniform; it must be vertex");
    assert_ok(mesh_takes(mesh, "Pref", rest_of("primvars:Pref", 0), &error), &error);
    assert_ok(take_default(mesh, rest_of("points", 0)), &error);
    assert_fails(skinslide_stage_mesh_get(mesh, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT, "primvars:rest was refused");
    assert_string_equal(skinslide_stage_mesh_rest_source(mesh), "");
    assert_ok(mesh_takes(mesh, "rest", painted_as(uniform, "varying"), &error), &error);
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    skinslide_stage_mesh_destroy(mesh);
}

static void bad_rest_points_are_named(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = triangle();
    const double large[9] = {0, 0, 0, 1e300, 0, 0, 0, 0, 0};
    const skinslide_value indices = INTS("primvars:rest:indices", 0, 1, 3);
    skinslide_value rest = rest_of("primvars:rest", 0);
    assert_fails(mesh_takes(mesh, "rest", other_of("primvars:rest", "string[]"), &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: primvars:rest has interpolation constant; it must be vertex");
    assert_fails(mesh_takes(mesh, "rest", painted_as(other_of("primvars:rest", "string[]"), "vertex"), &error), &error,
                 SKINSLIDE_BAD_POINTS, "primvars:rest is not an array of points");
    assert_fails(mesh_takes(mesh, "rest", indexed_by(rest, &indices), &error), &error, SKINSLIDE_BAD_POINTS,
                 "primvars:rest:indices[2] is 3, but primvars:rest has 3 values");
    rest.count = 2;
    assert_fails(mesh_takes(mesh, "rest", rest, &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: primvars:rest has 2 values, but points has 3");
    rest = painted_as(array_of("primvars:rest", SKINSLIDE_VALUE_DOUBLE, 3, 3, large), "vertex");
    assert_fails(mesh_takes(mesh, "rest", rest, &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: primvars:rest[1] is (inf, 0, 0)");
    skinslide_stage_mesh_destroy(mesh);
}

static void the_default_of_points_is_named(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = triangle();
    const float bad[9] = {0, 0, 0, 0, 0, 0, 0, NAN, 1};
    assert_fails(take_default(mesh, array_of("points", SKINSLIDE_VALUE_FLOAT, 3, 2, bad)), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: points (default) has 2 values, but points has 3");
    assert_fails(take_default(mesh, array_of("points", SKINSLIDE_VALUE_FLOAT, 3, 3, bad)), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: points (default)[2] is (0, nan, 1)");
    skinslide_stage_mesh_destroy(mesh);
}

static void none_at_all_says_what_to_author(void **state) {
    (void)state;
    static const char text[] = "has no rest points: points has samples but no default value, so author the rest pose as "
                               "skinSlide:restPoints or primvars:rest (point3f[], vertex)";
    skinslide_stage_mesh *mesh = triangle();
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    assert_fails(take_default(mesh, nothing_of("points")), &error, SKINSLIDE_BAD_POINTS, text);
    assert_int_equal(skinslide_stage_mesh_get(mesh, &out, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_fails(mesh_takes(mesh, "restPoints", blocked_of("skinSlide:restPoints"), &error), &error, SKINSLIDE_BAD_POINTS,
                 text);
    skinslide_stage_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_candidate_counts),
        cmocka_unit_test(points_of_no_face_may_be_anything),
        cmocka_unit_test(without_faces_no_point_is_warned_of),
        cmocka_unit_test(a_bad_candidate_is_not_passed_over),
        cmocka_unit_test(bad_rest_points_are_named),
        cmocka_unit_test(the_default_of_points_is_named),
        cmocka_unit_test(none_at_all_says_what_to_author),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
