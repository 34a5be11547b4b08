/* What all users of OpenGL ES share: programs, reading texels of integers, and how failures are reported. */
#include "egl.h"

#include <stdio.h>
#include <string.h>

bool ss_gl_did(const ss_egl_api *gl, char *failure, size_t size) {
    GLenum code = gl->glGetError(), reset = gl->glGetGraphicsResetStatus ? gl->glGetGraphicsResetStatus() : GL_NO_ERROR;
    snprintf(failure, size, reset ? "the context was lost, 0x%04x" : "OpenGL error 0x%04x", reset ? reset : code);
    return !code && !reset;
}

skinslide_status ss_gl_enter(const ss_egl *egl, ss_egl_before *before, skinslide_error *error) {
    if (ss_egl_enter(egl, before))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "eglMakeCurrent: %s", ss_egl_error_name(before->failure));
}

skinslide_status ss_gl_leave(const ss_egl *egl, const ss_egl_before *before, const char *what, skinslide_error *error) {
    char failure[64];
    bool did = ss_gl_did(&egl->api, failure, sizeof failure);
    ss_egl_leave(egl, before);
    return did ? SKINSLIDE_OK : ss_fail(error, SKINSLIDE_DEVICE_FAILED, "%s: %s", what, failure);
}

void ss_gl_read_numbers(const ss_egl_api *gl, const int32_t low[2], const int32_t high[2], uint32_t (*band)[4],
                        uint32_t *texels) {
    int32_t width = high[0] - low[0];
    for (int32_t row = low[1]; row < high[1]; row += SS_BAND_ROWS) {
        int32_t count = SS_BAND_ROWS < high[1] - row ? SS_BAND_ROWS : high[1] - row;
        gl->glReadPixels(low[0], row, width, count, GL_RGBA_INTEGER, GL_UNSIGNED_INT, band);
        for (int64_t i = 0; i < (int64_t)count * width; i++)
            texels[(int64_t)(row - low[1]) * width + i] = band[i][0];
    }
}

static void attach_shader(const ss_egl_api *gl, GLuint program, GLenum kind, const char *source) {
    GLuint shader = gl->glCreateShader(kind);
    gl->glShaderSource(shader, 1, &source, NULL);
    gl->glCompileShader(shader);
    gl->glAttachShader(program, shader);
    gl->glDeleteShader(shader); /* the program keeps it alive */
}

skinslide_status ss_gl_program(const ss_egl_api *gl, const char *vertex, const char *fragment, const char *const *captured,
                               int32_t captured_count, GLuint *program, skinslide_error *error) {
    GLint linked = GL_FALSE;
    *program = gl->glCreateProgram();
    attach_shader(gl, *program, GL_VERTEX_SHADER, vertex);
    attach_shader(gl, *program, GL_FRAGMENT_SHADER, fragment);
    if (captured_count > 0)
        gl->glTransformFeedbackVaryings(*program, captured_count, captured, GL_INTERLEAVED_ATTRIBS);
    gl->glLinkProgram(*program);
    gl->glGetProgramiv(*program, GL_LINK_STATUS, &linked);
    if (linked)
        return SKINSLIDE_OK;
    char text[200] = "";
    gl->glGetProgramInfoLog(*program, sizeof text, NULL, text);
    text[strcspn(text, "\n")] = 0;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "the device's compiler refuses a program: %s", text);
}
