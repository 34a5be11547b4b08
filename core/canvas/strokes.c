/* What is drawn on a surface with a pen: the sides of a patch's faces, its outline, the ways by which its vertices came, and dots
 * at pins. All are hidden by what is nearer. */
#include "canvas.h"

#include <string.h>

/* How each kind looks, but for its lines. */
static const ss_stroke kinds[SS_STROKES] = {
    [SS_WIRE] = {.width = 0.4f, .light = {0.02f, 0.02f, 0.025f}},
    [SS_OUTLINE] = {.width = 1, .light = {0.90f, 0.22f, 0.02f}},
    [SS_WAYS] = {.width = 0.6f, .nearer = 1e-3f, .light = {0.95f, 0.93f, 0.88f}},
    [SS_ENDS_OF_WAYS] = {.width = 1.6f, .nearer = 1e-3f, .light = {0.95f, 0.93f, 0.88f}},
    [SS_PINS] = {.width = 3, .nearer = 1e-3f, .light = {0.80f, 0.02f, 0.30f}},
};

static void list_segments(const ss_drawing *drawn, uint32_t (*const segments)[2], ss_stroke *stroke) {
    for (int32_t i = 0; i < stroke->count; i++)
        for (int end = 0; end < 2; end++)
            memcpy(stroke->ends[i][end], drawn->work.vertices[segments[i][end]].place, sizeof stroke->ends[i][end]);
}

/* The ends of a way are where its vertex is on the surface, and as far from there as it came. */
static void list_ways(ss_drawing *drawn) {
    ss_stroke *ways = &drawn->strokes[SS_WAYS], *ends = &drawn->strokes[SS_ENDS_OF_WAYS];
    for (int32_t i = 0; drawn->figure->ways && i < drawn->outline->corner_count; i++) {
        const float *way = drawn->figure->ways + 3 * (int64_t)drawn->outline->corners[i][0];
        const float *place = drawn->work.vertices[drawn->outline->corners[i][1]].place;
        if (way[0] == 0 && way[1] == 0 && way[2] == 0)
            continue;
        for (int k = 0; k < 3; k++) {
            ways->ends[ways->count][0][k] = place[k] - way[k];
            ways->ends[ways->count][1][k] = ends->ends[ends->count][0][k] = ends->ends[ends->count][1][k] = place[k];
        }
        ways->count++, ends->count++;
    }
}

static void list_pins(ss_drawing *drawn) {
    ss_stroke *pins = &drawn->strokes[SS_PINS];
    for (int32_t i = 0; drawn->figure->pins && i < drawn->outline->corner_count; i++)
        if (drawn->figure->pins[drawn->outline->corners[i][0]]) {
            const float *place = drawn->work.vertices[drawn->outline->corners[i][1]].place;
            memcpy(pins->ends[pins->count][0], place, 3 * sizeof *place);
            memcpy(pins->ends[pins->count++][1], place, 3 * sizeof *place);
        }
}

bool ss_list_strokes(ss_drawing *drawn) {
    const skinslide_outline *outline = drawn->outline;
    int32_t sides = drawn->figure->wire ? outline->side_count : 0, ways = drawn->figure->ways ? outline->corner_count : 0;
    const int32_t room[SS_STROKES] = {
        [SS_WIRE] = sides,
        [SS_OUTLINE] = outline->segment_count,
        [SS_WAYS] = ways,
        [SS_ENDS_OF_WAYS] = ways,
        [SS_PINS] = drawn->figure->pins ? outline->corner_count : 0,
    };
    for (int i = 0; i < SS_STROKES; i++) {
        drawn->strokes[i] = kinds[i];
        drawn->strokes[i].ends = ss_new(&drawn->work.memory, room[i], sizeof *drawn->strokes[i].ends);
    }
    if (drawn->work.memory.failed)
        return false;
    drawn->strokes[SS_WIRE].count = sides, drawn->strokes[SS_OUTLINE].count = outline->segment_count;
    list_segments(drawn, outline->sides, &drawn->strokes[SS_WIRE]);
    list_segments(drawn, outline->segments, &drawn->strokes[SS_OUTLINE]);
    list_ways(drawn);
    list_pins(drawn);
    return true;
}

static void draw_stroke(const ss_drawing *drawn, const ss_stroke *stroke) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_figure_objects *objects = &drawn->canvas->objects;
    float wide = drawn->line * stroke->width, colour[3];
    const float pen[3] = {wide / (float)drawn->viewport->width, wide / (float)drawn->viewport->height, stroke->nearer};
    ss_canvas_colour(drawn->canvas, stroke->light, colour);
    gl->glUniform3fv(objects->pen, 1, pen);
    gl->glUniform3fv(objects->line_colour, 1, colour);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->segment_buffer);
    gl->glBufferData(GL_ARRAY_BUFFER, stroke->count * (GLsizeiptr)sizeof *stroke->ends, stroke->ends, GL_STREAM_DRAW);
    gl->glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, stroke->count);
}

void ss_draw_strokes(const ss_drawing *drawn) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    gl->glUseProgram(drawn->canvas->objects.stroke_program);
    gl->glUniformMatrix4fv(drawn->canvas->objects.stroke_to_clip, 1, GL_FALSE, drawn->view.to_clip);
    gl->glBindVertexArray(drawn->canvas->objects.stroke_array);
    for (int i = 0; i < SS_STROKES; i++)
        if (drawn->strokes[i].count > 0)
            draw_stroke(drawn, &drawn->strokes[i]);
}
