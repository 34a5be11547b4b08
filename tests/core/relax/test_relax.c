/* The rule `relaxed`, where it promises more than `even`: whose own tests it passes, too. And the largest distances of every
 * rule. */
#include "distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float FLOAT_EPSILON = 0x1p-23f;

static skinslide_patch_setup by_rule(skinslide_rule rule) {
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.rule = rule, choices.interpolation = SKINSLIDE_INTERPOLATION_LINEAR;
    return choices;
}

static skinslide_patch_setup relaxed(void) {
    return by_rule(SKINSLIDE_RULE_RELAXED);
}

static double distance(const float *a, const float *b) {
    double x = (double)a[0] - b[0], y = (double)a[1] - b[1], z = (double)a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* ---- Parts of a step ---- */

/* A sheet whose pose is a linear map of it has that map for its gradient everywhere, and its tangents mapped for axes wherever
 * a vertex is; a vertex of no weight has none. */
static void axes_of_a_linear_map(void **state) {
    (void)state;
    static const double map[3][2] = {{2, 0.25}, {-1, 3}, {0.5, -4}};
    test_mesh mesh = grid_with_holes(true);
    float *points = copy_points(&mesh);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            points[3 * v + k] = (float)(map[k][0] * mesh.points[3 * v] + map[k][1] * mesh.points[3 * v + 1]);
    ss_patch *patch = patch_of(&mesh, relaxed());
    ss_sheet *sheet;
    ss_evener *evener;
    ss_relaxer *relaxer;
    skinslide_error error;
    assert_ok(ss_sheet_create(patch, mesh.points, &sheet, &error), &error);
    ss_room room = {0};
    assert_ok(ss_evener_create(sheet, true, &room, &evener, &error), &error);
    assert_ok(ss_relaxer_create(evener, &room, &relaxer, &error), &error);
    assert_true(ss_make_room(&room));
    ss_relaxer_lay_out(relaxer, &room);
    ss_posed_set(&evener->pose, points);
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        evener->weight[v] = !sheet->held[v];
        evener->place[v] = ss_place_of_vertex(patch, NULL, v);
        if (v % 2) /* anywhere in its triangle */
            ss_place_put(&evener->place[v], evener->place[v].triangle, (double[3]){0.5, 0.2, 0.3});
    }
    ss_find_gradients(relaxer);
    ss_find_axes(relaxer);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int i = 0; i < 6; i++) {
            const double *way = sheet->tangent[v][i / 3];
            double mapped = map[i % 3][0] * way[0] + map[i % 3][1] * way[1];
            assert_near(relaxer->axis[v][i % 3][i / 3], sheet->held[v] ? 0 : mapped, 1e-6); /* points are floats */
        }
    free(points);
    ss_relaxer_destroy(relaxer);
    ss_evener_destroy(evener);
    ss_free(&room.memory);
    ss_sheet_destroy(sheet);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* ---- The answer ---- */

/* Four quads whose right column is three wide: edges that were 1 are 1 and 3 long. The middle vertex slides along its row, to x
 * between 0 and 4; where two of its four edges are compressed their stretch is bounded at a half, and edges shorter than three
 * tenths pull no harder for it. The balance of forces less the hold of a uniform scale: log 1, the median. */
static double pull(double dx, double dy) {
    double square = dx * dx + dy * dy, z = 0.5 * log(square), force = z < 0 ? z / sqrt(1 + 4 * z * z) : z;
    return force * dx / (square + 0.09);
}

static double force_of_row(double x) {
    double d = x < 1 ? x - 1 : (x - 1) / 3; /* in rest, a third of the way in the wide column */
    double slope = x < 1 ? 1 : 3;
    return slope * (pull(x, 0) - pull(4 - x, 0) + pull(x - 1, 1) + pull(x - 1, 1)) + 4 * 0.03 * d;
}

static void a_slide_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    float *points = copy_points(&mesh);
    double least = 1, most = 3;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (least + most);
        *(force_of_row(middle) < 0 ? &least : &most) = middle;
    }
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v] = v % 3 == 2 ? 4 : (float)(v % 3);
    rig r = rig_of(&mesh, relaxed());
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(&r, &mesh, points, NULL, &result);
    assert_near(slid[3 * 4], least, 0.03);
    assert_near(slid[3 * 4 + 1], 1, 0.03); /* the fans of the faces are not symmetric */
    assert_true(result.relax_steps == 3 && result.folded_faces == 0);
    free(points), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

/* On a bump, less stretch is left than by the paper's rule, and than where relaxed starts; skin stays on the surface, up to the
 * rounding of points to float. */
static void stretch_is_less_than_by_other_rules(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        test_mesh mesh = triangles ? triangle_grid(20, 20) : quad_grid(20, 20);
        float *points = bumped(&mesh, 9, 11, 4, 5);
        rig relax = rig_of(&mesh, relaxed());
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&relax, &mesh, points, NULL, &result);
        for (int32_t rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++) {
            rig other = rig_of(&mesh, by_rule((skinslide_rule)rule));
            skinslide_patch_result own = SKINSLIDE_PATCH_RESULT_DEFAULT;
            free(slide_with(&other, &mesh, points, NULL, &own));
            assert_true(rule == SKINSLIDE_RULE_RELAXED || result.stretch_after < 0.99 * own.stretch_after);
            free_rig(&other);
        }
        assert_int_equal(result.folded_faces, 0);
        double size = extent_of(points, mesh.vertex_count);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            assert_near(distance_to_mesh(&mesh, points, slid + 3 * v), 0, FLOAT_EPSILON * size);
        free(points), free(slid);
        free_rig(&relax);
        free_mesh(&mesh);
    }
}

