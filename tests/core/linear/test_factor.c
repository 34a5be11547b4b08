/* The embedding's factor against one of dense rows in long doubles, and on processors with and without AVX2; the order and the
 * fronts that it goes by, on nets of every shape. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Nets ---- */

typedef struct built_net {
    ss_net net;
    int32_t (*edges)[2];
    uint8_t *fixed;
} built_net;

static built_net new_net(int32_t vertices, int32_t edges) {
    built_net b = {.edges = calloc((size_t)edges + 1, sizeof *b.edges), .fixed = calloc((size_t)vertices, 1)};
    b.net = (ss_net){vertices, 0, (const int32_t(*)[2])b.edges, b.fixed};
    return b;
}

static void free_net(built_net *b) {
    free(b->edges), free(b->fixed);
}

static void join(built_net *b, int32_t from, int32_t to) {
    b->edges[b->net.edge_count][0] = from, b->edges[b->net.edge_count++][1] = to;
}

/* A grid, numbered at random, in which every vertex of the first row is fixed. */
static built_net shuffled_grid(int32_t columns, int32_t rows, uint64_t seed) {
    built_net b = new_net(columns * rows, 3 * columns * rows);
    int32_t *name = malloc((size_t)(columns * rows) * sizeof *name);
    dice d = {seed};
    for (int32_t i = 0; i < columns * rows; i++) {
        int32_t other = roll_below(&d, i + 1);
        name[i] = name[other], name[other] = i;
    }
    for (int32_t i = 0; i < columns * rows; i++) {
        if (i % columns + 1 < columns)
            join(&b, name[i], name[i + 1]);
        if (i + columns < columns * rows)
            join(&b, name[i], name[i + columns]);
        if (i % columns + 1 < columns && i + columns < columns * rows)
            join(&b, name[i], name[i + columns + 1]);
        b.fixed[name[i]] = i < columns;
    }
    free(name);
    return b;
}

static built_net path(int32_t count) {
    built_net b = new_net(count, count);
    for (int32_t i = 0; i + 1 < count; i++)
        join(&b, i, i + 1);
    b.fixed[0] = 1;
    return b;
}

static built_net star(int32_t count) {
    built_net b = new_net(count, count);
    for (int32_t i = 1; i < count; i++)
        join(&b, 0, i);
    b.fixed[count - 1] = 1;
    return b;
}

/* Pairs of vertices, one of each fixed: no two free vertices are joined. */
static built_net pairs(int32_t count) {
    built_net b = new_net(2 * count, count);
    for (int32_t i = 0; i < count; i++)
        join(&b, 2 * i, 2 * i + 1), b.fixed[2 * i] = 1;
    return b;
}

static built_net clique(int32_t count) {
    built_net b = new_net(count, count * count / 2);
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; j < i; j++)
            join(&b, i, j);
    b.fixed[count / 2] = 1;
    return b;
}

enum { NETS = 8 };

static built_net make_net(int i) {
    switch (i) {
    case 0:
        return path(1);
    case 1:
        return path(5000);
    case 2:
        return star(3000);
    case 3:
        return pairs(2500);
    case 4:
        return clique(70);
    case 5:
        return shuffled_grid(13, 9, 1);
    case 6:
        return shuffled_grid(400, 8, 2);
    default:
        return shuffled_grid(70, 60, 3);
    }
}

/* ---- The order and the fronts ---- */

static void check_front(const ss_system *system, int32_t f, int32_t *columns) {
    const ss_front *front = &system->fronts[f];
    assert_int_equal(front->first, *columns);
    *columns += front->count;
    assert_true(front->parent < 0 ? front->row_count == 0 : front->parent > f);
    for (int32_t i = front->row_start; i < front->row_start + front->row_count; i++) {
        const ss_front *parent = &system->fronts[front->parent];
        int32_t place = system->place[i];
        assert_true(system->rows[i] >= *columns && system->rows[i] < system->n);
        assert_true(i == front->row_start || system->rows[i] > system->rows[i - 1]);
        assert_int_equal(system->rows[i], place < parent->count ? parent->first + place
                                                                : system->rows[parent->row_start + place - parent->count]);
    }
}

