/* How far edges are from curves: by hand on a grid, and every basis against its matrix. */
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* The edges of a grid of columns x rows quads: first those along x, row by row, then those along y. */
enum { SIDE = 4, HALF = SIDE * (SIDE + 1), EDGES = 2 * HALF };

static void list_edges(int32_t edges[EDGES][2]) {
    int32_t n = 0;
    for (int32_t j = 0; j <= SIDE; j++)
        for (int32_t i = 0; i < SIDE; i++, n++)
            edges[n][0] = j * (SIDE + 1) + i, edges[n][1] = edges[n][0] + 1;
    for (int32_t j = 0; j < SIDE; j++)
        for (int32_t i = 0; i <= SIDE; i++, n++)
            edges[n][0] = j * (SIDE + 1) + i, edges[n][1] = edges[n][0] + SIDE + 1;
}

static skinslide_curves curve_of(const float *points, const int32_t *count, skinslide_curve_basis basis,
                                 skinslide_curve_wrap wrap) {
    return (skinslide_curves){sizeof(skinslide_curves), 1, count, *count, points, NULL, basis, wrap};
}

/* Which edges are within a distance. */
static skinslide_status find(const skinslide_curves *curves, double distance, skinslide_direction direction, uint8_t *near) {
    test_mesh grid = quad_grid(SIDE, SIDE);
    int32_t edges[EDGES][2];
    list_edges(edges);
    double distances[EDGES];
    skinslide_status status =
        skinslide_edge_distances(grid.points, grid.vertex_count, edges[0], EDGES, curves, direction, distances, &error);
    for (int32_t e = 0; e < EDGES && !status; e++)
        near[e] = distances[e] <= distance;
    free_mesh(&grid);
    return status;
}

static int32_t count_near(const skinslide_curves *curves, double distance, skinslide_direction direction) {
    uint8_t near[EDGES];
    int32_t count = 0;
    assert_ok(find(curves, distance, direction, near), &error);
    for (int32_t e = 0; e < EDGES; e++)
        count += near[e];
    return count;
}

/* A line along y = 2, a little above the grid. Edges on it have their middles at its height, those across it half a side
 * away. */
static void a_line_by_hand(void **state) {
    (void)state;
    const float points[6] = {0, 2, 0.1f, 4, 2, 0.1f};
    const int32_t two = 2;
    skinslide_curves line = curve_of(points, &two, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC);
    uint8_t near[EDGES];
    assert_ok(find(&line, 0.2, SKINSLIDE_DIRECTION_ANY, near), &error);
    for (int32_t e = 0; e < EDGES; e++)
        assert_int_equal(near[e], e >= 2 * SIDE && e < 3 * SIDE);
    assert_int_equal(count_near(&line, 0.2, SKINSLIDE_DIRECTION_ALONG), SIDE);
    assert_int_equal(count_near(&line, 0.2, SKINSLIDE_DIRECTION_ACROSS), 0);
    assert_int_equal(count_near(&line, 0.09, SKINSLIDE_DIRECTION_ANY), 0);
    assert_int_equal(count_near(&line, 0.6, SKINSLIDE_DIRECTION_ALONG), SIDE);
    assert_int_equal(count_near(&line, 0.6, SKINSLIDE_DIRECTION_ACROSS), 2 * (SIDE + 1));
    assert_int_equal(count_near(&line, 0.6, SKINSLIDE_DIRECTION_ANY), SIDE + 2 * (SIDE + 1));
    assert_int_equal(count_near(&line, 100, SKINSLIDE_DIRECTION_ANY), EDGES);
}

/* Of two edges, one along a line and one across it; infinite for the one that does not run that way. */
static void distances_by_hand(void **state) {
    (void)state;
    const float points[6] = {-1, 1.625F, 0.25F, 9, 1.625F, 0.25F};
    const int32_t two = 2;
    skinslide_curves line = curve_of(points, &two, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC);
    const double along = hypot(1.625, 0.25), across = hypot(1.125, 0.25);
    const double expected[3][2] = {{along, across}, {along, INFINITY}, {INFINITY, across}};
    test_mesh mesh = quad_grid(SIDE, SIDE);
    int32_t edges[4] = {0, 1, 0, SIDE + 1}; /* along, at y = 0; across, about y = 0.5 */
    double found[2];
    for (skinslide_direction way = SKINSLIDE_DIRECTION_ANY; way <= SKINSLIDE_DIRECTION_ACROSS; way++) {
        assert_ok(skinslide_edge_distances(mesh.points, mesh.vertex_count, edges, 2, &line, way, found, &error), &error);
        for (int i = 0; i < 2; i++)
            assert_true(found[i] == expected[way][i] || fabs(found[i] - expected[way][i]) < 1e-12);
        assert_fails(skinslide_edge_distances(mesh.points, mesh.vertex_count, edges, 2, &line, way, NULL, &error), &error,
                     SKINSLIDE_BAD_ARGUMENT, "no place for the distances");
    }
    free_mesh(&mesh);
}

