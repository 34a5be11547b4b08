/* One connected patch: its vertices, edges and loops, and what of it may slide. */
#include "mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Vertices ---- */

/* The vertex that a mesh vertex is one with; a number that is no vertex stays as it is. */
static int32_t welded(const ss_patch *patch, int32_t mesh_vertex) {
    bool known = patch->weld && mesh_vertex >= 0 && mesh_vertex < patch->mesh_vertex_count;
    return known ? patch->weld[mesh_vertex] : mesh_vertex;
}

int32_t ss_patch_vertex(const ss_patch *patch, int32_t mesh_vertex) {
    mesh_vertex = welded(patch, mesh_vertex);
    const int32_t *found =
        bsearch(&mesh_vertex, patch->mesh_vertex, (size_t)patch->vertex_count, sizeof mesh_vertex, ss_ascending);
    while (found && found > patch->mesh_vertex && found[-1] == mesh_vertex)
        found--;
    return found ? (int32_t)(found - patch->mesh_vertex) : -1;
}

/* The rules of the plane refuse a vertex with several fans of faces; the others split it. */
static bool splits_vertices(const ss_patch *patch) {
    return !ss_has_plane(patch->setup->rule);
}

/* Corners hold mesh vertices before, patch vertices after; edges keep their numbers, since the order of vertices is kept. */
static bool number_vertices(ss_patch *patch, ss_memory *scratch) {
    ss_faces *faces = &patch->faces;
    patch->mesh_vertex = SS_NEW(scratch, int32_t, faces->corner_count);
    patch->split = SS_NEW(scratch, uint8_t, faces->corner_count);
    if (scratch->failed)
        return false;
    for (int32_t c = 0; c < faces->corner_count; c++)
        patch->mesh_vertex[c] = faces->corner_vertex[c];
    qsort(patch->mesh_vertex, (size_t)faces->corner_count, sizeof *patch->mesh_vertex, ss_ascending);
    for (int32_t c = 0; c < faces->corner_count; c++)
        if (c == 0 || patch->mesh_vertex[c] != patch->mesh_vertex[c - 1])
            patch->mesh_vertex[patch->vertex_count++] = patch->mesh_vertex[c];
    for (int32_t c = 0; c < faces->corner_count; c++)
        faces->corner_vertex[c] = ss_patch_vertex(patch, faces->corner_vertex[c]);
    return !splits_vertices(patch) || ss_split_vertices(patch);
}

static void mark_shared(ss_patch *patch, const ss_piece *piece) {
    for (int32_t v = 0; v < patch->vertex_count && piece->shared_count > 0; v++)
        if (bsearch(&patch->mesh_vertex[v], piece->shared_vertex, (size_t)piece->shared_count, sizeof(int32_t), ss_ascending))
            patch->shared[v] = 1;
}

/* Copies the vertices from scratch memory to arrays of the size that they came to. False if memory is short. */
static bool keep_vertices(ss_patch *patch) {
    int32_t *mesh_vertex = SS_NEW(&patch->memory, int32_t, patch->vertex_count);
    uint8_t *split = SS_NEW(&patch->memory, uint8_t, patch->vertex_count);
    if (patch->memory.failed)
        return false;
    memcpy(mesh_vertex, patch->mesh_vertex, (size_t)patch->vertex_count * sizeof *mesh_vertex);
    memcpy(split, patch->split, (size_t)patch->vertex_count * sizeof *split);
    patch->mesh_vertex = mesh_vertex, patch->split = split;
    return true;
}

/* The patch vertex and the mesh vertex at each corner: pairs [corner_count]. */
static void pair_corners(const ss_faces *faces, const skinslide_mesh *mesh, const int32_t *face_start,
                         const int32_t *mesh_faces, int32_t (*pairs)[2]) {
    for (int32_t f = 0; f < faces->face_count; f++)
        for (int32_t c = faces->face_start[f], k = face_start[mesh_faces[f]]; c < faces->face_start[f + 1]; c++, k++)
            pairs[c][0] = faces->corner_vertex[c], pairs[c][1] = mesh->face_indices[k];
}

