/* One relaxed slide: the slide of `even`, then steps on the pose. */
#include "relax.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS       3    /* two leave 1 to 2 % more of what can go of a face; with six, it moves 1.4 times as roughly */
#define LEAST_SPARE 0.01 /* of the cache's sum: keeps the part from vanishing where even gains nothing */

/* More careful than `even`: the model is worse at large steps, which at even's caution folded a walking figure. */
static const ss_caution caution = {.most_lost = 0.35, .least_area = 0.25};

void ss_relaxer_lay_out(ss_relaxer *relaxer, ss_room *room) {
    int32_t vertices = relaxer->evener->sheet->patch->vertex_count;
    ss_evener_lay_out(relaxer->evener, room);
    ss_blocks_lay_out(relaxer->blocks, room);
    relaxer->gradient = ss_take_room(room, vertices, sizeof *relaxer->gradient);
    relaxer->axis = ss_take_room(room, vertices, sizeof *relaxer->axis);
    relaxer->even = ss_take_room(room, vertices, sizeof *relaxer->even);
    relaxer->anchor = SS_TAKE(room, double, vertices);
}

skinslide_status ss_relaxer_create(ss_evener *evener, ss_room *room, ss_relaxer **out, skinslide_error *error) {
    ss_relaxer *relaxer = calloc(1, sizeof *relaxer);
    if (!relaxer)
        return ss_out_of_memory(error);
    ss_room counted = {0};
    relaxer->evener = evener;
    skinslide_status status = ss_blocks_create(evener->sheet->system, false, room, &relaxer->blocks, error);
    if (status) {
        ss_relaxer_destroy(relaxer);
        return status;
    }
    ss_relaxer_lay_out(relaxer, &counted);
    ss_ask_room(room, &counted);
    *out = relaxer;
    return SKINSLIDE_OK;
}

void ss_relaxer_destroy(ss_relaxer *relaxer) {
    if (!relaxer)
        return;
    ss_blocks_destroy(relaxer->blocks);
    free(relaxer);
}

/* Finds the step from where the vertices are; their stretch has been measured there. False if the model cannot be solved. */
static bool find_step(ss_relaxer *relaxer, const ss_frame *frame) {
    ss_evener *evener = relaxer->evener;
    ss_find_axes(relaxer);
    ss_fill_model(relaxer, frame);
    if (!ss_blocks_factor_and_solve(relaxer->blocks, frame->stop))
        return false;
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        for (int j = 0; j < 2 && evener->moving[v] >= 0; j++)
            evener->step[v][j] = relaxer->blocks->right[evener->moving[v]][j];
    return true;
}

/* Where rest is crumpled the model is poor, and its steps may add stretch. Given the sums of stretch in the cache, where `even`
 * leaves skin, and after the steps, returns how much of the steps to take so that, if the sum changed evenly on the way, it
 * would be no more than the cache's: 1 if it is no more in the end. Changes smoothly with all three. */
static double part_without_gain(double cache, double even, double after) {
    double spare = fmax(cache - even, LEAST_SPARE * cache), gain = fmax(after - fmax(cache, even), 0);
    return gain > 0 ? spare / (spare + gain) : 1;
}

/* Takes all steps, from the vertices' own places, by weights [vertex_count]. */
static skinslide_status slide_by(ss_relaxer *relaxer, const ss_frame *frame, const double *weight, int32_t *steps, int32_t *cut,
                                 skinslide_error *error) {
    ss_evener *evener = relaxer->evener;
    double cache = ss_sum_stretch(evener);
    skinslide_status status = ss_slide_by(evener, frame, weight, cut, error);
    if (status)
        return status;
    ss_set_anchors(relaxer);
    ss_measure_stretch(evener);
    double even = ss_sum_stretch(evener);
    for (*steps = 0; *steps < STEPS && !ss_is_set(frame->stop) && find_step(relaxer, frame); ++*steps) {
        *cut += ss_take_step(evener, caution);
        ss_measure_stretch(evener);
    }
    double part = part_without_gain(cache, even, ss_sum_stretch(evener));
    if (part < 1)
        ss_keep_part(evener, (const double(*)[2])relaxer->even, part);
    return SKINSLIDE_OK;
}

skinslide_status ss_relax(ss_relaxer *relaxer, const ss_frame *frame, int32_t *steps, int32_t *cut, skinslide_error *error) {
    ss_evener *evener = relaxer->evener;
    skinslide_status status = SKINSLIDE_OK;
    memset(evener->whole, 0, (size_t)evener->sheet->patch->vertex_count * sizeof *evener->whole);
    ss_set_out(evener, frame);
    ss_find_gradients(relaxer);
    if (ss_share_weights(evener, frame)) {
        status = slide_by(relaxer, frame, evener->sheet->slides, steps, cut, error);
        ss_keep_whole(evener);
        ss_go_home(evener);
    }
    if (!status)
        status = slide_by(relaxer, frame, evener->next_weight, steps, cut, error);
    if (!status)
        ss_scale_slide(evener);
    return status;
}
