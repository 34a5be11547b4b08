/* What is drawn on: that it is made, filled and read, on its own thread, beside a host; and every way in which it cannot be. */
#include "canvas.h"
#include "faults.h"
#include "hosts.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static skinslide_canvas_options sized(int32_t width, int32_t height, skinslide_pixels pixels) {
    return (skinslide_canvas_options){sizeof(skinslide_canvas_options), width, height, pixels, SKINSLIDE_ANY_DEVICE, 1};
}

static skinslide_canvas *canvas_of(skinslide_canvas_options options) {
    skinslide_canvas *canvas = NULL;
    skinslide_error error;
    assert_ok(skinslide_canvas_create(&options, &canvas, &error), &error);
    return canvas;
}

static double encoded(double light) {
    return 255 * (light < 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055);
}

/* ---- A sheet to draw ---- */

typedef struct scene {
    test_mesh mesh;
    skinslide_tessellation *tessellation;
    skinslide_camera camera;
    skinslide_figure figure;
    skinslide_viewport all;
} scene;

static scene set_scene(int32_t side, int32_t width, int32_t height, bool subdivided) {
    scene s = {.mesh = quad_grid(side, side), .all = {0, 0, width, height}};
    const skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    const double up[3] = {0, 1, 0};
    skinslide_mesh view = view_of(&s.mesh);
    skinslide_error error;
    int32_t *faces = all_faces(&s.mesh);
    const float *poses[1] = {s.mesh.points};
    const skinslide_subject subject = {.size = sizeof(skinslide_subject),
                                       .mesh = &view,
                                       .faces = faces,
                                       .face_count = s.mesh.face_count,
                                       .poses = poses,
                                       .pose_count = 1};
    view.subdivision = subdivided ? &own : NULL;
    assert_ok(skinslide_tessellation_create(&view, NULL, faces, 1, &s.tessellation, &error), &error);
    assert_ok(skinslide_frame_faces(&subject, up, (double)width / height, &s.camera, &error), &error);
    s.figure = (skinslide_figure){
        .size = sizeof(skinslide_figure), .tessellation = s.tessellation, .points = s.mesh.points, .squares = 1};
    free(faces);
    return s;
}

static void end_scene(scene *s) {
    skinslide_tessellation_destroy(s->tessellation);
    free_mesh(&s->mesh);
}

static skinslide_status draw(skinslide_canvas *canvas, const scene *s, skinslide_error *error) {
    return skinslide_canvas_draw(canvas, &s->all, &s->camera, &s->figure, error);
}

static void draw_and_read(skinslide_canvas *canvas, const scene *s, void *pixels) {
    const float blue[3] = {0, 0, 1};
    skinslide_error error;
    assert_ok(skinslide_canvas_clear(canvas, blue, &error), &error);
    assert_ok(draw(canvas, s, &error), &error);
    assert_ok(skinslide_canvas_read(canvas, pixels, &error), &error);
}

/* ---- Filling ---- */

/* Bytes to a level, floats to the 11 bits of a half. Below black and above white is clamped in bytes. */
static void a_colour_fills_it(void **state) {
    (void)state;
    static const float colours[5][3] = {{0, 0.5f, 1}, {0.001f, 0.003f, 0.004f}, {0.18f, 0.3f, 0.9f}, {-1, 2, 0.2f}, {0, 0, 0}};
    static const int32_t sizes[4][2] = {{1, 1}, {37, 23}, {1, 9}, {64, 64}};
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 5; c++) {
            int32_t count = sizes[i][0] * sizes[i][1];
            skinslide_canvas *bytes = canvas_of(sized(sizes[i][0], sizes[i][1], SKINSLIDE_PIXELS_BYTES));
            skinslide_canvas *floats = canvas_of(sized(sizes[i][0], sizes[i][1], SKINSLIDE_PIXELS_FLOATS));
            uint8_t *levels = calloc((size_t)count, 4);
            float(*lights)[4] = calloc((size_t)count, sizeof *lights);
            skinslide_error error;
            assert_ok(skinslide_canvas_clear(bytes, colours[c], &error), &error);
            assert_ok(skinslide_canvas_clear(floats, colours[c], &error), &error);
            assert_ok(skinslide_canvas_read(bytes, levels, &error), &error);
            assert_ok(skinslide_canvas_read(floats, lights, &error), &error);
            for (int32_t p = 0; p < count; p++) {
                for (int k = 0; k < 3; k++) {
                    assert_near(levels[4 * p + k], encoded(fmin(fmax(colours[c][k], 0), 1)), 1);
                    assert_near(lights[p][k], colours[c][k], 1e-3 * fabs(colours[c][k]) + 1e-7);
                }
                assert_int_equal(levels[4 * p + 3], 255);
                assert_true(lights[p][3] == 1);
            }
            skinslide_canvas_destroy(bytes), skinslide_canvas_destroy(floats);
            free(levels), free(lights);
        }
}

