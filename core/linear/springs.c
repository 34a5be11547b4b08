/* A net whose edges are springs, all alike, and whose vertices may each be held by one more. It is factored once in doubles,
 * and solved in floats for four right sides at a time: an unknown's four numbers are one vector.
 *
 * The factor is in tiles of four rows, [tile][column][4], as in kernels.c, but without extras. */
#include "linear.h"

#include <stdlib.h>

typedef float vector __attribute__((vector_size(16), may_alias));

struct ss_springs {
    ss_memory memory;
    ss_system *system;
    int64_t *panel; /* [front_count] where the tiles of the front begin */
    float *L;
};

/* ---- Creation ---- */

static void fill(const ss_system *system, double stiffness, const double *own, ss_factor *factor) {
    ss_factor_clear(factor);
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            factor->slack[system->unknown[v]] = own[v];
    for (int32_t e = 0; e < system->edge_count; e++) {
        int32_t a = system->unknown[system->edge_vertex[e][0]], b = system->unknown[system->edge_vertex[e][1]];
        factor->entry[e] = stiffness;
        if (a >= 0 && b < 0)
            factor->slack[a] += stiffness;
        if (b >= 0 && a < 0)
            factor->slack[b] += stiffness;
    }
}

static int64_t size_of(const ss_frontal *frontal, int32_t f) {
    ss_shape s = ss_shape_of(frontal, &frontal->system->fronts[f]);
    return (int64_t)ss_tile_start(&s, s.own_tiles + s.below_tiles);
}

static skinslide_status keep(const ss_frontal *frontal, ss_springs *springs, skinslide_error *error) {
    int32_t count = frontal->system->front_count;
    int64_t end = 0;
    springs->panel = SS_NEW(&springs->memory, int64_t, count);
    for (int32_t f = 0; f < count && springs->panel; end += size_of(frontal, f++))
        springs->panel[f] = end;
    springs->L = SS_NEW(&springs->memory, float, end);
    if (springs->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t f = 0; f < count; f++)
        for (int64_t i = 0; i < size_of(frontal, f); i++)
            springs->L[springs->panel[f] + i] = (float)frontal->L[frontal->panel[f] + i];
    return SKINSLIDE_OK;
}

static skinslide_status build(const ss_net *net, const char *label, double stiffness, const double *own, ss_springs *springs,
                              skinslide_error *error) {
    ss_factor *factor = NULL;
    skinslide_status status = ss_system_create(net, label, &springs->system, error);
    if (!status)
        status = ss_factor_create(springs->system, NULL, &factor, error);
    if (!status) {
        fill(springs->system, stiffness, own, factor);
        status = ss_factorise(factor) ? keep(factor->frontal, springs, error)
                                      : ss_fail(error, SKINSLIDE_SINGULAR, "%s: nothing holds its vertices", label);
    }
    ss_factor_destroy(factor);
    return status;
}

skinslide_status ss_springs_create(const ss_net *net, const char *label, double stiffness, const double *own, ss_springs **out,
                                   skinslide_error *error) {
    ss_springs *springs = calloc(1, sizeof *springs);
    if (!springs)
        return ss_out_of_memory(error);
    skinslide_status status = build(net, label, stiffness, own, springs, error);
    if (status)
        ss_springs_destroy(springs);
    else
        *out = springs;
    return status;
}

void ss_springs_destroy(ss_springs *springs) {
    if (!springs)
        return;
    ss_system_destroy(springs->system);
    ss_free(&springs->memory);
    free(springs);
}

int32_t ss_springs_unknown(const ss_springs *springs, int32_t vertex) {
    return springs->system->unknown[vertex];
}

int32_t ss_springs_scratch(const ss_springs *springs) {
    int32_t most = 0;
    for (int32_t f = 0; f < springs->system->front_count; f++)
        most = springs->system->fronts[f].row_count > most ? springs->system->fronts[f].row_count : most;
    return most + 3;
}

/* ---- Solving ---- */

/* sum[j] += l_j x, for four rows or columns j */
static inline void add_four(vector sum[4], vector l, vector x) {
    for (int j = 0; j < 4; j++)
        sum[j] += (vector){l[j], l[j], l[j], l[j]} * x;
}

