/* One connected patch of a mesh, and the triangles of its faces. */
#ifndef SKINSLIDE_PATCH_H
#define SKINSLIDE_PATCH_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

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
    int32_t *
        loop_start; /* [loop_count + 1]; loop 0 is the outer boundary, the others holes, as faces go round them; none where it is
                            closed */
    int32_t *loop_vertex;
    uint8_t *fixed;       /* [vertex_count] */
    int32_t *free_vertex; /* [free_count] in an order in which each has a neighbour before it */
    int32_t *free_before; /* [free_count] the place in free_vertex of that neighbour, -1 for a first */
    int32_t *loop_place;  /* [vertex_count] where loop_vertex has the vertex, on loops */
    int32_t *vertex_loop; /* [vertex_count] the loop that the vertex is on, -1 inside */
    ss_triangles triangles;
} ss_patch;

skinslide_status ss_patch_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setup, int32_t setup_index,
                                 const int32_t *mesh_faces, int32_t face_count, int32_t piece, int32_t piece_count,
                                 ss_patch **out, skinslide_error *error);
void ss_patch_destroy(ss_patch *patch);
/* BAD_PATCH where it is closed or has handles: only a disk with holes can be laid out in the plane. */
skinslide_status ss_check_disk(const ss_patch *patch, skinslide_error *error);
/* "patch elbow", or "patch elbow (piece 2 of 2)". */
void ss_label(const skinslide_patch_setup *setup, int32_t piece, int32_t piece_count, char *label, size_t size);
/* The patch vertex of a mesh vertex, or -1. */
int32_t ss_patch_vertex(const ss_patch *patch, int32_t mesh_vertex);
/* The edge between two patch vertices, or -1. */
int32_t ss_patch_edge(const ss_patch *patch, int32_t a, int32_t b);
/* The length of every edge, none under patch->shortest; returns how many were. points is the whole mesh's. */
int32_t ss_edge_lengths(const ss_patch *patch, const float *points, double *lengths);
/* The points [vertex_count][3] of the patch, of the whole mesh's. */
void ss_take_points(const ss_patch *patch, const float *points, double (*out)[3]);

/* ---- triangles.c ---- */

/* Fills patch->triangles, all else being there. False where memory is short. */
bool ss_list_triangles(ss_patch *patch);
/* The triangle that has the side which begins at a corner. */
int32_t ss_triangle_of_side(const ss_patch *patch, int32_t corner);
/* Which vertex of the triangle a patch vertex is. */
int ss_triangle_corner(const ss_patch *patch, int32_t triangle, int32_t vertex);

#ifdef __cplusplus
}
#endif

#endif
