/* The embedding (paper, section 3.1, equations of Schek 1974): for the free vertices, and for u and v each,
 *
 *     (C' Q C) X = -(C' Q Cf) Xf
 *
 * C is the edge-vertex incidence of the free vertices, Cf that of the fixed, Q = diag(density). The pattern of the matrix is that
 * of the net, so ordering (SuiteSparse's AMD) and the pattern of its factor are found once, and each pose costs one numeric
 * factorisation and one solve for u and v together.
 *
 * The factorisation L D L' is our own, column by column, because the matrix is special: no entry off the diagonal is positive,
 * and each diagonal entry is the sum of the others of its row and of a slack >= 0, the densities to fixed vertices. Elimination
 * keeps that form, so with the slack carried along (Grassmann, Taksar, Heyman 1985) nothing is ever subtracted, no digit is lost
 * however much densities differ, and u and v are the convex combinations that they should be. It also takes the sums in one
 * order on every machine; the ordering is the AMD build's, so bytes are the same on machines that have the same one. */
#include "system.h"

#include <amd.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ss_factor {
    ss_memory memory;
    double *Lx;                  /* the entries of L, with their signs turned: all >= 0 */
    double *pivot, *slack;       /* [n] D, and what of each pivot pulls towards fixed vertices */
    double *work;                /* [n] zero between columns */
    double *force;               /* [n] of the columns of a block */
    double (*right)[2];          /* [n] right sides, then solutions */
    int *first, *next, *reached; /* [n] blocks by the row they are to be used in next, and how far each was */
};

static bool joins_free(const ss_system *system, int32_t edge) {
    return system->unknown[system->edge_vertex[edge][0]] >= 0 && system->unknown[system->edge_vertex[edge][1]] >= 0;
}

/* The upper triangle in whatever order the unknowns have now. filled is scratch [n]. */
static void fill_pattern(ss_system *system, int *filled) {
    memset(system->Ap, 0, ((size_t)system->n + 1) * sizeof *system->Ap);
    for (int pass = 0; pass < 2; pass++) {
        memset(filled, 0, (size_t)system->n * sizeof *filled);
        for (int32_t e = 0; e < system->edge_count; e++) {
            if (!joins_free(system, e))
                continue;
            int32_t a = system->unknown[system->edge_vertex[e][0]], b = system->unknown[system->edge_vertex[e][1]];
            int32_t column = a > b ? a : b;
            if (pass)
                system->Ai[system->Ap[column] + filled[column]] = a < b ? a : b;
            filled[column]++;
        }
        for (int32_t k = 0; k < system->n && !pass; k++)
            system->Ap[k + 1] = system->Ap[k] + filled[k];
    }
}

/* Renumbers the unknowns by approximate minimum degree. scratch is [2 n]. */
static skinslide_status order(ss_system *system, int *scratch, skinslide_error *error) {
    double info[AMD_INFO];
    int *permutation = scratch, *place = scratch + system->n;
    fill_pattern(system, scratch);
    int status = amd_order(system->n, system->Ap, system->Ai, permutation, NULL, info);
    if (status == AMD_OUT_OF_MEMORY)
        return ss_out_of_memory(error);
    if (status < 0)
        return ss_fail(error, SKINSLIDE_SINGULAR, "%s: its system cannot be ordered", system->label);
    if (info[AMD_LNZ] > INT_MAX / 2)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: its system is too large, %.0f entries", system->label, info[AMD_LNZ]);
    for (int32_t k = 0; k < system->n; k++)
        place[permutation[k]] = k;
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            system->unknown[v] = place[system->unknown[v]];
    return SKINSLIDE_OK;
}

/* Visits, for each row k of L, its columns i: along the elimination tree from the entries of row k of the matrix (Liu 1990). The
 * first time it makes the tree and counts entries in filled, the second time it lists them. seen is scratch [n]. */
static void visit_rows(ss_system *system, int *filled, int *seen, bool list) {
    memset(filled, 0, (size_t)system->n * sizeof *filled);
    for (int k = 0; k < system->n; k++) {
        seen[k] = k;
        for (int p = system->Ap[k]; p < system->Ap[k + 1]; p++)
            for (int i = system->Ai[p]; seen[i] != k; i = system->parent[i]) {
                if (!list && system->parent[i] < 0)
                    system->parent[i] = k;
                if (list)
                    system->Li[system->Lp[i] + filled[i]] = k;
                filled[i]++;
                seen[i] = k;
            }
    }
}

