/* Rest and the first pose of a cache: scales, other orders, and poses however far. */
#include "records.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* A sheet of quads: its first pose and rest, the same until they are changed. */
typedef struct scene {
    test_mesh grid;
    float *first, *rest;
    skinslide_stage_mesh *mesh;
    skinslide_stage_patch *patch;
    skinslide_stage_controls *controls;
    skinslide_status status; /* of the set-up, of which error tells */
} scene;

static scene set_up(void) {
    scene s = {.grid = quad_grid(12, 9)};
    s.first = malloc(POINT_BYTES(&s.grid)), s.rest = malloc(POINT_BYTES(&s.grid));
    memcpy(s.first, s.grid.points, POINT_BYTES(&s.grid));
    memcpy(s.rest, s.grid.points, POINT_BYTES(&s.grid));
    return s;
}

static skinslide_value points_of(const scene *s, const char *name, const float *points) {
    return array_of(name, SKINSLIDE_VALUE_FLOAT, 3, s->grid.vertex_count, points);
}

static void read(scene *s, bool compare) {
    s->mesh = scene_mesh(&s->grid);
    assert_ok(mesh_takes(s->mesh, "points", points_of(s, "points", s->first), &error), &error);
    assert_ok(mesh_takes(s->mesh, "restPoints", points_of(s, "skinSlide:restPoints", s->rest), &error), &error);
    assert_ok(mesh_takes(s->mesh, "compareRest",
                         compare ? nothing_of("skinSlide:compareRest") : NUMBER("skinSlide:compareRest", 0), &error),
              &error);
    s->patch = scene_patch(s->mesh, &s->grid, NULL);
    s->controls = scene_controls(s->patch);
    skinslide_patch_setup out = SKINSLIDE_PATCH_SETUP_DEFAULT;
    s->status = skinslide_stage_patch_get(s->patch, s->controls, &out, &error);
}

static void tear_down(scene *s) {
    skinslide_stage_controls_destroy(s->controls);
    skinslide_stage_patch_destroy(s->patch);
    skinslide_stage_mesh_destroy(s->mesh);
    free(s->first);
    free(s->rest);
    free_mesh(&s->grid);
}

/* Whatever the scale, rest comes out at the cache's: by the rounding of a quotient and of a product. */
static void another_scale_is_taken_out(void **state) {
    (void)state;
    static const double scales[] = {0.001, 0.0254, 0.01, 0.4, 2.54, 39.37, 1e6};
    for (int i = 0; i < 7; i++) {
        scene s = set_up();
        skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
        char text[128];
        for (int32_t k = 0; k < 3 * s.grid.vertex_count; k++)
            s.rest[k] = (float)(scales[i] * (double)s.grid.points[k]);
        read(&s, true);
        assert_ok(s.status, &error);
        snprintf(text, sizeof text, "rest is %.3g times the size of the cache: lengths are taken at that scale", scales[i]);
        assert_string_equal(skinslide_stage_mesh_warning(s.mesh), text);
        assert_null(skinslide_stage_patch_warning(s.patch));
        assert_ok(skinslide_stage_mesh_get(s.mesh, &out, &error), &error);
        for (int32_t k = 0; k < 3 * s.grid.vertex_count; k++)
            assert_near(out.rest_points[k], s.grid.points[k], 1e-5 * (1 + fabs((double)s.grid.points[k])));
        tear_down(&s);
    }
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double length_of(const float *points, int32_t a, int32_t b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double off = (double)points[3 * (int64_t)a + k] - (double)points[3 * (int64_t)b + k];
        sum += off * off;
    }
    return sqrt(sum);
}

/* The middle of the quotients of all sides, in order. */
static double middle_of(const scene *s) {
    double *quotients = malloc((size_t)s->grid.index_count * sizeof *quotients);
    for (int32_t c = 0; c < s->grid.index_count; c++) {
        int32_t a = s->grid.face_indices[c], b = s->grid.face_indices[c % 4 < 3 ? c + 1 : c - 3];
        quotients[c] = length_of(s->first, a, b) / length_of(s->rest, a, b);
    }
    qsort(quotients, (size_t)s->grid.index_count, sizeof *quotients, ascending);
    double middle = quotients[s->grid.index_count / 2];
    free(quotients);
    return middle;
}

