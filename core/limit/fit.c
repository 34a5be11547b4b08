/* The least squares of interpolation LIMIT: moves free vertices by y from their linear places, so that samples of the surface,
 * L y, come to the planes that they belong in while edges keep what linear made of them. The minimum of
 *
 *     E(y) = sum (n.(L y - r))^2 + s sum ((|e| - |e0|)^2 + t |e - e0|^2)      s = 0.03, t = 0.05
 *          samples               edges
 *
 * where an edge is e0 in the linear result and e = e0 + D y after, D the edge-vertex incidence. Samples may slip in their planes,
 * which a coarse cage must let them; where vertices go there the edges say, by their length and a little by their direction.
 * Without edges nearness is bought with stretch: the stiffer they are, the less of both.
 *
 * Gauss-Newton, each step by conjugate gradients on
 *
 *     (L'NL + s D'(uu' + t) D) x = -grad E / 2                                N = nn', u = e / |e|
 *
 * which differs from frame to frame. The preconditioner is factored once a shot, from scalar matrices. It takes a vertex apart
 * across and along the plane of its own sample, since normals turn little from one vertex to the next:
 *
 *     n (L'L + s t D'D)^-1 n' + (1 - nn') (s (1/2 + t) D'D)^-1 (1 - nn')      1/2 the mean of uu' in the plane
 *
 * Where no vertex is held, as on a closed patch, D'D would let all of them go together: there it has 4 pi / n more of the n vertices'
 * own, which is the least that a sphere's first waves have of it.
 *
 * Steps are counted and not watched, so that the time is known and neighbouring frames go the same way. */
#include "base.h"
#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double edge_stiffness = 0.03;      /* s */
static const double direction_stiffness = 0.05; /* t */
enum { GAUSS_NEWTON_STEPS = 2, GRADIENT_STEPS = 5 };

/* An edge that has a free end. */
typedef struct edge {
    int32_t mesh_vertex[2];
    int32_t end[2]; /* places in free_vertex, -1 where held */
} edge;

struct ss_fit {
    ss_memory memory;
    int32_t free_count, edge_count;
    const ss_rows *samples; /* L */
    edge *edges;            /* [edge_count] */
    ss_least_squares *across, *along;
};

struct ss_fit_work {
    ss_memory memory;
    const ss_fit *fit;
    ss_least_squares_work *across, *along;
    const int *stop;           /* a flag: the frame is not wanted any more */
    const double (*normal)[3]; /* [sample count] n */
    double (*residual)[3];     /* [sample count] r */
    double (*linear)[3];       /* [edge_count] e0 */
    double (*direction)[3];    /* [edge_count] u */
    double *excess;            /* [edge_count] |e| - |e0| */
    double (*offset)[3];       /* [free_count] y */
    double (*gradient)[3];     /* [free_count] what y leaves of -grad E / 2 */
    double (*scaled)[3];       /* [free_count] the same through the preconditioner */
    double (*search)[3];       /* [free_count] a direction of conjugate gradients ... */
    double (*image)[3];        /* [free_count] ... and what the system makes of it */
    double *right;             /* [4][free_count] */
};

/* ---- Creation ---- */

static void list_edges(const ss_patch *patch, const int32_t *free_index, ss_fit *fit) {
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        edge own = {{patch->mesh_vertex[v[0]], patch->mesh_vertex[v[1]]}, {free_index[v[0]], free_index[v[1]]}};
        if (own.end[0] >= 0 || own.end[1] >= 0)
            fit->edges[fit->edge_count++] = own;
    }
}

/* Row by row of D, times weight. */
static void append_edges(const ss_fit *fit, double weight, ss_rows *rows) {
    int32_t end = rows->start[rows->row_count];
    for (int32_t e = 0; e < fit->edge_count; e++) {
        for (int side = 0; side < 2; side++)
            if (fit->edges[e].end[side] >= 0)
                rows->column[end] = fit->edges[e].end[side], rows->value[end++] = side ? weight : -weight;
        rows->start[++rows->row_count] = end;
    }
}

