/* Meshes made into triangles: on the limit surface or the faces, without cracks, each face wound as it was, outlined where the
 * patch ends. On every fixture, whole and with a part of its faces as the patch, under every scheme. */
#include "creases.h"
#include "picture.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- What is tessellated ---- */

enum { MESH_COUNT = FIXTURE_COUNT + 5, WAYS = 8 };

static test_mesh nth_mesh(int32_t i) {
    switch (i - FIXTURE_COUNT) {
    case 0:
        return cube();
    case 1:
        return octahedron();
    case 2:
        return torus(16, 12);
    case 3:
        return brick_wall(9, 10);
    case 4:
        return triangle_grid(12, 12);
    default:
        return make_fixture(i).mesh;
    }
}

typedef struct made {
    test_mesh mesh;
    creased c;
    int32_t holes[8];
    skinslide_mesh view;
    int32_t *patch, patch_count;
    uint8_t *inside; /* [face_count] */
    float *st, *values, *pose;
    skinslide_tessellation *own;
    ss_tessellation_work work;
    skinslide_error error;
    double size;
} made;

static bool only_triangles(const test_mesh *mesh) {
    for (int32_t f = 0; f < mesh->face_count; f++)
        if (mesh->face_counts[f] != 3)
            return false;
    return true;
}

/* By way: smooth, creased, with holes, boundary rules, smooth triangles, bilinear, loop, none. False where it cannot be. */
static bool choose_scheme(made *m, int32_t way) {
    static const skinslide_scheme schemes[WAYS] = {SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_SCHEME_CATMULL_CLARK,
                                                   SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_SCHEME_CATMULL_CLARK,
                                                   SKINSLIDE_SCHEME_CATMULL_CLARK, SKINSLIDE_SCHEME_BILINEAR,
                                                   SKINSLIDE_SCHEME_LOOP,          SKINSLIDE_SCHEME_NONE};
    m->c = crease_at_random(&m->mesh, schemes[way], 3);
    if (way != 1)
        m->c.own.crease_count = m->c.own.crease_index_count = m->c.own.crease_sharpness_count = m->c.own.corner_count = 0;
    for (int32_t i = 0; i < 8 && way == 2 && 7 * i < m->mesh.face_count; i++)
        m->holes[m->c.own.hole_count++] = 7 * i;
    m->c.own.hole_indices = m->holes;
    m->c.own.boundary_rule = way == 3   ? SKINSLIDE_BOUNDARY_RULE_NONE
                             : way == 4 ? SKINSLIDE_BOUNDARY_RULE_EDGE_ONLY
                                        : SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER;
    m->c.own.triangle_rule = way == 4 ? SKINSLIDE_TRIANGLE_RULE_SMOOTH : SKINSLIDE_TRIANGLE_RULE_CATMULL_CLARK;
    m->view.subdivision = way == WAYS - 1 ? NULL : &m->c.own;
    return schemes[way] != SKINSLIDE_SCHEME_LOOP || only_triangles(&m->mesh);
}

/* All faces; those around vertex 0; or some here and there. */
static void choose_patch(made *m, int32_t kind) {
    dice d = {(uint64_t)kind + 5};
    for (int32_t f = 0, c = 0; f < m->mesh.face_count; c += m->mesh.face_counts[f++]) {
        bool at_first = false;
        for (int32_t k = 0; k < m->mesh.face_counts[f]; k++)
            at_first = at_first || m->mesh.face_indices[c + k] == 0;
        m->inside[f] = kind == 0 || (kind == 1 ? at_first : roll_below(&d, 40) == 0);
        if (m->inside[f])
            m->patch[m->patch_count++] = f;
    }
}

/* Random st at every corner, so that each side of a face is a seam; random values. False where there is no such way. */
static bool make(made *m, int32_t mesh, int32_t way, int32_t patch) {
    *m = (made){.mesh = nth_mesh(mesh)};
    m->view = view_of(&m->mesh);
    m->pose = random_pose(&m->mesh, (uint64_t)mesh + 1);
    m->size = extent_of(m->pose, m->mesh.vertex_count);
    m->patch = calloc((size_t)m->mesh.face_count, sizeof *m->patch), m->inside = calloc((size_t)m->mesh.face_count, 1);
    m->st = calloc((size_t)m->mesh.index_count, sizeof(float[2]));
    m->values = calloc((size_t)m->mesh.vertex_count, sizeof *m->values);
    dice d = {(uint64_t)way};
    for (int32_t i = 0; i < 2 * m->mesh.index_count; i++)
        m->st[i] = (float)roll_between(&d, -1, 3);
    for (int32_t v = 0; v < m->mesh.vertex_count; v++)
        m->values[v] = (float)roll_between(&d, -1, 1);
    choose_patch(m, patch);
    if (!choose_scheme(m, way))
        return false;
    const double origin[3] = {0, 0, 0};
    assert_ok(skinslide_tessellation_create(&m->view, m->st, m->patch, m->patch_count, &m->own, &m->error), &m->error);
    assert_true(ss_tessellation_work_allocate(m->own, &m->work));
    ss_tessellate(m->own, m->pose, origin, &m->work);
    ss_tessellate_values(m->own, m->values, 0, &m->work);
    return true;
}

