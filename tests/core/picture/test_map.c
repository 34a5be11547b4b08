/* Maps drawn in texture coordinates: which texels are covered against whole numbers, values against barycentric coordinates,
 * dilation against the rule applied once more, tiles, order, faces without a texel. */
#include "skinslide/picture.h"
#include "support.h"

#include <float.h>
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
    skinslide_texture_layout layout;
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
    s->layout = (skinslide_texture_layout){sizeof(skinslide_texture_layout), &s->view, s->faces, mesh.face_count, s->st};
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

static float *draw(const scene *s, int32_t side, int32_t tile, int32_t *missed) {
    float *texels = malloc((size_t)side * (size_t)side * sizeof *texels);
    assert_ok(skinslide_map_draw(&s->layout, tile, s->values, side, texels, missed, &error), &error);
    return texels;
}

/* Row y from the bottom. */
static float at(const float *texels, int32_t side, int32_t x, int32_t y) {
    return texels[(side - 1 - y) * side + x];
}

/* ---- Which texels are covered ---- */

/* A square over the whole texture, of value 0, and triangles of value 1, in units of 1/UNITS texel. */
enum { TILE = 32, UNITS = 8, MOST_TRIANGLES = 128 };

typedef struct whole_triangle {
    int32_t corner[3][2];
} whole_triangle;

/* How often each texel is covered when every triangle is drawn alone over the square: [TILE][TILE], the lowest row first. */
static int32_t *coverage_of(const whole_triangle *triangles, int32_t count) {
    int32_t face_counts[1 + MOST_TRIANGLES] = {4}, indices[4 + 3 * MOST_TRIANGLES] = {0, 1, 2, 3};
    float st[2 * (4 + 3 * MOST_TRIANGLES)] = {0, 0, 1, 0, 1, 1, 0, 1}, values[7] = {0, 0, 0, 0, 1, 1, 1};
    for (int32_t i = 0; i < count; i++) {
        face_counts[1 + i] = 3;
        for (int k = 0; k < 3; k++) {
            indices[4 + 3 * i + k] = 4 + k;
            for (int axis = 0; axis < 2; axis++)
                st[2 * (4 + 3 * i + k) + axis] = (float)triangles[i].corner[k][axis] / (TILE * UNITS);
        }
    }
    const skinslide_mesh mesh = {
        sizeof(skinslide_mesh), 7, 1 + count, 4 + 3 * count, face_counts, indices, NULL, NULL, NULL, NULL};
    int32_t *covered = calloc(TILE * TILE, sizeof *covered);
    float texels[TILE * TILE];
    for (int32_t f = 1; f <= count; f++) {
        const int32_t faces[2] = {0, f};
        const skinslide_texture_layout layout = {sizeof(skinslide_texture_layout), &mesh, faces, 2, st};
        assert_ok(skinslide_map_draw(&layout, 1001, values, TILE, texels, NULL, &error), &error);
        for (int32_t i = 0; i < TILE * TILE; i++)
            covered[i] += texels[(TILE - 1 - i / TILE) * TILE + i % TILE] == 1;
    }
    return covered;
}

/* Which way a, b, and p turn, in whole numbers; where they are on a line, for a p a little to the right, and less up. */
static int turn(const int32_t a[2], const int32_t b[2], const int32_t p[2]) {
    int64_t x = b[0] - a[0], y = b[1] - a[1], area = x * (p[1] - a[1]) - y * (p[0] - a[0]);
    int64_t told = area ? area : y ? -y : x;
    return (told > 0) - (told < 0);
}

static bool holds(const whole_triangle *triangle, const int32_t p[2]) {
    int turns[3];
    for (int i = 0; i < 3; i++)
        turns[i] = turn(triangle->corner[i], triangle->corner[(i + 1) % 3], p);
    return turns[0] && turns[0] == turns[1] && turns[0] == turns[2];
}

/* Corners in eighths of a texel, so that centres are on sides, at corners and in triangles without area all the time. */
static void texels_in_whole_numbers(void **state) {
    (void)state;
    dice d = {3};
    for (int round = 0; round < 40; round++) {
        whole_triangle triangles[50];
        int32_t size = 1 + roll_below(&d, TILE * UNITS), step = round % 2 ? UNITS / 2 : 1;
        for (int i = 0; i < 50; i++)
            for (int k = 0; k < 6; k++)
                triangles[i].corner[k / 2][k % 2] =
                    roll_below(&d, size) / step * step + (TILE * UNITS - size) / 2 / step * step;
        int32_t *covered = coverage_of(triangles, 50);
        for (int32_t t = 0; t < TILE * TILE; t++) {
            const int32_t p[2] = {(t % TILE) * UNITS + UNITS / 2, (t / TILE) * UNITS + UNITS / 2};
            int32_t expected = 0;
            for (int i = 0; i < 50; i++)
                expected += holds(&triangles[i], p);
            assert_int_equal(covered[t], expected);
        }
        free(covered);
    }
}

