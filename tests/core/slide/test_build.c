/* A slider built set-up by set-up: in any order, by any threads, as at once; and what is wrong is said of the first. */
#include "support.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { SETUPS = 8 };

static skinslide_error error;

/* Set-ups of every rule over faces that overlap, on the limit surface and off it; some are in two pieces. */
typedef struct scene {
    test_mesh mesh;
    skinslide_subdivision subdivision;
    skinslide_mesh view;
    int32_t *faces;
    painted paint;
    skinslide_patch_setup setups[SETUPS];
    float *points;
} scene;

static void make_scene(scene *s) {
    static const skinslide_rule rules[4] = {SKINSLIDE_RULE_UNIT, SKINSLIDE_RULE_FAST, SKINSLIDE_RULE_RELAXED,
                                            SKINSLIDE_RULE_EVEN};
    test_mesh sheet = quad_grid(8, 8), other = quad_grid(4, 4);
    s->mesh = join_meshes(&sheet, &other);
    s->faces = all_faces(&s->mesh);
    s->paint = paint_at_random(&s->mesh, 1);
    s->points = random_pose(&s->mesh, 1);
    s->subdivision = (skinslide_subdivision)SKINSLIDE_SUBDIVISION_DEFAULT;
    s->subdivision.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    s->view = view_of(&s->mesh);
    s->view.subdivision = &s->subdivision;
    for (int32_t i = 0; i < SETUPS; i++) {
        s->setups[i] = setup_of(s->faces + 8 * i, 16);
        s->setups[i].rule = rules[i % 4];
        s->setups[i].interpolation = i % 3 ? SKINSLIDE_INTERPOLATION_LIMIT : SKINSLIDE_INTERPOLATION_LINEAR;
        s->setups[i].controls = &s->paint.controls;
    }
    s->setups[5].faces = s->faces, s->setups[5].face_count = s->mesh.face_count;
    free_mesh(&sheet), free_mesh(&other);
}

static void free_scene(scene *s) {
    free(s->faces), free(s->points);
    free_painted(&s->paint);
    free_mesh(&s->mesh);
}

static skinslide_build *begin(const scene *s) {
    skinslide_build *build = NULL;
    assert_ok(skinslide_build_create(&s->view, s->setups, SETUPS, &build, &error), &error);
    return build;
}

/* Slides a frame by a slider, which is destroyed. */
static float *slid_by(const scene *s, skinslide_slider *slider) {
    rig r = {.slider = slider};
    assert_ok(skinslide_workspace_create(slider, NULL, &r.workspace, &error), &error);
    float *slid = slide_with(&r, &s->mesh, s->points, NULL, NULL);
    free_rig(&r);
    return slid;
}

static float *slid_at_once(const scene *s) {
    skinslide_slider *slider = NULL;
    assert_ok(skinslide_slider_create(&s->view, s->setups, SETUPS, &slider, &error), &error);
    assert_true(skinslide_slider_patch_count(slider) > SETUPS);
    return slid_by(s, slider);
}

static void expect_same(const scene *s, skinslide_build *build, const float *expected) {
    skinslide_slider *slider = NULL;
    assert_ok(skinslide_build_finish(build, &slider, &error), &error);
    skinslide_build_destroy(build);
    for (int32_t p = 0, setup = 0; p < skinslide_slider_patch_count(slider); p++) {
        skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
        assert_ok(skinslide_slider_patch_info(slider, p, &info, &error), &error);
        assert_int_equal(info.setup, setup);
        setup += info.piece + 1 == info.piece_count;
    }
    float *slid = slid_by(s, slider);
    assert_same_bytes(slid, expected, POINT_BYTES(&s->mesh));
    free(slid);
}

