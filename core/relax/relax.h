/* The rule `relaxed`: from where `even` leaves skin, to where it is least stretched on the pose itself. With d the slides along
 * tangents of rest, as there,
 *
 *     sum of k S(z(d)) + hold k |D_b - D_a|^2 / l^2  +  sum of a |d - d_even|^2
 *
 * over edges and over vertices; S' = s, the bounded stretch of `even`, D the slides in space. It is lowered by three damped
 * Newton steps, always, in which z changes with d as the pose does, smoothed from vertex to vertex; a holds vertices near where
 * they were, the more the cache crushes skin there. So every step is a smooth function of the pose, and skin does not pass from
 * one lowest place to another in a frame or two. Of steps that add stretch to what the cache has, a part is taken that does not.
 * Weights are shares of the whole slide, as `even` has them. */
#ifndef SKINSLIDE_RELAX_H
#define SKINSLIDE_RELAX_H

#include "even.h"

/* ---- relax.c ---- */

/* Memory of one thread for one patch. */
typedef struct ss_relaxer {
    ss_evener *evener;        /* where skin is */
    ss_blocks *blocks;        /* it and what follows are laid out for a frame alone */
    double (*gradient)[3][3]; /* [vertex_count] how a point of the pose moves with the place on rest that it is of */
    ss_pair (*axis)[3];       /* [vertex_count] how each vertex moves in the pose by its two unknowns */
    double (*even)[2];        /* [vertex_count] d_even */
    double *anchor;           /* [vertex_count] a */
} ss_relaxer;

/* Asks the room for its part. */
skinslide_status ss_relaxer_create(const ss_sheet *sheet, ss_room *room, ss_relaxer **out, skinslide_error *error);
void ss_relaxer_destroy(ss_relaxer *relaxer);
/* Begins a turn. */
void ss_relaxer_lay_out(ss_relaxer *relaxer, ss_room *room);
/* Slides every vertex from its own place. Adds to *cut how many steps were cut short by a face. Returns through *steps how many
 * were taken on the pose: three, where the model of each can be solved. Fails with SINGULAR. */
skinslide_status ss_relax(ss_relaxer *relaxer, const ss_frame *frame, int32_t *steps, int32_t *cut, skinslide_error *error);

/* ---- gradient.c ---- */

/* Of the evener's pose. */
void ss_find_gradients(ss_relaxer *relaxer);
/* Sets the axes where vertices are. */
void ss_find_axes(ss_relaxer *relaxer);

/* ---- model.c ---- */

/* Sets the anchors of a frame: skin is where the cache has it, or has been evened out since. */
void ss_set_anchors(ss_relaxer *relaxer);
/* Fills the blocks with the model of the energy where vertices are, whose stretch and axes are found. */
void ss_fill_model(ss_relaxer *relaxer, const ss_frame *frame);

/* ---- relaxed.c ---- */

extern const ss_rule ss_relaxed_rule;

#endif
