/* Draws figures: a surface under a light at the camera, chequered or in false colours, then the outline of its patch. */
#include "canvas.h"

#include <math.h>
#include <stddef.h>

enum { COLOURS = 5 };

/* From little to much, linear light; as many as the shader has. */
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

static const float outline_light[3] = {0.90f, 0.22f, 0.02f};

/* ---- Programs ---- */

static const char surface_vertex[] = "#version 300 es\n"
                                     "uniform mat4 to_camera, to_clip;\n"
                                     "uniform mat3 turn_normal;\n"
                                     "layout(location = 0) in vec3 fixed_coordinates;\n"
                                     "layout(location = 1) in float fixed_inside;\n"
                                     "layout(location = 2) in vec3 place;\n"
                                     "layout(location = 3) in vec3 surface_normal;\n"
                                     "layout(location = 4) in float posed_value;\n"
                                     "out highp vec3 coordinates, seen, normal;\n"
                                     "out highp float inside, value;\n"
                                     "void main() {\n"
                                     "    coordinates = fixed_coordinates;\n"
                                     "    inside = fixed_inside;\n"
                                     "    seen = (to_camera * vec4(place, 1.0)).xyz;\n"
                                     "    normal = turn_normal * surface_normal;\n"
                                     "    value = posed_value;\n"
                                     "    gl_Position = to_clip * vec4(place, 1.0);\n"
                                     "}\n";

/* A chequer's mean over the pixel, so that squares too small to be seen are grey; two-sided light. coordinate_scale is squares,
 * and whether they are in space; scale is lowest and the inverse of the range, 0 for a chequer. */
static const char surface_fragment[] =
    "#version 300 es\n"
    "precision highp float;\n"
    "uniform vec2 coordinate_scale, scale;\n"
    "uniform int encoded;\n"
    "uniform vec3 colours[5];\n"
    "in vec3 coordinates, seen, normal;\n"
    "in float inside, value;\n"
    "layout(location = 0) out vec4 colour;\n"
    "float chequer() {\n"
    "    vec3 p = coordinates * coordinate_scale.x + 0.317 * coordinate_scale.y;\n"
    "    vec3 w = max(fwidth(p), 1e-4);\n"
    "    vec3 mean = 2.0 * (abs(fract(0.5 * (p - 0.5 * w)) - 0.5) - abs(fract(0.5 * (p + 0.5 * w)) - 0.5)) / w;\n"
    "    return 0.5 - 0.5 * mean.x * mean.y * mix(1.0, mean.z, coordinate_scale.y);\n"
    "}\n"
    "vec3 false_colour() {\n"
    "    float place = clamp((value - scale.x) * scale.y, 0.0, 1.0) * 4.0;\n"
    "    int below = min(int(place), 3);\n"
    "    return mix(colours[below], colours[below + 1], place - float(below));\n"
    "}\n"
    "vec3 encode(vec3 light) {\n"
    "    return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));\n"
    "}\n"
    "void main() {\n"
    "    vec3 plain = vec3(0.33, 0.31, 0.30);\n"
    "    vec3 base = plain;\n"
    "    if (scale.y == 0.0)\n"
    "        base = mix(mix(vec3(0.045, 0.055, 0.09), vec3(0.78, 0.74, 0.68), chequer()), plain, 0.7 * (1.0 - inside));\n"
    "    else if (inside > 0.5)\n"
    "        base = false_colour();\n"
    "    vec3 flat_normal = cross(dFdx(seen), dFdy(seen));\n"
    "    vec3 n = dot(normal, normal) > 0.0 ? normal : flat_normal;\n"
    "    n = normalize(dot(n, seen) > 0.0 ? -n : n);\n"
    "    float light = max(dot(n, normalize(vec3(-0.35, 0.55, 0.8))), 0.0);\n"
    "    float fill = 0.5 + 0.5 * n.y;\n"
    "    vec3 seen_light = base * (0.16 + 0.14 * fill + 0.78 * light);\n"
    "    colour = vec4(encoded == 1 ? encode(seen_light) : seen_light, 1.0);\n"
    "}\n";