/* A ribbon that nothing holds, drawn out at one end and pressed together at the other: skin must come from far along it. */
static void skin_comes_from_far(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(40, 4);
    float *points = copy_points(&mesh);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v] += 0.0075f * points[3 * v] * (points[3 * v] - 40);
    double left[2];
    for (int i = 0; i < 2; i++) {
        skinslide_patch_setup choices = by_rule(i ? SKINSLIDE_RULE_RELAXED : SKINSLIDE_RULE_EVEN);
        choices.holes = SKINSLIDE_HOLES_FREE_ALL;
        rig r = rig_of(&mesh, choices);
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        free(slide_with(&r, &mesh, points, NULL, &result));
        left[i] = result.stretch_after;
        free_rig(&r);
    }
    assert_true(left[1] < left[0]);
    free(points);
    free_mesh(&mesh);
}

/* On every fixture, in poses that shear, bump and shake it: on the surface whatever the weights. */
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
            float *slid = slide_with(&r, &f.mesh, points, seed % 2 ? &paint.controls : NULL, NULL);
            double size = extent_of(points, f.mesh.vertex_count);
            for (int32_t c = 0; c < f.mesh.index_count; c++)
                assert_near(distance_to_mesh(&f.mesh, points, slid + 3 * f.mesh.face_indices[c]), 0, 2 * FLOAT_EPSILON * size);
            free(points), free(slid);
        }
        free_painted(&paint);
        free_rig(&r);
        free_mesh(&f.mesh);
    }
}

/* Rest that is crumpled as paper is, where gradients smoothed from vertex to vertex say little of the surface: what even takes
 * off stretch there, relaxed does not put back. */
static void no_stretch_is_added_on_crumpled_rest(void **state) {
    (void)state;
    int32_t evened = 0;
    for (uint64_t seed = 0; seed < 60; seed++) {
        test_mesh mesh = seed % 2 ? triangle_grid(7, 7) : quad_grid(7, 7);
        float *rest = shaken(&mesh, seed, 0.7), *points;
        memcpy(mesh.points, rest, POINT_BYTES(&mesh));
        points = random_pose(&mesh, seed);
        skinslide_patch_result results[2] = {SKINSLIDE_PATCH_RESULT_DEFAULT, SKINSLIDE_PATCH_RESULT_DEFAULT};
        for (int k = 0; k < 2; k++) {
            rig r = rig_of(&mesh, k ? relaxed() : by_rule(SKINSLIDE_RULE_EVEN));
            free(slide_with(&r, &mesh, points, NULL, &results[k]));
            free_rig(&r);
        }
        bool evens = results[0].stretch_after < results[0].stretch_before;
        evened += evens;
        if (evens)
            assert_true(results[1].stretch_after < results[1].stretch_before);
        free(rest), free(points);
        free_mesh(&mesh);
    }
    assert_true(evened > 30);
}

/* Unpainted, no face turns over in these poses, which are a sample. Random disks are left out: their points have no shape, so
 * rest is crumpled, and faces that turn over are counted. */
static void nothing_turns_over(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t holes = SKINSLIDE_HOLES_PINNED; holes <= SKINSLIDE_HOLES_FREE; holes++) {
            fixture f = make_fixture(i);
            skinslide_patch_setup choices = relaxed();
            choices.holes = (skinslide_holes)holes;
            rig r = rig_of(&f.mesh, choices);
            for (uint64_t seed = 0; seed < 40 && !strstr(f.name, "random"); seed++) {
                float *points = random_pose(&f.mesh, seed);
                skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
                free(slide_with(&r, &f.mesh, points, NULL, &result));
                assert_int_equal(result.folded_faces, 0);
                free(points);
            }
            free_rig(&r);
            free_mesh(&f.mesh);
        }
}

/* ---- In time ---- */

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

/* Steps four times as short make second differences of a motion that jumps no smaller, of one that turns sharply four times, as
 * it does where a vertex comes over an edge between faces, of a smooth one sixteen times. Beyond 80 degrees the crook of this
 * limb is one crease, which the skin leaves to either side. */
static void no_slide_jumps(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(12, 12);
    rig r = rig_of(&mesh, relaxed());
    for (int i = 1; i < 7; i++) {
        double coarse = roughest_slide(&r, &mesh, flexed, 0.2 * i, 0.2 * (i + 1), 10);
        double fine = roughest_slide(&r, &mesh, flexed, 0.2 * i, 0.2 * (i + 1), 40);
        assert_true(fine < coarse / 1.5);
    }
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- How far ---- */

/* Under every rule no vertex goes farther than its limit, one that would not have keeps its bits, and one whose limit is zero
 * stays. The chord is no longer than the way; 1e-6 is for rounding. */
static void largest_distances_are_kept(void **state) {
    (void)state;
    test_mesh mesh = grid_with_holes(false);
    float *points = bumped(&mesh, 4, 6, 3, 3), *limit = calloc((size_t)mesh.vertex_count, sizeof *limit);
    for (int32_t rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++)
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_of_a_linear_map),
        cmocka_unit_test(a_slide_by_hand),
        cmocka_unit_test(stretch_is_less_than_by_other_rules),
        cmocka_unit_test(skin_comes_from_far),
        cmocka_unit_test(slides_stay_on_the_surface),
        cmocka_unit_test(no_stretch_is_added_on_crumpled_rest),
        cmocka_unit_test(nothing_turns_over),
        cmocka_unit_test(slides_are_smooth_in_time),
        cmocka_unit_test(no_slide_jumps),
        cmocka_unit_test(largest_distances_are_kept),
        cmocka_unit_test(largest_distances_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
