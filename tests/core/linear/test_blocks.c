/* Systems of two by two blocks: what is solved is what was filled in. */
#include "distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int going_on = 0, stop = 1;

static void fill_blocks(ss_blocks *blocks, const ss_patch *patch, dice *d) {
    ss_blocks_clear(blocks);
    for (int32_t i = 0; i < patch->free_count; i++) {
        double *own = ss_blocks_own(blocks, i);
        own[0] = 20 + roll_share(d), own[3] = 20 + roll_share(d), own[1] = own[2] = roll_share(d);
        blocks->right[i][0] = roll_share(d), blocks->right[i][1] = roll_share(d);
    }
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        bool first_is_row;
        if (patch->fixed[patch->edge_vertex[e][0]] || patch->fixed[patch->edge_vertex[e][1]])
            continue;
        double *between = ss_blocks_between(blocks, e, &first_is_row);
        for (int k = 0; k < 4; k++)
            between[k] = roll_between(d, -1, 1);
    }
}

/* residual -= A x, A the filled blocks. */
static void take_product(ss_blocks *blocks, const ss_patch *patch, const double (*x)[2], double (*residual)[2]) {
    for (int32_t i = 0; i < blocks->system->n; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++)
                residual[i][j] -= ss_blocks_own(blocks, i)[2 * j + k] * x[i][k];
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        int32_t a = ss_blocks_unknown(blocks, patch->edge_vertex[e][0]),
                b = ss_blocks_unknown(blocks, patch->edge_vertex[e][1]);
        bool first_is_row;
        if (a < 0 || b < 0)
            continue;
        const double *between = ss_blocks_between(blocks, e, &first_is_row);
        int32_t row = first_is_row ? a : b, column = first_is_row ? b : a;
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++) {
                residual[row][j] -= between[2 * j + k] * x[column][k];
                residual[column][k] -= between[2 * j + k] * x[row][j];
            }
    }
}

static ss_blocks *blocks_of(const ss_patch *patch, const uint8_t *fixed, ss_system **system) {
    ss_net net = ss_net_of(patch, fixed);
    skinslide_error error;
    ss_blocks *blocks;
    assert_ok(ss_system_create(&net, "grid", system, &error), &error);
    assert_ok(ss_blocks_create(*system, false, NULL, &blocks, &error), &error);
    return blocks;
}

/* Rows of twenty on the diagonal and at most sixteen ones beside it: well conditioned, so a residual of rounding. */
static void blocks_are_solved(void **state) {
    (void)state;
    test_mesh mesh = triangle_grid(9, 7);
    ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
    ss_system *system;
    ss_blocks *blocks = blocks_of(patch, patch->fixed, &system);
    size_t bytes = (size_t)patch->free_count * sizeof(double[2]);
    double(*x)[2] = malloc(bytes);
    for (uint64_t seed = 0; seed < 2; seed++) { /* the second on what the first left */
        dice d = {seed}, again = {seed}, both = {seed};
        fill_blocks(blocks, patch, &d);
        assert_true(ss_blocks_factor(blocks, &going_on));
        ss_blocks_solve(blocks);
        memcpy(x, blocks->right, bytes);
        fill_blocks(blocks, patch, &both);
        assert_true(ss_blocks_factor_and_solve(blocks, &going_on));
        assert_memory_equal(blocks->right, x, bytes);
        fill_blocks(blocks, patch, &again); /* the factor is where the matrix was */
        take_product(blocks, patch, (const double(*)[2])x, blocks->right);
        for (int32_t i = 0; i < patch->free_count; i++)
            assert_near(fabs(blocks->right[i][0]) + fabs(blocks->right[i][1]), 0, 1e-14);
    }
    assert_false(ss_blocks_factor(blocks, &stop));
    assert_false(ss_blocks_factor_and_solve(blocks, &stop));
    ss_blocks_own(blocks, 3)[0] = -1;
    assert_false(ss_blocks_factor(blocks, &going_on));
    free(x);
    ss_blocks_destroy(blocks);
    ss_system_destroy(system);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* Springs, each along a way of its own, whose stiffnesses are e^-80 to e^80, and nothing holds but a share of what acts. */
static void fill_springs(ss_blocks *blocks, const ss_patch *patch, dice *d, double share) {
    ss_blocks_clear(blocks);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        bool first_is_row;
        double k = exp(roll_between(d, -80, 80)), way[2] = {roll_between(d, -1, 1), roll_between(d, -1, 1)};
        double *between = ss_blocks_between(blocks, e, &first_is_row);
        for (int i = 0; i < 4; i++) {
            double stiffness = k * way[i / 2] * way[i % 2];
            between[i] = -stiffness;
            for (int end = 0; end < 2; end++)
                ss_blocks_own(blocks, ss_blocks_unknown(blocks, patch->edge_vertex[e][end]))[i] += stiffness;
        }
    }
    for (int32_t i = 0; i < blocks->system->n; i++)
        for (int k = 0; k < 4; k += 3) {
            ss_blocks_own(blocks, i)[k] *= 1 + share;
            blocks->right[i][k / 3] = roll_between(d, -1, 1) * sqrt(ss_blocks_own(blocks, i)[k]);
        }
}

/* However far apart stiffnesses are, and however little holds, residuals are rounding, in units of the square roots of the
 * diagonal. */
static void what_hardly_holds_is_solved(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 30; seed++) {
        test_mesh mesh = seed % 2 ? triangle_grid(9, 7) : quad_grid(12, 2);
        ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
        uint8_t *none = calloc((size_t)patch->vertex_count, 1);
        ss_system *system;
        ss_blocks *blocks = blocks_of(patch, none, &system);
        size_t bytes = (size_t)patch->vertex_count * sizeof(double[2]);
        double(*x)[2] = malloc(bytes), size = 0;
        dice d = {seed}, again = {seed};
        fill_springs(blocks, patch, &d, 1e-12);
        assert_true(ss_blocks_factor(blocks, &going_on));
        ss_blocks_solve(blocks);
        memcpy(x, blocks->right, bytes);
        fill_springs(blocks, patch, &again, 1e-12);
        for (int32_t i = 0; i < 2 * patch->vertex_count; i++)
            size = fmax(size, sqrt(ss_blocks_own(blocks, i / 2)[3 * (i % 2)]) * fabs(x[i / 2][i % 2]));
        take_product(blocks, patch, (const double(*)[2])x, blocks->right);
        for (int32_t i = 0; i < 2 * patch->vertex_count; i++)
            assert_near(blocks->right[i / 2][i % 2] / sqrt(ss_blocks_own(blocks, i / 2)[3 * (i % 2)]), 0, 1e-14 * size);
        free(x), free(none);
        ss_blocks_destroy(blocks);
        ss_system_destroy(system);
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_solved),
        cmocka_unit_test(what_hardly_holds_is_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
