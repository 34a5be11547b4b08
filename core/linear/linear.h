/* Sparse linear systems: the only room that knows solvers. */
#ifndef SKINSLIDE_LINEAR_H
#define SKINSLIDE_LINEAR_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- order.c ---- */

/* Vertices joined by edges. The edges must outlive the system. */
typedef struct ss_net {
    int32_t vertex_count;
    int32_t edge_count;
    const int32_t (*edge_vertex)[2];
    const uint8_t *fixed; /* [vertex_count] */
} ss_net;

/* Consecutive columns of a factor that are stored with the same rows below them. */
typedef struct ss_front {
    int32_t first, count;             /* columns, which are unknowns */
    int32_t row_start, row_count;     /* the rows below them, in rows */
    int32_t entry_start, entry_count; /* entries of the matrix in the columns, in entries */
    int32_t parent, child, next; /* the front that its update goes to; its last child; the parent's child before it; or -1 */
} ss_front;

/* An entry of the matrix in a front. */
typedef struct ss_entry {
    int32_t edge;
    int32_t column, row; /* within the front, whose rows are those of its columns, then those below */
} ss_entry;

/* A symmetric system with an unknown for each free vertex of a net and an entry for each edge. Immutable. */
typedef struct ss_system {
    ss_memory memory;
    char label[160];
    int32_t vertex_count, edge_count, n; /* n unknowns */
    int32_t block;                       /* rows and columns of an entry, which the fronts are chosen for: 1 or 2 */
    const int32_t (*edge_vertex)[2];     /* the net's */
    int32_t *unknown;                    /* [vertex_count] its number in the ordered system, -1 if fixed */
    int32_t held_count;
    int32_t *held; /* [held_count] edges with one end fixed, ascending */
    int32_t front_count;
    ss_front *fronts; /* children before parents */
    int64_t row_count;
    int32_t *rows;  /* [row_count] unknowns below each front, ascending ... */
    int32_t *place; /* ... and where each is among the rows of the parent front */
    ss_entry *entries;
} ss_system;

skinslide_status ss_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error);
/* The same for ss_blocks, whose fronts pay only with fewer zeros. */
skinslide_status ss_block_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error);
void ss_system_destroy(ss_system *system);

/* For each unknown, those that share an entry with it. */
typedef struct ss_graph {
    int32_t n;
    int32_t *start; /* [n + 1] */
    int32_t *neighbour;
} ss_graph;

/* Fills the graph of a system, with the current numbers of its unknowns. */
void ss_fill_graph(const ss_system *system, ss_graph *graph);
/* Renumbers the unknowns: unknown i becomes place[i]. */
void ss_renumber(ss_system *system, const int32_t *place);

/* ---- dissect.c ---- */

/* Divides a graph into parts. out set [n]: for each unknown, the place of its part in an order with little fill, where
 * separators come after what they separate. */
skinslide_status ss_dissect(const ss_graph *graph, int32_t *set, skinslide_error *error);

/* ---- fronts.c ---- */

/* Finds the fronts of a system, and renumbers its unknowns. graph is theirs, and is renumbered too. */
skinslide_status ss_find_fronts(ss_system *system, ss_graph *graph, skinslide_error *error);

/* ---- kernels.c ---- */

/* How a front is stored: in tiles of four rows, one after the other. A tile of the columns' own rows ends with the columns on
 * its diagonal. */
typedef struct ss_shape {
    int32_t used, columns;                 /* its columns; and how many with padding */
    int32_t below;                         /* rows below */
    int32_t own_tiles, below_tiles, tiles; /* of the columns' own rows, of those below; in all */
    size_t height;                         /* numbers in the first column of its update */
} ss_shape;

/* How many numbers are in a tile, and how many in those before it. */
static inline size_t ss_tile_size(const ss_shape *s, int32_t tile) {
    return 16 * (size_t)(tile < s->own_tiles ? tile + 1 : s->own_tiles);
}

static inline size_t ss_tile_start(const ss_shape *s, int32_t tile) {
    size_t own = (size_t)s->own_tiles, t = (size_t)tile;
    return tile < s->own_tiles ? 8 * t * (t + 1) : 8 * own * (2 * t + 1 - own);
}

