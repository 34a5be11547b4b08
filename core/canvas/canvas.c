/* What pictures are drawn on: two framebuffers of a context of our own. One has four samples a pixel and all targets, and is
 * drawn to; one has a single sample, and is read. Bytes hold sRGB, into which the shaders encode linear light: the device would
 * encode each sample, which is slow on software rasterisers. */
#include "canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SIDE = 16384, MOST_PIXELS = 1 << 26, SAMPLES = 4 };

/* ---- Colours ---- */

void ss_canvas_colour(const skinslide_canvas *canvas, const float light[3], float out[3]) {
    for (int k = 0; k < 3; k++) {
        float encoded = light[k] < 0.0031308f ? 12.92f * light[k] : 1.055f * powf(light[k], 1 / 2.4f) - 0.055f;
        out[k] = canvas->pixels == SKINSLIDE_PIXELS_BYTES ? encoded : light[k];
    }
}

/* ---- Creation ---- */

static size_t row_size(const skinslide_canvas *canvas) {
    return (size_t)canvas->width * 4 * (canvas->pixels == SKINSLIDE_PIXELS_FLOATS ? sizeof(float) : 1);
}

static skinslide_status check_options(const skinslide_canvas_options *options, skinslide_error *error) {
    int32_t width = options->width, height = options->height;
    if (width < 1 || height < 1 || width > MOST_SIDE || height > MOST_SIDE || (int64_t)width * height > MOST_PIXELS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT,
                       "a picture of %d by %d pixels; each side is 1 to %d, and all are at most %d", width, height, MOST_SIDE,
                       MOST_PIXELS);
    if (options->targets < 0 || options->targets > SKINSLIDE_MOST_TARGETS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a canvas of %d targets; it may have 0 to %d", options->targets,
                       SKINSLIDE_MOST_TARGETS);
    if ((unsigned)options->pixels > SKINSLIDE_PIXELS_FLOATS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such pixels: %d", (int)options->pixels);
    return ss_egl_check_device(options->device, error);
}

static skinslide_status check_limits(skinslide_canvas *canvas, skinslide_error *error) {
    const ss_egl_api *gl = &canvas->egl->api;
    GLint most = 0;
    gl->glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    canvas->largest_texture = most < SKINSLIDE_LARGEST_MAP ? most : SKINSLIDE_LARGEST_MAP;
    gl->glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (canvas->width > most || canvas->height > most)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a picture of %d by %d pixels is above the device's limit of %d",
                       canvas->width, canvas->height, most);
    if (canvas->pixels == SKINSLIDE_PIXELS_FLOATS && !ss_gl_has(gl, "GL_EXT_color_buffer_float") &&
        !ss_gl_has(gl, "GL_EXT_color_buffer_half_float"))
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "the device draws no floats: it lacks GL_EXT_color_buffer_float");
    return SKINSLIDE_OK;
}

static void attach(const skinslide_canvas *canvas, GLenum place, GLenum format, int32_t samples) {
    const ss_egl_api *gl = &canvas->egl->api;
    GLuint buffer;
    gl->glGenRenderbuffers(1, &buffer);
    gl->glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl->glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, canvas->width, canvas->height);
    gl->glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer);
}

static skinslide_status make_framebuffers(skinslide_canvas *canvas, skinslide_error *error) {
    const ss_egl_api *gl = &canvas->egl->api;
    GLenum colour = canvas->pixels == SKINSLIDE_PIXELS_FLOATS ? GL_RGBA16F : GL_RGBA8;
    gl->glGenFramebuffers(1, &canvas->resolved);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->resolved);
    attach(canvas, GL_COLOR_ATTACHMENT0, colour, 0);
    GLenum state = gl->glCheckFramebufferStatus(GL_FRAMEBUFFER);
    gl->glGenFramebuffers(1, &canvas->drawn);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->drawn);
    for (int32_t target = 0; target < canvas->targets; target++)
        attach(canvas, GL_COLOR_ATTACHMENT0 + (GLenum)target, colour, SAMPLES);
    attach(canvas, GL_DEPTH_STENCIL_ATTACHMENT, GL_DEPTH24_STENCIL8, SAMPLES);
    if (state == GL_FRAMEBUFFER_COMPLETE)
        state = gl->glCheckFramebufferStatus(GL_FRAMEBUFFER);
    gl->glEnable(GL_DEPTH_TEST);
    gl->glDepthFunc(GL_LEQUAL);
    gl->glDisable(GL_DITHER);
    if (state == GL_FRAMEBUFFER_COMPLETE)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "the device's framebuffer of %d by %d pixels is not complete: 0x%04x",
                   canvas->width, canvas->height, state);
}

static skinslide_status make_objects(skinslide_canvas *canvas, skinslide_error *error) {
    ss_egl_before before;
    skinslide_status status = ss_gl_enter(canvas->egl, &before, error);
    if (status)
        return status;
    status = check_limits(canvas, error);
    if (!status)
        status = make_framebuffers(canvas, error);
    if (!status)
        status = ss_figure_objects_create(&canvas->egl->api, &canvas->objects, error);
    skinslide_status left = ss_gl_leave(canvas->egl, &before, "making a canvas", status ? NULL : error);
    return status ? status : left;
}

