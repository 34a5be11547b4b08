/* Limit surfaces: against uniform refinement, across sides, and what cannot be one. */
#include "creases.h"
#include "queries.h"
#include "refined.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 5 };

/* ---- Meshes ---- */

static test_mesh nth_mesh(int32_t i) {
    switch (i) {
    case 0:
        return quad_grid(5, 4);
    case 1:
        return cube();
    case 2:
        return torus(12, 7);
    case 3:
        return brick_wall(5, 4);
    case 4:
        return triangle_grid(5, 4);
    case 5:
        return octahedron();
    case 6:
        return grid_with_holes(false);
    case 7:
        return finger(6, 4);
    default:
        return random_disk((uint64_t)i, 40);
    }
}

enum { MESH_COUNT = 16 };

static bool only_triangles(const test_mesh *mesh) {
    for (int32_t f = 0; f < mesh->face_count; f++)
        if (mesh->face_counts[f] != 3)
            return false;
    return true;
}

/* ---- Two implementations ---- */

static int32_t compared, refused; /* meshes, since a test began */

static void begin_counting(void) {
    compared = refused = 0;
}

/* Creases at a boundary are refused on some meshes; most are compared all the same. */
static void assert_most_compared(void) {
    print_message("%d compared, %d refused\n", compared, refused);
    assert_true(compared > refused);
}

/* Corners, middles of sides and middles of faces: the core's evaluation, and refinement, which has no vertex in the middle of a
 * loop triangle. Only rounding to float parts them but at corners, next to which a patch may stand for infinitely many. */
static void compare(const test_mesh *mesh, const skinslide_subdivision *subdivision, double at_corners) {
    skinslide_mesh view = view_of(mesh);
    view.subdivision = subdivision;
    size_t count = 3 * (size_t)mesh->index_count;
    skinslide_limit_place *places = malloc(count * sizeof *places);
    float(*got)[3] = malloc(count * sizeof *got);
    double(*refined)[3][3] = malloc((size_t)mesh->index_count * sizeof *refined);
    bool loop = subdivision->scheme == SKINSLIDE_SCHEME_LOOP;
    for (int32_t c = 0; c < mesh->index_count; c++) {
        places[3 * c] = (skinslide_limit_place){c, 0, 0};
        places[3 * c + 1] = (skinslide_limit_place){c, 1, 0};
        places[3 * c + 2] = loop ? places[3 * c] : (skinslide_limit_place){c, 1, 1};
    }
    skinslide_error error;
    skinslide_status status = skinslide_limit_points(&view, mesh->points, places, (int32_t)count, &got[0][0], &error);
    refused += status == SKINSLIDE_UNSUPPORTED, compared += status == SKINSLIDE_OK;
    if (status == SKINSLIDE_UNSUPPORTED) { /* named below */
        free(places), free(got), free(refined);
        return;
    }
    assert_ok(status, &error);
    refine_to_limit(&view, mesh->points, LEVELS, refined);
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_near(got[i][axis], refined[i / 3][i % 3][axis],
                        i % 3 == 0 || (loop && i % 3 == 2) ? at_corners : 1e-6 * extent_of(mesh->points, mesh->vertex_count));
    free(places), free(got), free(refined);
}

static void each_mesh(void (*check)(const test_mesh *mesh, skinslide_scheme scheme, int32_t i)) {
    for (int32_t i = 0; i < MESH_COUNT; i++) {
        test_mesh mesh = nth_mesh(i);
        check(&mesh, SKINSLIDE_SCHEME_CATMULL_CLARK, i);
        check(&mesh, SKINSLIDE_SCHEME_BILINEAR, i);
        if (only_triangles(&mesh))
            check(&mesh, SKINSLIDE_SCHEME_LOOP, i);
        free_mesh(&mesh);
    }
}

static double extent(const test_mesh *mesh) {
    return extent_of(mesh->points, mesh->vertex_count);
}

/* Seen at corners: 3.4e-4 of the mesh on random disks, rounding on all others. */
static void check_smooth(const test_mesh *mesh, skinslide_scheme scheme, int32_t i) {
    skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = scheme};
    compare(mesh, &own, (i < 8 ? 1e-6 : 1e-3) * extent(mesh));
    own.triangle_rule = SKINSLIDE_TRIANGLE_RULE_SMOOTH;
    compare(mesh, &own, (i < 8 ? 1e-6 : 1e-3) * extent(mesh));
    own.boundary_rule = SKINSLIDE_BOUNDARY_RULE_EDGE_ONLY;
    compare(mesh, &own, (i < 8 ? 1e-6 : 1e-3) * extent(mesh));
}

