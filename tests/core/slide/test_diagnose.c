/* What a slide did by vertex: by hand, and against sums over the faces of the mesh itself. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

typedef struct arrays {
    float *before, *after, *slide, *density;
    skinslide_diagnostics out;
} arrays;

static arrays arrays_of(const test_mesh *mesh) {
    size_t size = (size_t)mesh->vertex_count * sizeof(float);
    arrays made = {malloc(size), malloc(size), malloc(size), malloc(size), {0}};
    made.out = (skinslide_diagnostics){sizeof(skinslide_diagnostics), made.before, made.after, made.slide, made.density};
    return made;
}

static void free_arrays(arrays *a) {
    free(a->before), free(a->after), free(a->slide), free(a->density);
}

/* ---- By hand ---- */

/* Two unit quads side by side, vertices 0 1 2 below, 3 4 5 above. The right one is stretched along x by e, so log is 1 on its
 * sides 1-2 and 4-5 and 0 on all others. Vertex 1 has sides 0-1, 1-2, 1-4; vertex 2 has 1-2, 2-5; slid puts 4 and 5 back. */
static void two_quads_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 1);
    int32_t faces[2] = {0, 1};
    rig r = rig_of(&mesh, setup_of(faces, 2));
    arrays a = arrays_of(&mesh);
    float *cached = copy_points(&mesh), *slid;
    cached[3 * 2] = cached[3 * 5] = (float)(1 + exp(1));
    slid = malloc(POINT_BYTES(&mesh));
    memcpy(slid, cached, POINT_BYTES(&mesh));
    slid[3 * 2] = slid[3 * 5] = 2, slid[3 * 5 + 2] = 0;
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, cached, slid, &a.out, &error), &error);
    const double before[6] = {0, sqrt(1.0 / 3), sqrt(0.5), 0, sqrt(1.0 / 3), sqrt(0.5)};
    const double slide[6] = {0, 0, exp(1) - 1, 0, 0, exp(1) - 1};
    for (int v = 0; v < 6; v++) {
        assert_near(a.before[v], before[v], 2e-7); /* the point at 1 + e is a float */
        assert_near(a.after[v], 0, 0);
        assert_near(a.slide[v], slide[v], 2e-7);
        assert_near(a.density[v], 1, 0);
    }
    free(cached), free(slid);
    free_arrays(&a);
    free_rig(&r);
    free_mesh(&mesh);
}

/* A triangle and a pair of them meet in vertex 0 alone, and a quad joins them elsewhere. Of the five edges at the vertex 0-1
 * counts six times. */
static void faces_that_meet_in_a_point_by_hand(void **state) {
    (void)state;
    const int32_t counts[4] = {3, 3, 3, 4}, indices[13] = {0, 1, 2, 0, 3, 4, 0, 4, 5, 2, 1, 5, 4};
    const float points[18] = {0, 0, 0, -1, 1, 0, -1, -1, 0, 1, -1, 0, 2, 0, 0, 1, 1, 0};
    test_mesh mesh = copy_mesh(6, 4, counts, indices, points);
    int32_t faces[4] = {0, 1, 2, 3}, edge[2] = {0, 1};
    float six = 6;
    skinslide_patch_setup setup = setup_of(faces, 4);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.edges = edge, controls.edge_density = &six, controls.edge_count = 1;
    setup.rule = SKINSLIDE_RULE_EVEN, setup.controls = &controls;
    rig r = rig_of(&mesh, setup);
    arrays a = arrays_of(&mesh);
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, mesh.points, mesh.points, &a.out, &error), &error);
    assert_near(a.density[0], 2, 0);
    free_arrays(&a);
    free_rig(&r);
    free_mesh(&mesh);
}

/* A patch of the left quad alone: vertex 1 has 0-1 and 1-4, and 2 and 5 none. Edge 0-1 counts three times: vertices 0 and 1
 * each take the mean of 3 and 1. */
static void what_is_off_the_patch_by_hand(void **state) {
    (void)state;
    static const int32_t edge[2] = {1, 0};
    static const float factor[1] = {3};
    test_mesh mesh = quad_grid(2, 1);
    int32_t faces[1] = {0};
    skinslide_patch_setup setup = setup_of(faces, 1);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.edges = edge, controls.edge_density = factor, controls.edge_count = 1;
    setup.controls = &controls;
    rig r = rig_of_setups(&mesh, &setup, 1);
    arrays a = arrays_of(&mesh);
    float *cached = copy_points(&mesh);
    cached[3 * 2] = cached[3 * 5] = 7;
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, cached, mesh.points, &a.out, &error), &error);
    const double density[6] = {2, 2, 1, 1, 1, 1};
    for (int v = 0; v < 6; v++) {
        assert_near(a.before[v], 0, 0);
        assert_near(a.slide[v], v == 2 || v == 5 ? 5 : 0, 0);
        assert_near(a.density[v], density[v], 0);
    }
    skinslide_controls other = SKINSLIDE_CONTROLS_DEFAULT; /* the frame's, in place of the set-up's */
    assert_ok(skinslide_diagnose(r.slider, &other, NULL, cached, mesh.points, &a.out, &error), &error);
    assert_near(a.density[0], 1, 0);
    free(cached);
    free_arrays(&a);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- Against sums over the faces ---- */

