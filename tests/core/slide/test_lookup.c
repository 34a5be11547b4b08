/* Both lookups give the same bytes: on every fixture, at every resolution, and whatever the device does meanwhile. */
#include "faults.h"

#include <malloc.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#ifndef __SANITIZE_ADDRESS__
#define __SANITIZE_ADDRESS__ 0
#endif

static skinslide_workspace *workspace_at(const skinslide_slider *slider, skinslide_lookup lookup, int32_t resolution,
                                         ss_egl_loader load) {
    skinslide_workspace_options options = {sizeof(skinslide_workspace_options), lookup, SKINSLIDE_ANY_DEVICE, resolution};
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    assert_ok(ss_workspace_create(slider, &options, load, &workspace, &error), &error);
    return workspace;
}

static void slide_in(skinslide_workspace *workspace, const float *points, float *slid, skinslide_patch_result *result) {
    skinslide_error error;
    result->size = sizeof *result;
    assert_ok(skinslide_slide(workspace, points, NULL, slid, result, &error), &error);
}

/* A grid in a pose, what exact gives for it, and a place for what is compared. */
typedef struct scene {
    test_mesh mesh;
    rig exact;
    float *pose, *expected, *slid;
    skinslide_patch_result result;
} scene;

static scene scene_of(int32_t columns) {
    scene s = {.mesh = triangle_grid(columns, columns)};
    s.exact = rig_of(&s.mesh, (skinslide_patch_setup){0});
    s.pose = random_pose(&s.mesh, 5);
    s.slid = malloc(POINT_BYTES(&s.mesh)), s.expected = malloc(POINT_BYTES(&s.mesh));
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EXACT, 0, ss_egl_load);
    slide_in(workspace, s.pose, s.expected, &s.result);
    skinslide_workspace_destroy(workspace);
    return s;
}

static void free_scene(scene *s) {
    free_rig(&s->exact);
    free(s->pose), free(s->expected), free(s->slid);
    free_mesh(&s->mesh);
}

static skinslide_patch_result expect_same(scene *s, skinslide_workspace *workspace) {
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    memset(s->slid, 0, POINT_BYTES(&s->mesh));
    slide_in(workspace, s->pose, s->slid, &result);
    assert_same_bytes(s->slid, s->expected, POINT_BYTES(&s->mesh));
    return result;
}

static int32_t found(const skinslide_patch_result *r) {
    return r->found_in_centre + r->found_in_3x3 + r->walked_vertices + r->searched_vertices;
}

/* ---- Agreement ---- */

/* Everything of a result that says what came out, not how it was found. */
static void compare_results(const skinslide_patch_result *egl, const skinslide_patch_result *exact) {
    assert_int_equal(egl->slid_vertices, exact->slid_vertices);
    assert_int_equal(egl->clamped_vertices, exact->clamped_vertices);
    assert_int_equal(egl->folded_faces, exact->folded_faces);
    assert_memory_equal(&egl->largest_slide, &exact->largest_slide, sizeof(double));
    assert_memory_equal(&egl->stretch_after, &exact->stretch_after, sizeof(double));
    assert_int_equal(found(egl), found(exact));
    assert_int_equal(exact->found_in_centre + exact->found_in_3x3, 0);
    assert_int_equal(egl->lost_textures, 0);
}

static void compare_lookups(const fixture *f, skinslide_patch_setup choices) {
    static const int32_t sides[] = {1, 16, 256, 0};
    size_t bytes = POINT_BYTES(&f->mesh);
    float *a = malloc(bytes), *b = malloc(bytes);
    rig r = rig_of(&f->mesh, choices);
    skinslide_workspace *exact = workspace_at(r.slider, SKINSLIDE_LOOKUP_EXACT, 0, ss_egl_load);
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
        skinslide_workspace *egl = workspace_at(r.slider, SKINSLIDE_LOOKUP_EGL, sides[s], ss_egl_load);
        for (uint64_t seed = 0; seed < 3; seed++) {
            float *pose = seed ? random_pose(&f->mesh, seed) : copy_points(&f->mesh);
            skinslide_patch_result with = SKINSLIDE_PATCH_RESULT_DEFAULT, without = SKINSLIDE_PATCH_RESULT_DEFAULT;
            slide_in(egl, pose, a, &with);
            slide_in(exact, pose, b, &without);
            assert_same_bytes(a, b, bytes);
            compare_results(&with, &without);
            free(pose);
        }
        skinslide_workspace_destroy(egl);
    }
    skinslide_workspace_destroy(exact);
    free_rig(&r);
    free(a), free(b);
}

