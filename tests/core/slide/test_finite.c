/* Finite in, finite out: what floats cannot hold fails by name, and nothing is written. Points are at the ends of float's
 * range. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Frames ---- */

/* Some vertices, or all, at the ends of the range, which is further than any two of them may be apart. */
static float *far_pose(const test_mesh *mesh, uint64_t seed) {
    dice d = {seed};
    float *points = random_pose(mesh, seed);
    int32_t share = 1 + roll_below(&d, 4);
    for (int32_t k = 0; k < 3 * mesh->vertex_count; k++)
        if (roll_below(&d, share) == 0)
            points[k] = roll_below(&d, 2) ? FLT_MAX : -FLT_MAX;
    return points;
}

static bool slide_far(const rig *r, const test_mesh *mesh, uint64_t seed) {
    float *points = far_pose(mesh, seed), *slid = malloc(POINT_BYTES(mesh));
    memset(slid, 1, POINT_BYTES(mesh));
    skinslide_error error;
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    skinslide_status status = skinslide_slide(r->workspace, points, NULL, slid, &result, &error);
    if (status) {
        assert_fails(status, &error, status == SKINSLIDE_SINGULAR ? SKINSLIDE_SINGULAR : SKINSLIDE_BAD_POINTS, "patch all...");
        for (size_t i = 0; i < POINT_BYTES(mesh); i++)
            assert_int_equal(((const char *)slid)[i], 1);
    } else {
        assert_true(all_finite(slid, 3 * (int64_t)mesh->vertex_count));
        assert_true(isfinite(result.largest_slide) && isfinite(result.stretch_before) && isfinite(result.stretch_after));
    }
    free(points), free(slid);
    return status != SKINSLIDE_OK;
}

static int slide_far_with(const test_mesh *mesh, skinslide_patch_setup choices, const skinslide_subdivision *subdivision) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    rig r = {0};
    skinslide_error error;
    int refused = 0;
    view.subdivision = subdivision, choices.faces = faces, choices.face_count = mesh->face_count;
    assert_ok(skinslide_slider_create(&view, &choices, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    for (uint64_t seed = 0; seed < 4; seed++)
        refused += slide_far(&r, mesh, seed);
    free_rig(&r);
    free(faces);
    return refused;
}

/* Every rule and interpolation: a slide that floats hold, or a patch that is named. */
static void frames_far_away_are_finite_or_fail(void **state) {
    (void)state;
    skinslide_subdivision smooth = SKINSLIDE_SUBDIVISION_DEFAULT;
    smooth.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    int refused = 0, limit_refused = 0;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        for (int32_t way = 0; way < WAY_COUNT; way++) {
            skinslide_patch_setup choices;
            if (!choose_way(&f, way, &choices))
                continue;
            refused += slide_far_with(&f.mesh, choices, NULL);
            choices.interpolation = SKINSLIDE_INTERPOLATION_LIMIT;
            if (!(way & 4))
                limit_refused += slide_far_with(&f.mesh, choices, &smooth);
        }
        free_mesh(&f.mesh);
    }
    print_message("%d frames refused, and %d of the limit surface\n", refused, limit_refused);
    assert_true(limit_refused > 0);
}

