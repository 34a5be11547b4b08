/* What a frame promises: rest is left alone, so is what cannot slide, and the rest slides on the surface. */
#include "distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float FLOAT_EPSILON = 0x1p-23f;

typedef void each_way(const fixture *f, skinslide_patch_setup choices);

static void for_each_way(each_way *check) {
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        for (int32_t way = 0; way < WAY_COUNT; way++) {
            skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
            if (choose_way(&f, way, &choices))
                check(&f, choices);
        }
        free_mesh(&f.mesh);
    }
}

/* ---- Rest in, rest out ---- */

static void expect_rest(const rig *r, const test_mesh *mesh, const skinslide_controls *controls) {
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(r, mesh, mesh->points, controls, &result);
    assert_same_bytes(slid, mesh->points, POINT_BYTES(mesh));
    assert_int_equal(result.slid_vertices, 0);
    assert_int_equal(result.clamped_vertices, 0);
    assert_int_equal(result.searched_vertices, 0);
    assert_near(result.stretch_before, 0, 0);
    assert_near(result.stretch_after, 0, 0);
    assert_near(result.largest_slide, 0, 0);
    free(slid);
}

static void check_rest(const fixture *f, skinslide_patch_setup choices) {
    painted first = paint_at_random(&f->mesh, 1), second = paint_at_random(&f->mesh, 2);
    rig plain = rig_of(&f->mesh, choices);
    choices.controls = &first.controls;
    rig own = rig_of(&f->mesh, choices);
    expect_rest(&plain, &f->mesh, NULL);
    expect_rest(&plain, &f->mesh, &second.controls);
    expect_rest(&own, &f->mesh, NULL);
    expect_rest(&own, &f->mesh, &second.controls);
    free_rig(&plain), free_rig(&own);
    free_painted(&first), free_painted(&second);
}

static void rest_slides_nothing(void **state) {
    (void)state;
    for_each_way(check_rest);
}

