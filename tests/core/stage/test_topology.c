/* A mesh of a scene: what was authored comes back as the slider takes it, and what cannot be used is named. */
#include "records.h"

#include <math.h>
#include <string.h>

static skinslide_error error;

static skinslide_stage_mesh *empty_mesh(void) {
    skinslide_stage_mesh *mesh = NULL;
    assert_ok(skinslide_stage_mesh_create(&mesh, &error), &error);
    return mesh;
}

static void expect(skinslide_stage_mesh *mesh, const char *name, skinslide_value value, skinslide_status status,
                   const char *text) {
    assert_fails(mesh_takes(mesh, name, value, &error), &error, status, text);
}

static void takes(skinslide_stage_mesh *mesh, const char *name, skinslide_value value) {
    assert_ok(mesh_takes(mesh, name, value, &error), &error);
}

#define POINTS(name, count) array_of(name, SKINSLIDE_VALUE_FLOAT, 3, count, (float[3 * (count)]){0})

static void a_mesh_comes_back(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 2);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    assert_int_equal(out.vertex_count, grid.vertex_count);
    assert_int_equal(out.face_count, grid.face_count);
    assert_int_equal(out.index_count, grid.index_count);
    assert_same_bytes(out.face_counts, grid.face_counts, 4 * (size_t)grid.face_count);
    assert_same_bytes(out.face_indices, grid.face_indices, 4 * (size_t)grid.index_count);
    assert_same_bytes(out.rest_points, grid.points, POINT_BYTES(&grid));
    assert_null(out.subdivision);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

/* Patches need no rest points, and a mesh that refuses them still has its faces. */
static void faces_need_no_rest(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    takes(mesh, "points", POINTS("points", 4));
    takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 4));
    assert_fails(skinslide_stage_mesh_faces(mesh, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no mesh with faces, or no place for it");
    takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2, 3));
    assert_ok(skinslide_stage_mesh_faces(mesh, &out, &error), &error);
    assert_int_equal(out.face_count, 1);
    assert_int_equal(out.vertex_count, 4);
    assert_null(out.rest_points);
    out.size = 1;
    assert_fails(skinslide_stage_mesh_faces(mesh, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "skinslide_mesh: its size is 1; start from its default");
    skinslide_stage_mesh_destroy(mesh);
}

static void expect_painted(skinslide_stage_mesh *mesh, skinslide_value value, const char *interpolation, const char *fault) {
    double numbers[4];
    value.interpolation = interpolation;
    skinslide_status status = skinslide_stage_painted(mesh, &value, numbers, &error);
    if (fault)
        assert_fails(status, &error, SKINSLIDE_BAD_PATCH, fault);
    else
        assert_ok(status, &error);
    for (int32_t v = 0; v < 4 && !fault; v++)
        assert_true(numbers[v] == v);
}

static void paint_on_points(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    takes(mesh, "points", POINTS("points", 4));
    takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 4));
    takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2, 3));
    expect_painted(mesh, INTS("primvars:a", 0, 1, 2, 3), "vertex", NULL);
    expect_painted(mesh, FLOATS("primvars:a", 0, 1, 2, 3), "varying", NULL);
    expect_painted(mesh, FLOATS("primvars:a", 0, 1, 2, 3), "uniform",
                   "primvars:a has interpolation uniform; it must be vertex");
    expect_painted(mesh, FLOATS("primvars:a", 0, 1), "vertex", "primvars:a has 2 values, but the mesh has 4 points");
    expect_painted(mesh, FLOATS("primvars:a", 0, NAN, 2, 3), "vertex", "primvars:a[1] is nan");
    expect_painted(mesh, other_of("primvars:a", "color3f[]"), "vertex",
                   "primvars:a is color3f[]; it must be bool[], int[] or float[]");
    expect_painted(mesh, blocked_of("primvars:a"), "vertex", "primvars:a has no value");
    double numbers[4];
    assert_fails(skinslide_stage_painted(mesh, NULL, numbers, &error), &error, SKINSLIDE_BAD_PATCH, "the value has no value");
    skinslide_stage_mesh_destroy(mesh);
}

