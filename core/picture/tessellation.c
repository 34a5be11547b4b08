/* Makes a mesh into triangles to be drawn: fans of its faces, or grids on its limit surface. Each face has its own vertices,
 * since st and the like may differ from face to face at a mesh vertex; places and normals of neighbouring faces meet all the
 * same. Grids are fine in the patch and around it, where the camera looks, and coarse elsewhere. */
#include "picture.h"

#include "paint.h"

#include <stdlib.h>

enum { MOST_CELLS = 32768, MOST_STEPS = 8 }; /* of fine grids in all; along half a side of a face */
enum { MOST_CORNERS = 100000000 };
enum { RINGS = 2 }; /* of faces around the patch that are fine */

/* How each face is to be drawn, while the tessellation is built. */
typedef struct blueprint {
    ss_face_surface *kinds; /* [face_count] */
    int32_t *surface_of;    /* [face_count] its surface, or -1 */
    uint8_t *inside;        /* [face_count] it is in the patch */
    uint8_t *fine;          /* [face_count] */
    uint8_t *coarse;        /* [index_count] sides with a coarse face beyond */
} blueprint;

/* ---- Pieces ---- */

/* How many steps along half a side of a face give no more cells than there may be. */
static int32_t steps_for(int64_t quarters) {
    int32_t steps = MOST_STEPS;
    while (steps > 1 && quarters * steps * steps > MOST_CELLS)
        steps /= 2;
    return steps;
}

static void add_piece(skinslide_tessellation *own, ss_grid grid) {
    grid.first_vertex = own->vertex_count;
    own->grids[own->grid_count++] = grid;
    own->vertex_count += ss_grid_size(own, &grid);
    own->triangle_count += ss_grid_triangles(own, &grid);
}

/* A quad is one grid, another polygon one for each corner. coarse: bit k for side k of the face. */
static void add_grids(skinslide_tessellation *own, int32_t face, int32_t surface, int32_t steps, const uint8_t *coarse) {
    int32_t n = ss_face_size(own, face);
    if (n == 4) {
        uint8_t sides = (uint8_t)(coarse[0] | coarse[1] << 1 | coarse[2] << 2 | coarse[3] << 3);
        add_piece(own, (ss_grid){face, surface, -1, 2 * steps, sides, 0});
    }
    for (int32_t k = 0; k < n && n != 4; k++) {
        uint8_t sides = (uint8_t)(coarse[k] | coarse[(k + n - 1) % n] << 3);
        add_piece(own, (ss_grid){face, surface, k, steps, sides, 0});
    }
}

static void list_pieces(skinslide_tessellation *own, const blueprint *plan) {
    int64_t quarters = 0;
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        quarters += plan->surface_of[f] >= 0 && plan->fine[f] ? ss_face_size(own, f) : 0;
    int32_t steps = steps_for(quarters);
    for (int32_t f = 0; f < own->mesh_face_count; f++) {
        if (plan->surface_of[f] >= 0)
            add_grids(own, f, plan->surface_of[f], plan->fine[f] ? steps : 1, plan->coarse + own->face_start[f]);
        else if (plan->kinds[f] == SS_SURFACE_REFUSED && ss_face_size(own, f) >= 3)
            add_piece(own, (ss_grid){f, -1, -1, 0, 0, 0});
    }
}

/* ---- Fine and coarse ---- */

/* Marks the vertices of every face of which one is marked. */
static void grow(const skinslide_tessellation *own, uint8_t *marked, uint8_t *grown) {
    for (int32_t f = 0; f < own->mesh_face_count; f++) {
        bool any = false;
        for (int32_t c = own->face_start[f]; c < own->face_start[f + 1]; c++)
            any = any || marked[own->corner_vertex[c]];
        for (int32_t c = own->face_start[f]; c < own->face_start[f + 1] && any; c++)
            grown[own->corner_vertex[c]] = 1;
    }
    for (int32_t v = 0; v < own->mesh_vertex_count; v++)
        marked[v] = grown[v];
}

static void mark_face(const skinslide_tessellation *own, int32_t face, uint8_t *marked, uint8_t mark) {
    for (int32_t c = own->face_start[face]; c < own->face_start[face + 1]; c++)
        marked[own->corner_vertex[c]] = mark;
}

static bool all_marked(const skinslide_tessellation *own, int32_t face, const uint8_t *marked) {
    bool all = true;
    for (int32_t c = own->face_start[face]; c < own->face_start[face + 1]; c++)
        all = all && marked[own->corner_vertex[c]];
    return all;
}

