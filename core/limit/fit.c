/* The least squares of interpolation LIMIT: moves free vertices by y from their linear places, so that samples of the surface,
 * which move by L y, come to their planes while edges stay as linear made them. y minimises
 *
 *     E(y) = sum (L y - r)'N (L y - r) + s sum ((|e| - |e0|)^2 + t |e - e0|^2)      s = 0.023, t = 0.05
 *          samples                     edges
 *
 *     N = nn' + b (1 - n.n)^2                                                        b = 0.3
 *
 * where an edge is e0 in the linear result and e = e0 + D y after, D the edge-vertex incidence. Samples may slip within their
 * planes, as they must with a coarse cage; where in the plane is up to the edges, by their length and a little by their
 * direction. Without edges the surface would be nearer, but skin more stretched: the stiffer they are, the less of both. The
 * shorter n, see crumple.c, the more a sample is held at the point looked up, which lies on the surface and moves smoothly even
 * where normals spin. b was chosen for that, on seven examples.
 *
 * Gauss-Newton, each step by conjugate gradients on
 *
 *     (L'NL + s D'(uu' + t) D) x = -grad E / 2                                u = e / |e|
 *
 * whose matrix differs from frame to frame. The preconditioner does not: it is factored once for a shot, from matrices of
 * numbers. It splits the move of a vertex into that across and that along the plane of its own sample. The normal m of that
 * plane is n, lengthened to nearly a unit: with n itself, a little of each would count as the other.
 *
 *     m (L'L + s t D'D)^-1 m' + (1 - mm') (s (1/2 + t) D'D + C)^-1 (1 - mm')      1/2 the mean of uu' in the plane
 *
 * The first matrix is nearly a mass matrix, and is factored incompletely. On a rim, as of lips, normals turn from one vertex to
 * the next, so that the samples around hold a vertex along its plane too. C, which is diagonal, is how much they do so at rest,
 * with rows of L'NL summed: for a vertex half the sum of L (1 - (n.n of its own sample)^2). Without it the first step
 * overshoots on rims, and all others are spent on undoing that.
 *
 * If no vertex is held, as on a closed patch, D'D would let all of them move together: then 4 pi / n times its stiffness is
 * added at each of the n vertices, which is what D'D has for the longest waves of a sphere.
 *
 * The number of steps is fixed, so that the time is known and neighbouring frames are solved alike. */
#include "base.h"
#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double edge_stiffness = 0.023;     /* s */
static const double direction_stiffness = 0.05; /* t */
static const double all_ways_stiffness = 0.3;   /* b */
enum { GAUSS_NEWTON_STEPS = 2, GRADIENT_STEPS = 5 };

/* x, y, z and 0, in vectors that every processor has: pairs of doubles where the model is made, floats in conjugate gradients,
 * in units of the gradient's largest. What floats lose, the next step of Gauss-Newton mends. */
typedef double pair __attribute__((vector_size(16)));
typedef struct vector {
    pair xy, z;
} vector;
typedef float single __attribute__((vector_size(16)));

/* An edge with a free end. */
typedef struct edge {
    int32_t mesh_vertex[2];
    int32_t end[2]; /* places in free_vertex, free_count if held */
} edge;

/* The weight of a vertex in a term: a sample or, numbered after those, an edge. */
typedef struct share {
    int32_t term;
    float weight;
} share;

struct ss_fit {
    ss_memory memory;
    int32_t free_count, edge_count;
    const ss_rows *samples; /* L */
    float *sample_weight;   /* the values of samples */
    edge *edges;            /* [edge_count] */
    int32_t *share_start;   /* [free_count + 1] the rows of L' and D' begin in shares */
    share *shares;
    double *share_weight; /* of each share, in double */
    int32_t *unknown;     /* [free_count] the free vertex's unknown in along */
    ss_incomplete *across;
    ss_springs *along;
};

