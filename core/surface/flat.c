/* Faces laid flat, all in one plane or each in its own, so that places on them have two coordinates. */
#include "surface.h"

/* The corners of a triangle of a fan: the face's first, and two that follow each other. */
static void triangle_corners(const ss_patch *patch, const ss_flat *flat, int32_t triangle, const double *corners[3]) {
    int32_t face = patch->triangles.face[triangle], begin = patch->faces.face_start[face];
    int32_t second = begin + 1 + triangle - patch->triangles.first_triangle[face];
    corners[0] = ss_flat_corner(patch, flat, begin);
    corners[1] = ss_flat_corner(patch, flat, second), corners[2] = ss_flat_corner(patch, flat, second + 1);
}

void ss_flat_place(const ss_patch *patch, const ss_flat *flat, const ss_place *place, double out[2]) {
    const double *corners[3], *weight = place->weight;
    triangle_corners(patch, flat, place->triangle, corners);
    for (int k = 0; k < 2; k++)
        out[k] = flat->uv ? place->uv[k] : weight[0] * corners[0][k] + weight[1] * corners[1][k] + weight[2] * corners[2][k];
}

/* Solves p = sum of weight times corner. False if the triangle has no area. */
static bool weigh(const double *corners[3], const double p[2], double weight[3]) {
    double a[2], b[2], c[2];
    for (int k = 0; k < 2; k++)
        a[k] = corners[1][k] - corners[0][k], b[k] = corners[2][k] - corners[0][k], c[k] = p[k] - corners[0][k];
    double area = a[0] * b[1] - a[1] * b[0];
    weight[1] = (c[0] * b[1] - c[1] * b[0]) / area;
    weight[2] = (a[0] * c[1] - a[1] * c[0]) / area;
    weight[0] = 1 - weight[1] - weight[2];
    return isfinite(weight[1]) && isfinite(weight[2]);
}

static void clamp_weights(double weight[3]) {
    weight[1] = fmin(1, fmax(0, weight[1]));
    weight[2] = fmin(1 - weight[1], fmax(0, weight[2]));
    weight[0] = 1 - weight[1] - weight[2];
}

ss_place ss_flat_middle(const ss_patch *patch, const ss_flat *flat, int32_t face) {
    int32_t begin = patch->faces.face_start[face], end = patch->faces.face_start[face + 1];
    ss_place middle = {patch->triangles.first_triangle[face], {1, 0, 0}, {0, 0}};
    double best = -INFINITY;
    for (int32_t c = begin; c < end; c++)
        for (int k = 0; k < 2; k++)
            middle.uv[k] += ss_flat_corner(patch, flat, c)[k] / (end - begin);
    for (int32_t t = 0; t < ss_fan_size(&patch->faces, face); t++) {
        const double *corners[3];
        double weight[3];
        triangle_corners(patch, flat, patch->triangles.first_triangle[face] + t, corners);
        if (!weigh(corners, middle.uv, weight) || fmin(weight[0], fmin(weight[1], weight[2])) <= best)
            continue;
        best = fmin(weight[0], fmin(weight[1], weight[2]));
        middle.triangle = patch->triangles.first_triangle[face] + t;
        for (int k = 0; k < 3; k++)
            middle.weight[k] = weight[k];
    }
    clamp_weights(middle.weight);
    return middle;
}
