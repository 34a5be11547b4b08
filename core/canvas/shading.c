/* How figures look: the scale of false colours, the programs that draw surfaces and strokes, and the buffers that feed them. */
#include "canvas.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

enum { COLOURS = 5 };

/* From lowest to highest, linear light; as many as `colours` in the shader has. */
static const float scale_colours[COLOURS][3] = {{0.024f, 0.042f, 0.137f},
                                                {0.023f, 0.275f, 0.381f},
                                                {0.270f, 0.617f, 0.102f},
                                                {0.913f, 0.533f, 0.045f},
                                                {0.680f, 0.019f, 0.047f}};

void skinslide_false_colour(float share, float colour[3]) {
    float place = fminf(fmaxf(share, 0), 1) * (COLOURS - 1);
    int below = place < COLOURS - 1 ? (int)place : COLOURS - 2;
    for (int k = 0; k < 3; k++)
        colour[k] = scale_colours[below][k] + (place - (float)below) * (scale_colours[below + 1][k] - scale_colours[below][k]);
}

/* ---- Programs ---- */

static const char surface_vertex[] = "#version 300 es\n"
                                     "uniform mat4 to_clip;\n"
                                     "uniform mat3 turn_normal;\n"
                                     "layout(location = 0) in vec3 fixed_coordinates;\n"
                                     "layout(location = 1) in float posed_inside;\n"
                                     "layout(location = 2) in vec3 place;\n"
                                     "layout(location = 3) in vec3 surface_normal;\n"
                                     "layout(location = 4) in vec4 posed_values;\n"
                                     "out highp vec3 coordinates, normal;\n"
                                     "out highp float inside;\n"
                                     "out highp vec4 values;\n"
                                     "void main() {\n"
                                     "    coordinates = fixed_coordinates;\n"
                                     "    inside = posed_inside;\n"
                                     "    normal = turn_normal * surface_normal;\n"
                                     "    values = posed_values;\n"
                                     "    gl_Position = to_clip * vec4(place, 1.0);\n"
                                     "}\n";

/* Light from beside the camera, scaled so that a surface that faces the camera, or has no normal, shows its own colour:
 * base. */
static const char surface_fragment[] =
    "#version 300 es\n"
    "precision highp float;\n"
    "uniform int encoded;\n"
    "uniform vec3 scale[4];\n"
    "uniform vec3 colours[5];\n"
    "uniform sampler2D texels;\n"
    "in vec3 coordinates, normal;\n"
    "in float inside;\n"
    "in vec4 values;\n"
    "const vec3 plain = vec3(0.33, 0.31, 0.30);\n"
    "float shade(vec3 n) {\n"
    "    return 0.23 + 0.07 * n.y + 0.78 * max(dot(n, normalize(vec3(-0.35, 0.55, 0.8))), 0.0);\n"
    "}\n"
    "vec4 lit(vec3 base) {\n"
    "    vec3 n = normalize((gl_FrontFacing ? normal : -normal) + vec3(0.0, 0.0, 1e-6));\n"
    "    vec3 light = base * (shade(n) / shade(vec3(0.0, 0.0, 1.0)));\n"
    "    vec3 srgb = mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));\n"
    "    return vec4(encoded == 1 ? srgb : light, 1.0);\n"
    "}\n"
    /* The chequer's mean over the pixel, so that squares too small to be seen are grey. size is squares, and whether they are
     * in space; no value is read. */
    "vec3 chequer(float value, vec3 size) {\n"
    "    vec3 p = clamp(coordinates * size.x + 0.317 * size.y, -1e30, 1e30), w = max(fwidth(p), 1e-4);\n"
    "    vec3 mean = 2.0 * (abs(fract(0.5 * (p - 0.5 * w)) - 0.5) - abs(fract(0.5 * (p + 0.5 * w)) - 0.5)) / w;\n"
    "    float share = 0.5 - 0.5 * mean.x * mean.y * mix(1.0, mean.z, size.y);\n"
    "    return mix(mix(vec3(0.045, 0.055, 0.09), vec3(0.78, 0.74, 0.68), share), plain, 0.7 * (1.0 - inside));\n"
    "}\n"
    /* range is lowest, and the inverse of all of it. */
    "vec3 false_colour(float value, vec3 range) {\n"
    "    float place = clamp((value - range.x) * range.y, 0.0, 1.0) * 4.0;\n"
    "    vec3 found = colours[0];\n"
    "    for (int i = 0; i < 4; i++)\n"
    "        found += clamp(place - float(i), 0.0, 1.0) * (colours[i + 1] - colours[i]);\n"
    "    return inside > 0.5 ? found : plain;\n"
    "}\n"
    /* A tile of a texture, whose lower left corner is given. */
    "vec3 tile(vec3 corner) {\n"
    "    vec2 p = coordinates.xy - corner.xy;\n"
    "    vec3 found = texture(texels, vec2(p.x, 1.0 - p.y)).rgb;\n"
    "    if (any(lessThan(p, vec2(0.0))) || any(greaterThan(p, vec2(1.0))))\n"
    "        discard;\n"
    "    return found;\n"
    "}\n";

