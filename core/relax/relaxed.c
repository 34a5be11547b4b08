/* The relaxed rule: the patch laid out in the plane once, at rest, and each vertex slid in it until the deformed surface is as
 * little stretched as it can be. */
#include "relax.h"

#include <stdlib.h>
#include <string.h>

typedef struct relaxed_rest {
    ss_rest head;
    ss_chart *chart;
    ss_system *system; /* of what the blocks of a step join */
} relaxed_rest;

typedef struct relaxed_slide {
    ss_slide head;
    ss_memory memory;
    ss_relaxer *relaxer;
    ss_traveller *traveller; /* NULL before the first way that is cut short */
} relaxed_slide;

/* ---- Once a shot ---- */

static void destroy(ss_rest *rest) {
    relaxed_rest *own = (relaxed_rest *)rest;
    ss_chart_destroy(own->chart);
    ss_system_destroy(own->system);
    free(own);
}

static skinslide_status create(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error) {
    relaxed_rest *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_status status = ss_chart_create(patch, rest_points, &own->chart, error);
    if (!status)
        status = ss_system_create(&net, patch->label, &own->system, error);
    if (status) {
        destroy(&own->head);
        return status;
    }
    own->head = (ss_rest){.rule = &ss_relaxed_rule, .patch = patch, .paint = paint, .uv = own->chart->uv};
    *out = &own->head;
    return SKINSLIDE_OK;
}

/* ---- Once a thread ---- */

static void close_slide(ss_slide *slide) {
    relaxed_slide *own = (relaxed_slide *)slide;
    ss_relaxer_destroy(own->relaxer);
    ss_traveller_destroy(own->traveller);
    ss_free(&own->memory);
    free(own);
}

static skinslide_status open_slide(const ss_rest *rest, struct ss_idbuffer *idbuffer, int32_t number, ss_slide **out,
                                   skinslide_error *error) {
    (void)idbuffer, (void)number; /* nothing is looked up */
    const relaxed_rest *of = (const relaxed_rest *)rest;
    relaxed_slide *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->head.rest = rest, own->head.flat.uv = rest->uv;
    own->head.asked = ss_new(&own->memory, rest->patch->free_count, sizeof *own->head.asked);
    own->head.places = SS_NEW(&own->memory, ss_place, rest->patch->free_count);
    skinslide_status status = own->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_relaxer_create(of->chart, of->system, &own->relaxer, error);
    if (status)
        close_slide(&own->head);
    else
        *out = &own->head;
    return status;
}

/* ---- In every frame ---- */

static skinslide_status start(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    (void)error;
    double time = ss_now();
    result->relax_steps = ss_relax(((relaxed_slide *)slide)->relaxer, frame, slide->places);
    ss_lap(&time, &result->relax_seconds);
    return SKINSLIDE_OK;
}

static bool slides_fully(const ss_patch *patch, const ss_frame *frame) {
    for (int32_t i = 0; i < patch->free_count; i++)
        if (frame->weights[i] != 1)
            return false;
    return !frame->limits;
}

/* Cuts the ways short that the artist does not want whole. */
static skinslide_status finish(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    relaxed_slide *own = (relaxed_slide *)slide;
    double time = ss_now();
    if (!slides_fully(slide->rest->patch, frame)) {
        skinslide_status status = ss_traveller_need(slide->rest->patch, &own->traveller, error);
        if (status)
            return status;
        result->clamped_vertices = ss_travel(own->traveller, frame->points, slide->flat.uv,
                                             (ss_allowance){frame->weights, frame->limits}, slide->places);
    }
    result->folded_faces = ss_count_turned(own->relaxer, slide->places);
    ss_ask_where_found(slide);
    ss_lap(&time, &result->relax_seconds);
    return SKINSLIDE_OK;
}

const ss_rule ss_relaxed_rule = {create, destroy, open_slide, close_slide, start, finish};
