/* Subdivisions with creases at random. */
#ifndef SKINSLIDE_TEST_CREASES_H
#define SKINSLIDE_TEST_CREASES_H

#include "meshes.h"

/* Every third edge of faces sharp: semi-sharp, or infinitely. Some corners, too. Owns its arrays. */
typedef struct creased {
    skinslide_subdivision own;
    int32_t *lengths, *indices, *corners;
    float *sharpnesses, *corner_sharpnesses;
} creased;

creased crease_at_random(const test_mesh *mesh, skinslide_scheme scheme, uint64_t seed);
void free_creased(creased *c);

#endif
