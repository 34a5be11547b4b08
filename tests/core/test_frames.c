/* Frames do not depend on each other, on the thread, or on where their controls come from. */
#define _POSIX_C_SOURCE 200809L /* pthread */
#include "support.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 8, THREADS = 4 };

typedef struct shot {
    fixture f;
    rig r;
    float *points[FRAMES], *slid[FRAMES]; /* slid alone, each in a workspace of its own */
    skinslide_patch_result results[FRAMES];
} shot;

static skinslide_workspace *new_workspace(const rig *r) {
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    assert_ok(skinslide_workspace_create(r->slider, NULL, &workspace, &error), &error);
    return workspace;
}

static void begin_shot(shot *s, int32_t fixture_index, skinslide_holes holes) {
    s->f = make_fixture(fixture_index);
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.holes = holes;
    s->r = rig_of(&s->f.mesh, choices);
    for (int i = 0; i < FRAMES; i++) {
        s->points[i] = random_pose(&s->f.mesh, (uint64_t)i);
        rig alone = {s->r.slider, new_workspace(&s->r)};
        s->slid[i] = slide_with(&alone, &s->f.mesh, s->points[i], NULL, &s->results[i]);
        skinslide_workspace_destroy(alone.workspace);
    }
}

static void end_shot(shot *s) {
    for (int i = 0; i < FRAMES; i++)
        free(s->points[i]), free(s->slid[i]);
    free_rig(&s->r);
    free_mesh(&s->f.mesh);
}

/* Everything but the seconds. */
static bool same_result(skinslide_patch_result a, skinslide_patch_result b) {
    a.density_seconds = b.density_seconds, a.embed_seconds = b.embed_seconds;
    a.locate_seconds = b.locate_seconds, a.interpolate_seconds = b.interpolate_seconds;
    return memcmp(&a, &b, sizeof a) == 0;
}

/* No assertions: threads report by the count of frames that differ. */
static int frames_that_differ(const shot *s, skinslide_workspace *workspace, int rounds, int first) {
    int differ = 0;
    float *slid = malloc(POINT_BYTES(&s->f.mesh));
    for (int k = 0; k < rounds; k++) {
        int i = (first + 5 * k) % FRAMES;
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        if (skinslide_slide(workspace, s->points[i], NULL, slid, &result, NULL))
            differ++;
        else
            differ += memcmp(slid, s->slid[i], POINT_BYTES(&s->f.mesh)) != 0 || !same_result(result, s->results[i]);
    }
    free(slid);
    return differ;
}

static void a_frame_is_the_same_after_others(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t holes = 0; holes < 2; holes++) {
            shot s;
            begin_shot(&s, i, (skinslide_holes)holes);
            assert_int_equal(frames_that_differ(&s, s.r.workspace, 3 * FRAMES, i), 0);
            end_shot(&s);
        }
}

/* A frame is the same after one that failed. */
static void a_frame_is_the_same_after_a_failure(void **state) {
    (void)state;
    shot s;
    begin_shot(&s, 4, SKINSLIDE_HOLES_PINNED);
    float *slid = malloc(POINT_BYTES(&s.f.mesh)), one = s.points[0][7];
    s.points[0][7] = (float)(0x1p127 * 4);
    assert_int_equal(skinslide_slide(s.r.workspace, s.points[0], NULL, slid, NULL, NULL), SKINSLIDE_BAD_POINTS);
    s.points[0][7] = one;
    assert_int_equal(frames_that_differ(&s, s.r.workspace, FRAMES, 0), 0);
    free(slid);
    end_shot(&s);
}

typedef struct job {
    const shot *s;
    skinslide_workspace *workspace;
    int first, differ;
} job;

static void *run_job(void *argument) {
    job *j = argument;
    j->differ = frames_that_differ(j->s, j->workspace, 4 * FRAMES, j->first);
    return NULL;
}

