/* Draws the faces of a frame's embedding as numbers, and gathers for each query the numbers around it (paper, section 3.3).
 *
 * Two passes on the device. The first draws Ud into an R32UI texture, [0,1]^2 on all of it: each face by its triangle fan, in
 * its number plus one. The second runs once a query, as a vertex shader with its output captured: it fetches the 3x3 texels
 * around u_i and writes the distinct numbers, the own texel's first. So nine numbers a query come back and never the texture,
 * whatever its size; the fixed count costs a few bytes more than a list and needs no second trip for its length. Neither pass
 * is waited for: the host goes on with the next patch, and first waits when it maps the answers.
 *
 * What comes back only proposes faces. Everything may fail at any time; the context is then dropped, the caller walks, and the
 * next draw makes a new one. None is made any more where one cannot be made, or where two in a row are lost before either
 * answers.
 *
 * Resolution: a power of two from 256 to 4096. Four texels a free vertex, along a side; more where the smallest face of the
 * rest embedding would be under a texel, up to four times as many. */
#include "device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SMALLEST_SIDE = 256, LARGEST_SIDE = 4096, MOST_LOSSES = 2 };

/* One patch: its arrays on the host, its buffers on the device. */
typedef struct drawing {
    const ss_faces *faces;
    int32_t vertex_count; /* of the triangles of all fans */
    int32_t query_count;
    int32_t side;
    GLuint arrays[2];  /* of the two passes */
    GLuint buffers[4]; /* place and number of each vertex; queries; answers */
    bool drawn;        /* drawn, and the device has not failed since */
} drawing;

struct ss_idbuffer {
    ss_memory memory;
    ss_device_request request;
    ss_egl *egl; /* NULL once lost, until it is made again */
    bool gone;   /* lost too often: it is not made again */
    int losses;  /* how many since it last answered */
    skinslide_device_info info;
    char reason[480];  /* how it failed last */
    drawing *drawings; /* [drawing_count] */
    int32_t drawing_count, largest_side;
    int32_t least_side; /* of the texture, whatever is drawn */
    int32_t resolution; /* 0: each drawing its own */
    float (*staged)[2]; /* [most vertices or queries] on their way to the device */
    uint32_t *numbers;  /* [most vertices] */
    GLuint draw_program, gather_program, framebuffer, small_framebuffer;
    GLint side_uniform;
};

/* ---- Resolution ---- */

int32_t ss_id_side(const ss_patch *patch, const double (*rest_uv)[2]) {
    double wanted = 4 * sqrt(patch->free_count), smallest = INFINITY;
    for (int32_t f = 0; f < patch->faces.face_count; f++)
        for (int32_t t = 0; t < ss_fan_size(&patch->faces, f); t++) {
            int32_t v[3];
            ss_fan(&patch->faces, f, t, v);
            const double *a = rest_uv[v[0]], *b = rest_uv[v[1]], *c = rest_uv[v[2]];
            double area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
            smallest = area > 0 && area < smallest ? area : smallest;
        }
    double fine = 1 / sqrt(smallest);
    wanted = fine < wanted ? wanted : fine > 4 * wanted ? 4 * wanted : fine;
    int32_t side = SMALLEST_SIDE;
    while (side < wanted && side < LARGEST_SIDE)
        side *= 2;
    return side;
}

/* ---- Programs ---- */

static const char draw_vertex[] = "#version 300 es\n"
                                  "layout(location = 0) in vec2 uv;\n"
                                  "layout(location = 1) in highp uint number;\n"
                                  "flat out highp uint face;\n"
                                  "void main() {\n"
                                  "    face = number;\n"
                                  "    gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);\n"
                                  "}\n";

static const char draw_fragment[] = "#version 300 es\n"
                                    "flat in highp uint face;\n"
                                    "layout(location = 0) out highp uint texel;\n"
                                    "void main() {\n"
                                    "    texel = face;\n"
                                    "}\n";

