/* Vectors that turn as the skin under them. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

static int32_t element_count(const test_mesh *mesh, int layout) {
    return layout == SKINSLIDE_NORMALS_VERTEX    ? mesh->vertex_count
           : layout == SKINSLIDE_NORMALS_UNIFORM ? mesh->face_count
                                                 : mesh->index_count;
}

static float *random_vectors(dice *d, int32_t count) {
    float *vectors = malloc((size_t)count * sizeof(float[3]));
    for (int32_t i = 0; i < 3 * count; i++)
        vectors[i] = (float)roll_between(d, -2, 2);
    return vectors;
}

static void carry(const test_mesh *mesh, const float *turns, int layout, float *vectors) {
    skinslide_mesh view = view_of(mesh);
    view.rest_points = NULL; /* not read */
    assert_ok(skinslide_carry(&view, turns, (skinslide_normals_layout)layout, vectors, &error), &error);
}

/* Where nothing turns, vectors keep their bits, whatever they are. */
static void no_turn_keeps_bits(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int layout = SKINSLIDE_NORMALS_VERTEX; layout <= SKINSLIDE_NORMALS_UNIFORM; layout++) {
            fixture f = make_fixture(i);
            int32_t count = element_count(&f.mesh, layout);
            dice d = {7};
            float *turns = calloc((size_t)f.mesh.vertex_count, sizeof(float[3]));
            float *vectors = random_vectors(&d, count), *before = malloc((size_t)count * sizeof(float[3]));
            vectors[0] = NAN, vectors[1] = -0.0f, vectors[2] = FLT_MAX;
            memcpy(before, vectors, (size_t)count * sizeof(float[3]));
            carry(&f.mesh, turns, layout, vectors);
            assert_same_bytes(vectors, before, (size_t)count * sizeof(float[3]));
            free(turns), free(vectors), free(before);
            free_mesh(&f.mesh);
        }
}

static void roll_unit(dice *d, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = roll_between(d, -1, 1);
    ss_normalise(out);
}

/* The least rotation takes the one normal to the other, what is across both stays, and lengths and angles do. A turn is told as
 * floats, whose rounding grows towards half a circle; these are of 150 degrees at most. */
static void the_least_rotation(void **state) {
    (void)state;
    test_mesh mesh = polygon(3);
    dice d = {1};
    for (int i = 0; i < 500; i++) {
        double from[3], to[3], across[3], turn[3];
        roll_unit(&d, from), roll_unit(&d, to);
        if (ss_dot(from, to) < cos(150 * acos(-1) / 180))
            continue;
        ss_cross(from, to, across);
        ss_least_turn(from, to, turn);
        float turns[9], vectors[9];
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < 3; k++)
                turns[3 * v + k] = (float)turn[k];
        for (int k = 0; k < 3; k++)
            vectors[k] = (float)from[k], vectors[3 + k] = (float)across[k], vectors[6 + k] = (float)(3 * from[k] + across[k]);
        carry(&mesh, turns, SKINSLIDE_NORMALS_VERTEX, vectors);
        for (int k = 0; k < 3; k++) {
            assert_near((double)vectors[k], to[k], 1e-6);
            assert_near((double)vectors[3 + k], across[k], 1e-6);
            assert_near((double)vectors[6 + k], 3 * to[k] + across[k], 3e-6);
        }
    }
    free_mesh(&mesh);
}

/* There is no least rotation to the opposite direction, and none from a zero vector. */
static void without_a_rotation(void **state) {
    (void)state;
    const double up[3] = {0, 0, 1}, down[3] = {0, 0, -1}, nothing[3] = {0, 0, 0};
    const double *pairs[][2] = {{up, down}, {up, up}, {nothing, up}, {up, nothing}, {nothing, nothing}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        double turn[3];
        ss_least_turn(pairs[i][0], pairs[i][1], turn);
        for (int k = 0; k < 3; k++)
            assert_near(turn[k], 0, 0);
    }
}

/* Two unit quads side by side, 0 1 4 3 and 1 2 5 4; vertex 1 turns by 90 degrees about x, so y goes to z. Its corners are 1 of
 * the first face and 0 of the second. Each face has the mean of its four turns: a fourth of sin 45. */
