/* The paper: a patch in the plane at rest and in a frame, where each vertex is looked up there, and its place on the face. */
#ifndef SKINSLIDE_PLANE_H
#define SKINSLIDE_PLANE_H

#include "device.h"
#include "linear.h"
#include "surface.h"

#include <float.h>
#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- orient.c ---- */

/* Of the determinant below, to the sum of its products' sizes: Shewchuk's bound for this order of operations, (3 + 16 e) e with
 * e = DBL_EPSILON / 2, rounded up. */
#define SS_ORIENT_DOUBT ((3 + 10 * DBL_EPSILON) * (DBL_EPSILON / 2))

int ss_orient_exactly(const double a[2], const double b[2], const double c[2]);

/* 1 where a, b, c turn left, -1 right, 0 where they are on one line: exact for the doubles given. Here, since it is asked
 * several times a step of every walk. */
static inline int ss_orient(const double a[2], const double b[2], const double c[2]) {
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), determinant = left - right;
    double bound = SS_ORIENT_DOUBT * (fabs(left) + fabs(right));
    return determinant > bound ? 1 : determinant < -bound ? -1 : ss_orient_exactly(a, b, c);
}

/* ---- boundary.c ---- */

/* Puts the outer loop into uv [vertex_count][2]. Names the artist's corner that cannot be one. */
skinslide_status ss_place_boundary(const ss_patch *patch, skinslide_boundary boundary, const float *rest_points,
                                   double (*uv)[2], skinslide_error *error);
/* Whether the set-up's corners, where it has them, are this patch's: of several pieces, those of the one that has all four. */
bool ss_has_corners(const ss_patch *patch);
/* (cos, sin) of turns of a full circle, turns in [0,1): plain arithmetic only, so the same bits everywhere. */
void ss_circle(double turns, double out[2]);

/* ---- holes.c ---- */

/* Puts the loops of holes into uv [vertex_count][2], whose outer loop is there: where they fall with every hole capped. */
skinslide_status ss_place_holes(const ss_patch *patch, const float *rest_points, double (*uv)[2], skinslide_error *error);

/* ---- density.c ---- */

/* Force density of every edge by the patch's rule, times paint, NULL for 1. */
void ss_force_density(const ss_patch *patch, const double *lengths, const double *paint, double *density);

/* ---- embed.c ---- */

/* The edges of a patch; fixed is [vertex_count]. Both must live as long. */
ss_net ss_net_of(const ss_patch *patch, const uint8_t *fixed);
/* Solves for the free vertices of uv [vertex_count][2], whose fixed ones are given. density is [edge_count], > 0. */
skinslide_status ss_embed(const ss_system *system, ss_factor *factor, const double *density, double (*uv)[2],
                          skinslide_error *error);
/* The same for a system that is not needed again; label begins messages. */
skinslide_status ss_embed_once(const ss_net *net, const char *label, const double *density, double (*uv)[2],
                               skinslide_error *error);

/* ---- layout.c: how the faces of an embedding lie ---- */

/* The first triangle of the face that turns left and holds p, its border included; -1 where none does. */
int32_t ss_triangle_holding(const ss_patch *patch, int32_t face, const double (*uv)[2], const double p[2]);

typedef struct ss_layout {
    int32_t folded;    /* faces turned over by more than the rounding of their corners */
    int32_t collapsed; /* faces of no area, up to the same rounding */
    bool regular;      /* no hole is free, every face is convex and none is turned over at all: no two overlap */
} ss_layout;

ss_layout ss_lay_out(const ss_patch *patch, const double (*uv)[2]);

/* ---- paving.c: the triangles of an embedding as walks go over them ---- */

typedef struct ss_slab {
    int32_t vertex[3], beyond[4]; /* of the paving: slabs over each side, -1 on the border; and itself */
    int32_t triangle;             /* of the patch */
} ss_slab;

typedef struct ss_paving {
    const ss_patch *patch;
    int32_t *vertex;  /* [vertex_count] the patch's: first those of free_vertex, in their order */
    ss_slab *slab;    /* [triangle_count] */
    int32_t *slab_of; /* [triangle_count] of each of the patch's */
    double (*uv)[2];  /* [vertex_count] */
} ss_paving;