static double length_of(const float *points, int32_t a, int32_t b) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += pow((double)points[3 * a + k] - points[3 * b + k], 2);
    return sqrt(sum);
}

/* The sides between two vertices of a face that is of a set-up; -1 where none is. */
static bool has_edge(const test_mesh *mesh, const skinslide_patch_setup *setup, int32_t a, int32_t b) {
    for (int32_t f = 0, start = 0; f < mesh->face_count; start += mesh->face_counts[f++])
        for (int32_t i = 0; i < setup->face_count; i++)
            for (int32_t k = 0; setup->faces[i] == f && k < mesh->face_counts[f]; k++) {
                int32_t here = mesh->face_indices[start + k];
                int32_t next = mesh->face_indices[start + (k + 1) % mesh->face_counts[f]];
                if ((here == a && next == b) || (here == b && next == a))
                    return true;
            }
    return false;
}

typedef struct expected {
    double stretch, density;
} expected;

/* What is expected at one vertex, found by looking at every other: quadratic, and plain. Set-ups are in one piece. */
static expected expect(const test_mesh *mesh, const skinslide_patch_setup *setups, int32_t count, const uint8_t *chosen,
                       const float *points, int32_t v) {
    double squares = 0, edges = 0, densities = 0, patches = 0;
    for (int32_t other = 0; other < mesh->vertex_count; other++) {
        bool any = false;
        for (int32_t s = 0; s < count; s++)
            any = any || (chosen[s] && other != v && has_edge(mesh, &setups[s], v, other));
        if (any)
            squares += pow(log(length_of(points, v, other) / length_of(mesh->points, v, other)), 2), edges++;
    }
    for (int32_t s = 0; s < count; s++) {
        double sum = 0, degree = 0;
        for (int32_t other = 0; other < mesh->vertex_count && chosen[s]; other++)
            if (other != v && has_edge(mesh, &setups[s], v, other)) {
                const float *paint = setups[s].controls->vertex_density;
                sum += ((double)paint[v] + paint[other]) / 2, degree++;
            }
        if (degree > 0)
            densities += sum / degree, patches++;
    }
    return (expected){edges > 0 ? sqrt(squares / edges) : 0, patches > 0 ? densities / patches : 1};
}

/* Three patches of a grid, of which two overlap, each painted. */
static void overlapping_patches(void **state) {
    (void)state;
    static const int32_t left[6] = {0, 1, 5, 6, 10, 11}, middle[9] = {1, 2, 3, 6, 7, 8, 11, 12, 13}, corner[1] = {24};
    static const uint8_t all[3] = {1, 1, 1}, some[3] = {0, 1, 1};
    test_mesh mesh = quad_grid(5, 5);
    float *points = random_pose(&mesh, 3), *slid = random_pose(&mesh, 4);
    skinslide_patch_setup setups[3] = {setup_of(left, 6), setup_of(middle, 9), setup_of(corner, 1)};
    painted paint[3];
    skinslide_controls controls[3];
    for (int s = 0; s < 3; s++) {
        paint[s] = paint_at_random(&mesh, (uint64_t)s + 1);
        controls[s] = (skinslide_controls)SKINSLIDE_CONTROLS_DEFAULT;
        controls[s].vertex_density = paint[s].vertex_density;
        setups[s].controls = &controls[s];
    }
    rig r = rig_of_setups(&mesh, setups, 3);
    arrays a = arrays_of(&mesh);
    for (int turn = 0; turn < 3; turn++) {
        const uint8_t *chosen = turn == 0 ? NULL : turn == 1 ? all : some;
        assert_ok(skinslide_diagnose(r.slider, NULL, chosen, points, slid, &a.out, &error), &error);
        for (int32_t v = 0; v < mesh.vertex_count; v++) {
            expected before = expect(&mesh, setups, 3, chosen ? chosen : all, points, v);
            expected after = expect(&mesh, setups, 3, chosen ? chosen : all, slid, v);
            assert_near(a.before[v], before.stretch, 1e-6 * (1 + before.stretch));
            assert_near(a.after[v], after.stretch, 1e-6 * (1 + after.stretch));
            assert_near(a.density[v], after.density, 1e-6 * after.density);
            assert_near(a.slide[v],
                        sqrt(pow((double)slid[3 * v] - points[3 * v], 2) + pow((double)slid[3 * v + 1] - points[3 * v + 1], 2) +
                             pow((double)slid[3 * v + 2] - points[3 * v + 2], 2)),
                        1e-6);
        }
    }
    for (int s = 0; s < 3; s++)
        free_painted(&paint[s]);
    free(points), free(slid);
    free_arrays(&a);
    free_rig(&r);
    free_mesh(&mesh);
}

