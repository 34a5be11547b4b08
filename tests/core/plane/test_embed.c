/* The embedding's system: sparse against dense, its residual, what it promises, and what it cannot solve. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_status embed_once(const ss_net *net, const double *density, double (*uv)[2], skinslide_error *error) {
    return ss_embed_once(net, "patch p", density, uv, error);
}

static double *random_densities(int32_t count, uint64_t seed, double decades) {
    dice d = {seed};
    double *density = malloc((size_t)count * sizeof *density);
    for (int32_t e = 0; e < count; e++)
        density[e] = pow(10, roll_between(&d, -decades / 2, decades / 2));
    return density;
}

/* 2 x 2 quads: vertex 4 is joined to 1, 3, 5, 7. Its place is their mean weighted by density:
 *     u = (1 u1 + 2 u3 + 3 u5 + 4 u7) / 10, two roundings of numbers under 1 apart. */
static void the_free_vertex_is_the_weighted_mean(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
    double density[12], (*uv)[2] = held_uv_of(patch, mesh.points);
    skinslide_error error;
    for (int e = 0; e < 12; e++)
        density[e] = 100;
    density[ss_patch_edge(patch, 1, 4)] = 1, density[ss_patch_edge(patch, 3, 4)] = 2;
    density[ss_patch_edge(patch, 5, 4)] = 3, density[ss_patch_edge(patch, 7, 4)] = 4;
    ss_net net = ss_net_of(patch, patch->fixed);
    assert_ok(embed_once(&net, density, uv, &error), &error);
    assert_near(uv[4][0], (1 * 0.5 + 2 * 0 + 3 * 1 + 4 * 0.5) / 10, 2e-16);
    assert_near(uv[4][1], (1 * 0 + 2 * 0.5 + 3 * 0.5 + 4 * 1) / 10, 2e-16);
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void compare_with_dense(const ss_patch *patch, const float *rest_points, const double *density, double tolerance) {
    double(*sparse)[2] = held_uv_of(patch, rest_points), (*dense)[2] = held_uv_of(patch, rest_points);
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_error error;
    assert_ok(embed_once(&net, density, sparse, &error), &error);
    embed_densely(&net, density, dense);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int k = 0; k < 2; k++)
            assert_near(sparse[v][k], dense[v][k], tolerance);
    free(sparse), free(dense);
}

/* Two decades of densities: systems of condition about 1e4 at most, solved to 1e-16 backward: 1e-11 leaves room for both. */
static void sparse_and_dense_agree(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        for (int32_t holes = 0; holes < 2; holes++) {
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){.holes = (skinslide_holes)holes});
            double *density = random_densities(patch->faces.edge_count, (uint64_t)i, 2);
            compare_with_dense(patch, f.mesh.points, density, 1e-11);
            free(density);
            ss_patch_destroy(patch);
        }
        free_mesh(&f.mesh);
    }
}

/* Recomputed from the solution: the forces at each free vertex cancel, to the rounding of a backward stable solution: some eps
 * for every entry of a row of the factor, of which there are under 64 here. */
static void expect_balance(const ss_patch *patch, const double *density, const double (*uv)[2]) {
    double(*force)[2] = calloc((size_t)patch->vertex_count, sizeof *force), *size = calloc((size_t)patch->vertex_count, 8);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        for (int k = 0; k < 2; k++) {
            force[v[0]][k] += density[e] * (uv[v[1]][k] - uv[v[0]][k]);
            force[v[1]][k] += density[e] * (uv[v[0]][k] - uv[v[1]][k]);
        }
        size[v[0]] += density[e], size[v[1]] += density[e];
    }
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int k = 0; k < 2 && !patch->fixed[v]; k++)
            assert_near(force[v][k], 0, 64 * DBL_EPSILON * size[v]);
    free(force), free(size);
}

