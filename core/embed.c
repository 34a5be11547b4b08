/* The embedding (paper, section 3.1, equations of Schek 1974): for the free vertices, and for u and v each,
 *
 *     (C' Q C) X = -(C' Q Cf) Xf
 *
 * C is the edge-vertex incidence of the free vertices, Cf that of the fixed, Q = diag(density). The matrix is symmetric
 * positive definite wherever every free vertex is connected to a fixed one; its pattern is that of the net, so ordering (AMD)
 * and elimination tree are found once, and each pose costs one L D L' factorisation (LDL; Davis 2005) and two solves. */
#include "internal.h"

#include <amd.h>
#include <ldl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

struct ss_system {
    ss_memory memory;
    char label[160];
    int32_t vertex_count, edge_count, n; /* n unknowns */
    int32_t (*edge_vertex)[2];
    int32_t *unknown;  /* [vertex_count] place in the ordered system, -1 where fixed */
    int32_t *entry;    /* [edge_count] place of the edge's -q in values, -1 where an end is fixed */
    int32_t *diagonal; /* [n] place of each diagonal in values */
    int *Ap, *Ai;      /* upper triangle of the ordered matrix, by columns */
    int *Lp, *parent;
    int *counts; /* [n] entries of each column of L */
};

struct ss_factor {
    ss_memory memory;
    double *values, *Lx, *D, *row, *right[2];
    double *held; /* [n] sum of densities to fixed vertices: the right side where all of those are at 1 */
    int *Li, *counts, *pattern, *flag;
};

static bool joins_free(const ss_system *system, int32_t edge) {
    return system->unknown[system->edge_vertex[edge][0]] >= 0 && system->unknown[system->edge_vertex[edge][1]] >= 0;
}

/* Columns of the upper triangle, with the diagonal, in whatever order the unknowns have now; entry and diagonal say where each
 * value goes. filled is scratch [n]. */
static void fill_pattern(ss_system *system, int32_t *filled) {
    for (int32_t k = 0; k <= system->n; k++)
        system->Ap[k] = 0;
    for (int32_t pass = 0; pass < 2; pass++) {
        for (int32_t k = 0; k < system->n; k++) {
            filled[k] = 1;
            if (pass)
                system->Ai[system->diagonal[k] = system->Ap[k]] = k;
        }
        for (int32_t e = 0; e < system->edge_count; e++) {
            system->entry[e] = -1;
            if (!joins_free(system, e))
                continue;
            int32_t a = system->unknown[system->edge_vertex[e][0]], b = system->unknown[system->edge_vertex[e][1]];
            int32_t column = a > b ? a : b;
            if (pass)
                system->Ai[system->entry[e] = system->Ap[column] + filled[column]] = a < b ? a : b;
            filled[column]++;
        }
        if (!pass)
            for (int32_t k = 0; k < system->n; k++)
                system->Ap[k + 1] = system->Ap[k] + filled[k];
    }
}

