/* What the files of the core know of each other. One file a stage of the walk:
 *
 *     mesh ─► patch (boundary, holes) ─► system ─► embed(rest)            once a shot
 *             density ─► embed(frame) ─► locate ─► interpolate (─► cage)  every frame, in slider.c
 *
 * Names begin with ss_, so that the static library can be linked into any program. */
#ifndef SKINSLIDE_INTERNAL_H
#define SKINSLIDE_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>

#include "skinslide/skinslide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- memory.c: an object's arrays, all freed at once ---- */

typedef struct ss_block ss_block;
typedef struct ss_memory {
    ss_block *blocks;
    bool failed; /* an allocation failed: checked once, after all of them */
} ss_memory;

/* count * size bytes of zeros, or NULL with memory->failed set. A count of 0 gives a pointer all the same. */
void *ss_new(ss_memory *memory, int64_t count, size_t size);
void ss_free(ss_memory *memory);
#define SS_NEW(memory, type, count) ((type *)ss_new((memory), (count), sizeof(type)))

/* ---- error.c ---- */

/* Fills error, where there is one, and returns status: `return ss_fail(error, SKINSLIDE_BAD_PATCH, "...", ...);` */
__attribute__((format(printf, 3, 4))) skinslide_status ss_fail(skinslide_error *error, skinslide_status status,
                                                               const char *format, ...);
skinslide_status ss_out_of_memory(skinslide_error *error);

/* ---- orient.c ---- */

/* 1 where a, b, c turn left, -1 right, 0 where they are on one line: exact for the doubles given. */
int ss_orient(const double a[2], const double b[2], const double c[2]);

/* ---- mesh.c: faces and how they meet ---- */

/* Polygons over some vertices. Corner c of face f, face_start[f] <= c < face_start[f + 1], is also the side to the next corner.
 */
typedef struct ss_faces {
    int32_t face_count;
    int32_t corner_count;
    int32_t *face_start;    /* [face_count + 1] */
    int32_t *corner_vertex; /* [corner_count] */
    int32_t *corner_face;   /* [corner_count] */
    int32_t *corner_twin;   /* [corner_count] the same edge seen from the other face; -1 on the boundary */
    int32_t *corner_edge;   /* [corner_count] edges are numbered by their lower, then their higher vertex */
    int32_t edge_count;
} ss_faces;

static inline int32_t ss_next_corner(const ss_faces *faces, int32_t corner) {
    int32_t face = faces->corner_face[corner];
    return corner + 1 < faces->face_start[face + 1] ? corner + 1 : faces->face_start[face];
}

static inline int32_t ss_previous_corner(const ss_faces *faces, int32_t corner) {
    int32_t face = faces->corner_face[corner];
    return corner > faces->face_start[face] ? corner - 1 : faces->face_start[face + 1] - 1;
}

/* For qsort and bsearch: int32_t, and int32_t[2]. */
int ss_ascending(const void *a, const void *b);
int ss_ascending_pairs(const void *a, const void *b);

/* Counts, indices and rest points of the whole mesh. */
skinslide_status ss_check_mesh(const skinslide_mesh *mesh, skinslide_error *error);
/* Names the first vertex that is not finite. */
skinslide_status ss_check_points(const float *points, int32_t vertex_count, const char *what, skinslide_error *error);
/* The chosen faces of a mesh, with mesh vertices at their corners, twins and edges. label begins messages. */
skinslide_status ss_take_faces(const skinslide_mesh *mesh, const int32_t *chosen, int32_t count, const char *label,
                               ss_memory *memory, ss_faces *faces, skinslide_error *error);
/* Fills corner_edge and edge_count of any faces at all, several at an edge or none like it. False where memory is short. */
bool ss_number_edges(ss_faces *faces);
/* Numbers the pieces that are connected through edges, by their lowest face: piece_of_face [face_count]. Returns their count.
 */
int32_t ss_number_pieces(const ss_faces *faces, int32_t *piece_of_face, int32_t *stack);

