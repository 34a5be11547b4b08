/* Lines and dots on a surface: the sides of a patch's faces, its outline, edges in colours, the ways that its vertices slid,
 * and pins. What is nearer hides them. */
#include "canvas.h"

#include <math.h>
#include <string.h>

/* How each kind looks; segments are added to a copy. */
static const ss_stroke kinds[SS_STROKES] = {
    [SS_WIRE] = {.width = 0.4f, .light = {0.02f, 0.02f, 0.025f}},
    [SS_OUTLINE] = {.width = 1, .light = {0.90f, 0.22f, 0.02f}},
    [SS_EDGE_BORDERS] = {.width = 2.6f, .nearer = 3e-4f, .light = {0.02f, 0.02f, 0.025f}},
    [SS_EDGES] = {.width = 1.6f, .nearer = 6e-4f},
    [SS_WAYS] = {.width = 0.6f, .nearer = 1e-3f, .light = {0.95f, 0.93f, 0.88f}},
    [SS_ENDS_OF_WAYS] = {.width = 1.6f, .nearer = 1e-3f, .light = {0.95f, 0.93f, 0.88f}},
    [SS_PINS] = {.width = 3, .nearer = 1e-3f, .light = {0.80f, 0.02f, 0.30f}},
};

static void add_segment(ss_stroke *to, const float begin[3], const float end[3]) {
    ss_segment *segment = &to->segments[to->count++];
    memcpy(segment->ends[0], begin, sizeof segment->ends[0]);
    memcpy(segment->ends[1], end, sizeof segment->ends[1]);
    memcpy(segment->colour, to->colour, sizeof segment->colour);
}

static void add_side(const ss_drawing *drawn, ss_stroke *to, const uint32_t vertices[2]) {
    add_segment(to, drawn->work.vertices[vertices[0]].place, drawn->work.vertices[vertices[1]].place);
}

static void list_segments(const ss_drawing *drawn, uint32_t (*const segments)[2], int32_t count, ss_stroke *stroke) {
    for (int32_t i = 0; i < count; i++)
        add_side(drawn, stroke, segments[i]);
}

/* Each in its own colour, with a dark border that sets it off from the surface. */
static void list_edges(ss_drawing *drawn) {
    const skinslide_figure *figure = drawn->figure;
    ss_stroke *edges = &drawn->strokes[SS_EDGES];
    for (int32_t i = 0; drawn->edge_value && i < drawn->outline->side_count; i++) {
        float value = drawn->edge_value[drawn->outline->side_edge[i]];
        if (isnan(value))
            continue;
        skinslide_false_colour((value - figure->lowest) / (figure->highest - figure->lowest), edges->light);
        ss_canvas_colour(drawn->canvas, edges->light, edges->colour);
        add_side(drawn, &drawn->strokes[SS_EDGE_BORDERS], drawn->outline->sides[i]);
        add_side(drawn, edges, drawn->outline->sides[i]);
    }
}

/* A way begins where its vertex came from, and ends where it is on the surface. */
static void list_ways(ss_drawing *drawn) {
    ss_stroke *ways = &drawn->strokes[SS_WAYS], *ends = &drawn->strokes[SS_ENDS_OF_WAYS];
    for (int32_t i = 0; drawn->figure->ways && i < drawn->outline->corner_count; i++) {
        const float *way = drawn->figure->ways + 3 * (int64_t)drawn->outline->corners[i][0];
        const float *place = drawn->work.vertices[drawn->outline->corners[i][1]].place;
        if (way[0] == 0 && way[1] == 0 && way[2] == 0)
            continue;
        add_segment(ways, (float[3]){place[0] - way[0], place[1] - way[1], place[2] - way[2]}, place);
        add_segment(ends, place, place);
    }
}

static void list_pins(ss_drawing *drawn) {
    ss_stroke *pins = &drawn->strokes[SS_PINS];
    for (int32_t i = 0; drawn->figure->pins && i < drawn->outline->corner_count; i++)
        if (drawn->figure->pins[drawn->outline->corners[i][0]]) {
            const float *place = drawn->work.vertices[drawn->outline->corners[i][1]].place;
            add_segment(pins, place, place);
        }
}

bool ss_list_strokes(ss_drawing *drawn) {
    const skinslide_outline *outline = drawn->outline;
    int32_t sides = drawn->figure->wire ? outline->side_count : 0, ways = drawn->figure->ways ? outline->corner_count : 0;
    int32_t edges = drawn->edge_value ? outline->side_count : 0;
    const int32_t room[SS_STROKES] = {
        [SS_WIRE] = sides,
        [SS_OUTLINE] = outline->segment_count,
        [SS_EDGE_BORDERS] = edges,
        [SS_EDGES] = edges,
        [SS_WAYS] = ways,
        [SS_ENDS_OF_WAYS] = ways,
        [SS_PINS] = drawn->figure->pins ? outline->corner_count : 0,
    };
    for (int i = 0; i < SS_STROKES; i++) {
        drawn->strokes[i] = kinds[i];
        ss_canvas_colour(drawn->canvas, kinds[i].light, drawn->strokes[i].colour);
        drawn->strokes[i].segments = SS_NEW(&drawn->work.memory, ss_segment, room[i]);
    }
    if (drawn->work.memory.failed)
        return false;
    list_segments(drawn, outline->sides, sides, &drawn->strokes[SS_WIRE]);
    list_segments(drawn, outline->segments, outline->segment_count, &drawn->strokes[SS_OUTLINE]);
    list_edges(drawn);
    list_ways(drawn);
    list_pins(drawn);
    return true;
}

static void draw_stroke(const ss_drawing *drawn, const ss_stroke *stroke) {
    const ss_egl_api *gl = &drawn->canvas->egl->api;
    const ss_figure_objects *objects = &drawn->canvas->objects;
    float wide = drawn->line * stroke->width;
    const float pen[3] = {wide / (float)drawn->viewport->width, wide / (float)drawn->viewport->height, stroke->nearer};
    gl->glUniform3fv(objects->pen, 1, pen);
    gl->glBindBuffer(GL_ARRAY_BUFFER, objects->segment_buffer);
    gl->glBufferData(GL_ARRAY_BUFFER, stroke->count * (GLsizeiptr)sizeof *stroke->segments, stroke->segments, GL_STREAM_DRAW);
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