/* Each segment is a strip as wide as the line, square at its ends. One that reaches behind the camera is cut there. */
static const char outline_vertex[] = "#version 300 es\n"
                                     "uniform mat4 to_clip;\n"
                                     "uniform vec2 half_width;\n"
                                     "layout(location = 0) in vec3 begin;\n"
                                     "layout(location = 1) in vec3 end;\n"
                                     "void main() {\n"
                                     "    vec4 a = to_clip * vec4(begin, 1.0), b = to_clip * vec4(end, 1.0);\n"
                                     "    if (min(a.w, b.w) < 1e-4 * max(a.w, b.w)) {\n"
                                     "        float cut = (1e-4 * max(a.w, b.w) - a.w) / (b.w - a.w);\n"
                                     "        vec4 middle = mix(a, b, cut);\n"
                                     "        if (a.w < b.w)\n"
                                     "            a = middle;\n"
                                     "        else\n"
                                     "            b = middle;\n"
                                     "    }\n"
                                     "    vec2 along = (b.xy / b.w - a.xy / a.w) / half_width;\n"
                                     "    along = dot(along, along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);\n"
                                     "    bool at_end = gl_VertexID > 1;\n"
                                     "    vec2 aside = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? 1.0 : -1.0);\n"
                                     "    gl_Position = at_end ? b : a;\n"
                                     "    gl_Position.xy += (aside + (at_end ? along : -along)) * half_width * gl_Position.w;\n"
                                     "}\n";

static const char outline_fragment[] = "#version 300 es\n"
                                       "precision highp float;\n"
                                       "uniform vec3 line_colour;\n"
                                       "layout(location = 0) out vec4 colour;\n"
                                       "void main() {\n"
                                       "    colour = vec4(line_colour, 1.0);\n"
                                       "}\n";

/* ---- Objects ---- */

static void point_to(const ss_egl_api *gl, GLuint place, int32_t width, size_t stride, size_t offset) {
    gl->glEnableVertexAttribArray(place);
    gl->glVertexAttribPointer(place, width, GL_FLOAT, GL_FALSE, (GLsizei)stride, (const void *)(uintptr_t)offset);
}

static void make_arrays(const ss_egl_api *gl, ss_figure_objects *objects) {
    gl->glGenBuffers(1, &objects->fixed_buffer);
    gl->glGenBuffers(1, &objects->posed_buffer);
    gl->glGenBuffers(1, &objects->triangle_buffer);
    gl->glGenBuffers(1, &objects->segment_buffer);
    gl->glGenVertexArrays(1, &objects->surface_array);
    gl->glBindVertexArray(objects->surface_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->fixed_buffer);
    point_to(gl, 0, 3, sizeof(ss_fixed_vertex), offsetof(ss_fixed_vertex, coordinates));
    point_to(gl, 1, 1, sizeof(ss_fixed_vertex), offsetof(ss_fixed_vertex, inside));
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->posed_buffer);
    point_to(gl, 2, 3, sizeof(ss_posed_vertex), offsetof(ss_posed_vertex, place));
    point_to(gl, 3, 3, sizeof(ss_posed_vertex), offsetof(ss_posed_vertex, normal));
    point_to(gl, 4, 1, sizeof(ss_posed_vertex), offsetof(ss_posed_vertex, value));
    gl->glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, objects->triangle_buffer);
    gl->glGenVertexArrays(1, &objects->outline_array);
    gl->glBindVertexArray(objects->outline_array);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->segment_buffer);
    for (GLuint end = 0; end < 2; end++) {
        point_to(gl, end, 3, sizeof(float[2][3]), end * sizeof(float[3]));
        gl->glVertexAttribDivisor(end, 1);
    }
}

