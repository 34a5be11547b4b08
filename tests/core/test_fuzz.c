/* Random faces, valid and not: never a crash, and what is created holds and slides. Seeded, so every run is the same. */
#include "invariants.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 40000 };

/* ---- Meshes: of random indices, or sound ones that were damaged ---- */

static test_mesh random_indices(dice *d) {
    int32_t vertices = 3 + roll_below(d, 10), faces = 1 + roll_below(d, 12), counts[12], indices[12 * 6], n = 0;
    float points[13 * 3];
    bool all_triangles = roll_below(d, 2);
    for (int32_t f = 0; f < faces; f++) {
        counts[f] = all_triangles ? 3 : roll_below(d, 50) ? 3 + roll_below(d, 3) : roll_below(d, 3);
        for (int32_t k = 0; k < counts[f]; k++)
            indices[n++] = roll_below(d, 300) ? roll_below(d, vertices) : roll_below(d, 2) ? -1 : vertices;
    }
    for (int32_t k = 0; k < 3 * vertices; k++)
        points[k] = (float)roll_share(d);
    return copy_mesh(vertices, faces, counts, indices, points);
}

static void turn_face(test_mesh *mesh, int32_t face) {
    int32_t begin = 0, n = mesh->face_counts[face];
    for (int32_t f = 0; f < face; f++)
        begin += mesh->face_counts[f];
    for (int32_t i = 0; i < n / 2; i++) {
        int32_t swap = mesh->face_indices[begin + i];
        mesh->face_indices[begin + i] = mesh->face_indices[begin + n - 1 - i], mesh->face_indices[begin + n - 1 - i] = swap;
    }
}

static void damage(test_mesh *mesh, dice *d) {
    int32_t c = roll_below(d, mesh->index_count), v = roll_below(d, mesh->vertex_count), f = roll_below(d, mesh->face_count);
    switch (roll_below(d, 6)) {
    case 0:
        mesh->face_indices[c] = v;
        break;
    case 1: /* two vertices become one */
        for (int32_t i = 0, old = mesh->face_indices[c]; i < mesh->index_count; i++)
            mesh->face_indices[i] = mesh->face_indices[i] == old ? v : mesh->face_indices[i];
        break;
    case 2:
        turn_face(mesh, f);
        break;
    case 3:
        memcpy(mesh->points + 3 * v, mesh->points + 3 * mesh->face_indices[c], sizeof(float[3]));
        break;
    default: /* the set-up leaves faces out */
        break;
    }
}

static test_mesh damaged_mesh(dice *d) {
    test_mesh mesh;
    switch (roll_below(d, 4)) {
    case 0:
        mesh = quad_grid(1 + roll_below(d, 6), 1 + roll_below(d, 6));
        break;
    case 1:
        mesh = triangle_grid(1 + roll_below(d, 6), 1 + roll_below(d, 6));
        break;
    case 2:
        mesh = random_disk(roll(d), roll_below(d, 60));
        break;
    default:
        mesh = annulus(3 + roll_below(d, 6), 1 + roll_below(d, 4));
    }
    for (int32_t i = roll_below(d, 4); i > 0; i--)
        damage(&mesh, d);
    return mesh;
}

/* ---- Set-ups ---- */

static int32_t choose_faces(const test_mesh *mesh, dice *d, int32_t *faces) {
    int32_t count = 0, out_of = roll_below(d, 3) ? 0 : 2 + roll_below(d, 6);
    for (int32_t f = 0; f < mesh->face_count; f++)
        if (out_of == 0 || roll_below(d, out_of))
            faces[count++] = f;
    if (count && roll_below(d, 100) == 0)
        faces[roll_below(d, count)] = roll_below(d, mesh->face_count + 1);
    return count;
}

static skinslide_patch_setup random_setup(const test_mesh *mesh, dice *d, int32_t *faces, int32_t corners[4]) {
    skinslide_patch_setup setup = setup_of(faces, choose_faces(mesh, d, faces));
    setup.boundary = (skinslide_boundary)roll_below(d, 3), setup.holes = (skinslide_holes)roll_below(d, 3);
    setup.rule = (skinslide_rule)roll_below(d, 4), setup.interpolation = (skinslide_interpolation)roll_below(d, 3);
    for (int k = 0; k < 4; k++)
        corners[k] = roll_below(d, mesh->vertex_count);
    setup.corners = roll_below(d, 10) ? NULL : corners;
    return setup;
}

