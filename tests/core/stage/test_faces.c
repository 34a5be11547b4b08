/* The faces of a patch: by face, by vertex, of a subset; and every way that they cannot be. */
#include "records.h"

#include <math.h>
#include <string.h>

static skinslide_error error;
#define PRIMVAR "primvars:skinSlide:elbow:patch"

typedef struct scene {
    test_mesh grid; /* 3 x 2 quads */
    skinslide_stage_mesh *mesh;
    skinslide_stage_patch *patch;
} scene;

static scene set_up(void) {
    scene s = {quad_grid(3, 2), NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    assert_ok(skinslide_stage_patch_create(s.mesh, "elbow", NULL, &s.patch, &error), &error);
    return s;
}

static void tear_down(scene *s) {
    skinslide_stage_patch_destroy(s->patch);
    skinslide_stage_mesh_destroy(s->mesh);
    free_mesh(&s->grid);
}

static void expect_faces(const scene *s, int32_t count, const int32_t *expected) {
    int32_t found;
    const int32_t *faces = skinslide_stage_patch_faces(s->patch, &found);
    assert_int_equal(found, count);
    assert_same_bytes(faces, expected, (size_t)count * sizeof *expected);
}

static void by_face_of_every_type(void **state) {
    (void)state;
    const uint8_t bools[6] = {0, 1, 0, 1, 1, 0};
    const int32_t ints[6] = {-1, 2, 0, 1, 1, 0};
    const float floats[6] = {0, 0.5f, -3, 1, 2, 0};
    const void *data[] = {bools, ints, floats};
    const skinslide_value_type types[] = {SKINSLIDE_VALUE_BOOL, SKINSLIDE_VALUE_INT32, SKINSLIDE_VALUE_FLOAT};
    for (int i = 0; i < 3; i++) {
        scene s = set_up();
        int32_t count = -1;
        assert_null(skinslide_stage_patch_faces(s.patch, &count));
        assert_int_equal(count, 0);
        skinslide_value value = painted_as(array_of(PRIMVAR, types[i], 1, 6, data[i]), "uniform");
        assert_ok(patch_takes(s.patch, "patch", value, &error), &error);
        expect_faces(&s, 3, (int32_t[]){1, 3, 4});
        tear_down(&s);
    }
}

/* All points of the first column of quads, and one more that completes no face. */
static void by_vertex(void **state) {
    (void)state;
    scene s = set_up();
    const float floats[12] = {1, 1, 0, 0, 1, 1, 1, 0, 1, 1, 0, 0};
    skinslide_value value = painted_as(array_of(PRIMVAR, SKINSLIDE_VALUE_FLOAT, 1, 12, floats), "vertex");
    assert_ok(patch_takes(s.patch, "patch", value, &error), &error);
    expect_faces(&s, 2, (int32_t[]){0, 3});
    tear_down(&s);
}

static void indexed(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_value indices = INTS(PRIMVAR ":indices", 1, 0, 0, 0, 1, 1),
                          bad = INTS(PRIMVAR ":indices", 1, 0, 0, 0, 1, 2);
    skinslide_value value = painted_as(array_of(PRIMVAR, SKINSLIDE_VALUE_BOOL, 1, 2, (uint8_t[]){0, 1}), "uniform");
    assert_ok(patch_takes(s.patch, "patch", indexed_by(value, &indices), &error), &error);
    expect_faces(&s, 3, (int32_t[]){0, 4, 5});
    assert_fails(patch_takes(s.patch, "patch", indexed_by(value, &bad), &error), &error, SKINSLIDE_BAD_PATCH,
                 PRIMVAR ":indices[5] is 2, but " PRIMVAR " has 2 values");
    tear_down(&s);
}

/* The face at the end of a row of three, and those within a distance of it: whatever comes first, and only where the rule takes
 * any faces. */
static void grown(void **state) {
    (void)state;
    static const uint8_t chosen[6] = {1, 0, 0, 0, 0, 0};
    for (int first = 0; first < 3; first++) {
        scene s = set_up();
        for (int i = 0; i < 3; i++) {
            if ((first + i) % 3 == 0)
                assert_ok(patch_takes(s.patch, "grow", NUMBER("grow", 1), &error), &error);
            if ((first + i) % 3 == 1)
                assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "even"), &error), &error);
            if ((first + i) % 3 == 2)
                assert_ok(patch_takes(s.patch, "patch",
                                      painted_as(array_of(PRIMVAR, SKINSLIDE_VALUE_BOOL, 1, 6, chosen), "uniform"), &error),
                          &error);
        }
        expect_faces(&s, 3, (int32_t[]){0, 1, 3});
        assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "unit"), &error), &error);
        expect_faces(&s, 1, (int32_t[]){0});
        assert_ok(patch_takes(s.patch, "forceDensityRule", text_of("rule", "relaxed"), &error), &error);
        assert_ok(patch_takes(s.patch, "grow", NUMBER("grow", 2.5f), &error), &error);
        expect_faces(&s, 6, (int32_t[]){0, 1, 2, 3, 4, 5});
        tear_down(&s);
    }
}

