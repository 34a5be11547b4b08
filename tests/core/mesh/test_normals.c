/* Normals of slid points. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

static float *constant_normals(int32_t count, float x, float y, float z) {
    float *normals = malloc((size_t)count * sizeof(float[3]));
    for (int32_t i = 0; i < count; i++)
        normals[3 * i] = x, normals[3 * i + 1] = y, normals[3 * i + 2] = z;
    return normals;
}

static int32_t element_count(const test_mesh *mesh, skinslide_normals_layout layout) {
    return layout == SKINSLIDE_NORMALS_VERTEX    ? mesh->vertex_count
           : layout == SKINSLIDE_NORMALS_UNIFORM ? mesh->face_count
                                                 : mesh->index_count;
}

static void recompute(const test_mesh *mesh, const float *slid, skinslide_normals_layout layout, int32_t left, float *normals) {
    skinslide_mesh view = view_of(mesh);
    view.rest_points = NULL; /* not read */
    assert_ok(skinslide_normals(&view, mesh->points, slid, layout, left, normals, &error), &error);
}

/* Where nothing slid, normals keep their bits, whatever they are. */
static void nothing_slid_keeps_normals(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t layout = SKINSLIDE_NORMALS_VERTEX; layout <= SKINSLIDE_NORMALS_UNIFORM; layout++) {
            fixture f = make_fixture(i);
            int32_t count = element_count(&f.mesh, (skinslide_normals_layout)layout);
            float *normals = constant_normals(count, 0.1f, 7, -0.0f), *before = constant_normals(count, 0.1f, 7, -0.0f);
            recompute(&f.mesh, f.mesh.points, (skinslide_normals_layout)layout, 0, normals);
            assert_same_bytes(normals, before, (size_t)count * sizeof(float[3]));
            free(normals), free(before);
            free_mesh(&f.mesh);
        }
}

/* Two triangles 0 1 2 and 0 2 3 of a unit square; vertex 1 sinks by 1. Twice the areas, as vectors:
 *     face 0: (1,0,-1) x (1,1,0) = (1,-1,1),   face 1: (1,1,0) x (0,1,0) = (0,0,1).
 * So face 0 has (1,-1,1)/sqrt 3; vertices 0 and 2 the sum (1,-1,2)/sqrt 6; vertex 1 that of face 0. Face 1 and vertex 3 have no
 * vertex that slid, and keep what they had. One rounding to float each. */
static const float square_points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const float sunk_points[] = {0, 0, 0, 1, 0, -1, 1, 1, 0, 0, 1, 0};

static test_mesh two_triangles(void) {
    return copy_mesh(4, 2, (int32_t[]){3, 3}, (int32_t[]){0, 1, 2, 0, 2, 3}, square_points);
}

static void expect_normal(const float *normal, double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    assert_near(normal[0], x / length, 1e-7);
    assert_near(normal[1], y / length, 1e-7);
    assert_near(normal[2], z / length, 1e-7);
}

static void normals_by_hand(void **state) {
    (void)state;
    test_mesh mesh = two_triangles();
    for (int32_t left = 0; left < 2; left++) {
        double sign = left ? -1 : 1;
        float *normals = constant_normals(4, 0, 0, 5);
        recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_VERTEX, left, normals);
        expect_normal(normals, sign, -sign, 2 * sign);
        expect_normal(normals + 3, sign, -sign, sign);
        expect_normal(normals + 6, sign, -sign, 2 * sign);
        assert_near(normals[11], 5, 0);
        free(normals);
        normals = constant_normals(2, 0, 0, 5);
        recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_UNIFORM, left, normals);
        expect_normal(normals, sign, -sign, sign);
        assert_near(normals[5], 5, 0);
        free(normals);
    }
    free_mesh(&mesh);
}

/* Corners of a vertex share the new normal where they shared the old one; across a hard edge each side keeps to itself. */
static void corners_share_what_they_shared(void **state) {
    (void)state;
    test_mesh mesh = two_triangles();
    float *smooth = constant_normals(6, 0, 0, 1), *hard = constant_normals(6, 0, 0, 1);
    recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_FACE_VARYING, 0, smooth);
    expect_normal(smooth, 1, -1, 2), expect_normal(smooth + 9, 1, -1, 2);      /* vertex 0 in both faces */
    expect_normal(smooth + 6, 1, -1, 2), expect_normal(smooth + 12, 1, -1, 2); /* vertex 2 */
    expect_normal(smooth + 3, 1, -1, 1);
    assert_near(smooth[17], 1, 0);
    for (int c = 3; c < 6; c++)
        hard[3 * c] = 1, hard[3 * c + 2] = 0;
    recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_FACE_VARYING, 0, hard);
    for (int c = 0; c < 3; c++)
        expect_normal(hard + 3 * c, 1, -1, 1);
    for (int c = 3; c < 6; c++)
        assert_true(hard[3 * c] == 1 && hard[3 * c + 1] == 0 && hard[3 * c + 2] == 0);
    free(smooth), free(hard);
    free_mesh(&mesh);
}

