/* Strain: poses whose stretches are known, of flat and of round meshes; against what the texture says of each corner. */
#include "skinslide/picture.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

typedef struct scene {
    test_mesh mesh;
    skinslide_mesh view;
    int32_t *faces;
    float *st, *pose;
    skinslide_strain out;
} scene;

/* A scene of a mesh with a pose of its own, whose st is turned by an angle against x and y. */
static scene scene_of(test_mesh mesh, double angle) {
    scene s = {.mesh = mesh, .faces = all_faces(&mesh), .pose = copy_points(&mesh)};
    size_t size = (size_t)mesh.vertex_count * sizeof(float);
    s.view = view_of(&s.mesh);
    s.st = malloc((size_t)mesh.index_count * sizeof(float[2]));
    s.out = (skinslide_strain){sizeof(skinslide_strain), malloc(size), malloc(size), malloc(size),
                               malloc((size_t)mesh.index_count * sizeof(float[2]))};
    for (int32_t c = 0; c < mesh.index_count; c++) {
        const float *p = mesh.points + 3 * mesh.face_indices[c];
        s.st[2 * c] = (float)(0.1 * (cos(angle) * p[0] - sin(angle) * p[1]));
        s.st[2 * c + 1] = (float)(0.1 * (sin(angle) * p[0] + cos(angle) * p[1]));
    }
    return s;
}

static void free_scene(scene *s) {
    free(s->out.largest), free(s->out.smallest), free(s->out.area_ratio), free(s->out.direction);
    free(s->st), free(s->pose), free(s->faces);
    free_mesh(&s->mesh);
}

static void measure(scene *s) {
    assert_ok(skinslide_measure_strain(&s->view, s->st, s->faces, s->mesh.face_count, s->pose, &s->out, &error), &error);
}

static void apply(scene *s, const double matrix[3][3]) {
    for (int32_t v = 0; v < s->mesh.vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += matrix[i][k] * s->mesh.points[3 * v + k];
            s->pose[3 * v + i] = (float)sum;
        }
}

/* Whatever a mesh is like, at rest stretches are 1, and moved and scaled as a whole they are the scale. */
static void a_scale_is_told_of_any_mesh(void **state) {
    (void)state;
    const double turn[3][3] = {{0, -1.7, 0}, {1.7, 0, 0}, {0, 0, 1.7}};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int moved = 0; moved < 2; moved++) {
            scene s = scene_of(make_fixture(i).mesh, 0);
            if (moved)
                apply(&s, turn);
            measure(&s);
            for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
                bool lies_flat = s.out.largest[v] == 1 && s.out.area_ratio[v] == 1; /* a vertex of no area, or at rest */
                if (moved && lies_flat)
                    continue;
                assert_near(s.out.largest[v], moved ? 1.7 : 1, 3e-3);
                assert_near(s.out.smallest[v], moved ? 1.7 : 1, 3e-3);
            }
            free_scene(&s);
        }
}

/* A sheet stretched by two factors along axes at an angle: these factors, their product, and in the texture the angle of the
 * larger one's axis less that by which the texture is turned. */
static void a_uniform_stretch_of_a_sheet(void **state) {
    (void)state;
    const double angles[4] = {0, 0.4, 1.2, 2.9}, turns[3] = {0, 0.5, -1}, factors[3][2] = {{1.6, 0.7}, {1.1, 1.05}, {0.9, 0.4}};
    for (int i = 0; i < 36; i++) {
        double angle = angles[i % 4], turn = turns[i / 4 % 3], large = factors[i / 12][0], small = factors[i / 12][1];
        double c = cos(angle), n = sin(angle);
        const double stretch[3][3] = {{large * c * c + small * n * n, (large - small) * c * n, 0},
                                      {(large - small) * c * n, large * n * n + small * c * c, 0},
                                      {0, 0, 1}};
        scene s = scene_of(quad_grid(5, 4), turn);
        apply(&s, stretch);
        measure(&s);
        for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
            assert_near(s.out.largest[v], large, 2e-6);
            assert_near(s.out.smallest[v], small, 2e-6);
            assert_near(s.out.area_ratio[v], large * small, 2e-6);
        }
        for (int32_t corner = 0; corner < s.mesh.index_count; corner++) {
            assert_near(s.out.direction[2 * corner], cos(2 * (angle + turn)), 2e-4);
            assert_near(s.out.direction[2 * corner + 1], sin(2 * (angle + turn)), 2e-4);
        }
        free_scene(&s);
    }
}

