/* Faces, and how they meet. */
#ifndef SKINSLIDE_MESH_H
#define SKINSLIDE_MESH_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

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

/* A caller's mesh as ours. */
typedef struct ss_taken_mesh {
    skinslide_mesh mesh;
    skinslide_subdivision subdivision;
} ss_taken_mesh;
/* Takes the caller's mesh, makes *mesh point to that, and checks it. */
skinslide_status ss_take_mesh(const skinslide_mesh **mesh, ss_taken_mesh *own, skinslide_error *error);
/* Checks counts, indices and rest points of the whole mesh. */
skinslide_status ss_check_mesh(const skinslide_mesh *mesh, skinslide_error *error);
/* Names the first face with a negative count. */
skinslide_status ss_check_face_counts(const int32_t *counts, int32_t face_count, skinslide_error *error);
/* Names the first index that is not in [0, end). `what` begins the message, such as "face ". */
skinslide_status ss_check_members(const int32_t *indices, int32_t count, int32_t end, const char *what, skinslide_status status,
                                  skinslide_error *error);
/* The same for faces of a mesh; faces may be NULL if face_count is 0. Fails with BAD_ARGUMENT. */
skinslide_status ss_check_faces(int32_t mesh_face_count, const int32_t *faces, int32_t face_count, skinslide_error *error);
/* Says that an element which must be listed once, such as "face 3", is there again. */
skinslide_status ss_refuse_repeated(const char *label, const char *element, skinslide_status status, skinslide_error *error);
/* Says that what a vertex has, one number or three, is not finite. */
skinslide_status ss_refuse_vertex(const char *what, int32_t vertex, const float *numbers, int width, skinslide_status status,
                                  skinslide_error *error);
/* Names the first vertex that is not finite. */
skinslide_status ss_check_points(const float *points, int32_t vertex_count, const char *what, skinslide_error *error);
/* The same of the vertices that faces have, and of those that these are one with; others may be anything. */
skinslide_status ss_check_used(const skinslide_mesh *mesh, const float *points, const char *what, skinslide_error *error);
/* The sides of the box around the rest points that are finite. */
void ss_measure_rest(const skinslide_mesh *mesh, double size[3]);
/* The chosen faces of a mesh, with mesh vertices at their corners, twins and edges. face_start is as ss_start_faces has it;
 * NULL: it is found. label begins messages. */
skinslide_status ss_take_faces(const skinslide_mesh *mesh, const int32_t *face_start, const int32_t *chosen, int32_t count,
                               const char *label, ss_memory *memory, ss_faces *faces, skinslide_error *error);
/* Fills corner_edge and edge_count; any number of faces may share an edge. False if memory is short. */
bool ss_number_edges(ss_faces *faces);
/* Numbers the pieces that are connected through edges, by their lowest face: piece_of_face [face_count]. Returns their count.
 */
int32_t ss_number_pieces(const ss_faces *faces, int32_t *piece_of_face, int32_t *stack);

/* The vertex that a vertex of the mesh is one with. */
static inline int32_t ss_one(const skinslide_mesh *mesh, int32_t vertex) {
    return mesh->weld ? mesh->weld[vertex] : vertex;
}

/* ---- places.c: points in one place ---- */

/* A point to be told apart from others. */
typedef struct ss_spot {
    double along; /* where it is along a line */
    float at[3];
    int32_t place, vertex;
} ss_spot;
/* Splits places by a pose: of the vertices that share a place, those that are linked by distances of no more than tolerance
 * still do. place [vertex_count] is the lowest vertex in the place of each. vertices [count] are those to look at; spots is
 * scratch [count]. */
void ss_split_places(const float *points, double tolerance, const int32_t *vertices, int32_t count, ss_spot *spots,
                     int32_t *place);
/* The places of all points [count] of a pose: place [count] is the lowest point of each; one that is not finite has its own.
 * False if memory is short. */
bool ss_find_places(const float *points, double tolerance, int32_t count, int32_t *place);
/* Which of points [count] have one of others [other_count] in their place: met [count] is 1, else 0. Points that are not finite
 * meet none. False if memory is short. */
