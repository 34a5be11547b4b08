/* What a rule makes of a patch once a shot, once a thread and in every frame. Each rule is a room with a table of its functions;
 * a set-up's is chosen once, and nothing after that asks which it is. */
#ifndef SKINSLIDE_RULE_H
#define SKINSLIDE_RULE_H

#include "surface.h"

#ifdef __cplusplus
extern "C" {
#endif

struct ss_idbuffer;
typedef struct ss_rule ss_rule;

/* A patch at rest: immutable. Each rule's own begins with this. */
typedef struct ss_rest {
    const ss_rule *rule;
    const ss_patch *patch;
    const double *paint;   /* [edge_count] of the set-up's controls */
    const double (*uv)[2]; /* [vertex_count] U0, the patch laid out in the plane; NULL: the rule knows none */
} ss_rest;

/* One frame of a patch, before it slides. */
typedef struct ss_frame {
    const float *points;   /* [mesh vertex_count][3] */
    const double *lengths; /* [edge_count] */
    const double *paint;   /* [edge_count] that of rest, where it is the same */
    const double *weights; /* [free_count] */
    const double *limits;  /* [free_count] how far each may slide; NULL: as far as it goes */
    const int *stop;       /* a flag: the frame is not wanted any more */
    const double *holds;   /* [vertex_count] */
    double stretch_response, compression_response;
} ss_frame;

/* Where vertices of one patch slide to: memory of one thread. Each rule's own begins with this. */
typedef struct ss_slide {
    const ss_rest *rest;
    const double (*uv)[2]; /* [vertex_count] the plane that places are in, in the last frame; NULL: the rule knows none */
    double (*asked)[2];    /* [free_count] where in it each was looked up */
    ss_place *places;      /* [free_count] where it was found, settled */
} ss_slide;

/* Makes asked where each vertex was found: elsewhere than asked where it was held back. */
void ss_ask_where_found(ss_slide *slide);

struct ss_rule {
    /* The arrays must live as long. rest_points is the whole mesh's. */
    skinslide_status (*create)(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error);
    void (*destroy)(ss_rest *rest); /* not NULL */
    /* Where there is an ID buffer, the patch has a number in it. */
    skinslide_status (*open)(const ss_rest *rest, struct ss_idbuffer *idbuffer, int32_t number, ss_slide **out,
                             skinslide_error *error);
    void (*close)(ss_slide *slide); /* not NULL */
    /* A frame in two steps: a device may go on with the first while other patches start. Both add to what result counts. */
    skinslide_status (*start)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
    skinslide_status (*finish)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
};

#ifdef __cplusplus
}
#endif

#endif
