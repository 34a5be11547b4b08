/* See hosts.h. */
#include "hosts.h"

#include "support.h"

#include <string.h>

enum { SIDE = 8 };

host host_with(EGLenum api, EGLenum platform) {
    static const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    static const EGLint size[] = {EGL_WIDTH, SIDE, EGL_HEIGHT, SIDE, EGL_NONE};
    host h;
    char why[200];
    EGLConfig config;
    EGLDeviceEXT device;
    EGLint count;
    assert_true(ss_egl_load(&h.egl, why, sizeof why));
    assert_true(h.egl.eglQueryDevicesEXT(1, &device, &count));
    h.display = h.egl.eglGetPlatformDisplayEXT(platform, platform == EGL_PLATFORM_DEVICE_EXT ? device : NULL, NULL);
    assert_true(h.egl.eglInitialize(h.display, NULL, NULL));
    assert_true(h.egl.eglBindAPI(api));
    assert_true(h.egl.eglChooseConfig(h.display, attributes, &config, 1, &count) && count == 1);
    h.context = h.egl.eglCreateContext(h.display, config, EGL_NO_CONTEXT, NULL);
    h.draw = h.egl.eglCreatePbufferSurface(h.display, config, size);
    h.read = h.egl.eglCreatePbufferSurface(h.display, config, size);
    assert_true(h.egl.eglMakeCurrent(h.display, h.draw, h.read, h.context));
    return h;
}

void assert_current(const host *h, EGLenum api, EGLenum bound) {
    assert_int_equal(h->egl.eglQueryAPI(), bound);
    h->egl.eglBindAPI(api);
    assert_ptr_equal(h->egl.eglGetCurrentContext(), h->context);
    assert_ptr_equal(h->egl.eglGetCurrentDisplay(), h->display);
    assert_ptr_equal(h->egl.eglGetCurrentSurface(EGL_DRAW), h->draw);
    assert_ptr_equal(h->egl.eglGetCurrentSurface(EGL_READ), h->read);
    h->egl.eglBindAPI(bound);
}

/* ---- Pixels ---- */

typedef struct painter {
    PFNGLCLEARPROC clear;
    PFNGLCLEARCOLORPROC clear_color;
    PFNGLENABLEPROC enable;
    PFNGLGETERRORPROC error;
    PFNGLREADPIXELSPROC read;
    PFNGLSCISSORPROC scissor;
} painter;

static void load(const host *h, void *function, size_t size, const char *name) {
    void (*found)(void) = h->egl.eglGetProcAddress(name);
    assert_true(found && size == sizeof found);
    memcpy(function, &found, size);
}

static painter painter_of(const host *h) {
    painter p;
    load(h, &p.clear, sizeof p.clear, "glClear");
    load(h, &p.clear_color, sizeof p.clear_color, "glClearColor");
    load(h, &p.enable, sizeof p.enable, "glEnable");
    load(h, &p.error, sizeof p.error, "glGetError");
    load(h, &p.read, sizeof p.read, "glReadPixels");
    load(h, &p.scissor, sizeof p.scissor, "glScissor");
    return p;
}

/* A pixel has none or all of each channel, which surfaces of any depth hold exactly. */
static bool lit(int surface, int x, int y, int channel) {
    return (surface + 2) * (x + 3) * (y + 5) * (channel + 7) >> 2 & 1;
}

static void paint_pixel(const painter *p, int surface, int x, int y) {
    p->scissor(x, y, 1, 1);
    p->clear_color(lit(surface, x, y, 0), lit(surface, x, y, 1), lit(surface, x, y, 2), 1);
    p->clear(GL_COLOR_BUFFER_BIT);
}

static void check_pixel(const uint8_t pixel[4], int surface, int x, int y) {
    for (int k = 0; k < 3; k++)
        assert_int_equal(pixel[k], lit(surface, x, y, k) ? 255 : 0);
}

static void visit_surfaces(const host *h, EGLenum api, bool paint) {
    const painter p = painter_of(h);
    const EGLenum bound = h->egl.eglQueryAPI();
    h->egl.eglBindAPI(api);
    for (int surface = 0; surface < 2; surface++) {
        uint8_t pixels[SIDE * SIDE][4];
        EGLSurface own = surface ? h->read : h->draw;
        assert_true(h->egl.eglMakeCurrent(h->display, own, own, h->context));
        if (paint)
            p.enable(GL_SCISSOR_TEST);
        else
            p.read(0, 0, SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
        for (int i = 0; i < SIDE * SIDE; i++)
            if (paint)
                paint_pixel(&p, surface, i % SIDE, i / SIDE);
            else
                check_pixel(pixels[i], surface, i % SIDE, i / SIDE);
        assert_int_equal(p.error(), GL_NO_ERROR);
    }
    assert_true(h->egl.eglMakeCurrent(h->display, h->draw, h->read, h->context));
    h->egl.eglBindAPI(bound);
}

void paint_host(const host *h, EGLenum api) {
    visit_surfaces(h, api, true);
}

void assert_painted(const host *h, EGLenum api) {
    visit_surfaces(h, api, false);
}

void end_host(host *h) {
    h->egl.eglMakeCurrent(h->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    h->egl.eglDestroySurface(h->display, h->draw), h->egl.eglDestroySurface(h->display, h->read);
    h->egl.eglDestroyContext(h->display, h->context);
    h->egl.eglBindAPI(EGL_OPENGL_ES_API);
}
