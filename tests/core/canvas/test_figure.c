/* Pixels of figures: which are drawn, in which colour, in front of what. Most are drawn by a camera whose world is in pixels,
 * so that what each pixel has can be told by hand. */
#include "canvas.h"
#include "creases.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 64 };

typedef float pixel[4];

static const float blue[3] = {0, 0, 1};
static const skinslide_viewport whole = {0, 0, WIDTH, HEIGHT};

/* One of each kind for all tests: a context takes longer to make than most pictures. */
enum { MOST_CANVASES = 8 };
static skinslide_canvas *canvases[MOST_CANVASES];

/* Cleared to blue. A test draws on several only where they differ in size or pixels. */
static skinslide_canvas *canvas_of(int32_t width, int32_t height, skinslide_pixels pixels) {
    const skinslide_canvas_options options = {sizeof(skinslide_canvas_options), width, height, pixels, SKINSLIDE_ANY_DEVICE, 1};
    skinslide_error error;
    int i = 0;
    while (i < MOST_CANVASES && canvases[i] &&
           (canvases[i]->width != width || canvases[i]->height != height || canvases[i]->pixels != pixels))
        i++;
    assert_in_range(i, 0, MOST_CANVASES - 1);
    if (!canvases[i])
        assert_ok(skinslide_canvas_create(&options, &canvases[i], &error), &error);
    assert_ok(skinslide_canvas_clear(canvases[i], blue, &error), &error);
    return canvases[i];
}

static int destroy_canvases(void **state) {
    (void)state;
    for (int i = 0; i < MOST_CANVASES; i++)
        skinslide_canvas_destroy(canvases[i]);
    return 0;
}

/* Looks along -z at 0..width by 0..height, z from -1000 to 1000. */
static skinslide_camera in_pixels(double width, double height) {
    skinslide_camera camera = {.to_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                               .to_screen = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1e-3, 0, -1, -1, 0, 1}};
    camera.to_screen[0] = 2 / width, camera.to_screen[5] = 2 / height;
    return camera;
}

static void draw_in(skinslide_canvas *canvas, skinslide_viewport viewport, const skinslide_figure *figure,
                    skinslide_camera camera) {
    skinslide_error error;
    assert_ok(skinslide_canvas_draw(canvas, &viewport, &camera, figure, &error), &error);
}

static void draw(skinslide_canvas *canvas, const skinslide_figure *figure) {
    draw_in(canvas, whole, figure, in_pixels(WIDTH, HEIGHT));
}

static void read_all(skinslide_canvas *canvas, void *pixels) {
    skinslide_error error;
    assert_ok(skinslide_canvas_read(canvas, pixels, &error), &error);
}

/* ---- Sheets ---- */

typedef struct sheet {
    test_mesh mesh;
    skinslide_tessellation *tessellation;
    skinslide_figure figure;
    float *values;
} sheet;

/* A grid of columns by rows quads over a box of pixels, in z = 0, its st from 0 to 1. Its first `inside` faces are the
 * patch. */
static sheet sheet_of(int32_t columns, int32_t rows, const double box[4], int32_t inside, bool st) {
    sheet s = {.mesh = quad_grid(columns, rows)};
    int32_t *faces = all_faces(&s.mesh);
    float *at = calloc((size_t)s.mesh.index_count, sizeof(float[2]));
    skinslide_mesh view = view_of(&s.mesh);
    skinslide_error error;
    for (int32_t c = 0; c < s.mesh.index_count; c++) {
        const float *p = s.mesh.points + 3 * s.mesh.face_indices[c];
        at[2 * c] = p[0] / (float)columns, at[2 * c + 1] = p[1] / (float)rows;
    }
    for (int32_t v = 0; v < s.mesh.vertex_count; v++) {
        float *p = s.mesh.points + 3 * v;
        p[0] = (float)(box[0] + (box[2] - box[0]) * p[0] / columns), p[1] = (float)(box[1] + (box[3] - box[1]) * p[1] / rows);
    }
    assert_ok(skinslide_tessellation_create(&view, st ? at : NULL, faces, inside, &s.tessellation, &error), &error);
    s.figure = (skinslide_figure){
        .size = sizeof(skinslide_figure), .tessellation = s.tessellation, .points = s.mesh.points, .squares = 1};
    s.values = calloc((size_t)s.mesh.vertex_count, sizeof *s.values);
    free(at), free(faces);
    return s;
}

static const double everywhere[4] = {0, 0, WIDTH, HEIGHT};
static const double beyond[4] = {-WIDTH, -HEIGHT, 2 * WIDTH, 2 * HEIGHT};

/* In one false colour: a share of the scale. */
static void fill(sheet *s, float share) {
    for (int32_t v = 0; v < s->mesh.vertex_count; v++)
        s->values[v] = share;
    s->figure.values = s->values, s->figure.lowest = 0, s->figure.highest = 1;
}

static void end_sheet(sheet *s) {
    skinslide_tessellation_destroy(s->tessellation);
    free(s->values);
    free_mesh(&s->mesh);
}

static bool is_colour(const pixel p, const float colour[3], double slack) {
    for (int k = 0; k < 3; k++)
        if (!(fabs(p[k] - colour[k]) <= slack))
            return false;
    return true;
}

static bool is_share(const pixel p, float share) {
    float colour[3];
    skinslide_false_colour(share, colour);
    return is_colour(p, colour, 1e-3);
}

/* Half floats have 11 bits. */
static void assert_colour(const pixel p, const double colour[3]) {
    for (int k = 0; k < 3; k++)
        assert_near(p[k], colour[k], 1e-3);
}

/* ---- Coverage ---- */

/* Boxes of whole pixels: these and no others, in viewports of their own too, of which what is beyond is cut off. */
static void what_is_covered_is_drawn(void **state) {
    (void)state;
    static const double boxes[5][4] = {{0, 0, 40, 30}, {10, 5, 30, 25}, {7, 29, 8, 30}, {-50, -20, 90, 80}, {-5, 4, 3, 99}};
    static const skinslide_viewport viewports[3] = {{0, 0, 40, 30}, {8, 9, 40, 30}, {WIDTH - 40, HEIGHT - 30, 40, 30}};
    static pixel pixels[HEIGHT][WIDTH];
    for (int i = 0; i < 15; i++) {
        const double *box = boxes[i % 5];
        skinslide_viewport v = viewports[i / 5];
        sheet s = sheet_of(3, 2, box, 0, true);
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        draw_in(canvas, v, &s.figure, in_pixels(40, 30));
        read_all(canvas, pixels);
        for (int32_t row = 0; row < HEIGHT; row++)
            for (int32_t x = 0; x < WIDTH; x++) {
                double u = x - v.x + 0.5, w = HEIGHT - 1 - row - v.y + 0.5;
                bool covered = u > fmax(box[0], 0) && u < fmin(box[2], 40) && w > fmax(box[1], 0) && w < fmin(box[3], 30);
                assert_int_equal(covered, !is_colour(pixels[row][x], blue, 0));
            }
        end_sheet(&s);
    }
}