bool ss_find_met(const float *points, int32_t count, const float *others, int32_t other_count, double tolerance, uint8_t *met);
/* ss_root: the root of a vertex in a forest, whose roots are their own parents. ss_join: joins two trees under the lower
 * root. */
int32_t ss_root(int32_t *parent, int32_t vertex);
void ss_join(int32_t *parent, int32_t a, int32_t b);

/* ---- sew.c: which points in one place are one vertex ---- */

/* A corner of a face of a patch, and the next: at least one of the two points shares its place at rest. */
typedef struct ss_seam_corner {
    int32_t face, vertex, next;
} ss_seam_corner;

typedef struct ss_seams {
    int32_t vertex_count;
    int32_t *place;    /* [vertex_count] the lowest vertex in the same place */
    uint8_t *in_patch; /* [vertex_count] a face of a patch has it */
    int32_t shared_count;
    int32_t *shared; /* [shared_count] vertices that share a place at rest with one of a patch, ascending */
    int32_t corner_count;
    ss_seam_corner *corners; /* [corner_count] in the order of faces */
} ss_seams;

typedef struct ss_sewn {
    ss_memory memory;
    int32_t *vertex;  /* [vertex_count] the vertex that each is one with: the lowest one of a patch in that place */
    uint8_t *refused; /* [vertex_count] by place: it cannot be one vertex */
    char why[160];    /* the first of these cannot; or empty */
} ss_sewn;

/* Fills out, whose memory is the caller's to free. False if memory is short. */
bool ss_sew(const ss_seams *seams, ss_sewn *out);

/* ---- winding.c ---- */

/* A side of a face, by the ends of its edge. */
typedef struct ss_side {
    int32_t low, high, corner;
} ss_side;
/* Says what is wrong with an edge that has these sides. Leaves the edges numbered anew. */
skinslide_status ss_refuse_edge(ss_faces *faces, const ss_side *sides, int32_t count, const int32_t *mesh_face,
                                const char *label, skinslide_error *error);

/* ---- Fans: a face of n corners as n - 2 triangles about its first ---- */

/* Triangle t of the fan of a face, as patch vertices. */
static inline void ss_fan(const ss_faces *faces, int32_t face, int32_t triangle, int32_t vertices[3]) {
    const int32_t *corners = faces->corner_vertex + faces->face_start[face];
    vertices[0] = corners[0], vertices[1] = corners[triangle + 1], vertices[2] = corners[triangle + 2];
}

static inline int32_t ss_fan_size(const ss_faces *faces, int32_t face) {
    return faces->face_start[face + 1] - faces->face_start[face] - 2;
}

/* Where each face of a mesh begins among its corners: face_start [face_count + 1], whose first is 0. */
static inline void ss_start_faces(const skinslide_mesh *mesh, int32_t *face_start) {
    for (int32_t f = 0; f < mesh->face_count; f++)
        face_start[f + 1] = face_start[f] + mesh->face_counts[f];
}

/* The same, in memory; NULL where that is short. */
const int32_t *ss_list_starts(const skinslide_mesh *mesh, ss_memory *memory);

/* Corners of the largest face. */
int32_t ss_largest_face(const ss_faces *faces);

/* ---- subdivision.c ---- */

bool ss_is_subdivided(const skinslide_mesh *mesh);
/* Of a subdivided mesh that passed ss_check_mesh: names the face, vertex, crease or sharpness that cannot be. */
skinslide_status ss_check_subdivision(const skinslide_mesh *mesh, skinslide_error *error);

/* ---- normals.c: smooth normals of a pose ---- */

/* Twice the area vector of a polygon of 3 or more vertices: the sum of its fan's cross products. */
void ss_area_vector(const int32_t *vertices, int32_t count, const float *points, double out[3]);

