/* Meshes and poses that are degenerate but legal: nothing crashes, nothing is lost, and what was degraded is counted. */
#include "skinslide/paint.h"
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RULES = 4 };
static const skinslide_rule rules[RULES] = {SKINSLIDE_RULE_UNIT, SKINSLIDE_RULE_FAST, SKINSLIDE_RULE_EVEN,
                                            SKINSLIDE_RULE_RELAXED};

/* By any rule rest keeps its bits, and any pose gives finite points. */
static void check_poses(const test_mesh *mesh, skinslide_patch_setup choices) {
    for (size_t rule = 0; rule < RULES; rule++) {
        choices.rule = rules[rule];
        expect_finite_slides(mesh, choices, 5);
    }
}

static skinslide_patch_info info_of(const rig *r) {
    skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
    skinslide_error error;
    assert_ok(skinslide_slider_patch_info(r->slider, 0, &info, &error), &error);
    return info;
}

static void patches_with_nothing_free(void **state) {
    (void)state;
    for (int32_t sides = 3; sides < 9; sides++) {
        test_mesh mesh = polygon(sides);
        skinslide_patch_setup setup = setup_of(NULL, 0);
        for (size_t rule = 0; rule < RULES; rule++) {
            setup.rule = rules[rule];
            rig r = rig_of(&mesh, setup);
            float *points = shaken(&mesh, 1, 1), *slid = slide_with(&r, &mesh, points, NULL, NULL);
            assert_same_bytes(slid, points, POINT_BYTES(&mesh));
            assert_int_equal(info_of(&r).free_count, 0);
            free(points), free(slid);
            free_rig(&r);
        }
        free_mesh(&mesh);
    }
}

/* A grid of quads, and vertices that no face uses, at the ends and between: the even ones. */
static test_mesh grid_with_isolated(void) {
    test_mesh grid = quad_grid(4, 4), mesh = join_meshes(&grid, &grid);
    mesh.face_count = grid.face_count, mesh.index_count = grid.index_count;
    for (int32_t c = 0; c < mesh.index_count; c++)
        mesh.face_indices[c] = 2 * mesh.face_indices[c] + 1;
    for (int32_t v = 49; v >= 0; v--)
        memcpy(mesh.points + 3 * v, grid.points + 3 * (v / 2), sizeof(float[3]));
    free_mesh(&grid);
    return mesh;
}

static void isolated_vertices_keep_their_bits(void **state) {
    (void)state;
    test_mesh mesh = grid_with_isolated();
    skinslide_patch_setup setup = setup_of(NULL, 0);
    check_poses(&mesh, setup);
    for (size_t rule = 0; rule < RULES; rule++) {
        setup.rule = rules[rule];
        rig r = rig_of(&mesh, setup);
        float *points = shaken(&mesh, 1, 0.4), *slid = slide_with(&r, &mesh, points, NULL, NULL);
        for (int32_t v = 0; v < 50; v += 2)
            assert_same_bytes(slid + 3 * v, points + 3 * v, sizeof(float[3]));
        assert_true(largest_difference(slid, points, 150) > 0.01);
        free(points), free(slid);
        free_rig(&r);
    }
    free_mesh(&mesh);
}

/* Rest points of no face may be anything: the slide is as if they were not there, and they meet nothing. */
static void isolated_vertices_are_nowhere(void **state) {
    (void)state;
    test_mesh mesh = grid_with_isolated(), nowhere = grid_with_isolated();
    for (int32_t v = 0; v < 50; v += 2)
        nowhere.points[3 * v + v % 3] = v % 4 ? NAN : INFINITY;
    float *points = shaken(&mesh, 1, 0.4);
    skinslide_patch_setup setup = setup_of(NULL, 0);
    for (size_t rule = 0; rule < RULES; rule++) {
        setup.rule = rules[rule];
        rig r = rig_of(&mesh, setup), other = rig_of(&nowhere, setup);
        float *slid = slide_with(&r, &mesh, points, NULL, NULL), *same = slide_with(&other, &nowhere, points, NULL, NULL);
        assert_same_bytes(same, slid, POINT_BYTES(&mesh));
        free(slid), free(same);
        free_rig(&r), free_rig(&other);
    }
    free(points);
    free_mesh(&mesh), free_mesh(&nowhere);
}