/* ---- patch.c: one connected patch, a disk with holes ---- */

typedef struct ss_patch {
    ss_memory memory;
    char label[160]; /* "patch elbow" or "patch elbow (piece 2 of 2)" */
    const skinslide_patch_setup *setup;
    int32_t setup_index, piece, piece_count;
    int32_t vertex_count, free_count, loop_count;
    ss_faces faces;            /* corners hold patch vertices */
    int32_t *mesh_vertex;      /* [vertex_count], ascending */
    int32_t *mesh_face;        /* [face_count], ascending */
    int32_t *vertex_corner;    /* [vertex_count] a corner at the vertex; on the boundary the one whose side leaves along it */
    int32_t (*edge_vertex)[2]; /* [edge_count], lower first */
    double *rest_length;       /* [edge_count] clamped to shortest */
    double shortest;           /* 1e-6 of the mean rest edge */
    int32_t zero_length_edges;
    int32_t *loop_start; /* [loop_count + 1]; loop 0 is the outer boundary, the others holes, as faces go round them */
    int32_t *loop_vertex;
    uint8_t *fixed;        /* [vertex_count] */
    double (*fixed_uv)[2]; /* [vertex_count], where fixed */
    int32_t *free_vertex;  /* [free_count] in an order in which each has a neighbour before it */
    int32_t *free_before;  /* [free_count] the place in free_vertex of that neighbour, -1 for a first */
    int32_t *loop_place;   /* [vertex_count] where loop_vertex has the vertex, on loops */
    int32_t *vertex_loop;  /* [vertex_count] the loop that the vertex is on, -1 inside */
} ss_patch;

skinslide_status ss_patch_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setup, int32_t setup_index,
                                 const int32_t *mesh_faces, int32_t face_count, int32_t piece, int32_t piece_count,
                                 ss_patch **out, skinslide_error *error);
void ss_patch_destroy(ss_patch *patch);
/* "patch elbow", or "patch elbow (piece 2 of 2)". */
void ss_label(const skinslide_patch_setup *setup, int32_t piece, int32_t piece_count, char *label, size_t size);
/* The patch vertex of a mesh vertex, or -1. */
int32_t ss_patch_vertex(const ss_patch *patch, int32_t mesh_vertex);
/* The edge between two patch vertices, or -1. */
int32_t ss_patch_edge(const ss_patch *patch, int32_t a, int32_t b);
/* The length of every edge, none under patch->shortest; returns how many were. points is the whole mesh's. */
int32_t ss_edge_lengths(const ss_patch *patch, const float *points, double *lengths);

/* boundary.c: fixed_uv of the outer loop. */
skinslide_status ss_place_boundary(ss_patch *patch, const float *rest_points, skinslide_error *error);
/* Whether the set-up's corners, where it has them, are this patch's: of several pieces, those of the one that has all four. */
bool ss_has_corners(const ss_patch *patch);
/* (cos, sin) of turns of a full circle, turns in [0,1): plain arithmetic only, so the same bits everywhere. */
void ss_circle(double turns, double out[2]);

/* holes.c: fixed_uv of the loops of holes, where they fall with every hole capped. */
skinslide_status ss_place_holes(ss_patch *patch, const float *rest_points, skinslide_error *error);

/* ---- density.c ---- */

/* Values of controls: names the mesh element whose value is not one. */
skinslide_status ss_check_controls(const skinslide_mesh *mesh, const char *name, const skinslide_controls *controls,
                                   skinslide_error *error);
/* The painted multiplier of every edge: [edge_count]. Controls are checked. */
void ss_paint(const ss_patch *patch, const skinslide_controls *controls, double *paint);
/* Force density of every edge by the patch's rule, times paint. */
void ss_force_density(const ss_patch *patch, const double *lengths, const double *paint, double *density);
/* weight times envelope of every free vertex, in their order: [free_count]. Returns how many values were outside 0..1. */
int32_t ss_slide_weights(const ss_patch *patch, const skinslide_controls *controls, double *weights);
/* How far every free vertex may slide, in their order: [free_count], infinite where there is no limit. Returns whether any has. */
bool ss_slide_limits(const ss_patch *patch, const skinslide_controls *controls, double *limits);

