/* Points in one place. Points are sorted along a line that no sheet is likely to stand square on, so that those within a tolerance
 * of each other are near each other in that order: |u.(p - q)| <= |p - q| for a unit u. */
#include "mesh.h"

#include <math.h>
#include <stdlib.h>

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
    int32_t *all = SS_NEW(&scratch, int32_t, count);
    ss_spot *spots = SS_NEW(&scratch, ss_spot, count);
    for (int32_t i = 0; !scratch.failed && i < count; i++)
        all[i] = i, place[i] = 0;
    if (!scratch.failed)
        ss_split_places(points, tolerance, all, count, spots, place);
    ss_free(&scratch);
    return !scratch.failed;
}
