/* Force densities of the edges (paper, section 3.1). */
#include "plane.h"

static inline double painted(const double *paint, int32_t edge) {
    return paint ? paint[edge] : 1;
}

/* q = 1/l, in units of the patch's shortest length, so that the patch's size does not matter. */
SS_INLINE void divide(double unit, int32_t count, const double *lengths, const double *paint, double *restrict density) {
    for (int32_t e = 0; e < count; e++)
        density[e] = unit / lengths[e] * painted(paint, e);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void divide_avx2(double unit, int32_t count, const double *lengths, const double *paint,
                                                        double *density) {
    divide(unit, count, lengths, paint, density);
}
#endif

static void unit_rule(const ss_patch *patch, const double *lengths, const double *paint, double *density) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        divide_avx2(patch->shortest, patch->faces.edge_count, lengths, paint, density);
        return;
    }
#endif
    divide(patch->shortest, patch->faces.edge_count, lengths, paint, density);
}

/* q = m - l^2 + 1e-4 m, with m the largest l^2, in units of m. */
static void fast_rule(const ss_patch *patch, const double *lengths, const double *paint, double *density) {
    double longest = 0;
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        longest = lengths[e] > longest ? lengths[e] : longest;
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double share = lengths[e] / longest;
        density[e] = (1 - share * share + 1e-4) * painted(paint, e);
    }
}

void ss_force_density(const ss_patch *patch, const double *lengths, const double *paint, double *density) {
    if (patch->setup->rule == SKINSLIDE_RULE_FAST)
        fast_rule(patch, lengths, paint, density);
    else
        unit_rule(patch, lengths, paint, density);
}
