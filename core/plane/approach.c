/* Takes the first steps of several walks side by side. Like a step of a walk, a hop crosses the side of a slab that the point
 * is farthest outside of; but it is computed without branches, because a processor cannot predict which side that is. Near a
 * side it may err, but the walks that follow are exact. Hops of one point have to wait for each other; those of several points
 * overlap. Where hops end in a slab that holds the point beyond doubt, its place there is found, too. */
#include "plane.h"

enum { HOPS = 3 }; /* enough for most points from where a neighbour landed */
typedef int64_t two_bits __attribute__((vector_size(16)));
typedef int64_t four_bits __attribute__((vector_size(32)));

#define TARGET
#define VECTOR ss_two
#define BITS   two_bits
#define LANES  2
#define EACH(of)                                                                                                               \
    { of(0), of(1) }
#define NAME(name) name##_plain
#include "approach.inc"
#undef TARGET
#undef VECTOR
#undef BITS
#undef LANES
#undef EACH
#undef NAME

#ifdef __x86_64__
#define TARGET __attribute__((target("avx2")))
#define VECTOR ss_four
#define BITS   four_bits
#define LANES  4
#define EACH(of)                                                                                                               \
    { of(0), of(1), of(2), of(3) }
#define NAME(name) name##_avx2
#include "approach.inc"
#endif

int64_t ss_paving_approach_plain(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE],
                                 ss_place places[SS_AT_ONCE], bool found[SS_AT_ONCE]) {
    return approach_plain(paving, p, slab, places, found);
}

int64_t ss_paving_approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE], ss_place places[SS_AT_ONCE],
                           bool found[SS_AT_ONCE]) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return approach_avx2(paving, p, slab, places, found);
#endif
    return approach_plain(paving, p, slab, places, found);
}