/* A clear forgets what was drawn, its depth too. */
static void filled_again(void **state) {
    (void)state;
    enum { SIDE = 32 };
    static uint8_t first[SIDE * SIDE * 4], second[SIDE * SIDE * 4];
    scene s = set_scene(4, SIDE, SIDE, false);
    skinslide_canvas *canvas = canvas_of(sized(SIDE, SIDE, SKINSLIDE_PIXELS_BYTES));
    draw_and_read(canvas, &s, first);
    s.camera.to_camera[14] += 1, draw_and_read(canvas, &s, second); /* nearer */
    s.camera.to_camera[14] -= 1, draw_and_read(canvas, &s, second);
    assert_same_bytes(first, second, sizeof first);
    skinslide_canvas_destroy(canvas);
    end_scene(&s);
}

/* ---- Sizes ---- */

static void sizes_within_limits(void **state) {
    (void)state;
    static const int32_t sizes[4][2] = {{16384, 1}, {1, 16384}, {4095, 3}, {1920, 1080}};
    for (int i = 0; i < 4; i++) {
        size_t count = (size_t)sizes[i][0] * (size_t)sizes[i][1];
        uint32_t *pixels = calloc(count, sizeof *pixels);
        scene s = set_scene(4, sizes[i][0], sizes[i][1], false);
        skinslide_canvas *canvas = canvas_of(sized(sizes[i][0], sizes[i][1], SKINSLIDE_PIXELS_BYTES));
        draw_and_read(canvas, &s, pixels);
        assert_true(pixels[0] == 0xffff0000u && pixels[count - 1] == 0xffff0000u); /* blue */
        assert_true(pixels[count / 2 + (size_t)sizes[i][0] / 2 * (sizes[i][1] % 2 == 0)] != 0xffff0000u);
        skinslide_canvas_destroy(canvas);
        end_scene(&s);
        free(pixels);
    }
}

