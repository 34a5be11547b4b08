/* Curves drawn near a mesh: which edges lie by them, and whether along or across them. */
#include "base.h"
#include "paint.h"

#include <string.h>

#define STEPS 16 /* straight pieces of a cubic segment */

/* A straight piece of a curve. */
typedef struct piece {
    double from[3], to[3];
} piece;

typedef struct pieces {
    piece *list;
    int64_t count;
} pieces;

/* ---- Segments, as UsdGeomBasisCurves counts them ---- */

/* How many segments a curve of n control points has; -1 where n does not fit. */
static int32_t segment_count(const skinslide_curves *curves, int32_t n) {
    bool periodic = curves->wrap == SKINSLIDE_CURVE_WRAP_PERIODIC;
    switch (curves->basis) {
    case SKINSLIDE_CURVE_BASIS_LINEAR:
        return n < 2 ? -1 : periodic ? n : n - 1;
    case SKINSLIDE_CURVE_BASIS_BEZIER:
        if (periodic)
            return n < 3 || n % 3 ? -1 : n / 3;
        return n < 4 || (n - 4) % 3 ? -1 : (n - 4) / 3 + 1;
    default:
        if (periodic)
            return n < 3 ? -1 : n;
        if (curves->wrap == SKINSLIDE_CURVE_WRAP_PINNED)
            return n < 2 ? -1 : n - 1;
        return n < 4 ? -1 : n - 3;
    }
}

/* Control point i of a curve, in the mesh's space. Pinned curves have one more at each end, on the line through the last
 * two. */
static void control_point(const skinslide_curves *curves, int32_t first, int32_t n, int32_t i, double out[3]) {
    if (curves->wrap == SKINSLIDE_CURVE_WRAP_PINNED && (i < 0 || i >= n)) {
        double end[3], next[3];
        control_point(curves, first, n, i < 0 ? 0 : n - 1, end);
        control_point(curves, first, n, i < 0 ? 1 : n - 2, next);
        for (int k = 0; k < 3; k++)
            out[k] = 2 * end[k] - next[k];
        return;
    }
    const float *p = curves->points + 3 * ((int64_t)first + (i % n + n) % n);
    const double *m = curves->to_mesh;
    for (int k = 0; k < 3; k++)
        out[k] = m ? p[0] * m[k] + p[1] * m[4 + k] + p[2] * m[8 + k] + m[12 + k] : p[k];
}

static void blend_weights(skinslide_curve_basis basis, double t, double w[4]) {
    double s = 1 - t;
    switch (basis) {
    case SKINSLIDE_CURVE_BASIS_BEZIER:
        w[0] = s * s * s, w[1] = 3 * s * s * t, w[2] = 3 * s * t * t, w[3] = t * t * t;
        break;
    case SKINSLIDE_CURVE_BASIS_BSPLINE:
        w[0] = s * s * s / 6, w[3] = t * t * t / 6;
        w[1] = (4 - 6 * t * t + 3 * t * t * t) / 6, w[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
        break;
    case SKINSLIDE_CURVE_BASIS_CATMULL_ROM:
        w[0] = -t * s * s / 2, w[3] = -s * t * t / 2;
        w[1] = (2 - 5 * t * t + 3 * t * t * t) / 2, w[2] = (2 - 5 * s * s + 3 * s * s * s) / 2;
        break;
    default:
        w[0] = s, w[1] = t, w[2] = w[3] = 0;
    }
}

/* Appends the pieces of one segment of a curve. */
static void flatten_segment(const skinslide_curves *curves, int32_t first, int32_t n, int32_t segment, pieces *out) {
    bool linear = curves->basis == SKINSLIDE_CURVE_BASIS_LINEAR;
    int32_t step = curves->basis == SKINSLIDE_CURVE_BASIS_BEZIER ? 3 : 1, used = linear ? 2 : 4;
    bool phantom = !linear && step == 1 && curves->wrap == SKINSLIDE_CURVE_WRAP_PINNED;
    double control[4][3] = {{0}}, weights[4], last[3];
    for (int32_t c = 0; c < used; c++)
        control_point(curves, first, n, step * segment + c - phantom, control[c]);
    for (int32_t i = 0; i <= (linear ? 1 : STEPS); i++) {
        double here[3] = {0, 0, 0};
        blend_weights(curves->basis, linear ? i : (double)i / STEPS, weights);
        for (int32_t c = 0; c < 4; c++)
            for (int k = 0; k < 3; k++)
                here[k] += weights[c] * control[c][k];
        if (i > 0) {
            memcpy(out->list[out->count].from, last, sizeof last);
            memcpy(out->list[out->count++].to, here, sizeof here);
        }
        memcpy(last, here, sizeof last);
    }
}

/* ---- Checks ---- */

static skinslide_status check_curves(const skinslide_curves *curves, int64_t *segments, skinslide_error *error) {
    if (curves->curve_count < 1 || !curves->vertex_counts || !curves->points ||
        (unsigned)curves->basis > SKINSLIDE_CURVE_BASIS_CATMULL_ROM || (unsigned)curves->wrap > SKINSLIDE_CURVE_WRAP_PINNED)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no curves, or no such basis or wrap");
    int64_t sum = 0;
    *segments = 0;
    for (int32_t c = 0; c < curves->curve_count; c++) {
        int32_t n = curves->vertex_counts[c], found = segment_count(curves, n);
        if (found < 0)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "curve %d has %d points, which its basis and wrap cannot have", c, n);
        sum += n, *segments += found;
    }
    if (sum != curves->point_count)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "curve vertex counts add up to %lld, but there are %d points",
                       (long long)sum, curves->point_count);
    for (int k = 0; curves->to_mesh && k < 16; k++)
        if (!isfinite(curves->to_mesh[k]))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the curves' matrix is not finite");
    return ss_check_points(curves->points, curves->point_count, "curve points", error);
}

