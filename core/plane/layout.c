/* How the faces of an embedding lie: which hold a point, which turned over, whether any can overlap. */
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

/* Twice the area of a triangle, and how much of it may be rounding of its corners. */
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

/* Exactly: every corner turns left or goes straight, and so does every triangle of the fan, which rules out going round twice.
 */
static bool is_convex(const ss_faces *faces, int32_t face, const double (*uv)[2]) {
    const int32_t *corners = faces->corner_vertex + faces->face_start[face];
    int32_t n = ss_fan_size(faces, face) + 2;
    for (int32_t k = 0; k < (n == 3 ? 1 : n); k++)
        if (ss_orient(uv[corners[k]], uv[corners[(k + 1) % n]], uv[corners[(k + 2) % n]]) < 0)
            return false;
    for (int32_t k = 2; n > 4 && k + 1 < n; k++)
        if (ss_orient(uv[corners[0]], uv[corners[k]], uv[corners[k + 1]]) < 0)
            return false;
    return true;
}

ss_layout ss_lay_out(const ss_patch *patch, const double (*uv)[2]) {
    ss_layout layout = {.regular = patch->loop_count == 1 || patch->setup->holes == SKINSLIDE_HOLES_PINNED};
    for (int32_t f = 0; f < patch->faces.face_count; f++) {
        count_face(&patch->faces, f, uv, &layout);
        layout.regular = layout.regular && is_convex(&patch->faces, f, uv);
    }
    return layout;
}