/* A grid of triangles of which the inner corners are shaken: each texel is in one of them, however sides run. */
static void neighbours_share_no_texel_and_leave_none(void **state) {
    (void)state;
    dice d = {5};
    for (int round = 0; round < 40; round++) {
        test_mesh mesh = triangle_grid(8, 8);
        whole_triangle triangles[MOST_TRIANGLES];
        int32_t step = 1 << round % 3, (*places)[2] = calloc((size_t)mesh.vertex_count, sizeof *places);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            for (int k = 0; k < 2; k++) {
                int32_t place = (int32_t)mesh.points[3 * v + k], inside = place > 0 && place < 8;
                places[v][k] = place * TILE * UNITS / 8 + inside * (roll_below(&d, 17) - 8) / step * step;
            }
        for (int32_t i = 0; i < 3 * mesh.face_count; i++)
            memcpy(triangles[i / 3].corner[i % 3], places[mesh.face_indices[i]], sizeof *places);
        int32_t *covered = coverage_of(triangles, mesh.face_count);
        for (int32_t t = 0; t < TILE * TILE; t++)
            assert_int_equal(covered[t], 1);
        free(covered), free(places);
        free_mesh(&mesh);
    }
}

/* ---- Texels by barycentric coordinates ---- */

typedef struct answer {
    double value;
    bool covered;
} answer;

static double doubled_area(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The value of the last triangle that holds the texel's centre. */
static answer search(const scene *s, int32_t side, int32_t x, int32_t y) {
    answer found = {0, false};
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
            }
            if (!inside)
                continue;
            found.covered = true, found.value = 0;
            for (int i = 0; i < 3; i++)
                found.value += weight[i] * s->values[s->mesh.face_indices[corners[i]]];
        }
    return found;
}

/* Returns how many texels were compared, to the rounding of values up to 5. */
static int32_t compare_with_search(const scene *s, int32_t side) {
    float *texels = draw(s, side, 1001, NULL);
    int32_t compared = 0;
    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++) {
            answer expected = search(s, side, x, y);
            if (!expected.covered)
                continue;
            compared++;
            assert_near(at(texels, side, x, y), expected.value, 5 * FLT_EPSILON);
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
        assert_in_range(compare_with_search(&s, 64), 500, 64 * 64);
        free_scene(&s);
    }
}

/* Slivers 20 texels long and a hundredth of one to a few wide, in the far corner: interpolation from the texture's own corner,
 * in float, would be off by 1e-2. */
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
        compared += compare_with_search(&s, SIDE);
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
        float *texels = draw(&s, SIDE, 1001, &missed);
        for (int32_t i = 0; i < SIDE * SIDE; i++)
            assert_true(texels[i] == 0 || (texels[i] >= lowest && texels[i] <= highest));
        assert_in_range(missed, 0, s.mesh.face_count);
        free(texels);
        free_scene(&s);
    }
}

/* ---- Dilation ---- */

