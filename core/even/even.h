/* The rule `even`: stretch evened out over the rest surface itself, on any patch, open or closed, with no plane. With d the slides
 * of the vertices along tangents of rest,
 *
 *     J' k s(z(d)) + eta B d = 0
 *
 * z of an edge is the logarithm of how much longer it is, where its ends have slid to on the pose, than at rest, and s what of
 * that drives; k is its painted force density. J is how z changes with d at rest; B holds neighbours together, more where the cache
 * crushes skin. K = J' k J + eta B depends on the pose by that alone, and
 *
 *     d <- K^-1 J' k (J d - s(z(d)))
 *
 * is done four times, always, from 0: what comes is smooth in the pose, and no frame depends on another. */
#ifndef SKINSLIDE_EVEN_H
#define SKINSLIDE_EVEN_H

#include "linear.h"
#include "surface.h"

/* ---- sheet.c ---- */

/* An edge of which an end may slide. */
typedef struct ss_spring {
    int32_t edge;
    int32_t end[2];
    double square;      /* of its length at rest; 0 where that is under the patch's shortest: such an edge only holds */
    double slope[2][2]; /* J: of its z as either end slides along its tangents */
} ss_spring;

/* A patch at rest, and what of that every frame needs: immutable. */
typedef struct ss_sheet {
    ss_memory memory;
    const ss_patch *patch;
    ss_ground ground;        /* rest; its tangents are the sheet's */
    uint8_t *held;           /* [vertex_count] fixed, or without a normal or a way along its loop */
    double *slides;          /* [vertex_count] 1, and 0 of held ones: weights of a whole slide */
    double (*tangent)[2][3]; /* [vertex_count] unit; along a free loop the first alone, and the second is 0 */
    int32_t *degree;         /* [vertex_count] springs at the vertex */
    int32_t spring_count;
    ss_spring *springs;
    double (*between)[2][2]; /* [spring_count] as ss_multiply_tangents has them; NULL before ss_sheet_multiply */
    double (*flat)[2];       /* [corner_count] faces at rest, each in its own plane */
    double (*normal)[3];     /* [face_count] of that plane, of unit length */
    double *area;            /* [face_count] twice, in the plane */
    uint8_t *turned;         /* [face_count] which are turned over against the normals of their corners at rest already */
    ss_system *system;       /* of what K joins */
} ss_sheet;

/* rest_points is the whole mesh's. */
skinslide_status ss_sheet_create(const ss_patch *patch, const float *rest_points, ss_sheet **out, skinslide_error *error);
/* Lists the products of tangents, for a rule that needs them at each step. False where memory is short. */
bool ss_sheet_multiply(ss_sheet *sheet);
void ss_sheet_destroy(ss_sheet *sheet);
/* Products of the tangents at the first end of a spring with those at the second. */
static inline void ss_multiply_tangents(const ss_sheet *sheet, const ss_spring *spring, double out[2][2]) {
    const int32_t *v = spring->end;
    for (int k = 0; k < 4; k++)
        out[k / 2][k % 2] = ss_dot(sheet->tangent[v[0]][k / 2], sheet->tangent[v[1]][k % 2]);
}

/* ---- balance.c ---- */

/* How much an edge is stretched, and its force density. */
typedef struct ss_weighted {
    double z, k;
} ss_weighted;

/* How much of a face one step may take. */
typedef struct ss_caution {
    double most_lost;  /* of what it has over the least area */
    double least_area; /* of that at rest */
} ss_caution;

typedef double ss_pair __attribute__((vector_size(16), may_alias));

/* Memory of one thread for one patch, and where its slide has got to. */
typedef struct ss_evener {
    ss_memory memory;
    const ss_sheet *sheet;
    bool bonds_needed; /* what bonds and loads are is of use beyond K; else, where K is as it was, no share is below 1 */
    ss_blocks *K;      /* factored for the paint, weights and holds below, from frame to frame */
    bool factored;
    double *paint;                   /* [edge_count] */
    double *weight, *hold;           /* [vertex_count]; the weight is a share of the largest, and 0 of held vertices */
    int32_t *moving;                 /* [vertex_count] the unknown, or -1 where it has no weight */
    double most_weight;              /* the largest of the frame; what follows is laid out for a frame alone */
    double *next_weight, *next_hold; /* of the frame that begins */
    double *bond;                    /* [spring_count] what holds its ends together, over eta */
    double *bonds;                   /* [vertex_count] the sums of that over its springs ... */
    double *load;                    /* [vertex_count] ... and of k / l^2 */
    double *crush;                   /* [vertex_count] how much the cache crushes skin */
    ss_posed pose;                   /* its facets are set where ways are limited */
    ss_place *place;                 /* [vertex_count] where each vertex is, if its weight is not 0 */
    int32_t *walking;                /* [vertex_count] scratch for those that walk over faces */
    double (*at)[3];                 /* [vertex_count] of it in the pose */
    double (*up)[3];                 /* [vertex_count] scratch for normals */
    double (*slide)[2];              /* [vertex_count] d */
    double (*step)[2];               /* [vertex_count] to be added to it */
    ss_caution caution;              /* of that step */
    double *stretch;                 /* [spring_count] z */
    double scale;                    /* of the frame, to be taken off z */
    double (*whole)[2];              /* [vertex_count] the slide as if all shares were 1, where some are less */
    double *anchor;                  /* [vertex_count] */
    ss_pair (*straight)[3]; /* [vertex_count] where it has slid to at rest, along its tangents; and the step from there */
    double *part;           /* [vertex_count] of a step that is taken */
    double *reach;          /* [face_count] the part that each face lets be taken, 1 at most */
    ss_weighted *sorted;    /* [spring_count] */
} ss_evener;

