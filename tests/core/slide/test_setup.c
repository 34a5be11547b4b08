/* Set-ups of a slider: what it says of its patches, and every input it refuses, by name, leaving outputs as they were. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- What a slider says ---- */

static void patches_are_numbered_setup_by_setup(void **state) {
    (void)state;
    test_mesh sheet = quad_grid(3, 3), holed = grid_with_holes(false), mesh = join_meshes(&sheet, &holed);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setups[2] = {setup_of(faces, 9), setup_of(faces, mesh.face_count)};
    setups[0].name = "first", setups[1].name = "second";
    rig r = rig_of_setups(&mesh, setups, 2);
    assert_int_equal(skinslide_slider_patch_count(r.slider), 3);
    static const struct {
        const char *name;
        int32_t setup, piece, pieces, vertices, edges, faces, free, holes;
    } expected[3] = {
        {"first", 0, 0, 1, 16, 24, 9, 4, 0}, {"second", 1, 0, 2, 16, 24, 9, 4, 0}, {"second", 1, 1, 2, 120, 214, 93, 64, 2}};
    for (int32_t p = 0; p < 3; p++) {
        skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
        skinslide_error error;
        assert_ok(skinslide_slider_patch_info(r.slider, p, &info, &error), &error);
        assert_string_equal(info.name, expected[p].name);
        assert_int_equal(info.setup, expected[p].setup);
        assert_int_equal(info.piece, expected[p].piece);
        assert_int_equal(info.piece_count, expected[p].pieces);
        assert_int_equal(info.vertex_count, expected[p].vertices);
        assert_int_equal(info.edge_count, expected[p].edges);
        assert_int_equal(info.face_count, expected[p].faces);
        assert_int_equal(info.free_count, expected[p].free);
        assert_int_equal(info.hole_count, expected[p].holes);
        assert_int_equal(info.zero_length_edges + info.collapsed_faces + info.folded_faces, 0);
    }
    free(faces);
    free_rig(&r);
    free_mesh(&sheet), free_mesh(&holed), free_mesh(&mesh);
}

/* Faces in any order; vertices and faces come back ascending. Set-ups are read during the call only. */
static void copies_are_of_the_patch(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(4, 1);
    int32_t faces[2] = {2, 1}, vertices[6], found[2];
    char name[] = "elbow";
    skinslide_patch_setup setup = setup_of(faces, 2);
    setup.name = name;
    rig r = rig_of_setups(&mesh, &setup, 1);
    memset(faces, 0x55, sizeof faces), memset(name, 'x', 5), memset(&setup, 0x55, sizeof setup);
    free_mesh(&mesh);
    skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
    double uv[6][2];
    skinslide_error error;
    assert_ok(skinslide_slider_patch_info(r.slider, 0, &info, &error), &error);
    assert_ok(skinslide_slider_patch_vertices(r.slider, 0, vertices, &error), &error);
    assert_ok(skinslide_slider_patch_faces(r.slider, 0, found, &error), &error);
    assert_ok(skinslide_slider_embedding(r.slider, 0, &uv[0][0], &error), &error);
    assert_string_equal(info.name, "elbow");
    assert_same_bytes(vertices, ((int32_t[]){1, 2, 3, 6, 7, 8}), sizeof vertices);
    assert_same_bytes(found, ((int32_t[]){1, 2}), sizeof found);
    assert_true(uv[0][0] == 1 && uv[0][1] == 0.5); /* the loop begins at its lowest vertex, at the circle's right */
    free_rig(&r);
}

