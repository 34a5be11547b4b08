/* Points to look up in an embedding, mostly awkward ones. */
#ifndef SKINSLIDE_TEST_QUERIES_H
#define SKINSLIDE_TEST_QUERIES_H

#include "support.h"

/* Anywhere in or a little outside the square; a vertex; on a side, exactly or almost; on a diagonal of a fan; 1e-9 or a unit in
 * the last place from one of these. */
void random_query(const ss_faces *faces, const double (*uv)[2], dice *d, double out[2]);

/* Random uv for every vertex, so that faces overlap, turn over and cross themselves. */
double (*tangled(const ss_patch *patch, uint64_t seed))[2];

/* The length of a triangle's longest side, in the plane. */
double longest_side(const double *a, const double *b, const double *c);

/* Asserts that the weights of vertices [count] sum to 1 and give p. */
void expect_point(const double (*uv)[2], const int32_t *vertices, int32_t count, const double *weights, const double p[2],
                  double tolerance);

#endif