/* They are not welded, no mirror image is looked for among them, and sizes do not include them. */
static void isolated_vertices_say_nothing(void **state) {
    (void)state;
    test_mesh nowhere = grid_with_isolated();
    for (int32_t v = 0; v < 50; v += 2)
        nowhere.points[3 * v + v % 3] = v % 4 ? NAN : INFINITY;
    skinslide_mesh view = view_of(&nowhere);
    int32_t *all = all_faces(&nowhere), vertices[50], faces[16], mirrored[50];
    float stretch[64] = {0}, *pose = copy_points(&nowhere);
    uint8_t chosen[16];
    skinslide_patch_setup setup = setup_of(all, nowhere.face_count);
    skinslide_weld *weld;
    skinslide_error error;
    assert_ok(skinslide_weld_create(&view, &setup, 1, 1e-4, &weld, &error), &error);
    assert_ok(skinslide_weld_get(weld, vertices, NULL, &error), &error);
    for (int32_t v = 0; v < 50; v++)
        assert_int_equal(vertices[v], v);
    skinslide_weld_destroy(weld);
    assert_fails(skinslide_weld_create(&view, &setup, 1, 1, &weld, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "weld: the tolerance is 1; it must be 0 to 0.005...");
    skinslide_mirror_options middle = SKINSLIDE_MIRROR_OPTIONS_DEFAULT;
    middle.plane = 2;
    assert_ok(skinslide_mirror(&view, &middle, all, nowhere.face_count, faces, mirrored, &error), &error);
    for (int32_t v = 0; v < 50; v++)
        assert_int_equal(mirrored[v], v % 2 ? v / 10 * 10 + 10 - v % 10 : -1);
    pose[3 * 25] += 0.5f; /* vertex 12 of the grid, in its middle */
    assert_ok(skinslide_note_stretch(&view, pose, stretch, &error), &error);
    assert_ok(skinslide_mask_stretched(&view, stretch, NULL, chosen, &error), &error);
    assert_true(chosen[5] && chosen[10]);
    free(all), free(pose);
    free_mesh(&nowhere);
}

/* A vertex of no face to which another is welded counts, though: sliding reads it. */
static void what_a_vertex_is_one_with_must_be_finite(void **state) {
    (void)state;
    test_mesh mesh = grid_with_isolated();
    skinslide_mesh view = view_of(&mesh);
    int32_t *all = all_faces(&mesh), weld[50];
    skinslide_patch_setup setup = setup_of(all, mesh.face_count);
    skinslide_slider *slider = NULL;
    skinslide_error error;
    for (int32_t v = 0; v < 50; v++)
        weld[v] = v == 25 ? 24 : v;
    view.weld = weld;
    for (size_t rule = 0; rule < RULES; rule++) {
        setup.rule = rules[rule];
        mesh.points[3 * 24] = NAN;
        assert_fails(skinslide_slider_create(&view, &setup, 1, &slider, &error), &error, SKINSLIDE_BAD_POINTS,
                     "rest points: vertex 24 is not finite: (nan, 2, 0)");
        mesh.points[3 * 24] = mesh.points[3 * 25];
        assert_ok(skinslide_slider_create(&view, &setup, 1, &slider, &error), &error);
        skinslide_slider_destroy(slider);
    }
    free(all);
    free_mesh(&mesh);
}

/* Rows of a grid pulled into one another at rest: edges of no length are counted, in rest and in the pose. */
static void edges_of_no_length(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(6, 6);
    for (int32_t i = 0; i < 7; i++)
        mesh.points[3 * (21 + i) + 1] = 2; /* row 3 lies on row 2 */
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    assert_int_equal(info_of(&r).zero_length_edges, 7);
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(&r, &mesh, mesh.points, NULL, &result);
    assert_int_equal(result.zero_length_edges, 7);
    free(slid);
    free_rig(&r);
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        check_poses(&mesh, (skinslide_patch_setup){.rule = rules[i]});
    free_mesh(&mesh);
}

/* A disk does not fold however many of its edges have no length, at rest or in the pose: densities differ by a million. */
static void edges_of_no_length_do_not_fold(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        test_mesh mesh = seed % 2 ? triangle_grid(9, 9) : quad_grid(9, 9);
        float *points = random_pose(&mesh, seed);
        dice d = {seed};
        for (int32_t i = 0; i < 40; i++) {
            int32_t v = roll_below(&d, 99), w = v + (roll_below(&d, 2) ? 1 : 10);
            memcpy(points + 3 * w % 300, points + 3 * v, sizeof(float[3]));
            if (i % 2)
                memcpy(mesh.points + 3 * w % 300, mesh.points + 3 * v, sizeof(float[3]));
        }
        rig r = rig_of(&mesh, setup_of(NULL, 0));
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&r, &mesh, points, NULL, &result);
        assert_true(result.zero_length_edges > 0);
        assert_int_equal(info_of(&r).folded_faces, 0);
        assert_int_equal(result.folded_faces, 0);
        assert_true(all_finite(slid, 3 * (int64_t)mesh.vertex_count));
        free(points), free(slid);
        free_rig(&r);
        free_mesh(&mesh);
    }
}

/* All points of a pose in one place: every vertex slides there, that is, not at all. */
static void a_pose_in_one_place(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (size_t rule = 0; rule < RULES; rule++) {
            fixture f = make_fixture(i);
            rig r = rig_of(&f.mesh, (skinslide_patch_setup){.rule = rules[rule]});
            float *points = copy_points(&f.mesh);
            for (int32_t k = 0; k < 3 * f.mesh.vertex_count; k++)
                points[k] = 2.7f;
            skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
            float *slid = slide_with(&r, &f.mesh, points, NULL, &result);
            assert_same_bytes(slid, points, POINT_BYTES(&f.mesh));
            assert_int_equal(result.zero_length_edges, info_of(&r).edge_count);
            assert_true(isfinite(result.stretch_before) && isfinite(result.stretch_after));
            free(points), free(slid);
            free_rig(&r);
            free_mesh(&f.mesh);
        }
}