static void patches_that_are_not_there(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
    double uv[18];
    int32_t ids[9];
    skinslide_error error;
    const char *text = "there is no patch 1: the slider has 1";
    assert_fails(skinslide_slider_patch_info(r.slider, 1, &info, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_slider_patch_vertices(r.slider, 1, ids, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_slider_patch_faces(r.slider, 1, ids, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_slider_embedding(r.slider, 1, uv, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_workspace_embedding(r.workspace, 1, uv, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_workspace_embedding(r.workspace, 0, uv, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the workspace has slid no frame yet");
    assert_fails(skinslide_slider_embedding(NULL, 0, uv, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no slider or workspace, or no place for the answer");
    assert_int_equal(skinslide_slider_patch_info(r.slider, -1, &info, NULL), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_slider_patch_count(NULL), 0);
    free_rig(&r);
    free_mesh(&mesh);
}

static void statuses_have_names(void **state) {
    (void)state;
    assert_string_equal(skinslide_status_name(SKINSLIDE_OK), "OK");
    assert_string_equal(skinslide_status_text(SKINSLIDE_BAD_PATCH), "the patch is not a disk with holes");
    assert_string_equal(skinslide_status_name(SKINSLIDE_STATUS_COUNT), "?");
    assert_string_equal(skinslide_status_text((skinslide_status)-1), "?");
    assert_string_equal(skinslide_version(), SKINSLIDE_VERSION_TEXT);
}

/* ---- What it refuses ---- */

static void expect_setups(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t count,
                          skinslide_status expected, const char *text) {
    skinslide_slider *const untouched = (skinslide_slider *)&expected, *slider = untouched;
    skinslide_error error;
    skinslide_status status = skinslide_slider_create(mesh, setups, count, &slider, &error);
    assert_ptr_equal(slider, untouched);
    assert_fails(status, &error, expected, text);
    assert_int_equal(skinslide_slider_create(mesh, setups, count, &slider, NULL), expected);
}

static void expect_setup(skinslide_patch_setup setup, skinslide_status expected, const char *text) {
    test_mesh mesh = quad_grid(3, 3);
    skinslide_mesh view = view_of(&mesh);
    expect_setups(&view, &setup, 1, expected, text);
    free_mesh(&mesh);
}

static const int32_t nine[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};

static void bad_arguments(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    skinslide_mesh view = view_of(&mesh);
    skinslide_error error;
    expect_setups(NULL, NULL, 0, SKINSLIDE_BAD_ARGUMENT, "no mesh, or a negative count in it");
    expect_setups(&view, NULL, 1, SKINSLIDE_BAD_ARGUMENT, "no place for the slider, or no patches");
    expect_setups(&view, NULL, -1, SKINSLIDE_BAD_ARGUMENT, "no place for the slider, or no patches");
    assert_fails(skinslide_slider_create(&view, NULL, 0, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no place for the slider, or no patches");
    view.rest_points = NULL;
    expect_setups(&view, NULL, 0, SKINSLIDE_BAD_ARGUMENT, "no rest points");
    mesh.points[20] = NAN;
    view = view_of(&mesh);
    expect_setups(&view, NULL, 0, SKINSLIDE_BAD_POINTS, "rest points: vertex 6 is not finite: (2, 1, ...");
    view.face_count = 0;
    expect_setups(&view, NULL, 0, SKINSLIDE_BAD_MESH, "the mesh has no faces");
    free_mesh(&mesh);
}

static void bad_faces(void **state) {
    (void)state;
    expect_setup(setup_of(nine, 0), SKINSLIDE_BAD_PATCH, "patch all: it has no faces");
    expect_setup(setup_of(nine, -1), SKINSLIDE_BAD_ARGUMENT, "patch all: no array of faces");
    expect_setup(setup_of(NULL, 3), SKINSLIDE_BAD_ARGUMENT, "patch all: no array of faces");
    expect_setup(setup_of((int32_t[]){0, 9}, 2), SKINSLIDE_BAD_PATCH, "patch all: face 9 is not one of the mesh's 9");
    expect_setup(setup_of((int32_t[]){0, -1}, 2), SKINSLIDE_BAD_PATCH, "patch all: face -1 is not one of the mesh's 9");
    expect_setup(setup_of((int32_t[]){4, 0, 4}, 3), SKINSLIDE_BAD_PATCH, "patch all: face 4 is listed more than once");
    skinslide_patch_setup unnamed = setup_of(nine, 0);
    unnamed.name = NULL;
    expect_setup(unnamed, SKINSLIDE_BAD_PATCH, "patch : it has no faces");
}

/* Where a set-up falls into pieces, the piece is named. */
static void bad_pieces(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 3),
              closed = copy_mesh(4, 4, (int32_t[]){3, 3, 3, 3}, (int32_t[]){0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3},
                                 (float[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    test_mesh mesh = join_meshes(&grid, &closed);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, 13);
    skinslide_mesh view = view_of(&mesh);
    expect_setups(&view, &setup, 1, SKINSLIDE_BAD_PATCH,
                  "patch all (piece 2 of 2): the patch is closed; rules unit and fast need a boundary to hold on to, relaxed "
                  "and even do not");
    free(faces);
    free_mesh(&grid), free_mesh(&closed), free_mesh(&mesh);
}

static void bad_choices(void **state) {
    (void)state;
    const char *text = "patch all: no such boundary, holes, rule or interpolation";
    skinslide_patch_setup setup = setup_of(nine, 9);
    setup.boundary = (skinslide_boundary)3;
    expect_setup(setup, SKINSLIDE_BAD_ARGUMENT, text);
    setup = setup_of(nine, 9), setup.holes = (skinslide_holes)-1;
    expect_setup(setup, SKINSLIDE_BAD_ARGUMENT, text);
    setup = setup_of(nine, 9), setup.rule = (skinslide_rule)4;
    expect_setup(setup, SKINSLIDE_BAD_ARGUMENT, text);
    setup = setup_of(nine, 9), setup.interpolation = (skinslide_interpolation)4;
    expect_setup(setup, SKINSLIDE_BAD_ARGUMENT, text);
    setup.interpolation = SKINSLIDE_INTERPOLATION_LIMIT;
    expect_setup(setup, SKINSLIDE_BAD_CONTROL, "patch all: interpolation limit needs a mesh that is subdivided");
}

/* ---- Controls: refused alike in a set-up and in a frame ---- */

static void expect_controls(skinslide_controls controls, skinslide_status expected, const char *text) {
    test_mesh mesh = quad_grid(3, 3);
    skinslide_patch_setup setup = setup_of(nine, 9);
    rig r = rig_of_setups(&mesh, &setup, 1);
    setup.controls = &controls;
    skinslide_mesh view = view_of(&mesh);
    expect_setups(&view, &setup, 1, expected, text);
    float slid[48], before[48];
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT, result_before = SKINSLIDE_PATCH_RESULT_DEFAULT;
    skinslide_error error;
    memset(slid, 0x55, sizeof slid), memset(&result, 0x55, sizeof result);
    result.size = sizeof result;
    memcpy(before, slid, sizeof slid), memcpy(&result_before, &result, sizeof result);
    skinslide_status status = skinslide_slide(r.workspace, mesh.points, &controls, slid, &result, &error);
    assert_fails(status, &error, expected, text);
    assert_same_bytes(slid, before, sizeof slid);
    assert_same_bytes(&result, &result_before, sizeof result);
    free_rig(&r);
    free_mesh(&mesh);
}

static const skinslide_controls unpainted = SKINSLIDE_CONTROLS_DEFAULT;

static void fill(float *values, int count, int at, float value) {
    for (int i = 0; i < count; i++)
        values[i] = i == at ? value : 1;
}

static void bad_densities(void **state) {
    (void)state;
    float values[16];
    skinslide_controls controls = unpainted;
    static const struct {
        float value;
        const char *vertex, *face, *edge;
    } bad[] = {{0, "patch all: force density of vertex 5 is 0; it must be finite and > 0",
                "patch all: force density of face 5 is 0; it must be finite and > 0",
                "patch all: force density of edge 5-6 is 0; it must be finite and > 0"},
               {-2, "patch all: force density of vertex 5 is -2; it must be finite and > 0",
                "patch all: force density of face 5 is -2; it must be finite and > 0",
                "patch all: force density of edge 5-6 is -2; it must be finite and > 0"},
               {INFINITY, "patch all: force density of vertex 5 is inf; it must be finite and > 0",
                "patch all: force density of face 5 is inf; it must be finite and > 0",
                "patch all: force density of edge 5-6 is inf; it must be finite and > 0"},
               {NAN, "patch all: force density of vertex 5 is ...", "patch all: force density of face 5 is ...",
                "patch all: force density of edge 5-6 is ..."}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fill(values, 16, 5, bad[i].value);
        controls = unpainted, controls.vertex_density = values;
        expect_controls(controls, SKINSLIDE_BAD_CONTROL, bad[i].vertex);
        controls = unpainted, controls.face_density = values;
        expect_controls(controls, SKINSLIDE_BAD_CONTROL, bad[i].face);
        controls = unpainted, controls.edges = (int32_t[]){5, 6}, controls.edge_density = values + 5, controls.edge_count = 1;
        expect_controls(controls, SKINSLIDE_BAD_CONTROL, bad[i].edge);
    }
}

static void bad_edges(void **state) {
    (void)state;
    const float two[2] = {2, 2};
    skinslide_controls controls = unpainted;
    controls.edge_density = two, controls.edge_count = 1, controls.edges = (int32_t[]){5, 10};
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: 5-10 is not an edge of the patch");
    controls.edges = (int32_t[]){5, 99};
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: 5-99 is not an edge of the patch");
    controls.edges = (int32_t[]){-1, 5};
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: -1-5 is not an edge of the patch");
    controls.edges = (int32_t[]){5, 5};
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: 5-5 is not an edge of the patch");
    controls.edges = (int32_t[]){5, 6, 6, 5}, controls.edge_count = 2;
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: edge 5-6 is listed more than once");
    const char *text = "patch all: edges without force densities, or the reverse";
    controls.edge_density = NULL;
    expect_controls(controls, SKINSLIDE_BAD_ARGUMENT, text);
    controls.edge_density = two, controls.edges = NULL;
    expect_controls(controls, SKINSLIDE_BAD_ARGUMENT, text);
    controls.edge_count = -1;
    expect_controls(controls, SKINSLIDE_BAD_ARGUMENT, text);
}

static void bad_weights(void **state) {
    (void)state;
    float values[16];
    skinslide_controls controls = unpainted;
    fill(values, 16, 7, NAN);
    controls.weight = values;
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: weight of vertex 7 is not a number");
    controls = unpainted, controls.envelope = NAN;
    expect_controls(controls, SKINSLIDE_BAD_CONTROL, "patch all: envelope is not a number");
}

/* The middle four vertices hold each other 1e70 times as hard as anything holds them: they are as good as one vertex, in the
 * middle of the circle. What is left of one rounding a step, in units of 1. */
static void densities_of_any_size_are_solved(void **state) {
    (void)state;
    float values[16];
    for (int v = 0; v < 16; v++)
        values[v] = v % 4 == 0 || v % 4 == 3 || v / 4 == 0 || v / 4 == 3 ? 1e-30f : 1e38f;
    const float small[8] = {1e-37f, 1e-37f, 1e-37f, 1e-37f, 1e-37f, 1e-37f, 1e-37f, 1e-37f};
    test_mesh mesh = quad_grid(3, 3);
    skinslide_patch_setup setup = setup_of(NULL, 0);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.vertex_density = values;
    controls.edges = (int32_t[]){1, 5, 2, 6, 4, 5, 6, 7, 8, 9, 10, 11, 9, 13, 10, 14};
    controls.edge_density = small, controls.edge_count = 8;
    setup.controls = &controls;
    rig r = rig_of(&mesh, setup);
    double uv[16][2];
    skinslide_error error;
    assert_ok(skinslide_slider_embedding(r.slider, 0, uv[0], &error), &error);
    const int middle[4] = {5, 6, 9, 10};
    for (int k = 0; k < 4; k++)
        for (int axis = 0; axis < 2; axis++)
            assert_near(uv[middle[k]][axis], 0.5, 16 * DBL_EPSILON);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- Corners of set-ups in pieces ---- */

/* Two sheets that share vertex 15, a corner of the first: 3 x 3 vertices 0..15, and the same again from there. */
static test_mesh two_sheets(void) {
    test_mesh a = quad_grid(3, 3), b = quad_grid(3, 3), mesh = join_meshes(&a, &b);
    for (int32_t c = 0; c < mesh.index_count; c++)
        mesh.face_indices[c] = mesh.face_indices[c] == 16 ? 15 : mesh.face_indices[c];
    for (int32_t v = 16; v < 32; v++)
        mesh.points[3 * v] += 3, mesh.points[3 * v + 1] += 3;
    free_mesh(&a), free_mesh(&b);
    return mesh;
}

static void corners_count_for_the_piece_that_has_them(void **state) {
    (void)state;
    test_mesh mesh = two_sheets();
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, 18);
    setup.corners = (int32_t[]){0, 3, 15, 12};
    rig r = rig_of_setups(&mesh, &setup, 1);
    double uv[16][2];
    skinslide_error error;
    assert_ok(skinslide_slider_embedding(r.slider, 0, &uv[0][0], &error), &error);
    assert_true(uv[0][0] == 0 && uv[0][1] == 0 && uv[15][0] == 1 && uv[15][1] == 1);
    assert_ok(skinslide_slider_embedding(r.slider, 1, &uv[0][0], &error), &error);
    assert_true(uv[0][0] == 1 && uv[0][1] == 0.5); /* on the circle */
    free_rig(&r);
    skinslide_mesh view = view_of(&mesh);
    setup.corners = (int32_t[]){0, 3, 15, 31};
    expect_setups(&view, &setup, 1, SKINSLIDE_BAD_CONTROL,
                  "patch all: corners 0, 3, 15 and 31 are not all on one of its pieces");
    setup.corners = (int32_t[]){0, 3, 5, 12};
    expect_setups(&view, &setup, 1, SKINSLIDE_BAD_CONTROL, "patch all (piece 1 of 2): corner 5 is not on its outer boundary");
    free(faces);
    free_mesh(&mesh);
}

/* ---- Workspaces and frames ---- */

static void bad_workspaces(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    skinslide_workspace *const untouched = (skinslide_workspace *)&mesh, *workspace = untouched;
    skinslide_error error;
    skinslide_workspace_options options = {sizeof(skinslide_workspace_options), (skinslide_lookup)3, SKINSLIDE_ANY_DEVICE, 0};
    assert_fails(skinslide_workspace_create(r.slider, &options, &workspace, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no such lookup: 3");
    assert_fails(skinslide_workspace_create(NULL, NULL, &workspace, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no slider, or no place for the workspace");
    assert_ptr_equal(workspace, untouched);
    skinslide_workspace_destroy(NULL);
    skinslide_slider_destroy(NULL);
    free_rig(&r);
    free_mesh(&mesh);
}

static void bad_frames(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    float *points = copy_points(&mesh), slid[48], before[48];
    skinslide_error error;
    memset(slid, 0x55, sizeof slid), memcpy(before, slid, sizeof slid);
    points[3 * 10 + 1] = -INFINITY;
    assert_fails(skinslide_slide(r.workspace, points, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 10 is not finite: (2, -inf, 0)");
    const char *text = "no workspace, points, or place for the slid points";
    assert_fails(skinslide_slide(NULL, points, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_slide(r.workspace, NULL, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_slide(r.workspace, points, NULL, NULL, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_same_bytes(slid, before, sizeof slid);
    free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patches_are_numbered_setup_by_setup),
        cmocka_unit_test(copies_are_of_the_patch),
        cmocka_unit_test(patches_that_are_not_there),
        cmocka_unit_test(statuses_have_names),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(bad_faces),
        cmocka_unit_test(bad_pieces),
        cmocka_unit_test(bad_choices),
        cmocka_unit_test(bad_densities),
        cmocka_unit_test(bad_edges),
        cmocka_unit_test(bad_weights),
        cmocka_unit_test(densities_of_any_size_are_solved),
        cmocka_unit_test(corners_count_for_the_piece_that_has_them),
        cmocka_unit_test(bad_workspaces),
        cmocka_unit_test(bad_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