static void both_lookups_give_the_same_bytes(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        for (int32_t way = 0; way < WAY_COUNT; way++) {
            skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
            if (choose_way(&f, way, &choices))
                compare_lookups(&f, choices);
        }
        free_mesh(&f.mesh);
    }
}

/* 19,602 triangles in a 4 x 4 texture: nearly all are below a texel, and are walked for. */
static void faces_below_a_texel(void **state) {
    (void)state;
    scene s = scene_of(99);
    skinslide_workspace *coarse = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 4, ss_egl_load);
    skinslide_workspace *fine = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, ss_egl_load);
    skinslide_patch_result few = expect_same(&s, coarse), many = expect_same(&s, fine);
    assert_true(few.walked_vertices > few.found_in_centre + few.found_in_3x3);
    assert_true(many.found_in_centre + many.found_in_3x3 > 9 * many.walked_vertices);
    skinslide_workspace_destroy(coarse), skinslide_workspace_destroy(fine);
    free_scene(&s);
}

/* ---- Which lookup ---- */

static skinslide_lookup_info choose(scene *s, skinslide_lookup lookup, fault planned, ss_egl_loader load,
                                    skinslide_device_info *device) {
    plan_fault(planned);
    skinslide_workspace *workspace = workspace_at(s->exact.slider, lookup, 0, load);
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_error error;
    assert_ok(skinslide_workspace_lookup(workspace, &info, device, &error), &error);
    skinslide_patch_result result = expect_same(s, workspace);
    assert_true((info.lookup == SKINSLIDE_LOOKUP_EGL) == (result.found_in_centre > 0));
    skinslide_workspace_destroy(workspace);
    return info;
}

static void auto_is_egl_on_hardware_only(void **state) {
    (void)state;
    const skinslide_lookup automatic = SKINSLIDE_LOOKUP_AUTO;
    scene s = scene_of(8);
    fault hardware = {.devices = 1, .shown = "EGL_EXT_device_drm", .renderer = "A GPU"};
    fault software = {.devices = 1, .shown = "EGL_MESA_device_software"};
    fault incomplete = hardware;
    incomplete.call = "glCheckFramebufferStatus", incomplete.times = -1, incomplete.code = GL_FRAMEBUFFER_UNSUPPORTED;
    skinslide_device_info device = SKINSLIDE_DEVICE_INFO_DEFAULT;
    skinslide_lookup_info info = choose(&s, automatic, hardware, load_with_faults, &device);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EGL);
    assert_string_equal(device.renderer, "A GPU");
    assert_string_equal(info.reason, "");
    info = choose(&s, automatic, software, load_with_faults, &device);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EXACT);
    assert_string_equal(info.reason, "no hardware EGL device with OpenGL ES 3: EGL has only software rasterisers");
    info = choose(&s, automatic, incomplete, load_with_faults, &device);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EXACT);
    assert_non_null(strstr(info.reason, "not complete"));
    info = choose(&s, automatic, (fault)NO_FAULT, load_nothing, &device);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EXACT);
    assert_non_null(strstr(info.reason, "libEGL"));
    assert_true(device.device == SKINSLIDE_ANY_DEVICE && device.largest_resolution == 0 && device.renderer[0] == 0);
    info = choose(&s, SKINSLIDE_LOOKUP_EGL, software, load_with_faults, &device);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EGL);
    assert_int_equal(device.software, 1);
    free_scene(&s);
}

