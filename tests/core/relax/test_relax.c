/* The relaxed rule, and the largest distances of every rule. */
#include "distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float FLOAT_EPSILON = 0x1p-23f;

static skinslide_patch_setup relaxed(void) {
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.rule = SKINSLIDE_RULE_RELAXED;
    return choices;
}

static double distance(const float *a, const float *b) {
    double x = (double)a[0] - b[0], y = (double)a[1] - b[1], z = (double)a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* ---- The solver ---- */

static void fill_blocks(ss_blocks *blocks, const ss_patch *patch, dice *d) {
    ss_blocks_clear(blocks);
    for (int32_t i = 0; i < patch->free_count; i++) {
        double *own = ss_blocks_own(blocks, i);
        own[0] = 20 + roll_share(d), own[3] = 20 + roll_share(d), own[1] = own[2] = roll_share(d);
        blocks->right[i][0] = roll_share(d), blocks->right[i][1] = roll_share(d);
    }
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        bool first_is_row;
        if (patch->fixed[patch->edge_vertex[e][0]] || patch->fixed[patch->edge_vertex[e][1]])
            continue;
        double *between = ss_blocks_between(blocks, e, &first_is_row);
        for (int k = 0; k < 4; k++)
            between[k] = roll_between(d, -1, 1);
    }
}

/* residual -= A x, A the filled blocks. */
static void take_product(ss_blocks *blocks, const ss_patch *patch, const double (*x)[2], double (*residual)[2]) {
    for (int32_t i = 0; i < patch->free_count; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++)
                residual[i][j] -= ss_blocks_own(blocks, i)[2 * j + k] * x[i][k];
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        int32_t a = ss_blocks_unknown(blocks, patch->edge_vertex[e][0]),
                b = ss_blocks_unknown(blocks, patch->edge_vertex[e][1]);
        bool first_is_row;
        if (a < 0 || b < 0)
            continue;
        const double *between = ss_blocks_between(blocks, e, &first_is_row);
        int32_t row = first_is_row ? a : b, column = first_is_row ? b : a;
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++) {
                residual[row][j] -= between[2 * j + k] * x[column][k];
                residual[column][k] -= between[2 * j + k] * x[row][j];
            }
    }
}