/* The rule once more: each of four times, texels that touch covered ones take their mean. */
static void dilate_again(float *values, bool *covered, int32_t side) {
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

/* Charts whose borders lie between texel centres, one of them at the border of the texture. */
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
    dilate_again(expected, covered, SIDE);
    assert_same_bytes(texels, expected, SIDE * SIDE * sizeof *texels); /* sums of eight floats from 1e-4 to 5 are exact */
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
    s.layout.face_count = 1;
    float *texels = draw(&s, 32, 1001, NULL);
    assert_near(at(texels, 32, 16, 16), 2, 0);
    free(texels);
    s.layout.face_count = 0;
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
    float *first = draw(&s, 32, 1001, NULL);
    for (int32_t i = 0; i < 2 * s.mesh.index_count; i++)
        s.st[i] += 1;
    float *empty = draw(&s, 32, 1001, NULL), *moved = draw(&s, 32, 1012, NULL);
    assert_same_bytes(moved, first, 32 * 32 * sizeof *moved);
    for (int32_t i = 0; i < 32 * 32; i++)
        assert_near(empty[i], 0, 0);
    assert_true(at(moved, 32, 16, 16) != 0);
    free(first), free(empty), free(moved);
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

/* What the memory for the texels held before leaves no trace. */
static void a_map_is_drawn_over_another(void **state) {
    (void)state;
    scene large, small;
    fill_scene(&large, square_grid(4, 0, 1), 1);
    fill_scene(&small, square_grid(2, 0.4f, 0.6f), 2);
    float *alone = draw(&small, 64, 1001, NULL), *after = draw(&large, 64, 1001, NULL);
    assert_ok(skinslide_map_draw(&small.layout, 1001, small.values, 64, after, NULL, &error), &error);
    assert_same_bytes(after, alone, 64 * 64 * sizeof(float));
    free(alone), free(after);
    free_scene(&large), free_scene(&small);
}

/* One sum of bytes (FNV-1a) for every processor and compiler. */
static void the_same_bytes_on_every_machine(void **state) {
    (void)state;
    enum { LARGE = 256 };
    scene s;
    fill_scene(&s, square_grid(7, 0.13f, 0.91f), 11);
    dice d = {11};
    for (int32_t c = 0; c < s.mesh.index_count; c++)
        s.st[2 * c] += 0.1f * (float)roll_share(&d) - 0.05f;
    float *texels = draw(&s, LARGE, 1001, NULL);
    uint64_t sum = 14695981039346656037u;
    for (int32_t i = 0; i < LARGE * LARGE; i++) {
        uint32_t bits;
        memcpy(&bits, &texels[i], sizeof bits);
        for (int k = 0; k < 4; k++)
            sum = (sum ^ (bits >> 8 * k & 255)) * 1099511628211u;
    }
    assert_int_equal(sum, 0xccbc5d24385d7555);
    free(texels);
    free_scene(&s);
}

/* ---- What cannot be ---- */

static void refuse(const scene *s, int32_t tile, int32_t side, skinslide_status expected, const char *text) {
    float texels[16 * 16];
    int32_t missed = 77;
    memset(texels, 0x55, sizeof texels);
    assert_fails(skinslide_map_draw(&s->layout, tile, s->values, side, texels, &missed, &error), &error, expected, text);
    for (size_t i = 0; i < sizeof texels; i++)
        assert_int_equal(((unsigned char *)texels)[i], 0x55);
    assert_int_equal(missed, 77);
}

static void bad_arguments(void **state) {
    (void)state;
    scene s;
    fill_scene(&s, square_grid(2, 0.1f, 0.9f), 1);
    float texels[256];
    refuse(&s, 1000, 16, SKINSLIDE_BAD_ARGUMENT, "no such tile: 1000");
    refuse(&s, 10001, 16, SKINSLIDE_BAD_ARGUMENT, "no such tile: 10001");
    refuse(&s, 1001, 0, SKINSLIDE_BAD_ARGUMENT, "a map of 0 texels a side; it must have 1 to 16384");
    refuse(&s, 1001, 16385, SKINSLIDE_BAD_ARGUMENT, "a map of 16385 texels a side; it must have 1 to 16384");
    assert_fails(skinslide_map_draw(NULL, 1001, s.values, 16, texels, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no layout, values, or place for the texels");
    assert_fails(skinslide_map_draw(&s.layout, 1001, NULL, 16, texels, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no ...");
    assert_fails(skinslide_map_draw(&s.layout, 1001, s.values, 16, NULL, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no ...");
    s.values[4] = NAN;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_POINTS, "vertex 4 has the value nan");
    s.values[4] = 0, s.st[2 * 5] = INFINITY;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_CONTROL, "face 1 has st (inf, ...");
    s.st[2 * 5] = -0.25f;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_CONTROL, "face 1 has st (-0.25, 0.1), which is in no UDIM tile");
    s.layout.face_count = 1; /* of the others nothing is asked */
    free(draw(&s, 16, 1001, NULL));
    s.faces[0] = 4;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_ARGUMENT, "face 4 is not one of the mesh's 4");
    s.layout.st = NULL;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_ARGUMENT, "no texture coordinates, ...");
    s.view.face_indices = NULL;
    refuse(&s, 1001, 16, SKINSLIDE_BAD_ARGUMENT, "...");
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_in_whole_numbers),
        cmocka_unit_test(neighbours_share_no_texel_and_leave_none),
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
        cmocka_unit_test(a_map_is_drawn_over_another),
        cmocka_unit_test(the_same_bytes_on_every_machine),
        cmocka_unit_test(bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
