/* Lengths taken in another space: a slide there is that of the mesh brought there, and what comes of it goes back. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const double uneven[9] = {3, 0, 0, 0, 1, 0, 0.5, 0, 0.7};
static const float ROUNDING = 2e-5F; /* of points of about 10 units, to float, there and back */

static rig rig_in(const test_mesh *mesh, skinslide_patch_setup choices, const double *space) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    rig r;
    view.space = space;
    choices.size = sizeof choices, choices.name = "all", choices.faces = faces, choices.face_count = mesh->face_count;
    assert_ok(skinslide_slider_create(&view, &choices, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    free(faces);
    return r;
}

/* Points as rows times a matrix: to be freed. */
static float *brought(const float *points, int32_t count, const double m[9]) {
    float *out = calloc(3 * (size_t)count, sizeof *out);
    for (int32_t v = 0; v < count; v++)
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                out[3 * v + k] += (float)(points[3 * v + i] * m[3 * i + k]);
    return out;
}

static const skinslide_rule rules[] = {SKINSLIDE_RULE_FAST, SKINSLIDE_RULE_RELAXED, SKINSLIDE_RULE_EVEN};

/* For every rule: points, results, diagnostics and the least stretch. */
static void a_slide_is_that_of_the_mesh_brought_there(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8), there = quad_grid(8, 8);
    free(there.points), there.points = brought(mesh.points, mesh.vertex_count, uneven);
    float *pose = random_pose(&mesh, 3), *pose_there = brought(pose, mesh.vertex_count, uneven);
    for (int i = 0; i < 3; i++) {
        skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
        choices.rule = rules[i], choices.interpolation = SKINSLIDE_INTERPOLATION_LINEAR;
        rig own = rig_in(&mesh, choices, uneven), twin = rig_in(&there, choices, NULL), plain = rig_in(&mesh, choices, NULL);
        skinslide_patch_result a = SKINSLIDE_PATCH_RESULT_DEFAULT, b = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&own, &mesh, pose, NULL, &a), *slid_there = slide_with(&twin, &there, pose_there, NULL, &b);
        float *unbrought = slide_with(&plain, &mesh, pose, NULL, NULL), *back = brought(slid, mesh.vertex_count, uneven);
        assert_true(largest_difference(back, slid_there, 3 * (int64_t)mesh.vertex_count) < 3 * ROUNDING);
        assert_true(largest_difference(slid, unbrought, 3 * (int64_t)mesh.vertex_count) > 0.01);
        assert_near(a.stretch_before, b.stretch_before, 1e-6);
        assert_near(a.stretch_after, b.stretch_after, 1e-5);
        assert_near(a.largest_slide, b.largest_slide, 1e-4);
        float stretch[81], stretch_there[81];
        skinslide_diagnostics wanted = {.size = sizeof wanted, .stretch_after = stretch};
        assert_ok(skinslide_diagnose(own.slider, NULL, NULL, pose, slid, &wanted, &error), &error);
        wanted.stretch_after = stretch_there;
        assert_ok(skinslide_diagnose(twin.slider, NULL, NULL, pose_there, slid_there, &wanted, &error), &error);
        assert_true(largest_difference(stretch, stretch_there, 81) < 1e-4);
        double least, least_there;
        assert_ok(skinslide_workspace_least_stretch(own.workspace, pose, &least, &error), &error);
        assert_ok(skinslide_workspace_least_stretch(twin.workspace, pose_there, &least_there, &error), &error);
        assert_near(least, least_there, 1e-4);
        free(slid), free(slid_there), free(unbrought), free(back);
        free_rig(&own), free_rig(&twin), free_rig(&plain);
    }
    free(pose), free(pose_there);
    free_mesh(&mesh), free_mesh(&there);
}

/* Rest keeps its bits in any space, and the mesh's own space changes no bit. */
static void rest_stays_and_the_own_space_is_none(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
    choices.rule = SKINSLIDE_RULE_EVEN;
    float *pose = random_pose(&mesh, 4);
    rig own = rig_in(&mesh, choices, uneven), same = rig_in(&mesh, choices, identity), plain = rig_in(&mesh, choices, NULL);
    float *rest = slide_with(&own, &mesh, mesh.points, NULL, NULL);
    float *a = slide_with(&same, &mesh, pose, NULL, NULL), *b = slide_with(&plain, &mesh, pose, NULL, NULL);
    assert_same_bytes(rest, mesh.points, POINT_BYTES(&mesh));
    assert_same_bytes(a, b, POINT_BYTES(&mesh));
    free(rest), free(a), free(b), free(pose);
    free_rig(&own), free_rig(&same), free_rig(&plain);
    free_mesh(&mesh);
}

/* A turn after the map changes no length. */
static void only_lengths_count(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    double turned[9];
    for (int i = 0; i < 3; i++) {
        const double *row = uneven + 3 * i, c = 0.6, s = 0.8;
        turned[3 * i] = c * row[0] - s * row[1], turned[3 * i + 1] = s * row[0] + c * row[1], turned[3 * i + 2] = row[2];
    }
    skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
    choices.rule = SKINSLIDE_RULE_EVEN;
    float *pose = random_pose(&mesh, 5);
    rig a = rig_in(&mesh, choices, uneven), b = rig_in(&mesh, choices, turned);
    float *first = slide_with(&a, &mesh, pose, NULL, NULL), *second = slide_with(&b, &mesh, pose, NULL, NULL);
    assert_true(largest_difference(first, second, 3 * (int64_t)mesh.vertex_count) < ROUNDING);
    free(first), free(second), free(pose);
    free_rig(&a), free_rig(&b);
    free_mesh(&mesh);
}

static void spaces_that_are_none(void **state) {
    (void)state;
    static const double flat[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0}, bad[9] = {NAN, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double vast[9] = {1e30, 0, 0, 0, 1e30, 0, 0, 0, 1e30};
    test_mesh mesh = quad_grid(2, 2);
    skinslide_mesh view = view_of(&mesh);
    skinslide_slider *slider = NULL;
    for (int i = 0; i < 2; i++) {
        view.space = i ? flat : bad;
        assert_fails(skinslide_slider_create(&view, NULL, 0, &slider, &error), &error, SKINSLIDE_BAD_MESH,
                     "space: the matrix is not finite, or has no inverse");
    }
    assert_null(slider);
    skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
    choices.rule = SKINSLIDE_RULE_EVEN;
    rig r = rig_in(&mesh, choices, vast);
    float pose[27], slid[27] = {7};
    memcpy(pose, mesh.points, sizeof pose);
    pose[12] = 1e20F;
    assert_fails(skinslide_slide(r.workspace, pose, NULL, slid, NULL, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points where lengths are taken: vertex 4 is not finite: (inf...");
    assert_true(slid[0] == 7);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slide_is_that_of_the_mesh_brought_there),
        cmocka_unit_test(rest_stays_and_the_own_space_is_none),
        cmocka_unit_test(only_lengths_count),
        cmocka_unit_test(spaces_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
