/* skinslide: skin that slides over a deformed mesh instead of sticking to it.
 *
 * Method: Yang, Southern, Zhang, "Fast simulation of skin sliding", TR-NCCA-2009-01. A patch of the mesh is embedded in the
 * plane by the force density method at rest and again at each frame; each rest vertex is looked up in the frame's embedding,
 * and the face found there says where on the deformed surface the vertex belongs.
 *
 * Life cycle
 *     skinslide_slider     one mesh with all its patches; built once for a shot; immutable: any number of threads may share it
 *     skinslide_workspace  the memory that sliding a frame needs; one for each thread
 *     skinslide_slide      one call for each frame. Frames do not depend on each other: in any order, on any thread and on any
 *                          machine with the same builds of this library, CAMD and OpenSubdiv they come to the same bytes
 *
 * Conventions
 *     Points are float [vertex][3] in the mesh's object space; lengths are in its units. Work in between is done in double.
 *     Index spaces: a "mesh vertex" or "mesh face" counts within the mesh, a "patch vertex" or "patch face" within one patch.
 *     A skinslide_bool is 0 for no and anything else for yes; those that the library returns are 0 or 1.
 *     Arrays are the caller's; inputs are read during the call only, and are never kept. NULL is allowed only where said.
 *     A function that can fail returns a status; *out and output arrays are written only on success. The last parameter, an
 *     optional skinslide_error of the caller's, then says in one line what is wrong and names the element. No function prints,
 *     aborts or keeps global state; every function may be called on several threads at once for different objects.
 *
 * Versions
 *     A struct that begins with its size may grow at its end. Start from its default, which sets the size and what is not 0.
 *     All elements of an array have the size of the first. Members that the library knows and the program was compiled without
 *     have their defaults. Members that the program has and the library does not know must be 0, or the call fails with
 *     UNSUPPORTED; in results they are set to 0. Structs that only the library makes may grow likewise; other structs without a
 *     size stay as they are. What was added after 0.2 says since which version it is there.
 */
#ifndef SKINSLIDE_H
#define SKINSLIDE_H

#ifndef SKINSLIDE_CDEF /* defined only where the declarations are read by a binding generator */
#include <skinslide/version.h>
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#define SKINSLIDE_API __attribute__((visibility("default")))
#else
#define SKINSLIDE_API
#endif
#else
#define SKINSLIDE_API
#endif

typedef int32_t skinslide_bool;

/* Every status: name and meaning. */
#define SKINSLIDE_STATUSES(X)                                                                                                  \
    X(OK, "done")                                                                                                              \
    X(OUT_OF_MEMORY, "out of memory")                                                                                          \
    X(BAD_ARGUMENT, "an argument cannot be used")                                                                              \
    X(BAD_MESH, "the mesh is not valid")                                                                                       \
    X(BAD_PATCH, "the patch is not a disk with holes")                                                                         \
    X(BAD_CONTROL, "a control of the patch is not valid")                                                                      \
    X(BAD_POINTS, "the points are not valid")                                                                                  \
    X(SINGULAR, "the embedding cannot be solved")                                                                              \
    X(UNSUPPORTED, "not supported")                                                                                            \
    X(NO_DEVICE, "no device for the lookup")                                                                                   \
    X(DEVICE_FAILED, "the device of the lookup failed")                                                                        \
    X(BAD_IMAGE, "the image is not valid")                                                                                     \
    X(INTERRUPTED, "interrupted")

#define SKINSLIDE_STATUS_ENUM(name, text) SKINSLIDE_##name,
typedef enum skinslide_status { SKINSLIDE_STATUSES(SKINSLIDE_STATUS_ENUM) SKINSLIDE_STATUS_COUNT } skinslide_status;
#undef SKINSLIDE_STATUS_ENUM

/* What went wrong: written by a function that fails, left alone by one that does not. */
typedef struct skinslide_error {
    skinslide_status status;
    char message[480]; /* one line, no newline, names patch and element: "patch elbow: edge 812-813 has 3 faces" */
} skinslide_error;

/* "OUT_OF_MEMORY"; "?" for a number that is no status. A static string. */
SKINSLIDE_API const char *skinslide_status_name(skinslide_status status);

/* "out of memory"; "?" for a number that is no status. A static string. */
SKINSLIDE_API const char *skinslide_status_text(skinslide_status status);

/* The library's version, "major.minor.patch". A static string. */
SKINSLIDE_API const char *skinslide_version(void);

/* ---- The mesh and its patches ------------------------------------------------------------------------------------------- */

/* How a mesh is subdivided when rendered, in the words of UsdGeomMesh. USD's fallbacks come first, so that zeros beside the
 * scheme mean what nothing authored means in USD. */
typedef enum skinslide_scheme {
    SKINSLIDE_SCHEME_NONE,
    SKINSLIDE_SCHEME_CATMULL_CLARK,
    SKINSLIDE_SCHEME_LOOP, /* triangles only */
    SKINSLIDE_SCHEME_BILINEAR
} skinslide_scheme;

typedef enum skinslide_boundary_rule {
    SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER, /* the surface reaches edges with one face, and vertices with one face */
    SKINSLIDE_BOUNDARY_RULE_EDGE_ONLY,
    SKINSLIDE_BOUNDARY_RULE_NONE /* faces at the boundary of the mesh are holes */
} skinslide_boundary_rule;

typedef enum skinslide_triangle_rule {
    SKINSLIDE_TRIANGLE_RULE_CATMULL_CLARK,
    SKINSLIDE_TRIANGLE_RULE_SMOOTH /* Catmull-Clark only */
} skinslide_triangle_rule;

/* The subdivision of a mesh. Sharpness is >= 0, and 10 or more is infinitely sharp. Start from
 * SKINSLIDE_SUBDIVISION_DEFAULT. */