static void find_uniforms(const ss_egl_api *gl, ss_figure_objects *objects) {
    GLuint surface = objects->surface_program, outline = objects->outline_program;
    objects->surface_to_camera = gl->glGetUniformLocation(surface, "to_camera");
    objects->surface_to_clip = gl->glGetUniformLocation(surface, "to_clip");
    objects->turn_normal = gl->glGetUniformLocation(surface, "turn_normal");
    objects->coordinates = gl->glGetUniformLocation(surface, "coordinate_scale");
    objects->scale = gl->glGetUniformLocation(surface, "scale");
    objects->colours = gl->glGetUniformLocation(surface, "colours");
    objects->encoded = gl->glGetUniformLocation(surface, "encoded");
    objects->outline_to_clip = gl->glGetUniformLocation(outline, "to_clip");
    objects->half_width = gl->glGetUniformLocation(outline, "half_width");
    objects->line_colour = gl->glGetUniformLocation(outline, "line_colour");
}

skinslide_status ss_figure_objects_create(const ss_egl_api *gl, ss_figure_objects *objects, skinslide_error *error) {
    skinslide_status status = ss_gl_program(gl, surface_vertex, surface_fragment, NULL, 0, &objects->surface_program, error);
    if (!status)
        status = ss_gl_program(gl, outline_vertex, outline_fragment, NULL, 0, &objects->outline_program, error);
    if (status)
        return status;
    make_arrays(gl, objects);
    find_uniforms(gl, objects);
    return SKINSLIDE_OK;
}

/* ---- Drawing ---- */

static void fill(const ss_egl_api *gl, GLenum target, GLuint buffer, const void *data, int64_t count, size_t size) {
    gl->glBindBuffer(target, buffer);
    gl->glBufferData(target, (GLsizeiptr)count * (GLsizeiptr)size, data, GL_STREAM_DRAW);
}

static void draw_surface(const skinslide_canvas *canvas, const skinslide_figure *figure, const ss_view *view,
                         const ss_tessellation_work *work) {
    const ss_egl_api *gl = &canvas->egl->api;
    const ss_figure_objects *objects = &canvas->objects;
    const skinslide_tessellation *mesh = figure->tessellation;
    gl->glUseProgram(objects->surface_program);
    gl->glUniformMatrix4fv(objects->surface_to_camera, 1, GL_FALSE, view->to_camera);
    gl->glUniformMatrix4fv(objects->surface_to_clip, 1, GL_FALSE, view->to_clip);
    gl->glUniformMatrix3fv(objects->turn_normal, 1, GL_FALSE, view->turn_normal);
    gl->glUniform2f(objects->coordinates, figure->squares, mesh->in_space);
    gl->glUniform2f(objects->scale, figure->lowest, figure->values ? 1 / (figure->highest - figure->lowest) : 0);
    gl->glUniform1i(objects->encoded, canvas->pixels == SKINSLIDE_PIXELS_BYTES);
    gl->glUniform3fv(objects->colours, COLOURS, scale_colours[0]);
    gl->glBindVertexArray(objects->surface_array);
    fill(gl, GL_ARRAY_BUFFER, objects->fixed_buffer, mesh->fixed, mesh->vertex_count, sizeof *mesh->fixed);
    fill(gl, GL_ARRAY_BUFFER, objects->posed_buffer, work->vertices, mesh->vertex_count, sizeof *work->vertices);
    fill(gl, GL_ELEMENT_ARRAY_BUFFER, objects->triangle_buffer, mesh->triangles, mesh->triangle_count, sizeof *mesh->triangles);
    gl->glEnable(GL_POLYGON_OFFSET_FILL); /* behind its outline, however it slopes along the width of the line */
    gl->glPolygonOffset(4, 4);
    (figure->double_sided ? gl->glDisable : gl->glEnable)(GL_CULL_FACE);
    gl->glFrontFace(view->mirrored == (figure->left_handed != 0) ? GL_CCW : GL_CW);
    gl->glDrawElements(GL_TRIANGLES, 3 * mesh->triangle_count, GL_UNSIGNED_INT, NULL);
    gl->glDisable(GL_CULL_FACE);
    gl->glDisable(GL_POLYGON_OFFSET_FILL);
}

