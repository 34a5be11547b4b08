/* Maps drawn in texture coordinates: texels against barycentric coordinates in double, dilation against the rule applied on the
 * host, tiles, order, faces without a texel, devices that fail. */
#include "faults.h"
#include "map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* A mesh whose vertices lie in the texture where they lie in space, and what a map of it is drawn from. */
typedef struct scene {
    test_mesh mesh;
    skinslide_mesh view;
    int32_t *faces;
    float *st, *values;
    skinslide_charts charts;
} scene;

static void read_points(scene *s) {
    for (int32_t c = 0; c < s->mesh.index_count; c++)
        for (int k = 0; k < 2; k++)
            s->st[2 * c + k] = s->mesh.points[3 * s->mesh.face_indices[c] + k];
}

static void fill_scene(scene *s, test_mesh mesh, uint64_t seed) {
    dice d = {seed};
    *s = (scene){.mesh = mesh, .view = view_of(&mesh), .faces = all_faces(&mesh)};
    s->view.rest_points = NULL;
    s->st = malloc((size_t)mesh.index_count * sizeof(float[2]));
    s->values = malloc((size_t)mesh.vertex_count * sizeof *s->values);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        s->values[v] = (float)roll_between(&d, -2, 5);
    read_points(s);
    s->charts = (skinslide_charts){&s->view, s->faces, mesh.face_count, s->st};
}

static void free_scene(scene *s) {
    free(s->faces), free(s->st), free(s->values);
    free_mesh(&s->mesh);
}

/* A grid of quads over [low, high] squared. */
static test_mesh square_grid(int32_t columns, float low, float high) {
    test_mesh mesh = quad_grid(columns, columns);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        for (int k = 0; k < 2; k++)
            mesh.points[3 * v + k] = low + mesh.points[3 * v + k] * (high - low) / (float)columns;
    return mesh;
}

static float *draw_on(skinslide_map_canvas *canvas, int32_t side, const scene *s, int32_t tile, int32_t *missed) {
    float *texels = malloc((size_t)side * (size_t)side * sizeof *texels);
    assert_ok(skinslide_map_draw(canvas, &s->charts, tile, s->values, texels, missed, &error), &error);
    return texels;
}

static skinslide_map_canvas *canvas_of(int32_t side) {
    skinslide_map_canvas *canvas = NULL;
    assert_ok(skinslide_map_canvas_create(side, SKINSLIDE_ANY_DEVICE, &canvas, &error), &error);
    return canvas;
}

static float *draw(const scene *s, int32_t side, int32_t tile, int32_t *missed) {
    skinslide_map_canvas *canvas = canvas_of(side);
    float *texels = draw_on(canvas, side, s, tile, missed);
    skinslide_map_canvas_destroy(canvas);
    return texels;
}

/* Row y from the bottom. */
static float at(const float *texels, int32_t side, int32_t x, int32_t y) {
    return texels[(side - 1 - y) * side + x];
}

/* ---- Texels by barycentric coordinates ---- */

typedef struct answer {
    double value;
    bool covered, clear; /* clear: the centre is far enough from every side for any device to agree */
} answer;

/* Devices place corners on a grid of 1/256 texel or finer. */
#define NEAR_A_SIDE (1.0 / 128)

static double doubled_area(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance_to_side(const double a[2], const double b[2], const double p[2]) {
    double along[2] = {b[0] - a[0], b[1] - a[1]}, square = along[0] * along[0] + along[1] * along[1];
    double share = square > 0 ? ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    return hypot(p[0] - a[0] - share * along[0], p[1] - a[1] - share * along[1]);
}

/* What the last triangle that holds the centre says. */
static answer search(const scene *s, int32_t side, int32_t x, int32_t y) {
    answer found = {0, false, true};
    const double p[2] = {x + 0.5, y + 0.5};
    for (int32_t f = 0, start = 0; f < s->mesh.face_count; start += s->mesh.face_counts[f++])
        for (int32_t t = 1; t + 1 < s->mesh.face_counts[f]; t++) {
            const int32_t corners[3] = {start, start + t, start + t + 1};
            double place[3][2], weight[3], area;
            for (int i = 0; i < 3; i++)
                for (int k = 0; k < 2; k++)
                    place[i][k] = (double)s->st[2 * corners[i] + k] * side;
            area = doubled_area(place[0], place[1], place[2]);
            bool inside = area != 0;
            for (int i = 0; i < 3; i++) {
                weight[i] = area != 0 ? doubled_area(place[(i + 1) % 3], place[(i + 2) % 3], p) / area : 0;
                inside = inside && weight[i] >= 0;
                found.clear = found.clear && distance_to_side(place[i], place[(i + 1) % 3], p) > NEAR_A_SIDE;
            }
            if (!inside)
                continue;
            found.covered = true, found.value = 0;
            for (int i = 0; i < 3; i++)
                found.value += weight[i] * s->values[s->mesh.face_indices[corners[i]]];
        }
    return found;
}

/* Returns how many texels were compared. tolerance: float arithmetic on corners relative to the triangle, values up to 5. */
static int32_t compare_with_search(const scene *s, int32_t side, double tolerance) {
    float *texels = draw(s, side, 1001, NULL);
    int32_t compared = 0;
    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++) {
            answer expected = search(s, side, x, y);
            if (!expected.clear || !expected.covered)
                continue;
            compared++;
            assert_near(at(texels, side, x, y), expected.value, tolerance);
        }
    free(texels);
    return compared;
}

