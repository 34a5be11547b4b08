/* L D L' of a matrix in blocks of two by two, on the pattern that order.c found: column of blocks by column, each taking what the
 * columns before it leave there. D is of numbers, and L has ones in its blocks' diagonals, too: so it loses no more digits than the
 * matrix costs, however far apart the two unknowns of a block are. Columns whose rows are the same go together, as in factor.c. Sums
 * are in one order on every machine. */
#include "linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

skinslide_status ss_blocks_create(const ss_system *system, ss_blocks **out, skinslide_error *error) {
    ss_blocks *blocks = calloc(1, sizeof *blocks);
    if (!blocks)
        return ss_out_of_memory(error);
    ss_memory *memory = &blocks->memory;
    int32_t n = system->n;
    blocks->system = system;
    blocks->Lx = ss_new(memory, system->Lp[n], sizeof *blocks->Lx);
    blocks->own = ss_new(memory, n, sizeof *blocks->own);
    blocks->right = ss_new(memory, n, sizeof *blocks->right);
    blocks->pivot = ss_new(memory, n, sizeof *blocks->pivot);
    blocks->lean = SS_NEW(memory, double, n);
    blocks->work = ss_new(memory, n, sizeof *blocks->work);
    blocks->first = SS_NEW(memory, int, n);
    blocks->next = SS_NEW(memory, int, n);
    blocks->reached = SS_NEW(memory, int, n);
    if (memory->failed) {
        ss_blocks_destroy(blocks);
        return ss_out_of_memory(error);
    }
    *out = blocks;
    return SKINSLIDE_OK;
}

void ss_blocks_destroy(ss_blocks *blocks) {
    if (!blocks)
        return;
    ss_free(&blocks->memory);
    free(blocks);
}

void ss_blocks_clear(ss_blocks *blocks) {
    size_t n = (size_t)blocks->system->n;
    memset(blocks->Lx, 0, (size_t)blocks->system->Lp[n] * sizeof *blocks->Lx);
    memset(blocks->own, 0, n * sizeof *blocks->own);
    memset(blocks->right, 0, n * sizeof *blocks->right);
}

int32_t ss_blocks_unknown(const ss_blocks *blocks, int32_t vertex) {
    return blocks->system->unknown[vertex];
}

double *ss_blocks_own(ss_blocks *blocks, int32_t unknown) {
    return blocks->own[unknown];
}

double *ss_blocks_between(ss_blocks *blocks, int32_t edge, bool *first_is_row) {
    const ss_system *system = blocks->system;
    *first_is_row = system->unknown[system->edge_vertex[edge][0]] > system->unknown[system->edge_vertex[edge][1]];
    return blocks->Lx[system->entry[edge]];
}

/* ---- Blocks ---- */

/* c -= a b */
static void subtract_product(const double *restrict a, const double *restrict b, double *restrict c) {
    c[0] -= a[0] * b[0] + a[1] * b[2];
    c[1] -= a[0] * b[1] + a[1] * b[3];
    c[2] -= a[2] * b[0] + a[3] * b[2];
    c[3] -= a[2] * b[1] + a[3] * b[3];
}

/* ---- The factor ---- */

/* What column j, at its entry in row k, has to leave in column k: D times that entry, transposed. Takes it out of k's own. */
static void find_force(ss_blocks *blocks, int j, int entry, int k, double force[4]) {
    const double *at = blocks->Lx[entry], *pivot = blocks->pivot[j];
    force[0] = pivot[0] * at[0], force[1] = pivot[0] * at[2];
    force[2] = pivot[1] * at[1], force[3] = pivot[1] * at[3];
    subtract_product(at, force, blocks->own[k]);
}

/* Lists a run of columns under the next of the rows below it that they have an entry in. */
static void list_run(ss_blocks *blocks, int run, int reached) {
    const ss_system *system = blocks->system;
    int last = system->block[run + 1] - 1, row = system->Lp[last] + reached;
    blocks->reached[run] = reached;
    if (row == system->Lp[last + 1])
        return;
    blocks->next[run] = blocks->first[system->Li[row]];
    blocks->first[system->Li[row]] = run;
}

