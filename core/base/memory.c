/* An object's arrays, chained so that one call frees them: allocation is checked once, after all of it. */
#include "base.h"

#include <stdlib.h>

struct ss_block {
    ss_block *next;
    max_align_t data[];
};

void *ss_new(ss_memory *memory, int64_t count, size_t size) {
    if (memory->failed || count < 0 || (uint64_t)count > (PTRDIFF_MAX - sizeof(ss_block)) / size) {
        memory->failed = true;
        return NULL;
    }
    ss_block *block = calloc(1, sizeof *block + (size_t)count * size);
    if (!block) {
        memory->failed = true;
        return NULL;
    }
    block->next = memory->blocks;
    memory->blocks = block;
    return block->data;
}

void ss_free(ss_memory *memory) {
    while (memory->blocks) {
        ss_block *block = memory->blocks;
        memory->blocks = block->next;
        free(block);
    }
}
