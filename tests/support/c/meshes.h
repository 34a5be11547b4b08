/* Meshes and poses that the C tests share. Meshes own their arrays; all that is random comes from a seed. */
#ifndef SKINSLIDE_TEST_MESHES_H
#define SKINSLIDE_TEST_MESHES_H

#include "mesh.h"

/* ---- Random numbers: the same on every machine ---- */

typedef struct dice {
    uint64_t state;
} dice;

uint64_t roll(dice *d);
int32_t roll_below(dice *d, int32_t bound); /* 0 .. bound - 1 */
double roll_share(dice *d);                 /* [0, 1) */
double roll_between(dice *d, double low, double high);

/* ---- Meshes ---- */

typedef struct test_mesh {
    int32_t vertex_count, face_count, index_count;
    int32_t *face_counts, *face_indices;
    float *points; /* [vertex_count][3] */
} test_mesh;

test_mesh copy_mesh(int32_t vertex_count, int32_t face_count, const int32_t *face_counts, const int32_t *face_indices,
                    const float *points);
void free_mesh(test_mesh *mesh);
/* The mesh as the library takes it, with its own points as rest. */
skinslide_mesh view_of(const test_mesh *mesh);

/* columns x rows quads of side 1 in z = 0; vertex (i, j) is j (columns + 1) + i. */
test_mesh quad_grid(int32_t columns, int32_t rows);
/* The same, each quad cut in two; diagonals alternate. */
test_mesh triangle_grid(int32_t columns, int32_t rows);
/* The mesh without faces for which drop is true. Their vertices stay, isolated if nothing else uses them. */
test_mesh without_faces(const test_mesh *mesh, bool (*drop)(const test_mesh *mesh, int32_t face));
/* A 10 x 10 grid with two holes, of 2 x 2 and 1 x 3 quads. */
test_mesh grid_with_holes(bool triangles);
/* A ring of quads between two circles. */
test_mesh annulus(int32_t around, int32_t rings);
/* Rows of hexagonal bricks, with quads at the ends of every other row. */
test_mesh brick_wall(int32_t columns, int32_t rows);
/* One polygon. */
test_mesh polygon(int32_t sides);
/* A disk grown at random, by splitting edges and by adding diagonals, vertices inside faces, and ears. Its points have no
 * shape. */
test_mesh random_disk(uint64_t seed, int32_t steps);
/* A tube of rings of quads, closed at the far end by a fan of triangles: the skin of a finger. */
test_mesh finger(int32_t around, int32_t rings);
/* Closed meshes: six quads, eight triangles, and a quad grid rolled up both ways, of at most 256 quads. */
test_mesh cube(void);
test_mesh octahedron(void);
test_mesh torus(int32_t around, int32_t across);
/* Two meshes as one. */
test_mesh join_meshes(const test_mesh *a, const test_mesh *b);

/* ---- Poses: points of the same mesh, [vertex_count][3], to be freed ---- */

float *copy_points(const test_mesh *mesh);
/* A bump of Gaussian profile over (x, y), which also drags the points under it sideways. */
float *bumped(const test_mesh *mesh, double x, double y, double radius, double height);
/* Every coordinate moved by up to amount. */
float *shaken(const test_mesh *mesh, uint64_t seed, double amount);
/* A shear, a bump and a shake, chosen by the seed. */
float *random_pose(const test_mesh *mesh, uint64_t seed);
/* The length of the diagonal of the points' bounding box. */
double extent_of(const float *points, int32_t vertex_count);

/* ---- The corpus: small meshes, each awkward in its own way ---- */

typedef struct fixture {
    const char *name;
    int32_t holes;
    bool square; /* has an outer loop of four vertices or more */
    test_mesh mesh;
} fixture;

enum { FIXTURE_COUNT = 14 };
fixture make_fixture(int32_t index);

/* Every face of the mesh, in order: to be freed. */
int32_t *all_faces(const test_mesh *mesh);

#endif
