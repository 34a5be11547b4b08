/* The fan triangles of a patch's faces. */
#include "support.h"

static void sides_belong_to_their_triangle(void **state) {
    (void)state;
    for (int32_t sides = 3; sides < 8; sides++) {
        test_mesh mesh = polygon(sides);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        assert_int_equal(ss_fan_size(&patch->faces, 0), sides - 2);
        assert_int_equal(patch->triangles.count, sides - 2);
        for (int32_t c = 0; c < sides; c++) {
            const int32_t *v = patch->triangles.vertex[ss_triangle_of_side(patch, c)];
            int32_t found = 0;
            for (int k = 0; k < 3; k++)
                found += v[k] == c || v[k] == (c + 1) % sides;
            assert_int_equal(found, 2);
        }
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

/* Over a side, the next triangle has the same ends the other way round, and leads back; where there is none, the side is one of
 * a loop. */
static void check_side(const ss_patch *patch, int32_t t, int k) {
    const ss_triangles *triangles = &patch->triangles;
    int32_t a = triangles->vertex[t][k], b = triangles->vertex[t][(k + 1) % 3], next = triangles->neighbour[t][k];
    if (next < 0) {
        assert_true(patch->vertex_loop[a] >= 0 && patch->vertex_loop[a] == patch->vertex_loop[b]);
        assert_int_equal(triangles->vertex_triangle[a], t);
        return;
    }
    int there = ss_triangle_corner(patch, next, b);
    assert_int_equal(triangles->vertex[next][there], b);
    assert_int_equal(triangles->vertex[next][(there + 1) % 3], a);
    assert_int_equal(triangles->neighbour[next][there], t);
}

static void neighbours_share_their_side(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        for (int32_t t = 0; t < patch->triangles.count; t++)
            for (int k = 0; k < 3; k++)
                check_side(patch, t, k);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_belong_to_their_triangle),
        cmocka_unit_test(neighbours_share_their_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
