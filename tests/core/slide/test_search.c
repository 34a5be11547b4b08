/* The least stretch of a pose: what must hold of it, and poses of which it is known. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

static double least_of(const rig *r, const float *points) {
    double least = -1;
    assert_ok(skinslide_workspace_least_stretch(r->workspace, points, &least, &error), &error);
    return least;
}

/* A flat sheet whose vertices inside were moved about in its plane: where they slide back, nothing is stretched. */
static void what_can_be_undone_is(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(6, 6);
    int32_t *faces = all_faces(&mesh);
    const skinslide_rule rules[3] = {SKINSLIDE_RULE_UNIT, SKINSLIDE_RULE_EVEN, SKINSLIDE_RULE_RELAXED};
    for (int k = 0; k < 3; k++) {
        skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
        setup.rule = rules[k];
        rig r = rig_of(&mesh, setup);
        float *points = copy_points(&mesh);
        for (int32_t row = 1; row < 6; row++)
            for (int32_t column = 1; column < 6; column++)
                points[3 * (7 * row + column)] += 0.3f * (float)sin(row + 2 * column);
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        free(slide_with(&r, &mesh, points, NULL, &result));
        assert_true(result.stretch_before > 0.1);
        assert_near(least_of(&r, points), 0, 1e-4 * result.stretch_before); /* as near as the gain of a step is to be seen */
        free(points);
        free_rig(&r);
    }
    free(faces);
    free_mesh(&mesh);
}

/* The least stretch is no more than that of the cache and that of the slide, and the same the second time. */
static void no_rule_is_better(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
    setup.rule = SKINSLIDE_RULE_RELAXED;
    rig r = rig_of(&mesh, setup);
    float *points = copy_points(&mesh);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v + 2] = 3 * (float)exp(-0.3 * (pow(points[3 * v] - 4, 2) + pow(points[3 * v + 1] - 4, 2)));
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    free(slide_with(&r, &mesh, points, NULL, &result));
    double least = least_of(&r, points), again = least_of(&r, points);
    assert_true(least > 0 && least <= result.stretch_after + 1e-6 && result.stretch_after < result.stretch_before);
    assert_same_bytes(&least, &again, sizeof least);
    free(points);
    free(faces);
    free_rig(&r);
    free_mesh(&mesh);
}

static void bad_arguments(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    int32_t *faces = all_faces(&mesh);
    rig r = rig_of(&mesh, setup_of(faces, mesh.face_count));
    float *points = copy_points(&mesh);
    double least = 7;
    const char *text = "no workspace, points, or place for the least stretch";
    assert_fails(skinslide_workspace_least_stretch(NULL, points, &least, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_workspace_least_stretch(r.workspace, NULL, &least, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_workspace_least_stretch(r.workspace, points, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_workspace_least_stretch(r.workspace, points, &least, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the workspace has slid no frame yet");
    free(slide_with(&r, &mesh, points, NULL, NULL));
    skinslide_workspace_interrupt(r.workspace);
    assert_fails(skinslide_workspace_least_stretch(r.workspace, points, &least, &error), &error, SKINSLIDE_INTERRUPTED,
                 "the frame was interrupted");
    assert_true(least == 7);
    assert_near(least_of(&r, points), 0, 0);
    free(points);
    free(faces);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_can_be_undone_is),
        cmocka_unit_test(no_rule_is_better),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