/* Takes pairs as scratch. False if memory is short. */
static bool list_copies(ss_patch *patch, int32_t (*pairs)[2]) {
    const ss_faces *faces = &patch->faces;
    int32_t count = 0;
    qsort(pairs, (size_t)faces->corner_count, sizeof *pairs, ss_ascending_pairs);
    for (int32_t c = 0; c < faces->corner_count; c++)
        if (c == 0 || ss_ascending_pairs(pairs[c], pairs[c - 1]) != 0)
            memmove(pairs[count++], pairs[c], sizeof *pairs);
    patch->copy = SS_NEW(&patch->memory, int32_t, count);
    for (int32_t i = 0; i < count && patch->copy; i++) {
        patch->copy[i] = pairs[i][1];
        patch->copy_start[pairs[i][0] + 1] = i + 1;
    }
    return patch->copy != NULL;
}

/* How many vertices are on loops: as many as there are sides on the boundary, once check_fans has passed. */
static int32_t count_boundary(const ss_faces *faces) {
    int32_t count = 0;
    for (int32_t c = 0; c < faces->corner_count; c++)
        count += faces->corner_twin[c] < 0;
    return count;
}

static void list_edges(ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t a = faces->corner_vertex[c], b = faces->corner_vertex[ss_next_corner(faces, c)];
        int32_t *edge = patch->edge_vertex[faces->corner_edge[c]];
        edge[0] = a < b ? a : b, edge[1] = a < b ? b : a;
    }
}

int32_t ss_patch_edge(const ss_patch *patch, int32_t a, int32_t b) {
    int32_t key[2] = {a < b ? a : b, a < b ? b : a};
    const int32_t(*found)[2] =
        bsearch(key, patch->edge_vertex, (size_t)patch->faces.edge_count, sizeof *patch->edge_vertex, ss_ascending_pairs);
    return found ? (int32_t)(found - (const int32_t(*)[2])patch->edge_vertex) : -1;
}

int32_t ss_patch_mesh_edge(const ss_patch *patch, int32_t a, int32_t b) {
    a = welded(patch, a), b = welded(patch, b);
    int32_t count = patch->vertex_count, first = ss_patch_vertex(patch, a), second = ss_patch_vertex(patch, b), edge = -1;
    for (int32_t v = first; v >= 0 && v < count && patch->mesh_vertex[v] == a && edge < 0; v++)
        for (int32_t w = second; w >= 0 && w < count && patch->mesh_vertex[w] == b && edge < 0; w++)
            edge = ss_patch_edge(patch, v, w);
    return edge;
}

/* ---- Loops ---- */

/* The faces of every vertex must follow each other over shared edges: a single turn, or on the boundary a single fan. Sets
 * vertex_corner; turned and corners are scratch [vertex_count]. */
static skinslide_status check_fans(ss_patch *patch, int32_t *turned, int32_t *corners, skinslide_error *error) {
    const ss_faces *faces = &patch->faces;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        patch->vertex_corner[v] = -1;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t v = faces->corner_vertex[c];
        corners[v]++;
        if (patch->vertex_corner[v] < 0 || faces->corner_twin[c] < 0)
            patch->vertex_corner[v] = c;
    }
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        int32_t c = patch->vertex_corner[v], first = c;
        bool boundary = faces->corner_twin[c] < 0;
        do {
            turned[v]++;
            c = faces->corner_twin[ss_previous_corner(faces, c)];
        } while (c >= 0 && c != first);
        if (turned[v] != corners[v])
            return ss_fail(error, SKINSLIDE_BAD_PATCH,
                           boundary ? "%s: the boundary touches itself at vertex %d"
                                    : "%s: vertex %d joins faces that share no edge there",
                           patch->label, patch->mesh_vertex[v]);
    }
    return SKINSLIDE_OK;
}

