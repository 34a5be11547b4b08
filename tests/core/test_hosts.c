/* Beside a host that draws with EGL itself, on the same thread and on another: what it has current and what it has painted
 * stay, and frames and pictures are those of a thread without a host. Needs an EGL; software Mesa is one. */
#define _POSIX_C_SOURCE 200809L /* pthread */
#include "hosts.h"
#include "skinslide/picture.h"
#include "support.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 32, ROUNDS = 3 };

/* A frame slid with lookup EGL, and a picture of it. */
typedef struct product {
    skinslide_status status;
    float *slid;
    uint8_t pixels[SIDE * SIDE * 4];
} product;

static skinslide_status slide(const skinslide_slider *slider, const float *points, float *slid) {
    skinslide_workspace_options options = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    skinslide_workspace *workspace = NULL;
    options.lookup = SKINSLIDE_LOOKUP_EGL;
    skinslide_status status = skinslide_workspace_create(slider, &options, &workspace, NULL);
    if (!status)
        status = skinslide_slide(workspace, points, NULL, slid, NULL, NULL);
    skinslide_workspace_destroy(workspace);
    return status;
}

static skinslide_status draw(const test_mesh *mesh, const float *points, uint8_t *pixels) {
    const skinslide_canvas_options options = {sizeof options, SIDE, SIDE, SKINSLIDE_PIXELS_BYTES, SKINSLIDE_ANY_DEVICE, 1};
    const skinslide_viewport all = {0, 0, SIDE, SIDE};
    const double up[3] = {0, 1, 0};
    const float grey[3] = {0.5f, 0.5f, 0.5f}, *poses[1] = {points};
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    skinslide_subject subject = {
        .size = sizeof subject, .mesh = &view, .faces = faces, .face_count = mesh->face_count, .poses = poses, .pose_count = 1};
    skinslide_tessellation *tessellation = NULL;
    skinslide_canvas *canvas = NULL;
    skinslide_camera camera;
    skinslide_status status = skinslide_tessellation_create(&view, NULL, faces, 1, &tessellation, NULL);
    skinslide_figure figure = {.size = sizeof figure, .tessellation = tessellation, .points = points, .squares = 1};
    if (!status)
        status = skinslide_frame_faces(&subject, up, 1, &camera, NULL);
    if (!status)
        status = skinslide_canvas_create(&options, &canvas, NULL);
    if (!status)
        status = skinslide_canvas_clear(canvas, grey, NULL);
    if (!status)
        status = skinslide_canvas_draw(canvas, &all, &camera, &figure, NULL);
    if (!status)
        status = skinslide_canvas_read(canvas, pixels, NULL);
    skinslide_canvas_destroy(canvas);
    skinslide_tessellation_destroy(tessellation);
    free(faces);
    return status;
}

typedef struct work {
    test_mesh mesh;
    rig r;
    float *points;
    product made;
} work;

/* No assertions: it runs on a thread of its own, too. */
static void *make(void *argument) {
    work *w = argument;
    w->made.status = slide(w->r.slider, w->points, w->made.slid);
    if (!w->made.status)
        w->made.status = draw(&w->mesh, w->made.slid, w->made.pixels);
    return NULL;
}

static work begin_work(void) {
    work w = {.mesh = grid_with_holes(true)};
    w.r = rig_of(&w.mesh, setup_of(NULL, 0));
    w.points = random_pose(&w.mesh, 3), w.made.slid = copy_points(&w.mesh);
    return w;
}

static void end_work(work *w) {
    free(w->points), free(w->made.slid);
    free_rig(&w->r);
    free_mesh(&w->mesh);
}

static void assert_same_product(const work *a, const work *b) {
    assert_int_equal(a->made.status, SKINSLIDE_OK);
    assert_same_bytes(a->made.slid, b->made.slid, POINT_BYTES(&a->mesh));
    assert_same_bytes(a->made.pixels, b->made.pixels, sizeof a->made.pixels);
}

typedef void each_host(const host *h, EGLenum api, EGLenum bound, const work *alone);

/* OpenGL and OpenGL ES, on our display and on another, with its API bound and with the other left bound. */
static void for_each_host(each_host *check) {
    const EGLenum apis[] = {EGL_OPENGL_API, EGL_OPENGL_ES_API};
    const EGLenum platforms[] = {EGL_PLATFORM_DEVICE_EXT, EGL_PLATFORM_SURFACELESS_MESA};
    work alone = begin_work();
    make(&alone);
    assert_int_equal(alone.made.status, SKINSLIDE_OK);
    for (int i = 0; i < 8; i++) {
        EGLenum api = apis[i & 1], bound = apis[i >> 1 & 1];
        host h = host_with(api, platforms[i >> 2]);
        paint_host(&h, api);
        h.egl.eglBindAPI(bound);
        check(&h, api, bound, &alone);
        end_host(&h);
    }
    end_work(&alone);
}

static void check_same_thread(const host *h, EGLenum api, EGLenum bound, const work *alone) {
    work w = begin_work();
    for (int round = 0; round < ROUNDS; round++) {
        make(&w);
        assert_current(h, api, bound);
        assert_painted(h, api);
        assert_same_product(&w, alone);
    }
    end_work(&w);
}

static void on_the_same_thread(void **state) {
    (void)state;
    for_each_host(check_same_thread);
}

/* The host goes on painting meanwhile. */
static void check_another_thread(const host *h, EGLenum api, EGLenum bound, const work *alone) {
    work w = begin_work();
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, make, &w), 0);
    for (int round = 0; round < ROUNDS; round++) {
        paint_host(h, api);
        assert_painted(h, api);
    }
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_current(h, api, bound);
    assert_painted(h, api);
    assert_same_product(&w, alone);
    end_work(&w);
}

static void on_another_thread(void **state) {
    (void)state;
    for_each_host(check_another_thread);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_the_same_thread),
        cmocka_unit_test(on_another_thread),
    };
    return cmocka_run_group_tests_name("hosts", tests, NULL, NULL);
}
