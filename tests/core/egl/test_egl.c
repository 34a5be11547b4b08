/* Contexts of our own: in which order displays are tried, what is said where none will do, and that a host's context does not
 * notice. Needs an EGL; software Mesa is one. */
#include "faults.h"
#include "hosts.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

#ifndef __SANITIZE_ADDRESS__
#define __SANITIZE_ADDRESS__ 0
#endif

static ss_egl *open_with(fault planned, ss_device_request request, skinslide_status expected, skinslide_error *error) {
    ss_egl *egl = NULL;
    plan_fault(planned);
    request.load = load_with_faults;
    skinslide_status status = ss_egl_open(&request, &egl, error);
    if (expected == SKINSLIDE_OK)
        assert_ok(status, error);
    assert_int_equal(status, expected);
    assert_true((egl != NULL) == (status == SKINSLIDE_OK));
    return egl;
}

static const ss_device_request any = {.device = SKINSLIDE_ANY_DEVICE};

/* ---- Which display ---- */

static void the_device_is_told(void **state) {
    (void)state;
    skinslide_error error;
    ss_egl *egl = open_with((fault)NO_FAULT, any, SKINSLIDE_OK, &error);
    print_message("device: %s, %s, %s\n", egl->info.device_name, egl->info.renderer, egl->info.driver);
    assert_true(strlen(egl->info.renderer) > 0 && strncmp(egl->info.driver, "OpenGL ES 3", 11) == 0);
    assert_true(egl->info.largest_resolution >= 2048); /* what OpenGL ES 3.0 asks of every device */
    ss_egl_close(egl);
    ss_egl_close(NULL);
}

/* The order: devices, surfaceless, default display; each is named with what failed. */
static void displays_are_tried_in_order(void **state) {
    (void)state;
    skinslide_error error;
    fault none = {.call = "eglInitialize", .times = -1, .code = EGL_BAD_ALLOC, .devices = 1};
    open_with(none, any, SKINSLIDE_NO_DEVICE, &error);
    const char *places[] = {"no EGL device with OpenGL ES 3: EGL device 0", "EGL surfaceless: eglInitialize: EGL_BAD_ALLOC",
                            "EGL default display: "};
    const char *at = error.message;
    for (int i = 0; i < 3; i++) {
        at = strstr(at, places[i]);
        assert_non_null(at);
    }
    fault first = {.call = "eglInitialize", .times = 1, .code = EGL_NOT_INITIALIZED, .devices = 1};
    ss_egl *egl = open_with(first, any, SKINSLIDE_OK, &error);
    assert_string_equal(egl->info.device_name, "EGL surfaceless");
    assert_int_equal(egl->info.device, SKINSLIDE_ANY_DEVICE);
    ss_egl_close(egl);
    egl = open_with((fault){.devices = -1, .hidden = "EGL_EXT_platform_device"}, any, SKINSLIDE_OK, &error);
    assert_string_equal(egl->info.device_name, "EGL surfaceless");
    ss_egl_close(egl);
}