static void append_vertices(const ss_fit *fit, double weight, ss_rows *rows) {
    for (int32_t i = 0, end = rows->start[rows->row_count]; i < fit->free_count; i++) {
        rows->column[end] = i, rows->value[end++] = weight;
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

/* A'A, of samples, or NULL for none, of edges so stiff, and where that is above 0, of vertices so stiff. */
static skinslide_status factor(const ss_fit *fit, const ss_rows *samples, double stiffness, double own, const char *label,
                               ss_least_squares **out, skinslide_error *error) {
    int64_t row_count = fit->edge_count, entries = 2 * row_count;
    if (own > 0)
        row_count += fit->free_count, entries += fit->free_count;
    if (samples)
        row_count += samples->row_count, entries += samples->start[samples->row_count];
    if (row_count > INT32_MAX || entries > INT32_MAX)
        return ss_refuse_large(label, error);
    ss_memory scratch = {0};
    ss_rows rows = {.column_count = fit->free_count};
    rows.start = SS_NEW(&scratch, int32_t, row_count + 1);
    rows.column = SS_NEW(&scratch, int32_t, entries);
    rows.value = SS_NEW(&scratch, double, entries);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        if (samples)
            append_samples(samples, &rows);
        append_edges(fit, sqrt(stiffness), &rows);
        if (own > 0)
            append_vertices(fit, sqrt(own), &rows);
        status = ss_least_squares_create(&rows, label, out, error);
    }
    ss_free(&scratch);
    return status;
}

skinslide_status ss_fit_create(const ss_patch *patch, const int32_t *free_index, const ss_rows *samples, ss_fit **out,
                               skinslide_error *error) {
    ss_fit *fit = calloc(1, sizeof *fit);
    if (!fit)
        return ss_out_of_memory(error);
    fit->free_count = patch->free_count, fit->samples = samples;
    fit->edges = SS_NEW(&fit->memory, edge, patch->faces.edge_count);
    skinslide_status status = fit->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        list_edges(patch, free_index, fit);
        status = factor(fit, samples, edge_stiffness * direction_stiffness, 0, patch->label, &fit->across, error);
    }
    double along = edge_stiffness * (0.5 + direction_stiffness);
    bool is_held = patch->free_count < patch->vertex_count;
    if (!status)
        status =
            factor(fit, NULL, along, is_held ? 0 : 4 * SS_PI / patch->free_count * along, patch->label, &fit->along, error);
    if (status)
        ss_fit_destroy(fit);
    else
        *out = fit;
    return status;
}

void ss_fit_destroy(ss_fit *fit) {
    if (!fit)
        return;
    ss_least_squares_destroy(fit->across);
    ss_least_squares_destroy(fit->along);
    ss_free(&fit->memory);
    free(fit);
}

static void new_arrays(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    ss_memory *memory = &work->memory;
    work->residual = ss_new(memory, fit->samples->row_count, sizeof *work->residual);
    work->linear = ss_new(memory, fit->edge_count, sizeof *work->linear);
    work->direction = ss_new(memory, fit->edge_count, sizeof *work->direction);
    work->excess = SS_NEW(memory, double, fit->edge_count);
    work->offset = ss_new(memory, fit->free_count, sizeof *work->offset);
    work->gradient = ss_new(memory, fit->free_count, sizeof *work->gradient);
    work->scaled = ss_new(memory, fit->free_count, sizeof *work->scaled);
    work->search = ss_new(memory, fit->free_count, sizeof *work->search);
    work->image = ss_new(memory, fit->free_count, sizeof *work->image);
    work->right = SS_NEW(memory, double, 4 * (int64_t)fit->free_count);
}

skinslide_status ss_fit_work_create(const ss_fit *fit, ss_fit_work **out, skinslide_error *error) {
    ss_fit_work *work = calloc(1, sizeof *work);
    if (!work)
        return ss_out_of_memory(error);
    work->fit = fit;
    new_arrays(work);
    skinslide_status status = work->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_least_squares_work_create(fit->across, &work->across, error);
    if (!status)
        status = ss_least_squares_work_create(fit->along, &work->along, error);
    if (status)
        ss_fit_work_destroy(work);
    else
        *out = work;
    return status;
}