/* A resolution above the device's limit: AUTO does without the device, EGL says so. */
static void a_resolution_above_the_limit(void **state) {
    (void)state;
    scene s = scene_of(4);
    skinslide_workspace_options options = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_AUTO, SKINSLIDE_ANY_DEVICE,
                                           600};
    skinslide_workspace *workspace;
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_error error;
    plan_fault((fault){.devices = 1, .shown = "EGL_EXT_device_drm", .renderer = "A GPU", .largest = 512});
    assert_ok(ss_workspace_create(s.exact.slider, &options, load_with_faults, &workspace, &error), &error);
    assert_ok(skinslide_workspace_lookup(workspace, &info, NULL, &error), &error);
    assert_int_equal(info.lookup, SKINSLIDE_LOOKUP_EXACT);
    assert_string_equal(info.reason, "resolution 600 is above the device's limit of 512");
    skinslide_workspace_destroy(workspace);
    options.lookup = SKINSLIDE_LOOKUP_EGL;
    assert_fails(ss_workspace_create(s.exact.slider, &options, load_with_faults, &workspace, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "lookup egl: resolution 600 is above the device's limit of 512");
    free_scene(&s);
}

static void egl_asked_for_and_not_to_be_had(void **state) {
    (void)state;
    scene s = scene_of(4);
    skinslide_workspace_options options = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    options.lookup = SKINSLIDE_LOOKUP_EGL;
    assert_fails(ss_workspace_create(s.exact.slider, &options, load_nothing, &workspace, &error), &error, SKINSLIDE_NO_DEVICE,
                 "lookup egl: no EGL device with OpenGL ES 3: libEGL.so.1: no such file");
    options.device = 1000;
    assert_fails(skinslide_workspace_create(s.exact.slider, &options, &workspace, &error), &error, SKINSLIDE_NO_DEVICE,
                 "lookup egl: no EGL device with OpenGL ES 3: there is no EGL device 1000, there are ...");
    assert_null(workspace);
    free_scene(&s);
}

