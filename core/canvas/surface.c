/* Draws a figure's surface: chequered, in false colours, or with the tiles of its texture over the chequer. With ghosts, what
 * hides the patch is drawn as a mere shadow. In order, with a mark in the stencil where the patch is:
 *
 *     the patch          leaves its mark
 *     all else           where there is no mark
 *     strokes
 *     what may hide it   where there is a mark: first its depth, then the colour of the nearest alone, thinly */
#include "canvas.h"

#include "paint.h"

static const float shadow = 0.16f; /* how much of the colour of what hides shows */

static void fill(const ss_egl_api *gl, GLenum target, GLuint buffer, const void *data, int64_t count, size_t size) {
    gl->glBindBuffer(target, buffer);
    gl->glBufferData(target, (GLsizeiptr)count * (GLsizeiptr)size, data, GL_STREAM_DRAW);
}

/* ---- Programs ---- */

static void use(const ss_drawing *drawn, const ss_surface_program *own) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    float turn_normal[9];
    for (int i = 0; i < 9; i++)
        turn_normal[i] = drawn->figure->left_handed ? -drawn->view.turn_normal[i] : drawn->view.turn_normal[i];
    gl->glUseProgram(own->program);
    gl->glUniformMatrix4fv(own->to_clip, 1, GL_FALSE, drawn->view.to_clip);
    gl->glUniformMatrix3fv(own->turn_normal, 1, GL_FALSE, turn_normal);
    gl->glUniform1i(own->encoded, drawn->canvas->pixels == SKINSLIDE_PIXELS_BYTES);
}

static void draw_range(const ss_drawing *drawn, int32_t first, int32_t count) {
    const void *offset = (const void *)(uintptr_t)((size_t)first * sizeof *drawn->triangles);
    drawn->canvas->egl->api.glDrawElements(GL_TRIANGLES, 3 * count, GL_UNSIGNED_INT, offset);
}

static void draw_tiles(const ss_drawing *drawn, const ss_target_look *look, int32_t first, int32_t count) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_surface_program *own = &drawn->canvas->objects.tile;
    for (int32_t i = 0; i < look->own.tile_count; i++) {
        int32_t tile = look->tiles[i].number - SS_FIRST_TILE;
        const float corner[3] = {(float)(tile % SS_TILE_COLUMNS), (float)(tile / SS_TILE_COLUMNS), 0};
        use(drawn, own);
        gl->glUniform3fv(own->scale, 1, corner);
        gl->glBindTexture(GL_TEXTURE_2D, look->textures[i]);
        draw_range(drawn, first, count);
    }
}

/* Triangles [first, first + count), in the figure's looks. */
static void draw_looks(const ss_drawing *drawn, int32_t first, int32_t count) {
    float scales[SKINSLIDE_MOST_TARGETS][3] = {{0}};
    for (int32_t i = 0; i < drawn->look_count; i++) {
        const skinslide_look *look = &drawn->looks[i].own;
        scales[i][0] = look->values ? look->lowest : drawn->figure->squares;
        scales[i][1] = look->values ? 1 / (look->highest - look->lowest) : drawn->mesh->in_space;
    }
    use(drawn, drawn->look);
    drawn->canvas->egl->api.glUniform3fv(drawn->look->scale, drawn->look_count, scales[0]);
    draw_range(drawn, first, count);
    for (int32_t i = 0; i < drawn->look_count; i++) {
        const ss_target_look *look = &drawn->looks[i];
        if (look->own.values || look->own.tile_count == 0)
            continue;
        ss_draw_on_targets(drawn->canvas, i, i + 1);
        draw_tiles(drawn, look, first, count);
        ss_draw_on_targets(drawn->canvas, 0, drawn->look_count);
    }
}

/* ---- Textures ---- */

static GLsizei levels_of(const skinslide_colour_tile *tile) {
    GLsizei levels = 1;
    for (int32_t side = tile->width > tile->height ? tile->width : tile->height; side > 1; side /= 2)
        levels++;
    return levels;
}

