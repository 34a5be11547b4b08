/* Nested dissection of a graph (George 1973): a separator of few unknowns parts it, others part its parts, until they are small.
 *
 * A part is cut half way between two ends that are far apart, by the difference of the distances to both, on several such ways.
 * Then unknowns go from the separator to a side, which draws their neighbours on the other side into it, so that it is smaller in
 * the end (Fiduccia and Mattheyses 1982, Ashcraft and Liu 1998). The best separator counts. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

#define SMALL       200 /* unknowns of a part that is not parted */
#define LEVEL_RANGE 0.3 /* of a part: twice how far from half of it a first cut may be */
#define MOST_SHARE  0.6 /* of a part: what moves may bring to one side */
#define FAIR_SHARE  0.8 /* of a part: what may be on one side in the end */
#define MOST_SWEEPS 8
enum { FIRST, SECOND, SEPARATOR, SIDES };
enum { ENDS = 4, WAYS = 4 };
static const int ways[WAYS][2] = {{0, 2}, {1, 2}, {0, 1}, {2, 3}};

typedef struct dissection {
    const ss_graph *graph;
    int32_t *list;           /* [n] unknowns, part by part */
    int32_t *part;           /* [n] which part each is in, until that is parted */
    int32_t *distance[ENDS]; /* [n] to the ends of ways */
    int32_t *queue;          /* [n] scratch */
    int32_t *histogram;      /* [2 n + 1] */
    int32_t part_count, set_count;
    int32_t *set; /* [n] out */

    /* The separator at hand. */
    uint8_t *side, *best, *first; /* [n] first: begins a piece */
    int32_t (*near)[SIDES];       /* [n] neighbours by side */
    int32_t size[SIDES];
    int32_t *separator, *place; /* [n] its unknowns, and where each is among them */
    int32_t *moved;             /* [3 n] unknowns that went to a side, each followed by those, as ~, that it drew in */
    int32_t *sweep;             /* [n] the last in which it went to a side */
    int32_t sweep_count;
} dissection;

static bool allocate(ss_memory *memory, const ss_graph *graph, int32_t *set, dissection *d) {
    int32_t n = graph->n;
    *d = (dissection){.graph = graph, .set = set};
    int32_t **arrays[] = {&d->list, &d->part, &d->queue, &d->separator, &d->place, &d->sweep};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = SS_NEW(memory, int32_t, n);
    for (int k = 0; k < ENDS; k++)
        d->distance[k] = SS_NEW(memory, int32_t, n);
    d->histogram = SS_NEW(memory, int32_t, 2 * (int64_t)n + 1);
    d->moved = SS_NEW(memory, int32_t, 3 * (int64_t)n);
    d->side = SS_NEW(memory, uint8_t, n), d->best = SS_NEW(memory, uint8_t, n);
    d->first = SS_NEW(memory, uint8_t, n);
    d->near = ss_new(memory, n, sizeof *d->near);
    return !memory->failed;
}

/* ---- Ends of ways ---- */

/* Distances from one unknown of those of its part that it is joined to and whose distance is below 0. Lists them in queue, the
 * nearest first. Returns how many those are. */
static int32_t spread(const dissection *d, int32_t from, int32_t *distance, int32_t *queue) {
    const ss_graph *graph = d->graph;
    int32_t part = d->part[from], count = 1;
    queue[0] = from, distance[from] = 0;
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = graph->start[queue[i]]; k < graph->start[queue[i] + 1]; k++) {
            int32_t w = graph->neighbour[k];
            if (d->part[w] == part && distance[w] < 0)
                distance[w] = distance[queue[i]] + 1, queue[count++] = w;
        }
    return count;
}

/* Of all unknowns of a piece from one. Returns one that is farthest. */
static int32_t measure(const dissection *d, int32_t begin, int32_t end, int32_t from, int32_t *distance) {
    for (int32_t i = begin; i < end; i++)
        distance[d->list[i]] = -1;
    return d->queue[spread(d, from, distance, d->queue) - 1];
}

/* The unknown that is farthest from both of two ends. */
static int32_t far_from(const dissection *d, int32_t begin, int32_t end, const int32_t *a, const int32_t *b) {
    int32_t best = -1, found = d->list[begin];
    for (int32_t i = begin; i < end; i++) {
        int32_t v = d->list[i], least = a[v] < b[v] ? a[v] : b[v];
        if (least > best)
            best = least, found = v;
    }
    return found;
}

/* Four ends: two that are far apart, one far from both, and one far from that. */
static void find_ends(const dissection *d, int32_t begin, int32_t end) {
    int32_t far = measure(d, begin, end, d->list[begin], d->distance[0]);
    far = measure(d, begin, end, far, d->distance[0]);
    measure(d, begin, end, far, d->distance[1]);
    far = measure(d, begin, end, far_from(d, begin, end, d->distance[0], d->distance[1]), d->distance[2]);
    measure(d, begin, end, far, d->distance[3]);
}