/* Arrays of free vertices have one vertex more, which stands for all that are held: it is 0. */
struct ss_fit_work {
    ss_memory memory;
    const ss_fit *fit;
    const int *stop;          /* set if the frame is not wanted any more */
    vector *up;               /* [sample count] n ... */
    float *all_ways;          /* [sample count] ... and b (1 - n.n)^2 */
    vector *residual;         /* [sample count] r */
    vector *linear;           /* [edge_count] e0 */
    vector *direction;        /* [edge_count] u */
    double *excess;           /* [edge_count] |e| - |e0| */
    vector *force;            /* [sample count + edge_count] of each term */
    vector *offset;           /* [free_count + 1] y */
    vector *slope;            /* [free_count + 1] -grad E / 2 */
    single *single_up;        /* [sample count] n */
    single *single_across;    /* [free_count] m */
    single *single_direction; /* [edge_count] u */
    single *single_force;     /* [sample count + edge_count] */
    single *gradient;         /* [free_count + 1] what y leaves of slope */
    single *scaled;           /* [free_count + 1] gradient, preconditioned */
    single *search;           /* [free_count + 1] a direction of conjugate gradients ... */
    single *image;            /* [free_count + 1] ... and its product with the matrix */
    float *across;            /* [free_count] right sides */
    single *along;            /* [free_count] right sides, by unknown */
    single *scratch;          /* for ss_springs_solve */
};

/* ---- Creation ---- */

static void list_edges(const ss_patch *patch, const int32_t *free_index, ss_fit *fit) {
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        edge own = {{patch->mesh_vertex[v[0]], patch->mesh_vertex[v[1]]}, {free_index[v[0]], free_index[v[1]]}};
        for (int side = 0; side < 2; side++)
            if (own.end[side] < 0)
                own.end[side] = fit->free_count;
        if (own.end[0] < fit->free_count || own.end[1] < fit->free_count)
            fit->edges[fit->edge_count++] = own;
    }
}

/* Adds a share; in the first pass, only counts it. */
static void add_share(ss_fit *fit, bool count, int32_t vertex, int32_t term, double weight) {
    if (vertex == fit->free_count)
        return;
    if (count)
        fit->share_start[vertex]++;
    else {
        int32_t place = --fit->share_start[vertex];
        fit->shares[place] = (share){term, (float)weight}, fit->share_weight[place] = weight;
    }
}

static void list_shares(ss_fit *fit, bool count) {
    const ss_rows *samples = fit->samples;
    for (int32_t e = fit->edge_count - 1; e >= 0; e--)
        for (int side = 0; side < 2; side++)
            add_share(fit, count, fit->edges[e].end[side], samples->row_count + e, side ? 1 : -1);
    for (int32_t s = samples->row_count - 1; s >= 0; s--)
        for (int32_t k = samples->start[s]; k < samples->start[s + 1]; k++)
            add_share(fit, count, samples->column[k], s, samples->value[k]);
}

/* Appends the rows of D, times weight. */
static void append_edges(const ss_fit *fit, double weight, ss_rows *rows) {
    int32_t end = rows->start[rows->row_count];
    for (int32_t e = 0; e < fit->edge_count; e++) {
        for (int side = 0; side < 2; side++)
            if (fit->edges[e].end[side] < fit->free_count)
                rows->column[end] = fit->edges[e].end[side], rows->value[end++] = side ? weight : -weight;
        rows->start[++rows->row_count] = end;
    }
}

static void append_samples(const ss_rows *samples, ss_rows *rows) {
    size_t entries = (size_t)samples->start[samples->row_count];
    memcpy(rows->start, samples->start, ((size_t)samples->row_count + 1) * sizeof *rows->start);
    memcpy(rows->column, samples->column, entries * sizeof *rows->column);
    memcpy(rows->value, samples->value, entries * sizeof *rows->value);
    rows->row_count = samples->row_count;
}

/* L'L + s t D'D */
static skinslide_status factor_across(ss_fit *fit, const char *label, skinslide_error *error) {
    const ss_rows *samples = fit->samples;
    int64_t row_count = (int64_t)fit->edge_count + samples->row_count;
    int64_t entries = 2 * (int64_t)fit->edge_count + samples->start[samples->row_count];
    if (row_count > INT32_MAX || entries > INT32_MAX)
        return ss_refuse_large(label, error);
    ss_memory scratch = {0};
    ss_rows rows = {.column_count = fit->free_count};
    rows.start = SS_NEW(&scratch, int32_t, row_count + 1);
    rows.column = SS_NEW(&scratch, int32_t, entries);
    rows.value = SS_NEW(&scratch, double, entries);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        append_samples(samples, &rows);
        append_edges(fit, sqrt(edge_stiffness * direction_stiffness), &rows);
        status = ss_incomplete_create(&rows, label, &fit->across, error);
    }
    ss_free(&scratch);
    return status;
}

