/* The two halves of solving with a factor: right sides are eliminated from the first front on, and solutions put in from the last
 * one back. */
#include "linear.h"

/* ---- Right sides of one front ---- */

/* x [count][columns]: right sides of a front's columns, 0 of those that are none. */
static void take_columns(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int count, const double *right) {
    const double *from = right + (size_t)count * (size_t)(frontal->block * front->first);
    for (int c = 0; c < count; c++) {
        double *x = frontal->x + c * s->columns;
        for (int32_t k = 0; k < s->columns; k++)
            x[k] = k < s->used ? from[count * k + c] : 0;
    }
}

static void put_columns(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int count, double *right) {
    double *to = right + (size_t)count * (size_t)(frontal->block * front->first);
    for (int c = 0; c < count; c++)
        for (int32_t k = 0; k < s->used; k++)
            to[count * k + c] = frontal->x[c * s->columns + k];
}

static void add_below(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int count, double *right) {
    const int32_t *rows = frontal->system->rows + front->row_start;
    int32_t block = frontal->block;
    for (int32_t i = 0; i < front->row_count; i++)
        for (int32_t k = 0; k < block; k++)
            for (int c = 0; c < count; c++)
                right[(block * (size_t)rows[i] + (size_t)k) * (size_t)count + (size_t)c] +=
                    frontal->below[4 * c * s->below_tiles + block * i + k];
}

static void take_below(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, int count, const double *right) {
    const int32_t *rows = frontal->system->rows + front->row_start;
    int32_t block = frontal->block;
    for (int32_t i = 0; i < front->row_count; i++)
        for (int32_t k = 0; k < block; k++)
            for (int c = 0; c < count; c++)
                frontal->below[4 * c * s->below_tiles + block * i + k] =
                    right[(block * (size_t)rows[i] + (size_t)k) * (size_t)count + (size_t)c];
    for (int32_t i = s->below; i < 4 * s->below_tiles; i++)
        for (int c = 0; c < count; c++)
            frontal->below[4 * c * s->below_tiles + i] = 0;
}

/* ---- All of them ---- */

void ss_eliminate_right(ss_frontal *frontal, int count, double *right) {
    for (int32_t f = 0; f < frontal->system->front_count; f++) {
        const ss_front *front = &frontal->system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        take_columns(frontal, front, &s, count, right);
        frontal->kernels->forward[count - 1](&s, frontal->L + frontal->panel[f], frontal->x, frontal->below);
        put_columns(frontal, front, &s, count, right);
        add_below(frontal, front, &s, count, right);
    }
}

static void divide_columns(const ss_frontal *frontal, const ss_shape *s, const double *panel, int count) {
    for (int32_t k = 0; k < s->columns; k++)
        for (int c = 0; c < count; c++)
            frontal->x[c * s->columns + k] *= panel[4 * (size_t)s->columns * (size_t)(k / 4) + 4 * (size_t)k + (size_t)(k % 4)];
}

static void take_extras(const ss_frontal *frontal, const ss_shape *s, const double *panel) {
    const double *extras = panel + 4 * (size_t)s->columns * (size_t)(s->tiles - 1);
    for (int32_t k = 0; k < s->columns; k++)
        frontal->x[k] = extras[4 * k + 1], frontal->x[s->columns + k] = extras[4 * k + 2];
}

void ss_substitute_back(ss_frontal *frontal, int count, bool carried, double *right) {
    for (int32_t f = frontal->system->front_count - 1; f >= 0; f--) {
        const ss_front *front = &frontal->system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        const double *panel = frontal->L + frontal->panel[f];
        if (carried) {
            take_extras(frontal, &s, panel);
        } else {
            take_columns(frontal, front, &s, count, right);
            divide_columns(frontal, &s, panel, count);
        }
        take_below(frontal, front, &s, count, right);
        frontal->kernels->backward[count - 1](&s, panel, frontal->x, frontal->below);
        put_columns(frontal, front, &s, count, right);
    }
}