/* Chooses the faces that are fine, and of these the sides that may have a coarse face beyond: those with a vertex of a
 * coarse face at an end. Both faces at a side see the same vertices, so they agree. marked and other are scratch
 * [mesh_vertex_count]. */
static void choose_fine(const skinslide_tessellation *own, blueprint *plan, uint8_t *marked, uint8_t *other) {
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        if (plan->inside[f])
            mark_face(own, f, marked, 1);
    for (int ring = 0; ring < RINGS; ring++)
        grow(own, marked, other);
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        plan->fine[f] = all_marked(own, f, marked);
    for (int32_t v = 0; v < own->mesh_vertex_count; v++)
        marked[v] = 1;
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        if (!plan->fine[f])
            mark_face(own, f, marked, 0);
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        for (int32_t begin = own->face_start[f], n = ss_face_size(own, f), k = 0; k < n; k++)
            plan->coarse[begin + k] =
                !marked[own->corner_vertex[begin + k]] || !marked[own->corner_vertex[begin + (k + 1) % n]];
}

static skinslide_status plan_grids(const skinslide_tessellation *own, blueprint *plan, skinslide_error *error) {
    ss_memory scratch = {0};
    uint8_t *marked = SS_NEW(&scratch, uint8_t, own->mesh_vertex_count);
    uint8_t *other = SS_NEW(&scratch, uint8_t, own->mesh_vertex_count);
    if (!scratch.failed)
        choose_fine(own, plan, marked, other);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    ss_free(&scratch);
    return status;
}

/* ---- Surfaces ---- */

/* Lists the faces that have one, in order. */
static int32_t list_surfaces(skinslide_tessellation *own, blueprint *plan, int32_t *faces) {
    int32_t count = 0;
    for (int32_t f = 0; f < own->mesh_face_count; f++) {
        plan->surface_of[f] = plan->kinds[f] == SS_SURFACE ? count : -1;
        if (plan->kinds[f] == SS_SURFACE)
            faces[count++] = f;
        own->flat_faces += plan->kinds[f] == SS_SURFACE_REFUSED;
    }
    return count;
}

