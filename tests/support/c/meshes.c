/* Fixtures: see meshes.h. */
#include "meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Random numbers: splitmix64 (Steele, Lea, Flood 2014) ---- */

uint64_t roll(dice *d) {
    uint64_t z = d->state += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
}

int32_t roll_below(dice *d, int32_t bound) {
    return (int32_t)(roll(d) % (uint64_t)bound);
}

double roll_share(dice *d) {
    return (double)(roll(d) >> 11) * 0x1p-53;
}

double roll_between(dice *d, double low, double high) {
    return low + (high - low) * roll_share(d);
}

/* ---- Meshes ---- */

static void *room(int64_t count, size_t size) {
    void *memory = calloc((size_t)(count ? count : 1), size);
    if (!memory)
        abort();
    return memory;
}

static test_mesh new_mesh(int32_t vertex_count, int32_t face_count, int32_t index_count) {
    return (test_mesh){vertex_count,
                       face_count,
                       index_count,
                       room(face_count, sizeof(int32_t)),
                       room(index_count, sizeof(int32_t)),
                       room(3 * (int64_t)vertex_count, sizeof(float))};
}

test_mesh copy_mesh(int32_t vertex_count, int32_t face_count, const int32_t *face_counts, const int32_t *face_indices,
                    const float *points) {
    int32_t indices = 0;
    for (int32_t f = 0; f < face_count; f++)
        indices += face_counts[f];
    test_mesh mesh = new_mesh(vertex_count, face_count, indices);
    memcpy(mesh.face_counts, face_counts, (size_t)face_count * sizeof *face_counts);
    memcpy(mesh.face_indices, face_indices, (size_t)indices * sizeof *face_indices);
    memcpy(mesh.points, points, (size_t)vertex_count * sizeof(float[3]));
    return mesh;
}

void free_mesh(test_mesh *mesh) {
    free(mesh->face_counts);
    free(mesh->face_indices);
    free(mesh->points);
    *mesh = (test_mesh){0};
}

skinslide_mesh view_of(const test_mesh *mesh) {
    skinslide_mesh view = SKINSLIDE_MESH_DEFAULT;
    view.vertex_count = mesh->vertex_count, view.face_count = mesh->face_count, view.index_count = mesh->index_count;
    view.face_counts = mesh->face_counts, view.face_indices = mesh->face_indices, view.rest_points = mesh->points;
    return view;
}

static void put_point(test_mesh *mesh, int32_t vertex, double x, double y, double z) {
    float *p = mesh->points + 3 * (int64_t)vertex;
    p[0] = (float)x, p[1] = (float)y, p[2] = (float)z;
}

static void add_face(test_mesh *mesh, int32_t count, const int32_t *vertices) {
    memcpy(mesh->face_indices + mesh->index_count, vertices, (size_t)count * sizeof *vertices);
    mesh->face_counts[mesh->face_count++] = count;
    mesh->index_count += count;
}

/* A mesh to which faces are added one by one: with room for them, but none yet. */
static test_mesh empty_mesh(int32_t vertex_count, int32_t face_room, int32_t index_room) {
    test_mesh mesh = new_mesh(vertex_count, face_room, index_room);
    mesh.face_count = mesh.index_count = 0;
    return mesh;
}

static test_mesh grid(int32_t columns, int32_t rows, bool triangles) {
    int32_t wide = columns + 1, cells = columns * rows;
    test_mesh mesh = empty_mesh(wide * (rows + 1), 2 * cells, 6 * cells);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        put_point(&mesh, v, v % wide, v / wide, 0);
    for (int32_t j = 0; j < rows; j++)
        for (int32_t i = 0; i < columns; i++) {
            int32_t a = j * wide + i, quad[4] = {a, a + 1, a + 1 + wide, a + wide}, turn = (i + j) % 2;
            if (!triangles) {
                add_face(&mesh, 4, quad);
                continue;
            }
            add_face(&mesh, 3, (int32_t[]){quad[turn], quad[turn + 1], quad[turn + 2]});
            add_face(&mesh, 3, (int32_t[]){quad[turn], quad[turn + 2], quad[(turn + 3) % 4]});
        }
    return mesh;
}

