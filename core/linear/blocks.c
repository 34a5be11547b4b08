/* Positive definite systems with two unknowns for each vertex and entries of any sign. Pivots are numbers, not blocks, so that
 * no more digits are lost than the condition of the matrix costs, even if the two unknowns of a vertex differ much in scale. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

void ss_blocks_lay_out(ss_blocks *blocks, ss_room *room) {
    blocks->own = ss_take_room(room, blocks->system->n, sizeof *blocks->own);
    blocks->between = ss_take_room(room, blocks->system->edge_count, sizeof *blocks->between);
    blocks->right = ss_take_room(room, blocks->system->n, sizeof *blocks->right);
    ss_frontal_lay_out(blocks->frontal, room);
}

static skinslide_status find_room(ss_blocks *blocks, ss_room *room, skinslide_error *error) {
    ss_room counted = {0};
    ss_blocks_lay_out(blocks, &counted);
    if (!ss_find_room(room, &blocks->own_room, &counted))
        return ss_out_of_memory(error);
    if (!room)
        ss_blocks_lay_out(blocks, &blocks->own_room);
    return SKINSLIDE_OK;
}

skinslide_status ss_blocks_create(const ss_system *system, bool keeps, ss_room *room, ss_blocks **out, skinslide_error *error) {
    ss_blocks *blocks = calloc(1, sizeof *blocks);
    if (!blocks)
        return ss_out_of_memory(error);
    blocks->system = system;
    skinslide_status status = ss_frontal_create(system, 2, false, keeps, &blocks->frontal, error);
    if (!status)
        status = find_room(blocks, room, error);
    if (status)
        ss_blocks_destroy(blocks);
    else
        *out = blocks;
    return status;
}

void ss_blocks_destroy(ss_blocks *blocks) {
    if (!blocks)
        return;
    ss_frontal_destroy(blocks->frontal);
    ss_free(&blocks->own_room.memory);
    free(blocks);
}

void ss_blocks_clear(ss_blocks *blocks) {
    size_t n = (size_t)blocks->system->n;
    memset(blocks->own, 0, n * sizeof *blocks->own);
    memset(blocks->between, 0, (size_t)blocks->system->edge_count * sizeof *blocks->between);
    memset(blocks->right, 0, n * sizeof *blocks->right);
}

static bool factor(ss_blocks *blocks, double (*right)[2], const int *stop) {
    return ss_factor_blocks(blocks->frontal, (const double(*)[4])blocks->own, (const double(*)[4])blocks->between, right, stop);
}

bool ss_blocks_factor(ss_blocks *blocks, const int *stop) {
    return factor(blocks, NULL, stop);
}

void ss_blocks_solve(ss_blocks *blocks) {
    ss_eliminate_right(blocks->frontal, blocks->right);
    ss_substitute_back(blocks->frontal, false, blocks->right);
}

bool ss_blocks_factor_and_solve(ss_blocks *blocks, const int *stop) {
    bool good = factor(blocks, blocks->right, stop);
    if (good)
        ss_substitute_back(blocks->frontal, false, blocks->right);
    return good;
}
