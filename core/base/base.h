/* Memory and errors. Names begin with ss_, so that the static library can be linked into any program. */
#ifndef SKINSLIDE_BASE_H
#define SKINSLIDE_BASE_H

#include <stdbool.h>
#include <stddef.h>

#include "skinslide/skinslide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- memory.c: an object's arrays, all freed at once ---- */

typedef struct ss_block ss_block;
typedef struct ss_memory {
    ss_block *blocks;
    bool failed; /* an allocation failed: checked once, after all of them */
} ss_memory;

/* count * size bytes of zeros, or NULL with memory->failed set. A count of 0 gives a pointer all the same. */
void *ss_new(ss_memory *memory, int64_t count, size_t size);
void ss_free(ss_memory *memory);
#define SS_NEW(memory, type, count) ((type *)ss_new((memory), (count), sizeof(type)))

/* ---- error.c ---- */

/* Fills error, where there is one, and returns status: `return ss_fail(error, SKINSLIDE_BAD_PATCH, "...", ...);` */
__attribute__((format(printf, 3, 4))) skinslide_status ss_fail(skinslide_error *error, skinslide_status status,
                                                               const char *format, ...);
skinslide_status ss_out_of_memory(skinslide_error *error);

/* ---- A flag that another thread sets, to have long work left. Whoever sees it returns early, and what it made is not used. ---- */

static inline bool ss_is_set(const int *flag) {
    return __atomic_load_n(flag, __ATOMIC_RELAXED) != 0;
}

static inline void ss_set(int *flag, int to) {
    __atomic_store_n(flag, to, __ATOMIC_RELAXED);
}

/* ---- clock.c ---- */

/* Seconds since some moment. */
double ss_now(void);
/* Adds the seconds since *since to *sum, and sets it to now. */
void ss_lap(double *since, double *sum);

/* ---- sized.c: structs of callers, which begin with a size_t, their size. name is for messages ---- */

/* BAD_ARGUMENT where the size cannot be one. */
skinslide_status ss_check_size(const void *given, const char *name, skinslide_error *error);
/* What the caller's struct has, over own, which holds its defaults; NULL: nothing. Fails also with UNSUPPORTED, where it has more
 * than own, and that is not 0. */
skinslide_status ss_take(const void *given, const char *name, void *own, size_t own_size, skinslide_error *error);
/* The same for arrays, whose elements have the size of the first. own is [count]; standard is the default of one. */
skinslide_status ss_take_all(const void *given, int64_t count, const char *name, void *own, size_t own_size,
                             const void *standard, skinslide_error *error);
/* What the caller's struct has room for, whose size was checked; what it has more is 0. */
void ss_give(const void *own, size_t own_size, void *given);
/* The same for arrays, of which only the first element need have its size. */
void ss_give_all(const void *own, int64_t count, size_t own_size, void *given);

#ifdef __cplusplus
}
#endif

#endif