static void draw_outline(const skinslide_canvas *canvas, const skinslide_viewport *viewport, const skinslide_tessellation *mesh,
                         const ss_view *view, const ss_tessellation_work *work, float (*ends)[2][3]) {
    const ss_egl_api *gl = &canvas->egl->api;
    float width = fmaxf(1, (float)viewport->height / 700), colour[3];
    ss_canvas_colour(canvas, outline_light, colour);
    for (int32_t i = 0; i < mesh->segment_count; i++)
        for (int end = 0; end < 2; end++)
            for (int k = 0; k < 3; k++)
                ends[i][end][k] = work->vertices[mesh->segments[i][end]].place[k];
    gl->glUseProgram(canvas->objects.outline_program);
    gl->glUniformMatrix4fv(canvas->objects.outline_to_clip, 1, GL_FALSE, view->to_clip);
    gl->glUniform2f(canvas->objects.half_width, width / (float)viewport->width, width / (float)viewport->height);
    gl->glUniform3fv(canvas->objects.line_colour, 1, colour);
    gl->glBindVertexArray(canvas->objects.outline_array);
    fill(gl, GL_ARRAY_BUFFER, canvas->objects.segment_buffer, ends, mesh->segment_count, sizeof *ends);
    gl->glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, mesh->segment_count);
}

static skinslide_status check(const skinslide_canvas *canvas, const skinslide_viewport *viewport,
                              const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    if (!canvas || !viewport || !camera || !figure || !figure->tessellation)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, viewport, camera, or figure");
    if (viewport->width < 1 || viewport->height < 1 || viewport->x < 0 || viewport->y < 0 ||
        viewport->x > canvas->width - viewport->width || viewport->y > canvas->height - viewport->height)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the viewport is not on the canvas of %d by %d pixels", canvas->width,
                       canvas->height);
    if (figure->values ? !(figure->lowest < figure->highest && isfinite(1 / (figure->highest - figure->lowest)))
                       : !(figure->squares > 0 && isfinite(figure->squares)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT,
                       figure->values ? "the scale goes from %g to %g" : "the chequer has %g squares",
                       figure->values ? (double)figure->lowest : (double)figure->squares, (double)figure->highest);
    int32_t count = figure->tessellation->mesh_vertex_count;
    skinslide_status status = ss_check_points(figure->points, count, "points", error);
    for (int32_t v = 0; !status && figure->values && v < count; v++)
        if (!isfinite(figure->values[v]))
            status = ss_fail(error, SKINSLIDE_BAD_POINTS, "vertex %d has the value %g", v, (double)figure->values[v]);
    return status;
}

skinslide_status skinslide_canvas_draw(skinslide_canvas *canvas, const skinslide_viewport *viewport,
                                       const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    skinslide_status status = check(canvas, viewport, camera, figure, error);
    if (status)
        return status;
    ss_view view;
    ss_egl_before before;
    double origin[3];
    ss_find_middle(figure->tessellation, figure->points, origin);
    if (!ss_view_of(camera, figure->to_world, origin, &view))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "the camera, or the mesh's way to the world, is not finite or has no inverse");
    ss_tessellation_work work = {0};
    float(*ends)[2][3] = ss_new(&work.memory, figure->tessellation->segment_count, sizeof *ends);
    status = ss_tessellation_work_allocate(figure->tessellation, &work) ? SKINSLIDE_OK : ss_out_of_memory(error);
    if (!status) {
        ss_tessellate(figure->tessellation, figure->points, figure->values, origin, &work);
        status = ss_gl_enter(canvas->egl, &before, error);
    }
    if (!status) {
        const ss_egl_api *gl = &canvas->egl->api;
        gl->glBindFramebuffer(GL_FRAMEBUFFER, canvas->drawn);
        gl->glViewport(viewport->x, viewport->y, viewport->width, viewport->height);
        draw_surface(canvas, figure, &view, &work);
        draw_outline(canvas, viewport, figure->tessellation, &view, &work, ends);
        status = ss_gl_leave(canvas->egl, &before, "drawing a figure", error);
    }
    ss_free(&work.memory);
    return status;
}