static void end(made *m) {
    skinslide_tessellation_destroy(m->own);
    ss_free(&m->work.memory);
    free_creased(&m->c);
    free(m->patch), free(m->inside), free(m->st), free(m->values), free(m->pose);
    free_mesh(&m->mesh);
}

/* ---- Places in faces ---- */

/* The place of a vertex of a grid, in the quad at a corner of its face. */
static skinslide_limit_place place_in_grid(const made *m, const ss_grid *grid, int32_t x, int32_t y) {
    float s = (float)x / (float)grid->side, t = (float)y / (float)grid->side;
    int32_t start = m->own->face_start[grid->face];
    if (grid->corner >= 0)
        return (skinslide_limit_place){start + grid->corner, s, t};
    if (t <= 0.5f)
        return s <= 0.5f ? (skinslide_limit_place){start, 2 * s, 2 * t}
                         : (skinslide_limit_place){start + 1, 2 * t, 2 * (1 - s)};
    return s <= 0.5f ? (skinslide_limit_place){start + 3, 2 * (1 - t), 2 * s}
                     : (skinslide_limit_place){start + 2, 2 * (1 - s), 2 * (1 - t)};
}

static double distance(const float *a, const float *b) {
    return sqrt(pow((double)a[0] - b[0], 2) + pow((double)a[1] - b[1], 2) + pow((double)a[2] - b[2], 2));
}

/* Places of all vertices but those that may be joined to a coarse face's, and whether each is at the border of its grid. */
static int32_t list_places(const made *m, skinslide_limit_place *places, int32_t *vertices, bool *at_border) {
    int32_t count = 0;
    for (int32_t p = 0; p < m->own->grid_count; p++) {
        const ss_grid *grid = &m->own->grids[p];
        for (int32_t i = 0, side = grid->side; side && i < (side + 1) * (side + 1); i++) {
            int32_t x = i % (side + 1), y = i / (side + 1);
            at_border[count] = x == 0 || y == 0 || x == side || y == side;
            vertices[count] = grid->first_vertex + i;
            places[count] = place_in_grid(m, grid, x, y);
            count += !at_border[count] || !grid->coarse;
        }
    }
    return count;
}

/* Inside its grid exactly, in float. At the border of a grid, whose places are those of the first face there, as near as
 * surfaces with creases come to each other: 0.027 of the mesh was seen. */
static void check_places(made *m) {
    if (!m->view.subdivision || m->own->flat_faces)
        return;
    size_t most = (size_t)m->own->vertex_count + 1;
    skinslide_limit_place *places = calloc(most, sizeof *places);
    int32_t *vertices = calloc(most, sizeof *vertices);
    bool *at_border = calloc(most, sizeof *at_border);
    float(*expected)[3] = calloc(most, sizeof *expected);
    int32_t count = list_places(m, places, vertices, at_border);
    assert_ok(skinslide_limit_points(&m->view, m->pose, places, count, &expected[0][0], &m->error), &m->error);
    for (int32_t i = 0; i < count; i++)
        assert_near(distance(m->work.vertices[vertices[i]].place, expected[i]), 0,
                    (at_border[i] ? m->c.own.crease_count ? 0.05 : 5e-3 : 1e-6) * m->size);
    free(places), free(vertices), free(at_border), free(expected);
}

/* Fans are the mesh's own vertices; and every face that is not subdivided is one, and none other but the refused. */
static void check_fans(made *m) {
    for (int32_t p = 0; p < m->own->grid_count; p++) {
        const ss_grid *grid = &m->own->grids[p];
        assert_true(m->own->flat_faces || (grid->side == 0) == (m->view.subdivision == NULL));
        for (int32_t k = 0; !grid->side && k < m->mesh.face_counts[grid->face]; k++) {
            int32_t v = m->mesh.face_indices[m->own->face_start[grid->face] + k];
            assert_same_bytes(m->work.vertices[grid->first_vertex + k].place, m->pose + 3 * v, sizeof(float[3]));
        }
    }
}