static void a_device_by_number_is_the_only_one(void **state) {
    (void)state;
    skinslide_error error;
    ss_device_request first = {.device = 0}, absent = {.device = 31};
    ss_egl *egl = open_with((fault)NO_FAULT, first, SKINSLIDE_OK, &error);
    assert_int_equal(egl->info.device, 0);
    ss_egl_close(egl);
    open_with((fault){.devices = 1}, absent, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no EGL device with OpenGL ES 3: there is no EGL device 31, there are 1");
    open_with((fault){.devices = 0}, first, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no EGL device with OpenGL ES 3: there is no EGL device 0, there are 0");
    open_with((fault){.call = "eglCreateContext", .times = -1, .code = EGL_BAD_MATCH, .devices = -1}, first,
              SKINSLIDE_NO_DEVICE, &error);
    assert_null(strstr(error.message, "surfaceless"));
}

static void only_hardware(void **state) {
    (void)state;
    skinslide_error error;
    ss_device_request request = {.device = SKINSLIDE_ANY_DEVICE, .hardware_only = true};
    fault hardware = {.devices = 1, .shown = "EGL_EXT_device_drm", .renderer = "A GPU"};
    fault software = {.devices = 1, .shown = "EGL_MESA_device_software"};
    fault disguised = {.devices = 1, .shown = "EGL_EXT_device_drm", .renderer = "softpipe"};
    ss_egl *egl = open_with(hardware, request, SKINSLIDE_OK, &error);
    assert_int_equal(egl->info.software, 0);
    ss_egl_close(egl);
    open_with(software, request, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no hardware EGL device with OpenGL ES 3: EGL has only software rasterisers");
    open_with(disguised, request, SKINSLIDE_NO_DEVICE, &error);
    assert_non_null(strstr(error.message, "softpipe is a software rasteriser"));
    request.device = 0;
    open_with(software, request, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no hardware EGL device with OpenGL ES 3: EGL device 0 is a software rasteriser");
}

/* ---- Every call that can fail ---- */

static void every_failure_is_named(void **state) {
    (void)state;
    static const struct {
        const char *call, *hidden;
        EGLint code;
        const char *text;
    } cases[] = {
        {"eglGetPlatformDisplayEXT", NULL, EGL_BAD_PARAMETER, "eglGetPlatformDisplayEXT: EGL_BAD_PARAMETER"},
        {"eglInitialize", NULL, EGL_NOT_INITIALIZED, "eglInitialize: EGL_NOT_INITIALIZED"},
        {"eglChooseConfig", "EGL_KHR_surfaceless_context", EGL_BAD_ATTRIBUTE, "eglChooseConfig: EGL_BAD_ATTRIBUTE"},
        {"eglCreateContext", NULL, EGL_BAD_ALLOC, "eglCreateContext: EGL_BAD_ALLOC"},
        {"eglCreatePbufferSurface", "EGL_KHR_surfaceless_context", EGL_BAD_MATCH, "eglCreatePbufferSurface: EGL_BAD_MATCH"},
        {"eglMakeCurrent", NULL, EGL_BAD_ACCESS, "eglMakeCurrent: EGL_BAD_ACCESS"},
        {"eglInitialize", NULL, 0x1234, "eglInitialize: an unknown error"},
    };
    ss_device_request first = {.device = 0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_error error;
        fault planned = {.call = cases[i].call, .times = -1, .code = (uint32_t)cases[i].code, .devices = -1};
        planned.hidden = cases[i].hidden;
        open_with(planned, first, SKINSLIDE_NO_DEVICE, &error);
        assert_true(faults_struck() > 0);
        assert_non_null(strstr(error.message, cases[i].text));
    }
}

/* Devices that fail alike are told as one, and what is tried after them is always told. */
static void many_failures_are_told(void **state) {
    (void)state;
    skinslide_error error;
    fault alike = {.call = "eglInitialize", .times = -1, .code = EGL_NOT_INITIALIZED, .devices = 8};
    alike.shown = "EGL_EXT_device_drm";
    open_with(alike, any, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no EGL device with OpenGL ES 3: EGL devices 0-7: eglInitialize: EGL_NOT_INITIALIZED; "
                                       "EGL surfaceless: eglInitialize: EGL_NOT_INITIALIZED; "
                                       "EGL default display: eglInitialize: EGL_NOT_INITIALIZED");
    alike.varied = true;
    open_with(alike, any, SKINSLIDE_NO_DEVICE, &error);
    const char *parts[] = {"EGL device 0", "EGL device 1", "and ", " more devices; EGL surfaceless: ", "EGL default display: "};
    const char *at = error.message;
    for (int i = 0; i < 5; i++) {
        at = strstr(at, parts[i]);
        assert_non_null(at);
    }
    assert_true(strlen(error.message) < sizeof error.message - 20);
}

static void devices_beyond_the_most(void **state) {
    (void)state;
    skinslide_error error;
    ss_device_request far = {.device = 40};
    open_with((fault){.devices = 64}, far, SKINSLIDE_NO_DEVICE, &error);
    assert_string_equal(error.message, "no EGL device with OpenGL ES 3: only EGL's first 32 devices are tried, not device 40");
}

/* The first context can tell that it was lost, the next cannot, and must not be asked. */
static void each_context_says_whether_it_can_tell(void **state) {
    (void)state;
    skinslide_error error;
    fault second = {.call = "glGetString", .times = 1, .devices = 1, .robust = 1}, both = second;
    both.robust = 2;
    ss_egl *egl = open_with(second, any, SKINSLIDE_OK, &error);
    assert_string_equal(egl->info.device_name, "EGL surfaceless");
    assert_true(egl->api.glGetGraphicsResetStatus == NULL);
    ss_egl_close(egl);
    egl = open_with(both, any, SKINSLIDE_OK, &error);
    assert_true(egl->api.glGetGraphicsResetStatus != NULL);
    ss_egl_close(egl);
}

static void no_library(void **state) {
    (void)state;
    ss_device_request request = {.load = load_nothing, .device = SKINSLIDE_ANY_DEVICE};
    ss_egl *egl = NULL;
    skinslide_error error;
    assert_fails(ss_egl_open(&request, &egl, &error), &error, SKINSLIDE_NO_DEVICE,
                 "no EGL device with OpenGL ES 3: libEGL.so.1: no such file");
    assert_null(egl);
}

/* Older drivers: a config and a pixel of surface, no robustness. */
static void without_extensions(void **state) {
    (void)state;
    const char *const names[] = {"EGL_KHR_surfaceless_context", "EGL_KHR_no_config_context",
                                 "EGL_EXT_create_context_robustness"};
    for (int i = 0; i < 3; i++) {
        skinslide_error error;
        ss_egl_before before;
        ss_egl *egl = open_with((fault){.devices = -1, .hidden = names[i]}, any, SKINSLIDE_OK, &error);
        assert_true((egl->surface != EGL_NO_SURFACE) == (i == 0));
        assert_true(ss_egl_enter(egl, &before));
        ss_egl_leave(egl, &before);
        ss_egl_close(egl);
    }
}

/* ---- The host ---- */

/* OpenGL and OpenGL ES, on our display and on another, with its API bound and with the other left bound; what succeeds and
 * what fails. */
static void a_hosts_context_stays_current(void **state) {
    (void)state;
    const EGLenum apis[] = {EGL_OPENGL_API, EGL_OPENGL_ES_API};
    const EGLenum platforms[] = {EGL_PLATFORM_DEVICE_EXT, EGL_PLATFORM_SURFACELESS_MESA};
    for (int i = 0; i < 8; i++) {
        EGLenum api = apis[i & 1], bound = apis[i >> 1 & 1];
        host h = host_with(api, platforms[i >> 2]);
        skinslide_error error;
        ss_egl_before before;
        h.egl.eglBindAPI(bound);
        ss_egl *egl = open_with((fault)NO_FAULT, any, SKINSLIDE_OK, &error);
        assert_current(&h, api, bound);
        assert_true(ss_egl_enter(egl, &before));
        assert_ptr_equal(h.egl.eglGetCurrentContext(), egl->context);
        ss_egl_leave(egl, &before);
        assert_current(&h, api, bound);
        plan_fault((fault){.call = "eglMakeCurrent", .times = 1, .code = EGL_CONTEXT_LOST, .devices = -1});
        assert_false(ss_egl_enter(egl, &before));
        assert_int_equal(before.failure, EGL_CONTEXT_LOST);
        assert_current(&h, api, bound);
        ss_egl_close(egl);
        open_with((fault){.call = "eglCreateContext", .times = -1, .devices = -1}, any, SKINSLIDE_NO_DEVICE, &error);
        assert_current(&h, api, bound);
        end_host(&h);
    }
}

static void without_a_host_nothing_stays_current(void **state) {
    (void)state;
    skinslide_error error;
    ss_egl_before before;
    ss_egl *egl = open_with((fault)NO_FAULT, any, SKINSLIDE_OK, &error);
    assert_ptr_equal(egl->api.eglGetCurrentContext(), EGL_NO_CONTEXT);
    assert_true(ss_egl_enter(egl, &before));
    ss_egl_leave(egl, &before);
    assert_ptr_equal(egl->api.eglGetCurrentContext(), EGL_NO_CONTEXT);
    ss_egl_close(egl);
}

/* ---- Growth ---- */

/* After a first hundred, which fill the driver's caches, two thousand more. */
static void thousands_of_contexts_do_not_grow(void **state) {
    (void)state;
    skinslide_error error;
    size_t start = 0;
    for (int i = 0; i < 2100; i++) {
        if (i == 100)
            start = mallinfo2().uordblks;
        ss_egl_close(open_with((fault)NO_FAULT, any, SKINSLIDE_OK, &error));
    }
    size_t grown = mallinfo2().uordblks - start;
    if (!__SANITIZE_ADDRESS__) /* whose heap is its own; it looks for leaks itself */
        assert_true((int64_t)grown < 2000 * 8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_device_is_told),
        cmocka_unit_test(displays_are_tried_in_order),
        cmocka_unit_test(a_device_by_number_is_the_only_one),
        cmocka_unit_test(only_hardware),
        cmocka_unit_test(every_failure_is_named),
        cmocka_unit_test(many_failures_are_told),
        cmocka_unit_test(devices_beyond_the_most),
        cmocka_unit_test(each_context_says_whether_it_can_tell),
        cmocka_unit_test(no_library),
        cmocka_unit_test(without_extensions),
        cmocka_unit_test(a_hosts_context_stays_current),
        cmocka_unit_test(without_a_host_nothing_stays_current),
        cmocka_unit_test(thousands_of_contexts_do_not_grow),
    };
    return cmocka_run_group_tests_name("egl", tests, NULL, NULL);
}
