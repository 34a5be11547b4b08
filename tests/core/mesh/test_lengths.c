/* Lengths of edges at once, beside those one by one: the same bits, whichever processor this is. */
#include "support.h"

#include <stdlib.h>

/* For counts of edges that leave none, one, two or three beside groups of four; the first edge of each row is too short. */
static void lengths_at_once_are_each_to_the_bit(void **state) {
    (void)state;
    int seen[4] = {0};
    for (int32_t columns = 1; columns < 9; columns++) {
        test_mesh mesh = columns % 3 ? quad_grid(columns, 4) : triangle_grid(columns, 3);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        int32_t count = patch->faces.edge_count;
        float *points = random_pose(&mesh, (uint64_t)columns);
        for (int32_t v = 1; v < mesh.vertex_count; v += columns + 1)
            for (int k = 0; k < 3; k++)
                points[3 * v + k] = points[3 * (v - 1) + k];
        double *each = malloc((size_t)count * sizeof *each), *at_once = malloc((size_t)count * sizeof *at_once);
        double(*own)[4] = malloc((size_t)patch->vertex_count * sizeof *own);
        int32_t clamped = ss_edge_lengths(patch, points, each);
        assert_true(clamped > 0 && clamped < count);
        assert_int_equal(ss_edge_lengths_at_once(patch, points, own, at_once), clamped);
        assert_memory_equal(at_once, each, (size_t)count * sizeof *each);
        seen[count % 4]++;
        free(own), free(each), free(at_once), free(points);
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
    for (int k = 0; k < 4; k++)
        assert_true(seen[k] > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_at_once_are_each_to_the_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
