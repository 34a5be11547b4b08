/* One slide: four steps towards the balance that even.h states. */
#include "even.h"

#include <stdlib.h>
#include <string.h>

/* At half and at twice as many, 34 and 41 % of the stretch of the example sleeve goes, where it is 39 %; with twice, a face
 * moves 1.5 times as roughly as its cache. Six folded a walking figure. */
#define STEPS        4
#define LEAST_SQUARE 1e-12 /* (length / length at rest)^2, so that a logarithm is finite */

static const ss_caution own_caution = {.most_lost = 0.5, .least_area = 0.1};

void ss_evener_lay_out(ss_evener *evener, ss_room *room) {
    const ss_patch *patch = evener->sheet->patch;
    int32_t vertices = patch->vertex_count, springs = evener->sheet->spring_count;
    evener->next_weight = SS_TAKE(room, double, vertices);
    evener->next_hold = SS_TAKE(room, double, vertices);
    evener->bond = SS_TAKE(room, double, springs);
    evener->bonds = SS_TAKE(room, double, vertices);
    evener->load = SS_TAKE(room, double, vertices);
    evener->crush = SS_TAKE(room, double, vertices);
    ss_posed_lay_out(&evener->pose, patch, room);
    evener->place = SS_TAKE(room, ss_place, vertices);
    evener->walking = SS_TAKE(room, int32_t, vertices);
    evener->at = ss_take_room(room, vertices, sizeof *evener->at);
    evener->up = ss_take_room(room, vertices, sizeof *evener->up);
    evener->slide = ss_take_room(room, vertices, sizeof *evener->slide);
    evener->step = ss_take_room(room, vertices, sizeof *evener->step);
    evener->straight = ss_take_room(room, vertices, sizeof *evener->straight);
    evener->part = SS_TAKE(room, double, vertices);
    evener->reach = SS_TAKE(room, double, patch->faces.face_count);
    evener->whole = ss_take_room(room, vertices, sizeof *evener->whole);
    evener->anchor = SS_TAKE(room, double, vertices);
    evener->stretch = SS_TAKE(room, double, springs);
    evener->sorted = SS_TAKE(room, ss_weighted, springs);
    ss_blocks_lay_out(evener->K, room);
}

skinslide_status ss_evener_create(const ss_sheet *sheet, bool bonds_needed, ss_room *room, ss_evener **out,
                                  skinslide_error *error) {
    ss_evener *evener = calloc(1, sizeof *evener);
    if (!evener)
        return ss_out_of_memory(error);
    ss_room counted = {0};
    evener->sheet = sheet, evener->bonds_needed = bonds_needed;
    evener->paint = SS_NEW(&evener->memory, double, sheet->patch->faces.edge_count);
    evener->weight = SS_NEW(&evener->memory, double, sheet->patch->vertex_count);
    evener->hold = SS_NEW(&evener->memory, double, sheet->patch->vertex_count);
    evener->moving = SS_NEW(&evener->memory, int32_t, sheet->patch->vertex_count);
    skinslide_status status = evener->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_blocks_create(sheet->system, true, room, &evener->K, error);
    if (status) {
        ss_evener_destroy(evener);
        return status;
    }
    ss_evener_lay_out(evener, &counted);
    ss_ask_room(room, &counted);
    *out = evener;
    return SKINSLIDE_OK;
}

void ss_evener_destroy(ss_evener *evener) {
    if (!evener)
        return;
    ss_blocks_destroy(evener->K);
    ss_free(&evener->memory);
    free(evener);
}

/* ---- Where the vertices are ---- */

void ss_measure_stretch(ss_evener *evener) {
    for (int32_t i = 0; i < evener->sheet->spring_count; i++) {
        const ss_spring *spring = &evener->sheet->springs[i];
        double way[3];
        ss_subtract(evener->at[spring->end[1]], evener->at[spring->end[0]], way);
        evener->stretch[i] = spring->square > 0 ? ss_most(ss_dot(way, way) / spring->square, LEAST_SQUARE) : 1;
    }
    ss_logs(evener->sheet->spring_count, evener->stretch);
    for (int32_t i = 0; i < evener->sheet->spring_count; i++)
        evener->stretch[i] *= 0.5;
}