/* Renumbers the unknowns by approximate minimum degree. scratch is [2 n]. */
static skinslide_status order(ss_system *system, int32_t *scratch, skinslide_error *error) {
    double info[AMD_INFO];
    int32_t *permutation = scratch, *place = scratch + system->n;
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

static skinslide_status analyse(ss_system *system, int32_t *scratch, skinslide_error *error) {
    if (system->n == 0)
        return SKINSLIDE_OK;
    skinslide_status status = order(system, scratch, error);
    if (status)
        return status;
    fill_pattern(system, scratch);
    ldl_symbolic(system->n, system->Ap, system->Ai, system->Lp, system->parent, system->counts, scratch, NULL, NULL);
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
    system->diagonal = SS_NEW(memory, int32_t, vertices);
    system->Ap = SS_NEW(memory, int, (int64_t)vertices + 1);
    system->Ai = SS_NEW(memory, int, (int64_t)edges + vertices);
    system->Lp = SS_NEW(memory, int, (int64_t)vertices + 1);
    system->parent = SS_NEW(memory, int, vertices);
    system->counts = SS_NEW(memory, int, vertices);
    int32_t *scratch = SS_NEW(&scratch_memory, int32_t, 2 * (int64_t)vertices);
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
    factor->values = SS_NEW(memory, double, system->Ap[n]);
    factor->Lx = SS_NEW(memory, double, system->Lp[n]);
    factor->Li = SS_NEW(memory, int, system->Lp[n]);
    factor->D = SS_NEW(memory, double, n);
    factor->row = SS_NEW(memory, double, n);
    factor->right[0] = SS_NEW(memory, double, n);
    factor->right[1] = SS_NEW(memory, double, n);
    factor->held = SS_NEW(memory, double, n);
    factor->counts = SS_NEW(memory, int, n);
    factor->pattern = SS_NEW(memory, int, n);
    factor->flag = SS_NEW(memory, int, n);
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

/* One end of an edge: density on the diagonal, and to the right side where the other end is fixed. */
static void add_end(const ss_system *system, ss_factor *factor, int32_t vertex, int32_t other, double density,
                    const double (*uv)[2]) {
    int32_t k = system->unknown[vertex];
    if (k < 0)
        return;
    factor->values[system->diagonal[k]] += density;
    if (system->unknown[other] >= 0)
        return;
    factor->held[k] += density;
    factor->right[0][k] += density * uv[other][0];
    factor->right[1][k] += density * uv[other][1];
}

static void assemble(const ss_system *system, ss_factor *factor, const double *density, const double (*uv)[2]) {
    for (int32_t k = 0; k < system->n; k++)
        factor->values[system->diagonal[k]] = factor->right[0][k] = factor->right[1][k] = factor->held[k] = 0;
    for (int32_t e = 0; e < system->edge_count; e++) {
        int32_t a = system->edge_vertex[e][0], b = system->edge_vertex[e][1];
        if (system->entry[e] >= 0)
            factor->values[system->entry[e]] = -density[e];
        add_end(system, factor, a, b, density[e], uv);
        add_end(system, factor, b, a, density[e], uv);
    }
}

static void solve(const ss_system *system, ss_factor *factor, double *x) {
    int *Lp = system->Lp;
    ldl_lsolve(system->n, x, Lp, factor->Li, factor->Lx);
    ldl_dsolve(system->n, x, factor->D);
    ldl_ltsolve(system->n, x, Lp, factor->Li, factor->Lx);
}

/* With every fixed vertex at 1 the solution is 1. What it is off by is what rounding took of small densities beside large ones:
 * the same share is missing from every embedding. */
static bool is_accurate(const ss_system *system, ss_factor *factor) {
    bool accurate = true;
    solve(system, factor, factor->held);
    for (int32_t k = 0; k < system->n; k++)
        accurate = accurate && fabs(factor->held[k] - 1) < 1e-6;
    return accurate;
}

/* Whether densities differ so much that rounding may matter: below this, a million unknowns keep six digits. */
static bool is_uneven(const ss_system *system, const double *density) {
    double least = INFINITY, most = 0;
    for (int32_t e = 0; e < system->edge_count; e++) {
        least = density[e] < least ? density[e] : least;
        most = density[e] > most ? density[e] : most;
    }
    return most > 1e4 * least;
}

skinslide_status ss_embed(const ss_system *system, ss_factor *factor, const double *density, double (*uv)[2],
                          skinslide_error *error) {
    if (system->n == 0)
        return SKINSLIDE_OK;
    assemble(system, factor, density, (const double(*)[2])uv);
    int done = ldl_numeric(system->n, system->Ap, system->Ai, factor->values, system->Lp, system->parent, factor->counts,
                           factor->Li, factor->Lx, factor->D, factor->row, factor->pattern, factor->flag, NULL, NULL);
    bool positive = done == system->n;
    for (int32_t k = 0; k < system->n && positive; k++)
        positive = factor->D[k] > 0 && isfinite(factor->D[k]);
    if (!positive || (is_uneven(system, density) && !is_accurate(system, factor)))
        return ss_fail(error, SKINSLIDE_SINGULAR,
                       "%s: its force densities differ too much in size for the embedding to be solved", system->label);
    solve(system, factor, factor->right[0]);
    solve(system, factor, factor->right[1]);
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            uv[v][0] = factor->right[0][system->unknown[v]], uv[v][1] = factor->right[1][system->unknown[v]];
    return SKINSLIDE_OK;
}
