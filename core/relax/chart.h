/* What chart.c gives to relax.c, stretch.c and folds.c: the plane that sites slide in. */
#ifndef SKINSLIDE_CHART_H
#define SKINSLIDE_CHART_H

#include "site.h"

/* A patch laid out in the plane at rest, and what of that the relaxed rule needs in every frame: immutable. */
typedef struct ss_chart {
    ss_memory memory;
    const ss_triangles *triangles;
    const double (*uv)[2];  /* [vertex_count] an embedding of the patch */
    ss_posed plane;         /* the same as a pose */
    double (*share)[3];     /* [triangle_count] of its corners in what surrounds their vertices; 0 without area */
    double (*slope)[2][2];  /* [edge_count] of the logarithm of the edge's length, at rest, as either end moves in the plane */
    double *inverse_square; /* [edge_count] of the edge's length in the plane */
    double *area;           /* [face_count] in the plane */
} ss_chart;

/* uv and the triangles must live as long. rest_points is the whole mesh's. */
skinslide_status ss_chart_create(const ss_triangles *triangles, const double (*uv)[2], const float *rest_points, ss_chart **out,
                                 skinslide_error *error);
void ss_chart_destroy(ss_chart *chart);
/* How the surface through points [vertex_count][3] moves with u and v: gradient [vertex_count][2][3]. */
void ss_chart_gradient(const ss_chart *chart, const double (*points)[3], double (*gradient)[2][3]);
/* The area of a face whose corners are at uv [vertex_count][2]. */
double ss_chart_area(const ss_chart *chart, int32_t face, const double (*uv)[2]);

#endif
