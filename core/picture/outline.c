/* The outline of some faces on a tessellated mesh: their sides with none of the faces beyond. Also all of their sides and
 * corners, on which lines and dots are drawn. */
#include "picture.h"

#include <stdlib.h>

typedef struct segments {
    uint32_t (*ends)[2];
    int32_t *edge; /* of each; NULL: it is not wanted */
    int32_t count;
    int32_t of; /* the edge of the segments that are added next */
} segments;

static void add_segment(segments *to, uint32_t begin, uint32_t end) {
    to->ends[to->count][0] = begin, to->ends[to->count][1] = end;
    if (to->edge)
        to->edge[to->count] = to->of;
    to->count++;
}

static void add_side(segments *to, const ss_grid *grid, int side) {
    for (int32_t step = 0; step < grid->side; step++)
        add_segment(to, ss_on_side(grid, side, step), ss_on_side(grid, side, step + 1));
}

/* The part of side k of its face, of n sides, that the grid has. */
static void add_part(segments *to, const ss_grid *grid, int32_t k, int32_t n) {
    if (!grid->side) {
        add_segment(to, (uint32_t)(grid->first_vertex + k), (uint32_t)(grid->first_vertex + (k + 1) % n));
    } else if (grid->corner < 0) {
        add_side(to, grid, k);
    } else if (grid->corner == k) {
        add_side(to, grid, 0);
    } else if (grid->corner == (k + 1) % n) {
        add_side(to, grid, 3);
    }
}

/* The sides of faces inside whose corners are chosen [corner_count], and the edge that each is of. */
static int32_t list_sides(const skinslide_outline *own, const uint8_t *chosen, uint32_t (*ends)[2], int32_t *edge) {
    const skinslide_tessellation *mesh = own->tessellation;
    segments to = {.ends = ends, .edge = edge};
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        const ss_grid *grid = &mesh->grids[p];
        int32_t n = ss_face_size(mesh, grid->face);
        for (int32_t k = 0; own->inside[grid->face] && k < n; k++) {
            int32_t corner = mesh->face_start[grid->face] + k;
            to.of = mesh->skin.corner_edge[corner];
            if (chosen[corner])
                add_part(&to, grid, k, n);
        }
    }
    return to.count;
}

/* The vertex of a grid at corner k of its face, of n; -1 where that is another grid's. */
static int64_t at_corner(const ss_grid *grid, int32_t k) {
    if (!grid->side)
        return grid->first_vertex + k;
    if (grid->corner < 0)
        return ss_on_side(grid, k, 0);
    return grid->corner == k ? (int64_t)ss_on_side(grid, 0, 0) : -1;
}

/* listed is scratch [mesh_vertex_count], of zeros. */
static void list_corners(skinslide_outline *own, uint8_t *listed) {
    const skinslide_tessellation *mesh = own->tessellation;
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        const ss_grid *grid = &mesh->grids[p];
        for (int32_t k = 0; own->inside[grid->face] && k < ss_face_size(mesh, grid->face); k++) {
            int32_t vertex = mesh->corner_vertex[mesh->face_start[grid->face] + k];
            if (listed[vertex] || at_corner(grid, k) < 0)
                continue;
            own->corners[own->corner_count][0] = (uint32_t)vertex;
            own->corners[own->corner_count++][1] = (uint32_t)at_corner(grid, k), listed[vertex] = 1;
        }
    }
}

/* border [corner_count]: sides of faces inside with no other of them beyond. count is scratch [edge_count], of zeros. */
static void find_border(const skinslide_outline *own, int32_t *count, uint8_t *border) {
    const ss_faces *faces = &own->tessellation->skin;
    for (int32_t c = 0; c < faces->corner_count; c++)
        count[faces->corner_edge[c]] += own->inside[faces->corner_face[c]];
    for (int32_t c = 0; c < faces->corner_count; c++)
        border[c] = own->inside[faces->corner_face[c]] && count[faces->corner_edge[c]] == 1 &&
                    faces->corner_vertex[c] != faces->corner_vertex[ss_next_corner(faces, c)];
}

/* Chooses one side for each edge of faces inside: that of its first face. used is scratch [edge_count], of zeros. */
static void choose_each_once(const skinslide_outline *own, uint8_t *used, uint8_t *once) {
    const ss_faces *faces = &own->tessellation->skin;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        once[c] = own->inside[faces->corner_face[c]] && !used[faces->corner_edge[c]];
        used[faces->corner_edge[c]] |= once[c];
    }
}

/* Room for every side of what is inside. */
static int64_t most_segments(const skinslide_outline *own) {
    const skinslide_tessellation *mesh = own->tessellation;
    int64_t most = 0;
    for (int32_t p = 0; p < mesh->grid_count; p++)
        if (own->inside[mesh->grids[p].face])
            most += mesh->grids[p].side ? 4 * mesh->grids[p].side : ss_face_size(mesh, mesh->grids[p].face);
    return most;
}

/* ---- Creation ---- */

static bool fill(skinslide_outline *own, const int32_t *chosen, int32_t count) {
    const skinslide_tessellation *mesh = own->tessellation;
    ss_memory scratch = {0};
    int32_t *uses = SS_NEW(&scratch, int32_t, mesh->skin.edge_count);
    uint8_t *border = SS_NEW(&scratch, uint8_t, mesh->faces.corner_count);
    uint8_t *used = SS_NEW(&scratch, uint8_t, mesh->skin.edge_count);
    uint8_t *once = SS_NEW(&scratch, uint8_t, mesh->faces.corner_count);
    uint8_t *listed = SS_NEW(&scratch, uint8_t, mesh->mesh_vertex_count);
    own->inside = SS_NEW(&own->memory, uint8_t, mesh->mesh_face_count);
    for (int32_t i = 0; i < count && own->inside; i++)
        own->inside[chosen[i]] = 1;
    int64_t most = own->inside ? most_segments(own) : 0;
    own->segments = ss_new(&own->memory, most, sizeof *own->segments);
    own->sides = ss_new(&own->memory, most, sizeof *own->sides);
    own->side_edge = SS_NEW(&own->memory, int32_t, most);
    own->corners = ss_new(&own->memory, mesh->mesh_vertex_count, sizeof *own->corners);
    bool allocated = !scratch.failed && !own->memory.failed;
    if (allocated) {
        find_border(own, uses, border);
        choose_each_once(own, used, once);
        own->segment_count = list_sides(own, border, own->segments, NULL);
        own->side_count = list_sides(own, once, own->sides, own->side_edge);
        list_corners(own, listed);
    }
    ss_free(&scratch);
    return allocated;
}

skinslide_status ss_outline_create(const skinslide_tessellation *tessellation, const int32_t *faces, int32_t face_count,
                                   skinslide_outline **out, skinslide_error *error) {
    skinslide_outline *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    own->tessellation = tessellation;
    if (!fill(own, faces, face_count)) {
        skinslide_outline_destroy(own);
        return ss_out_of_memory(error);
    }
    *out = own;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_outline_create(const skinslide_tessellation *tessellation, const int32_t *faces, int32_t face_count,
                                          skinslide_outline **out, skinslide_error *error) {
    if (!tessellation || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no tessellation, or no place for the outline");
    skinslide_status status = ss_check_faces(tessellation->mesh_face_count, faces, face_count, error);
    return status ? status : ss_outline_create(tessellation, faces, face_count, out, error);
}

void skinslide_outline_destroy(skinslide_outline *outline) {
    if (!outline)
        return;
    ss_free(&outline->memory);
    free(outline);
}
