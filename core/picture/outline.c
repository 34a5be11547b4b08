/* The outline of a patch on a tessellated mesh: the sides of its faces with no other face of it beyond. Any faces will do. */
#include "picture.h"

#include <stdlib.h>

static void add_side(skinslide_outline *own, const ss_grid *grid, int side) {
    for (int32_t step = 0; step < grid->side; step++, own->segment_count++) {
        own->segments[own->segment_count][0] = ss_on_side(grid, side, step);
        own->segments[own->segment_count][1] = ss_on_side(grid, side, step + 1);
    }
}

/* The part of side k of the face, which is on the outline, that the grid has. */
static void outline_side(skinslide_outline *own, const ss_grid *grid, int32_t k) {
    int32_t n = ss_face_size(own->tessellation, grid->face);
    if (!grid->side) {
        own->segments[own->segment_count][0] = (uint32_t)(grid->first_vertex + k);
        own->segments[own->segment_count++][1] = (uint32_t)(grid->first_vertex + (k + 1) % n);
    } else if (grid->corner < 0) {
        add_side(own, grid, k);
    } else if (grid->corner == k) {
        add_side(own, grid, 0);
    } else if (grid->corner == (k + 1) % n) {
        add_side(own, grid, 3);
    }
}

static void list_segments(skinslide_outline *own, const uint8_t *border) {
    const skinslide_tessellation *mesh = own->tessellation;
    for (int32_t p = 0; p < mesh->grid_count; p++)
        for (int32_t k = 0; own->inside[mesh->grids[p].face] && k < ss_face_size(mesh, mesh->grids[p].face); k++)
            if (border[mesh->face_start[mesh->grids[p].face] + k])
                outline_side(own, &mesh->grids[p], k);
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
    own->inside = SS_NEW(&own->memory, uint8_t, mesh->mesh_face_count);
    for (int32_t i = 0; i < count && own->inside; i++)
        own->inside[chosen[i]] = 1;
    own->segments = own->inside ? ss_new(&own->memory, most_segments(own), sizeof *own->segments) : NULL;
    bool allocated = !scratch.failed && !own->memory.failed;
    if (allocated) {
        find_border(own, uses, border);
        list_segments(own, border);
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