double ss_sum_stretch(const ss_evener *evener) {
    double sum = 0;
    for (int32_t i = 0; i < evener->sheet->spring_count; i++) {
        double own = evener->stretch[i] - evener->scale;
        sum += own * own;
    }
    return sum;
}

void ss_go_home(ss_evener *evener) {
    const ss_patch *patch = evener->sheet->patch;
    memcpy(evener->at, evener->pose.point, (size_t)patch->vertex_count * sizeof *evener->at);
    memset(evener->slide, 0, (size_t)patch->vertex_count * sizeof *evener->slide);
    memset(evener->step, 0, (size_t)patch->vertex_count * sizeof *evener->step);
    ss_measure_stretch(evener);
}

/* Adds its step to the slide of every vertex that may slide. Vertices on loops walk along them; the others are listed in
 * over_faces. Returns how many are. */
static int32_t add_steps(ss_evener *evener, int32_t *over_faces) {
    const ss_sheet *sheet = evener->sheet;
    int32_t count = 0;
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++) {
        if (!(evener->weight[v] > 0))
            continue;
        for (int j = 0; j < 2; j++)
            evener->slide[v][j] += evener->step[v][j];
        if (sheet->patch->vertex_loop[v] < 0) {
            over_faces[count++] = v;
            continue;
        }
        evener->place[v] = ss_place_of_vertex(sheet->patch, NULL, v);
        ss_walk_border(&sheet->ground.pose, &evener->place[v], evener->slide[v][0]);
    }
    return count;
}

/* Walks each vertex anew from its own place; the part of a slide beyond the border is dropped. */
static void slide_all(ss_evener *evener) {
    int32_t count = add_steps(evener, evener->walking);
    ss_walk_turned_all(&evener->sheet->ground, count, evener->walking, evener->slide, evener->place);
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        if (evener->weight[v] > 0)
            ss_place_point(&evener->pose, &evener->place[v], evener->at[v]);
}

/* ---- The balance ---- */

static double find_scale(const ss_evener *evener, const double *paint) {
    int32_t count = 0;
    for (int32_t i = 0; i < evener->sheet->spring_count; i++)
        if (evener->sheet->springs[i].square > 0)
            evener->sorted[count++] = (ss_weighted){evener->stretch[i], paint[evener->sheet->springs[i].edge]};
    return ss_find_scale(evener->sorted, count);
}

enum { AT_ONCE = 256 }; /* springs */

/* J d - s for count springs from begin on. */
static void find_forces(const ss_evener *evener, const ss_frame *frame, int32_t begin, int32_t count, double *force) {
    double stretch_response = frame->stretch_response, compression_response = frame->compression_response;
    double drive[AT_ONCE], slope;
    for (int32_t i = 0; i < count; i++)
        drive[i] = ss_drive(stretch_response, compression_response, evener->stretch[begin + i] - evener->scale, &slope);
    for (int32_t i = 0; i < count; i++) {
        const ss_spring *spring = &evener->sheet->springs[begin + i];
        const double *first = evener->slide[spring->end[0]], *second = evener->slide[spring->end[1]];
        force[i] = spring->slope[0][0] * first[0] + spring->slope[0][1] * first[1] + spring->slope[1][0] * second[0] +
                   spring->slope[1][1] * second[1] - drive[i];
    }
}

static void add_force(ss_evener *evener, const ss_spring *spring, double force) {
    for (int end = 0; end < 2; end++) {
        int32_t unknown = evener->moving[spring->end[end]];
        for (int j = 0; j < 2 && unknown >= 0; j++)
            evener->K->right[unknown][j] += force * spring->slope[end][j];
    }
}

