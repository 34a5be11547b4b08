/* Walks whose direction depends on the place alone. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

typedef struct walk_scene {
    ss_memory memory;
    test_mesh mesh;
    ss_patch *patch;
    ss_ground ground;
} walk_scene;

static walk_scene scene_of(test_mesh mesh) {
    walk_scene s = {.mesh = mesh};
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.rule = SKINSLIDE_RULE_EVEN;
    s.patch = patch_of(&mesh, choices);
    assert_true(ss_ground_allocate(&s.memory, s.patch, &s.ground));
    ss_ground_set(&s.ground, mesh.points);
    return s;
}

static void free_scene(walk_scene *s) {
    ss_free(&s->memory);
    ss_patch_destroy(s->patch);
    free_mesh(&s->mesh);
}

/* A vector as a way along the tangents of a vertex. */
static double walk_along(const walk_scene *s, int32_t vertex, const double vector[3], ss_meter *meter, ss_place *place) {
    double way[2];
    for (int j = 0; j < 2; j++)
        way[j] = ss_dot(vector, s->ground.tangent[vertex][j]);
    return ss_walk_turned(&s->ground, vertex, way, meter, place);
}

/* In a flat sheet a walk ends at its vector's end, to rounding in each of some triangles, or on the border. */
static void straight_in_a_plane(void **state) {
    (void)state;
    walk_scene s = scene_of(triangle_grid(9, 9));
    dice d = {3};
    for (int i = 0; i < 200; i++) {
        double way[3] = {roll_between(&d, -3, 3), roll_between(&d, -3, 3), 0}, end[3];
        int32_t v = 10 * (3 + roll_below(&d, 4)) + 3 + roll_below(&d, 4);
        ss_place place;
        assert_near(walk_along(&s, v, way, NULL, &place), 1, 0);
        ss_place_point(&s.ground.pose, &place, end);
        for (int k = 0; k < 3; k++)
            assert_near(end[k], s.ground.pose.point[v][k] + way[k], 1e-13);
    }
    ss_place place;
    assert_near(walk_along(&s, 44, (double[3]){10, 0, 0}, NULL, &place), 0.5, 1e-12); /* from x = 4 to 9 */
    free_scene(&s);
}

/* The same from anywhere in a face, by what of the vector is in the plane. */
static void straight_from_a_place(void **state) {
    (void)state;
    walk_scene s = scene_of(triangle_grid(9, 9));
    dice d = {4};
    for (int i = 0; i < 200; i++) {
        double way[3] = {roll_between(&d, -2, 2), roll_between(&d, -2, 2), 5}, begin[3], end[3], first = roll_share(&d);
        int32_t v = 10 * (3 + roll_below(&d, 3)) + 3 + roll_below(&d, 3);
        ss_place place = ss_place_of_vertex(s.patch, NULL, v);
        double second = i % 2 ? 0 : (1 - first) * roll_share(&d); /* 0: on a side */
        ss_place_put(&place, place.triangle, (double[3]){1 - first - second, first, second});
        ss_place_point(&s.ground.pose, &place, begin);
        ss_walk_turned_from(&s.ground, way, &place);
        ss_place_point(&s.ground.pose, &place, end);
        for (int k = 0; k < 2; k++)
            assert_near(end[k], begin[k] + way[k], 1e-13);
    }
    free_scene(&s);
}

/* A way of no length ends at the vertex itself, exactly; a meter ends a walk at its limit. */
static void nothing_and_a_meter(void **state) {
    (void)state;
    walk_scene s = scene_of(torus(9, 7));
    ss_place place;
    ss_meter meter = {&s.ground.pose, 0, 0.25};
    assert_near(walk_along(&s, 20, (double[3]){0, 0, 0}, NULL, &place), 1, 0);
    assert_int_equal(s.patch->triangles.vertex[place.triangle][ss_place_corner(&place)], 20);
    double *normal = s.ground.normal[20], way[3] = {0, 0, 0}, axis[3] = {0.3, -0.5, 0.8};
    ss_cross(normal, axis, way);
    double part = walk_along(&s, 20, way, &meter, &place);
    assert_near(meter.walked, 0.25, 0);
    assert_near(part * ss_length(way), 0.25, 1e-12);
    free_scene(&s);
}

/* If a walk comes to the end of its meter, walked is exactly the limit, whatever sums were rounded to: else callers could not
 * tell. */
static void a_meter_ends_at_its_limit(void **state) {
    (void)state;
    walk_scene s = scene_of(triangle_grid(3, 3));
    dice d = {7};
    const double rates[3] = {-1e3, 1e3, 0};
    for (int i = 0; i < 1000; i++) {
        ss_meter meter = {&s.ground.pose, roll_between(&d, 0, 0.5), roll_between(&d, 1, 2)};
        assert_true(ss_measure(&meter, 0, rates, 1) < 1);
        assert_near(meter.walked, meter.limit, 0);
    }
    free_scene(&s);
}

