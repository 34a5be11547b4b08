/* The rules by force density (the paper): the patch is laid out in the plane at rest and in every frame, and each vertex is
 * looked up in the frame's layout at its place at rest. */
#include "plane.h"

#include <stdlib.h>
#include <string.h>

typedef struct plane_rest {
    ss_rest head;
    ss_memory memory;
    ss_system *system;
    double (*uv)[2]; /* [vertex_count] U0, the head's */
} plane_rest;

typedef struct plane_slide {
    ss_slide head;
    ss_memory memory;
    ss_room *room; /* of the factor and the next, used while embedding */
    ss_factor *factor;
    double (*own_rest_uv)[2]; /* [vertex_count] U0 with the frame's paint */
    ss_locator *locator;
    ss_traveller *traveller;    /* NULL before the first frame with limits */
    ss_idbuffer *idbuffer;      /* NULL: nothing proposes faces */
    int32_t number;             /* the patch's in idbuffer */
    ss_candidates *candidates;  /* [free_count] with idbuffer */
    const double (*rest_uv)[2]; /* the rest's uv, or own_rest_uv */
    double (*uv)[2];            /* [vertex_count] Ud, the head's */
} plane_slide;

static const ss_system *system_of(const plane_slide *own) {
    return ((const plane_rest *)own->head.rest)->system;
}

/* ---- Once a shot ---- */

static skinslide_status embed_rest(plane_rest *own, skinslide_error *error) {
    const ss_patch *patch = own->head.patch;
    ss_factor *factor = NULL;
    skinslide_status status = ss_factor_create(own->system, NULL, &factor, error);
    if (!status) {
        ss_force_density(patch, patch->rest_length, own->head.paint, factor->entry);
        status = ss_embed(own->system, factor, own->uv, error);
    }
    ss_factor_destroy(factor);
    return status;
}

/* Whether a vertex of a hole is fixed. */
static bool holds_hole(const ss_patch *patch) {
    bool holds = false;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        holds = holds || (patch->vertex_loop[v] > 0 && patch->fixed[v]);
    return holds;
}

static skinslide_status lay_out_rest(plane_rest *own, const float *rest_points, skinslide_error *error) {
    const ss_patch *patch = own->head.patch;
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_status status = ss_check_disk(patch, error);
    if (!status)
        status = ss_place_boundary(patch, patch->setup->boundary, rest_points, own->uv, error);
    if (!status && holds_hole(patch))
        status = ss_place_holes(patch, rest_points, own->uv, error);
    if (!status)
        status = ss_system_create(&net, patch->label, &own->system, error);
    return status ? status : embed_rest(own, error);
}

static void destroy(ss_rest *rest) {
    plane_rest *own = (plane_rest *)rest;
    ss_system_destroy(own->system);
    ss_free(&own->memory);
    free(own);
}

static skinslide_status create(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error) {
    plane_rest *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->uv = ss_new(&own->memory, patch->vertex_count, sizeof *own->uv);
    own->head = (ss_rest){.rule = &ss_plane_rule, .patch = patch, .paint = paint, .uv = (const double(*)[2])own->uv};
    skinslide_status status = own->memory.failed ? ss_out_of_memory(error) : lay_out_rest(own, rest_points, error);
    if (status)
        destroy(&own->head);
    else
        *out = &own->head;
    return status;
}

/* ---- Once a thread ---- */

/* Fixed vertices are where they are at rest, in every frame. */
static void copy_rest(const ss_rest *rest, double (*uv)[2]) {
    memcpy(uv, rest->uv, (size_t)rest->patch->vertex_count * sizeof *uv);
}

static void lay_out(plane_slide *own, ss_room *room) {
    const ss_patch *patch = own->head.rest->patch;
    ss_factor_lay_out(own->factor, room);
    own->own_rest_uv = ss_take_room(room, patch->vertex_count, sizeof *own->own_rest_uv);
}

static skinslide_status allocate(plane_slide *own, skinslide_error *error) {
    const ss_patch *patch = own->head.rest->patch;
    ss_memory *memory = &own->memory;
    own->uv = ss_new(memory, patch->vertex_count, sizeof *own->uv);
    own->head.asked = ss_new(memory, patch->free_count, sizeof *own->head.asked);
    own->head.places = SS_NEW(memory, ss_place, patch->free_count);
    if (own->idbuffer)
        own->candidates = ss_new(memory, patch->free_count, sizeof *own->candidates);
    if (memory->failed)
        return ss_out_of_memory(error);
    own->head.flat.uv = (const double(*)[2])own->uv;
    copy_rest(own->head.rest, own->uv);
    skinslide_status status = ss_factor_create(system_of(own), own->room, &own->factor, error);
    ss_room counted = {0};
    if (!status) {
        lay_out(own, &counted);
        ss_ask_room(own->room, &counted);
    }
    return status ? status : ss_locator_create(patch, &own->locator, error);
}

