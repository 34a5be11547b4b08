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

/* An exponent, and 0x400 to keep it positive, becomes a double as the last bits of one of 2^52 and more. */
static const uint64_t above = UINT64_C(0x400) << 52, large = UINT64_C(0x433) << 52;

/* Of normal numbers, by their bits and without a branch. The exponent counts from the bits of root_of_half. */
SS_INLINE void take_logs_of_normal(ss_four x[VECTORS]) {
    const uint64_t root = UINT64_C(0x3fe6a09e667f3bcd);
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

/* ---- Of quotients, for measures: one division each, and a shorter series ---- */

/* With x = m 2^exponent and m from 2/3 up to 3/2 of y:
 *
 *     log(x / y) / 2 = exponent ln 2 / 2 + s + s^3 (1/3 + s^2/5 + ...),    s = (m - y) / (m + y) at most 0.2
 *
 * Of the series in brackets this is the interpolation by seven terms at Chebyshev's points, within 6e-17 of the whole. Both are
 * normal, and half of either is. */
SS_INLINE void take_halved_logs(const ss_four x[VECTORS], const ss_four y[VECTORS], ss_four out[VECTORS]) {
    const uint64_t half = UINT64_C(1) << 51;
    for (int k = 0; k < VECTORS; k++) {
        bits raised = ((bits)x[k] - (bits)y[k] + half + above) >> 52;
        ss_four m = (ss_four)((bits)x[k] - (raised << 52) + above), exponent = (ss_four)(raised | large) - (0x1p52 + 0x400);
        ss_four s = (m - y[k]) / (m + y[k]), square = s * s, fourth = square * square;
        ss_four low = (0x1.555555555556dp-2 + 0x1.999999997cd24p-3 * square) +
                      (0x1.24924951743bbp-3 + 0x1.c71c3d608a2f4p-4 * square) * fourth;
        ss_four high = (0x1.746b9dab90793p-4 + 0x1.390565d08943ep-4 * square) + 0x1.3587371ccaae8p-4 * fourth;
        out[k] = exponent * (0.5 * (ln2_high + ln2_low)) + (s + s * square * (low + high * (fourth * fourth)));
    }
}

static double sum_of(ss_four x) {
    return (x[0] + x[1]) + (x[2] + x[3]);
}

/* Whatever they are: each log is added to one of four sums. */
static double sum_squares_of_any(int32_t count, const double *x, const double *y) {
    ss_four sum = {0};
    for (int32_t i = 0; i < count; i++) {
        double halved = ss_log(x[i] / y[i]) / 2;
        sum[i % 4] += halved * halved;
    }
    return 4 * sum_of(sum);
}

/* The same of numbers of which all, and half of them, are normal. A topmost bit in other says that some are not. */
SS_INLINE void add_squares(const double *x, const double *y, ss_four *sum, bits *other) {
    const uint64_t least = UINT64_C(2) << 52;
    ss_four dividend[VECTORS], divisor[VECTORS], halved[VECTORS];
    take(x, dividend), take(y, divisor);
    take_halved_logs(dividend, divisor, halved);
    for (int k = 0; k < VECTORS; k++) {
        *sum += halved[k] * halved[k];
        *other |= ((bits)dividend[k] - least) | ((bits)divisor[k] - least);
    }
}

SS_INLINE double sum_squares(int32_t count, const double *x, const double *y) {
    ss_four sum = {0};
    bits other = {0};
    double last[2][AT_ONCE];
    int32_t whole = count / AT_ONCE * AT_ONCE;
    for (int32_t i = 0; i < whole; i += AT_ONCE)
        add_squares(x + i, y + i, &sum, &other);
    fill_up(count - whole, x + whole, last[0]), fill_up(count - whole, y + whole, last[1]);
    add_squares(last[0], last[1], &sum, &other);
    return (other[0] | other[1] | other[2] | other[3]) >> 63 ? sum_squares_of_any(count, x, y) : 4 * sum_of(sum);
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
