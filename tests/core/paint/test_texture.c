/* Maps sampled at texture coordinates: values by hand, wraps against the image laid out again and again, tiles. */
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

/* Two texels by two: 1 2 on top, 3 4 below. Texel centres lie at s, t of 0.25 and 0.75, and t grows upwards. */
static const float four[4] = {1, 2, 3, 4};

/* The layout is valid until the next call. */
static const skinslide_texture_layout *layout_of(const skinslide_mesh *mesh, const int32_t *faces, int32_t face_count,
                                                 const float *st) {
    static skinslide_texture_layout layout;
    layout = (skinslide_texture_layout){sizeof layout, mesh, faces, face_count, st};
    return &layout;
}

static skinslide_image image_of(const float *pixels, int32_t width, int32_t height, skinslide_wrap wrap) {
    return (skinslide_image){sizeof(skinslide_image), width, height, wrap, wrap, pixels, "R"};
}

/* The value at one texture coordinate: that of a triangle with all corners there. */
static double value_at(const skinslide_image *image, double s, double t) {
    const int32_t counts[1] = {3}, indices[3] = {0, 1, 2}, faces[1] = {0};
    const skinslide_mesh mesh = {sizeof(skinslide_mesh), 3, 1, 3, counts, indices, NULL, NULL, NULL, NULL};
    const float st[6] = {(float)s, (float)t, (float)s, (float)t, (float)s, (float)t};
    const skinslide_texture_tile tile = {sizeof(skinslide_texture_tile), image, 0};
    float values[3];
    assert_ok(skinslide_texture_sample(layout_of(&mesh, faces, 1, st), &tile, 1, values, &error), &error);
    assert_near(values[1], values[0], 0);
    return values[0];
}

static void bilinear_by_hand(void **state) {
    (void)state;
    skinslide_image image = image_of(four, 2, 2, SKINSLIDE_WRAP_CLAMP);
    assert_near(value_at(&image, 0.25, 0.75), 1, 0);
    assert_near(value_at(&image, 0.75, 0.75), 2, 0);
    assert_near(value_at(&image, 0.25, 0.25), 3, 0);
    assert_near(value_at(&image, 0.75, 0.25), 4, 0);
    assert_near(value_at(&image, 0.5, 0.5), 2.5, 0);
    assert_near(value_at(&image, 0.375, 0.75), 1.25, 0);
    assert_near(value_at(&image, 0.25, 0.625), 1.5, 0);
    assert_near(value_at(&image, 0.375, 0.625), 0.75 * (0.75 * 1 + 0.25 * 2) + 0.25 * (0.75 * 3 + 0.25 * 4), 0);
    assert_near(value_at(&image, 0, 0), 3, 0);
    assert_near(value_at(&image, 1, 1), 2, 0);
}

static void beyond_the_border_by_hand(void **state) {
    (void)state;
    static const struct {
        skinslide_wrap wrap;
        double left, far_right, middle_of_border; /* at s = -0.25, 2.25 and 0; t = 0.75 */
    } cases[] = {{SKINSLIDE_WRAP_CLAMP, 1, 2, 1},
                 {SKINSLIDE_WRAP_PERIODIC, 2, 1, 1.5},
                 {SKINSLIDE_WRAP_MIRROR, 1, 1, 1},
                 {SKINSLIDE_WRAP_BLACK, 0, 0, 0.5}};
    for (int i = 0; i < 4; i++) {
        skinslide_image image = image_of(four, 2, 2, cases[i].wrap);
        assert_near(value_at(&image, -0.25, 0.75), cases[i].left, 0);
        assert_near(value_at(&image, 2.25, 0.75), cases[i].far_right, 0);
        assert_near(value_at(&image, 0, 0.75), cases[i].middle_of_border, 0);
    }
}

