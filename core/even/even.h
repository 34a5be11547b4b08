/* The rule `even`: stretch evened out over the rest surface itself, on any patch, open or closed, without a plane. The slides d
 * of the vertices, along tangents of rest, are to satisfy
 *
 *     J' k s(z(d)) + eta B d = 0
 *
 * z of an edge is log(length / length at rest), its length taken on the pose between the points that its ends have slid to; s
 * is the drive that z makes (ss_drive), and k the painted force density. J is the derivative of z by d at rest; B holds
 * neighbours together, more where the cache crushes skin. K = J' k J + eta B depends on the pose only through B, and
 *
 *     d <- K^-1 J' k (J d - s(z(d)))
 *
 * is done four times, always, from 0: so the result is smooth in the pose, and no frame depends on another. */
#ifndef SKINSLIDE_EVEN_H
#define SKINSLIDE_EVEN_H

#include "linear.h"
#include "surface.h"

/* ---- sheet.c ---- */

/* An edge with an end that may slide. */
typedef struct ss_spring {
    int32_t edge;
    int32_t end[2];
    double square;      /* its length at rest, squared; 0 if that is under the patch's shortest: such an edge only holds */
    double slope[2][2]; /* J: derivatives of z as each end slides along its tangents */
} ss_spring;

/* A patch at rest, with what every frame needs of it: immutable. */
typedef struct ss_sheet {
    ss_memory memory;
    const ss_patch *patch;
    ss_ground ground;        /* rest; its tangents are the sheet's */
    uint8_t *held;           /* [vertex_count] fixed, or has no normal, or no direction along its loop */
    double *slides;          /* [vertex_count] 0 if held, else 1: the weights of a whole slide */
    double (*tangent)[2][3]; /* [vertex_count] unit; on a free loop the first runs along it, and the second is 0 */
    int32_t *degree;         /* [vertex_count] number of springs at the vertex */
    int32_t spring_count;
    ss_spring *springs;
    double (*between)[2][2]; /* [spring_count] from ss_multiply_tangents; NULL before ss_sheet_multiply */
    double (*flat)[2];       /* [corner_count] faces at rest, each in its own plane */
    double (*normal)[3];     /* [face_count] unit normal of that plane */
    double *area;            /* [face_count] twice the area in that plane */
    uint8_t *turned;         /* [face_count] already turned over at rest, against the normals at its corners */
    ss_system *system;       /* the pattern of K */
} ss_sheet;

/* rest_points are the whole mesh's. */
skinslide_status ss_sheet_create(const ss_patch *patch, const float *rest_points, ss_sheet **out, skinslide_error *error);
/* Lists the products of tangents, for a rule that needs them at each step. False if memory is short. */
bool ss_sheet_multiply(ss_sheet *sheet);
void ss_sheet_destroy(ss_sheet *sheet);
/* Dot products of the tangents at a spring's first end with those at its second. */
static inline void ss_multiply_tangents(const ss_sheet *sheet, const ss_spring *spring, double out[2][2]) {
    const int32_t *v = spring->end;
    for (int k = 0; k < 4; k++)
        out[k / 2][k % 2] = ss_dot(sheet->tangent[v[0]][k / 2], sheet->tangent[v[1]][k % 2]);
}

/* ---- balance.c ---- */

/* An edge's stretch and its force density. */
typedef struct ss_weighted {
    double z, k;
} ss_weighted;

/* How much area one step may take from a face: at most a share of what it has over the least. */
typedef struct ss_caution {
    double most_lost;  /* that share */
    double least_area; /* as a share of the area at rest */
} ss_caution;

typedef double ss_pair __attribute__((vector_size(16), may_alias));

