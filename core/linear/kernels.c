/* The dense arithmetic of fronts, for processors with AVX2 and for those without: both give the same bytes.
 *
 * The columns of a front are a panel of tiles of four rows, [tile][column][4]: first the rows of the columns themselves, each
 * tile up to the columns on its diagonal; then the rows below; both padded; then, if the matrix is dominant, one tile of
 * extras: slack, two right sides, and one row unused. Once a column is eliminated, its diagonal holds 1 / pivot. Signs off the
 * diagonal are turned, so that with pivots p elimination
 *
 *     l_ik = f_ik / p_k,     f_ij += l_ik f_jk
 *
 * only adds. p_k is the sum of column k below its diagonal, slack included, if the matrix is dominant; else it is - f_kk. */
#include "linear.h"

#include <float.h>

typedef ss_shape shape;

/* The sum of four numbers. */
SS_INLINE double sum_of(const double *x) {
    return (x[0] + x[1]) + (x[2] + x[3]);
}

/* ---- Within a tile of four columns: their own rows ---- */

/* Adds the slacks of four columns. */
SS_INLINE void add_slack(const shape *s, const double *panel, int32_t tile, double sums[4]) {
    const double *extras = panel + ss_tile_start(s, s->own_tiles + s->below_tiles) + 16 * (size_t)tile;
    for (int j = 0; j < 4; j++)
        sums[j] += extras[4 * j];
}

/* Factors a tile on the diagonal. out own: [k][j] is what column k had in the row of column j before it was divided, [k][k] is
 * 1 / pivot. sums are those of the columns over all rows below the tile. Columns from count on are padding. */
SS_INLINE bool factor_tile(double *tile, int32_t count, bool dominant, double sums[4], double own[4][4]) {
    bool good = true;
#pragma GCC unroll 4
    for (int k = 0; k < 4; k++) {
        double pivot = dominant ? sums[k] : -tile[5 * k];
#pragma GCC unroll 4
        for (int i = k + 1; i < 4; i++)
            pivot += dominant ? tile[4 * k + i] : 0;
        double inverse = k < count ? 1 / pivot : 0;
        good = good && (k >= count || (pivot > 0 && pivot <= DBL_MAX && inverse <= DBL_MAX));
#pragma GCC unroll 4
        for (int j = k + 1; j < 4; j++) {
            double share = tile[4 * k + j] * inverse;
            own[k][j] = tile[4 * k + j];
#pragma GCC unroll 4
            for (int i = j; i < 4; i++)
                tile[4 * j + i] += tile[4 * k + i] * share;
            sums[j] += sums[k] * share;
        }
#pragma GCC unroll 4
        for (int j = k + 1; j < 4; j++)
            tile[4 * k + j] *= inverse;
        own[k][k] = tile[5 * k] = inverse;
    }
    return good;
}

SS_INLINE void eliminate_tile(const double *tile, double x[4]) {
    for (int k = 0; k < 3; k++)
        for (int i = k + 1; i < 4; i++)
            x[i] += tile[4 * k + i] * x[k];
}

SS_INLINE void solve_tile(const double *tile, double x[4]) {
    for (int k = 2; k >= 0; k--)
        for (int i = k + 1; i < 4; i++)
            x[k] += tile[4 * k + i] * x[i];
}

#define TARGET
#define VECTOR     ss_two
#define LOOSE      ss_loose_two
#define TILES      1
#define NAME(name) name##_plain
#include "kernels.inc"
#undef TARGET
#undef VECTOR
#undef LOOSE
#undef TILES
#undef NAME

#ifdef __x86_64__
#define TARGET     __attribute__((target("avx2")))
#define VECTOR     ss_four
#define LOOSE      ss_loose_four
#define TILES      2
#define NAME(name) name##_avx2
#include "kernels.inc"
#endif

const ss_kernels *ss_kernels_of(bool fastest) {
#ifdef __x86_64__
    if (fastest && __builtin_cpu_supports("avx2"))
        return &kernels_avx2;
#endif
    (void)fastest;
    return &kernels_plain;
}