/* Each edge is at two vertices: twice the edges times the report's square is the sum over vertices of their edges times theirs.
 */
static void adds_up_to_the_report(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        int32_t *faces = all_faces(&f.mesh);
        rig r = rig_of(&f.mesh, setup_of(faces, f.mesh.face_count));
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
        skinslide_patch_result results[8];
        float *points = random_pose(&f.mesh, (uint64_t)i), *slid;
        if (skinslide_slider_patch_count(r.slider) == 1) {
            arrays a = arrays_of(&f.mesh);
            double before = 0, after = 0, edges = patch->faces.edge_count;
            slid = slide_with(&r, &f.mesh, points, NULL, results);
            assert_ok(skinslide_diagnose(r.slider, NULL, NULL, points, slid, &a.out, &error), &error);
            for (int32_t e = 0; e < patch->faces.edge_count; e++)
                for (int k = 0; k < 2; k++) {
                    int32_t v = patch->mesh_vertex[patch->edge_vertex[e][k]];
                    before += pow(a.before[v], 2), after += pow(a.after[v], 2);
                }
            assert_near(sqrt(before / (2 * edges)), results[0].stretch_before, 1e-6);
            assert_near(sqrt(after / (2 * edges)), results[0].stretch_after, 1e-6);
            free(slid);
            free_arrays(&a);
        }
        free(points), free(faces);
        ss_patch_destroy(patch);
        free_rig(&r);
        free_mesh(&f.mesh);
    }
}

/* ---- Properties ---- */

static void rest_gives_zeros_bit_for_bit(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        int32_t *faces = all_faces(&f.mesh);
        rig r = rig_of(&f.mesh, setup_of(faces, f.mesh.face_count));
        arrays a = arrays_of(&f.mesh);
        float *slid = slide_with(&r, &f.mesh, f.mesh.points, NULL, NULL);
        float *zeros = calloc((size_t)f.mesh.vertex_count, sizeof *zeros);
        size_t size = (size_t)f.mesh.vertex_count * sizeof *zeros;
        assert_ok(skinslide_diagnose(r.slider, NULL, NULL, f.mesh.points, slid, &a.out, &error), &error);
        assert_same_bytes(a.before, zeros, size);
        assert_same_bytes(a.after, zeros, size);
        assert_same_bytes(a.slide, zeros, size);
        free(slid), free(zeros), free(faces);
        free_arrays(&a);
        free_rig(&r);
        free_mesh(&f.mesh);
    }
}

static void what_is_not_wanted_is_left_out(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    int32_t *faces = all_faces(&mesh);
    rig r = rig_of(&mesh, setup_of(faces, mesh.face_count));
    float *points = random_pose(&mesh, 1), slide[16];
    arrays a = arrays_of(&mesh);
    const skinslide_diagnostics none = SKINSLIDE_DIAGNOSTICS_DEFAULT, one = {.size = sizeof one, .slide = slide};
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, points, mesh.points, &a.out, &error), &error);
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, points, mesh.points, &none, &error), &error);
    assert_ok(skinslide_diagnose(r.slider, NULL, NULL, points, mesh.points, &one, &error), &error);
    assert_same_bytes(slide, a.slide, sizeof slide);
    free(points), free(faces);
    free_arrays(&a);
    free_rig(&r);
    free_mesh(&mesh);
}

static void bad_arguments(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    int32_t *faces = all_faces(&mesh);
    rig r = rig_of(&mesh, setup_of(faces, mesh.face_count));
    float *bad = copy_points(&mesh), slide[16] = {7};
    const skinslide_diagnostics out = {.size = sizeof(skinslide_diagnostics), .slide = slide};
    bad[3 * 5 + 1] = NAN;
    assert_fails(skinslide_diagnose(NULL, NULL, NULL, bad, bad, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no slider, ...");
    assert_fails(skinslide_diagnose(r.slider, NULL, NULL, bad, bad, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no slider, ...");
    assert_fails(skinslide_diagnose(r.slider, NULL, NULL, bad, mesh.points, &out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "cached points: vertex 5 is not finite: ...");
    assert_fails(skinslide_diagnose(r.slider, NULL, NULL, mesh.points, bad, &out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "slid points: vertex 5 is not finite: ...");
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    float density[16] = {0};
    controls.vertex_density = density;
    assert_fails(skinslide_diagnose(r.slider, &controls, NULL, mesh.points, mesh.points, &out, &error), &error,
                 SKINSLIDE_BAD_CONTROL, "patch all: force density of vertex 0 is 0; ...");
    assert_near(slide[0], 7, 0);
    free(bad), free(faces);
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_quads_by_hand),
        cmocka_unit_test(faces_that_meet_in_a_point_by_hand),
        cmocka_unit_test(what_is_off_the_patch_by_hand),
        cmocka_unit_test(overlapping_patches),
        cmocka_unit_test(adds_up_to_the_report),
        cmocka_unit_test(rest_gives_zeros_bit_for_bit),
        cmocka_unit_test(what_is_not_wanted_is_left_out),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
