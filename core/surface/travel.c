/* Limits how far each vertex goes along its way, measured along the deformed surface, to what the artist allows. The way is the
 * straight line in the embedding from the vertex's own place to where it was looked up. */
#include "surface.h"

#include <stdlib.h>

struct ss_traveller {
    ss_memory memory;
    const ss_patch *patch;
    ss_posed plane, pose;
};

skinslide_status ss_traveller_need(const ss_patch *patch, ss_traveller **traveller, skinslide_error *error) {
    if (*traveller)
        return SKINSLIDE_OK;
    ss_traveller *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->patch = patch;
    if (!ss_posed_allocate(&own->memory, patch, &own->plane) || !ss_posed_allocate(&own->memory, patch, &own->pose)) {
        ss_traveller_destroy(own);
        return ss_out_of_memory(error);
    }
    *traveller = own;
    return SKINSLIDE_OK;
}

void ss_traveller_destroy(ss_traveller *traveller) {
    if (!traveller)
        return;
    ss_free(&traveller->memory);
    free(traveller);
}

/* The way of a vertex, and where it ends. */
typedef struct journey {
    int32_t vertex;
    double limit;   /* along the way */
    ss_place place; /* in: where the way leads; out: where it ends */
    bool cut, at_hole;
} journey;

static void go_along_loop(const ss_traveller *traveller, const ss_place *own, journey *j) {
    double distance = ss_border_distance(&traveller->pose, j->vertex, &j->place), goal = fmin(fabs(distance), j->limit);
    j->cut = goal < fabs(distance);
    if (!j->cut)
        return;
    j->place = *own;
    ss_walk_border(&traveller->pose, &j->place, distance < 0 ? -goal : goal);
}

/* If a walk ends at a hole, the rest of the way is measured straight through space. */
static double rest_of_way(const ss_traveller *traveller, const ss_place *end, const ss_place *place) {
    double a[3], b[3], gap[3];
    ss_place_point(&traveller->pose, end, a);
    ss_place_point(&traveller->pose, place, b);
    ss_subtract(b, a, gap);
    return ss_length(gap);
}

static void go_through_plane(const ss_traveller *traveller, const ss_place *own, journey *j) {
    ss_place end = *own, cut = *own;
    const double *uv = j->place.uv;
    double length = ss_walk_measured(&traveller->plane, &traveller->pose, &end, uv, INFINITY);
    double missing = rest_of_way(traveller, &end, &j->place), goal = fmin(length + missing, j->limit);
    j->cut = goal < length + missing;
    if (!j->cut)
        return;
    ss_walk_measured(&traveller->plane, &traveller->pose, &cut, uv, goal);
    j->place = cut;
    j->at_hole = goal > length && missing > 1e-6 * (length + missing); /* rounding leaves less */
}

int32_t ss_travel(ss_traveller *traveller, const float *points, const double (*uv)[2], const double *limits, ss_place *places) {
    const ss_patch *patch = traveller->patch;
    int32_t at_holes = 0;
    ss_posed_set(&traveller->pose, points);
    ss_posed_set_plane(&traveller->plane, uv);
    for (int32_t i = 0; i < patch->free_count; i++) {
        journey j = {.vertex = patch->free_vertex[i], .limit = limits[i], .place = places[i]};
        if (places[i].triangle == SS_STAYS || isinf(j.limit))
            continue;
        ss_place own = ss_place_of_vertex(patch, uv, j.vertex);
        (patch->vertex_loop[j.vertex] >= 0 ? go_along_loop : go_through_plane)(traveller, &own, &j);
        if (j.cut)
            ss_place_settle(patch, uv, &j.place);
        places[i] = j.limit == 0 ? ss_place_staying(uv[j.vertex]) : j.place;
        at_holes += j.at_hole;
    }
    return at_holes;
}