test_mesh quad_grid(int32_t columns, int32_t rows) {
    return grid(columns, rows, false);
}

test_mesh triangle_grid(int32_t columns, int32_t rows) {
    return grid(columns, rows, true);
}

test_mesh without_faces(const test_mesh *mesh, bool (*drop)(const test_mesh *mesh, int32_t face)) {
    test_mesh left = empty_mesh(mesh->vertex_count, mesh->face_count, mesh->index_count);
    memcpy(left.points, mesh->points, (size_t)mesh->vertex_count * sizeof(float[3]));
    for (int32_t f = 0, c = 0; f < mesh->face_count; c += mesh->face_counts[f++])
        if (!drop(mesh, f))
            add_face(&left, mesh->face_counts[f], mesh->face_indices + c);
    return left;
}

static bool in_either_hole(const test_mesh *mesh, int32_t face) {
    int32_t cell = mesh->face_counts[0] == 3 ? face / 2 : face, i = cell % 10, j = cell / 10;
    return (i >= 2 && i < 4 && j >= 2 && j < 4) || (i == 7 && j >= 4 && j < 7);
}

test_mesh grid_with_holes(bool triangles) {
    test_mesh whole = grid(10, 10, triangles), left = without_faces(&whole, in_either_hole);
    free_mesh(&whole);
    return left;
}

/* Quads between the closed rings of a sheet. */
static void add_rings(test_mesh *mesh, int32_t around, int32_t rings) {
    for (int32_t r = 0; r < rings; r++)
        for (int32_t i = 0; i < around; i++) {
            int32_t a = r * around + i, b = r * around + (i + 1) % around;
            add_face(mesh, 4, (int32_t[]){a, b, b + around, a + around});
        }
}

test_mesh annulus(int32_t around, int32_t rings) {
    test_mesh mesh = empty_mesh(around * (rings + 1), around * rings, 4 * around * rings);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        double angle = 2 * acos(-1) * (v % around) / around, radius = 2.0 - 1.0 * (v / around) / rings;
        put_point(&mesh, v, radius * cos(angle), radius * sin(angle), 0);
    }
    add_rings(&mesh, around, rings);
    return mesh;
}

test_mesh finger(int32_t around, int32_t rings) {
    int32_t tip = around * (rings + 1);
    test_mesh mesh = empty_mesh(tip + 1, around * (rings + 1), around * (4 * rings + 3));
    double step = 2 * acos(-1) / around;
    for (int32_t v = 0; v < tip; v++)
        put_point(&mesh, v, cos(step * (v % around)), sin(step * (v % around)), step * (v / around));
    put_point(&mesh, tip, 0, 0, step * rings + 1);
    add_rings(&mesh, around, rings);
    for (int32_t i = 0; i < around; i++)
        add_face(&mesh, 3, (int32_t[]){rings * around + i, rings * around + (i + 1) % around, tip});
    return mesh;
}

/* Each brick spans two cells of a grid, shifted by one cell every other row: inner bricks have a vertex more above and below.
 */
test_mesh brick_wall(int32_t columns, int32_t rows) {
    int32_t wide = 2 * columns + 1, cells = 2 * columns * rows;
    test_mesh mesh = empty_mesh(wide * (rows + 1), cells, 6 * cells);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        put_point(&mesh, v, v % wide, v / wide, 0);
    for (int32_t j = 0; j < rows; j++)
        for (int32_t i = -(j % 2); i < 2 * columns; i += 2) {
            int32_t from = i < 0 ? 0 : i, to = i + 2 > 2 * columns ? 2 * columns : i + 2, brick[6], n = 0;
            for (int32_t k = from; k <= to; k++)
                brick[n++] = j * wide + k;
            for (int32_t k = to; k >= from; k--)
                brick[n++] = (j + 1) * wide + k;
            add_face(&mesh, n, brick);
        }
    return mesh;
}