static void texels_by_barycentric_coordinates(void **state) {
    (void)state;
    scene s;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        test_mesh mesh = seed % 2 ? square_grid(3, 0.1f, 0.9f) : brick_wall(4, 4);
        dice d = {seed};
        double extent = extent_of(mesh.points, mesh.vertex_count);
        for (int32_t i = 0; i < 3 * mesh.vertex_count; i++)
            mesh.points[i] =
                (float)(seed % 2 ? mesh.points[i] + roll_between(&d, -0.05, 0.05) : 0.05 + 0.9 * mesh.points[i] / extent);
        fill_scene(&s, mesh, seed);
        assert_in_range(compare_with_search(&s, 64, 1e-5), 500, 64 * 64);
        free_scene(&s);
    }
}

/* Slivers 20 texels long and a hundredth of one to a few wide, in the far corner: the device's interpolation from the texture's
 * own corner would be off by 1e-2. */
static void slivers_far_from_the_corner(void **state) {
    (void)state;
    enum { SIDE = 512 };
    dice d = {9};
    int32_t compared = 0;
    for (int i = 0; i < 12; i++) {
        float low = 1 - 20.0f / SIDE, x = low + (float)roll_share(&d) * 15 / SIDE,
              width = (float)exp(roll_between(&d, -4, 1)) / SIDE;
        const float points[9] = {x, low, 0, x + width, low + 0.001f, 0, x + 4.2f / SIDE, 1, 0};
        const int32_t counts[1] = {3}, indices[3] = {0, 1, 2};
        scene s;
        fill_scene(&s, copy_mesh(3, 1, counts, indices, points), (uint64_t)i + 1);
        compared +=
            compare_with_search(&s, SIDE, 2e-4); /* st themselves are floats: 3e-5 texels at 512, over a width of 0.02 */
        free_scene(&s);
    }
    assert_in_range(compared, 30, 1000);
}

static void the_top_row_comes_first(void **state) {
    (void)state;
    scene s;
    fill_scene(&s, square_grid(1, 0, 1), 1);
    for (int32_t v = 0; v < 4; v++)
        s.values[v] = s.mesh.points[3 * v + 1] + 10 * s.mesh.points[3 * v];
    float *texels = draw(&s, 4, 1001, NULL);
    for (int32_t i = 0; i < 16; i++)
        assert_near(texels[i], (3 - i / 4 + 0.5) / 4 + 10 * ((i % 4) + 0.5) / 4, 1e-6);
    free(texels);
    texels = draw(&s, 1, 1001, NULL);
    assert_near(texels[0], 5.5, 1e-6);
    free(texels);
    free_scene(&s);
}