/* Caches round normals, to half floats for one: their lengths are not 1, and corners share them all the same. */
static void lengths_of_cached_normals_do_not_matter(void **state) {
    (void)state;
    test_mesh mesh = two_triangles();
    const float lengths[2] = {0.7f, 1.3f};
    for (int i = 0; i < 2; i++) {
        float *unit = constant_normals(6, 0, 0, 1), *other = constant_normals(6, 0, 0, lengths[i]);
        other[1] += 1e-3f;
        recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_FACE_VARYING, 0, unit);
        recompute(&mesh, sunk_points, SKINSLIDE_NORMALS_FACE_VARYING, 0, other);
        assert_same_bytes(unit, other, 5 * sizeof(float[3])); /* around the sixth nothing moved */
        free(unit), free(other);
    }
    free_mesh(&mesh);
}

/* Against a plain sum over all faces for each vertex. */
static void vertex_normals_are_area_weighted(void **state) {
    (void)state;
    fixture f = make_fixture(6);
    float *slid = random_pose(&f.mesh, 3), *normals = constant_normals(f.mesh.vertex_count, 0, 0, 9);
    recompute(&f.mesh, slid, SKINSLIDE_NORMALS_VERTEX, 0, normals);
    for (int32_t v = 0; v < f.mesh.vertex_count; v++) {
        double sum[3] = {0, 0, 0};
        for (int32_t c = 0; c < f.mesh.index_count; c += 4) {
            const int32_t *quad = f.mesh.face_indices + c;
            const float *p[4] = {slid + 3 * quad[0], slid + 3 * quad[1], slid + 3 * quad[2], slid + 3 * quad[3]};
            for (int k = 0; k < 3 && (quad[0] == v || quad[1] == v || quad[2] == v || quad[3] == v); k++) {
                int i = (k + 1) % 3, j = (k + 2) % 3; /* a quad's area vector is half the product of its diagonals */
                sum[k] += ((double)p[2][i] - p[0][i]) * ((double)p[3][j] - p[1][j]) -
                          ((double)p[2][j] - p[0][j]) * ((double)p[3][i] - p[1][i]);
            }
        }
        if (sum[0] != 0 || sum[1] != 0 || sum[2] != 0)
            expect_normal(normals + 3 * v, sum[0], sum[1], sum[2]);
        else
            assert_near(normals[3 * v + 2], 9, 0); /* no face */
    }
    free(slid), free(normals);
    free_mesh(&f.mesh);
}

/* Slid points may coincide: a face or a fan of no area keeps the normal it had. */
static void no_area_keeps_the_normal(void **state) {
    (void)state;
    test_mesh mesh = two_triangles();
    const float nowhere[12] = {0};
    for (int32_t layout = SKINSLIDE_NORMALS_VERTEX; layout <= SKINSLIDE_NORMALS_UNIFORM; layout++) {
        float *normals = constant_normals(6, 0, 1, 0), *before = constant_normals(6, 0, 1, 0);
        recompute(&mesh, nowhere, (skinslide_normals_layout)layout, 0, normals);
        assert_same_bytes(normals, before, 6 * sizeof(float[3]));
        free(normals), free(before);
    }
    free_mesh(&mesh);
}

static void bad_normals(void **state) {
    (void)state;
    test_mesh mesh = two_triangles();
    skinslide_mesh view = view_of(&mesh);
    float normals[18] = {0};
    const char *text = "no points or normals, or no such layout of normals";
    assert_fails(skinslide_normals(&view, NULL, sunk_points, SKINSLIDE_NORMALS_VERTEX, 0, normals, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_normals(&view, mesh.points, NULL, SKINSLIDE_NORMALS_VERTEX, 0, normals, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_normals(&view, mesh.points, sunk_points, SKINSLIDE_NORMALS_VERTEX, 0, NULL, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_normals(&view, mesh.points, sunk_points, (skinslide_normals_layout)3, 0, normals, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, text);
    mesh.face_indices[4] = 4;
    assert_fails(skinslide_normals(&view, mesh.points, sunk_points, SKINSLIDE_NORMALS_VERTEX, 0, normals, &error), &error,
                 SKINSLIDE_BAD_MESH, "face 1 has vertex 4, but the mesh has 4 vertices");
    for (int k = 0; k < 18; k++)
        assert_true(normals[k] == 0);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_slid_keeps_normals),
        cmocka_unit_test(normals_by_hand),
        cmocka_unit_test(corners_share_what_they_shared),
        cmocka_unit_test(vertex_normals_are_area_weighted),
        cmocka_unit_test(no_area_keeps_the_normal),
        cmocka_unit_test(bad_normals),
        cmocka_unit_test(lengths_of_cached_normals_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