/* The texel that is laid at a place of the plane, by the definition of each wrap. */
static double laid_texel(const skinslide_image *image, int32_t x, int32_t y) {
    int32_t place[2] = {x, y}, size[2] = {image->width, image->height};
    for (int k = 0; k < 2; k++) {
        int32_t copy = (int32_t)floor((double)place[k] / size[k]), within = place[k] - copy * size[k];
        if (copy && image->wrap_s == SKINSLIDE_WRAP_BLACK)
            return 0;
        if (image->wrap_s == SKINSLIDE_WRAP_CLAMP)
            within = copy < 0 ? 0 : copy > 0 ? size[k] - 1 : within;
        if (image->wrap_s == SKINSLIDE_WRAP_MIRROR && copy % 2 != 0)
            within = size[k] - 1 - within;
        place[k] = within;
    }
    return image->pixels[place[1] * image->width + place[0]];
}

static void wraps_against_the_plane(void **state) {
    (void)state;
    float pixels[15];
    for (int i = 0; i < 15; i++)
        pixels[i] = (float)(i * i % 11);
    dice d = {3};
    for (int i = 0; i < 4000; i++) {
        skinslide_image image = image_of(pixels, 5, 3, (skinslide_wrap)(i % 4));
        float s = (float)roll_between(&d, -4, 4), t = (float)roll_between(&d, -4, 4);
        double x = s * 5.0 - 0.5, y = (1.0 - t) * 3 - 0.5, expected = 0;
        int32_t left = (int32_t)floor(x), top = (int32_t)floor(y);
        for (int k = 0; k < 4; k++)
            expected += (k & 1 ? x - left : 1 - (x - left)) * (k & 2 ? y - top : 1 - (y - top)) *
                        laid_texel(&image, left + (k & 1), top + (k >> 1));
        assert_near(value_at(&image, s, t), expected, 2e-6); /* a few roundings of values up to 10, one to float */
    }
    skinslide_image image = image_of(pixels, 5, 3, SKINSLIDE_WRAP_PERIODIC);
    assert_true(isfinite(value_at(&image, 3e38, -3e38)));
}

/* Two quads side by side. A vertex takes the mean over its corners; where only one face counts, over that face's. */
static void vertices_take_the_mean_of_their_corners(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 1);
    skinslide_mesh mesh = view_of(&grid);
    mesh.rest_points = NULL;
    skinslide_image image = image_of(four, 2, 2, SKINSLIDE_WRAP_CLAMP);
    const skinslide_texture_tile tile = {sizeof(skinslide_texture_tile), &image, 0};
    float st[16], values[6];
    for (int c = 0; c < 8; c++)
        st[2 * c] = c < 4 ? 0.25f : 0.75f, st[2 * c + 1] = 0.75f; /* a seam between the faces */
    const int32_t both[2] = {1, 0}, second[1] = {1};
    assert_ok(skinslide_texture_sample(layout_of(&mesh, both, 2, st), &tile, 1, values, &error), &error);
    const float means[6] = {1, 1.5f, 2, 1, 1.5f, 2}, of_second[6] = {1, 2, 2, 1, 2, 2};
    assert_same_bytes(values, means, sizeof means);
    assert_ok(skinslide_texture_sample(layout_of(&mesh, second, 1, st), &tile, 1, values, &error), &error);
    assert_same_bytes(values, of_second, sizeof of_second);
    free_mesh(&grid);
}

/* ---- Tiles ---- */

/* A strip of quads; corner k of face i at s of i, i + 1, i + 1, i, from t = 0 to 1. */
static void strip_st(int32_t faces, float shift_s, float shift_t, float *st) {
    static const float corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int32_t i = 0; i < faces; i++)
        for (int k = 0; k < 4; k++) {
            st[8 * i + 2 * k] = (float)i + corner[k][0] + shift_s;
            st[8 * i + 2 * k + 1] = corner[k][1] + shift_t;
        }
}

