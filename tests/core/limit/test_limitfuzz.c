/* Limit surfaces of meshes that no one models: edges of many faces, vertices that join them, repeated corners, creases
 * anywhere. Whatever OpenSubdiv cannot take is refused before it is asked, and nothing else comes out than finite points. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_FACES = 15, MOST_SIZE = 7, MOST_VERTICES = 16, MOST_CREASES = 8, MOST_CORNERS = 2, PLACES = 4 };

typedef struct jumble {
    skinslide_mesh mesh;
    skinslide_subdivision own;
    float points[MOST_VERTICES][3];
    int32_t counts[MOST_FACES], indices[MOST_FACES * MOST_SIZE], starts[MOST_FACES];
    int32_t lengths[MOST_CREASES], creases[MOST_CREASES][2], corners[MOST_CORNERS], hole;
    float sharpnesses[MOST_CREASES], corner_sharpnesses[MOST_CORNERS];
} jumble;

static const float sharpness[] = {0, 0.5f, 1, 2.3f, 9.9f, 10, 20, INFINITY};

static bool repeats(const int32_t *face, int32_t count, int32_t vertex) {
    for (int32_t k = 0; k < count; k++)
        if (face[k] == vertex)
            return true;
    return false;
}

static void roll_face(jumble *j, dice *d, bool may_repeat, int32_t f) {
    bool loop = j->own.scheme == SKINSLIDE_SCHEME_LOOP;
    int32_t size = loop ? 3 : 3 + (roll_below(d, 3) ? roll_below(d, 2) : roll_below(d, MOST_SIZE - 2));
    int32_t *face = j->indices + j->mesh.index_count;
    for (int32_t k = 0; k < size; k++)
        for (int tries = 0; tries < 50; tries++) {
            face[k] = roll_below(d, j->mesh.vertex_count);
            if (may_repeat || !repeats(face, k, face[k]))
                break;
        }
    j->starts[f] = j->mesh.index_count;
    j->counts[f] = size;
    j->mesh.index_count += size;
}

static void roll_sharp(jumble *j, dice *d) {
    int32_t creases = roll_below(d, 2) ? roll_below(d, MOST_CREASES) : 0;
    for (int32_t i = 0; i < creases; i++) {
        int32_t f = roll_below(d, j->mesh.face_count), n = j->counts[f], k = roll_below(d, n);
        j->lengths[i] = 2;
        j->creases[i][0] = j->indices[j->starts[f] + k];
        j->creases[i][1] = j->indices[j->starts[f] + (k + 1) % n];
        j->sharpnesses[i] = sharpness[roll_below(d, 8)];
    }
    j->own.crease_count = j->own.crease_sharpness_count = creases, j->own.crease_index_count = 2 * creases;
    j->own.corner_count = roll_below(d, MOST_CORNERS + 1);
    for (int32_t i = 0; i < j->own.corner_count; i++) {
        j->corners[i] = roll_below(d, j->mesh.vertex_count);
        j->corner_sharpnesses[i] = sharpness[roll_below(d, 8)];
    }
    j->own.hole_count = roll_below(d, 4) == 0;
    j->hole = roll_below(d, j->mesh.face_count);
}

static void roll_jumble(jumble *j, uint64_t seed) {
    dice d = {seed};
    *j = (jumble){.mesh = SKINSLIDE_MESH_DEFAULT, .own = SKINSLIDE_SUBDIVISION_DEFAULT};
    j->mesh.vertex_count = 4 + roll_below(&d, MOST_VERTICES - 4), j->mesh.face_count = 1 + roll_below(&d, 14);
    j->own.scheme = (skinslide_scheme)(1 + roll_below(&d, 3));
    j->own.boundary_rule = (skinslide_boundary_rule)roll_below(&d, 3);
    j->own.triangle_rule = (skinslide_triangle_rule)roll_below(&d, 2);
    for (int32_t v = 0; v < MOST_VERTICES; v++)
        for (int k = 0; k < 3; k++)
            j->points[v][k] = (float)roll_between(&d, -1, 1);
    for (int32_t f = 0; f < j->mesh.face_count; f++)
        roll_face(j, &d, seed % 2, f);
    roll_sharp(j, &d);
    j->own.crease_lengths = j->lengths, j->own.crease_indices = j->creases[0], j->own.crease_sharpnesses = j->sharpnesses;
    j->own.corner_indices = j->corners, j->own.corner_sharpnesses = j->corner_sharpnesses, j->own.hole_indices = &j->hole;
    j->mesh.face_counts = j->counts, j->mesh.face_indices = j->indices, j->mesh.rest_points = j->points[0];
    j->mesh.subdivision = &j->own;
}

/* How many faces gave points. */
static int32_t evaluate_faces(const jumble *j) {
    int32_t evaluated = 0;
    for (int32_t f = 0; f < j->mesh.face_count; f++) {
        int32_t c = j->starts[f];
        const skinslide_limit_place places[PLACES] = {{c, 0, 0}, {c, 1, 0}, {c, 1, 1}, {c + 2, 0.3f, 0.7f}};
        float out[PLACES][3] = {{7}};
        skinslide_error error;
        if (skinslide_limit_points(&j->mesh, j->points[0], places, PLACES, out[0], &error)) {
            assert_true(out[0][0] == 7);
            continue;
        }
        for (int i = 0; i < PLACES * 3; i++)
            assert_true(isfinite((&out[0][0])[i]));
        evaluated++;
    }
    return evaluated;
}

static void make_sliders(const jumble *j) {
    for (int32_t f = 0; f < j->mesh.face_count; f++) {
        skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
        skinslide_slider *slider = NULL;
        skinslide_error error;
        setup.name = "face", setup.faces = &f, setup.face_count = 1;
        skinslide_slider_create(&j->mesh, &setup, 1, &slider, &error);
        skinslide_slider_destroy(slider);
    }
}

static void jumbles_give_points_or_are_refused(void **state) {
    (void)state;
    static jumble j;
    int32_t faces = 0, evaluated = 0;
    for (uint64_t seed = 0; seed < 3000; seed++) {
        roll_jumble(&j, seed);
        faces += j.mesh.face_count;
        evaluated += evaluate_faces(&j);
        if (seed % 8 == 0)
            make_sliders(&j);
    }
    print_message("%d of %d faces have a limit surface\n", evaluated, faces);
    assert_true(evaluated > faces / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(jumbles_give_points_or_are_refused)};
    return cmocka_run_group_tests_name("limitfuzz", tests, NULL, NULL);
}
