/* A second way to a limit surface: the mesh refined uniformly, and the refined vertices pushed to the limit by their masks. */
#ifndef SKINSLIDE_TEST_REFINED_H
#define SKINSLIDE_TEST_REFINED_H

#include "skinslide/skinslide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The limit points of every corner, the middle of its side to the next corner, and the middle of its face, from `levels` of
 * refinement: [index_count][3][3]. */
void refine_to_limit(const skinslide_mesh *mesh, const float *points, int levels, double (*out)[3][3]);

#ifdef __cplusplus
}
#endif

#endif
