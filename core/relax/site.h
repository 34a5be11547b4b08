/* Points that slide on a patch: what triangles.c and site.c give to chart.c, relax.c and travel.c. */
#ifndef SKINSLIDE_SITE_H
#define SKINSLIDE_SITE_H

#include "internal.h"
#include "vector.h"

/* ---- triangles.c ---- */

/* The triangles of the fans of a patch's faces, and how they meet: immutable. Side k of a triangle goes from its vertex k to
 * the next. */
typedef struct ss_surface {
    ss_memory memory;
    const ss_patch *patch;
    int32_t triangle_count;
    int32_t (*vertex)[3];     /* [triangle_count] patch vertices */
    int32_t (*neighbour)[3];  /* [triangle_count] over each side, -1 on the border */
    int32_t *face;            /* [triangle_count] patch face */
    int32_t *first_triangle;  /* [face_count] */
    int32_t *vertex_triangle; /* [vertex_count] a triangle at the vertex; on the border the one whose side leaves along it */
} ss_surface;

skinslide_status ss_surface_create(const ss_patch *patch, ss_surface **out, skinslide_error *error);
void ss_surface_destroy(ss_surface *surface);
/* Which vertex of the triangle a patch vertex is. */
int ss_triangle_corner(const ss_surface *surface, int32_t triangle, int32_t vertex);

/* A triangle in a pose. */
typedef struct ss_facet {
    double first[3], second[3]; /* from its vertex 0 to 1 and 2 */
    double gram[3];             /* the inverse of their products: 11, 12, 22 */
    double normal[3];           /* of unit length */
    bool has_area;
} ss_facet;

typedef struct ss_shape {
    const ss_surface *surface;
    double (*point)[3]; /* [vertex_count] */
    ss_facet *facet;    /* [triangle_count] */
} ss_shape;

/* The patch's of the whole mesh's points: [vertex_count][3]. */
void ss_take_points(const ss_patch *patch, const float *points, double (*out)[3]);
bool ss_shape_allocate(ss_memory *memory, const ss_surface *surface, ss_shape *pose);
/* points is the whole mesh's. */
void ss_shape_set(ss_shape *pose, const float *points);
/* The plane as a pose: an embedding uv [vertex_count][2], to walk straight in. */
void ss_shape_set_plane(ss_shape *pose, const double (*uv)[2]);

/* ---- site.c ---- */

/* A point of the surface: weights sum to 1, and exactly 1 is the vertex itself. */
typedef struct ss_site {
    int32_t triangle;
    double weight[3];
} ss_site;

ss_site ss_site_of_vertex(const ss_surface *surface, int32_t vertex);
/* Which vertex of its triangle the site is on, or -1. */
int ss_site_corner(const ss_site *site);
/* The weighted sum of values [vertex_count][2]. */
void ss_site_blend(const ss_surface *surface, const ss_site *site, const double (*values)[2], double out[2]);
void ss_site_place(const ss_shape *pose, const ss_site *site, double out[3]);
/* As a location for ss_interpolate, uv being the embedding [vertex_count][2] that it will be given, and back. */
ss_location ss_site_location(const ss_surface *surface, const ss_site *site, const double (*uv)[2]);
ss_site ss_location_site(const ss_surface *surface, const ss_location *location, const double (*uv)[2]);
/* Walks straight in the plane to uv, or to the border. */
void ss_site_walk(const ss_shape *plane, ss_site *site, const double uv[2]);
/* The same, but no farther than limit measured in the pose. Returns how far. */
double ss_site_trace(const ss_shape *plane, const ss_shape *pose, ss_site *site, const double uv[2], double limit);
/* For a site on the border: the direction in which faces go round it there, and a walk along it that far. */
void ss_site_border(const ss_shape *pose, const ss_site *site, double out[3]);
void ss_site_walk_border(const ss_shape *pose, ss_site *site, double distance);
/* How far the site is along its loop from a vertex of it, the shorter way: less than 0 against the faces' way. */
double ss_site_border_distance(const ss_shape *pose, int32_t vertex, const ss_site *site);

#endif