typedef struct skinslide_subdivision {
    size_t size; /* sizeof(skinslide_subdivision) */
    skinslide_scheme scheme;
    skinslide_boundary_rule boundary_rule;
    skinslide_triangle_rule triangle_rule;
    int32_t crease_count;
    int32_t crease_index_count;      /* the sum of crease_lengths */
    int32_t crease_sharpness_count;  /* crease_count, or one for each edge of each crease: crease_index_count - crease_count */
    const int32_t *crease_lengths;   /* [crease_count] vertices of each crease, each >= 2 */
    const int32_t *crease_indices;   /* [crease_index_count] mesh vertices; successive ones of a crease must share an edge */
    const float *crease_sharpnesses; /* [crease_sharpness_count] */
    int32_t corner_count;
    const int32_t *corner_indices;   /* [corner_count] mesh vertices */
    const float *corner_sharpnesses; /* [corner_count] */
    int32_t hole_count;
    const int32_t *hole_indices; /* [hole_count] mesh faces that are not rendered */
} skinslide_subdivision;

#define SKINSLIDE_SUBDIVISION_DEFAULT                                                                                          \
    {                                                                                                                          \
        sizeof(skinslide_subdivision), SKINSLIDE_SCHEME_NONE, SKINSLIDE_BOUNDARY_RULE_EDGE_AND_CORNER,                         \
            SKINSLIDE_TRIANGLE_RULE_CATMULL_CLARK, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0                                             \
    }

/* A polygon mesh at rest. Counts and indices are those of UsdGeomMesh. Start from SKINSLIDE_MESH_DEFAULT. */
typedef struct skinslide_mesh {
    size_t size; /* sizeof(skinslide_mesh) */
    int32_t vertex_count;
    int32_t face_count;
    int32_t index_count;                      /* the sum of face_counts */
    const int32_t *face_counts;               /* [face_count] vertices of each face */
    const int32_t *face_indices;              /* [index_count] mesh vertices, face by face */
    const float *rest_points;                 /* [vertex_count][3] the pose in which nothing slides; finite where a face is */
    const skinslide_subdivision *subdivision; /* NULL: none */
    const int32_t *weld; /* [vertex_count] the vertex that each is one with, itself for most: see skinslide_weld_get. NULL: each
                            is its own. Points, edges, corners, boundaries and paint are then those of the welded mesh, and the
                            limit surface that of the faces as they are */
    const double *space; /* [3][3] takes points, as rows, to where lengths are taken, such as the world; it has an inverse, and
                            largest distances and slides are there. NULL: the mesh's object space */
} skinslide_mesh;

