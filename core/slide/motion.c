/* Velocities and accelerations of slid points: the cache's own, plus the rate at which the displacement changes. */
#include "slide.h"

#include <math.h>

static double displacement(const skinslide_sample *sample, int64_t i) {
    return (double)sample->slid[i] - sample->cached[i];
}

skinslide_status ss_take_samples(const skinslide_sample *given, int count, skinslide_sample *samples, skinslide_error *error) {
    const skinslide_sample standard = SKINSLIDE_SAMPLE_DEFAULT;
    skinslide_status status = ss_take_all(given, count, "skinslide_sample", samples, sizeof *samples, &standard, error);
    if (status)
        return status;
    for (int k = 0; k < count; k++)
        if (!samples[k].cached || !samples[k].slid || !isfinite(samples[k].seconds))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "sample %d has no points, or no finite time", k);
    for (int k = 1; k < count; k++)
        if (!(samples[k].seconds > samples[k - 1].seconds))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "sample times do not ascend: %g s, then %g s", samples[k - 1].seconds,
                           samples[k].seconds);
    return SKINSLIDE_OK;
}

/* The rate at which the displacement changes over two samples, and the rate at which that does over three. */
static double change_of(const skinslide_sample *samples, int count, int64_t i) {
    double first = samples[1].seconds - samples[0].seconds, here = displacement(&samples[1], i);
    double before = (here - displacement(&samples[0], i)) / first;
    if (count == 2)
        return before;
    double second = samples[2].seconds - samples[1].seconds, after = (displacement(&samples[2], i) - here) / second;
    return 2 * (after - before) / (first + second);
}

static float corrected(const skinslide_sample *samples, int count, float rate, int64_t i) {
    double change = change_of(samples, count, i);
    return change == 0 ? rate : (float)(rate + change);
}

/* Rates that are not finite in the cache may stay so. */
static skinslide_status check_rates(int32_t vertex_count, const skinslide_sample *samples, int count, const float *rates,
                                    skinslide_error *error) {
    for (int64_t i = 0; i < 3 * (int64_t)vertex_count; i++) {
        float rate = corrected(samples, count, rates[i], i);
        if (!isfinite(rate) && isfinite(rates[i]))
            return ss_refuse_vertex(count == 2 ? "velocities" : "accelerations", (int32_t)(i / 3), &rate, 1,
                                    SKINSLIDE_BAD_POINTS, error);
    }
    return SKINSLIDE_OK;
}

static skinslide_status correct(int32_t vertex_count, const skinslide_sample *given, int count, float *rates,
                                skinslide_error *error) {
    skinslide_sample samples[3];
    if (vertex_count < 0 || !given || !rates)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no samples, no rates to correct, or a negative count");
    skinslide_status status = ss_take_samples(given, count, samples, error);
    if (!status)
        status = check_rates(vertex_count, samples, count, rates, error);
    for (int64_t i = 0; !status && i < 3 * (int64_t)vertex_count; i++)
        rates[i] = corrected(samples, count, rates[i], i);
    return status;
}

skinslide_status skinslide_velocities(int32_t vertex_count, const skinslide_sample *given, float *velocities,
                                      skinslide_error *error) {
    return correct(vertex_count, given, 2, velocities, error);
}

skinslide_status skinslide_accelerations(int32_t vertex_count, const skinslide_sample *given, float *accelerations,
                                         skinslide_error *error) {
    return correct(vertex_count, given, 3, accelerations, error);
}