/* Every unknown has a number, columns follow each other, rows of a front are rows or columns of its parent. */
static void fronts_hold_the_factor(void **state) {
    (void)state;
    for (int i = 0; i < NETS; i++) {
        built_net b = make_net(i);
        ss_system *system;
        skinslide_error error;
        assert_ok(ss_system_create(&b.net, "net", &system, &error), &error);
        uint8_t *seen = calloc((size_t)b.net.vertex_count, 1);
        for (int32_t v = 0; v < b.net.vertex_count; v++) {
            int32_t k = system->unknown[v];
            assert_true(b.fixed[v] ? k == -1 : k >= 0 && k < system->n && !seen[k]++);
        }
        int32_t columns = 0;
        for (int32_t f = 0; f < system->front_count; f++)
            check_front(system, f, &columns);
        assert_int_equal(columns, system->n);
        free(seen);
        ss_system_destroy(system);
        free_net(&b);
    }
}

/* What the fronts of a grid hold grows as n log n (George 1973); an order by rows has sqrt(n) an unknown, which at 250 x 250 is
 * more than four times as much as is let through here. */
static void large_grids_fill_little(void **state) {
    (void)state;
    const int32_t sides[2] = {60, 250};
    for (int i = 0; i < 2; i++) {
        built_net b = shuffled_grid(sides[i], sides[i], 4);
        ss_system *system;
        skinslide_error error;
        assert_ok(ss_system_create(&b.net, "net", &system, &error), &error);
        double entries = 0, n = system->n;
        for (int32_t f = 0; f < system->front_count; f++)
            entries += system->fronts[f].count * (system->fronts[f].row_count + 0.5 * system->fronts[f].count);
        print_message("%.0f unknowns: %.1f entries each\n", n, entries / n);
        assert_true(entries < 3.5 * n * log2(n));
        ss_system_destroy(system);
        free_net(&b);
    }
}

/* ---- Solutions ---- */

/* Densities e^-range to e^range; right sides that are positive, as those of points in [0,1] are. */
static void fill(ss_factor *factor, const built_net *b, double range, uint64_t seed) {
    const ss_system *system = factor->frontal->system;
    dice d = {seed};
    ss_factor_clear(factor);
    for (int32_t e = 0; e < b->net.edge_count; e++) {
        double density = exp(roll_between(&d, -range, range));
        factor->entry[e] = density;
        for (int end = 0; end < 2; end++) {
            int32_t own = system->unknown[b->edges[e][end]];
            if (own < 0 || system->unknown[b->edges[e][1 - end]] >= 0)
                continue;
            factor->slack[own] += density;
            for (int k = 0; k < 2; k++)
                factor->right[own][k] += density * roll_between(&d, 0.1, 1);
        }
    }
}