static void expect(scene *s, skinslide_value value, const char *text) {
    assert_fails(patch_takes(s->patch, "patch", value, &error), &error, SKINSLIDE_BAD_PATCH, text);
}

static void bad_primvars_are_named(void **state) {
    (void)state;
    scene s = set_up();
    skinslide_value colours = painted_as(other_of(PRIMVAR, "color3f[]"), "uniform"), wide = colours;
    wide.type = SKINSLIDE_VALUE_FLOAT, wide.width = 3, wide.data = (float[3]){0};
    expect(&s, colours, PRIMVAR " is color3f[]; it must be bool[], int[] or float[]");
    expect(&s, wide,
           PRIMVAR
           " is color3f[]; it must be bool[], int[] or float[], or skinSlide:elbow:paintChannel must name the channel that "
           "counts");
    expect(&s, painted_as(NUMBER(PRIMVAR, 1), "uniform"), PRIMVAR " is float; it must be bool[], int[] or float[]");
    expect(&s, painted_as(INTS(PRIMVAR, 1), "faceVarying"), PRIMVAR " has 1 values, but the mesh has 24 face corners");
    expect(&s, INTS(PRIMVAR, 1), PRIMVAR " has interpolation constant; it must be uniform (by face), vertex or faceVarying");
    expect(&s, painted_as(blocked_of(PRIMVAR), "uniform"), PRIMVAR " has no value");
    expect(&s, painted_as(INTS(PRIMVAR, 1), "uniform"), PRIMVAR " has 1 values, but the mesh has 6 faces");
    expect(&s, painted_as(INTS(PRIMVAR, 1), "vertex"), PRIMVAR " has 1 values, but the mesh has 12 points");
    expect(&s, painted_as(FLOATS(PRIMVAR, 1, NAN, 0, 0, 0, 0), "uniform"), PRIMVAR "[1] is nan");
    expect(&s, painted_as(FLOATS(PRIMVAR, 1, 0, 0, INFINITY, 0, 0), "uniform"), PRIMVAR "[3] is inf");
    expect(&s, painted_as(INTS(PRIMVAR, 0, 0, 0, 0, 0, 0), "uniform"), "has no faces: " PRIMVAR " is above 0 on no face");
    expect(&s, painted_as(INTS(PRIMVAR, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0), "vertex"),
           "has no faces: " PRIMVAR " is above 0 on all points of no face");
    tear_down(&s);
}

/* Other values may choose the same faces, as after a tool has resampled them. */
static void faces_must_stay_the_same(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_stage_input *input = input_of(SKINSLIDE_STAGE_PATCH, NULL, "patch");
    const skinslide_value first = painted_as(INTS(PRIMVAR, 1, 1, 0, 0, 0, 0), "uniform");
    const skinslide_value same = painted_as(FLOATS(PRIMVAR, 3, 0.5f, 0, -1, 0, 0), "uniform");
    const skinslide_value other = painted_as(INTS(PRIMVAR, 1, 0, 1, 0, 0, 0), "uniform");
    assert_ok(patch_takes(s.patch, "patch", first, &error), &error);
    assert_ok(skinslide_stage_patch_check(s.patch, input, &same, 1001, &error), &error);
    assert_fails(skinslide_stage_patch_check(s.patch, input, &other, 1003, &error), &error, SKINSLIDE_BAD_PATCH,
                 PRIMVAR " chooses other faces at frame 1003; patches are fixed");
    tear_down(&s);
}

/* ---- Subsets ---- */

static const skinslide_value unsaid = SKINSLIDE_VALUE_DEFAULT;

static skinslide_stage_subset subset_of(void) {
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    subset.path = "/mesh/elbow", subset.type_name = "GeomSubset", subset.is_subset = 1;
    return subset;
}

static skinslide_status subset_takes(const scene *s, const char *name, skinslide_value value) {
    return skinslide_stage_patch_take(s->patch, input_of(SKINSLIDE_STAGE_SUBSET, NULL, name), &value, &error);
}