/* Memory of one thread for one patch, and how far its slide has got. */
typedef struct ss_evener {
    ss_memory memory;
    const ss_sheet *sheet;
    bool bonds_needed; /* bonds and loads are read after K is made; if not, an old K needs none: no share is below 1 */
    ss_blocks *K;      /* factored for the paint, weights and holds below, from frame to frame */
    bool factored;
    double *paint;                   /* [edge_count] */
    double *weight, *hold;           /* [vertex_count]; weight is a share of the largest, 0 if held */
    int32_t *moving;                 /* [vertex_count] its unknown, or -1 without weight */
    double most_weight;              /* of the frame. What follows lasts for one frame */
    double *next_weight, *next_hold; /* [vertex_count] of the frame that begins */
    double *bond;                    /* [spring_count] stiffness that holds its ends together, without eta */
    double *bonds;                   /* [vertex_count] sums over the springs at the vertex: of bond ... */
    double *load;                    /* [vertex_count] ... and of k / l^2 */
    double *crush;                   /* [vertex_count] how much the cache crushes skin */
    ss_posed pose;                   /* its facets are set only to limit ways */
    ss_place *place;                 /* [vertex_count] where the vertex is, if its weight is not 0 */
    int32_t *walking;                /* [vertex_count] scratch: vertices that walk over faces */
    double (*at)[3];                 /* [vertex_count] where that is in the pose */
    double (*up)[3];                 /* [vertex_count] scratch for normals */
    double (*slide)[2];              /* [vertex_count] d */
    double (*step)[2];               /* [vertex_count] to be added to slide */
    ss_caution caution;              /* of that step */
    double *stretch;                 /* [spring_count] z */
    double scale;                    /* of the frame, subtracted from z: see scale.c */
    double (*whole)[2];              /* [vertex_count] if some shares are below 1: the slide as if all were 1 */
    double *anchor;                  /* [vertex_count] see weights.c */
    ss_pair (*straight)[3];          /* [vertex_count] rest + slide along the tangents, and the step from there */
    double *part;                    /* [vertex_count] of the step that is taken */
    double *reach;                   /* [face_count] the part that the face allows, 1 at most */
    ss_weighted *sorted;             /* [spring_count] */
} ss_evener;

/* Asks the room for the memory of a frame. */
skinslide_status ss_evener_create(const ss_sheet *sheet, bool bonds_needed, ss_room *room, ss_evener **out,
                                  skinslide_error *error);
void ss_evener_destroy(ss_evener *evener);
/* Lays out the memory of a frame: begins a turn. */
void ss_evener_lay_out(ss_evener *evener, ss_room *room);
/* Slides every vertex from its own place. Adds to *cut how many of the steps were cut short by a face. Fails with SINGULAR. */
skinslide_status ss_even_out(ss_evener *evener, const ss_frame *frame, int32_t *cut, skinslide_error *error);

/* The parts of that, for rules that build on it. Begins a frame: puts every vertex at its own place, and finds the scale, the
 * crush and the holds. */
void ss_set_out(ss_evener *evener, const ss_frame *frame);
/* Puts every vertex back at its own place. */
void ss_go_home(ss_evener *evener);
/* Takes the steps from there, by weights [vertex_count]. */
skinslide_status ss_slide_by(ss_evener *evener, const ss_frame *frame, const double *weight, int32_t *cut,
                             skinslide_error *error);
/* Keeps the slide as the whole that shares are of. */
void ss_keep_whole(ss_evener *evener);
/* Keeps only a part of the slide beyond from [vertex_count]. */
void ss_keep_part(ss_evener *evener, const double (*from)[2], double part);
/* At the end: multiplies the slide by the largest weight. */
void ss_scale_slide(ss_evener *evener);
/* Measures the stretch z where the vertices are now. */
void ss_measure_stretch(ss_evener *evener);
/* The sum of (z - scale)^2 over what was measured. */
double ss_sum_stretch(const ss_evener *evener);
/* s(z) and its slope, for z less the scale: z times the response to stretch or to compression. The drive of compressed edges is
 * bounded by a half. Without a branch or a call, so that the compiler finds several at once: z - |z| is 2 z below 0, else 0. */