static void a_constant_is_drawn_bit_for_bit(void **state) {
    (void)state;
    scene s;
    test_mesh mesh = random_disk(4, 60);
    double extent = extent_of(mesh.points, mesh.vertex_count);
    for (int32_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.points[i] = (float)(0.5 + 0.4 * mesh.points[i] / extent);
    fill_scene(&s, mesh, 1);
    const float constants[3] = {0, 0.1f, 1e-30f};
    for (int k = 0; k < 3; k++) {
        for (int32_t v = 0; v < s.mesh.vertex_count; v++)
            s.values[v] = constants[k];
        float *texels = draw(&s, 64, 1001, NULL);
        for (int i = 0; i < 64 * 64; i++)
            assert_true(texels[i] == constants[k] || texels[i] == 0);
        free(texels);
    }
    free_scene(&s);
}

/* Faces without area, large ones, small ones, values as large as floats are: nothing comes out that did not go in. */
static void awkward_faces(void **state) {
    (void)state;
    enum { SIDE = 48 };
    dice d = {17};
    skinslide_map_canvas *canvas = canvas_of(SIDE);
    for (uint64_t seed = 0; seed < 40; seed++) {
        scene s;
        fill_scene(&s, quad_grid(4, 4), seed);
        double size = pow(10, roll_between(&d, -9, 0.5)), low = 0;
        float lowest = INFINITY, highest = -INFINITY;
        for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
            for (int k = 0; k < 2; k++)
                low = floor(roll_share(&d) * SIDE) / SIDE,
                s.mesh.points[3 * v + k] = (float)(seed % 3 ? low + size * roll_share(&d) : (low + 0.5 / SIDE));
            s.values[v] = (float)roll_between(&d, -1, 1) * (seed % 2 ? 3.4e38f : 1e-3f);
            lowest = fminf(lowest, s.values[v]), highest = fmaxf(highest, s.values[v]);
        }
        read_points(&s);
        for (int32_t c = 4; c < 8; c++) /* one face on a line, and one in a point */
            s.st[2 * c] = 0.5f, s.st[2 * c + 8] = s.st[2 * c + 9] = 0.5f + 0.5f / SIDE;
        int32_t missed;
        float *texels = draw_on(canvas, SIDE, &s, 1001, &missed);
        for (int32_t i = 0; i < SIDE * SIDE; i++)
            assert_true(texels[i] == 0 || (texels[i] >= lowest && texels[i] <= highest));
        assert_in_range(missed, 0, s.mesh.face_count);
        free(texels);
        free_scene(&s);
    }
    skinslide_map_canvas_destroy(canvas);
}

/* ---- Dilation ---- */

/* The rule on the host: each of four times, texels that touch covered ones take their mean. */
static void dilate_on_host(float *values, bool *covered, int32_t side) {
    size_t count = (size_t)side * (size_t)side;
    float *old_values = malloc(count * sizeof *values);
    bool *old = malloc(count * sizeof *covered);
    for (int pass = 0; pass < 4; pass++) {
        memcpy(old_values, values, count * sizeof *values), memcpy(old, covered, count * sizeof *covered);
        for (int32_t i = 0; i < side * side; i++) {
            double sum = 0, around = 0;
            for (int n = 0; n < 9 && !old[i]; n++) {
                int32_t x = i % side + n % 3 - 1, y = i / side + n / 3 - 1;
                if (x >= 0 && y >= 0 && x < side && y < side && old[y * side + x])
                    sum += old_values[y * side + x], around++;
            }
            if (around > 0)
                values[i] = (float)(sum / around), covered[i] = true;
        }
    }
    free(old_values), free(old);
}

/* Charts whose borders lie between texel centres, one of them at the border of the texture, so no device can differ. */
static void dilation_by_the_rule(void **state) {
    (void)state;
    enum { SIDE = 64 };
    scene s;
    test_mesh one = square_grid(2, 16.0f / SIDE, 40.0f / SIDE), other = square_grid(1, 45.0f / SIDE, 1);
    test_mesh both = join_meshes(&one, &other);
    fill_scene(&s, both, 5);
    float *texels = draw(&s, SIDE, 1001, NULL), *expected = calloc(SIDE * SIDE, sizeof *expected);
    bool *covered = calloc(SIDE * SIDE, sizeof *covered);
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        int32_t x = i % SIDE, y = SIDE - 1 - i / SIDE;
        covered[i] = (x >= 16 && x < 40 && y >= 16 && y < 40) || (x >= 45 && y >= 45);
        expected[i] = covered[i] ? texels[i] : 0;
        assert_true(!covered[i] || texels[i] != 0);
    }
    dilate_on_host(expected, covered, SIDE);
    for (int32_t i = 0; i < SIDE * SIDE; i++)
        assert_near(texels[i], expected[i], 4e-6); /* sums of up to eight floats of up to 5, four times */
    free(texels), free(expected), free(covered);
    free_mesh(&one), free_mesh(&other);
    free_scene(&s);
}