/* The first row read is the top one: where y is largest. */
static void the_top_comes_first(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    const double upper[4] = {0, HEIGHT / 2.0, WIDTH, HEIGHT};
    sheet s = sheet_of(1, 1, upper, 0, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_false(is_colour(pixels[0][5], blue, 0.1));
    assert_true(is_colour(pixels[HEIGHT - 1][5], blue, 0));
    end_sheet(&s);
}

/* ---- The chequer ---- */

static const double dark[3] = {0.045, 0.055, 0.09}, light[3] = {0.78, 0.74, 0.68};

/* Squares of 8 by 8 pixels, the first, at st 0, dark; shifted by whole squares of st. */
static void squares_are_where_st_is(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    sheet s = sheet_of(3, 2, beyond, 6, true); /* st 0 to 1 over three times the picture each way */
    for (int shift = 0; shift < 3; shift++) {
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        s.figure.squares = 36; /* over 288 pixels: 8 each; over 192: 5 1/3 each */
        for (int32_t v = 0; v < s.mesh.vertex_count && shift; v++)
            s.mesh.points[3 * v] += 8;
        draw(canvas, &s.figure);
        read_all(canvas, pixels);
        for (int32_t row = 0; row < HEIGHT; row++)
            for (int32_t x = 0; x < WIDTH; x++) {
                double p = (x + 0.5 + WIDTH - 8 * shift) / 8, q = (HEIGHT - row - 0.5 + HEIGHT) * 36 / (3.0 * HEIGHT);
                bool odd = ((int)p + (int)q) % 2;
                if (q - floor(q) > 0.1 && q - floor(q) < 0.9) /* else a pixel of two squares */
                    assert_colour(pixels[row][x], odd ? light : dark);
            }
    }
    end_sheet(&s);
}

/* Squares of a fifteenth of a pixel: their mean, to a square in the pixel's. */
static void small_squares_are_grey(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    sheet s = sheet_of(2, 2, beyond, 4, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    s.figure.squares = 15 * 3 * WIDTH + 0.37f;
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 3; k++)
            assert_near(pixels[i / WIDTH][i % WIDTH][k], 0.5 * (dark[k] + light[k]), 0.01);
    end_sheet(&s);
}

/* Coordinates that are beyond all floats once they are in squares are as good as any: pixels are colours nevertheless. */
static void no_squares_are_too_small(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    sheet s = sheet_of(8, 2, beyond, 16, false);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    s.figure.squares = 3e38f;
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 3; k++)
            assert_true(pixels[i / WIDTH][i % WIDTH][k] >= 0 && pixels[i / WIDTH][i % WIDTH][k] <= 1);
    end_sheet(&s);
}

/* Without st, squares at rest in space. Moved along with the mesh, they are the same; and they are those of st that goes as the
 * places at rest do, from the middle of the mesh on, less the shift that keeps a flat sheet inside one layer of squares. */
static void squares_in_space_go_with_the_mesh(void **state) {
    (void)state;
    enum { STEP = 16 };
    static pixel still[HEIGHT][WIDTH], moved[HEIGHT][WIDTH], by_st[HEIGHT][WIDTH];
    sheet space = sheet_of(3, 2, beyond, 6, false), plane = sheet_of(3, 2, beyond, 6, true);
    const float size = 8;
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    space.figure.squares = 1 / size;
    draw(canvas, &space.figure);
    read_all(canvas, still);
    for (int32_t v = 0; v < space.tessellation->vertex_count; v++)
        for (int k = 0; k < 2; k++)
            plane.tessellation->fixed[v].coordinates[k] = space.tessellation->fixed[v].coordinates[k] / size + 0.317f;
    canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &plane.figure);
    read_all(canvas, by_st);
    for (int32_t v = 0; v < space.mesh.vertex_count; v++)
        space.mesh.points[3 * v] += STEP, space.mesh.points[3 * v + 2] = 7;
    canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &space.figure);
    read_all(canvas, moved);
    int32_t lights = 0;
    for (int32_t row = 0; row < HEIGHT; row++)
        for (int32_t x = 0; x < WIDTH; x++)
            for (int k = 0; k < 3; k++) {
                assert_near(still[row][x][k], by_st[row][x][k], 2e-3);
                if (x >= STEP)
                    assert_near(moved[row][x][k], still[row][x - STEP][k], 2e-3);
                lights += still[row][x][k] > 0.4;
            }
    assert_near((double)lights / (3 * WIDTH * HEIGHT), 0.5, 0.1);
    end_sheet(&space), end_sheet(&plane);
}

