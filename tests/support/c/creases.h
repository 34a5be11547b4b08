/* Subdivisions with random creases. */
#ifndef SKINSLIDE_TEST_CREASES_H
#define SKINSLIDE_TEST_CREASES_H

#include "meshes.h"

/* Every third edge of the faces is sharp, infinitely or less; so are some corners. Owns its arrays. */
typedef struct creased {
    skinslide_subdivision own;
    int32_t *lengths, *indices, *corners;
    float *sharpnesses, *corner_sharpnesses;
} creased;

creased crease_at_random(const test_mesh *mesh, skinslide_scheme scheme, uint64_t seed);
void free_creased(creased *c);

#endif
