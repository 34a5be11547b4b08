/* Logarithm and exponential by + - * / alone, which every machine rounds alike; the C library's differ by what the processor
 * has. */
#include "base.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double root_of_half = 0x1.6a09e667f3bcdp-1;
/* ln 2 in two parts: a multiple of the first by a binary exponent is exact. */
static const double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;

/* Of x = m 2^exponent with m from root_of_half up to twice that:
 * log m = 2 (s + s^3/3 + s^5/5 + ...),  s = (m - 1) / (m + 1)  at most 0.172. */
SS_INLINE double log_of(double m, double exponent) {
    double s = (m - 1) / (m + 1), square = s * s, sum = square * (1.0 / 21);
    sum = square * (sum + 1.0 / 19), sum = square * (sum + 1.0 / 17), sum = square * (sum + 1.0 / 15);
    sum = square * (sum + 1.0 / 13), sum = square * (sum + 1.0 / 11), sum = square * (sum + 1.0 / 9);
    sum = square * (sum + 1.0 / 7), sum = square * (sum + 1.0 / 5), sum = square * (sum + 1.0 / 3);
    return exponent * ln2_high + (2 * s + (2 * s * sum + exponent * ln2_low));
}

/* Of any x, subnormal numbers too. */
double ss_log(double x) {
    int exponent;
    double m = frexp(x, &exponent);
    bool low = m < root_of_half;
    return log_of(low ? 2 * m : m, low ? exponent - 1 : exponent);
}

/* ---- Several at once: each step of all of them before the next, since a step of one has to wait for the one before ---- */

enum { VECTORS = 4, AT_ONCE = 4 * VECTORS };
typedef uint64_t bits __attribute__((vector_size(32)));

SS_INLINE void take(const double *from, ss_four x[VECTORS]) {
    for (int k = 0; k < VECTORS; k++)
        x[k] = *(const ss_loose_four *)(from + 4 * k);
}

SS_INLINE void put(const ss_four x[VECTORS], double *to) {
    for (int k = 0; k < VECTORS; k++)
        *(ss_loose_four *)(to + 4 * k) = x[k];
}

SS_INLINE bool are_normal(const ss_four x[VECTORS]) {
    bits normal = ~(bits){0};
    for (int k = 0; k < VECTORS; k++)
        normal &= (bits)(x[k] >= DBL_MIN);
    return normal[0] & normal[1] & normal[2] & normal[3];
}

/* Of normal numbers, by their bits and without a branch. The exponent counts from the bits of root_of_half; it becomes a double as the
 * last bits of one of 2^52 and more. */
SS_INLINE void take_logs_of_normal(ss_four x[VECTORS]) {
    const uint64_t root = UINT64_C(0x3fe6a09e667f3bcd), above = UINT64_C(0x400) << 52, large = UINT64_C(0x433) << 52;
    ss_four exponent[VECTORS], s[VECTORS], square[VECTORS], sum[VECTORS];
    for (int k = 0; k < VECTORS; k++) {
        bits raised = ((bits)x[k] - root + above) >> 52;
        ss_four m = (ss_four)((bits)x[k] - (raised << 52) + above);
        exponent[k] = (ss_four)(raised | large) - (0x1p52 + 0x400);
        s[k] = (m - 1) / (m + 1), square[k] = s[k] * s[k], sum[k] = square[k] * (1.0 / 21);
    }
    for (int divisor = 19; divisor >= 3; divisor -= 2)
        for (int k = 0; k < VECTORS; k++)
            sum[k] = square[k] * (sum[k] + 1.0 / divisor);
    for (int k = 0; k < VECTORS; k++)
        x[k] = exponent[k] * ln2_high + (2 * s[k] + (2 * s[k] * sum[k] + exponent[k] * ln2_low));
}

SS_INLINE void take_logs(ss_four x[VECTORS]) {
    double each[AT_ONCE];
    if (are_normal(x)) {
        take_logs_of_normal(x);
        return;
    }
    put(x, each);
    for (int i = 0; i < AT_ONCE; i++)
        each[i] = ss_log(each[i]);
    take(each, x);
}

/* Fewer than AT_ONCE, then ones. */
SS_INLINE void fill_up(int32_t count, const double *x, double out[AT_ONCE]) {
    for (int32_t i = 0; i < AT_ONCE; i++)
        out[i] = i < count ? x[i] : 1;
}

SS_INLINE void logs(int32_t count, double *x) {
    ss_four some[VECTORS];
    double last[AT_ONCE];
    for (; count >= AT_ONCE; count -= AT_ONCE, x += AT_ONCE) {
        take(x, some);
        take_logs(some);
        put(some, x);
    }
    fill_up(count, x, last);
    take(last, some);
    take_logs(some);
    put(some, last);
    memcpy(x, last, (size_t)count * sizeof *x);
}

/* Adds to sum the squares of logs of as many quotients, one after the other. */
SS_INLINE double add_squares(const double *x, const double *y, double sum) {
    ss_four quotient[VECTORS], divisor[VECTORS];
    take(x, quotient), take(y, divisor);
    for (int k = 0; k < VECTORS; k++)
        quotient[k] /= divisor[k];
    take_logs(quotient);
    for (int k = 0; k < VECTORS; k++) {
        ss_four square = quotient[k] * quotient[k];
        for (int j = 0; j < 4; j++)
            sum += square[j];
    }
    return sum;
}

SS_INLINE double sum_squares(int32_t count, const double *x, const double *y) {
    double sum = 0, last[2][AT_ONCE];
    for (; count >= AT_ONCE; count -= AT_ONCE, x += AT_ONCE, y += AT_ONCE)
        sum = add_squares(x, y, sum);
    fill_up(count, x, last[0]), fill_up(count, y, last[1]);
    return add_squares(last[0], last[1], sum);
}

void ss_logs_plain(int32_t count, double *x) {
    logs(count, x);
}

double ss_sum_squared_logs_plain(int32_t count, const double *x, const double *y) {
    return sum_squares(count, x, y);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void logs_avx2(int32_t count, double *x) {
    logs(count, x);
}

__attribute__((target("avx2"))) static double sum_squares_avx2(int32_t count, const double *x, const double *y) {
    return sum_squares(count, x, y);
}
#endif

void ss_logs(int32_t count, double *x) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        logs_avx2(count, x);
        return;
    }
#endif
    ss_logs_plain(count, x);
}

double ss_sum_squared_logs(int32_t count, const double *x, const double *y) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return sum_squares_avx2(count, x, y);
#endif
    return ss_sum_squared_logs_plain(count, x, y);
}

/* x = e ln 2 + r, |r| at most ln 2 / 2: the series of exp r. */
double ss_exp(double x) {
    double exponent = floor(x / (ln2_high + ln2_low) + 0.5), r = x - exponent * ln2_high - exponent * ln2_low, sum = 1;
    for (int k = 15; k >= 1; k--)
        sum = 1 + r / k * sum;
    return ldexp(sum, (int)exponent);
}