/* Rows of twenty on the diagonal and at most sixteen ones beside it: well conditioned, so a residual of rounding. */
static void blocks_are_solved(void **state) {
    (void)state;
    const int going_on = 0, stop = 1;
    test_mesh mesh = triangle_grid(9, 7);
    ss_patch *patch = patch_of(&mesh, relaxed());
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_error error;
    ss_system *system;
    ss_blocks *blocks;
    assert_ok(ss_system_create(&net, "grid", &system, &error), &error);
    assert_ok(ss_blocks_create(system, &blocks, &error), &error);
    size_t bytes = (size_t)patch->free_count * sizeof(double[2]);
    double(*x)[2] = malloc(bytes);
    for (uint64_t seed = 0; seed < 2; seed++) { /* the second on what the first left */
        dice d = {seed}, again = {seed};
        fill_blocks(blocks, patch, &d);
        assert_true(ss_blocks_factor(blocks, &going_on));
        ss_blocks_solve(blocks);
        memcpy(x, blocks->right, bytes);
        fill_blocks(blocks, patch, &again); /* the factor is where the matrix was */
        take_product(blocks, patch, (const double(*)[2])x, blocks->right);
        for (int32_t i = 0; i < patch->free_count; i++)
            assert_near(fabs(blocks->right[i][0]) + fabs(blocks->right[i][1]), 0, 1e-14);
    }
    assert_false(ss_blocks_factor(blocks, &stop));
    ss_blocks_own(blocks, 3)[0] = -1;
    assert_false(ss_blocks_factor(blocks, &going_on));
    free(x);
    ss_blocks_destroy(blocks);
    ss_system_destroy(system);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* ---- The chart ---- */

/* A pose that is a linear map of the chart has that map for its gradient everywhere: shares sum to 1. */
static void gradients_of_a_linear_map(void **state) {
    (void)state;
    static const double map[2][3] = {{2, -1, 0.5}, {0.25, 3, -4}};
    test_mesh mesh = grid_with_holes(false);
    ss_patch *patch = patch_of(&mesh, relaxed());
    ss_chart *chart = NULL;
    skinslide_error error;
    assert_ok(ss_chart_create(patch, mesh.points, &chart, &error), &error);
    int32_t count = patch->vertex_count;
    double(*points)[3] = malloc((size_t)count * sizeof *points), (*gradient)[2][3] = malloc((size_t)count * sizeof *gradient);
    for (int32_t v = 0; v < count; v++)
        for (int k = 0; k < 3; k++)
            points[v][k] = chart->uv[v][0] * map[0][k] + chart->uv[v][1] * map[1][k];
    ss_chart_gradient(chart, (const double(*)[3])points, gradient);
    for (int32_t v = 0; v < count; v++)
        for (int i = 0; i < 6; i++)
            assert_near(gradient[v][i / 3][i % 3], map[i / 3][i % 3], 1e-12);
    free(points), free(gradient);
    ss_chart_destroy(chart);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* ---- The answer ---- */

/* Four quads whose right column is three wide. The middle vertex slides along its row, to x, between 0 and 4; all four of its
 * edges are 1 at rest: the lowest E is that of a search over x, a third of which is seen in the chart. What a thousandth of E
 * can change leaves x open to about its root, 0.03. */
static double energy_of_row(double x) {
    double up = sqrt(1 + (x - 1) * (x - 1)), hold = 4 * 0.003 * (x - 1) * (x - 1) / 9;
    return log(x) * log(x) + log(4 - x) * log(4 - x) + 2 * log(up) * log(up) + hold;
}

static void a_slide_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    float *points = copy_points(&mesh);
    double best = 1;
    for (double x = 1; x < 3; x += 1e-4)
        best = energy_of_row(x) < energy_of_row(best) ? x : best;
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v] = v % 3 == 2 ? 4 : (float)(v % 3);
    rig r = rig_of(&mesh, relaxed());
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(&r, &mesh, points, NULL, &result);
    assert_near(slid[3 * 4], best, 0.03);
    assert_near(slid[3 * 4 + 1], 1, 0.03); /* the fans of the faces are not symmetric */
    assert_true(result.relax_steps > 0 && result.folded_faces == 0);
    free(points), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

/* Never above the paper's rule on a bump, and on the surface to the rounding of points to float. */
static void stretch_is_less_than_by_force_density(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        test_mesh mesh = triangles ? triangle_grid(20, 20) : quad_grid(20, 20);
        float *points = bumped(&mesh, 9, 11, 4, 5);
        rig relax = rig_of(&mesh, relaxed()), unit = rig_of(&mesh, setup_of(NULL, 0));
        skinslide_patch_result relax_result = SKINSLIDE_PATCH_RESULT_DEFAULT, unit_result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&relax, &mesh, points, NULL, &relax_result);
        free(slide_with(&unit, &mesh, points, NULL, &unit_result));
        assert_true(relax_result.stretch_after < 0.99 * unit_result.stretch_after);
        assert_int_equal(relax_result.folded_faces, 0);
        double size = extent_of(points, mesh.vertex_count);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            assert_near(distance_to_mesh(&mesh, points, slid + 3 * v), 0, FLOAT_EPSILON * size);
        free(points), free(slid);
        free_rig(&relax), free_rig(&unit);
        free_mesh(&mesh);
    }
}

/* On every fixture, in poses that shear, bump and shake it: on the surface whatever the weights, nothing folded without. */
static void slides_stay_on_the_surface(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        skinslide_patch_setup choices = relaxed();
        choices.holes = (skinslide_holes)(i % 2);
        rig r = rig_of(&f.mesh, choices);
        painted paint = paint_at_random(&f.mesh, 3);
        for (uint64_t seed = 0; seed < 4; seed++) {
            float *points = random_pose(&f.mesh, seed);
            skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
            float *slid = slide_with(&r, &f.mesh, points, seed % 2 ? &paint.controls : NULL, &result);
            double size = extent_of(points, f.mesh.vertex_count);
            for (int32_t c = 0; c < f.mesh.index_count; c++)
                assert_near(distance_to_mesh(&f.mesh, points, slid + 3 * f.mesh.face_indices[c]), 0, 2 * FLOAT_EPSILON * size);
            assert_true(seed % 2 || result.folded_faces == 0);
            free(points), free(slid);
        }
        free_painted(&paint);
        free_rig(&r);
        free_mesh(&f.mesh);
    }
}

/* ---- In time ---- */

static double second_difference(float *const frames[3], int32_t vertex) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double a = frames[0][3 * vertex + k], b = frames[1][3 * vertex + k], c = frames[2][3 * vertex + k];
        square += (a - 2 * b + c) * (a - 2 * b + c);
    }
    return sqrt(square);
}

static double largest_second_difference(float *const frames[3], int32_t vertex_count) {
    double largest = 0;
    for (int32_t v = 0; v < vertex_count; v++)
        largest = fmax(largest, second_difference(frames, v));
    return largest;
}

