/* The other side of a mesh by nearest place: as by faces where those are symmetric, and where they are cut otherwise. */
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
enum { COLUMNS = 8, ROWS = 6 };

/* Each quad of a grid cut from its first corner: all along the same diagonal, so that no face mirrors one. */
static test_mesh cut_alike(void) {
    test_mesh grid = quad_grid(COLUMNS, ROWS);
    int32_t counts[2 * COLUMNS * ROWS], indices[6 * COLUMNS * ROWS];
    for (int32_t f = 0; f < grid.face_count; f++) {
        const int32_t *v = grid.face_indices + 4 * f, own[6] = {v[0], v[1], v[2], v[0], v[2], v[3]};
        memcpy(indices + 6 * f, own, sizeof own);
        counts[2 * f] = counts[2 * f + 1] = 3;
    }
    test_mesh mesh = copy_mesh(grid.vertex_count, 2 * grid.face_count, counts, indices, grid.points);
    free_mesh(&grid);
    return mesh;
}

/* A grid, or triangles, on a bumpy sheet that is symmetric about x = 4. */
static test_mesh symmetric(bool triangles) {
    test_mesh mesh = triangles ? cut_alike() : quad_grid(COLUMNS, ROWS);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        float *p = mesh.points + 3 * v, off = fabsf(p[0] - COLUMNS / 2.0F);
        p[2] = (float)(0.3 * sin(off) + 0.2 * sin(p[1]));
    }
    return mesh;
}

static double middle_x(const test_mesh *mesh, int32_t face) {
    int32_t count = mesh->face_counts[0];
    double sum = 0;
    for (int32_t k = 0; k < count; k++)
        sum += mesh->points[3 * mesh->face_indices[count * face + k]];
    return sum / count;
}

/* Faces left of the middle, and in some rows: the count. */
static int32_t left_faces(const test_mesh *mesh, int32_t *faces) {
    int32_t count = 0, corners = mesh->face_counts[0];
    for (int32_t f = 0; f < mesh->face_count; f++)
        if (middle_x(mesh, f) < 3 && mesh->points[3 * mesh->face_indices[corners * f] + 1] < 4)
            faces[count++] = f;
    return count;
}

typedef struct nearest {
    int32_t *faces, *vertices;
    double worst;
} nearest;

static skinslide_mirror_options about(int32_t axis, double plane, double tolerance) {
    return (skinslide_mirror_options){sizeof(skinslide_mirror_options), axis, plane, tolerance};
}

static skinslide_status find(const test_mesh *mesh, double tolerance, const int32_t *faces, int32_t count, nearest *out) {
    skinslide_mesh view = view_of(mesh);
    const skinslide_mirror_options options = about(0, COLUMNS / 2, tolerance);
    *out =
        (nearest){malloc((size_t)mesh->face_count * sizeof(int32_t)), malloc((size_t)mesh->vertex_count * sizeof(int32_t)), -1};
    return skinslide_mirror_nearest(&view, &options, faces, count, out->faces, out->vertices, &out->worst, &error);
}

static void free_nearest(nearest *n) {
    free(n->faces), free(n->vertices);
}

static void as_by_faces_where_these_are_symmetric(void **state) {
    (void)state;
    test_mesh mesh = symmetric(false);
    skinslide_mesh view = view_of(&mesh);
    const skinslide_mirror_options middle = about(0, COLUMNS / 2, -1);
    int32_t *faces = all_faces(&mesh), *across = all_faces(&mesh), *image = malloc(sizeof(int32_t) * (size_t)mesh.vertex_count);
    int32_t count = left_faces(&mesh, faces), found = 0;
    assert_ok(skinslide_mirror(&view, &middle, faces, count, across, image, &error), &error);
    nearest n;
    assert_ok(find(&mesh, -1, faces, count, &n), &error);
    for (int32_t i = 0; i < count; i++)
        assert_int_equal(n.faces[across[i]], faces[i]);
    for (int32_t f = 0; f < mesh.face_count; f++)
        found += n.faces[f] >= 0;
    assert_int_equal(found, count);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        if (image[v] >= 0)
            assert_int_equal(n.vertices[image[v]], v);
    assert_near(n.worst, 0, 1e-6);
    free(faces), free(across), free(image);
    free_nearest(&n);
    free_mesh(&mesh);
}

/* Every vertex where the mirror puts it; the same region on the other side, whose faces have none that mirrors them. */
static void faces_cut_otherwise(void **state) {
    (void)state;
    test_mesh mesh = symmetric(true);
    skinslide_mesh view = view_of(&mesh);
    const skinslide_mirror_options middle = about(0, COLUMNS / 2, -1);
    int32_t *faces = all_faces(&mesh), *across = all_faces(&mesh), *image = malloc(sizeof(int32_t) * (size_t)mesh.vertex_count);
    int32_t count = left_faces(&mesh, faces), found = 0;
    assert_fails(skinslide_mirror(&view, &middle, faces, count, across, image, &error), &error, SKINSLIDE_BAD_MESH, "face ...");
    nearest n;
    assert_ok(find(&mesh, -1, faces, count, &n), &error);
    for (int32_t f = 0; f < mesh.face_count; f++)
        if (n.faces[f] >= 0) {
            found++;
            assert_true(middle_x(&mesh, f) > 5 - 1e-6 && fabs(middle_x(&mesh, n.faces[f]) + middle_x(&mesh, f) - COLUMNS) < 1);
        }
    assert_int_equal(found, count);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = mesh.points + 3 * v, *q = mesh.points + 3 * n.vertices[v];
        if (n.vertices[v] >= 0)
            assert_true(fabsf(p[0] + q[0] - COLUMNS) < 1e-6F && p[1] == q[1] && fabsf(p[2] - q[2]) < 1e-6F);
    }
    assert_near(n.worst, 0, 1e-6);
    free(faces), free(across), free(image);
    free_nearest(&n);
    free_mesh(&mesh);
}

static void what_is_too_far_is_named(void **state) {
    (void)state;
    test_mesh mesh = symmetric(true);
    int32_t *faces = all_faces(&mesh), count = left_faces(&mesh, faces);
    mesh.points[3 * (COLUMNS - 1) + 2] += 0.125F; /* on the other side */
    nearest n;
    assert_fails(find(&mesh, -1, faces, count, &n), &error, SKINSLIDE_BAD_MESH,
                 "the mirror image of point 1 beyond x = 4 is ...");
    free_nearest(&n);
    assert_ok(find(&mesh, 0.2, faces, count, &n), &error);
    assert_true(n.worst > 0.05 && n.worst <= 0.125);
    free_nearest(&n);
    skinslide_mesh view = view_of(&mesh);
    const skinslide_mirror_options no_axis = about(3, 0, -1), middle = about(0, 4, -1), beyond = about(0, 100, 1e6);
    int32_t none[200];
    double worst;
    assert_fails(skinslide_mirror_nearest(&view, &no_axis, faces, count, none, none, &worst, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "axis 3, plane 0, tolerance -1");
    assert_fails(skinslide_mirror_nearest(&view, &middle, faces, count, NULL, none, &worst, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "no place for what is nearest");
    assert_fails(skinslide_mirror_nearest(&view, &beyond, faces, count, none, none, &worst, &error), &error, SKINSLIDE_BAD_MESH,
                 "no face is beyond x = 100 where these are");
    free(faces);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_by_faces_where_these_are_symmetric),
        cmocka_unit_test(faces_cut_otherwise),
        cmocka_unit_test(what_is_too_far_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