static skinslide_status subdivide(skinslide_tessellation *own, const skinslide_mesh *mesh, blueprint *plan,
                                  skinslide_error *error) {
    ss_topology *topology = NULL;
    ss_memory scratch = {0};
    int32_t *faces = SS_NEW(&scratch, int32_t, mesh->face_count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_topology_create(mesh, &topology, error);
    if (!status)
        status = ss_face_surfaces(topology, plan->kinds, error);
    if (!status) {
        int32_t count = list_surfaces(own, plan, faces);
        status = ss_limit_surfaces_create(topology, faces, count, "picture", &own->surfaces, error);
    }
    ss_topology_destroy(topology);
    ss_free(&scratch);
    return status;
}

static skinslide_status take_surfaces(skinslide_tessellation *own, const skinslide_mesh *mesh, blueprint *plan,
                                      skinslide_error *error) {
    for (int32_t f = 0; f < mesh->face_count; f++)
        plan->kinds[f] = SS_SURFACE_REFUSED, plan->surface_of[f] = -1;
    return ss_is_subdivided(mesh) ? subdivide(own, mesh, plan, error) : SKINSLIDE_OK;
}

/* ---- Triangles ---- */

static void list_fan(const skinslide_tessellation *own, const ss_grid *grid, uint32_t (**next)[3]) {
    uint32_t first = (uint32_t)grid->first_vertex;
    for (uint32_t k = 1; k + 1 < (uint32_t)ss_face_size(own, grid->face); k++, ++*next)
        (**next)[0] = first, (**next)[1] = first + k, (**next)[2] = first + k + 1;
}

static void list_grid(const ss_grid *grid, uint32_t (**next)[3]) {
    uint32_t row = (uint32_t)grid->side + 1;
    for (uint32_t y = 0; y < (uint32_t)grid->side; y++)
        for (uint32_t x = 0; x < (uint32_t)grid->side; x++) {
            uint32_t a = (uint32_t)grid->first_vertex + y * row + x;
            (**next)[0] = a, (**next)[1] = a + 1, (**next)[2] = a + row + 1, ++*next;
            (**next)[0] = a, (**next)[1] = a + row + 1, (**next)[2] = a + row, ++*next;
        }
}

/* Where the vertices of a grid are in their face. */
static void place_grid(skinslide_tessellation *own, const ss_grid *grid) {
    ss_parameter *next = own->at + grid->first_vertex;
    for (int32_t y = 0; y <= grid->side; y++)
        for (int32_t x = 0; x <= grid->side; x++) {
            double s = (double)x / grid->side, t = (double)y / grid->side;
            *next++ = grid->corner < 0 ? (ss_parameter){-1, {s, t}}
                                       : ss_limit_parameter(own->surfaces, grid->surface, grid->corner, s, t);
        }
}

static void list_triangles(skinslide_tessellation *own) {
    uint32_t(*next)[3] = own->triangles;
    for (int32_t p = 0; p < own->grid_count; p++) {
        if (own->grids[p].side) {
            list_grid(&own->grids[p], &next);
            place_grid(own, &own->grids[p]);
        } else {
            list_fan(own, &own->grids[p], &next);
        }
    }
}

/* ---- What never changes ---- */

static void fix_st(skinslide_tessellation *own, const float *st, double *weights) {
    for (int32_t p = 0; p < own->grid_count; p++) {
        const ss_grid *grid = &own->grids[p];
        for (int32_t v = grid->first_vertex; v < grid->first_vertex + ss_grid_size(own, grid); v++)
            ss_blend(own, grid, v, st, 2, true, weights, own->fixed[v].coordinates);
    }
}

static skinslide_status fix_vertices(skinslide_tessellation *own, const skinslide_mesh *mesh, const float *st,
                                     skinslide_error *error) {
    double middle[3];
    ss_tessellation_work work = {0};
    bool allocated = ss_tessellation_work_allocate(own, &work);
    if (allocated && st) {
        fix_st(own, st, work.weights);
    } else if (allocated) {
        ss_find_middle(own, mesh->rest_points, middle);
        ss_tessellate(own, mesh->rest_points, middle, &work);
        for (int32_t v = 0; v < own->vertex_count; v++)
            for (int i = 0; i < 3; i++)
                own->fixed[v].coordinates[i] = work.vertices[v].place[i];
    }
    ss_free(&work.memory);
    return allocated ? SKINSLIDE_OK : ss_out_of_memory(error);
}

/* ---- Creation ---- */

static skinslide_status check(const skinslide_mesh *mesh, const float *st, const int32_t *faces, int32_t face_count,
                              skinslide_error *error) {
    skinslide_status status = ss_is_subdivided(mesh) ? ss_check_subdivision(mesh, error) : SKINSLIDE_OK;
    if (!status && mesh->index_count > MOST_CORNERS)
        status = ss_fail(error, SKINSLIDE_UNSUPPORTED, "%d face indices are too many to be drawn", mesh->index_count);
    if (!status && !st)
        status = ss_check_used(mesh, mesh->rest_points, "rest points", error);
    if (!status)
        status = ss_check_faces(mesh->face_count, faces, face_count, error);
    for (int32_t f = 0, c = 0; !status && st && f < mesh->face_count; c += mesh->face_counts[f++])
        for (int32_t k = c; k < c + mesh->face_counts[f] && !status; k++)
            status = ss_check_st(st + 2 * (int64_t)k, f, error);
    return status;
}

static bool copy_faces(skinslide_tessellation *own, const skinslide_mesh *mesh) {
    own->mesh_vertex_count = mesh->vertex_count, own->mesh_face_count = mesh->face_count;
    own->face_start = SS_NEW(&own->memory, int32_t, (int64_t)mesh->face_count + 1);
    own->corner_vertex = SS_NEW(&own->memory, int32_t, mesh->index_count);
    own->faces.corner_face = SS_NEW(&own->memory, int32_t, mesh->index_count);
    own->faces.corner_edge = SS_NEW(&own->memory, int32_t, mesh->index_count);
    own->grids = SS_NEW(&own->memory, ss_grid, (int64_t)mesh->index_count + mesh->face_count);
    if (own->memory.failed)
        return false;
    ss_start_faces(mesh, own->face_start);
    for (int32_t f = 0; f < mesh->face_count; f++)
        own->largest_face = ss_face_size(own, f) > own->largest_face ? ss_face_size(own, f) : own->largest_face;
    for (int32_t c = 0; c < mesh->index_count; c++)
        own->corner_vertex[c] = mesh->face_indices[c];
    return true;
}

static bool allocate_pieces(skinslide_tessellation *own) {
    own->at = SS_NEW(&own->memory, ss_parameter, own->vertex_count);
    own->same_as = SS_NEW(&own->memory, uint32_t, own->vertex_count);
    own->fixed = SS_NEW(&own->memory, ss_fixed_vertex, own->vertex_count);
    own->triangles = ss_new(&own->memory, own->triangle_count, sizeof *own->triangles);
    return !own->memory.failed;
}

static bool allocate_plan(const skinslide_mesh *mesh, ss_memory *memory, blueprint *plan) {
    plan->kinds = SS_NEW(memory, ss_face_surface, mesh->face_count);
    plan->surface_of = SS_NEW(memory, int32_t, mesh->face_count);
    plan->inside = SS_NEW(memory, uint8_t, mesh->face_count);
    plan->fine = SS_NEW(memory, uint8_t, mesh->face_count);
    plan->coarse = SS_NEW(memory, uint8_t, mesh->index_count);
    return !memory->failed;
}

/* Faces of corners, and edges. False if memory is short. */
static bool connect_faces(skinslide_tessellation *own) {
    ss_faces *faces = &own->faces;
    faces->face_count = own->mesh_face_count, faces->corner_count = own->face_start[own->mesh_face_count];
    faces->face_start = own->face_start, faces->corner_vertex = own->corner_vertex;
    for (int32_t f = 0; f < own->mesh_face_count; f++)
        for (int32_t c = own->face_start[f]; c < own->face_start[f + 1]; c++)
            faces->corner_face[c] = f;
    return ss_number_edges(faces);
}

/* The same of the welded mesh, whose patches have no borders at its seams. False if memory is short. */
static bool connect_skin(skinslide_tessellation *own, const skinslide_mesh *mesh) {
    own->skin = own->faces;
    if (!mesh->weld)
        return true;
    own->skin.corner_vertex = SS_NEW(&own->memory, int32_t, mesh->index_count);
    own->skin.corner_edge = SS_NEW(&own->memory, int32_t, mesh->index_count);
    for (int32_t c = 0; c < mesh->index_count && !own->memory.failed; c++)
        own->skin.corner_vertex[c] = ss_one(mesh, mesh->face_indices[c]);
    return !own->memory.failed && ss_number_edges(&own->skin);
}

static skinslide_status build(skinslide_tessellation *own, const skinslide_mesh *mesh, const float *st, const int32_t *faces,
                              int32_t face_count, blueprint *plan, skinslide_error *error) {
    own->in_space = !st;
    if (!copy_faces(own, mesh) || !connect_faces(own) || !connect_skin(own, mesh))
        return ss_out_of_memory(error);
    for (int32_t i = 0; i < face_count; i++)
        plan->inside[faces[i]] = 1;
    skinslide_status status = take_surfaces(own, mesh, plan, error);
    if (!status)
        status = plan_grids(own, plan, error);
    if (status)
        return status;
    list_pieces(own, plan);
    if (!allocate_pieces(own) || !ss_join_seams(own))
        return ss_out_of_memory(error);
    list_triangles(own);
    status = ss_outline_create(own, faces, face_count, &own->outline, error);
    return status ? status : fix_vertices(own, mesh, st, error);
}

skinslide_status skinslide_tessellation_create(const skinslide_mesh *mesh, const float *st, const int32_t *faces,
                                               int32_t face_count, skinslide_tessellation **out, skinslide_error *error) {
    if (!out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the tessellation");
    ss_taken_mesh taken;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (!status)
        status = check(mesh, st, faces, face_count, error);
    if (status)
        return status;
    skinslide_tessellation *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    ss_memory scratch = {0};
    blueprint plan = {0};
    bool allocated = allocate_plan(mesh, &scratch, &plan);
    status = allocated ? build(own, mesh, st, faces, face_count, &plan, error) : ss_out_of_memory(error);
    ss_free(&scratch);
    if (status)
        skinslide_tessellation_destroy(own);
    else
        *out = own;
    return status;
}

void skinslide_tessellation_destroy(skinslide_tessellation *own) {
    if (!own)
        return;
    skinslide_outline_destroy(own->outline);
    ss_limit_surfaces_destroy(own->surfaces);
    ss_free(&own->memory);
    free(own);
}

skinslide_status skinslide_tessellation_describe(const skinslide_tessellation *own, skinslide_tessellation_info *info,
                                                 skinslide_error *error) {
    if (!own || !info)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no tessellation, or no place for the answer");
    const skinslide_tessellation_info answer = {sizeof answer, own->vertex_count, own->triangle_count, own->flat_faces};
    skinslide_status status = ss_check_size(info, "skinslide_tessellation_info", error);
    if (!status)
        ss_give(&answer, sizeof answer, info);
    return status;
}
