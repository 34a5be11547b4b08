/* Memory, errors, clocks, callers' structs, vectors. Internal names begin with ss_, so that the static library can be linked
 * into any program. */
#ifndef SKINSLIDE_BASE_H
#define SKINSLIDE_BASE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

/* count * size bytes of zeros, or NULL with memory->failed set. Never NULL for a count of 0. */
void *ss_new(ss_memory *memory, int64_t count, size_t size);
void ss_free(ss_memory *memory);
/* Takes over all that another has. */
void ss_adopt(ss_memory *memory, ss_memory *other);
#define SS_NEW(memory, type, count) ((type *)ss_new((memory), (count), sizeof(type)))

/* ---- memory.c: room for arrays of several objects that are at work by turns ---- */

/* Scratch memory that several objects use by turns: whenever an object's turn comes, it takes its arrays one after the other,
 * with anything in them. To find out how much it needs, it first takes them from a room without bytes, which returns NULL and
 * counts; the shared room is then made for the largest of them. */
typedef struct ss_room {
    ss_memory memory;
    char *bytes;
    int64_t size, taken; /* bytes that there are, or are asked for; bytes taken so far in this turn */
} ss_room;

static inline void ss_begin_turn(ss_room *room) {
    room->taken = 0;
}
/* The next array of a turn, from the beginning of a cache line on. */
void *ss_take_room(ss_room *room, int64_t count, size_t size);
#define SS_TAKE(room, type, count) ((type *)ss_take_room((room), (count), sizeof(type)))
/* Asks for at least as much as was counted. */
void ss_ask_room(ss_room *room, const ss_room *counted);
/* Makes what was asked for. False if memory is short. */
bool ss_make_room(ss_room *room);
/* Asks the shared room for as much as was counted or, if that is NULL, makes the object's own of that size. False if memory is
 * short. */
bool ss_find_room(ss_room *shared, ss_room *own, const ss_room *counted);

/* ---- error.c ---- */

/* Fills error, if it is not NULL, and returns status: `return ss_fail(error, SKINSLIDE_BAD_PATCH, "...", ...);` */
__attribute__((format(printf, 3, 4))) skinslide_status ss_fail(skinslide_error *error, skinslide_status status,
                                                               const char *format, ...);
skinslide_status ss_out_of_memory(skinslide_error *error);

/* ---- A flag that another thread sets, to have long work left. Who sees it returns early: what it made is not used ---- */

static inline bool ss_is_set(const int *flag) {
    return __atomic_load_n(flag, __ATOMIC_RELAXED) != 0;
}

static inline void ss_set(int *flag, int to) {
    __atomic_store_n(flag, to, __ATOMIC_RELAXED);
}

/* ---- logarithm.c: the same bytes on every machine ---- */

/* The logarithm of finite x > 0; of 1 exactly 0. */
double ss_log(double x);
/* The logarithms of several numbers, in place: the same bits, faster. */
void ss_logs(int32_t count, double *x);
/* The sum of log^2(x / y), of numbers above 0 and under 1e300; exactly 0 if each x is its y. */
double ss_sum_squared_logs(int32_t count, const double *x, const double *y);
/* The same as processors without AVX2 do them. */
void ss_logs_plain(int32_t count, double *x);
double ss_sum_squared_logs_plain(int32_t count, const double *x, const double *y);
/* The exponential of x, |x| under 700. */
double ss_exp(double x);

/* ---- clock.c ---- */

/* Seconds since some moment. */
double ss_now(void);
/* Adds the seconds since *since to *sum, and sets it to now. */
void ss_lap(double *since, double *sum);

/* ---- sized.c: structs of callers, which begin with a size_t, their size. name is for messages ---- */

/* Fails with BAD_ARGUMENT if the size cannot be that of a struct. */
skinslide_status ss_check_size(const void *given, const char *name, skinslide_error *error);
/* Copies the caller's struct over own, which holds the defaults of members that it lacks; given may be NULL. Fails also with
 * UNSUPPORTED if it has members that own lacks, and these are not 0. */
skinslide_status ss_take(const void *given, const char *name, void *own, size_t own_size, skinslide_error *error);
/* The same for an array, whose elements all have the size of the first. own is [count]; standard is the default of an
 * element. */
skinslide_status ss_take_all(const void *given, int64_t count, const char *name, void *own, size_t own_size,
                             const void *standard, skinslide_error *error);
/* Copies as much of own as the caller's struct has room for; members that own lacks become 0. Its size is checked. */
void ss_give(const void *own, size_t own_size, void *given);
/* The same for an array, of which only the first element need have its size set. */
void ss_give_all(const void *own, int64_t count, size_t own_size, void *given);

/* ---- Halves: IEEE 754 binary16, as bits ---- */

/* Exact: a half has a sign, 5 bits of exponent and 10 of fraction. */
static inline float ss_half_to_float(uint16_t half) {
    int exponent = half >> 10 & 31, fraction = half & 1023;
    float size = exponent == 31 ? (fraction ? NAN : INFINITY)
                 : exponent     ? ldexpf((float)(1024 + fraction), exponent - 25)
                                : ldexpf((float)fraction, -24);
    return half & 0x8000 ? -size : size;
}

/* Whether all three coordinates of a point are finite. */
static inline bool ss_is_finite(const float point[3]) {
    return isfinite(point[0]) && isfinite(point[1]) && isfinite(point[2]);
}

/* Whether all of several numbers are finite: one that is not has the largest exponent, and adding 1 to that sets the sign. */
static inline bool ss_all_finite(int64_t count, const float *x) {
    uint32_t signs = 0;
    for (int64_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, x + i, sizeof bits);
        signs |= (bits & UINT32_C(0x7fffffff)) + UINT32_C(0x00800000);
    }
    return signs >> 31 == 0;
}

/* ---- Code for processors that do several things at once ---- */

/* For functions whose arguments are constants, or whose target is another, once they are in their caller. */
#define SS_INLINE static inline __attribute__((always_inline))

/* Two or four doubles at once; those that are loose need no more alignment than a double. */
typedef double ss_two __attribute__((vector_size(16)));
typedef double ss_loose_two __attribute__((vector_size(16), aligned(8), may_alias));
typedef double ss_four __attribute__((vector_size(32)));
typedef double ss_loose_four __attribute__((vector_size(32), aligned(8), may_alias));

/* ---- Vectors of three doubles ---- */

#define SS_PI 3.14159265358979323846

/* Like fmin and fmax, but inline. If a is NaN, b. */
static inline double ss_least(double a, double b) {
    return a < b ? a : b;
}

static inline double ss_most(double a, double b) {
    return a > b ? a : b;
}

static inline double ss_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double ss_length(const double a[3]) {
    return sqrt(ss_dot(a, a));
}

/* The distance between two of points [][3]. */
static inline double ss_distance(const float *points, int32_t a, int32_t b) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = (double)points[3 * (int64_t)b + k] - points[3 * (int64_t)a + k];
    return ss_length(way);
}

static inline void ss_subtract(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* out += factor a */
static inline void ss_add(double factor, const double a[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] += factor * a[k];
}

static inline void ss_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Makes a vector's length 1; one of no length stays. */
static inline void ss_normalise(double a[3]) {
    double length = ss_length(a);
    for (int k = 0; k < 3 && length > 0; k++)
        a[k] /= length;
}

#ifdef __cplusplus
}
#endif

#endif
