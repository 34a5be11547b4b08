/* From a point in a face of the embedding to a point on the deformed mesh (paper, section 3.4): the weights of the face's
 * corners there, applied to the corners of the deformed face. `linear`: barycentric in a triangle of the fan. `meanValue`: mean
 * value coordinates in the polygon (Floater 2003; Hormann and Floater 2006), smooth across the fan's diagonals. */
#include "plane.h"

#include <math.h>

static double cross(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance(const double a[2], const double b[2]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

/* Where the triangle has no area: along its longest side. */
static void segment_weights(const double *corners[3], const double p[2], double weights[3]) {
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (distance(corners[k], corners[(k + 1) % 3]) > distance(corners[longest], corners[(longest + 1) % 3]))
            longest = k;
    double whole = distance(corners[longest], corners[(longest + 1) % 3]);
    double share = whole > 0 ? distance(corners[longest], p) / whole : 0;
    weights[0] = weights[1] = weights[2] = 0;
    weights[(longest + 1) % 3] = share > 1 ? 1 : share;
    weights[longest] = 1 - weights[(longest + 1) % 3];
}

static double clamped(double share, double most) {
    return share > 0 ? (share < most ? share : most) : 0;
}

void ss_linear_weights(const ss_faces *faces, const double (*uv)[2], const ss_location *location, double weights[3]) {
    int32_t v[3];
    ss_fan(faces, location->face, location->triangle, v);
    const double *corners[3] = {uv[v[0]], uv[v[1]], uv[v[2]]}, *p = location->uv;
    double area = cross(corners[0], corners[1], corners[2]);
    double second = cross(corners[0], p, corners[2]) / area, third = cross(corners[0], corners[1], p) / area;
    if (!isfinite(second) || !isfinite(third)) {
        segment_weights(corners, p, weights);
        return;
    }
    weights[1] = clamped(second, 1);
    weights[2] = clamped(third, 1 - weights[1]);
    weights[0] = 1 - weights[1] - weights[2];
}

/* ---- Mean value coordinates ---- */

typedef struct spoke { /* from the point to a corner */
    double x, y, length;
} spoke;

static spoke spoke_to(const ss_faces *faces, const double (*uv)[2], const ss_location *location, int32_t k) {
    const double *corner = uv[faces->corner_vertex[faces->face_start[location->face] + k]];
    double x = corner[0] - location->uv[0], y = corner[1] - location->uv[1];
    return (spoke){x, y, sqrt(x * x + y * y)};
}

/* tan of half the angle between two spokes; infinite where the point is between their ends, on the side. */
static double half_tangent(spoke a, spoke b) {
    double product = a.length * b.length, dot = a.x * b.x + a.y * b.y, area = a.x * b.y - a.y * b.x;
    if (fabs(area) <= 1e-14 * product) /* less than rounding leaves of it */
        return dot > 0 ? 0 : INFINITY;
    return (product - dot) / area;
}

static void weigh_one(double *weights, int32_t n, int32_t k) {
    for (int32_t j = 0; j < n; j++)
        weights[j] = j == k;
}

static void weigh_side(double *weights, int32_t n, int32_t k, double first, double second) {
    weigh_one(weights, n, k);
    weights[(k + 1) % n] = first / (first + second);
    weights[k] = 1 - weights[(k + 1) % n];
}

bool ss_mean_value_weights(const ss_faces *faces, const double (*uv)[2], const ss_location *location, double *weights) {
    int32_t n = ss_fan_size(faces, location->face) + 2;
    double sum = 0;
    spoke here = spoke_to(faces, uv, location, 0);
    double before = half_tangent(spoke_to(faces, uv, location, n - 1), here);
    for (int32_t k = 0; k < n; k++) {
        spoke next = spoke_to(faces, uv, location, (k + 1) % n);
        if (here.length == 0) {
            weigh_one(weights, n, k);
            return true;
        }
        double after = half_tangent(here, next);
        if (isinf(after) && next.length > 0) {
            weigh_side(weights, n, k, here.length, next.length);
            return true;
        }
        weights[k] = (before + after) / here.length;
        sum += weights[k];
        here = next, before = after;
    }
    bool bounded = sum > 0;
    for (int32_t k = 0; k < n; k++) {
        weights[k] /= sum;
        bounded = bounded && weights[k] > -1 && weights[k] < 2; /* 0..1 in a convex polygon, anything in a tangled one */
    }
    return bounded;
}

/* ---- Points ---- */

/* The weighted sum of deformed corners, as an offset from where a vertex is now. */
static void offset_from(const ss_patch *patch, const float *points, int32_t vertex, const int32_t *corners, int32_t count,
                        const double *weights, double out[3]) {
    const float *here = points + 3 * (int64_t)patch->mesh_vertex[vertex];
    out[0] = out[1] = out[2] = 0;
    for (int32_t k = 0; k < count; k++) {
        const float *corner = points + 3 * (int64_t)patch->mesh_vertex[corners[k]];
        for (int axis = 0; axis < 3; axis++)
            out[axis] += weights[k] * ((double)corner[axis] - here[axis]);
    }
}

static void interpolate_one(const ss_patch *patch, const double (*uv)[2], int32_t vertex, const ss_location *location,
                            const float *points, double *weights, double out[3]) {
    const ss_faces *faces = &patch->faces;
    if (patch->setup->interpolation == SKINSLIDE_INTERPOLATION_MEAN_VALUE &&
        ss_mean_value_weights(faces, uv, location, weights)) {
        offset_from(patch, points, vertex, faces->corner_vertex + faces->face_start[location->face],
                    ss_fan_size(faces, location->face) + 2, weights, out);
        return;
    }
    int32_t corners[3];
    ss_fan(faces, location->face, location->triangle, corners);
    ss_linear_weights(faces, uv, location, weights);
    offset_from(patch, points, vertex, corners, 3, weights, out);
}

void ss_interpolate(const ss_patch *patch, const double (*uv)[2], const ss_location *locations, const float *points,
                    double *weights, double (*displacement)[3]) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        displacement[i][0] = displacement[i][1] = displacement[i][2] = 0;
        if (locations[i].face != SS_STAYS)
            interpolate_one(patch, uv, patch->free_vertex[i], &locations[i], points, weights, displacement[i]);
    }
}
