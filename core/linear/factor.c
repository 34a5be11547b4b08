/* L D L' of the embedding's matrix, column by column, and two right sides solved with it together.
 *
 * The factorisation is our own because the matrix is special: no entry off the diagonal is positive, and each diagonal entry is
 * the sum of the others of its row and of a slack >= 0, the densities to fixed vertices. Elimination keeps that form, so with the
 * slack carried along (Grassmann, Taksar, Heyman 1985) nothing is ever subtracted, no digit is lost however much densities
 * differ, and u and v are the convex combinations that they should be. It also takes the sums in one order on every machine; the
 * ordering is the AMD build's, so bytes are the same on machines that have the same one. */
#include "linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

skinslide_status ss_factor_create(const ss_system *system, ss_factor **out, skinslide_error *error) {
    ss_factor *factor = calloc(1, sizeof *factor);
    if (!factor)
        return ss_out_of_memory(error);
    ss_memory *memory = &factor->memory;
    int32_t n = system->n;
    factor->Lx = SS_NEW(memory, double, system->Lp[n]);
    factor->pivot = SS_NEW(memory, double, n);
    factor->slack = SS_NEW(memory, double, n);
    factor->work = SS_NEW(memory, double, n);
    factor->force = SS_NEW(memory, double, n);
    factor->right = ss_new(memory, n, sizeof *factor->right);
    factor->first = SS_NEW(memory, int, n);
    factor->next = SS_NEW(memory, int, n);
    factor->reached = SS_NEW(memory, int, n);
    if (memory->failed) {
        ss_factor_destroy(factor);
        return ss_out_of_memory(error);
    }
    *out = factor;
    return SKINSLIDE_OK;
}

void ss_factor_destroy(ss_factor *factor) {
    if (!factor)
        return;
    ss_free(&factor->memory);
    free(factor);
}

void ss_factor_clear(const ss_system *system, ss_factor *factor) {
    memset(factor->Lx, 0, (size_t)system->Lp[system->n] * sizeof *factor->Lx);
    memset(factor->slack, 0, (size_t)system->n * sizeof *factor->slack);
    memset(factor->right, 0, (size_t)system->n * sizeof *factor->right);
}

/* Lists a block under the next of the rows below it that its columns have an entry in. */
static void list_block(const ss_system *system, ss_factor *factor, int block, int reached) {
    int last = system->block[block + 1] - 1, row = system->Lp[last] + reached;
    factor->reached[block] = reached;
    if (row == system->Lp[last + 1])
        return;
    factor->next[block] = factor->first[system->Li[row]];
    factor->first[system->Li[row]] = block;
}

/* Sums of four columns at once, then of those left: a[i] f[0] + b[i] f[1] + ..., in one order always. */
static void add_dense(double *target, const double *const columns[4], const double *force, int count, int length) {
    const double *a = columns[0], *b = columns[1], *c = columns[2], *d = columns[3];
    if (count == 4)
        for (int i = 0; i < length; i++)
            target[i] += (a[i] * force[0] + b[i] * force[1]) + (c[i] * force[2] + d[i] * force[3]);
    else
        for (int k = 0; k < count; k++)
            for (int i = 0; i < length; i++)
                target[i] += columns[k][i] * force[k];
}

static void add_scattered(double *target, const int *rows, const double *const columns[4], const double *force, int count,
                          int length) {
    const double *a = columns[0], *b = columns[1], *c = columns[2], *d = columns[3];
    if (count == 4)
        for (int i = 0; i < length; i++)
            target[rows[i]] += (a[i] * force[0] + b[i] * force[1]) + (c[i] * force[2] + d[i] * force[3]);
    else
        for (int k = 0; k < count; k++)
            for (int i = 0; i < length; i++)
                target[rows[i]] += columns[k][i] * force[k];
}

/* The columns from begin to end at their entries in row k, which pull on it: their forces, and what slack they pass on. entry is
 * counted in the rows from k = begin on: column j has that row at Lp[j] + entry - (j - begin). */