/* sum += l' x, for one column and four rows */
static inline void add_column(vector *sum, vector l, const vector x[4]) {
    for (int j = 0; j < 4; j++)
        *sum += (vector){l[j], l[j], l[j], l[j]} * x[j];
}

/* sum = the product of the first columns of a tile with x */
static inline void apply(const vector *tile, int32_t count, const vector *x, vector sum[4]) {
    for (int j = 0; j < 4; j++)
        sum[j] = (vector){0};
    for (int32_t k = 0; k < count; k++)
        add_four(sum, tile[k], x[k]);
}

static int32_t rows_left(int32_t count, int32_t tile) {
    return count - 4 * tile < 4 ? count - 4 * tile : 4;
}

/* Eliminates a front: x are the right sides of its columns, right those of all unknowns. */
static void eliminate(const ss_front *front, const vector *tile, const int32_t *rows, vector *x, vector *right) {
    int32_t columns = (front->count + 3) / 4 * 4;
    vector sum[4];
    for (int32_t t = 0; 4 * t < front->count; tile += 4 * ++t) {
        apply(tile, 4 * t, x, sum);
        for (int j = 0; j < rows_left(front->count, t); j++) {
            x[4 * t + j] += sum[j];
            for (int k = 0; k < j; k++)
                x[4 * t + j] += tile[4 * t + k][j] * x[4 * t + k];
        }
    }
    for (int32_t t = 0; 4 * t < front->row_count; t++, tile += columns) {
        apply(tile, front->count, x, sum);
        for (int j = 0; j < rows_left(front->row_count, t); j++)
            right[rows[4 * t + j]] += sum[j];
    }
}

/* Solves for count columns from begin on, of one tile: sum is what the solution below that tile contributes. */
static void finish_columns(const vector *tile, int32_t begin, int32_t count, const vector sum[4], vector *x) {
    for (int c = count - 1; c >= 0; c--) {
        vector l = tile[begin + c], solved = l[c] * x[begin + c] + sum[c];
        for (int r = c + 1; r < count; r++)
            solved += l[r] * x[begin + r];
        x[begin + c] = solved;
    }
}

/* Solves for a front's columns. below is the solution for the rows below it, padded with zeros to a multiple of four. */
static void substitute(const ss_front *front, const vector *panel, const vector *below, vector *x) {
    int32_t own = (front->count + 3) / 4;
    const ss_shape s = {.own_tiles = own};
    for (int32_t ct = own - 1; ct >= 0; ct--) {
        vector sum[4] = {{0}};
        for (int32_t t = ct + 1; t < own; t++)
            for (int c = 0; c < 4; c++)
                for (int r = 0; r < rows_left(front->count, t); r++)
                    sum[c] += panel[ss_tile_start(&s, t) / 4 + (size_t)(4 * ct + c)][r] * x[4 * t + r];
        for (int32_t t = 0; 4 * t < front->row_count; t++)
            for (int c = 0; c < 4; c++)
                add_column(&sum[c], panel[ss_tile_start(&s, own + t) / 4 + (size_t)(4 * ct + c)], below + 4 * t);
        finish_columns(panel + ss_tile_start(&s, ct) / 4, 4 * ct, rows_left(front->count, ct), sum, x);
    }
}

void ss_springs_solve(const ss_springs *springs, float (*scratch)[4], float (*right)[4]) {
    const ss_system *system = springs->system;
    vector *all = (vector *)right, *below = (vector *)scratch;
    for (int32_t f = 0; f < system->front_count; f++) {
        const ss_front *front = &system->fronts[f];
        eliminate(front, (const vector *)(springs->L + springs->panel[f]), system->rows + front->row_start, all + front->first,
                  all);
    }
    for (int32_t f = system->front_count - 1; f >= 0; f--) {
        const ss_front *front = &system->fronts[f];
        for (int32_t i = 0; i < front->row_count; i++)
            below[i] = all[system->rows[front->row_start + i]];
        for (int32_t i = front->row_count; i % 4 != 0; i++)
            below[i] = (vector){0};
        substitute(front, (const vector *)(springs->L + springs->panel[f]), below, all + front->first);
    }
}
