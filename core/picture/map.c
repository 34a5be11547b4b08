/* Draws values of a mesh's vertices, or of its corners, in its texture coordinates.
 *
 * A row of texel centres at height y crosses the side from a up to b where a.y <= y < b.y. The side's column is the first whose
 * centre is on it or right of it, found exactly; a triangle covers the columns from one of its two crossed sides up to the
 * other's. So every centre in triangles side by side is covered by one of them, and never by two.
 *
 *     value(p) = sum of area(p, the other two corners) value(corner) / area
 *
 * Then, DILATION times, each uncovered texel that touches covered ones, along a side or at a corner, takes their mean. All in
 * double, one texel after the other: the same bytes on every machine. */
#include "paint.h"
#include "picture.h"

#include <math.h>
#include <string.h>

enum { DILATION = 4 };

/* A triangle of a face's fan, its corners in texels from the lower left corner of the tile. */
typedef struct triangle {
    double corner[3][2];
    float value[3];
} triangle;

typedef struct map {
    const skinslide_texture_layout *layout;
    int32_t *face_start; /* [mesh face_count + 1] */
    int32_t *tiles;      /* [index_count] of each corner */
    int32_t tile, side;
    const float *values; /* [vertex_count], or by corner [index_count] */
    bool by_corner;
    float *texels;           /* [side][side] from the top row on; NAN: not covered */
    float *rows[3];          /* [side + 2] each, for the dilation */
    int32_t low[2], high[2]; /* columns and rows [low, high) hold all that is covered */
} map;

/* Rows count from the lowest. */
static float *row_of(const map *m, int32_t row) {
    return m->texels + (int64_t)(m->side - 1 - row) * m->side;
}

static void widen(map *m, int axis, int32_t from, int32_t to) {
    m->low[axis] = from < m->low[axis] ? from : m->low[axis];
    m->high[axis] = to > m->high[axis] ? to : m->high[axis];
}

/* ---- Triangles ---- */

/* The first column whose centre, at height y, is on the side from a up to b or right of it: 0 to side. The division is off by
 * far less than a column. */
static int32_t column_of(const double a[2], const double b[2], double y, int32_t side) {
    double crossing = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    int32_t column = (int32_t)fmin(fmax(ceil(crossing - 0.5), 0), side);
    if (column > 0 && ss_orient(a, b, (double[2]){column - 0.5, y}) <= 0)
        return column - 1;
    if (column < side && ss_orient(a, b, (double[2]){column + 0.5, y}) > 0)
        return column + 1;
    return column;
}

/* The columns [from, to) that a triangle covers in the row at height y. */
static void cross_row(const triangle *t, double y, int32_t side, int32_t *from, int32_t *to) {
    *from = side, *to = 0;
    for (int i = 0; i < 3; i++) {
        const double *a = t->corner[i], *b = t->corner[(i + 1) % 3];
        if ((a[1] <= y) == (b[1] <= y))
            continue;
        int32_t column = a[1] <= y ? column_of(a, b, y, side) : column_of(b, a, y, side);
        *from = column < *from ? column : *from;
        *to = column > *to ? column : *to;
    }
}

