/* From a point in a face laid flat, in the embedding or at rest, to a point on the deformed mesh (paper, section 3.4): the
 * weights of the face's corners at that point are applied to the corners of the deformed face. `linear`: barycentric weights in
 * a triangle of the fan. `meanValue`: mean value coordinates in the polygon (Floater 2003; Hormann and Floater 2006), smooth
 * across the fan's diagonals. */
#include "plane.h"

#include <math.h>

/* ---- Mean value coordinates ---- */

typedef struct spoke { /* from the point to a corner */
    double x, y, length;
} spoke;

static spoke spoke_to(const ss_patch *patch, const ss_flat *flat, int32_t corner_index, const double p[2]) {
    const double *corner = ss_flat_corner(patch, flat, corner_index);
    double x = corner[0] - p[0], y = corner[1] - p[1];
    return (spoke){x, y, sqrt(x * x + y * y)};
}

/* tan of half the angle between two spokes; infinite if the point is on the side between their ends. */
static double half_tangent(spoke a, spoke b) {
    double product = a.length * b.length, dot = a.x * b.x + a.y * b.y, area = a.x * b.y - a.y * b.x;
    if (fabs(area) <= 1e-14 * product) /* within rounding */
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

bool ss_mean_value_weights(const ss_patch *patch, const ss_flat *flat, int32_t face, const double p[2], double *weights) {
    int32_t begin = patch->faces.face_start[face], count = patch->faces.face_start[face + 1] - begin;
    double sum = 0;
    spoke here = spoke_to(patch, flat, begin, p);
    double before = half_tangent(spoke_to(patch, flat, begin + count - 1, p), here);
    for (int32_t k = 0; k < count; k++) {
        spoke next = spoke_to(patch, flat, begin + (k + 1) % count, p);
        if (here.length == 0) {
            weigh_one(weights, count, k);
            return true;
        }
        double after = half_tangent(here, next);
        if (isinf(after) && next.length > 0) {
            weigh_side(weights, count, k, here.length, next.length);
            return true;
        }
        weights[k] = (before + after) / here.length;
        sum += weights[k];
        here = next, before = after;
    }
    bool bounded = sum > 0;
    for (int32_t k = 0; k < count; k++) {
        weights[k] /= sum;
        bounded = bounded && weights[k] > -1 && weights[k] < 2; /* 0..1 in a convex polygon, anything in a tangled one */
    }
    return bounded;
}

/* ---- Points ---- */

/* The weighted sum of a face's deformed corners, as an offset from where the vertex is now. */
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

static bool weigh_place(const ss_patch *patch, const ss_flat *flat, const ss_place *place, double *weights) {
    double p[2];
    ss_flat_place(patch, flat, place, p);
    return ss_mean_value_weights(patch, flat, patch->triangles.face[place->triangle], p, weights);
}

static void interpolate_one(const ss_patch *patch, const ss_flat *flat, int32_t vertex, const ss_place *place,
                            const float *points, double *weights, double out[3]) {
    const ss_triangles *triangles = &patch->triangles;
    if (patch->setup->interpolation != SKINSLIDE_INTERPOLATION_MEAN_VALUE || !weigh_place(patch, flat, place, weights)) {
        offset_from(patch, points, vertex, triangles->vertex[place->triangle], 3, place->weight, out);
        return;
    }
    int32_t face = triangles->face[place->triangle], n = ss_fan_size(&patch->faces, face) + 2;
    offset_from(patch, points, vertex, patch->faces.corner_vertex + patch->faces.face_start[face], n, weights, out);
}

void ss_interpolate(const ss_patch *patch, const ss_flat *flat, const ss_place *places, const float *points, double *weights,
                    double (*displacement)[3]) {
    for (int32_t i = 0; i < patch->free_count; i++) {
        displacement[i][0] = displacement[i][1] = displacement[i][2] = 0;
        if (places[i].triangle != SS_STAYS)
            interpolate_one(patch, flat, patch->free_vertex[i], &places[i], points, weights, displacement[i]);
    }
}