static void threads_share_a_slider(void **state) {
    (void)state;
    shot s;
    begin_shot(&s, 7, SKINSLIDE_HOLES_PINNED);
    pthread_t threads[THREADS];
    job jobs[THREADS];
    for (int t = 0; t < THREADS; t++) {
        jobs[t] = (job){&s, new_workspace(&s.r), t, -1};
        assert_int_equal(pthread_create(&threads[t], NULL, run_job, &jobs[t]), 0);
    }
    for (int t = 0; t < THREADS; t++) {
        assert_int_equal(pthread_join(threads[t], NULL), 0);
        assert_int_equal(jobs[t].differ, 0);
        skinslide_workspace_destroy(jobs[t].workspace);
    }
    end_shot(&s);
}

/* ---- Controls of a frame, and of a set-up ---- */

/* The same paint, weights and edges given either way: the same bytes; and when the frame brings none again, the set-up's. */
static void compare_controls(const fixture *f, const skinslide_controls *controls) {
    skinslide_patch_setup choices = setup_of(NULL, 0);
    rig plain = rig_of(&f->mesh, choices);
    choices.controls = controls;
    rig own = rig_of(&f->mesh, choices);
    float *points = random_pose(&f->mesh, 3);
    skinslide_patch_result first = SKINSLIDE_PATCH_RESULT_DEFAULT, second = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *expected = slide_with(&own, &f->mesh, points, NULL, &first);
    float *slid = slide_with(&plain, &f->mesh, points, controls, &second);
    assert_same_bytes(slid, expected, POINT_BYTES(&f->mesh));
    assert_true(same_result(first, second));
    float *unpainted = slide_with(&plain, &f->mesh, points, NULL, NULL);
    const skinslide_controls none = SKINSLIDE_CONTROLS_DEFAULT;
    float *again = slide_with(&own, &f->mesh, points, &none, NULL);
    assert_same_bytes(again, unpainted, POINT_BYTES(&f->mesh));
    free(points), free(expected), free(slid), free(unpainted), free(again);
    free_rig(&plain), free_rig(&own);
}

static void controls_of_a_frame_are_those_of_a_setup(void **state) {
    (void)state;
    for (int32_t i = 2; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        painted paint = paint_at_random(&f.mesh, (uint64_t)i);
        const int32_t edges[4] = {f.mesh.face_indices[0], f.mesh.face_indices[1], f.mesh.face_indices[2],
                                  f.mesh.face_indices[1]};
        const float factors[2] = {7, 0.1f};
        compare_controls(&f, &paint.controls);
        paint.controls.edges = edges, paint.controls.edge_density = factors, paint.controls.edge_count = 2;
        compare_controls(&f, &paint.controls);
        skinslide_controls half = SKINSLIDE_CONTROLS_DEFAULT;
        half.envelope = 0.5f;
        compare_controls(&f, &half);
        free_painted(&paint);
        free_mesh(&f.mesh);
    }
}

/* Only ratios of densities matter: all of 4 is all of 1. A power of two, so exactly. */
static void one_density_everywhere_is_none(void **state) {
    (void)state;
    fixture f = make_fixture(6);
    rig r = rig_of(&f.mesh, setup_of(NULL, 0));
    float *points = random_pose(&f.mesh, 3), *four = malloc((size_t)f.mesh.face_count * sizeof *four);
    for (int32_t i = 0; i < f.mesh.face_count; i++)
        four[i] = 4;
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.face_density = four;
    float *plain = slide_with(&r, &f.mesh, points, NULL, NULL),
          *painted_slid = slide_with(&r, &f.mesh, points, &controls, NULL);
    assert_same_bytes(painted_slid, plain, POINT_BYTES(&f.mesh));
    free(points), free(four), free(plain), free(painted_slid);
    free_rig(&r);
    free_mesh(&f.mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_the_same_after_others), cmocka_unit_test(a_frame_is_the_same_after_a_failure),
        cmocka_unit_test(threads_share_a_slider),           cmocka_unit_test(controls_of_a_frame_are_those_of_a_setup),
        cmocka_unit_test(one_density_everywhere_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
