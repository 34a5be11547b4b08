/* What holds for every patch that could be created. */
#ifndef SKINSLIDE_TEST_INVARIANTS_H
#define SKINSLIDE_TEST_INVARIANTS_H

#include "support.h"

/* Of any surface: twins are symmetric, edges numbered by their ends, loops closed and apart, and every vertex either fixed or
 * free, each free one after a neighbour. */
void assert_surface_holds(const ss_patch *patch);
/* Of a disk also: Euler's count is right for its holes, and no vertex is split. */
void assert_patch_holds(const ss_patch *patch);
void assert_faces_hold(const ss_faces *faces);

#endif
