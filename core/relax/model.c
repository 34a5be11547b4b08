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

static void add_anchor(ss_relaxer *relaxer, int32_t v) {
    const ss_evener *evener = relaxer->evener;
    int32_t unknown = ss_blocks_unknown(relaxer->blocks, v);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    double a = relaxer->anchor[v], share = evener->anchor[v];
    own[0] += a + share, own[3] += a + share;
    for (int j = 0; j < 2; j++)
        right[j] -= a * (evener->slide[v][j] - relaxer->even[v][j]) +
                    share * (evener->slide[v][j] - evener->weight[v] * evener->whole[v][j]);
    if (evener->weight[v] == 0)
        own[0] = own[3] = right[0] = right[1] = 0;
    ss_firm(own);
}

/* ---- Edges ---- */

typedef struct edge_model {
    double slope[2][2];           /* how each end's unknowns make the edge longer */
    double pull;                  /* the force along the edge, > 0 where it is stretched */
    double more, across, damping; /* stiffness along it beyond that across, across, and of what holds and damps */
    double hold[3];               /* the force of the hold */
} edge_model;

/* x where it is, else 0, smoothly. */
static double positive(double x) {
    return 0.5 * (x + sqrt(x * x + BLUNTNESS * BLUNTNESS));
}

/* From where the first end is to where the second is. */
static void set_pull(const ss_relaxer *relaxer, const ss_frame *frame, int32_t i, double scale_square, edge_model *model) {
    const ss_evener *evener = relaxer->evener;
    const ss_spring *spring = &evener->sheet->springs[i];
    double way[3], slope, k = evener->paint[spring->edge];
    double force = ss_drive(frame->stretch_response, frame->compression_response, evener->stretch[i] - evener->scale, &slope);
    ss_subtract(evener->at[spring->end[1]], evener->at[spring->end[0]], way);
    double square = ss_dot(way, way) + SHORT * SHORT * spring->square * scale_square, length = sqrt(square);
    model->across = k / square * positive(force);
    model->more = k / square * (LEAST_ALONG + positive(slope - force - LEAST_ALONG)) - model->across;
    model->pull = k * force / length;
    for (int end = 0; end < 2; end++)
        for (int j = 0; j < 2; j++)
            model->slope[end][j] = (end ? 1 : -1) * ss_dot(way, relaxer->axis[spring->end[end]][j]) / length;
}

static void set_hold(const ss_relaxer *relaxer, int32_t i, edge_model *model) {
    const ss_evener *evener = relaxer->evener;
    const ss_spring *spring = &evener->sheet->springs[i];
    double hold = evener->bond[i];
    model->damping = (HOLD + DAMPING) * hold;
    for (int end = 0; end < 2; end++)
        for (int j = 0; j < 2; j++)
            ss_add((end ? HOLD : -HOLD) * hold * evener->slide[spring->end[end]][j],
                   evener->sheet->tangent[spring->end[end]][j], model->hold);
}

static void add_own(ss_relaxer *relaxer, const ss_spring *spring, int end, const edge_model *model) {
    int32_t v = spring->end[end], unknown = ss_blocks_unknown(relaxer->blocks, v);
    if (relaxer->evener->weight[v] == 0)
        return;
    const double(*axis)[3] = (const double(*)[3])relaxer->axis[v];
    const double(*tangent)[3] = (const double(*)[3])relaxer->evener->sheet->tangent[v], *slope = model->slope[end];
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    for (int i = 0; i < 2; i++) {
        right[i] -= model->pull * slope[i] + (end ? 1 : -1) * ss_dot(tangent[i], model->hold);
        for (int j = 0; j < 2; j++)
            own[2 * i + j] += model->more * slope[i] * slope[j] + model->across * ss_dot(axis[i], axis[j]) +
                              model->damping * ss_dot(tangent[i], tangent[j]);
    }
}

static void add_between(ss_relaxer *relaxer, const ss_spring *spring, const edge_model *model) {
    const ss_evener *evener = relaxer->evener;
    const int32_t *v = spring->end;
    bool first_is_row;
    if (evener->weight[v[0]] == 0 || evener->weight[v[1]] == 0)
        return;
    double *between = ss_blocks_between(relaxer->blocks, spring->edge, &first_is_row);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            between[first_is_row ? 2 * i + j : 2 * j + i] =
                model->more * model->slope[0][i] * model->slope[1][j] -
                model->across * ss_dot(relaxer->axis[v[0]][i], relaxer->axis[v[1]][j]) -
                model->damping * ss_dot(evener->sheet->tangent[v[0]][i], evener->sheet->tangent[v[1]][j]);
}

void ss_fill_model(ss_relaxer *relaxer, const ss_frame *frame) {
    const ss_sheet *sheet = relaxer->evener->sheet;
    double scale_square = ss_exp(2 * relaxer->evener->scale);
    ss_blocks_clear(relaxer->blocks);
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const ss_spring *spring = &sheet->springs[i];
        edge_model model = {0};
        if (spring->square > 0)
            set_pull(relaxer, frame, i, scale_square, &model);
        set_hold(relaxer, i, &model);
        add_own(relaxer, spring, 0, &model);
        add_own(relaxer, spring, 1, &model);
        add_between(relaxer, spring, &model);
    }
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        add_anchor(relaxer, v);
}