static void close_slide(ss_slide *slide) {
    plane_slide *own = (plane_slide *)slide;
    ss_factor_destroy(own->factor);
    ss_locator_destroy(own->locator);
    ss_traveller_destroy(own->traveller);
    ss_free(&own->memory);
    free(own);
}

static skinslide_status open_slide(const ss_rest *rest, ss_room *room, ss_idbuffer *idbuffer, int32_t number, ss_slide **out,
                                   skinslide_error *error) {
    plane_slide *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->head.rest = rest, own->room = room, own->idbuffer = idbuffer, own->number = number;
    skinslide_status status = allocate(own, error);
    if (status)
        close_slide(&own->head);
    else
        *out = &own->head;
    return status;
}

/* ---- In every frame ---- */

/* If the frame's paint differs from the set-up's, embeds rest anew. */
static skinslide_status choose_rest(plane_slide *own, const ss_frame *frame, skinslide_error *error) {
    const ss_rest *rest = own->head.rest;
    own->rest_uv = rest->uv;
    if (frame->paint == rest->paint)
        return SKINSLIDE_OK;
    copy_rest(rest, own->own_rest_uv);
    own->rest_uv = (const double(*)[2])own->own_rest_uv;
    ss_force_density(rest->patch, rest->patch->rest_length, frame->paint, own->factor->entry);
    return ss_embed(system_of(own), own->factor, own->own_rest_uv, error);
}

/* u = lerp(own place in Ud, rest place in U0, weight): where each free vertex is looked up. */
static void ask(plane_slide *own, const double *weights) {
    const ss_patch *patch = own->head.rest->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        const double *here = own->head.flat.uv[patch->free_vertex[i]], *rest = own->rest_uv[patch->free_vertex[i]];
        double weight = weights[i];
        for (int k = 0; k < 2; k++)
            own->head.asked[i][k] = weight == 1 ? rest[k] : here[k] + weight * (rest[k] - here[k]);
    }
}

/* Embeds the frame. A device draws its texture while the caller goes on. */
static skinslide_status start(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    plane_slide *own = (plane_slide *)slide;
    const ss_patch *patch = slide->rest->patch;
    double time = ss_now();
    ss_begin_turn(own->room);
    lay_out(own, own->room);
    skinslide_status status = choose_rest(own, frame, error);
    if (status)
        return status;
    ss_force_density(patch, frame->lengths, frame->paint, own->factor->entry);
    ss_lap(&time, &result->density_seconds);

    if ((status = ss_embed(system_of(own), own->factor, own->uv, error)))
        return status;
    ss_lap(&time, &result->embed_seconds);

    ss_layout layout = ss_lay_out(patch, slide->flat.uv);
    result->folded_faces = layout.folded;
    slide->regular = layout.regular;
    ask(own, frame->weights);
    if (own->idbuffer && layout.regular)
        ss_idbuffer_draw(own->idbuffer, own->number, slide->flat.uv, (const double(*)[2])slide->asked);
    ss_lap(&time, &result->locate_seconds);
    return SKINSLIDE_OK;
}

static void locate(plane_slide *own, skinslide_patch_result *result) {
    ss_slide *slide = &own->head;
    bool asked = own->idbuffer && slide->regular && slide->rest->patch->free_count > 0;
    bool proposed = asked && ss_idbuffer_candidates(own->idbuffer, own->number, own->candidates);
    ss_located located = ss_locate(own->locator, slide->flat.uv, slide->regular, (const double(*)[2])slide->asked,
                                   proposed ? (const ss_candidates *)own->candidates : NULL, slide->places);
    result->lost_textures = asked && !proposed;
    result->found_in_centre = located.centre;
    result->found_in_3x3 = located.around;
    result->walked_vertices = located.walked;
    result->searched_vertices = located.searched;
    result->clamped_vertices = located.clamped;
    result->walk_steps = located.steps;
}

/* Looks each vertex up in the embedding, and limits its way. */
static skinslide_status finish(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error) {
    plane_slide *own = (plane_slide *)slide;
    double time = ss_now();
    skinslide_status status = frame->limits ? ss_traveller_need(slide->rest->patch, &own->traveller, error) : SKINSLIDE_OK;
    if (status)
        return status;
    locate(own, result);
    if (frame->limits) {
        result->clamped_vertices += ss_travel(own->traveller, frame->points, slide->flat.uv, frame->limits, slide->places);
        ss_ask_where_found(slide);
    }
    ss_lap(&time, &result->locate_seconds);
    return SKINSLIDE_OK;
}

const ss_rule ss_plane_rule = {create, destroy, open_slide, close_slide, start, finish};