static int find_entry(const ss_system *system, int column, int row) {
    int low = system->Lp[column], high = system->Lp[column + 1] - 1;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (system->Li[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void place_edges(ss_system *system) {
    for (int32_t e = 0; e < system->edge_count; e++) {
        int32_t a = system->unknown[system->edge_vertex[e][0]], b = system->unknown[system->edge_vertex[e][1]];
        system->entry[e] = joins_free(system, e) ? find_entry(system, a < b ? a : b, a < b ? b : a) : -1;
    }
}

/* A column goes on with the run before it where it is that column's parent and has its rows but itself. */
static void find_blocks(ss_system *system) {
    for (int k = 0; k < system->n; k++) {
        int rows = system->Lp[k + 1] - system->Lp[k], before = k > 0 ? system->Lp[k] - system->Lp[k - 1] : 0;
        if (k == 0 || system->parent[k - 1] != k || before != rows + 1)
            system->block[system->block_count++] = k;
    }
    system->block[system->block_count] = system->n;
}

/* scratch is [2 n]. */
static skinslide_status analyse(ss_system *system, int *scratch, skinslide_error *error) {
    if (system->n > 0) {
        skinslide_status status = order(system, scratch, error);
        if (status)
            return status;
    }
    int *filled = scratch, *seen = scratch + system->n;
    fill_pattern(system, filled);
    for (int k = 0; k < system->n; k++)
        system->parent[k] = -1;
    visit_rows(system, filled, seen, false);
    for (int k = 0; k < system->n; k++)
        system->Lp[k + 1] = system->Lp[k] + filled[k];
    system->Li = SS_NEW(&system->memory, int, system->Lp[system->n]);
    if (system->memory.failed)
        return ss_out_of_memory(error);
    visit_rows(system, filled, seen, true);
    place_edges(system);
    find_blocks(system);
    return SKINSLIDE_OK;
}

/* Copies the net and numbers its free vertices as they come. */
static void copy_net(ss_system *system, const ss_net *net) {
    for (int32_t e = 0; e < net->edge_count; e++)
        system->edge_vertex[e][0] = net->edge_vertex[e][0], system->edge_vertex[e][1] = net->edge_vertex[e][1];
    for (int32_t v = 0; v < net->vertex_count; v++)
        system->unknown[v] = net->fixed[v] ? -1 : system->n++;
}

skinslide_status ss_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error) {
    ss_system *system = calloc(1, sizeof *system);
    if (!system)
        return ss_out_of_memory(error);
    ss_memory scratch_memory = {0}, *memory = &system->memory;
    int32_t vertices = net->vertex_count, edges = net->edge_count;
    system->vertex_count = vertices, system->edge_count = edges;
    for (size_t i = 0; i + 1 < sizeof system->label && label[i]; i++)
        system->label[i] = label[i];
    system->edge_vertex = ss_new(memory, edges, sizeof *system->edge_vertex);
    system->unknown = SS_NEW(memory, int32_t, vertices);
    system->entry = SS_NEW(memory, int32_t, edges);
    system->Ap = SS_NEW(memory, int, (int64_t)vertices + 1);
    system->Ai = SS_NEW(memory, int, edges);
    system->Lp = SS_NEW(memory, int, (int64_t)vertices + 1);
    system->parent = SS_NEW(memory, int, vertices);
    system->block = SS_NEW(memory, int, (int64_t)vertices + 1);
    int *scratch = SS_NEW(&scratch_memory, int, 2 * (int64_t)vertices);
    skinslide_status status = memory->failed || scratch_memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        copy_net(system, net);
        status = analyse(system, scratch, error);
    }
    ss_free(&scratch_memory);
    if (status)
        ss_system_destroy(system);
    else
        *out = system;
    return status;
}

void ss_system_destroy(ss_system *system) {
    if (!system)
        return;
    ss_free(&system->memory);
    free(system);
}

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

/* One end of an edge whose other end is fixed. */
static void hold(const ss_system *system, ss_factor *factor, int32_t vertex, const double at[2], double density) {
    int32_t k = system->unknown[vertex];
    if (k < 0)
        return;
    factor->slack[k] += density;
    factor->right[k][0] += density * at[0];
    factor->right[k][1] += density * at[1];
}

static void assemble(const ss_system *system, ss_factor *factor, const double *density, const double (*uv)[2]) {
    memset(factor->Lx, 0, (size_t)system->Lp[system->n] * sizeof *factor->Lx);
    memset(factor->slack, 0, (size_t)system->n * sizeof *factor->slack);
    memset(factor->right, 0, (size_t)system->n * sizeof *factor->right);
    for (int32_t e = 0; e < system->edge_count; e++) {
        int32_t a = system->edge_vertex[e][0], b = system->edge_vertex[e][1];
        if (system->entry[e] >= 0) {
            factor->Lx[system->entry[e]] = density[e];
        } else {
            hold(system, factor, a, uv[b], density[e]);
            hold(system, factor, b, uv[a], density[e]);
        }
    }
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

/* Lx holds the matrix at first, L after. */
static bool factorise(const ss_system *system, ss_factor *factor) {
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

static void solve(const ss_system *system, const ss_factor *factor, double (*x)[2]) {
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

skinslide_status ss_embed(const ss_system *system, ss_factor *factor, const double *density, double (*uv)[2],
                          skinslide_error *error) {
    assemble(system, factor, density, (const double(*)[2])uv);
    if (!factorise(system, factor))
        return ss_fail(error, SKINSLIDE_SINGULAR,
                       "%s: its force densities differ too much in size for the embedding to be solved", system->label);
    solve(system, factor, factor->right);
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            memcpy(uv[v], factor->right[system->unknown[v]], sizeof *uv);
    return SKINSLIDE_OK;
}