/* Follows every boundary loop from its lowest vertex. Needs vertex_corner. */
static void trace_loops(ss_patch *patch) {
    const ss_faces *faces = &patch->faces;
    int32_t traced = 0;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        patch->vertex_loop[v] = -1;
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        if (patch->vertex_loop[v] >= 0 || faces->corner_twin[patch->vertex_corner[v]] >= 0)
            continue;
        for (int32_t w = v; patch->vertex_loop[w] < 0;
             w = faces->corner_vertex[ss_next_corner(faces, patch->vertex_corner[w])]) {
            patch->vertex_loop[w] = patch->loop_count;
            patch->loop_vertex[traced++] = w;
        }
        patch->loop_start[++patch->loop_count] = traced;
    }
}

/* Euler: V - E + F + loops = 2 for a sphere with loops cut out; every handle takes 2 away. */
skinslide_status ss_check_disk(const ss_patch *patch, skinslide_error *error) {
    int32_t euler = patch->vertex_count - patch->faces.edge_count + patch->faces.face_count + patch->loop_count;
    if (patch->loop_count == 0)
        return ss_fail(error, SKINSLIDE_BAD_PATCH,
                       "%s: the patch is closed; rules unit and fast need a boundary to hold on to, relaxed and even do not",
                       patch->label);
    if (euler != 2)
        return ss_fail(error, SKINSLIDE_BAD_PATCH,
                       "%s: the patch has %d handle(s); rules unit and fast need a disk with holes, relaxed and even do not",
                       patch->label, (2 - euler) / 2);
    return SKINSLIDE_OK;
}

static double loop_length(const ss_patch *patch, int32_t loop) {
    double length = 0;
    for (int32_t i = patch->loop_start[loop]; i < patch->loop_start[loop + 1]; i++)
        length += patch->rest_length[patch->faces.corner_edge[patch->vertex_corner[patch->loop_vertex[i]]]];
    return length;
}

/* Makes the longest loop number 0. scratch is [vertices on loops]. */
static void put_outer_first(ss_patch *patch, int32_t *scratch) {
    int32_t outer = 0, on_loops = patch->loop_start[patch->loop_count];
    if (patch->loop_count == 0)
        return;
    for (int32_t loop = 1; loop < patch->loop_count; loop++)
        if (loop_length(patch, loop) > loop_length(patch, outer))
            outer = loop;
    int32_t begin = patch->loop_start[outer], count = patch->loop_start[outer + 1] - begin, k = 0;
    for (int32_t i = 0; i < count; i++)
        scratch[k++] = patch->loop_vertex[begin + i];
    for (int32_t i = 0; i < on_loops; i++)
        if (i < begin || i >= begin + count)
            scratch[k++] = patch->loop_vertex[i];
    for (int32_t loop = outer; loop > 0; loop--)
        patch->loop_start[loop] = patch->loop_start[loop - 1] + count;
    for (int32_t i = 0; i < on_loops; i++)
        patch->loop_vertex[i] = scratch[i];
    for (int32_t loop = 0; loop < patch->loop_count; loop++)
        for (int32_t i = patch->loop_start[loop]; i < patch->loop_start[loop + 1]; i++)
            patch->vertex_loop[patch->loop_vertex[i]] = loop, patch->loop_place[patch->loop_vertex[i]] = i;
}

/* ---- Lengths ---- */

/* Not relative to the patch's centre: so differences of points are those from which edge lengths are taken, to the bit, and
 * rest has no stretch at all. */