/* A pose on a line, and one in a plane seen edge on, with slivers of all sizes. */
static void flat_and_sliver_poses(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t squeeze = 0; squeeze < 3; squeeze++) {
            fixture f = make_fixture(i);
            skinslide_patch_setup setup = setup_of(NULL, 0);
            float *points = random_pose(&f.mesh, 1);
            for (int32_t k = 0; k < 3 * f.mesh.vertex_count; k++)
                points[k] *= k % 3 == 0 ? 1 : squeeze == 0 ? 0 : squeeze == 1 ? 1e-7f : k % 3 == 1 ? 1e-20f : 1;
            for (size_t rule = 0; rule < RULES; rule++) {
                setup.rule = rules[rule];
                rig r = rig_of(&f.mesh, setup);
                float *slid = slide_with(&r, &f.mesh, points, NULL, NULL);
                assert_true(all_finite(slid, 3 * (int64_t)f.mesh.vertex_count));
                free(slid);
                free_rig(&r);
            }
            free(points);
            free_mesh(&f.mesh);
        }
}

/* A triangle with two sides on one side of the square has no area there. Of 3 x 3 quads cut in two, vertices 3 and 12 have one
 * face each, and with these corners lie within a side. Both are reported, and frames go on. */
static void ears_on_the_square_collapse(void **state) {
    (void)state;
    test_mesh mesh = triangle_grid(3, 3);
    const int32_t corners[4] = {1, 11, 14, 4};
    rig r = rig_of(&mesh, (skinslide_patch_setup){.corners = corners});
    skinslide_patch_info info = info_of(&r);
    assert_int_equal(info.folded_faces, 0);
    assert_int_equal(info.collapsed_faces, 2);
    check_poses(&mesh, (skinslide_patch_setup){.corners = corners});
    check_poses(&mesh, (skinslide_patch_setup){.corners = corners, .interpolation = SKINSLIDE_INTERPOLATION_MEAN_VALUE});
    free_rig(&r);
    free_mesh(&mesh);
}

/* The largest and smallest floats there are. */
static void sizes_at_the_ends_of_float(void **state) {
    (void)state;
    for (int32_t huge = 0; huge < 2; huge++) {
        test_mesh mesh = quad_grid(8, 8);
        float scale = huge ? 0.01f * FLT_MAX : FLT_MIN;
        float *points = random_pose(&mesh, 2);
        for (int32_t k = 0; k < 3 * mesh.vertex_count; k++)
            mesh.points[k] *= scale, points[k] *= scale;
        skinslide_patch_setup setup = setup_of(NULL, 0);
        for (size_t rule = 0; rule < RULES; rule++) {
            setup.rule = rules[rule];
            rig r = rig_of(&mesh, setup);
            skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
            float *slid = slide_with(&r, &mesh, points, NULL, &result);
            assert_true(all_finite(slid, 3 * (int64_t)mesh.vertex_count));
            assert_true(result.slid_vertices > 0);
            free(slid);
            free_rig(&r);
        }
        free(points);
        free_mesh(&mesh);
    }
}

/* Wound the other way round, as left-handed meshes are: nothing here depends on it. The slide is that of the mirrored mesh. */
static void either_winding_slides(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    float *points = random_pose(&mesh, 3);
    for (int32_t c = 0; c < mesh.index_count; c += 4) {
        int32_t swap = mesh.face_indices[c + 1];
        mesh.face_indices[c + 1] = mesh.face_indices[c + 3], mesh.face_indices[c + 3] = swap;
    }
    skinslide_patch_setup setup = setup_of(NULL, 0);
    check_poses(&mesh, setup);
    for (size_t rule = 0; rule < RULES; rule++) {
        setup.rule = rules[rule];
        rig r = rig_of(&mesh, setup);
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&r, &mesh, points, NULL, &result);
        assert_int_equal(result.folded_faces, 0);
        assert_true(result.slid_vertices > 40);
        free(slid);
        free_rig(&r);
    }
    free(points);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patches_with_nothing_free),
        cmocka_unit_test(isolated_vertices_keep_their_bits),
        cmocka_unit_test(isolated_vertices_are_nowhere),
        cmocka_unit_test(isolated_vertices_say_nothing),
        cmocka_unit_test(what_a_vertex_is_one_with_must_be_finite),
        cmocka_unit_test(edges_of_no_length),
        cmocka_unit_test(edges_of_no_length_do_not_fold),
        cmocka_unit_test(a_pose_in_one_place),
        cmocka_unit_test(flat_and_sliver_poses),
        cmocka_unit_test(ears_on_the_square_collapse),
        cmocka_unit_test(sizes_at_the_ends_of_float),
        cmocka_unit_test(either_winding_slides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
