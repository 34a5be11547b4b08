/* What travel.c gives to slider.c. */
#ifndef SKINSLIDE_TRAVEL_H
#define SKINSLIDE_TRAVEL_H

#include "site.h"

/* Memory of one thread for one patch. */
typedef struct ss_traveller {
    ss_memory memory;
    const ss_triangles *triangles;
    ss_posed plane, pose;
} ss_traveller;

/* How far along its way from its own place each free vertex goes, in their order. */
typedef struct ss_allowance {
    const double *shares; /* [free_count] of the way, NULL: all of it */
    const double *limits; /* [free_count] at most, along the surface; NULL: no limit */
} ss_allowance;

skinslide_status ss_traveller_create(const ss_triangles *triangles, ss_traveller **out, skinslide_error *error);
void ss_traveller_destroy(ss_traveller *traveller);
/* Cuts the ways short. Each leads from the vertex's own place straight through the embedding uv [vertex_count][2], or along its
 * free loop, to its location [free_count]. points is the whole mesh's. Returns how many ways a hole is in: those end at it. */
int32_t ss_travel(ss_traveller *traveller, const float *points, const double (*uv)[2], ss_allowance allowance,
                  ss_location *locations);

#endif