static void stencils_match_a_refined_mesh(void **state) {
    (void)state;
    begin_counting();
    each_mesh(check_smooth);
    assert_most_compared();
    assert_int_equal(refused, 0);
}

/* Seen at corners: 2.9e-3 of the mesh, where creases of several sharpnesses meet. */
static void check_creased(const test_mesh *mesh, skinslide_scheme scheme, int32_t i) {
    creased c = crease_at_random(mesh, scheme, (uint64_t)i + 1);
    compare(mesh, &c.own, 5e-3 * extent(mesh));
    free_creased(&c);
}

static void creases_match_a_refined_mesh(void **state) {
    (void)state;
    begin_counting();
    each_mesh(check_creased);
    assert_most_compared();
}

/* Weights sum to one, so every affine map commutes with the limit. */
static void check_affine(const test_mesh *mesh, skinslide_scheme scheme, int32_t i) {
    creased c = crease_at_random(mesh, scheme, (uint64_t)i);
    skinslide_mesh view = view_of(mesh);
    view.subdivision = &c.own;
    dice d = {(uint64_t)i};
    skinslide_limit_place places[64];
    float before[64][3], after[64][3], *mapped = copy_points(mesh);
    double map[3][4];
    for (int k = 0; k < 12; k++)
        (&map[0][0])[k] = roll_between(&d, -2, 2);
    for (int k = 0; k < 64; k++)
        places[k] = (skinslide_limit_place){roll_below(&d, mesh->index_count), (float)roll_share(&d), (float)roll_share(&d)};
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            const float *p = mesh->points + 3 * v;
            mapped[3 * v + k] = (float)(map[k][0] * p[0] + map[k][1] * p[1] + map[k][2] * p[2] + map[k][3]);
        }
    skinslide_error error;
    skinslide_status status = skinslide_limit_points(&view, mesh->points, places, 64, &before[0][0], &error);
    if (!status)
        status = skinslide_limit_points(&view, mapped, places, 64, &after[0][0], &error);
    refused += status == SKINSLIDE_UNSUPPORTED, compared += status == SKINSLIDE_OK;
    if (status != SKINSLIDE_UNSUPPORTED)
        assert_ok(status, &error);
    for (int i2 = 0; i2 < 64 && !status; i2++)
        for (int k = 0; k < 3; k++) {
            const float *p = before[i2];
            assert_near(after[i2][k], map[k][0] * p[0] + map[k][1] * p[1] + map[k][2] * p[2] + map[k][3],
                        1e-5 * (1 + extent(mesh)));
        }
    free(mapped);
    free_creased(&c);
}

static void affine_maps_commute(void **state) {
    (void)state;
    begin_counting();
    each_mesh(check_affine);
    assert_most_compared();
}

/* ---- Parameters ---- */

static double point_distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

typedef struct surfaces_of_patch {
    ss_patch *patch;
    ss_limit_surfaces *surfaces;
    float *points;
    double (*uv)[2], *scratch;
    bool loop;
} surfaces_of_patch;

static surfaces_of_patch surfaces_for(const test_mesh *mesh, const skinslide_subdivision *own, uint64_t seed) {
    surfaces_of_patch s = {.patch = patch_of(mesh, setup_of(NULL, 0)), .loop = own->scheme == SKINSLIDE_SCHEME_LOOP};
    skinslide_mesh view = view_of(mesh);
    view.subdivision = own;
    ss_topology *topology;
    skinslide_error error;
    assert_ok(ss_check_subdivision(&view, &error), &error);
    assert_ok(ss_topology_create(&view, &topology, &error), &error);
    assert_ok(ss_limit_surfaces_create(topology, s.patch->mesh_face, mesh->face_count, "all", &s.surfaces, &error), &error);
    ss_topology_destroy(topology);
    s.points = random_pose(mesh, seed);
    s.uv = embedding_of(s.patch, mesh->points, s.points);
    s.scratch = malloc((size_t)ss_limit_surfaces_scratch(s.surfaces) * sizeof *s.scratch);
    return s;
}

static void free_surfaces(surfaces_of_patch *s) {
    ss_limit_surfaces_destroy(s->surfaces);
    ss_patch_destroy(s->patch);
    free(s->points), free(s->uv), free(s->scratch);
}