/* ---- embed.c: the only file that knows the solver ---- */

typedef struct ss_net {
    int32_t vertex_count;
    int32_t edge_count;
    const int32_t (*edge_vertex)[2];
    const uint8_t *fixed; /* [vertex_count] */
} ss_net;

typedef struct ss_system ss_system; /* pattern, ordering, symbolic factor: immutable */
typedef struct ss_factor ss_factor; /* numeric factor: one a thread */

skinslide_status ss_system_create(const ss_net *net, const char *label, ss_system **out, skinslide_error *error);
void ss_system_destroy(ss_system *system);
skinslide_status ss_factor_create(const ss_system *system, ss_factor **out, skinslide_error *error);
void ss_factor_destroy(ss_factor *factor);
/* Solves for the free vertices of uv [vertex_count][2], whose fixed ones are given. density is [edge_count], > 0. */
skinslide_status ss_embed(const ss_system *system, ss_factor *factor, const double *density, double (*uv)[2],
                          skinslide_error *error);

/* ---- layout.c: how the faces of an embedding lie ---- */

/* Triangle t of the fan of a face, as patch vertices. */
static inline void ss_fan(const ss_faces *faces, int32_t face, int32_t triangle, int32_t vertices[3]) {
    const int32_t *corners = faces->corner_vertex + faces->face_start[face];
    vertices[0] = corners[0], vertices[1] = corners[triangle + 1], vertices[2] = corners[triangle + 2];
}

static inline int32_t ss_fan_size(const ss_faces *faces, int32_t face) {
    return faces->face_start[face + 1] - faces->face_start[face] - 2;
}

/* The triangle of the fan that has the side which begins at a corner. */
int32_t ss_fan_of_side(const ss_faces *faces, int32_t corner);
/* The first triangle of the fan that turns left and holds p, its border included; -1 where none does. */
int32_t ss_fan_holding(const ss_faces *faces, int32_t face, const double (*uv)[2], const double p[2]);

typedef struct ss_layout {
    int32_t folded;    /* faces turned over by more than the rounding of their corners */
    int32_t collapsed; /* faces of no area, up to the same rounding */
    bool regular;      /* no hole is free, every face is convex and none is turned over at all: no two overlap */
} ss_layout;

ss_layout ss_lay_out(const ss_patch *patch, const double (*uv)[2]);

/* ---- locate.c, facetree.c ---- */

enum { SS_CANDIDATES = 9 };

/* Faces of the texels around a query: that of its own texel or -1, then the other distinct ones, then -1. */
typedef int32_t ss_candidates[SS_CANDIDATES];

#define SS_STAYS (-1)

typedef struct ss_location {
    int32_t face;     /* patch face, or SS_STAYS: the vertex keeps its place */
    int32_t triangle; /* of the face's fan */
    double uv[2];     /* in that triangle */
} ss_location;

typedef struct ss_face_tree ss_face_tree; /* faces of an embedding by place */
skinslide_status ss_face_tree_create(const ss_faces *faces, ss_face_tree **out, skinslide_error *error);
void ss_face_tree_destroy(ss_face_tree *tree);
/* uv is read by the queries that follow, too. */
void ss_face_tree_build(ss_face_tree *tree, const double (*uv)[2]);
/* The lowest face that holds p, its border included; false where none does. */
bool ss_face_tree_holding(const ss_face_tree *tree, const double p[2], ss_location *out);
/* The point nearest to p on the sides of the faces, of the lowest face where several are as near. Returns the distance. */
double ss_face_tree_nearest(const ss_face_tree *tree, const double p[2], ss_location *out);
/* The point of the side that begins at a corner nearest to p. Returns the distance squared. */
double ss_nearest_on_side(const ss_faces *faces, const double (*uv)[2], int32_t corner, const double p[2], double out[2]);

