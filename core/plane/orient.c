/* On which side of a line a point is, exactly, so that no point on a common edge is outside both faces.
 *
 *     orient(a, b, c) = sign of (a - c) x (b - c)
 *
 * ss_orient tries in double, with a bound on its error. If that cannot tell, the six products of the expanded determinant are
 * split into sums of two doubles and added up without rounding (Dekker 1971, Knuth, Shewchuk 1997: expansions). Both must be
 * compiled without contraction of products and sums. Exact if no product underflows: coordinates of an embedding are in [0,1]
 * and, unless 0, far above 1e-140. */
#include "plane.h"

/* x + y = a + b exactly, x the rounded sum. */
static void two_sum(double a, double b, double *x, double *y) {
    *x = a + b;
    double b_part = *x - a;
    *y = (a - (*x - b_part)) + (b - b_part);
}

static void split(double a, double *high, double *low) {
    double c = 134217729.0 * a; /* 2^27 + 1 */
    *high = c - (c - a);
    *low = a - *high;
}

/* x + y = a b exactly, x the rounded product. */
static void two_product(double a, double b, double *x, double *y) {
    double ah, al, bh, bl;
    *x = a * b;
    split(a, &ah, &al);
    split(b, &bh, &bl);
    *y = al * bl - (((*x - ah * bh) - al * bh) - ah * bl);
}

/* Adds b to an expansion of n components, smallest first. Returns its new n. */
static int grow(double *expansion, int n, double b) {
    int kept = 0;
    for (int i = 0; i < n; i++) {
        double rest;
        two_sum(b, expansion[i], &b, &rest);
        if (rest != 0)
            expansion[kept++] = rest;
    }
    if (b != 0)
        expansion[kept++] = b;
    return kept;
}

int ss_orient_exactly(const double a[2], const double b[2], const double c[2]) {
    const double products[6][2] = {{a[0], b[1]}, {-a[0], c[1]}, {-c[0], b[1]}, {-a[1], b[0]}, {a[1], c[0]}, {c[1], b[0]}};
    double expansion[12];
    int n = 0;
    for (int i = 0; i < 6; i++) {
        double high, low;
        two_product(products[i][0], products[i][1], &high, &low);
        n = grow(expansion, n, low);
        n = grow(expansion, n, high);
    }
    return n == 0 ? 0 : expansion[n - 1] > 0 ? 1 : -1;
}