static void bad_points_are_named(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    expect(mesh, "points", other_of("points", "int"), SKINSLIDE_BAD_POINTS, "points is not an array of points");
    expect(mesh, "points", nothing_of("points"), SKINSLIDE_BAD_POINTS, "points has no value");
    expect(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3), SKINSLIDE_BAD_ARGUMENT, "the points of the mesh come first");
    skinslide_stage_mesh_destroy(mesh);
}

static void bad_faces_are_named(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    takes(mesh, "points", POINTS("points", 4));
    expect(mesh, "faceVertexCounts", FLOATS("faceVertexCounts", 1), SKINSLIDE_BAD_MESH,
           "faceVertexCounts is not an array of int");
    expect(mesh, "faceVertexCounts", nothing_of("faceVertexCounts"), SKINSLIDE_BAD_MESH, "faceVertexCounts has no value");
    expect(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3, -4), SKINSLIDE_BAD_MESH, "face 1 has -4 vertices");
    takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 9)); /* there is nothing to compare them with */
    takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3, 3));
    expect(mesh, "faceVertexIndices", nothing_of("faceVertexIndices"), SKINSLIDE_BAD_MESH, "faceVertexIndices has no value");
    expect(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2, 3), SKINSLIDE_BAD_MESH,
           "faceVertexCounts add up to 6, but faceVertexIndices has 4 values");
    expect(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2, 0, 2, 4), SKINSLIDE_BAD_MESH,
           "face 1 has point 4, but the mesh has 4 points");
    expect(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, -1, 2, 0, 2, 3), SKINSLIDE_BAD_MESH,
           "face 0 has point -1, but the mesh has 4 points");
    skinslide_stage_patch *patch = NULL;
    assert_int_equal(skinslide_stage_patch_create(mesh, "p", NULL, &patch, &error), SKINSLIDE_BAD_ARGUMENT);
    skinslide_stage_mesh_destroy(mesh);
}

/* A mesh gives nothing while a value is refused or missing, and what takes its place mends it. */
static void what_was_refused_may_be_given_again(void **state) {
    (void)state;
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    skinslide_stage_mesh *mesh = empty_mesh();
    assert_int_equal(skinslide_stage_mesh_get(mesh, &out, &error), SKINSLIDE_BAD_ARGUMENT);
    takes(mesh, "points", POINTS("points", 3));
    takes(mesh, "faceVertexCounts", INTS("faceVertexCounts", 3));
    expect(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 3), SKINSLIDE_BAD_MESH, "face 0 has point 3, but...");
    takes(mesh, "restPoints", POINTS("skinSlide:restPoints", 3));
    assert_fails(skinslide_stage_mesh_get(mesh, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT, "faceVertexIndices was refused");
    takes(mesh, "faceVertexIndices", INTS("faceVertexIndices", 0, 1, 2));
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    skinslide_stage_mesh_destroy(mesh);
}

