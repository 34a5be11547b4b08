/* Draws figures: a surface under a light beside the camera, chequered or in false colours, then the outline of its patch. */
#include "canvas.h"

#include <math.h>
#include <string.h>

static const float outline_light[3] = {0.90f, 0.22f, 0.02f};

/* ---- What is in sight ---- */

/* A bit for each side of the view that a place is beyond. */
static unsigned beyond(const float *to_clip, const float place[3]) {
    float clip[4];
    unsigned sides = 0;
    for (int i = 0; i < 4; i++)
        clip[i] = to_clip[i] * place[0] + to_clip[4 + i] * place[1] + to_clip[8 + i] * place[2] + to_clip[12 + i];
    for (int i = 0; i < 3; i++)
        sides |= (unsigned)(clip[i] < -clip[3]) << (2 * i) | (unsigned)(clip[i] > clip[3]) << (2 * i + 1);
    return sides;
}

static bool in_sight(const skinslide_tessellation *mesh, const ss_piece *piece, const ss_view *view,
                     const ss_posed_vertex *vertices) {
    unsigned all = ~0u;
    for (int32_t v = piece->first_vertex; v < piece->first_vertex + ss_piece_size(mesh, piece) && all; v++)
        all &= beyond(view->to_clip, vertices[v].place);
    return !all;
}

/* The triangles but those of pieces that are all beyond one side of the view: close to a patch, most of a mesh is. */
static int32_t list_in_sight(const skinslide_tessellation *mesh, const ss_view *view, const ss_posed_vertex *vertices,
                             uint32_t (*triangles)[3]) {
    int32_t count = 0;
    for (int32_t p = 0, first = 0; p < mesh->piece_count; p++) {
        int32_t own = ss_triangles_of(mesh, &mesh->pieces[p]);
        if (in_sight(mesh, &mesh->pieces[p], view, vertices)) {
            memcpy(triangles + count, mesh->triangles + first, (size_t)own * sizeof *triangles);
            count += own;
        }
        first += own;
    }
    return count;
}

/* ---- Drawing ---- */

/* One call of skinslide_canvas_draw. */
typedef struct drawing {
    const skinslide_canvas *canvas;
    const skinslide_figure *figure;
    const skinslide_tessellation *mesh;
    ss_view view;
    ss_tessellation_work work;
    uint32_t (*triangles)[3]; /* [triangle_count] in sight, of room for all */
    int32_t triangle_count;
    float (*ends)[2][3]; /* [mesh->segment_count] */
    float line;          /* pixels that the outline is wide */
    float line_on_screen[2];
} drawing;

static void fill(const ss_egl_api *gl, GLenum target, GLuint buffer, const void *data, int64_t count, size_t size) {
    gl->glBindBuffer(target, buffer);
    gl->glBufferData(target, (GLsizeiptr)count * (GLsizeiptr)size, data, GL_STREAM_DRAW);
}

static void set_surface(const drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const skinslide_figure *figure = drawn->figure;
    const ss_surface_program *own = figure->values ? &drawn->canvas->objects.false_colours : &drawn->canvas->objects.chequer;
    float turn_normal[9];
    for (int i = 0; i < 9; i++)
        turn_normal[i] = figure->left_handed ? -drawn->view.turn_normal[i] : drawn->view.turn_normal[i];
    gl->glUseProgram(own->program);
    gl->glUniformMatrix4fv(own->to_clip, 1, GL_FALSE, drawn->view.to_clip);
    gl->glUniformMatrix3fv(own->turn_normal, 1, GL_FALSE, turn_normal);
    gl->glUniform1i(own->encoded, drawn->canvas->pixels == SKINSLIDE_PIXELS_BYTES);
    if (figure->values)
        gl->glUniform2f(own->scale, figure->lowest, 1 / (figure->highest - figure->lowest));
    else
        gl->glUniform2f(own->scale, figure->squares, drawn->mesh->in_space);
}

static void draw_surface(const drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_figure_objects *objects = &drawn->canvas->objects;
    const skinslide_tessellation *mesh = drawn->mesh;
    const skinslide_figure *figure = drawn->figure;
    set_surface(drawn);
    gl->glBindVertexArray(objects->surface_array);
    fill(gl, GL_ARRAY_BUFFER, objects->fixed_buffer, mesh->fixed, mesh->vertex_count, sizeof *mesh->fixed);
    fill(gl, GL_ARRAY_BUFFER, objects->posed_buffer, drawn->work.vertices, mesh->vertex_count, sizeof *drawn->work.vertices);
    fill(gl, GL_ELEMENT_ARRAY_BUFFER, objects->triangle_buffer, drawn->triangles, drawn->triangle_count,
         sizeof *drawn->triangles);
    gl->glEnable(GL_POLYGON_OFFSET_FILL); /* behind its outline, however it slopes along the width of the line */
    gl->glPolygonOffset(drawn->line, 4);
    (figure->double_sided ? gl->glDisable : gl->glEnable)(GL_CULL_FACE);
    gl->glFrontFace(drawn->view.mirrored == (figure->left_handed != 0) ? GL_CCW : GL_CW);
    gl->glDrawElements(GL_TRIANGLES, 3 * drawn->triangle_count, GL_UNSIGNED_INT, NULL);
    gl->glDisable(GL_CULL_FACE);
    gl->glDisable(GL_POLYGON_OFFSET_FILL);
}