static double pull(const ss_system *system, ss_factor *factor, int begin, int end, int entry) {
    double slack = 0;
    for (int j = begin; j < end; j++) {
        double share = factor->Lx[system->Lp[j] + entry - (j - begin)];
        factor->force[j - begin] = share * factor->pivot[j];
        slack += share * factor->slack[j];
    }
    return slack;
}

/* Four columns of a run, or those left, below an entry; returns how many. */
static int take_columns(const ss_system *system, const ss_factor *factor, int begin, int from, int end, int entry,
                        const double *columns[4]) {
    int count = end - from < 4 ? end - from : 4;
    for (int k = 0; k < 4; k++)
        columns[k] = k < count ? factor->Lx + system->Lp[from + k] + entry - (from + k - begin) + 1 : NULL;
    return count;
}

/* Adds to column k what the columns of its own block before it leave there: rows match one to one. */
static void gather_own(const ss_system *system, ss_factor *factor, int begin, int k) {
    const double *columns[4];
    int length = system->Lp[k + 1] - system->Lp[k];
    factor->slack[k] += pull(system, factor, begin, k, k - begin - 1);
    for (int j = begin, count; j < k; j += count) {
        count = take_columns(system, factor, begin, j, k, k - begin - 1, columns);
        add_dense(factor->Lx + system->Lp[k], columns, factor->force + (j - begin), count, length);
    }
}

/* Adds to work, by rows, what the blocks that have an entry in row k leave in column k. */
static void gather_others(const ss_system *system, ss_factor *factor, int k) {
    const double *columns[4];
    for (int block = factor->first[k], next; block >= 0; block = next) {
        int begin = system->block[block], end = system->block[block + 1], reached = factor->reached[block];
        int entry = end - begin - 1 + reached, row = system->Lp[end - 1] + reached + 1, length = system->Lp[end] - row;
        next = factor->next[block];
        factor->slack[k] += pull(system, factor, begin, end, entry);
        for (int j = begin, count; j < end; j += count) {
            count = take_columns(system, factor, begin, j, end, entry, columns);
            add_scattered(factor->work, system->Li + row, columns, factor->force + (j - begin), count, length);
        }
        list_block(system, factor, block, reached + 1);
    }
}

/* Column k of L and its pivot. False where that is not a number to divide by. */
static bool finish_column(const ss_system *system, ss_factor *factor, int k) {
    double pivot = factor->slack[k];
    for (int p = system->Lp[k]; p < system->Lp[k + 1]; p++) {
        factor->Lx[p] += factor->work[system->Li[p]];
        factor->work[system->Li[p]] = 0;
        pivot += factor->Lx[p];
    }
    factor->pivot[k] = pivot;
    for (int p = system->Lp[k]; p < system->Lp[k + 1]; p++)
        factor->Lx[p] /= pivot;
    return pivot > 0 && isfinite(pivot) && isfinite(1 / pivot);
}

bool ss_factorise(const ss_system *system, ss_factor *factor) {
    bool good = true;
    for (int k = 0; k < system->n; k++)
        factor->first[k] = -1;
    for (int block = 0; block < system->block_count; block++) {
        for (int k = system->block[block]; k < system->block[block + 1]; k++) {
            gather_own(system, factor, system->block[block], k);
            gather_others(system, factor, k);
            good = finish_column(system, factor, k) && good;
        }
        list_block(system, factor, block, 0);
    }
    return good;
}

void ss_solve(const ss_system *system, ss_factor *factor) {
    double(*x)[2] = factor->right;
    for (int k = 0; k < system->n; k++)
        for (int p = system->Lp[k]; p < system->Lp[k + 1]; p++) {
            x[system->Li[p]][0] += factor->Lx[p] * x[k][0];
            x[system->Li[p]][1] += factor->Lx[p] * x[k][1];
        }
    for (int k = system->n - 1; k >= 0; k--) {
        double u = x[k][0] / factor->pivot[k], v = x[k][1] / factor->pivot[k];
        for (int p = system->Lp[k]; p < system->Lp[k + 1]; p++) {
            u += factor->Lx[p] * x[system->Li[p]][0];
            v += factor->Lx[p] * x[system->Li[p]][1];
        }
        x[k][0] = u, x[k][1] = v;
    }
}