static void options_that_cannot_be(void **state) {
    (void)state;
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_device_info device = SKINSLIDE_DEVICE_INFO_DEFAULT;
    skinslide_error error;
    skinslide_workspace_options options[3] = {{sizeof(skinslide_workspace_options), (skinslide_lookup)3, -1, 0},
                                              {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_AUTO, -2, 0},
                                              {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EXACT, -1, -1}};
    const char *texts[] = {"no such lookup: 3", "no such device: -2", "no such resolution: -1"};
    for (int i = 0; i < 3; i++)
        assert_fails(skinslide_choose_lookup(&options[i], &info, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, texts[i]);
    assert_int_equal(skinslide_choose_lookup(NULL, NULL, &device, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_workspace_lookup(NULL, &info, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_ok(skinslide_choose_lookup(NULL, &info, &device, &error), &error);
    print_message("auto: %s: %s\n", info.lookup == SKINSLIDE_LOOKUP_EGL ? "egl" : "exact",
                  info.lookup == SKINSLIDE_LOOKUP_EGL ? device.renderer : info.reason);
}

/* ---- In the middle of a shot ---- */

static skinslide_lookup_info lookup_of(const skinslide_workspace *workspace) {
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_error error;
    assert_ok(skinslide_workspace_lookup(workspace, &info, NULL, &error), &error);
    return info;
}

/* A device that fails once, in each way: the frame has the same bytes and counts one texture lost, unless the failure showed
 * before anything was drawn; the next frame has its texture again. */
static void a_context_lost_in_the_middle_of_a_shot(void **state) {
    (void)state;
    static const struct {
        const char *call;
        int32_t after;
        uint32_t code;
        int32_t lost;
    } cases[] = {
        {"eglMakeCurrent", 0, EGL_CONTEXT_LOST, 0}, /* at the draw: made again at once */
        {"eglMakeCurrent", 1, EGL_CONTEXT_LOST, 1},
        {"glGetGraphicsResetStatus", 0, 0x8253, 1},
        {"glGetGraphicsResetStatus", 1, 0x8255, 1},
        {"glGetError", 0, GL_OUT_OF_MEMORY, 1},
        {"glGetError", 1, 0x0507, 1},
        {"glMapBufferRange", 0, 0, 1},
        {"glUnmapBuffer", 0, 0, 1},
    };
    scene s = scene_of(12);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        plan_fault((fault)NO_FAULT);
        skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, load_with_faults);
        assert_int_equal(expect_same(&s, workspace).lost_textures, 0);
        plan_fault((fault){.call = cases[i].call, .after = cases[i].after, .times = 1, .code = cases[i].code, .devices = -1});
        skinslide_patch_result hit = expect_same(&s, workspace);
        assert_int_equal(faults_struck(), 1);
        assert_int_equal(hit.lost_textures, cases[i].lost);
        assert_int_equal(hit.found_in_centre > 0, !cases[i].lost);
        skinslide_patch_result next = expect_same(&s, workspace);
        assert_int_equal(next.lost_textures, 0);
        assert_true(next.found_in_centre > 0);
        assert_true(strlen(lookup_of(workspace).reason) > 0); /* which a new context does not make forgotten */
        skinslide_workspace_destroy(workspace);
    }
    free_scene(&s);
}

/* A device that takes every drawing and loses it: the second loss in a row is the last, one with answers between is not. */
static void a_device_that_never_finishes(void **state) {
    (void)state;
    scene s = scene_of(6);
    const fault resets = {.call = "glGetGraphicsResetStatus", .times = -1, .code = 0x8253, .devices = -1};
    plan_fault((fault)NO_FAULT);
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, load_with_faults);
    for (int i = 0; i < 3; i++) {
        plan_fault((fault){.call = resets.call, .times = 1, .code = resets.code, .devices = -1});
        assert_int_equal(expect_same(&s, workspace).lost_textures, 1);
        assert_int_equal(expect_same(&s, workspace).lost_textures, 0);
    }
    plan_fault(resets);
    for (int frame = 0; frame < 5; frame++)
        assert_int_equal(expect_same(&s, workspace).lost_textures, 1);
    assert_int_equal(faults_struck(), 2);
    assert_non_null(strstr(lookup_of(workspace).reason, "the context was lost, 0x8253"));
    skinslide_workspace_destroy(workspace);
    free_scene(&s);
}

/* A device that goes and does not come back: every frame counts it, one attempt is made, and the workspace says why. */
static void a_device_that_is_gone(void **state) {
    (void)state;
    scene s = scene_of(6);
    skinslide_error error;
    plan_fault((fault)NO_FAULT);
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, load_with_faults);
    plan_fault((fault){.call = "eglMakeCurrent", .times = -1, .code = EGL_CONTEXT_LOST, .devices = 1});
    for (int frame = 0; frame < 3; frame++)
        assert_int_equal(expect_same(&s, workspace).lost_textures, 1);
    assert_int_equal(faults_struck(), 3); /* the draw; then the device and the surfaceless platform, anew */
    assert_non_null(strstr(lookup_of(workspace).reason, "EGL_CONTEXT_LOST"));
    int32_t side;
    uint32_t texel;
    assert_int_equal(skinslide_workspace_id_buffer(workspace, 0, &side, &texel, &error), SKINSLIDE_DEVICE_FAILED);
    skinslide_workspace_destroy(workspace);
    free_scene(&s);
}

/* Answers that were never drawn: any faces at all, and numbers of none. */
static void a_device_that_answers_nonsense(void **state) {
    (void)state;
    scene s = scene_of(20);
    const uint32_t most[] = {(uint32_t)s.mesh.face_count, UINT32_MAX};
    for (int i = 0; i < 2; i++) {
        plan_fault((fault){.call = "glMapBufferRange", .times = -1, .code = most[i], .devices = -1});
        skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, load_with_faults);
        assert_int_equal(expect_same(&s, workspace).lost_textures, 0);
        skinslide_workspace_destroy(workspace);
    }
    free_scene(&s);
}