static void four_texels_and_no_further(void **state) {
    (void)state;
    enum { SIDE = 64 };
    scene s;
    fill_scene(&s, square_grid(1, 24.0f / SIDE, 32.0f / SIDE), 5);
    for (int32_t v = 0; v < 4; v++)
        s.values[v] = 3;
    float *texels = draw(&s, SIDE, 1001, NULL);
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        int32_t x = i % SIDE, y = SIDE - 1 - i / SIDE;
        assert_near(texels[i], x >= 20 && x < 36 && y >= 20 && y < 36 ? 3 : 0, 0);
    }
    free(texels);
    free_scene(&s);
}

/* ---- Which faces, and where ---- */

static void the_later_face_wins(void **state) {
    (void)state;
    scene s;
    test_mesh one = square_grid(1, 0.25f, 0.75f), other = square_grid(1, 0.25f, 0.75f);
    fill_scene(&s, join_meshes(&one, &other), 1);
    for (int32_t v = 0; v < 8; v++)
        s.values[v] = v < 4 ? 1 : 2;
    for (int32_t turn = 0; turn < 2; turn++) {
        s.faces[0] = turn, s.faces[1] = 1 - turn;
        float *texels = draw(&s, 32, 1001, NULL);
        assert_near(at(texels, 32, 16, 16), turn ? 1 : 2, 0);
        free(texels);
    }
    s.charts.face_count = 1;
    float *texels = draw(&s, 32, 1001, NULL);
    assert_near(at(texels, 32, 16, 16), 2, 0);
    free(texels);
    s.charts.face_count = 0;
    texels = draw(&s, 32, 1001, NULL);
    for (int i = 0; i < 32 * 32; i++)
        assert_near(texels[i], 0, 0);
    free(texels);
    free_mesh(&one), free_mesh(&other);
    free_scene(&s);
}

/* The same face in the first tile and in tile 1012, st 1 + 1/4 and so on: exact in float. */
static void tiles_are_drawn_alike(void **state) {
    (void)state;
    scene s;
    fill_scene(&s, square_grid(3, 0.25f, 0.8125f), 3);
    skinslide_map_canvas *canvas = canvas_of(32);
    float *first = draw_on(canvas, 32, &s, 1001, NULL);
    for (int32_t i = 0; i < 2 * s.mesh.index_count; i++)
        s.st[i] += 1;
    float *empty = draw_on(canvas, 32, &s, 1001, NULL), *moved = draw_on(canvas, 32, &s, 1012, NULL);
    for (int32_t i = 0; i < 32 * 32; i++) {
        assert_near(moved[i], first[i], 1e-6);
        assert_near(empty[i], 0, 0);
    }
    assert_true(at(moved, 32, 16, 16) != 0);
    free(first), free(empty), free(moved);
    skinslide_map_canvas_destroy(canvas);
    free_scene(&s);
}

/* A face from s = 1/2 to 3/2: its left half in one tile, its right half in the next. */
static void a_face_across_tiles_is_in_both(void **state) {
    (void)state;
    scene s;
    fill_scene(&s, square_grid(1, 0.25f, 0.75f), 3);
    for (int32_t c = 0; c < 4; c++)
        s.st[2 * c] = s.st[2 * c] < 0.5f ? 0.5f : 1.5f;
    for (int32_t v = 0; v < 4; v++)
        s.values[v] = s.mesh.points[3 * v] < 0.5f ? 0 : 1;
    float *left = draw(&s, 32, 1001, NULL), *right = draw(&s, 32, 1002, NULL);
    assert_near(at(left, 32, 20, 16), 4.5 / 32, 1e-6);
    assert_near(at(right, 32, 10, 16), 26.5 / 32, 1e-6);
    assert_near(at(right, 32, 25, 16), 0, 0);
    free(left), free(right);
    free_scene(&s);
}

/* Faces of 1/3 texel: of nine along a side three have a centre in them. A long face a hundredth of a texel high has none,
 * unless it lies on one. */
