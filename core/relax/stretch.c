/* The energy of a relaxed slide and its quadratic models:
 *
 *     E = sum of k log^2(l / rest l) + hold k |s|^2 / d^2
 *
 * over edges, k the painted force density, l the distance of the edge's ends, d its length in the chart, s the difference of
 * their slides there. The second term is small: edges of quads alone leave shear free. With t the edge's direction and
 * z = log(l / rest l) the Hessian of log^2 for one end is
 *
 *     2 / l^2 ((1 - z) t t' + z (1 - t t'))
 *
 * of which the model keeps what is positive, and of t t' a fifth at least. */
#include "relax.h"

#define HOLD        0.003
#define DAMPING     0.05 /* of a step, as the hold: of a share of every edge's own stiffness */
#define LEAST_ALONG 0.2
#define BLUNTNESS   0.05 /* of where what is kept begins */

/* Edges between two fixed vertices never change, and are left out. */
static bool counts(const ss_patch *patch, int32_t edge) {
    return !patch->fixed[patch->edge_vertex[edge][0]] || !patch->fixed[patch->edge_vertex[edge][1]];
}

/* From the first end to the second. */
static double edge_vector(const ss_relaxer *relaxer, int32_t edge, double out[3]) {
    const ss_patch *patch = relaxer->chart->patch;
    ss_subtract(relaxer->at[patch->edge_vertex[edge][1]], relaxer->at[patch->edge_vertex[edge][0]], out);
    double length = ss_length(out);
    return length < patch->shortest ? patch->shortest : length;
}

double ss_stretch_energy(const ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->chart->patch;
    double sum = 0, vector[3];
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double stretch = log(edge_vector(relaxer, e, vector) / patch->rest_length[e]);
        sum += counts(patch, e) ? relaxer->paint[e] * stretch * stretch : 0;
    }
    return sum;
}

/* ---- The models, halved throughout ---- */

typedef struct edge_model {
    double pull;         /* the force along the edge, > 0 where it is stretched */
    double slope[2][2];  /* of each end along its unknowns: how they make the edge longer, the first end's with its sign */
    double more, across; /* stiffness along the edge beyond that across it */
    double spring;       /* of the hold and the damping */
    double hold[2];      /* the force of the hold */
} edge_model;

static void set_springs(const ss_relaxer *relaxer, int32_t edge, edge_model *model) {
    const int32_t *v = relaxer->chart->patch->edge_vertex[edge];
    const double(*uv)[2] = (const double(*)[2])relaxer->uv, (*own)[2] = relaxer->chart->uv;
    double spring = relaxer->paint[edge] * relaxer->chart->inverse_square[edge];
    model->spring = (HOLD + DAMPING) * spring;
    for (int k = 0; k < 2; k++)
        model->hold[k] = HOLD * spring * ((uv[v[1]][k] - uv[v[0]][k]) - (own[v[1]][k] - own[v[0]][k]));
}

/* x where it is, else 0, smoothly. */
static double positive(double x) {
    return 0.5 * (x + sqrt(x * x + BLUNTNESS * BLUNTNESS));
}

static edge_model model_edge(const ss_relaxer *relaxer, int32_t edge) {
    const ss_patch *patch = relaxer->chart->patch;
    edge_model model;
    double vector[3], weight = relaxer->paint[edge], length = edge_vector(relaxer, edge, vector);
    double stretch = log(length / patch->rest_length[edge]), stiff = weight / (length * length);
    model.across = stiff * positive(stretch);
    model.more = stiff * (LEAST_ALONG + positive(1 - stretch - LEAST_ALONG)) - model.across;
    model.pull = weight * stretch / length;
    for (int end = 0; end < 2; end++)
        for (int j = 0; j < 2; j++)
            model.slope[end][j] = (end ? 1 : -1) * ss_dot(vector, relaxer->axis[patch->edge_vertex[edge][end]][j]) / length;
    set_springs(relaxer, edge, &model);
    return model;
}