/* From the columns of k's own run before it: rows match one to one. */
static void gather_own(ss_blocks *blocks, int begin, int k) {
    const int *Lp = blocks->system->Lp;
    double force[4];
    for (int j = begin; j < k; j++) {
        int entry = Lp[j] + k - j - 1;
        find_force(blocks, j, entry, k, force);
        for (int p = Lp[k], q = entry + 1; p < Lp[k + 1]; p++, q++)
            subtract_product(blocks->Lx[q], force, blocks->Lx[p]);
    }
}

/* From the runs that have an entry in row k, by rows into work. */
static void gather_others(ss_blocks *blocks, int k) {
    const ss_system *system = blocks->system;
    double force[4];
    for (int run = blocks->first[k], next; run >= 0; run = next) {
        int begin = system->block[run], end = system->block[run + 1], reached = blocks->reached[run];
        next = blocks->next[run];
        for (int j = begin; j < end; j++) {
            int entry = system->Lp[j] + (end - 1 - j) + reached;
            find_force(blocks, j, entry, k, force);
            for (int p = entry + 1; p < system->Lp[j + 1]; p++)
                subtract_product(blocks->Lx[p], force, blocks->work[system->Li[p]]);
        }
        list_run(blocks, run, reached + 1);
    }
}

/* The pivots of column k, and its entries over them. */
static bool finish_column(ss_blocks *blocks, int k) {
    const ss_system *system = blocks->system;
    const double *own = blocks->own[k];
    double *pivot = blocks->pivot[k], lean = blocks->lean[k] = own[2] / own[0];
    pivot[0] = own[0], pivot[1] = own[3] - lean * own[1];
    double first = 1 / pivot[0], second = 1 / pivot[1];
    for (int p = system->Lp[k]; p < system->Lp[k + 1]; p++) {
        double *work = blocks->work[system->Li[p]], *at = blocks->Lx[p];
        for (int i = 0; i < 4; i++)
            at[i] += work[i], work[i] = 0;
        at[1] = second * (at[1] - lean * at[0]), at[3] = second * (at[3] - lean * at[2]);
        at[0] *= first, at[2] *= first;
    }
    return pivot[0] > 0 && pivot[1] > 0 && isfinite(first) && isfinite(second);
}

bool ss_blocks_factor(ss_blocks *blocks, const int *stop) {
    const ss_system *system = blocks->system;
    bool good = true;
    for (int k = 0; k < system->n; k++)
        blocks->first[k] = -1;
    for (int run = 0; run < system->block_count; run++) {
        if (ss_is_set(stop))
            return false;
        for (int k = system->block[run]; k < system->block[run + 1]; k++) {
            gather_own(blocks, system->block[run], k);
            gather_others(blocks, k);
            good = finish_column(blocks, k) && good;
        }
        list_run(blocks, run, 0);
    }
    return good;
}

void ss_blocks_solve(ss_blocks *blocks) {
    const int *Lp = blocks->system->Lp, *Li = blocks->system->Li, n = blocks->system->n;
    double(*x)[2] = blocks->right;
    for (int j = 0; j < n; j++) {
        x[j][1] -= blocks->lean[j] * x[j][0];
        for (int p = Lp[j]; p < Lp[j + 1]; p++) {
            const double *l = blocks->Lx[p];
            x[Li[p]][0] -= l[0] * x[j][0] + l[1] * x[j][1];
            x[Li[p]][1] -= l[2] * x[j][0] + l[3] * x[j][1];
        }
    }
    for (int j = n - 1; j >= 0; j--) {
        double a = x[j][0] / blocks->pivot[j][0], b = x[j][1] / blocks->pivot[j][1];
        for (int p = Lp[j]; p < Lp[j + 1]; p++) {
            const double *l = blocks->Lx[p];
            a -= l[0] * x[Li[p]][0] + l[2] * x[Li[p]][1];
            b -= l[1] * x[Li[p]][0] + l[3] * x[Li[p]][1];
        }
        x[j][0] = a - blocks->lean[j] * b, x[j][1] = b;
    }
}
