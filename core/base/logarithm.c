/* Logarithm and exponential by + - * / alone, which every machine rounds alike; the C library's choose by what a processor has. */
#include "base.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

static const double root_of_half = 0x1.6a09e667f3bcdp-1;
/* ln 2 in two parts: a multiple of the first by a binary exponent is exact. */
static const double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;

/* Of x = m 2^exponent with m from root_of_half up to twice that:
 * log m = 2 (s + s^3/3 + s^5/5 + ...),  s = (m - 1) / (m + 1)  at most 0.172. */
INLINE double log_of(double m, double exponent) {
    double s = (m - 1) / (m + 1), square = s * s, sum = square * (1.0 / 21);
    sum = square * (sum + 1.0 / 19), sum = square * (sum + 1.0 / 17), sum = square * (sum + 1.0 / 15);
    sum = square * (sum + 1.0 / 13), sum = square * (sum + 1.0 / 11), sum = square * (sum + 1.0 / 9);
    sum = square * (sum + 1.0 / 7), sum = square * (sum + 1.0 / 5), sum = square * (sum + 1.0 / 3);
    return exponent * ln2_high + (2 * s + (2 * s * sum + exponent * ln2_low));
}

/* Any: also of what is too small for all its digits. */
double ss_log(double x) {
    int exponent;
    double m = frexp(x, &exponent);
    bool low = m < root_of_half;
    return log_of(low ? 2 * m : m, low ? exponent - 1 : exponent);
}

/* The same of a normal number, by its bits and without a branch, so that several are computed at once. The exponent counts from
 * the bits of root_of_half; it becomes a double as the last bits of one of 2^52 and more. */
INLINE double log_of_normal(double x) {
    const uint64_t root = UINT64_C(0x3fe6a09e667f3bcd), above = UINT64_C(0x400) << 52, large = UINT64_C(0x433) << 52;
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint64_t raised = (bits - root + above) >> 52, mantissa = bits - (raised << 52) + above, counted = raised | large;
    double m, exponent;
    memcpy(&m, &mantissa, sizeof m);
    memcpy(&exponent, &counted, sizeof exponent);
    return log_of(m, exponent - (0x1p52 + 0x400));
}

static void logs_of_normal(int32_t count, double *x) {
    for (int32_t i = 0; i < count; i++)
        x[i] = log_of_normal(x[i]);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void logs_of_normal_avx2(int32_t count, double *x) {
    for (int32_t i = 0; i < count; i++)
        x[i] = log_of_normal(x[i]);
}
#endif

static bool are_normal(int32_t count, const double *x) {
    int64_t normal = 0;
    for (int32_t i = 0; i < count; i++)
        normal += x[i] >= DBL_MIN;
    return normal == count;
}

void ss_logs_plain(int32_t count, double *x) {
    if (are_normal(count, x))
        logs_of_normal(count, x);
    else
        for (int32_t i = 0; i < count; i++)
            x[i] = ss_log(x[i]);
}

void ss_logs(int32_t count, double *x) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2") && are_normal(count, x)) {
        logs_of_normal_avx2(count, x);
        return;
    }
#endif
    ss_logs_plain(count, x);
}

/* x = e ln 2 + r, |r| at most ln 2 / 2: the series of exp r. */
double ss_exp(double x) {
    double exponent = floor(x / (ln2_high + ln2_low) + 0.5), r = x - exponent * ln2_high - exponent * ln2_low, sum = 1;
    for (int k = 15; k >= 1; k--)
        sum = 1 + r / k * sum;
    return ldexp(sum, (int)exponent);
}
