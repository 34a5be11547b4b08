/* A mesh that is split, at every corner or along a seam, slides as the mesh that it was split from, to the bit; what cannot be
 * one stays apart, and is named. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* ---- Split meshes ---- */

/* A mesh and what it was split from: copies of a vertex follow each other, so that welded vertices are in the order of the
 * whole's. */
typedef struct split_mesh {
    test_mesh mesh;
    int32_t *whole; /* [vertex_count] */
} split_mesh;

/* Faces of the same group share vertices, as many as there are groups; the last corners of a vertex's groups are its copies. */
static split_mesh split_by(const test_mesh *mesh, const int32_t *group, int32_t group_count) {
    split_mesh split = {.whole = calloc((size_t)mesh->index_count, sizeof(int32_t))};
    int32_t *indices = calloc((size_t)mesh->index_count, sizeof *indices), count = 0;
    int32_t *copy = calloc((size_t)group_count, sizeof *copy);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        for (int32_t g = 0; g < group_count; g++)
            copy[g] = -1;
        for (int32_t f = 0, c = 0; f < mesh->face_count; f++)
            for (int32_t end = c + mesh->face_counts[f]; c < end; c++) {
                if (mesh->face_indices[c] != v)
                    continue;
                if (copy[group[f]] < 0)
                    split.whole[count] = v, copy[group[f]] = count++;
                indices[c] = copy[group[f]];
            }
    }
    float *points = calloc(3 * (size_t)count, sizeof *points);
    for (int32_t v = 0; v < count; v++)
        memcpy(points + 3 * v, mesh->points + 3 * split.whole[v], sizeof(float[3]));
    split.mesh = copy_mesh(count, mesh->face_count, mesh->face_counts, indices, points);
    free(indices), free(points), free(copy);
    return split;
}

/* Every corner of every face has a point of its own, as in meshes of games. */
static split_mesh split_everywhere(const test_mesh *mesh) {
    int32_t *group = all_faces(mesh);
    split_mesh split = split_by(mesh, group, mesh->face_count);
    free(group);
    return split;
}

static void free_split(split_mesh *split) {
    free_mesh(&split->mesh);
    free(split->whole);
}

/* Points of the whole mesh as points of the split one. To be freed. */
static float *split_points(const split_mesh *split, const float *points) {
    float *own = calloc(3 * (size_t)split->mesh.vertex_count, sizeof *own);
    for (int32_t v = 0; v < split->mesh.vertex_count; v++)
        memcpy(own + 3 * v, points + 3 * split->whole[v], sizeof(float[3]));
    return own;
}

/* ---- Welding ---- */

/* What is one where every face of the mesh is of a patch, over rest and some poses: [vertex_count], to be freed. */
static int32_t *weld_all(const test_mesh *mesh, double tolerance, const float *const *poses, int32_t pose_count,
                         skinslide_weld_info *info) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh), *one = calloc((size_t)mesh->vertex_count + 1, sizeof *one);
    skinslide_patch_setup setup = setup_of(faces, mesh->face_count);
    skinslide_weld *weld;
    *info = (skinslide_weld_info)SKINSLIDE_WELD_INFO_DEFAULT;
    assert_ok(skinslide_weld_create(&view, &setup, 1, tolerance, &weld, &error), &error);
    for (int32_t i = 0; i < pose_count; i++)
        assert_ok(skinslide_weld_show(weld, 1001 + i, poses[i], &error), &error);
    assert_ok(skinslide_weld_get(weld, one, info, &error), &error);
    skinslide_weld_destroy(weld);
    free(faces);
    return one;
}