static void point_at(const surfaces_of_patch *s, const ss_place *place, double out[3]) {
    const double origin[3] = {0, 0, 0};
    ss_parameter at = ss_parametrise(s->patch, s->loop, &(ss_flat){(const double(*)[2])s->uv, NULL}, place);
    int32_t face = s->patch->triangles.face[place->triangle];
    ss_limit_prepare(s->surfaces, face, s->points, origin, s->scratch);
    ss_limit_point(s->surfaces, face, &at, s->scratch, out);
}

/* A point of a side is the same from both faces, whatever polygons they are. Fitted patches meet along curves that agree to
 * 2e-3 of the mesh. */
static void check_sides(const test_mesh *mesh, skinslide_scheme scheme, int32_t i) {
    skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = scheme};
    if (i == 1 || i == 2 || i == 5) /* closed: no patch */
        return;
    surfaces_of_patch s = surfaces_for(mesh, &own, 3);
    const ss_faces *faces = &s.patch->faces;
    double size = extent_of(s.points, mesh->vertex_count);
    dice d = {(uint64_t)i};
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t twin = faces->corner_twin[c];
        if (twin < 0)
            continue;
        double share = roll_share(&d), p[2], here[3], there[3];
        const double(*uv)[2] = (const double(*)[2])s.uv, *a = s.uv[faces->corner_vertex[c]],
              *b = s.uv[faces->corner_vertex[twin]];
        for (int k = 0; k < 2; k++)
            p[k] = a[k] + share * (b[k] - a[k]);
        ss_place from = place_at(s.patch, uv, ss_triangle_of_side(s.patch, c), p);
        ss_place to = place_at(s.patch, uv, ss_triangle_of_side(s.patch, twin), p);
        point_at(&s, &from, here), point_at(&s, &to, there);
        assert_near(point_distance(here, there), 0, 2e-3 * size);
    }
    free_surfaces(&s);
}

static void surfaces_meet_along_sides(void **state) {
    (void)state;
    each_mesh(check_sides);
}

/* Corners go to corners, and middles to middles, exactly at the parameters that the face has there. */
static void check_corners(const test_mesh *mesh, skinslide_scheme scheme, int32_t i) {
    skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = scheme};
    if (i == 1 || i == 2 || i == 5)
        return;
    surfaces_of_patch s = surfaces_for(mesh, &own, 4);
    const ss_faces *faces = &s.patch->faces;
    const double origin[3] = {0, 0, 0};
    double size = extent_of(s.points, mesh->vertex_count);
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t face = faces->corner_face[c];
        const double *p = s.uv[faces->corner_vertex[c]];
        ss_place place = place_at(s.patch, (const double(*)[2])s.uv, ss_triangle_of_side(s.patch, c), p);
        double got[3], expected[3];
        point_at(&s, &place, got);
        ss_parameter corner = ss_limit_parameter(s.surfaces, face, c - faces->face_start[face], 0, 0);
        ss_limit_point(s.surfaces, face, &corner, s.scratch, expected);
        assert_near(point_distance(got, expected), 0, 1e-6 * size);
        (void)origin;
    }
    free_surfaces(&s);
}

static void corners_are_found_at_corners(void **state) {
    (void)state;
    each_mesh(check_corners);
}

/* Bilinear in a quad, by hand: the quad (0,0) (4,0) (2,2) (0,2) at s = 1/2, t = 1/2 is the mean of its corners, (1.5, 1). */
static void a_quad_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(1, 1);
    ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
    const double uv[4][2] = {{0, 0}, {4, 0}, {0, 2}, {2, 2}}; /* vertices of the grid: 0 1 over 2 3, the face 0 1 3 2 */
    ss_place place = place_at(patch, uv, 0, (double[2]){1.5, 1});
    ss_parameter at = ss_parametrise(patch, false, &(ss_flat){uv, NULL}, &place);
    assert_int_equal(at.corner, -1);
    assert_near(at.st[0], 0.5, 1e-15);
    assert_near(at.st[1], 0.5, 1e-15);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* A face of no area and one that is not convex still give parameters within 0..1. */
