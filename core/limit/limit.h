/* Interpolation LIMIT: keeps the limit surface where it was. The only room that knows OpenSubdiv. */
#ifndef SKINSLIDE_LIMIT_H
#define SKINSLIDE_LIMIT_H

#include "plane.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- parameter.cpp, limit.cpp: the limit surface; the latter is the only file that knows OpenSubdiv ---- */

/* A point of a face. Quads: bilinear, from corner 0 to 1 and to 3. Triangles of the loop scheme: weights of corners 1 and 2.
 * Other polygons: bilinear in the quad at a corner, from it to the middles of the side after and of the side before it. */
typedef struct ss_parameter {
    int32_t corner; /* of the face, in polygons; else -1 */
    double st[2];
} ss_parameter;

/* The parameters of a place. loop: whether the scheme is loop. */
ss_parameter ss_parametrise(const ss_patch *patch, bool loop, const ss_flat *flat, const ss_place *place);

typedef struct ss_topology ss_topology;             /* of a subdivided mesh, which must outlive it: immutable */
typedef struct ss_limit_surfaces ss_limit_surfaces; /* of some faces: immutable; may outlive the topology */

skinslide_status ss_topology_create(const skinslide_mesh *mesh, ss_topology **out, skinslide_error *error);
void ss_topology_destroy(ss_topology *topology);
typedef enum ss_face_surface {
    SS_SURFACE,         /* the face has a limit surface */
    SS_SURFACE_NONE,    /* it has none, and is not rendered */
    SS_SURFACE_REFUSED, /* OpenSubdiv would crash at it, or too many faces or vertices are around */
} ss_face_surface;
/* out kinds [mesh face_count] */
skinslide_status ss_face_surfaces(const ss_topology *topology, ss_face_surface *kinds, skinslide_error *error);
/* Fails with BAD_PATCH if a face has none, UNSUPPORTED if it is refused. label begins messages. */
skinslide_status ss_limit_surfaces_create(const ss_topology *topology, const int32_t *mesh_faces, int32_t count,
                                          const char *label, ss_limit_surfaces **out, skinslide_error *error);
void ss_limit_surfaces_destroy(ss_limit_surfaces *surfaces);
/* How many doubles of scratch ss_limit_prepare needs. */
int32_t ss_limit_surfaces_scratch(const ss_limit_surfaces *surfaces);
/* The most weights that ss_limit_stencil writes. */
int32_t ss_limit_surfaces_most_vertices(const ss_limit_surfaces *surfaces);
/* The mesh vertices and weights whose weighted sum is a limit point. A vertex may occur twice. Returns their count. */
int32_t ss_limit_stencil(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const int32_t **vertices,
                         double *weights);
/* Fills scratch with what ss_limit_point needs of a face, from the mesh's points minus origin. face is a place in the
 * mesh_faces that the surfaces were created with. */
void ss_limit_prepare(const ss_limit_surfaces *surfaces, int32_t face, const float *points, const double origin[3],
                      double *scratch);
/* The mesh vertices that the face's surface depends on. Returns their count. */
int32_t ss_limit_vertices(const ss_limit_surfaces *surfaces, int32_t face, const int32_t **vertices);
void ss_limit_point(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch,
                    double out[3]);
/* The same with the unit normal, which is 0 if the surface has none, and points the other way if faces are left-handed. Returns
 * how far the tangents are from one line: 1 if they are at right angles and equally long, 0 without a normal. */
double ss_limit_normal(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch,
                       double point[3], double normal[3]);
/* The parameters of a place in the quad at a corner: see skinslide_limit_place. */
ss_parameter ss_limit_parameter(const ss_limit_surfaces *surfaces, int32_t face, int32_t corner, double s, double t);

/* ---- fit.c: the least squares of interpolation LIMIT ---- */

typedef struct ss_fit ss_fit;           /* samples, edges and factors of a patch: immutable */
typedef struct ss_fit_work ss_fit_work; /* one for each thread */

/* samples has a row for each sample of the surface, with the weights of the free vertices, its columns, that make it. The first
 * rows are samples near the free vertices, in the order of free_vertex. It must outlive the fit. normal [row_count] are the
 * samples' unit normals at rest, 0 for none. free_index [vertex_count] is the place in free_vertex, or -1. */
skinslide_status ss_fit_create(const ss_patch *patch, const int32_t *free_index, const ss_rows *samples,
                               const double (*normal)[3], ss_fit **out, skinslide_error *error);
void ss_fit_destroy(ss_fit *fit);
skinslide_status ss_fit_work_create(const ss_fit *fit, ss_fit_work **out, skinslide_error *error);
void ss_fit_work_destroy(ss_fit_work *work);
/* displacement [free_count]: in, the linear one; out, one that moves each sample nearer to residual from where it is
 * undisplaced: along normal, and the shorter normal is than 1, the more in all directions. Both are [row_count]. */
void ss_fit_samples(ss_fit_work *work, const ss_frame *frame, const double (*residual)[3], const double (*normal)[3],
                    double (*displacement)[3]);

/* ---- crumple.c: shorter normals where a pose crumples the surface ---- */

typedef struct ss_crumple ss_crumple; /* immutable */

/* Shortens the unit normal of a sample by how much nearer to one line its tangents are than at rest. square and at_rest are
 * what ss_limit_normal returned. */
void ss_shorten_flat(double square, double at_rest, double normal[3]);
/* samples are the fit's, and must outlive it. normal [row_count] are theirs at rest. */
skinslide_status ss_crumple_create(const ss_rows *samples, const double (*normal)[3], ss_crumple **out, skinslide_error *error);
void ss_crumple_destroy(ss_crumple *crumple);
/* Shortens the frame's normals [row_count] further where they turn from one sample to the next by more than at rest. sum and
 * part [column_count] are scratch. */
void ss_crumple_shorten(const ss_crumple *crumple, double (*sum)[3], double *part, double (*normal)[3]);

/* ---- middle.c: where the middles of faces are looked up ---- */

typedef struct ss_middles ss_middles; /* memory of one thread for one patch */

/* free_index [vertex_count] is the place in free_vertex, or -1; it must outlive the middles. */
skinslide_status ss_middles_create(const ss_patch *patch, const int32_t *free_index, ss_middles **out, skinslide_error *error);
void ss_middles_destroy(ss_middles *middles);
/* Sets the slide whose middles are asked for next. */
void ss_middles_set(ss_middles *middles, const ss_slide *slide);
ss_place ss_middle(const ss_middles *middles, int32_t face);

/* ---- cage.c: interpolation LIMIT ---- */

typedef struct ss_cage ss_cage;           /* limit surfaces and samples of a patch: immutable */
typedef struct ss_cage_work ss_cage_work; /* one for each thread */

/* rest_points are the whole mesh's. */
skinslide_status ss_cage_create(const ss_topology *topology, const ss_patch *patch, const float *rest_points, bool loop,
                                ss_cage **out, skinslide_error *error);
void ss_cage_destroy(ss_cage *cage);
skinslide_status ss_cage_work_create(const ss_cage *cage, ss_cage_work **out, skinslide_error *error);
void ss_cage_work_destroy(ss_cage_work *work);
/* displacement [free_count]: in, the linear one; out, the one that keeps the limit surface. Returns how many vertices were
 * damped. */
int32_t ss_move_cage(ss_cage_work *work, const ss_frame *frame, const ss_slide *slide, double (*displacement)[3]);

#ifdef __cplusplus
}
#endif

#endif