/* Asks the room for its part. */
skinslide_status ss_evener_create(const ss_sheet *sheet, bool bonds_needed, ss_room *room, ss_evener **out,
                                  skinslide_error *error);
void ss_evener_destroy(ss_evener *evener);
/* Begins a turn. */
void ss_evener_lay_out(ss_evener *evener, ss_room *room);
/* Slides every vertex from its own place. Adds to *cut how many of the steps were cut short by a face. Fails with SINGULAR. */
skinslide_status ss_even_out(ss_evener *evener, const ss_frame *frame, int32_t *cut, skinslide_error *error);

/* What that is made of. To begin a frame: every vertex at its own place, the scale, and how the frame crushes and holds. */
void ss_set_out(ss_evener *evener, const ss_frame *frame);
/* Every vertex back at its own place. */
void ss_go_home(ss_evener *evener);
/* The steps from there, by weights [vertex_count]. */
skinslide_status ss_slide_by(ss_evener *evener, const ss_frame *frame, const double *weight, int32_t *cut,
                             skinslide_error *error);
/* Keeps the slide for what shares are of. */
void ss_keep_whole(ss_evener *evener);
/* Leaves a part of the slide beyond from [vertex_count]. */
void ss_keep_part(ss_evener *evener, const double (*from)[2], double part);
/* In the end: leaves of the slide what the largest of the weights does. */
void ss_scale_slide(ss_evener *evener);
/* Measures the stretch where vertices are. */
void ss_measure_stretch(ss_evener *evener);
/* The sum of the squares of what was measured, over the scale. */
double ss_sum_stretch(const ss_evener *evener);
/* s(z), z over the scale, by what answers stretch and compression, and how fast that changes with z. What drives skin apart comes to
 * half at most. Without a branch or a call, so that several are found at once: z - |z| is 2 z where it is less than 0, else 0. */
static inline double ss_drive(double stretch_response, double compression_response, double z, double *slope) {
    double share = z - fabs(z), inverse = 1 / sqrt(1 + share * share);
    double bounded = (z < 0 ? compression_response : stretch_response) * inverse;
    *slope = bounded * inverse * inverse;
    return bounded * z;
}
/* Shortens the step, and takes it. Returns whether a face cut it short. */
bool ss_take_step(ss_evener *evener, ss_caution caution);
/* Where every free vertex is, in their order: [free_count]. */
void ss_write_places(const ss_evener *evener, ss_place *places);

/* ---- limits.c ---- */

/* Cuts ways of the last slide short that are longer in the pose than the frame lets them be. */
void ss_limit_ways(ss_evener *evener, const ss_frame *frame, ss_place *places);

/* ---- stiffness.c ---- */

/* Makes K that of the frame's paint and of weights and holds [vertex_count], where it is not. Fails with SINGULAR, also where the
 * frame is not wanted any more. */
skinslide_status ss_need_stiffness(ss_evener *evener, const ss_frame *frame, const double *weight, const double *hold,
                                   skinslide_error *error);
/* Of a matrix that is a sum of squares, makes a block of the diagonal firm: it holds its unknowns by a small share of all that acts
 * on them, and wholly where nothing does, which makes the matrix positive definite. */
void ss_firm(double own[4]);

/* ---- weights.c ---- */

/* Makes next_weight of the frame's: shares of the largest. Returns whether any is between 0 and 1. */
bool ss_share_weights(ss_evener *evener, const ss_frame *frame);
/* Stiffnesses of the springs that hold vertices at shares of their slide, by weight and paint. */
void ss_find_anchors(ss_evener *evener);
/* Right sides of the unknowns, once they have the forces: with the pull of those springs. whole [vertex_count] is the slide. */
void ss_pull_to_shares(ss_evener *evener, const double (*whole)[2], double (*right)[2]);

/* ---- crush.c ---- */

/* Finds how much the cache, whose stretch and scale the evener has, crushes skin, and makes next_hold of holds [vertex_count]:
 * stiffer there. */
void ss_stiffen_holds(ss_evener *evener, const double *holds);

/* ---- scale.c ---- */

/* The smoothed median of z by k, 0 of none; changes their order. */
double ss_find_scale(ss_weighted *values, int32_t count);

/* ---- shorten.c ---- */

/* Shortens the step so that no face turns over. Returns whether some face had to be kept from it, beyond the ease that all steps
 * have. */
bool ss_shorten_step(ss_evener *evener, ss_caution caution);

/* ---- folds.c ---- */

/* Whether a face with vertices at points, where normals are those given, both [vertex_count], is turned over against them. */
bool ss_is_turned(const ss_patch *patch, int32_t face, const double (*at)[3], const double (*normal)[3]);
/* Faces that places [free_count] turn over on the rest surface. normal is scratch [vertex_count]. */
int32_t ss_count_turned_over(const ss_sheet *sheet, const ss_place *places, double (*at)[3], double (*normal)[3]);

/* ---- even.c: what rules that even out share, and the plain one ---- */

const ss_sheet *ss_sheet_of(const ss_rest *rest);
/* ss_sheet_multiply of its sheet. */
skinslide_status ss_multiply_rest(ss_rest *rest, skinslide_error *error);
/* Fills what every slide begins with. */
skinslide_status ss_begin_slide(const ss_rest *rest, ss_memory *memory, ss_slide *slide, skinslide_error *error);
/* Writes where the evener has vertices, no farther than the frame lets them be, and counts what turned over. */
void ss_end_slide(ss_evener *evener, const ss_frame *frame, ss_slide *slide, skinslide_patch_result *result);
/* For a rule that is done once it has started: nothing of a frame is left in the room. */
skinslide_status ss_finish_nothing(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result,
                                   skinslide_error *error);

extern const ss_rule ss_even_rule;

#endif