typedef struct ss_kernels {
    /* Factors a panel. out force, as large, is the panel before its columns are divided by their pivots. False if a pivot
     * cannot be divided by. */
    bool (*factor)(const ss_shape *s, bool dominant, double *panel, double *force);
    /* Adds what a factored panel leaves to be done to an update, or if that is new, sets it. It is stored by columns, each from
     * its own tile on. */
    void (*update)(const ss_shape *s, const double *panel, const double *force, bool is_new, double *update);
    /* For 1 or 2 right sides. Eliminates x [count][columns]; out below [count][rows below] is what is to be added there. */
    void (*forward[2])(const ss_shape *s, const double *panel, double *x, double *below);
    /* x [count][columns]: in, what forward made, divided by the pivots; out, the solution. below is the solution there. */
    void (*backward[2])(const ss_shape *s, const double *panel, double *x, const double *below);
} ss_kernels;

/* The fastest kernels for this processor, or those that run on all. */
const ss_kernels *ss_kernels_of(bool fastest);

/* ---- frontal.c, substitute.c: L D L' ---- */

/* How many numbers are in all panels, in the largest, and at most in each stack; and the most columns of a front, and rows
 * below one. */
typedef struct ss_extent {
    int64_t panels, panel, stack[2];
    int32_t columns, below;
} ss_extent;

/* One for each thread. */
typedef struct ss_frontal {
    ss_memory memory;
    const ss_system *system;
    int32_t block; /* rows and columns of an entry: 1 or 2 */
    bool dominant; /* pivots are sums, and right sides are carried along: see factor.c */
    const ss_kernels *kernels;
    ss_extent extent;
    int64_t *panel, *update; /* [front_count] where the columns of the front begin in L, and its update in a stack */
    int32_t *entry_place;    /* [edge_count] where the system's entry is in the panel of its front */
    int32_t *row_place;      /* [row_count] where the system's row begins in the panel of its front's parent */
    uint8_t *odd;            /* [front_count] which stack its update is in */
    bool keeps;              /* L has its own memory, so that it lasts */
    double *L;               /* [panels] */
    double *stack[2];        /* [stack] */
    double *force;           /* [panel] a panel before it is divided by its pivots */
    double *x, *below;       /* [2][columns], [2][below] */
} ss_frontal;

/* keeps: whether the factor lasts beyond a turn. */
skinslide_status ss_frontal_create(const ss_system *system, int32_t block, bool dominant, bool keeps, ss_frontal **out,
                                   skinslide_error *error);
void ss_frontal_destroy(ss_frontal *frontal);
/* Lays out the memory of a turn. */
void ss_frontal_lay_out(ss_frontal *frontal, ss_room *room);
ss_shape ss_shape_of(const ss_frontal *frontal, const ss_front *front);
/* False if a pivot cannot be divided by. entries is [edge_count]; slack [n] and right [n] are carried along. */
bool ss_factor_numbers(ss_frontal *frontal, const double *entries, const double *slack, const double (*right)[2]);
/* False also if the work was broken off because stop was set. own [n]; between [edge_count], with the rows of the higher
 * unknown. right [n], or NULL, is eliminated front by front. */
bool ss_factor_blocks(ss_frontal *frontal, const double (*own)[4], const double (*between)[4], double (*right)[2],
                      const int *stop);
/* The two halves of solving for right [n]: two right sides, or one in blocks. carried: the first half was done by carrying
 * right sides along, which is never so for blocks. */
void ss_eliminate_front(ss_frontal *frontal, int32_t f, double (*right)[2]);
void ss_eliminate_right(ss_frontal *frontal, double (*right)[2]);
void ss_substitute_back(ss_frontal *frontal, bool carried, double (*right)[2]);

/* ---- factor.c: entries of one number, none positive off the diagonal ---- */

/* One for each thread. */
typedef struct ss_factor {
    ss_room own;
    ss_frontal *frontal;
    double *entry;      /* [edge_count] entries off the diagonal with their signs turned: all >= 0 */
    double *slack;      /* [n] the part of each pivot that pulls towards fixed vertices */
    double (*right)[2]; /* [n] right sides, then solutions */
} ss_factor;

/* Asks the room for its memory; if room is NULL, it has a room of its own, and a single turn. */
skinslide_status ss_factor_create(const ss_system *system, ss_room *room, ss_factor **out, skinslide_error *error);
void ss_factor_destroy(ss_factor *factor);
/* Lays out the memory of a turn. */
void ss_factor_lay_out(ss_factor *factor, ss_room *room);
/* Sets slack and right to 0; the caller fills them, and entry. */
void ss_factor_clear(ss_factor *factor);
/* False if a pivot cannot be divided by. */
bool ss_factorise(ss_factor *factor);
/* Replaces right by the solutions. */
void ss_solve(ss_factor *factor);
/* Factorises, then solves. */
bool ss_factorise_and_solve(ss_factor *factor);