static void faces_without_a_texel_are_counted(void **state) {
    (void)state;
    scene s;
    int32_t missed;
    fill_scene(&s, square_grid(9, 8.0f / 32, 11.0f / 32), 3);
    free(draw(&s, 32, 1001, &missed));
    assert_int_equal(missed, 81 - 9);
    free(draw(&s, 512, 1001, &missed));
    assert_int_equal(missed, 0);
    free_scene(&s);
    for (int on_a_centre = 0; on_a_centre < 2; on_a_centre++) {
        float y = on_a_centre ? 8.495f : 8.6f;
        fill_scene(&s, square_grid(1, 0, 1), 3);
        for (int32_t c = 0; c < 4; c++)
            s.st[2 * c + 1] = (s.st[2 * c + 1] < 0.5f ? y : y + 0.01f) / 32;
        free(draw(&s, 32, 1001, &missed));
        assert_int_equal(missed, !on_a_centre);
        free_scene(&s);
    }
}

/* What was drawn before leaves no trace. */
static void a_canvas_is_used_again(void **state) {
    (void)state;
    scene large, small;
    fill_scene(&large, square_grid(4, 0, 1), 1);
    fill_scene(&small, square_grid(2, 0.4f, 0.6f), 2);
    skinslide_map_canvas *canvas = canvas_of(64);
    float *alone = draw_on(canvas, 64, &small, 1001, NULL);
    free(draw_on(canvas, 64, &large, 1001, NULL));
    float *after = draw_on(canvas, 64, &small, 1001, NULL);
    assert_same_bytes(after, alone, 64 * 64 * sizeof(float));
    free(alone), free(after);
    skinslide_map_canvas_destroy(canvas);
    free_scene(&large), free_scene(&small);
}

/* ---- What cannot be ---- */

static void refuse(skinslide_map_canvas *canvas, const scene *s, int32_t tile, skinslide_status expected, const char *text) {
    float texels[16 * 16];
    int32_t missed = 77;
    memset(texels, 0x55, sizeof texels);
    assert_fails(skinslide_map_draw(canvas, &s->charts, tile, s->values, texels, &missed, &error), &error, expected, text);
    for (size_t i = 0; i < sizeof texels; i++)
        assert_int_equal(((unsigned char *)texels)[i], 0x55);
    assert_int_equal(missed, 77);
}

static void bad_arguments(void **state) {
    (void)state;
    scene s;
    fill_scene(&s, square_grid(2, 0.1f, 0.9f), 1);
    skinslide_map_canvas *canvas = canvas_of(16);
    float texels[256];
    refuse(canvas, &s, 1000, SKINSLIDE_BAD_ARGUMENT, "no such tile: 1000");
    refuse(canvas, &s, 10001, SKINSLIDE_BAD_ARGUMENT, "no such tile: 10001");
    assert_fails(skinslide_map_draw(NULL, &s.charts, 1001, s.values, texels, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no canvas, charts, values, ...");
    s.values[4] = NAN;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_POINTS, "vertex 4 has the value nan");
    s.values[4] = 0, s.st[2 * 5] = INFINITY;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_CONTROL, "face 1 has st (inf, ...");
    s.st[2 * 5] = -0.25f;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_CONTROL, "face 1 has st (-0.25, 0.1), which is in no UDIM tile");
    s.charts.face_count = 1; /* of the others nothing is asked */
    free(draw_on(canvas, 16, &s, 1001, NULL));
    s.faces[0] = 4;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_ARGUMENT, "face 4 is not one of the mesh's 4");
    s.charts.st = NULL;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_ARGUMENT, "no texture coordinates, ...");
    s.view.face_indices = NULL;
    refuse(canvas, &s, 1001, SKINSLIDE_BAD_ARGUMENT, "...");
    skinslide_map_canvas_destroy(canvas);
    skinslide_map_canvas_destroy(NULL);
    free_scene(&s);
}

static skinslide_status create_with(fault planned, int32_t side, skinslide_map_canvas **out) {
    const skinslide_status untouched = SKINSLIDE_OK;
    const ss_device_request request = {load_with_faults, SKINSLIDE_ANY_DEVICE, false};
    *out = NULL;
    plan_fault(planned);
    skinslide_status status = ss_map_canvas_create(side, &request, out, &error);
    assert_true((status == untouched) == (*out != NULL));
    return status;
}