typedef struct ss_located {
    int32_t centre, around; /* in the first candidate, in another */
    int32_t walked;
    int32_t searched; /* by the tree */
    int32_t clamped;  /* in no face: put on the nearest */
    int64_t steps;    /* of walks */
} ss_located;

typedef struct ss_locator ss_locator;
skinslide_status ss_locator_create(const ss_patch *patch, ss_locator **out, skinslide_error *error);
void ss_locator_destroy(ss_locator *locator);
/* Looks up query [free_count][2], in the order of free_vertex, in the faces of uv. candidates [free_count], or NULL, are only
 * a help: any faces at all give the same locations. They are not looked at where the layout is not regular. */
ss_located ss_locate(ss_locator *locator, const double (*uv)[2], bool regular, const double (*query)[2],
                     const ss_candidates *candidates, ss_location *locations);

/* ---- normals.c ---- */

/* Twice the area vector of a polygon of 3 or more vertices: the sum of its fan's cross products. */
void ss_area_vector(const int32_t *vertices, int32_t count, const float *points, double out[3]);

/* ---- map.c ---- */

/* UDIM tiles, numbered by rows of ten: 1001 to 10000. */
enum { SS_FIRST_TILE = 1001, SS_TILE_COLUMNS = 10, SS_TILE_ROWS = 900 };

/* ---- egl.c: the only file that knows EGL ---- */

/* Fills the table of EGL's and OpenGL ES's functions (egl.h); where it cannot, says why. Tests give tables that fail. */
struct ss_egl_api;
typedef bool (*ss_egl_loader)(struct ss_egl_api *api, char *why, size_t size);
bool ss_egl_load(struct ss_egl_api *api, char *why, size_t size);

typedef struct ss_device_request {
    ss_egl_loader load;
    int32_t device;     /* of EGL's devices, or SKINSLIDE_ANY_DEVICE */
    bool hardware_only; /* a software rasteriser will not do */
} ss_device_request;

/* ---- idbuffer.c: the faces of embeddings drawn as numbers ---- */

/* What is drawn of one patch. */
typedef struct ss_id_patch {
    const ss_faces *faces;
    int32_t query_count;
    int32_t side; /* texels; at least 1 */
} ss_id_patch;

typedef struct ss_idbuffer ss_idbuffer;
/* patches are copied, their faces are kept. resolution 0: patches[].side, or the device's limit where that is less.
 * Fails with NO_DEVICE, DEVICE_FAILED, OUT_OF_MEMORY, BAD_ARGUMENT (resolution above the device's limit). */
skinslide_status ss_idbuffer_create(const ss_device_request *request, const ss_id_patch *patches, int32_t patch_count,
                                    int32_t resolution, ss_idbuffer **out, skinslide_error *error);
void ss_idbuffer_destroy(ss_idbuffer *buffer);
const skinslide_lookup_info *ss_idbuffer_info(const ss_idbuffer *buffer);
int32_t ss_idbuffer_side(const ss_idbuffer *buffer, int32_t patch);
/* Starts drawing the faces of uv and gathering the candidates of the queries [query_count][2], and does not wait. A failure
 * shows in the next call. */
void ss_idbuffer_draw(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], const double (*queries)[2]);
/* The candidates of what was drawn last of the patch: [query_count]. False where the device failed. */
bool ss_idbuffer_candidates(ss_idbuffer *buffer, int32_t patch, ss_candidates *candidates);
/* Draws uv and reads the texels: [side][side], 1 + patch face, 0 where there is none. */
skinslide_status ss_idbuffer_read(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], uint32_t *texels,
                                  skinslide_error *error);
/* The resolution that suits a patch: see skinslide_workspace_options. */
int32_t ss_id_side(const ss_patch *patch, const double (*rest_uv)[2]);

