/* Draws values of a mesh's vertices in its texture coordinates.
 *
 * Texels are 32 bits of whole numbers, which every OpenGL ES 3 draws: a covered one holds the bits of a float, an uncovered one
 * a pattern that no number has. So coverage costs no memory of its own, and no device lacks what it takes.
 *
 * A triangle's three corners and values go to the fragment shader as they are, relative to a texel near them, and the value at
 * a texel's centre comes from barycentric coordinates found there: the device's own interpolation loses digits with the
 * distance from the texture's corner and with the triangle's thinness.
 *
 * Then DILATION passes from one texture into the other: each uncovered texel that touches covered ones, along a side or at a
 * corner, takes their mean. Only the texels near what was drawn are gone over and read. */
#include "map.h"
#include "paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SIDE = 16384, DILATION = 4 };
static const uint32_t uncovered = 0xffffffffu; /* in the shaders, too */

/* A triangle as the shaders read it. */
typedef struct triangle {
    float corner[3][2]; /* in texels, from the origin */
    float origin[2];    /* whole texels */
    float value[3];
} triangle;

/* Texels [low, high) along both directions. */
typedef struct box {
    int32_t low[2], high[2];
} box;

/* What is drawn of a tile. */
typedef struct drawing {
    ss_memory memory;
    const skinslide_charts *charts;
    int32_t *face_start; /* [mesh face_count + 1] */
    int32_t *tiles;      /* [index_count] of each corner */
    int32_t tile, side;
    triangle *triangles;
    int32_t triangle_count, missed_faces;
    box reach; /* of the triangles, dilated */
} drawing;

struct skinslide_map_canvas {
    ss_egl *egl;
    int32_t side;
    GLuint draw_program, dilate_program, triangle_array, empty_array, triangle_buffer;
    GLuint textures[2], framebuffers[2];
};

/* ---- Programs ---- */

static const char draw_vertex[] = "#version 300 es\n"
                                  "uniform float side;\n"
                                  "layout(location = 0) in vec4 first_two;\n"
                                  "layout(location = 1) in vec4 third_and_origin;\n"
                                  "layout(location = 2) in vec3 corner_values;\n"
                                  "flat out highp vec4 ab;\n"
                                  "flat out highp vec4 c_origin;\n"
                                  "flat out highp vec3 values;\n"
                                  "void main() {\n"
                                  "    ab = first_two;\n"
                                  "    c_origin = third_and_origin;\n"
                                  "    values = corner_values;\n"
                                  "    vec2 corner = gl_VertexID == 0 ? ab.xy : gl_VertexID == 1 ? ab.zw : c_origin.xy;\n"
                                  "    gl_Position = vec4(2.0 * (c_origin.zw + corner) / side - 1.0, 0.0, 1.0);\n"
                                  "}\n";

/* A device that takes a centre just outside for inside must not extrapolate. */
static const char draw_fragment[] = "#version 300 es\n"
                                    "precision highp float;\n"
                                    "flat in highp vec4 ab;\n"
                                    "flat in highp vec4 c_origin;\n"
                                    "flat in highp vec3 values;\n"
                                    "layout(location = 0) out highp uint texel;\n"
                                    "float cross_of(vec2 a, vec2 b) {\n"
                                    "    return a.x * b.y - a.y * b.x;\n"
                                    "}\n"
                                    "void main() {\n"
                                    "    vec2 p = gl_FragCoord.xy - c_origin.zw - ab.xy;\n"
                                    "    vec2 b = ab.zw - ab.xy, c = c_origin.xy - ab.xy;\n"
                                    "    float area = cross_of(b, c), inverse = abs(area) > 1e-30 ? 1.0 / area : 0.0;\n"
                                    "    float at_b = cross_of(p, c) * inverse, at_c = cross_of(b, p) * inverse;\n"
                                    "    float value = (1.0 - at_b - at_c) * values.x + at_b * values.y + at_c * values.z;\n"
                                    "    float low = min(values.x, min(values.y, values.z));\n"
                                    "    float high = max(values.x, max(values.y, values.z));\n"
                                    "    texel = floatBitsToUint(clamp(value, low, high));\n"
                                    "}\n";

/* One triangle over everything. */
static const char dilate_vertex[] =
    "#version 300 es\n"
    "void main() {\n"
    "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
    "}\n";

