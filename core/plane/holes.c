/* Where the loops of holes go: where they fall in the rest embedding if every hole is capped.
 *
 * The paper leaves hole loops free at rest and then pins them where they fall, but free loops fold. So each hole gets a virtual
 * vertex, joined to every vertex of its loop with density 1 / (rest distance to the loop's centroid). The patch is then a disk,
 * whose embedding (rule unit, unpainted) cannot fold. The caps are dropped again, and the loops stay where they are. */
#include "plane.h"

#include <math.h>

static double distance_to(const double centre[3], const float *point) {
    double x = point[0] - centre[0], y = point[1] - centre[1], z = point[2] - centre[2];
    return sqrt(x * x + y * y + z * z);
}

static void centroid(const ss_patch *patch, int32_t loop, const float *rest_points, double out[3]) {
    int32_t begin = patch->loop_start[loop], end = patch->loop_start[loop + 1];
    const float *origin = rest_points + 3 * (int64_t)patch->mesh_vertex[patch->loop_vertex[begin]];
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (int32_t i = begin; i < end; i++)
            sum += (double)rest_points[3 * (int64_t)patch->mesh_vertex[patch->loop_vertex[i]] + k] - origin[k];
        out[k] = origin[k] + sum / (end - begin);
    }
}

/* The patch's own edges, then the spokes of every cap. */
static void join_caps(const ss_patch *patch, const float *rest_points, int32_t (*edges)[2], double *density) {
    int32_t e = 0;
    for (; e < patch->faces.edge_count; e++) {
        edges[e][0] = patch->edge_vertex[e][0], edges[e][1] = patch->edge_vertex[e][1];
        density[e] = patch->shortest / patch->rest_length[e];
    }
    for (int32_t loop = 1; loop < patch->loop_count; loop++) {
        double centre[3];
        centroid(patch, loop, rest_points, centre);
        for (int32_t i = patch->loop_start[loop]; i < patch->loop_start[loop + 1]; i++, e++) {
            int32_t vertex = patch->loop_vertex[i];
            double length = distance_to(centre, rest_points + 3 * (int64_t)patch->mesh_vertex[vertex]);
            edges[e][0] = vertex, edges[e][1] = patch->vertex_count + loop - 1;
            density[e] = patch->shortest / (length < patch->shortest ? patch->shortest : length);
        }
    }
}

skinslide_status ss_place_holes(const ss_patch *patch, const float *rest_points, double (*uv)[2], skinslide_error *error) {
    int32_t holes = patch->loop_count - 1, vertices = patch->vertex_count + holes;
    int32_t spokes = patch->loop_start[patch->loop_count] - patch->loop_start[1];
    int32_t edge_count = patch->faces.edge_count + spokes;
    if (holes == 0)
        return SKINSLIDE_OK;
    ss_memory memory = {0};
    int32_t(*edges)[2] = ss_new(&memory, edge_count, sizeof *edges);
    double *density = SS_NEW(&memory, double, edge_count);
    uint8_t *fixed = SS_NEW(&memory, uint8_t, vertices);
    double(*capped)[2] = ss_new(&memory, vertices, sizeof *capped);
    skinslide_status status = memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status) {
        join_caps(patch, rest_points, edges, density);
        for (int32_t v = 0; v < patch->vertex_count; v++) {
            fixed[v] = patch->vertex_loop[v] == 0;
            capped[v][0] = uv[v][0], capped[v][1] = uv[v][1];
        }
        ss_net net = {vertices, edge_count, (const int32_t(*)[2])edges, fixed};
        status = ss_embed_once(&net, patch->label, density, capped, error);
    }
    for (int32_t v = 0; v < patch->vertex_count && !status; v++)
        if (patch->vertex_loop[v] > 0)
            uv[v][0] = capped[v][0], uv[v][1] = capped[v][1];
    ss_free(&memory);
    return status;
}
