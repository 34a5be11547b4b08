/* See creases.h. */
#include "creases.h"

#include <math.h>
#include <stdlib.h>

creased crease_at_random(const test_mesh *mesh, skinslide_scheme scheme, uint64_t seed) {
    dice d = {seed};
    size_t room = (size_t)mesh->index_count;
    creased c = {.own = {.size = sizeof c.own, .scheme = scheme}};
    c.lengths = malloc(room * sizeof *c.lengths), c.indices = malloc(2 * room * sizeof *c.indices);
    c.sharpnesses = malloc(room * sizeof *c.sharpnesses);
    c.corners = malloc(room * sizeof *c.corners), c.corner_sharpnesses = malloc(room * sizeof *c.corner_sharpnesses);
    static const float sharpness[] = {0.5f, 1, 2.3f, 10, 20, INFINITY};
    int32_t creases = 0, corners = 0;
    for (int32_t f = 0, start = 0; f < mesh->face_count; start += mesh->face_counts[f++]) {
        int32_t n = mesh->face_counts[f], k = roll_below(&d, n);
        c.lengths[creases] = 2;
        c.indices[2 * creases] = mesh->face_indices[start + k];
        c.indices[2 * creases + 1] = mesh->face_indices[start + (k + 1) % n];
        c.sharpnesses[creases++] = sharpness[roll_below(&d, 6)];
        if (f % 5 == 0) {
            c.corners[corners] = mesh->face_indices[start];
            c.corner_sharpnesses[corners++] = sharpness[roll_below(&d, 6)];
        }
    }
    c.own.crease_count = c.own.crease_sharpness_count = creases, c.own.crease_index_count = 2 * creases;
    c.own.crease_lengths = c.lengths, c.own.crease_indices = c.indices, c.own.crease_sharpnesses = c.sharpnesses;
    c.own.corner_count = corners, c.own.corner_indices = c.corners, c.own.corner_sharpnesses = c.corner_sharpnesses;
    return c;
}

void free_creased(creased *c) {
    free(c->lengths), free(c->indices), free(c->corners), free(c->sharpnesses), free(c->corner_sharpnesses);
}
