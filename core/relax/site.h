/* Points that slide on a patch. */
#ifndef SKINSLIDE_SITE_H
#define SKINSLIDE_SITE_H

#include "plane.h"
#include "vector.h"

/* A point of the surface: weights sum to 1, and exactly 1 is the vertex itself. */
typedef struct ss_site {
    int32_t triangle;
    double weight[3];
} ss_site;

ss_site ss_site_of_vertex(const ss_triangles *triangles, int32_t vertex);
/* Which vertex of its triangle the site is on, or -1. */
int ss_site_corner(const ss_site *site);
/* The weighted sum of values [vertex_count][2]. */
void ss_site_blend(const ss_triangles *triangles, const ss_site *site, const double (*values)[2], double out[2]);
void ss_site_place(const ss_posed *pose, const ss_site *site, double out[3]);
/* As a location for ss_interpolate, uv being the embedding [vertex_count][2] that it will be given, and back. */
ss_location ss_site_location(const ss_triangles *triangles, const ss_site *site, const double (*uv)[2]);
ss_site ss_location_site(const ss_triangles *triangles, const ss_location *location, const double (*uv)[2]);
/* Walks straight in the plane to uv, or to the border. */
void ss_site_walk(const ss_posed *plane, ss_site *site, const double uv[2]);
/* The same, but no farther than limit measured in the pose. Returns how far. */
double ss_site_trace(const ss_posed *plane, const ss_posed *pose, ss_site *site, const double uv[2], double limit);
/* For a site on the border: the direction in which faces go round it there, and a walk along it that far. */
void ss_site_border(const ss_posed *pose, const ss_site *site, double out[3]);
void ss_site_walk_border(const ss_posed *pose, ss_site *site, double distance);
/* How far the site is along its loop from a vertex of it, the shorter way: less than 0 against the faces' way. */
double ss_site_border_distance(const ss_posed *pose, int32_t vertex, const ss_site *site);

#endif