static inline double ss_drive(double stretch_response, double compression_response, double z, double *slope) {
    double share = z - fabs(z), inverse = 1 / sqrt(1 + share * share);
    double bounded = (z < 0 ? compression_response : stretch_response) * inverse;
    *slope = bounded * inverse * inverse;
    return bounded * z;
}
/* Shortens the step, then takes it. Returns whether a face cut it short. */
bool ss_take_step(ss_evener *evener, ss_caution caution);
/* Writes where the free vertices are, in their order: [free_count]. */
void ss_write_places(const ss_evener *evener, ss_place *places);

/* ---- limits.c ---- */

/* Cuts short those ways of the last slide that are longer on the pose than the frame allows. */
void ss_limit_ways(ss_evener *evener, const ss_frame *frame, ss_place *places);

/* ---- stiffness.c ---- */

/* Makes and factors K for the frame's paint and for weights and holds [vertex_count], unless it is that already. Fails with
 * SINGULAR, also if the frame is not wanted any more. */
skinslide_status ss_need_stiffness(ss_evener *evener, const ss_frame *frame, const double *weight, const double *hold,
                                   skinslide_error *error);
/* Makes a matrix that is a sum of squares positive definite, given one block of its diagonal: adds a small share of what acts
 * on each unknown, and 1 where nothing does. */
void ss_firm(double own[4]);

/* ---- weights.c ---- */

/* Sets next_weight to the frame's weights as shares of the largest. Returns whether any is between 0 and 1. */
bool ss_share_weights(ss_evener *evener, const ss_frame *frame);
/* Finds how stiff the springs are that hold vertices at shares of their slide, from weight and paint. */
void ss_find_anchors(ss_evener *evener);
/* Adds the pull of those springs to right sides that hold the forces. whole [vertex_count] is the slide that shares are of. */
void ss_pull_to_shares(ss_evener *evener, const double (*whole)[2], double (*right)[2]);

/* ---- crush.c ---- */

/* Finds how much the cache crushes skin, from its stretch and scale in the evener, and sets next_hold to holds [vertex_count],
 * stiffer there. */
void ss_stiffen_holds(ss_evener *evener, const double *holds);

/* ---- scale.c ---- */

/* The smoothed median of z, weighted by k; 0 if there are none. Reorders values. */
double ss_find_scale(ss_weighted *values, int32_t count);

/* ---- shorten.c ---- */

/* Shortens the step so that no face turns over. Returns whether a face cut it short, beyond what is done
 * smoothly to all. */
bool ss_shorten_step(ss_evener *evener, ss_caution caution);

/* ---- folds.c ---- */

/* Whether a face is turned over, its vertices being at these points with these normals, both [vertex_count]. */
bool ss_is_turned(const ss_patch *patch, int32_t face, const double (*at)[3], const double (*normal)[3]);
/* Counts the faces that places [free_count] turn over on the rest surface. at and normal are scratch [vertex_count]. */
int32_t ss_count_turned_over(const ss_sheet *sheet, const ss_place *places, double (*at)[3], double (*normal)[3]);

/* ---- even.c: the rule, and what other rules share with it ---- */

const ss_sheet *ss_sheet_of(const ss_rest *rest);
/* Does ss_sheet_multiply for its sheet. */
skinslide_status ss_multiply_rest(ss_rest *rest, skinslide_error *error);
/* A slide, as it begins under each of these rules. */
typedef struct ss_even_slide {
    ss_slide head;
    ss_memory memory;
    ss_room *room;
    ss_evener *evener;
} ss_even_slide;
/* Opens a slide that is all zeros; if it fails, the slide is still to be closed. bonds_needed as for ss_evener_create. */
skinslide_status ss_open_even(const ss_rest *rest, bool bonds_needed, ss_room *room, ss_even_slide *slide,
                              skinslide_error *error);
/* Frees the slide too. */
void ss_close_even(ss_even_slide *slide);
/* Writes where the vertices are, no farther than the frame allows, and counts the faces that turned over. */
void ss_end_slide(ss_evener *evener, const ss_frame *frame, ss_slide *slide, skinslide_patch_result *result);
/* For a rule that is done once it has started, and keeps nothing of a frame in the room. */
skinslide_status ss_finish_nothing(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result,
                                   skinslide_error *error);

extern const ss_rule ss_even_rule;

#endif
