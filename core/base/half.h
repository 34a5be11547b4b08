/* Halves: IEEE 754 binary16, as bits. */
#ifndef SKINSLIDE_HALF_H
#define SKINSLIDE_HALF_H

#include <math.h>
#include <stdint.h>

/* Sign, 5 bits of exponent, 10 of fraction; exact as a float. */
static inline float ss_half_to_float(uint16_t half) {
    int exponent = half >> 10 & 31, fraction = half & 1023;
    float size = exponent == 31 ? (fraction ? NAN : INFINITY)
                 : exponent     ? ldexpf((float)(1024 + fraction), exponent - 25)
                                : ldexpf((float)fraction, -24);
    return half & 0x8000 ? -size : size;
}

#endif