/* Some vertices of a grid are at one end of the range and some at the other: limit overshoots. */
static void the_vertex_is_named(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    skinslide_subdivision smooth = SKINSLIDE_SUBDIVISION_DEFAULT;
    smooth.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    skinslide_mesh view = view_of(&mesh);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
    view.subdivision = &smooth;
    rig r = {0};
    skinslide_error error;
    assert_ok(skinslide_slider_create(&view, &setup, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    float *points = far_pose(&mesh, 1), *slid = malloc(POINT_BYTES(&mesh));
    assert_fails(skinslide_slide(r.workspace, points, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_POINTS,
                 "patch all: vertex ...");
    assert_non_null(strstr(error.message, " slides to where it is not finite: ("));
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    assert_ok(skinslide_slide(r.workspace, mesh.points, NULL, slid, &result, &error), &error);
    assert_same_bytes(slid, mesh.points, POINT_BYTES(&mesh));
    free(points), free(slid), free(faces);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- What comes of frames ---- */

/* Places of the limit surface lie between points. */
static void limit_points_far_away_are_finite(void **state) {
    (void)state;
    skinslide_subdivision smooth = SKINSLIDE_SUBDIVISION_DEFAULT;
    smooth.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        skinslide_mesh view = view_of(&f.mesh);
        view.subdivision = &smooth;
        for (uint64_t seed = 0; seed < 4; seed++) {
            float *points = far_pose(&f.mesh, seed), out[300][3];
            skinslide_limit_place places[300];
            dice d = {seed};
            for (int32_t k = 0; k < 300; k++)
                places[k] =
                    (skinslide_limit_place){roll_below(&d, f.mesh.index_count), (float)roll_share(&d), (float)roll_share(&d)};
            skinslide_error error;
            assert_ok(skinslide_limit_points(&view, points, places, 300, out[0], &error), &error);
            assert_true(all_finite(out[0], 900));
            free(points);
        }
        free_mesh(&f.mesh);
    }
}

/* Vertex 1 would be faster than a float can say; vertex 0 is not written either. */
static void rates_are_finite_or_fail(void **state) {
    (void)state;
    float still[6] = {0}, moved[6] = {1, 1, 1, FLT_MAX, 0, 0}, away[6] = {2, 2, 2, -FLT_MAX, 0, 0};
    float rates[6] = {1, 2, 3, 4, 5, 6}, before[6];
    memcpy(before, rates, sizeof rates);
    skinslide_sample samples[3] = {
        {sizeof *samples, 0, still, still}, {sizeof *samples, 0.5, still, moved}, {sizeof *samples, 1, still, away}};
    skinslide_error error;
    assert_fails(skinslide_velocities(2, samples, rates, &error), &error, SKINSLIDE_BAD_POINTS,
                 "velocities: vertex 1 is not finite: inf");
    assert_fails(skinslide_accelerations(2, samples, rates, &error), &error, SKINSLIDE_BAD_POINTS,
                 "accelerations: vertex 1 is not finite: -inf");
    assert_same_bytes(rates, before, sizeof rates);
}

/* A slide from one end of the range to the other is longer than a float can say. */
static void diagnostics_are_finite_or_fail(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    float *cached = copy_points(&mesh), *slid = copy_points(&mesh), slide[9] = {7}, density[9] = {7};
    cached[12] = FLT_MAX, slid[12] = -FLT_MAX;
    skinslide_diagnostics wanted = {.size = sizeof(skinslide_diagnostics), .slide = slide, .force_density = density};
    skinslide_error error;
    assert_fails(skinslide_diagnose(r.slider, NULL, NULL, cached, slid, &wanted, &error), &error, SKINSLIDE_BAD_POINTS,
                 "slide: vertex 4 is not finite: inf");
    assert_true(slide[0] == 7 && density[0] == 7);
    const int32_t edges[2] = {1, 4};
    const float factor = FLT_MAX;
    float paint[9] = {1, FLT_MAX, 1, 1, FLT_MAX, 1, 1, 1, 1};
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.vertex_density = paint, controls.edges = edges, controls.edge_density = &factor, controls.edge_count = 1;
    wanted.slide = NULL;
    assert_fails(skinslide_diagnose(r.slider, &controls, NULL, cached, cached, &wanted, &error), &error, SKINSLIDE_BAD_CONTROL,
                 "force density: vertex 1 is not finite: inf");
    free(cached), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- Points that no slide reads ---- */

/* The middle of a grid of 9 x 9 quads, and the points of it beyond the faces around that. */
enum { SIDE = 9, FIRST = 3, END = 6, READ = 36 };

static skinslide_slider *slider_of_middle(const test_mesh *mesh, skinslide_interpolation interpolation) {
    int32_t faces[(END - FIRST) * (END - FIRST)], count = 0;
    for (int32_t j = FIRST; j < END; j++)
        for (int32_t i = FIRST; i < END; i++)
            faces[count++] = j * SIDE + i;
    skinslide_subdivision smooth = SKINSLIDE_SUBDIVISION_DEFAULT;
    smooth.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    skinslide_mesh view = view_of(mesh);
    skinslide_patch_setup setup = setup_of(faces, count);
    skinslide_slider *slider;
    skinslide_error error;
    view.subdivision = &smooth, setup.interpolation = interpolation, setup.rule = SKINSLIDE_RULE_EVEN;
    assert_ok(skinslide_slider_create(&view, &setup, 1, &slider, &error), &error);
    return slider;
}

static bool is_read(int32_t vertex) {
    int32_t i = vertex % (SIDE + 1), j = vertex / (SIDE + 1);
    return i >= FIRST - 1 && i <= END + 1 && j >= FIRST - 1 && j <= END + 1;
}

/* All that comes of a frame: points, turns, diagnostics, the least stretch. */
typedef struct outcome {
    float *slid, *turns, *stretch, *slide;
    double least;
} outcome;

static outcome outcome_of(const rig *r, const test_mesh *mesh, const float *points) {
    outcome o = {slide_with(r, mesh, points, NULL, NULL), malloc(POINT_BYTES(mesh)), malloc(POINT_BYTES(mesh)),
                 malloc(POINT_BYTES(mesh)), 0};
    skinslide_error error;
    skinslide_diagnostics wanted = {.size = sizeof wanted, .stretch_after = o.stretch, .slide = o.slide};
    assert_ok(skinslide_workspace_turns(r->workspace, points, o.turns, &error), &error);
    assert_ok(skinslide_diagnose(r->slider, NULL, NULL, points, o.slid, &wanted, &error), &error);
    assert_ok(skinslide_workspace_least_stretch(r->workspace, points, &o.least, &error), &error);
    return o;
}

static void free_outcome(outcome *o) {
    free(o->slid), free(o->turns), free(o->stretch), free(o->slide);
}

/* With faults beyond, everything at the patch is as without, to the bit, and the faults are as they were. */
static void faults_off_the_patch_pass(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(SIDE, SIDE);
    float *clean = random_pose(&mesh, 3), *faulty = copy_points(&mesh);
    for (skinslide_interpolation way = SKINSLIDE_INTERPOLATION_LINEAR; way <= SKINSLIDE_INTERPOLATION_LIMIT; way++) {
        rig r = {slider_of_middle(&mesh, way), NULL};
        skinslide_error error, warning;
        assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
        memcpy(faulty, clean, POINT_BYTES(&mesh));
        int32_t passed;
        assert_ok(skinslide_slider_check_points(r.slider, clean, &passed, &warning, &error), &error);
        assert_int_equal(passed, 0);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            if (!is_read(v))
                faulty[3 * v + v % 3] = v % 2 ? NAN : INFINITY;
        outcome a = outcome_of(&r, &mesh, clean), b = outcome_of(&r, &mesh, faulty);
        assert_same_bytes(a.turns, b.turns, POINT_BYTES(&mesh));
        assert_true(a.least == b.least);
        for (int32_t v = 0; v < mesh.vertex_count; v++) {
            const float *expected = is_read(v) ? a.slid : faulty;
            assert_same_bytes(b.slid + 3 * v, expected + 3 * v, sizeof(float[3]));
            assert_true(a.stretch[v] == b.stretch[v] && a.slide[v] == b.slide[v]);
        }
        assert_ok(skinslide_slider_check_points(r.slider, faulty, &passed, &warning, &error), &error);
        assert_int_equal(passed, mesh.vertex_count - READ);
        const char *says = "64 points that no patch uses are not finite, and stay as they are: vertex 0, the first, at (inf, ";
        assert_memory_equal(warning.message, says, strlen(says));
        free_outcome(&a), free_outcome(&b);
        free_rig(&r);
    }
    free(clean), free(faulty);
    free_mesh(&mesh);
}

/* A point of a face next to the patch fails, since normals of the patch depend on it. */
static void faults_at_the_patch_fail(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(SIDE, SIDE);
    rig r = {slider_of_middle(&mesh, SKINSLIDE_INTERPOLATION_LINEAR), NULL};
    float *points = copy_points(&mesh), *slid = copy_points(&mesh);
    skinslide_error error;
    int32_t passed = 7;
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    points[3 * 22] = NAN;
    assert_true(is_read(22));
    const char *says = "points: vertex 22 is not finite: (nan, 2, 0)";
    assert_fails(skinslide_slide(r.workspace, points, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_POINTS, says);
    assert_fails(skinslide_slider_check_points(r.slider, points, &passed, NULL, &error), &error, SKINSLIDE_BAD_POINTS, says);
    assert_int_equal(passed, 7);
    assert_fails(skinslide_slider_check_points(r.slider, NULL, &passed, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no points");
    points[3 * 22] = 2, points[0] = NAN;
    skinslide_error warning;
    assert_ok(skinslide_slider_check_points(r.slider, points, &passed, &warning, &error), &error);
    assert_string_equal(warning.message,
                        "1 point that no patch uses is not finite, and stays as it is: vertex 0 at (nan, 0, 0)");
    free(points), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_far_away_are_finite_or_fail), cmocka_unit_test(the_vertex_is_named),
        cmocka_unit_test(limit_points_far_away_are_finite),   cmocka_unit_test(rates_are_finite_or_fail),
        cmocka_unit_test(diagnostics_are_finite_or_fail),     cmocka_unit_test(faults_off_the_patch_pass),
        cmocka_unit_test(faults_at_the_patch_fail),
    };
    return cmocka_run_group_tests_name("finite", tests, NULL, NULL);
}