void ss_take_points(const ss_patch *patch, const float *points, double (*out)[3]) {
    for (int32_t v = 0; v < patch->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            out[v][k] = points[3 * (int64_t)patch->mesh_vertex[v] + k];
}

static skinslide_status measure_rest(ss_patch *patch, const float *rest_points, skinslide_error *error) {
    int32_t edges = patch->faces.edge_count;
    ss_edge_lengths(patch, rest_points, patch->rest_length);
    double sum = 0;
    for (int32_t e = 0; e < edges; e++)
        sum += patch->rest_length[e];
    if (sum == 0)
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "%s: all its rest points are in one place", patch->label);
    patch->mean_edge = sum / edges;
    patch->shortest = 1e-6 * patch->mean_edge;
    patch->zero_length_edges = ss_edge_lengths(patch, rest_points, patch->rest_length);
    return SKINSLIDE_OK;
}

/* ---- What may slide ---- */

/* Breadth first over edges, from the lowest free vertex of each region between fixed ones. place is scratch [vertex_count]. */
static void order_free(ss_patch *patch, int32_t *place) {
    const ss_faces *faces = &patch->faces;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        place[v] = -1;
    for (int32_t seed = 0, done = 0; seed < patch->vertex_count; seed++) {
        if (patch->fixed[seed] || place[seed] >= 0)
            continue;
        place[seed] = patch->free_count;
        patch->free_before[patch->free_count] = -1;
        patch->free_vertex[patch->free_count++] = seed;
        for (; done < patch->free_count; done++) {
            int32_t first = patch->vertex_corner[patch->free_vertex[done]], c = first;
            do {
                int32_t w = faces->corner_vertex[ss_next_corner(faces, c)];
                if (!patch->fixed[w] && place[w] < 0) {
                    place[w] = patch->free_count;
                    patch->free_before[patch->free_count] = done;
                    patch->free_vertex[patch->free_count++] = w;
                }
                c = faces->corner_twin[ss_previous_corner(faces, c)];
            } while (c >= 0 && c != first);
        }
    }
}

static bool holds_loop(const ss_patch *patch, int32_t loop) {
    return loop == 0 ? patch->setup->holes != SKINSLIDE_HOLES_FREE_ALL : patch->setup->holes == SKINSLIDE_HOLES_PINNED;
}

/* Faces that meet only in a point, be they of one piece or of several, cannot each move it. In a plane, what is held is on
 * loops. */
static bool touches_others(const ss_patch *patch, int32_t vertex) {
    return patch->split[vertex] || (patch->shared[vertex] && (patch->vertex_loop[vertex] >= 0 || splits_vertices(patch)));
}

/* Whether the set-up holds any copy of a vertex. */
static bool is_held(const ss_patch *patch, int32_t vertex) {
    bool held = false;
    for (int32_t i = patch->copy_start[vertex]; i < patch->copy_start[vertex + 1] && patch->setup->held; i++)
        held = held || patch->setup->held[patch->copy[i]];
    return held;
}

static void hold_vertices(ss_patch *patch) {
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        int32_t loop = patch->vertex_loop[v];
        patch->fixed[v] = touches_others(patch, v) || (loop >= 0 && holds_loop(patch, loop));
        bool held = !patch->fixed[v] && loop >= 0 && is_held(patch, v);
        patch->held_count += held;
        patch->fixed[v] = patch->fixed[v] || held;
    }
}

/* ---- Creation ---- */

void ss_label(const skinslide_patch_setup *setup, int32_t piece, int32_t piece_count, char *label, size_t size) {
    enum { MOST = 96 }; /* bytes of a name, which leaves room for what follows it in a message */
    size_t shown = strlen(setup->name);
    const char *dots = "";
    if (shown > MOST) {
        dots = "...";
        for (shown = MOST; shown > 0 && ((unsigned char)setup->name[shown] & 0xC0) == 0x80;)
            shown--; /* not to end in the middle of a UTF-8 character */
    }
    if (piece_count == 1)
        snprintf(label, size, "patch %.*s%s", (int)shown, setup->name, dots);
    else
        snprintf(label, size, "patch %.*s%s (piece %d of %d)", (int)shown, setup->name, dots, piece + 1, piece_count);
}