/* A host that ends the display that it shares with us, and one that has it begin again. */
static void a_host_that_ends_the_display(void **state) {
    (void)state;
    scene s = scene_of(10);
    for (int again = 0; again < 2; again++) {
        skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, ss_egl_load);
        assert_true(expect_same(&s, workspace).found_in_centre > 0);
        ss_device_request request = {.load = ss_egl_load, .device = SKINSLIDE_ANY_DEVICE};
        ss_egl *host;
        skinslide_error error;
        assert_ok(ss_egl_open(&request, &host, &error), &error);
        EGLBoolean (*terminate)(EGLDisplay) = (EGLBoolean(*)(EGLDisplay))host->api.eglGetProcAddress("eglTerminate");
        assert_non_null(terminate);
        assert_true(terminate(host->display));
        if (again)
            assert_true(host->api.eglInitialize(host->display, NULL, NULL));
        for (int frame = 0; frame < 2; frame++) {
            skinslide_patch_result result = expect_same(&s, workspace);
            assert_int_equal(result.lost_textures, 0);
            assert_true(result.found_in_centre > 0);
        }
        skinslide_workspace_destroy(workspace);
        free(host); /* its context went with the display */
    }
    free_scene(&s);
}

/* ---- Threads ---- */

typedef struct job {
    const scene *s;
    skinslide_workspace *workspace; /* NULL: its own */
    bool same;
} job;

/* What a thread finds is told afterwards: cmocka's assertions are for the thread of the test. */
static void *slide_on_thread(void *argument) {
    job *own = argument;
    skinslide_workspace_options options = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EGL, SKINSLIDE_ANY_DEVICE, 0};
    skinslide_workspace *workspace = own->workspace;
    size_t bytes = POINT_BYTES(&own->s->mesh);
    float *slid = malloc(bytes);
    own->same = workspace || !skinslide_workspace_create(own->s->exact.slider, &options, &workspace, NULL);
    for (int frame = 0; frame < 5 && own->same; frame++) {
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        own->same = !skinslide_slide(workspace, own->s->pose, NULL, slid, &result, NULL) && !result.lost_textures &&
                    result.found_in_centre > 0 && memcmp(slid, own->s->expected, bytes) == 0;
    }
    if (!own->workspace)
        skinslide_workspace_destroy(workspace);
    free(slid);
    return NULL;
}

static void sixteen_threads_at_once(void **state) {
    (void)state;
    enum { THREADS = 16 };
    scene s = scene_of(30);
    pthread_t threads[THREADS];
    job jobs[THREADS];
    for (int t = 0; t < THREADS; t++) {
        jobs[t] = (job){&s, NULL, false};
        assert_int_equal(pthread_create(&threads[t], NULL, slide_on_thread, &jobs[t]), 0);
    }
    for (int t = 0; t < THREADS; t++)
        pthread_join(threads[t], NULL);
    for (int t = 0; t < THREADS; t++)
        assert_true(jobs[t].same);
    free_scene(&s);
}

static void a_workspace_goes_from_thread_to_thread(void **state) {
    (void)state;
    scene s = scene_of(10);
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, ss_egl_load);
    for (int t = 0; t < 4; t++) {
        pthread_t thread;
        job own = {&s, workspace, false};
        assert_int_equal(pthread_create(&thread, NULL, slide_on_thread, &own), 0);
        pthread_join(thread, NULL);
        assert_true(own.same);
        expect_same(&s, workspace);
    }
    skinslide_workspace_destroy(workspace);
    free_scene(&s);
}

/* ---- Growth, pictures ---- */

static void workspaces_come_and_go(void **state) {
    (void)state;
    scene s = scene_of(6);
    size_t start = 0;
    int rounds = __SANITIZE_ADDRESS__ ? 60 : 300;
    for (int i = 0; i < rounds; i++) {
        if (i == 50)
            start = mallinfo2().uordblks;
        skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 0, ss_egl_load);
        expect_same(&s, workspace);
        skinslide_workspace_destroy(workspace);
    }
    int64_t grown = (int64_t)(mallinfo2().uordblks - start);
    print_message("%lld bytes over %d workspaces\n", (long long)grown, rounds - 50);
    if (!__SANITIZE_ADDRESS__)
        assert_true(grown < (int64_t)rounds * 256);
    free_scene(&s);
}