/* ---- Sides ---- */

enum { MOST_ALONG = 17 };

static uint32_t vertex_at(const ss_grid *grid, int32_t x, int32_t y) {
    return (uint32_t)(grid->first_vertex + y * (grid->side + 1) + x);
}

/* Piece of a face: of its grid, its fan, or its grid at a corner. NULL where it is not drawn. */
static const ss_grid *piece_of(const made *m, int32_t face, int32_t corner) {
    for (int32_t p = 0; p < m->own->grid_count; p++)
        if (m->own->grids[p].face == face && (m->own->grids[p].corner < 0 || m->own->grids[p].corner == corner))
            return &m->own->grids[p];
    return NULL;
}

/* The vertices along side k of a face, from its corner k on; their count, 0 where it is not drawn. */
static int32_t along_side(const made *m, int32_t face, int32_t k, uint32_t *out) {
    int32_t n = m->mesh.face_counts[face], count = 0;
    const ss_grid *grid = piece_of(m, face, k), *next = piece_of(m, face, (k + 1) % n);
    if (!grid)
        return 0;
    int32_t side = grid->side;
    if (!side) {
        out[0] = (uint32_t)(grid->first_vertex + k), out[1] = (uint32_t)(grid->first_vertex + (k + 1) % n);
        return 2;
    }
    for (int32_t i = 0; i <= side; i++) {
        const int32_t at[4][2] = {{i, 0}, {side, i}, {side - i, side}, {0, side - i}};
        int32_t of = grid->corner < 0 ? k : 0;
        out[count++] = vertex_at(grid, at[of][0], at[of][1]);
    }
    for (int32_t i = 1; grid->corner >= 0 && i <= side; i++)
        out[count++] = vertex_at(next, 0, side - i);
    return count;
}

static double distance_to_segment(const float *p, const float *a, const float *b) {
    double along = 0, length = 0, at[3];
    for (int k = 0; k < 3; k++) {
        along += ((double)p[k] - a[k]) * ((double)b[k] - a[k]);
        length += ((double)b[k] - a[k]) * ((double)b[k] - a[k]);
    }
    double share = length > 0 ? fmin(fmax(along / length, 0), 1) : 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + share * ((double)b[k] - a[k]);
        sum += (p[k] - at[k]) * (p[k] - at[k]);
    }
    return sqrt(sum);
}

/* How far the vertices of one line are at most from the segments of another. */
static double farthest(const made *m, const uint32_t *line, int32_t count, const uint32_t *other, int32_t other_count) {
    double most = 0;
    for (int32_t i = 0; i < count; i++) {
        double least = INFINITY;
        for (int32_t j = 0; j + 1 < other_count; j++)
            least = fmin(least, distance_to_segment(m->work.vertices[line[i]].place, m->work.vertices[other[j]].place,
                                                    m->work.vertices[other[j + 1]].place));
        most = fmax(most, least);
    }
    return most;
}

static bool is_fan(const made *m, int32_t face) {
    const ss_grid *grid = piece_of(m, face, 0);
    return grid && !grid->side;
}

static int32_t compared_sides, uneven_sides;

static void compare_sides(const made *m, int32_t face, int32_t k, int32_t beyond, int32_t j) {
    uint32_t here[MOST_ALONG], there[MOST_ALONG];
    int32_t count = along_side(m, face, k, here), other = along_side(m, beyond, j, there);
    if (!count || !other || is_fan(m, face) != is_fan(m, beyond))
        return;
    compared_sides++, uneven_sides += count != other;
    assert_near(farthest(m, here, count, there, other), 0, 2e-7 * m->size);
    assert_near(farthest(m, there, other, here, count), 0, 2e-7 * m->size);
}

/* All pairs of sides of one edge; and the grids of a polygon, along the lines on which they meet. */
static void check_cracks(made *m) {
    const int32_t *v = m->mesh.face_indices, *start = m->own->face_start;
    for (int32_t f = 0; f < m->mesh.face_count; f++)
        for (int32_t k = 0, n = m->mesh.face_counts[f]; k < n; k++) {
            int32_t a = v[start[f] + k], b = v[start[f] + (k + 1) % n];
            for (int32_t g = 0; g < f; g++)
                for (int32_t j = 0, o = m->mesh.face_counts[g]; j < o; j++) {
                    int32_t c = v[start[g] + j], d = v[start[g] + (j + 1) % o];
                    if ((a == c && b == d) || (a == d && b == c))
                        compare_sides(m, f, k, g, j);
                }
            const ss_grid *grid = piece_of(m, f, k), *next = piece_of(m, f, (k + 1) % n);
            for (int32_t i = 0; grid && grid->corner >= 0 && i <= grid->side; i++)
                assert_near(distance(m->work.vertices[vertex_at(grid, grid->side, i)].place,
                                     m->work.vertices[vertex_at(next, i, next->side)].place),
                            0, 0);
        }
}

