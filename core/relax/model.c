/* The quadratic model of the energy of a relaxed slide, where the vertices are now. With t the direction of an edge, L its
 * length, enlarged if it is short, and f = s(z) its force for k = 1, the Hessian of S is
 *
 *     1 / L^2 ((f' - f) t t' + f (1 - t t'))
 *
 * of which the model keeps the positive parts, and at least LEAST_ALONG of t t'. DAMPING adds to the hold in the matrix, and
 * not in the force. The anchor of a vertex is its crush, see crush.c, times ANCHOR and the sum of k / l^2 over its edges.
 *
 * The constants were chosen together, for little stretch and smooth motion, on twelve shots. At half and at twice of each, this
 * much of the stretch of the example sleeve goes, where it is 45 %, and the examples sleeve and face move this many times as
 * roughly as their caches at quarter frames, where it is 4.6 and 1.0 times:
 *
 *     hold         45 44 %    4.8 5.8    1.6 1.1
 *     damping      45 45 %    4.6 4.7    1.2 1.1
 *     anchor       50 42 %    5.1 5.6    1.1 1.0
 *     least along  45 45 %    4.6 4.6    1.0 1.0
 *     bluntness    45 45 %    4.6 4.6    1.9 1.1
 *     short        49 40 %    5.3 5.6    1.0 1.0 */
#include "relax.h"

#include <string.h>

#define HOLD        0.03 /* in place of eta in `even` */
#define DAMPING     0.05
#define ANCHOR      10.0
#define LEAST_ALONG 0.2
#define BLUNTNESS   0.1 /* over which the positive part bends at 0 */
#define SHORT       0.3 /* of an edge at rest, at the pose's scale; with 0.02 a sleeve moves twice as roughly */

/* ---- Anchors ---- */

void ss_set_anchors(ss_relaxer *relaxer) {
    const ss_evener *evener = relaxer->evener;
    int32_t vertices = evener->sheet->patch->vertex_count;
    memcpy(relaxer->even, evener->slide, (size_t)vertices * sizeof *relaxer->even);
    for (int32_t v = 0; v < vertices; v++)
        relaxer->anchor[v] = ANCHOR * evener->crush[v] * evener->load[v];
}

/* ---- Edges ---- */

enum { AT_ONCE = 256 };

/* For some consecutive edges: the way from the first end to the second, L^2, k, and z less the scale; and the numbers of the
 * model that follow from these. */
typedef struct edge_models {
    double way[AT_ONCE][3], square[AT_ONCE], k[AT_ONCE], z[AT_ONCE];
    double pull[AT_ONCE];                  /* k f / L^2 */
    double more[AT_ONCE], across[AT_ONCE]; /* stiffness along the edge less that across, over L^2; stiffness across */
} edge_models;

static void measure(const ss_relaxer *relaxer, double scale_square, int32_t begin, int32_t count, edge_models *m) {
    const ss_evener *evener = relaxer->evener;
    for (int32_t i = 0; i < count; i++) {
        const ss_spring *spring = &evener->sheet->springs[begin + i];
        bool pulls = spring->square > 0;
        ss_subtract(evener->at[spring->end[1]], evener->at[spring->end[0]], m->way[i]);
        m->square[i] = pulls ? ss_dot(m->way[i], m->way[i]) + SHORT * SHORT * spring->square * scale_square : 1;
        m->k[i] = pulls ? evener->paint[spring->edge] : 0;
        m->z[i] = evener->stretch[begin + i] - evener->scale;
    }
}

/* max(x, 0), smoothed. */
static inline double positive(double x) {
    return 0.5 * (x + sqrt(x * x + BLUNTNESS * BLUNTNESS));
}

static void find_models(double stretch_response, double compression_response, int32_t count, edge_models *m) {
    for (int32_t i = 0; i < count; i++) {
        double slope, force = ss_drive(stretch_response, compression_response, m->z[i], &slope);
        double share = 1 / m->square[i], own = m->k[i] * share, across = own * positive(force);
        m->pull[i] = own * force, m->across[i] = across;
        m->more[i] = (own * (LEAST_ALONG + positive(slope - force - LEAST_ALONG)) - across) * share;
    }
}

/* ---- The blocks ---- */

/* Adds the part of an edge that is one end's own. slope is how L^2 / 2 changes with the end's unknowns, hold what holds it
 * back. */
static inline void add_own(ss_relaxer *relaxer, int32_t unknown, ss_pair slope, double pull, double more, ss_pair hold) {
    ss_pair *own = (ss_pair *)ss_blocks_own(relaxer->blocks, unknown), *right = (ss_pair *)relaxer->blocks->right[unknown];
    *right -= pull * slope + hold;
    for (int i = 0; i < 2; i++)
        own[i] += more * slope[i] * slope;
}