static void draw_outline(const drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_figure_objects *objects = &drawn->canvas->objects;
    float colour[3];
    ss_canvas_colour(drawn->canvas, outline_light, colour);
    gl->glUseProgram(objects->outline_program);
    gl->glUniformMatrix4fv(objects->outline_to_clip, 1, GL_FALSE, drawn->view.to_clip);
    gl->glUniform2f(objects->half_width, drawn->line_on_screen[0] / 2, drawn->line_on_screen[1] / 2);
    gl->glUniform3fv(objects->line_colour, 1, colour);
    gl->glBindVertexArray(objects->outline_array);
    fill(gl, GL_ARRAY_BUFFER, objects->segment_buffer, drawn->ends, drawn->mesh->segment_count, sizeof *drawn->ends);
    gl->glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, drawn->mesh->segment_count);
}

/* ---- What can be drawn ---- */

static skinslide_status check_paint(const skinslide_figure *figure, skinslide_error *error) {
    float range = figure->highest - figure->lowest;
    if (!figure->values && !(figure->squares > 0 && isfinite(figure->squares)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a chequer of %g squares", (double)figure->squares);
    if (figure->values && !(range > 0 && isnormal(range) && isnormal(1 / range)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a scale from %g to %g", (double)figure->lowest, (double)figure->highest);
    for (int32_t v = 0; figure->values && v < figure->tessellation->mesh_vertex_count; v++)
        if (!isfinite(figure->values[v]))
            return ss_fail(error, SKINSLIDE_BAD_POINTS, "vertex %d has the value %g", v, (double)figure->values[v]);
    return SKINSLIDE_OK;
}

static skinslide_status check(const skinslide_canvas *canvas, const skinslide_viewport *viewport,
                              const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    if (!canvas || !viewport || !camera || !figure || !figure->tessellation)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, viewport, camera, or figure");
    if (viewport->width < 1 || viewport->height < 1 || viewport->x < 0 || viewport->y < 0 ||
        viewport->x > canvas->width - viewport->width || viewport->y > canvas->height - viewport->height)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the viewport is not on the canvas of %d by %d pixels", canvas->width,
                       canvas->height);
    skinslide_status status = check_paint(figure, error);
    return status ? status : ss_check_points(figure->points, figure->tessellation->mesh_vertex_count, "points", error);
}

/* ---- A figure ---- */

/* All that needs no device. */
static skinslide_status prepare(drawing *drawn, const skinslide_viewport *viewport, const skinslide_camera *camera,
                                skinslide_error *error) {
    const skinslide_figure *figure = drawn->figure;
    const skinslide_tessellation *mesh = drawn->mesh;
    ss_tessellation_work *work = &drawn->work;
    double origin[3];
    ss_find_middle(mesh, figure->points, origin);
    if (!ss_view_of(camera, figure->to_world, origin, &drawn->view))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "the camera, or the mesh's way to the world, is not finite or has no inverse");
    drawn->triangles = ss_new(&work->memory, mesh->triangle_count, sizeof *drawn->triangles);
    drawn->ends = ss_new(&work->memory, mesh->segment_count, sizeof *drawn->ends);
    if (!ss_tessellation_work_allocate(mesh, work))
        return ss_out_of_memory(error);
    ss_tessellate(mesh, figure->points, figure->values, origin, work);
    drawn->triangle_count = list_in_sight(mesh, &drawn->view, work->vertices, drawn->triangles);
    for (int32_t i = 0; i < mesh->segment_count; i++)
        for (int end = 0; end < 2; end++)
            memcpy(drawn->ends[i][end], work->vertices[mesh->segments[i][end]].place, sizeof drawn->ends[i][end]);
    drawn->line = fmaxf(1.5f, (float)viewport->height / 450);
    drawn->line_on_screen[0] = 2 * drawn->line / (float)viewport->width;
    drawn->line_on_screen[1] = 2 * drawn->line / (float)viewport->height;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_canvas_draw(skinslide_canvas *canvas, const skinslide_viewport *viewport,
                                       const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    ss_egl_before before;
    skinslide_status status = check(canvas, viewport, camera, figure, error);
    if (status)
        return status;
    drawing drawn = {.canvas = canvas, .figure = figure, .mesh = figure->tessellation};
    status = prepare(&drawn, viewport, camera, error);
    if (!status)
        status = ss_gl_enter(canvas->egl, &before, error);
    if (!status) {
        canvas->egl->api.glBindFramebuffer(GL_FRAMEBUFFER, canvas->drawn);
        canvas->egl->api.glViewport(viewport->x, viewport->y, viewport->width, viewport->height);
        draw_surface(&drawn);
        draw_outline(&drawn);
        status = ss_gl_leave(canvas->egl, &before, "drawing a figure", error);
    }
    ss_free(&drawn.work.memory);
    return status;
}