/* Of eighths, so that no sum is too large; and no mean lies outside what it is of, however sums round. */
static const char dilate_fragment[] = "#version 300 es\n"
                                      "precision highp float;\n"
                                      "precision highp int;\n"
                                      "uniform highp usampler2D texels;\n"
                                      "layout(location = 0) out highp uint texel;\n"
                                      "void main() {\n"
                                      "    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(texels, 0) - 1;\n"
                                      "    texel = texelFetch(texels, here, 0).r;\n"
                                      "    if (texel != 0xffffffffu)\n"
                                      "        return;\n"
                                      "    ivec2 from = max(here - 1, 0), to = min(here + 1, last);\n"
                                      "    float sum = 0.0, count = 0.0, low = 0.0, high = 0.0;\n"
                                      "    for (int y = from.y; y <= to.y; y++)\n"
                                      "        for (int x = from.x; x <= to.x; x++) {\n"
                                      "            uint other = texelFetch(texels, ivec2(x, y), 0).r;\n"
                                      "            if (other != 0xffffffffu) {\n"
                                      "                float value = uintBitsToFloat(other);\n"
                                      "                low = count > 0.0 ? min(low, value) : value;\n"
                                      "                high = count > 0.0 ? max(high, value) : value;\n"
                                      "                sum += 0.125 * value;\n"
                                      "                count += 0.125;\n"
                                      "            }\n"
                                      "        }\n"
                                      "    if (count > 0.0)\n"
                                      "        texel = floatBitsToUint(clamp(sum / count, low, high));\n"
                                      "}\n";

/* ---- Creation ---- */

static skinslide_status make_texture(skinslide_map_canvas *canvas, int k, skinslide_error *error) {
    const ss_egl_api *gl = &canvas->egl->api;
    int32_t side = canvas->side;
    gl->glGenTextures(1, &canvas->textures[k]);
    gl->glBindTexture(GL_TEXTURE_2D, canvas->textures[k]);
    gl->glTexStorage2D(GL_TEXTURE_2D, 1, GL_R32UI, side, side);
    gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->glGenFramebuffers(1, &canvas->framebuffers[k]);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[k]);
    gl->glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, canvas->textures[k], 0);
    GLenum state = gl->glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state == GL_FRAMEBUFFER_COMPLETE)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_DEVICE_FAILED, "the device's framebuffer of %d by %d texels is not complete: 0x%04x", side,
                   side, state);
}

static void make_arrays(skinslide_map_canvas *canvas) {
    static const GLint widths[3] = {4, 4, 3};
    const ss_egl_api *gl = &canvas->egl->api;
    gl->glGenVertexArrays(1, &canvas->empty_array);
    gl->glGenVertexArrays(1, &canvas->triangle_array);
    gl->glGenBuffers(1, &canvas->triangle_buffer);
    gl->glBindVertexArray(canvas->triangle_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, canvas->triangle_buffer);
    for (GLuint place = 0; place < 3; place++) {
        gl->glEnableVertexAttribArray(place);
        gl->glVertexAttribPointer(place, widths[place], GL_FLOAT, GL_FALSE, sizeof(triangle),
                                  (const void *)(uintptr_t)(4 * place * sizeof(float)));
        gl->glVertexAttribDivisor(place, 1);
    }
}

static skinslide_status make_programs(skinslide_map_canvas *canvas, skinslide_error *error) {
    const ss_egl_api *gl = &canvas->egl->api;
    skinslide_status status = ss_gl_program(gl, draw_vertex, draw_fragment, NULL, 0, &canvas->draw_program, error);
    if (!status)
        status = ss_gl_program(gl, dilate_vertex, dilate_fragment, NULL, 0, &canvas->dilate_program, error);
    if (status)
        return status;
    gl->glUseProgram(canvas->draw_program);
    gl->glUniform1f(gl->glGetUniformLocation(canvas->draw_program, "side"), (float)canvas->side);
    return SKINSLIDE_OK;
}