test_mesh polygon(int32_t sides) {
    test_mesh mesh = new_mesh(sides, 1, sides);
    mesh.face_counts[0] = sides;
    for (int32_t v = 0; v < sides; v++) {
        mesh.face_indices[v] = v;
        put_point(&mesh, v, cos(2 * acos(-1) * v / sides), sin(2 * acos(-1) * v / sides), 0);
    }
    return mesh;
}

test_mesh join_meshes(const test_mesh *a, const test_mesh *b) {
    test_mesh mesh =
        new_mesh(a->vertex_count + b->vertex_count, a->face_count + b->face_count, a->index_count + b->index_count);
    memcpy(mesh.points, a->points, (size_t)a->vertex_count * sizeof(float[3]));
    memcpy(mesh.points + 3 * (int64_t)a->vertex_count, b->points, (size_t)b->vertex_count * sizeof(float[3]));
    memcpy(mesh.face_counts, a->face_counts, (size_t)a->face_count * sizeof(int32_t));
    memcpy(mesh.face_counts + a->face_count, b->face_counts, (size_t)b->face_count * sizeof(int32_t));
    for (int32_t c = 0; c < mesh.index_count; c++)
        mesh.face_indices[c] = c < a->index_count ? a->face_indices[c] : b->face_indices[c - a->index_count] + a->vertex_count;
    return mesh;
}

/* ---- Random disks: faces as lists, changed by moves that keep a disk ---- */

enum { MOST_CORNERS = 12, MOST_FACES = 512, MOST_VERTICES = 512 };

typedef struct growth {
    int32_t faces, vertices;
    int32_t count[MOST_FACES];
    int32_t corner[MOST_FACES][MOST_CORNERS];
    dice d;
} growth;

/* The face with the side from b to a, and where it is in the face; -1 if there is none. */
static int32_t face_across(const growth *g, int32_t a, int32_t b, int32_t *place) {
    for (int32_t f = 0; f < g->faces; f++)
        for (*place = 0; *place < g->count[f]; ++*place)
            if (g->corner[f][*place] == b && g->corner[f][(*place + 1) % g->count[f]] == a)
                return f;
    return -1;
}

static void insert_corner(growth *g, int32_t face, int32_t after, int32_t vertex) {
    int32_t *corners = g->corner[face];
    memmove(corners + after + 2, corners + after + 1, (size_t)(g->count[face] - after - 1) * sizeof *corners);
    corners[after + 1] = vertex;
    g->count[face]++;
}

static void split_edge(growth *g, int32_t face, int32_t k) {
    int32_t place, other = face_across(g, g->corner[face][k], g->corner[face][(k + 1) % g->count[face]], &place);
    if (g->count[face] == MOST_CORNERS || (other >= 0 && g->count[other] == MOST_CORNERS))
        return;
    if (other >= 0)
        insert_corner(g, other, place, g->vertices);
    insert_corner(g, face, k, g->vertices++);
}

/* A new edge from corner 0 to corner k, unless its ends already share one. */
static void add_diagonal(growth *g, int32_t face, int32_t k) {
    int32_t *corners = g->corner[face], n = g->count[face], place;
    if (k < 2 || k > n - 2 || face_across(g, corners[0], corners[k], &place) >= 0 ||
        face_across(g, corners[k], corners[0], &place) >= 0)
        return;
    int32_t *half = g->corner[g->faces];
    half[0] = corners[0];
    memcpy(half + 1, corners + k, (size_t)(n - k) * sizeof *half);
    g->count[g->faces++] = n - k + 1;
    g->count[face] = k + 1;
}

/* A vertex inside the face, joined to every corner. */
static void star_face(growth *g, int32_t face) {
    int32_t n = g->count[face], old[MOST_CORNERS];
    memcpy(old, g->corner[face], sizeof old);
    for (int32_t k = 0; k < n; k++) {
        int32_t f = k == 0 ? face : g->faces++;
        memcpy(g->corner[f], (int32_t[]){old[k], old[(k + 1) % n], g->vertices}, 3 * sizeof(int32_t));
        g->count[f] = 3;
    }
    g->vertices++;
}