/* ---- blocks.c: entries of two by two ---- */

/* Entries are blocks [2][2]: of a free vertex with itself, or of the two ends of an edge. */
typedef struct ss_blocks {
    ss_room own_room;
    const ss_system *system;
    ss_frontal *frontal;
    double (*own)[4];     /* [n] */
    double (*between)[4]; /* [edge_count] with the rows of the higher unknown */
    double (*right)[2];   /* [n] right side, then the solution */
} ss_blocks;

/* As ss_factor_create. keeps: whether the factor lasts beyond a turn. */
skinslide_status ss_blocks_create(const ss_system *system, bool keeps, ss_room *room, ss_blocks **out, skinslide_error *error);
void ss_blocks_destroy(ss_blocks *blocks);
void ss_blocks_lay_out(ss_blocks *blocks, ss_room *room);
void ss_blocks_clear(ss_blocks *blocks);
/* The place of a vertex in right, -1 if it is fixed. */
static inline int32_t ss_blocks_unknown(const ss_blocks *blocks, int32_t vertex) {
    return blocks->system->unknown[vertex];
}
/* The diagonal block of an unknown. */
static inline double *ss_blocks_own(ss_blocks *blocks, int32_t unknown) {
    return blocks->own[unknown];
}
/* The block between the ends of an edge, neither fixed, and whether its rows are the first end's. */
static inline double *ss_blocks_between(ss_blocks *blocks, int32_t edge, bool *first_is_row) {
    const int32_t *v = blocks->system->edge_vertex[edge];
    *first_is_row = ss_blocks_unknown(blocks, v[0]) > ss_blocks_unknown(blocks, v[1]);
    return blocks->between[edge];
}
/* Factors. False if the matrix is not positive definite, or the work was broken off because stop was set. */
bool ss_blocks_factor(ss_blocks *blocks, const int *stop);
/* Replaces right by the solution. */
void ss_blocks_solve(ss_blocks *blocks);
/* Factors, then solves. */
bool ss_blocks_factor_and_solve(ss_blocks *blocks, const int *stop);

/* ---- springs.c: a net of springs ---- */

typedef struct ss_springs ss_springs; /* factored: immutable */

/* All edges have one stiffness, and each free vertex is held by a spring of its own, of stiffness own [vertex_count]. label
 * begins messages. Fails with SINGULAR. */
skinslide_status ss_springs_create(const ss_net *net, const char *label, double stiffness, const double *own, ss_springs **out,
                                   skinslide_error *error);
void ss_springs_destroy(ss_springs *springs);
/* The place of a vertex in right sides, -1 if it is fixed. */
int32_t ss_springs_unknown(const ss_springs *springs, int32_t vertex);
/* How many vectors of scratch ss_springs_solve takes. */
int32_t ss_springs_scratch(const ss_springs *springs);
/* Replaces right [unknowns], four right sides, by the solutions. Both arrays must be aligned to 16 bytes. */
void ss_springs_solve(const ss_springs *springs, float (*scratch)[4], float (*right)[4]);

/* ---- incomplete.c: an approximation to the normal equations of a sparse A ---- */

/* A matrix by rows. */
typedef struct ss_rows {
    int32_t row_count, column_count;
    int32_t *start; /* [row_count + 1] */
    int32_t *column;
    double *value;
} ss_rows;

typedef struct ss_incomplete ss_incomplete; /* immutable */

/* Fails: the system of a patch has more entries than can be numbered. label begins the message. */
skinslide_status ss_refuse_large(const char *label, skinslide_error *error);
/* Fails with SINGULAR if the condition of A'A leaves too few digits. rows are not kept; label begins messages. */
skinslide_status ss_incomplete_create(const ss_rows *rows, const char *label, ss_incomplete **out, skinslide_error *error);
void ss_incomplete_destroy(ss_incomplete *incomplete);
/* x [column_count]: in b, out an approximate solution of A'A x = b, by a symmetric positive definite matrix. */
void ss_incomplete_solve(const ss_incomplete *incomplete, float *x);

#ifdef __cplusplus
}
#endif

#endif
