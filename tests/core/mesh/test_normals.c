/* Smooth normals of a pose. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The normals of all vertices, from the faces around the chosen ones, or all faces if chosen is NULL. To be freed. */
static double (*normals_of(const test_mesh *mesh, const float *points, const uint8_t *chosen))[3] {
    uint8_t *all = malloc((size_t)mesh->vertex_count);
    memset(all, 1, (size_t)mesh->vertex_count);
    skinslide_mesh view = view_of(mesh);
    ss_memory memory = {0};
    ss_around around = {0};
    double(*normal)[3] = malloc((size_t)mesh->vertex_count * sizeof *normal);
    assert_true(ss_take_around(&view, chosen ? chosen : all, &memory, &around));
    ss_smooth_normals(&around, points, mesh->vertex_count, normal);
    ss_free(&memory);
    free(all);
    return normal;
}

static void expect_normal(const double normal[3], double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    assert_near(normal[0], x / length, 1e-15);
    assert_near(normal[1], y / length, 1e-15);
    assert_near(normal[2], z / length, 1e-15);
}

/* Two triangles 0 1 2 and 0 2 3 of a unit square; vertex 1 sinks by 1. Twice the areas, as vectors:
 *     face 0: (1,0,-1) x (1,1,0) = (1,-1,1),   face 1: (1,1,0) x (0,1,0) = (0,0,1).
 * All three sides of face 0 are as long, so its angles are 60 degrees; face 1 has 45 at vertices 0 and 2. */
static void by_hand(void **state) {
    (void)state;
    static const float sunk[] = {0, 0, 0, 1, 0, -1, 1, 1, 0, 0, 1, 0};
    test_mesh mesh = copy_mesh(4, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 0, 2, 3}, sunk);
    double(*normal)[3] = normals_of(&mesh, sunk, NULL);
    double first = sin(acos(-1) / 6) / sqrt(3), second = sin(acos(-1) / 8);
    expect_normal(normal[0], first, -first, first + second);
    expect_normal(normal[1], 1, -1, 1);
    expect_normal(normal[2], first, -first, first + second);
    expect_normal(normal[3], 0, 0, 1);
    free(normal);
    free_mesh(&mesh);
}

/* A cube's corners, and a flat sheet's vertices however its faces are cut. */
static void of_symmetric_meshes(void **state) {
    (void)state;
    test_mesh solid = cube(), sheet = triangle_grid(5, 4);
    double(*corner)[3] = normals_of(&solid, solid.points, NULL), centre[3] = {0, 0, 0};
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++)
            centre[k] += (double)solid.points[3 * v + k] / 8;
    for (int v = 0; v < 8; v++)
        expect_normal(corner[v], solid.points[3 * v] - centre[0], solid.points[3 * v + 1] - centre[1],
                      solid.points[3 * v + 2] - centre[2]);
    double(*flat)[3] = normals_of(&sheet, sheet.points, NULL);
    for (int32_t v = 0; v < sheet.vertex_count; v++)
        expect_normal(flat[v], 0, 0, 1);
    free(corner), free(flat);
    free_mesh(&solid), free_mesh(&sheet);
}

/* Faces off the chosen vertices make no difference to theirs, and all faces at them count. */
static void chosen_vertices_have_all_their_faces(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        float *points = random_pose(&f.mesh, 5);
        uint8_t *chosen = calloc((size_t)f.mesh.vertex_count, 1);
        for (int32_t v = 0; v < f.mesh.vertex_count; v += 3)
            chosen[v] = 1;
        double(*all)[3] = normals_of(&f.mesh, points, NULL), (*some)[3] = normals_of(&f.mesh, points, chosen);
        for (int32_t v = 0; v < f.mesh.vertex_count; v += 3)
            assert_same_bytes(all[v], some[v], sizeof *all);
        free(points), free(chosen), free(all), free(some);
        free_mesh(&f.mesh);
    }
}

/* Faces without an area, and of fewer than three vertices, have no say; a vertex with no other has no normal. */
static void without_area(void **state) {
    (void)state;
    static const float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, 5, 5, 5, 5, 5, 5};
    test_mesh mesh = copy_mesh(6, 5, (int32_t[]){3, 3, 2, 0, 3}, (int32_t[]){0, 1, 2, 0, 1, 3, 0, 2, 3, 4, 5}, points);
    double(*normal)[3] = normals_of(&mesh, points, NULL);
    for (int v = 0; v < 3; v++)
        expect_normal(normal[v], 0, 0, 1);
    assert_near(ss_length(normal[3]), 0, 0);
    assert_near(ss_length(normal[4]), 0, 0);
    free(normal);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(of_symmetric_meshes),
        cmocka_unit_test(chosen_vertices_have_all_their_faces),
        cmocka_unit_test(without_area),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
