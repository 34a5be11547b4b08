/* Times: how those of several sources become one list, which frames lie between, which are next to a time, and how they are
 * written. */
#include "stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Layer offsets leave noise of this size on the times of samples that were authored at one time. */
static const double same_time = 1e-6;

/* The most frames between samples. */
static const int64_t most_between = 10000000;

typedef struct moment {
    double time;
    int64_t given; /* its place in the order that times were given in */
} moment;

static int by_time(const void *a, const void *b) {
    const moment *x = a, *y = b;
    if (x->time != y->time)
        return x->time < y->time ? -1 : 1;
    return x->given < y->given ? -1 : x->given > y->given;
}

skinslide_status skinslide_stage_merge_times(double *times, int64_t *count, skinslide_error *error) {
    if (!count || *count < 0 || (*count > 0 && !times))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no times, or a negative count of them");
    for (int64_t i = 0; i < *count; i++)
        if (!isfinite(times[i]))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "time %lld is %g", (long long)i, times[i]);
    ss_memory scratch = {0};
    moment *moments = SS_NEW(&scratch, moment, *count);
    if (!moments)
        return ss_out_of_memory(error);
    for (int64_t i = 0; i < *count; i++)
        moments[i] = (moment){times[i], i};
    qsort(moments, (size_t)*count, sizeof *moments, by_time);
    int64_t kept = 0;
    for (int64_t i = 0; i < *count; i++)
        if (!kept || moments[i].time - moments[kept - 1].time > same_time)
            moments[kept++] = moments[i];
        else if (moments[i].given < moments[kept - 1].given)
            moments[kept - 1] = moments[i];
    for (int64_t i = 0; i < kept; i++)
        times[i] = moments[i].time;
    *count = kept;
    ss_free(&scratch);
    return SKINSLIDE_OK;
}

/* Finds the whole times between two that lie more than 1 apart, except those within noise of either. Returns how many. */
static double span_between(double before, double after, double *first) {
    *first = floor(before + same_time) + 1;
    return after - before > 1 + same_time ? fmax(ceil(after - same_time) - *first, 0) : 0;
}

skinslide_status skinslide_stage_times_between(const double *times, int64_t count, double *between, int64_t *between_count,
                                               skinslide_error *error) {
    if (count < 0 || (count > 0 && !times) || !between_count)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no times, a negative count of them, or no place for how many there are");
    int64_t found = 0;
    for (int64_t i = 1; i < count; i++) {
        double first, more = span_between(times[i - 1], times[i], &first);
        char frame[32];
        skinslide_stage_frame_text(times[i], frame);
        if (more > (double)(most_between - found))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT,
                           "by frame %s there are more than %lld frames between samples; name the frames that are wanted",
                           frame, (long long)most_between);
        for (int64_t k = 0; k < (int64_t)more; k++, found++)
            if (between)
                between[found] = first + (double)k;
    }
    *between_count = found;
    return SKINSLIDE_OK;
}

int32_t ss_samples_around(const double *times, int64_t time_count, double time, int32_t count, double around[3]) {
    int64_t before = 0, after = time_count; /* times[before - 1] and times[after] are those next to it */
    while (before < time_count && times[before] < time - same_time)
        before++;
    while (after > 0 && times[after - 1] > time + same_time)
        after--;
    int32_t found = 0;
    if (before > 0 && after < time_count) {
        around[found++] = times[before - 1];
        if (count == 3)
            around[found++] = time;
        around[found++] = times[after];
        return found;
    }
    int32_t wanted = count - 1;
    for (int64_t i = before - wanted < 0 ? 0 : before - wanted; after == time_count && i < before; i++)
        around[found++] = times[i];
    around[found++] = time;
    for (int64_t i = after; i < time_count && i < after + wanted; i++)
        around[found++] = times[i];
    return found;
}

void skinslide_stage_frame_text(double frame, char *text) {
    if (!(fabs(frame) < 1e15)) { /* a longer row of digits says less */
        snprintf(text, 32, "%g", frame);
        return;
    }
    snprintf(text, 32, "%.6f", frame);
    char *end = text + strlen(text);
    while (end[-1] == '0')
        *--end = 0;
    if (end[-1] == '.')
        *--end = 0;
    if (strcmp(text, "-0") == 0)
        strcpy(text, "0");
}
