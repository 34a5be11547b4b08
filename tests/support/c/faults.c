/* See faults.h. */
#include "faults.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ss_egl_api real;
static fault plan = NO_FAULT;
static int32_t seen, struck;
static EGLint egl_error;
static GLenum gl_error;
static char extensions[4096], context_extensions[16384];
static int32_t contexts; /* whose extensions were asked for */

void plan_fault(fault planned) {
    plan = planned;
    seen = struck = contexts = 0;
    egl_error = EGL_SUCCESS, gl_error = GL_NO_ERROR;
}

int32_t faults_struck(void) {
    return struck;
}

static bool strikes(const char *call) {
    if (!plan.call || strcmp(plan.call, call) != 0 || seen++ < plan.after || (plan.times >= 0 && struck >= plan.times))
        return false;
    struck++;
    return true;
}

static bool egl_strikes(const char *call) {
    bool failed = strikes(call);
    egl_error = failed ? (EGLint)plan.code + (plan.varied ? struck % 12 : 0) : EGL_SUCCESS;
    return failed;
}

static EGLint get_egl_error(void) {
    EGLint code = egl_error;
    egl_error = EGL_SUCCESS;
    return code != EGL_SUCCESS ? code : real.eglGetError();
}

static EGLDisplay get_display(EGLNativeDisplayType native) {
    return egl_strikes("eglGetDisplay") ? EGL_NO_DISPLAY : real.eglGetDisplay(native);
}

static EGLDisplay get_platform_display(EGLenum platform, void *native, const EGLint *attributes) {
    return egl_strikes("eglGetPlatformDisplayEXT") ? EGL_NO_DISPLAY
                                                   : real.eglGetPlatformDisplayEXT(platform, native, attributes);
}

static EGLBoolean initialize(EGLDisplay display, EGLint *major, EGLint *minor) {
    return egl_strikes("eglInitialize") ? EGL_FALSE : real.eglInitialize(display, major, minor);
}

static EGLBoolean choose_config(EGLDisplay display, const EGLint *attributes, EGLConfig *configs, EGLint size, EGLint *count) {
    return egl_strikes("eglChooseConfig") ? EGL_FALSE : real.eglChooseConfig(display, attributes, configs, size, count);
}

static EGLContext create_context(EGLDisplay display, EGLConfig config, EGLContext shared, const EGLint *attributes) {
    return egl_strikes("eglCreateContext") ? EGL_NO_CONTEXT : real.eglCreateContext(display, config, shared, attributes);
}

static EGLSurface create_surface(EGLDisplay display, EGLConfig config, const EGLint *attributes) {
    return egl_strikes("eglCreatePbufferSurface") ? EGL_NO_SURFACE : real.eglCreatePbufferSurface(display, config, attributes);
}

/* Only making a context current fails, never releasing it. */
static EGLBoolean make_current(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context) {
    if (context != EGL_NO_CONTEXT && egl_strikes("eglMakeCurrent"))
        return EGL_FALSE;
    return real.eglMakeCurrent(display, draw, read, context);
}

/* The extensions without the hidden ones. */
static const char *query_string(EGLDisplay display, EGLint name) {
    const char *text = real.eglQueryString(display, name);
    const char *found = plan.hidden && text ? strstr(text, plan.hidden) : NULL;
    if (!found)
        return text;
    snprintf(extensions, sizeof extensions, "%.*s%s", (int)(found - text), text, found + strlen(plan.hidden));
    return extensions;
}

static EGLBoolean query_devices(EGLint most, EGLDeviceEXT *devices, EGLint *count) {
    EGLBoolean done = real.eglQueryDevicesEXT(most, devices, count);
    for (int32_t d = *count; done && d < plan.devices && d < most; d++)
        devices[d] = devices[0];
    if (plan.devices >= 0)
        *count = plan.devices < most ? plan.devices : most;
    return done;
}

static const char *query_device(EGLDeviceEXT device, EGLint name) {
    return plan.shown && name == EGL_EXTENSIONS ? plan.shown : real.eglQueryDeviceStringEXT(device, name);
}

