/* How far a point is from a surface, in double. */
#ifndef SKINSLIDE_TEST_DISTANCE_H
#define SKINSLIDE_TEST_DISTANCE_H

#include "support.h"

double distance_to_triangle(const double p[3], const float *a, const float *b, const float *c);
/* To the nearest triangle of all fans of the mesh, its vertices at points. */
double distance_to_mesh(const test_mesh *mesh, const float *points, const float *p);

#endif