/* A triangle outside a boundary side. */
static void add_ear(growth *g, int32_t face, int32_t k) {
    int32_t a = g->corner[face][k], b = g->corner[face][(k + 1) % g->count[face]], place;
    if (face_across(g, a, b, &place) >= 0)
        return;
    memcpy(g->corner[g->faces], (int32_t[]){b, a, g->vertices++}, 3 * sizeof(int32_t));
    g->count[g->faces++] = 3;
}

static void grow_once(growth *g) {
    int32_t face = roll_below(&g->d, g->faces), k = roll_below(&g->d, g->count[face]);
    switch (roll_below(&g->d, 5)) {
    case 0:
        split_edge(g, face, k);
        break;
    case 1:
        star_face(g, face);
        break;
    case 2:
        add_ear(g, face, k);
        break;
    default:
        add_diagonal(g, face, k);
    }
}

test_mesh random_disk(uint64_t seed, int32_t steps) {
    static _Thread_local growth g;
    g = (growth){.faces = 1, .vertices = 5, .count = {5}, .corner = {{0, 1, 2, 3, 4}}, .d = {seed}};
    for (int32_t i = 0; i < steps && g.faces + MOST_CORNERS < MOST_FACES && g.vertices + 2 < MOST_VERTICES; i++)
        grow_once(&g);
    test_mesh mesh = empty_mesh(g.vertices, g.faces, g.faces * MOST_CORNERS);
    for (int32_t f = 0; f < g.faces; f++)
        add_face(&mesh, g.count[f], g.corner[f]);
    for (int32_t v = 0; v < mesh.vertex_count; v++)
        put_point(&mesh, v, roll_share(&g.d), roll_share(&g.d), roll_share(&g.d));
    return mesh;
}

/* ---- Poses ---- */

float *copy_points(const test_mesh *mesh) {
    float *points = room(3 * (int64_t)mesh->vertex_count, sizeof *points);
    memcpy(points, mesh->points, (size_t)mesh->vertex_count * sizeof(float[3]));
    return points;
}

static void bump(float *points, int32_t vertex_count, double x, double y, double radius, double height) {
    for (int32_t v = 0; v < vertex_count; v++) {
        float *p = points + 3 * (int64_t)v;
        double dx = p[0] - x, dy = p[1] - y, share = exp(-(dx * dx + dy * dy) / (radius * radius));
        p[0] = (float)(p[0] + 0.4 * height * share);
        p[2] = (float)(p[2] + height * share);
    }
}

static void shake(float *points, int32_t vertex_count, dice *d, double amount) {
    for (int64_t i = 0; i < 3 * (int64_t)vertex_count; i++)
        points[i] = (float)(points[i] + roll_between(d, -amount, amount));
}

float *bumped(const test_mesh *mesh, double x, double y, double radius, double height) {
    float *points = copy_points(mesh);
    bump(points, mesh->vertex_count, x, y, radius, height);
    return points;
}

float *shaken(const test_mesh *mesh, uint64_t seed, double amount) {
    dice d = {seed};
    float *points = copy_points(mesh);
    shake(points, mesh->vertex_count, &d, amount);
    return points;
}

float *random_pose(const test_mesh *mesh, uint64_t seed) {
    dice d = {seed};
    float *points = copy_points(mesh);
    double size = extent_of(points, mesh->vertex_count), shear = roll_between(&d, -1, 1);
    const float *at = points + 3 * (int64_t)roll_below(&d, mesh->vertex_count);
    double x = at[0], y = at[1];
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        points[3 * (int64_t)v] += (float)shear * points[3 * (int64_t)v + 1];
    bump(points, mesh->vertex_count, x, y, roll_between(&d, 0.05, 0.4) * size, roll_between(&d, -0.5, 0.5) * size);
    shake(points, mesh->vertex_count, &d, roll_between(&d, 0, 0.05) * size);
    return points;
}

