/* A frame that another thread wants no more of: it is left inside its stages, and the next is as if there had been none. */
#define _POSIX_C_SOURCE 200809L /* pthread */
#include "support.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* A rig of a subdivided mesh, with a pose that slides. */
typedef struct scene {
    test_mesh mesh;
    rig r;
    float *points, *slid;
} scene;

static scene scene_with(skinslide_rule rule, skinslide_interpolation interpolation) {
    scene s = {.mesh = grid_with_holes(false)};
    skinslide_subdivision smooth = SKINSLIDE_SUBDIVISION_DEFAULT;
    smooth.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    skinslide_mesh view = view_of(&s.mesh);
    int32_t *faces = all_faces(&s.mesh);
    skinslide_patch_setup setup = setup_of(faces, s.mesh.face_count);
    skinslide_error error;
    view.subdivision = &smooth, setup.rule = rule, setup.interpolation = interpolation;
    assert_ok(skinslide_slider_create(&view, &setup, 1, &s.r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(s.r.slider, NULL, &s.r.workspace, &error), &error);
    s.points = random_pose(&s.mesh, 3), s.slid = slide_with(&s.r, &s.mesh, s.points, NULL, NULL);
    free(faces);
    return s;
}

static void end_scene(scene *s) {
    free(s->points), free(s->slid);
    free_rig(&s->r);
    free_mesh(&s->mesh);
}

static void one_frame_fails_and_the_next_does_not(void **state) {
    (void)state;
    for (int32_t rule = 0; rule <= SKINSLIDE_RULE_RELAXED; rule++) {
        scene s = scene_with((skinslide_rule)rule, SKINSLIDE_INTERPOLATION_LIMIT);
        float *slid = copy_points(&s.mesh);
        skinslide_error error;
        skinslide_workspace_interrupt(s.r.workspace);
        skinslide_workspace_interrupt(s.r.workspace);
        assert_fails(skinslide_slide(s.r.workspace, s.points, NULL, slid, NULL, &error), &error, SKINSLIDE_INTERRUPTED,
                     "the frame was interrupted");
        assert_same_bytes(slid, s.mesh.points, POINT_BYTES(&s.mesh));
        assert_ok(skinslide_slide(s.r.workspace, s.points, NULL, slid, NULL, &error), &error);
        assert_same_bytes(slid, s.slid, POINT_BYTES(&s.mesh));
        free(slid);
        end_scene(&s);
    }
    skinslide_workspace_interrupt(NULL);
}

/* The stages that take longest are stopped while they run: no step is taken, and nothing is fitted. */
static void stages_are_left(void **state) {
    (void)state;
    const int stop = 1;
    scene s = scene_with(SKINSLIDE_RULE_RELAXED, SKINSLIDE_INTERPOLATION_LIMIT);
    ss_patch_work *work = s.r.workspace->patches;
    skinslide_patch_result result = {0};
    skinslide_error error;
    double(*before)[3] = calloc((size_t)s.mesh.vertex_count, sizeof *before);
    size_t size = (size_t)s.r.slider->parts[0].patch->free_count * sizeof *before;
    memcpy(before, work->displacement, size);
    work->frame.stop = &stop;
    ss_move_cage(work->cage, &work->frame, work->slide, work->displacement);
    assert_same_bytes(work->displacement, before, size);
    assert_ok(s.r.slider->parts[0].rest->rule->start(work->slide, &work->frame, &result, &error), &error);
    assert_int_equal(result.relax_steps, 0);
    free(before);
    end_scene(&s);
}

typedef struct job {
    const scene *s;
    float *slid;
    int frames;
    skinslide_status status;
} job;

static void *slide_until_interrupted(void *argument) {
    job *j = argument;
    do
        j->status = skinslide_slide(j->s->r.workspace, j->s->points, NULL, j->slid, NULL, NULL), j->frames++;
    while (j->status == SKINSLIDE_OK);
    return NULL;
}

static void another_thread_interrupts(void **state) {
    (void)state;
    scene s = scene_with(SKINSLIDE_RULE_UNIT, SKINSLIDE_INTERPOLATION_LIMIT);
    job j = {&s, copy_points(&s.mesh), 0, SKINSLIDE_OK};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, slide_until_interrupted, &j), 0);
    skinslide_workspace_interrupt(s.r.workspace);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(j.status, SKINSLIDE_INTERRUPTED);
    assert_same_bytes(j.slid, j.frames > 1 ? s.slid : s.mesh.points, POINT_BYTES(&s.mesh));
    free(j.slid);
    end_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_frame_fails_and_the_next_does_not),
        cmocka_unit_test(stages_are_left),
        cmocka_unit_test(another_thread_interrupts),
    };
    return cmocka_run_group_tests_name("interrupt", tests, NULL, NULL);
}
