/* From a point in a face laid flat to the face's own parameters, as OpenSubdiv has them: barycentric in triangles of the loop
 * scheme, bilinear in quads, and in other polygons bilinear in one of the quads between a corner, the middles of its two sides
 * and the mean of all corners. Along a side all of these run linearly from corner to corner, so that faces of different kinds
 * agree there. */
#include "limit.h"

#include <cmath>
#include <glm/glm.hpp>

namespace {

using glm::dvec2;

dvec2 corner_of(const ss_patch *patch, const ss_flat &flat, int32_t face, int32_t k) {
    const double *corner = ss_flat_corner(patch, &flat, patch->faces.face_start[face] + k);
    return {corner[0], corner[1]};
}

double cross(dvec2 a, dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

/* Corners p00, p10, p11, p01: in order around the quad. */
struct Quad {
    dvec2 corners[4];

    dvec2 at(dvec2 st) const {
        return glm::mix(glm::mix(corners[0], corners[1], st.x), glm::mix(corners[3], corners[2], st.x), st.y);
    }
    double size() const {
        return glm::length(corners[2] - corners[0]) + glm::length(corners[3] - corners[1]);
    }
};

/* How far off a solution is, as a share of the quad's size; infinite if it is not a number. */
double miss(const Quad &quad, double size, dvec2 st, dvec2 p) {
    double share = glm::length(quad.at(st) - p) / size;
    return std::isfinite(share) ? share : INFINITY;
}

/* The real roots of  a x^2 + b x + c = 0,  or the real part if there are none. One of them goes to -c/b as a goes to 0. */
dvec2 roots(double a, double b, double c) {
    double discriminant = b * b - 4 * a * c;
    double q = -0.5 * (b + std::copysign(std::sqrt(discriminant > 0 ? discriminant : 0), b));
    return {c / q, q / a};
}

/* The nearest solution is taken, and the first of several that differ by less than this: if a face is not convex, several may
 * hit, and rounding must not choose among them. */
const double accepted_miss = 1e-8;

/* st with quad.at(st) nearest to p, clamped to the quad. With  e = p10 - p00,  f = p01 - p00,  g = p11 - p10 - f,  h = p - p00:
 * h = e s + f t + g s t;  the cross product with  e + g t  leaves a quadratic for t, of whose roots the better is taken. */
dvec2 inverse_bilinear(const Quad &quad, dvec2 p, double *missed) {
    dvec2 e = quad.corners[1] - quad.corners[0], f = quad.corners[3] - quad.corners[0], h = p - quad.corners[0];
    dvec2 g = quad.corners[2] - quad.corners[1] - f;
    dvec2 both = roots(cross(f, g), cross(f, e) - cross(h, g), -cross(h, e)), best(0);
    double size = quad.size();
    *missed = INFINITY;
    for (int k = 0; k < 2; k++) {
        dvec2 along = e + both[k] * g;
        dvec2 st = glm::clamp(dvec2(glm::dot(h - both[k] * f, along) / glm::dot(along, along), both[k]), 0.0, 1.0);
        double own = miss(quad, size, st, p);
        if (own + accepted_miss < *missed)
            *missed = own, best = st;
    }
    return best;
}

/* The parameters of a triangle of the fan, for faces in which the inverse fails: quads without area or not convex, and polygons
 * none of whose quads has a solution, which get their corner of the largest weight. */
ss_parameter from_fan(const ss_patch *patch, const ss_place *place, int32_t n) {
    const double *weights = place->weight;
    int32_t second = place->triangle - patch->triangles.first_triangle[patch->triangles.face[place->triangle]] + 1;
    if (n == 4) {
        dvec2 b = second == 1 ? dvec2(1, 0) : dvec2(1, 1), c = second == 1 ? dvec2(1, 1) : dvec2(0, 1);
        dvec2 st = weights[1] * b + weights[2] * c;
        return {-1, {st.x, st.y}};
    }
    int32_t corners[3] = {0, second, second + 1}, most = 0;
    for (int32_t k = 1; k < 3; k++)
        most = weights[k] > weights[most] ? k : most;
    return {corners[most], {0, 0}};
}

/* The quad at corner k of a polygon: the corner, the middle of the side after it, the mean, the middle of the side before. */
Quad corner_quad(const ss_patch *patch, const ss_flat &flat, int32_t face, int32_t k, int32_t n, dvec2 mean) {
    dvec2 here = corner_of(patch, flat, face, k), next = corner_of(patch, flat, face, (k + 1) % n);
    dvec2 previous = corner_of(patch, flat, face, (k + n - 1) % n);
    return {{here, 0.5 * (here + next), mean, 0.5 * (previous + here)}};
}

ss_parameter in_quad(const ss_patch *patch, const ss_flat &flat, const ss_place *place, dvec2 p) {
    int32_t face = patch->triangles.face[place->triangle];
    Quad quad;
    for (int32_t k = 0; k < 4; k++)
        quad.corners[k] = corner_of(patch, flat, face, k);
    double missed;
    dvec2 st = inverse_bilinear(quad, p, &missed);
    if (missed > accepted_miss)
        return from_fan(patch, place, 4);
    return {-1, {st.x, st.y}};
}

ss_parameter in_polygon(const ss_patch *patch, const ss_flat &flat, const ss_place *place, dvec2 p, int32_t n) {
    int32_t face = patch->triangles.face[place->triangle];
    dvec2 mean(0);
    for (int32_t k = 0; k < n; k++)
        mean += corner_of(patch, flat, face, k) / double(n);
    double least = INFINITY;
    ss_parameter best = {-1, {0, 0}};
    for (int32_t k = 0; k < n; k++) {
        Quad quad = corner_quad(patch, flat, face, k, n, mean);
        double missed;
        dvec2 st = inverse_bilinear(quad, p, &missed);
        if (missed + accepted_miss < least)
            least = missed, best = {k, {st.x, st.y}};
    }
    return best.corner < 0 ? from_fan(patch, place, n) : best;
}

} // namespace

ss_parameter ss_parametrise(const ss_patch *patch, bool loop, const ss_flat *flat, const ss_place *place) {
    int32_t n = ss_fan_size(&patch->faces, patch->triangles.face[place->triangle]) + 2;
    if (loop)
        return {-1, {place->weight[1], place->weight[2]}};
    double p[2];
    ss_flat_place(patch, flat, place, p);
    return n == 4 ? in_quad(patch, *flat, place, {p[0], p[1]}) : in_polygon(patch, *flat, place, {p[0], p[1]}, n);
}