static void awkward_faces_give_parameters(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(1, 1);
    ss_patch *patch = patch_of(&mesh, setup_of(NULL, 0));
    const double shapes[4][4][2] = {{{0, 0}, {1, 0}, {3, 0}, {2, 0}},
                                    {{1, 1}, {1, 1}, {1, 1}, {1, 1}},
                                    {{0, 0}, {1, 0}, {0, 1}, {0.1, 0.1}},
                                    {{0, 0}, {1, 0}, {0, 1e-14}, {1, 1e-14}}};
    dice d = {1};
    for (int shape = 0; shape < 4; shape++)
        for (int i = 0; i < 100; i++) {
            const double p[2] = {roll_share(&d), shape == 3 ? 0 : roll_share(&d)};
            ss_place place = place_at(patch, shapes[shape], i % 2, p);
            ss_parameter at = ss_parametrise(patch, false, &(ss_flat){shapes[shape], NULL}, &place);
            assert_true(at.st[0] >= 0 && at.st[0] <= 1 && at.st[1] >= 0 && at.st[1] <= 1);
        }
    ss_patch_destroy(patch);
    free_mesh(&mesh);
}

/* ---- Which faces have one ---- */

/* As a place on each of them says: those with holes, and at boundaries that are interpolated or not. */
static void faces_with_a_surface(void **state) {
    (void)state;
    const int32_t holes[2] = {1, 6};
    skinslide_error error;
    for (int32_t i = 0; i < MESH_COUNT; i++)
        for (int rule = SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER; rule <= SKINSLIDE_BOUNDARY_RULE_NONE; rule++) {
            test_mesh mesh = nth_mesh(i);
            skinslide_mesh view = view_of(&mesh);
            skinslide_subdivision own = {sizeof own, .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
            uint8_t *has = malloc((size_t)mesh.face_count);
            own.boundary_rule = (skinslide_boundary_rule)rule, own.hole_count = mesh.face_count > 6 ? 2 : 1;
            own.hole_indices = holes, view.subdivision = &own;
            assert_ok(skinslide_limit_faces(&view, has, &error), &error);
            assert_int_equal(has[1], 0);
            for (int32_t f = 0, c = 0; f < mesh.face_count; c += mesh.face_counts[f++]) {
                float out[3];
                const skinslide_limit_place place = {c, 0.5f, 0.5f};
                skinslide_status status = skinslide_limit_points(&view, mesh.points, &place, 1, out, &error);
                assert_int_equal(has[f], status == SKINSLIDE_OK);
                assert_true(!status || status == SKINSLIDE_BAD_PATCH || status == SKINSLIDE_UNSUPPORTED);
            }
            free(has);
            free_mesh(&mesh);
        }
}

static void faces_that_nobody_asks_for(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    skinslide_mesh view = view_of(&mesh);
    uint8_t has[4] = {7, 7, 7, 7};
    skinslide_error error;
    assert_fails(skinslide_limit_faces(&view, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no place for the faces");
    assert_fails(skinslide_limit_faces(&view, has, &error), &error, SKINSLIDE_BAD_MESH,
                 "the mesh is not subdivided: it has no limit surface");
    assert_int_equal(has[0], 7);
    free_mesh(&mesh);
}

/* ---- Bad input ---- */

static void expect_bad(const skinslide_subdivision *own, skinslide_status expected, const char *text) {
    test_mesh mesh = quad_grid(3, 3);
    skinslide_mesh view = view_of(&mesh);
    view.subdivision = own;
    const skinslide_limit_place place = {0, 0, 0};
    float out[3];
    skinslide_error error;
    assert_fails(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error, expected, text);
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
    skinslide_slider *slider = NULL;
    if (expected != SKINSLIDE_BAD_PATCH)
        assert_fails(skinslide_slider_create(&view, &setup, 1, &slider, &error), &error, expected, text);
    setup.interpolation = SKINSLIDE_INTERPOLATION_LINEAR; /* which needs no limit surface */
    assert_ok(skinslide_slider_create(&view, &setup, 1, &slider, &error), &error);
    skinslide_slider_destroy(slider);
    free(faces);
    free_mesh(&mesh);
}

#define CC .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK

static void bad_subdivisions_are_named(void **state) {
    (void)state;
    const int32_t edge[2] = {0, 1}, diagonal[3] = {0, 1, 6}, outside[2] = {0, 16}, lengths[2] = {2, 1}, three[1] = {3};
    const float one[1] = {1}, negative[1] = {-1}, nan[1] = {NAN}, two[2] = {1, 1};
    const int32_t hole[1] = {9}, first[1] = {0};
#define CREASE(...)                                                                                                            \
    &(skinslide_subdivision){sizeof(skinslide_subdivision),                                                                    \
                             CC,                                                                                               \
                             .crease_count = 1,                                                                                \
                             .crease_lengths = lengths,                                                                        \
                             .crease_index_count = 2,                                                                          \
                             .crease_indices = edge,                                                                           \
                             .crease_sharpness_count = 1,                                                                      \
                             .crease_sharpnesses = one,                                                                        \
                             __VA_ARGS__}
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init"
    expect_bad(CREASE(.crease_lengths = three, .crease_index_count = 3, .crease_indices = diagonal), SKINSLIDE_BAD_MESH,
               "crease 0: 1-6 is not an edge of the mesh");
    expect_bad(CREASE(.crease_indices = outside), SKINSLIDE_BAD_MESH, "crease indices: 16 is not one of the mesh's 16");
    expect_bad(CREASE(.crease_sharpnesses = negative), SKINSLIDE_BAD_MESH, "crease sharpness 0 is -1; it must be 0 or more");
    expect_bad(CREASE(.crease_sharpnesses = nan), SKINSLIDE_BAD_MESH, "crease sharpness 0 is ...");
    expect_bad(CREASE(.crease_count = 2, .crease_index_count = 3), SKINSLIDE_BAD_MESH,
               "crease 1 has 1 vertices; a crease has 2 or more");
    expect_bad(CREASE(.crease_index_count = 3), SKINSLIDE_BAD_MESH,
               "crease lengths add up to 2, but there are 3 crease indices");
    expect_bad(CREASE(.crease_sharpness_count = 2, .crease_sharpnesses = two), SKINSLIDE_BAD_MESH,
               "2 crease sharpnesses fit neither 1 creases nor their 1 edges");
    expect_bad(CREASE(.crease_lengths = NULL), SKINSLIDE_BAD_ARGUMENT, "no array of crease lengths...");
    expect_bad(CREASE(.crease_indices = NULL), SKINSLIDE_BAD_ARGUMENT, "no array of crease indices...");
    expect_bad(CREASE(.crease_sharpnesses = NULL), SKINSLIDE_BAD_ARGUMENT, "no array of crease sharpnesses...");
    expect_bad(CREASE(.corner_count = 1, .corner_indices = three, .corner_sharpnesses = negative), SKINSLIDE_BAD_MESH,
               "corner sharpness 0 is -1; it must be 0 or more");
    expect_bad(CREASE(.corner_count = 1, .corner_indices = outside + 1, .corner_sharpnesses = one), SKINSLIDE_BAD_MESH,
               "corner indices: 16 is not one of the mesh's 16");
    expect_bad(CREASE(.hole_count = 1, .hole_indices = hole), SKINSLIDE_BAD_MESH, "hole indices: 9 is not one of the mesh's 9");
    expect_bad(CREASE(.hole_count = 1, .hole_indices = first), SKINSLIDE_BAD_PATCH,
               "limit points: face 0 has no limit surface: it is one of holeIndices");
    expect_bad(
        CREASE(.boundary_rule = SKINSLIDE_BOUNDARY_RULE_NONE), SKINSLIDE_BAD_PATCH,
        "limit points: face 0 has no limit surface: interpolateBoundary none leaves the faces at the boundary of the...");
    expect_bad(CREASE(.scheme = SKINSLIDE_SCHEME_LOOP), SKINSLIDE_BAD_MESH,
               "face 0 has 4 vertices; the loop scheme needs triangles");
    expect_bad(CREASE(.scheme = (skinslide_scheme)7), SKINSLIDE_BAD_ARGUMENT, "no such subdivision scheme...");
#pragma GCC diagnostic pop
}

static void bad_places_are_named(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    skinslide_mesh view = view_of(&mesh);
    skinslide_subdivision own = {sizeof(skinslide_subdivision), CC};
    float out[3];
    skinslide_error error;
    skinslide_limit_place place = {16, 0, 0};
    assert_fails(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error, SKINSLIDE_BAD_MESH,
                 "the mesh is not subdivided: it has no limit surface");
    view.subdivision = &own;
    assert_fails(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "place 0 is not on the mesh: corner 16, (0, 0)");
    place = (skinslide_limit_place){0, 1.5f, 0};
    assert_fails(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "place 0 is not on the mesh: corner 0, (1.5, 0)");
    assert_fails(skinslide_limit_points(&view, mesh.points, NULL, 1, out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no places, or no room for their points");
    assert_ok(skinslide_limit_points(&view, mesh.points, NULL, 0, NULL, &error), &error);
    free_mesh(&mesh);
}

/* Faces of no size and repeated vertices elsewhere in the mesh: the one is refused, the other OpenSubdiv takes. */
static void faces_that_cannot_be_subdivided(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    skinslide_mesh view = view_of(&mesh);
    skinslide_subdivision own = {sizeof(skinslide_subdivision), CC};
    const skinslide_limit_place place = {0, 0, 0};
    float out[3];
    skinslide_error error;
    view.subdivision = &own;
    mesh.face_counts[2] = 2, mesh.face_counts[3] = 6;
    assert_fails(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error, SKINSLIDE_BAD_MESH,
                 "face 2 has 2 vertices; a face that is subdivided has 3 to 65535");
    mesh.face_counts[2] = mesh.face_counts[3] = 4;
    mesh.face_indices[15] = mesh.face_indices[14];
    assert_ok(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error);
    free_mesh(&mesh);
}

/* A grid of 2 x 1 quads with a vertex added in its inner side, which then has two faces around it, and a crease there. */
static void what_crashes_opensubdiv_is_refused(void **state) {
    (void)state;
    static const float points[7][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 0.5f, 0}};
    static const int32_t counts[2] = {5, 5}, indices[10] = {0, 1, 6, 4, 3, 1, 2, 5, 4, 6};
    static const int32_t lengths[1] = {2}, crease[2] = {1, 6};
    static const float sharpness[1] = {2};
    test_mesh mesh = copy_mesh(7, 2, counts, indices, &points[0][0]);
    skinslide_mesh view = view_of(&mesh);
    skinslide_subdivision own = {sizeof(skinslide_subdivision), CC};
    const skinslide_limit_place place = {0, 0, 0};
    float out[3];
    skinslide_error error;
    view.subdivision = &own;
    assert_ok(skinslide_limit_points(&view, mesh.points, &place, 1, out, &error), &error);
    own.crease_count = own.crease_sharpness_count = 1, own.crease_index_count = 2;
    own.crease_lengths = lengths, own.crease_indices = crease, own.crease_sharpnesses = sharpness;
    skinslide_status status = skinslide_limit_points(&view, mesh.points, &place, 1, out, &error);
    if (status) /* by OpenSubdiv 3.5.1 and later it is not */
        assert_fails(status, &error, SKINSLIDE_UNSUPPORTED,
                     "limit points: face 0 has a crease, the mesh's boundary and a vertex of two faces; OpenSubdiv...");
    free_mesh(&mesh);
}

/* The time grows with the cube of the faces around a vertex, or the vertices of a face: the most there may be are taken, and
 * what has more is named. A bilinear surface has no such vertices. */
static void expect_crowd(const test_mesh *mesh, skinslide_scheme scheme, skinslide_status expected, const char *text) {
    skinslide_mesh view = view_of(mesh);
    skinslide_subdivision own = SKINSLIDE_SUBDIVISION_DEFAULT;
    own.scheme = scheme, view.subdivision = &own;
    const skinslide_limit_place place = {mesh->index_count - 1, 0.5f, 0.25f}; /* of the last face */
    float out[3];
    skinslide_error error;
    skinslide_status status = skinslide_limit_points(&view, mesh->points, &place, 1, out, &error);
    if (expected)
        assert_fails(status, &error, expected, text);
    else
        assert_ok(status, &error);
}

static void crowds_are_refused(void **state) {
    (void)state;
    test_mesh most = finger(256, 2), more = finger(257, 2), face = polygon(257);
    expect_crowd(&most, SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_OK, NULL);
    expect_crowd(&more, SKINSLIDE_SCHEME_BILINEAR, SKINSLIDE_OK, NULL);
    expect_crowd(&more, SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_UNSUPPORTED,
                 "limit points: vertex 771 has 257 faces; limit surfaces are made for 256 at most");
    expect_crowd(&face, SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_UNSUPPORTED,
                 "limit points: face 0 has 257 vertices; limit surfaces are made for 256 at most");
    free_mesh(&most), free_mesh(&more), free_mesh(&face);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stencils_match_a_refined_mesh),
        cmocka_unit_test(creases_match_a_refined_mesh),
        cmocka_unit_test(affine_maps_commute),
        cmocka_unit_test(surfaces_meet_along_sides),
        cmocka_unit_test(corners_are_found_at_corners),
        cmocka_unit_test(a_quad_by_hand),
        cmocka_unit_test(awkward_faces_give_parameters),
        cmocka_unit_test(faces_with_a_surface),
        cmocka_unit_test(faces_that_nobody_asks_for),
        cmocka_unit_test(bad_subdivisions_are_named),
        cmocka_unit_test(bad_places_are_named),
        cmocka_unit_test(faces_that_cannot_be_subdivided),
        cmocka_unit_test(what_crashes_opensubdiv_is_refused),
        cmocka_unit_test(crowds_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
