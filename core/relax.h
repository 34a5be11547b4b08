/* The relaxed slide: what relax.c gives to slider.c, and what stretch.c, folds.c and relax.c share. */
#ifndef SKINSLIDE_RELAX_H
#define SKINSLIDE_RELAX_H

#include "blocks.h"
#include "site.h"

/* Where a vertex has got to. */
typedef struct ss_stand {
    ss_site site;
    double place[3], uv[2]; /* of the site, in the manner of the pose and in the chart */
    double normal[3];       /* the surface's there, creases not blunted */
} ss_stand;

/* Memory of one thread for one patch, and where its slide has got to. */
typedef struct ss_relaxer {
    ss_memory memory;
    const ss_surface *surface;
    ss_blocks *blocks;
    ss_shape pose;
    const double (*chart)[2];  /* [vertex_count] an embedding of the patch that does not fold */
    const double *paint;       /* [edge_count] */
    double hold;               /* of springs that hold every edge to its slide in the cache, as a share of its own stiffness */
    double damping;            /* of a step, as the same share */
    ss_stand *now, *trial;     /* [vertex_count] */
    ss_site *best;             /* [vertex_count] */
    double (*axis)[2][3];      /* [vertex_count] of the tangent plane, 0 where there is no way to go */
    double *part;              /* [vertex_count] of the step that the trial takes */
    double *before, *after;    /* [vertex_count] energies round a vertex */
    double (*slope)[2];        /* [unknowns] of E along the axes, downwards */
    double *area, *trial_area; /* [face_count] as shares of those in the cache */
    double *cache_area, *cache_chart_area; /* [face_count] */
} ss_relaxer;

/* ---- relax.c ---- */

skinslide_status ss_relaxer_create(const ss_surface *surface, const ss_system *system, ss_relaxer **out,
                                   skinslide_error *error);
void ss_relaxer_destroy(ss_relaxer *relaxer);
/* Where every free vertex slides to, in their order: locations [free_count] in the chart. points is the whole mesh's. Returns
 * how many steps it took. */
int32_t ss_relax(ss_relaxer *relaxer, const float *points, const double (*chart)[2], const double *paint,
                 ss_location *locations);
/* The vertex's site in the trial: along the step as far as its part says. */
void ss_walk_trial(ss_relaxer *relaxer, int32_t vertex);

/* ---- stretch.c: E and its model ---- */

double ss_stretch_energy(const ss_relaxer *relaxer, const ss_stand *stands);
/* The edges' share of every vertex: sums [vertex_count]. */
void ss_stretch_by_vertex(const ss_relaxer *relaxer, const ss_stand *stands, double *sums);
/* Adds Hessian and slope where the vertices are now to the blocks. */
void ss_stretch_model(ss_relaxer *relaxer);

/* ---- folds.c: faces must not turn over ---- */

/* Takes the areas now for those of the cache: what turning over is measured by. */
void ss_measure_cache(ss_relaxer *relaxer);
/* Halves the trial's steps of vertices whose faces would turn over; at last they stay. Sets trial_area. */
void ss_cut_back(ss_relaxer *relaxer);
/* Rises without bound where a face goes to no area: 0 from a fifth of that in the cache up. */
double ss_fold_energy(const ss_relaxer *relaxer, const double *area);
void ss_fold_model(ss_relaxer *relaxer);
/* Faces that the last slide, cut short to locations [free_count], turns over in the chart. */
int32_t ss_count_turned(ss_relaxer *relaxer, const ss_location *locations);

#endif