/* The same by rows that are stored whole, in long doubles, from the last unknown to the first; no entry is subtracted. */
static long double *solve_whole(const ss_factor *factor, const built_net *b) {
    const ss_system *system = factor->frontal->system;
    size_t n = (size_t)system->n, width = n + 3;
    long double *rows = calloc(n * width + 1, sizeof *rows);
    for (int32_t e = 0; e < b->net.edge_count; e++) {
        int32_t i = system->unknown[b->edges[e][0]], j = system->unknown[b->edges[e][1]];
        if (i >= 0 && j >= 0)
            rows[(size_t)i * width + (size_t)j] = rows[(size_t)j * width + (size_t)i] = (long double)factor->entry[e];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            rows[i * width + n + k] = (long double)(k == 2 ? factor->slack[i] : factor->right[i][k]);
    for (size_t k = n; k-- > 0;) {
        long double pivot = rows[k * width + n + 2];
        for (size_t j = 0; j < k; j++)
            pivot += rows[k * width + j];
        for (size_t j = 0; j < width; j++)
            rows[k * width + j] = j < k || j >= n ? rows[k * width + j] / pivot : 0;
        for (size_t i = 0; i < k; i++)
            for (size_t j = 0; j < width; j++)
                if (j != i && (j < k || j >= n))
                    rows[i * width + j] += rows[i * width + k] * rows[k * width + j];
    }
    for (size_t k = 0; k < n; k++)
        for (size_t j = 0; j < k; j++)
            for (size_t c = 0; c < 2; c++)
                rows[k * width + n + c] += rows[k * width + j] * rows[j * width + n + c];
    return rows;
}

static const double ranges[4] = {0, 5, 12, 20};

/* Each number is right to 1e-12 of itself, however much densities differ, for right sides that are carried along and for those
 * solved afterwards. */
static void every_number_is_right(void **state) {
    (void)state;
    for (int i = 4; i < 6; i++)
        for (int r = 0; r < 4; r++) {
            built_net b = make_net(i);
            ss_system *system;
            ss_factor *factor;
            skinslide_error error;
            assert_ok(ss_system_create(&b.net, "net", &system, &error), &error);
            assert_ok(ss_factor_create(system, NULL, &factor, &error), &error);
            fill(factor, &b, ranges[r], (uint64_t)i);
            long double *expected = solve_whole(factor, &b);
            size_t n = (size_t)system->n, size = n * sizeof *factor->right;
            double(*right)[2] = malloc(size);
            memcpy(right, factor->right, size);
            assert_true(ss_factorise_and_solve(factor));
            for (int again = 0; again < 2; again++) {
                for (size_t k = 0; k < 2 * n; k++) {
                    double value = (double)expected[k / 2 * (n + 3) + n + k % 2];
                    assert_near(factor->right[k / 2][k % 2] / value, 1, 1e-12);
                }
                memcpy(factor->right, right, size);
                ss_solve(factor);
            }
            free(right), free(expected);
            ss_factor_destroy(factor);
            ss_system_destroy(system);
            free_net(&b);
        }
}

/* ---- Processors ---- */

static void compare_kernels(const built_net *b, double range) {
    ss_system *system;
    ss_factor *factors[2];
    skinslide_error error;
    assert_ok(ss_system_create(&b->net, "net", &system, &error), &error);
    for (int fastest = 0; fastest < 2; fastest++) {
        assert_ok(ss_factor_create(system, NULL, &factors[fastest], &error), &error);
        factors[fastest]->frontal->kernels = ss_kernels_of(fastest);
        fill(factors[fastest], b, range, 9);
        assert_true(ss_factorise_and_solve(factors[fastest]));
    }
    assert_same_bytes(factors[0]->right, factors[1]->right, (size_t)system->n * sizeof *factors[0]->right);
    for (int fastest = 0; fastest < 2; fastest++)
        ss_solve(factors[fastest]);
    assert_same_bytes(factors[0]->right, factors[1]->right, (size_t)system->n * sizeof *factors[0]->right);
    ss_factor_destroy(factors[0]), ss_factor_destroy(factors[1]);
    ss_system_destroy(system);
}

static void compare_kernels_of_blocks(const built_net *b) {
    ss_system *system;
    ss_blocks *blocks[2];
    skinslide_error error;
    const int going_on = 0;
    assert_ok(ss_system_create(&b->net, "net", &system, &error), &error);
    for (int fastest = 0; fastest < 2; fastest++) {
        dice d = {5};
        assert_ok(ss_blocks_create(system, false, NULL, &blocks[fastest], &error), &error);
        blocks[fastest]->frontal->kernels = ss_kernels_of(fastest);
        for (int32_t k = 0; k < system->n; k++)
            for (int i = 0; i < 4; i++)
                blocks[fastest]->own[k][i] = i % 3 == 0 ? 5000 + roll_share(&d) : 0.5, blocks[fastest]->right[k][i / 2] = i;
        for (int32_t e = 0; e < b->net.edge_count; e++)
            for (int i = 0; i < 4; i++)
                blocks[fastest]->between[e][i] = roll_between(&d, -1, 1);
        assert_true(ss_blocks_factor(blocks[fastest], &going_on));
        ss_blocks_solve(blocks[fastest]);
    }
    assert_same_bytes(blocks[0]->right, blocks[1]->right, (size_t)system->n * sizeof *blocks[0]->right);
    ss_blocks_destroy(blocks[0]), ss_blocks_destroy(blocks[1]);
    ss_system_destroy(system);
}

static void processors_give_the_same_bytes(void **state) {
    (void)state;
    if (ss_kernels_of(true) == ss_kernels_of(false))
        skip();
    for (int i = 0; i < NETS; i++) {
        built_net b = make_net(i);
        compare_kernels(&b, 0);
        compare_kernels(&b, 20);
        compare_kernels_of_blocks(&b);
        free_net(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fronts_hold_the_factor),
        cmocka_unit_test(large_grids_fill_little),
        cmocka_unit_test(every_number_is_right),
        cmocka_unit_test(processors_give_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