static skinslide_status make_objects(skinslide_map_canvas *canvas, skinslide_error *error) {
    const ss_egl_api *gl = &canvas->egl->api;
    ss_egl_before before;
    skinslide_status status = ss_gl_enter(canvas->egl, &before, error);
    if (status)
        return status;
    status = make_programs(canvas, error);
    for (int k = 0; !status && k < 2; k++)
        status = make_texture(canvas, k, error);
    if (!status)
        make_arrays(canvas);
    gl->glDisable(GL_DITHER);
    gl->glEnable(GL_SCISSOR_TEST);
    gl->glViewport(0, 0, canvas->side, canvas->side);
    skinslide_status left = ss_gl_leave(canvas->egl, &before, "making a map's canvas", status ? NULL : error);
    return status ? status : left;
}

skinslide_status ss_map_canvas_create(int32_t side, const ss_device_request *request, skinslide_map_canvas **out,
                                      skinslide_error *error) {
    if (!out || request->device < SKINSLIDE_ANY_DEVICE)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the canvas, or no such device: %d", request->device);
    if (side < 1 || side > MOST_SIDE)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a map of %d texels a side; it must have 1 to %d", side, MOST_SIDE);
    skinslide_map_canvas *canvas = calloc(1, sizeof *canvas);
    if (!canvas)
        return ss_out_of_memory(error);
    canvas->side = side;
    skinslide_status status = ss_egl_open(request, &canvas->egl, error);
    if (!status && side > canvas->egl->info.largest_resolution)
        status = ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a map of %d texels a side is above the device's limit of %d", side,
                         canvas->egl->info.largest_resolution);
    if (!status)
        status = make_objects(canvas, error);
    if (status)
        skinslide_map_canvas_destroy(canvas);
    else
        *out = canvas;
    return status;
}

skinslide_status skinslide_map_canvas_create(int32_t side, int32_t device, skinslide_map_canvas **out, skinslide_error *error) {
    const ss_device_request request = {ss_egl_load, device, false};
    return ss_map_canvas_create(side, &request, out, error);
}

void skinslide_map_canvas_destroy(skinslide_map_canvas *canvas) {
    if (!canvas)
        return;
    ss_egl_close(canvas->egl); /* and with the context all of its objects */
    free(canvas);
}

/* ---- Triangles ---- */

static bool is_in_tile(const drawing *d, int32_t face) {
    for (int32_t c = d->face_start[face]; c < d->face_start[face + 1]; c++)
        if (d->tiles[c] == d->tile)
            return true;
    return false;
}

static double texel_of(const drawing *d, int32_t corner, int k) {
    int32_t place = d->tile - SS_FIRST_TILE, origin = k ? place / SS_TILE_COLUMNS : place % SS_TILE_COLUMNS;
    return ((double)d->charts->st[2 * (int64_t)corner + k] - origin) * d->side;
}

/* Where the line of texel centres at height y crosses a triangle: low to high; none where high is less. */
static void cross_line(const double corner[3][2], double y, double *low, double *high) {
    *low = INFINITY, *high = -INFINITY;
    for (int i = 0; i < 3; i++) {
        const double *a = corner[i], *b = corner[(i + 1) % 3];
        if ((a[1] < y && b[1] < y) || (a[1] > y && b[1] > y))
            continue;
        double share = a[1] == b[1] ? 0 : (y - a[1]) / (b[1] - a[1]);
        *low = fmin(*low, fmin(a[0] + share * (b[0] - a[0]), a[1] == b[1] ? b[0] : INFINITY));
        *high = fmax(*high, fmax(a[0] + share * (b[0] - a[0]), a[1] == b[1] ? b[0] : -INFINITY));
    }
}

/* Whether a triangle has the centre of a texel, border included. */
static bool has_centre(const double corner[3][2], int32_t side) {
    double lowest = fmin(corner[0][1], fmin(corner[1][1], corner[2][1]));
    double highest = fmax(corner[0][1], fmax(corner[1][1], corner[2][1]));
    int32_t last = (int32_t)fmin(side - 1, floor(highest - 0.5));
    for (int32_t row = (int32_t)fmax(0, ceil(lowest - 0.5)); row <= last; row++) {
        double low, high;
        cross_line(corner, row + 0.5, &low, &high);
        double column = fmax(0, ceil(low - 0.5));
        if (column <= high - 0.5 && column < side)
            return true;
    }
    return false;
}