static void sizes_beyond_them(void **state) {
    (void)state;
    static const int32_t sizes[6][2] = {{0, 4}, {4, 0}, {-1, 4}, {16385, 1}, {1, INT32_MAX}, {16384, 4097}};
    skinslide_canvas *canvas = NULL;
    skinslide_error error;
    for (int i = 0; i < 6; i++) {
        const skinslide_canvas_options options = sized(sizes[i][0], sizes[i][1], SKINSLIDE_PIXELS_BYTES);
        assert_fails(skinslide_canvas_create(&options, &canvas, &error), &error, SKINSLIDE_BAD_ARGUMENT, "a picture of ...");
    }
    const skinslide_canvas_options large = sized(600, 300, SKINSLIDE_PIXELS_BYTES);
    plan_fault((fault){.devices = -1, .largest = 512});
    assert_fails(ss_canvas_create(&large, load_with_faults, &canvas, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "a picture of 600 by 300 pixels is above the device's limit of 512");
    assert_null(canvas);
}

/* ---- The same again ---- */

static void the_same_picture_has_the_same_bytes(void **state) {
    (void)state;
    enum { WIDTH = 200, HEIGHT = 117 };
    static float first[WIDTH * HEIGHT * 4], again[WIDTH * HEIGHT * 4];
    scene s = set_scene(9, WIDTH, HEIGHT, true);
    skinslide_canvas *canvas = canvas_of(sized(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS));
    draw_and_read(canvas, &s, first);
    for (int i = 0; i < 5; i++) {
        draw_and_read(canvas, &s, again);
        assert_same_bytes(first, again, sizeof first);
    }
    skinslide_canvas_destroy(canvas);
    canvas = canvas_of(sized(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS));
    draw_and_read(canvas, &s, again);
    assert_same_bytes(first, again, sizeof first);
    skinslide_canvas_destroy(canvas);
    end_scene(&s);
}

enum { SIDE_OF_THREADS = 120 };

static void *draw_often(void *given) {
    const scene *s = given;
    uint8_t *pixels = calloc(SIDE_OF_THREADS * SIDE_OF_THREADS, 4), *first = calloc(SIDE_OF_THREADS * SIDE_OF_THREADS, 4);
    skinslide_canvas *canvas = canvas_of(sized(SIDE_OF_THREADS, SIDE_OF_THREADS, SKINSLIDE_PIXELS_BYTES));
    draw_and_read(canvas, s, first);
    for (int i = 0; i < 10; i++) {
        draw_and_read(canvas, s, pixels);
        assert_same_bytes(first, pixels, SIDE_OF_THREADS * SIDE_OF_THREADS * 4);
    }
    skinslide_canvas_destroy(canvas);
    free(pixels);
    return first;
}

/* One tessellation, a canvas each. */
static void threads_draw_the_same(void **state) {
    (void)state;
    scene s = set_scene(9, SIDE_OF_THREADS, SIDE_OF_THREADS, true);
    pthread_t threads[3];
    void *pictures[3];
    for (int i = 0; i < 3; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, draw_often, &s), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pthread_join(threads[i], &pictures[i]), 0);
    for (int i = 1; i < 3; i++)
        assert_same_bytes(pictures[0], pictures[i], SIDE_OF_THREADS * SIDE_OF_THREADS * 4);
    for (int i = 0; i < 3; i++)
        free(pictures[i]);
    end_scene(&s);
}

/* ---- The host ---- */

/* After each call, good or failed, the host's own context is current. */
static void a_hosts_context_stays_current(void **state) {
    (void)state;
    const EGLenum apis[] = {EGL_OPENGL_API, EGL_OPENGL_ES_API};
    static uint8_t pixels[16 * 16 * 4];
    const float grey[3] = {0.5f, 0.5f, 0.5f};
    for (int i = 0; i < 4; i++) {
        host h = host_with(apis[i & 1], EGL_PLATFORM_DEVICE_EXT);
        EGLenum bound = apis[i >> 1];
        skinslide_canvas *canvas = NULL;
        skinslide_error error;
        scene s = set_scene(2, 16, 16, false);
        const skinslide_canvas_options options = sized(16, 16, SKINSLIDE_PIXELS_BYTES);
        h.egl.eglBindAPI(bound);
        plan_fault((fault)NO_FAULT);
        assert_ok(ss_canvas_create(&options, load_with_faults, &canvas, &error), &error);
        assert_current(&h, apis[i & 1], bound);
        assert_ok(skinslide_canvas_clear(canvas, grey, &error), &error);
        assert_current(&h, apis[i & 1], bound);
        assert_ok(draw(canvas, &s, &error), &error);
        assert_current(&h, apis[i & 1], bound);
        assert_ok(skinslide_canvas_read(canvas, pixels, &error), &error);
        assert_current(&h, apis[i & 1], bound);
        plan_fault((fault){.call = "glGetError", .times = -1, .code = GL_OUT_OF_MEMORY, .devices = -1});
        assert_int_equal(draw(canvas, &s, &error), SKINSLIDE_DEVICE_FAILED);
        assert_current(&h, apis[i & 1], bound);
        skinslide_canvas_destroy(canvas);
        assert_current(&h, apis[i & 1], bound);
        end_scene(&s);
        end_host(&h);
    }
}

/* ---- Devices that cannot ---- */

