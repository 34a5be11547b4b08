/* See hosts.h. */
#include "hosts.h"

#include "support.h"

host host_with(EGLenum api, EGLenum platform) {
    static const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    static const EGLint size[] = {EGL_WIDTH, 8, EGL_HEIGHT, 8, EGL_NONE};
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

void end_host(host *h) {
    h->egl.eglMakeCurrent(h->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    h->egl.eglDestroySurface(h->display, h->draw), h->egl.eglDestroySurface(h->display, h->read);
    h->egl.eglDestroyContext(h->display, h->context);
    h->egl.eglBindAPI(EGL_OPENGL_ES_API);
}