static void sizes(void **state) {
    (void)state;
    skinslide_map_canvas *canvas;
    fault small = {.devices = -1, .largest = 256};
    assert_fails(create_with(small, 257, &canvas), &error, SKINSLIDE_BAD_ARGUMENT,
                 "a map of 257 texels a side is above the device's limit of 256");
    assert_ok(create_with(small, 256, &canvas), &error);
    skinslide_map_canvas_destroy(canvas);
    assert_fails(create_with(small, 0, &canvas), &error, SKINSLIDE_BAD_ARGUMENT,
                 "a map of 0 texels a side; it must have 1 to 16384");
    assert_fails(create_with(small, 16385, &canvas), &error, SKINSLIDE_BAD_ARGUMENT, "a map of 16385 ...");
    assert_fails(skinslide_map_canvas_create(16, -2, &canvas, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no place ...");
    assert_fails(skinslide_map_canvas_create(16, -1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no place ...");
}

static void machines_without_a_device(void **state) {
    (void)state;
    skinslide_map_canvas *canvas = NULL;
    ss_egl *egl = NULL;
    skinslide_error said;
    const ss_device_request request = {load_nothing, SKINSLIDE_ANY_DEVICE, false};
    assert_int_equal(ss_egl_open(&request, &egl, &said), SKINSLIDE_NO_DEVICE);
    assert_fails(ss_map_canvas_create(16, &request, &canvas, &error), &error, SKINSLIDE_NO_DEVICE, said.message);
    assert_null(canvas);
}

static void devices_that_cannot(void **state) {
    (void)state;
    static const struct {
        const char *call, *text;
        int32_t after;
        uint32_t code;
    } cases[] = {
        {"glCheckFramebufferStatus", "the device's framebuffer of 16 by 16 texels is not complete: 0x8cdd", 0, 0x8cdd},
        {"glCheckFramebufferStatus", "the device's framebuffer of 16 by 16 texels is not complete: 0x8cdd", 1, 0x8cdd},
        {"glGetProgramiv", "the device's compiler refuses a program: ...", 0, 0},
        {"glGetProgramiv", "the device's compiler refuses a program: ...", 1, 0},
        {"glGetError", "making a map's canvas: OpenGL error 0x0505", 0, GL_OUT_OF_MEMORY},
        {"eglMakeCurrent", "eglMakeCurrent: EGL_BAD_ALLOC", 1, EGL_BAD_ALLOC},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_map_canvas *canvas;
        fault planned = {.call = cases[i].call, .after = cases[i].after, .times = -1, .code = cases[i].code, .devices = -1};
        assert_fails(create_with(planned, 16, &canvas), &error, SKINSLIDE_DEVICE_FAILED, cases[i].text);
        assert_true(faults_struck() > 0);
    }
}

static void devices_that_fail_later(void **state) {
    (void)state;
    static const struct {
        const char *call, *text;
        uint32_t code;
    } cases[] = {{"glGetError", "drawing a map: OpenGL error 0x0505", GL_OUT_OF_MEMORY},
                 {"glGetGraphicsResetStatus", "drawing a map: the context was lost, 0x8253", 0x8253},
                 {"eglMakeCurrent", "eglMakeCurrent: EGL_CONTEXT_LOST", EGL_CONTEXT_LOST}};
    scene s;
    fill_scene(&s, square_grid(2, 0.1f, 0.9f), 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_map_canvas *canvas;
        assert_ok(create_with((fault)NO_FAULT, 16, &canvas), &error);
        plan_fault((fault){.call = cases[i].call, .times = 1, .code = cases[i].code, .devices = -1});
        refuse(canvas, &s, 1001, SKINSLIDE_DEVICE_FAILED, cases[i].text);
        assert_int_equal(faults_struck(), 1);
        free(draw_on(canvas, 16, &s, 1001, NULL)); /* and again, once it works */
        skinslide_map_canvas_destroy(canvas);
    }
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_by_barycentric_coordinates),
        cmocka_unit_test(slivers_far_from_the_corner),
        cmocka_unit_test(the_top_row_comes_first),
        cmocka_unit_test(a_constant_is_drawn_bit_for_bit),
        cmocka_unit_test(awkward_faces),
        cmocka_unit_test(dilation_by_the_rule),
        cmocka_unit_test(four_texels_and_no_further),
        cmocka_unit_test(the_later_face_wins),
        cmocka_unit_test(tiles_are_drawn_alike),
        cmocka_unit_test(a_face_across_tiles_is_in_both),
        cmocka_unit_test(faces_without_a_texel_are_counted),
        cmocka_unit_test(a_canvas_is_used_again),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(sizes),
        cmocka_unit_test(machines_without_a_device),
        cmocka_unit_test(devices_that_cannot),
        cmocka_unit_test(devices_that_fail_later),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