/* C of a free vertex. */
static double turn_around(const ss_fit *fit, int32_t i, const double (*normal)[3]) {
    double sum = 0;
    for (int32_t k = fit->share_start[i]; k < fit->share_start[i + 1]; k++) {
        int32_t s = fit->shares[k].term;
        double cosine = s < fit->samples->row_count ? ss_dot(normal[s], normal[i]) : 1;
        sum += 0.5 * fabs(fit->share_weight[k]) * (1 - cosine * cosine);
    }
    return sum;
}

/* s (1/2 + t) D'D + C, and more if no vertex is held. */
static skinslide_status factor_along(ss_fit *fit, const ss_patch *patch, const double (*normal)[3], skinslide_error *error) {
    ss_memory scratch = {0};
    ss_net net = ss_net_of(patch, patch->fixed);
    double stiffness = edge_stiffness * (0.5 + direction_stiffness), *own = SS_NEW(&scratch, double, patch->vertex_count);
    double least = patch->free_count < patch->vertex_count ? 0 : 4 * SS_PI / patch->free_count * stiffness;
    for (int32_t i = 0; i < fit->free_count && own; i++)
        own[patch->free_vertex[i]] = least + ss_most(turn_around(fit, i, normal), 0);
    skinslide_status status =
        own ? ss_springs_create(&net, patch->label, stiffness, own, &fit->along, error) : ss_out_of_memory(error);
    for (int32_t i = 0; i < fit->free_count && !status; i++)
        fit->unknown[i] = ss_springs_unknown(fit->along, patch->free_vertex[i]);
    ss_free(&scratch);
    return status;
}

static skinslide_status list_terms(ss_fit *fit, const ss_patch *patch, const int32_t *free_index, skinslide_error *error) {
    ss_memory *memory = &fit->memory;
    fit->edges = SS_NEW(memory, edge, patch->faces.edge_count);
    fit->unknown = SS_NEW(memory, int32_t, fit->free_count);
    fit->share_start = SS_NEW(memory, int32_t, (int64_t)fit->free_count + 1);
    fit->sample_weight = SS_NEW(memory, float, fit->samples->start[fit->samples->row_count]);
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t k = 0; k < fit->samples->start[fit->samples->row_count]; k++)
        fit->sample_weight[k] = (float)fit->samples->value[k];
    list_edges(patch, free_index, fit);
    list_shares(fit, true);
    for (int32_t i = 0; i < fit->free_count; i++)
        fit->share_start[i + 1] += fit->share_start[i];
    fit->shares = SS_NEW(memory, share, fit->share_start[fit->free_count]);
    fit->share_weight = SS_NEW(memory, double, fit->share_start[fit->free_count]);
    if (memory->failed)
        return ss_out_of_memory(error);
    list_shares(fit, false);
    return SKINSLIDE_OK;
}

skinslide_status ss_fit_create(const ss_patch *patch, const int32_t *free_index, const ss_rows *samples,
                               const double (*normal)[3], ss_fit **out, skinslide_error *error) {
    ss_fit *fit = calloc(1, sizeof *fit);
    if (!fit)
        return ss_out_of_memory(error);
    fit->free_count = patch->free_count, fit->samples = samples;
    skinslide_status status = list_terms(fit, patch, free_index, error);
    if (!status)
        status = factor_across(fit, patch->label, error);
    if (!status)
        status = factor_along(fit, patch, normal, error);
    if (status)
        ss_fit_destroy(fit);
    else
        *out = fit;
    return status;
}

void ss_fit_destroy(ss_fit *fit) {
    if (!fit)
        return;
    ss_incomplete_destroy(fit->across);
    ss_springs_destroy(fit->along);
    ss_free(&fit->memory);
    free(fit);
}