/* Vertices of grids at one vertex of the mesh are in one place, also of faces that share no side. */
static void check_corners(made *m) {
    float *at = malloc(POINT_BYTES(&m->mesh));
    uint8_t *seen = calloc((size_t)m->mesh.vertex_count, 1);
    for (int32_t f = 0; f < m->mesh.face_count; f++)
        for (int32_t k = 0; k < m->mesh.face_counts[f]; k++) {
            uint32_t line[MOST_ALONG];
            int32_t vertex = m->mesh.face_indices[m->own->face_start[f] + k];
            if (!along_side(m, f, k, line) || is_fan(m, f))
                continue;
            if (seen[vertex])
                assert_same_bytes(at + 3 * vertex, m->work.vertices[line[0]].place, sizeof(float[3]));
            memcpy(at + 3 * vertex, m->work.vertices[line[0]].place, sizeof(float[3]));
            seen[vertex] = 1;
        }
    free(at), free(seen);
}

/* ---- Triangles ---- */

/* Directed sides of all triangles of a grid: each turned round by another, but for those along the border of the grid, which
 * go as the face does. */
static void check_winding(const made *m, const ss_grid *grid, const uint32_t (*triangles)[3], int32_t count) {
    int32_t size = grid->side ? (grid->side + 1) * (grid->side + 1) : m->mesh.face_counts[grid->face];
    int8_t *net = calloc((size_t)size * (size_t)size, 1);
    for (int32_t t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) {
            int32_t a = (int32_t)triangles[t][k] - grid->first_vertex;
            int32_t b = (int32_t)triangles[t][(k + 1) % 3] - grid->first_vertex;
            assert_true(a >= 0 && a < size && b >= 0 && b < size && a != b);
            net[a * size + b]++, net[b * size + a]--;
        }
    for (int32_t i = 0, sides = grid->side ? 4 * grid->side : size; i < sides; i++) {
        int32_t row = grid->side + 1, side = grid->side, step = side ? i % side : 0;
        const int32_t at[4] = {step, step * row + side, side * row + side - step, (side - step) * row};
        const int32_t on[4] = {1, row, -1, -row};
        int32_t a = side ? at[i / side] : i, b = side ? a + on[i / side] : (i + 1) % size;
        net[a * size + b]--, net[b * size + a]++;
    }
    for (int32_t i = 0; i < size * size; i++)
        assert_int_equal(net[i], 0);
    free(net);
}

static void check_triangles(made *m) {
    uint8_t *used = calloc((size_t)m->own->vertex_count + 1, 1);
    int32_t first = 0;
    for (int32_t p = 0; p < m->own->grid_count; p++) {
        const ss_grid *grid = &m->own->grids[p];
        int32_t count = grid->side ? 2 * grid->side * grid->side : m->mesh.face_counts[grid->face] - 2;
        if (p % 5 == 0)
            check_winding(m, grid, (const uint32_t(*)[3])m->own->triangles + first, count);
        first += count;
    }
    skinslide_tessellation_info info = SKINSLIDE_TESSELLATION_INFO_DEFAULT;
    assert_ok(skinslide_tessellation_describe(m->own, &info, &m->error), &m->error);
    assert_int_equal(info.triangle_count, first);
    assert_int_equal(info.vertex_count, m->own->vertex_count);
    for (int32_t t = 0; t < first; t++)
        for (int k = 0; k < 3; k++)
            used[m->own->triangles[t][k]] = 1;
    for (int32_t v = 0; v < m->own->vertex_count; v++)
        assert_true(used[v]);
    free(used);
}

static double length_of(const float n[3]) {
    return sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
}

/* Along a side that was joined to a coarse face's, means of two. */
static void check_normals(made *m) {
    for (int32_t p = 0; p < m->own->grid_count; p++) {
        const ss_grid *grid = &m->own->grids[p];
        for (int32_t i = 0, side = grid->side; i < ss_grid_size(m->own, grid); i++) {
            double length = length_of(m->work.vertices[grid->first_vertex + i].normal);
            int32_t x = side ? i % (side + 1) : 0, y = side ? i / (side + 1) : 0;
            bool mean = grid->coarse && (x == 0 || y == 0 || x == side || y == side);
            assert_true(length < 1 + 1e-6 && (mean || length == 0 || length > 1 - 1e-6));
        }
    }
}

