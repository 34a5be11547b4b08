/* How the skin turned in a frame: nothing where nothing slid, and on a sheet whose normals are known where it went. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
enum { SIDE = 24 };
static const double height = 6, width = 50; /* of z = height exp(-r^2 / width) about the middle of the sheet */

static float *turns_of(const rig *r, const test_mesh *mesh, const float *points) {
    float *turns = malloc(POINT_BYTES(mesh));
    assert_ok(skinslide_workspace_turns(r->workspace, points, turns, &error), &error);
    return turns;
}

static bool same_point(const float *a, const float *b, int32_t vertex) {
    return memcmp(a + 3 * vertex, b + 3 * vertex, sizeof(float[3])) == 0;
}

static bool is_nothing(const float *turn) {
    return turn[0] == 0 && turn[1] == 0 && turn[2] == 0;
}

/* At rest nothing turns; in a pose what does not move does not. */
static void nothing_slid_turns_nothing(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t way = 0; way < WAY_COUNT; way++) {
            fixture f = make_fixture(i);
            skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
            if (choose_way(&f, way, &choices)) {
                rig r = rig_of(&f.mesh, choices);
                float *pose = random_pose(&f.mesh, 2);
                for (int moved = 0; moved < 2; moved++) {
                    const float *points = moved ? pose : f.mesh.points;
                    float *slid = slide_with(&r, &f.mesh, points, NULL, NULL), *turns = turns_of(&r, &f.mesh, points);
                    for (int32_t v = 0; v < f.mesh.vertex_count; v++) {
                        assert_true(isfinite(turns[3 * v]) && isfinite(turns[3 * v + 1]) && isfinite(turns[3 * v + 2]));
                        assert_true(!same_point(points, slid, v) || is_nothing(turns + 3 * v));
                    }
                    free(slid), free(turns);
                }
                free(pose);
                free_rig(&r);
            }
            free_mesh(&f.mesh);
        }
}

/* ---- A sheet that bulges ---- */

static void middle_of(const float *point, double out[2]) {
    out[0] = (double)point[0] - SIDE / 2.0, out[1] = (double)point[1] - SIDE / 2.0;
}

static void true_normal(const float *point, double out[3]) {
    double at[2];
    middle_of(point, at);
    double slope = 2 * height / width * exp(-(at[0] * at[0] + at[1] * at[1]) / width);
    out[0] = slope * at[0], out[1] = slope * at[1], out[2] = 1;
    ss_normalise(out);
}

/* On the bulge, and drawn together along x on one side of it, so that all of it slides. */
static float *bulging(const test_mesh *mesh) {
    float *points = copy_points(mesh);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        float *p = points + 3 * v;
        double at[2], pi = acos(-1);
        p[0] = (float)((double)p[0] + 0.8 * sin(2 * pi * (double)p[0] / SIDE) * sin(pi * (double)p[1] / SIDE));
        middle_of(p, at);
        p[2] = (float)(height * exp(-(at[0] * at[0] + at[1] * at[1]) / width));
    }
    return points;
}

/* In degrees, of unit vectors; exact also where it is small. */
static double angle(const double a[3], const double b[3]) {
    double across[3];
    ss_cross(a, b, across);
    return atan2(ss_length(across), ss_dot(a, b)) * 180 / acos(-1);
}

static double *true_normals(const test_mesh *mesh, const float *points, float *floats) {
    double *normals = malloc(3 * (size_t)mesh->vertex_count * sizeof *normals);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        true_normal(points + 3 * v, normals + 3 * v);
    for (int32_t i = 0; i < 3 * mesh->vertex_count; i++)
        floats[i] = (float)normals[i];
    return normals;
}

/* The largest angle between the true normals of the points, carried, and the true ones where they slid to, which is `to`. */
static double largest_error(const rig *r, const test_mesh *mesh, const float *points, const float *to, double *largest_slide) {
    skinslide_mesh view = view_of(mesh);
    float *turns = turns_of(r, mesh, points), *carried = malloc(POINT_BYTES(mesh));
    double *before = true_normals(mesh, points, carried), worst = 0;
    *largest_slide = 0;
    assert_ok(skinslide_carry(&view, turns, SKINSLIDE_NORMALS_VERTEX, carried, &error), &error);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double expected[3], found[3] = {carried[3 * v], carried[3 * v + 1], carried[3 * v + 2]};
        double way[3] = {to[3 * v] - points[3 * v], to[3 * v + 1] - points[3 * v + 1], to[3 * v + 2] - points[3 * v + 2]};
        true_normal(to + 3 * v, expected);
        worst = fmax(worst, angle(found, expected));
        *largest_slide = fmax(*largest_slide, ss_length(way));
    }
    free(turns), free(carried), free(before);
    return worst;
}

/* Fully slid, by every rule and interpolation, carried normals are the true ones to a degree, on faces that bend by up to 14
 * degrees from one to the next. */
