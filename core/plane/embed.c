/* The embedding (paper, section 3.1, equations of Schek 1974). For the free vertices, with u and v each as X,
 *
 *     (C' Q C) X = -(C' Q Cf) Xf
 *
 * C is the edge-vertex incidence of the free vertices, Cf that of the fixed, Q = diag(density). The matrix has the pattern of
 * the net, so that its ordering and the pattern of its factor are found once; each pose costs one numeric factorisation, and
 * one solve for u and v together. */
#include "plane.h"

#include <string.h>

ss_net ss_net_of(const ss_patch *patch, const uint8_t *fixed) {
    return (ss_net){patch->vertex_count, patch->faces.edge_count, (const int32_t(*)[2])patch->edge_vertex, fixed};
}

static void assemble(const ss_system *system, ss_factor *factor, const double (*uv)[2]) {
    const double *density = factor->entry;
    ss_factor_clear(factor);
    for (int32_t i = 0; i < system->held_count; i++) {
        int32_t edge = system->held[i], a = system->edge_vertex[edge][0], b = system->edge_vertex[edge][1];
        bool first_is_free = system->unknown[a] >= 0;
        int32_t k = system->unknown[first_is_free ? a : b];
        const double *at = uv[first_is_free ? b : a];
        factor->slack[k] += density[edge];
        factor->right[k][0] += density[edge] * at[0];
        factor->right[k][1] += density[edge] * at[1];
    }
}

skinslide_status ss_embed(const ss_system *system, ss_factor *factor, double (*uv)[2], skinslide_error *error) {
    assemble(system, factor, (const double(*)[2])uv);
    if (!ss_factorise_and_solve(factor))
        return ss_fail(error, SKINSLIDE_SINGULAR,
                       "%s: its force densities differ too much in size for the embedding to be solved", system->label);
    for (int32_t v = 0; v < system->vertex_count; v++)
        if (system->unknown[v] >= 0)
            memcpy(uv[v], factor->right[system->unknown[v]], sizeof *uv);
    return SKINSLIDE_OK;
}

skinslide_status ss_embed_once(const ss_net *net, const char *label, const double *density, double (*uv)[2],
                               skinslide_error *error) {
    ss_system *system = NULL;
    ss_factor *factor = NULL;
    skinslide_status status = ss_system_create(net, label, &system, error);
    if (!status)
        status = ss_factor_create(system, NULL, &factor, error);
    if (!status) {
        memcpy(factor->entry, density, (size_t)system->edge_count * sizeof *density);
        status = ss_embed(system, factor, uv, error);
    }
    ss_factor_destroy(factor);
    ss_system_destroy(system);
    return status;
}
