/* Draws figures: a surface under a light beside the camera, chequered or in false colours, then the outline of its patch. */
#include "canvas.h"

#include <math.h>
#include <string.h>

static const float outline_light[3] = {0.90f, 0.22f, 0.02f};

/* One call of skinslide_canvas_draw. */
typedef struct drawing {
    const skinslide_canvas *canvas;
    const skinslide_figure *figure;
    const skinslide_tessellation *mesh;
    const skinslide_outline *outline;
    ss_view view;
    ss_tessellation_work work;
    double origin[3];
    uint8_t *in_sight;        /* [mesh->grid_count] */
    uint32_t (*triangles)[3]; /* [triangle_count] of grids in sight, of room for all */
    int32_t triangle_count;
    float (*ends)[2][3]; /* [outline->segment_count] */
    float line;          /* pixels that the outline is wide */
    float line_on_screen[2];
} drawing;

/* ---- What is in sight ---- */

enum { LEEWAY = 20 }; /* percent: surfaces that OpenSubdiv fits may leave the hull of the vertices that make them */

/* A bit for each side of the view that a vertex is beyond. */
static unsigned beyond(const drawing *drawn, int32_t vertex) {
    const float *to_clip = drawn->view.to_clip, *point = drawn->figure->points + 3 * (int64_t)vertex;
    double clip[4];
    unsigned sides = 0;
    for (int i = 0; i < 4; i++) {
        clip[i] = to_clip[12 + i];
        for (int k = 0; k < 3; k++)
            clip[i] += to_clip[4 * k + i] * (point[k] - drawn->origin[k]);
    }
    double reach = clip[3] * (1 + LEEWAY / 100.0);
    for (int i = 0; i < 3; i++)
        sides |= (unsigned)(clip[i] < -reach) << (2 * i) | (unsigned)(clip[i] > reach) << (2 * i + 1);
    return sides;
}

/* False where all vertices that make it are beyond the same side of the view. What has the outline always is. */
static bool in_sight(const drawing *drawn, const ss_grid *grid) {
    const skinslide_tessellation *mesh = drawn->mesh;
    const int32_t *vertices = mesh->corner_vertex + mesh->face_start[grid->face];
    int32_t count = grid->side ? ss_limit_vertices(mesh->surfaces, grid->surface, &vertices) : ss_face_size(mesh, grid->face);
    unsigned all = ~0u;
    for (int32_t i = 0; i < count && all; i++)
        all &= beyond(drawn, vertices[i]);
    return !all || drawn->outline->inside[grid->face];
}

static int32_t piece_of(const skinslide_tessellation *mesh, int32_t vertex) {
    int32_t low = 0, high = mesh->grid_count;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        *(mesh->grids[middle].first_vertex <= vertex ? &low : &high) = middle;
    }
    return low;
}

/* Close to a patch, most of a mesh is out of sight. It is not posed, but where what is in sight has places of it. */
static void skip_out_of_sight(drawing *drawn) {
    const skinslide_tessellation *mesh = drawn->mesh;
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        drawn->in_sight[p] = in_sight(drawn, &mesh->grids[p]);
        drawn->work.skipped[p] = !drawn->in_sight[p];
    }
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        int32_t first = mesh->grids[p].first_vertex, end = first + ss_grid_size(mesh, &mesh->grids[p]);
        for (int32_t v = first; v < end && drawn->in_sight[p] && mesh->grids[p].side; v++)
            if ((int32_t)mesh->same_as[v] < first)
                drawn->work.skipped[piece_of(mesh, (int32_t)mesh->same_as[v])] = 0;
    }
}

static void list_triangles(drawing *drawn) {
    for (int32_t p = 0, first = 0; p < drawn->mesh->grid_count; p++) {
        int32_t own = ss_grid_triangles(drawn->mesh, &drawn->mesh->grids[p]);
        if (drawn->in_sight[p])
            memcpy(drawn->triangles + drawn->triangle_count, drawn->mesh->triangles + first,
                   (size_t)own * sizeof *drawn->triangles);
        drawn->triangle_count += drawn->in_sight[p] ? own : 0;
        first += own;
    }
}

