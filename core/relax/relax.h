/* The rule `relaxed`: starts where `even` leaves skin, and goes on to where it is stretched least on the pose itself. With d
 * the slides along tangents of rest, and s and z as in even.h, the energy
 *
 *     sum of k S(z(d)) + hold k |D_b - D_a|^2 / l^2  +  sum of a |d - d_even|^2
 *
 * over edges and over vertices, S' = s and D the slides in space, is lowered by three damped Newton steps, always. The
 * derivative of z by d is that on the pose, smoothed from vertex to vertex; a holds vertices near d_even, more where the cache
 * crushes skin. So every step is a smooth function of the pose, and skin does not jump from one minimum to another in a frame
 * or two. If the steps stretch skin more than the cache does, only a part of them is taken. Weights are shares of the whole
 * slide, as in `even`. */
#ifndef SKINSLIDE_RELAX_H
#define SKINSLIDE_RELAX_H

#include "even.h"

/* ---- relax.c ---- */

/* Memory of one thread for one patch. */
typedef struct ss_relaxer {
    ss_evener *evener;        /* where skin is: the slide's */
    ss_blocks *blocks;        /* of the model; what it holds, and what follows, lasts for one frame */
    double (*gradient)[3][3]; /* [vertex_count] derivative of a point on the pose by its place on rest */
    ss_pair (*axis)[3];       /* [vertex_count] how the vertex moves on the pose with its two unknowns */
    double (*even)[2];        /* [vertex_count] d_even */
    double *anchor;           /* [vertex_count] a */
} ss_relaxer;

/* Asks the room for the memory of a frame. The evener, which must have bonds, outlives it. */
skinslide_status ss_relaxer_create(ss_evener *evener, ss_room *room, ss_relaxer **out, skinslide_error *error);
void ss_relaxer_destroy(ss_relaxer *relaxer);
/* Lays out the memory of a frame: begins a turn. */
void ss_relaxer_lay_out(ss_relaxer *relaxer, ss_room *room);
/* Slides every vertex from its own place. Adds to *cut how many steps a face cut short. *steps is how many were taken on the
 * pose: three, if the model of each can be solved. Fails with SINGULAR. */
skinslide_status ss_relax(ss_relaxer *relaxer, const ss_frame *frame, int32_t *steps, int32_t *cut, skinslide_error *error);

/* ---- gradient.c ---- */

/* Sets the gradients, from the evener's pose. */
void ss_find_gradients(ss_relaxer *relaxer);
/* Sets the axes of all vertices where they are now. */
void ss_find_axes(ss_relaxer *relaxer);

/* ---- model.c ---- */

/* Sets the anchors of a frame, once the evener has slid: d_even is its slide. */
void ss_set_anchors(ss_relaxer *relaxer);
/* Fills the blocks with the model of the energy where the vertices are now. Their stretch and axes must have been found
 * there. */
void ss_fill_model(ss_relaxer *relaxer, const ss_frame *frame);

/* ---- relaxed.c ---- */

extern const ss_rule ss_relaxed_rule;

#endif
