/* What holds of every patch that could be created. */
#ifndef SKINSLIDE_TEST_INVARIANTS_H
#define SKINSLIDE_TEST_INVARIANTS_H

#include "support.h"

/* Twins are symmetric, edges numbered by their ends, loops closed and apart, Euler's count that of a disk with holes, and every
 * vertex either fixed or free, each free one after a neighbour. */
void assert_patch_holds(const ss_patch *patch);
void assert_faces_hold(const ss_faces *faces);

#endif