void ss_fit_work_destroy(ss_fit_work *work) {
    if (!work)
        return;
    ss_least_squares_work_destroy(work->across);
    ss_least_squares_work_destroy(work->along);
    ss_free(&work->memory);
    free(work);
}

/* ---- Rows of L and D ---- */

/* out += scale (L x)_s */
static void add_sample(const ss_rows *rows, int32_t s, double scale, const double (*x)[3], double out[3]) {
    for (int32_t k = rows->start[s]; k < rows->start[s + 1]; k++)
        ss_add(scale * rows->value[k], x[rows->column[k]], out);
}

/* out += L'_s N a; where the surface has no normal, N is 1. */
static void scatter_sample(const ss_fit_work *work, int32_t s, const double a[3], double (*out)[3]) {
    const ss_rows *rows = work->fit->samples;
    const double *n = work->normal[s];
    bool none = n[0] == 0 && n[1] == 0 && n[2] == 0;
    double height = none ? 1 : ss_dot(n, a);
    for (int32_t k = rows->start[s]; k < rows->start[s + 1]; k++)
        ss_add(height * rows->value[k], none ? a : n, out[rows->column[k]]);
}

/* out = (D x)_e */
static void take_edge(const edge *own, const double (*x)[3], double out[3]) {
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (own->end[1] < 0 ? 0 : x[own->end[1]][axis]) - (own->end[0] < 0 ? 0 : x[own->end[0]][axis]);
}

/* out += D'_e a */
static void scatter_edge(const edge *own, const double a[3], double (*out)[3]) {
    for (int side = 0; side < 2; side++)
        if (own->end[side] >= 0)
            ss_add(side ? 1 : -1, a, out[own->end[side]]);
}

/* ---- The model where y is ---- */

/* u, of zeros where an edge has no length, and |e| - |e0|. */
static void measure_edges(ss_fit_work *work) {
    for (int32_t e = 0; e < work->fit->edge_count; e++) {
        double now[3], *u = work->direction[e];
        take_edge(&work->fit->edges[e], (const double(*)[3])work->offset, now);
        ss_add(1, work->linear[e], now);
        double length = ss_length(now);
        for (int axis = 0; axis < 3; axis++)
            u[axis] = length > 0 ? now[axis] / length : 0;
        work->excess[e] = length - ss_length(work->linear[e]);
    }
}

/* gradient = -grad E / 2 */
static void list_gradient(ss_fit_work *work) {
    const ss_fit *fit = work->fit;
    const double(*y)[3] = (const double(*)[3])work->offset;
    memset(work->gradient, 0, (size_t)fit->free_count * sizeof *work->gradient);
    for (int32_t s = 0; s < fit->samples->row_count; s++) {
        double left[3];
        memcpy(left, work->residual[s], sizeof left);
        add_sample(fit->samples, s, -1, y, left);
        scatter_sample(work, s, left, work->gradient);
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        double change[3], force[3] = {0, 0, 0};
        take_edge(&fit->edges[e], y, change);
        ss_add(-edge_stiffness * direction_stiffness, change, force);
        ss_add(-edge_stiffness * work->excess[e], work->direction[e], force);
        scatter_edge(&fit->edges[e], force, work->gradient);
    }
}

/* out = (L'NL + s D'(uu' + t) D) x */
static void apply_system(const ss_fit_work *work, const double (*x)[3], double (*out)[3]) {
    const ss_fit *fit = work->fit;
    memset(out, 0, (size_t)fit->free_count * sizeof *out);
    for (int32_t s = 0; s < fit->samples->row_count; s++) {
        double moved[3] = {0, 0, 0};
        add_sample(fit->samples, s, 1, x, moved);
        scatter_sample(work, s, moved, out);
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        double change[3], force[3] = {0, 0, 0};
        take_edge(&fit->edges[e], x, change);
        ss_add(edge_stiffness * direction_stiffness, change, force);
        ss_add(edge_stiffness * ss_dot(work->direction[e], change), work->direction[e], force);
        scatter_edge(&fit->edges[e], force, out);
    }
}

