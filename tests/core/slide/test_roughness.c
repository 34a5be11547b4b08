/* How roughly patches move: by hand, and what must hold of any motion. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* Three poses of a sheet of 9 vertices, in the cache and slid. */
typedef struct shot {
    test_mesh mesh;
    int32_t *faces;
    rig r;
    float *cached[3], *slid[3];
    skinslide_sample samples[3];
} shot;

static shot open_shot(void) {
    shot s = {.mesh = quad_grid(2, 2)};
    s.faces = all_faces(&s.mesh);
    s.r = rig_of(&s.mesh, setup_of(s.faces, s.mesh.face_count));
    for (int k = 0; k < 3; k++) {
        s.cached[k] = copy_points(&s.mesh), s.slid[k] = copy_points(&s.mesh);
        s.samples[k] = (skinslide_sample){sizeof(skinslide_sample), k, s.cached[k], s.slid[k]};
    }
    return s;
}

static void close_shot(shot *s) {
    for (int k = 0; k < 3; k++)
        free(s->cached[k]), free(s->slid[k]);
    free_rig(&s->r);
    free(s->faces);
    free_mesh(&s->mesh);
}

static skinslide_roughness measured(const shot *s) {
    skinslide_roughness found = SKINSLIDE_ROUGHNESS_DEFAULT;
    assert_ok(skinslide_measure_roughness(s->r.slider, s->samples, &found, &error), &error);
    return found;
}

/* Vertex 4 goes 0, 1, 4 along x in the cache: 0 - 2 + 4 = 2. In the result vertex 7 jumps by 3 along y at the middle: 6. */
static void by_hand(void **state) {
    (void)state;
    shot s = open_shot();
    for (int k = 0; k < 3; k++)
        s.cached[k][3 * 4] = s.slid[k][3 * 4] = (float)(k * k);
    s.slid[1][3 * 7 + 1] += 3;
    skinslide_roughness found = measured(&s);
    assert_near(found.before, 2, 0);
    assert_near(found.after, 6, 0);
    assert_int_equal(found.vertex_before, 4);
    assert_int_equal(found.vertex_after, 7);
    assert_near(found.least, 0.01, 1e-15); /* edges are 1 long */
    close_shot(&s);
}

/* Even motion is rough by nothing but rounding, however uneven the steps; a parabola of a t^2 by 2 a (t1 - t0) (t2 - t1). */
static void uneven_steps(void **state) {
    (void)state;
    const double times[3] = {-0.5, 0.25, 2};
    shot s = open_shot();
    for (int k = 0; k < 3; k++) {
        s.samples[k].seconds = times[k];
        for (int32_t v = 0; v < s.mesh.vertex_count; v++)
            s.cached[k][3 * v + 2] = (float)(7 * times[k]);
        s.slid[k][3 * 4 + 2] = (float)(3 * times[k] * times[k]);
    }
    skinslide_roughness found = measured(&s);
    assert_true(found.before <= 1e-6);
    assert_near(found.after, 2 * 3 * 0.75 * 1.75, 1e-6);
    close_shot(&s);
}

static void no_motion_is_not_rough(void **state) {
    (void)state;
    shot s = open_shot();
    skinslide_roughness found = measured(&s);
    assert_true(found.before == 0 && found.after == 0 && found.least > 0);
    close_shot(&s);
}

/* Far away, rounding is more than what counts on skin: of three points, the middle one twice, sqrt(3) of half a unit in the
 * last place. */
static void rounding_does_not_count(void **state) {
    (void)state;
    shot s = open_shot();
    s.cached[0][3 * 2 + 1] = s.slid[2][3 * 2] = 1e6f;
    assert_near(measured(&s).least, 2 * sqrt(3) * FLT_EPSILON * 1e6, 1e-9);
    close_shot(&s);
}

/* Times at the ends of the range of doubles, and points at those of float. */
static void far_and_near(void **state) {
    (void)state;
    shot s = open_shot();
    s.samples[0].seconds = -DBL_MAX, s.samples[1].seconds = 0, s.samples[2].seconds = DBL_MAX;
    s.cached[0][0] = FLT_MAX, s.cached[1][0] = -FLT_MAX, s.cached[2][0] = FLT_MAX;
    assert_near(measured(&s).before / FLT_MAX, 4, 1e-15);
    s.samples[0].seconds = 0, s.samples[1].seconds = 5e-324, s.samples[2].seconds = 1e-323;
    assert_true(isfinite(measured(&s).before));
    close_shot(&s);
}

/* What is off the patches does not count, and each patch is measured by itself. */
static void patches_apart(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 1); /* vertices 0 1 2 3 below, 4 5 6 7 above */
    static const int32_t left[1] = {0}, right[1] = {2};
    skinslide_patch_setup setups[2] = {setup_of(left, 1), setup_of(right, 1)};
    rig r = rig_of_setups(&mesh, setups, 2);
    float *poses[3] = {copy_points(&mesh), copy_points(&mesh), copy_points(&mesh)};
    skinslide_sample samples[3];
    poses[1][3 * 7] += 1;
    for (int k = 0; k < 3; k++)
        samples[k] = (skinslide_sample){sizeof(skinslide_sample), k, poses[k], poses[k]};
    skinslide_roughness found[2] = {SKINSLIDE_ROUGHNESS_DEFAULT, SKINSLIDE_ROUGHNESS_DEFAULT};
    assert_ok(skinslide_measure_roughness(r.slider, samples, found, &error), &error);
    assert_true(found[0].before == 0 && found[0].after == 0);
    assert_true(found[1].before == 2 && found[1].after == 2 && found[1].vertex_after == 7);
    for (int k = 0; k < 3; k++)
        free(poses[k]);
    free_rig(&r);
    free_mesh(&mesh);
}

static void bad_arguments(void **state) {
    (void)state;
    shot s = open_shot();
    skinslide_roughness found = SKINSLIDE_ROUGHNESS_DEFAULT, before = found;
    const skinslide_slider *slider = s.r.slider;
    const char *text = "no slider, samples, or place for the roughness";
    assert_fails(skinslide_measure_roughness(NULL, s.samples, &found, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_measure_roughness(slider, NULL, &found, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_measure_roughness(slider, s.samples, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    s.slid[2][3 * 8] = NAN;
    assert_fails(skinslide_measure_roughness(slider, s.samples, &found, &error), &error, SKINSLIDE_BAD_POINTS,
                 "patch all: vertex 8 is not finite: nan");
    s.samples[2].seconds = 1;
    assert_fails(skinslide_measure_roughness(slider, s.samples, &found, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "sample times do not ascend: 1 s, then 1 s");
    assert_same_bytes(&found, &before, sizeof found);
    close_shot(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(uneven_steps),
        cmocka_unit_test(no_motion_is_not_rough),
        cmocka_unit_test(far_and_near),
        cmocka_unit_test(patches_apart),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(rounding_does_not_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
