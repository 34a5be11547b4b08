/* Takes the first steps of several walks side by side. Like a step of a walk, a hop crosses the side of a slab that the point
 * is farthest outside of; but it is computed without branches, because a processor cannot predict which side that is. Near a
 * side it may err, but the walks that follow are exact. Hops of one point have to wait for each other; those of several points
 * overlap. Where hops end beyond doubt in the slab that holds the point, its place is found at once. */
#include "plane.h"

enum { LANES = 2, HOPS = 3 }; /* enough for most points from where a neighbour landed */
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lane_bits __attribute__((vector_size(8 * LANES)));

/* For two points, each with its own slab: the side that it is farthest outside of, or 3 if it is outside of none. */
SS_INLINE lane_bits sides_to_leave_by(const ss_paving *paving, const int32_t slab[LANES], const double (*p)[2]) {
    lanes x[3], y[3], turn[3], px = {p[0][0], p[1][0]}, py = {p[0][1], p[1][1]};
    for (int k = 0; k < 3; k++) {
        const double *a = paving->uv[paving->slab[slab[0]].vertex[k]], *b = paving->uv[paving->slab[slab[1]].vertex[k]];
        x[k] = (lanes){a[0], b[0]} - px, y[k] = (lanes){a[1], b[1]} - py;
    }
    for (int k = 0; k < 3; k++)
        turn[k] = x[k] * y[(k + 1) % 3] - y[k] * x[(k + 1) % 3];
    lane_bits second = turn[1] < turn[0], third = (turn[2] < turn[0]) & (turn[2] < turn[1]);
    lane_bits outside = (turn[0] < 0) | (turn[1] < 0) | (turn[2] < 0);
    return (~outside & 3) | (third & 2) | (second & ~third & 1);
}

SS_INLINE int64_t hop(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]) {
    int64_t steps = 0;
    for (int i = 0; i < SS_AT_ONCE; i += LANES) {
        lane_bits side = sides_to_leave_by(paving, slab + i, p + i);
        for (int l = 0; l < LANES; l++) {
            int32_t beyond = paving->slab[slab[i + l]].beyond[side[l]];
            beyond = beyond < 0 ? slab[i + l] : beyond;
            steps += beyond != slab[i + l];
            slab[i + l] = beyond;
        }
    }
    return steps;
}

/* share, but at least 0 and at most most. */
SS_INLINE lanes clamped(lanes share, lanes most) {
    lane_bits above = share > 0, below = share < most;
    return (lanes)(((lane_bits)share & above & below) | ((lane_bits)most & above & ~below));
}

/* Whether points are inside their slabs beyond doubt, as side_to_leave_by of a walk decides that. x and y are the ways from them to
 * the corners. */
SS_INLINE lane_bits are_inside(const lanes x[3], const lanes y[3]) {
    lanes turn[3], sum = {0};
    for (int k = 0; k < 3; k++) {
        lanes left = x[k] * y[(k + 1) % 3], right = y[k] * x[(k + 1) % 3];
        turn[k] = left - right;
        sum += (lanes)((lane_bits)left & INT64_MAX) + (lanes)((lane_bits)right & INT64_MAX);
    }
    return (turn[0] > SS_ORIENT_DOUBT * sum) & (turn[1] > SS_ORIENT_DOUBT * sum) & (turn[2] > SS_ORIENT_DOUBT * sum);
}

/* Finds the places, as ss_place_between does, of those points that are inside their slabs beyond doubt. */
SS_INLINE void find_places(const ss_paving *paving, const double (*p)[2], const int32_t slab[LANES], ss_place *places,
                           bool *found) {
    const lanes px = {p[0][0], p[1][0]}, py = {p[0][1], p[1][1]}, one = {1, 1};
    lanes x[3], y[3], to_x[3], to_y[3];
    for (int k = 0; k < 3; k++) {
        const double *a = paving->uv[paving->slab[slab[0]].vertex[k]], *b = paving->uv[paving->slab[slab[1]].vertex[k]];
        x[k] = (lanes){a[0], b[0]}, y[k] = (lanes){a[1], b[1]};
        to_x[k] = x[k] - px, to_y[k] = y[k] - py;
    }
    lanes x1 = x[1] - x[0], y1 = y[1] - y[0], x2 = x[2] - x[0], y2 = y[2] - y[0], area = x1 * y2 - y1 * x2;
    lanes second = (to_y[0] * x2 - to_x[0] * y2) / area, third = (y1 * to_x[0] - x1 * to_y[0]) / area;
    lane_bits inside = are_inside(to_x, to_y) & (second - second == 0) & (third - third == 0);
    second = clamped(second, one), third = clamped(third, one - second);
    lanes first = one - second - third;
    for (int l = 0; l < LANES; l++) {
        places[l] = (ss_place){paving->slab[slab[l]].triangle, {first[l], second[l], third[l]}, {p[l][0], p[l][1]}};
        found[l] = inside[l];
    }
}

SS_INLINE int64_t approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE], ss_place places[SS_AT_ONCE],
                           bool found[SS_AT_ONCE]) {
    int64_t steps = 0;
    for (int i = 0; i < HOPS; i++)
        steps += hop(paving, p, slab);
    for (int i = 0; i < SS_AT_ONCE; i += LANES)
        find_places(paving, p + i, slab + i, places + i, found + i);
    return steps;
}

int64_t ss_paving_approach_plain(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE],
                                 ss_place places[SS_AT_ONCE], bool found[SS_AT_ONCE]) {
    return approach(paving, p, slab, places, found);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static int64_t approach_avx2(const ss_paving *paving, const double (*p)[2],
                                                             int32_t slab[SS_AT_ONCE], ss_place places[SS_AT_ONCE],
                                                             bool found[SS_AT_ONCE]) {
    return approach(paving, p, slab, places, found);
}
#endif

int64_t ss_paving_approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE], ss_place places[SS_AT_ONCE],
                           bool found[SS_AT_ONCE]) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return approach_avx2(paving, p, slab, places, found);
#endif
    return ss_paving_approach_plain(paving, p, slab, places, found);
}