/* Faces of a mesh around some of its vertices. */
typedef struct ss_around {
    int32_t face_count;
    int32_t *face_start;    /* [face_count + 1] */
    int32_t *corner_vertex; /* [face_start[face_count]] mesh vertices; those that are to have one normal are one here */
} ss_around;
/* All faces at chosen vertices: chosen is [vertex_count]. False if memory is short. */
bool ss_take_around(const skinslide_mesh *mesh, const uint8_t *chosen, ss_memory *memory, ss_around *out);
/* normal [vertex_count] of unit length; 0 where no face at the vertex has an area. Only those of the chosen vertices are
 * whole. */
void ss_smooth_normals(const ss_around *around, const float *points, int32_t vertex_count, double (*normal)[3]);

/* ---- carry.c: what lives on the skin turns with it ---- */

/* The turn from one unit normal to another; 0 where they are opposite, or one is 0. See skinslide_workspace_turns. */
void ss_least_turn(const double from[3], const double to[3], double turn[3]);
/* How many elements of a mesh carry a vector. */
int32_t ss_element_count(const skinslide_mesh *mesh, skinslide_normals_layout layout);
/* Vectors of either type: the other is NULL. */
typedef struct ss_vectors {
    float *floats;
    double *doubles;
} ss_vectors;
/* Fails for a vector, named by its number, that might not stay finite when it is turned. */
skinslide_status ss_check_vector(const double vector[3], bool is_double, int64_t number, skinslide_error *error);
/* skinslide_carry. The mesh is checked. */
skinslide_status ss_carry(const skinslide_mesh *mesh, const float *turns, skinslide_normals_layout layout, ss_vectors vectors,
                          skinslide_error *error);

/* ---- grow.c: what is near on the mesh at rest ---- */

/* Spreads ways from the vertices where left [vertex_count] is 0 or more: that is how far a way may still go there. Afterwards
 * left is the most that any way has left at each vertex, or below 0 where none comes. False if memory is short. */
bool ss_spread(const skinslide_mesh *mesh, double *left);
/* Fills left [vertex_count] for ways of that length that begin at the faces inside [face_count]. */
void ss_start_at(const skinslide_mesh *mesh, const uint8_t *inside, double way, double *left);
/* Adds the faces of which ways come to all vertices. */
void ss_add_reached(const skinslide_mesh *mesh, const double *left, uint8_t *inside);
/* Adds the faces that are wholly within that way of those inside. False if memory is short. */
bool ss_add_near_faces(const skinslide_mesh *mesh, double way, uint8_t *inside);

/* ---- patch.c: one connected patch ---- */

/* The triangles of the fans of its faces, and how they meet. Side k of a triangle goes from its vertex k to the next. */
typedef struct ss_triangles {
    int32_t count;
    int32_t (*vertex)[3];     /* [count] patch vertices */
    int32_t (*neighbour)[3];  /* [count] over each side, -1 on the border */
    int32_t *face;            /* [count] patch face */
    int32_t *first_triangle;  /* [face_count] */
    int32_t *vertex_triangle; /* [vertex_count] a triangle at the vertex; on the border the one whose side leaves along it */
} ss_triangles;

/* Faces of a set-up that are connected through edges. */
typedef struct ss_piece {
    const int32_t *faces; /* [face_count] of the mesh, ascending */
    int32_t face_count;
    int32_t number, count;        /* of the set-up */
    const int32_t *shared_vertex; /* [shared_count] mesh vertices that are of other pieces, too, among others; ascending */
    int32_t shared_count;
} ss_piece;

