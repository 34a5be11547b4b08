/* What is near on a mesh at rest: ways by every path of corners, tried one by one; seams; and faces as a whole. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 200 };

/* Finds what is left of the way at each vertex by trying every pair of corners of each face again and again. */
static void relax(const test_mesh *mesh, double *left) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t f = 0, begin = 0; f < mesh->face_count; begin += mesh->face_counts[f++])
            for (int32_t i = 0; i < mesh->face_counts[f]; i++)
                for (int32_t k = 0; k < mesh->face_counts[f]; k++) {
                    int32_t a = mesh->face_indices[begin + i], b = mesh->face_indices[begin + k];
                    const float *p = mesh->points + 3 * a, *q = mesh->points + 3 * b;
                    double x = (double)p[0] - q[0], y = (double)p[1] - q[1], z = (double)p[2] - q[2];
                    double there = left[a] - sqrt(x * x + y * y + z * z);
                    if (there >= 0 && there > left[b] + 1e-12)
                        left[b] = there, changed = true;
                }
    }
}

static void as_every_way_tried(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 30; seed++) {
        dice d = {seed};
        test_mesh mesh = random_disk(seed, 40);
        skinslide_mesh view = view_of(&mesh);
        double left[MOST], tried[MOST];
        assert_true(mesh.vertex_count <= MOST);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            left[v] = tried[v] = roll_below(&d, 8) ? -1 : roll_between(&d, 0, 2);
        assert_true(ss_spread(&view, left));
        relax(&mesh, tried);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            assert_true(fabs(left[v] - tried[v]) < 1e-9); /* a sum in another order */
        free_mesh(&mesh);
    }
}

static int32_t count_near(const test_mesh *mesh, int32_t face, double way) {
    skinslide_mesh view = view_of(mesh);
    uint8_t inside[MOST] = {0};
    int32_t count = 0;
    inside[face] = 1;
    assert_true(ss_add_near_faces(&view, way, inside));
    for (int32_t f = 0; f < mesh->face_count; f++)
        count += inside[f];
    return count;
}

/* Around the middle of a 7 x 7 grid: those at sides are within 1, those at corners, over their diagonal, within 1.4143. */
static void faces_join_as_a_whole(void **state) {
    (void)state;
    test_mesh grid = quad_grid(7, 7);
    assert_int_equal(count_near(&grid, 24, 0), 1);
    assert_int_equal(count_near(&grid, 24, 0.99), 1);
    assert_int_equal(count_near(&grid, 24, 1), 5);
    assert_int_equal(count_near(&grid, 24, 1.4143), 9);
    assert_int_equal(count_near(&grid, 24, INFINITY), 49);
    free_mesh(&grid);
}

/* The same on two sheets, one of which begins where the other ends, with points of its own. */
static void over_seams(void **state) {
    (void)state;
    test_mesh whole = quad_grid(4, 2), half = quad_grid(2, 2), other = quad_grid(2, 2);
    for (int32_t v = 0; v < other.vertex_count; v++)
        other.points[3 * v] += 2;
    test_mesh halves = join_meshes(&half, &other);
    for (double way = 0; way < 5; way += 0.5)
        assert_int_equal(count_near(&halves, 0, way), count_near(&whole, 0, way));
    free_mesh(&whole), free_mesh(&half), free_mesh(&other), free_mesh(&halves);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_every_way_tried),
        cmocka_unit_test(faces_join_as_a_whole),
        cmocka_unit_test(over_seams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