static void widen(box *reach, const double corner[3][2], int32_t side) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) {
            double within = fmin(fmax(corner[i][k], 0), side);
            int32_t low = (int32_t)floor(within) - DILATION, high = (int32_t)ceil(within) + DILATION;
            low = low > 0 ? low : 0, high = high < side ? high : side;
            reach->low[k] = low < reach->low[k] ? low : reach->low[k];
            reach->high[k] = high > reach->high[k] ? high : reach->high[k];
        }
}

static void add_triangle(drawing *d, const int32_t corners[3], const double place[3][2], const float *values) {
    triangle *made = &d->triangles[d->triangle_count++];
    for (int k = 0; k < 2; k++)
        made->origin[k] = (float)floor(fmin(place[0][k], fmin(place[1][k], place[2][k])));
    for (int i = 0; i < 3; i++) {
        made->value[i] = values[d->charts->mesh->face_indices[corners[i]]];
        for (int k = 0; k < 2; k++)
            made->corner[i][k] = (float)(place[i][k] - made->origin[k]);
    }
    widen(&d->reach, place, d->side);
}

/* The fan of a face. */
static void add_face(drawing *d, int32_t face, const float *values) {
    bool found = false;
    for (int32_t c = d->face_start[face] + 1; c + 1 < d->face_start[face + 1]; c++) {
        const int32_t corners[3] = {d->face_start[face], c, c + 1};
        double place[3][2];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 2; k++)
                place[i][k] = texel_of(d, corners[i], k);
        add_triangle(d, corners, (const double(*)[2])place, values);
        found = found || has_centre((const double(*)[2])place, d->side);
    }
    d->missed_faces += !found;
}

/* ---- What is drawn ---- */

static skinslide_status check_values(const drawing *d, const float *values, skinslide_error *error) {
    for (int32_t i = 0; i < d->charts->face_count; i++) {
        int32_t face = d->charts->faces[i];
        for (int32_t c = d->face_start[face]; c < d->face_start[face + 1]; c++) {
            int32_t vertex = d->charts->mesh->face_indices[c];
            if (!isfinite(values[vertex]))
                return ss_fail(error, SKINSLIDE_BAD_POINTS, "vertex %d has the value %g", vertex, (double)values[vertex]);
        }
    }
    return SKINSLIDE_OK;
}

static skinslide_status find_triangles(drawing *d, const float *values, skinslide_error *error) {
    const skinslide_mesh *mesh = d->charts->mesh;
    d->tiles = SS_NEW(&d->memory, int32_t, mesh->index_count);
    d->face_start = SS_NEW(&d->memory, int32_t, (int64_t)mesh->face_count + 1);
    if (d->memory.failed)
        return ss_out_of_memory(error);
    skinslide_status status =
        skinslide_map_tiles(mesh, d->charts->faces, d->charts->face_count, d->charts->st, d->tiles, error);
    if (status)
        return status;
    for (int32_t f = 0; f < mesh->face_count; f++)
        d->face_start[f + 1] = d->face_start[f] + mesh->face_counts[f];
    if ((status = check_values(d, values, error)))
        return status;
    int64_t most = 0;
    for (int32_t i = 0; i < d->charts->face_count; i++)
        most += mesh->face_counts[d->charts->faces[i]];
    d->triangles = ss_new(&d->memory, most < INT32_MAX ? most : -1, sizeof *d->triangles);
    if (!d->triangles)
        return ss_out_of_memory(error);
    d->reach = (box){{d->side, d->side}, {0, 0}};
    for (int32_t i = 0; i < d->charts->face_count; i++)
        if (is_in_tile(d, d->charts->faces[i]))
            add_face(d, d->charts->faces[i], values);
    return SKINSLIDE_OK;
}

/* ---- Drawing ---- */

static void clear(const skinslide_map_canvas *canvas) {
    const ss_egl_api *gl = &canvas->egl->api;
    const GLuint empty[4] = {uncovered, uncovered, uncovered, uncovered};
    gl->glScissor(0, 0, canvas->side, canvas->side);
    for (int k = 0; k < 2; k++) {
        gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[k]);
        gl->glClearBufferuiv(GL_COLOR, 0, empty);
    }
}

