/* The pattern of a symmetric system whose off-diagonal entries are the edges of a net: an order of its unknowns with little
 * fill in the factor, and the fronts of that factor. Found once for each net. Small systems are ordered by approximate minimum
 * degree alone, large ones by a nested dissection, and by approximate minimum degree within its parts (SuiteSparse's CAMD). */
#include "linear.h"

#include <camd.h>
#include <limits.h>
#include <stdlib.h>

#define LARGE 2000 /* unknowns: from here on, dissection gives less fill */

static skinslide_status refuse_large(const ss_system *system, double entries, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: its system is too large, %.0f entries", system->label, entries);
}

/* ---- The graph of the unknowns ---- */

static skinslide_status new_graph(const ss_system *system, ss_memory *memory, ss_graph *graph, skinslide_error *error) {
    if (system->edge_count > INT32_MAX / 2)
        return refuse_large(system, system->edge_count, error);
    graph->n = system->n;
    graph->start = SS_NEW(memory, int32_t, (int64_t)system->n + 1);
    graph->neighbour = SS_NEW(memory, int32_t, 2 * (int64_t)system->edge_count);
    return memory->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

void ss_fill_graph(const ss_system *system, ss_graph *graph) {
    int32_t *start = graph->start;
    for (int32_t k = 0; k <= graph->n; k++)
        start[k] = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t e = 0; e < system->edge_count; e++) {
            int32_t a = system->unknown[system->edge_vertex[e][0]], b = system->unknown[system->edge_vertex[e][1]];
            if (a < 0 || b < 0)
                continue;
            if (pass)
                graph->neighbour[--start[a]] = b, graph->neighbour[--start[b]] = a;
            else
                start[a]++, start[b]++;
        }
        for (int32_t k = 0; k < graph->n && !pass; k++)
            start[k + 1] += start[k];
    }
}

void ss_renumber(ss_system *system, const int32_t *place) {
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            system->unknown[v] = place[system->unknown[v]];
}

/* ---- The order ---- */

static skinslide_status minimum_degree(const ss_system *system, const ss_graph *graph, int32_t *set, int32_t *order,
                                       skinslide_error *error) {
    double info[CAMD_INFO];
    int status = camd_order(graph->n, graph->start, graph->neighbour, order, NULL, info, set);
    if (status == CAMD_OUT_OF_MEMORY)
        return ss_out_of_memory(error);
    if (status < 0)
        return ss_fail(error, SKINSLIDE_SINGULAR, "%s: its system cannot be ordered", system->label);
    if (info[CAMD_LNZ] > INT_MAX / 2)
        return refuse_large(system, info[CAMD_LNZ], error);
    return SKINSLIDE_OK;
}

static skinslide_status order_unknowns(ss_system *system, const ss_graph *graph, skinslide_error *error) {
    ss_memory scratch = {0};
    int32_t n = system->n, *order = SS_NEW(&scratch, int32_t, n), *place = SS_NEW(&scratch, int32_t, n), *set = NULL;
    if (n >= LARGE)
        set = SS_NEW(&scratch, int32_t, n);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status && set)
        status = ss_dissect(graph, set, error);
    if (!status)
        status = minimum_degree(system, graph, set, order, error);
    for (int32_t k = 0; k < n && !status; k++)
        place[order[k]] = k;
    if (!status)
        ss_renumber(system, place);
    ss_free(&scratch);
    return status;
}

static skinslide_status analyse(ss_system *system, skinslide_error *error) {
    ss_memory scratch = {0};
    ss_graph graph;
    if (system->n == 0)
        return SKINSLIDE_OK;
    skinslide_status status = new_graph(system, &scratch, &graph, error);
    if (!status) {
        ss_fill_graph(system, &graph);
        status = order_unknowns(system, &graph, error);
    }
    if (!status) {
        ss_fill_graph(system, &graph);
        status = ss_find_fronts(system, &graph, error);
    }
    ss_free(&scratch);
    return status;
}

/* Numbers the free vertices of the net in their own order. */
static void number_free(ss_system *system, const ss_net *net) {
    for (int32_t v = 0; v < net->vertex_count; v++)
        system->unknown[v] = net->fixed[v] ? -1 : system->n++;
}

static bool is_held(const ss_system *system, int32_t edge) {
    const int32_t *v = system->edge_vertex[edge];
    return (system->unknown[v[0]] < 0) != (system->unknown[v[1]] < 0);
}

static bool list_held(ss_system *system) {
    for (int32_t e = 0; e < system->edge_count; e++)
        system->held_count += is_held(system, e);
    system->held = SS_NEW(&system->memory, int32_t, system->held_count);
    for (int32_t e = 0, i = 0; e < system->edge_count && system->held; e++)
        if (is_held(system, e))
            system->held[i++] = e;
    return system->held;
}

static skinslide_status create(const ss_net *net, int32_t block, const char *label, ss_system **out, skinslide_error *error) {
    ss_system *system = calloc(1, sizeof *system);
    if (!system)
        return ss_out_of_memory(error);
    system->vertex_count = net->vertex_count, system->edge_count = net->edge_count, system->edge_vertex = net->edge_vertex;
    system->block = block;
    for (size_t i = 0; i + 1 < sizeof system->label && label[i]; i++)
        system->label[i] = label[i];
    system->unknown = SS_NEW(&system->memory, int32_t, net->vertex_count);
    skinslide_status status = system->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        number_free(system, net);
        status = list_held(system) ? analyse(system, error) : ss_out_of_memory(error);
    }
    if (status)
        ss_system_destroy(system);
    else
        *out = system;
    return status;
}

skinslide_status ss_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error) {
    return create(net, 1, label, out, error);
}

skinslide_status ss_block_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error) {
    return create(net, 2, label, out, error);
}

void ss_system_destroy(ss_system *system) {
    if (!system)
        return;
    ss_free(&system->memory);
    free(system);
}