/* ---- Sides ---- */

static void put(dissection *d, int32_t v, int side) {
    int from = d->side[v];
    d->size[from]--, d->size[side]++, d->side[v] = (uint8_t)side;
    for (int32_t k = d->graph->start[v]; k < d->graph->start[v + 1]; k++)
        d->near[d->graph->neighbour[k]][from]--, d->near[d->graph->neighbour[k]][side]++;
    if (side == SEPARATOR) {
        d->place[v] = d->size[SEPARATOR] - 1, d->separator[d->place[v]] = v;
    } else if (from == SEPARATOR) {
        int32_t last = d->separator[d->size[SEPARATOR]];
        d->separator[d->place[v]] = last, d->place[last] = d->place[v];
    }
}

static void count_near(dissection *d, int32_t v) {
    d->near[v][FIRST] = d->near[v][SECOND] = d->near[v][SEPARATOR] = 0;
    for (int32_t k = d->graph->start[v]; k < d->graph->start[v + 1]; k++)
        if (d->part[d->graph->neighbour[k]] == d->part[v])
            d->near[v][d->side[d->graph->neighbour[k]]]++;
}

/* The level of the histogram, among those that leave enough on both sides, that has the fewest unknowns. */
static int32_t choose_level(const dissection *d, int32_t count) {
    int32_t n = d->graph->n, below = 0, found = 0, least = INT32_MAX, off = 0;
    for (int32_t level = -count; level <= count && below < count; level++) { /* no distance in a piece is beyond its count */
        int32_t own = d->histogram[n + level], away = abs(2 * below + own - count);
        if (own > 0 && away < LEVEL_RANGE * count && (own < least || (own == least && away < off)))
            found = level, least = own, off = away;
        below += own;
    }
    return found;
}

/* Half of a part by a - b to one side, the rest to the other; what of the larger half meets the smaller is the separator. */
static void cut(dissection *d, int32_t begin, int32_t end, const int32_t *a, const int32_t *b) {
    int32_t n = d->graph->n, half = 0;
    memset(d->size, 0, sizeof d->size);
    for (int32_t i = begin; i < end; i++)
        d->histogram[n + a[d->list[i]] - b[d->list[i]]]++;
    half = choose_level(d, end - begin);
    for (int32_t i = begin; i < end; i++) {
        int32_t v = d->list[i];
        d->histogram[n + a[v] - b[v]] = 0;
        d->side[v] = a[v] - b[v] < half ? FIRST : SECOND;
        d->size[d->side[v]]++;
    }
    for (int32_t i = begin; i < end; i++)
        count_near(d, d->list[i]);
    int wide = d->size[FIRST] > d->size[SECOND] ? FIRST : SECOND;
    for (int32_t i = begin; i < end; i++)
        if (d->side[d->list[i]] == wide && d->near[d->list[i]][1 - wide] > 0)
            put(d, d->list[i], SEPARATOR);
}

/* ---- Moves ---- */

/* Puts an unknown of the separator on a side, and what that draws in into the separator. Returns how much is listed in moved. */
static int32_t move(dissection *d, int32_t v, int side, int32_t listed) {
    d->moved[listed++] = v;
    put(d, v, side);
    for (int32_t k = d->graph->start[v]; k < d->graph->start[v + 1]; k++) {
        int32_t w = d->graph->neighbour[k];
        if (d->part[w] == d->part[v] && d->side[w] == 1 - side)
            d->moved[listed++] = ~w, put(d, w, SEPARATOR);
    }
    return listed;
}

/* Takes moves back until only so many are listed. */
static void take_back(dissection *d, int32_t listed, int32_t keep) {
    while (listed > keep) {
        int32_t drawn = listed;
        while (d->moved[drawn - 1] < 0)
            drawn--;
        int side = d->side[d->moved[drawn - 1]];
        for (; listed > drawn; listed--)
            put(d, ~d->moved[listed - 1], 1 - side);
        put(d, d->moved[--listed], SEPARATOR);
    }
}

/* The unknown whose move leaves the least separator, and its side: of equals, to the smaller one. -1 where none may move. */
static int32_t choose(const dissection *d, int *side) {
    int32_t found = -1, least = INT32_MAX, count = d->size[FIRST] + d->size[SECOND] + d->size[SEPARATOR];
    int small = d->size[SECOND] < d->size[FIRST] ? SECOND : FIRST;
    for (int32_t i = 0; i < d->size[SEPARATOR]; i++) {
        int32_t v = d->separator[i];
        for (int k = 0; k < 2 && d->sweep[v] != d->sweep_count; k++) {
            int to = k == 0 ? small : 1 - small;
            if (d->near[v][1 - to] < least && d->size[to] + 1 <= MOST_SHARE * count)
                found = v, least = d->near[v][1 - to], *side = to;
        }
    }
    return found;
}

static int32_t imbalance(const dissection *d) {
    return abs(d->size[FIRST] - d->size[SECOND]);
}

