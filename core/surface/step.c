/* Steps of a walk: over a side into the next triangle, and their length in a pose. */
#include "surface.h"

int ss_cross_side(const ss_patch *patch, ss_place *place, int corner) {
    int32_t here = place->triangle, there = patch->triangles.neighbour[here][(corner + 1) % 3];
    int32_t a = patch->triangles.vertex[here][(corner + 1) % 3], b = patch->triangles.vertex[here][(corner + 2) % 3];
    double weights[2] = {place->weight[(corner + 1) % 3], place->weight[(corner + 2) % 3]};
    int opposite = 0;
    place->triangle = there;
    for (int k = 0; k < 3; k++) {
        int32_t v = patch->triangles.vertex[there][k];
        place->weight[k] = v == a ? weights[0] : v == b ? weights[1] : 0;
        opposite = v != a && v != b ? k : opposite;
    }
    return opposite;
}

double ss_measure(ss_meter *meter, int32_t triangle, const double rates[3], double part) {
    double vector[3];
    ss_vector_along(meter->pose, triangle, rates, vector);
    double length = part * ss_length(vector), allowed = meter->limit - meter->walked;
    bool too_far = length > allowed;
    meter->walked = too_far ? meter->limit : meter->walked + length; /* exactly, so that callers can tell */
    return too_far ? part * (allowed / length) : part;
}
