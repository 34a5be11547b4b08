/* The relaxed rule: the patch is laid out in the plane at rest alone. */
#ifndef SKINSLIDE_RELAX_H
#define SKINSLIDE_RELAX_H

#include "plane.h"

/* ---- chart.c ---- */

/* A patch laid out in the plane at rest, and what of that the relaxed rule needs in every frame: immutable. */
typedef struct ss_chart {
    ss_memory memory;
    const ss_patch *patch;
    const double (*uv)[2];  /* [vertex_count] an embedding of the patch */
    ss_posed plane;         /* the same as a pose */
    double (*share)[3];     /* [triangle_count] of its corners in what surrounds their vertices; 0 without area */
    double (*slope)[2][2];  /* [edge_count] of the logarithm of the edge's length, at rest, as either end moves in the plane */
    double *inverse_square; /* [edge_count] of the edge's length in the plane */
    double *area;           /* [face_count] in the plane */
} ss_chart;

/* Every loop is held, and no paint counts, so that the chart does not fold. rest_points is the whole mesh's. */
skinslide_status ss_chart_create(const ss_patch *patch, const float *rest_points, ss_chart **out, skinslide_error *error);
void ss_chart_destroy(ss_chart *chart);
/* How the surface through points [vertex_count][3] moves with u and v: gradient [vertex_count][2][3]. */
void ss_chart_gradient(const ss_chart *chart, const double (*points)[3], double (*gradient)[2][3]);
/* The area of a face whose corners are at uv [vertex_count][2]. */
double ss_chart_area(const ss_chart *chart, int32_t face, const double (*uv)[2]);

/* ---- relax.c ---- */

/* Memory of one thread for one patch, and where its slide has got to. Unknowns are steps in the chart; a vertex of a free loop
 * has but one, along it. */
typedef struct ss_relaxer {
    ss_memory memory;
    const ss_chart *chart;
    ss_blocks *blocks, *rest; /* of where the vertices are; of rest, factored for rest_paint */
    double *rest_paint;       /* [edge_count], 0 before the first frame */
    const double *paint;      /* [edge_count] */
    double (*point)[3];       /* [vertex_count] of the pose */
    double (*gradient)[2][3]; /* [vertex_count] of the pose over the chart */
    ss_place *place;          /* [vertex_count] where each vertex is */
    double (*uv)[2];          /* [vertex_count] of it in the chart */
    double (*at)[3];          /* [vertex_count] of it in the pose */
    double (*way)[2][2];      /* [vertex_count] in the chart, of the two unknowns; 0 where there is no such way */
    double (*axis)[2][3];     /* [vertex_count] the same in the pose */
    double (*slope)[2];       /* [unknowns] of E along the unknowns, downwards */
    double (*step)[2];        /* [vertex_count] to be taken in the chart */
    ss_place *before;         /* [vertex_count] places before it */
    double *reach;            /* [vertex_count] the part of the step that no face minds */
} ss_relaxer;

skinslide_status ss_relaxer_create(const ss_chart *chart, const ss_system *system, ss_relaxer **out, skinslide_error *error);
void ss_relaxer_destroy(ss_relaxer *relaxer);
/* Where every free vertex slides to, in their order: places [free_count] in the chart. points is the whole mesh's. Returns how
 * many steps it took. */
int32_t ss_relax(ss_relaxer *relaxer, const ss_frame *frame, ss_place *places);

/* ---- stretch.c: E and its models ---- */

/* Where the vertices are now. */
double ss_stretch_energy(const ss_relaxer *relaxer);
/* Adds stiffness and forces where the vertices are now to the blocks. */
void ss_stretch_model(ss_relaxer *relaxer);
/* Adds those of the cache, as if lengths changed as they do at rest, to the blocks of rest. */
void ss_rest_stiffness(ss_relaxer *relaxer);
void ss_rest_forces(ss_relaxer *relaxer);

/* ---- folds.c: faces must not turn over ---- */

void ss_fold_model(ss_relaxer *relaxer);
/* Shortens the steps. */
void ss_limit_steps(ss_relaxer *relaxer);
/* Whether a face has turned over where the vertices are now. */
bool ss_has_turned(const ss_relaxer *relaxer, int32_t face);
/* Faces that the last slide, cut short to places [free_count], turns over in the chart. */
int32_t ss_count_turned(ss_relaxer *relaxer, const ss_place *places);

/* ---- relaxed.c ---- */

extern const ss_rule ss_relaxed_rule;

#endif