static void mark_inside(drawing *drawn) {
    for (int32_t p = 0; p < drawn->mesh->grid_count; p++) {
        const ss_grid *grid = &drawn->mesh->grids[p];
        for (int32_t v = 0; v < ss_grid_size(drawn->mesh, grid) && drawn->in_sight[p]; v++)
            drawn->work.vertices[grid->first_vertex + v].inside = drawn->outline->inside[grid->face];
    }
}

static void list_ends(drawing *drawn) {
    const skinslide_outline *outline = drawn->outline;
    for (int32_t i = 0; i < outline->segment_count; i++)
        for (int end = 0; end < 2; end++)
            memcpy(drawn->ends[i][end], drawn->work.vertices[outline->segments[i][end]].place, sizeof drawn->ends[i][end]);
}

/* ---- Drawing ---- */

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
    fill(gl, GL_ARRAY_BUFFER, objects->segment_buffer, drawn->ends, drawn->outline->segment_count, sizeof *drawn->ends);
    gl->glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, drawn->outline->segment_count);
}

/* ---- What can be drawn ---- */

static skinslide_status check_paint(const skinslide_figure *figure, skinslide_error *error) {
    float range = figure->highest - figure->lowest;
    if (!figure->values && !(figure->squares > 0 && isfinite(figure->squares)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a chequer of %g squares", (double)figure->squares);
    if (figure->values && !(range > 0 && isnormal(range) && isnormal(1 / range)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a scale from %g to %g", (double)figure->lowest, (double)figure->highest);
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t v = 0; figure->values && v < figure->tessellation->mesh_vertex_count && !status; v++)
        status = ss_check_value(v, figure->values[v], error);
    return status;
}

static skinslide_status check(const skinslide_canvas *canvas, const skinslide_viewport *viewport,
                              const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    if (!canvas || !viewport || !camera || !figure->tessellation)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no canvas, viewport, camera, or figure");
    if (figure->outline && figure->outline->tessellation != figure->tessellation)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the outline is another tessellation's");
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
    ss_find_middle(mesh, figure->points, drawn->origin);
    if (!ss_view_of(camera, figure->to_world, drawn->origin, &drawn->view))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "the camera, or the mesh's way to the world, is not finite or has no inverse");
    drawn->in_sight = SS_NEW(&work->memory, uint8_t, mesh->grid_count);
    drawn->triangles = ss_new(&work->memory, mesh->triangle_count, sizeof *drawn->triangles);
    drawn->ends = ss_new(&work->memory, drawn->outline->segment_count, sizeof *drawn->ends);
    if (!ss_tessellation_work_allocate(mesh, work))
        return ss_out_of_memory(error);
    skip_out_of_sight(drawn);
    ss_tessellate(mesh, figure->points, figure->values, drawn->origin, work);
    list_triangles(drawn);
    mark_inside(drawn);
    list_ends(drawn);
    drawn->line = fmaxf(1.5f, (float)viewport->height / 450);
    drawn->line_on_screen[0] = 2 * drawn->line / (float)viewport->width;
    drawn->line_on_screen[1] = 2 * drawn->line / (float)viewport->height;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_canvas_draw(skinslide_canvas *canvas, const skinslide_viewport *viewport,
                                       const skinslide_camera *camera, const skinslide_figure *figure, skinslide_error *error) {
    ss_egl_before before;
    skinslide_figure own = SKINSLIDE_FIGURE_DEFAULT;
    skinslide_status status = ss_take(figure, "skinslide_figure", &own, sizeof own, error);
    if (!status)
        status = check(canvas, viewport, camera, &own, error);
    if (status)
        return status;
    drawing drawn = {.canvas = canvas, .figure = &own, .mesh = own.tessellation};
    drawn.outline = own.outline ? own.outline : drawn.mesh->outline;
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