static void devices_that_cannot_make_one(void **state) {
    (void)state;
    static const struct {
        fault planned;
        skinslide_status status;
        const char *text;
    } cases[] = {
        {{.call = "glCheckFramebufferStatus", .times = -1, .code = GL_FRAMEBUFFER_UNSUPPORTED, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "the device's framebuffer of 16 by 8 pixels is not complete: 0x8cdd"},
        {{.call = "glCheckFramebufferStatus", .after = 1, .times = -1, .code = GL_FRAMEBUFFER_UNSUPPORTED, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "the device's framebuffer of 16 by 8 pixels is not complete: 0x8cdd"},
        {{.call = "glGetProgramiv", .times = 1, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "the device's compiler refuses a program: ..."},
        {{.call = "glGetProgramiv", .after = 1, .times = 1, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "the device's compiler refuses a program: ..."},
        {{.call = "glGetError", .times = -1, .code = GL_OUT_OF_MEMORY, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "making a canvas: OpenGL error 0x0505"},
        {{.call = "eglMakeCurrent", .after = 1, .times = -1, .code = EGL_CONTEXT_LOST, .devices = -1},
         SKINSLIDE_DEVICE_FAILED,
         "eglMakeCurrent: EGL_CONTEXT_LOST"},
        {{.call = "eglCreateContext", .times = -1, .code = EGL_BAD_ALLOC, .devices = 1},
         SKINSLIDE_NO_DEVICE,
         "no EGL device with OpenGL ES 3: EGL device 0..."},
        {{.hidden = "GL_EXT_color_buffer", .devices = -1},
         SKINSLIDE_UNSUPPORTED,
         "the device draws no floats: it lacks GL_EXT_color_buffer_float"},
    };
    const skinslide_canvas_options options = sized(16, 8, SKINSLIDE_PIXELS_FLOATS);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_canvas *canvas = NULL;
        skinslide_error error;
        plan_fault(cases[i].planned);
        assert_fails(ss_canvas_create(&options, load_with_faults, &canvas, &error), &error, cases[i].status, cases[i].text);
        assert_null(canvas);
    }
    skinslide_canvas *canvas = NULL;
    skinslide_error error;
    assert_fails(ss_canvas_create(&options, load_nothing, &canvas, &error), &error, SKINSLIDE_NO_DEVICE,
                 "no EGL device with OpenGL ES 3: libEGL.so.1: no such file");
}

/* Bytes need no floats. */
static void without_floats_bytes_do(void **state) {
    (void)state;
    const skinslide_canvas_options options = sized(16, 8, SKINSLIDE_PIXELS_BYTES);
    skinslide_canvas *canvas = NULL;
    skinslide_error error;
    plan_fault((fault){.hidden = "GL_EXT_color_buffer", .devices = -1});
    assert_ok(ss_canvas_create(&options, load_with_faults, &canvas, &error), &error);
    skinslide_canvas_destroy(canvas);
}

/* In each call; what is read into stays as it was. Once the fault is over, the canvas can be used again. */
static void devices_that_fail_later(void **state) {
    (void)state;
    static const fault faults[] = {
        {.call = "eglMakeCurrent", .times = -1, .code = EGL_CONTEXT_LOST, .devices = -1},
        {.call = "glGetError", .times = -1, .code = GL_OUT_OF_MEMORY, .devices = -1},
        {.call = "glGetGraphicsResetStatus", .times = -1, .code = 0x8253, .devices = -1}, /* GL_GUILTY_CONTEXT_RESET */
    };
    static const char *const texts[3][3] = {
        {"eglMakeCurrent: EGL_CONTEXT_LOST", "eglMakeCurrent: EGL_CONTEXT_LOST", "eglMakeCurrent: EGL_CONTEXT_LOST"},
        {"clearing a canvas: OpenGL error 0x0505", "drawing a figure: OpenGL error 0x0505",
         "reading a canvas: OpenGL error 0x0505"},
        {"clearing a canvas: the context was lost, 0x8253", "drawing a figure: the context was lost, 0x8253",
         "reading a canvas: the context was lost, 0x8253"}};
    const skinslide_canvas_options options = sized(16, 16, SKINSLIDE_PIXELS_BYTES);
    const float grey[3] = {0.5f, 0.5f, 0.5f};
    static uint8_t pixels[16 * 16 * 4], before[16 * 16 * 4];
    scene s = set_scene(2, 16, 16, false);
    for (int i = 0; i < 3; i++) {
        skinslide_canvas *canvas = NULL;
        skinslide_error error;
        plan_fault((fault)NO_FAULT);
        assert_ok(ss_canvas_create(&options, load_with_faults, &canvas, &error), &error);
        plan_fault(faults[i]);
        memset(pixels, 3, sizeof pixels), memset(before, 3, sizeof before);
        assert_fails(skinslide_canvas_clear(canvas, grey, &error), &error, SKINSLIDE_DEVICE_FAILED, texts[i][0]);
        assert_fails(draw(canvas, &s, &error), &error, SKINSLIDE_DEVICE_FAILED, texts[i][1]);
        assert_fails(skinslide_canvas_read(canvas, pixels, &error), &error, SKINSLIDE_DEVICE_FAILED, texts[i][2]);
        assert_same_bytes(pixels, before, sizeof pixels);
        plan_fault((fault)NO_FAULT);
        draw_and_read(canvas, &s, pixels);
        skinslide_canvas_destroy(canvas);
    }
    end_scene(&s);
}

/* ---- Bad arguments ---- */

static void refused(skinslide_canvas *canvas, const scene *s, skinslide_status status, const char *text) {
    skinslide_error error;
    assert_fails(draw(canvas, s, &error), &error, status, text);
}

static void bad_canvases_are_named(void **state) {
    (void)state;
    skinslide_canvas *canvas = NULL;
    skinslide_device_info info = SKINSLIDE_DEVICE_INFO_DEFAULT;
    skinslide_error error;
    skinslide_canvas_options options = sized(4, 4, (skinslide_pixels)2);
    const float grey[3] = {0.5f, 0.5f, 0.5f}, nan[3] = {0, NAN, 0}, endless[3] = {0, 0, INFINITY};
    assert_fails(skinslide_canvas_create(&options, &canvas, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no such pixels: 2");
    options.pixels = SKINSLIDE_PIXELS_BYTES, options.device = -2;
    assert_fails(skinslide_canvas_create(&options, &canvas, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no such device: -2");
    assert_fails(skinslide_canvas_create(NULL, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no place for the canvas");
    assert_null(canvas);
    canvas = canvas_of(sized(4, 4, SKINSLIDE_PIXELS_BYTES));
    assert_fails(skinslide_canvas_clear(canvas, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no colour");
    assert_fails(skinslide_canvas_clear(NULL, grey, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no colour");
    assert_fails(skinslide_canvas_clear(canvas, nan, &error), &error, SKINSLIDE_BAD_ARGUMENT, "the colour (0, ...");
    assert_fails(skinslide_canvas_clear(canvas, endless, &error), &error, SKINSLIDE_BAD_ARGUMENT, "the colour (0, ...");
    assert_fails(skinslide_canvas_read(canvas, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place...");
    assert_fails(skinslide_canvas_read(NULL, &info, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place...");
    assert_fails(skinslide_canvas_device(NULL, &info, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place...");
    assert_fails(skinslide_canvas_device(canvas, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place...");
    assert_ok(skinslide_canvas_device(canvas, &info, &error), &error);
    assert_true(strlen(info.renderer) > 0);
    skinslide_canvas_destroy(canvas);
    skinslide_canvas_destroy(NULL);
}

static void bad_viewports_are_named(void **state) {
    (void)state;
    static const skinslide_viewport bad[] = {{0, 0, 0, 4},  {0, 0, 4, 0},  {-1, 0, 4, 4},        {0, -1, 4, 4},
                                             {0, 0, 17, 4}, {9, 0, 8, 16}, {INT32_MAX, 0, 1, 1}, {0, 1, 16, INT32_MAX}};
    skinslide_canvas *canvas = canvas_of(sized(16, 16, SKINSLIDE_PIXELS_BYTES));
    skinslide_error error;
    scene s = set_scene(2, 16, 16, false);
    for (int i = 0; i < 8; i++) {
        s.all = bad[i];
        refused(canvas, &s, SKINSLIDE_BAD_ARGUMENT, "the viewport is not on the canvas of 16 by 16 pixels");
    }
    const char *missing = "no canvas, viewport, camera, or figure";
    s.all = (skinslide_viewport){0, 0, 16, 16};
    refused(NULL, &s, SKINSLIDE_BAD_ARGUMENT, missing);
    assert_fails(skinslide_canvas_draw(canvas, NULL, &s.camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT, missing);
    assert_fails(skinslide_canvas_draw(canvas, &s.all, NULL, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT, missing);
    assert_fails(skinslide_canvas_draw(canvas, &s.all, &s.camera, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, missing);
    skinslide_canvas_destroy(canvas);
    end_scene(&s);
}

static void bad_figures_are_named(void **state) {
    (void)state;
    const float bad_squares[] = {0, -1, NAN, INFINITY};
    const float bad_scales[][2] = {{1, 1}, {2, 1}, {NAN, 1}, {0, INFINITY}, {-3e38f, 3e38f}, {0, 1e-45f}};
    const char *matrix_text = "the camera, or the mesh's way to the world, is not finite or has no inverse";
    float values[9] = {0}, points[27];
    double singular[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    skinslide_canvas *canvas = canvas_of(sized(16, 16, SKINSLIDE_PIXELS_BYTES));
    scene s = set_scene(2, 16, 16, true);
    const skinslide_figure good = s.figure;
    const skinslide_camera camera = s.camera;
    for (int i = 0; i < 4; i++) {
        s.figure.squares = bad_squares[i];
        refused(canvas, &s, SKINSLIDE_BAD_ARGUMENT, "a chequer of ...");
    }
    s.figure = good, s.figure.values = values;
    for (int i = 0; i < 6; i++) {
        s.figure.lowest = bad_scales[i][0], s.figure.highest = bad_scales[i][1];
        refused(canvas, &s, SKINSLIDE_BAD_ARGUMENT, "a scale from ...");
    }
    s.figure.lowest = 0, s.figure.highest = 1, values[7] = NAN;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, "vertex 7 has the value ...");
    s.figure = good, s.figure.points = NULL;
    refused(canvas, &s, SKINSLIDE_BAD_ARGUMENT, "no points");
    memcpy(points, good.points, sizeof points), points[13] = INFINITY, s.figure.points = points;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, "points: vertex 4 is not finite...");
    s.figure = good, s.figure.tessellation = NULL;
    refused(canvas, &s, SKINSLIDE_BAD_ARGUMENT, "no canvas, viewport, camera, or figure");
    s.figure = good, s.figure.to_world = singular;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, matrix_text);
    singular[10] = NAN;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, matrix_text);
    s.figure = good, s.camera.to_camera[3] = NAN;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, matrix_text);
    s.camera = camera, s.camera.to_screen[5] = 1e300;
    refused(canvas, &s, SKINSLIDE_BAD_POINTS, matrix_text);
    skinslide_canvas_destroy(canvas);
    end_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_colour_fills_it),
        cmocka_unit_test(filled_again),
        cmocka_unit_test(sizes_within_limits),
        cmocka_unit_test(sizes_beyond_them),
        cmocka_unit_test(the_same_picture_has_the_same_bytes),
        cmocka_unit_test(threads_draw_the_same),
        cmocka_unit_test(a_hosts_context_stays_current),
        cmocka_unit_test(devices_that_cannot_make_one),
        cmocka_unit_test(without_floats_bytes_do),
        cmocka_unit_test(devices_that_fail_later),
        cmocka_unit_test(bad_canvases_are_named),
        cmocka_unit_test(bad_viewports_are_named),
        cmocka_unit_test(bad_figures_are_named),
    };
    return cmocka_run_group_tests_name("canvas", tests, NULL, NULL);
}
