/* The relaxed slide: what relax.c gives to slider.c, and what stretch.c, folds.c and relax.c share. */
#ifndef SKINSLIDE_RELAX_H
#define SKINSLIDE_RELAX_H

#include "chart.h"

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
    ss_site *site;            /* [vertex_count] where each vertex is */
    double (*uv)[2];          /* [vertex_count] of it in the chart */
    double (*place)[3];       /* [vertex_count] of it in the pose */
    double (*way)[2][2];      /* [vertex_count] in the chart, of the two unknowns; 0 where there is no such way */
    double (*axis)[2][3];     /* [vertex_count] the same in the pose */
    double (*slope)[2];       /* [unknowns] of E along the unknowns, downwards */
    double (*step)[2];        /* [vertex_count] to be taken in the chart */
    ss_site *before;          /* [vertex_count] sites before it */
    double *reach;            /* [vertex_count] the part of the step that no face minds */
} ss_relaxer;

/* ---- relax.c ---- */

skinslide_status ss_relaxer_create(const ss_chart *chart, const ss_system *system, ss_relaxer **out, skinslide_error *error);
void ss_relaxer_destroy(ss_relaxer *relaxer);
/* Where every free vertex slides to, in their order: locations [free_count] in the chart. points is the whole mesh's. Returns
 * how many steps it took. */
int32_t ss_relax(ss_relaxer *relaxer, const float *points, const double *paint, ss_location *locations);

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
/* Faces that the last slide, cut short to locations [free_count], turns over in the chart. */
int32_t ss_count_turned(ss_relaxer *relaxer, const ss_location *locations);

#endif