/* A bump that wanders over a sheet, in 60 steps of a fifth of a face: in no frame does a slid vertex speed up more than twice
 * as fast as some vertex of the cache. */
static void slides_are_smooth_in_time(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(24, 24);
    rig r = rig_of(&mesh, relaxed());
    float *cache[3] = {0}, *slid[3] = {0};
    for (int frame = 0; frame < 60; frame++) {
        free(cache[0]), free(slid[0]);
        cache[0] = cache[1], cache[1] = cache[2], slid[0] = slid[1], slid[1] = slid[2];
        cache[2] = bumped(&mesh, 6 + 0.2 * frame, 12, 5, 5);
        slid[2] = slide_with(&r, &mesh, cache[2], NULL, NULL);
        if (frame >= 2)
            assert_true(largest_second_difference(slid, mesh.vertex_count) <=
                        2 * largest_second_difference(cache, mesh.vertex_count));
    }
    for (int k = 0; k < 3; k++)
        free(cache[k]), free(slid[k]);
    free_rig(&r);
    free_mesh(&mesh);
}

/* A limb that flexes: skin a face and a half above a joint at x = 6, the side beyond it turned upwards, blended over three
 * columns. It crumples in the crook; a muscle swells beside it. */
static float *flexed(const test_mesh *mesh, double angle) {
    float *points = bumped(mesh, 3, 6, 3, angle);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double share = fmin(1, fmax(0, (points[3 * v] - 4.5) / 3)), x = points[3 * v] - 6, z = points[3 * v + 2] + 1.5;
        share *= share * (3 - 2 * share);
        points[3 * v] += (float)(share * (cos(angle) * x - sin(angle) * z - x));
        points[3 * v + 2] += (float)(share * (sin(angle) * x + cos(angle) * z - z));
    }
    return points;
}

/* Of the motion between two angles in so many steps. */
static double roughest_slide(const rig *r, const test_mesh *mesh, double from, double to, int steps) {
    float *slid[3] = {0};
    double roughest = 0;
    for (int i = 0; i <= steps; i++) {
        float *points = flexed(mesh, from + (to - from) * i / steps);
        free(slid[0]);
        slid[0] = slid[1], slid[1] = slid[2];
        slid[2] = slide_with(r, mesh, points, NULL, NULL);
        roughest = i >= 2 ? fmax(roughest, largest_second_difference(slid, mesh->vertex_count)) : 0;
        free(points);
    }
    for (int k = 0; k < 3; k++)
        free(slid[k]);
    return roughest;
}

/* Steps four times as short make second differences of a motion that jumps no smaller, of one that turns sharply four times, as
 * it does where a vertex comes over an edge between faces, of a smooth one sixteen times. Beyond 80 degrees the crook of this
 * limb is one crease, which the skin leaves to either side. */
