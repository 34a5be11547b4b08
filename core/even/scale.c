/* The scale of a patch in a pose: what of the stretch is the whole character's, and nothing to even out. The median of z by k,
 * which skin that bends leaves where it is while under half of the patch stretches, with its steps smoothed: mu with
 *
 *     sum k (z - mu) / sqrt(1 + ((z - mu) / width)^2) = 0
 *
 * nearly, by a fixed count of reweighted means from the median. */
#include "even.h"

#define WIDTH  0.02
#define ROUNDS 6

static bool is_less(ss_weighted a, ss_weighted b) {
    return a.z != b.z ? a.z < b.z : a.k < b.k;
}

/* Makes a heap, whose largest comes first, of [count] in which only the one at root may be less than those under it. */
static void sift(ss_weighted *values, int32_t root, int32_t count) {
    ss_weighted moving = values[root];
    for (int32_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
        child += child + 1 < count && is_less(values[child], values[child + 1]);
        if (!is_less(moving, values[child]))
            break;
        values[root] = values[child];
        root = child;
    }
    values[root] = moving;
}

/* Ascending in z, then in k. By a heap: qsort may ask for memory. */
static void sort(ss_weighted *values, int32_t count) {
    for (int32_t i = count / 2; i-- > 0;)
        sift(values, i, count);
    for (int32_t last = count; last-- > 1;) {
        ss_weighted largest = values[0];
        values[0] = values[last];
        values[last] = largest;
        sift(values, 0, last);
    }
}

/* Each value stands at the middle of its own share of the sum; the median is on the line between the two about half of it. */
static double median(const ss_weighted *values, int32_t count) {
    double half = 0, before = 0;
    for (int32_t i = 0; i < count; i++)
        half += 0.5 * values[i].k;
    for (int32_t i = 0; i < count; i++) {
        double here = before + 0.5 * values[i].k;
        before += values[i].k;
        if (here < half)
            continue;
        if (i == 0)
            return values[0].z;
        double gap = 0.5 * (values[i - 1].k + values[i].k), share = fmin(1, fmax(0, (here - half) / gap));
        return values[i].z + share * (values[i - 1].z - values[i].z);
    }
    return count > 0 ? values[count - 1].z : 0;
}

static double smoothed(const ss_weighted *values, int32_t count, double middle) {
    double sum = 0, weights = 0;
    for (int32_t i = 0; i < count; i++) {
        double off = values[i].z - middle, share = off / WIDTH, weight = values[i].k / sqrt(1 + share * share);
        sum += weight * off, weights += weight;
    }
    return weights > 0 ? middle + sum / weights : middle;
}

double ss_find_scale(ss_weighted *values, int32_t count) {
    sort(values, count);
    double middle = median(values, count);
    for (int round = 0; round < ROUNDS; round++)
        middle = smoothed(values, count, middle);
    return middle;
}
