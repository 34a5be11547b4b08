/* The other side of a symmetric mesh: found for every face, told apart where points coincide, refused where it is not there. */
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* A bumpy grid of an even number of columns about the plane x = middle; vertices and faces shuffled where seed is not 0. */
static test_mesh symmetric(int32_t columns, int32_t rows, float middle, uint64_t seed) {
    test_mesh mesh = quad_grid(columns, rows);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        float *p = mesh.points + 3 * v, off = p[0] - (float)columns / 2;
        p[0] = middle + off, p[2] = (float)(0.1 * fabs(off) + 0.2 * sin(p[1]));
    }
    dice d = {seed};
    for (int32_t v = mesh.vertex_count - 1; seed && v > 0; v--) {
        int32_t other = roll_below(&d, v + 1);
        float p[3];
        memcpy(p, mesh.points + 3 * v, sizeof p);
        memcpy(mesh.points + 3 * v, mesh.points + 3 * other, sizeof p);
        memcpy(mesh.points + 3 * other, p, sizeof p);
        for (int32_t c = 0; c < mesh.index_count; c++)
            mesh.face_indices[c] = mesh.face_indices[c] == v ? other : mesh.face_indices[c] == other ? v : mesh.face_indices[c];
    }
    for (int32_t f = 0; seed && f < mesh.face_count; f++) /* begin each face at another corner */
        for (int32_t n = roll_below(&d, 4); n > 0; n--) {
            int32_t *face = mesh.face_indices + 4 * f, first = face[0];
            face[0] = face[1], face[1] = face[2], face[2] = face[3], face[3] = first;
        }
    return mesh;
}

typedef struct found {
    int32_t *faces, *vertices;
} found;

static skinslide_mirror_options about(int32_t axis, double plane, double tolerance) {
    return (skinslide_mirror_options){sizeof(skinslide_mirror_options), axis, plane, tolerance};
}

static skinslide_status mirror(const test_mesh *mesh, int32_t axis, double plane, double tolerance, found *out) {
    skinslide_mesh view = view_of(mesh);
    const skinslide_mirror_options options = about(axis, plane, tolerance);
    int32_t *faces = malloc((size_t)mesh->face_count * sizeof *faces);
    for (int32_t f = 0; f < mesh->face_count; f++)
        faces[f] = f;
    out->faces = malloc((size_t)mesh->face_count * sizeof *out->faces);
    out->vertices = malloc((size_t)mesh->vertex_count * sizeof *out->vertices);
    skinslide_status status = skinslide_mirror(&view, &options, faces, mesh->face_count, out->faces, out->vertices, &error);
    free(faces);
    return status;
}

static void free_found(found *f) {
    free(f->faces), free(f->vertices);
}

/* Whatever was found: vertices where the mirror puts them, faces of the mirrored vertices, and twice is back again. */
static void assert_mirrored(const test_mesh *mesh, int32_t axis, double plane, double tolerance) {
    found f;
    assert_ok(mirror(mesh, axis, plane, tolerance, &f), &error);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t other = f.vertices[v];
        assert_in_range(other, 0, mesh->vertex_count - 1);
        assert_int_equal(f.vertices[other], v);
        for (int k = 0; k < 3; k++) {
            double image = mesh->points[3 * v + k];
            image = k == axis ? 2 * plane - image : image;
            assert_near(mesh->points[3 * other + k], image, tolerance);
        }
    }
    for (int32_t face = 0; face < mesh->face_count; face++) {
        assert_int_equal(f.faces[f.faces[face]], face);
        const int32_t *there = mesh->face_indices + 4 * f.faces[face];
        for (int c = 0; c < 4; c++) {
            int32_t image = f.vertices[mesh->face_indices[4 * face + c]];
            assert_true(image == there[0] || image == there[1] || image == there[2] || image == there[3]);
        }
    }
    free_found(&f);
}

static void grids_in_any_order(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        test_mesh mesh = symmetric(2 + 2 * (int32_t)(seed % 4), 1 + (int32_t)(seed % 5), 0, seed);
        assert_mirrored(&mesh, 0, 0, 1e-6);
        free_mesh(&mesh);
    }
}

static void any_plane(void **state) {
    (void)state;
    test_mesh mesh = symmetric(6, 4, 3.5f, 9);
    assert_mirrored(&mesh, 0, 3.5, 1e-6);
    for (int32_t v = 0; v < mesh.vertex_count; v++) { /* x, y, z becomes y, z, x: the plane's axis is the last */
        float *p = mesh.points + 3 * v, x = p[0];
        p[0] = p[1], p[1] = p[2], p[2] = x;
    }
    assert_mirrored(&mesh, 2, 3.5, 1e-6);
    free_mesh(&mesh);
}

/* A flat sheet in the plane y = 0 has every vertex at one coordinate of an axis of the mirror plane. */
static void a_flat_sheet(void **state) {
    (void)state;
    test_mesh mesh = symmetric(60, 60, 0, 0);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        float *p = mesh.points + 3 * v;
        p[2] = p[1], p[1] = 0;
    }
    assert_mirrored(&mesh, 0, 0, 1e-6);
    free_mesh(&mesh);
}