/* Which software rasterisers need not have. */
static const GLubyte *get_extensions(void) {
    const char *own = (const char *)real.glGetString(GL_EXTENSIONS), *robust = strstr(own, "GL_EXT_robustness");
    bool shown = !plan.robust || contexts++ < plan.robust;
    if (robust)
        snprintf(context_extensions, sizeof context_extensions, "%.*s%s%s", (int)(robust - own), own, shown ? "" : "No_",
                 robust);
    else
        snprintf(context_extensions, sizeof context_extensions, "%s%s", own, shown ? " GL_EXT_robustness" : "");
    for (char *at = context_extensions; plan.hidden && (at = strstr(at, plan.hidden)) != NULL;)
        *at = '_';
    char *other = strstr(context_extensions, "GL_KHR_robustness");
    if (other)
        *other = '_';
    return (const GLubyte *)context_extensions;
}

static const GLubyte *get_string(GLenum name) {
    if (name == GL_EXTENSIONS)
        return get_extensions();
    if (name == GL_VERSION && strikes("glGetString"))
        return (const GLubyte *)"OpenGL ES 2.0";
    return plan.renderer && name == GL_RENDERER ? (const GLubyte *)plan.renderer : real.glGetString(name);
}

static void get_integer(GLenum name, GLint *value) {
    real.glGetIntegerv(name, value);
    if (plan.largest && (name == GL_MAX_TEXTURE_SIZE || name == GL_MAX_RENDERBUFFER_SIZE))
        *value = plan.largest;
}

static GLenum check_framebuffer(GLenum target) {
    return strikes("glCheckFramebufferStatus") ? plan.code : real.glCheckFramebufferStatus(target);
}

static void get_program(GLuint program, GLenum name, GLint *value) {
    real.glGetProgramiv(program, name, value);
    if (strikes("glGetProgramiv"))
        *value = GL_FALSE;
}

static GLenum get_gl_error(void) {
    GLenum code = real.glGetError();
    return strikes("glGetError") ? plan.code : code;
}

static GLenum reset_status(void) {
    return strikes("glGetGraphicsResetStatus") ? plan.code : GL_NO_ERROR;
}

typedef void (*address)(void);

static address get_address(const char *name) {
    return strcmp(name, "glGetGraphicsResetStatusEXT") == 0 ? (address)reset_status : real.eglGetProcAddress(name);
}

/* Answers that a device never wrote: with no code none at all, else random numbers up to it. */
static void *map_buffer(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access) {
    static uint32_t answers[1 << 16];
    void *mapped = real.glMapBufferRange(target, offset, length, access);
    if (!strikes("glMapBufferRange"))
        return mapped;
    if (!plan.code) {
        real.glUnmapBuffer(target);
        return NULL;
    }
    dice d = {7};
    assert_true((size_t)length <= sizeof answers);
    for (GLsizeiptr i = 0; i < length / 4; i++)
        answers[i] = (uint32_t)(roll(&d) % ((uint64_t)plan.code + 1));
    return answers;
}

static GLboolean unmap_buffer(GLenum target) {
    GLboolean done = real.glUnmapBuffer(target);
    return strikes("glUnmapBuffer") ? GL_FALSE : done;
}

bool load_with_faults(struct ss_egl_api *api, char *why, size_t size) {
    if (!ss_egl_load(&real, why, size))
        return false;
    *api = real;
    api->eglGetError = get_egl_error, api->eglGetDisplay = get_display, api->eglInitialize = initialize;
    api->eglGetPlatformDisplayEXT = get_platform_display, api->eglChooseConfig = choose_config;
    api->eglCreateContext = create_context, api->eglCreatePbufferSurface = create_surface;
    api->eglMakeCurrent = make_current, api->eglQueryString = query_string;
    api->eglQueryDevicesEXT = query_devices, api->eglQueryDeviceStringEXT = query_device;
    api->glGetString = get_string, api->glGetIntegerv = get_integer, api->glGetProgramiv = get_program;
    api->glCheckFramebufferStatus = check_framebuffer, api->glGetError = get_gl_error;
    api->eglGetProcAddress = get_address;
    api->glMapBufferRange = map_buffer, api->glUnmapBuffer = unmap_buffer;
    return true;
}

bool load_nothing(struct ss_egl_api *api, char *why, size_t size) {
    (void)api;
    snprintf(why, size, "libEGL.so.1: no such file");
    return false;
}
