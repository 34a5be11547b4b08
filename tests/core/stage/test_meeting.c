/* Where another mesh meets a patch: what of it is held, and what of other meshes counts. */
#include "records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
enum { SIDE = 4, VERTICES = 25 };

/* The left half of a grid is the patch. */
static patch_scene set_up(void) {
    uint8_t chosen[SIDE * SIDE];
    for (int32_t f = 0; f < SIDE * SIDE; f++)
        chosen[f] = f % SIDE < SIDE / 2;
    patch_scene s = {quad_grid(SIDE, SIDE), NULL, NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    s.patch = scene_patch(s.mesh, &s.grid, chosen);
    s.controls = scene_controls(s.patch);
    return s;
}

static const uint8_t *held_of(patch_scene *s) {
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    assert_ok(skinslide_stage_patch_get(s->patch, s->controls, &setup, &error), &error);
    return setup.held;
}

static void only_borders_that_may_slide_want_neighbours(void **state) {
    (void)state;
    patch_scene s = set_up();
    assert_false(skinslide_stage_patch_wants_neighbours(s.patch));
    assert_ok(patch_takes(s.patch, "holes", text_of("holes", "freeAll"), &error), &error);
    assert_true(skinslide_stage_patch_wants_neighbours(s.patch));
    assert_ok(patch_takes(s.patch, "holes", text_of("holes", "free"), &error), &error);
    assert_true(skinslide_stage_patch_wants_neighbours(s.patch));
    assert_ok(mesh_takes(s.mesh, "weld", single_of("weld", SKINSLIDE_VALUE_BOOL, &(uint8_t){0}), &error), &error);
    assert_false(skinslide_stage_patch_wants_neighbours(s.patch));
    assert_false(skinslide_stage_patch_wants_neighbours(NULL));
    end_scene(&s);
}

/* Two meshes, one after the other: points of the patch that either has, and no point that it has not. */
static void points_of_the_patch_are_held_where_others_are(void **state) {
    (void)state;
    patch_scene s = set_up();
    assert_null(held_of(&s));
    float first[][3] = {{0, 0, 0}, {0, 1, 0}, {3, 0, 0}, {NAN, 0, 0}}, second[][3] = {{0, 1, 0}, {0, 2, 0}, {0, 3.5F, 0}};
    assert_ok(skinslide_stage_patch_meet(s.patch, first[0], 4, &error), &error);
    assert_ok(skinslide_stage_patch_meet(s.patch, second[0], 3, &error), &error);
    const uint8_t *held = held_of(&s);
    for (int32_t v = 0; v < VERTICES; v++)
        assert_int_equal(held[v], v == 0 || v == SIDE + 1 || v == 2 * (SIDE + 1));
    end_scene(&s);
}

static void a_copy_of_the_patch_holds_nothing(void **state) {
    (void)state;
    patch_scene s = set_up();
    assert_ok(skinslide_stage_patch_meet(s.patch, s.grid.points, VERTICES, &error), &error);
    const uint8_t *held = held_of(&s);
    for (int32_t v = 0; v < VERTICES; v++)
        assert_int_equal(held[v], 0);
    end_scene(&s);
}

static void as_near_as_the_tolerance_says(void **state) {
    (void)state;
    const float near[3] = {0, 1e-3F, 0};
    for (int wide = 0; wide < 2; wide++) {
        patch_scene s = set_up();
        float tolerance = wide ? 2e-3F : 5e-4F;
        assert_ok(mesh_takes(s.mesh, "weldTolerance", NUMBER("weldTolerance", tolerance), &error), &error);
        assert_ok(skinslide_stage_patch_meet(s.patch, near, 1, &error), &error);
        assert_int_equal(held_of(&s)[0], wide);
        end_scene(&s);
    }
}

static void arguments_that_are_none(void **state) {
    (void)state;
    patch_scene s = set_up();
    const char *says = "no patch with faces, no points, or a negative count of them";
    assert_fails(skinslide_stage_patch_meet(NULL, NULL, 0, &error), &error, SKINSLIDE_BAD_ARGUMENT, says);
    assert_fails(skinslide_stage_patch_meet(s.patch, NULL, 1, &error), &error, SKINSLIDE_BAD_ARGUMENT, says);
    assert_fails(skinslide_stage_patch_meet(s.patch, s.grid.points, -1, &error), &error, SKINSLIDE_BAD_ARGUMENT, says);
    assert_fails(skinslide_stage_patch_meet(s.patch, s.grid.points, INT32_MAX, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "two meshes have 2147483672 points, and may have 2147483647");
    end_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_borders_that_may_slide_want_neighbours),
        cmocka_unit_test(points_of_the_patch_are_held_where_others_are),
        cmocka_unit_test(a_copy_of_the_patch_holds_nothing),
        cmocka_unit_test(as_near_as_the_tolerance_says),
        cmocka_unit_test(arguments_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