/* Outside the patch paler: 0.7 of the way to a plain grey. */
static void paler_outside_the_patch(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    static const double plain[3] = {0.33, 0.31, 0.30};
    sheet s = sheet_of(2, 1, everywhere, 1, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    s.figure.squares = 0.5f; /* all in the first */
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_colour(pixels[HEIGHT / 2][WIDTH / 4], dark);
    for (int k = 0; k < 3; k++)
        assert_near(pixels[HEIGHT / 2][3 * WIDTH / 4][k], 0.3 * dark[k] + 0.7 * plain[k], 1e-3);
    fill(&s, 1);
    canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_true(is_share(pixels[HEIGHT / 2][WIDTH / 4], 1));
    assert_colour(pixels[HEIGHT / 2][3 * WIDTH / 4], plain);
    end_sheet(&s);
}

/* ---- False colours and light ---- */

static void false_colours_are_those_of_the_scale(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    static uint8_t levels[HEIGHT][WIDTH][4];
    sheet s = sheet_of(8, 2, beyond, 16, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    skinslide_canvas *bytes = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
    for (int32_t v = 0; v < s.mesh.vertex_count; v++)
        s.values[v] = s.mesh.points[3 * v]; /* x, in pixels */
    s.figure.values = s.values, s.figure.lowest = 20, s.figure.highest = 80;
    draw(canvas, &s.figure), draw(bytes, &s.figure);
    read_all(canvas, pixels), read_all(bytes, levels);
    for (int32_t row = 0; row < HEIGHT; row++)
        for (int32_t x = 0; x < WIDTH; x++) {
            float expected[3];
            skinslide_false_colour(((float)x + 0.5f - 20) / 60, expected);
            for (int k = 0; k < 3; k++) {
                double l = expected[k], srgb = l < 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
                assert_near(pixels[row][x][k], l, 2e-3);
                assert_near(levels[row][x][k], 255 * srgb, 1.5);
            }
        }
    end_sheet(&s);
}

/* Ends clamp, and of what is no share there is none. */
static void shares_clamp(void **state) {
    (void)state;
    float low[3], high[3], colour[3];
    skinslide_false_colour(0, low), skinslide_false_colour(1, high);
    skinslide_false_colour(-3, colour), assert_same_bytes(colour, low, sizeof low);
    skinslide_false_colour(-INFINITY, colour), assert_same_bytes(colour, low, sizeof low);
    skinslide_false_colour(INFINITY, colour), assert_same_bytes(colour, high, sizeof high);
    skinslide_false_colour(NAN, colour), assert_same_bytes(colour, low, sizeof low);
    for (int i = 0; i <= 100; i++) {
        skinslide_false_colour((float)i / 100, colour);
        for (int k = 0; k < 3; k++)
            assert_true(colour[k] >= 0 && colour[k] <= 1);
    }
}

/* The lamp is at (-0.35, 0.55, 0.8); what faces the camera has its own colour. */
static double shade(const double n[3]) {
    double lamp = sqrt(0.35 * 0.35 + 0.55 * 0.55 + 0.8 * 0.8), dot = (-0.35 * n[0] + 0.55 * n[1] + 0.8 * n[2]) / lamp;
    return (0.23 + 0.07 * n[1] + 0.78 * fmax(dot, 0)) / (0.23 + 0.78 * 0.8 / lamp);
}

/* Slopes in x or in y; from both sides, right- and left-handed: light is the same for what is seen. */
static void slopes_are_shaded(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    static const double slopes[5] = {0, 0.5, -0.5, 3, -3};
    for (int i = 0; i < 40; i++) {
        double slope = slopes[i % 5], length = hypot(1, slope);
        bool in_y = i / 5 & 1;
        const double n[3] = {in_y ? 0 : -slope / length, in_y ? -slope / length : 0, 1 / length};
        const double back[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, WIDTH, 0, 0, 1};
        float colour[3];
        sheet s = sheet_of(2, 2, beyond, 4, true);
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        fill(&s, 0.4f);
        s.figure.double_sided = 1, s.figure.left_handed = i / 10 & 1;
        for (int32_t v = 0; v < s.mesh.vertex_count; v++)
            s.mesh.points[3 * v + 2] = (float)(slope * s.mesh.points[3 * v + (in_y ? 1 : 0)] * (i >= 20 && !in_y ? -1 : 1));
        s.figure.to_world = i >= 20 ? back : NULL; /* mirrored in x, and with it its slope */
        draw(canvas, &s.figure);
        read_all(canvas, pixels);
        skinslide_false_colour(0.4f, colour);
        for (int k = 0; k < 3; k++)
            assert_near(pixels[HEIGHT / 3][WIDTH / 3][k], colour[k] * shade(n), 2e-3);
        end_sheet(&s);
    }
}

/* Where faces of two windings meet in every vertex, their normals cancel: they are lit as if they faced the camera. */
static void where_normals_cancel_colours_are_plain(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    static const float points[3][3] = {{-WIDTH, -HEIGHT, 0}, {3 * WIDTH, -HEIGHT, 0}, {-WIDTH, 3 * HEIGHT, 0}};
    static const int32_t counts[2] = {3, 3}, indices[6] = {0, 1, 2, 0, 2, 1}, faces[2] = {0, 1};
    static const float values[3] = {0.4f, 0.4f, 0.4f};
    const double sizes[3] = {1, 1e-9, 1e9};
    const skinslide_mesh mesh = {sizeof(skinslide_mesh), 3, 2, 6, counts, indices, &points[0][0], NULL, NULL, NULL};
    skinslide_tessellation *both;
    skinslide_error error;
    assert_ok(skinslide_tessellation_create(&mesh, NULL, faces, 2, &both, &error), &error);
    for (int i = 0; i < 3; i++) {
        float scaled[3][3];
        double s = 1 / sizes[i], back[16] = {s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, 0, 0, 0, 1};
        for (int k = 0; k < 9; k++)
            (&scaled[0][0])[k] = (float)(sizes[i] * (&points[0][0])[k]);
        skinslide_figure figure = SKINSLIDE_FIGURE_DEFAULT;
        figure.tessellation = both, figure.points = &scaled[0][0], figure.to_world = back;
        figure.values = values, figure.double_sided = 1;
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        draw(canvas, &figure);
        read_all(canvas, pixels);
        assert_true(is_share(pixels[HEIGHT / 2][WIDTH / 2], 0.4f));
    }
    skinslide_tessellation_destroy(both);
}

/* ---- In front and behind ---- */

/* Surfaces lie behind themselves by their slope over the width of an outline: 1.5 pixels. */
static void the_nearer_hides_the_farther(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    for (int order = 0; order < 2; order++) {
        sheet s[2] = {sheet_of(2, 2, beyond, 4, true), sheet_of(3, 1, beyond, 3, true)};
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        fill(&s[0], 0.1f), fill(&s[1], 0.9f);
        for (int32_t v = 0; v < s[0].mesh.vertex_count; v++)
            s[0].mesh.points[3 * v + 2] = s[0].mesh.points[3 * v] - WIDTH / 2.0f;
        draw(canvas, &s[order].figure), draw(canvas, &s[1 - order].figure);
        read_all(canvas, pixels);
        for (int32_t x = 0; x < WIDTH; x++) /* the second is red */
            if (abs(x - WIDTH / 2) > 2)
                assert_int_equal(pixels[HEIGHT / 2][x][0] > 0.5f, x < WIDTH / 2);
        end_sheet(&s[0]), end_sheet(&s[1]);
    }
}

/* Turned away from the camera: left out, unless double-sided. Winding, orientation and a mirroring each turn it over. */
static void backs_are_left_out(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    const double mirror[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, WIDTH, 0, 0, 1};
    const double turn[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, WIDTH, 0, 0, 1};
    for (int i = 0; i < 32; i++) {
        sheet s = sheet_of(2, 2, beyond, 4, true);
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        skinslide_camera camera = in_pixels(WIDTH, HEIGHT);
        bool flipped = i & 16;
        s.figure.left_handed = i & 1, s.figure.double_sided = i >> 1 & 1;
        s.figure.to_world = i & 4 ? mirror : i & 8 ? turn : NULL;
        if (flipped) /* a picture as in a looking-glass shows the same sides */
            camera.to_screen[0] *= -1, camera.to_screen[12] *= -1;
        draw_in(canvas, whole, &s.figure, camera);
        read_all(canvas, pixels);
        /* A mirrored mesh faces as it did: with its shape, its outside is mirrored in x alone. Turned half round, it does
         * not. */
        bool away = (i & 1) != ((i & 12) == 8);
        assert_int_equal(is_colour(pixels[HEIGHT / 3][WIDTH / 3], blue, 0.01), away && !(i & 2));
        end_sheet(&s);
    }
}

/* ---- The outline ---- */

static const float orange[3] = {0.90f, 0.22f, 0.02f};

/* The side between two faces, at x = 100 of 200, of a picture 900 high: two pixels wide. In front of its own faces however they
 * slope, behind what is nearer than it, in front of what is farther. */
static void the_outline_is_on_top(void **state) {
    (void)state;
    enum { TALL = 900, ACROSS = 200 };
    static pixel pixels[TALL][ACROSS];
    static const double slopes[6] = {0, 1, -1, 4, 0.001, -4}, box[4] = {-100, -20, 300, 920}, cover[4] = {0, 450, 200, 900};
    for (int i = 0; i < 6; i++) {
        sheet s = sheet_of(2, 1, box, 1, true), near = sheet_of(1, 1, cover, 0, true);
        skinslide_canvas *canvas = canvas_of(ACROSS, TALL, SKINSLIDE_PIXELS_FLOATS);
        for (int32_t v = 0; v < s.mesh.vertex_count; v++)
            s.mesh.points[3 * v + 2] = (float)(slopes[i] * (s.mesh.points[3 * v] - 100));
        for (int32_t v = 0; v < near.mesh.vertex_count; v++)
            near.mesh.points[3 * v + 2] = 10;
        draw_in(canvas, (skinslide_viewport){0, 0, ACROSS, TALL}, &s.figure, in_pixels(ACROSS, TALL));
        draw_in(canvas, (skinslide_viewport){0, 0, ACROSS, TALL}, &near.figure, in_pixels(ACROSS, TALL));
        read_all(canvas, pixels);
        for (int32_t row = 0; row < TALL; row++) {
            bool covered = row < TALL / 2;
            assert_int_equal(is_colour(pixels[row][99], orange, 1e-3), !covered);
            assert_int_equal(is_colour(pixels[row][100], orange, 1e-3), !covered);
            assert_false(is_colour(pixels[row][97], orange, 0.1) || is_colour(pixels[row][102], orange, 0.1));
        }
        end_sheet(&s), end_sheet(&near);
    }
}

/* Whether a place of the picture, in pixels, is within `most` pixels of a segment, of which what is behind the near plane is
 * cut off: ends in clip space. */
static bool is_near(double x, double y, const double a[4], const double b[4], double most) {
    enum { STEPS = 4000 };
    double from = 0, to = 1, a_ahead = a[2] + a[3], b_ahead = b[2] + b[3];
    if (a_ahead <= 0 && b_ahead <= 0)
        return false;
    if (a_ahead < 0)
        from = a_ahead / (a_ahead - b_ahead);
    if (b_ahead < 0)
        to = a_ahead / (a_ahead - b_ahead);
    double ends[2][2];
    for (int end = 0; end < 2; end++) {
        double share = end ? to : from, at[4];
        for (int k = 0; k < 4; k++)
            at[k] = a[k] + share * (b[k] - a[k]);
        ends[end][0] = (at[0] / at[3] + 1) * WIDTH / 2, ends[end][1] = (at[1] / at[3] + 1) * HEIGHT / 2;
    }
    double dx = ends[1][0] - ends[0][0], dy = ends[1][1] - ends[0][1], length = dx * dx + dy * dy;
    double share = length > 0 ? fmin(fmax(((x - ends[0][0]) * dx + (y - ends[0][1]) * dy) / length, 0), 1) : 0;
    return hypot(ends[0][0] + share * dx - x, ends[0][1] + share * dy - y) < most;
}

/* A tessellation for all faces drawn with the outline of some is the picture of one for these, where both have the same
 * triangles. */
static void an_outline_of_its_own(void **state) {
    (void)state;
    static uint8_t apart[HEIGHT * WIDTH * 4], together[HEIGHT * WIDTH * 4];
    const double box[4] = {10, 10, 70, 50};
    sheet some = sheet_of(6, 4, box, 7, true), all = sheet_of(6, 4, box, 24, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
    int32_t faces[7] = {0, 1, 2, 3, 4, 5, 6}, none[1] = {24};
    skinslide_outline *outline = NULL;
    skinslide_camera camera = in_pixels(WIDTH, HEIGHT);
    skinslide_error error;
    assert_ok(skinslide_outline_create(all.tessellation, faces, 7, &outline, &error), &error);
    all.figure.outline = outline;
    draw(canvas, &some.figure);
    read_all(canvas, apart);
    draw(canvas, &all.figure);
    read_all(canvas, together);
    assert_memory_equal(apart, together, sizeof apart);
    some.figure.outline = outline;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &some.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the outline is another tessellation's");
    skinslide_outline_destroy(outline);
    assert_fails(skinslide_outline_create(all.tessellation, none, 1, &outline, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "face 24 is not one of the mesh's 24");
    assert_fails(skinslide_outline_create(NULL, faces, 7, &outline, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no tessellation, or no place for the outline");
    skinslide_outline_destroy(NULL);
    end_sheet(&some), end_sheet(&all);
}

/* ---- Strokes ---- */

static const float purple[3] = {0.80f, 0.02f, 0.30f}, white[3] = {0.95f, 0.93f, 0.88f};

/* Faces of 24 by 32 pixels, of which the first row is the patch: of its sides those inside it are drawn, thinly; on its outline
 * the outline is. */
static void sides_of_the_patch_are_drawn(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    sheet s = sheet_of(4, 2, everywhere, 4, true);
    fill(&s, 0.5f);
    for (int wire = 0; wire < 2; wire++) {
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        s.figure.wire = wire;
        draw(canvas, &s.figure);
        read_all(canvas, pixels);
        for (int32_t x = 2; x < WIDTH - 2; x++) {
            bool side = x % 24 == 0 || x % 24 == 23;
            assert_int_equal(is_share(pixels[HEIGHT - 10][x], 0.5f), !(side && wire)); /* the lower row is the first */
            assert_true(is_colour(pixels[10][x], (float[3]){0.33f, 0.31f, 0.30f}, 1e-3));
        }
        assert_int_equal(pixels[HEIGHT - 10][24][1] < 0.5f, wire);
    }
    end_sheet(&s);
}

/* Faces of 24 by 32 pixels, of which the first row is the patch. An edge has the colour of its value, on a dark border; the
 * same the other way round; none of those outside the patch, of no face, or of vertices that are none is drawn. */
static void edges_have_the_colour_of_their_value(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH], without[HEIGHT][WIDTH];
    const int32_t edges[][2] = {{1, 6}, {8, 3}, {6, 11}, {1, 7}, {0, 99}, {-1, 0}}; /* at x = 24, 72; above; across; none */
    const float values[] = {0.9f, 0.1f, 0.9f, 0.9f, 0.9f, 0.9f};
    sheet s = sheet_of(4, 2, everywhere, 4, true);
    fill(&s, 0.5f);
    for (int some = 0; some < 2; some++) {
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        s.figure.edges = edges[0], s.figure.edge_values = values, s.figure.edge_count = some ? 6 : 0, s.figure.line = 2;
        draw(canvas, &s.figure);
        read_all(canvas, some ? pixels : without);
    }
    for (int32_t y = 0; y < HEIGHT; y++)
        for (int32_t x = 0; x < WIDTH; x++) {
            bool near = y >= HEIGHT / 2 - 6 && ((x >= 19 && x <= 28) || (x >= 67 && x <= 76));
            assert_true(near || memcmp(pixels[y][x], without[y][x], sizeof(pixel)) == 0);
        }
    for (int32_t y = HEIGHT - 2; y > HEIGHT / 2 + 4; y--) {
        assert_true(is_share(pixels[y][24], 0.9f) && is_share(pixels[y][72], 0.1f));
        assert_true(pixels[y][20][1] < 0.1f && pixels[y][68][1] < 0.1f);
    }
    end_sheet(&s);
}

/* What is nearer hides an edge that is painted. */
static void hidden_edges_are_not_drawn(void **state) {
    (void)state;
    static pixel pixels[2][HEIGHT][WIDTH];
    const int32_t edge[2] = {1, 4};
    const float value = 0.9f;
    sheet s = sheet_of(2, 1, everywhere, 2, true), front = sheet_of(2, 1, everywhere, 2, true);
    fill(&s, 0.5f), fill(&front, 0.5f);
    for (int32_t v = 0; v < 6; v++)
        front.mesh.points[3 * v + 2] = 50;
    for (int some = 0; some < 2; some++) {
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        s.figure.edges = edge, s.figure.edge_values = &value, s.figure.edge_count = some;
        draw(canvas, &s.figure);
        draw(canvas, &front.figure);
        read_all(canvas, pixels[some]);
    }
    assert_memory_equal(pixels[0], pixels[1], sizeof pixels[0]);
    end_sheet(&s), end_sheet(&front);
}

/* A dot at a pin of the patch, none at one outside; a line to a vertex from where it came. */
static void pins_and_ways_are_drawn(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    uint8_t pins[15] = {0};
    float ways[45] = {0};
    sheet s = sheet_of(4, 2, everywhere, 4, true); /* vertices 5 to 9 are at y = 32, x = 0, 24, .. */
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    fill(&s, 0.5f);
    pins[2] = pins[12] = 1, ways[3 * 7] = ways[3 * 12] = 20;
    s.figure.pins = pins, s.figure.ways = ways;
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_true(is_colour(pixels[HEIGHT - 1][48], purple, 1e-3)); /* vertex 2, at (48, 0) */
    assert_false(is_colour(pixels[HEIGHT - 5][48], purple, 0.1));
    assert_false(is_colour(pixels[0][48], purple, 0.1));         /* vertex 12, above */
    assert_true(is_colour(pixels[HEIGHT / 2][48], white, 1e-3)); /* vertex 7, at (48, 32), which came from (28, 32) */
    for (int32_t x = 0; x < WIDTH; x++)
        if (x < 26 || x > 51)
            assert_false(pixels[HEIGHT / 2][x][2] > 0.5f && pixels[HEIGHT / 2][x][0] > 0.5f);
        else if (x > 29 && x < 49)
            assert_true(pixels[HEIGHT / 2][x][2] > 0.3f);
    s.figure.line = 3;
    canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_true(is_colour(pixels[HEIGHT - 5][48], purple, 1e-3)); /* 13.5 pixels wide */
    end_sheet(&s);
}

/* ---- Ghosts ---- */

/* The left half is the patch, and another sheet of the same mesh lies before all of it: it covers what is outside, and darkens
 * the patch by its share alone. Behind, it is not seen. */
static void what_hides_the_patch_is_a_shadow(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    const float plain[3] = {0.33f, 0.31f, 0.30f};
    float colour[3], thin[3];
    skinslide_false_colour(0.9f, colour);
    for (int k = 0; k < 3; k++)
        thin[k] = 0.16f * plain[k] + 0.84f * colour[k];
    for (int i = 0; i < 3; i++) {         /* no ghosts; ghosts; ghosts of what is behind */
        test_mesh pair = quad_grid(2, 3); /* faces 0, 1 are the lower sheet, 4, 5 the upper; 2, 3 join them, edge-on */
        skinslide_mesh view = view_of(&pair);
        float values[12];
        int32_t patch[1] = {0};
        skinslide_error error;
        skinslide_tessellation *own;
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        for (int32_t v = 0; v < 12; v++) {
            int row = v / 3, column = v % 3;
            float *p = pair.points + 3 * v;
            values[v] = 0.9f, p[0] = (float)(row < 2 ? column : 2 - column) * WIDTH / 2.0f;
            p[1] = row == 0 || row == 3 ? 0 : HEIGHT, p[2] = (float)(row < 2 ? 0 : i < 2 ? 50 : -50);
        }
        assert_ok(skinslide_tessellation_create(&view, NULL, patch, 1, &own, &error), &error);
        skinslide_figure figure = SKINSLIDE_FIGURE_DEFAULT;
        figure.tessellation = own, figure.points = pair.points, figure.values = values;
        figure.ghosts = i > 0, figure.double_sided = 1;
        draw(canvas, &figure);
        read_all(canvas, pixels);
        const float *seen = i == 0 ? plain : i == 1 ? thin : colour;
        for (int32_t x = 6; x < WIDTH; x++)
            if (abs(x - WIDTH / 2) > 4)
                for (int k = 0; k < 3; k++)
                    assert_near(pixels[HEIGHT / 2][x][k], x < WIDTH / 2 ? seen[k] : plain[k], 2e-3);
        skinslide_tessellation_destroy(own);
        free_mesh(&pair);
    }
}

/* ---- Textures ---- */

/* Two tiles side by side over three quarters of a sheet, whose st goes from 0 to 2; a chequer where there is none. */
static void tiles_are_drawn_where_st_is(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    static const uint8_t rows[2][4] = {{255, 0, 0, 0}, {0, 255, 0, 0}}, white_one[1][4] = {{255, 255, 255, 0}};
    skinslide_colour_tile tiles[2] = {SKINSLIDE_COLOUR_TILE_DEFAULT, SKINSLIDE_COLOUR_TILE_DEFAULT};
    sheet s = sheet_of(2, 1, everywhere, 2, true);
    for (int32_t v = 0; v < s.tessellation->vertex_count; v++)
        s.tessellation->fixed[v].coordinates[0] *= 3;
    tiles[0].pixels = rows[0], tiles[0].width = 1, tiles[0].height = 2; /* red above green */
    tiles[1].pixels = white_one[0], tiles[1].number = 1002, tiles[1].width = tiles[1].height = 1;
    s.figure.tiles = tiles, s.figure.tile_count = 2, s.figure.squares = 0.1f;
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    for (int32_t x = 2; x < WIDTH - 2; x++)
        if (x % 32 > 1 && x % 32 < 30) {
            const float *high = pixels[4][x], *low = pixels[HEIGHT - 5][x];
            const double above[3] = {x < 64, x >= 32 && x < 64, x >= 32 && x < 64};
            const double below[3] = {x >= 32 && x < 64, x < 64, x >= 32 && x < 64};
            if (x < 64)
                assert_colour(high, above), assert_colour(low, below);
            else
                assert_colour(high, dark), assert_colour(low, dark);
        }
    end_sheet(&s);
}

static void tiles_that_cannot_be(void **state) {
    (void)state;
    static const uint8_t white_one[4] = {255, 255, 255, 255};
    sheet s = sheet_of(1, 1, everywhere, 1, true), space = sheet_of(1, 1, everywhere, 1, false);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    skinslide_camera camera = in_pixels(WIDTH, HEIGHT);
    skinslide_error error;
    skinslide_colour_tile tile = SKINSLIDE_COLOUR_TILE_DEFAULT;
    s.figure.tiles = &tile, s.figure.tile_count = 1;
    tile.pixels = white_one, tile.width = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "tile 1001 has 1 by 0 pixels; each side may have 1 to 16384");
    tile.height = 1, tile.number = 1000;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "tile 1000 has no pixels, or no place in a UDIM");
    s.figure.tile_count = 1001;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "1001 tiles of a texture; there may be 0 to 1000");
    tile.number = 1001, space.figure.tiles = &tile, space.figure.tile_count = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &space.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "there is no st for the tiles of a texture");
    s.figure.line = -1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "lines -1 times as wide as usual; they may be 0 to 1000");
    s.figure.line = 0;
    float ways[12] = {[4] = NAN};
    s.figure.tile_count = 0, s.figure.ways = ways;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_POINTS,
                 "ways: vertex 1 is not finite: (0, nan, 0)");
    s.figure.ways = NULL, s.figure.edge_count = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "1 edges to be drawn, without their values");
    const int32_t edge[2] = {0, 1};
    s.figure.edges = edge, s.figure.edge_values = &ways[4], s.figure.highest = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_POINTS,
                 "the value of edge 0-1 is nan");
    s.figure.lowest = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "a scale from 1 to 1");
    end_sheet(&s), end_sheet(&space);
}