/* Edges at exactly the distance count, and those at exactly 45 degrees to a curve run along it. */
static void borders_count(void **state) {
    (void)state;
    const float points[6] = {0, 0, 0, 4, 4, 0};
    const int32_t two = 2;
    skinslide_curves diagonal = curve_of(points, &two, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC);
    assert_int_equal(count_near(&diagonal, 100, SKINSLIDE_DIRECTION_ALONG), EDGES);
    const float level[6] = {-1, 0, 0, 9, 0, 0};
    skinslide_curves bottom = curve_of(level, &two, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC);
    assert_int_equal(count_near(&bottom, 0.5, SKINSLIDE_DIRECTION_ANY), SIDE + SIDE + 1);
    assert_int_equal(count_near(&bottom, 0, SKINSLIDE_DIRECTION_ANY), SIDE);
}

/* Two curves, one with points in one place, brought to the grid by a matrix: scaled by 2, moved by (1, 2, 0). */
static void curves_come_by_a_matrix(void **state) {
    (void)state;
    const float points[15] = {-0.5f, 0, 0, 0.5f, 0, 0, -0.5f, -1, 0, -0.5f, -1, 0, -0.5f, 1, 0};
    const int32_t counts[2] = {2, 3};
    const double matrix[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 2, 0, 1};
    const skinslide_curves curves = {
        sizeof(skinslide_curves), 2, counts, 5, points, matrix, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC};
    /* From (0, 2) to (2, 2), and from (0, 0) to (0, 4). */
    assert_int_equal(count_near(&curves, 0.1, SKINSLIDE_DIRECTION_ANY), 2 + SIDE);
    assert_int_equal(count_near(&curves, 0.1, SKINSLIDE_DIRECTION_ALONG), 2 + SIDE);
}

/* ---- Cubic curves ---- */

/* The rows multiply t^3, t^2, t, 1; the columns the four control points: as the documentation of UsdGeomBasisCurves has
 * them. */
static const double bases[4][4][4] = {
    {{0}},
    {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}},
    {{-1 / 6., 3 / 6., -3 / 6., 1 / 6.}, {3 / 6., -6 / 6., 3 / 6., 0}, {-3 / 6., 0, 3 / 6., 0}, {1 / 6., 4 / 6., 1 / 6., 0}},
    {{-0.5, 1.5, -1.5, 0.5}, {1, -2.5, 2, -0.5}, {-0.5, 0, 0.5, 0}, {0, 1, 0, 0}}};

static double matrix_distance(const float control[4][3], skinslide_curve_basis basis, const double at[3]) {
    double least = INFINITY;
    for (int i = 0; i <= 2000; i++) {
        double t = i / 2000.0, powers[4] = {t * t * t, t * t, t, 1}, sum = 0;
        for (int k = 0; k < 3; k++) {
            double here = 0;
            for (int c = 0; c < 4; c++)
                for (int row = 0; row < 4; row++)
                    here += powers[row] * bases[basis][row][c] * control[c][k];
            sum += (here - at[k]) * (here - at[k]);
        }
        least = sum < least ? sum : least;
    }
    return sqrt(least);
}

static void cubic_curves_against_their_matrices(void **state) {
    (void)state;
    dice d = {11};
    test_mesh grid = quad_grid(SIDE, SIDE);
    int32_t edges[EDGES][2], tested = 0;
    list_edges(edges);
    for (int round = 0; round < 60; round++) {
        skinslide_curve_basis basis = (skinslide_curve_basis)(1 + round % 3);
        float control[4][3];
        const int32_t four = 4;
        for (int i = 0; i < 12; i++)
            control[i / 3][i % 3] = (float)roll_between(&d, 0, i % 3 == 2 ? 0.5 : SIDE);
        skinslide_curves curve = curve_of(control[0], &four, basis, SKINSLIDE_CURVE_WRAP_NONPERIODIC);
        uint8_t near[EDGES];
        assert_ok(find(&curve, 0.7, SKINSLIDE_DIRECTION_ANY, near), &error);
        for (int32_t e = 0; e < EDGES; e++) {
            const float *a = grid.points + 3 * edges[e][0], *b = grid.points + 3 * edges[e][1];
            const double middle[3] = {(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, (a[2] + b[2]) / 2.0};
            double distance = matrix_distance((const float(*)[3])control, basis, middle);
            /* 16 straight pieces of a curve of this size are off by up to a hundredth or so. */
            if (fabs(distance - 0.7) > 0.03)
                assert_int_equal(near[e], distance < 0.7), tested++;
        }
    }
    assert_true(tested > 50 * EDGES);
    free_mesh(&grid);
}

/* A straight row of points: what part of it each kind of curve runs along, in edges of the bottom row of the grid. */
static void segments_by_hand(void **state) {
    (void)state;
    float row[21];
    for (int i = 0; i < 7; i++)
        row[3 * i] = (float)i - 1, row[3 * i + 1] = row[3 * i + 2] = 0; /* x from -1 to 5 */
    static const struct {
        skinslide_curve_basis basis;
        skinslide_curve_wrap wrap;
        int32_t points, first, edges; /* from which point, and how many edges have their middles on the curve */
    } cases[] = {{SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 3, 1, 2},
                 {SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_PINNED, 3, 1, 2},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 4, 1, 3},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 7, 0, 4},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_PINNED, 4, 1, 3},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_PERIODIC, 3, 1, 1}, /* to x = 1.15 and back */
                 {SKINSLIDE_CURVE_BASIS_BSPLINE, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 5, 0, 2},
                 {SKINSLIDE_CURVE_BASIS_BSPLINE, SKINSLIDE_CURVE_WRAP_PINNED, 3, 1, 2},
                 {SKINSLIDE_CURVE_BASIS_CATMULL_ROM, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 5, 0, 2},
                 {SKINSLIDE_CURVE_BASIS_CATMULL_ROM, SKINSLIDE_CURVE_WRAP_PINNED, 2, 1, 1},
                 {SKINSLIDE_CURVE_BASIS_CATMULL_ROM, SKINSLIDE_CURVE_WRAP_PERIODIC, 4, 1, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_curves curve = curve_of(row + 3 * cases[i].first, &cases[i].points, cases[i].basis, cases[i].wrap);
        assert_int_equal(count_near(&curve, 1e-6, SKINSLIDE_DIRECTION_ANY), cases[i].edges);
    }
}

