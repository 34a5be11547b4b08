/* Takes the first steps of several walks side by side. Like a step of a walk, a hop crosses the side of a slab that the point
 * is farthest outside of; but it is computed without branches, because a processor cannot predict which side that is. Near a
 * side it may err, but the walks that follow are exact. Hops of one point have to wait for each other; those of several points
 * overlap. */
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

SS_INLINE int64_t approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]) {
    int64_t steps = 0;
    for (int hop = 0; hop < HOPS; hop++)
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

int64_t ss_paving_approach_plain(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]) {
    return approach(paving, p, slab);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static int64_t approach_avx2(const ss_paving *paving, const double (*p)[2],
                                                             int32_t slab[SS_AT_ONCE]) {
    return approach(paving, p, slab);
}
#endif

int64_t ss_paving_approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE]) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return approach_avx2(paving, p, slab);
#endif
    return ss_paving_approach_plain(paving, p, slab);
}