static double cross(const double a[2], const double b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

/* The value at p: of double arithmetic, and however thin the triangle is, not outside those of its corners. */
static float value_at(const triangle *t, const double p[2]) {
    const double *a = t->corner[0];
    const double b[2] = {t->corner[1][0] - a[0], t->corner[1][1] - a[1]},
                 c[2] = {t->corner[2][0] - a[0], t->corner[2][1] - a[1]};
    const double along[2] = {p[0] - a[0], p[1] - a[1]}, area = cross(b, c);
    double at_b = area != 0 ? cross(along, c) / area : 0, at_c = area != 0 ? cross(b, along) / area : 0;
    float value = (float)((1 - at_b - at_c) * t->value[0] + at_b * t->value[1] + at_c * t->value[2]);
    float low = t->value[0], high = t->value[0];
    for (int i = 1; i < 3; i++) {
        low = t->value[i] < low ? t->value[i] : low;
        high = t->value[i] > high ? t->value[i] : high;
    }
    return value < low ? low : value > high ? high : value;
}

/* Whether it covers a texel. */
static bool draw_triangle(map *m, const triangle *t) {
    bool covers = false;
    double lowest = fmin(t->corner[0][1], fmin(t->corner[1][1], t->corner[2][1]));
    double highest = fmax(t->corner[0][1], fmax(t->corner[1][1], t->corner[2][1]));
    int32_t last = (int32_t)fmin(m->side - 1, floor(highest - 0.5));
    for (int32_t row = (int32_t)fmax(0, ceil(lowest - 0.5)); row <= last; row++) {
        int32_t from, to;
        cross_row(t, row + 0.5, m->side, &from, &to);
        if (from >= to)
            continue;
        covers = true;
        widen(m, 0, from, to), widen(m, 1, row, row + 1);
        for (int32_t x = from; x < to; x++)
            row_of(m, row)[x] = value_at(t, (double[2]){x + 0.5, row + 0.5});
    }
    return covers;
}

/* ---- Faces ---- */

static bool is_in_tile(const map *m, int32_t face) {
    for (int32_t c = m->face_start[face]; c < m->face_start[face + 1]; c++)
        if (m->tiles[c] == m->tile)
            return true;
    return false;
}

static void place_corner(const map *m, int32_t corner, double place[2]) {
    int32_t tile = m->tile - SS_FIRST_TILE;
    const float *st = m->layout->st + 2 * (int64_t)corner;
    place[0] = ((double)st[0] - tile % SS_TILE_COLUMNS) * m->side;
    place[1] = ((double)st[1] - tile / SS_TILE_COLUMNS) * m->side;
}

/* Where the value of a corner is among the values. */
static int32_t place_of_value(const map *m, int32_t corner) {
    return m->by_corner ? corner : m->layout->mesh->face_indices[corner];
}

/* The fan of a face. Whether it covers a texel. */
static bool draw_face(map *m, int32_t face) {
    bool covers = false;
    int32_t first = m->face_start[face];
    for (int32_t c = first + 1; c + 1 < m->face_start[face + 1]; c++) {
        const int32_t corners[3] = {first, c, c + 1};
        triangle t;
        for (int i = 0; i < 3; i++) {
            place_corner(m, corners[i], t.corner[i]);
            t.value[i] = m->values[place_of_value(m, corners[i])];
        }
        covers = draw_triangle(m, &t) || covers;
    }
    return covers;
}

/* Returns how many faces of the tile cover no texel. */
static int32_t draw_faces(map *m) {
    int32_t missed = 0;
    for (int64_t i = 0; i < (int64_t)m->side * m->side; i++)
        m->texels[i] = NAN;
    for (int32_t i = 0; i < m->layout->face_count; i++)
        if (is_in_tile(m, m->layout->faces[i]))
            missed += !draw_face(m, m->layout->faces[i]);
    return missed;
}

/* ---- Dilation ---- */

/* A row as it is now with a texel more at both ends; beyond the texture nothing is covered. */
static void copy_row(const map *m, int32_t row, float *out) {
    for (int32_t x = m->low[0] - 1; x <= m->high[0]; x++)
        out[x + 1] = row >= 0 && row < m->side && x >= 0 && x < m->side ? row_of(m, row)[x] : NAN;
}

/* The mean of the covered texels among nine, whose columns begin at x of the copied rows; NAN where there are none. */
static float mean_of(float *const rows[3], int32_t x) {
    double sum = 0;
    int32_t count = 0;
    for (int i = 0; i < 9; i++) {
        float texel = rows[i / 3][x + i % 3];
        if (!isnan(texel))
            sum += texel, count++;
    }
    return count > 0 ? (float)(sum / count) : NAN;
}

static void dilate(map *m) {
    float *rows[3] = {m->rows[0], m->rows[1], m->rows[2]};
    for (int axis = 0; axis < 2; axis++)
        widen(m, axis, m->low[axis] > 0 ? m->low[axis] - 1 : 0, m->high[axis] < m->side ? m->high[axis] + 1 : m->side);
    copy_row(m, m->low[1] - 1, rows[0]);
    copy_row(m, m->low[1], rows[1]);
    for (int32_t row = m->low[1]; row < m->high[1]; row++) {
        copy_row(m, row + 1, rows[2]);
        for (int32_t x = m->low[0]; x < m->high[0]; x++)
            if (isnan(rows[1][x + 1]))
                row_of(m, row)[x] = mean_of(rows, x);
        float *first = rows[0];
        rows[0] = rows[1], rows[1] = rows[2], rows[2] = first;
    }
}

/* ---- What is drawn ---- */

static skinslide_status check(const skinslide_texture_layout *layout, int32_t tile, const float *values, int32_t side,
                              const float *texels, skinslide_error *error) {
    if (!layout || !values || !texels)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no layout, values, or place for the texels");
    if (tile < SS_FIRST_TILE || tile >= SS_FIRST_TILE + SS_TILE_COLUMNS * SS_TILE_ROWS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such tile: %d", tile);
    if (side < 1 || side > SKINSLIDE_LARGEST_MAP)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a map of %d texels a side; it must have 1 to %d", side,
                       SKINSLIDE_LARGEST_MAP);
    return SKINSLIDE_OK;
}

static skinslide_status check_values(const map *m, skinslide_error *error) {
    for (int32_t i = 0; i < m->layout->face_count; i++) {
        int32_t face = m->layout->faces[i];
        for (int32_t c = m->face_start[face]; c < m->face_start[face + 1]; c++) {
            float value = m->values[place_of_value(m, c)];
            skinslide_status status = ss_check_value(m->layout->mesh->face_indices[c], value, error);
            if (status)
                return status;
        }
    }
    return SKINSLIDE_OK;
}

static skinslide_status prepare(map *m, ss_memory *memory, skinslide_error *error) {
    const skinslide_texture_layout *layout = m->layout;
    const skinslide_mesh *mesh = layout->mesh;
    m->tiles = SS_NEW(memory, int32_t, mesh->index_count);
    m->face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    for (int k = 0; k < 3; k++)
        m->rows[k] = SS_NEW(memory, float, m->side + 2);
    if (memory->failed)
        return ss_out_of_memory(error);
    ss_start_faces(mesh, m->face_start);
    skinslide_status status = skinslide_texture_tiles(layout, m->tiles, error);
    return status ? status : check_values(m, error);
}

static skinslide_status draw(map *m, int32_t *missed_faces, skinslide_error *error) {
    ss_taken_layout taken;
    skinslide_status status = check(m->layout, m->tile, m->values, m->side, m->texels, error);
    if (!status)
        status = ss_take_layout(&m->layout, &taken, error);
    if (status)
        return status;
    ss_memory memory = {0};
    m->low[0] = m->low[1] = m->side;
    status = prepare(m, &memory, error);
    if (!status) {
        int32_t missed = draw_faces(m);
        for (int pass = 0; pass < DILATION; pass++)
            dilate(m);
        for (int64_t i = 0; i < (int64_t)m->side * m->side; i++)
            m->texels[i] = isnan(m->texels[i]) ? 0 : m->texels[i];
        if (missed_faces)
            *missed_faces = missed;
    }
    ss_free(&memory);
    return status;
}

skinslide_status skinslide_map_draw(const skinslide_texture_layout *layout, int32_t tile, const float *values, int32_t side,
                                    float *texels, int32_t *missed_faces, skinslide_error *error) {
    map m = {.layout = layout, .tile = tile, .values = values, .side = side, .texels = texels};
    return draw(&m, missed_faces, error);
}

skinslide_status skinslide_map_draw_corners(const skinslide_texture_layout *layout, int32_t tile, const float *values,
                                            int32_t side, float *texels, int32_t *missed_faces, skinslide_error *error) {
    map m = {.layout = layout, .tile = tile, .values = values, .by_corner = true, .side = side, .texels = texels};
    return draw(&m, missed_faces, error);
}