/* One output for each target that there may be; outputs for targets that are not drawn on are dropped. */
static const char tile_main[] = "layout(location = 0) out vec4 colour[4];\n"
                                "void main() {\n"
                                "    vec4 found = lit(tile(scale[0]));\n"
                                "    colour[0] = found, colour[1] = found, colour[2] = found, colour[3] = found;\n"
                                "}\n";

/* Each segment is a strip as wide as the line, with square ends. What is behind the near plane is cut off first, since it has
 * no place on the picture, where the width is measured. */
static const char stroke_vertex[] = "#version 300 es\n"
                                    "uniform mat4 to_clip;\n"
                                    "uniform vec3 pen;\n"
                                    "layout(location = 0) in vec3 begin;\n"
                                    "layout(location = 1) in vec3 end;\n"
                                    "layout(location = 2) in vec3 colour;\n"
                                    "flat out highp vec3 line_colour;\n"
                                    "void main() {\n"
                                    "    vec2 half_width = pen.xy;\n"
                                    "    line_colour = colour;\n"
                                    "    vec4 a = to_clip * vec4(begin, 1.0), b = to_clip * vec4(end, 1.0);\n"
                                    "    float a_ahead = a.z + a.w, b_ahead = b.z + b.w;\n"
                                    "    if (max(a_ahead, b_ahead) <= 0.0) {\n"
                                    "        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);\n"
                                    "        return;\n"
                                    "    }\n"
                                    "    if (a_ahead < 0.0)\n"
                                    "        a = mix(a, b, a_ahead / (a_ahead - b_ahead));\n"
                                    "    else if (b_ahead < 0.0)\n"
                                    "        b = mix(b, a, b_ahead / (b_ahead - a_ahead));\n"
                                    "    vec2 along = (b.xy / b.w - a.xy / a.w) / half_width;\n"
                                    "    along = dot(along, along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);\n"
                                    "    bool at_end = gl_VertexID > 1;\n"
                                    "    vec2 aside = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? 1.0 : -1.0);\n"
                                    "    gl_Position = at_end ? b : a;\n"
                                    "    gl_Position.xy += (aside + (at_end ? along : -along)) * half_width * gl_Position.w;\n"
                                    "    gl_Position.z -= pen.z * gl_Position.w;\n"
                                    "}\n";

static const char stroke_fragment[] = "#version 300 es\n"
                                      "precision highp float;\n"
                                      "flat in vec3 line_colour;\n"
                                      "layout(location = 0) out vec4 colour[4];\n"
                                      "void main() {\n"
                                      "    vec4 line = vec4(line_colour, 1.0);\n"
                                      "    colour[0] = line, colour[1] = line, colour[2] = line, colour[3] = line;\n"
                                      "}\n";

/* ---- Objects ---- */

static void point_to(const ss_egl_api *gl, GLuint place, int32_t width, size_t stride, size_t offset) {
    gl->glEnableVertexAttribArray(place);
    gl->glVertexAttribPointer(place, width, GL_FLOAT, GL_FALSE, (GLsizei)stride, (const void *)(uintptr_t)offset);
}