/* False where memory is short. */
bool ss_pave(ss_memory *memory, const ss_patch *patch, ss_paving *paving);
/* Takes an embedding [vertex_count], of the patch's vertices. */
void ss_paving_lay_out(ss_paving *paving, const double (*uv)[2]);
/* Walks to a slab that holds p, its border included, where none is turned over; -1 where it meets the patch's border or takes too
 * long. Adds the slabs that it entered. */
int32_t ss_paving_walk(const ss_paving *paving, int32_t from, const double p[2], bool *on_border, int64_t *steps);
/* The place of a point of a slab. */
void ss_paving_place_at(const ss_paving *paving, int32_t slab, const double p[2], ss_place *out);

/* ---- approach.c ---- */

enum { SS_AT_ONCE = 8 };
/* Takes the first steps of walks to so many points: slab is where each begins, and then where a walk to it is to go on. Returns how
 * many slabs were entered. */
int64_t ss_paving_approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]);
/* The same as processors without AVX2 do it. */
int64_t ss_paving_approach_plain(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]);

/* ---- locate.c, facetree.c ---- */

typedef struct ss_face_tree ss_face_tree; /* faces of an embedding by place */
skinslide_status ss_face_tree_create(const ss_patch *patch, ss_face_tree **out, skinslide_error *error);
void ss_face_tree_destroy(ss_face_tree *tree);
/* uv is read by the queries that follow, too. */
void ss_face_tree_build(ss_face_tree *tree, const double (*uv)[2]);
/* The lowest face that holds p, its border included; false where none does. */
bool ss_face_tree_holding(const ss_face_tree *tree, const double p[2], ss_place *out);
/* The point nearest to p on the sides of the faces, of the lowest face where several are as near. Returns the distance. */
double ss_face_tree_nearest(const ss_face_tree *tree, const double p[2], ss_place *out);
/* The point of the side that begins at a corner nearest to p. Returns the distance squared. */
double ss_nearest_on_side(const ss_faces *faces, const double (*uv)[2], int32_t corner, const double p[2], double out[2]);

typedef struct ss_located {
    int32_t centre, around; /* in the first candidate, in another */
    int32_t walked;
    int32_t searched; /* by the tree */
    int32_t clamped;  /* in no face: put on the nearest */
    int64_t steps;    /* of walks */
} ss_located;

typedef struct ss_locator ss_locator;
skinslide_status ss_locator_create(const ss_patch *patch, ss_locator **out, skinslide_error *error);
void ss_locator_destroy(ss_locator *locator);
/* Looks up query [free_count][2], in the order of free_vertex, in the faces of uv. candidates [free_count], or NULL, are only
 * a help: any faces at all give the same places. They are not looked at where the layout is not regular. */
ss_located ss_locate(ss_locator *locator, const double (*uv)[2], bool regular, const double (*query)[2],
                     const ss_candidates *candidates, ss_place *places);

/* The embedding that single places are asked of next. regular: its layout is. */
void ss_locator_set(ss_locator *locator, const double (*uv)[2], bool regular);
/* The place of p as ss_locate finds it for a vertex inside. triangle is one near by, any at all. */
ss_place ss_locate_near(ss_locator *locator, int32_t triangle, const double p[2]);

/* ---- interpolate.c ---- */

/* The displacement of every free vertex, in their order, from its own place to where it is looked up. points is the whole
 * mesh's; weights is scratch [largest face]. */
void ss_interpolate(const ss_patch *patch, const ss_flat *flat, const ss_place *places, const float *points, double *weights,
                    double (*displacement)[3]);
/* Weights, which sum to 1, of a face's corners at a point: false where a face that turned over leaves them without meaning. */
bool ss_mean_value_weights(const ss_patch *patch, const ss_flat *flat, int32_t face, const double p[2], double *weights);

/* ---- plane.c ---- */

extern const ss_rule ss_plane_rule; /* UNIT and FAST */

#ifdef __cplusplus
}
#endif

#endif
