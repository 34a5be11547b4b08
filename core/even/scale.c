/* The scale of a patch in a pose: stretch that the whole character has, so that there is nothing to even out. It is the median
 * of z weighted by k, which bending does not move while less than half of the patch stretches (by the mean, hands would slide
 * when a knee bends). So that it changes smoothly, it is made the mu for which
 *
 *     sum k (z - mu) / sqrt(1 + ((z - mu) / width)^2) = 0
 *
 * nearly: a fixed number of reweighted means is taken, from the median on. */
#include "even.h"

#define WIDTH  0.02 /* of stretch; at half and at twice of it, a sleeve is 5.7 and 6.6 times as rough as its cache, now 6.1 */
#define ROUNDS 6    /* at half and at twice as many, the examples lose the same stretch, to a thousandth */

static bool is_less(ss_weighted a, ss_weighted b) {
    return a.z != b.z ? a.z < b.z : a.k < b.k;
}

/* ---- The median ---- */

static void swap(ss_weighted *a, ss_weighted *b) {
    ss_weighted kept = *a;
    *a = *b, *b = kept;
}

static ss_weighted middle_of(ss_weighted a, ss_weighted b, ss_weighted c) {
    ss_weighted low = is_less(a, b) ? a : b, high = is_less(a, b) ? b : a;
    return is_less(c, low) ? low : is_less(high, c) ? high : c;
}

/* Sorts values into those less than the pivot, those equal to it, up to *end, and the others. Returns how many are less; *sum
 * is the sum of their k. */
static int32_t part(ss_weighted *values, int32_t count, ss_weighted pivot, int32_t *end, double *sum) {
    int32_t less = 0, more = count;
    *sum = 0;
    for (int32_t i = 0; i < more;)
        if (is_less(values[i], pivot)) {
            *sum += values[i].k;
            swap(&values[less++], &values[i++]);
        } else if (is_less(pivot, values[i])) {
            swap(&values[i], &values[--more]);
        } else {
            i++;
        }
    *end = more;
    return less;
}

/* If the values were sorted, half of the sum of k would fall into the share of one of them: returns its place. Those before it
 * are then less, with *before the sum of their k, and those after it more. */
static int32_t select_half(ss_weighted *values, int32_t count, double half, double *before) {
    int32_t begin = 0, end = count, same, more;
    double sum;
    for (*before = 0;;) {
        ss_weighted pivot = middle_of(values[begin], values[begin + (end - begin) / 2], values[end - 1]);
        same = begin + part(values + begin, end - begin, pivot, &more, &sum);
        more += begin;
        if (same > begin && *before + sum >= half) {
            end = same;
            continue;
        }
        for (*before += sum; same < more; same++, *before += pivot.k)
            if (*before + pivot.k >= half || (same + 1 == more && more == end))
                return same;
        begin = more;
    }
}

/* The largest or the least of values [count], at least one. */
static ss_weighted utmost(const ss_weighted *values, int32_t count, bool largest) {
    ss_weighted found = values[0];
    for (int32_t i = 1; i < count; i++)
        found = is_less(largest ? found : values[i], largest ? values[i] : found) ? values[i] : found;
    return found;
}

/* Each value stands at the middle of its share of the sum; the median is interpolated between the two around half. */
static double median(ss_weighted *values, int32_t count) {
    double half = 0, before;
    for (int32_t i = 0; i < count; i++)
        half += 0.5 * values[i].k;
    int32_t chosen = select_half(values, count, half, &before);
    double off = before + 0.5 * values[chosen].k - half; /* how far past half it stands */
    int32_t others = off > 0 ? chosen : count - chosen - 1;
    if (others == 0)
        return values[chosen].z;
    ss_weighted other = utmost(off > 0 ? values : values + chosen + 1, others, off > 0);
    double gap = 0.5 * (values[chosen].k + other.k);
    return values[chosen].z + ss_least(fabs(off) / gap, 1) * (other.z - values[chosen].z);
}

/* ---- The median, smoothed ---- */

enum { LANES = 4 }; /* sums side by side, for speed; in the same order on every processor */

static inline void weigh(ss_weighted value, double middle, double *sum, double *weights) {
    double off = value.z - middle, weight = value.k / sqrt(WIDTH * WIDTH + off * off);
    *sum += weight * off, *weights += weight;
}

static double smoothed(const ss_weighted *values, int32_t count, double middle) {
    double sum[LANES] = {0}, weights[LANES] = {0};
    int32_t whole = count - count % LANES;
    for (int32_t i = 0; i < whole; i += LANES)
        for (int k = 0; k < LANES; k++)
            weigh(values[i + k], middle, &sum[k], &weights[k]);
    for (int32_t i = whole; i < count; i++)
        weigh(values[i], middle, &sum[0], &weights[0]);
    double all = (weights[0] + weights[1]) + (weights[2] + weights[3]);
    return all > 0 ? middle + ((sum[0] + sum[1]) + (sum[2] + sum[3])) / all : middle;
}

double ss_find_scale(ss_weighted *values, int32_t count) {
    double middle = count > 0 ? median(values, count) : 0;
    for (int round = 0; round < ROUNDS; round++)
        middle = smoothed(values, count, middle);
    return middle;
}