#define SKINSLIDE_MESH_DEFAULT                                                                                                 \
    { sizeof(skinslide_mesh), 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* What the outer boundary of a patch is laid out on (paper, section 3.2). AUTO: SQUARE with corners, else CIRCLE. */
typedef enum skinslide_boundary {
    SKINSLIDE_BOUNDARY_AUTO,
    SKINSLIDE_BOUNDARY_SQUARE, /* the unit square; without corners: the sharpest vertex and those nearest the quarters of the
                                  arc */
    SKINSLIDE_BOUNDARY_CIRCLE  /* its inscribed circle, by rest arc length */
} skinslide_boundary;

/* What holds the loops of holes (eyes, nostrils, mouth, the other end of a sleeve). */
typedef enum skinslide_holes {
    SKINSLIDE_HOLES_PINNED,  /* each where it falls at rest with the holes capped; embeddings rarely fold; folds are counted */
    SKINSLIDE_HOLES_FREE,    /* nothing: loops slide along themselves; embeddings may fold; folds are counted */
    SKINSLIDE_HOLES_FREE_ALL /* nothing, and the outer boundary slides along itself too: under RELAXED and EVEN only */
} skinslide_holes;

/* Where skin slides to. UNIT and FAST are the paper's: force density of an edge of length l (section 3.1), and a lookup in
 * the plane; they need a patch that is a disk with holes. RELAXED and EVEN slide on the rest surface itself, and take a
 * patch with any number of handles and boundaries, or none: corners and boundary have no effect, and there is no
 * embedding.
 *
 * EVEN goes to where the logarithms of edge lengths over rest lengths are in balance, less their median, which is the
 * character's scale, and those of compressed edges bounded: smooth in the pose, and so in time.
 *
 * RELAXED goes to where every edge is as near its rest length as the deformed surface allows: from where EVEN leaves skin,
 * held more, three steps on the pose itself towards a minimum of the sum of k log^2(l / rest l), k the painted force
 * density, with compressed edges bounded as there; skin that a pose crushes stays nearer to where it was left. Smooth in the
 * pose, as EVEN is, which is why it is no minimum. */
typedef enum skinslide_rule {
    SKINSLIDE_RULE_UNIT, /* 1/l */
    SKINSLIDE_RULE_FAST, /* m - l^2 + 1e-4 m, m the largest l^2 of the patch in that pose */
    SKINSLIDE_RULE_RELAXED,
    SKINSLIDE_RULE_EVEN
} skinslide_rule;

/* How a point in a face of the embedding becomes a point on the deformed mesh. AUTO: LIMIT on a subdivided mesh, else LINEAR.
 * LIMIT keeps the shape of the limit surface and not that of the faces: from the LINEAR result, the limit points of the free
 * vertices and of the middles of the patch's faces are taken back, along the normal, to where each is looked up on the limit
 * surface of the deformed mesh, as near as the free vertices can take all of them with every other held and with edges that
 * nearly keep the length that LINEAR gives them. It can be as near as faces are fine for the slide. Where the pose crumples the
 * surface, its normals jump: there they are taken back less along the normal, and in every direction instead. A vertex that
 * this would take farther from its LINEAR place than half the mean edge where it lands is held back to that distance, and
 * counted as damped: the solve rings where a target jumps over a crease. From 3/4 of it on vertices slow down. It is limit
 * points that weights scale the slide of: one of weight 0 stays, and its vertex follows so that it does. */
typedef enum skinslide_interpolation {
    SKINSLIDE_INTERPOLATION_AUTO,
    SKINSLIDE_INTERPOLATION_LINEAR,     /* barycentric, in the triangle fan from the face's first vertex */
    SKINSLIDE_INTERPOLATION_MEAN_VALUE, /* mean value coordinates in the polygon */
    SKINSLIDE_INTERPOLATION_LIMIT       /* on the subdivision limit surface */
} skinslide_interpolation;

/* What an artist paints and animates on a patch. Start from SKINSLIDE_CONTROLS_DEFAULT. Force densities multiply each other and
 * the rule's; each must be finite and > 0. Only ratios matter. */
typedef struct skinslide_controls {
    size_t size;                 /* sizeof(skinslide_controls) */
    const float *vertex_density; /* [mesh vertex_count] or NULL: 1; an edge takes the mean of its ends */
    const float *face_density;   /* [mesh face_count] or NULL: 1; an edge takes the mean of its faces in the patch */
    const int32_t *edges;        /* [edge_count][2] mesh vertices of edges of the patch, each edge at most once; or NULL */
    const float *edge_density;   /* [edge_count] */
    int32_t edge_count;
    float envelope;      /* scales every weight, 0..1 (clamped, and counted once) */
    const float *weight; /* [mesh vertex_count] or NULL: 1; how far each vertex slides, 0..1 (clamped, and counted). Under LIMIT
                            a vertex of weight 0 still moves as its neighbours slide, so that its limit point stays */
    const float *max_distance; /* [mesh vertex_count] or NULL: no limit; how far each vertex may slide along the surface, >= 0,
                                  object units; measured on the triangles that `linear` interpolates in */
    const float *hold; /* [mesh vertex_count] or NULL: 1; under RELAXED and EVEN: how closely a vertex follows the slide of its
                          neighbours, finite and > 0: low where surplus skin is to come from, high where it must not */
    float stretch_response;     /* under RELAXED and EVEN: how much of the stretch is evened out, 0..1 */
    float compression_response; /* and how much of the compression */
} skinslide_controls;

#define SKINSLIDE_CONTROLS_DEFAULT                                                                                             \
    { sizeof(skinslide_controls), 0, 0, 0, 0, 0, 1.0f, 0, 0, 0, 1.0f, 1.0f }

/* One patch as an artist sets it up. Faces that fall into several pieces, connected through edges, become several patches with
 * the same settings; corners then count for the piece that has them. A vertex in which pieces touch stays; under UNIT and FAST,
 * only on borders. Start from SKINSLIDE_PATCH_SETUP_DEFAULT. */
typedef struct skinslide_patch_setup {
    size_t size;            /* sizeof(skinslide_patch_setup) */
    const char *name;       /* used in messages; copied */
    const int32_t *faces;   /* [face_count] mesh faces, each once */
    int32_t face_count;     /* > 0 */
    const int32_t *corners; /* [4] mesh vertices on the outer loop, in any order, or NULL: none */
    skinslide_boundary boundary;
    skinslide_holes holes;
    skinslide_rule rule;
    skinslide_interpolation interpolation;
    const skinslide_controls *controls; /* used by frames that bring none of their own; NULL: the default */
    const uint8_t *held; /* [mesh vertex_count] 1 for vertices that stay where they are on a border, whatever `holes` says, such
                            as those at which another mesh meets this one; NULL: none */
} skinslide_patch_setup;

#define SKINSLIDE_PATCH_SETUP_DEFAULT                                                                                          \
    {                                                                                                                          \
        sizeof(skinslide_patch_setup), 0, 0, 0, 0, SKINSLIDE_BOUNDARY_AUTO, SKINSLIDE_HOLES_PINNED, SKINSLIDE_RULE_UNIT,       \
            SKINSLIDE_INTERPOLATION_AUTO, 0, 0                                                                                 \
    }

/* ---- Points in one place ------------------------------------------------------------------------------------------------- */

/* Which points of a mesh are to be one vertex: meshes from games and exporters have a point for each side of a seam, or for
 * each corner of a face. Points that are in one place at rest, and in every pose shown, are welded where faces of patches meet
 * there edge to edge: a side of one face and a side of another run between the same places, in opposite directions. Points off
 * the patches are welded to those of the patches in the same place. Points stay apart in a place where a face has two corners,
 * and where welding would give an edge more than two faces, as in a doubled sheet, or two faces that are wound against each
 * other.
 *
 * The answer must be the same for every part of a shot: show all poses of the shot, not only those that are to be slid. */
typedef struct skinslide_weld skinslide_weld;

/* Begins with the rest points.
 *   mesh       in  its weld is not read
 *   setups     in  [setup_count] only their faces are read; faces that the mesh does not have are ignored
 *   tolerance  in  points within this distance are in one place, as are points linked by a chain of such; object units, 0 to a
 *                  thousandth of the diagonal of the rest points' box. 0: where their coordinates are equal
 *   out        out the caller's to destroy
 * Fails with BAD_MESH, BAD_POINTS (rest points not finite), BAD_ARGUMENT (also a tolerance out of range), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_weld_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                                                     int32_t setup_count, double tolerance, skinslide_weld **out,
                                                     skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_weld_destroy(skinslide_weld *weld);

/* Whether poses need be shown: not where no point of a patch shares its place at rest. */
SKINSLIDE_API skinslide_bool skinslide_weld_wants_poses(const skinslide_weld *weld);

/* Shows a pose; call it in the order of time. Points that are apart in it are not welded. One thread at a time for a weld.
 *   frame   in  its time, which skinslide_weld_info reports
 *   points  in  [vertex_count][3]
 * Fails with BAD_POINTS (a point that shares a place is not finite: names it), BAD_ARGUMENT, and then leaves the pose out. */
SKINSLIDE_API skinslide_status skinslide_weld_show(skinslide_weld *weld, double frame, const float *points,
                                                   skinslide_error *error);

/* What was welded. Start from SKINSLIDE_WELD_INFO_DEFAULT. */
typedef struct skinslide_weld_info {
    size_t size;            /* sizeof(skinslide_weld_info) */
    int32_t welded_points;  /* points that are welded to others */
    int32_t welded_places;  /* vertices that these make */
    int32_t parted_points;  /* points that would be welded to others, were they not apart in some pose */
    int32_t refused_points; /* points of patches in places that cannot be one vertex */
    int32_t parted_vertex;  /* the first point that parts from another ... */
    int32_t parted_from;    /* ... that other ... */
    double parted_frame;    /* ... and when it does */
    char refused[160];      /* why the first place cannot be one: "vertices 3 and 4 are both corners of face 2"; or empty */
} skinslide_weld_info;

#define SKINSLIDE_WELD_INFO_DEFAULT                                                                                            \
    { sizeof(skinslide_weld_info), 0, 0, 0, 0, 0, 0, 0, "" }

/* The answer.
 *   vertices  out [vertex_count] the vertex that each is one with, as skinslide_mesh has it: the lowest one of a patch in that
 *                 place; most are themselves
 *   info      out, or NULL
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_weld_get(const skinslide_weld *weld, int32_t *vertices, skinslide_weld_info *info,
                                                  skinslide_error *error);

/* ---- The slider --------------------------------------------------------------------------------------------------------- */

typedef struct skinslide_slider skinslide_slider;

/* Builds every patch of a mesh: connectivity, boundary and holes in the plane, the symbolic factor, the rest embedding.
 *   mesh    in
 *   setups  in  [setup_count]; setup_count >= 0
 *   out     out, the caller's to destroy
 * Fails with BAD_MESH (an index out of range, counts that do not add up, and in patches faces of fewer than three or of
 * repeated vertices), BAD_POINTS (rest points not finite), BAD_PATCH (no faces, a face twice or out of range, no boundary, an
 * edge with three faces, faces wound against each other, a boundary that touches itself, faces that meet in a vertex alone, a
 * handle; RELAXED and EVEN need no boundary, take handles, and let vertices at which faces meet in a point stay), BAD_CONTROL
 * (a density or a hold not > 0, a response not in 0..1, a weight or an envelope that is not a number, a largest distance not
 * >= 0, edges not of the patch, corners not on the outer loop), BAD_ARGUMENT (NULL, a negative count, an unknown enum value),
 * SINGULAR, UNSUPPORTED (FREE_ALL by UNIT or FAST), OUT_OF_MEMORY.
 * With LIMIT also with BAD_MESH (a face of fewer than three vertices or under LOOP not a triangle, a crease that is not an
 * edge, a sharpness out of range, counts or indices of the subdivision that do not fit), BAD_PATCH (a face that is a hole of
 * the surface), BAD_CONTROL (the mesh is not subdivided), UNSUPPORTED (also a vertex with more than 256 faces, or a face with
 * more than 256 vertices). */
SKINSLIDE_API skinslide_status skinslide_slider_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                                                       int32_t setup_count, skinslide_slider **out, skinslide_error *error);

