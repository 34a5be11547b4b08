/* How transforms above a mesh scale it: what is warned of, the map by which lengths are those in the world, and what
 * changes. */
#include "records.h"

#include <math.h>
#include <string.h>

static skinslide_error error;

typedef struct scene {
    test_mesh grid;
    skinslide_stage_mesh *mesh;
} scene;

static scene set_up(bool in_world) {
    scene s = {quad_grid(2, 2), NULL};
    s.mesh = scene_mesh(&s.grid);
    const uint8_t on = in_world;
    assert_ok(mesh_takes(s.mesh, "worldSpace", single_of("worldSpace", SKINSLIDE_VALUE_BOOL, &on), &error), &error);
    return s;
}

static void tear_down(scene *s) {
    skinslide_stage_mesh_destroy(s->mesh);
    free_mesh(&s->grid);
}

/* Scales along x, y and z, after a turn about z, before another and a move, all of any size. */
static void to_world(double turned, double x, double y, double z, double then, double out[16]) {
    const double scale[3] = {x, y, z}, a = cos(turned), b = sin(turned), c = cos(then), d = sin(then);
    const double first[3][3] = {{a, b, 0}, {-b, a, 0}, {0, 0, 1}}, last[3][3] = {{c, d, 0}, {-d, c, 0}, {0, 0, 1}};
    memset(out, 0, 16 * sizeof *out);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                out[4 * i + j] += first[i][k] * scale[k] * last[k][j];
    out[12] = 5, out[13] = -7, out[14] = 100, out[15] = 1;
}

static skinslide_status give(scene *s, double turned, double x, double y, double z, double frame) {
    double matrix[16];
    to_world(turned, x, y, z, 0.3 + frame, matrix);
    return skinslide_stage_mesh_space(s->mesh, matrix, frame, &error);
}

static void expect_warning(const scene *s, const char *text) {
    const char *said = skinslide_stage_mesh_space_warning(s->mesh);
    if (text)
        assert_string_equal(said, text);
    else
        assert_null(said);
}

static const double *space_of(const scene *s) {
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    assert_ok(skinslide_stage_mesh_get(s->mesh, &mesh, &error), &error);
    return mesh.space;
}

/* Turned either way, and mirrored. */
static void what_is_even_is_no_matter(void **state) {
    (void)state;
    scene s = set_up(false);
    assert_ok(give(&s, 0.7, 2, 2, 2, 1001), &error);
    assert_ok(give(&s, 0.7, -3, 3, 3, 1002), &error);
    assert_ok(give(&s, 0.1, 1, 1.005, 1, 1003), &error);
    assert_ok(give(&s, 0.1, 0, 0, 0, 1004), &error); /* hidden */
    expect_warning(&s, NULL);
    assert_null(space_of(&s));
    tear_down(&s);
}

static void what_is_not_even_is_warned_of(void **state) {
    (void)state;
    scene s = set_up(false);
    assert_ok(give(&s, 0.7, 2, 1, 1, 1001), &error);
    expect_warning(&s,
                   "the transforms above scale it 2 times as much one way as another: lengths are taken in its own space, and "
                   "in the world's with skinSlide:worldSpace = true");
    assert_ok(give(&s, 0.7, 1.5, 1, 1, 1002), &error);
    assert_ok(give(&s, 0.7, 1, 1, 0.25, 1003), &error);
    expect_warning(&s,
                   "the transforms above scale it 4 times as much one way as another, most at frame 1003: lengths are taken in "
                   "its own space, and in the world's with skinSlide:worldSpace = true");
    assert_null(space_of(&s));
    tear_down(&s);
}

/* For any vector, whatever else turns and moves the mesh. */
static void lengths_are_those_in_the_world(void **state) {
    (void)state;
    scene s = set_up(true);
    double matrix[16];
    to_world(0.7, 3, 1, 0.5, 0.3, matrix);
    assert_null(space_of(&s));
    assert_ok(skinslide_stage_mesh_space(s.mesh, matrix, 1001, &error), &error);
    const double *space = space_of(&s);
    assert_non_null(space);
    expect_warning(&s, NULL);
    dice d = {1};
    for (int i = 0; i < 100; i++) {
        double p[3], there[3] = {0}, here[3] = {0};
        for (int k = 0; k < 3; k++)
            p[k] = 2 * roll_share(&d) - 1;
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                there[j] += p[k] * matrix[4 * k + j], here[j] += p[k] * space[3 * k + j];
        assert_near(ss_length(here), ss_length(there), 1e-6);
    }
    tear_down(&s);
}

/* It may turn, move and grow: lengths stay those at first. */
static void the_shape_must_stay(void **state) {
    (void)state;
    scene s = set_up(true);
    assert_ok(give(&s, 0.7, 3, 1, 1, 1001), &error);
    assert_ok(give(&s, 0.7, 6, 2, 2, 1002), &error);
    assert_fails(
        give(&s, 0.7, 3, 1, 1.01, 1003), &error, SKINSLIDE_BAD_CONTROL,
        "skinSlide:worldSpace: the transforms above scale it otherwise at frame 1003 than at first; only their size may "
        "change");
    tear_down(&s);
}

static void ways_to_the_world_that_are_none(void **state) {
    (void)state;
    scene s = set_up(true);
    assert_fails(give(&s, 0.7, 1, 1, 0, 1001), &error, SKINSLIDE_BAD_CONTROL,
                 "skinSlide:worldSpace: the transforms above flatten it, so that it has no lengths in the world");
    tear_down(&s);
    s = set_up(true);
    assert_fails(give(&s, 0.7, NAN, 1, 1, 1001), &error, SKINSLIDE_BAD_CONTROL, "the way to the world is not finite");
    tear_down(&s);
    s = set_up(false);
    assert_ok(give(&s, 0.7, NAN, 1, 1, 1001), &error);
    assert_ok(give(&s, 0.7, 1, 1, 0, 1002), &error);
    expect_warning(
        &s, "the transforms above scale it 1e+06 times as much one way as another, most at frame 1002: lengths are taken "
            "in its own space, and in the world's with skinSlide:worldSpace = true");
    assert_fails(skinslide_stage_mesh_space(s.mesh, NULL, 1, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no mesh, or no way to the world");
    tear_down(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_even_is_no_matter),       cmocka_unit_test(what_is_not_even_is_warned_of),
        cmocka_unit_test(lengths_are_those_in_the_world),  cmocka_unit_test(the_shape_must_stay),
        cmocka_unit_test(ways_to_the_world_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
