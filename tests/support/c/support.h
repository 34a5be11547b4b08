/* What the C tests share besides meshes: cmocka, building a patch or a slider in one call, comparisons that name the place. */
#ifndef SKINSLIDE_TEST_SUPPORT_H
#define SKINSLIDE_TEST_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "meshes.h"
#include "slide.h"

/* Aborts the test with the library's message if status is not OK. */
#define assert_ok(status, error) assert_ok_at((status), (error), __FILE__, __LINE__)
void assert_ok_at(skinslide_status status, const skinslide_error *error, const char *file, int line);

/* Asserts that actual is within tolerance of expected; NaN never is. */
#define assert_near(actual, expected, tolerance) assert_near_at((actual), (expected), (tolerance), __FILE__, __LINE__)
void assert_near_at(double actual, double expected, double tolerance, const char *file, int line);

/* Asserts the status, and that the message is text, or begins with it if text ends in "...". */
#define assert_fails(status, error, expected, text) assert_fails_at((status), (error), (expected), (text), __FILE__, __LINE__)
void assert_fails_at(skinslide_status status, const skinslide_error *error, skinslide_status expected, const char *text,
                     const char *file, int line);

#define assert_same_bytes(a, b, size) assert_memory_equal((a), (b), (size))
#define POINT_BYTES(mesh)             ((size_t)(mesh)->vertex_count * sizeof(float[3]))

/* A set-up of every face of a mesh, named "all", controls at their defaults. The faces are the caller's to free. */
skinslide_patch_setup setup_of(const int32_t *faces, int32_t face_count);

/* A patch of the whole mesh, or its first piece. choices need no name, faces or sizes. */
ss_patch *patch_of(const test_mesh *mesh, skinslide_patch_setup choices);

/* A slider with one set-up of the whole mesh, as choices say, and a workspace for it. */
typedef struct rig {
    skinslide_slider *slider;
    skinslide_workspace *workspace;
} rig;
rig rig_of(const test_mesh *mesh, skinslide_patch_setup choices);
rig rig_of_setups(const test_mesh *mesh, const skinslide_patch_setup *setups, int32_t count);
void free_rig(rig *r);

/* Slides one frame; the caller frees the points. results may be NULL. */
float *slide_with(const rig *r, const test_mesh *mesh, const float *points, const skinslide_controls *controls,
                  skinslide_patch_result *results);
bool all_finite(const float *values, int64_t count);
/* Rest keeps its bits, and so many random poses give finite points. */
void expect_finite_slides(const test_mesh *mesh, skinslide_patch_setup choices, uint64_t poses);

/* Where the plane rule puts fixed vertices, with free ones at 0: [vertex_count][2], to be freed. */
double (*held_uv_of(const ss_patch *patch, const float *rest_points))[2];

/* The embedding of a patch for some points, with the set-up's rule and no paint: [vertex_count][2], to be freed. */
double (*embedding_of(const ss_patch *patch, const float *rest_points, const float *points))[2];

/* Solves the same system as ss_embed, but densely, by elimination with row exchanges. */
void embed_densely(const ss_net *net, const double *density, double (*uv)[2]);

/* Returns what ss_place_at writes. */
ss_place place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2]);

/* The place of p in the lowest face that holds it, by testing all; else on the nearest side of all, with *inside false. */
ss_place search_all(const ss_patch *patch, const double (*uv)[2], const double p[2], bool *inside);

/* Asserts that two places are the same to the bit. */
void assert_same_place(const ss_place *a, const ss_place *b);

/* All ways to set up a fixture: boundaries x holes x rules x interpolations. False for those that the fixture cannot have. */
enum { WAY_COUNT = 32 };
bool choose_way(const fixture *f, int32_t way, skinslide_patch_setup *choices);

/* Random controls for a whole mesh, with their own arrays. */
typedef struct painted {
    skinslide_controls controls;
    float *vertex_density, *face_density, *weight;
} painted;
painted paint_at_random(const test_mesh *mesh, uint64_t seed);
void free_painted(painted *p);

/* The largest difference between two arrays. */
double largest_difference(const float *a, const float *b, int64_t count);

#endif
