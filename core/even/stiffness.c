/* K, in blocks of two by two, factored: J' k J + eta B, with
 *
 *     d' B d = sum of k |D_b - D_a|^2 / l^2     over edges of length l at rest, D the slides in space
 *
 * and eta times the mean of what is painted on the ends; and the springs of weights, see weights.c. Each unknown is held where it is
 * by FIRMNESS of all that acts on it: so K is positive definite, rounded as it is, where nothing else holds skin and however far
 * apart densities, holds and weights are. A vertex of no weight keeps its unknowns, which come to 0. */
#include "even.h"

#include <string.h>

#define TIE      1e6   /* of the ends of an edge without length: of eta k, over the square of the mean edge */
#define FIRMNESS 1e-10 /* far over rounding, far under what holds skin of a million faces that is closed */

static bool slides(const ss_evener *evener, int32_t vertex) {
    return evener->weight[vertex] > 0;
}

double ss_hold_of(const ss_evener *evener, const ss_spring *spring) {
    const double *hold = evener->hold;
    double mean = 0.5 * (hold[spring->end[0]] + hold[spring->end[1]]), edge = evener->sheet->patch->mean_edge;
    double stiffness = spring->square > 0 ? 1 / spring->square : TIE / (edge * edge);
    return mean * evener->paint[spring->edge] * stiffness;
}

static void add_own(ss_evener *evener, const ss_spring *spring, int end, double k, double hold) {
    int32_t v = spring->end[end];
    if (!slides(evener, v))
        return;
    double *own = ss_blocks_own(evener->K, ss_blocks_unknown(evener->K, v));
    const double(*tangent)[3] = (const double(*)[3])evener->sheet->tangent[v], *slope = spring->slope[end];
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            own[2 * i + j] += k * slope[i] * slope[j] + hold * ss_dot(tangent[i], tangent[j]);
}

static void add_between(ss_evener *evener, const ss_spring *spring, double k, double hold) {
    const int32_t *v = spring->end;
    bool first_is_row;
    if (!slides(evener, v[0]) || !slides(evener, v[1]))
        return;
    double *between = ss_blocks_between(evener->K, spring->edge, &first_is_row);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            between[first_is_row ? 2 * i + j : 2 * j + i] =
                k * spring->slope[0][i] * spring->slope[1][j] -
                hold * ss_dot(evener->sheet->tangent[v[0]][i], evener->sheet->tangent[v[1]][j]);
}

void ss_firm(double own[4]) {
    for (int i = 0; i < 4; i += 3)
        own[i] = own[i] > 0 ? (1 + FIRMNESS) * own[i] : 1;
}

static void add_diagonal(ss_evener *evener, int32_t v, double anchor) {
    int32_t unknown = ss_blocks_unknown(evener->K, v);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(evener->K, unknown);
    own[0] += anchor, own[3] += anchor;
    ss_firm(own);
}

static void add_stiffness(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    ss_blocks_clear(evener->K);
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const ss_spring *spring = &sheet->springs[i];
        double k = spring->square > 0 ? evener->paint[spring->edge] : 0,
               hold = evener->temper.hold * ss_hold_of(evener, spring);
        add_own(evener, spring, 0, k, hold);
        add_own(evener, spring, 1, k, hold);
        add_between(evener, spring, k, hold);
    }
    ss_find_anchors(evener);
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        add_diagonal(evener, v, evener->anchor[v]);
}

/* Copies values; whether that changed any. */
static bool take(double *own, const double *values, int32_t count) {
    bool same = memcmp(own, values, (size_t)count * sizeof *own) == 0;
    memcpy(own, values, (size_t)count * sizeof *own);
    return !same;
}

skinslide_status ss_need_stiffness(ss_evener *evener, const ss_frame *frame, const double *weight, const double *hold,
                                   skinslide_error *error) {
    const ss_patch *patch = evener->sheet->patch;
    bool changed = take(evener->paint, frame->paint, patch->faces.edge_count);
    changed |= take(evener->weight, weight, patch->vertex_count);
    changed |= take(evener->hold, hold, patch->vertex_count);
    if (evener->factored && !changed)
        return SKINSLIDE_OK;
    evener->factored = false;
    add_stiffness(evener);
    if (!ss_blocks_factor(evener->K, frame->stop))
        return ss_fail(error, SKINSLIDE_SINGULAR, "%s: force densities, holds and weights are too far apart to slide with",
                       patch->label);
    evener->factored = true;
    return SKINSLIDE_OK;
}
