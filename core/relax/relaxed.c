/* The rule `relaxed`: its functions, as every rule has them. A patch at rest is prepared as for `even`. */
#include "relax.h"

#include <stdlib.h>

typedef struct relaxed_slide {
    ss_even_slide even;
    ss_relaxer *relaxer;
} relaxed_slide;

/* ---- Once a shot ---- */

static skinslide_status create(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error) {
    skinslide_status status = ss_even_rule.create(patch, rest_points, paint, out, error);
    if (status)
        return status;
    (*out)->rule = &ss_relaxed_rule;
    status = ss_multiply_rest(*out, error);
    if (status) {
        ss_even_rule.destroy(*out);
        *out = NULL;
    }
    return status;
}

static void destroy(ss_rest *rest) {
    ss_even_rule.destroy(rest);
}

/* ---- Once a thread ---- */

static void close_slide(ss_slide *slide) {
    relaxed_slide *own = (relaxed_slide *)slide;
    ss_relaxer_destroy(own->relaxer);
    ss_close_even(&own->even);
}

static skinslide_status open_slide(const ss_rest *rest, ss_room *room, struct ss_idbuffer *idbuffer, int32_t number,
                                   ss_slide **out, skinslide_error *error) {
    (void)idbuffer, (void)number; /* nothing is looked up */
    relaxed_slide *own = calloc(1, sizeof *own);
    skinslide_status status = own ? ss_open_even(rest, true, room, &own->even, error) : ss_out_of_memory(error);
    if (!status)
        status = ss_relaxer_create(own->even.evener, room, &own->relaxer, error);
    if (status && own)
        close_slide(&own->even.head);
    if (!status)
        *out = &own->even.head;
    return status;
}

/* ---- In every frame ---- */

static skinslide_status start(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    relaxed_slide *own = (relaxed_slide *)slide;
    double time = ss_now();
    ss_begin_turn(own->even.room);
    ss_relaxer_lay_out(own->relaxer, own->even.room);
    skinslide_status status = ss_relax(own->relaxer, frame, &result->relax_steps, &result->cut_steps, error);
    if (!status && !ss_is_set(frame->stop))
        ss_end_slide(own->even.evener, frame, slide, result);
    ss_lap(&time, &result->relax_seconds);
    return status;
}

const ss_rule ss_relaxed_rule = {create, destroy, open_slide, close_slide, start, ss_finish_nothing};