/* On a torus, of radii 3 and 1, away from its middle circle: limit surfaces of 16 by 12 quads to 0.12, fans to 0.2. */
static void normals_point_out(void **state) {
    (void)state;
    for (int32_t way = 0; way < WAYS; way += WAYS - 1) {
        made m;
        const double origin[3] = {0, 0, 0};
        assert_true(make(&m, FIXTURE_COUNT + 2, way, 0));
        ss_tessellate(m.own, m.mesh.points, origin, &m.work);
        for (int32_t v = 0; v < m.own->vertex_count; v++) {
            const float *p = m.work.vertices[v].place, *n = m.work.vertices[v].normal;
            double round = hypot(p[0], p[1]), out[3] = {p[0] - 3 * p[0] / round, p[1] - 3 * p[1] / round, p[2]};
            double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
            for (int k = 0; k < 3; k++)
                assert_near(n[k], out[k] / length, way ? 0.2 : 0.12);
        }
        end(&m);
    }
}

/* ---- What is blended in faces ---- */

/* Bilinear in the quad at a corner, between the corner, the middles of its sides and the middle of the face. */
static double blend(const float *at, int32_t n, int32_t corner, double s, double t) {
    double middle = 0, own = at[corner], next = at[(corner + 1) % n], previous = at[(corner + n - 1) % n];
    for (int32_t k = 0; k < n; k++)
        middle += (double)at[k] / n;
    return (1 - s) * (1 - t) * own + s * (1 - t) * 0.5 * (own + next) + (1 - s) * t * 0.5 * (own + previous) + s * t * middle;
}

static void check_blend_at(const made *m, const ss_grid *grid, int32_t i) {
    int32_t n = m->mesh.face_counts[grid->face], start = m->own->face_start[grid->face], row = grid->side + 1;
    skinslide_limit_place at = {start + (grid->side ? 0 : i), 0, 0};
    float corners[3][512];
    const ss_fixed_vertex *fixed = &m->own->fixed[grid->first_vertex + i];
    double found[3] = {fixed->coordinates[0], fixed->coordinates[1], m->work.vertices[grid->first_vertex + i].values[0]};
    if (grid->side)
        at = place_in_grid(m, grid, i % row, i / row);
    for (int32_t k = 0; k < n; k++) {
        corners[0][k] = m->st[2 * (start + k)], corners[1][k] = m->st[2 * (start + k) + 1];
        corners[2][k] = m->values[m->mesh.face_indices[start + k]];
    }
    for (int k = 0; k < 3; k++)
        assert_near(found[k], blend(corners[k], n, at.corner - start, at.s, at.t), 1e-6);
    assert_true(m->own->outline->inside[grid->face] == m->inside[grid->face]);
}

static void check_blends(made *m) {
    for (int32_t p = 0; p < m->own->grid_count; p++)
        for (int32_t i = 0; i < ss_grid_size(m->own, &m->own->grids[p]); i++)
            check_blend_at(m, &m->own->grids[p], i);
}