static void corners_on_borders_are_in_their_faces_tile(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 1);
    skinslide_mesh mesh = view_of(&grid);
    const int32_t faces[2] = {0, 2};
    float st[24];
    int32_t tiles[12];
    strip_st(3, 0, 0, st);
    assert_ok(skinslide_texture_tiles(layout_of(&mesh, faces, 2, st), tiles, &error), &error);
    for (int c = 0; c < 12; c++)
        assert_int_equal(tiles[c], c < 4 ? 1001 : c < 8 ? 0 : 1003);
    strip_st(3, 7, 12, st);
    assert_ok(skinslide_texture_tiles(layout_of(&mesh, faces, 2, st), tiles, &error), &error);
    assert_int_equal(tiles[0], 1001 + 7 + 120);
    assert_int_equal(tiles[8], 1001 + 9 + 120);
    strip_st(3, 0.5f, 0, st); /* faces across borders: each corner where it is */
    assert_ok(skinslide_texture_tiles(layout_of(&mesh, faces, 1, st), tiles, &error), &error);
    assert_int_equal(tiles[0], 1001);
    assert_int_equal(tiles[1], 1002);
    free_mesh(&grid);
}

static void tiles_are_sampled_each_for_itself(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 1);
    skinslide_mesh mesh = view_of(&grid);
    const float tens[4] = {10, 20, 30, 40};
    skinslide_image a = image_of(four, 2, 2, SKINSLIDE_WRAP_PERIODIC), b = image_of(tens, 2, 2, SKINSLIDE_WRAP_BLACK);
    const skinslide_texture_tile tiles[2] = {{sizeof(skinslide_texture_tile), &b, 1002},
                                             {sizeof(skinslide_texture_tile), &a, 1001}};
    const int32_t faces[2] = {0, 1};
    float st[16], values[6];
    strip_st(2, 0, 0, st);
    assert_ok(skinslide_texture_sample(layout_of(&mesh, faces, 2, st), tiles, 2, values, &error), &error);
    const float expected[6] = {3, (4 + 30) / 2.0f, 40, 1, (2 + 10) / 2.0f, 20};
    assert_same_bytes(values, expected, sizeof expected);
    assert_fails(skinslide_texture_sample(layout_of(&mesh, faces, 2, st), tiles, 1, values, &error), &error,
                 SKINSLIDE_BAD_CONTROL, "face 0 has st (0, 0), but there is no tile 1001");
    free_mesh(&grid);
}

/* ---- Refused ---- */

static void coordinates_that_cannot_be(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 1);
    skinslide_mesh mesh = view_of(&grid);
    skinslide_image image = image_of(four, 2, 2, SKINSLIDE_WRAP_CLAMP);
    const skinslide_texture_tile tile = {sizeof(skinslide_texture_tile), &image, 0};
    const int32_t faces[2] = {0, 1}, outside[1] = {2};
    int32_t numbers[8] = {7, 7, 7, 7, 7, 7, 7, 7};
    float st[16], values[6];
    strip_st(2, 8.5f, 0, st);
    assert_fails(skinslide_texture_tiles(layout_of(&mesh, faces, 2, st), numbers, &error), &error, SKINSLIDE_BAD_CONTROL,
                 "face 1 has st (10.5, 0), which is in no UDIM tile");
    assert_int_equal(numbers[0], 7);
    strip_st(2, 0, -0.5f, st);
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, faces, 1, st), numbers, &error), SKINSLIDE_BAD_CONTROL);
    strip_st(2, 0, 899.5f, st);
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, faces, 1, st), numbers, &error), SKINSLIDE_BAD_CONTROL);
    st[9] = NAN;
    assert_fails(skinslide_texture_sample(layout_of(&mesh, faces, 2, st), &tile, 1, values, &error), &error,
                 SKINSLIDE_BAD_CONTROL, "face 1 has st (1, nan)");
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, faces + 1, 1, st), numbers, &error), SKINSLIDE_BAD_CONTROL);
    assert_ok(skinslide_texture_sample(layout_of(&mesh, faces, 1, st), &tile, 1, values, &error), &error);
    assert_fails(skinslide_texture_sample(layout_of(&mesh, outside, 1, st), &tile, 1, values, &error), &error,
                 SKINSLIDE_BAD_ARGUMENT, "face 2 is not one of the mesh's 2");
    free_mesh(&grid);
}

