/* The walk, the tie rule and the search behind them, against all faces one by one. */
#include "queries.h"

#include <math.h>
#include <stdlib.h>

typedef struct queries {
    double (*at)[2];
    ss_place *found;
} queries;

static queries make_queries(const ss_patch *patch, const double (*uv)[2], dice *d) {
    size_t count = (size_t)patch->free_count + 1;
    queries q = {malloc(count * sizeof *q.at), malloc(count * sizeof *q.found)};
    for (int32_t i = 0; i < patch->free_count; i++)
        random_query(&patch->faces, uv, d, q.at[i]);
    return q;
}

static void free_queries(queries *q) {
    free(q->at), free(q->found);
}

/* The nearest point of a free vertex's own loop. */
static double away_from_loop(const ss_patch *patch, const double (*uv)[2], int32_t loop, const double p[2]) {
    double best = INFINITY, at[2];
    for (int32_t c = 0; c < patch->faces.corner_count; c++)
        if (patch->faces.corner_twin[c] < 0 && patch->vertex_loop[patch->faces.corner_vertex[c]] == loop)
            best = fmin(best, ss_nearest_on_side(&patch->faces, uv, c, p, at));
    return sqrt(best);
}

static void compare(const ss_patch *patch, const double (*uv)[2], int32_t vertex, const double p[2], const ss_place *found,
                    int32_t *clamped) {
    if (p[0] == uv[vertex][0] && p[1] == uv[vertex][1]) {
        assert_int_equal(found->triangle, SS_STAYS);
        return;
    }
    double away = hypot(p[0] - found->uv[0], p[1] - found->uv[1]);
    if (patch->vertex_loop[vertex] >= 0) {
        assert_near(away, away_from_loop(patch, uv, patch->vertex_loop[vertex], p), 1e-15);
        return;
    }
    bool inside;
    ss_place expected = search_all(patch, uv, p, &inside);
    if (inside) {
        assert_same_place(found, &expected);
        assert_true(found->uv[0] == p[0] && found->uv[1] == p[1]);
    } else {
        assert_near(away, hypot(p[0] - expected.uv[0], p[1] - expected.uv[1]), 1e-15); /* rounding of distances under 2 */
        *clamped += away > 0;
    }
}

/* regular as it is, then denied: the walk and the search give the same. */
static void compare_all(const ss_patch *patch, const double (*uv)[2], dice *d) {
    ss_locator *locator = NULL;
    skinslide_error error;
    queries q = make_queries(patch, uv, d);
    assert_ok(ss_locator_create(patch, &locator, &error), &error);
    bool regular = ss_lay_out(patch, uv).regular;
    for (int pass = 0; pass < 2; pass++) {
        ss_located located = ss_locate(locator, uv, regular && pass == 0, (const double(*)[2])q.at, NULL, q.found);
        int32_t clamped = 0;
        for (int32_t i = 0; i < patch->free_count; i++)
            compare(patch, uv, patch->free_vertex[i], q.at[i], &q.found[i], &clamped);
        assert_int_equal(located.clamped, clamped);
        assert_true(located.steps == 0 || (regular && pass == 0));
    }
    ss_locator_destroy(locator);
    free_queries(&q);
}

/* Embeddings of random poses, on which the walk starts. */
static void the_walk_finds_the_lowest_face(void **state) {
    (void)state;
    dice d = {1};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t round = 0; round < 8; round++) {
            fixture f = make_fixture(i);
            ss_patch *patch =
                patch_of(&f.mesh, (skinslide_patch_setup){.holes = (skinslide_holes)(round % 2),
                                                          .boundary = f.square && round % 4 / 2 ? SKINSLIDE_BOUNDARY_SQUARE
                                                                                                : SKINSLIDE_BOUNDARY_CIRCLE});
            float *points = random_pose(&f.mesh, (uint64_t)round);
            double(*uv)[2] = embedding_of(patch, f.mesh.points, points);
            compare_all(patch, (const double(*)[2])uv, &d);
            free(uv), free(points);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

static void tangles_are_searched(void **state) {
    (void)state;
    dice d = {2};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        double(*uv)[2] = tangled(patch, (uint64_t)i);
        compare_all(patch, (const double(*)[2])uv, &d);
        free(uv);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
}

/* A grid in the plane as it is: every vertex and side of it lies on lines of its neighbours, so ties are everywhere, and with
 * two columns squeezed into one, faces of no area are between. */
static void ties_go_to_the_lowest_face(void **state) {
    (void)state;
    dice d = {3};
    for (int32_t squeeze = 0; squeeze < 3; squeeze++) {
        test_mesh mesh = squeeze == 1 ? triangle_grid(16, 16) : quad_grid(16, 16);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        double uv[17 * 17][2];
        for (int32_t v = 0; v < 17 * 17; v++)
            uv[v][0] = (squeeze && v % 17 > 8 ? v % 17 - 1 : v % 17) / 16.0, uv[v][1] = v / 17 / 16.0;
        for (int round = 0; round < 10; round++)
            compare_all(patch, (const double(*)[2])uv, &d);
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

/* From where its neighbour landed, a vertex is a step or two away at every size; from its own face it would be as many as it
 * slides over, here up to a fifth of the sheet. */
static void a_walk_is_short(void **state) {
    (void)state;
    for (int32_t side = 20; side <= 80; side *= 2) {
        test_mesh mesh = quad_grid(side, side);
        rig r = rig_of(&mesh, (skinslide_patch_setup){0});
        float *points = copy_points(&mesh);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            points[3 * v] *= points[3 * v] / (float)side;
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&r, &mesh, points, NULL, &result);
        assert_true(result.walk_steps < 3 * (int64_t)mesh.vertex_count);
        assert_int_equal(result.searched_vertices, 0);
        free(slid), free(points);
        free_rig(&r);
        free_mesh(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_walk_finds_the_lowest_face),
        cmocka_unit_test(tangles_are_searched),
        cmocka_unit_test(ties_go_to_the_lowest_face),
        cmocka_unit_test(a_walk_is_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