/* A tube that is drawn out along itself and grows thinner: along and round it, at each of its vertices, bent as it is. */
static void a_tube_drawn_out(void **state) {
    (void)state;
    test_mesh tube = annulus(24, 6);
    for (int32_t v = 0; v < tube.vertex_count; v++) {
        double angle = 2 * acos(-1) * (v % 24) / 24;
        tube.points[3 * v] = (float)cos(angle), tube.points[3 * v + 1] = (float)sin(angle);
        tube.points[3 * v + 2] = (float)(0.3 * (v / 24));
    }
    const double stretch[3][3] = {{0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 1.5}};
    scene s = scene_of(tube, 0);
    apply(&s, stretch);
    measure(&s);
    for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
        assert_near(s.out.largest[v], 1.5, 1e-5);
        assert_near(s.out.smallest[v], 0.8, 1e-5);
    }
    free_scene(&s);
}

/* In any pose the area ratio is the product, and the largest no less than the smallest. */
static void area_is_the_product(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        scene s = scene_of(make_fixture(i).mesh, 0.3);
        free(s.pose);
        s.pose = random_pose(&s.mesh, (uint64_t)i + 1);
        measure(&s);
        for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
            assert_true(s.out.largest[v] >= s.out.smallest[v] && s.out.smallest[v] >= 0);
            assert_near(s.out.area_ratio[v], (double)s.out.largest[v] * s.out.smallest[v], 1e-6 * s.out.area_ratio[v]);
        }
        for (int32_t c = 0; c < s.mesh.index_count; c++) {
            double length = hypot(s.out.direction[2 * c], s.out.direction[2 * c + 1]);
            assert_true(length == 0 || fabs(length - 1) < 1e-6);
        }
        free_scene(&s);
    }
}

/* Faces that are not given do not count; copies of a welded vertex have one strain, a vertex of no face given none. */
static void only_the_faces_count(void **state) {
    (void)state;
    scene s = scene_of(quad_grid(2, 1), 0); /* vertices 0 1 2 below, 3 4 5 above */
    int32_t left[1] = {0}, weld[6] = {0, 1, 1, 3, 4, 5};
    s.pose[3 * 2] = s.pose[3 * 5] = 4; /* the right one twice as wide again */
    assert_ok(skinslide_measure_strain(&s.view, s.st, left, 1, s.pose, &s.out, &error), &error);
    for (int32_t v = 0; v < 6; v++)
        assert_near(s.out.largest[v], 1, 1e-6);
    measure(&s);
    assert_near(s.out.largest[5], 3, 1e-6);
    assert_near(s.out.largest[4], sqrt((1 + 9) / 2.0), 1e-6); /* the mean of the tensors of both */
    s.view.weld = weld;
    measure(&s);
    assert_true(s.out.largest[1] == s.out.largest[2]);
    free_scene(&s);
}

static void bad_input(void **state) {
    (void)state;
    scene s = scene_of(quad_grid(2, 1), 0);
    int32_t none[1] = {2};
    assert_fails(skinslide_measure_strain(&s.view, NULL, s.faces, 2, s.pose, &s.out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "there is no st for the direction of strain");
    assert_fails(skinslide_measure_strain(&s.view, s.st, none, 1, s.pose, &s.out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "face 2 is not one of the mesh's 2");
    assert_fails(skinslide_measure_strain(&s.view, s.st, s.faces, 2, NULL, &s.out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no points, or no place for the strain");
    for (int32_t v = 0; v < 6; v++)
        s.mesh.points[3 * v] *= 1e-30f, s.mesh.points[3 * v + 1] *= 1e-30f, s.pose[3 * v] *= 1e30f;
    assert_fails(skinslide_measure_strain(&s.view, s.st, s.faces, 2, s.pose, &s.out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "stretch: vertex 0 is not finite: inf");
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scale_is_told_of_any_mesh),
        cmocka_unit_test(a_uniform_stretch_of_a_sheet),
        cmocka_unit_test(a_tube_drawn_out),
        cmocka_unit_test(area_is_the_product),
        cmocka_unit_test(only_the_faces_count),
        cmocka_unit_test(bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