/* ---- Targets ---- */

/* The left half is the patch; a sheet of the same mesh, two faces farther on, lies before its upper quarter. */
static sheet folded_sheet(void) {
    sheet s = sheet_of(2, 3, everywhere, 1, true);
    for (int32_t v = 0; v < 12; v++) {
        int row = v / 3, column = v % 3;
        float *p = s.mesh.points + 3 * v;
        p[0] = (float)(row < 2 ? column : 2 - column) * WIDTH / 2.0f, p[2] = row < 2 ? 0 : 50;
        p[1] = row == 0 ? 0 : row == 3 ? 0.75f * HEIGHT : HEIGHT;
        s.values[v] = (float)v / 12;
    }
    s.figure.ghosts = s.figure.wire = s.figure.double_sided = 1, s.figure.squares = 7;
    return s;
}

/* Four targets at once are the four pictures, byte for byte: values, a texture over a chequer, other values, a chequer. */
static void targets_are_pictures(void **state) {
    (void)state;
    static uint8_t alone[HEIGHT][WIDTH][4], target[HEIGHT][WIDTH][4];
    static const uint8_t texels[2][4] = {{255, 40, 0, 0}, {0, 255, 90, 0}};
    const skinslide_canvas_options options = {sizeof options, WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES, SKINSLIDE_ANY_DEVICE, 4};
    skinslide_colour_tile tile = SKINSLIDE_COLOUR_TILE_DEFAULT;
    skinslide_look looks[4] = {SKINSLIDE_LOOK_DEFAULT, SKINSLIDE_LOOK_DEFAULT, SKINSLIDE_LOOK_DEFAULT, SKINSLIDE_LOOK_DEFAULT};
    skinslide_canvas *canvas = NULL;
    skinslide_error error;
    sheet s = folded_sheet();
    float others[12];
    for (int32_t v = 0; v < 12; v++)
        others[v] = 1 - s.values[v];
    tile.pixels = texels[0], tile.width = 1, tile.height = 2;
    looks[0].values = s.values, looks[1].tiles = &tile, looks[1].tile_count = 1;
    looks[2].values = others, looks[2].lowest = -1;
    assert_ok(skinslide_canvas_create(&options, &canvas, &error), &error);
    for (int32_t count = 1; count <= 4; count++) {
        skinslide_figure all = s.figure;
        all.values = looks[0].values, all.lowest = 0, all.highest = 1, all.others = looks + 1, all.other_count = count - 1;
        assert_ok(skinslide_canvas_clear(canvas, blue, &error), &error);
        draw(canvas, &all);
        for (int32_t i = 0; i < 4; i++) {
            skinslide_canvas *single = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
            s.figure.values = looks[i].values, s.figure.lowest = looks[i].lowest, s.figure.highest = looks[i].highest;
            s.figure.tiles = looks[i].tiles, s.figure.tile_count = looks[i].tile_count;
            if (i < count)
                draw(single, &s.figure);
            read_all(single, alone);
            assert_ok(skinslide_canvas_read_target(canvas, i, target, &error), &error);
            assert_same_bytes(target, alone, sizeof alone);
        }
    }
    skinslide_canvas_destroy(canvas);
    end_sheet(&s);
}

