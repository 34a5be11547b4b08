/* How far each vertex goes along its way: a share of it, and no farther than the artist lets it, both measured along the deformed
 * surface. The way is the straight line in the embedding from the vertex's own place to where it belongs. */
#include "travel.h"

#include <stdlib.h>

skinslide_status ss_traveller_create(const ss_triangles *triangles, ss_traveller **out, skinslide_error *error) {
    ss_traveller *traveller = calloc(1, sizeof *traveller);
    if (!traveller)
        return ss_out_of_memory(error);
    traveller->triangles = triangles;
    if (!ss_posed_allocate(&traveller->memory, triangles, &traveller->plane) ||
        !ss_posed_allocate(&traveller->memory, triangles, &traveller->pose)) {
        ss_traveller_destroy(traveller);
        return ss_out_of_memory(error);
    }
    *out = traveller;
    return SKINSLIDE_OK;
}

void ss_traveller_destroy(ss_traveller *traveller) {
    if (!traveller)
        return;
    ss_free(&traveller->memory);
    free(traveller);
}

/* Where a vertex may go, and what became of it. */
typedef struct journey {
    int32_t vertex;
    double share, limit; /* of the way, and along it */
    ss_site site;        /* where it leads, then where it ends */
    bool cut, at_hole;
} journey;

static double allowed(const journey *j, double length) {
    return fmin(j->share * length, j->limit);
}

static void go_along_loop(const ss_traveller *traveller, journey *j) {
    double distance = ss_site_border_distance(&traveller->pose, j->vertex, &j->site), goal = allowed(j, fabs(distance));
    j->cut = goal < fabs(distance);
    if (!j->cut)
        return;
    j->site = ss_site_of_vertex(traveller->triangles, j->vertex);
    ss_site_walk_border(&traveller->pose, &j->site, distance < 0 ? -goal : goal);
}

/* What is missing of a way that ends at a hole is measured through the air. */
static double rest_of_way(const ss_traveller *traveller, const ss_site *end, const ss_site *site) {
    double a[3], b[3], gap[3];
    ss_site_place(&traveller->pose, end, a);
    ss_site_place(&traveller->pose, site, b);
    ss_subtract(b, a, gap);
    return ss_length(gap);
}

static void go_through_plane(const ss_traveller *traveller, const double uv[2], journey *j) {
    ss_site own = ss_site_of_vertex(traveller->triangles, j->vertex), end = own;
    double length = ss_site_trace(&traveller->plane, &traveller->pose, &end, uv, INFINITY);
    double missing = rest_of_way(traveller, &end, &j->site), goal = allowed(j, length + missing);
    j->cut = goal < length + missing;
    if (!j->cut)
        return;
    ss_site_trace(&traveller->plane, &traveller->pose, &own, uv, goal);
    j->site = own;
    j->at_hole = goal > length && missing > 1e-6 * (length + missing); /* rounding leaves less */
}

int32_t ss_travel(ss_traveller *traveller, const float *points, const double (*uv)[2], ss_allowance allowance,
                  ss_location *locations) {
    const ss_triangles *triangles = traveller->triangles;
    const ss_patch *patch = triangles->patch;
    int32_t at_holes = 0;
    ss_posed_set(&traveller->pose, points);
    ss_posed_set_plane(&traveller->plane, uv);
    for (int32_t i = 0; i < patch->free_count; i++) {
        journey j = {.vertex = patch->free_vertex[i],
                     .share = allowance.shares ? allowance.shares[i] : 1,
                     .limit = allowance.limits ? allowance.limits[i] : INFINITY};
        if (locations[i].face == SS_STAYS || (j.share == 1 && isinf(j.limit)))
            continue;
        j.site = ss_location_site(triangles, &locations[i], uv);
        if (patch->vertex_loop[j.vertex] >= 0)
            go_along_loop(traveller, &j);
        else
            go_through_plane(traveller, locations[i].uv, &j);
        if (j.cut)
            locations[i] = ss_site_location(triangles, &j.site, uv);
        if (j.share == 0 || j.limit == 0)
            locations[i].face = SS_STAYS;
        at_holes += j.at_hole;
    }
    return at_holes;
}