/* Where no two edges agree, it is the scale of the one in the middle: that of one beside it is beyond the tolerance. */
static void the_scale_is_that_of_the_edge_in_the_middle(void **state) {
    (void)state;
    for (int i = 0; i < 5; i++) {
        scene s = set_up();
        skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
        for (int32_t k = 0; k < 3 * s.grid.vertex_count; k++)
            s.rest[k] = (float)(pow(7, i - 5) * ((double)s.grid.points[k] + 0.01 * sin(99.0 * k + i)));
        read(&s, true);
        assert_ok(s.status, &error);
        assert_non_null(skinslide_stage_mesh_warning(s.mesh));
        assert_ok(skinslide_stage_mesh_get(s.mesh, &out, &error), &error);
        double middle = middle_of(&s);
        for (int32_t k = 0; k < 3 * s.grid.vertex_count; k++)
            assert_near(out.rest_points[k], middle * (double)s.rest[k], 1e-6 * fabs((double)out.rest_points[k]));
        tear_down(&s);
    }
}

static void expect_untouched(scene *s) {
    skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
    assert_ok(s->status, &error);
    assert_null(skinslide_stage_mesh_warning(s->mesh));
    assert_null(skinslide_stage_patch_warning(s->patch));
    assert_ok(skinslide_stage_mesh_get(s->mesh, &out, &error), &error);
    assert_same_bytes(out.rest_points, s->rest, POINT_BYTES(&s->grid));
}

/* Growth by less than twice, a turn, and rest itself. */
static void poses_leave_rest_alone(void **state) {
    (void)state;
    for (int pose = 0; pose < 3; pose++) {
        scene s = set_up();
        for (int32_t v = 0; v < s.grid.vertex_count; v++) {
            float *at = s.rest + 3 * (int64_t)v, x = at[0], y = at[1];
            if (pose == 1)
                at[0] = 0.6f * x - 0.8f * y, at[1] = 0.8f * x + 0.6f * y;
            for (int k = 0; pose == 2 && k < 3; k++)
                at[k] *= 1.9f;
        }
        read(&s, true);
        expect_untouched(&s);
        tear_down(&s);
    }
}

/* Vertex v where (v * 47) % 130 was: neighbours are far apart. An option takes even that. */
static void another_order_is_refused(void **state) {
    (void)state;
    for (int compared = 0; compared < 2; compared++) {
        scene s = set_up();
        int32_t count = s.grid.vertex_count;
        for (int32_t v = 0; v < count; v++)
            memcpy(s.rest + 3 * (int64_t)v, s.grid.points + 3 * (int64_t)((v * 47) % count), sizeof(float[3]));
        read(&s, compared);
        assert_null(skinslide_stage_mesh_warning(s.mesh));
        if (!compared)
            expect_untouched(&s);
        else
            assert_fails(s.status, &error, SKINSLIDE_BAD_POINTS,
                         "rest is not that of the cache: lengths of edges differ by a factor of ...");
        tear_down(&s);
    }
}

/* Half of the edges, those that run one way, are longer. */
static void a_poor_likeness_is_told(void **state) {
    (void)state;
    scene s = set_up();
    for (int32_t v = 0; v < s.grid.vertex_count; v++)
        s.rest[3 * (int64_t)v] *= 2.5f;
    read(&s, true);
    assert_ok(s.status, &error);
    assert_null(skinslide_stage_mesh_warning(s.mesh));
    assert_non_null(strstr(skinslide_stage_patch_warning(s.patch), "lengths of edges differ by a factor of "));
    tear_down(&s);
}

/* Nothing follows from points that are not finite, or all in one place. */
static void what_has_no_length_tells_nothing(void **state) {
    (void)state;
    for (int nan = 0; nan < 2; nan++) {
        scene s = set_up();
        for (int32_t k = 0; k < 3 * s.grid.vertex_count; k++)
            s.first[k] = nan ? NAN : 1;
        read(&s, true);
        expect_untouched(&s);
        tear_down(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_scale_is_taken_out), cmocka_unit_test(the_scale_is_that_of_the_edge_in_the_middle),
        cmocka_unit_test(poses_leave_rest_alone),     cmocka_unit_test(another_order_is_refused),
        cmocka_unit_test(a_poor_likeness_is_told),    cmocka_unit_test(what_has_no_length_tells_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