static void the_texture_can_be_read(void **state) {
    (void)state;
    scene s = scene_of(8);
    skinslide_error error;
    int32_t side = 0;
    static uint32_t texels[32 * 32];
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, 32, ss_egl_load);
    skinslide_workspace *exact = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EXACT, 0, ss_egl_load);
    assert_fails(skinslide_workspace_id_buffer(workspace, 0, &side, texels, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the workspace has slid no frame yet");
    expect_same(&s, workspace);
    assert_fails(skinslide_workspace_id_buffer(exact, 0, &side, texels, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the workspace's lookup is exact: it draws no ID buffer");
    assert_int_equal(skinslide_workspace_id_buffer(workspace, 1, &side, texels, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_ok(skinslide_workspace_id_buffer(workspace, 0, &side, NULL, &error), &error);
    assert_int_equal(side, 32);
    assert_ok(skinslide_workspace_id_buffer(workspace, 0, &side, texels, &error), &error);
    assert_int_equal(texels[0], 0); /* the circle does not reach the corner */
    assert_true(texels[16 * 32 + 16] >= 1 && texels[16 * 32 + 16] <= (uint32_t)s.mesh.face_count);
    skinslide_workspace_destroy(workspace), skinslide_workspace_destroy(exact);
    free_scene(&s);
}

static void a_texture_that_cannot_be_read_writes_nothing(void **state) {
    (void)state;
    enum { SIDE = 32 };
    scene s = scene_of(8);
    static uint32_t texels[SIDE * SIDE];
    int32_t side = -7;
    skinslide_error error;
    plan_fault((fault)NO_FAULT);
    skinslide_workspace *workspace = workspace_at(s.exact.slider, SKINSLIDE_LOOKUP_EGL, SIDE, load_with_faults);
    expect_same(&s, workspace);
    memset(texels, 0xab, sizeof texels);
    plan_fault((fault){.call = "glGetError", .times = 1, .code = GL_OUT_OF_MEMORY, .devices = -1});
    assert_fails(skinslide_workspace_id_buffer(workspace, 0, &side, texels, &error), &error, SKINSLIDE_DEVICE_FAILED,
                 "reading the ID buffer: OpenGL error 0x0505");
    assert_int_equal(side, -7);
    for (int i = 0; i < SIDE * SIDE; i++)
        assert_int_equal(texels[i], 0xabababab);
    assert_ok(skinslide_workspace_id_buffer(workspace, 0, &side, texels, &error), &error);
    assert_int_equal(texels[0], 0);
    skinslide_workspace_destroy(workspace);
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_lookups_give_the_same_bytes),
        cmocka_unit_test(faces_below_a_texel),
        cmocka_unit_test(auto_is_egl_on_hardware_only),
        cmocka_unit_test(a_resolution_above_the_limit),
        cmocka_unit_test(egl_asked_for_and_not_to_be_had),
        cmocka_unit_test(options_that_cannot_be),
        cmocka_unit_test(a_context_lost_in_the_middle_of_a_shot),
        cmocka_unit_test(a_device_that_never_finishes),
        cmocka_unit_test(a_device_that_is_gone),
        cmocka_unit_test(a_device_that_answers_nonsense),
        cmocka_unit_test(a_host_that_ends_the_display),
        cmocka_unit_test(sixteen_threads_at_once),
        cmocka_unit_test(a_workspace_goes_from_thread_to_thread),
        cmocka_unit_test(workspaces_come_and_go),
        cmocka_unit_test(the_texture_can_be_read),
        cmocka_unit_test(a_texture_that_cannot_be_read_writes_nothing),
    };
    return cmocka_run_group_tests_name("lookup", tests, NULL, NULL);
}
