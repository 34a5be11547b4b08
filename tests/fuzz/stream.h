/* The bytes of a fuzzer as the choices that a target makes: what is left when they are used up is zeros. */
#ifndef SKINSLIDE_FUZZ_STREAM_H
#define SKINSLIDE_FUZZ_STREAM_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* What libFuzzer calls. Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct stream {
    const uint8_t *data;
    size_t left;
} stream;

static inline void take(stream *s, void *out, size_t size) {
    size_t given = size < s->left ? size : s->left;
    memset(out, 0, size);
    if (given > 0)
        memcpy(out, s->data, given);
    s->data += given, s->left -= given;
}

/* Bytes of their own memory, so that a sanitizer sees one read too many. To be freed. */
static inline void *take_new(stream *s, size_t size) {
    void *out = malloc(size ? size : 1);
    if (!out)
        abort();
    take(s, out, size);
    return out;
}

/* 0 to bound - 1, bound up to 256. */
static inline int32_t take_below(stream *s, int32_t bound) {
    uint8_t byte;
    take(s, &byte, 1);
    return byte % bound;
}

/* A property that must hold. */
static inline void require(int holds) {
    if (!holds)
        abort();
}

#endif
