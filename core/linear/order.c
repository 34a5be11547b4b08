/* The pattern of a symmetric system whose off-diagonal entries are the edges of a net: its unknowns in the order that fills its
 * factor least (SuiteSparse's AMD), where the factor has entries, and which of its columns go together. Found once a net. */
#include "linear.h"

#include <amd.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

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
