/* Systems of two unknowns a vertex: positive definite, of any signs. Pivots are numbers and not blocks, so that no more digits are
 * lost than the matrix costs, however far apart the two unknowns of a vertex are. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

skinslide_status ss_blocks_create(const ss_system *system, ss_blocks **out, skinslide_error *error) {
    ss_blocks *blocks = calloc(1, sizeof *blocks);
    if (!blocks)
        return ss_out_of_memory(error);
    blocks->system = system;
    blocks->own = ss_new(&blocks->memory, system->n, sizeof *blocks->own);
    blocks->between = ss_new(&blocks->memory, system->edge_count, sizeof *blocks->between);
    blocks->right = ss_new(&blocks->memory, system->n, sizeof *blocks->right);
    skinslide_status status = blocks->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_frontal_create(system, 2, false, &blocks->frontal, error);
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
    ss_free(&blocks->memory);
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