static void no_slide_jumps(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(12, 12);
    rig r = rig_of(&mesh, relaxed());
    for (int i = 1; i < 7; i++) {
        double coarse = roughest_slide(&r, &mesh, 0.2 * i, 0.2 * (i + 1), 10);
        double fine = roughest_slide(&r, &mesh, 0.2 * i, 0.2 * (i + 1), 40);
        assert_true(fine < coarse / 1.5);
    }
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- How far ---- */

/* In a plane the way is nearly straight, a little bent from triangle to triangle, so half of it is half the distance to a
 * thousandth. */
static void half_a_slide_is_half_as_long(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(10, 10);
    float *points = copy_points(&mesh);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v] += 0.15f * points[3 * v] * (10 - points[3 * v]) * 0.4f;
    rig r = rig_of(&mesh, relaxed());
    skinslide_controls half = SKINSLIDE_CONTROLS_DEFAULT;
    half.envelope = 0.5f;
    float *whole = slide_with(&r, &mesh, points, NULL, NULL), *slid = slide_with(&r, &mesh, points, &half, NULL);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        assert_near(distance(slid + 3 * v, points + 3 * v), 0.5 * distance(whole + 3 * v, points + 3 * v), 1e-3);
    free(points), free(whole), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

/* By every rule: none goes farther, one that did not want to keeps its bits, and none at all where the limit is zero. The chord
 * is no longer than the way, and 1e-6 is rounding. */
static void largest_distances_are_kept(void **state) {
    (void)state;
    test_mesh mesh = grid_with_holes(false);
    float *points = bumped(&mesh, 4, 6, 3, 3), *limit = calloc((size_t)mesh.vertex_count, sizeof *limit);
    for (int32_t rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_RELAXED; rule++)
        for (int32_t holes = SKINSLIDE_HOLES_PINNED; holes <= SKINSLIDE_HOLES_FREE; holes++) {
            skinslide_patch_setup choices = setup_of(NULL, 0);
            choices.rule = (skinslide_rule)rule, choices.holes = (skinslide_holes)holes;
            rig r = rig_of(&mesh, choices);
            skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
            controls.max_distance = limit;
            float *whole = slide_with(&r, &mesh, points, NULL, NULL);
            for (int32_t v = 0; v < mesh.vertex_count; v++)
                limit[v] = v % 3 ? 0.1f * (float)(v % 3) : INFINITY;
            float *slid = slide_with(&r, &mesh, points, &controls, NULL);
            int32_t cut = 0;
            for (int32_t v = 0; v < mesh.vertex_count; v++) {
                assert_true(distance(slid + 3 * v, points + 3 * v) <= (double)limit[v] + 1e-6);
                if (isinf(limit[v]))
                    assert_same_bytes(slid + 3 * v, whole + 3 * v, sizeof(float[3]));
                cut += memcmp(slid + 3 * v, whole + 3 * v, sizeof(float[3])) != 0;
            }
            assert_true(cut > 5);
            free(slid);
            memset(limit, 0, (size_t)mesh.vertex_count * sizeof *limit);
            slid = slide_with(&r, &mesh, points, &controls, NULL);
            assert_same_bytes(slid, points, POINT_BYTES(&mesh));
            free(slid), free(whole);
            free_rig(&r);
        }
    free(points), free(limit);
    free_mesh(&mesh);
}

static void largest_distances_are_checked(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    float limit[9] = {1, 1, 1, 1, -0.5f, 1, 1, 1, 1};
    rig r = rig_of(&mesh, relaxed());
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.max_distance = limit;
    skinslide_error error;
    float out[27];
    skinslide_status status = skinslide_slide(r.workspace, mesh.points, &controls, out, NULL, &error);
    assert_fails(status, &error, SKINSLIDE_BAD_CONTROL, "patch all: largest distance of vertex 4 is -0.5; it must be >= 0");
    limit[4] = NAN;
    status = skinslide_slide(r.workspace, mesh.points, &controls, out, NULL, &error);
    assert_fails(status, &error, SKINSLIDE_BAD_CONTROL, "patch all: largest distance of vertex 4 is ...");
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- Loops ---- */

/* A vertex of a free loop ends on a side of that loop, one of a pinned loop where it was. */
static void free_loops_slide_along_themselves(void **state) {
    (void)state;
    test_mesh mesh = annulus(12, 4);
    float *points = bumped(&mesh, 1, 0, 1, 1);
    skinslide_patch_setup choices = relaxed();
    choices.holes = SKINSLIDE_HOLES_FREE;
    rig r = rig_of(&mesh, choices);
    const ss_patch *patch = r.slider->parts[0].patch;
    float *slid = slide_with(&r, &mesh, points, NULL, NULL);
    int32_t moved = 0;
    for (int32_t i = patch->loop_start[1]; i < patch->loop_start[2]; i++) {
        const float *p = slid + 3 * patch->mesh_vertex[patch->loop_vertex[i]];
        double here[3] = {p[0], p[1], p[2]}, nearest = INFINITY;
        for (int32_t k = patch->loop_start[1]; k < patch->loop_start[2]; k++) {
            int32_t next = k + 1 < patch->loop_start[2] ? k + 1 : patch->loop_start[1];
            const float *a = points + 3 * patch->mesh_vertex[patch->loop_vertex[k]];
            const float *b = points + 3 * patch->mesh_vertex[patch->loop_vertex[next]];
            nearest = fmin(nearest, distance_to_triangle(here, a, b, b));
        }
        assert_near(nearest, 0, 1e-6);
        moved += distance(p, points + 3 * patch->mesh_vertex[patch->loop_vertex[i]]) > 1e-3;
    }
    assert_true(moved > 3);
    free(points), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_solved),
        cmocka_unit_test(gradients_of_a_linear_map),
        cmocka_unit_test(a_slide_by_hand),
        cmocka_unit_test(stretch_is_less_than_by_force_density),
        cmocka_unit_test(slides_stay_on_the_surface),
        cmocka_unit_test(slides_are_smooth_in_time),
        cmocka_unit_test(no_slide_jumps),
        cmocka_unit_test(half_a_slide_is_half_as_long),
        cmocka_unit_test(largest_distances_are_kept),
        cmocka_unit_test(largest_distances_are_checked),
        cmocka_unit_test(free_loops_slide_along_themselves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