/* Without st, places at rest: and wherever the mesh is, exactly those, in the middle of its own box. */
static void without_st_places_at_rest(void **state) {
    (void)state;
    for (int far = 0; far < 2; far++) {
        const double origin[3] = {5 + far * 65536, 5, 0};
        test_mesh mesh = quad_grid(10, 10);
        for (int32_t v = 0; v < mesh.vertex_count; v++)
            mesh.points[3 * v] += (float)(far * 65536);
        skinslide_mesh view = view_of(&mesh);
        skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
        skinslide_tessellation *made_of;
        ss_tessellation_work work = {0};
        skinslide_error error;
        int32_t first = 44;
        view.subdivision = &own;
        assert_ok(skinslide_tessellation_create(&view, NULL, &first, 1, &made_of, &error), &error);
        assert_true(ss_tessellation_work_allocate(made_of, &work));
        ss_tessellate(made_of, mesh.points, origin, &work);
        for (int32_t v = 0; v < made_of->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                assert_near(made_of->fixed[v].coordinates[k], work.vertices[v].place[k], 1e-5);
        ss_free(&work.memory);
        skinslide_tessellation_destroy(made_of);
        free_mesh(&mesh);
    }
}

/* ---- The outline ---- */

static int32_t uses_of_edge(const made *m, int32_t a, int32_t b) {
    int32_t uses = 0;
    for (int32_t i = 0; i < m->patch_count; i++)
        for (int32_t k = 0, n = m->mesh.face_counts[m->patch[i]], s = m->own->face_start[m->patch[i]]; k < n; k++) {
            int32_t c = m->mesh.face_indices[s + k], d = m->mesh.face_indices[s + (k + 1) % n];
            uses += (a == c && b == d) || (a == d && b == c);
        }
    return uses;
}

static bool has_segment(const made *m, uint32_t a, uint32_t b) {
    const float *p = m->work.vertices[a].place, *q = m->work.vertices[b].place;
    for (int32_t i = 0; i < m->own->outline->segment_count; i++) {
        const float *x = m->work.vertices[m->own->outline->segments[i][0]].place,
                    *y = m->work.vertices[m->own->outline->segments[i][1]].place;
        if (memcmp(p, x, sizeof(float[3])) == 0 && memcmp(q, y, sizeof(float[3])) == 0)
            return true;
    }
    return false;
}

/* As many segments as cells along the sides of the patch with no face of it beyond, and each of those is there. */
static void check_outline(made *m) {
    int32_t expected = 0;
    for (int32_t i = 0; i < m->patch_count; i++)
        for (int32_t f = m->patch[i], k = 0, n = m->mesh.face_counts[f], s = m->own->face_start[f]; k < n; k++) {
            uint32_t line[MOST_ALONG];
            int32_t count = along_side(m, f, k, line);
            if (uses_of_edge(m, m->mesh.face_indices[s + k], m->mesh.face_indices[s + (k + 1) % n]) != 1)
                continue;
            expected += count ? count - 1 : 0;
            for (int32_t j = 0; j + 1 < count; j++)
                assert_true(has_segment(m, line[j], line[j + 1]));
        }
    assert_int_equal(m->own->outline->segment_count, expected);
}

/* ---- How fine, and what is left out ---- */

static bool touches(const made *m, int32_t face, const uint8_t *vertices) {
    for (int32_t k = 0; k < m->mesh.face_counts[face]; k++)
        if (vertices[m->mesh.face_indices[m->own->face_start[face] + k]])
            return true;
    return false;
}

/* A ring of faces around the patch is as fine as the patch, and what is three rings away is coarse. */
static void check_fineness(made *m) {
    uint8_t *marked = calloc((size_t)m->mesh.vertex_count, 1), *reached = calloc((size_t)m->mesh.face_count, 1);
    for (int32_t ring = 0; ring <= 3; ring++) {
        for (int32_t f = 0; f < m->mesh.face_count; f++)
            if (!reached[f] && (ring ? touches(m, f, marked) : m->inside[f]))
                reached[f] = (uint8_t)(ring + 1);
        for (int32_t f = 0; f < m->mesh.face_count; f++)
            for (int32_t k = 0; reached[f] && k < m->mesh.face_counts[f]; k++)
                marked[m->mesh.face_indices[m->own->face_start[f] + k]] = 1;
    }
    for (int32_t p = 0; p < m->own->grid_count; p++) {
        const ss_grid *grid = &m->own->grids[p];
        int32_t cells = grid->corner < 0 ? grid->side : 2 * grid->side, ring = reached[grid->face];
        if (!grid->side)
            continue;
        assert_true(cells >= 2 && cells <= 16);
        if (!ring)
            assert_int_equal(cells, 2);
        else if (ring <= 2)
            assert_true(cells == 16 || m->mesh.face_count > 60);
    }
    free(marked), free(reached);
}

/* 32,768 cells of fine grids, however many faces there are, but for one of each quarter of a quad. */
static void fine_cells_are_bounded(void **state) {
    (void)state;
    for (int32_t side = 5; side <= 90; side += 17) {
        test_mesh mesh = quad_grid(side, side);
        skinslide_mesh view = view_of(&mesh);
        skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
        skinslide_tessellation *all;
        skinslide_error error;
        int32_t *faces = all_faces(&mesh);
        view.subdivision = &own;
        assert_ok(skinslide_tessellation_create(&view, NULL, faces, mesh.face_count, &all, &error), &error);
        int32_t cells = all->triangle_count / 2, least = 4 * mesh.face_count;
        assert_true(cells == least || (cells <= 32768 && (4 * cells > 32768 || cells == 64 * least)));
        skinslide_tessellation_destroy(all);
        free(faces);
        free_mesh(&mesh);
    }
}

static bool at_boundary(const made *m, int32_t face) {
    const int32_t *v = m->mesh.face_indices, *start = m->own->face_start;
    for (int32_t k = 0, n = m->mesh.face_counts[face]; k < n; k++) {
        int32_t uses = 0, a = v[start[face] + k];
        for (int32_t f = 0; f < m->mesh.face_count; f++)
            for (int32_t j = 0, o = m->mesh.face_counts[f]; j < o; j++) {
                int32_t c = v[start[f] + j], d = v[start[f] + (j + 1) % o], b = v[start[face] + (k + 1) % n];
                uses += (a == c && b == d) || (a == d && b == c);
            }
        if (uses == 1)
            return true;
    }
    return false;
}

/* Holes are; with boundary rule none, faces with a side at the boundary; and nothing else where there is neither. */
static void check_left_out(made *m) {
    if (m->c.own.crease_count) /* where faces may be refused */
        return;
    bool none = m->view.subdivision && m->c.own.boundary_rule == SKINSLIDE_BOUNDARY_RULE_NONE;
    for (int32_t f = 0; f < m->mesh.face_count; f++) {
        bool drawn = piece_of(m, f, 0) != NULL, hole = m->c.own.hole_count && f % 7 == 0 && f < 56;
        if (none && at_boundary(m, f))
            assert_false(drawn);
        else if (!none)
            assert_int_equal(drawn, !hole);
    }
    assert_int_equal(m->own->flat_faces, 0);
}

/* ---- All of it ---- */

static void every_mesh_in_every_way(void **state) {
    (void)state;
    void (*const checks[])(made * m) = {check_places,  check_fans,   check_cracks,  check_corners,  check_triangles,
                                        check_normals, check_blends, check_outline, check_fineness, check_left_out};
    compared_sides = uneven_sides = 0;
    for (int32_t mesh = 0; mesh < MESH_COUNT; mesh++)
        for (int32_t way = 0; way < WAYS; way++)
            for (int32_t patch = 0; patch < 3; patch++) {
                made m;
                bool is_way = make(&m, mesh, way, patch);
                for (size_t i = 0; is_way && i < sizeof checks / sizeof *checks; i++)
                    checks[i](&m);
                end(&m);
            }
    print_message("%d pairs of sides, %d of them of a fine and a coarse face\n", compared_sides, uneven_sides);
    assert_true(uneven_sides > 300);
}

/* As in test_limit.c: two pentagons, a crease between them, which OpenSubdiv before 3.5.1 cannot subdivide. */
static void refused_faces_are_flat(void **state) {
    (void)state;
    static const float points[7][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 0.5f, 0}};
    static const int32_t counts[2] = {5, 5}, indices[10] = {0, 1, 6, 4, 3, 1, 2, 5, 4, 6};
    static const int32_t lengths[1] = {2}, crease[2] = {1, 6}, faces[2] = {0, 1};
    static const float sharpness[1] = {2};
    const skinslide_subdivision own = {.size = sizeof(skinslide_subdivision),
                                       .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK,
                                       .crease_count = 1,
                                       .crease_index_count = 2,
                                       .crease_sharpness_count = 1,
                                       .crease_lengths = lengths,
                                       .crease_indices = crease,
                                       .crease_sharpnesses = sharpness};
    const double origin[3] = {0, 0, 0};
    skinslide_mesh mesh = {sizeof(skinslide_mesh), 7, 2, 10, counts, indices, &points[0][0], &own, NULL, NULL};
    skinslide_tessellation *flat;
    ss_tessellation_work work = {0};
    skinslide_error error;
    assert_ok(skinslide_tessellation_create(&mesh, NULL, faces, 2, &flat, &error), &error);
    assert_int_equal(flat->flat_faces, flat->grids[0].side ? 0 : 2);
    assert_true(ss_tessellation_work_allocate(flat, &work));
    ss_tessellate(flat, &points[0][0], origin, &work);
    for (int32_t v = 0; v < flat->vertex_count && flat->flat_faces; v++) {
        assert_same_bytes(work.vertices[v].place, points[indices[v]], sizeof(float[3]));
        assert_true(work.vertices[v].normal[2] == 1);
    }
    ss_free(&work.memory);
    skinslide_tessellation_destroy(flat);
}

