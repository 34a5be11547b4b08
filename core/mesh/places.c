/* Points in one place. They are sorted along a line that is unlikely to be square to any flat part of a mesh, so that points
 * within a tolerance of each other are near each other in that order: |u.(p - q)| <= |p - q| for a unit u. */
#include "mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int32_t ss_root(int32_t *parent, int32_t vertex) {
    int32_t root = vertex;
    while (parent[root] != root)
        root = parent[root];
    while (parent[vertex] != root) {
        int32_t next = parent[vertex];
        parent[vertex] = root;
        vertex = next;
    }
    return root;
}

void ss_join(int32_t *parent, int32_t a, int32_t b) {
    a = ss_root(parent, a), b = ss_root(parent, b);
    parent[a > b ? a : b] = a < b ? a : b;
}

static ss_spot spot_of(const float *points, int32_t vertex, int32_t place) {
    static const double line[3] = {0.48, 0.64, 0.6};
    const float *at = points + 3 * (int64_t)vertex;
    ss_spot spot = {.at = {at[0], at[1], at[2]}, .place = place, .vertex = vertex};
    for (int k = 0; k < 3; k++)
        spot.along += line[k] * at[k];
    return spot;
}

static int ascending(double a, double b) {
    return a < b ? -1 : a > b;
}

/* Equal points follow each other, by vertex. */
static int by_place(const void *a, const void *b) {
    const ss_spot *x = a, *y = b;
    if (x->place != y->place)
        return ss_ascending(&x->place, &y->place);
    int order = ascending(x->along, y->along);
    for (int k = 0; k < 3 && !order; k++)
        order = ascending(x->at[k], y->at[k]);
    return order ? order : ss_ascending(&x->vertex, &y->vertex);
}

static bool same_place(const ss_spot *a, const ss_spot *b) {
    return a->place == b->place && a->at[0] == b->at[0] && a->at[1] == b->at[1] && a->at[2] == b->at[2];
}

static bool is_near(const ss_spot *a, const ss_spot *b, double tolerance) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = (double)a->at[k] - b->at[k];
    return ss_length(way) <= tolerance;
}

/* Joins the first of some equal spots to those after them within the tolerance. */
static void join_near(const ss_spot *spots, int32_t count, int32_t first, double tolerance, int32_t *parent) {
    const ss_spot *own = &spots[first];
    for (int32_t i = first + 1; i < count && spots[i].place == own->place && spots[i].along - own->along <= tolerance; i++)
        if (!same_place(&spots[i], &spots[i - 1]) && is_near(own, &spots[i], tolerance))
            ss_join(parent, own->vertex, spots[i].vertex);
}

void ss_split_places(const float *points, double tolerance, const int32_t *vertices, int32_t count, ss_spot *spots,
                     int32_t *place) {
    for (int32_t i = 0; i < count; i++)
        spots[i] = spot_of(points, vertices[i], place[vertices[i]]);
    qsort(spots, (size_t)count, sizeof *spots, by_place);
    for (int32_t i = 0; i < count; i++)
        place[vertices[i]] = vertices[i];
    for (int32_t i = 0; i < count; i++) {
        if (i > 0 && same_place(&spots[i], &spots[i - 1]))
            ss_join(place, spots[i - 1].vertex, spots[i].vertex);
        else if (tolerance > 0)
            join_near(spots, count, i, tolerance, place);
    }
    for (int32_t i = 0; i < count; i++)
        place[vertices[i]] = ss_root(place, vertices[i]);
}

bool ss_find_places(const float *points, double tolerance, int32_t count, int32_t *place) {
    ss_memory scratch = {0};
    int32_t *finite = SS_NEW(&scratch, int32_t, count), finite_count = 0;
    ss_spot *spots = SS_NEW(&scratch, ss_spot, count);
    for (int32_t i = 0; !scratch.failed && i < count; i++) {
        bool is_finite = ss_is_finite(points + 3 * (int64_t)i);
        place[i] = is_finite ? 0 : i;
        if (is_finite)
            finite[finite_count++] = i;
    }
    if (!scratch.failed)
        ss_split_places(points, tolerance, finite, finite_count, spots, place);
    ss_free(&scratch);
    return !scratch.failed;
}

/* ---- Two sets of points ---- */

/* Around some points: what is outside it by more than the tolerance shares no place with them. */
typedef struct box {
    float low[3], high[3];
    double margin;
} box;

static box box_around(const float *points, int32_t count, double tolerance) {
    box b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 1.001 * tolerance};
    for (int32_t v = 0; v < count; v++)
        for (int k = 0; k < 3 && ss_is_finite(points + 3 * (int64_t)v); k++) {
            float x = points[3 * (int64_t)v + k];
            b.low[k] = x < b.low[k] ? x : b.low[k], b.high[k] = x > b.high[k] ? x : b.high[k];
        }
    return b;
}

static bool is_at(const box *b, const float *point) {
    bool near = ss_is_finite(point);
    for (int k = 0; k < 3; k++)
        near = near && (double)b->low[k] - point[k] <= b->margin && (double)point[k] - b->high[k] <= b->margin;
    return near;
}

/* Appends the points that are near the box; vertex, if not NULL, gives their numbers. Returns how many spots there are then. */
static int32_t add_near(const box *b, const float *points, int32_t count, int32_t *vertex, float *out, int32_t have) {
    for (int32_t v = 0; v < count; v++) {
        if (!is_at(b, points + 3 * (int64_t)v))
            continue;
        if (vertex)
            vertex[have] = v;
        if (out)
            memcpy(out + 3 * (int64_t)have, points + 3 * (int64_t)v, sizeof(float[3]));
        have++;
    }
    return have;
}

bool ss_find_met(const float *points, int32_t count, const float *others, int32_t other_count, double tolerance, uint8_t *met) {
    ss_memory scratch = {0};
    box around = box_around(points, count, tolerance);
    int32_t near = add_near(&around, others, other_count, NULL, NULL, 0);
    float *all = SS_NEW(&scratch, float, 3 * ((int64_t)count + near));
    int32_t *vertex = SS_NEW(&scratch, int32_t, count), *place = SS_NEW(&scratch, int32_t, (int64_t)count + near);
    uint8_t *has_other = SS_NEW(&scratch, uint8_t, (int64_t)count + near);
    memset(met, 0, (size_t)count);
    bool done = !scratch.failed;
    if (done && near > 0) {
        int32_t own = add_near(&around, points, count, vertex, all, 0);
        int32_t both = add_near(&around, others, other_count, NULL, all, own);
        done = ss_find_places(all, tolerance, both, place);
        for (int32_t i = own; i < both && done; i++)
            has_other[place[i]] = 1;
        for (int32_t i = 0; i < own && done; i++)
            met[vertex[i]] = has_other[place[i]];
    }
    ss_free(&scratch);
    return done;
}