static void allocate(ss_patch *patch) {
    ss_memory *memory = &patch->memory;
    int32_t vertices = patch->vertex_count, edges = patch->faces.edge_count, boundary = count_boundary(&patch->faces);
    patch->copy_start = SS_NEW(memory, int32_t, (int64_t)vertices + 1);
    patch->vertex_corner = SS_NEW(memory, int32_t, vertices);
    patch->edge_vertex = ss_new(memory, edges, sizeof *patch->edge_vertex);
    patch->rest_length = SS_NEW(memory, double, edges);
    patch->loop_start = SS_NEW(memory, int32_t, (int64_t)boundary + 1);
    patch->loop_vertex = SS_NEW(memory, int32_t, boundary);
    patch->vertex_loop = SS_NEW(memory, int32_t, vertices);
    patch->loop_place = SS_NEW(memory, int32_t, vertices);
    patch->fixed = SS_NEW(memory, uint8_t, vertices);
    patch->shared = SS_NEW(memory, uint8_t, vertices);
    patch->free_vertex = SS_NEW(memory, int32_t, vertices);
    patch->free_before = SS_NEW(memory, int32_t, vertices);
}

/* What needs scratch memory: two arrays [vertex_count]. */
static skinslide_status build(ss_patch *patch, const float *rest_points, int32_t *scratch[2], skinslide_error *error) {
    skinslide_status status = check_fans(patch, scratch[0], scratch[1], error);
    if (status)
        return status;
    trace_loops(patch);
    list_edges(patch);
    if ((status = measure_rest(patch, rest_points, error)))
        return status;
    put_outer_first(patch, scratch[0]);
    hold_vertices(patch);
    order_free(patch, scratch[0]);
    return ss_list_triangles(patch) ? SKINSLIDE_OK : ss_out_of_memory(error);
}

skinslide_status ss_patch_create(const skinslide_mesh *mesh, const int32_t *face_start, const skinslide_patch_setup *setup,
                                 int32_t setup_index, const ss_piece *piece, ss_patch **out, skinslide_error *error) {
    ss_patch *patch = calloc(1, sizeof *patch);
    if (!patch)
        return ss_out_of_memory(error);
    ss_memory scratch = {0};
    patch->setup = setup, patch->setup_index = setup_index, patch->piece = piece->number, patch->piece_count = piece->count;
    patch->weld = mesh->weld, patch->mesh_vertex_count = mesh->vertex_count;
    ss_label(setup, piece->number, piece->count, patch->label, sizeof patch->label);
    if (!face_start)
        face_start = ss_list_starts(mesh, &scratch);
    skinslide_status status =
        ss_take_faces(mesh, face_start, piece->faces, piece->face_count, patch->label, &patch->memory, &patch->faces, error);
    if (!status && !(number_vertices(patch, &scratch) && keep_vertices(patch)))
        status = ss_out_of_memory(error);
    if (!status) {
        allocate(patch);
        patch->mesh_face = SS_NEW(&patch->memory, int32_t, piece->face_count);
        int32_t *arrays[2] = {SS_NEW(&scratch, int32_t, patch->vertex_count), SS_NEW(&scratch, int32_t, patch->vertex_count)};
        int32_t(*pairs)[2] = ss_new(&scratch, patch->faces.corner_count, sizeof *pairs);
        status = patch->memory.failed || scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
        if (!status)
            mark_shared(patch, piece), pair_corners(&patch->faces, mesh, face_start, piece->faces, pairs);
        if (!status && !list_copies(patch, pairs))
            status = ss_out_of_memory(error);
        if (!status)
            status = build(patch, mesh->rest_points, arrays, error);
    }
    ss_free(&scratch);
    if (status) {
        ss_patch_destroy(patch);
        return status;
    }
    for (int32_t f = 0; f < piece->face_count; f++)
        patch->mesh_face[f] = piece->faces[f];
    *out = patch;
    return SKINSLIDE_OK;
}

void ss_patch_destroy(ss_patch *patch) {
    if (!patch)
        return;
    ss_free(&patch->memory);
    free(patch);
}