/* Two patches that overlap, and a pose slid in between. */
static void rest_slides_nothing_in_overlaps(void **state) {
    (void)state;
    test_mesh mesh = triangle_grid(10, 6);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setups[2] = {setup_of(faces, 80), setup_of(faces + 40, 80)};
    painted paint = paint_at_random(&mesh, 3);
    setups[1].controls = &paint.controls, setups[1].rule = SKINSLIDE_RULE_FAST;
    rig r = rig_of_setups(&mesh, setups, 2);
    float *points = random_pose(&mesh, 4), *slid = slide_with(&r, &mesh, points, NULL, NULL);
    assert_true(largest_difference(slid, points, 3 * (int64_t)mesh.vertex_count) > 0.01);
    free(slid);
    slid = slide_with(&r, &mesh, mesh.points, NULL, NULL);
    assert_same_bytes(slid, mesh.points, POINT_BYTES(&mesh));
    free(slid), free(points), free(faces);
    free_painted(&paint);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- What stays ---- */

/* The patch is a part of a mesh, held at its boundary and at pinned holes: every vertex that is not free keeps its bits, those
 * of negative zeros too. */
static void what_is_not_free_keeps_its_bits(void **state) {
    (void)state;
    test_mesh mesh = grid_with_holes(false);
    int32_t faces[60];
    for (int32_t f = 0; f < 60; f++)
        faces[f] = f + 10;
    skinslide_patch_setup setup = setup_of(faces, 60);
    rig r = rig_of_setups(&mesh, &setup, 1);
    float *points = shaken(&mesh, 1, 0.5);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        points[3 * v + 2] = -0.0f;
    float *slid = slide_with(&r, &mesh, points, NULL, NULL);
    const ss_patch *patch = r.slider->parts[0].patch;
    int32_t moved = 0;
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        int32_t own = ss_patch_vertex(patch, v);
        if (own < 0 || patch->fixed[own])
            assert_same_bytes(slid + 3 * v, points + 3 * v, sizeof(float[3]));
        else
            moved += memcmp(slid + 3 * v, points + 3 * v, sizeof(float[3])) != 0;
    }
    assert_true(moved > patch->free_count / 2);
    free(slid), free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

static void an_envelope_of_zero_slides_nothing(void **state) {
    (void)state;
    test_mesh mesh = grid_with_holes(true);
    float *points = random_pose(&mesh, 5), *none = calloc((size_t)mesh.vertex_count, sizeof *none);
    for (int32_t holes = 0; holes < 2; holes++) {
        skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
        rig r = rig_of(&mesh, (skinslide_patch_setup){.holes = (skinslide_holes)holes, .controls = &controls});
        controls.envelope = 0;
        float *slid = slide_with(&r, &mesh, points, &controls, NULL);
        assert_same_bytes(slid, points, POINT_BYTES(&mesh));
        free(slid);
        controls.envelope = 1, controls.weight = none;
        slid = slide_with(&r, &mesh, points, &controls, NULL);
        assert_same_bytes(slid, points, POINT_BYTES(&mesh));
        free(slid);
        free_rig(&r);
    }
    free(points), free(none);
    free_mesh(&mesh);
}

static void no_patches_slide_nothing(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    rig r = rig_of_setups(&mesh, NULL, 0);
    float *points = shaken(&mesh, 1, 1), *slid = slide_with(&r, &mesh, points, NULL, NULL);
    assert_same_bytes(slid, points, POINT_BYTES(&mesh));
    free(slid), free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- A slide by hand ---- */

/* 2 x 2 quads on the unit square; the middle vertex, at (1,1), goes to (1.5, 1). Its edges are then 1.5 to the left, 0.5 to the
 * right, sqrt(1.25) up and down, so in the plane
 *     u = (0 / 1.5 + 1 / 0.5 + 2 (0.5 / sqrt(1.25))) / (1/1.5 + 1/0.5 + 2/sqrt(1.25)),   v = 1/2.
 * At rest it was at (1/2, 1/2): now on the edge from its left neighbour, at the share 0.5 / u of it. So x = 1.5 (0.5 / u).
 * Exact but for the rounding of x to float. */
static void a_slide_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    float *points = copy_points(&mesh);
    points[12] = 1.5f;
    double up = 1 / sqrt(1.25), u = (2 + up) / (1 / 1.5 + 2 + 2 * up), x = 1.5 * 0.5 / u;
    double before = log(1.5) * log(1.5) + log(0.5) * log(0.5) + 2 * log(sqrt(1.25)) * log(sqrt(1.25));
    for (int32_t way = SKINSLIDE_INTERPOLATION_AUTO; way <= SKINSLIDE_INTERPOLATION_MEAN_VALUE; way++) {
        rig r = rig_of(&mesh, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE,
                                                      .interpolation = (skinslide_interpolation)way});
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&r, &mesh, points, NULL, &result);
        assert_near(slid[12], x, FLOAT_EPSILON);
        assert_near(slid[13], 1, 0);
        assert_near(slid[14], 0, 0);
        assert_int_equal(result.slid_vertices, 1);
        assert_near(result.largest_slide, 1.5 - x, 1e-14);
        assert_near(result.stretch_before, sqrt(before / 12), 1e-15);
        assert_true(result.stretch_after < result.stretch_before);
        free(slid);
        free_rig(&r);
    }
    free(points);
    free_mesh(&mesh);
}

/* ---- Moved, turned and scaled meshes ---- */

static float *slide_all(const test_mesh *mesh, const float *points, skinslide_patch_setup choices) {
    rig r = rig_of(mesh, choices);
    float *slid = slide_with(&r, mesh, points, NULL, NULL);
    free_rig(&r);
    return slid;
}

/* (x, y, z) to (-y, x, -z): every length keeps its bits, since x^2 + y^2 does. */
static void turn_quarter(float *points, int32_t vertex_count) {
    for (int32_t v = 0; v < vertex_count; v++) {
        float x = points[3 * v];
        points[3 * v] = -points[3 * v + 1], points[3 * v + 1] = x, points[3 * v + 2] = -points[3 * v + 2];
    }
}

/* The relaxed rule's axes in the tangent planes do not turn with the mesh, so that it rounds differently. */
static void check_quarter_turn(const fixture *f, skinslide_patch_setup choices) {
    if (choices.rule == SKINSLIDE_RULE_RELAXED)
        return;
    float *points = random_pose(&f->mesh, 7), *slid = slide_all(&f->mesh, points, choices);
    turn_quarter(points, f->mesh.vertex_count), turn_quarter(slid, f->mesh.vertex_count);
    float *turned = slide_all(&f->mesh, points, choices);
    for (int32_t k = 0; k < 3 * f->mesh.vertex_count; k++)
        assert_true(turned[k] == slid[k]); /* zeros may differ in sign */
    free(points), free(slid), free(turned);
}

