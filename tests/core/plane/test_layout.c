/* How faces of an embedding lie. */
#include "support.h"

#include <stdlib.h>
#include <string.h>

/* A quad whose fan is cut from (0,0) to (1,1): a point on the diagonal is in the first triangle, border and corners are in. */
static void the_first_triangle_holds_the_diagonal(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(1, 1);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    const double uv[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}; /* vertices; the face is 0 1 3 2 */
    static const struct {
        double p[2];
        int32_t triangle;
    } cases[] = {{{0.5, 0.5}, 0}, {{0.75, 0.25}, 0}, {{0.25, 0.75}, 1},    {{0, 0}, 0},        {{1, 1}, 0},
                 {{1, 0}, 0},     {{0, 1}, 1},       {{0.5, 1}, 1},        {{0.5, 0}, 0},      {{1, 0.5}, 0},
                 {{0, 0.5}, 1},   {{1.1, 0.5}, -1},  {{-1e-300, 0.5}, -1}, {{0.5, -1e-16}, -1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(ss_triangle_holding(patch, 0, uv, cases[i].p), cases[i].triangle);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

static void expect_layout(const ss_patch *patch, const double (*uv)[2], int32_t folded, int32_t collapsed, bool regular) {
    ss_layout layout = ss_lay_out(patch, uv);
    assert_int_equal(layout.folded, folded);
    assert_int_equal(layout.collapsed, collapsed);
    assert_int_equal(layout.regular, regular);
}

/* Four triangles around vertex 4 of a unit square. Where that vertex goes decides. */
static void folds_by_hand(void **state) {
    (void)state;
    const float points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 0.5f, 0};
    test_mesh mesh = copy_mesh(5, 4, (int32_t[]){3, 3, 3, 3}, (int32_t[]){0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4}, points);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double uv[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
    const double(*view)[2] = (const double(*)[2])uv;
    expect_layout(patch, view, 0, 0, true);
    uv[4][1] = 0; /* on a side: one face has no area */
    expect_layout(patch, view, 0, 1, true);
    uv[4][1] = -0.25; /* outside */
    expect_layout(patch, view, 1, 0, false);
    uv[4][1] = -1e-17; /* outside by less than rounding: no fold to count, but no walking either */
    expect_layout(patch, view, 0, 1, false);
    uv[4][0] = -0.25, uv[4][1] = -0.25; /* outside two sides */
    expect_layout(patch, view, 2, 0, false);
    for (int v = 0; v < 5; v++)
        uv[v][0] = uv[v][1] = 0.5;
    expect_layout(patch, view, 0, 4, true);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* A strip of triangles i, i + 1, i + 2 with its vertices in two rows. */
static test_mesh strip(int32_t count) {
    int32_t counts[16], indices[3 * 16];
    float points[3 * 18] = {0};
    for (int32_t v = 0; v < count + 2; v++)
        points[3 * v] = (float)(v / 2), points[3 * v + 1] = (float)(v % 2);
    for (int32_t t = 0; t < count; t++) {
        counts[t] = 3;
        indices[3 * t] = t, indices[3 * t + 1] = t + 2 - t % 2, indices[3 * t + 2] = t + 1 + t % 2;
    }
    return copy_mesh(count + 2, count, counts, indices, points);
}

static int32_t count_turned(const test_mesh *mesh, const double (*uv)[2]) {
    int32_t turned = 0;
    for (int32_t t = 0; t < mesh->face_count; t++) {
        const int32_t *v = mesh->face_indices + 3 * t;
        long double x1 = uv[v[1]][0] - uv[v[0]][0], y1 = uv[v[1]][1] - uv[v[0]][1];
        long double x2 = uv[v[2]][0] - uv[v[0]][0], y2 = uv[v[2]][1] - uv[v[0]][1];
        turned += x1 * y2 < y1 * x2;
    }
    return turned;
}

/* Folds are counted wherever they are, among an odd or an even number of triangles. */
static void each_fold_is_counted(void **state) {
    (void)state;
    dice d = {8};
    for (int32_t count = 1; count <= 16; count++) {
        test_mesh mesh = strip(count);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        for (int32_t moved = 0; moved < 10 * (count + 2); moved++) {
            double uv[18][2];
            for (int32_t v = 0; v < count + 2; v++)
                for (int k = 0; k < 2; k++)
                    uv[v][k] = v == moved % (count + 2) ? roll_share(&d) : mesh.points[3 * v + k] / 9.0;
            int32_t turned = count_turned(&mesh, (const double(*)[2])uv);
            expect_layout(patch, (const double(*)[2])uv, turned, 0, turned == 0);
        }
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

/* A pentagram turns left at every corner and yet covers its middle twice; a bow-tie and a dart turn both ways. */
static void polygons_that_overlap_are_not_regular(void **state) {
    (void)state;
    test_mesh five = polygon(5), four = polygon(4);
    ss_patch *pentagon = patch_of(&five, (skinslide_patch_setup){0}), *quad = patch_of(&four, (skinslide_patch_setup){0});
    const double star[5][2] = {{1, 0.5}, {0.1, 0.8}, {0.65, 0}, {0.65, 1}, {0.1, 0.2}};
    assert_false(ss_lay_out(pentagon, star).regular);
    const double bow_tie[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}, dart[4][2] = {{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}};
    assert_false(ss_lay_out(quad, bow_tie).regular);
    for (int first = 0; first < 4; first++) { /* whichever corner turns the other way */
        double turned[4][2];
        for (int k = 0; k < 4; k++)
            memcpy(turned[k], dart[(first + k) % 4], sizeof turned[k]);
        assert_false(ss_lay_out(quad, (const double(*)[2])turned).regular);
    }
    ss_patch_destroy(pentagon), ss_patch_destroy(quad);
    free_mesh(&five), free_mesh(&four);
}

static void free_holes_are_never_regular(void **state) {
    (void)state;
    test_mesh mesh = annulus(8, 2);
    for (int32_t holes = 0; holes < 2; holes++) {
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){.holes = (skinslide_holes)holes});
        double(*uv)[2] = embedding_of(patch, mesh.points, mesh.points);
        assert_int_equal(ss_lay_out(patch, (const double(*)[2])uv).regular, holes == SKINSLIDE_HOLES_PINNED);
        free(uv);
        ss_patch_destroy(patch);
    }
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_triangle_holds_the_diagonal),
        cmocka_unit_test(folds_by_hand),
        cmocka_unit_test(each_fold_is_counted),
        cmocka_unit_test(polygons_that_overlap_are_not_regular),
        cmocka_unit_test(free_holes_are_never_regular),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