/* Set-ups are built from the last to the first, every second one, one several times, none, and numbers that do not exist. */
static void in_any_order(void **state) {
    (void)state;
    static const int32_t orders[][SETUPS] = {{7, 6, 5, 4, 3, 2, 1, 0},
                                             {1, 3, 5, 7, -1, -1, -1, -1},
                                             {5, 5, 5, 5, 5, 5, 5, 5},
                                             {-1, SETUPS, -2, 99, INT32_MAX, -1, -1, -1}};
    scene s;
    make_scene(&s);
    float *expected = slid_at_once(&s);
    assert_true(memcmp(expected, s.points, POINT_BYTES(&s.mesh)) != 0);
    for (size_t o = 0; o < sizeof orders / sizeof *orders; o++) {
        skinslide_build *build = begin(&s);
        for (int32_t i = 0; i < SETUPS; i++)
            skinslide_build_setup(build, orders[o][i]);
        expect_same(&s, build, expected);
    }
    free(expected);
    free_scene(&s);
}

typedef struct job {
    skinslide_build *build;
    int32_t setup;
} job;

static void *build_one(void *own) {
    const job *one = own;
    skinslide_build_setup(one->build, one->setup);
    return NULL;
}

static void by_as_many_threads(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    float *expected = slid_at_once(&s);
    for (int32_t turn = 0; turn < 20; turn++) {
        pthread_t threads[SETUPS];
        job jobs[SETUPS];
        skinslide_build *build = begin(&s);
        for (int32_t i = 0; i < SETUPS; i++) {
            jobs[i] = (job){build, i};
            assert_int_equal(pthread_create(&threads[i], NULL, build_one, &jobs[i]), 0);
        }
        for (int32_t i = 0; i < SETUPS; i++)
            assert_int_equal(pthread_join(threads[i], NULL), 0);
        expect_same(&s, build, expected);
    }
    free(expected);
    free_scene(&s);
}

static void expect_fault(const scene *s, skinslide_status expected, const char *text) {
    skinslide_build *build = begin(s);
    skinslide_slider *const untouched = (skinslide_slider *)&expected, *slider = untouched;
    for (int32_t i = SETUPS - 1; i >= 0; i--)
        skinslide_build_setup(build, i);
    for (int32_t again = 0; again < 2; again++)
        assert_fails(skinslide_build_finish(build, &slider, &error), &error, expected, text);
    assert_ptr_equal(slider, untouched);
    skinslide_build_destroy(build);
}

/* Also if the error is in the mesh, which set-ups of other interpolations do not notice. */
static void the_first_fault_is_said(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    s.setups[2].face_count = 0, s.setups[4].face_count = 0, s.setups[4].name = "other";
    expect_fault(&s, SKINSLIDE_BAD_PATCH, "patch all: it has no faces");
    static const int32_t hole = -1;
    s.subdivision.hole_count = 1, s.subdivision.hole_indices = &hole;
    expect_fault(&s, SKINSLIDE_BAD_MESH, "hole indices: -1 is not one of ...");
    s.setups[0].face_count = 0, s.setups[0].name = "first";
    expect_fault(&s, SKINSLIDE_BAD_PATCH, "patch first: it has no faces");
    free_scene(&s);
}

static void bad_arguments(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    skinslide_build *const untouched = (skinslide_build *)&s, *build = untouched;
    const char *none = "no place for the slider, or no patches", *over = "nothing that is being built, or no place for it";
    assert_fails(skinslide_build_create(&s.view, s.setups, -1, &build, &error), &error, SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_build_create(&s.view, s.setups, 1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_build_create(NULL, NULL, 0, &build, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no mesh, ...");
    assert_ptr_equal(build, untouched);
    skinslide_slider *slider = NULL;
    build = begin(&s);
    assert_fails(skinslide_build_finish(build, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, over);
    assert_fails(skinslide_build_finish(NULL, &slider, &error), &error, SKINSLIDE_BAD_ARGUMENT, over);
    assert_ok(skinslide_build_finish(build, &slider, &error), &error);
    skinslide_slider *again = NULL;
    skinslide_build_setup(build, 0);
    assert_fails(skinslide_build_finish(build, &again, &error), &error, SKINSLIDE_BAD_ARGUMENT, over);
    assert_null(again);
    skinslide_build_setup(NULL, 0);
    skinslide_build_destroy(build), skinslide_build_destroy(NULL);
    skinslide_slider_destroy(slider);
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_any_order),
        cmocka_unit_test(by_as_many_threads),
        cmocka_unit_test(the_first_fault_is_said),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
