/* Where a mesh stretches: the most of every pose, regions that grow by their size, and what cannot be. */
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

enum { SIDE = 40, FACES = SIDE * SIDE, CORNERS = 4 * FACES };

/* A grid of quads of side 1, of which the vertex in the middle of a square of side 2 * half is pulled out of the plane by a
 * little, and all others of the square with it, less towards its rim. */
static float *pulled(const test_mesh *grid, int32_t half) {
    float *points = copy_points(grid);
    for (int32_t j = 0; j <= SIDE; j++)
        for (int32_t i = 0; i <= SIDE; i++) {
            int32_t off = abs(i - SIDE / 2) > abs(j - SIDE / 2) ? abs(i - SIDE / 2) : abs(j - SIDE / 2);
            points[3 * (j * (SIDE + 1) + i) + 2] = off < half ? (float)(half - off) * 0.5f : 0;
        }
    return points;
}

static int32_t mask(const test_mesh *grid, const float *points, const skinslide_mask_options *options, uint8_t *faces) {
    static float stretch[CORNERS];
    skinslide_mesh view = view_of(grid);
    int32_t count = 0;
    memset(stretch, 0, sizeof stretch);
    assert_ok(skinslide_note_stretch(&view, points, stretch, &error), &error);
    assert_ok(skinslide_mask_stretched(&view, stretch, options, faces, &error), &error);
    for (int32_t f = 0; f < grid->face_count; f++)
        count += faces[f];
    return count;
}

/* Vertices inside the square are ends of stretched sides, those of its rim too but for the four at its corners: so the region
 * is one face wider, without the faces at its own corners. */
static void a_region_and_what_is_near(void **state) {
    (void)state;
    test_mesh grid = quad_grid(SIDE, SIDE);
    uint8_t faces[FACES];
    for (int32_t half = 1; half <= 12; half++) {
        float *points = pulled(&grid, half);
        skinslide_mask_options options = SKINSLIDE_MASK_OPTIONS_DEFAULT;
        int32_t side = 2 * half + 2;
        options.grow = 0, options.rings = 0;
        assert_int_equal(mask(&grid, points, &options, faces), side * side - 4);
        options.rings = 3;
        int32_t ringed = (side + 6) * (side + 6) - 4;
        assert_int_equal(mask(&grid, points, &options, faces), ringed);
        assert_int_equal(mask(&grid, points, NULL, faces) >= ringed, 1);
        options.rings = 0, options.grow = 0.5;
        /* Half the radius, as far as whole faces go: straight on at each side, and less at the corners. */
        double radius = sqrt((side * side - 4) / 3.14159265358979);
        int32_t grown = mask(&grid, points, &options, faces), steps = (int32_t)(0.5 * radius);
        assert_true(grown >= side * side - 4 + 4 * (side - 2) * steps && grown <= (side + 2 * steps) * (side + 2 * steps));
        free(points);
    }
    free_mesh(&grid);
}

static void nothing_stretches(void **state) {
    (void)state;
    test_mesh grid = quad_grid(SIDE, SIDE);
    uint8_t faces[FACES];
    float *points = copy_points(&grid);
    for (int32_t k = 0; k < 3 * grid.vertex_count; k++)
        points[k] *= 1.01f; /* which is less than two in a hundred */
    assert_int_equal(mask(&grid, points, NULL, faces), 0);
    for (int32_t k = 0; k < 3 * grid.vertex_count; k++)
        points[k] *= 1.02f;
    assert_int_equal(mask(&grid, points, NULL, faces), FACES);
    free(points);
    free_mesh(&grid);
}

/* Each side remembers the pose in which it was farthest from its rest length, longer or shorter. */
static void the_most_of_all_poses(void **state) {
    (void)state;
    test_mesh grid = quad_grid(5, 5);
    skinslide_mesh view = view_of(&grid);
    float both[4 * 25] = {0}, one[3][4 * 25] = {{0}};
    for (int32_t i = 0; i < 3; i++) {
        float *pose = shaken(&grid, (uint64_t)i + 1, 0.4);
        assert_ok(skinslide_note_stretch(&view, pose, both, &error), &error);
        assert_ok(skinslide_note_stretch(&view, pose, one[i], &error), &error);
        free(pose);
    }
    for (int32_t c = 0; c < 4 * 25; c++)
        assert_true(both[c] == fmaxf(one[0][c], fmaxf(one[1][c], one[2][c])) && both[c] > 0);
    free_mesh(&grid);
}

static void what_cannot_be_is_named(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    skinslide_mesh view = view_of(&grid);
    skinslide_mask_options options = SKINSLIDE_MASK_OPTIONS_DEFAULT;
    float stretch[16] = {0}, *points = copy_points(&grid);
    uint8_t faces[4];
    points[13] = NAN;
    assert_fails(skinslide_note_stretch(&view, points, stretch, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 4 is not finite: (1, nan, 0)");
    assert_int_equal(skinslide_note_stretch(&view, NULL, stretch, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mask_stretched(&view, NULL, NULL, faces, &error), SKINSLIDE_BAD_ARGUMENT);
    stretch[5] = -1;
    assert_fails(skinslide_mask_stretched(&view, stretch, NULL, faces, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "stretch[5] is -1; a stretch is 0 or more");
    stretch[5] = 0, options.grow = NAN;
    assert_fails(skinslide_mask_stretched(&view, stretch, &options, faces, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "least 0.02, grow nan, 3 rings: none may be below 0");
    free(points);
    free_mesh(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_region_and_what_is_near),
        cmocka_unit_test(nothing_stretches),
        cmocka_unit_test(the_most_of_all_poses),
        cmocka_unit_test(what_cannot_be_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