/* Solves K goal = J' k (J d - s); the step is goal - d. */
static void solve(ss_evener *evener, const ss_frame *frame) {
    const ss_sheet *sheet = evener->sheet;
    double force[AT_ONCE];
    memset(evener->K->right, 0, (size_t)sheet->system->n * sizeof *evener->K->right);
    for (int32_t begin = 0; begin < sheet->spring_count; begin += AT_ONCE) {
        int32_t left = sheet->spring_count - begin, count = left < AT_ONCE ? left : AT_ONCE;
        find_forces(evener, frame, begin, count, force);
        for (int32_t i = 0; i < count; i++) {
            const ss_spring *spring = &sheet->springs[begin + i];
            add_force(evener, spring, evener->paint[spring->edge] * force[i]);
        }
    }
    ss_pull_to_shares(evener, (const double(*)[2])evener->whole, evener->K->right);
    ss_blocks_solve(evener->K);
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++) {
        int32_t unknown = evener->moving[v];
        for (int j = 0; j < 2 && unknown >= 0; j++)
            evener->step[v][j] = evener->K->right[unknown][j] - evener->slide[v][j];
    }
}

/* ---- The slide ---- */

static bool stays(const ss_evener *evener, int32_t vertex) {
    const ss_place *place = &evener->place[vertex];
    int corner = ss_place_corner(place);
    return corner >= 0 && evener->sheet->patch->triangles.vertex[place->triangle][corner] == vertex;
}

void ss_write_places(const ss_evener *evener, ss_place *places) {
    const ss_patch *patch = evener->sheet->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        bool slides = evener->weight[v] != 0 && !stays(evener, v);
        places[i] = slides ? evener->place[v] : ss_place_staying((double[2]){0, 0});
    }
}

bool ss_take_step(ss_evener *evener, ss_caution caution) {
    bool cut = ss_shorten_step(evener, caution);
    slide_all(evener);
    return cut;
}

void ss_set_out(ss_evener *evener, const ss_frame *frame) {
    ss_take_points(evener->sheet->patch, frame->points, evener->pose.point);
    ss_go_home(evener);
    evener->scale = find_scale(evener, frame->paint);
    ss_stiffen_holds(evener, frame->holds);
}

skinslide_status ss_slide_by(ss_evener *evener, const ss_frame *frame, const double *weight, int32_t *cut,
                             skinslide_error *error) {
    skinslide_status status = ss_need_stiffness(evener, frame, weight, evener->next_hold, error);
    for (int step = 0; step < STEPS && !status && !ss_is_set(frame->stop); step++) {
        if (step > 0)
            ss_measure_stretch(evener);
        solve(evener, frame);
        *cut += ss_take_step(evener, own_caution);
    }
    return status;
}

void ss_keep_whole(ss_evener *evener) {
    memcpy(evener->whole, evener->slide, (size_t)evener->sheet->patch->vertex_count * sizeof *evener->whole);
}

void ss_keep_part(ss_evener *evener, const double (*from)[2], double part) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        for (int j = 0; j < 2; j++)
            evener->slide[v][j] = from[v][j] + part * (evener->slide[v][j] - from[v][j]), evener->step[v][j] = 0;
    slide_all(evener);
}

void ss_scale_slide(ss_evener *evener) {
    if (evener->most_weight == 1)
        return;
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        for (int j = 0; j < 2; j++)
            evener->slide[v][j] *= evener->most_weight, evener->step[v][j] = 0;
    slide_all(evener);
}

skinslide_status ss_even_out(ss_evener *evener, const ss_frame *frame, int32_t *cut, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    ss_set_out(evener, frame);
    if (ss_share_weights(evener, frame)) {
        status = ss_slide_by(evener, frame, evener->sheet->slides, cut, error);
        ss_keep_whole(evener);
        ss_go_home(evener);
    }
    if (!status)
        status = ss_slide_by(evener, frame, evener->next_weight, cut, error);
    if (!status)
        ss_scale_slide(evener);
    return status;
}