skinslide_status ss_canvas_create(const skinslide_canvas_options *options, ss_egl_loader load, skinslide_canvas **out,
                                  skinslide_error *error) {
    skinslide_canvas_options own = SKINSLIDE_CANVAS_OPTIONS_DEFAULT;
    if (!out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the canvas");
    skinslide_status status = ss_take(options, "skinslide_canvas_options", &own, sizeof own, error);
    if (!status)
        status = check_options(&own, error);
    if (status)
        return status;
    skinslide_canvas *canvas = calloc(1, sizeof *canvas);
    if (!canvas)
        return ss_out_of_memory(error);
    canvas->width = own.width, canvas->height = own.height, canvas->pixels = own.pixels;
    canvas->targets = own.targets > 0 ? own.targets : 1;
    const ss_device_request request = {load, own.device, false};
    canvas->rows = ss_new(&canvas->memory, canvas->height, row_size(canvas));
    status = canvas->rows ? ss_egl_open(&request, &canvas->egl, error) : ss_out_of_memory(error);
    if (!status)
        status = make_objects(canvas, error);
    if (status)
        skinslide_canvas_destroy(canvas);
    else
        *out = canvas;
    return status;
}

skinslide_status skinslide_canvas_create(const skinslide_canvas_options *options, skinslide_canvas **out,
                                         skinslide_error *error) {
    return ss_canvas_create(options, ss_egl_load, out, error);
}

void skinslide_canvas_destroy(skinslide_canvas *canvas) {
    if (!canvas)
        return;
    ss_egl_close(canvas->egl); /* and with the context all of its objects */
    ss_free(&canvas->memory);
    free(canvas);
}

skinslide_status skinslide_canvas_device(const skinslide_canvas *canvas, skinslide_device_info *info, skinslide_error *error) {
    if (!canvas || !info)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place for the answer");
    skinslide_status status = ss_check_size(info, "skinslide_device_info", error);
    if (!status)
        ss_give(&canvas->egl->info, sizeof canvas->egl->info, info);
    return status;
}

/* ---- Clearing and reading ---- */

void ss_draw_on_targets(const skinslide_canvas *canvas, int32_t first, int32_t end) {
    GLenum buffers[SKINSLIDE_MOST_TARGETS];
    for (int32_t target = 0; target < canvas->targets; target++)
        buffers[target] = target >= first && target < end ? GL_COLOR_ATTACHMENT0 + (GLenum)target : GL_NONE;
    canvas->egl->api.glDrawBuffers(canvas->targets, buffers);
}

skinslide_status skinslide_canvas_clear(skinslide_canvas *canvas, const float colour[3], skinslide_error *error) {
    ss_egl_before before;
    if (!canvas || !colour)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no colour");
    if (!isfinite(colour[0]) || !isfinite(colour[1]) || !isfinite(colour[2]))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the colour (%g, %g, %g) is not finite", (double)colour[0],
                       (double)colour[1], (double)colour[2]);
    skinslide_status status = ss_gl_enter(canvas->egl, &before, error);
    if (status)
        return status;
    const ss_egl_api *gl = &canvas->egl->api;
    float all[4] = {0, 0, 0, 1};
    ss_canvas_colour(canvas, colour, all);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->drawn);
    ss_draw_on_targets(canvas, 0, canvas->targets);
    for (int32_t target = 0; target < canvas->targets; target++)
        gl->glClearBufferfv(GL_COLOR, target, all);
    gl->glClearBufferfi(GL_DEPTH_STENCIL, 0, 1, 0); /* both at once: one alone is slow */
    canvas->marks = 0;
    return ss_gl_leave(canvas->egl, &before, "clearing a canvas", error);
}

/* OpenGL's first row is the lowest, ours the highest. */
static void turn_over(const uint8_t *rows, int32_t height, size_t row_size, uint8_t *out) {
    for (int32_t y = 0; y < height; y++)
        memcpy(out + (size_t)y * row_size, rows + (size_t)(height - 1 - y) * row_size, row_size);
}

skinslide_status skinslide_canvas_read_target(skinslide_canvas *canvas, int32_t target, void *pixels, skinslide_error *error) {
    ss_egl_before before;
    if (!canvas || !pixels)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, or no place for its pixels");
    if (target < 0 || target >= canvas->targets)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "there is no target %d; the canvas has %d", target, canvas->targets);
    int32_t width = canvas->width, height = canvas->height;
    skinslide_status status = ss_gl_enter(canvas->egl, &before, error);
    if (status)
        return status;
    const ss_egl_api *gl = &canvas->egl->api;
    GLenum type = canvas->pixels == SKINSLIDE_PIXELS_FLOATS ? GL_FLOAT : GL_UNSIGNED_BYTE;
    gl->glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->drawn);
    gl->glReadBuffer(GL_COLOR_ATTACHMENT0 + (GLenum)target);
    gl->glBindFramebuffer(GL_DRAW_FRAMEBUFFER, canvas->resolved);
    gl->glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl->glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->resolved);
    gl->glReadPixels(0, 0, width, height, GL_RGBA, type, canvas->rows);
    status = ss_gl_leave(canvas->egl, &before, "reading a canvas", error);
    if (!status)
        turn_over(canvas->rows, height, row_size(canvas), pixels);
    return status;
}

skinslide_status skinslide_canvas_read(skinslide_canvas *canvas, void *pixels, skinslide_error *error) {
    return skinslide_canvas_read_target(canvas, 0, pixels, error);
}
