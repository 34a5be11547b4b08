/* The quadratic model of the energy of a relaxed slide where vertices are. With t the direction of an edge, L its length, blunted
 * where it is short, and f = s(z) its force for k = 1, the Hessian of S is
 *
 *     1 / L^2 ((f' - f) t t' + f (1 - t t'))
 *
 * of which the model keeps what is positive, and of t t' a fifth at least. The matrix alone has DAMPING more of what holds. The
 * anchor of a vertex is its crush, as even.h has it, times ANCHOR and the sum of k / l^2 over its edges. */
#include "relax.h"

#include <string.h>

#define HOLD        0.03 /* where even has eta */
#define DAMPING     0.05
#define ANCHOR      10.0
#define LEAST_ALONG 0.2
#define BLUNTNESS   0.1 /* of where what is kept begins */
#define SHORT       0.3 /* of an edge at rest, as the pose is scaled: shorter ones do not pull harder for it */

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

/* Some edges, from one on: where the second end is from the first, L^2, k, and z over the scale; and what of the model comes of
 * those alone. */
typedef struct edge_models {
    double way[AT_ONCE][3], square[AT_ONCE], k[AT_ONCE], z[AT_ONCE];
    double pull[AT_ONCE];                  /* k f / L^2 */
    double more[AT_ONCE], across[AT_ONCE]; /* stiffness along it beyond that across, over L^2, and across */
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

/* x where it is, else 0, smoothly. */
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

static void add_own(ss_relaxer *relaxer, int32_t unknown, const double slope[2], double pull, double more,
                    const double hold[2]) {
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    for (int i = 0; i < 2; i++) {
        right[i] -= pull * slope[i] + hold[i];
        for (int j = 0; j < 2; j++)
            own[2 * i + j] += more * slope[i] * slope[j];
    }
}

/* Edge i, which is m's e. across [vertex_count] sums what is to be taken times products of a vertex's own axes. */
static void add_edge(ss_relaxer *relaxer, int32_t i, const edge_models *m, int32_t e, double *across) {
    const ss_evener *evener = relaxer->evener;
    const ss_spring *spring = &evener->sheet->springs[i];
    const int32_t *v = spring->end, moving[2] = {evener->moving[v[0]], evener->moving[v[1]]};
    const double(*product)[2] = (const double(*)[2])evener->sheet->between[i];
    const double *first = evener->slide[v[0]], *second = evener->slide[v[1]], bond = evener->bond[i];
    double slope[2][2], hold[2][2];
    for (int j = 0; j < 2; j++) {
        slope[0][j] = -ss_dot(m->way[e], relaxer->axis[v[0]][j]), slope[1][j] = ss_dot(m->way[e], relaxer->axis[v[1]][j]);
        hold[0][j] = HOLD * bond * (first[j] - (product[j][0] * second[0] + product[j][1] * second[1]));
        hold[1][j] = HOLD * bond * (second[j] - (product[0][j] * first[0] + product[1][j] * first[1]));
    }
    for (int end = 0; end < 2; end++)
        if (moving[end] >= 0) {
            add_own(relaxer, moving[end], slope[end], m->pull[e], m->more[e], hold[end]);
            across[v[end]] += m->across[e];
        }
    if (moving[0] < 0 || moving[1] < 0)
        return;
    bool first_is_row = moving[0] > moving[1];
    double *between = relaxer->blocks->between[spring->edge];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            between[first_is_row ? 2 * a + b : 2 * b + a] =
                m->more[e] * slope[0][a] * slope[1][b] - (HOLD + DAMPING) * bond * product[a][b] -
                m->across[e] * ss_dot(relaxer->axis[v[0]][a], relaxer->axis[v[1]][b]);
}

/* What of a vertex is not of one edge: products of its axes, what holds and damps it, and its anchors. */
static void add_vertex(ss_relaxer *relaxer, int32_t v, double across) {
    const ss_evener *evener = relaxer->evener;
    int32_t unknown = ss_blocks_unknown(relaxer->blocks, v);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    double a = relaxer->anchor[v], share = evener->anchor[v], damping = (HOLD + DAMPING) * evener->bonds[v];
    for (int i = 0; i < 2 && evener->moving[v] >= 0; i++) {
        const double *slide = evener->slide[v], *tangent = evener->sheet->tangent[v][i];
        for (int j = 0; j < 2; j++)
            own[2 * i + j] += across * ss_dot(relaxer->axis[v][i], relaxer->axis[v][j]);
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