static void make_arrays(const ss_egl_api *gl, ss_figure_objects *objects) {
    gl->glGenBuffers(1, &objects->vertex_buffer);
    gl->glGenBuffers(1, &objects->triangle_buffer);
    gl->glGenBuffers(1, &objects->segment_buffer);
    gl->glGenVertexArrays(1, &objects->surface_array);
    gl->glBindVertexArray(objects->surface_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->vertex_buffer);
    point_to(gl, 0, 3, sizeof(ss_vertex_attributes), offsetof(ss_vertex_attributes, coordinates));
    point_to(gl, 1, 1, sizeof(ss_vertex_attributes), offsetof(ss_vertex_attributes, inside));
    point_to(gl, 2, 3, sizeof(ss_vertex_attributes), offsetof(ss_vertex_attributes, place));
    point_to(gl, 3, 3, sizeof(ss_vertex_attributes), offsetof(ss_vertex_attributes, normal));
    point_to(gl, 4, SKINSLIDE_MOST_TARGETS, sizeof(ss_vertex_attributes), offsetof(ss_vertex_attributes, values));
    gl->glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, objects->triangle_buffer);
    gl->glGenVertexArrays(1, &objects->stroke_array);
    gl->glBindVertexArray(objects->stroke_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->segment_buffer);
    for (GLuint part = 0; part < 3; part++) { /* its ends and its colour */
        point_to(gl, part, 3, sizeof(ss_segment), part * sizeof(float[3]));
        gl->glVertexAttribDivisor(part, 1);
    }
}

enum { MOST_TEXT = 6000 };

static skinslide_status make_surface_program(const ss_egl_api *gl, const char *rest, ss_surface_program *out,
                                             skinslide_error *error) {
    char text[MOST_TEXT];
    GLuint program;
    snprintf(text, sizeof text, "%s%s", surface_fragment, rest);
    skinslide_status status = ss_gl_program(gl, surface_vertex, text, NULL, 0, &program, error);
    if (status)
        return status;
    out->to_clip = gl->glGetUniformLocation(program, "to_clip");
    out->turn_normal = gl->glGetUniformLocation(program, "turn_normal");
    out->scale = gl->glGetUniformLocation(program, "scale");
    out->encoded = gl->glGetUniformLocation(program, "encoded");
    gl->glUseProgram(program);
    gl->glUniform3fv(gl->glGetUniformLocation(program, "colours"), COLOURS, scale_colours[0]);
    out->program = program;
    return SKINSLIDE_OK;
}

/* The fragment shader's main for a number of targets, each as its bit says. */
static void write_look_main(int32_t targets, unsigned false_colours, char text[MOST_TEXT]) {
    int length = snprintf(text, MOST_TEXT, "layout(location = 0) out vec4 colour[%d];\nvoid main() {\n", targets);
    for (int32_t k = 0; k < targets; k++)
        length += snprintf(text + length, (size_t)(MOST_TEXT - length), "    colour[%d] = lit(%s(values[%d], scale[%d]));\n", k,
                           false_colours >> k & 1 ? "false_colour" : "chequer", k, k);
    snprintf(text + length, (size_t)(MOST_TEXT - length), "}\n");
}

skinslide_status ss_look_program(skinslide_canvas *canvas, int32_t targets, unsigned false_colours,
                                 const ss_surface_program **out, skinslide_error *error) {
    ss_surface_program *own = &canvas->objects.looks[1u << targets | false_colours];
    char text[MOST_TEXT];
    *out = own;
    if (own->program)
        return SKINSLIDE_OK;
    write_look_main(targets, false_colours, text);
    return make_surface_program(&canvas->egl->api, text, own, error);
}

skinslide_status ss_figure_objects_create(const ss_egl_api *gl, ss_figure_objects *objects, skinslide_error *error) {
    skinslide_status status = make_surface_program(gl, tile_main, &objects->tile, error);
    if (!status)
        status = ss_gl_program(gl, stroke_vertex, stroke_fragment, NULL, 0, &objects->stroke_program, error);
    if (status)
        return status;
    make_arrays(gl, objects);
    objects->stroke_to_clip = gl->glGetUniformLocation(objects->stroke_program, "to_clip");
    objects->pen = gl->glGetUniformLocation(objects->stroke_program, "pen");
    return SKINSLIDE_OK;
}