static const char gather_vertex[] = "#version 300 es\n"
                                    "precision highp float;\n"
                                    "precision highp int;\n"
                                    "uniform highp usampler2D texels;\n"
                                    "uniform int side;\n"
                                    "layout(location = 0) in vec2 query;\n"
                                    "flat out uvec3 answer0, answer1, answer2;\n"
                                    "void main() {\n"
                                    "    ivec2 centre = clamp(ivec2(query * float(side)), 0, side - 1);\n"
                                    "    uint found[9];\n"
                                    "    for (int i = 0; i < 9; i++)\n"
                                    "        found[i] = 0u;\n"
                                    "    found[0] = texelFetch(texels, centre, 0).r;\n"
                                    "    int count = 1;\n"
                                    "    for (int i = 0; i < 9; i++) {\n"
                                    "        ivec2 at = clamp(centre + ivec2(i % 3, i / 3) - 1, 0, side - 1);\n"
                                    "        uint face = texelFetch(texels, at, 0).r;\n"
                                    "        bool seen = face == 0u;\n"
                                    "        for (int k = 0; k < count; k++)\n"
                                    "            seen = seen || found[k] == face;\n"
                                    "        if (!seen)\n"
                                    "            found[count++] = face;\n"
                                    "    }\n"
                                    "    answer0 = uvec3(found[0], found[1], found[2]);\n"
                                    "    answer1 = uvec3(found[3], found[4], found[5]);\n"
                                    "    answer2 = uvec3(found[6], found[7], found[8]);\n"
                                    "    gl_Position = vec4(0.0);\n"
                                    "}\n";

static const char gather_fragment[] = "#version 300 es\n"
                                      "void main() {\n"
                                      "}\n";

/* ---- Objects of the context ---- */

/* The texture, as large as the largest drawing, stays bound; a pixel of its own serves the second pass, since a texture must
 * not be read while it is drawn to. */
static skinslide_status make_targets(ss_idbuffer *buffer, skinslide_error *error) {
    const ss_egl_api *gl = &buffer->egl->api;
    GLuint texture, pixel;
    int32_t side = buffer->largest_side;
    gl->glGenTextures(1, &texture);
    gl->glBindTexture(GL_TEXTURE_2D, texture);
    gl->glTexStorage2D(GL_TEXTURE_2D, 1, GL_R32UI, side, side);
    gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->glGenFramebuffers(1, &buffer->framebuffer);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, buffer->framebuffer);
    gl->glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    GLenum state = gl->glCheckFramebufferStatus(GL_FRAMEBUFFER);
    gl->glGenRenderbuffers(1, &pixel);
    gl->glBindRenderbuffer(GL_RENDERBUFFER, pixel);
    gl->glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
    gl->glGenFramebuffers(1, &buffer->small_framebuffer);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, buffer->small_framebuffer);
    gl->glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, pixel);
    if (state == GL_FRAMEBUFFER_COMPLETE)
        state = gl->glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state == GL_FRAMEBUFFER_COMPLETE)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "the device's framebuffer of %d by %d texels is not complete: 0x%04x", side,
                   side, state);
}

/* The number of its face at each vertex of the fans: the same for every frame. */
static void make_numbers(const drawing *drawn, uint32_t *numbers) {
    int32_t n = 0;
    for (int32_t f = 0; f < drawn->faces->face_count; f++)
        for (int32_t t = 0; t < 3 * ss_fan_size(drawn->faces, f); t++)
            numbers[n++] = (uint32_t)f + 1;
}

static void make_buffers(ss_idbuffer *buffer, drawing *drawn) {
    const ss_egl_api *gl = &buffer->egl->api;
    gl->glGenVertexArrays(2, drawn->arrays);
    gl->glGenBuffers(4, drawn->buffers);
    make_numbers(drawn, buffer->numbers);
    gl->glBindVertexArray(drawn->arrays[0]);
    gl->glBindBuffer(GL_ARRAY_BUFFER, drawn->buffers[0]);
    gl->glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
    gl->glEnableVertexAttribArray(0);
    gl->glBindBuffer(GL_ARRAY_BUFFER, drawn->buffers[1]);
    gl->glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)drawn->vertex_count * (GLsizeiptr)sizeof *buffer->numbers, buffer->numbers,
                     GL_STATIC_DRAW);
    gl->glVertexAttribIPointer(1, 1, GL_UNSIGNED_INT, 0, NULL);
    gl->glEnableVertexAttribArray(1);
    gl->glBindVertexArray(drawn->arrays[1]);
    gl->glBindBuffer(GL_ARRAY_BUFFER, drawn->buffers[2]);
    gl->glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
    gl->glEnableVertexAttribArray(0);
    gl->glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, drawn->buffers[3]);
    gl->glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, (GLsizeiptr)drawn->query_count * (GLsizeiptr)sizeof(ss_candidates), NULL,
                     GL_STREAM_READ);
}