static void targets_that_cannot_be(void **state) {
    (void)state;
    static uint8_t pixels[HEIGHT][WIDTH][4];
    skinslide_canvas_options options = SKINSLIDE_CANVAS_OPTIONS_DEFAULT;
    skinslide_canvas *made = NULL, *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
    const skinslide_camera camera = in_pixels(WIDTH, HEIGHT);
    skinslide_look look = SKINSLIDE_LOOK_DEFAULT;
    skinslide_error error;
    sheet s = sheet_of(1, 1, everywhere, 1, true);
    for (int32_t i = 0; i < 2; i++) {
        options.targets = (const int32_t[]){5, -1}[i];
        assert_fails(skinslide_canvas_create(&options, &made, &error), &error, SKINSLIDE_BAD_ARGUMENT, "a canvas of ...");
    }
    s.figure.others = &look, s.figure.other_count = 1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "1 other looks; the canvas has targets for 0");
    s.figure.other_count = -1;
    assert_fails(skinslide_canvas_draw(canvas, &whole, &camera, &s.figure, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "-1 other looks; the canvas has targets for 0");
    assert_fails(skinslide_canvas_read_target(canvas, 1, pixels, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "there is no target 1; the canvas has 1");
    assert_fails(skinslide_canvas_read_target(canvas, -1, pixels, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "there is no target -1; the canvas has 1");
    end_sheet(&s);
}

/* The stencil has a number for each of 255 figures. Where the patches of those before were, what hides this one's is drawn. */
static void many_figures_leave_marks(void **state) {
    (void)state;
    static pixel first[HEIGHT][WIDTH], last[HEIGHT][WIDTH];
    sheet s = folded_sheet();
    skinslide_camera far_away = in_pixels(WIDTH, HEIGHT), mirrored = far_away;
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    far_away.to_camera[14] = -500;
    mirrored.to_screen[0] = -mirrored.to_screen[0], mirrored.to_screen[12] = 1;
    draw_in(canvas, whole, &s.figure, mirrored);
    read_all(canvas, first);
    canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    for (int i = 0; i < 255; i++)
        draw_in(canvas, i < 254 ? (skinslide_viewport){0, 0, 4, 4} : whole, &s.figure, far_away);
    draw_in(canvas, whole, &s.figure, mirrored);
    read_all(canvas, last);
    assert_same_bytes(&first[0][8], &last[0][8], sizeof(first) - sizeof(pixel[8]) - 4 * sizeof first[0]);
    end_sheet(&s);
}

/* From inside a cube, turned any way: every pixel of the outline is at an edge of the patch, and those of edges that reach
 * behind the camera are nowhere else. */
static void from_inside_nothing_smears(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    test_mesh mesh = cube();
    skinslide_mesh view = view_of(&mesh);
    skinslide_tessellation *box;
    skinslide_error error;
    const int32_t face = 2; /* 0 1 5 4 */
    int32_t found = 0;
    assert_ok(skinslide_tessellation_create(&view, NULL, &face, 1, &box, &error), &error);
    for (int turn = 0; turn < 24; turn++) {
        double c = cos(turn * 0.26), s = sin(turn * 0.26), n = 0.01, f = 10, clips[4][4];
        double rise = (turn % 3 - 1) * 0.7, u = cos(rise), w = sin(rise);
        /* About z, then about x, and the projection of a field of view of 90 degrees. */
        const double turned[16] = {c, s * u, s * w, 0, -s, c * u, c * w, 0, 0, -w, u, 0, 0, 0, 0, 1};
        double shift[3] = {0.5, 0.2, 0.5};
        skinslide_camera camera = {
            .to_screen = {1, 0, 0, 0, 0, 1.5, 0, 0, 0, 0, -(f + n) / (f - n), -1, 0, 0, -2 * f * n / (f - n), 0}};
        memcpy(camera.to_camera, turned, sizeof turned);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                camera.to_camera[12 + k] -= shift[j] * turned[4 * j + k];
        for (int v = 0; v < 4; v++) {
            const float *p = mesh.points + 3 * mesh.face_indices[8 + v];
            double at[4];
            for (int k = 0; k < 4; k++)
                at[k] = camera.to_camera[12 + k] + p[0] * camera.to_camera[k] + p[1] * camera.to_camera[4 + k] +
                        p[2] * camera.to_camera[8 + k];
            for (int k = 0; k < 4; k++)
                clips[v][k] = at[0] * camera.to_screen[k] + at[1] * camera.to_screen[4 + k] + at[2] * camera.to_screen[8 + k] +
                              at[3] * camera.to_screen[12 + k];
        }
        skinslide_figure figure = {
            .size = sizeof(skinslide_figure), .tessellation = box, .points = mesh.points, .squares = 0.01f, .double_sided = 1};
        skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
        draw_in(canvas, whole, &figure, camera);
        read_all(canvas, pixels);
        for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
            int32_t x = i % WIDTH, y = HEIGHT - 1 - i / WIDTH;
            bool at_edge = false;
            if (!is_colour(pixels[i / WIDTH][x], orange, 0.2))
                continue;
            for (int k = 0; k < 4; k++)
                at_edge = at_edge || is_near(x + 0.5, y + 0.5, clips[k], clips[(k + 1) % 4], 2.5);
            assert_true(at_edge);
            found++;
        }
    }
    assert_true(found > 300);
    skinslide_tessellation_destroy(box);
    free_mesh(&mesh);
}

/* A floor that reaches from far ahead of the camera to far behind it, of which the patch has both: it makes no difference where
 * on it is what is behind. Vertices that are next to those ahead stay. */
static void what_is_behind_is_nowhere(void **state) {
    (void)state;
    enum { ROWS = 16 };
    static pixel pictures[2][HEIGHT][WIDTH];
    static const double square[4] = {-12, -21, 12, 19};
    const double n = 0.01, f = 100;
    const skinslide_camera camera = {
        .to_camera = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}, /* along y, z up */
        .to_screen = {1, 0, 0, 0, 0, 1.5, 0, 0, 0, 0, -(f + n) / (f - n), -1, 0, 0, -2 * f * n / (f - n), 0}};
    for (int ghosts = 0; ghosts < 2; ghosts++) {
        sheet s = sheet_of(12, ROWS, square, 12 * 3 * ROWS / 4, true);
        s.figure.double_sided = 1, s.figure.ghosts = ghosts, s.figure.squares = 9;
        for (int32_t v = 0; v < s.mesh.vertex_count; v++)
            s.mesh.points[3 * v + 2] = -0.5f;
        for (int moved = 0; moved < 2; moved++) {
            for (int32_t v = 0; moved && v < s.mesh.vertex_count; v++)
                s.mesh.points[3 * v] *= s.mesh.points[3 * v + 1] < -2 ? -1 : 1;
            skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
            draw_in(canvas, whole, &s.figure, camera);
            read_all(canvas, pictures[moved]);
        }
        assert_same_bytes(pictures[0], pictures[1], sizeof pictures[0]);
        assert_true(is_colour(pictures[0][0][0], blue, 1e-3) && !is_colour(pictures[0][HEIGHT - 1][WIDTH / 2], blue, 0.1));
        end_sheet(&s);
    }
}