static inline ss_pair slope_of(const ss_relaxer *relaxer, int32_t vertex, const double way[3]) {
    const ss_pair *axis = relaxer->axis[vertex];
    return way[0] * axis[0] + way[1] * axis[1] + way[2] * axis[2];
}

/* A row of the dot products of two vertices' axes. */
static inline ss_pair multiply_axes(const ss_pair a[3], int row, const ss_pair b[3]) {
    return a[0][row] * b[0] + a[1][row] * b[1] + a[2][row] * b[2];
}

/* Adds edge i, which is m's e. across [vertex_count] sums the stiffnesses across the edges at a vertex, for add_vertex. */
static void add_edge(ss_relaxer *relaxer, int32_t i, const edge_models *m, int32_t e, double *across) {
    const ss_evener *evener = relaxer->evener;
    const ss_spring *spring = &evener->sheet->springs[i];
    const int32_t *v = spring->end, moving[2] = {evener->moving[v[0]], evener->moving[v[1]]};
    const ss_pair *slides = (const ss_pair *)evener->slide, first = slides[v[0]], second = slides[v[1]];
    const ss_pair *product = (const ss_pair *)evener->sheet->between[i];
    ss_pair turned[2] = {{product[0][0], product[1][0]}, {product[0][1], product[1][1]}};
    double bond = evener->bond[i];
    ss_pair slope[2] = {-slope_of(relaxer, v[0], m->way[e]), slope_of(relaxer, v[1], m->way[e])};
    ss_pair hold[2] = {first - (second[0] * turned[0] + second[1] * turned[1]),
                       second - (first[0] * product[0] + first[1] * product[1])};
    for (int end = 0; end < 2; end++)
        if (moving[end] >= 0) {
            add_own(relaxer, moving[end], slope[end], m->pull[e], m->more[e], HOLD * bond * hold[end]);
            across[v[end]] += m->across[e];
        }
    if (moving[0] < 0 || moving[1] < 0)
        return;
    int row = moving[0] > moving[1] ? 0 : 1;
    const ss_pair *tangents = row == 0 ? product : turned, *axis = relaxer->axis[v[row]], *other = relaxer->axis[v[1 - row]];
    ss_pair *between = (ss_pair *)relaxer->blocks->between[spring->edge];
    for (int a = 0; a < 2; a++)
        between[a] = m->more[e] * slope[row][a] * slope[1 - row] - (HOLD + DAMPING) * bond * tangents[a] -
                     m->across[e] * multiply_axes(axis, a, other);
}

/* Adds what is not one edge's own: across times the products of the vertex's axes, hold and damping, and the anchors. */
static void add_vertex(ss_relaxer *relaxer, int32_t v, double across) {
    const ss_evener *evener = relaxer->evener;
    int32_t unknown = ss_blocks_unknown(relaxer->blocks, v);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    double a = relaxer->anchor[v], share = evener->anchor[v], damping = (HOLD + DAMPING) * evener->bonds[v];
    for (int i = 0; i < 2 && evener->moving[v] >= 0; i++) {
        const double *slide = evener->slide[v], *tangent = evener->sheet->tangent[v][i];
        ((ss_pair *)own)[i] += across * multiply_axes(relaxer->axis[v], i, relaxer->axis[v]);
        own[3 * i] += damping * ss_dot(tangent, tangent) + a + share;
        right[i] -= a * (slide[i] - relaxer->even[v][i]) + share * (slide[i] - evener->weight[v] * evener->whole[v][i]);
    }
    ss_firm(own);
}

void ss_fill_model(ss_relaxer *relaxer, const ss_frame *frame) {
    const ss_evener *evener = relaxer->evener;
    const ss_sheet *sheet = evener->sheet;
    double scale_square = ss_exp(2 * evener->scale), *across = evener->part;
    edge_models models;
    ss_blocks_clear(relaxer->blocks);
    memset(across, 0, (size_t)sheet->patch->vertex_count * sizeof *across);
    for (int32_t begin = 0; begin < sheet->spring_count; begin += AT_ONCE) {
        int32_t left = sheet->spring_count - begin, count = left < AT_ONCE ? left : AT_ONCE;
        measure(relaxer, scale_square, begin, count, &models);
        find_models(frame->stretch_response, frame->compression_response, count, &models);
        for (int32_t i = 0; i < count; i++)
            add_edge(relaxer, begin + i, &models, i, across);
    }
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        add_vertex(relaxer, v, across[v]);
}