static void new_arrays(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    ss_memory *memory = &work->memory;
    int64_t samples = fit->samples->row_count, vertices = (int64_t)fit->free_count + 1;
    work->up = SS_NEW(memory, vector, samples);
    work->all_ways = SS_NEW(memory, float, samples);
    work->residual = SS_NEW(memory, vector, samples);
    work->linear = SS_NEW(memory, vector, fit->edge_count);
    work->direction = SS_NEW(memory, vector, fit->edge_count);
    work->excess = SS_NEW(memory, double, fit->edge_count);
    work->force = SS_NEW(memory, vector, samples + fit->edge_count);
    work->offset = SS_NEW(memory, vector, vertices);
    work->slope = SS_NEW(memory, vector, vertices);
    work->single_up = SS_NEW(memory, single, samples);
    work->single_across = SS_NEW(memory, single, fit->free_count);
    work->single_direction = SS_NEW(memory, single, fit->edge_count);
    work->single_force = SS_NEW(memory, single, samples + fit->edge_count);
    work->gradient = SS_NEW(memory, single, vertices);
    work->scaled = SS_NEW(memory, single, vertices);
    work->search = SS_NEW(memory, single, vertices);
    work->image = SS_NEW(memory, single, vertices);
    work->across = SS_NEW(memory, float, fit->free_count);
    work->along = SS_NEW(memory, single, fit->free_count);
    work->scratch = SS_NEW(memory, single, ss_springs_scratch(fit->along));
}

skinslide_status ss_fit_work_create(const ss_fit *fit, ss_fit_work **out, skinslide_error *error) {
    ss_fit_work *work = calloc(1, sizeof *work);
    if (!work)
        return ss_out_of_memory(error);
    work->fit = fit;
    new_arrays(work);
    if (work->memory.failed) {
        ss_fit_work_destroy(work);
        return ss_out_of_memory(error);
    }
    *out = work;
    return SKINSLIDE_OK;
}

void ss_fit_work_destroy(ss_fit_work *work) {
    if (!work)
        return;
    ss_free(&work->memory);
    free(work);
}

/* ---- Vectors ---- */

static inline vector make(double x, double y, double z) {
    return (vector){{x, y}, {z, 0}};
}

/* sum += factor a */
static inline void add(vector *sum, double factor, const vector *a) {
    sum->xy += factor * a->xy, sum->z += factor * a->z;
}

static inline vector scale(double factor, const vector *a) {
    return (vector){factor * a->xy, factor * a->z};
}

static inline vector subtract(const vector *a, const vector *b) {
    return (vector){a->xy - b->xy, a->z - b->z};
}

static inline double dot(const vector *a, const vector *b) {
    pair product = a->xy * b->xy;
    return product[0] + product[1] + a->z[0] * b->z[0];
}

/* ---- Rows of L and D, and of L' and D' ---- */

static inline vector take_sample(const ss_rows *rows, int32_t s, const vector *x) {
    vector sum = make(0, 0, 0);
    for (int32_t k = rows->start[s]; k < rows->start[s + 1]; k++)
        add(&sum, rows->value[k], &x[rows->column[k]]);
    return sum;
}

static inline vector take_edge(const edge *own, const vector *x) {
    return subtract(&x[own->end[1]], &x[own->end[0]]);
}

/* N a */
static inline vector press(const vector *normal, float all_ways, const vector *a) {
    vector sum = scale(dot(normal, a), normal);
    add(&sum, (double)all_ways, a);
    return sum;
}

/* out = L' of the forces of samples + D' of those of edges */
static void gather_forces(const ss_fit_work *work, vector *out) {
    const ss_fit *fit = work->fit;
    for (int32_t i = 0; i < fit->free_count; i++) {
        vector sum = make(0, 0, 0);
        for (int32_t k = fit->share_start[i]; k < fit->share_start[i + 1]; k++)
            add(&sum, fit->share_weight[k], &work->force[fit->shares[k].term]);
        out[i] = sum;
    }
}

/* ---- The model where y is ---- */

