/* A mesh as triangles to look at, and from where. */
#ifndef SS_PICTURE_H
#define SS_PICTURE_H

#include "limit.h"
#include "skinslide/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tessellation.c, seams.c, outline.c, posed.c ---- */

/* Part of a face: the fan of all of it, where side is 0, or a grid of side by side cells on its limit surface. */
typedef struct ss_grid {
    int32_t face;    /* mesh face */
    int32_t surface; /* of the tessellation's surfaces, -1 for a fan */
    int32_t corner;  /* of the face whose quad it is; -1: all of the face */
    int32_t side;
    uint8_t coarse; /* bit k: beyond its side k there may be a face of only 2 by 2 cells */
    int32_t first_vertex;
} ss_grid;

/* What of a vertex is the same in every pose. */
typedef struct ss_fixed_vertex {
    float coordinates[3]; /* st, or the place at rest */
} ss_fixed_vertex;

/* What depends on the pose. */
typedef struct ss_posed_vertex {
    float place[3]; /* relative to the origin */
    float normal[3];
    float values[SKINSLIDE_MOST_TARGETS];
} ss_posed_vertex;

struct skinslide_outline {
    ss_memory memory;
    const skinslide_tessellation *tessellation;
    uint8_t *inside; /* [mesh_face_count] the face is in the patch */
    int32_t segment_count;
    uint32_t (*segments)[2]; /* vertices of the tessellation */
    int32_t side_count;
    uint32_t (*sides)[2]; /* the same of every side of the faces, each once */
    int32_t *side_edge;   /* [side_count] of the tessellation's skin */
    int32_t corner_count;
    uint32_t (*corners)[2]; /* a vertex of the mesh, each once, and the one of the tessellation that is there */
};

struct skinslide_tessellation {
    ss_memory memory;
    ss_limit_surfaces *surfaces; /* NULL where nothing is subdivided */
    int32_t mesh_vertex_count, mesh_face_count, largest_face;
    int32_t *face_start;    /* [mesh_face_count + 1] */
    int32_t *corner_vertex; /* [mesh index_count] mesh vertices */
    ss_faces faces;         /* the same, with faces and edges of corners */
    ss_faces skin;          /* the same, of the welded mesh */
    bool in_space;          /* coordinates are places at rest */
    int32_t grid_count, vertex_count, triangle_count, flat_faces;
    ss_grid *grids;    /* [grid_count] */
    ss_parameter *at;  /* [vertex_count] in its face; of grids */
    uint32_t *same_as; /* [vertex_count] the vertex, itself or one before it, whose place it has */
    uint32_t (*triangles)[3];
    ss_fixed_vertex *fixed;     /* [vertex_count] */
    skinslide_outline *outline; /* of the faces that it was made for */
};

/* Scratch of one thread for ss_tessellate. */
typedef struct ss_tessellation_work {
    ss_memory memory;
    double *patch_points;      /* [ss_limit_surfaces_scratch] */
    double (*normals)[3];      /* [mesh_vertex_count], of fans */
    double *weights;           /* [largest_face] */
    ss_posed_vertex *vertices; /* [vertex_count] */
    uint8_t *skipped;          /* [grid_count] its vertices are not wanted */
} ss_tessellation_work;

static inline int32_t ss_face_size(const skinslide_tessellation *tessellation, int32_t face) {
    return tessellation->face_start[face + 1] - tessellation->face_start[face];
}

static inline int32_t ss_grid_size(const skinslide_tessellation *tessellation, const ss_grid *grid) {
    return grid->side ? (grid->side + 1) * (grid->side + 1) : ss_face_size(tessellation, grid->face);
}

static inline int32_t ss_grid_triangles(const skinslide_tessellation *tessellation, const ss_grid *grid) {
    return grid->side ? 2 * grid->side * grid->side : ss_face_size(tessellation, grid->face) - 2;
}

/* The vertex on side `side` of a grid, `step` cells along it: the sides go round the grid as those of a face do, from its first
 * corner on. */
uint32_t ss_on_side(const ss_grid *grid, int side, int32_t step);
/* Fills same_as. False if memory is short. */
bool ss_join_seams(skinslide_tessellation *tessellation);
/* skinslide_outline_create, of faces that are checked. */
skinslide_status ss_outline_create(const skinslide_tessellation *tessellation, const int32_t *faces, int32_t face_count,
                                   skinslide_outline **out, skinslide_error *error);
/* Blends values [width] at the corners of a grid's face linearly at one of its vertices: values are of the mesh's vertices, or
 * of its corners. */
void ss_blend(const skinslide_tessellation *tessellation, const ss_grid *grid, int32_t vertex, const float *values,
              int32_t width, bool by_corner, double *weights, float *out);

/* The middle of the box around all vertices of faces. Places are made relative to it before they are rounded to float. */
void ss_find_middle(const skinslide_tessellation *tessellation, const float *points, double middle[3]);
/* Fails with BAD_POINTS unless a value is finite; names the vertex. */
skinslide_status ss_check_value(int32_t mesh_vertex, float value, skinslide_error *error);
bool ss_tessellation_work_allocate(const skinslide_tessellation *tessellation, ss_tessellation_work *work);
/* Poses the mesh, relative to the origin: fills work->vertices, with values of 0. */
void ss_tessellate(const skinslide_tessellation *tessellation, const float *points, const double origin[3],
                   ss_tessellation_work *work);
/* Sets value number `place` of each of these vertices. */
void ss_tessellate_values(const skinslide_tessellation *tessellation, const float *values, int32_t place,
                          ss_tessellation_work *work);

/* ---- view.cpp: the only file that knows cameras ---- */

/* Matrices by columns, as OpenGL has them, for places relative to an origin of the mesh. */
typedef struct ss_view {
    float to_clip[16];
    float turn_normal[9]; /* takes normals from the mesh's space to the camera's, up to their length */
    bool mirrored;        /* what turns left in the mesh's space turns right in the camera's */
} ss_view;

/* False where it is not finite. to_world may be NULL. */
bool ss_view_of(const skinslide_camera *camera, const double *to_world, const double origin[3], ss_view *view);

#ifdef __cplusplus
}
#endif

#endif
