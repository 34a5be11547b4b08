/* The triangles of a patch in an order of their own, and walks over them. */
#include "queries.h"

#include <stdlib.h>

/* The mesh with its vertices and faces in no order. */
static test_mesh shuffled(const test_mesh *mesh, uint64_t seed) {
    dice d = {seed};
    test_mesh copy = copy_mesh(mesh->vertex_count, mesh->face_count, mesh->face_counts, mesh->face_indices, mesh->points);
    int32_t *place = calloc((size_t)mesh->vertex_count, sizeof *place);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t other = roll_below(&d, v + 1);
        place[v] = place[other], place[other] = v;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            copy.points[3 * place[v] + k] = mesh->points[3 * v + k];
    for (int32_t f = copy.face_count - 1, n = mesh->face_counts[0]; f >= 0; f--) { /* all faces are alike */
        int32_t other = roll_below(&d, f + 1);
        for (int32_t k = 0; k < n; k++) {
            int32_t vertex = copy.face_indices[n * f + k];
            copy.face_indices[n * f + k] = copy.face_indices[n * other + k], copy.face_indices[n * other + k] = vertex;
        }
    }
    for (int32_t c = 0; c < copy.index_count; c++)
        copy.face_indices[c] = place[copy.face_indices[c]];
    free(place);
    return copy;
}

static void every_slab_is_a_triangle_of_the_patch(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        const ss_triangles *triangles = &patch->triangles;
        ss_memory memory = {0};
        ss_paving paving;
        assert_true(ss_pave(&memory, patch, &paving));
        for (int32_t k = 0; k < patch->free_count; k++)
            assert_int_equal(paving.vertex[k], patch->free_vertex[k]);
        for (int32_t t = 0; t < triangles->count; t++) {
            const ss_slab *slab = &paving.slab[paving.slab_of[t]];
            assert_int_equal(slab->triangle, t);
            assert_int_equal(slab->beyond[3], paving.slab_of[t]);
            for (int k = 0; k < 3; k++) {
                int32_t beyond = slab->beyond[k];
                assert_int_equal(paving.vertex[slab->vertex[k]], triangles->vertex[t][k]);
                assert_int_equal(beyond < 0 ? -1 : paving.slab[beyond].triangle, triangles->neighbour[t][k]);
            }
        }
        ss_free(&memory);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
}

/* How far apart in memory neighbours are, on average. */
static double mean_way(const ss_paving *paving) {
    double sum = 0;
    for (int32_t s = 0; s < paving->patch->triangles.count; s++)
        for (int k = 0; k < 3; k++)
            sum += paving->slab[s].beyond[k] < 0 ? 0 : abs(paving->slab[s].beyond[k] - s);
    return sum / (3.0 * paving->patch->triangles.count);
}

/* A row of 40 quads has 80 triangles, and neighbours are in this row or the next; of 3,200 in no order they would be 1,067
 * apart. */
static void neighbours_are_near_however_a_mesh_is_numbered(void **state) {
    (void)state;
    for (int round = 0; round < 2; round++) {
        test_mesh ordered = round ? quad_grid(40, 40) : triangle_grid(40, 40), mesh = shuffled(&ordered, 5);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        ss_memory memory = {0};
        ss_paving paving;
        assert_true(ss_pave(&memory, patch, &paving));
        assert_true(mean_way(&paving) < 120);
        ss_free(&memory);
        ss_patch_destroy(patch);
        free_mesh(&mesh), free_mesh(&ordered);
    }
}

/* Where a walk ends holds the point exactly, and it says whether on a border. */
static void expect_held(const ss_paving *paving, int32_t slab, const double p[2], bool on_border) {
    bool border = false;
    for (int k = 0; k < 3; k++) {
        const int32_t *v = paving->slab[slab].vertex;
        int side = ss_orient(paving->uv[v[k]], paving->uv[v[(k + 1) % 3]], p);
        assert_true(side >= 0);
        border = border || side == 0;
    }
    assert_int_equal(on_border, border);
}

/* Without holes there is nothing in the way of a walk, whose border is convex; from where it begins does not matter. */
static void a_walk_comes_to_every_point(void **state) {
    (void)state;
    dice d = {4};
    int64_t steps = 0;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        float *points = random_pose(&f.mesh, (uint64_t)i);
        double(*uv)[2] = embedding_of(patch, f.mesh.points, points);
        const double(*view)[2] = (const double(*)[2])uv;
        ss_memory memory = {0};
        ss_paving paving;
        assert_true(ss_pave(&memory, patch, &paving));
        ss_paving_lay_out(&paving, view);
        for (int round = 0; round < 200 && f.holes == 0 && ss_lay_out(patch, view).regular; round++) {
            double p[2];
            bool inside, on_border;
            random_query(&patch->faces, view, &d, p);
            search_all(patch, view, p, &inside);
            int32_t slab = ss_paving_walk(&paving, roll_below(&d, patch->triangles.count), p, &on_border, &steps);
            assert_true(slab >= 0 || !inside);
            if (slab >= 0 && ss_lay_out(patch, view).collapsed == 0)
                expect_held(&paving, slab, p, on_border);
        }
        ss_free(&memory);
        free(uv), free(points);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
    assert_true(steps > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_slab_is_a_triangle_of_the_patch),
        cmocka_unit_test(neighbours_are_near_however_a_mesh_is_numbered),
        cmocka_unit_test(a_walk_comes_to_every_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