/* ---- interpolate.c ---- */

/* The displacement of every free vertex, in their order, from its own place to where it is looked up. points is the whole
 * mesh's; weights is scratch [largest face]. */
void ss_interpolate(const ss_patch *patch, const double (*uv)[2], const ss_location *locations, const float *points,
                    double *weights, double (*displacement)[3]);
/* Weights, which sum to 1, of the corners of the location's triangle, and of its face: false where a polygon that turned over
 * leaves the latter without meaning. */
void ss_linear_weights(const ss_faces *faces, const double (*uv)[2], const ss_location *location, double weights[3]);
bool ss_mean_value_weights(const ss_faces *faces, const double (*uv)[2], const ss_location *location, double *weights);
int32_t ss_largest_face(const ss_faces *faces);

/* ---- subdivision.c ---- */

bool ss_is_subdivided(const skinslide_mesh *mesh);
/* Of a subdivided mesh that passed ss_check_mesh: names the face, vertex, crease or sharpness that cannot be. */
skinslide_status ss_check_subdivision(const skinslide_mesh *mesh, skinslide_error *error);

/* ---- parameter.cpp, limit.cpp: the limit surface; the latter is the only file that knows OpenSubdiv ---- */

/* A point of a face. Quads: bilinear, from corner 0 to 1 and to 3. Triangles of the loop scheme: weights of corners 1 and 2.
 * Other polygons: bilinear in the quad at a corner, from it to the middles of the side after and of the side before it. */
typedef struct ss_parameter {
    int32_t corner; /* of the face, in polygons; else -1 */
    double st[2];
} ss_parameter;

/* The parameters of a location in the embedding. loop: the scheme is. */
ss_parameter ss_parametrise(const ss_faces *faces, bool loop, const double (*uv)[2], const ss_location *location);

typedef struct ss_topology ss_topology; /* a subdivided mesh, checked; keeps the mesh and its arrays */
typedef struct ss_surfaces ss_surfaces; /* limit surfaces of some of its faces: immutable, and good without it */

skinslide_status ss_topology_create(const skinslide_mesh *mesh, ss_topology **out, skinslide_error *error);
void ss_topology_destroy(ss_topology *topology);
typedef enum ss_face_surface {
    SS_SURFACE,         /* the face has a limit surface */
    SS_SURFACE_NONE,    /* it is not rendered */
    SS_SURFACE_REFUSED, /* it would have one but for OpenSubdiv */
} ss_face_surface;
/* kinds out [mesh face_count] */
skinslide_status ss_face_surfaces(const ss_topology *topology, ss_face_surface *kinds, skinslide_error *error);
/* BAD_PATCH where a face has none. label begins messages. */
skinslide_status ss_surfaces_create(const ss_topology *topology, const int32_t *mesh_faces, int32_t count, const char *label,
                                    ss_surfaces **out, skinslide_error *error);
void ss_surfaces_destroy(ss_surfaces *surfaces);
/* Doubles of scratch for ss_limit_prepare. */
int32_t ss_surfaces_scratch(const ss_surfaces *surfaces);
/* The most that ss_limit_stencil writes. */
int32_t ss_surfaces_most_vertices(const ss_surfaces *surfaces);
/* A limit point is the sum of weights times points of mesh vertices, of which one may be there twice. Returns their count. */
int32_t ss_limit_stencil(const ss_surfaces *surfaces, int32_t face, const ss_parameter *at, const int32_t **vertices,
                         double *weights);
/* Gathers what makes the face's surface from the mesh's points, less origin, for ss_limit_point. face counts in the mesh_faces
 * that the surfaces are of. */
void ss_limit_prepare(const ss_surfaces *surfaces, int32_t face, const float *points, const double origin[3], double *scratch);
/* The mesh vertices that make the face's surface. Returns their count. */
int32_t ss_limit_vertices(const ss_surfaces *surfaces, int32_t face, const int32_t **vertices);
void ss_limit_point(const ss_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch, double out[3]);
/* The same with the unit normal, of zeros where the surface has none, and the other way round where faces are left-handed. */
void ss_limit_frame(const ss_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch, double point[3],
                    double normal[3]);
