/* A headless OpenGL ES context through EGL, beside whatever context the host has.
 *
 * libEGL is opened at run time and not linked: the core must load and slide where there is none, and which EGL it meets is the
 * machine's choice. The library is never unloaded, nor a display ended: drivers leave thread-local destructors behind, and the
 * process shares both with us. A display that a host ended under us shows as a failing eglMakeCurrent; the caller then opens
 * anew.
 *
 * Displays are tried in this order until one gives a context of OpenGL ES 3: EGL's devices, hardware before software, each in
 * the order of their numbers; Mesa's surfaceless platform; the default display. A device chosen by number is the only one
 * tried. */
#define _GNU_SOURCE /* RTLD_NODELETE */
#include "egl.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DEVICES = 32, MOST_DISPLAYS = MOST_DEVICES + 2 };

typedef struct message {
    char text[400];
    size_t length;
} message;

__attribute__((format(printf, 2, 3))) static void append(message *out, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(out->text + out->length, sizeof out->text - out->length, format, arguments);
    va_end(arguments);
    out->length += length > 0 ? (size_t)length : 0;
    if (out->length > sizeof out->text - 1)
        out->length = sizeof out->text - 1;
}

const char *ss_egl_error_name(EGLint code) {
    static const char *const names[] = {
        "EGL_SUCCESS",           "EGL_NOT_INITIALIZED",   "EGL_BAD_ACCESS",          "EGL_BAD_ALLOC",   "EGL_BAD_ATTRIBUTE",
        "EGL_BAD_CONFIG",        "EGL_BAD_CONTEXT",       "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY", "EGL_BAD_MATCH",
        "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW", "EGL_BAD_PARAMETER",       "EGL_BAD_SURFACE", "EGL_CONTEXT_LOST"};
    int32_t place = code - EGL_SUCCESS;
    return place >= 0 && place < (int32_t)(sizeof names / sizeof *names) ? names[place] : "an unknown error";
}

/* ---- The table of functions ---- */

/* ISO C has no cast from an object pointer to a function pointer; POSIX says that the bytes are the same. */
static bool set(void *function, const void *address) {
    memcpy(function, &address, sizeof address);
    return address != NULL;
}

static const void *gl_address(const ss_egl_api *api, const char *name) {
    void (*function)(void) = api->eglGetProcAddress(name);
    const void *address;
    memcpy(&address, &function, sizeof address);
    return address;
}

bool ss_egl_load(ss_egl_api *api, char *why, size_t size) {
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!library) {
        snprintf(why, size, "%s", dlerror());
        return false;
    }
    const char *missing = NULL;