static void faces_of_a_subset(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_stage_input *input = input_of(SKINSLIDE_STAGE_SUBSET, NULL, "indices");
    const skinslide_value indices = INTS("indices", 5, 0, 3, 0), other = INTS("indices", 5, 0, 3);
    skinslide_stage_subset subset = subset_of();
    assert_ok(patch_takes(s.patch, "patch", nothing_of(PRIMVAR), &error), &error);
    assert_int_equal(subset_takes(&s, "indices", indices), SKINSLIDE_BAD_ARGUMENT); /* of no subset */
    assert_ok(skinslide_stage_patch_take_subset(s.patch, &subset, &error), &error);
    assert_ok(subset_takes(&s, "elementType", unsaid), &error);
    assert_ok(subset_takes(&s, "indices", indices), &error);
    expect_faces(&s, 3, (int32_t[]){0, 3, 5});
    assert_int_equal(skinslide_stage_patch_faces(s.patch, NULL)[1], 3);
    assert_ok(subset_takes(&s, "elementType", text_of("elementType", "face")), &error);
    assert_ok(subset_takes(&s, "indices", indices), &error);
    assert_ok(skinslide_stage_patch_check(s.patch, input, &indices, 1, &error), &error);
    assert_fails(skinslide_stage_patch_check(s.patch, input, &other, 1002, &error), &error, SKINSLIDE_BAD_PATCH,
                 "/mesh/elbow.indices changes at frame 1002; it must stay the same over time");
    tear_down(&s);
}

static void a_primvar_wins_over_a_subset(void **state) {
    (void)state;
    scene s = set_up();
    skinslide_stage_subset subset = subset_of();
    assert_ok(patch_takes(s.patch, "patch", painted_as(INTS(PRIMVAR, 0, 1, 0, 0, 0, 0), "uniform"), &error), &error);
    assert_ok(skinslide_stage_patch_take_subset(s.patch, &subset, &error), &error);
    assert_ok(subset_takes(&s, "indices", INTS("indices", 5)), &error);
    assert_ok(skinslide_stage_patch_take_subset(s.patch, NULL, &error), &error);
    expect_faces(&s, 1, (int32_t[]){1});
    tear_down(&s);
}

/* An error of a subset is reported once: after that its inputs are not looked at, until a subset is taken again. */
static void expect_subset(const scene *s, skinslide_value element, skinslide_value indices, const char *text) {
    const skinslide_stage_subset subset = subset_of();
    assert_ok(skinslide_stage_patch_take_subset(s->patch, &subset, &error), &error);
    bool is_element = element.type != SKINSLIDE_VALUE_NONE;
    skinslide_status first = subset_takes(s, "elementType", element);
    assert_fails(is_element ? first : subset_takes(s, "indices", indices), &error, SKINSLIDE_BAD_PATCH, text);
    assert_ok(subset_takes(s, "indices", indices), &error);
}

static void expect_no_subset(const scene *s, const skinslide_stage_subset *subset, const char *text) {
    assert_fails(skinslide_stage_patch_take_subset(s->patch, subset, &error), &error, SKINSLIDE_BAD_PATCH, text);
    assert_ok(subset_takes(s, "indices", INTS("indices", 0)), &error);
}

static void bad_subsets_are_named(void **state) {
    (void)state;
    scene s = set_up();
    const skinslide_value good = INTS("indices", 0);
    expect_subset(&s, unsaid, unsaid, "has no faces: the GeomSubset /mesh/elbow is empty");
    expect_subset(&s, unsaid, INTS("indices", 0, 6, 7), "the GeomSubset /mesh/elbow has face 6, but the mesh has 6 faces");
    expect_subset(&s, unsaid, INTS("indices", 0, -1), "the GeomSubset /mesh/elbow has face -1, but the mesh has 6 faces");
    expect_subset(&s, unsaid, FLOATS("indices", 1), "/mesh/elbow.indices is not an array of int");
    expect_subset(&s, text_of("elementType", "point"), good,
                  "the GeomSubset /mesh/elbow has elementType point; it must be face");
    expect_subset(&s, other_of("elementType", "int"), good, "the GeomSubset /mesh/elbow has elementType int; it must be face");
    skinslide_stage_subset subset = subset_of();
    expect_no_subset(&s, NULL, "has no faces: there is neither " PRIMVAR " nor a GeomSubset elbow under the mesh");
    subset.is_subset = 0, subset.type_name = "Xform";
    expect_no_subset(&s, &subset, "has no faces: /mesh/elbow is a Xform, not a GeomSubset");
    subset.type_name = NULL;
    expect_no_subset(&s, &subset, "has no faces: /mesh/elbow is a prim without a type, not a GeomSubset");
    subset.path = NULL;
    assert_int_equal(skinslide_stage_patch_take_subset(s.patch, &subset, &error), SKINSLIDE_BAD_ARGUMENT);
    subset.size = 0;
    assert_int_equal(skinslide_stage_patch_take_subset(s.patch, &subset, &error), SKINSLIDE_BAD_ARGUMENT);
    tear_down(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_face_of_every_type),
        cmocka_unit_test(by_vertex),
        cmocka_unit_test(indexed),
        cmocka_unit_test(grown),
        cmocka_unit_test(bad_primvars_are_named),
        cmocka_unit_test(faces_must_stay_the_same),
        cmocka_unit_test(faces_of_a_subset),
        cmocka_unit_test(a_primvar_wins_over_a_subset),
        cmocka_unit_test(bad_subsets_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