static skinslide_status check_edges(const float *points, int32_t vertex_count, const int32_t *edges, int32_t edge_count,
                                    skinslide_error *error) {
    if (edge_count < 0 || (edge_count && !edges))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no edges");
    for (int64_t i = 0; i < 2 * (int64_t)edge_count; i++)
        if (edges[i] < 0 || edges[i] >= vertex_count)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "edge %d-%d: there are %d vertices", edges[i & ~(int64_t)1],
                           edges[i | 1], vertex_count);
    return ss_check_points(points, vertex_count, "points", error);
}

/* ---- Nearest pieces ---- */

static double distance_to_piece(const piece *p, const double at[3]) {
    double along[3], off[3];
    for (int k = 0; k < 3; k++)
        along[k] = p->to[k] - p->from[k], off[k] = at[k] - p->from[k];
    double length = ss_dot(along, along), share = length > 0 ? ss_dot(along, off) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int k = 0; k < 3; k++)
        off[k] -= share * along[k];
    return ss_length(off);
}

/* The first of the nearest pieces; NULL if none is at a finite distance. */
static const piece *nearest_piece(const pieces *all, const double at[3]) {
    const piece *nearest = NULL;
    double least = INFINITY;
    for (int64_t i = 0; i < all->count; i++) {
        double found = distance_to_piece(&all->list[i], at);
        if (found < least)
            least = found, nearest = &all->list[i];
    }
    return nearest;
}

/* cos of the angle >= cos 45 degrees, without roots. */
static bool is_along(const piece *p, const double edge[3]) {
    double curve[3];
    for (int k = 0; k < 3; k++)
        curve[k] = p->to[k] - p->from[k];
    double both = ss_dot(edge, curve);
    return both != 0 && 2 * both * both >= ss_dot(edge, edge) * ss_dot(curve, curve);
}

/* Leaves out pieces of no length: they have no direction, and their neighbours end in the same place. */
static void flatten(const skinslide_curves *curves, pieces *out) {
    for (int32_t c = 0, first = 0; c < curves->curve_count; first += curves->vertex_counts[c++])
        for (int32_t s = 0; s < segment_count(curves, curves->vertex_counts[c]); s++)
            flatten_segment(curves, first, curves->vertex_counts[c], s, out);
    int64_t kept = 0;
    for (int64_t i = 0; i < out->count; i++)
        if (memcmp(out->list[i].from, out->list[i].to, sizeof out->list[i].from) != 0)
            out->list[kept++] = out->list[i];
    out->count = kept;
}

/* The distance of an edge's middle from the curves, if the edge runs in that direction; else INFINITY. */
static double distance_of(const float *a, const float *b, const pieces *all, skinslide_direction direction) {
    double middle[3], edge[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * ((double)a[k] + b[k]), edge[k] = (double)b[k] - a[k];
    const piece *nearest = nearest_piece(all, middle);
    bool counts = direction == SKINSLIDE_DIRECTION_ANY ||
                  (nearest && is_along(nearest, edge) == (direction == SKINSLIDE_DIRECTION_ALONG));
    return nearest && counts ? distance_to_piece(nearest, middle) : INFINITY;
}

/* Checks curves, and makes their pieces. */
static skinslide_status take_pieces(const skinslide_curves *curves, ss_memory *memory, pieces *out, skinslide_error *error) {
    int64_t segments = 0;
    skinslide_curves own = SKINSLIDE_CURVES_DEFAULT;
    skinslide_status status = ss_take(curves, "skinslide_curves", &own, sizeof own, error);
    if (!status)
        status = check_curves(&own, &segments, error);
    if (status)
        return status;
    *out = (pieces){SS_NEW(memory, piece, segments * STEPS), 0};
    if (memory->failed)
        return ss_out_of_memory(error);
    flatten(&own, out);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_edge_distances(const float *points, int32_t vertex_count, const int32_t *edges, int32_t edge_count,
                                          const skinslide_curves *curves, skinslide_direction direction, double *distances,
                                          skinslide_error *error) {
    if ((unsigned)direction > SKINSLIDE_DIRECTION_ACROSS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "there is no direction %d", (int)direction);
    if (edge_count > 0 && !distances)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the distances");
    ss_memory memory = {0};
    pieces all;
    skinslide_status status = check_edges(points, vertex_count, edges, edge_count, error);
    if (!status)
        status = take_pieces(curves, &memory, &all, error);
    for (int32_t e = 0; e < edge_count && !status; e++)
        distances[e] = distance_of(points + 3 * (int64_t)edges[2 * e], points + 3 * (int64_t)edges[2 * e + 1], &all, direction);
    ss_free(&memory);
    return status;
}
