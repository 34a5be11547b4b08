/* See queries.h. */
#include "queries.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static void between_two(const double a[2], const double b[2], double share, double out[2]) {
    out[0] = a[0] + share * (b[0] - a[0]), out[1] = a[1] + share * (b[1] - a[1]);
}

/* A little, or by the least there is. Next to 0 are numbers whose products underflow, which no embedding has: 1e-17 stands for
 * them. */
static void nudge(double *x, dice *d) {
    double toward = roll_below(d, 2) ? 2 : -2;
    if (roll_below(d, 2))
        *x += 0.5e-9 * toward;
    else
        *x = *x == 0 ? 0.5e-17 * toward : nextafter(*x, toward);
}

void random_query(const ss_faces *faces, const double (*uv)[2], dice *d, double out[2]) {
    int32_t face = roll_below(d, faces->face_count), begin = faces->face_start[face];
    int32_t n = faces->face_start[face + 1] - begin, i = roll_below(d, n), j = roll_below(d, n);
    const double *a = uv[faces->corner_vertex[begin + i]], *b = uv[faces->corner_vertex[begin + j]];
    const double *next = uv[faces->corner_vertex[begin + (i + 1) % n]];
    switch (roll_below(d, 5)) {
    case 0:
        out[0] = roll_between(d, -0.1, 1.1), out[1] = roll_between(d, -0.1, 1.1);
        return;
    case 1:
        out[0] = a[0], out[1] = a[1];
        break;
    case 2:
        between_two(a, next, 0.5, out);
        break;
    case 3:
        between_two(a, next, roll_share(d), out);
        break;
    default:
        between_two(a, b, roll_share(d), out);
    }
    if (roll_below(d, 3) == 0)
        nudge(&out[roll_below(d, 2)], d);
}

double (*tangled(const ss_patch *patch, uint64_t seed))[2] {
    dice d = {seed};
    double(*uv)[2] = malloc((size_t)patch->vertex_count * sizeof *uv);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        uv[v][0] = roll_share(&d), uv[v][1] = roll_share(&d);
    return uv;
}

double longest_side(const double *a, const double *b, const double *c) {
    return fmax(hypot(a[0] - b[0], a[1] - b[1]), fmax(hypot(b[0] - c[0], b[1] - c[1]), hypot(c[0] - a[0], c[1] - a[1])));
}

void expect_point(const double (*uv)[2], const int32_t *vertices, int32_t count, const double *weights, const double p[2],
                  double tolerance) {
    double at[2] = {0, 0}, sum = 0;
    for (int32_t k = 0; k < count; k++) {
        sum += weights[k];
        at[0] += weights[k] * uv[vertices[k]][0], at[1] += weights[k] * uv[vertices[k]][1];
    }
    assert_near(sum, 1, 4 * DBL_EPSILON * count);
    assert_near(at[0], p[0], tolerance);
    assert_near(at[1], p[1], tolerance);
}