static void layouts_by_hand(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 1);
    float turns[18] = {0}, vectors[24];
    turns[3] = (float)sqrt(0.5);
    for (int layout = SKINSLIDE_NORMALS_VERTEX; layout <= SKINSLIDE_NORMALS_UNIFORM; layout++) {
        double share = layout == SKINSLIDE_NORMALS_UNIFORM ? 2 * asin(sqrt(0.5) / 4) : acos(0);
        for (int i = 0; i < 24; i++)
            vectors[i] = i % 3 == 1;
        carry(&mesh, turns, layout, vectors);
        for (int32_t e = 0; e < element_count(&mesh, layout); e++) {
            bool turned = layout == SKINSLIDE_NORMALS_UNIFORM || (layout == SKINSLIDE_NORMALS_VERTEX && e == 1) ||
                          (layout == SKINSLIDE_NORMALS_FACE_VARYING && mesh.face_indices[e] == 1);
            assert_near((double)vectors[3 * e], 0, 0);
            assert_near((double)vectors[3 * e + 1], turned ? cos(share) : 1, turned ? 1e-7 : 0);
            assert_near((double)vectors[3 * e + 2], turned ? sin(share) : 0, turned ? 1e-7 : 0);
        }
    }
    free_mesh(&mesh);
}

/* Doubles are carried as floats are, to the rounding of floats. */
static void doubles_as_floats(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(3, 3);
    skinslide_mesh view = view_of(&mesh);
    dice d = {2};
    float *turns = random_vectors(&d, mesh.vertex_count), *floats = random_vectors(&d, mesh.index_count);
    double *doubles = malloc(3 * (size_t)mesh.index_count * sizeof *doubles);
    for (int32_t i = 0; i < 3 * mesh.vertex_count; i++)
        turns[i] /= 4;
    for (int32_t i = 0; i < 3 * mesh.index_count; i++)
        doubles[i] = (double)floats[i];
    assert_ok(ss_carry(&view, turns, SKINSLIDE_NORMALS_FACE_VARYING, (ss_vectors){NULL, doubles}, &error), &error);
    carry(&mesh, turns, SKINSLIDE_NORMALS_FACE_VARYING, floats);
    for (int32_t i = 0; i < 3 * mesh.index_count; i++)
        assert_true((float)doubles[i] == floats[i]);
    free(turns), free(floats), free(doubles);
    free_mesh(&mesh);
}

static void what_cannot_be_carried(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 1);
    skinslide_mesh view = view_of(&mesh);
    float turns[18] = {0}, vectors[24] = {0}, before[24];
    const char *text = "no turns or vectors, or no such layout of them";
    assert_fails(skinslide_carry(&view, NULL, SKINSLIDE_NORMALS_VERTEX, vectors, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_carry(&view, turns, SKINSLIDE_NORMALS_VERTEX, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, text);
    assert_fails(skinslide_carry(&view, turns, (skinslide_normals_layout)3, vectors, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 text);
    turns[3] = turns[6] = 0.5f, vectors[3] = 1, vectors[6] = FLT_MAX, vectors[9] = FLT_MAX; /* the last does not turn */
    memcpy(before, vectors, sizeof before);
    assert_fails(skinslide_carry(&view, turns, SKINSLIDE_NORMALS_VERTEX, vectors, &error), &error, SKINSLIDE_BAD_POINTS,
                 "vector 2 is too long to be carried: (3.40282e+38, 0, 0)");
    assert_same_bytes(vectors, before, sizeof before);
    mesh.face_indices[4] = 6;
    assert_fails(skinslide_carry(&view, turns, SKINSLIDE_NORMALS_VERTEX, vectors, &error), &error, SKINSLIDE_BAD_MESH,
                 "face 1 has vertex 6, but the mesh has 6 vertices");
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_turn_keeps_bits), cmocka_unit_test(the_least_rotation), cmocka_unit_test(without_a_rotation),
        cmocka_unit_test(layouts_by_hand),    cmocka_unit_test(doubles_as_floats),  cmocka_unit_test(what_cannot_be_carried),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