typedef struct ss_patch {
    ss_memory memory;
    char label[160]; /* "patch elbow" or "patch elbow (piece 2 of 2)" */
    const skinslide_patch_setup *setup;
    int32_t setup_index, piece, piece_count;
    int32_t vertex_count, free_count, loop_count;
    int32_t held_count;   /* on loops, fixed by the set-up alone */
    ss_faces faces;       /* corners hold patch vertices */
    int32_t *mesh_vertex; /* [vertex_count], ascending; the parts of a split vertex have the same */
    uint8_t *split;       /* [vertex_count] whether it is a part of a split vertex */
    uint8_t *shared;      /* [vertex_count] whether other pieces of the set-up have the vertex, too */
    int32_t *copy_start;  /* [vertex_count + 1] */
    int32_t *copy;        /* the mesh vertices that are each patch vertex, ascending: one, but for welded ones */
    int32_t *mesh_face;   /* [face_count], ascending */
    const int32_t *weld;  /* the mesh's, [mesh_vertex_count]; or NULL */
    int32_t mesh_vertex_count;
    int32_t *vertex_corner;    /* [vertex_count] a corner at the vertex; on the boundary the one whose side leaves along it */
    int32_t (*edge_vertex)[2]; /* [edge_count], lower first */
    double *rest_length;       /* [edge_count] not under `shortest` */
    double mean_edge;          /* at rest */
    double shortest;           /* 1e-6 of that */
    int32_t zero_length_edges;
    int32_t *loop_start;  /* [loop_count + 1] loop 0 is the outer boundary, the others holes; a closed patch has none */
    int32_t *loop_vertex; /* in the direction in which faces go along each loop */
    uint8_t *fixed;       /* [vertex_count] */
    int32_t *free_vertex; /* [free_count] in an order in which each has a neighbour before it */
    int32_t *free_before; /* [free_count] the place in free_vertex of that neighbour, -1 for a first */
    int32_t *loop_place;  /* [vertex_count] where loop_vertex has the vertex, on loops */
    int32_t *vertex_loop; /* [vertex_count] the loop that the vertex is on, -1 inside */
    ss_triangles triangles;
} ss_patch;

/* The paper's rules lay patches out in the plane; the others slide on the rest surface. */
static inline bool ss_has_plane(skinslide_rule rule) {
    return rule == SKINSLIDE_RULE_UNIT || rule == SKINSLIDE_RULE_FAST;
}

/* The mesh's weld must outlive the patch. face_start as for ss_take_faces. */
skinslide_status ss_patch_create(const skinslide_mesh *mesh, const int32_t *face_start, const skinslide_patch_setup *setup,
                                 int32_t setup_index, const ss_piece *piece, ss_patch **out, skinslide_error *error);
void ss_patch_destroy(ss_patch *patch);
/* BAD_PATCH where it is closed or has handles: only a disk with holes can be laid out in the plane. */
skinslide_status ss_check_disk(const ss_patch *patch, skinslide_error *error);
/* "patch elbow", or "patch elbow (piece 2 of 2)". */
void ss_label(const skinslide_patch_setup *setup, int32_t piece, int32_t piece_count, char *label, size_t size);
/* The patch vertex that a mesh vertex is, or is one with; the first of several; -1 where there is none. */
int32_t ss_patch_vertex(const ss_patch *patch, int32_t mesh_vertex);
/* The edge between two patch vertices, or -1. */
int32_t ss_patch_edge(const ss_patch *patch, int32_t a, int32_t b);
/* The edge between two mesh vertices, or -1. */
int32_t ss_patch_mesh_edge(const ss_patch *patch, int32_t a, int32_t b);
/* The points [vertex_count][3] of the patch, of the whole mesh's. */
void ss_take_points(const ss_patch *patch, const float *points, double (*out)[3]);

/* ---- lengths.c ---- */

/* The length of every edge, raised to patch->shortest. Returns how many were shorter. points is the whole mesh's. */
int32_t ss_edge_lengths(const ss_patch *patch, const float *points, double *lengths);
/* The same bits, faster. own is scratch [vertex_count]. */
int32_t ss_edge_lengths_at_once(const ss_patch *patch, const float *points, double (*own)[4], double *lengths);

/* ---- split.c ---- */

/* Gives every fan of faces at a vertex a vertex of its own, and numbers vertices and edges anew. False if memory is short. */
bool ss_split_vertices(ss_patch *patch);

/* ---- triangles.c ---- */

/* Fills patch->triangles, once all else is there. False if memory is short. */
bool ss_list_triangles(ss_patch *patch);
/* The triangle that has the side which begins at a corner. */
int32_t ss_triangle_of_side(const ss_patch *patch, int32_t corner);
/* Which vertex of the triangle a patch vertex is. */
int ss_triangle_corner(const ss_patch *patch, int32_t triangle, int32_t vertex);

#ifdef __cplusplus
}
#endif

#endif