/* ---- A part of a picture ---- */

/* A torus with creases and a mesh of polygons in perspective, as a whole; and each of 4 by 4 parts by itself, in which most is
 * out of sight: the same pixels, but for a sample here and there. */
static void compare_parts(test_mesh mesh, const skinslide_subdivision *own) {
    enum { PARTS = 4 };
    static uint8_t all[PARTS * HEIGHT][PARTS * WIDTH][4], part[HEIGHT][WIDTH][4];
    const double up[3] = {0, 1, 0};
    skinslide_mesh view = view_of(&mesh);
    int32_t *faces = all_faces(&mesh), differ = 0;
    const float *poses[1] = {mesh.points};
    const skinslide_subject subject = {sizeof(skinslide_subject), &view, faces, mesh.face_count, 1, poses, NULL, 0};
    skinslide_tessellation *drawn;
    skinslide_camera camera;
    skinslide_error error;
    view.subdivision = own;
    assert_ok(skinslide_tessellation_create(&view, NULL, faces, 2, &drawn, &error), &error);
    assert_ok(skinslide_frame_faces(&subject, up, (double)WIDTH / HEIGHT, &camera, &error), &error);
    const skinslide_figure figure = {
        .size = sizeof(skinslide_figure), .tessellation = drawn, .points = mesh.points, .squares = 0.5f, .double_sided = 1};
    skinslide_canvas *canvas = canvas_of(PARTS * WIDTH, PARTS * HEIGHT, SKINSLIDE_PIXELS_BYTES);
    draw_in(canvas, (skinslide_viewport){0, 0, PARTS * WIDTH, PARTS * HEIGHT}, &figure, camera);
    read_all(canvas, all);
    for (int i = 0; i < PARTS * PARTS; i++) {
        skinslide_camera near = camera;
        double middle[2] = {(2.0 * (i % PARTS) + 1) / PARTS - 1, (2.0 * (i / PARTS) + 1) / PARTS - 1};
        for (int row = 0; row < 4; row++)
            for (int k = 0; k < 2; k++)
                near.to_screen[4 * row + k] =
                    PARTS * (camera.to_screen[4 * row + k] - middle[k] * camera.to_screen[4 * row + 3]);
        canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
        draw_in(canvas, whole, &figure, near);
        read_all(canvas, part);
        for (int32_t y = 0; y < HEIGHT; y++)
            for (int32_t x = 0; x < WIDTH; x++)
                for (int k = 0; k < 3; k++)
                    differ += abs(part[y][x][k] - all[(PARTS - 1 - i / PARTS) * HEIGHT + y][i % PARTS * WIDTH + x][k]) > 8;
    }
    assert_in_range(differ, 0, 3 * PARTS * PARTS * WIDTH * HEIGHT / 500);
    skinslide_tessellation_destroy(drawn);
    free(faces);
    free_mesh(&mesh);
}

