/* An object's arrays, chained so that one call frees them: allocation is checked once, after all of it. And room that objects
 * share. */
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

void ss_adopt(ss_memory *memory, ss_memory *other) {
    ss_block **end = &other->blocks;
    while (*end)
        end = &(*end)->next;
    *end = memory->blocks;
    memory->blocks = other->blocks;
    other->blocks = NULL;
}

enum { LINE = 64 }; /* bytes of a cache line, which no two arrays of a room share */

void *ss_take_room(ss_room *room, int64_t count, size_t size) {
    char *array = room->bytes ? room->bytes + room->taken : NULL;
    room->taken += (count * (int64_t)size + LINE - 1) / LINE * LINE;
    return array;
}

void ss_ask_room(ss_room *room, const ss_room *counted) {
    room->size = counted->taken > room->size ? counted->taken : room->size;
}

bool ss_make_room(ss_room *room) {
    char *bytes = SS_NEW(&room->memory, char, room->size + LINE);
    room->bytes = bytes ? bytes + LINE - (uintptr_t)bytes % LINE : NULL;
    return room->bytes != NULL;
}

bool ss_find_room(ss_room *shared, ss_room *own, const ss_room *counted) {
    ss_ask_room(shared ? shared : own, counted);
    return shared || ss_make_room(own);
}
