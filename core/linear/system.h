/* The pattern that embed.c finds and blocks.c uses again. */
#ifndef SKINSLIDE_SYSTEM_H
#define SKINSLIDE_SYSTEM_H

#include "internal.h"

struct ss_system {
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
};

#endif