static void parts_of_pictures_are_theirs(void **state) {
    (void)state;
    test_mesh sharp = torus(16, 12);
    creased c = crease_at_random(&sharp, SKINSLIDE_SCHEME_CATMULL_CLARK, 2);
    const skinslide_subdivision smooth = {.size = sizeof(skinslide_subdivision), .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    compare_parts(sharp, &c.own);
    compare_parts(brick_wall(9, 10), &smooth);
    compare_parts(finger(12, 20), NULL);
    free_creased(&c);
}

/* ---- Any size, anywhere ---- */

static void draw_torus(double scale, const double shift[3], uint8_t *levels) {
    test_mesh mesh = torus(16, 12);
    skinslide_mesh view = view_of(&mesh);
    const skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    const double up[3] = {0, 1, 0}, matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, shift[0], shift[1], shift[2], 1};
    skinslide_tessellation *drawn;
    skinslide_error error;
    int32_t *faces = all_faces(&mesh);
    for (int32_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.points[i] = (float)(scale * mesh.points[i]);
    view.subdivision = &own;
    const float *poses[1] = {mesh.points};
    const skinslide_subject subject = {sizeof(skinslide_subject), &view, faces, 20, 1, poses, matrix, 0};
    skinslide_camera camera;
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_BYTES);
    assert_ok(skinslide_frame_faces(&subject, up, (double)WIDTH / HEIGHT, &camera, &error), &error);
    assert_ok(skinslide_tessellation_create(&view, NULL, faces, 20, &drawn, &error), &error);
    skinslide_figure figure = {.size = sizeof(skinslide_figure),
                               .tessellation = drawn,
                               .points = mesh.points,
                               .to_world = matrix,
                               .squares = (float)(3 / scale)};
    draw_in(canvas, whole, &figure, camera);
    read_all(canvas, levels);
    skinslide_tessellation_destroy(drawn);
    free(faces);
    free_mesh(&mesh);
}