/* Two sheets in one place, wound against each other as the two sides of closed lips: each mirrors itself. */
static void sheets_in_one_place_are_told_apart(void **state) {
    (void)state;
    test_mesh front = symmetric(4, 3, 0, 5), back = symmetric(4, 3, 0, 5);
    for (int32_t f = 0; f < back.face_count; f++) {
        int32_t *face = back.face_indices + 4 * f, second = face[1];
        face[1] = face[3], face[3] = second;
    }
    test_mesh both = join_meshes(&front, &back);
    assert_mirrored(&both, 0, 0, 1e-6);
    found f;
    assert_ok(mirror(&both, 0, 0, 1e-6, &f), &error);
    for (int32_t v = 0; v < both.vertex_count; v++)
        assert_int_equal(f.vertices[v] < front.vertex_count, v < front.vertex_count);
    free_found(&f);
    free_mesh(&front), free_mesh(&back), free_mesh(&both);
}

static void some_faces_only(void **state) {
    (void)state;
    test_mesh mesh = symmetric(4, 1, 0, 0);
    skinslide_mesh view = view_of(&mesh);
    const int32_t faces[2] = {0, 1};
    int32_t mirrored[2], vertices[10];
    assert_ok(skinslide_mirror(&view, NULL, faces, 2, mirrored, vertices, &error), &error);
    assert_int_equal(mirrored[0], 3);
    assert_int_equal(mirrored[1], 2);
    const int32_t expected[10] = {4, 3, 2, -1, -1, 9, 8, 7, -1, -1};
    assert_same_bytes(vertices, expected, sizeof expected);
    free_mesh(&mesh);
}

/* Below 0, the tolerance is 1e-4 of the largest extent: 8 here. */
static void the_usual_tolerance(void **state) {
    (void)state;
    test_mesh mesh = symmetric(8, 3, 0, 0);
    found f;
    mesh.points[3 * 4 + 1] += 0.0007f; /* of the middle column, so that it mirrors itself whatever y is */
    mesh.points[3 * 2 + 1] += 0.0007f;
    assert_ok(mirror(&mesh, 0, 0, -1, &f), &error);
    free_found(&f);
    mesh.points[3 * 2 + 1] += 0.0002f;
    assert_fails(mirror(&mesh, 0, 0, -1, &f), &error, SKINSLIDE_BAD_MESH,
                 "points 2, 6 have no mirror image within 0.0008 beyond x = 0");
    free_found(&f);
    free_mesh(&mesh);
}

static void what_has_no_counterpart_is_named(void **state) {
    (void)state;
    test_mesh mesh = symmetric(4, 3, 0, 0);
    found f;
    assert_fails(mirror(&mesh, 0, 0.25, 1e-3, &f), &error, SKINSLIDE_BAD_MESH,
                 "points 0, 1, 2, 3, 4, 5, 6, 7 and 12 more have no mirror image within 0.001 beyond x = 0.25");
    free_found(&f);
    mesh.points[3 * 7] = 0.5f; /* on the middle column */
    assert_fails(mirror(&mesh, 0, 0, 1e-3, &f), &error, SKINSLIDE_BAD_MESH,
                 "point 7 has no mirror image within 0.001 beyond x = 0");
    free_found(&f);
    free_mesh(&mesh);
    mesh = triangle_grid(2, 1); /* diagonals alternate, so turn one round: now points mirror, and faces do not */
    for (int32_t c = 0; c < 12; c++)
        mesh.points[3 * (c % 6)] = (float)(c % 3) - 1;
    const int32_t same[12] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    memcpy(mesh.face_indices, same, sizeof same);
    assert_fails(mirror(&mesh, 0, 0, 1e-3, &f), &error, SKINSLIDE_BAD_MESH,
                 "face 0 has no mirror image beyond x = 0, though its points have");
    free_found(&f);
    free_mesh(&mesh);
}

static void bad_arguments(void **state) {
    (void)state;
    test_mesh mesh = symmetric(2, 1, 0, 0);
    skinslide_mesh view = view_of(&mesh);
    const int32_t faces[1] = {0}, outside[1] = {2};
    const skinslide_mirror_options good = about(0, 0, 0), no_axis = about(3, 0, 0), no_plane = about(0, NAN, 0),
                                   no_tolerance = about(0, 0, NAN), none = {0};
    int32_t mirrored[1], vertices[6];
    assert_int_equal(skinslide_mirror(&view, &no_axis, faces, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &no_plane, faces, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &no_tolerance, faces, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &good, outside, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &good, NULL, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &good, faces, 1, NULL, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(&view, &good, faces, -1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_mirror(NULL, &good, faces, 1, mirrored, vertices, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_fails(skinslide_mirror(&view, &none, faces, 1, mirrored, vertices, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "skinslide_mirror_options: its size is 0; start from its default");
    assert_ok(skinslide_mirror(&view, &good, NULL, 0, mirrored, vertices, &error), &error);
    mesh.points[0] = NAN;
    assert_int_equal(skinslide_mirror(&view, &good, faces, 1, mirrored, vertices, &error), SKINSLIDE_BAD_POINTS);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_in_any_order),
        cmocka_unit_test(any_plane),
        cmocka_unit_test(a_flat_sheet),
        cmocka_unit_test(sheets_in_one_place_are_told_apart),
        cmocka_unit_test(some_faces_only),
        cmocka_unit_test(the_usual_tolerance),
        cmocka_unit_test(what_has_no_counterpart_is_named),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