/* Moves each unknown at most once, and keeps the moves up to where the separator was best. Returns whether that is better. */
static bool sweep(dissection *d) {
    int32_t listed = 0, kept = 0, vain = 0, best = d->size[SEPARATOR], balance = imbalance(d), before = best, side = 0;
    int32_t patience = 20 + best / 4;
    d->sweep_count++;
    for (int32_t v; vain < patience && (v = choose(d, &side)) >= 0; vain++) {
        d->sweep[v] = d->sweep_count;
        listed = move(d, v, side, listed);
        if (d->size[SEPARATOR] < best || (d->size[SEPARATOR] == best && imbalance(d) < balance))
            best = d->size[SEPARATOR], balance = imbalance(d), kept = listed, vain = 0;
    }
    take_back(d, listed, kept);
    return best < before;
}

/* ---- Parts ---- */

/* Whether the sides are such that parting goes on for a few levels only. */
static bool is_fair(const dissection *d) {
    int32_t small = d->size[FIRST] < d->size[SECOND] ? FIRST : SECOND;
    return d->size[small] > 0 && d->size[1 - small] <= FAIR_SHARE * (d->size[FIRST] + d->size[SECOND] + d->size[SEPARATOR]);
}

/* Cuts a part on the best of the ways. Returns whether one is fair; best says who is on which side. */
static bool separate(dissection *d, int32_t begin, int32_t end) {
    int32_t least = INT32_MAX, balance = 0;
    for (int way = 0; way < WAYS; way++) {
        cut(d, begin, end, d->distance[ways[way][0]], d->distance[ways[way][1]]);
        for (int k = 0; k < MOST_SWEEPS && sweep(d); k++)
            ;
        bool better = d->size[SEPARATOR] < least || (d->size[SEPARATOR] == least && imbalance(d) < balance);
        if (!better || !is_fair(d))
            continue;
        least = d->size[SEPARATOR], balance = imbalance(d);
        for (int32_t i = begin; i < end; i++)
            d->best[d->list[i]] = d->side[d->list[i]];
    }
    return least < INT32_MAX;
}

/* Sorts a part by sides. Returns in size how many each has. */
static void sort_sides(dissection *d, int32_t begin, int32_t end, int32_t size[SIDES]) {
    int32_t sorted = 0;
    for (int side = 0; side < SIDES; side++) {
        size[side] = -sorted;
        for (int32_t i = begin; i < end; i++)
            if (d->best[d->list[i]] == side)
                d->queue[sorted++] = d->list[i];
        size[side] += sorted;
    }
    memcpy(d->list + begin, d->queue, (size_t)sorted * sizeof *d->list);
}

static void finish(dissection *d, int32_t begin, int32_t end) {
    for (int32_t i = begin; i < end; i++)
        d->set[d->list[i]] = d->set_count;
    d->set_count += end > begin;
}

static void part_pieces(dissection *d, int32_t begin, int32_t end);

static void part(dissection *d, int32_t begin, int32_t end) {
    int32_t size[SIDES];
    bool parted = end - begin > SMALL;
    if (parted) {
        find_ends(d, begin, end);
        parted = separate(d, begin, end);
    }
    if (!parted) {
        finish(d, begin, end);
        return;
    }
    sort_sides(d, begin, end, size);
    part_pieces(d, begin, begin + size[FIRST]);
    part_pieces(d, begin + size[FIRST], end - size[SEPARATOR]);
    finish(d, end - size[SEPARATOR], end);
}

/* Parts each piece of what may be in several: as deep as fair shares go. */
static void part_pieces(dissection *d, int32_t begin, int32_t end) {
    if (end - begin <= SMALL) {
        finish(d, begin, end);
        return;
    }
    int32_t listed = 0;
    d->part_count++;
    for (int32_t i = begin; i < end; i++)
        d->part[d->list[i]] = d->part_count, d->distance[0][d->list[i]] = -1;
    for (int32_t i = begin; i < end; i++)
        if (d->distance[0][d->list[i]] < 0)
            listed += spread(d, d->list[i], d->distance[0], d->queue + listed);
    memcpy(d->list + begin, d->queue, (size_t)listed * sizeof *d->list);
    for (int32_t i = begin; i < end; i++)
        d->first[d->list[i]] = d->distance[0][d->list[i]] == 0;
    for (int32_t i = begin, next; i < end; i = next) {
        for (next = i + 1; next < end && !d->first[d->list[next]]; next++)
            ;
        part(d, i, next);
    }
}

skinslide_status ss_dissect(const ss_graph *graph, int32_t *set, skinslide_error *error) {
    ss_memory scratch = {0};
    dissection d;
    if (!allocate(&scratch, graph, set, &d)) {
        ss_free(&scratch);
        return ss_out_of_memory(error);
    }
    for (int32_t k = 0; k < graph->n; k++)
        d.list[k] = k;
    part_pieces(&d, 0, graph->n);
    ss_free(&scratch);
    return SKINSLIDE_OK;
}
