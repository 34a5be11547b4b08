/* The rules of the paper: a patch laid out in the plane at rest and in a frame, the lookup of its vertices there, and where
 * they go. */
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

/* Bounds the error of the determinant below, relative to the sum of the sizes of its two products: Shewchuk's (3 + 16 e) e for
 * this order of operations, with e = DBL_EPSILON / 2, rounded up. */
#define SS_ORIENT_DOUBT ((3 + 10 * DBL_EPSILON) * (DBL_EPSILON / 2))

int ss_orient_exactly(const double a[2], const double b[2], const double c[2]);

/* 1 if a, b, c turn left, -1 if right, 0 if they are on one line: exact for the doubles given. Inline, since each step of a
 * walk asks several times. */
static inline int ss_orient(const double a[2], const double b[2], const double c[2]) {
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), determinant = left - right;
    double bound = SS_ORIENT_DOUBT * (fabs(left) + fabs(right));
    return determinant > bound ? 1 : determinant < -bound ? -1 : ss_orient_exactly(a, b, c);
}

/* ---- boundary.c ---- */

/* Puts the outer loop into uv [vertex_count][2]. Errors name the artist's corner that cannot be one. */
skinslide_status ss_place_boundary(const ss_patch *patch, skinslide_boundary boundary, const float *rest_points,
                                   double (*uv)[2], skinslide_error *error);
/* Whether the set-up has corners and they are this patch's: of several pieces, only the one with all four has them. */
bool ss_has_corners(const ss_patch *patch);
/* (cos, sin) of turns of a full circle, turns in [0,1). By plain arithmetic only, and so the same bits on every machine. */
void ss_circle(double turns, double out[2]);

/* ---- holes.c ---- */

/* Puts the loops of holes into uv [vertex_count][2], in which the outer loop is already: where they fall if every hole is
 * capped. */
skinslide_status ss_place_holes(const ss_patch *patch, const float *rest_points, double (*uv)[2], skinslide_error *error);

/* ---- density.c ---- */

/* Force density of every edge by the patch's rule, times paint, NULL for 1. */
void ss_force_density(const ss_patch *patch, const double *lengths, const double *paint, double *density);

/* ---- embed.c ---- */

/* The edges of a patch; fixed is [vertex_count]. Both must outlive the net. */
ss_net ss_net_of(const ss_patch *patch, const uint8_t *fixed);
/* Solves for the free vertices of uv [vertex_count][2], whose fixed ones are given. The factor's entries are the densities,
 * > 0. */
skinslide_status ss_embed(const ss_system *system, ss_factor *factor, double (*uv)[2], skinslide_error *error);
/* The same for a system that is not needed again, and density [edge_count]; label begins messages. */
skinslide_status ss_embed_once(const ss_net *net, const char *label, const double *density, double (*uv)[2],
                               skinslide_error *error);

/* ---- layout.c: how the faces of an embedding lie ---- */

/* The first triangle of the face that turns left and holds p, its border included; -1 if none does. */
int32_t ss_triangle_holding(const ss_patch *patch, int32_t face, const double (*uv)[2], const double p[2]);

typedef struct ss_layout {
    int32_t folded;    /* faces turned over by more than the rounding of their corners */
    int32_t collapsed; /* faces without area, up to the same rounding */
    bool regular;      /* no hole is free, and every face is convex and not turned over: so no two overlap */
} ss_layout;

ss_layout ss_lay_out(const ss_patch *patch, const double (*uv)[2]);

/* ---- paving.c: the triangles of an embedding as walks go over them ---- */

typedef struct ss_slab {
    int32_t vertex[3], beyond[4]; /* of the paving; the slab beyond each side, -1 on the border, and last itself */
    int32_t triangle;             /* of the patch */
} ss_slab;

typedef struct ss_paving {
    const ss_patch *patch;
    int32_t *vertex;  /* [vertex_count] the patch's vertices: first those of free_vertex, in that order */
    ss_slab *slab;    /* [triangle_count] */
    int32_t *slab_of; /* [triangle_count] the slab of each triangle of the patch */
    double (*uv)[2];  /* [vertex_count] */
} ss_paving;