static void quarter_turns_commute_exactly(void **state) {
    (void)state;
    for_each_way(check_quarter_turn);
}

/* Scaling rest and pose by a power of two scales every length, and so the result, exactly. */
static void powers_of_two_commute_exactly(void **state) {
    (void)state;
    for (int32_t power = -14; power <= 14; power += 28) /* 6e-5 and 16384 */
        for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
            fixture f = make_fixture(i);
            skinslide_patch_setup choices = setup_of(NULL, 0);
            float *points = random_pose(&f.mesh, 8), *slid = slide_all(&f.mesh, points, choices);
            for (int32_t k = 0; k < 3 * f.mesh.vertex_count; k++) {
                points[k] = ldexpf(points[k], power), slid[k] = ldexpf(slid[k], power);
                f.mesh.points[k] = ldexpf(f.mesh.points[k], power);
            }
            float *scaled = slide_all(&f.mesh, points, choices);
            assert_same_bytes(scaled, slid, POINT_BYTES(&f.mesh));
            free(points), free(slid), free(scaled);
            free_mesh(&f.mesh);
        }
}

/* A rotation about a skew axis and a move, in double, rounded to float. */
static void turn_and_move(float *points, int32_t vertex_count) {
    static const double rows[3][3] = {{2 / 3.0, -1 / 3.0, 2 / 3.0}, {2 / 3.0, 2 / 3.0, -1 / 3.0}, {-1 / 3.0, 2 / 3.0, 2 / 3.0}};
    for (int32_t v = 0; v < vertex_count; v++) {
        double p[3] = {points[3 * v], points[3 * v + 1], points[3 * v + 2]};
        for (int k = 0; k < 3; k++)
            points[3 * v + k] = (float)(rows[k][0] * p[0] + rows[k][1] * p[1] + rows[k][2] * p[2] + 5);
    }
}

/* Rounding of the moved points, 2^-24 of some 20 units, changes lengths near 1 by 1e-6 of themselves, and a vertex slides by
 * about as much more or less of its edges' length; ten times that is allowed. */
static void rigid_motion_commutes(void **state) {
    (void)state;
    for (int32_t i = 3; i <= 8; i++) {
        fixture f = make_fixture(i);
        skinslide_patch_setup choices = setup_of(NULL, 0);
        float *points = bumped(&f.mesh, 4, 4, 3, 1.5), *slid = slide_all(&f.mesh, points, choices);
        turn_and_move(points, f.mesh.vertex_count), turn_and_move(slid, f.mesh.vertex_count);
        float *turned = slide_all(&f.mesh, points, choices);
        assert_near(largest_difference(turned, slid, 3 * (int64_t)f.mesh.vertex_count), 0, 1e-5);
        free(points), free(slid), free(turned);
        free_mesh(&f.mesh);
    }
}

static skinslide_patch_setup by_rule(skinslide_rule rule) {
    skinslide_patch_setup setup = setup_of(NULL, 0);
    setup.rule = rule;
    return setup;
}

/* Whole numbers, 64 to the side of a face, moved by ten million: still exact in float, so lengths are the same bits. Results
 * are whole numbers there, so they differ by one rounding to those: a half, and as much of float's for the other. */
static void far_from_the_origin_is_the_same(void **state) {
    (void)state;
    for (skinslide_rule rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++) {
        test_mesh mesh = quad_grid(12, 12);
        float *points = random_pose(&mesh, 9);
        for (int32_t k = 0; k < 3 * mesh.vertex_count; k++)
            mesh.points[k] *= 64, points[k] = roundf(64 * points[k]);
        float *near_slid = slide_all(&mesh, points, by_rule(rule));
        for (int32_t k = 0; k < 3 * mesh.vertex_count; k++)
            mesh.points[k] += 1e7f, points[k] += 1e7f;
        float *far_slid = slide_all(&mesh, points, by_rule(rule));
        for (int32_t k = 0; k < 3 * mesh.vertex_count; k++)
            assert_near((double)far_slid[k] - 1e7, near_slid[k], 0.5 + 1e-4);
        free(points), free(near_slid), free(far_slid);
        free_mesh(&mesh);
    }
}

