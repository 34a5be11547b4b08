/* How far points are from a surface, and how far motion is from even, in double. */
#ifndef SKINSLIDE_TEST_DISTANCE_H
#define SKINSLIDE_TEST_DISTANCE_H

#include "support.h"

double distance_to_triangle(const double p[3], const float *a, const float *b, const float *c);
/* The distance to the nearest triangle of all fans of the mesh, with its vertices at points. */
double distance_to_mesh(const test_mesh *mesh, const float *points, const float *p);

/* How roughly points move: the largest |p0 - 2 p1 + p2| of three successive poses [vertex_count][3]. */
double largest_second_difference(float *const poses[3], int32_t vertex_count);

/* The points of a mesh at a moment of a motion, to be freed. */
typedef float *(*test_motion)(const test_mesh *mesh, double moment);
/* The largest of a slide by a rig, while a motion goes from one moment to another in so many steps. */
double roughest_slide(const rig *r, const test_mesh *mesh, test_motion motion, double from, double to, int steps);

#endif
