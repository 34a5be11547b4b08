/* The embedding's system. Its matrix is special: no entry off the diagonal is positive, and each diagonal entry is the sum of
 * the others of its row and of a slack >= 0, the densities to fixed vertices. Elimination keeps that form. So, with the slack
 * carried along (Grassmann, Taksar, Heyman 1985), nothing is ever subtracted: no digits are lost however much densities differ,
 * and u and v are the convex combinations that they should be. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

void ss_factor_lay_out(ss_factor *factor, ss_room *room) {
    const ss_system *system = factor->frontal->system;
    factor->entry = SS_TAKE(room, double, system->edge_count);
    factor->slack = SS_TAKE(room, double, system->n);
    factor->right = ss_take_room(room, system->n, sizeof *factor->right);
    ss_frontal_lay_out(factor->frontal, room);
}

static skinslide_status find_room(ss_factor *factor, ss_room *room, skinslide_error *error) {
    ss_room counted = {0};
    ss_factor_lay_out(factor, &counted);
    if (!ss_find_room(room, &factor->own, &counted))
        return ss_out_of_memory(error);
    if (!room)
        ss_factor_lay_out(factor, &factor->own);
    return SKINSLIDE_OK;
}

skinslide_status ss_factor_create(const ss_system *system, ss_room *room, ss_factor **out, skinslide_error *error) {
    ss_factor *factor = calloc(1, sizeof *factor);
    if (!factor)
        return ss_out_of_memory(error);
    skinslide_status status = ss_frontal_create(system, 1, true, false, &factor->frontal, error);
    if (!status)
        status = find_room(factor, room, error);
    if (status)
        ss_factor_destroy(factor);
    else
        *out = factor;
    return status;
}

void ss_factor_destroy(ss_factor *factor) {
    if (!factor)
        return;
    ss_frontal_destroy(factor->frontal);
    ss_free(&factor->own.memory);
    free(factor);
}

void ss_factor_clear(ss_factor *factor) {
    size_t n = (size_t)factor->frontal->system->n;
    memset(factor->slack, 0, n * sizeof *factor->slack);
    memset(factor->right, 0, n * sizeof *factor->right);
}

bool ss_factorise(ss_factor *factor) {
    return ss_factor_numbers(factor->frontal, factor->entry, factor->slack, (const double(*)[2])factor->right);
}

void ss_solve(ss_factor *factor) {
    ss_eliminate_right(factor->frontal, factor->right);
    ss_substitute_back(factor->frontal, false, factor->right);
}

bool ss_factorise_and_solve(ss_factor *factor) {
    bool good = ss_factorise(factor);
    if (good)
        ss_substitute_back(factor->frontal, true, factor->right);
    return good;
}