/* Powers of two, so that points are rounded alike; pixels at edges may differ by a sample. */
static void pictures_do_not_know_sizes_or_places(void **state) {
    (void)state;
    static uint8_t plain[HEIGHT * WIDTH * 4], other[HEIGHT * WIDTH * 4];
    static const double scales[4] = {0x1p-20, 0x1p20, 1, 0x1p-60}, shifts[4][3] = {{0}, {0}, {0x1p20, -0x1p21, 0x1p19}, {0}};
    const double nowhere[3] = {0, 0, 0};
    draw_torus(1, nowhere, plain);
    for (int i = 0; i < 4; i++) {
        int32_t differ = 0;
        draw_torus(scales[i], shifts[i], other);
        for (int32_t k = 0; k < HEIGHT * WIDTH * 4; k++)
            differ += abs(plain[k] - other[k]) > 2;
        assert_in_range(differ, 0, HEIGHT * WIDTH * 4 / 200);
    }
}

static void a_million_faces(void **state) {
    (void)state;
    static pixel pixels[HEIGHT][WIDTH];
    sheet s = sheet_of(1000, 1000, beyond, 1000000, true);
    skinslide_canvas *canvas = canvas_of(WIDTH, HEIGHT, SKINSLIDE_PIXELS_FLOATS);
    fill(&s, 0.5f);
    draw(canvas, &s.figure);
    read_all(canvas, pixels);
    assert_true(is_share(pixels[HEIGHT / 2][WIDTH / 2], 0.5f));
    end_sheet(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_covered_is_drawn),
        cmocka_unit_test(the_top_comes_first),
        cmocka_unit_test(squares_are_where_st_is),
        cmocka_unit_test(small_squares_are_grey),
        cmocka_unit_test(no_squares_are_too_small),
        cmocka_unit_test(squares_in_space_go_with_the_mesh),
        cmocka_unit_test(paler_outside_the_patch),
        cmocka_unit_test(false_colours_are_those_of_the_scale),
        cmocka_unit_test(shares_clamp),
        cmocka_unit_test(slopes_are_shaded),
        cmocka_unit_test(where_normals_cancel_colours_are_plain),
        cmocka_unit_test(the_nearer_hides_the_farther),
        cmocka_unit_test(backs_are_left_out),
        cmocka_unit_test(the_outline_is_on_top),
        cmocka_unit_test(an_outline_of_its_own),
        cmocka_unit_test(sides_of_the_patch_are_drawn),
        cmocka_unit_test(edges_have_the_colour_of_their_value),
        cmocka_unit_test(hidden_edges_are_not_drawn),
        cmocka_unit_test(pins_and_ways_are_drawn),
        cmocka_unit_test(what_hides_the_patch_is_a_shadow),
        cmocka_unit_test(targets_are_pictures),
        cmocka_unit_test(targets_that_cannot_be),
        cmocka_unit_test(many_figures_leave_marks),
        cmocka_unit_test(tiles_are_drawn_where_st_is),
        cmocka_unit_test(tiles_that_cannot_be),
        cmocka_unit_test(from_inside_nothing_smears),
        cmocka_unit_test(what_is_behind_is_nowhere),
        cmocka_unit_test(parts_of_pictures_are_theirs),
        cmocka_unit_test(pictures_do_not_know_sizes_or_places),
        cmocka_unit_test(a_million_faces),
    };
    return cmocka_run_group_tests_name("figure", tests, NULL, destroy_canvases);
}
