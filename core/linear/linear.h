/* Sparse linear systems: the only room that knows solvers. */
#ifndef SKINSLIDE_LINEAR_H
#define SKINSLIDE_LINEAR_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- order.c ---- */

/* Vertices that edges join. */
typedef struct ss_net {
    int32_t vertex_count;
    int32_t edge_count;
    const int32_t (*edge_vertex)[2];
    const uint8_t *fixed; /* [vertex_count] */
} ss_net;

/* A symmetric system with an unknown a free vertex of a net and an entry an edge: immutable. */
typedef struct ss_system {
    ss_memory memory;
    char label[160];
    int32_t vertex_count, edge_count, n; /* n unknowns */
    int32_t (*edge_vertex)[2];
    int32_t *unknown; /* [vertex_count] place in the ordered system, -1 where fixed */
    int32_t *entry;   /* [edge_count] place of the edge in Lx, -1 where an end is fixed */
    int *Ap, *Ai;     /* upper triangle of the ordered matrix, by columns, without the diagonal */
    int *Lp, *Li;     /* L by columns, rows ascending, without its diagonal of ones */
    int *parent;      /* [n] elimination tree */
    int *block;       /* [block_count + 1] first columns of runs whose rows below the run are the same */
    int block_count;
} ss_system;

skinslide_status ss_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error);
void ss_system_destroy(ss_system *system);

/* ---- factor.c: entries of one number, none positive off the diagonal ---- */

/* One a thread. */
typedef struct ss_factor {
    ss_memory memory;
    double *Lx;                  /* the entries off the diagonal, then of L, with their signs turned: all >= 0 */
    double *pivot, *slack;       /* [n] D, and what of each pivot pulls towards fixed vertices */
    double *work;                /* [n] zero between columns */
    double *force;               /* [n] of the columns of a block */
    double (*right)[2];          /* [n] right sides, then solutions */
    int *first, *next, *reached; /* [n] blocks by the row they are to be used in next, and how far each was */
} ss_factor;

skinslide_status ss_factor_create(const ss_system *system, ss_factor **out, skinslide_error *error);
void ss_factor_destroy(ss_factor *factor);
/* Empties Lx, slack and right, to be filled with the matrix and the right sides. */
void ss_factor_clear(const ss_system *system, ss_factor *factor);
/* False where a pivot is not a number to divide by. */
bool ss_factorise(const ss_system *system, ss_factor *factor);
/* right becomes the solutions. */
void ss_solve(const ss_system *system, ss_factor *factor);

/* ---- blocks.c: entries of two by two ---- */

/* A block [2][2] of a free vertex with itself, or of the two ends of an edge. */
typedef struct ss_blocks {
    ss_memory memory;
    const ss_system *system;
    double (*Lx)[4];             /* the matrix below its diagonal, then L */
    double (*own)[4];            /* [unknowns] its diagonal */
    double (*right)[2];          /* [unknowns] right side, then the solution */
    double (*pivot)[2];          /* [unknowns] D */
    double *lean;                /* [unknowns] of L, the one entry in a diagonal block that is neither 0 nor 1 */
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
/* Factors; false where the matrix is not positive definite, or work is left because of the flag. */
bool ss_blocks_factor(ss_blocks *blocks, const int *stop);
/* right becomes the solution. */
void ss_blocks_solve(ss_blocks *blocks);

/* ---- leastsquares.c: the only file that knows KLU ---- */

/* A matrix by rows. */
typedef struct ss_rows {
    int32_t row_count, column_count;
    int32_t *start; /* [row_count + 1] */
    int32_t *column;
    double *value;
} ss_rows;

typedef struct ss_least_squares ss_least_squares;           /* A'A, factored: immutable */
typedef struct ss_least_squares_work ss_least_squares_work; /* one a thread */

/* That a system of a patch has more entries than can be numbered. label begins the message. */
skinslide_status ss_refuse_large(const char *label, skinslide_error *error);
/* SINGULAR where the condition of A'A leaves too few digits. rows are only read; label begins messages. */
skinslide_status ss_least_squares_create(const ss_rows *rows, const char *label, ss_least_squares **out,
                                         skinslide_error *error);
void ss_least_squares_destroy(ss_least_squares *sparse);
skinslide_status ss_least_squares_work_create(const ss_least_squares *sparse, ss_least_squares_work **out,
                                              skinslide_error *error);
void ss_least_squares_work_destroy(ss_least_squares_work *work);
/* Puts x with A'A x = b in the place of each b of right: [count][column_count]. */
void ss_least_squares_solve(ss_least_squares_work *work, double *right, int32_t count);

#ifdef __cplusplus
}
#endif

#endif
