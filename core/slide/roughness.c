/* How roughly patches move at a time between two others: how far the cache and the result are, at each vertex, from where even
 * motion between the times around would have them, twice, which at even steps is the second difference in time:
 *
 *     2 |(1 - s) p0 + s p2 - p1|,   s = (t1 - t0) / (t2 - t0)
 *
 * A cache that is a blend of two shapes has next to none, under skin that goes a little curve. So there is a least that counts:
 * a hundredth of the mean edge at rest, or what rounding may come to. */
#include "slide.h"

#include <float.h>
#include <math.h>

/* Of the largest coordinate: what the rounding of three points to float may come to in the second difference. */
static const double ROUNDING = 2 * 1.7320508075688772 * FLT_EPSILON;
static const double LEAST = 0.01; /* of the mean edge at rest */

/* The points of three times. */
typedef struct motion {
    const float *points[3];
    double share; /* s: of halves, since times may be farther apart than numbers go */
} motion;

static motion motion_of(const skinslide_sample *samples, bool slid) {
    motion made = {.share =
                       (samples[1].seconds / 2 - samples[0].seconds / 2) / (samples[2].seconds / 2 - samples[0].seconds / 2)};
    for (int k = 0; k < 3; k++)
        made.points[k] = slid ? samples[k].slid : samples[k].cached;
    return made;
}

/* A quarter of the square of the second difference: the root is for the largest alone. */
static double square_of_way(const motion *m, int32_t v) {
    double way[3];
    for (int k = 0; k < 3; k++) {
        int64_t i = 3 * (int64_t)v + k;
        double here = m->points[1][i];
        way[k] = (1 - m->share) * (m->points[0][i] - here) + m->share * (m->points[2][i] - here);
    }
    return ss_dot(way, way);
}

static inline float larger(float a, float b) {
    return a > b ? a : b; /* of finite numbers, for which fmaxf does too much */
}

/* Along each axis, so that none waits for another. */
static void enlarge(const motion *m, int32_t v, float largest[3]) {
    for (int k = 0; k < 3; k++) {
        int64_t i = 3 * (int64_t)v + k;
        float own = larger(fabsf(m->points[0][i]), larger(fabsf(m->points[1][i]), fabsf(m->points[2][i])));
        largest[k] = larger(own, largest[k]);
    }
}

/* The largest second difference of a patch and the mesh vertex that has it; least grows to what rounding may be. */
static skinslide_status measure(const ss_patch *patch, const motion *m, double *most, int32_t *vertex, double *least,
                                skinslide_error *error) {
    double most_square = 0;
    float largest[3] = {0};
    *vertex = patch->mesh_vertex[0];
    for (int32_t i = 0; i < patch->vertex_count; i++) {
        int32_t v = patch->mesh_vertex[i];
        double square = square_of_way(m, v);
        if (!isfinite(square))
            return ss_refuse_vertex(patch->label, v, &(float){(float)square}, 1, SKINSLIDE_BAD_POINTS, error);
        if (square > most_square)
            most_square = square, *vertex = v;
        enlarge(m, v, largest);
    }
    *most = 2 * sqrt(most_square);
    *least = fmax(*least, ROUNDING * larger(largest[0], larger(largest[1], largest[2])));
    return SKINSLIDE_OK;
}

static skinslide_status measure_all(const skinslide_slider *slider, const skinslide_sample *samples, skinslide_roughness *own,
                                    skinslide_error *error) {
    const motion before = motion_of(samples, false), after = motion_of(samples, true);
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t p = 0; p < slider->part_count && !status; p++) {
        const ss_patch *patch = slider->parts[p].patch;
        own[p].least = LEAST * patch->mean_edge;
        status = measure(patch, &before, &own[p].before, &own[p].vertex_before, &own[p].least, error);
        if (!status)
            status = measure(patch, &after, &own[p].after, &own[p].vertex_after, &own[p].least, error);
    }
    return status;
}

skinslide_status skinslide_measure_roughness(const skinslide_slider *slider, const skinslide_sample *given,
                                             skinslide_roughness *roughness, skinslide_error *error) {
    if (!slider || !given || !roughness)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no slider, samples, or place for the roughness");
    skinslide_sample samples[3];
    skinslide_status status = ss_take_samples(given, 3, samples, error);
    if (!status && slider->part_count > 0)
        status = ss_check_size(roughness, "skinslide_roughness", error);
    if (status)
        return status;
    ss_memory memory = {0};
    skinslide_roughness *own = SS_NEW(&memory, skinslide_roughness, slider->part_count);
    status = own ? measure_all(slider, samples, own, error) : ss_out_of_memory(error);
    if (!status)
        ss_give_all(own, slider->part_count, sizeof *own, roughness);
    ss_free(&memory);
    return status;
}
