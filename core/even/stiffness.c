/* Makes and factors K = J' k J + eta B, in blocks of two by two, with
 *
 *     d' B d = sum of k |D_b - D_a|^2 / l^2     over edges of length l at rest, D the slides in space
 *
 * and eta times the mean hold of the two ends; added are the springs of weights, see weights.c. Each unknown is held in place
 * by FIRMNESS times all that acts on it, so that K, rounded as it is, is positive definite even if nothing else holds skin, and
 * however much densities, holds and weights differ. A vertex of no weight keeps its unknowns, which come to 0. */
#include "even.h"

#include <string.h>

/* eta. Without crush.c, so little would be too rough. At half and at twice of it, `even` takes 50 and 31 % of the stretch of
 * the example sleeve away, where it is 39 %, and moves it 11.4 and 3.5 times as roughly as its cache, where it is 6.1 times. */
#define HOLD     0.05
#define TIE      1e6   /* an edge without length ties its ends like one of a thousandth of the mean edge */
#define FIRMNESS 1e-10 /* far above rounding, and far below what holds a closed skin of a million faces */

/* ---- What the springs are ---- */

static void list_moving(ss_evener *evener) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        evener->moving[v] = evener->weight[v] > 0 ? ss_blocks_unknown(evener->K, v) : -1;
}

static void list_bonds(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    double edge = sheet->patch->mean_edge;
    memset(evener->bonds, 0, (size_t)sheet->patch->vertex_count * sizeof *evener->bonds);
    memset(evener->load, 0, (size_t)sheet->patch->vertex_count * sizeof *evener->load);
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const ss_spring *spring = &sheet->springs[i];
        const int32_t *v = spring->end;
        bool pulls = spring->square > 0;
        double k = evener->paint[spring->edge], own = pulls ? k / spring->square : TIE * k / (edge * edge);
        evener->bond[i] = 0.5 * (evener->hold[v[0]] + evener->hold[v[1]]) * own;
        evener->bonds[v[0]] += evener->bond[i], evener->bonds[v[1]] += evener->bond[i];
        if (pulls)
            evener->load[v[0]] += own, evener->load[v[1]] += own;
    }
}

/* ---- The matrix ---- */

static void add_own(ss_evener *evener, int32_t unknown, ss_pair slope, double k) {
    ss_pair *own = (ss_pair *)ss_blocks_own(evener->K, unknown);
    for (int i = 0; i < 2; i++)
        own[i] += k * slope[i] * slope;
}

static void add_between(ss_evener *evener, int32_t i, double k, double hold) {
    const ss_spring *spring = &evener->sheet->springs[i];
    double product[2][2];
    bool first_is_row;
    ss_multiply_tangents(evener->sheet, spring, product);
    double *between = ss_blocks_between(evener->K, spring->edge, &first_is_row);
    int row = first_is_row ? 2 : 1, column = 3 - row;
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            between[row * a + column * b] = k * spring->slope[0][a] * spring->slope[1][b] - hold * product[a][b];
}

static void add_spring(ss_evener *evener, int32_t i) {
    const ss_spring *spring = &evener->sheet->springs[i];
    double k = spring->square > 0 ? evener->paint[spring->edge] : 0;
    const int32_t moving[2] = {evener->moving[spring->end[0]], evener->moving[spring->end[1]]};
    for (int end = 0; end < 2; end++)
        if (moving[end] >= 0)
            add_own(evener, moving[end], (ss_pair){spring->slope[end][0], spring->slope[end][1]}, k);
    if (moving[0] >= 0 && moving[1] >= 0)
        add_between(evener, i, k, HOLD * evener->bond[i]);
}

void ss_firm(double own[4]) {
    for (int i = 0; i < 4; i += 3)
        own[i] = own[i] > 0 ? (1 + FIRMNESS) * own[i] : 1;
}

/* The two tangents at a vertex are at right angles, and of length 1, but on a loop the second is 0. */
static void add_diagonal(ss_evener *evener, int32_t v) {
    int32_t unknown = ss_blocks_unknown(evener->K, v);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(evener->K, unknown), hold = HOLD * evener->bonds[v];
    for (int j = 0; j < 2 && evener->moving[v] >= 0; j++)
        own[3 * j] += hold * ss_dot(evener->sheet->tangent[v][j], evener->sheet->tangent[v][j]) + evener->anchor[v];
    ss_firm(own);
}

static void add_stiffness(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    ss_blocks_clear(evener->K);
    for (int32_t i = 0; i < sheet->spring_count; i++)
        add_spring(evener, i);
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        add_diagonal(evener, v);
}

/* Copies values into own. Returns whether that changed any. */
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
    if (changed || !evener->factored || evener->bonds_needed) {
        list_moving(evener);
        list_bonds(evener);
        ss_find_anchors(evener);
    }
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