/* Finds u, which is 0 if an edge has no length, and |e| - |e0|. */
static void measure_edges(ss_fit_work *work) {
    for (int32_t e = 0; e < work->fit->edge_count; e++) {
        const vector *before = &work->linear[e];
        vector now = take_edge(&work->fit->edges[e], work->offset);
        add(&now, 1, before);
        double length = sqrt(dot(&now, &now));
        work->direction[e] = scale(length > 0 ? 1 / length : 0, &now);
        work->excess[e] = length - sqrt(dot(before, before));
    }
}

/* gradient = -grad E / 2 */
static void list_gradient(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    vector *edge_force = work->force + fit->samples->row_count;
    for (int32_t s = 0; s < fit->samples->row_count; s++) {
        vector moved = take_sample(fit->samples, s, work->offset), left = subtract(&work->residual[s], &moved);
        work->force[s] = press(&work->up[s], work->all_ways[s], &left);
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        vector change = take_edge(&fit->edges[e], work->offset);
        edge_force[e] = scale(-edge_stiffness * direction_stiffness, &change);
        add(&edge_force[e], -edge_stiffness * work->excess[e], &work->direction[e]);
    }
    gather_forces(work, work->slope);
}

/* ---- The same in floats ---- */

static inline single to_single(const vector *a) {
    return (single){(float)a->xy[0], (float)a->xy[1], (float)a->z[0], 0};
}

static inline float single_dot(single a, single b) {
    single product = a * b;
    return product[0] + product[1] + product[2];
}

/* One step of Newton's from n to the unit normal: what was short by x is short by 3/2 x^2 after, and 0 stays 0. */
static inline single nearly_unit(single n) {
    return (1.5f - 0.5f * single_dot(n, n)) * n;
}

static void round_samples(ss_fit_work *work) {
    for (int32_t s = 0; s < work->fit->samples->row_count; s++)
        work->single_up[s] = to_single(&work->up[s]);
    for (int32_t i = 0; i < work->fit->free_count; i++)
        work->single_across[i] = nearly_unit(work->single_up[i]);
}

static void round_edges(ss_fit_work *work) {
    for (int32_t e = 0; e < work->fit->edge_count; e++)
        work->single_direction[e] = to_single(&work->direction[e]);
}

/* gradient = slope, in units of its largest. Returns the unit, which is 1 if all are 0. */
static double round_slope(ss_fit_work *work) {
    int32_t n = work->fit->free_count;
    double unit = 0;
    for (int32_t i = 0; i < n; i++)
        unit = ss_most(sqrt(dot(&work->slope[i], &work->slope[i])), unit);
    unit = unit > 0 ? unit : 1;
    for (int32_t i = 0; i < n; i++) {
        vector own = scale(1 / unit, &work->slope[i]);
        work->gradient[i] = to_single(&own);
    }
    return unit;
}

/* single_force = N L search for samples, s (uu' + t) D search for edges. */
static void list_single_forces(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    const ss_rows *samples = fit->samples;
    const float stiffness = (float)edge_stiffness, direct = (float)(edge_stiffness * direction_stiffness);
    single *edge_force = work->single_force + samples->row_count;
    for (int32_t s = 0; s < samples->row_count; s++) {
        single moved = {0}, up = work->single_up[s];
        for (int32_t k = samples->start[s]; k < samples->start[s + 1]; k++)
            moved += fit->sample_weight[k] * work->search[samples->column[k]];
        work->single_force[s] = single_dot(up, moved) * up + work->all_ways[s] * moved;
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        single change = work->search[fit->edges[e].end[1]] - work->search[fit->edges[e].end[0]];
        single direction = work->single_direction[e];
        edge_force[e] = direct * change + stiffness * single_dot(direction, change) * direction;
    }
}

/* image = (L'NL + s D'(uu' + t) D) search */
static void apply_system(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    list_single_forces(work);
    for (int32_t i = 0; i < fit->free_count; i++) {
        single sum = {0};
        for (int32_t k = fit->share_start[i]; k < fit->share_start[i + 1]; k++)
            sum += fit->shares[k].weight * work->single_force[fit->shares[k].term];
        work->image[i] = sum;
    }
}

/* ---- Conjugate gradients ---- */

