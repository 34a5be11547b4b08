/* Steps of a walk: inside a triangle as rates at which the weights of a place change, and over a side into the next triangle. */
#include "surface.h"

void ss_place_put(ss_place *place, int32_t triangle, const double weights[3]) {
    place->triangle = triangle;
    for (int k = 0; k < 3; k++)
        place->weight[k] = weights[k];
}

void ss_rates_along(const ss_facet *facet, const double vector[3], double rates[3]) {
    double first = ss_dot(facet->first, vector), second = ss_dot(facet->second, vector);
    rates[1] = facet->gram[0] * first + facet->gram[1] * second;
    rates[2] = facet->gram[1] * first + facet->gram[2] * second;
    rates[0] = -rates[1] - rates[2];
}

void ss_vector_along(const ss_facet *facet, const double rates[3], double vector[3]) {
    for (int k = 0; k < 3; k++)
        vector[k] = rates[1] * facet->first[k] + rates[2] * facet->second[k];
}

double ss_reach(const ss_place *place, const double rates[3], int except, int *corner) {
    double most = 1;
    *corner = -1;
    for (int k = 0; k < 3; k++)
        if (k != except && rates[k] < 0 && place->weight[k] < -rates[k] * most) {
            most = place->weight[k] / -rates[k];
            *corner = k;
        }
    return most;
}

void ss_advance(ss_place *place, double rates[3], double part, int corner) {
    double second = ss_least(ss_most(place->weight[1] + part * rates[1], 0), 1);
    double third = ss_least(ss_most(place->weight[2] + part * rates[2], 0), 1), sum = second + third;
    second = corner == 1 ? 0 : second, third = corner == 2 ? 0 : third;
    if (corner == 0 || second + third > 1)
        second /= sum, third = 1 - second;
    ss_place_put(place, place->triangle, (double[3]){corner == 0 ? 0 : 1 - second - third, second, third});
    for (int k = 0; k < 3; k++)
        rates[k] *= 1 - part;
}

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
    ss_vector_along(&meter->pose->facet[triangle], rates, vector);
    double length = part * ss_length(vector), allowed = meter->limit - meter->walked;
    bool too_far = length > allowed;
    meter->walked = too_far ? meter->limit : meter->walked + length; /* where a walk ends it says so to the bit */
    return too_far ? part * (allowed / length) : part;
}