/* A slider under construction, for building many set-ups on several threads. The slider is the same in the end. */
typedef struct skinslide_build skinslide_build;

/* Makes what all set-ups share. Unlike elsewhere, the arrays of the mesh and of the set-ups must stay until
 * skinslide_build_finish returns, or the build is destroyed.
 *   mesh    in
 *   setups  in  [setup_count]; setup_count >= 0
 *   out     out, the caller's to destroy
 * Fails as skinslide_slider_create does where the mesh or its rest points are bad. */
SKINSLIDE_API skinslide_status skinslide_build_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                                                      int32_t setup_count, skinslide_build **out, skinslide_error *error);

/* Builds the patches of one set-up, unless they are built already or there is no such set-up. Several threads may build
 * different set-ups at once. It reports no errors: skinslide_build_finish does. */
SKINSLIDE_API void skinslide_build_setup(skinslide_build *build, int32_t setup);

/* Builds the set-ups that are not built yet, and completes the slider. No other thread may use the build at that time, and
 * afterwards it can only be destroyed.
 *   out  out the slider, the caller's to destroy
 * Fails as skinslide_slider_create does, for the first set-up that is bad; also with BAD_ARGUMENT (it was finished before). */
SKINSLIDE_API skinslide_status skinslide_build_finish(skinslide_build *build, skinslide_slider **out, skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_build_destroy(skinslide_build *build);

/* NULL does nothing. Destroy the slider's workspaces first. */
SKINSLIDE_API void skinslide_slider_destroy(skinslide_slider *slider);

/* What a patch is. Patches are numbered set-up by set-up, and the pieces of one set-up by their lowest face. Start from
 * SKINSLIDE_PATCH_INFO_DEFAULT. */
typedef struct skinslide_patch_info {
    size_t size;               /* sizeof(skinslide_patch_info) */
    const char *name;          /* the set-up's; lives as long as the slider */
    int32_t setup;             /* its number, from 0 */
    int32_t piece;             /* of this set-up, from 0 */
    int32_t piece_count;       /* of this set-up */
    int32_t vertex_count;      /* of the patch; RELAXED and EVEN split those at which faces meet only in a point, which stay */
    int32_t edge_count;        /* of the patch, each once */
    int32_t face_count;        /* of the patch */
    int32_t free_count;        /* vertices that may slide */
    int32_t hole_count;        /* boundary loops but the longest */
    int32_t zero_length_edges; /* at rest: taken as 1e-6 of the mean edge */
    int32_t collapsed_faces; /* of no area in the rest embedding, such as a triangle with two edges on one side of the square */
    int32_t folded_faces;    /* turned over in the rest embedding */
    int32_t held_count;      /* vertices on borders that would slide, were they not held by the set-up */
} skinslide_patch_info;

#define SKINSLIDE_PATCH_INFO_DEFAULT                                                                                           \
    { sizeof(skinslide_patch_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* How many patches a slider has. They are numbered from 0. */
SKINSLIDE_API int32_t skinslide_slider_patch_count(const skinslide_slider *slider);

/* What a patch of a slider is. Fails with BAD_ARGUMENT (there is no such patch). */
SKINSLIDE_API skinslide_status skinslide_slider_patch_info(const skinslide_slider *slider, int32_t patch,
                                                           skinslide_patch_info *info, skinslide_error *error);

/* The vertices of a patch.
 *   vertices  out [vertex_count of the patch] the mesh vertex of each patch vertex, ascending; a vertex that is split comes
 *                 once for each part, and of welded points only the one that the others are welded to
 * Fails with BAD_ARGUMENT (there is no such patch). */
SKINSLIDE_API skinslide_status skinslide_slider_patch_vertices(const skinslide_slider *slider, int32_t patch, int32_t *vertices,
                                                               skinslide_error *error);

/* The faces of a patch.
 *   faces  out [face_count of the patch] the mesh face of each patch face, ascending
 * Fails with BAD_ARGUMENT (there is no such patch). */
SKINSLIDE_API skinslide_status skinslide_slider_patch_faces(const skinslide_slider *slider, int32_t patch, int32_t *faces,
                                                            skinslide_error *error);

/* Whether the points of a frame can be slid. Points that sliding does not read, as no face at a patch has them, may hold
 * anything, and are copied as they are.
 *   points   in  [vertex_count][3]
 *   passed   out how many of these are not finite
 *   warning  out, or NULL: if there are any, names the first
 * Fails as skinslide_slide does: with BAD_POINTS (not finite: names the vertex), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_slider_check_points(const skinslide_slider *slider, const float *points,
                                                             int32_t *passed, skinslide_error *warning, skinslide_error *error);

/* How many vertices of a patch have a point of another mesh in their place. Start from SKINSLIDE_NEIGHBOURS_DEFAULT. */
typedef struct skinslide_neighbours {
    size_t size;   /* sizeof(skinslide_neighbours) */
    int32_t held;  /* how many of them stay */
    int32_t loose; /* how many may slide, away from the other mesh */
} skinslide_neighbours;

#define SKINSLIDE_NEIGHBOURS_DEFAULT                                                                                           \
    { sizeof(skinslide_neighbours), 0, 0 }

/* Counts the vertices of a patch at which another mesh meets it, as where a head and a body meet at the neck.
 *   points     in  [vertex_count][3] the slider's mesh in some pose
 *   others     in  [other_count][3] the other mesh in that pose, in the same space
 *   tolerance  in  as for skinslide_weld_create, but with no upper bound; 0 is fast
 *   found      out
 * Fails with BAD_ARGUMENT (there is no such patch; NULL), BAD_POINTS (not finite), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_slider_neighbours(const skinslide_slider *slider, int32_t patch, const float *points,
                                                           const float *others, int32_t other_count, double tolerance,
                                                           skinslide_neighbours *found, skinslide_error *error);

/* The rest embedding U0 of a patch.
 *   uv  out [vertex_count of the patch][2], in [0,1]^2 up to rounding
 * Fails with BAD_ARGUMENT (there is no such patch), UNSUPPORTED (its rule has no embedding). */
SKINSLIDE_API skinslide_status skinslide_slider_embedding(const skinslide_slider *slider, int32_t patch, double *uv,
                                                          skinslide_error *error);

/* ---- Frames ------------------------------------------------------------------------------------------------------------- */

/* How rest vertices are looked up in the frame's embedding. The result is the same, bit for bit. */
typedef enum skinslide_lookup {
    SKINSLIDE_LOOKUP_AUTO, /* EGL where it has a hardware device; EXACT on software rasterisers and where EGL is missing, its
                              device fails when the workspace is made, or a fixed resolution is above the device's limit */
    SKINSLIDE_LOOKUP_EGL,  /* proposed by rendering each face in its own colour (paper, section 3.3), then tested exactly; found
                              by walking where the texture missed */
    SKINSLIDE_LOOKUP_EXACT /* by walking from face to face */
} skinslide_lookup;

#define SKINSLIDE_ANY_DEVICE (-1)

/* How a workspace works. Start from SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT. */
typedef struct skinslide_workspace_options {
    size_t size; /* sizeof(skinslide_workspace_options) */
    skinslide_lookup lookup;
    int32_t device;     /* number of one of EGL's devices, the only one tried; or SKINSLIDE_ANY_DEVICE: EGL's devices in their
                           order, hardware before software, then its surfaceless platform, then its default display */
    int32_t resolution; /* texels along a side of the texture, within the device's limit (OpenGL ES 3 has 2048 or more); 0:
                           for each patch, the power of two from 256 to 4096, within the device's limit, that is at least four
                           times the square root of its free vertices, and up to four times as large where the smallest face of
                           the rest embedding would be under a texel */
} skinslide_workspace_options;

#define SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT                                                                                    \
    { sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_AUTO, SKINSLIDE_ANY_DEVICE, 0 }

/* Which lookup the options lead to on this machine. Start from SKINSLIDE_LOOKUP_INFO_DEFAULT. */
typedef struct skinslide_lookup_info {
    size_t size;             /* sizeof(skinslide_lookup_info) */
    skinslide_lookup lookup; /* EGL or EXACT */
    char reason[480];        /* why AUTO led to EXACT, or how the device failed last; one line, or empty */
} skinslide_lookup_info;

#define SKINSLIDE_LOOKUP_INFO_DEFAULT                                                                                          \
    { sizeof(skinslide_lookup_info), SKINSLIDE_LOOKUP_EXACT, "" }

/* A device that draws. Start from SKINSLIDE_DEVICE_INFO_DEFAULT. */
typedef struct skinslide_device_info {
    size_t size;                /* sizeof(skinslide_device_info) */
    int32_t device;             /* its number, or SKINSLIDE_ANY_DEVICE where the display has none, or there is no device */
    skinslide_bool software;    /* whether it is a software rasteriser */
    int32_t largest_resolution; /* texels along a side, the device's limit; 0: there is no device */
    char device_name[96];       /* "EGL device 0 (/dev/dri/card0)" */
    char renderer[128];         /* as the driver names the device */
    char driver[128];           /* its version */
} skinslide_device_info;

#define SKINSLIDE_DEVICE_INFO_DEFAULT                                                                                          \
    { sizeof(skinslide_device_info), SKINSLIDE_ANY_DEVICE, 0, 0, "", "", "" }

/* Says which lookup the options lead to. Where that must be tried, it makes a context, with the largest texture that a
 * workspace with these options could ask for, and destroys it.
 *   options  in, or NULL: the default
 *   info     out
 *   device   out, or NULL: that of lookup EGL; for EXACT there is none
 * Fails with BAD_ARGUMENT (no such lookup, device or resolution), DEVICE_FAILED, NO_DEVICE (lookup EGL: names all that was
 * tried, with EGL's errors), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_choose_lookup(const skinslide_workspace_options *options, skinslide_lookup_info *info,
                                                       skinslide_device_info *device, skinslide_error *error);

typedef struct skinslide_workspace skinslide_workspace;

/* Memory for sliding frames of a slider. Only one thread at a time may use it, but not always the same. The slider must outlive
 * it. With lookup EGL it has an OpenGL ES context of its own, which is current only within calls: whatever EGL context the
 * thread had is current again after each. A thread cannot use EGL while a context of another system, such as GLX, is current.
 *   options  in, or NULL: the default
 * Fails with OUT_OF_MEMORY, BAD_ARGUMENT (no such lookup, device or resolution), and with lookup EGL NO_DEVICE,
 * DEVICE_FAILED. */
SKINSLIDE_API skinslide_status skinslide_workspace_create(const skinslide_slider *slider,
                                                          const skinslide_workspace_options *options, skinslide_workspace **out,
                                                          skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_workspace_destroy(skinslide_workspace *workspace);

/* Makes the frame that is being slid in the workspace, or the next one where there is none, fail soon with INTERRUPTED: work
 * stops between stages, and between steps of the long ones. This is the only function that may be called while another thread
 * uses the workspace, and signal handlers may call it. NULL does nothing. */
SKINSLIDE_API void skinslide_workspace_interrupt(skinslide_workspace *workspace);

/* Which lookup a workspace's options led to.
 *   info    out
 *   device  out, or NULL: that of lookup EGL; for EXACT there is none
 * Fails with BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_workspace_lookup(const skinslide_workspace *workspace, skinslide_lookup_info *info,
                                                          skinslide_device_info *device, skinslide_error *error);

/* What happened to one patch in one frame. Everything but the seconds is the same in every run with the same lookup; how many
 * vertices were found in which way depends on the lookup, its resolution and its device. Start from
 * SKINSLIDE_PATCH_RESULT_DEFAULT. */
typedef struct skinslide_patch_result {
    size_t size;               /* sizeof(skinslide_patch_result) */
    int32_t slid_vertices;     /* free vertices that moved */
    int32_t clamped_vertices;  /* looked up outside every face (in a hole), put on the nearest */
    int32_t clamped_weights;   /* weights and envelope that were outside 0..1 */
    int32_t damped_vertices;   /* LIMIT only: brought back towards their place under LINEAR */
    int32_t folded_faces;      /* turned over in this frame's embedding; none on a disk, rarely any with pinned holes. Under
                                  RELAXED and EVEN: turned over on the rest surface, once its corners are where they slide to */
    int32_t zero_length_edges; /* in this frame: taken as 1e-6 of the mean rest edge */
    int32_t found_in_centre;   /* vertices in the face of their own texel of the texture */
    int32_t found_in_3x3;      /* in another face of the texels around it */
    int32_t walked_vertices;   /* found by walking */
    int32_t searched_vertices; /* that the walk could not reach, found by the tree of faces */
    int32_t lost_textures;     /* 1 where lookup EGL failed (a lost context) and every vertex was found by walking */
    int32_t relax_steps;       /* under RELAXED: steps on the pose itself: 3, or fewer where the next could not be solved */
    int64_t walk_steps;        /* triangles entered by walking, in all */
    double largest_slide;      /* of a vertex from its place in the cache, overlapping patches included; object units */
    double stretch_before;     /* RMS over the patch's edges of log(length / rest length), in the cache */
    double stretch_after;      /* and in the result, overlapping patches included */

    double density_seconds;     /* force densities from edge lengths */
    double embed_seconds;       /* the frame's embedding */
    double relax_seconds;       /* under RELAXED and EVEN, in place of embedding and locating */
    double locate_seconds;      /* looking rest vertices up in the embedding */
    double interpolate_seconds; /* their places on the deformed surface; under LIMIT, fitting the faces to them too */
    int32_t cut_steps;          /* under RELAXED and EVEN: how many of their steps were cut short, lest a face turn over */
} skinslide_patch_result;

#define SKINSLIDE_PATCH_RESULT_DEFAULT                                                                                         \
    { sizeof(skinslide_patch_result), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* Slides the skin of one frame (paper, section 3): density, embed, locate and interpolate for every patch, then blend them.
 *   points    in  [vertex_count][3] the deformed mesh
 *   controls  in  [setup_count] the frame's controls, in place of the set-ups' own; NULL: the set-ups' own. Force
 *                 densities that differ from the set-up's cost a second embedding, since rest is then embedded again.
 *   slid      out [vertex_count][3] the corrected points; may be points itself. Bits stay the same of vertices outside
 *                 patches, but for those welded to one that slides; of vertices that are on the outer boundary or a pinned
 *                 hole of every patch they are in; and of all vertices when points are the rest points. A vertex that may
 *                 slide in several patches moves by the mean of their displacements, weighted by weight times envelope.
 *   results   out [patch_count]; only the first need have its size. NULL: nothing is measured, which is faster
 * Fails with BAD_ARGUMENT (NULL, edges without densities), BAD_POINTS (not finite, or slid beyond what a float can hold: names
 * the vertex; see skinslide_slider_check_points), BAD_CONTROL, SINGULAR, OUT_OF_MEMORY, INTERRUPTED. One thread at a time for a
 * workspace. */
SKINSLIDE_API skinslide_status skinslide_slide(skinslide_workspace *workspace, const float *points,
                                               const skinslide_controls *controls, float *slid, skinslide_patch_result *results,
                                               skinslide_error *error);

/* What makes a result less than it should be: each kind, from 0 on, is a count of skinslide_patch_result.
 *   warning  out  the count in words, such as "3 faces turned over in the embedding"; may be NULL
 * Returns the name of its member, such as "folded_faces"; NULL beyond the last kind. */
SKINSLIDE_API const char *skinslide_degradation(int32_t kind, int32_t count, skinslide_error *warning);

/* The same of a patch in the last frame that this workspace slid, measured or not.
 *   warning  out  if there are any, "patch elbow: 3 faces turned over in the embedding"; may be NULL
 * Returns the count; -1 beyond the last patch or kind, before the first frame, and after a frame that could not be finished.
 * One thread at a time for a workspace. */
SKINSLIDE_API int32_t skinslide_workspace_degraded(const skinslide_workspace *workspace, int32_t patch, int32_t kind,
                                                   skinslide_error *warning);

/* The embedding Ud of a patch in the last frame that this workspace slid.
 *   uv  out [vertex_count of the patch][2]
 * Fails with BAD_ARGUMENT where there is no such patch or no frame yet, UNSUPPORTED where the rule has none. */
SKINSLIDE_API skinslide_status skinslide_workspace_embedding(const skinslide_workspace *workspace, int32_t patch, double *uv,
                                                             skinslide_error *error);

/* The texture of lookup EGL: the last frame's embedding, drawn again, for pictures of it.
 *   side    out  texels along a side
 *   texels  out  [side][side], in rows of u from v = 0 on: 1 + patch face, 0 where there is none; NULL: only side is wanted
 * Fails with BAD_ARGUMENT where there is no such patch, no frame yet, or the lookup is EXACT; UNSUPPORTED where the rule has no
 * embedding; DEVICE_FAILED, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_workspace_id_buffer(skinslide_workspace *workspace, int32_t patch, int32_t *side,
                                                             uint32_t *texels, skinslide_error *error);

/* Searches for the least stretch that a pose allows, which is slow. Vertices inside a patch may go anywhere on it, and faces
 * may turn over; the search begins both from where the cache has vertices and from where the last frame that this workspace
 * slid left them. Of the stretch that can be removed, sliding removes the share (before - after) / (before - least); a slider
 * with the rule RELAXED finds the lowest.
 *   points  in  [vertex_count][3] of that frame
 *   least   out [patch_count] RMS over the edges of log(length / rest length), no more than in the cache
 * Fails with BAD_ARGUMENT (NULL, no frame yet), BAD_POINTS, SINGULAR, OUT_OF_MEMORY, INTERRUPTED. One thread at a time for a
 * workspace. */
SKINSLIDE_API skinslide_status skinslide_workspace_least_stretch(skinslide_workspace *workspace, const float *points,
                                                                 double *least, skinslide_error *error);

/* ---- What a slide did, by vertex ---------------------------------------------------------------------------------------- */

/* Measures of a slide, for pictures and maps. Only edges of patches count, each once. Any of the arrays may be NULL: it is not
 * wanted. Start from SKINSLIDE_DIAGNOSTICS_DEFAULT. */
typedef struct skinslide_diagnostics {
    size_t size;           /* sizeof(skinslide_diagnostics) */
    float *stretch_before; /* out [vertex_count] RMS over the edges at the vertex of log(length / rest length), in the cache */
    float *stretch_after;  /* out [vertex_count] and in the result; 0 at vertices of no patch */
    float *slide;          /* out [vertex_count] distance of slid from cached, object units */
    float *force_density;  /* out [vertex_count] the painted one: mean over the edges of a patch at the vertex, and over the
                              patches where they overlap; 1 at vertices of none */
} skinslide_diagnostics;

#define SKINSLIDE_DIAGNOSTICS_DEFAULT                                                                                          \
    { sizeof(skinslide_diagnostics), 0, 0, 0, 0 }

/* Measures one frame.
 *   controls     in  [setup_count] as for skinslide_slide; NULL: the set-ups' own
 *   chosen       in  [setup_count] 0: the patches of the set-up do not count; NULL: all do
 *   cached       in  [vertex_count][3] the points before sliding
 *   slid         in  [vertex_count][3] after
 *   diagnostics  in, its arrays out
 * Fails with BAD_ARGUMENT (NULL, edges without densities), BAD_POINTS (not finite, or a slide longer than a float can hold:
 * names the vertex), BAD_CONTROL (also a density larger than a float can hold), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_diagnose(const skinslide_slider *slider, const skinslide_controls *controls,
                                                  const uint8_t *chosen, const float *cached, const float *slid,
                                                  const skinslide_diagnostics *diagnostics, skinslide_error *error);

/* ---- The limit surface -------------------------------------------------------------------------------------------------- */

/* A place on a limit surface. Every face of n vertices is n quads, one a corner, that meet at its middle: s goes from the
 * corner along its side to the next corner, t along the side to the one before, and both are 1 at the middle of the face. */
typedef struct skinslide_limit_place {
    int32_t corner; /* an index of face_indices */
    float s, t;     /* 0..1 */
} skinslide_limit_place;

/* Which faces of a subdivided mesh have a limit surface, so that a patch of interpolation limit may have them: not its holes,
 * none at a boundary that is not interpolated, and none that skinslide_limit_points finds unsupported.
 *   mesh   in   rest_points are not read
 *   faces  out  [face_count] 1 or 0
 * Fails with BAD_ARGUMENT (NULL), BAD_MESH (as above, or a mesh that is not subdivided), UNSUPPORTED, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_limit_faces(const skinslide_mesh *mesh, uint8_t *faces, skinslide_error *error);

/* Points of the limit surface of a subdivided mesh.
 *   mesh     in   rest_points are not read
 *   points   in   [vertex_count][3]
 *   places   in   [count]
 *   out      out  [count][3]
 * Fast where places of one face follow each other.
 * Fails with BAD_ARGUMENT, BAD_MESH (as above, or a mesh that is not subdivided), BAD_PATCH (a place on a hole), BAD_POINTS,
 * UNSUPPORTED (a vertex with more than 256 faces, a face with more than 256 vertices, with OpenSubdiv before 3.5.1 some faces
 * with creases, at a boundary or where the mesh is not manifold), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_limit_points(const skinslide_mesh *mesh, const float *points,
                                                      const skinslide_limit_place *places, int32_t count, float *out,
                                                      skinslide_error *error);

/* ---- What else a cache holds -------------------------------------------------------------------------------------------- */

/* How the skin turned under each vertex in the last frame that this workspace slid: the least rotation from the smooth normal
 * of the cache at the vertex's own place to that at the place it slid to. The smooth normal of a vertex is the mean over all
 * faces of the mesh at it, and is blended between vertices.
 *   points  in   [vertex_count][3] those of that frame, before sliding
 *   turns   out  [vertex_count][3] axis times the sine of half the angle, right-handed, the angle at most half a circle; 0
 *                where, and only where, a vertex did not slide, no face there has an area, or the normals are opposite
 * Fails with BAD_ARGUMENT (NULL, no frame yet), BAD_POINTS (not finite), OUT_OF_MEMORY. One thread at a time for a
 * workspace. */
SKINSLIDE_API skinslide_status skinslide_workspace_turns(skinslide_workspace *workspace, const float *points, float *turns,
                                                         skinslide_error *error);

/* Which elements carry a vector, such as a normal, as USD names it. */
typedef enum skinslide_normals_layout {
    SKINSLIDE_NORMALS_VERTEX,       /* [vertex_count][3] */
    SKINSLIDE_NORMALS_FACE_VARYING, /* [index_count][3]; each turns as its vertex, so corners keep the angles between them */
    SKINSLIDE_NORMALS_UNIFORM       /* [face_count][3]; by the mean of the turns of the face's vertices */
} skinslide_normals_layout;

/* Carries what lives on the skin with it: normals, tangents and the like turn as the skin under them turned. Those that do not
 * turn keep their bits, and none changes its length but by rounding.
 *   mesh     in  rest_points are not read
 *   turns    in  [vertex_count][3] as skinslide_workspace_turns gives them
 *   vectors  in, out  the cache's, then the carried
 * Fails with BAD_MESH, BAD_ARGUMENT (NULL, no such layout), BAD_POINTS (a vector so long that it might not stay finite: names
 * it), and then changes none. */
SKINSLIDE_API skinslide_status skinslide_carry(const skinslide_mesh *mesh, const float *turns, skinslide_normals_layout layout,
                                               float *vectors, skinslide_error *error);

/* The box around points, which UsdGeomMesh calls their extent.
 *   points  in  [vertex_count][3]; coordinates that are NaN are left out
 *   extent  out [2][3] the least of each coordinate, then the largest; FLT_MAX and -FLT_MAX where there are none
 * Fails with BAD_ARGUMENT (NULL, a negative count). */
SKINSLIDE_API skinslide_status skinslide_extent(const float *points, int32_t vertex_count, float *extent,
                                                skinslide_error *error);

/* Points of one time, for rates of change. Start from SKINSLIDE_SAMPLE_DEFAULT. */
typedef struct skinslide_sample {
    size_t size; /* sizeof(skinslide_sample) */
    double seconds;
    const float *cached; /* [vertex_count][3] */
    const float *slid;   /* [vertex_count][3] */
} skinslide_sample;

#define SKINSLIDE_SAMPLE_DEFAULT                                                                                               \
    { sizeof(skinslide_sample), 0, 0, 0 }

/* Adds to the cache's velocities, units per second, the rate at which the displacement (slid - cached) changes from the first
 * sample to the second. Vertices whose displacement does not change keep their bits.
 *   samples     in  [2], ascending in time
 *   velocities  in, out  the cache's, then the corrected [vertex_count][3]
 * Fails with BAD_ARGUMENT (NULL, a negative count, times that are not finite or do not ascend), BAD_POINTS (a finite velocity
 * would not stay so: names the vertex). */
SKINSLIDE_API skinslide_status skinslide_velocities(int32_t vertex_count, const skinslide_sample *samples, float *velocities,
                                                    skinslide_error *error);

/* Adds to the cache's accelerations, units per second squared, the rate at which the displacement's rate of change changes: its
 * second difference over three samples. Vertices where that is 0 keep their bits.
 *   samples        in  [3], ascending in time
 *   accelerations  in, out  the cache's, then the corrected [vertex_count][3]
 * Fails as skinslide_velocities. */
SKINSLIDE_API skinslide_status skinslide_accelerations(int32_t vertex_count, const skinslide_sample *samples,
                                                       float *accelerations, skinslide_error *error);

/* ---- How smoothly skin moves -------------------------------------------------------------------------------------------- */

/* How roughly a patch moves at a time between two others: the largest second difference in time of any of its vertices, in
 * object units. The largest of the result over a shot, divided by the largest of the cache, says whether skin pops: it is 1
 * where skin moves as smoothly as what it slides on. Raise both to `least` first. Start from SKINSLIDE_ROUGHNESS_DEFAULT. */
typedef struct skinslide_roughness {
    size_t size;   /* sizeof(skinslide_roughness) */
    double before; /* in the cache: |p0 - 2 p1 + p2|; where steps are uneven, twice the distance of p1 from where motion at a
                      constant speed from p0 to p2 would have it */
    double after;  /* and in the result */
    double least;  /* the least that counts, in either: a hundredth of the mean edge at rest, which nobody sees, or what
                      rounding points to float may come to where that is more */
    int32_t vertex_before; /* the mesh vertex that has the largest in the cache */
    int32_t vertex_after;  /* and in the result */
} skinslide_roughness;

#define SKINSLIDE_ROUGHNESS_DEFAULT                                                                                            \
    { sizeof(skinslide_roughness), 0, 0, 0, 0, 0 }

/* Measures the middle of three times.
 *   samples    in  [3], ascending in time, their points those of the slider's mesh
 *   roughness  out [patch_count]; only the first need have its size
 * Fails with BAD_ARGUMENT (NULL, times that are not finite or do not ascend), BAD_POINTS (a vertex of a patch that is not
 * finite: names patch and vertex), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_measure_roughness(const skinslide_slider *slider, const skinslide_sample *samples,
                                                           skinslide_roughness *roughness, skinslide_error *error);

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
}
#endif
#endif

#endif