static skinslide_status make_objects(ss_idbuffer *buffer, skinslide_error *error) {
    const ss_egl_api *gl = &buffer->egl->api;
    static const char *const answers[] = {"answer0", "answer1", "answer2"};
    skinslide_status status = ss_gl_program(gl, draw_vertex, draw_fragment, NULL, 0, &buffer->draw_program, error);
    if (!status)
        status = ss_gl_program(gl, gather_vertex, gather_fragment, answers, 3, &buffer->gather_program, error);
    if (!status)
        status = make_targets(buffer, error);
    if (status)
        return status;
    buffer->side_uniform = gl->glGetUniformLocation(buffer->gather_program, "side");
    gl->glDisable(GL_DITHER);
    gl->glEnable(GL_SCISSOR_TEST);
    for (int32_t p = 0; p < buffer->drawing_count; p++)
        make_buffers(buffer, &buffer->drawings[p]);
    char failure[64];
    if (ss_gl_did(gl, failure, sizeof failure))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "the device has no room for the patches: %s", failure);
}

/* ---- Losing a context and making it again ---- */

static void lose(ss_idbuffer *buffer, const char *call, const char *failure) {
    snprintf(buffer->reason, sizeof buffer->reason, "%s: %s", call, failure);
    ss_egl_close(buffer->egl);
    buffer->egl = NULL;
    buffer->gone = ++buffer->losses >= MOST_LOSSES;
    for (int32_t p = 0; p < buffer->drawing_count; p++)
        buffer->drawings[p].drawn = false;
}

static bool enter(ss_idbuffer *buffer, ss_egl_before *before) {
    if (!buffer->egl)
        return false;
    if (ss_egl_enter(buffer->egl, before))
        return true;
    lose(buffer, "eglMakeCurrent", ss_egl_error_name(before->failure));
    return false;
}

static void leave(ss_idbuffer *buffer, const ss_egl_before *before, const char *what, bool mapped) {
    char failure[64];
    bool good = ss_gl_did(&buffer->egl->api, failure, sizeof failure);
    ss_egl_leave(buffer->egl, before);
    if (!good || !mapped)
        lose(buffer, what, good ? "its answers cannot be mapped" : failure);
}

/* Fits the sides of all textures to the device's limit: a fixed resolution above it is an error, others are reduced. */
static skinslide_status settle_sides(ss_idbuffer *buffer, skinslide_error *error) {
    int32_t most = buffer->info.largest_resolution;
    if (buffer->resolution > most)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "resolution %d is above the device's limit of %d", buffer->resolution,
                       most);
    buffer->largest_side = buffer->resolution ? buffer->resolution : buffer->least_side < most ? buffer->least_side : most;
    for (int32_t p = 0; p < buffer->drawing_count; p++) {
        int32_t *side = &buffer->drawings[p].side;
        *side = buffer->resolution ? buffer->resolution : *side < most ? *side : most;
        buffer->largest_side = *side > buffer->largest_side ? *side : buffer->largest_side;
    }
    return SKINSLIDE_OK;
}

static skinslide_status open_context(ss_idbuffer *buffer, skinslide_error *error) {
    ss_egl_before before;
    skinslide_status status = ss_egl_open(&buffer->request, &buffer->egl, error);
    if (status)
        return status;
    buffer->info = buffer->egl->info;
    status = settle_sides(buffer, error);
    if (!status)
        status = ss_gl_enter(buffer->egl, &before, error);
    if (!status) {
        status = make_objects(buffer, error);
        ss_egl_leave(buffer->egl, &before);
    }
    if (status) {
        ss_egl_close(buffer->egl);
        buffer->egl = NULL;
    }
    return status;
}

/* Enters the context, or a new one if it was lost. */
static bool enter_anew(ss_idbuffer *buffer, ss_egl_before *before) {
    skinslide_error error;
    if (enter(buffer, before))
        return true;
    if (!buffer->gone && open_context(buffer, &error)) {
        snprintf(buffer->reason, sizeof buffer->reason, "%s", error.message);
        buffer->gone = true;
    }
    return enter(buffer, before);
}