static void load_textures(const ss_drawing *drawn, const ss_target_look *look) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    gl->glGenTextures(look->own.tile_count, look->textures);
    for (int32_t i = 0; i < look->own.tile_count; i++) {
        const skinslide_colour_tile *tile = &look->tiles[i];
        gl->glBindTexture(GL_TEXTURE_2D, look->textures[i]);
        gl->glTexStorage2D(GL_TEXTURE_2D, levels_of(tile), GL_SRGB8_ALPHA8, tile->width, tile->height);
        gl->glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, tile->width, tile->height, GL_RGBA, GL_UNSIGNED_BYTE, tile->pixels);
        gl->glGenerateMipmap(GL_TEXTURE_2D);
        gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        gl->glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
}

/* ---- Ghosts ---- */

static void draw_shadows(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    int32_t first = drawn->hiding_first, count = drawn->triangle_count - drawn->hiding_first;
    gl->glStencilFunc(GL_EQUAL, drawn->mark, ~0u);
    gl->glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    use(drawn, drawn->plain);
    draw_range(drawn, first, count);
    gl->glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    gl->glEnable(GL_BLEND);
    gl->glBlendColor(0, 0, 0, shadow);
    gl->glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
    gl->glDepthFunc(GL_EQUAL);
    draw_range(drawn, first, count);
    gl->glDepthFunc(GL_LEQUAL);
    gl->glDisable(GL_BLEND);
    gl->glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

/* State for drawing the surface itself; `end` undoes it. */
static void begin(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    gl->glBindVertexArray(drawn->canvas->objects.surface_array);
    gl->glEnable(GL_POLYGON_OFFSET_FILL); /* pushed behind the lines on it, however the surface slopes across their width */
    gl->glPolygonOffset(drawn->line, 4);
    (drawn->figure->double_sided ? gl->glDisable : gl->glEnable)(GL_CULL_FACE);
    gl->glFrontFace(drawn->view.mirrored == (drawn->figure->left_handed != 0) ? GL_CCW : GL_CW);
}

static void end(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    gl->glDisable(GL_CULL_FACE);
    gl->glDisable(GL_POLYGON_OFFSET_FILL);
}

static void draw_with_ghosts(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    gl->glEnable(GL_STENCIL_TEST);
    gl->glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    gl->glStencilFunc(GL_ALWAYS, drawn->mark, ~0u);
    draw_looks(drawn, 0, drawn->inside_count);
    gl->glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl->glStencilFunc(GL_NOTEQUAL, drawn->mark, ~0u);
    draw_looks(drawn, drawn->inside_count, drawn->triangle_count - drawn->inside_count);
    end(drawn);
    gl->glDisable(GL_STENCIL_TEST);
    ss_draw_strokes(drawn);
    gl->glEnable(GL_STENCIL_TEST);
    begin(drawn);
    draw_shadows(drawn);
    gl->glDisable(GL_STENCIL_TEST);
}

/* ---- All ---- */

void ss_draw_surface(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_figure_objects *objects = &drawn->canvas->objects;
    for (int32_t i = 0; i < drawn->look_count; i++)
        load_textures(drawn, &drawn->looks[i]);
    begin(drawn);
    fill(gl, GL_ARRAY_BUFFER, objects->vertex_buffer, drawn->vertices, drawn->vertex_count, sizeof *drawn->vertices);
    fill(gl, GL_ELEMENT_ARRAY_BUFFER, objects->triangle_buffer, drawn->triangles, drawn->triangle_count,
         sizeof *drawn->triangles);
    if (drawn->figure->ghosts)
        draw_with_ghosts(drawn);
    else
        draw_looks(drawn, 0, drawn->triangle_count);
    end(drawn);
    if (!drawn->figure->ghosts)
        ss_draw_strokes(drawn);
    for (int32_t i = 0; i < drawn->look_count; i++)
        gl->glDeleteTextures(drawn->looks[i].own.tile_count, drawn->looks[i].textures);
}
