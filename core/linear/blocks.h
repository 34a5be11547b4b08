/* What blocks.c gives to relax.c: symmetric positive definite systems of two unknowns a free vertex. */
#ifndef SKINSLIDE_BLOCKS_H
#define SKINSLIDE_BLOCKS_H

#include "internal.h"

/* A block [2][2] of a free vertex with itself, or of the two ends of an edge. */
typedef struct ss_blocks {
    ss_memory memory;
    const ss_system *system;
    double (*Lx)[4];             /* the matrix below its diagonal, then L */
    double (*own)[4];            /* [unknowns] its diagonal */
    double (*right)[2];          /* [unknowns] right side, then the solution */
    double (*pivot)[4];          /* [unknowns] D */
    double (*inverse)[4];        /* [unknowns] of D */
    double (*work)[4];           /* [unknowns] zero between columns */
    int *first, *next, *reached; /* [unknowns] runs of columns by the row they are to be used in next, and how far each was */
} ss_blocks;

skinslide_status ss_blocks_create(const ss_system *system, ss_blocks **out, skinslide_error *error);
void ss_blocks_destroy(ss_blocks *blocks);
void ss_blocks_clear(ss_blocks *blocks);
/* The place of a vertex in right, -1 where it is fixed. */
int32_t ss_blocks_unknown(const ss_blocks *blocks, int32_t vertex);
/* The diagonal block of an unknown. */
double *ss_blocks_own(ss_blocks *blocks, int32_t unknown);
/* The block between the ends of an edge, neither fixed, and whether its rows are the first end's. */
double *ss_blocks_between(ss_blocks *blocks, int32_t edge, bool *first_is_row);
/* Factors; false where the matrix is not positive definite. */
bool ss_blocks_factor(ss_blocks *blocks);
/* right becomes the solution. */
void ss_blocks_solve(ss_blocks *blocks);

#endif