/* False if memory is short. */
bool ss_pave(ss_memory *memory, const ss_patch *patch, ss_paving *paving);
/* Takes an embedding [vertex_count], of the patch's vertices. */
void ss_paving_lay_out(ss_paving *paving, const double (*uv)[2]);
/* Walks to a slab that holds p, its border included; no slab may be turned over. Returns -1 if the walk meets the patch's
 * border or takes too long. Adds to *steps how many slabs it entered. */
int32_t ss_paving_walk(const ss_paving *paving, int32_t from, const double p[2], bool *on_border, int64_t *steps);
/* The place of a point p in a slab. */
void ss_paving_place_at(const ss_paving *paving, int32_t slab, const double p[2], ss_place *out);

/* ---- approach.c ---- */

enum { SS_AT_ONCE = 8 };
/* Takes the first steps of walks to so many points: slab is where each begins, and then where a walk to it is to go on. found
 * says which need no walk, since that slab holds them beyond doubt: their places are filled, those of others may hold anything.
 * Returns how many slabs were entered. */
int64_t ss_paving_approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE], ss_place places[SS_AT_ONCE],
                           bool found[SS_AT_ONCE]);
/* The same as processors without AVX2 do it. */
int64_t ss_paving_approach_plain(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE],
                                 ss_place places[SS_AT_ONCE], bool found[SS_AT_ONCE]);

/* ---- locate.c, facetree.c ---- */

typedef struct ss_face_tree ss_face_tree; /* the faces of an embedding, sorted by where they are */
skinslide_status ss_face_tree_create(const ss_patch *patch, ss_face_tree **out, skinslide_error *error);
void ss_face_tree_destroy(ss_face_tree *tree);
/* Queries read uv too, until the next call. */
void ss_face_tree_build(ss_face_tree *tree, const double (*uv)[2]);
/* The place of p in the lowest face that holds it, its border included; false if none does. */
bool ss_face_tree_holding(const ss_face_tree *tree, const double p[2], ss_place *out);
/* The point nearest to p on the sides of the faces, in the lowest face if several are as near. Returns the distance. */
double ss_face_tree_nearest(const ss_face_tree *tree, const double p[2], ss_place *out);
/* The point nearest to p of the side that begins at a corner. Returns the distance squared. */
double ss_nearest_on_side(const ss_faces *faces, const double (*uv)[2], int32_t corner, const double p[2], double out[2]);

typedef struct ss_located {
    int32_t centre, around; /* queries found in the first candidate; in another candidate */
    int32_t walked;
    int32_t searched; /* queries found by the tree */
    int32_t clamped;  /* queries in no face, put on the nearest */
    int64_t steps;    /* steps of walks */
} ss_located;

typedef struct ss_locator ss_locator;
skinslide_status ss_locator_create(const ss_patch *patch, ss_locator **out, skinslide_error *error);
void ss_locator_destroy(ss_locator *locator);
/* Looks up query [free_count][2], in the order of free_vertex, in the faces of uv. candidates [free_count], or NULL, only save
 * time: any faces at all give the same places. They are not looked at if the layout is not regular. */
ss_located ss_locate(ss_locator *locator, const double (*uv)[2], bool regular, const double (*query)[2],
                     const ss_candidates *candidates, ss_place *places);

/* Sets the embedding for ss_locate_near. regular: whether its layout is. */
void ss_locator_set(ss_locator *locator, const double (*uv)[2], bool regular);
/* The place of p, as ss_locate finds it for a vertex that is on no loop. triangle is any, better one near by. */
ss_place ss_locate_near(ss_locator *locator, int32_t triangle, const double p[2]);

/* ---- interpolate.c ---- */

/* out displacement [free_count]: of every free vertex, in their order, from its own place to where it is looked up. points are
 * the whole mesh's; weights is scratch [largest face]. */
void ss_interpolate(const ss_patch *patch, const ss_flat *flat, const ss_place *places, const float *points, double *weights,
                    double (*displacement)[3]);
/* Weights of a face's corners at a point, which sum to 1. False if they are meaningless, as in a face that is turned over. */
bool ss_mean_value_weights(const ss_patch *patch, const ss_flat *flat, int32_t face, const double p[2], double *weights);

/* ---- plane.c ---- */

extern const ss_rule ss_plane_rule; /* UNIT and FAST */

#ifdef __cplusplus
}
#endif

#endif