/* A texel that is not a number is an error only if it is used. */
static void texels_that_are_no_numbers(void **state) {
    (void)state;
    const float pixels[4] = {1, NAN, 3, INFINITY};
    skinslide_image image = image_of(pixels, 2, 2, SKINSLIDE_WRAP_CLAMP);
    assert_near(value_at(&image, 0.25, 0.5), 2, 0);
    assert_near(value_at(&image, 0.1, 0.9), 1, 0);
    const int32_t counts[1] = {3}, indices[3] = {0, 1, 2}, faces[1] = {0};
    const skinslide_mesh mesh = {sizeof(skinslide_mesh), 3, 1, 3, counts, indices, NULL, NULL, NULL, NULL};
    const float st[6] = {0.25f, 0.5f, 0.25f, 0.5f, 0.5f, 0.75f};
    const skinslide_texture_tile tile = {sizeof(skinslide_texture_tile), &image, 0};
    float values[3] = {5, 5, 5};
    assert_fails(skinslide_texture_sample(layout_of(&mesh, faces, 1, st), &tile, 1, values, &error), &error,
                 SKINSLIDE_BAD_CONTROL, "the map is nan at st (0.5, 0.75), on face 0");
    assert_near(values[0], 5, 0);
}

static void bad_arguments(void **state) {
    (void)state;
    test_mesh grid = quad_grid(1, 1);
    skinslide_mesh mesh = view_of(&grid);
    skinslide_image image = image_of(four, 2, 2, SKINSLIDE_WRAP_CLAMP), empty = image_of(four, 0, 2, 0);
    const skinslide_texture_tile good = {sizeof(skinslide_texture_tile), &image, 0},
                                 none = {sizeof(skinslide_texture_tile), NULL, 0},
                                 no_texels = {sizeof(skinslide_texture_tile), &empty, 0},
                                 odd = {sizeof(skinslide_texture_tile), &image, 1000};
    const skinslide_texture_tile mixed[2] = {{sizeof(skinslide_texture_tile), &image, 1001},
                                             {sizeof(skinslide_texture_tile), &image, 0}};
    const int32_t faces[1] = {0};
    float st[8] = {0}, values[4];
    int32_t tiles[4];
#define SAMPLE(st, tiles, count, values) skinslide_texture_sample(layout_of(&mesh, faces, 1, st), tiles, count, values, &error)
    assert_int_equal(SAMPLE(st, &good, 1, values), SKINSLIDE_OK);
    assert_int_equal(SAMPLE(NULL, &good, 1, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, &good, 1, NULL), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, NULL, 1, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, &good, 0, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, &none, 1, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, &no_texels, 1, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, &odd, 1, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(SAMPLE(st, mixed, 2, values), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, faces, 1, st), NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, NULL, 1, st), tiles, &error), SKINSLIDE_BAD_ARGUMENT);
    mesh.index_count = 3;
    assert_int_equal(skinslide_texture_tiles(layout_of(&mesh, faces, 1, st), tiles, &error), SKINSLIDE_BAD_MESH);
    free_mesh(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bilinear_by_hand),
        cmocka_unit_test(beyond_the_border_by_hand),
        cmocka_unit_test(wraps_against_the_plane),
        cmocka_unit_test(vertices_take_the_mean_of_their_corners),
        cmocka_unit_test(corners_on_borders_are_in_their_faces_tile),
        cmocka_unit_test(tiles_are_sampled_each_for_itself),
        cmocka_unit_test(coordinates_that_cannot_be),
        cmocka_unit_test(texels_that_are_no_numbers),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