/* Weights stay a place's on every fixture, however long the walk. */
static void places_stay_places(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        walk_scene s = scene_of(make_fixture(i).mesh);
        dice d = {(uint64_t)i};
        for (int n = 0; n < 100; n++) {
            int32_t v = roll_below(&d, s.patch->vertex_count);
            double axis[3] = {roll_between(&d, -9, 9), roll_between(&d, -9, 9), roll_between(&d, -9, 9)}, way[3];
            ss_place place;
            ss_cross(s.ground.normal[v], axis, way);
            double part = walk_along(&s, v, way, NULL, &place);
            assert_true(part >= 0 && part <= 1);
            assert_near(place.weight[0] + place.weight[1] + place.weight[2], 1, 1e-15);
            for (int k = 0; k < 3; k++)
                assert_true(place.weight[k] >= 0);
        }
        free_scene(&s);
    }
}

static bool is_inside(const walk_scene *s, const ss_place *place, int32_t vertex) {
    const int32_t *v = s->patch->triangles.vertex[place->triangle];
    const double *weight = place->weight, least = ss_least(weight[0], ss_least(weight[1], weight[2]));
    return (v[0] == vertex || v[1] == vertex || v[2] == vertex) && least > 1e-12;
}

/* Inside its first triangle a walk ends as far as its way is long, however that triangle lies to the normal of the vertex. */
static void first_triangles_keep_lengths(void **state) {
    (void)state;
    int inside = 0;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        walk_scene s = scene_of(make_fixture(i).mesh);
        dice d = {(uint64_t)i};
        for (int n = 0; n < 100; n++) {
            int32_t v = roll_below(&d, s.patch->vertex_count);
            double way[2] = {roll_between(&d, -1e-3, 1e-3), roll_between(&d, -1e-3, 1e-3)}, end[3];
            ss_place place;
            ss_walk_turned(&s.ground, v, way, NULL, &place);
            if (!is_inside(&s, &place, v))
                continue;
            ss_place_point(&s.ground.pose, &place, end);
            ss_subtract(end, s.ground.pose.point[v], end);
            assert_near(ss_length(end) / hypot(way[0], way[1]), 1, 1e-9);
            inside++;
        }
        free_scene(&s);
    }
    assert_true(inside > 50 * FIXTURE_COUNT);
}

/* On a fine tube a walk round it stays at its height: the direction turns with the surface. */
static void walks_go_round(void **state) {
    (void)state;
    walk_scene s = scene_of(finger(24, 8));
    for (int32_t v = 24 * 3; v < 24 * 5; v++) {
        double *normal = s.ground.normal[v], up[3] = {0, 0, 1}, way[3], end[3];
        ss_place place;
        ss_cross(up, normal, way);
        assert_near(walk_along(&s, v, way, NULL, &place), 1, 1e-12);
        ss_place_point(&s.ground.pose, &place, end);
        assert_near(end[2], s.ground.pose.point[v][2], 0.02);
    }
    free_scene(&s);
}

/* Several walks in turn are each as alone, to the bit, and leave of their ways what they walked. */
static void several_as_alone(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        walk_scene s = scene_of(make_fixture(i).mesh);
        dice d = {(uint64_t)i};
        int32_t count = s.patch->vertex_count, *vertices = calloc((size_t)count, sizeof *vertices);
        double(*way)[2] = calloc((size_t)count, sizeof *way), (*cut)[2] = calloc((size_t)count, sizeof *cut);
        ss_place *places = calloc((size_t)count, sizeof *places);
        for (int32_t v = 0; v < count; v++) {
            vertices[v] = count - 1 - v;
            for (int j = 0; j < 2; j++)
                way[v][j] = cut[v][j] = roll_below(&d, 8) ? roll_between(&d, -3, 3) * s.patch->mean_edge : 0;
        }
        ss_walk_turned_all(&s.ground, count, vertices, cut, places);
        for (int32_t v = 0; v < count; v++) {
            ss_place place = {0};
            double part = ss_walk_turned(&s.ground, v, way[v], NULL, &place);
            assert_memory_equal(&place.triangle, &places[v].triangle, sizeof place.triangle);
            assert_memory_equal(place.weight, places[v].weight, sizeof place.weight);
            for (int j = 0; j < 2; j++)
                assert_true(cut[v][j] == (part < 1 ? part * way[v][j] : way[v][j]));
        }
        free(vertices), free(way), free(cut), free(places);
        free_scene(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_in_a_plane), cmocka_unit_test(straight_from_a_place),
        cmocka_unit_test(nothing_and_a_meter), cmocka_unit_test(a_meter_ends_at_its_limit),
        cmocka_unit_test(places_stay_places),  cmocka_unit_test(walks_go_round),
        cmocka_unit_test(several_as_alone),    cmocka_unit_test(first_triangles_keep_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
