/* Where a pose crumples the surface, its normals turn so much from one sample to the next, and from one frame to the next, that
 * there is no shape to keep, and skin that followed them would jump. There a sample is held less along its normal, and more in
 * all directions, see fit.c, by shortening n twice:
 *
 *     n <- n / (1 + max((0.37 c0 / c)^4 - (0.37 / 0.85)^4, 0))
 *     n <- n mean of 1 / (1 + (x / 0.25)^4) over the vertices of the sample, weighted by L
 *
 * where c is how far the tangents are from one line, see ss_limit_normal, and c0 the same at rest; x of a vertex is by which
 * share the mean normal of the samples around it is shorter than at rest, and at least 0. Both are relative to rest, so that
 * long faces and sharp rims do not count as crumpled.
 *
 * Down to 0.85 c0 nothing is shortened: a surface that is bent but not crumpled must not be held along itself at all. Only
 * edges hold long waves there, and so weakly that a thousandth of what crumpled samples are held by would count. */
#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double flat = 0.37, clean = 0.85, apart = 0.25;

struct ss_crumple {
    ss_memory memory;
    const ss_rows *samples; /* L */
    double *together; /* [column_count] length of L' normal at rest: the mean normal, times the sum of the vertex's weights */
};

/* sum = L' normal */
static void gather(const ss_rows *samples, const double (*normal)[3], double (*sum)[3]) {
    memset(sum, 0, (size_t)samples->column_count * sizeof *sum);
    for (int32_t s = 0; s < samples->row_count; s++)
        for (int32_t k = samples->start[s]; k < samples->start[s + 1]; k++)
            ss_add(samples->value[k], normal[s], sum[samples->column[k]]);
}

skinslide_status ss_crumple_create(const ss_rows *samples, const double (*normal)[3], ss_crumple **out,
                                   skinslide_error *error) {
    ss_crumple *crumple = calloc(1, sizeof *crumple);
    ss_memory scratch = {0};
    if (!crumple)
        return ss_out_of_memory(error);
    crumple->samples = samples;
    crumple->together = SS_NEW(&crumple->memory, double, samples->column_count);
    double(*sum)[3] = ss_new(&scratch, samples->column_count, sizeof *sum);
    skinslide_status status = scratch.failed || crumple->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        gather(samples, normal, sum);
        for (int32_t i = 0; i < samples->column_count; i++)
            crumple->together[i] = ss_length(sum[i]);
        *out = crumple;
    } else
        ss_crumple_destroy(crumple);
    ss_free(&scratch);
    return status;
}

void ss_crumple_destroy(ss_crumple *crumple) {
    if (!crumple)
        return;
    ss_free(&crumple->memory);
    free(crumple);
}

static double fourth_power(double x) {
    return x * x * x * x;
}

void ss_shorten_flat(double square, double at_rest, double normal[3]) {
    double nearer = square > 0 ? fourth_power(flat * at_rest / square) - fourth_power(flat / clean) : HUGE_VAL;
    double part = 1 / (1 + ss_most(nearer, 0));
    for (int axis = 0; axis < 3; axis++)
        normal[axis] *= part;
}

static double part_together(double together, double at_rest) {
    double less = at_rest > 0 ? ss_most(1 - together / at_rest, 0) : 0;
    return 1 / (1 + fourth_power(less / apart));
}

void ss_crumple_shorten(const ss_crumple *crumple, double (*sum)[3], double *part, double (*normal)[3]) {
    const ss_rows *samples = crumple->samples;
    gather(samples, (const double(*)[3])normal, sum);
    for (int32_t i = 0; i < samples->column_count; i++)
        part[i] = part_together(ss_length(sum[i]), crumple->together[i]);
    for (int32_t s = 0; s < samples->row_count; s++) {
        double mean = 0, total = 0;
        for (int32_t k = samples->start[s]; k < samples->start[s + 1]; k++)
            mean += samples->value[k] * part[samples->column[k]], total += samples->value[k];
        for (int axis = 0; axis < 3 && total > 0; axis++)
            normal[s][axis] *= mean / total;
    }
}