/* A rig of a welded mesh, all of it one patch. */
static rig rig_of_welded(const test_mesh *mesh, const int32_t *one, skinslide_patch_setup choices) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    rig r;
    view.weld = one;
    choices.size = sizeof choices, choices.name = "all", choices.faces = faces, choices.face_count = mesh->face_count;
    assert_ok(skinslide_slider_create(&view, &choices, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    free(faces);
    return r;
}

static void expect_alike(const split_mesh *split, const float *own, const float *whole) {
    for (int32_t v = 0; v < split->mesh.vertex_count; v++)
        assert_same_bytes(own + 3 * v, whole + 3 * split->whole[v], sizeof(float[3]));
}

/* Slides both meshes with the same choices: points, measures and counts are the same. */
static void expect_twins(const test_mesh *whole, const split_mesh *split, skinslide_patch_setup choices) {
    skinslide_weld_info info;
    skinslide_patch_result results[2] = {SKINSLIDE_PATCH_RESULT_DEFAULT, SKINSLIDE_PATCH_RESULT_DEFAULT};
    int32_t *one = weld_all(&split->mesh, 0, NULL, 0, &info);
    rig twin = rig_of(whole, choices), own = rig_of_welded(&split->mesh, one, choices);
    assert_int_equal(skinslide_slider_patch_count(own.slider), 1);
    float *pose = random_pose(whole, 7), *split_pose = split_points(split, pose);
    float *slid = slide_with(&twin, whole, pose, NULL, &results[0]);
    float *split_slid = slide_with(&own, &split->mesh, split_pose, NULL, &results[1]);
    expect_alike(split, split_slid, slid);
    assert_int_equal(results[0].slid_vertices, results[1].slid_vertices);
    assert_near(results[0].stretch_after, results[1].stretch_after, 0);
    assert_near(results[0].largest_slide, results[1].largest_slide, 0);
    free_rig(&twin), free_rig(&own);
    free(pose), free(split_pose), free(slid), free(split_slid), free(one);
}

/* Whether vertices of the mesh itself coincide, which splitting does not tell from copies. */
static bool is_in_one_place_twice(const test_mesh *mesh) {
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int32_t w = 0; w < v; w++)
            if (memcmp(mesh->points + 3 * v, mesh->points + 3 * w, sizeof(float[3])) == 0)
                return true;
    return false;
}

static void a_mesh_split_at_every_corner_is_its_twin(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        split_mesh split = split_everywhere(&f.mesh);
        bool apart = !is_in_one_place_twice(&f.mesh);
        for (int32_t way = 0; way < WAY_COUNT; way++) {
            skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
            if (apart && choose_way(&f, way, &choices))
                expect_twins(&f.mesh, &split, choices);
        }
        free_split(&split);
        free_mesh(&f.mesh);
    }
}

/* A seam that crosses the sheet, and one that ends inside it; the test below has a seam of one edge, of which only one end is
 * split. */
static void a_mesh_split_along_a_seam_is_its_twin(void **state) {
    (void)state;
    for (int32_t length = 2; length <= 8; length += 3) {
        test_mesh grid = quad_grid(8, 8);
        int32_t group[64];
        /* Faces left of the middle, in the first rows: the seam's last vertex has faces of both groups only over the row
         * above. */
        for (int32_t f = 0; f < 64; f++)
            group[f] = f / 8 < length && f % 8 < 4;
        split_mesh split = split_by(&grid, group, 2);
        assert_true(split.mesh.vertex_count > grid.vertex_count);
        expect_twins(&grid, &split, (skinslide_patch_setup){.rule = SKINSLIDE_RULE_EVEN});
        expect_twins(&grid, &split, (skinslide_patch_setup){.boundary = SKINSLIDE_BOUNDARY_SQUARE});
        free_split(&split);
        free_mesh(&grid);
    }
}

/* A seam of one edge inside a sheet: its first end is not split, its second is, at the border. */
static void a_seam_may_have_an_end_that_is_not_split(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2); /* the edge 1-4, whose faces are 0 and 1; 4 is inside */
    int32_t indices[16];
    float points[30];
    skinslide_weld_info info;
    memcpy(indices, grid.face_indices, sizeof indices);
    memcpy(points, grid.points, sizeof(float[27]));
    memcpy(points + 27, grid.points + 3, sizeof(float[3]));
    for (int32_t c = 4; c < 8; c++)
        indices[c] = indices[c] == 1 ? 9 : indices[c];
    test_mesh split = copy_mesh(10, 4, grid.face_counts, indices, points);
    int32_t *one = weld_all(&split, 0, NULL, 0, &info);
    for (int32_t v = 0; v < 9; v++)
        assert_int_equal(one[v], v);
    assert_int_equal(one[9], 1);
    assert_int_equal(info.welded_points, 2);
    assert_int_equal(info.welded_places, 1);
    free(one);
    free_mesh(&split), free_mesh(&grid);
}