/* Sizes that are no powers of two: rounding of points to float is 1e-7 of them, as under rigid motion. FAST magnifies it on
 * edges that are all the longest: there its force densities are 1e-4 of what a change of length makes them. */
static void tiny_and_huge_meshes_slide_alike(void **state) {
    (void)state;
    static const skinslide_rule rules[] = {SKINSLIDE_RULE_UNIT, SKINSLIDE_RULE_RELAXED, SKINSLIDE_RULE_EVEN};
    for (int32_t i = 0; i < 6; i++) {
        test_mesh mesh = quad_grid(12, 12);
        double scale = i % 2 ? 1e4 : 1e-4;
        skinslide_patch_setup setup = by_rule(rules[i / 2]);
        float *points = bumped(&mesh, 6, 6, 3, 2), *slid = slide_all(&mesh, points, setup);
        for (int32_t k = 0; k < 3 * mesh.vertex_count; k++) {
            mesh.points[k] = (float)(scale * mesh.points[k]);
            points[k] = (float)(scale * points[k]), slid[k] = (float)(scale * slid[k]);
        }
        float *scaled = slide_all(&mesh, points, setup);
        assert_near(largest_difference(scaled, slid, 3 * (int64_t)mesh.vertex_count), 0, 1e-5 * scale);
        free(points), free(slid), free(scaled);
        free_mesh(&mesh);
    }
}

/* ---- Embeddings in a frame ---- */

static void check_embedding(const rig *r, const skinslide_patch_setup *choices) {
    const ss_patch *patch = r->slider->parts[0].patch;
    double(*uv)[2] = malloc((size_t)patch->vertex_count * sizeof *uv);
    skinslide_error error;
    assert_ok(skinslide_workspace_embedding(r->workspace, 0, &uv[0][0], &error), &error);
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        assert_true(uv[v][0] >= 0 && uv[v][0] <= 1 + 1e-15 && uv[v][1] >= 0 && uv[v][1] <= 1 + 1e-15);
        if (choices->boundary == SKINSLIDE_BOUNDARY_CIRCLE)
            assert_true(hypot(uv[v][0] - 0.5, uv[v][1] - 0.5) <= 0.5 + 1e-15);
    }
    free(uv);
}

/* A disk never folds, by Tutte's theorem; uv stays inside, to the rounding of a weighted mean. With pinned holes there is no
 * such theorem: unpainted, no fold was met in these poses, which are a sample; painted at random, a thin ring of skin does fold
 * now and then. Free holes may fold. So may slides over rest that is crumpled itself. Folds there are counted, not asserted. */
static void check_poses(const fixture *f, skinslide_patch_setup choices) {
    if (choices.interpolation != SKINSLIDE_INTERPOLATION_LINEAR)
        return; /* nothing to do with the embedding */
    rig r = rig_of(&f->mesh, choices);
    for (uint64_t seed = 0; seed < 80; seed++) {
        float *points = random_pose(&f->mesh, seed);
        painted paint = paint_at_random(&f->mesh, seed);
        skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
        float *slid = slide_with(&r, &f->mesh, points, seed % 2 ? &paint.controls : NULL, &result);
        bool crumpled = !r.slider->parts[0].rest->uv && strstr(f->name, "random");
        if (!crumpled && (f->holes == 0 || (choices.holes == SKINSLIDE_HOLES_PINNED && seed % 2 == 0)))
            assert_int_equal(result.folded_faces, 0);
        if (r.slider->parts[0].rest->uv)
            check_embedding(&r, &choices);
        free(points), free(slid);
        free_painted(&paint);
    }
    free_rig(&r);
}

static void nothing_folds_and_uv_stays_inside(void **state) {
    (void)state;
    for_each_way(check_poses);
}

/* ---- Where slid vertices are ---- */

/* With linear interpolation every slid vertex is on the deformed surface, whatever its weight: to the rounding of the point to
 * float. */