static edge_model model_rest_edge(const ss_relaxer *relaxer, int32_t edge) {
    const ss_patch *patch = relaxer->chart->patch;
    edge_model model;
    double vector[3], weight = relaxer->paint[edge];
    model.across = 0, model.more = weight;
    model.pull = weight * log(edge_vector(relaxer, edge, vector) / patch->rest_length[edge]);
    for (int end = 0; end < 2; end++)
        for (int j = 0; j < 2; j++) {
            const double *way = relaxer->way[patch->edge_vertex[edge][end]][j], *slope = relaxer->chart->slope[edge][end];
            model.slope[end][j] = (end ? 1 : -1) * (way[0] * slope[0] + way[1] * slope[1]);
        }
    set_springs(relaxer, edge, &model);
    model.spring = HOLD * weight * relaxer->chart->inverse_square[edge];
    return model;
}

static double way_dot(const double a[2], const double b[2]) {
    return a[0] * b[0] + a[1] * b[1];
}

static void add_forces(const ss_relaxer *relaxer, ss_blocks *blocks, int32_t edge, const edge_model *model) {
    for (int end = 0; end < 2; end++) {
        int32_t v = relaxer->chart->patch->edge_vertex[edge][end], unknown = ss_blocks_unknown(blocks, v);
        for (int j = 0; j < 2 && unknown >= 0; j++)
            blocks->right[unknown][j] -=
                model->pull * model->slope[end][j] + (end ? 1 : -1) * way_dot(relaxer->way[v][j], model->hold);
    }
}

static void add_own(const ss_relaxer *relaxer, ss_blocks *blocks, int32_t vertex, int end, const edge_model *model) {
    const double(*axis)[3] = (const double(*)[3])relaxer->axis[vertex], (*way)[2] = (const double(*)[2])relaxer->way[vertex];
    const double *slope = model->slope[end];
    int32_t unknown = ss_blocks_unknown(blocks, vertex);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(blocks, unknown);
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 2; k++)
            own[2 * j + k] += model->more * slope[j] * slope[k] + model->across * ss_dot(axis[j], axis[k]) +
                              model->spring * way_dot(way[j], way[k]);
}

static void add_stiffness(const ss_relaxer *relaxer, ss_blocks *blocks, int32_t edge, const edge_model *model) {
    const int32_t *v = relaxer->chart->patch->edge_vertex[edge];
    bool first_is_row;
    add_own(relaxer, blocks, v[0], 0, model);
    add_own(relaxer, blocks, v[1], 1, model);
    if (ss_blocks_unknown(blocks, v[0]) < 0 || ss_blocks_unknown(blocks, v[1]) < 0)
        return;
    double *between = ss_blocks_between(blocks, edge, &first_is_row);
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 2; k++)
            between[first_is_row ? 2 * j + k : 2 * k + j] =
                model->more * model->slope[0][j] * model->slope[1][k] -
                model->across * ss_dot(relaxer->axis[v[0]][j], relaxer->axis[v[1]][k]) -
                model->spring * way_dot(relaxer->way[v[0]][j], relaxer->way[v[1]][k]);
}

void ss_stretch_model(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->chart->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        if (!counts(patch, e))
            continue;
        edge_model model = model_edge(relaxer, e);
        add_stiffness(relaxer, relaxer->blocks, e, &model);
        add_forces(relaxer, relaxer->blocks, e, &model);
    }
}

void ss_rest_stiffness(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->chart->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        edge_model model = model_rest_edge(relaxer, e);
        if (counts(patch, e))
            add_stiffness(relaxer, relaxer->rest, e, &model);
    }
}

void ss_rest_forces(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->chart->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        edge_model model = model_rest_edge(relaxer, e);
        if (counts(patch, e))
            add_forces(relaxer, relaxer->rest, e, &model);
    }
}
