/* The rule `even`: its functions, as every rule has them. */
#include "even.h"

#include <stdlib.h>

typedef struct even_rest {
    ss_rest head;
    ss_sheet *sheet;
} even_rest;

/* ---- Once a shot ---- */

static void destroy(ss_rest *rest) {
    even_rest *own = (even_rest *)rest;
    ss_sheet_destroy(own->sheet);
    free(own);
}

static skinslide_status create(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error) {
    even_rest *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->head = (ss_rest){.rule = &ss_even_rule, .patch = patch, .paint = paint};
    skinslide_status status = ss_sheet_create(patch, rest_points, &own->sheet, error);
    if (status) {
        destroy(&own->head);
        return status;
    }
    own->head.ground = &own->sheet->ground;
    *out = &own->head;
    return SKINSLIDE_OK;
}

const ss_sheet *ss_sheet_of(const ss_rest *rest) {
    return ((const even_rest *)rest)->sheet;
}

skinslide_status ss_multiply_rest(ss_rest *rest, skinslide_error *error) {
    return ss_sheet_multiply(((even_rest *)rest)->sheet) ? SKINSLIDE_OK : ss_out_of_memory(error);
}

/* ---- Once a thread ---- */

skinslide_status ss_open_even(const ss_rest *rest, bool bonds_needed, ss_room *room, ss_even_slide *slide,
                              skinslide_error *error) {
    slide->room = room;
    slide->head.rest = rest;
    slide->head.flat = (ss_flat){.corner = (const double(*)[2])ss_sheet_of(rest)->flat};
    slide->head.places = SS_NEW(&slide->memory, ss_place, rest->patch->free_count);
    if (slide->memory.failed)
        return ss_out_of_memory(error);
    return ss_evener_create(ss_sheet_of(rest), bonds_needed, room, &slide->evener, error);
}

void ss_close_even(ss_even_slide *slide) {
    ss_evener_destroy(slide->evener);
    ss_free(&slide->memory);
    free(slide);
}

static void close_slide(ss_slide *slide) {
    ss_close_even((ss_even_slide *)slide);
}

static skinslide_status open_slide(const ss_rest *rest, ss_room *room, struct ss_idbuffer *idbuffer, int32_t number,
                                   ss_slide **out, skinslide_error *error) {
    (void)idbuffer, (void)number; /* nothing is looked up */
    ss_even_slide *own = calloc(1, sizeof *own);
    skinslide_status status = own ? ss_open_even(rest, false, room, own, error) : ss_out_of_memory(error);
    if (status && own)
        ss_close_even(own);
    if (!status)
        *out = &own->head;
    return status;
}

/* ---- In every frame ---- */

void ss_end_slide(ss_evener *evener, const ss_frame *frame, ss_slide *slide, skinslide_patch_result *result) {
    ss_write_places(evener, slide->places);
    if (frame->limits)
        ss_limit_ways(evener, frame, slide->places);
    result->folded_faces = ss_count_turned_over(evener->sheet, slide->places, evener->at, evener->up);
}

static skinslide_status start(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    ss_even_slide *own = (ss_even_slide *)slide;
    double time = ss_now();
    ss_begin_turn(own->room);
    ss_evener_lay_out(own->evener, own->room);
    skinslide_status status = ss_even_out(own->evener, frame, &result->cut_steps, error);
    if (!status && !ss_is_set(frame->stop))
        ss_end_slide(own->evener, frame, slide, result);
    ss_lap(&time, &result->relax_seconds);
    return status;
}

skinslide_status ss_finish_nothing(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result,
                                   skinslide_error *error) {
    (void)slide, (void)frame, (void)result, (void)error;
    return SKINSLIDE_OK;
}

const ss_rule ss_even_rule = {create, destroy, open_slide, close_slide, start, ss_finish_nothing};