static void draw_triangles(const skinslide_map_canvas *canvas, const drawing *d) {
    const ss_egl_api *gl = &canvas->egl->api;
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[0]);
    gl->glUseProgram(canvas->draw_program);
    gl->glBindVertexArray(canvas->triangle_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, canvas->triangle_buffer);
    gl->glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)d->triangle_count * (GLsizeiptr)sizeof *d->triangles, d->triangles,
                     GL_STREAM_DRAW);
    gl->glDrawArraysInstanced(GL_TRIANGLES, 0, 3, d->triangle_count);
}

/* An even number of times: the result is where the triangles were drawn. */
static void dilate(const skinslide_map_canvas *canvas) {
    const ss_egl_api *gl = &canvas->egl->api;
    gl->glUseProgram(canvas->dilate_program);
    gl->glBindVertexArray(canvas->empty_array);
    for (int pass = 0; pass < DILATION; pass++) {
        gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[(pass + 1) % 2]);
        gl->glBindTexture(GL_TEXTURE_2D, canvas->textures[pass % 2]);
        gl->glDrawArrays(GL_TRIANGLES, 0, 3);
    }
}

/* texels: those of the reach, the lowest row first. */
static skinslide_status draw(const skinslide_map_canvas *canvas, const drawing *d, uint32_t (*band)[4], uint32_t *texels,
                             skinslide_error *error) {
    ss_egl_before before;
    const ss_egl_api *gl = &canvas->egl->api;
    const box *reach = &d->reach;
    skinslide_status status = ss_gl_enter(canvas->egl, &before, error);
    if (status)
        return status;
    clear(canvas);
    gl->glScissor(reach->low[0], reach->low[1], reach->high[0] - reach->low[0], reach->high[1] - reach->low[1]);
    draw_triangles(canvas, d);
    dilate(canvas);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[0]);
    ss_gl_read_numbers(gl, reach->low, reach->high, band, texels);
    return ss_gl_leave(canvas->egl, &before, "drawing a map", error);
}

static float value_of(uint32_t texel) {
    float value;
    memcpy(&value, &texel, sizeof value);
    return texel == uncovered ? 0 : value;
}

/* From the top row on. */
static void write_map(const drawing *d, const uint32_t *texels, float *map) {
    int32_t left = d->reach.low[0], width = d->reach.high[0] - left, height = d->reach.high[1] - d->reach.low[1];
    memset(map, 0, (size_t)d->side * (size_t)d->side * sizeof *map);
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++)
            map[(int64_t)(d->side - 1 - d->reach.low[1] - y) * d->side + left + x] = value_of(texels[(int64_t)y * width + x]);
}

static skinslide_status check(const skinslide_map_canvas *canvas, const skinslide_charts *charts, int32_t tile,
                              const float *values, const float *texels, skinslide_error *error) {
    if (!canvas || !charts || !values || !texels)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, charts, values, or place for the texels");
    if (tile < SS_FIRST_TILE || tile >= SS_FIRST_TILE + SS_TILE_COLUMNS * SS_TILE_ROWS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such tile: %d", tile);
    return ss_check_mesh(charts->mesh, error);
}

skinslide_status skinslide_map_draw(skinslide_map_canvas *canvas, const skinslide_charts *charts, int32_t tile,
                                    const float *values, float *texels, int32_t *missed_faces, skinslide_error *error) {
    skinslide_status status = check(canvas, charts, tile, values, texels, error);
    if (status)
        return status;
    drawing d = {.charts = charts, .tile = tile, .side = canvas->side};
    status = find_triangles(&d, values, error);
    int64_t width = d.reach.high[0] - d.reach.low[0], height = d.reach.high[1] - d.reach.low[1];
    if (!status && d.triangle_count > 0) {
        uint32_t(*band)[4] = ss_new(&d.memory, SS_BAND_ROWS * width, sizeof *band);
        uint32_t *drawn = SS_NEW(&d.memory, uint32_t, width * height);
        status = d.memory.failed ? ss_out_of_memory(error) : draw(canvas, &d, band, drawn, error);
        if (!status)
            write_map(&d, drawn, texels);
    } else if (!status) {
        memset(texels, 0, (size_t)d.side * (size_t)d.side * sizeof *texels);
    }
    if (!status && missed_faces)
        *missed_faces = d.missed_faces;
    ss_free(&d.memory);
    return status;
}