#define EXPORTED(type, name)                                                                                                   \
    if (!set(&api->name, dlsym(library, #name)))                                                                               \
        missing = #name;
#define EXTENSION(type, name) set(&api->name, gl_address(api, #name));
#define ADDRESSED(type, name)                                                                                                  \
    if (!missing && !set(&api->name, gl_address(api, #name)))                                                                  \
        missing = #name;
    SS_EGL_FUNCTIONS(EXPORTED)
    SS_GL_FUNCTIONS(ADDRESSED)
    if (!missing) {
        SS_EGL_EXTENSIONS(EXTENSION)
    }
#undef EXPORTED
#undef EXTENSION
#undef ADDRESSED
    dlclose(library); /* the library stays loaded, by RTLD_NODELETE */
    if (missing)
        snprintf(why, size, "libEGL.so.1 has no %s", missing);
    return !missing;
}

/* Whether a list of names, between spaces, has one. */
static bool has(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *at = list ? strstr(list, name) : NULL; at; at = strstr(at + length, name))
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
            return true;
    return false;
}

/* ---- Displays to be tried ---- */

typedef struct choice {
    EGLenum platform; /* 0: the default display */
    EGLDeviceEXT native;
    int32_t device; /* SKINSLIDE_ANY_DEVICE where it is not known */
    bool software;
    const char *file; /* of a device, or NULL */
} choice;

static choice device_choice(const ss_egl_api *api, EGLDeviceEXT native, int32_t device) {
    const char *extensions = api->eglQueryDeviceStringEXT(native, EGL_EXTENSIONS);
    choice made = {.platform = EGL_PLATFORM_DEVICE_EXT, .native = native, .device = device};
    made.software = has(extensions, "EGL_MESA_device_software");
    if (has(extensions, "EGL_EXT_device_drm"))
        made.file = api->eglQueryDeviceStringEXT(native, EGL_DRM_DEVICE_FILE_EXT);
    return made;
}

/* EGL's devices; returns how many there are in all, or -1 where EGL cannot tell. */
static int32_t list_devices(const ss_egl_api *api, const char *client, const ss_device_request *request, choice *choices,
                            int32_t *count) {
    EGLDeviceEXT devices[MOST_DEVICES];
    EGLint found = 0;
    bool base = has(client, "EGL_EXT_device_base") || has(client, "EGL_EXT_device_enumeration");
    if (!base || !has(client, "EGL_EXT_platform_device") || !api->eglQueryDevicesEXT || !api->eglQueryDeviceStringEXT ||
        !api->eglGetPlatformDisplayEXT || !api->eglQueryDevicesEXT(MOST_DEVICES, devices, &found))
        return -1;
    for (int software = 0; software <= !request->hardware_only; software++)
        for (int32_t d = 0; d < found; d++) {
            choice made = device_choice(api, devices[d], d);
            if (made.software == software && (request->device < 0 || request->device == d))
                choices[(*count)++] = made;
        }
    return found;
}

static void report_software(message *tried, const char *what) {
    append(tried, "%.60s is a software rasteriser; ", what);
}

/* Fills choices [MOST_DISPLAYS]; returns their count. Where EGL lists devices and only hardware will do, they are all there is:
 * it would be the same devices that the other platforms find. */
static int32_t list_choices(const ss_egl_api *api, const ss_device_request *request, choice *choices, message *tried) {
    const char *client = api->eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    int32_t count = 0, devices = list_devices(api, client, request, choices, &count);
    char asked[32];
    snprintf(asked, sizeof asked, "EGL device %d", request->device);
    if (devices < 0)
        append(tried, "EGL does not list devices; ");
    else if (request->device >= MOST_DEVICES && devices == MOST_DEVICES)
        append(tried, "only EGL's first %d devices are tried, not device %d; ", MOST_DEVICES, request->device);
    else if (request->device >= devices)
        append(tried, "there is no %s, there are %d; ", asked, devices);
    else if (request->hardware_only && count == 0 && request->device >= 0)
        report_software(tried, asked);
    else if (request->hardware_only && count == 0)
        append(tried, devices ? "EGL has only software rasterisers; " : "EGL has no devices; ");
    if (request->device >= 0 || (request->hardware_only && devices > 0))
        return count;
    if (api->eglGetPlatformDisplayEXT && has(client, "EGL_MESA_platform_surfaceless"))
        choices[count++] = (choice){.platform = EGL_PLATFORM_SURFACELESS_MESA, .device = SKINSLIDE_ANY_DEVICE};
    choices[count++] = (choice){.device = SKINSLIDE_ANY_DEVICE};
    return count;
}

static void name_choice(const choice *made, char *name, size_t size) {
    if (made->platform == EGL_PLATFORM_DEVICE_EXT)
        snprintf(name, size, "EGL device %d%s%s%s", made->device, made->file ? " (" : "", made->file ? made->file : "",
                 made->file ? ")" : "");
    else
        snprintf(name, size, "%s", made->platform ? "EGL surfaceless" : "EGL default display");
}

/* ---- A context on one of them ---- */

static bool report_code(message *tried, const char *call, EGLint code) {
    append(tried, "%s: %s; ", call, ss_egl_error_name(code));
    return false;
}

static bool report(const ss_egl_api *api, message *tried, const char *call) {
    return report_code(tried, call, api->eglGetError());
}

static bool open_display(ss_egl *egl, const choice *made, message *tried) {
    const ss_egl_api *api = &egl->api;
    egl->display = made->platform ? api->eglGetPlatformDisplayEXT(made->platform, made->native, NULL)
                                  : api->eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (egl->display == EGL_NO_DISPLAY)
        return report(api, tried, made->platform ? "eglGetPlatformDisplayEXT" : "eglGetDisplay");
    return api->eglInitialize(egl->display, NULL, NULL) || report(api, tried, "eglInitialize");
}

/* Robust if possible: a reset of the device is then reported as a lost context, and does not end the process. */
static bool create_context(ss_egl *egl, EGLConfig config, const char *extensions, message *tried) {
    const ss_egl_api *api = &egl->api;
    const EGLint robust[] = {EGL_CONTEXT_CLIENT_VERSION,
                             3,
                             EGL_CONTEXT_OPENGL_ROBUST_ACCESS_EXT,
                             EGL_TRUE,
                             EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT,
                             EGL_LOSE_CONTEXT_ON_RESET_EXT,
                             EGL_NONE};
    const EGLint plain[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    egl->context = EGL_NO_CONTEXT;
    if (has(extensions, "EGL_EXT_create_context_robustness"))
        egl->context = api->eglCreateContext(egl->display, config, EGL_NO_CONTEXT, robust);
    if (egl->context == EGL_NO_CONTEXT)
        egl->context = api->eglCreateContext(egl->display, config, EGL_NO_CONTEXT, plain);
    return egl->context != EGL_NO_CONTEXT || report(api, tried, "eglCreateContext");
}

/* A context without config and surface, or with the first config for a pixel of a buffer. */
static bool make_context(ss_egl *egl, message *tried) {
    const ss_egl_api *api = &egl->api;
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_NONE};
    const EGLint pixel[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    const char *extensions = api->eglQueryString(egl->display, EGL_EXTENSIONS);
    bool no_surface = has(extensions, "EGL_KHR_surfaceless_context");
    bool no_config = no_surface && has(extensions, "EGL_KHR_no_config_context");
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint configs = 0;
    if (!no_config && (!api->eglChooseConfig(egl->display, wanted, &config, 1, &configs) || configs < 1))
        return report(api, tried, "eglChooseConfig");
    if (!create_context(egl, config, extensions, tried))
        return false;
    egl->surface = no_surface ? EGL_NO_SURFACE : api->eglCreatePbufferSurface(egl->display, config, pixel);
    return no_surface || egl->surface != EGL_NO_SURFACE || report(api, tried, "eglCreatePbufferSurface");
}

bool ss_gl_has(const ss_egl_api *gl, const char *extension) {
    return has((const char *)gl->glGetString(GL_EXTENSIONS), extension);
}

static bool is_software(const char *renderer) {
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader", "Software"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strstr(renderer, names[i]))
            return true;
    return false;
}

/* Only the context's own list says whether the function may be called. */
static void find_reset_status(ss_egl_api *api) {
    const char *extensions = (const char *)api->glGetString(GL_EXTENSIONS);
    api->glGetGraphicsResetStatus = NULL;
    if (has(extensions, "GL_EXT_robustness"))
        set(&api->glGetGraphicsResetStatus, gl_address(api, "glGetGraphicsResetStatusEXT"));
    else if (has(extensions, "GL_KHR_robustness"))
        set(&api->glGetGraphicsResetStatus, gl_address(api, "glGetGraphicsResetStatusKHR"));
}

/* What the context is; false where it is no OpenGL ES 3 or cannot be made current. */
static bool describe(ss_egl *egl, const choice *made, message *tried) {
    ss_egl_before before;
    skinslide_device_info *info = &egl->info;
    if (!ss_egl_enter(egl, &before))
        return report_code(tried, "eglMakeCurrent", before.failure);
    const char *renderer = (const char *)egl->api.glGetString(GL_RENDERER);
    const char *version = (const char *)egl->api.glGetString(GL_VERSION);
    egl->api.glGetIntegerv(GL_MAX_TEXTURE_SIZE, &info->largest_resolution);
    snprintf(info->renderer, sizeof info->renderer, "%s", renderer ? renderer : "");
    snprintf(info->driver, sizeof info->driver, "%s", version ? version : "");
    find_reset_status(&egl->api);
    ss_egl_leave(egl, &before);
    name_choice(made, info->device_name, sizeof info->device_name);
    info->size = sizeof *info;
    info->device = made->device;
    info->software = made->software || is_software(info->renderer);
    if (strncmp(info->driver, "OpenGL ES 3", 11) == 0)
        return true;
    append(tried, "it has %.60s; ", info->driver);
    return false;
}

static void drop_context(ss_egl *egl) {
    if (egl->surface != EGL_NO_SURFACE)
        egl->api.eglDestroySurface(egl->display, egl->surface);
    if (egl->context != EGL_NO_CONTEXT)
        egl->api.eglDestroyContext(egl->display, egl->context);
    egl->surface = EGL_NO_SURFACE, egl->context = EGL_NO_CONTEXT;
}

static bool try_choice(ss_egl *egl, const choice *made, bool hardware_only, message *tried) {
    bool made_one = open_display(egl, made, tried) && make_context(egl, tried) && describe(egl, made, tried);
    if (made_one && hardware_only && egl->info.software) {
        report_software(tried, egl->info.renderer);
        made_one = false;
    }
    if (!made_one)
        drop_context(egl);
    return made_one;
}

/* ---- All of them ---- */

/* What was tried, for the message. Consecutive devices that failed alike are named together; those for which there is no room
 * are counted. */
typedef struct attempts {
    message report;
    message failure; /* not reported yet, of first and the devices behind it */
    choice first;
    int32_t count, unreported;
} attempts;

enum { ROOM_FOR_OTHERS = 180 }; /* bytes for what is tried after the devices */

static void report_failure(attempts *tried) {
    char name[96];
    message entry = {0};
    bool is_device = tried->first.platform == EGL_PLATFORM_DEVICE_EXT;
    name_choice(&tried->first, name, sizeof name);
    if (tried->count > 1)
        snprintf(name, sizeof name, "EGL devices %d-%d", tried->first.device, tried->first.device + tried->count - 1);
    append(&entry, "%s: %s", name, tried->failure.text);
    if (is_device && tried->report.length + entry.length > sizeof entry.text - ROOM_FOR_OTHERS)
        tried->unreported += tried->count;
    else if (tried->count > 0)
        append(&tried->report, "%s", entry.text);
    tried->count = 0;
}

static void report_rest(attempts *tried) {
    if (tried->unreported)
        append(&tried->report, "and %d more devices; ", tried->unreported);
    tried->unreported = 0;
}

static void add_failure(attempts *tried, const choice *made, const message *failure) {
    const choice *first = &tried->first;
    bool same = tried->count > 0 && first->platform == EGL_PLATFORM_DEVICE_EXT && made->platform == first->platform &&
                made->device == first->device + tried->count && strcmp(tried->failure.text, failure->text) == 0;
    if (!same) {
        report_failure(tried);
        tried->first = *made, tried->failure = *failure;
    }
    if (made->platform != EGL_PLATFORM_DEVICE_EXT)
        report_rest(tried);
    tried->count++;
}

static const char *report_all(attempts *tried) {
    report_failure(tried);
    report_rest(tried);
    if (tried->report.length > 2)
        tried->report.text[tried->report.length - 2] = 0; /* the last separator */
    return tried->report.text;
}

static bool try_all(ss_egl *egl, const ss_device_request *request, attempts *tried) {
    choice choices[MOST_DISPLAYS];
    EGLenum before = egl->api.eglQueryAPI();
    int32_t count = list_choices(&egl->api, request, choices, &tried->report);
    bool made = false;
    egl->api.eglBindAPI(EGL_OPENGL_ES_API);
    for (int32_t i = 0; i < count && !made; i++) {
        message failure = {0};
        made = try_choice(egl, &choices[i], request->hardware_only, &failure);
        if (!made)
            add_failure(tried, &choices[i], &failure);
    }
    egl->api.eglBindAPI(before);
    return made;
}

/* ---- Open, enter, leave, close ---- */

skinslide_status ss_egl_check_device(int32_t device, skinslide_error *error) {
    return device >= SKINSLIDE_ANY_DEVICE ? SKINSLIDE_OK : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such device: %d", device);
}

skinslide_status ss_egl_open(const ss_device_request *request, ss_egl **out, skinslide_error *error) {
    attempts tried = {0};
    const char *kind = request->hardware_only ? "hardware " : "", *why = tried.report.text;
    ss_egl *egl = calloc(1, sizeof *egl);
    if (!egl)
        return ss_out_of_memory(error);
    if (request->load(&egl->api, tried.report.text, sizeof tried.report.text)) {
        if (try_all(egl, request, &tried)) {
            *out = egl;
            return SKINSLIDE_OK;
        }
        why = report_all(&tried);
    }
    free(egl);
    return ss_fail(error, SKINSLIDE_NO_DEVICE, "no %sEGL device with OpenGL ES 3: %s", kind, why);
}

void ss_egl_close(ss_egl *egl) {
    if (!egl)
        return;
    drop_context(egl);
    free(egl);
}

/* The thread's current context: EGL tells it only while the context's API is bound, and a host need not have left it bound. */
static void save(const ss_egl_api *api, ss_egl_before *before) {
    const EGLenum apis[] = {api->eglQueryAPI(), EGL_OPENGL_ES_API, EGL_OPENGL_API};
    before->api = apis[0];
    before->context = EGL_NO_CONTEXT;
    for (int i = 0; i < 3 && before->context == EGL_NO_CONTEXT; i++) {
        api->eglBindAPI(apis[i]);
        before->context = api->eglGetCurrentContext();
        before->display = api->eglGetCurrentDisplay();
        before->draw = api->eglGetCurrentSurface(EGL_DRAW);
        before->read = api->eglGetCurrentSurface(EGL_READ);
    }
}

bool ss_egl_enter(const ss_egl *egl, ss_egl_before *before) {
    save(&egl->api, before);
    egl->api.eglBindAPI(EGL_OPENGL_ES_API);
    if (egl->api.eglMakeCurrent(egl->display, egl->surface, egl->surface, egl->context))
        return true;
    before->failure = egl->api.eglGetError(); /* before the next call overwrites it */
    egl->api.eglBindAPI(before->api);
    return false;
}

void ss_egl_leave(const ss_egl *egl, const ss_egl_before *before) {
    const ss_egl_api *api = &egl->api;
    if (before->context == EGL_NO_CONTEXT || !api->eglMakeCurrent(before->display, before->draw, before->read, before->context))
        api->eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    api->eglBindAPI(before->api);
}