/* ---- Creation ---- */

static skinslide_status copy_patches(ss_idbuffer *buffer, const ss_id_patch *patches, skinslide_error *error) {
    int32_t most = 1, most_vertices = 1;
    buffer->drawings = SS_NEW(&buffer->memory, drawing, buffer->drawing_count);
    for (int32_t p = 0; p < buffer->drawing_count && buffer->drawings; p++) {
        drawing *drawn = &buffer->drawings[p];
        drawn->faces = patches[p].faces;
        drawn->vertex_count = 3 * (drawn->faces->corner_count - 2 * drawn->faces->face_count);
        drawn->query_count = patches[p].query_count;
        drawn->side = patches[p].side;
        most_vertices = drawn->vertex_count > most_vertices ? drawn->vertex_count : most_vertices;
        most = drawn->query_count > most ? drawn->query_count : most;
    }
    most = most_vertices > most ? most_vertices : most;
    buffer->staged = ss_new(&buffer->memory, most, sizeof *buffer->staged);
    buffer->numbers = SS_NEW(&buffer->memory, uint32_t, most_vertices);
    return buffer->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

skinslide_status ss_idbuffer_create(const ss_device_request *request, const ss_id_patch *patches, int32_t patch_count,
                                    int32_t resolution, ss_idbuffer **out, skinslide_error *error) {
    ss_idbuffer *buffer = calloc(1, sizeof *buffer);
    if (!buffer)
        return ss_out_of_memory(error);
    buffer->request = *request;
    buffer->drawing_count = patch_count;
    buffer->resolution = resolution;
    buffer->least_side = patches ? 1 : LARGEST_SIDE;
    skinslide_status status = copy_patches(buffer, patches, error);
    if (!status)
        status = open_context(buffer, error);
    if (status)
        ss_idbuffer_destroy(buffer);
    else
        *out = buffer;
    return status;
}

void ss_idbuffer_destroy(ss_idbuffer *buffer) {
    if (!buffer)
        return;
    ss_egl_close(buffer->egl); /* and with the context all of its objects */
    ss_free(&buffer->memory);
    free(buffer);
}

const skinslide_device_info *ss_idbuffer_device(const ss_idbuffer *buffer) {
    return &buffer->info;
}

const char *ss_idbuffer_reason(const ss_idbuffer *buffer) {
    return buffer->reason;
}

int32_t ss_idbuffer_side(const ss_idbuffer *buffer, int32_t patch) {
    return buffer->drawings[patch].side;
}

/* ---- The two passes ---- */

static void draw_faces(ss_idbuffer *buffer, const drawing *drawn, const double (*uv)[2]) {
    const ss_egl_api *gl = &buffer->egl->api;
    const GLuint nothing[4] = {0};
    int32_t n = 0;
    for (int32_t f = 0; f < drawn->faces->face_count; f++)
        for (int32_t t = 0; t < ss_fan_size(drawn->faces, f); t++) {
            int32_t v[3];
            ss_fan(drawn->faces, f, t, v);
            for (int k = 0; k < 3; k++, n++)
                buffer->staged[n][0] = (float)uv[v[k]][0], buffer->staged[n][1] = (float)uv[v[k]][1];
        }
    gl->glBindFramebuffer(GL_FRAMEBUFFER, buffer->framebuffer);
    gl->glViewport(0, 0, drawn->side, drawn->side);
    gl->glScissor(0, 0, drawn->side, drawn->side); /* clear only this part: the texture is as large as the largest drawing */
    gl->glClearBufferuiv(GL_COLOR, 0, nothing);
    gl->glUseProgram(buffer->draw_program);
    gl->glBindVertexArray(drawn->arrays[0]);
    gl->glBindBuffer(GL_ARRAY_BUFFER, drawn->buffers[0]);
    gl->glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)n * (GLsizeiptr)sizeof *buffer->staged, buffer->staged, GL_STREAM_DRAW);
    gl->glDrawArrays(GL_TRIANGLES, 0, n);
}

