/* Nets of springs: forces are balanced by what is solved for, in floats. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is left of b [vertices][4] when every spring pulls by x, over the largest force. */
static double residual_of(const ss_net *net, double stiffness, const double *own, const float (*x)[4], const float (*b)[4]) {
    double(*left)[4] = malloc((size_t)net->vertex_count * sizeof *left), off = 0, most = 0;
    for (int32_t v = 0; v < net->vertex_count; v++)
        for (int k = 0; k < 4; k++)
            left[v][k] = (double)b[v][k] - own[v] * (double)x[v][k];
    for (int32_t e = 0; e < net->edge_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t *v = net->edge_vertex[e];
            double force = stiffness * ((double)x[v[1]][k] - (double)x[v[0]][k]);
            left[v[0]][k] += force, left[v[1]][k] -= force;
            most = fmax(most, fabs(force));
        }
    for (int32_t v = 0; v < net->vertex_count; v++)
        for (int k = 0; k < 4 && !net->fixed[v]; k++)
            off = fmax(off, fabs(left[v][k]));
    free(left);
    return off / most;
}

/* Each vertex is held as stiff as least, or up to twice as stiff. */
static double solve_random(const ss_net *net, double stiffness, double least) {
    ss_springs *springs;
    ss_memory memory = {0};
    skinslide_error error;
    dice d = {7};
    double *own = SS_NEW(&memory, double, net->vertex_count);
    for (int32_t v = 0; v < net->vertex_count; v++)
        own[v] = roll_between(&d, 1, 2) * least;
    assert_ok(ss_springs_create(net, "net", stiffness, own, &springs, &error), &error);
    float(*b)[4] = ss_new(&memory, net->vertex_count, sizeof *b), (*x)[4] = ss_new(&memory, net->vertex_count, sizeof *x);
    float(*right)[4] = ss_new(&memory, net->vertex_count, sizeof *right);
    float(*scratch)[4] = ss_new(&memory, ss_springs_scratch(springs), sizeof *scratch);
    for (int32_t v = 0; v < net->vertex_count; v++) {
        int32_t unknown = ss_springs_unknown(springs, v);
        assert_true((unknown < 0) == net->fixed[v]);
        for (int k = 0; k < 4 && unknown >= 0; k++)
            b[v][k] = right[unknown][k] = (float)roll_between(&d, -1, 1);
    }
    ss_springs_solve(springs, scratch, right);
    for (int32_t v = 0; v < net->vertex_count; v++)
        if (!net->fixed[v])
            memcpy(x[v], right[ss_springs_unknown(springs, v)], sizeof *x);
    double residual = residual_of(net, stiffness, own, (const float(*)[4])x, (const float(*)[4])b);
    ss_free(&memory);
    ss_springs_destroy(springs);
    return residual;
}

/* The residual is some roundings of floats for each spring, and for each entry that a solution is summed from. */
static void forces_are_balanced(void **state) {
    (void)state;
    for (int32_t side = 2; side < 80; side += 11)
        for (int closed = 0; closed < 2; closed++) {
            test_mesh mesh = side % 2 ? triangle_grid(side, side) : quad_grid(side, side + 3);
            ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
            uint8_t *none = calloc((size_t)patch->vertex_count, 1);
            ss_net net = ss_net_of(patch, closed ? none : patch->fixed);
            assert_true(solve_random(&net, 0.0165, closed ? 1e-3 : 0) < 1e-4);
            free(none);
            ss_patch_destroy(patch);
            free_mesh(&mesh);
        }
}

static void what_nothing_holds_is_refused(void **state) {
    (void)state;
    const int32_t edges[2][2] = {{0, 1}, {1, 2}};
    const uint8_t fixed[3] = {0, 0, 0};
    const double own[3] = {0, 0, 0};
    const ss_net net = {3, 2, edges, fixed};
    ss_springs *springs = NULL;
    skinslide_error error;
    assert_fails(ss_springs_create(&net, "net", 1, own, &springs, &error), &error, SKINSLIDE_SINGULAR,
                 "net: nothing holds its vertices");
    assert_null(springs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_balanced),
        cmocka_unit_test(what_nothing_holds_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