/* The parameters of a place in the quad at a corner: see skinslide_limit_place. */
ss_parameter ss_limit_parameter(const ss_surfaces *surfaces, int32_t face, int32_t corner, double s, double t);

/* ---- sparse.c: the only file that knows KLU ---- */

/* A matrix by rows. */
typedef struct ss_rows {
    int32_t row_count, column_count;
    int32_t *start; /* [row_count + 1] */
    int32_t *column;
    double *value;
} ss_rows;

typedef struct ss_sparse ss_sparse;           /* A'A, factored: immutable */
typedef struct ss_sparse_work ss_sparse_work; /* one a thread */

/* SINGULAR where the condition of A'A leaves too few digits. rows are only read; label begins messages. */
skinslide_status ss_sparse_create(const ss_rows *rows, const char *label, ss_sparse **out, skinslide_error *error);
void ss_sparse_destroy(ss_sparse *sparse);
skinslide_status ss_sparse_work_create(const ss_sparse *sparse, ss_sparse_work **out, skinslide_error *error);
void ss_sparse_work_destroy(ss_sparse_work *work);
/* Puts x with A'A x = b in the place of each b of right: [count][column_count]. */
void ss_sparse_solve(ss_sparse_work *work, double *right, int32_t count);

/* ---- fit.c: the least squares of interpolation LIMIT ---- */

typedef struct ss_fit ss_fit;           /* samples, edges and factors of a patch: immutable */
typedef struct ss_fit_work ss_fit_work; /* one a thread */

/* samples has a row for each sample of a surface, of the weights with which free vertices, its columns, make it: first, in the
 * order of free_vertex, one near each free vertex. It is kept. free_index [vertex_count] is the place in free_vertex, or -1. */
skinslide_status ss_fit_create(const ss_patch *patch, const int32_t *free_index, const ss_rows *samples, ss_fit **out,
                               skinslide_error *error);
void ss_fit_destroy(ss_fit *fit);
skinslide_status ss_fit_work_create(const ss_fit *fit, ss_fit_work **out, skinslide_error *error);
void ss_fit_work_destroy(ss_fit_work *work);
/* displacement [free_count]: in the linear one, out the one that brings each sample nearer to where it is to move by residual,
 * along normal: unit, or 0 for in every direction. Both are [row_count]. points is the whole mesh's. */
void ss_fit_samples(ss_fit_work *work, const float *points, const double (*residual)[3], const double (*normal)[3],
                    double (*displacement)[3]);

/* ---- cage.c: interpolation LIMIT ---- */

typedef struct ss_cage ss_cage;           /* limit surfaces and samples of a patch: immutable */
typedef struct ss_cage_work ss_cage_work; /* one a thread */

/* One patch in one frame. */
typedef struct ss_pose {
    const float *points;          /* [mesh vertex_count][3] */
    const double *lengths;        /* [edge_count] */
    const double (*uv)[2];        /* [vertex_count] Ud */
    const double (*queries)[2];   /* [free_count] */
    const ss_location *locations; /* [free_count] */
} ss_pose;

skinslide_status ss_cage_create(const ss_topology *topology, const ss_patch *patch, bool loop, ss_cage **out,
                                skinslide_error *error);
void ss_cage_destroy(ss_cage *cage);
skinslide_status ss_cage_work_create(const ss_cage *cage, ss_cage_work **out, skinslide_error *error);
void ss_cage_work_destroy(ss_cage_work *work);
/* displacement [free_count]: in the linear one, out the one that keeps the limit surface. Returns how many vertices were
 * damped. */
int32_t ss_move_cage(ss_cage_work *work, const ss_pose *pose, double (*displacement)[3]);

#ifdef __cplusplus
}
#endif

#endif