static void slid_vertices_are_on_the_surface(void **state) {
    (void)state;
    for (int32_t i = 2; i <= 8; i++) {
        fixture f = make_fixture(i);
        painted paint = paint_at_random(&f.mesh, 3);
        skinslide_controls half = SKINSLIDE_CONTROLS_DEFAULT;
        rig r = rig_of(&f.mesh, (skinslide_patch_setup){.holes = (skinslide_holes)(i % 2), .controls = &half});
        float *points = random_pose(&f.mesh, 6);
        half.envelope = 0.5f;
        double size = extent_of(points, f.mesh.vertex_count);
        const skinslide_controls *all[3] = {NULL, &half, &paint.controls};
        for (int k = 0; k < 3; k++) {
            float *slid = slide_with(&r, &f.mesh, points, all[k], NULL);
            for (int32_t c = 0; c < f.mesh.index_count; c++)
                assert_near(distance_to_mesh(&f.mesh, points, slid + 3 * f.mesh.face_indices[c]), 0, FLOAT_EPSILON * size);
            free(slid);
        }
        free(points);
        free_painted(&paint);
        free_rig(&r);
        free_mesh(&f.mesh);
    }
}

/* The point of it all: a bump that drags the points under it stretches edges, and sliding takes most of that back. */
static void sliding_lowers_stretch(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(30, 30);
    float *points = bumped(&mesh, 15, 15, 5, 5);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(&r, &mesh, points, NULL, &result);
    assert_true(result.stretch_after < 0.75 * result.stretch_before);
    assert_true(result.largest_slide > 0.5);
    free(slid), free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

static void points_may_be_slid_in_place(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    float *points = random_pose(&mesh, 2), *slid = slide_with(&r, &mesh, points, NULL, NULL);
    skinslide_error error;
    assert_ok(skinslide_slide(r.workspace, points, NULL, points, NULL, &error), &error);
    assert_same_bytes(points, slid, POINT_BYTES(&mesh));
    free(slid), free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

/* Frames with and without measures, in either order. */
static void measuring_changes_no_point(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    rig r = rig_of(&mesh, setup_of(NULL, 0));
    skinslide_patch_result measured[2] = {SKINSLIDE_PATCH_RESULT_DEFAULT, SKINSLIDE_PATCH_RESULT_DEFAULT};
    float *points = random_pose(&mesh, 3), *slid[4];
    for (int i = 0; i < 4; i++) {
        slid[i] = slide_with(&r, &mesh, points, NULL, i % 2 ? &measured[i / 2] : NULL);
        assert_same_bytes(slid[i], slid[0], POINT_BYTES(&mesh));
    }
    assert_true(measured[0].stretch_after > 0 && measured[0].stretch_after == measured[1].stretch_after);
    assert_true(measured[0].slid_vertices > 0 && measured[0].slid_vertices == measured[1].slid_vertices);
    for (int i = 0; i < 4; i++)
        free(slid[i]);
    free(points);
    free_rig(&r);
    free_mesh(&mesh);
}

/* ---- Several patches ---- */

static float *slide_setup(const test_mesh *mesh, const float *points, const skinslide_patch_setup *setup) {
    rig r = rig_of_setups(mesh, setup, 1);
    float *slid = slide_with(&r, mesh, points, NULL, NULL);
    free_rig(&r);
    return slid;
}

static double weight_at(const skinslide_slider *slider, int32_t part, const float *weight, int32_t vertex) {
    const ss_patch *patch = slider->parts[part].patch;
    int32_t own = ss_patch_vertex(patch, vertex);
    return own < 0 || patch->fixed[own] ? 0 : weight[vertex];
}

/* The largest distance between two places of a vertex that may slide. */
static double largest_move(const ss_patch *patch, const float *a, const float *b) {
    double largest = 0;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t k = 3 * patch->mesh_vertex[patch->free_vertex[i]];
        double x = (double)a[k] - b[k], y = (double)a[k + 1] - b[k + 1], z = (double)a[k + 2] - b[k + 2];
        largest = fmax(largest, sqrt(x * x + y * y + z * z));
    }
    return largest;
}

/* Left and right patches of a grid that share its middle, each with its own weights:
 *     slid = point + (w1 d1 + w2 d2) / (w1 + w2),
 * the displacements d taken from each patch alone, where they were rounded to float: 2^-23 of coordinates under 16. */
static void overlaps_are_weighted_means(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(8, 8);
    int32_t *faces = all_faces(&mesh);
    painted first = paint_at_random(&mesh, 1), second = paint_at_random(&mesh, 2);
    skinslide_patch_setup setups[2] = {setup_of(faces, 48), setup_of(faces + 24, 40)};
    skinslide_controls controls[2] = {SKINSLIDE_CONTROLS_DEFAULT, SKINSLIDE_CONTROLS_DEFAULT};
    controls[0].weight = first.weight, controls[1].weight = second.weight;
    setups[0].controls = &controls[0], setups[1].controls = &controls[1];
    float *points = random_pose(&mesh, 3);
    float *one = slide_setup(&mesh, points, &setups[0]), *two = slide_setup(&mesh, points, &setups[1]);
    rig r = rig_of_setups(&mesh, setups, 2);
    skinslide_patch_result results[2];
    float *both = slide_with(&r, &mesh, points, NULL, results);
    for (int p = 0; p < 2; p++)
        assert_near(results[p].largest_slide, largest_move(r.slider->parts[p].patch, both, points), 16 * FLOAT_EPSILON);
    int32_t shared = 0;
    for (int32_t k = 0; k < 3 * mesh.vertex_count; k++) {
        double w1 = weight_at(r.slider, 0, first.weight, k / 3), w2 = weight_at(r.slider, 1, second.weight, k / 3);
        double d1 = (double)one[k] - points[k], d2 = (double)two[k] - points[k];
        shared += w1 > 0 && w2 > 0;
        assert_near(both[k], w1 + w2 > 0 ? points[k] + (w1 * d1 + w2 * d2) / (w1 + w2) : points[k], 16 * FLOAT_EPSILON);
    }
    assert_true(shared > 30);
    free(one), free(two), free(both), free(points), free(faces);
    free_painted(&first), free_painted(&second);
    free_rig(&r);
    free_mesh(&mesh);
}

/* Two separate sheets in one set-up are two patches, and slide as either would alone: the same bytes. */
static void pieces_slide_as_if_alone(void **state) {
    (void)state;
    test_mesh left = quad_grid(6, 5), right = triangle_grid(4, 7), mesh = join_meshes(&left, &right);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
    float *points = random_pose(&mesh, 3), *slid = slide_setup(&mesh, points, &setup);
    float *one = slide_all(&left, points, setup), *two = slide_all(&right, points + 3 * left.vertex_count, setup);
    assert_same_bytes(slid, one, POINT_BYTES(&left));
    assert_same_bytes(slid + 3 * left.vertex_count, two, POINT_BYTES(&right));
    free(points), free(slid), free(one), free(two), free(faces);
    free_mesh(&left), free_mesh(&right), free_mesh(&mesh);
}

/* ---- Pieces that touch in a point ---- */

static bool is_in_quarters(int32_t i, int32_t j) {
    return (i < 4) == (j < 4);
}

/* A ring with a face that reaches into its hole, and there, corner to corner with that, an island. */
static bool is_ring_or_island(int32_t i, int32_t j) {
    bool ring = i < 1 || j < 1 || i > 5 || j > 5, reaches = i == 4 && j == 5, island = i == 3 && (j == 3 || j == 4);
    return ring || reaches || island;
}

/* What `holes` frees of a border slides along it, in each piece its own way: what several pieces share stays, and nothing
 * leaves the surface. */
static void check_touching(bool (*is_in)(int32_t i, int32_t j), int32_t shared, skinslide_patch_setup choices) {
    test_mesh mesh = quad_grid(8, 8);
    int32_t faces[64], count = 0;
    for (int32_t f = 0; f < mesh.face_count; f++)
        if (is_in(f % 8, f / 8))
            faces[count++] = f;
    skinslide_patch_setup setup = setup_of(faces, count);
    setup.rule = choices.rule, setup.holes = choices.holes;
    float *points = random_pose(&mesh, 3), *slid = slide_setup(&mesh, points, &setup);
    double size = extent_of(points, mesh.vertex_count);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        assert_near(distance_to_mesh(&mesh, points, slid + 3 * v), 0, FLOAT_EPSILON * size);
    assert_same_bytes(slid + 3 * shared, points + 3 * shared, sizeof(float[3]));
    assert_true(largest_difference(slid, points, 3 * (int64_t)mesh.vertex_count) > 0.01);
    free(points), free(slid);
    free_mesh(&mesh);
}

static void what_pieces_share_stays(void **state) {
    (void)state;
    for (skinslide_rule rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++)
        for (int way = 0; way < (ss_has_plane(rule) ? 2 : 3); way++) {
            skinslide_patch_setup choices = {.rule = rule, .holes = (skinslide_holes)way};
            check_touching(is_in_quarters, 4 * 9 + 4, choices);
            if (way > 0)
                check_touching(is_ring_or_island, 5 * 9 + 4, choices);
        }
}

/* ---- What a set-up holds ---- */

/* Slides a pose with every other vertex held, those inside too, which are not meant: they slide as all others. */
static void check_held(const test_mesh *mesh, skinslide_patch_setup choices) {
    uint8_t *held = calloc((size_t)mesh->vertex_count, 1);
    rig plain = rig_of(mesh, choices);
    choices.held = held;
    rig none = rig_of(mesh, choices);
    for (int32_t v = 0; v < mesh->vertex_count; v += 2)
        held[v] = 1;
    rig own = rig_of(mesh, choices);
    float *pose = random_pose(mesh, 5), *as_before = slide_with(&plain, mesh, pose, NULL, NULL);
    float *unheld = slide_with(&none, mesh, pose, NULL, NULL), *slid = slide_with(&own, mesh, pose, NULL, NULL);
    assert_same_bytes(unheld, as_before, POINT_BYTES(mesh));
    const ss_patch *patch = own.slider->parts[0].patch, *free_patch = plain.slider->parts[0].patch;
    int32_t count = 0;
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        int32_t vertex = patch->mesh_vertex[v];
        bool is_held = held[vertex] && patch->vertex_loop[v] >= 0 && !free_patch->fixed[v];
        assert_int_equal(patch->fixed[v], free_patch->fixed[v] || is_held);
        if (patch->fixed[v])
            assert_same_bytes(slid + 3 * vertex, pose + 3 * vertex, sizeof(float[3]));
        count += is_held;
    }
    skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
    skinslide_error error;
    assert_ok(skinslide_slider_patch_info(own.slider, 0, &info, &error), &error);
    assert_int_equal(info.held_count, count);
    assert_true(count > 0 && largest_difference(slid, pose, 3 * (int64_t)mesh->vertex_count) > 0);
    free(pose), free(as_before), free(unheld), free(slid), free(held);
    free_rig(&plain), free_rig(&none), free_rig(&own);
}