/* ---- Patches and meshes of any kind ---- */

/* What no slider takes is drawn all the same: three faces at an edge, faces wound against each other, one named twice, faces of
 * two vertices and of one vertex repeated. */
static void any_faces_can_be_drawn(void **state) {
    (void)state;
    static const float points[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}};
    static const int32_t counts[6] = {4, 4, 3, 2, 4, 0}, faces[7] = {0, 1, 2, 1, 3, 4, 5};
    static const int32_t indices[17] = {0, 1, 2, 3, 0, 1, 5, 4, 0, 1, 4, 0, 1, 2, 2, 3, 0};
    skinslide_mesh mesh = {sizeof(skinslide_mesh), 6, 6, 17, counts, indices, &points[0][0], NULL, NULL, NULL};
    skinslide_tessellation *drawn;
    skinslide_error error;
    assert_ok(skinslide_tessellation_create(&mesh, NULL, faces, 7, &drawn, &error), &error);
    assert_int_equal(drawn->triangle_count, 2 + 2 + 1 + 2);
    /* 1-2, 1-5, 5-4, 1-4, 2-0: sides of one face each. 2-2 is none. */
    assert_int_equal(drawn->outline->segment_count, 5);
    skinslide_tessellation_destroy(drawn);
    assert_ok(skinslide_tessellation_create(&mesh, NULL, NULL, 0, &drawn, &error), &error);
    assert_int_equal(drawn->outline->segment_count, 0);
    skinslide_tessellation_destroy(drawn);
}