double extent_of(const float *points, int32_t vertex_count) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, square = 0;
    for (int64_t i = 0; i < 3 * (int64_t)vertex_count; i++) {
        low[i % 3] = fmin(low[i % 3], points[i]);
        high[i % 3] = fmax(high[i % 3], points[i]);
    }
    for (int k = 0; k < 3; k++)
        square += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(square);
}

/* ---- The corpus ---- */

/* Edges of no length, faces of no area, and slivers. */
static test_mesh flawed_grid(void) {
    test_mesh mesh = triangle_grid(6, 6);
    put_point(&mesh, 24, 2, 3, 0); /* from (3,3) to its neighbour's place */
    put_point(&mesh, 16, 2.000001, 1, 0);
    put_point(&mesh, 32, 3, 4, 0); /* was (4,4) */
    return mesh;
}

test_mesh cube(void) {
    static const float points[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const int32_t counts[6] = {4, 4, 4, 4, 4, 4};
    static const int32_t faces[24] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
    return copy_mesh(8, 6, counts, faces, &points[0][0]);
}

test_mesh octahedron(void) {
    static const float points[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const int32_t counts[8] = {3, 3, 3, 3, 3, 3, 3, 3};
    static const int32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    return copy_mesh(6, 8, counts, faces, &points[0][0]);
}

test_mesh torus(int32_t around, int32_t across) {
    float points[256][3];
    int32_t counts[256], faces[256][4];
    for (int32_t j = 0; j < across; j++)
        for (int32_t i = 0; i < around; i++) {
            int32_t v = j * around + i, up = (j + 1) % across * around, right = (i + 1) % around;
            double a = 6.283185307179586 * i / around, b = 6.283185307179586 * j / across, r = 3 + cos(b);
            points[v][0] = (float)(r * cos(a)), points[v][1] = (float)(r * sin(a)), points[v][2] = (float)sin(b);
            counts[v] = 4;
            faces[v][0] = v, faces[v][1] = j * around + right, faces[v][2] = up + right, faces[v][3] = up + i;
        }
    return copy_mesh(around * across, around * across, counts, &faces[0][0], &points[0][0]);
}

static test_mesh shaken_grid(void) {
    test_mesh mesh = quad_grid(9, 7);
    float *points = shaken(&mesh, 5, 0.3);
    memcpy(mesh.points, points, (size_t)mesh.vertex_count * sizeof(float[3]));
    free(points);
    return mesh;
}

fixture make_fixture(int32_t index) {
    switch (index) {
    case 0:
        return (fixture){"one triangle", 0, false, polygon(3)};
    case 1:
        return (fixture){"one seven-sided face", 0, true, polygon(7)};
    case 2:
        return (fixture){"two by two quads", 0, true, quad_grid(2, 2)};
    case 3:
        return (fixture){"quads", 0, true, quad_grid(12, 9)};
    case 4:
        return (fixture){"triangles", 0, true, triangle_grid(11, 8)};
    case 5:
        return (fixture){"bricks", 0, true, brick_wall(5, 8)};
    case 6:
        return (fixture){"quads with holes", 2, true, grid_with_holes(false)};
    case 7:
        return (fixture){"triangles with holes", 2, true, grid_with_holes(true)};
    case 8:
        return (fixture){"annulus", 1, true, annulus(16, 5)};
    case 9:
        return (fixture){"finger", 0, true, finger(12, 20)};
    case 10:
        return (fixture){"random disk", 0, true, random_disk(11, 300)};
    case 11:
        return (fixture){"another random disk", 0, true, random_disk(12, 200)};
    case 12:
        return (fixture){"triangles with coincident points", 0, true, flawed_grid()};
    default:
        return (fixture){"shaken quads", 0, true, shaken_grid()};
    }
}

int32_t *all_faces(const test_mesh *mesh) {
    int32_t *faces = room(mesh->face_count, sizeof *faces);
    for (int32_t f = 0; f < mesh->face_count; f++)
        faces[f] = f;
    return faces;
}
