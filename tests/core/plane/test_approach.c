/* Hops towards several points at once, beside walks to each. */
#include "queries.h"

#include <stdlib.h>
#include <string.h>

enum { HOPS = 3 };

typedef struct net {
    test_mesh mesh;
    ss_patch *patch;
    ss_memory memory;
    ss_paving paving;
} net;

/* A posed sheet, in its embedding. */
static void make_net(test_mesh mesh, uint64_t seed, net *n) {
    *n = (net){.mesh = mesh};
    n->patch = patch_of(&n->mesh, (skinslide_patch_setup){0});
    float *points = random_pose(&n->mesh, seed);
    double(*uv)[2] = embedding_of(n->patch, n->mesh.points, points);
    assert_true(ss_lay_out(n->patch, (const double(*)[2])uv).regular);
    assert_true(ss_pave(&n->memory, n->patch, &n->paving));
    ss_paving_lay_out(&n->paving, (const double(*)[2])uv);
    free(uv), free(points);
}

static void free_net(net *n) {
    ss_free(&n->memory);
    ss_patch_destroy(n->patch);
    free_mesh(&n->mesh);
}

/* The centre of a slab, where it is clear on which side of each line a point is. */
static void centre_of(const ss_paving *paving, int32_t slab, double out[2]) {
    for (int axis = 0; axis < 2; axis++) {
        out[axis] = 0;
        for (int k = 0; k < 3; k++)
            out[axis] += paving->uv[paving->slab[slab].vertex[k]][axis] / 3;
    }
}

/* A point is found only where a walk ends at once and off all sides, and its place is then the walk's to the bit. */
static void expect_places(const ss_paving *paving, const double (*p)[2], const int32_t slab[SS_AT_ONCE],
                          const ss_place places[SS_AT_ONCE], const bool found[SS_AT_ONCE]) {
    for (int i = 0; i < SS_AT_ONCE; i++) {
        ss_place place;
        int64_t steps = 0;
        bool on_border = false, ends = ss_paving_walk(paving, slab[i], p[i], &on_border, &steps) == slab[i] && steps == 0;
        assert_true(!found[i] || (ends && !on_border));
        if (!found[i])
            continue;
        ss_paving_place_at(paving, slab[i], p[i], &place);
        assert_int_equal(places[i].triangle, place.triangle);
        assert_same_bytes(places[i].weight, place.weight, sizeof place.weight);
        assert_same_bytes(places[i].uv, place.uv, sizeof place.uv);
    }
}

/* Hops as processors with and without AVX2 do. Returns how many slabs were entered. */
static int64_t approach(const ss_paving *paving, const double (*p)[2], int32_t slab[SS_AT_ONCE], bool found[SS_AT_ONCE]) {
    int32_t plain[SS_AT_ONCE];
    bool plain_found[SS_AT_ONCE];
    ss_place places[SS_AT_ONCE], plain_places[SS_AT_ONCE];
    memcpy(plain, slab, sizeof plain);
    int64_t entered = ss_paving_approach(paving, p, slab, places, found);
    assert_int_equal(ss_paving_approach_plain(paving, p, plain, plain_places, plain_found), entered);
    assert_memory_equal(plain, slab, sizeof plain);
    assert_memory_equal(plain_found, found, sizeof plain_found);
    expect_places(paving, p, slab, places, found);
    expect_places(paving, p, slab, plain_places, found);
    return entered;
}

/* Hops arrive if the slab is within as many steps of a walk; the others go as far as hops can. */
static void hops_are_steps_of_walks(void **state) {
    (void)state;
    dice d = {6};
    for (uint64_t seed = 0; seed < 20; seed++) {
        net n;
        make_net(seed % 2 ? quad_grid(7, 7) : triangle_grid(6, 8), seed, &n);
        int32_t count = n.patch->triangles.count, arrived = 0;
        for (int round = 0; round < 50; round++) {
            double p[SS_AT_ONCE][2];
            int32_t slab[SS_AT_ONCE], begun[SS_AT_ONCE], wanted[SS_AT_ONCE];
            bool found[SS_AT_ONCE];
            int64_t steps = 0;
            for (int i = 0; i < SS_AT_ONCE; i++) {
                int64_t own = 0;
                bool on_border;
                wanted[i] = roll_below(&d, count), slab[i] = begun[i] = roll_below(&d, count);
                centre_of(&n.paving, wanted[i], p[i]);
                assert_int_equal(ss_paving_walk(&n.paving, slab[i], p[i], &on_border, &own), wanted[i]);
                steps += own < HOPS ? own : HOPS;
            }
            assert_int_equal(approach(&n.paving, (const double(*)[2])p, slab, found), steps);
            for (int i = 0; i < SS_AT_ONCE; i++) {
                int64_t whole = 0, left = 0;
                bool on_border;
                ss_paving_walk(&n.paving, begun[i], p[i], &on_border, &whole);
                ss_paving_walk(&n.paving, slab[i], p[i], &on_border, &left);
                assert_int_equal(left, whole < HOPS ? 0 : whole - HOPS);
                assert_true(found[i] == (slab[i] == wanted[i]));
                arrived += found[i];
            }
        }
        assert_true(arrived > 0);
        free_net(&n);
    }
}

/* From any slab, to points that none holds. */
static void hops_stay_on_the_patch(void **state) {
    (void)state;
    dice d = {7};
    net n;
    make_net(triangle_grid(5, 5), 1, &n);
    for (int round = 0; round < 200; round++) {
        double p[SS_AT_ONCE][2];
        int32_t slab[SS_AT_ONCE];
        bool found[SS_AT_ONCE];
        for (int i = 0; i < SS_AT_ONCE; i++) {
            slab[i] = roll_below(&d, n.patch->triangles.count);
            for (int axis = 0; axis < 2; axis++)
                p[i][axis] = roll_between(&d, -2, 3);
        }
        approach(&n.paving, (const double(*)[2])p, slab, found);
        for (int i = 0; i < SS_AT_ONCE; i++)
            assert_true(slab[i] >= 0 && slab[i] < n.patch->triangles.count);
    }
    free_net(&n);
}

/* On corners, on sides and a rounding beside them, where only an exact test can tell. */
static void what_is_in_doubt_is_left_to_walks(void **state) {
    (void)state;
    dice d = {8};
    net n;
    make_net(triangle_grid(5, 5), 2, &n);
    for (int round = 0; round < 200; round++) {
        double p[SS_AT_ONCE][2];
        int32_t slab[SS_AT_ONCE];
        bool found[SS_AT_ONCE];
        for (int i = 0; i < SS_AT_ONCE; i++) {
            slab[i] = roll_below(&d, n.patch->triangles.count);
            const int32_t *v = n.paving.slab[slab[i]].vertex;
            const double *a = n.paving.uv[v[i % 3]], *b = n.paving.uv[v[(i + 1) % 3]];
            double share = round % 4 == 0 ? 0 : roll_between(&d, 0, 1);
            for (int axis = 0; axis < 2; axis++)
                p[i][axis] = a[axis] + share * (b[axis] - a[axis]);
        }
        approach(&n.paving, (const double(*)[2])p, slab, found);
        for (int i = 0; i < SS_AT_ONCE && round % 4 == 0; i++)
            assert_false(found[i]);
    }
    free_net(&n);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hops_are_steps_of_walks),
        cmocka_unit_test(hops_stay_on_the_patch),
        cmocka_unit_test(what_is_in_doubt_is_left_to_walks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
