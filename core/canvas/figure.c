/* Draws a figure: poses and lists what of it is in sight, then draws that. */
#include "canvas.h"

#include <math.h>

/* ---- What is in sight ---- */

enum { LEEWAY = 20 }; /* percent: OpenSubdiv's surfaces may leave the hull of their control points */

/* A bit for each side of the view that a vertex is beyond. */
static uint8_t beyond(const ss_drawing *drawn, int32_t vertex) {
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
    return (uint8_t)sides;
}

/* False where all vertices that its surface depends on are beyond the same side of the view. Faces of the patch, which have the
 * outline, always count as in sight. */
static bool in_sight(const ss_drawing *drawn, const ss_grid *grid, const uint8_t *sides) {
    const skinslide_tessellation *mesh = drawn->mesh;
    const int32_t *vertices = mesh->corner_vertex + mesh->face_start[grid->face];
    int32_t count = grid->side ? ss_limit_vertices(mesh->surfaces, grid->surface, &vertices) : ss_face_size(mesh, grid->face);
    unsigned all = ~0u;
    for (int32_t i = 0; i < count && all; i++)
        all &= sides[vertices[i]];
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

/* Close to a patch, most of a mesh is out of sight and need not be posed, except grids from which those in sight take places of
 * vertices. sides is scratch [mesh_vertex_count]. */
static void skip_out_of_sight(ss_drawing *drawn, uint8_t *sides) {
    const skinslide_tessellation *mesh = drawn->mesh;
    for (int32_t v = 0; v < mesh->mesh_vertex_count; v++)
        sides[v] = beyond(drawn, v);
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        drawn->in_sight[p] = in_sight(drawn, &mesh->grids[p], sides);
        drawn->work.skipped[p] = !drawn->in_sight[p];
    }
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        int32_t first = mesh->grids[p].first_vertex, end = first + ss_grid_size(mesh, &mesh->grids[p]);
        for (int32_t v = first; v < end && drawn->in_sight[p] && mesh->grids[p].side; v++)
            if ((int32_t)mesh->same_as[v] < first)
                drawn->work.skipped[piece_of(mesh, (int32_t)mesh->same_as[v])] = 0;
    }
}

/* ---- What can be drawn ---- */

enum { WIDEST = 1000 };

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
    if (!(figure->line >= 0 && figure->line <= WIDEST))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "lines %g times as wide as usual; they may be 0 to %d",
                       (double)figure->line, WIDEST);
    skinslide_status status = SKINSLIDE_OK;
    if (figure->ways)
        status = ss_check_points(figure->ways, figure->tessellation->mesh_vertex_count, "ways", error);
    return status ? status : ss_check_points(figure->points, figure->tessellation->mesh_vertex_count, "points", error);
}

/* ---- A figure ---- */

#define THINNEST 1.5f   /* pixels of a line of usual width, at least */
#define LINES_UP 450.0f /* such lines, side by side, are as high as the picture */

/* All that needs no device. */
static skinslide_status prepare(ss_drawing *drawn, const skinslide_camera *camera, skinslide_error *error) {
    const skinslide_figure *figure = drawn->figure;
    const skinslide_tessellation *mesh = drawn->mesh;
    ss_tessellation_work *work = &drawn->work;
    ss_find_middle(mesh, figure->points, drawn->origin);
    if (!ss_view_of(camera, figure->to_world, drawn->origin, &drawn->view))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "the camera, or the mesh's way to the world, is not finite or has no inverse");
    drawn->in_sight = SS_NEW(&work->memory, uint8_t, mesh->grid_count);
    uint8_t *sides = SS_NEW(&work->memory, uint8_t, mesh->mesh_vertex_count);
    if (!ss_tessellation_work_allocate(mesh, work))
        return ss_out_of_memory(error);
    skip_out_of_sight(drawn, sides);
    ss_tessellate(mesh, figure->points, drawn->origin, work);
    for (int32_t i = 0; i < drawn->look_count; i++)
        if (drawn->looks[i].own.values)
            ss_tessellate_values(mesh, drawn->looks[i].own.values, i, work);
    drawn->line = fmaxf(THINNEST, (float)drawn->viewport->height / LINES_UP) * (figure->line > 0 ? figure->line : 1);
    return ss_list_seen(drawn) && ss_list_strokes(drawn) ? SKINSLIDE_OK : ss_out_of_memory(error);
}

/* A value that no figure has left in the stencil. */
static GLint new_mark(skinslide_canvas *canvas) {
    const GLint none = 0;
    if (canvas->marks == UINT8_MAX) {
        canvas->egl->api.glClearBufferiv(GL_STENCIL, 0, &none);
        canvas->marks = 0;
    }
    return ++canvas->marks;
}

/* The context is current. */
static skinslide_status draw(skinslide_canvas *canvas, ss_drawing *drawn, skinslide_error *error) {
    const skinslide_viewport *place = drawn->viewport;
    unsigned all = (1u << drawn->look_count) - 1, with_values = 0;
    for (int32_t i = 0; i < drawn->look_count; i++)
        with_values |= (unsigned)(drawn->looks[i].own.values != NULL) << i;
    skinslide_status status = ss_look_program(canvas, drawn->look_count, with_values, &drawn->look, error);
    if (!status)
        status = ss_look_program(canvas, drawn->look_count, all, &drawn->plain, error);
    if (status)
        return status;
    canvas->egl->api.glBindFramebuffer(GL_FRAMEBUFFER, canvas->drawn);
    canvas->egl->api.glViewport(place->x, place->y, place->width, place->height);
    drawn->mark = new_mark(canvas);
    ss_draw_on_targets(canvas, 0, drawn->look_count);
    ss_draw_surface(drawn);
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
    ss_drawing drawn = {.canvas = canvas, .figure = &own, .mesh = own.tessellation, .viewport = viewport};
    drawn.outline = own.outline ? own.outline : drawn.mesh->outline;
    status = ss_take_looks(&drawn, error);
    if (!status)
        status = ss_take_edges(&drawn, error);
    if (!status)
        status = prepare(&drawn, camera, error);
    if (!status)
        status = ss_gl_enter(canvas->egl, &before, error);
    if (!status) {
        status = draw(canvas, &drawn, error);
        skinslide_status left = ss_gl_leave(canvas->egl, &before, "drawing a figure", status ? NULL : error);
        status = status ? status : left;
    }
    ss_free(&drawn.work.memory);
    return status;
}