/* ---- Conjugate gradients ---- */

/* scaled = what the preconditioner makes of gradient. Sample i is that of free vertex i. */
static void precondition(ss_fit_work *work) {
    int64_t n = work->fit->free_count;
    double *across = work->right, *along = work->right + n;
    for (int64_t i = 0; i < n; i++) {
        const double *gradient = work->gradient[i], *normal = work->normal[i];
        across[i] = ss_dot(normal, gradient);
        for (int axis = 0; axis < 3; axis++)
            along[axis * n + i] = gradient[axis] - across[i] * normal[axis];
    }
    ss_least_squares_solve(work->across, across, 1);
    ss_least_squares_solve(work->along, along, 3);
    for (int64_t i = 0; i < n; i++) {
        double *scaled = work->scaled[i];
        for (int axis = 0; axis < 3; axis++)
            scaled[axis] = along[axis * n + i];
        ss_add(across[i] - ss_dot(work->normal[i], scaled), work->normal[i], scaled);
    }
}

static double product(int32_t count, double (*a)[3], double (*b)[3]) {
    double sum = 0;
    for (int32_t i = 0; i < count; i++)
        sum += ss_dot(a[i], b[i]);
    return sum;
}

/* search = scaled + keep search */
static void turn_search(ss_fit_work *work, double keep) {
    for (int32_t i = 0; i < work->fit->free_count; i++)
        for (int axis = 0; axis < 3; axis++)
            work->search[i][axis] = work->scaled[i][axis] + keep * work->search[i][axis];
}

/* One step of Gauss-Newton. Nothing is left to do where gradient.scaled is 0. */
static void improve(ss_fit_work *work) {
    int32_t n = work->fit->free_count;
    double before = 0;
    measure_edges(work);
    list_gradient(work);
    memset(work->search, 0, (size_t)n * sizeof *work->search);
    for (int k = 0; k < GRADIENT_STEPS && !ss_is_set(work->stop); k++) {
        precondition(work);
        double now = product(n, work->gradient, work->scaled);
        if (!(now > 0))
            return;
        turn_search(work, k > 0 ? now / before : 0);
        apply_system(work, (const double(*)[3])work->search, work->image);
        double curvature = product(n, work->search, work->image);
        if (!(curvature > 0))
            return;
        for (int32_t i = 0; i < n; i++) {
            ss_add(now / curvature, work->search[i], work->offset[i]);
            ss_add(-now / curvature, work->image[i], work->gradient[i]);
        }
        before = now;
    }
}

/* ---- One frame ---- */

/* Takes the linear displacement off the residual, and takes e0 from it. */
static void start_linear(ss_fit_work *work, const float *points, const double (*residual)[3], const double (*displacement)[3]) {
    const ss_fit *fit = work->fit;
    for (int32_t s = 0; s < fit->samples->row_count; s++) {
        memcpy(work->residual[s], residual[s], sizeof *work->residual);
        add_sample(fit->samples, s, -1, displacement, work->residual[s]);
    }
    for (int32_t e = 0; e < fit->edge_count; e++) {
        const float *from = points + 3 * (int64_t)fit->edges[e].mesh_vertex[0];
        const float *to = points + 3 * (int64_t)fit->edges[e].mesh_vertex[1];
        take_edge(&fit->edges[e], displacement, work->linear[e]);
        for (int axis = 0; axis < 3; axis++)
            work->linear[e][axis] += (double)to[axis] - from[axis];
    }
    memset(work->offset, 0, (size_t)fit->free_count * sizeof *work->offset);
}

void ss_fit_samples(ss_fit_work *work, const ss_frame *frame, const double (*residual)[3], const double (*normal)[3],
                    double (*displacement)[3]) {
    work->normal = normal, work->stop = frame->stop;
    start_linear(work, frame->points, residual, (const double(*)[3])displacement);
    for (int k = 0; k < GAUSS_NEWTON_STEPS; k++)
        improve(work);
    for (int32_t i = 0; i < work->fit->free_count; i++)
        ss_add(1, work->offset[i], displacement[i]);
}