/* scaled = gradient, preconditioned. Sample i is that of free vertex i. */
static void precondition(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    for (int32_t i = 0; i < fit->free_count; i++) {
        float across = work->across[i] = single_dot(work->single_across[i], work->gradient[i]);
        work->along[fit->unknown[i]] = work->gradient[i] - across * work->single_across[i];
    }
    ss_incomplete_solve(fit->across, work->across);
    ss_springs_solve(fit->along, (float(*)[4])work->scratch, (float(*)[4])work->along);
    for (int32_t i = 0; i < fit->free_count; i++) {
        single moved = work->along[fit->unknown[i]], normal = work->single_across[i];
        work->scaled[i] = moved + (work->across[i] - single_dot(normal, moved)) * normal;
    }
}

static double product(int32_t count, const single *a, const single *b) {
    double sum = 0;
    for (int32_t i = 0; i < count; i++)
        sum += (double)single_dot(a[i], b[i]);
    return sum;
}

/* y += unit step search, and gradient -= step image */
static void take_step(ss_fit_work *work, double unit, float step) {
    for (int32_t i = 0; i < work->fit->free_count; i++) {
        single moved = step * work->search[i];
        vector own = make((double)moved[0], (double)moved[1], (double)moved[2]);
        add(&work->offset[i], unit, &own);
        work->gradient[i] -= step * work->image[i];
    }
}

/* One step of Gauss-Newton. Once gradient.scaled is 0, nothing is left to do. */
static void improve(ss_fit_work *work) {
    int32_t n = work->fit->free_count;
    double before = 0;
    measure_edges(work);
    list_gradient(work);
    round_edges(work);
    double unit = round_slope(work);
    memset(work->search, 0, (size_t)n * sizeof *work->search);
    for (int k = 0; k < GRADIENT_STEPS && !ss_is_set(work->stop); k++) {
        precondition(work);
        double now = product(n, work->gradient, work->scaled);
        if (!(now > 0))
            return;
        float keep = k > 0 ? (float)(now / before) : 0;
        for (int32_t i = 0; i < n; i++)
            work->search[i] = work->scaled[i] + keep * work->search[i];
        apply_system(work);
        double curvature = product(n, work->search, work->image);
        if (!(curvature > 0))
            return;
        take_step(work, unit, (float)(now / curvature));
        before = now;
    }
}

/* ---- One frame ---- */

/* Subtracts the linear displacement, which is in offset, from the residual, and finds e0 with it. */
static void start_linear(ss_fit_work *work, const float *points, const double (*residual)[3], const double (*normal)[3]) {
    const ss_fit *fit = work->fit;
    for (int32_t s = 0; s < fit->samples->row_count; s++) {
        const double *r = residual[s], *n = normal[s];
        vector moved = take_sample(fit->samples, s, work->offset), wanted = make(r[0], r[1], r[2]);
        work->residual[s] = subtract(&wanted, &moved);
        double short_of = ss_most(1 - ss_dot(n, n), 0);
        work->up[s] = make(n[0], n[1], n[2]);
        work->all_ways[s] = (float)(all_ways_stiffness * short_of * short_of);
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        const float *from = points + 3 * (int64_t)fit->edges[e].mesh_vertex[0];
        const float *to = points + 3 * (int64_t)fit->edges[e].mesh_vertex[1];
        vector way = make((double)to[0] - from[0], (double)to[1] - from[1], (double)to[2] - from[2]);
        work->linear[e] = take_edge(&fit->edges[e], work->offset);
        add(&work->linear[e], 1, &way);
    }
    round_samples(work);
    memset(work->offset, 0, (size_t)fit->free_count * sizeof *work->offset);
}

void ss_fit_samples(ss_fit_work *work, const ss_frame *frame, const double (*residual)[3], const double (*normal)[3],
                    double (*displacement)[3]) {
    work->stop = frame->stop;
    for (int32_t i = 0; i < work->fit->free_count; i++)
        work->offset[i] = make(displacement[i][0], displacement[i][1], displacement[i][2]);
    start_linear(work, frame->points, residual, normal);
    for (int k = 0; k < GAUSS_NEWTON_STEPS; k++)
        improve(work);
    for (int32_t i = 0; i < work->fit->free_count; i++) {
        displacement[i][0] += work->offset[i].xy[0];
        displacement[i][1] += work->offset[i].xy[1];
        displacement[i][2] += work->offset[i].z[0];
    }
}
