/* Logarithm and exponential by + - * / alone, which every machine rounds alike; the C library's choose by what a processor has. */
#include "base.h"

#include <math.h>

static const double root_of_half = 0x1.6a09e667f3bcdp-1;
/* ln 2 in two parts: a multiple of the first by a binary exponent is exact. */
static const double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;

/* x = m 2^e with m about 1, and  log m = 2 (s + s^3/3 + s^5/5 + ...),  s = (m - 1) / (m + 1)  at most 0.172. */
double ss_log(double x) {
    int exponent;
    double m = frexp(x, &exponent), sum = 0;
    if (m < root_of_half)
        m *= 2, exponent--;
    double s = (m - 1) / (m + 1), square = s * s;
    for (int k = 21; k >= 3; k -= 2)
        sum = square * (sum + 1.0 / k);
    return exponent * ln2_high + (2 * s + (2 * s * sum + exponent * ln2_low));
}

/* x = e ln 2 + r, |r| at most ln 2 / 2: the series of exp r. */
double ss_exp(double x) {
    double exponent = floor(x / (ln2_high + ln2_low) + 0.5), r = x - exponent * ln2_high - exponent * ln2_low, sum = 1;
    for (int k = 15; k >= 1; k--)
        sum = 1 + r / k * sum;
    return ldexp(sum, (int)exponent);
}