static void forces_cancel(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t decades = 0; decades <= 8; decades += 4) {
            fixture f = make_fixture(i);
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
            double *density = random_densities(patch->faces.edge_count, (uint64_t)i, decades);
            double(*uv)[2] = held_uv_of(patch, f.mesh.points);
            ss_net net = ss_net_of(patch, patch->fixed);
            skinslide_error error;
            assert_ok(embed_once(&net, density, uv, &error), &error);
            expect_balance(patch, density, (const double(*)[2])uv);
            free(uv), free(density);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

/* Means of means: every free vertex is inside the square that holds the fixed ones, and inside the circle: below exactly, since
 * the solution adds positive numbers only, above up to its rounding. */
static void embeddings_are_inside(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t square = 0; square < 2; square++) {
            fixture f = make_fixture(i);
            ss_patch *patch =
                patch_of(&f.mesh, (skinslide_patch_setup){.boundary = f.square && square ? SKINSLIDE_BOUNDARY_SQUARE
                                                                                         : SKINSLIDE_BOUNDARY_CIRCLE});
            double(*uv)[2] = embedding_of(patch, f.mesh.points, f.mesh.points);
            for (int32_t v = 0; v < patch->vertex_count; v++) {
                double radius = hypot(uv[v][0] - 0.5, uv[v][1] - 0.5);
                assert_true(uv[v][0] >= 0 && uv[v][0] <= 1 + 1e-15 && uv[v][1] >= 0 && uv[v][1] <= 1 + 1e-15);
                assert_true((f.square && square) || radius <= 0.5 + 1e-15);
            }
            free(uv);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

/* A factor is used again and again: what it solved before leaves no trace. */
static void a_factor_remembers_nothing(void **state) {
    (void)state;
    test_mesh mesh = triangle_grid(9, 9);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    ss_net net = ss_net_of(patch, patch->fixed);
    size_t size = (size_t)patch->vertex_count * sizeof(double[2]);
    double(*first)[2] = held_uv_of(patch, mesh.points), (*again)[2] = held_uv_of(patch, mesh.points);
    double *density = random_densities(net.edge_count, 1, 3), *other = random_densities(net.edge_count, 2, 3);
    ss_system *system = NULL;
    ss_factor *factor = NULL;
    skinslide_error error;
    assert_ok(ss_system_create(&net, "patch p", &system, &error), &error);
    assert_ok(ss_factor_create(system, NULL, &factor, &error), &error);
    const double *densities[] = {density, other, density};
    for (int i = 0; i < 3; i++) {
        memcpy(factor->entry, densities[i], (size_t)net.edge_count * sizeof *density);
        assert_ok(ss_embed(system, factor, i == 0 ? first : again, &error), &error);
    }
    assert_same_bytes(first, again, size);
    ss_factor_destroy(factor);
    ss_system_destroy(system);
    free(first), free(again), free(density), free(other);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void nothing_free_is_nothing_to_solve(void **state) {
    (void)state;
    test_mesh mesh = polygon(5);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double density[5] = {1, 1, 1, 1, 1}, (*uv)[2] = held_uv_of(patch, mesh.points), (*held)[2] = held_uv_of(patch, mesh.points);
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_error error;
    assert_ok(embed_once(&net, density, uv, &error), &error);
    assert_same_bytes(uv, held, 5 * sizeof *uv);
    free(uv), free(held);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* Densities by which a double cannot be divided. */
static void what_cannot_be_solved_is_refused(void **state) {
    (void)state;
    const int32_t edges[3][2] = {{0, 1}, {1, 2}, {2, 3}};
    const uint8_t fixed[4] = {1, 0, 0, 1};
    ss_net net = {4, 3, edges, fixed};
    double uv[4][2] = {{0, 0}, {0, 0}, {0, 0}, {1, 1}};
    skinslide_error error;
    const double densities[2][3] = {{1e-310, 1e-310, 1e-310}, {1e308, 1e308, 1e308}};
    for (int k = 0; k < 2; k++) {
        skinslide_status status = embed_once(&net, densities[k], uv, &error);
        assert_fails(status, &error, SKINSLIDE_SINGULAR,
                     "patch p: its force densities differ too much in size for the embedding to be solved");
        assert_true(uv[1][0] == 0 && uv[2][0] == 0);
    }
}

/* A chain of free vertices between 0 and 1, of densities over up to eighty decades. Like resistors in a row, vertex k is at
 *     u_k = sum of 1/q over the edges before it / sum of 1/q over all,
 * and the answer has all its digits but the few that forty roundings take: nothing is ever subtracted. */
static void check_chain(dice *d) {
    enum { N = 40 };
    int32_t edges[N + 1][2];
    const uint8_t fixed[N + 2] = {[0] = 1, [N + 1] = 1};
    double density[N + 1], uv[N + 2][2] = {[N + 1] = {1, 1}}, whole = 0, before = 0, decades = roll_between(d, 0, 80);
    for (int32_t e = 0; e <= N; e++) {
        edges[e][0] = e, edges[e][1] = e + 1;
        density[e] = pow(10, roll_between(d, 0, decades));
        whole += 1 / density[e];
    }
    ss_net net = {N + 2, N + 1, (const int32_t(*)[2])edges, fixed};
    skinslide_error error;
    assert_ok(embed_once(&net, density, uv, &error), &error);
    for (int32_t v = 1; v <= N; v++) {
        before += 1 / density[v - 1];
        assert_near(uv[v][0] / (before / whole), 1, 1000 * DBL_EPSILON);
    }
}

static void every_digit_is_right(void **state) {
    (void)state;
    dice d = {8};
    for (int round = 0; round < 2000; round++)
        check_chain(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_free_vertex_is_the_weighted_mean),
        cmocka_unit_test(sparse_and_dense_agree),
        cmocka_unit_test(forces_cancel),
        cmocka_unit_test(embeddings_are_inside),
        cmocka_unit_test(a_factor_remembers_nothing),
        cmocka_unit_test(nothing_free_is_nothing_to_solve),
        cmocka_unit_test(what_cannot_be_solved_is_refused),
        cmocka_unit_test(every_digit_is_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
