/* Vectors of three doubles. */
#ifndef SKINSLIDE_VECTOR_H
#define SKINSLIDE_VECTOR_H

#include <math.h>

static inline double ss_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double ss_length(const double a[3]) {
    return sqrt(ss_dot(a, a));
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

/* A vector of no length stays. */
static inline void ss_normalise(double a[3]) {
    double length = ss_length(a);
    for (int k = 0; k < 3 && length > 0; k++)
        a[k] /= length;
}

#endif