static void carried_where_normals_are_known(void **state) {
    (void)state;
    static const skinslide_subdivision catmull_clark = {.size = sizeof(skinslide_subdivision),
                                                        .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    test_mesh mesh = quad_grid(SIDE, SIDE);
    float *points = bulging(&mesh), *slid = malloc(POINT_BYTES(&mesh));
    int32_t *faces = all_faces(&mesh);
    skinslide_mesh view = view_of(&mesh);
    view.subdivision = &catmull_clark;
    for (int rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++)
        for (int way = SKINSLIDE_INTERPOLATION_LINEAR; way <= SKINSLIDE_INTERPOLATION_LIMIT; way++) {
            skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
            setup.rule = (skinslide_rule)rule, setup.interpolation = (skinslide_interpolation)way;
            if (rule == SKINSLIDE_RULE_EVEN && way != SKINSLIDE_INTERPOLATION_LINEAR)
                continue;
            rig r;
            double largest_slide;
            assert_ok(skinslide_slider_create(&view, &setup, 1, &r.slider, &error), &error);
            assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
            assert_ok(skinslide_slide(r.workspace, points, NULL, slid, NULL, &error), &error);
            double worst = largest_error(&r, &mesh, points, slid, &largest_slide);
            assert_true(worst < 1 && largest_slide > 0.5);
            free_rig(&r);
        }
    free(points), free(slid), free(faces);
    free_mesh(&mesh);
}

/* How far the mesh's own smooth normals are from the true ones, at most. */
static double largest_coarseness(const test_mesh *mesh, const float *points) {
    skinslide_mesh view = view_of(mesh);
    uint8_t *all = malloc((size_t)mesh->vertex_count);
    float *floats = malloc(POINT_BYTES(mesh));
    double(*smooth)[3] = malloc((size_t)mesh->vertex_count * sizeof *smooth), worst = 0;
    ss_memory memory = {0};
    ss_around around = {0};
    memset(all, 1, (size_t)mesh->vertex_count);
    assert_true(ss_take_around(&view, all, &memory, &around));
    ss_smooth_normals(&around, points, mesh->vertex_count, smooth);
    double *expected = true_normals(mesh, points, floats);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        worst = fmax(worst, angle(smooth[v], expected + 3 * v));
    free(all), free(floats), free(smooth), free(expected);
    ss_free(&memory);
    return worst;
}

/* On sheets of ever more faces, whose own normals are off by ever less, carried ones are off by less than those, by every
 * rule. */
static void as_near_as_the_mesh_is_fine(void **state) {
    (void)state;
    double before[SKINSLIDE_RULE_EVEN + 1] = {0};
    for (int32_t side = SIDE / 2; side <= 2 * SIDE; side *= 2) {
        test_mesh mesh = quad_grid(side, side);
        for (int32_t i = 0; i < 3 * mesh.vertex_count; i++)
            mesh.points[i] *= (float)SIDE / (float)side;
        float *points = bulging(&mesh);
        double coarseness = largest_coarseness(&mesh, points);
        for (int rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++) {
            skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
            choices.rule = (skinslide_rule)rule;
            rig r = rig_of(&mesh, choices);
            double largest_slide;
            float *slid = slide_with(&r, &mesh, points, NULL, NULL);
            double worst = largest_error(&r, &mesh, points, slid, &largest_slide);
            assert_true(worst < coarseness && (side == SIDE / 2 || worst < 0.6 * before[rule]));
            before[rule] = worst;
            free(slid);
            free_rig(&r);
        }
        free(points);
        free_mesh(&mesh);
    }
}

/* A tiny slide turns hardly at all, and a slide half as far half as much: there is no jump at 0. */
static void a_tiny_slide_turns_a_tiny_bit(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(SIDE, SIDE);
    float *points = bulging(&mesh);
    for (int rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++) {
        skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
        choices.rule = (skinslide_rule)rule;
        rig r = rig_of(&mesh, choices);
        double whole = 0, half = 0;
        for (int part = 1; part <= 2; part++) {
            skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
            controls.envelope = (float)part * 5e-6f;
            float *slid = slide_with(&r, &mesh, points, &controls, NULL), *turns = turns_of(&r, &mesh, points);
            for (int32_t v = 0; v < mesh.vertex_count; v++) {
                double turn[3] = {turns[3 * v], turns[3 * v + 1], turns[3 * v + 2]};
                *(part == 1 ? &half : &whole) = fmax(part == 1 ? half : whole, 2 * ss_length(turn) * 180 / acos(-1));
            }
            free(slid), free(turns);
        }
        assert_true(half > 0 && whole < 0.005);
        assert_near(whole, 2 * half, 1e-3 * whole);
        free_rig(&r);
    }
    free(points);
    free_mesh(&mesh);
}

/* Where two patches overlap, the normals are blended as displacements are: two that are one and the same make no difference. */
static void overlapping_patches(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(SIDE, SIDE);
    float *points = bulging(&mesh);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setups[2] = {setup_of(faces, mesh.face_count), setup_of(faces, mesh.face_count)};
    rig one = rig_of_setups(&mesh, setups, 1), two = rig_of_setups(&mesh, setups, 2);
    float *slid_once = slide_with(&one, &mesh, points, NULL, NULL), *slid_twice = slide_with(&two, &mesh, points, NULL, NULL);
    float *once = turns_of(&one, &mesh, points), *twice = turns_of(&two, &mesh, points);
    assert_near(largest_difference(once, twice, 3 * mesh.vertex_count), 0, 1e-7);
    free(slid_once), free(slid_twice), free(once), free(twice), free(points), free(faces);
    free_rig(&one), free_rig(&two);
    free_mesh(&mesh);
}

/* The sheet cut in two along its middle column, whose vertices are there twice: the second time at the end. */
static test_mesh cut(const test_mesh *mesh, int32_t *weld) {
    enum { COLUMN = SIDE / 2, COUNT = (SIDE + 1) * (SIDE + 1) };
    float *points = malloc((COUNT + SIDE + 1) * sizeof(float[3]));
    int32_t *indices = malloc((size_t)mesh->index_count * sizeof *indices);
    memcpy(points, mesh->points, POINT_BYTES(mesh));
    for (int32_t v = 0; v < COUNT; v++)
        weld[v] = v;
    for (int32_t j = 0; j <= SIDE; j++) {
        weld[COUNT + j] = j * (SIDE + 1) + COLUMN;
        memcpy(points + 3 * (COUNT + j), mesh->points + 3 * weld[COUNT + j], sizeof(float[3]));
    }
    for (int32_t c = 0; c < mesh->index_count; c++) {
        int32_t v = mesh->face_indices[c], column = c / 4 % SIDE;
        indices[c] = v % (SIDE + 1) == COLUMN && column >= COLUMN ? COUNT + v / (SIDE + 1) : v;
    }
    test_mesh made = copy_mesh(COUNT + SIDE + 1, mesh->face_count, mesh->face_counts, indices, points);
    free(points), free(indices);
    return made;
}

/* Points that are one turn as one, as the vertex of the uncut sheet does. */
static void welded_points_turn_as_one(void **state) {
    (void)state;
    test_mesh whole = quad_grid(SIDE, SIDE);
    int32_t weld[(SIDE + 1) * (SIDE + 2)];
    test_mesh halves = cut(&whole, weld);
    float *points = bulging(&whole), *same = bulging(&halves), *slid = malloc(POINT_BYTES(&halves));
    int32_t *faces = all_faces(&halves);
    skinslide_patch_setup setup = setup_of(faces, halves.face_count);
    skinslide_mesh view = view_of(&halves);
    view.weld = weld;
    rig one = rig_of_setups(&whole, &setup, 1), welded;
    assert_ok(skinslide_slider_create(&view, &setup, 1, &welded.slider, &error), &error);
    assert_ok(skinslide_workspace_create(welded.slider, NULL, &welded.workspace, &error), &error);
    assert_ok(skinslide_slide(welded.workspace, same, NULL, slid, NULL, &error), &error);
    free(slide_with(&one, &whole, points, NULL, NULL));
    float *expected = turns_of(&one, &whole, points), *turns = turns_of(&welded, &halves, same);
    assert_near(largest_difference(turns, expected, 3 * whole.vertex_count), 0, 1e-7);
    for (int32_t v = whole.vertex_count; v < halves.vertex_count; v++) {
        assert_same_bytes(turns + 3 * v, turns + 3 * weld[v], sizeof(float[3]));
        assert_true(is_nothing(turns + 3 * v) == (v == whole.vertex_count || v == halves.vertex_count - 1));
    }
    free(points), free(same), free(slid), free(faces), free(expected), free(turns);
    free_rig(&one), free_rig(&welded);
    free_mesh(&whole), free_mesh(&halves);
}

static void arguments_that_are_none(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    rig r = rig_of(&mesh, (skinslide_patch_setup)SKINSLIDE_PATCH_SETUP_DEFAULT);
    float turns[3 * 16], nowhere[3 * 16] = {[7] = NAN};
    const char *none = "no workspace, or no place for the turns";
    assert_fails(skinslide_workspace_turns(r.workspace, mesh.points, turns, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the workspace has slid no frame yet");
    free(slide_with(&r, &mesh, mesh.points, NULL, NULL));
    assert_fails(skinslide_workspace_turns(NULL, mesh.points, turns, &error), &error, SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_workspace_turns(r.workspace, mesh.points, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, none);
    assert_fails(skinslide_workspace_turns(r.workspace, NULL, turns, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no points");
    assert_fails(skinslide_workspace_turns(r.workspace, nowhere, turns, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 2 is not finite: (0, nan, 0)");
    free_rig(&r);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_slid_turns_nothing),  cmocka_unit_test(carried_where_normals_are_known),
        cmocka_unit_test(as_near_as_the_mesh_is_fine), cmocka_unit_test(a_tiny_slide_turns_a_tiny_bit),
        cmocka_unit_test(overlapping_patches),         cmocka_unit_test(welded_points_turn_as_one),
        cmocka_unit_test(arguments_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