/* Two squares, each with points of its own, that are one skin: 6 sides, and not 8. */
static void seams_of_one_skin_are_not_outlined(void **state) {
    (void)state;
    static const float points[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
    static const int32_t counts[2] = {4, 4}, indices[8] = {0, 1, 2, 3, 4, 5, 6, 7}, faces[2] = {0, 1};
    static const int32_t weld[8] = {0, 1, 2, 3, 1, 5, 6, 2};
    skinslide_mesh mesh = {sizeof(skinslide_mesh), 8, 2, 8, counts, indices, &points[0][0], NULL, NULL, NULL};
    skinslide_error error;
    for (int welded = 0; welded < 2; welded++) {
        skinslide_tessellation *drawn;
        mesh.weld = welded ? weld : NULL;
        assert_ok(skinslide_tessellation_create(&mesh, NULL, faces, 2, &drawn, &error), &error);
        assert_int_equal(drawn->outline->segment_count, welded ? 6 : 8);
        skinslide_tessellation_destroy(drawn);
    }
}

static void bad_arguments_are_named(void **state) {
    (void)state;
    test_mesh mesh = quad_grid(2, 2);
    skinslide_mesh view = view_of(&mesh);
    skinslide_tessellation *out = NULL;
    skinslide_tessellation_info info = SKINSLIDE_TESSELLATION_INFO_DEFAULT;
    skinslide_error error;
    float st[32] = {0}, nan = mesh.points[4];
    const int32_t past[1] = {4}, below[1] = {-1}, first[1] = {0};
    assert_fails(skinslide_tessellation_create(&view, NULL, first, 1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no place for the tessellation");
    assert_fails(skinslide_tessellation_create(NULL, NULL, first, 1, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no mesh, or a negative count in it");
    assert_fails(skinslide_tessellation_create(&view, NULL, past, 1, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "face 4 is not one of the mesh's 4");
    assert_fails(skinslide_tessellation_create(&view, NULL, below, 1, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "face -1 is not one of the mesh's 4");
    assert_fails(skinslide_tessellation_create(&view, NULL, NULL, 1, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no faces");
    assert_fails(skinslide_tessellation_create(&view, NULL, first, -1, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no faces");
    st[2 * 9 + 1] = NAN;
    assert_fails(skinslide_tessellation_create(&view, st, first, 1, &out, &error), &error, SKINSLIDE_BAD_CONTROL,
                 "face 2 has st (0, ...");
    mesh.points[4] = NAN;
    assert_fails(skinslide_tessellation_create(&view, NULL, first, 1, &out, &error), &error, SKINSLIDE_BAD_POINTS,
                 "rest points: vertex 1 is not finite...");
    mesh.points[4] = nan, mesh.face_indices[3] = 9;
    assert_fails(skinslide_tessellation_create(&view, NULL, first, 1, &out, &error), &error, SKINSLIDE_BAD_MESH,
                 "face 0 has vertex 9, but the mesh has 9 vertices");
    assert_fails(skinslide_tessellation_describe(NULL, &info, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no tessellation...");
    assert_null(out);
    skinslide_tessellation_destroy(NULL);
    free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mesh_in_every_way),
        cmocka_unit_test(normals_point_out),
        cmocka_unit_test(without_st_places_at_rest),
        cmocka_unit_test(fine_cells_are_bounded),
        cmocka_unit_test(refused_faces_are_flat),
        cmocka_unit_test(any_faces_can_be_drawn),
        cmocka_unit_test(seams_of_one_skin_are_not_outlined),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests_name("tessellation", tests, NULL, NULL);
}
