/* The energy of a relaxed slide and its quadratic model at the places reached:
 *
 *     E = sum of k log^2(l / rest l) + hold k |s|^2 / rest l^2
 *
 * over edges, k the painted force density, l the distance of the edge's ends, s the difference of their slides. The second term
 * is small: edges of quads alone leave shear free, and would let a slide jump from one answer to another in the course of a
 * motion. With t the edge's direction and z = log(l / rest l) the Hessian of log^2 for one end is
 *
 *     2 / l^2 ((1 - z) t t' + z (1 - t t'))
 *
 * of which the model keeps what is positive, and of t t' a fifth at least. */
#include "relax.h"

#define LEAST_ALONG 0.2

/* Edges between two fixed vertices never change, and are left out. */
static bool counts(const ss_patch *patch, int32_t edge) {
    return !patch->fixed[patch->edge_vertex[edge][0]] || !patch->fixed[patch->edge_vertex[edge][1]];
}

static double edge_vector(const ss_patch *patch, const ss_stand *stands, int32_t edge, double out[3]) {
    ss_subtract(stands[patch->edge_vertex[edge][0]].place, stands[patch->edge_vertex[edge][1]].place, out);
    double length = ss_length(out);
    return length < patch->shortest ? patch->shortest : length;
}

/* How much farther the first end of the edge slid than the second. */
static void slide_difference(const ss_relaxer *relaxer, const ss_stand *stands, int32_t edge, double out[3]) {
    const int32_t *v = relaxer->surface->patch->edge_vertex[edge];
    const double(*point)[3] = (const double(*)[3])relaxer->pose.point;
    for (int k = 0; k < 3; k++)
        out[k] = (stands[v[0]].place[k] - stands[v[1]].place[k]) - (point[v[0]][k] - point[v[1]][k]);
}

static double edge_energy(const ss_relaxer *relaxer, const ss_stand *stands, int32_t edge) {
    const ss_patch *patch = relaxer->surface->patch;
    double vector[3], rest = patch->rest_length[edge];
    double stretch = log(edge_vector(patch, stands, edge, vector) / rest), energy = stretch * stretch;
    if (relaxer->hold > 0) {
        slide_difference(relaxer, stands, edge, vector);
        energy += relaxer->hold * ss_dot(vector, vector) / (rest * rest);
    }
    return relaxer->paint[edge] * energy;
}

double ss_stretch_energy(const ss_relaxer *relaxer, const ss_stand *stands) {
    const ss_patch *patch = relaxer->surface->patch;
    double sum = 0;
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        sum += counts(patch, e) ? edge_energy(relaxer, stands, e) : 0;
    return sum;
}

void ss_stretch_by_vertex(const ss_relaxer *relaxer, const ss_stand *stands, double *sums) {
    const ss_patch *patch = relaxer->surface->patch;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        sums[v] = 0;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double energy = counts(patch, e) ? edge_energy(relaxer, stands, e) : 0;
        sums[patch->edge_vertex[e][0]] += energy;
        sums[patch->edge_vertex[e][1]] += energy;
    }
}

/* ---- The model, halved throughout ---- */

typedef struct edge_model {
    double direction[3], pull; /* the force along the edge, > 0 where it is stretched */
    double hold[3];            /* the force of the hold */
    double more, across;       /* stiffness along the edge beyond that across it */
    bool unfold;
} edge_model;

static edge_model model_edge(const ss_relaxer *relaxer, int32_t edge) {
    const ss_patch *patch = relaxer->surface->patch;
    edge_model model;
    double rest = patch->rest_length[edge], weight = relaxer->paint[edge], spring = weight / (rest * rest);
    double length = edge_vector(patch, relaxer->now, edge, model.direction), stretch = log(length / rest);
    double stiff = weight / (length * length);
    model.across = stiff * fmax(stretch, 0) + (relaxer->hold + relaxer->damping) * spring;
    model.more = stiff * (fmax(1 - stretch, LEAST_ALONG) - fmax(stretch, 0));
    model.pull = weight * stretch / length;
    model.unfold = relaxer->pose.manner == SS_BLUNT && stretch < 0;
    slide_difference(relaxer, relaxer->now, edge, model.hold);
    for (int k = 0; k < 3; k++) {
        model.direction[k] /= length;
        model.hold[k] *= relaxer->hold * spring;
    }
    return model;
}

/* How the edge's direction lies in the axes of an end. Across a closed crease it points through the air, at right angles to
 * both planes: to unfold it is taken for the direction in the plane that is nearest. */
static void find_slope(const edge_model *model, const double (*axis)[3], double slope[2]) {
    for (int j = 0; j < 2; j++)
        slope[j] = ss_dot(axis[j], model->direction);
    double size = sqrt(slope[0] * slope[0] + slope[1] * slope[1]);
    for (int j = 0; j < 2 && model->unfold && size > 1e-3; j++)
        slope[j] /= size;
}

/* One end of an edge: its own block and its slope; sign is 1 at the first end. */
static void add_end(ss_relaxer *relaxer, int32_t unknown, const double (*axis)[3], const edge_model *model, double sign,
                    double slope[2]) {
    double *own = ss_blocks_own(relaxer->blocks, unknown), *right = relaxer->blocks->right[unknown];
    find_slope(model, axis, slope);
    for (int j = 0; j < 2; j++) {
        right[j] -= sign * (model->pull * slope[j] + ss_dot(axis[j], model->hold));
        for (int k = 0; k < 2; k++)
            own[2 * j + k] += model->more * slope[j] * slope[k] + (j == k ? model->across : 0);
    }
}

static void add_edge(ss_relaxer *relaxer, int32_t edge) {
    const int32_t *v = relaxer->surface->patch->edge_vertex[edge];
    int32_t a = ss_blocks_unknown(relaxer->blocks, v[0]), b = ss_blocks_unknown(relaxer->blocks, v[1]);
    const double(*first)[3] = (const double(*)[3])relaxer->axis[v[0]], (*second)[3] = (const double(*)[3])relaxer->axis[v[1]];
    edge_model model = model_edge(relaxer, edge);
    double slope[2][2];
    bool first_is_row;
    if (a >= 0)
        add_end(relaxer, a, first, &model, 1, slope[0]);
    if (b >= 0)
        add_end(relaxer, b, second, &model, -1, slope[1]);
    if (a < 0 || b < 0)
        return;
    double *between = ss_blocks_between(relaxer->blocks, edge, &first_is_row);
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 2; k++)
            between[first_is_row ? 2 * j + k : 2 * k + j] =
                -model.more * slope[0][j] * slope[1][k] - model.across * ss_dot(first[j], second[k]);
}

void ss_stretch_model(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->surface->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        if (counts(patch, e))
            add_edge(relaxer, e);
}
