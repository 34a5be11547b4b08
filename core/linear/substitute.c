/* The two halves of solving with a factor: right sides are eliminated from the first front to the last, and solutions
 * substituted from the last back to the first. Each unknown has two numbers: two right sides if entries are numbers,
 * [unknown][side], or one if they are blocks, [unknown][row]. */
#include "linear.h"

enum { MOST_AHEAD = 2048 }; /* numbers read ahead */

/* ---- Right sides of one front ---- */

/* Copies the right sides of a front's columns to x [count][columns], with 0 for padding. */
SS_INLINE void take_columns(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int block,
                            const double (*right)[2]) {
    const double *from = right[front->first];
    int count = 2 / block;
    for (int c = 0; c < count; c++) {
        double *x = frontal->x + c * s->columns;
        for (int32_t k = 0; k < s->used; k++)
            x[k] = from[count * k + c];
        for (int32_t k = s->used; k < s->columns; k++)
            x[k] = 0;
    }
}

SS_INLINE void put_columns(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int block, double (*right)[2]) {
    double *to = right[front->first];
    int count = 2 / block;
    for (int c = 0; c < count; c++)
        for (int32_t k = 0; k < s->used; k++)
            to[count * k + c] = frontal->x[c * s->columns + k];
}

/* Adds below [count][rows] to the right sides of the rows. */
SS_INLINE void add_below(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int block, double (*right)[2]) {
    const int32_t *rows = frontal->system->rows + front->row_start;
    const double *below = frontal->below, *other = below + 4 * s->below_tiles;
    for (int32_t i = 0; i < front->row_count; i++)
        *(ss_loose_two *)right[rows[i]] +=
            block == 2 ? *(const ss_loose_two *)(below + 2 * i) : (ss_loose_two){below[i], other[i]};
}

SS_INLINE void take_below(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int block,
                          const double (*right)[2]) {
    const int32_t *rows = frontal->system->rows + front->row_start;
    double *below = frontal->below, *other = below + 4 * s->below_tiles;
    for (int32_t i = 0; i < front->row_count; i++) {
        ss_loose_two own = *(const ss_loose_two *)right[rows[i]];
        if (block == 2)
            *(ss_loose_two *)(below + 2 * i) = own;
        else
            below[i] = own[0], other[i] = own[1];
    }
    for (int c = 0; c < 2 / block; c++)
        for (int32_t i = s->below; i < 4 * s->below_tiles; i++)
            below[4 * c * s->below_tiles + i] = 0;
}

/* ---- All of them ---- */

SS_INLINE void eliminate(ss_frontal *frontal, int32_t f, int block, double (*right)[2]) {
    const ss_front *front = &frontal->system->fronts[f];
    ss_shape s = ss_shape_of(frontal, front);
    take_columns(frontal, front, &s, block, (const double(*)[2])right);
    frontal->kernels->forward[2 / block - 1](&s, frontal->L + frontal->panel[f], frontal->x, frontal->below);
    put_columns(frontal, front, &s, block, right);
    add_below(frontal, front, &s, block, right);
}

void ss_eliminate_front(ss_frontal *frontal, int32_t f, double (*right)[2]) {
    if (frontal->block == 2)
        eliminate(frontal, f, 2, right);
    else
        eliminate(frontal, f, 1, right);
}

void ss_eliminate_right(ss_frontal *frontal, double (*right)[2]) {
    for (int32_t f = 0; f < frontal->system->front_count; f++)
        ss_eliminate_front(frontal, f, right);
}

SS_INLINE void divide_columns(const ss_frontal *frontal, const ss_shape *s, const double *panel, int block) {
    for (int32_t t = 0; t < s->own_tiles; t++) {
        const double *diagonal = panel + ss_tile_start(s, t) + 16 * (size_t)t;
        for (int c = 0; c < 2 / block; c++)
            for (int k = 0; k < 4; k++)
                frontal->x[c * s->columns + 4 * t + k] *= diagonal[5 * k];
    }
}

static void take_extras(const ss_frontal *frontal, const ss_shape *s, const double *panel) {
    const double *extras = panel + ss_tile_start(s, s->tiles - 1);
    for (int32_t k = 0; k < s->columns; k++)
        frontal->x[k] = extras[4 * k + 1], frontal->x[s->columns + k] = extras[4 * k + 2];
}

/* Processors read ahead only forwards, and panels are visited backwards: asks for the next one, or for its beginning. */
static void prefetch(const double *panel, const double *end) {
    const double *last = end - panel < MOST_AHEAD ? end : panel + MOST_AHEAD;
#pragma GCC unroll 4
    for (const double *line = panel; line < last; line += 8)
        __builtin_prefetch(line);
}

SS_INLINE void substitute(ss_frontal *frontal, int block, bool carried, double (*right)[2]) {
    for (int32_t f = frontal->system->front_count - 1; f >= 0; f--) {
        const ss_front *front = &frontal->system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        const double *panel = frontal->L + frontal->panel[f];
        if (f > 0)
            prefetch(frontal->L + frontal->panel[f - 1], panel);
        if (carried) {
            take_extras(frontal, &s, panel);
        } else {
            take_columns(frontal, front, &s, block, (const double(*)[2])right);
            divide_columns(frontal, &s, panel, block);
        }
        take_below(frontal, front, &s, block, (const double(*)[2])right);
        frontal->kernels->backward[2 / block - 1](&s, panel, frontal->x, frontal->below);
        put_columns(frontal, front, &s, block, right);
    }
}

void ss_substitute_back(ss_frontal *frontal, bool carried, double (*right)[2]) {
    if (frontal->block == 2)
        substitute(frontal, 2, false, right);
    else
        substitute(frontal, 1, carried, right);
}
