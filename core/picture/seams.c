/* Where the grids of a tessellation meet. Each has its own vertices along the sides that it shares, and OpenSubdiv's surfaces
 * of faces with creases meet their neighbours' only to some hundredths of the mesh's size. So that pictures have no cracks, all
 * vertices that should coincide take the place of one of them. */
#include "picture.h"

/* ---- Vertices that are one ---- */

static uint32_t root(uint32_t *same_as, uint32_t vertex) {
    while (same_as[vertex] != vertex)
        vertex = same_as[vertex] = same_as[same_as[vertex]];
    return vertex;
}

/* The lower one, which is posed first, stands for both. */
static void unite(uint32_t *same_as, uint32_t a, uint32_t b) {
    uint32_t x = root(same_as, a), y = root(same_as, b);
    if (x < y)
        same_as[y] = x;
    else
        same_as[x] = y;
}

/* ---- Sides of faces ---- */

static int32_t cells_along(const ss_grid *grid) {
    return grid->corner < 0 ? grid->side : 2 * grid->side;
}

/* The vertex of side k of a face of n at a step of `steps` along it; first is the first of the face's grids. */
static uint32_t vertex_along(const ss_grid *first, int32_t n, int32_t k, int32_t step, int32_t steps) {
    if (first->corner < 0)
        return ss_on_side(first, k, step * first->side / steps);
    if (2 * step <= steps)
        return ss_on_side(first + k, 0, 2 * step * first->side / steps);
    return ss_on_side(first + (k + 1) % n, 3, (2 * step - steps) * first->side / steps);
}

/* The grids of a polygon meet from the middle of each side to its centre. */
static void join_corners(const ss_grid *first, int32_t n, uint32_t *same_as) {
    for (int32_t k = 0; k < n; k++)
        for (int32_t step = 0; step <= first->side; step++)
            unite(same_as, ss_on_side(first + k, 1, step), ss_on_side(first + (k + 1) % n, 2, first->side - step));
}

/* ---- All of them ---- */

typedef struct meeting {
    const ss_faces *faces;
    const ss_grid **first_grid; /* [face_count] where the face has grids, else NULL */
    int32_t *first_corner;      /* [edge_count] of the first face with grids at the edge, or -1 */
    int64_t *first_vertex;      /* [mesh_vertex_count] of a grid at the mesh vertex, or -1 */
} meeting;

static int32_t size_of(const ss_faces *faces, int32_t face) {
    return faces->face_start[face + 1] - faces->face_start[face];
}

/* Joins the side that begins at a corner to the first side at the same edge. A side from a vertex to itself has no
 * direction. */
static void join_side(const meeting *all, int32_t corner, uint32_t *same_as) {
    const ss_faces *faces = all->faces;
    int32_t other = all->first_corner[faces->corner_edge[corner]], face = faces->corner_face[corner];
    int32_t beyond = faces->corner_face[other], k = corner - faces->face_start[face], j = other - faces->face_start[beyond];
    const ss_grid *here = all->first_grid[face], *there = all->first_grid[beyond];
    int32_t steps = cells_along(here) < cells_along(there) ? cells_along(here) : cells_along(there);
    bool along = faces->corner_vertex[corner] == faces->corner_vertex[other];
    if (faces->corner_vertex[corner] == faces->corner_vertex[ss_next_corner(faces, corner)])
        return;
    for (int32_t step = 0; step <= steps; step++)
        unite(same_as, vertex_along(here, size_of(faces, face), k, step, steps),
              vertex_along(there, size_of(faces, beyond), j, along ? step : steps - step, steps));
}

static void join_face(meeting *all, int32_t face, uint32_t *same_as) {
    const ss_faces *faces = all->faces;
    int32_t n = size_of(faces, face);
    if (all->first_grid[face]->corner >= 0)
        join_corners(all->first_grid[face], n, same_as);
    for (int32_t k = 0; k < n; k++) {
        int32_t corner = faces->face_start[face] + k, *first = &all->first_corner[faces->corner_edge[corner]];
        int64_t *at = &all->first_vertex[faces->corner_vertex[corner]];
        uint32_t own = vertex_along(all->first_grid[face], n, k, 0, 2);
        *first = *first < 0 ? corner : *first;
        *at = *at < 0 ? own : *at;
        unite(same_as, own, (uint32_t)*at);
        join_side(all, corner, same_as);
    }
}

static void join_all(skinslide_tessellation *own, meeting *all) {
    for (int32_t e = 0; e < all->faces->edge_count; e++)
        all->first_corner[e] = -1;
    for (int32_t v = 0; v < own->mesh_vertex_count; v++)
        all->first_vertex[v] = -1;
    for (int32_t v = 0; v < own->vertex_count; v++)
        own->same_as[v] = (uint32_t)v;
    for (int32_t p = 0; p < own->grid_count; p++)
        if (own->grids[p].side && own->grids[p].corner <= 0)
            all->first_grid[own->grids[p].face] = &own->grids[p];
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        if (all->first_grid[f])
            join_face(all, f, own->same_as);
    for (int32_t v = 0; v < own->vertex_count; v++)
        own->same_as[v] = root(own->same_as, (uint32_t)v);
}

bool ss_join_seams(skinslide_tessellation *own) {
    const ss_faces *faces = &own->faces;
    ss_memory scratch = {0};
    meeting all = {.faces = faces};
    all.first_grid = SS_NEW(&scratch, const ss_grid *, own->mesh_face_count);
    all.first_corner = SS_NEW(&scratch, int32_t, faces->edge_count);
    all.first_vertex = SS_NEW(&scratch, int64_t, own->mesh_vertex_count);
    bool allocated = !scratch.failed;
    if (allocated)
        join_all(own, &all);
    ss_free(&scratch);
    return allocated;
}