static void faces_must_stay_the_same(void **state) {
    (void)state;
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    const skinslide_stage_input *indices = input_of(SKINSLIDE_STAGE_MESH, NULL, "faceVertexIndices");
    skinslide_value same = array_of("faceVertexIndices", SKINSLIDE_VALUE_INT32, 1, 4, grid.face_indices);
    const skinslide_value turned = INTS("faceVertexIndices", 3, 1, 0, 2), none = nothing_of("faceVertexIndices");
    assert_int_equal(indices->when, SKINSLIDE_STAGE_STILL);
    assert_ok(skinslide_stage_mesh_check(mesh, indices, &same, 1002, &error), &error);
    assert_fails(skinslide_stage_mesh_check(mesh, indices, &turned, 1002.5, &error), &error, SKINSLIDE_BAD_MESH,
                 "faceVertexIndices changes at frame 1002.5; it must stay the same over time");
    assert_fails(skinslide_stage_mesh_check(mesh, indices, &none, 1, &error), &error, SKINSLIDE_BAD_MESH,
                 "faceVertexIndices changes at frame 1; it must stay the same over time");
    assert_int_equal(skinslide_stage_mesh_check(mesh, input_of(SKINSLIDE_STAGE_MESH, NULL, "points"), &same, 1, &error),
                     SKINSLIDE_BAD_ARGUMENT);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

static void orientation_is_a_token(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    takes(mesh, "points", POINTS("points", 3));
    assert_false(skinslide_stage_mesh_left_handed(mesh));
    takes(mesh, "orientation", text_of("orientation", "leftHanded"));
    assert_true(skinslide_stage_mesh_left_handed(mesh));
    takes(mesh, "orientation", text_of("orientation", "rightHanded"));
    assert_false(skinslide_stage_mesh_left_handed(mesh));
    takes(mesh, "orientation", other_of("orientation", "token[]"));
    assert_false(skinslide_stage_mesh_left_handed(mesh));
    skinslide_stage_mesh_destroy(mesh);
}

static void points_are_checked_as_by_a_slide(void **state) {
    (void)state;
    skinslide_stage_mesh *mesh = empty_mesh();
    float points[12] = {0};
    takes(mesh, "points", POINTS("points", 4));
    assert_ok(skinslide_stage_check_points(mesh, points, &error), &error);
    points[7] = NAN;
    assert_fails(skinslide_stage_check_points(mesh, points, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 2 is not finite: (0, nan, 0)");
    assert_fails(skinslide_stage_check_points(NULL, points, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no mesh");
    skinslide_stage_mesh_destroy(mesh);
}

static void points_of_a_frame(void **state) {
    (void)state;
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    const double doubles[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    float out[12];
    skinslide_value value = array_of("points", SKINSLIDE_VALUE_DOUBLE, 3, 4, doubles);
    const skinslide_value none = nothing_of("points"), other = other_of("points", "string");
    assert_ok(skinslide_stage_points(mesh, &value, NULL, &error), &error);
    assert_ok(skinslide_stage_points(mesh, &value, out, &error), &error);
    for (int i = 0; i < 12; i++)
        assert_true((double)out[i] == doubles[i]);
    value.count = 3;
    assert_fails(skinslide_stage_points(mesh, &value, out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points has 3 values, but 4 at first; the count must stay the same");
    assert_fails(skinslide_stage_points(mesh, &none, out, &error), &error, SKINSLIDE_BAD_POINTS, "points has no value");
    assert_fails(skinslide_stage_points(mesh, &other, out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points is not an array of points");
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

/* ---- Subdivision ---- */

static skinslide_status surface_takes(skinslide_stage_mesh *mesh, const char *name, skinslide_value value) {
    return skinslide_stage_mesh_take(mesh, input_of(SKINSLIDE_STAGE_SUBDIVISION, NULL, name), &value, &error);
}

static void take_surface_of_nothing(skinslide_stage_mesh *mesh) {
    const skinslide_stage_input *input = NULL;
    while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_SUBDIVISION, input)) != NULL)
        assert_ok(skinslide_stage_mesh_take(mesh, input, NULL, &error), &error);
}

static void subdivision_comes_back(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    take_surface_of_nothing(mesh); /* USD's fallbacks */
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    assert_int_equal(out.subdivision->scheme, SKINSLIDE_SCHEME_CATMULL_CLARK);
    assert_int_equal(out.subdivision->boundary_rule, SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER);
    assert_int_equal(out.subdivision->crease_count, 0);
    assert_ok(surface_takes(mesh, "subdivisionScheme", text_of("subdivisionScheme", "bilinear")), &error);
    assert_ok(surface_takes(mesh, "interpolateBoundary", text_of("interpolateBoundary", "none")), &error);
    assert_ok(surface_takes(mesh, "triangleSubdivisionRule", text_of("triangleSubdivisionRule", "smooth")), &error);
    assert_ok(surface_takes(mesh, "creaseLengths", INTS("creaseLengths", 2)), &error);
    assert_ok(surface_takes(mesh, "creaseIndices", INTS("creaseIndices", 0, 1)), &error);
    assert_ok(surface_takes(mesh, "creaseSharpnesses", FLOATS("creaseSharpnesses", 2.5f)), &error);
    assert_ok(surface_takes(mesh, "cornerIndices", INTS("cornerIndices", 3)), &error);
    assert_ok(surface_takes(mesh, "cornerSharpnesses", FLOATS("cornerSharpnesses", 10)), &error);
    assert_ok(surface_takes(mesh, "holeIndices", INTS("holeIndices", 1)), &error);
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    const skinslide_subdivision *own = out.subdivision;
    assert_int_equal(own->scheme, SKINSLIDE_SCHEME_BILINEAR);
    assert_int_equal(own->boundary_rule, SKINSLIDE_BOUNDARY_RULE_NONE);
    assert_int_equal(own->triangle_rule, SKINSLIDE_TRIANGLE_RULE_SMOOTH);
    assert_true(own->crease_count == 1 && own->crease_lengths[0] == 2 && own->crease_index_count == 2);
    assert_true(own->crease_indices[1] == 1 && own->crease_sharpness_count == 1 && own->crease_sharpnesses[0] == 2.5f);
    assert_true(own->corner_count == 1 && own->corner_indices[0] == 3 && own->corner_sharpnesses[0] == 10);
    assert_true(own->hole_count == 1 && own->hole_indices[0] == 1);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

static void bad_subdivision_is_named(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    assert_fails(surface_takes(mesh, "subdivisionScheme", text_of("subdivisionScheme", "butterfly")), &error,
                 SKINSLIDE_BAD_MESH, "subdivisionScheme is 'butterfly'; it must be one of none, catmullClark, loop, bilinear");
    assert_fails(skinslide_stage_mesh_get(mesh, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT, "subdivisionScheme was refused");
    assert_ok(surface_takes(mesh, "subdivisionScheme", text_of("subdivisionScheme", "loop")), &error);
    assert_fails(surface_takes(mesh, "creaseLengths", FLOATS("creaseLengths", 2)), &error, SKINSLIDE_BAD_MESH,
                 "creaseLengths is not an array of int");
    assert_fails(surface_takes(mesh, "creaseSharpnesses", INTS("creaseSharpnesses", 2)), &error, SKINSLIDE_BAD_MESH,
                 "creaseSharpnesses is not an array of float");
    assert_ok(surface_takes(mesh, "cornerIndices", INTS("cornerIndices", 2, 3)), &error);
    assert_fails(surface_takes(mesh, "cornerSharpnesses", FLOATS("cornerSharpnesses", 2)), &error, SKINSLIDE_BAD_MESH,
                 "corner sharpnesses: 1 values for 2 corners");
    const skinslide_stage_input *scheme = input_of(SKINSLIDE_STAGE_SUBDIVISION, NULL, "subdivisionScheme");
    const skinslide_value later = text_of("subdivisionScheme", "bilinear");
    assert_fails(skinslide_stage_mesh_check(mesh, scheme, &later, 7, &error), &error, SKINSLIDE_BAD_MESH,
                 "subdivisionScheme changes at frame 7; it must stay the same over time");
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

/* If a mesh renders as its faces, the other inputs of subdivision have no effect. */
static void a_mesh_of_no_scheme_has_no_subdivision(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    assert_ok(surface_takes(mesh, "subdivisionScheme", text_of("subdivisionScheme", "none")), &error);
    assert_ok(surface_takes(mesh, "interpolateBoundary", text_of("interpolateBoundary", "nonsense")), &error);
    assert_ok(skinslide_stage_mesh_get(mesh, &out, &error), &error);
    assert_null(out.subdivision);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

/* ---- Texture coordinates ---- */

static void coordinates_by_corner_and_by_point(void **state) {
    (void)state;
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    const float by_point[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    float st[8];
    skinslide_value value = painted_as(array_of("primvars:st", SKINSLIDE_VALUE_FLOAT, 2, 4, by_point), "vertex");
    assert_ok(skinslide_stage_coordinates(mesh, &value, st, &error), &error);
    for (int c = 0; c < 4; c++)
        assert_true(st[2 * c] == by_point[2 * grid.face_indices[c]] && st[2 * c + 1] == by_point[2 * grid.face_indices[c] + 1]);
    value.interpolation = "faceVarying";
    assert_ok(skinslide_stage_coordinates(mesh, &value, st, &error), &error);
    assert_same_bytes(st, by_point, sizeof st);
    const skinslide_value indices = INTS("primvars:st:indices", 3, 0, 0, 1);
    value.indices = &indices;
    assert_ok(skinslide_stage_coordinates(mesh, &value, st, &error), &error);
    assert_same_bytes(st, ((float[]){6, 7, 0, 1, 0, 1, 2, 3}), sizeof st);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

static void expect_coordinates(const skinslide_stage_mesh *mesh, skinslide_value value, const char *text) {
    float st[8];
    assert_fails(skinslide_stage_coordinates(mesh, &value, st, &error), &error, SKINSLIDE_BAD_CONTROL, text);
}

static void bad_coordinates_are_named(void **state) {
    (void)state;
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    const float data[10] = {0};
    skinslide_value value = painted_as(array_of("primvars:st", SKINSLIDE_VALUE_FLOAT, 2, 5, data), "uniform");
    const skinslide_value indices = INTS("primvars:st:indices", 0, 0, 0, 9);
    expect_coordinates(mesh, value, "primvars:st has interpolation uniform; a map needs faceVarying, vertex or varying");
    expect_coordinates(mesh, painted_as(value, NULL),
                       "primvars:st has interpolation constant; a map needs faceVarying, vertex or varying");
    expect_coordinates(mesh, painted_as(value, "vertex"), "primvars:st has 5 values, but the mesh has 4 points");
    expect_coordinates(mesh, painted_as(value, "faceVarying"), "primvars:st has 5 values, but the mesh has 4 face corners");
    expect_coordinates(mesh, painted_as(blocked_of("primvars:st"), "vertex"),
                       "primvars:st has 0 values, but the mesh has 4 points");
    expect_coordinates(mesh, painted_as(indexed_by(value, &indices), "vertex"),
                       "primvars:st:indices[3] is 9, but primvars:st has 5 values");
    value.width = 1, value.type_name = "float[]";
    expect_coordinates(mesh, painted_as(value, "vertex"), "primvars:st is float[]; a map needs pairs of floats");
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_comes_back),
        cmocka_unit_test(faces_need_no_rest),
        cmocka_unit_test(paint_on_points),
        cmocka_unit_test(bad_points_are_named),
        cmocka_unit_test(bad_faces_are_named),
        cmocka_unit_test(what_was_refused_may_be_given_again),
        cmocka_unit_test(faces_must_stay_the_same),
        cmocka_unit_test(orientation_is_a_token),
        cmocka_unit_test(points_of_a_frame),
        cmocka_unit_test(points_are_checked_as_by_a_slide),
        cmocka_unit_test(subdivision_comes_back),
        cmocka_unit_test(bad_subdivision_is_named),
        cmocka_unit_test(a_mesh_of_no_scheme_has_no_subdivision),
        cmocka_unit_test(coordinates_by_corner_and_by_point),
        cmocka_unit_test(bad_coordinates_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
