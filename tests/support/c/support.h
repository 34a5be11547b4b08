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

/* Aborts the test with the library's message where status is not OK. */
#define assert_ok(status, error) assert_ok_at((status), (error), __FILE__, __LINE__)
void assert_ok_at(skinslide_status status, const skinslide_error *error, const char *file, int line);

/* Whether actual is expected to within tolerance; NaN is not. */
#define assert_near(actual, expected, tolerance) assert_near_at((actual), (expected), (tolerance), __FILE__, __LINE__)
void assert_near_at(double actual, double expected, double tolerance, const char *file, int line);

/* Asserts status and that the message is exactly this, or begins with it where it ends in "...". */
#define assert_fails(status, error, expected, text) assert_fails_at((status), (error), (expected), (text), __FILE__, __LINE__)
void assert_fails_at(skinslide_status status, const skinslide_error *error, skinslide_status expected, const char *text,
                     const char *file, int line);

#define assert_same_bytes(a, b, size) assert_memory_equal((a), (b), (size))
#define POINT_BYTES(mesh)             ((size_t)(mesh)->vertex_count * sizeof(float[3]))

/* A set-up of every face of a mesh, named "all", controls at their defaults. The faces are the caller's to free. */
skinslide_patch_setup setup_of(const int32_t *faces, int32_t face_count);

/* One patch of the whole mesh, set up by choices, of which name, faces and sizes need not be there: of one piece, or of the first. */
ss_patch *patch_of(const test_mesh *mesh, skinslide_patch_setup choices);

/* A slider with one set-up of the whole mesh, as choices say, and a workspace for it. */
typedef struct rig {
    skinslide_slider *slider;
    skinslide_workspace *workspace;
} rig;
rig rig_of(const test_mesh *mesh, skinslide_patch_setup choices);
rig rig_of_setups(const test_mesh *mesh, const skinslide_patch_setup *setups, int32_t count);
void free_rig(rig *r);

/* One frame of a rig: points to be freed. results may be NULL. */
float *slide_with(const rig *r, const test_mesh *mesh, const float *points, const skinslide_controls *controls,
                  skinslide_patch_result *results);

/* Where the plane rule puts what it holds; free vertices at 0: [vertex_count][2], to be freed. */
double (*held_uv_of(const ss_patch *patch, const float *rest_points))[2];

/* The embedding of a patch for some points, with the set-up's rule and no paint: [vertex_count][2], to be freed. */
double (*embedding_of(const ss_patch *patch, const float *rest_points, const float *points))[2];

/* The same system as ss_embed's, solved densely by elimination with row exchanges. */
void embed_densely(const ss_net *net, const double *density, double (*uv)[2]);

/* What ss_place_at gives. */
ss_place place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2]);

/* The lowest face that holds p among all, each tested; else the nearest of all sides, when *inside is false. */
ss_place search_all(const ss_patch *patch, const double (*uv)[2], const double p[2], bool *inside);

/* The same in every bit. */
void assert_same_place(const ss_place *a, const ss_place *b);

/* Every way to set up a fixture: boundaries x holes x rules x interpolations. Some are no way for the fixture: false. */
enum { WAY_COUNT = 32 };
bool choose_way(const fixture *f, int32_t way, skinslide_patch_setup *choices);

/* Random controls for a whole mesh, which own their arrays. */
typedef struct painted {
    skinslide_controls controls;
    float *vertex_density, *face_density, *weight;
} painted;
painted paint_at_random(const test_mesh *mesh, uint64_t seed);
void free_painted(painted *p);

/* Largest difference of two arrays. */
double largest_difference(const float *a, const float *b, int64_t count);

#endif