static void what_is_held_of_free_borders_stays(void **state) {
    (void)state;
    test_mesh holes = grid_with_holes(false), grid = quad_grid(8, 6);
    for (skinslide_rule rule = SKINSLIDE_RULE_UNIT; rule <= SKINSLIDE_RULE_EVEN; rule++) {
        skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
        choices.rule = rule, choices.holes = SKINSLIDE_HOLES_FREE;
        check_held(&holes, choices);
        choices.holes = SKINSLIDE_HOLES_FREE_ALL;
        if (!ss_has_plane(rule))
            check_held(&grid, choices), check_held(&holes, choices);
    }
    free_mesh(&holes), free_mesh(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_slides_nothing),
        cmocka_unit_test(rest_slides_nothing_in_overlaps),
        cmocka_unit_test(what_is_not_free_keeps_its_bits),
        cmocka_unit_test(an_envelope_of_zero_slides_nothing),
        cmocka_unit_test(no_patches_slide_nothing),
        cmocka_unit_test(a_slide_by_hand),
        cmocka_unit_test(quarter_turns_commute_exactly),
        cmocka_unit_test(powers_of_two_commute_exactly),
        cmocka_unit_test(rigid_motion_commutes),
        cmocka_unit_test(far_from_the_origin_is_the_same),
        cmocka_unit_test(tiny_and_huge_meshes_slide_alike),
        cmocka_unit_test(nothing_folds_and_uv_stays_inside),
        cmocka_unit_test(slid_vertices_are_on_the_surface),
        cmocka_unit_test(sliding_lowers_stretch),
        cmocka_unit_test(points_may_be_slid_in_place),
        cmocka_unit_test(measuring_changes_no_point),
        cmocka_unit_test(overlaps_are_weighted_means),
        cmocka_unit_test(what_is_held_of_free_borders_stays),
        cmocka_unit_test(pieces_slide_as_if_alone),
        cmocka_unit_test(what_pieces_share_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
