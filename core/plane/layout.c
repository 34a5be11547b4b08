/* How the faces of an embedding lie: which hold a point, which are turned over, whether any can overlap. */
#include "plane.h"

#include <float.h>
#include <math.h>

int32_t ss_triangle_holding(const ss_patch *patch, int32_t face, const double (*uv)[2], const double p[2]) {
    for (int32_t t = 0; t < ss_fan_size(&patch->faces, face); t++) {
        int32_t v[3];
        ss_fan(&patch->faces, face, t, v);
        const double *a = uv[v[0]], *b = uv[v[1]], *c = uv[v[2]];
        if (ss_orient(a, b, p) >= 0 && ss_orient(b, c, p) >= 0 && ss_orient(c, a, p) >= 0 && ss_orient(a, b, c) > 0)
            return patch->triangles.first_triangle[face] + t;
    }
    return -1;
}

/* Twice the area of a triangle, and how much of that may be due to rounding of its corners. */
static double doubled_area(const double a[2], const double b[2], const double c[2], double *rounding) {
    double x1 = b[0] - a[0], y1 = b[1] - a[1], x2 = c[0] - a[0], y2 = c[1] - a[1];
    *rounding = 8 * DBL_EPSILON * (fabs(x1) + fabs(y1) + fabs(x2) + fabs(y2));
    return x1 * y2 - y1 * x2;
}

static void count_face(const ss_faces *faces, int32_t face, const double (*uv)[2], ss_layout *layout) {
    bool folded = false, collapsed = true;
    for (int32_t t = 0; t < ss_fan_size(faces, face); t++) {
        int32_t v[3];
        double rounding;
        ss_fan(faces, face, t, v);
        double area = doubled_area(uv[v[0]], uv[v[1]], uv[v[2]], &rounding);
        folded |= area < -rounding;
        collapsed &= fabs(area) <= rounding;
    }
    layout->folded += folded;
    layout->collapsed += collapsed;
}

typedef int64_t pair_bits __attribute__((vector_size(16)));

static inline ss_two size_of(ss_two x) {
    return (ss_two)((pair_bits)x & INT64_MAX);
}

/* Whether each of two triangles turns left beyond doubt, by the same areas and roundings as doubled_area's, to the bit. */
static inline pair_bits two_turn_left(const int32_t (*v)[3], const double (*uv)[2]) {
    ss_two way[2][2];
    for (int t = 0; t < 2; t++)
        for (int k = 0; k < 2; k++)
            way[t][k] = *(const ss_loose_two *)uv[v[t][k + 1]] - *(const ss_loose_two *)uv[v[t][0]];
    ss_two x1 = {way[0][0][0], way[1][0][0]}, y1 = {way[0][0][1], way[1][0][1]};
    ss_two x2 = {way[0][1][0], way[1][1][0]}, y2 = {way[0][1][1], way[1][1][1]};
    return x1 * y2 - y1 * x2 > 8 * DBL_EPSILON * (size_of(x1) + size_of(y1) + size_of(x2) + size_of(y2));
}

/* Whether all triangles turn left beyond doubt: each area is larger than the rounding of its corners, which in an embedding of
 * size 1 is larger than that of the area itself. */
static bool clearly_turn_left(const ss_triangles *triangles, const double (*uv)[2]) {
    const int32_t(*v)[3] = (const int32_t(*)[3])triangles->vertex;
    pair_bits left = {-1, -1};
    int32_t t = 0;
    for (; t + 2 <= triangles->count; t += 2)
        left &= two_turn_left(v + t, uv);
    double rounding = 0, area = t < triangles->count ? doubled_area(uv[v[t][0]], uv[v[t][1]], uv[v[t][2]], &rounding) : 1;
    return left[0] && left[1] && area > rounding;
}

/* Whether every triangle of the fan turns left or is flat, exactly: then the face does not go round twice. */
static bool fan_turns_left(const ss_faces *faces, int32_t face, const double (*uv)[2]) {
    for (int32_t t = 0; t < ss_fan_size(faces, face); t++) {
        int32_t v[3];
        ss_fan(faces, face, t, v);
        if (ss_orient(uv[v[0]], uv[v[1]], uv[v[2]]) < 0)
            return false;
    }
    return true;
}

/* Whether a quad turns left beyond doubt at the two corners where its fan has no triangle. */
static bool clearly_turns_left(const int32_t *corners, const double (*uv)[2]) {
    const int32_t v[2][3] = {{corners[1], corners[2], corners[3]}, {corners[3], corners[0], corners[1]}};
    pair_bits left = two_turn_left(v, uv);
    return left[0] & left[1];
}

/* Whether a face turns left or goes straight on, exactly, at every corner that fan_turns_left did not test. The fan's first
 * triangle is the second corner's, its last triangle the last corner's. */
static bool corners_turn_left(const ss_faces *faces, int32_t face, const double (*uv)[2]) {
    const int32_t *corners = faces->corner_vertex + faces->face_start[face];
    int32_t n = ss_fan_size(faces, face) + 2;
    if (n == 4 && clearly_turns_left(corners, uv))
        return true;
    for (int32_t k = 1; k < n && n > 3; k++)
        if (k != n - 2 && ss_orient(uv[corners[k]], uv[corners[(k + 1) % n]], uv[corners[(k + 2) % n]]) < 0)
            return false;
    return true;
}

ss_layout ss_lay_out(const ss_patch *patch, const double (*uv)[2]) {
    const ss_faces *faces = &patch->faces;
    ss_layout layout = {.regular = patch->loop_count == 1 || patch->setup->holes == SKINSLIDE_HOLES_PINNED};
    bool clear = clearly_turn_left(&patch->triangles, uv);
    for (int32_t f = 0; f < faces->face_count && !clear; f++) {
        count_face(faces, f, uv, &layout);
        layout.regular = layout.regular && fan_turns_left(faces, f, uv);
    }
    bool of_triangles = patch->triangles.count == faces->face_count; /* whose corners were all tested */
    for (int32_t f = 0; f < faces->face_count && layout.regular && !of_triangles; f++)
        layout.regular = corners_turn_left(faces, f, uv);
    return layout;
}