/* ---- Refused ---- */

static void counts_that_do_not_fit(void **state) {
    (void)state;
    static const float points[21] = {0};
    static const struct {
        skinslide_curve_basis basis;
        skinslide_curve_wrap wrap;
        int32_t count;
    } cases[] = {{SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 1},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 3},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 5},
                 {SKINSLIDE_CURVE_BASIS_BEZIER, SKINSLIDE_CURVE_WRAP_PERIODIC, 4},
                 {SKINSLIDE_CURVE_BASIS_BSPLINE, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 3},
                 {SKINSLIDE_CURVE_BASIS_BSPLINE, SKINSLIDE_CURVE_WRAP_PERIODIC, 2},
                 {SKINSLIDE_CURVE_BASIS_CATMULL_ROM, SKINSLIDE_CURVE_WRAP_PINNED, 1},
                 {SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC, -1},
                 {SKINSLIDE_CURVE_BASIS_BSPLINE, SKINSLIDE_CURVE_WRAP_NONPERIODIC, 0}};
    uint8_t near[EDGES];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_curves curve = curve_of(points, &cases[i].count, cases[i].basis, cases[i].wrap);
        assert_fails(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), &error, SKINSLIDE_BAD_ARGUMENT, "curve 0 has ...");
    }
}

static void bad_arguments(void **state) {
    (void)state;
    const float points[6] = {0, 0, 0, 1, 0, 0}, odd[6] = {0, 0, 0, 1, NAN, 0};
    const int32_t two = 2, edge[2] = {0, 25};
    uint8_t near[EDGES];
    double matrix[16] = {INFINITY}, distance;
    const skinslide_curves good = curve_of(points, &two, 0, 0);
    skinslide_curves curve = good;
    assert_ok(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), &error);
    assert_int_equal(find(&curve, 1, 3, near), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(find(NULL, 1, SKINSLIDE_DIRECTION_ANY, near), SKINSLIDE_BAD_ARGUMENT);
    curve.point_count = 3;
    assert_fails(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), &error, SKINSLIDE_BAD_ARGUMENT,
                 "curve vertex counts add up to 2, but there are 3 points");
    curve = good, curve.curve_count = 0;
    assert_int_equal(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), SKINSLIDE_BAD_ARGUMENT);
    curve = good, curve.points = odd;
    assert_int_equal(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), SKINSLIDE_BAD_POINTS);
    curve = good, curve.to_mesh = matrix;
    assert_int_equal(find(&curve, 1, SKINSLIDE_DIRECTION_ANY, near), SKINSLIDE_BAD_ARGUMENT);
    assert_fails(skinslide_edge_distances(points, 2, edge, 1, &good, SKINSLIDE_DIRECTION_ANY, &distance, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "edge 0-25: there are 2 vertices");
    assert_int_equal(skinslide_edge_distances(odd, 2, edge, 0, &good, SKINSLIDE_DIRECTION_ANY, NULL, &error),
                     SKINSLIDE_BAD_POINTS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_by_hand),
        cmocka_unit_test(distances_by_hand),
        cmocka_unit_test(borders_count),
        cmocka_unit_test(curves_come_by_a_matrix),
        cmocka_unit_test(cubic_curves_against_their_matrices),
        cmocka_unit_test(segments_by_hand),
        cmocka_unit_test(counts_that_do_not_fit),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