static void paint_wildly(painted *p, float *hold, const test_mesh *mesh, dice *d) {
    double decades = roll_below(d, 3) * roll_between(d, 0, 12);
    p->controls.hold = hold;
    p->controls.stretch_response = (float)roll_share(d), p->controls.compression_response = (float)roll_share(d);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        p->vertex_density[v] = (float)pow(10, roll_between(d, -decades, decades));
        p->weight[v] = (float)roll_between(d, -0.5, 1.5);
        hold[v] = (float)pow(10, roll_between(d, -decades, decades));
    }
}

/* ---- Frames ---- */

static void wild_points(const test_mesh *mesh, dice *d, float *points) {
    double scale = pow(10, roll_between(d, -38, 37)), flat = roll_below(d, 3) ? 1 : 0;
    for (int32_t k = 0; k < 3 * mesh->vertex_count; k++)
        points[k] = (float)((k % 3 ? flat : 1) * (roll_below(d, 9) ? roll_between(d, -scale, scale) : scale));
}

static void slide_once(const rig *r, const test_mesh *mesh, const float *points, const skinslide_controls *controls) {
    float *slid = malloc(POINT_BYTES(mesh));
    skinslide_error error;
    int32_t patches = skinslide_slider_patch_count(r->slider);
    skinslide_patch_result *results = calloc((size_t)patches + 1, sizeof *results);
    results->size = sizeof *results;
    assert_ok(skinslide_slide(r->workspace, points, controls, slid, results, &error), &error);
    for (int32_t k = 0; k < 3 * mesh->vertex_count; k++)
        assert_true(isfinite(slid[k]));
    for (int32_t p = 0; p < patches; p++) {
        assert_true(isfinite(results[p].stretch_before) && isfinite(results[p].stretch_after) &&
                    isfinite(results[p].largest_slide));
        bool relaxes = r->slider->parts[p].patch->setup->rule == SKINSLIDE_RULE_RELAXED;
        assert_int_equal(results[p].relax_steps, relaxes ? 3 : 0); /* no model of a step is refused */
    }
    free(slid), free(results);
}

static void check_shared(const skinslide_slider *slider, int32_t part) {
    const ss_patch *patch = slider->parts[part].patch;
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        bool shared = false;
        for (int32_t p = 0; p < slider->part_count; p++)
            shared = shared || (p != part && ss_patch_vertex(slider->parts[p].patch, patch->mesh_vertex[v]) >= 0);
        assert_int_equal(patch->shared[v], shared);
    }
}

static void exercise(const rig *r, const test_mesh *mesh, dice *d, painted *paint) {
    for (int32_t p = 0; p < r->slider->part_count; p++) {
        const ss_patch *patch = r->slider->parts[p].patch;
        check_shared(r->slider, p);
        (ss_has_plane(patch->setup->rule) ? assert_patch_holds : assert_surface_holds)(patch);
    }
    float *points = malloc(POINT_BYTES(mesh)), *posed = random_pose(mesh, roll(d));
    float *hold = malloc((size_t)mesh->vertex_count * sizeof *hold);
    slide_once(r, mesh, posed, NULL);
    for (int i = 0; i < 3; i++) {
        wild_points(mesh, d, points);
        paint_wildly(paint, hold, mesh, d);
        slide_once(r, mesh, points, i ? &paint->controls : NULL);
    }
    free(points), free(posed), free(hold);
}

/* Returns whether a slider could be created. */
static bool try_once(dice *d) {
    test_mesh mesh = roll_below(d, 3) ? damaged_mesh(d) : random_indices(d);
    int32_t *faces = malloc((size_t)mesh.face_count * sizeof *faces), corners[4];
    painted paint = paint_at_random(&mesh, roll(d));
    skinslide_patch_setup setup = random_setup(&mesh, d, faces, corners);
    skinslide_mesh view = view_of(&mesh);
    rig r = {0};
    skinslide_error error = {SKINSLIDE_OK, ""};
    skinslide_status status = skinslide_slider_create(&view, &setup, 1, &r.slider, &error);
    if (status) {
        assert_null(r.slider);
        assert_int_equal(error.status, status);
        assert_in_range(strlen(error.message), 5, sizeof error.message - 1);
        assert_null(strchr(error.message, '\n'));
    } else {
        assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
        exercise(&r, &mesh, d, &paint);
    }
    free_rig(&r);
    free_painted(&paint);
    free(faces);
    free_mesh(&mesh);
    return !status;
}

static void random_faces(void **state) {
    (void)state;
    dice d = {2009};
    int32_t created = 0;
    for (int32_t i = 0; i < ROUNDS; i++)
        created += try_once(&d);
    print_message("%d of %d set-ups could be created\n", created, ROUNDS);
    assert_in_range(created, ROUNDS / 5, ROUNDS - ROUNDS / 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