/* ---- The limit surface ---- */

static rig subdivided_rig(const test_mesh *mesh, const int32_t *one, const skinslide_subdivision *own) {
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh->face_count);
    rig r;
    view.weld = one, view.subdivision = own;
    assert_ok(skinslide_slider_create(&view, &setup, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    free(faces);
    return r;
}

/* The surface of a mesh that is split is creased at its seam, which faces on either side reach as they do a border: that of the
 * whole with an infinitely sharp crease there. To rounding, since OpenSubdiv comes to the weights in other ways. */
static void the_limit_surface_is_that_of_the_split_mesh(void **state) {
    (void)state;
    static const int32_t length = 9, seam[] = {4, 13, 22, 31, 40, 49, 58, 67, 76};
    static const float sharp = 10;
    const skinslide_subdivision plain = {.size = sizeof plain, .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    skinslide_subdivision creased = plain;
    creased.crease_count = creased.crease_sharpness_count = 1, creased.crease_index_count = length;
    creased.crease_lengths = &length, creased.crease_indices = seam, creased.crease_sharpnesses = &sharp;
    test_mesh grid = quad_grid(8, 8);
    int32_t group[64];
    for (int32_t f = 0; f < 64; f++)
        group[f] = f % 8 < 4;
    split_mesh split = split_by(&grid, group, 2);
    skinslide_weld_info info;
    int32_t *one = weld_all(&split.mesh, 0, NULL, 0, &info);
    rig twin = subdivided_rig(&grid, NULL, &creased), own = subdivided_rig(&split.mesh, one, &plain);
    rig smooth = subdivided_rig(&grid, NULL, &plain);
    float *pose = bumped(&grid, 3, 4, 2, 2), *split_pose = split_points(&split, pose);
    float *slid = slide_with(&twin, &grid, pose, NULL, NULL), *smoothly = slide_with(&smooth, &grid, pose, NULL, NULL);
    float *split_slid = slide_with(&own, &split.mesh, split_pose, NULL, NULL), *expected = split_points(&split, slid);
    assert_true(largest_difference(slid, smoothly, 3 * 81) > 1e-3);
    assert_true(largest_difference(split_slid, expected, 3 * (int64_t)split.mesh.vertex_count) < 1e-6);
    for (int32_t v = 0; v < split.mesh.vertex_count; v++)
        assert_same_bytes(split_slid + 3 * v, split_slid + 3 * one[v], sizeof(float[3]));
    free(one), free(pose), free(split_pose), free(slid), free(smoothly), free(split_slid), free(expected);
    free_rig(&twin), free_rig(&own), free_rig(&smooth);
    free_split(&split);
    free_mesh(&grid);
}

/* ---- Normals ---- */

static float *turns_of(const rig *r, const test_mesh *mesh, const float *pose) {
    float *turns = calloc(3 * (size_t)mesh->vertex_count, sizeof *turns);
    free(slide_with(r, mesh, pose, NULL, NULL));
    assert_ok(skinslide_workspace_turns(r->workspace, pose, turns, &error), &error);
    return turns;
}

static void the_skin_turns_as_that_of_its_twin(void **state) {
    (void)state;
    test_mesh grid = quad_grid(8, 8);
    split_mesh split = split_everywhere(&grid);
    skinslide_weld_info info;
    int32_t *one = weld_all(&split.mesh, 0, NULL, 0, &info);
    rig twin = rig_of(&grid, (skinslide_patch_setup){0}), own = rig_of_welded(&split.mesh, one, (skinslide_patch_setup){0});
    float *pose = bumped(&grid, 4, 4, 2, 2), *split_pose = split_points(&split, pose);
    float *turns = turns_of(&twin, &grid, pose), *split_turns = turns_of(&own, &split.mesh, split_pose);
    assert_true(fabsf(turns[3 * 30]) > 1e-3);
    expect_alike(&split, split_turns, turns);
    free(one), free(pose), free(split_pose), free(turns), free(split_turns);
    free_rig(&twin), free_rig(&own);
    free_split(&split);
    free_mesh(&grid);
}

/* ---- Poses ---- */

/* A sheet of 6 x 4 faces that is cut along the row of vertices in its middle. */
static split_mesh lips(void) {
    test_mesh grid = quad_grid(6, 4);
    int32_t group[24];
    for (int32_t f = 0; f < 24; f++)
        group[f] = f / 6 < 2 ? 0 : 1;
    split_mesh split = split_by(&grid, group, 2);
    free_mesh(&grid);
    return split;
}

/* Opens lips in the middle of the cut: its corners are the second vertices from the ends. */
static float *opened(const split_mesh *split, double by) {
    float *pose = copy_points(&split->mesh);
    for (int32_t v = 1; v < split->mesh.vertex_count; v++)
        if (split->whole[v] == split->whole[v - 1] && split->whole[v] % 7 >= 2 && split->whole[v] % 7 <= 4)
            pose[3 * v + 1] += (float)by;
    return pose;
}

static void lips_that_open_are_not_one(void **state) {
    (void)state;
    split_mesh split = lips();
    float *open = opened(&split, 0.25);
    const float *closed_then_open[] = {split.mesh.points, open, split.mesh.points}, *open_first[] = {open, split.mesh.points};
    skinslide_weld_info info;
    int32_t *one = weld_all(&split.mesh, 0, NULL, 0, &info);
    assert_int_equal(info.welded_points, 14);
    assert_int_equal(info.welded_places, 7);
    assert_int_equal(info.parted_points, 0);
    free(one);
    one = weld_all(&split.mesh, 0, closed_then_open, 3, &info);
    assert_int_equal(info.welded_points, 8);
    assert_int_equal(info.parted_points, 3);
    assert_int_equal(split.whole[info.parted_from], 16);
    assert_int_equal(split.whole[info.parted_vertex], 16);
    assert_near(info.parted_frame, 1002, 0);
    for (int32_t v = 0; v < split.mesh.vertex_count; v++)
        assert_true(one[v] == v || split.whole[v] % 7 < 2 || split.whole[v] % 7 > 4);
    int32_t *other = weld_all(&split.mesh, 0, open_first, 2, &info);
    assert_same_bytes(one, other, (size_t)split.mesh.vertex_count * sizeof *one);
    free(one), free(other), free(open);
    free_split(&split);
}

/* ---- Tolerance ---- */

static void points_within_a_tolerance_go_the_same_way(void **state) {
    (void)state;
    test_mesh grid = quad_grid(8, 8);
    split_mesh split = split_everywhere(&grid);
    float *apart = shaken(&split.mesh, 3, 1e-4), *pose = bumped(&grid, 4, 4, 2, 2), *split_pose = split_points(&split, pose);
    memcpy(split.mesh.points, apart, POINT_BYTES(&split.mesh));
    skinslide_weld_info info;
    free(weld_all(&split.mesh, 1e-5, NULL, 0, &info));
    assert_true(info.welded_places < 20);
    int32_t *one = weld_all(&split.mesh, 4e-4, NULL, 0, &info); /* the diagonal of a box of 2e-4 */
    assert_int_equal(info.welded_places, 81 - 4);
    rig r = rig_of_welded(&split.mesh, one, (skinslide_patch_setup){.rule = SKINSLIDE_RULE_EVEN});
    float *slid = slide_with(&r, &split.mesh, split_pose, NULL, NULL);
    assert_true(largest_difference(slid, split_pose, 3 * (int64_t)split.mesh.vertex_count) > 0.01);
    for (int32_t v = 0; v < split.mesh.vertex_count; v++)
        assert_same_bytes(slid + 3 * v, slid + 3 * one[v], sizeof(float[3])); /* which were in one place in the pose */
    free_rig(&r);
    free(one), free(slid), free(apart), free(pose), free(split_pose);
    free_split(&split);
    free_mesh(&grid);
}

/* ---- What is not one ---- */

static void expect_refused(int32_t vertex_count, int32_t face_count, const int32_t *counts, const int32_t *indices,
                           const float *points, int32_t refused, const char *why) {
    test_mesh mesh = copy_mesh(vertex_count, face_count, counts, indices, points);
    skinslide_weld_info info;
    int32_t *one = weld_all(&mesh, 0, NULL, 0, &info);
    for (int32_t v = 0; v < vertex_count; v++)
        assert_int_equal(one[v], v);
    assert_int_equal(info.welded_points, 0);
    assert_int_equal(info.refused_points, refused);
    assert_string_equal(info.refused, why);
    free(one);
    free_mesh(&mesh);
}

static void a_doubled_sheet_stays_two(void **state) {
    (void)state;
    test_mesh front = quad_grid(3, 2), back = quad_grid(3, 2);
    for (int32_t f = 0; f < back.face_count; f++) {
        int32_t *corners = back.face_indices + 4 * f, second = corners[1];
        corners[1] = corners[3], corners[3] = second;
    }
    test_mesh both = join_meshes(&front, &back);
    expect_refused(24, 12, both.face_counts, both.face_indices, both.points, 16,
                   "edge 1-5 would have 4 faces"); /* all but the corners, which have no such edge, but only such neighbours */
    free_mesh(&front), free_mesh(&back), free_mesh(&both);
}

static void what_welding_would_break_is_named(void **state) {
    (void)state;
    const float strip[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0};
    const float fan[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0};
    expect_refused(8, 2, (int32_t[]){4, 4}, (int32_t[]){0, 1, 2, 3, 4, 7, 6, 5}, strip, 4,
                   "faces 0 and 1 are wound against each other along edge 1-2");
    expect_refused(4, 1, (int32_t[]){4}, (int32_t[]){0, 1, 2, 3}, fan, 2, "vertices 0 and 3 are both corners of face 0");
    expect_refused(8, 2, (int32_t[]){4, 4}, (int32_t[]){0, 1, 2, 3, 4, 5, 6, 7},
                   (float[]){0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 2, 2, 0, 1, 2, 0}, 0, "");
}

/* ---- Off the patches ---- */

/* A sheet, its lining, of the same points, and a patch of the sheet alone. */
static void points_off_the_patches_follow(void **state) {
    (void)state;
    test_mesh sheet = quad_grid(6, 6), both = join_meshes(&sheet, &sheet);
    skinslide_mesh view = view_of(&both);
    int32_t faces[36], one[98];
    for (int32_t f = 0; f < 36; f++)
        faces[f] = 36 + f;
    skinslide_patch_setup setup = setup_of(faces, 36);
    skinslide_weld_info info = SKINSLIDE_WELD_INFO_DEFAULT;
    skinslide_weld *weld;
    assert_ok(skinslide_weld_create(&view, &setup, 1, 0, &weld, &error), &error);
    assert_true(skinslide_weld_wants_poses(weld));
    assert_ok(skinslide_weld_get(weld, one, &info, &error), &error);
    for (int32_t v = 0; v < 98; v++)
        assert_int_equal(one[v], v < 49 ? v + 49 : v);
    view.weld = one;
    rig r, plain = rig_of(&sheet, (skinslide_patch_setup){0});
    assert_ok(skinslide_slider_create(&view, &setup, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    float *pose = bumped(&sheet, 3, 3, 2, 2), twice[294];
    memcpy(twice, pose, sizeof(float[147])), memcpy(twice + 147, pose, sizeof(float[147]));
    float *slid = slide_with(&r, &both, twice, NULL, NULL), *twin = slide_with(&plain, &sheet, pose, NULL, NULL);
    assert_same_bytes(slid, twin, sizeof(float[147]));
    assert_same_bytes(slid + 147, twin, sizeof(float[147]));
    skinslide_weld_destroy(weld);
    free_rig(&r), free_rig(&plain);
    free(pose), free(slid), free(twin);
    free_mesh(&sheet), free_mesh(&both);
}

/* A sheet, and another that goes on from its last column: they meet in five points, which stay unless the border is free. */
static void points_of_other_meshes_are_counted(void **state) {
    (void)state;
    test_mesh sheet = quad_grid(4, 4), beside = quad_grid(4, 4);
    for (int32_t v = 0; v < beside.vertex_count; v++)
        beside.points[3 * v] += 4;
    for (int all = 0; all < 2; all++) {
        skinslide_patch_setup choices = {.rule = SKINSLIDE_RULE_EVEN,
                                         .holes = all ? SKINSLIDE_HOLES_FREE_ALL : SKINSLIDE_HOLES_PINNED};
        rig r = rig_of(&sheet, choices);
        skinslide_neighbours met = SKINSLIDE_NEIGHBOURS_DEFAULT;
        assert_ok(skinslide_slider_neighbours(r.slider, 0, sheet.points, beside.points, 25, 0, &met, &error), &error);
        assert_int_equal(met.held, all ? 0 : 5);
        assert_int_equal(met.loose, all ? 5 : 0);
        assert_ok(skinslide_slider_neighbours(r.slider, 0, sheet.points, sheet.points, 25, 0, &met, &error), &error);
        assert_int_equal(met.held + met.loose, 25);
        assert_ok(skinslide_slider_neighbours(r.slider, 0, sheet.points, beside.points, 0, 0, &met, &error), &error);
        assert_int_equal(met.held + met.loose, 0);
        assert_fails(skinslide_slider_neighbours(r.slider, 0, sheet.points, NULL, 25, 0, &met, &error), &error,
                     SKINSLIDE_BAD_ARGUMENT, "no points of the other mesh");
        assert_fails(skinslide_slider_neighbours(r.slider, 0, sheet.points, beside.points, 25, -1, &met, &error), &error,
                     SKINSLIDE_BAD_ARGUMENT, "tolerance -1, and 25 points of the other mesh");
        free_rig(&r);
    }
    free_mesh(&sheet), free_mesh(&beside);
}

/* A pose says nothing about points that share their place with no other, and may not be finite there; where one that shares its
 * place is not finite, the pose is refused. */
static void faults_are_named_where_they_are_looked_at(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 4);
    split_mesh split = split_everywhere(&grid);
    skinslide_mesh view = view_of(&split.mesh);
    int32_t *faces = all_faces(&split.mesh);
    skinslide_patch_setup setup = setup_of(faces, split.mesh.face_count);
    skinslide_weld *weld;
    assert_ok(skinslide_weld_create(&view, &setup, 1, 0, &weld, &error), &error);
    float *pose = copy_points(&split.mesh);
    pose[3 * 0] = NAN; /* the corner of the grid, of one face */
    assert_ok(skinslide_weld_show(weld, 1, pose, &error), &error);
    pose[3 * 1] = NAN;
    assert_fails(skinslide_weld_show(weld, 1, pose, &error), &error, SKINSLIDE_BAD_POINTS,
                 "points: vertex 1 is not finite: (nan, 0, 0)");
    skinslide_weld_destroy(weld);
    free(pose), free(faces);
    free_split(&split), free_mesh(&grid);
}

/* ---- Bad input ---- */

static void bad_input_is_named(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 4);
    skinslide_mesh view = view_of(&grid);
    int32_t one[20];
    skinslide_weld *weld = NULL;
    assert_fails(skinslide_weld_create(&view, NULL, 0, -1, &weld, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "weld: the tolerance is -1; it must be 0 to 0.005, a thousandth of the size of the mesh");
    assert_fails(skinslide_weld_create(&view, NULL, 0, 0.0051, &weld, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "weld: the tolerance is 0.0051; ...");
    assert_fails(skinslide_weld_create(&view, NULL, 0, NAN, &weld, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "weld: the tolerance is nan; ...");
    assert_fails(skinslide_weld_create(&view, NULL, 1, 0, &weld, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no place ...");
    assert_null(weld);
    int32_t unwritten[4] = {-1, 9, 9, 9}; /* the place for an answer, say */
    view.weld = unwritten;
    assert_ok(skinslide_weld_create(&view, NULL, 0, 0.005, &weld, &error), &error);
    assert_false(skinslide_weld_wants_poses(weld));
    float *pose = copy_points(&grid);
    pose[7] = NAN;
    assert_ok(skinslide_weld_show(weld, 1, pose, &error), &error); /* no point that shares its place */
    assert_fails(skinslide_weld_show(weld, 1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no points");
    assert_fails(skinslide_weld_get(weld, NULL, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no weld...");
    assert_ok(skinslide_weld_get(weld, one, NULL, &error), &error);
    skinslide_weld_destroy(weld);
    skinslide_weld_destroy(NULL);
    assert_false(skinslide_weld_wants_poses(NULL));
    skinslide_slider *slider = NULL;
    view.weld = one, one[3] = 20;
    assert_fails(skinslide_slider_create(&view, NULL, 0, &slider, &error), &error, SKINSLIDE_BAD_MESH,
                 "weld: vertex 3 is one with 20, which is none or is one with another");
    one[3] = 2, one[2] = 1;
    assert_fails(skinslide_slider_create(&view, NULL, 0, &slider, &error), &error, SKINSLIDE_BAD_MESH,
                 "weld: vertex 3 is one with 2, which is none or is one with another");
    assert_null(slider);
    free(pose);
    free_mesh(&grid);
}

/* As it is found without leaving out those that are far away: places of all points at once, on a lattice that is coarse enough
 * to be shared, with some that are nowhere. */
static void points_that_others_meet(void **state) {
    (void)state;
    enum { OWN = 40, OTHERS = 60, ALL = OWN + OTHERS };
    dice d = {1};
    int32_t met_count = 0;
    for (int round = 0; round < 100; round++) {
        float all[3 * ALL];
        for (int i = 0; i < 3 * ALL; i++)
            all[i] = (float)roll_below(&d, 4) + (i < 3 * OWN ? 0 : (float)roll_below(&d, 3)) + 0.01f * (float)roll_below(&d, 2);
        for (int i = 0; i < 3; i++)
            all[3 * roll_below(&d, ALL)] = i ? INFINITY : NAN;
        float finite[3 * ALL];
        int32_t number[ALL], place[ALL], count = 0;
        uint8_t expected[OWN] = {0}, met[OWN], other[ALL] = {0};
        for (int v = 0; v < ALL; v++)
            if (isfinite(all[3 * v]))
                memcpy(finite + 3 * count, all + 3 * v, sizeof(float[3])), number[count++] = v;
        double tolerance = round % 2 ? 0.012 : 0;
        assert_true(ss_find_places(finite, tolerance, count, place));
        for (int i = 0; i < count; i++)
            other[place[i]] |= number[i] >= OWN;
        for (int i = 0; i < count && number[i] < OWN; i++)
            expected[number[i]] = other[place[i]], met_count += other[place[i]];
        assert_true(ss_find_met(all, OWN, all + 3 * OWN, OTHERS, tolerance, met));
        assert_same_bytes(met, expected, sizeof met);
    }
    assert_in_range(met_count, 200, 3500);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_that_others_meet),
        cmocka_unit_test(a_mesh_split_at_every_corner_is_its_twin),
        cmocka_unit_test(a_mesh_split_along_a_seam_is_its_twin),
        cmocka_unit_test(a_seam_may_have_an_end_that_is_not_split),
        cmocka_unit_test(the_limit_surface_is_that_of_the_split_mesh),
        cmocka_unit_test(the_skin_turns_as_that_of_its_twin),
        cmocka_unit_test(lips_that_open_are_not_one),
        cmocka_unit_test(points_within_a_tolerance_go_the_same_way),
        cmocka_unit_test(a_doubled_sheet_stays_two),
        cmocka_unit_test(what_welding_would_break_is_named),
        cmocka_unit_test(points_off_the_patches_follow),
        cmocka_unit_test(points_of_other_meshes_are_counted),
        cmocka_unit_test(faults_are_named_where_they_are_looked_at),
        cmocka_unit_test(bad_input_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
