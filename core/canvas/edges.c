/* Edges that are drawn in colours: finds the edge of the mesh that each pair of vertices is, and its value. */
#include "canvas.h"

#include <math.h>

static skinslide_status check(const skinslide_figure *figure, skinslide_error *error) {
    if (figure->edge_count < 0 || (figure->edge_count > 0 && (!figure->edges || !figure->edge_values)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%d edges to be drawn, without their values", figure->edge_count);
    skinslide_status status = figure->edge_count ? ss_check_scale(figure->lowest, figure->highest, error) : SKINSLIDE_OK;
    for (int32_t i = 0; i < figure->edge_count && !status; i++)
        if (!isfinite(figure->edge_values[i]))
            status = ss_fail(error, SKINSLIDE_BAD_POINTS, "the value of edge %d-%d is %g", figure->edges[2 * i],
                             figure->edges[2 * i + 1], (double)figure->edge_values[i]);
    return status;
}

/* The ends of each edge, lower first. Edges are numbered in the order of their ends, so the list is sorted. */
static void list_ends(const ss_faces *skin, int32_t (*ends)[2]) {
    for (int32_t c = 0; c < skin->corner_count; c++) {
        int32_t a = skin->corner_vertex[c], b = skin->corner_vertex[ss_next_corner(skin, c)],
                *edge = ends[skin->corner_edge[c]];
        edge[0] = a < b ? a : b, edge[1] = a < b ? b : a;
    }
}

/* The edge between two vertices; -1 where there is none. */
static int32_t find(const ss_faces *skin, int32_t (*const ends)[2], int32_t a, int32_t b) {
    int32_t low = 0, high = skin->edge_count, from = a < b ? a : b, to = a < b ? b : a;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        bool before = ends[middle][0] < from || (ends[middle][0] == from && ends[middle][1] < to);
        low = before ? middle + 1 : low, high = before ? high : middle;
    }
    return low < skin->edge_count && ends[low][0] == from && ends[low][1] == to ? low : -1;
}

/* skin_vertex [mesh_vertex_count]: -1 where no face has the vertex. */
static void take(ss_drawing *drawn, const int32_t *skin_vertex, int32_t (*const ends)[2]) {
    const skinslide_figure *figure = drawn->figure;
    for (int32_t i = 0; i < figure->edge_count; i++) {
        int32_t a = figure->edges[2 * i], b = figure->edges[2 * i + 1], count = drawn->mesh->mesh_vertex_count;
        bool known = a >= 0 && b >= 0 && a < count && b < count && skin_vertex[a] >= 0 && skin_vertex[b] >= 0;
        int32_t edge = known ? find(&drawn->mesh->skin, ends, skin_vertex[a], skin_vertex[b]) : -1;
        if (edge >= 0)
            drawn->edge_value[edge] = figure->edge_values[i];
    }
}

skinslide_status ss_take_edges(ss_drawing *drawn, skinslide_error *error) {
    const skinslide_tessellation *mesh = drawn->mesh;
    skinslide_status status = check(drawn->figure, error);
    if (status || !drawn->figure->edge_count)
        return status;
    ss_memory *memory = &drawn->work.memory;
    drawn->edge_value = SS_NEW(memory, float, mesh->skin.edge_count);
    int32_t *skin_vertex = SS_NEW(memory, int32_t, mesh->mesh_vertex_count);
    int32_t(*ends)[2] = ss_new(memory, mesh->skin.edge_count, sizeof *ends);
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t e = 0; e < mesh->skin.edge_count; e++)
        drawn->edge_value[e] = NAN;
    for (int32_t v = 0; v < mesh->mesh_vertex_count; v++)
        skin_vertex[v] = -1;
    for (int32_t c = 0; c < mesh->faces.corner_count; c++)
        skin_vertex[mesh->faces.corner_vertex[c]] = mesh->skin.corner_vertex[c];
    list_ends(&mesh->skin, ends);
    take(drawn, skin_vertex, ends);
    return SKINSLIDE_OK;
}