static void gather_candidates(ss_idbuffer *buffer, const drawing *drawn, const double (*queries)[2]) {
    const ss_egl_api *gl = &buffer->egl->api;
    for (int32_t i = 0; i < drawn->query_count; i++)
        buffer->staged[i][0] = (float)queries[i][0], buffer->staged[i][1] = (float)queries[i][1];
    gl->glBindFramebuffer(GL_FRAMEBUFFER, buffer->small_framebuffer);
    gl->glUseProgram(buffer->gather_program);
    gl->glUniform1i(buffer->side_uniform, drawn->side);
    gl->glBindVertexArray(drawn->arrays[1]);
    gl->glBindBuffer(GL_ARRAY_BUFFER, drawn->buffers[2]);
    gl->glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)drawn->query_count * (GLsizeiptr)sizeof *buffer->staged, buffer->staged,
                     GL_STREAM_DRAW);
    gl->glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, drawn->buffers[3]);
    gl->glEnable(GL_RASTERIZER_DISCARD);
    gl->glBeginTransformFeedback(GL_POINTS);
    gl->glDrawArrays(GL_POINTS, 0, drawn->query_count);
    gl->glEndTransformFeedback();
    gl->glDisable(GL_RASTERIZER_DISCARD);
    gl->glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
}

void ss_idbuffer_draw(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], const double (*queries)[2]) {
    drawing *drawn = &buffer->drawings[patch];
    ss_egl_before before;
    drawn->drawn = false;
    if (drawn->query_count == 0 || !enter_anew(buffer, &before))
        return;
    drawn->drawn = true;
    draw_faces(buffer, drawn, uv);
    gather_candidates(buffer, drawn, queries);
    leave(buffer, &before, "drawing faces", true);
}

/* Turns numbers into faces. One that is no face of the patch, as a device that fails silently may give, counts as none. */
static void copy_answers(const drawing *drawn, const uint32_t *answers, ss_candidates *candidates) {
    for (int32_t i = 0; i < drawn->query_count; i++)
        for (int32_t k = 0; k < SS_CANDIDATES; k++) {
            uint32_t number = answers[SS_CANDIDATES * (int64_t)i + k];
            candidates[i][k] = number <= (uint32_t)drawn->faces->face_count ? (int32_t)number - 1 : -1;
        }
}

bool ss_idbuffer_candidates(ss_idbuffer *buffer, int32_t patch, ss_candidates *candidates) {
    drawing *drawn = &buffer->drawings[patch];
    ss_egl_before before;
    if (!drawn->drawn || !enter(buffer, &before))
        return false;
    const ss_egl_api *gl = &buffer->egl->api;
    gl->glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, drawn->buffers[3]);
    const uint32_t *answers = gl->glMapBufferRange(
        GL_TRANSFORM_FEEDBACK_BUFFER, 0, (GLsizeiptr)drawn->query_count * (GLsizeiptr)sizeof *candidates, GL_MAP_READ_BIT);
    if (answers)
        copy_answers(drawn, answers, candidates);
    bool mapped = answers && gl->glUnmapBuffer(GL_TRANSFORM_FEEDBACK_BUFFER);
    leave(buffer, &before, "reading candidates", mapped);
    if (drawn->drawn)
        buffer->losses = 0;
    return drawn->drawn;
}

/* ---- The picture ---- */

skinslide_status ss_idbuffer_read(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], uint32_t *texels,
                                  skinslide_error *error) {
    const drawing *drawn = &buffer->drawings[patch];
    const int32_t low[2] = {0, 0}, high[2] = {drawn->side, drawn->side};
    ss_memory scratch = {0};
    ss_egl_before before;
    uint32_t(*band)[4] = ss_new(&scratch, (int64_t)SS_BAND_ROWS * drawn->side, sizeof *band);
    uint32_t *read = SS_NEW(&scratch, uint32_t, (int64_t)drawn->side * drawn->side);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status && enter_anew(buffer, &before)) {
        draw_faces(buffer, drawn, uv);
        ss_gl_read_numbers(&buffer->egl->api, low, high, band, read);
        leave(buffer, &before, "reading the ID buffer", true);
    }
    if (!status && !buffer->egl)
        status = ss_fail(error, SKINSLIDE_DEVICE_FAILED, "%s", buffer->reason);
    if (!status)
        memcpy(texels, read, (size_t)drawn->side * (size_t)drawn->side * sizeof *texels);
    ss_free(&scratch);
    return status;
}
