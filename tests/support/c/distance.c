/* See distance.h. */
#include "distance.h"

#include <math.h>
#include <stdlib.h>

typedef struct vector {
    double x, y, z;
} vector;

static vector minus(vector a, vector b) {
    return (vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static double dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector along(vector a, vector d, double t) {
    return (vector){a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
}

static double to_segment(vector p, vector a, vector b) {
    vector d = minus(b, a);
    double square = dot(d, d), t = square > 0 ? dot(minus(p, a), d) / square : 0;
    vector rest = minus(p, along(a, d, t < 0 ? 0 : t > 1 ? 1 : t));
    return sqrt(dot(rest, rest));
}

/* The foot of p in the plane, where it is inside; else the nearest side. */
static double to_triangle(vector p, vector a, vector b, vector c) {
    vector u = minus(b, a), v = minus(c, a), w = minus(p, a);
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v), area = uu * vv - uv * uv;
    double s = (vv * wu - uv * wv) / area, t = (uu * wv - uv * wu) / area;
    if (area > 0 && s >= 0 && t >= 0 && s + t <= 1) {
        vector rest = minus(p, along(along(a, u, s), v, t));
        return sqrt(dot(rest, rest));
    }
    return fmin(to_segment(p, a, b), fmin(to_segment(p, b, c), to_segment(p, c, a)));
}

static vector vector_at(const float *p) {
    return (vector){p[0], p[1], p[2]};
}

double distance_to_triangle(const double p[3], const float *a, const float *b, const float *c) {
    return to_triangle((vector){p[0], p[1], p[2]}, vector_at(a), vector_at(b), vector_at(c));
}

double distance_to_mesh(const test_mesh *mesh, const float *points, const float *p) {
    double best = INFINITY, at[3] = {p[0], p[1], p[2]};
    for (int32_t f = 0, c = 0; f < mesh->face_count; c += mesh->face_counts[f++])
        for (int32_t k = 1; k + 1 < mesh->face_counts[f]; k++) {
            const int32_t *v = mesh->face_indices + c;
            best = fmin(best, distance_to_triangle(at, points + 3 * v[0], points + 3 * v[k], points + 3 * v[k + 1]));
        }
    return best;
}

static double second_difference(float *const poses[3], int32_t vertex) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double a = poses[0][3 * vertex + k], b = poses[1][3 * vertex + k], c = poses[2][3 * vertex + k];
        square += (a - 2 * b + c) * (a - 2 * b + c);
    }
    return sqrt(square);
}

double largest_second_difference(float *const poses[3], int32_t vertex_count) {
    double largest = 0;
    for (int32_t v = 0; v < vertex_count; v++)
        largest = fmax(largest, second_difference(poses, v));
    return largest;
}

double roughest_slide(const rig *r, const test_mesh *mesh, test_motion motion, double from, double to, int steps) {
    float *slid[3] = {0};
    double roughest = 0;
    for (int i = 0; i <= steps; i++) {
        float *points = motion(mesh, from + (to - from) * i / steps);
        free(slid[0]);
        slid[0] = slid[1], slid[1] = slid[2];
        slid[2] = slide_with(r, mesh, points, NULL, NULL);
        if (i >= 2)
            roughest = fmax(roughest, largest_second_difference(slid, mesh->vertex_count));
        free(points);
    }
    for (int k = 0; k < 3; k++)
        free(slid[k]);
    return roughest;
}
