/* Curves of any bytes over a grid: how far its edges are from them, or a refusal in one line. */
#include "skinslide/paint.h"
#include "stream.h"

#include <stdbool.h>

enum { SIDE = 5, VERTICES = SIDE * SIDE, EDGES = 2 * SIDE * (SIDE - 1), MOST_CURVES = 8 };

static void make_grid(float points[VERTICES][3], int32_t edges[EDGES][2]) {
    int32_t count = 0;
    for (int32_t v = 0; v < VERTICES; v++) {
        points[v][0] = (float)(v % SIDE), points[v][1] = (float)(v / SIDE), points[v][2] = 0;
        if (v % SIDE + 1 < SIDE)
            edges[count][0] = v, edges[count++][1] = v + 1;
        if (v + SIDE < VERTICES)
            edges[count][0] = v, edges[count++][1] = v + SIDE;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static float points[VERTICES][3];
    static int32_t edges[EDGES][2];
    stream s = {data, size};
    int32_t counts[MOST_CURVES];
    double to_mesh[16], distances[EDGES];
    skinslide_curves curves = SKINSLIDE_CURVES_DEFAULT;
    skinslide_error error;
    make_grid(points, edges);
    curves.curve_count = take_below(&s, MOST_CURVES + 1), curves.vertex_counts = counts;
    for (int32_t i = 0; i < curves.curve_count; i++)
        curves.point_count += counts[i] = take_below(&s, 16) - 1;
    curves.point_count += take_below(&s, 20) == 19;
    curves.basis = (skinslide_curve_basis)take_below(&s, 5), curves.wrap = (skinslide_curve_wrap)take_below(&s, 4);
    skinslide_direction direction = (skinslide_direction)take_below(&s, 4);
    bool placed = take_below(&s, 2);
    if (placed)
        take(&s, to_mesh, sizeof to_mesh);
    curves.to_mesh = placed ? to_mesh : NULL;
    float *own = take_new(&s, curves.point_count > 0 ? (size_t)curves.point_count * sizeof(float[3]) : 0);
    curves.points = own;
    skinslide_status status =
        skinslide_edge_distances(points[0], VERTICES, edges[0], EDGES, &curves, direction, distances, &error);
    require(!status || (error.message[0] && !strchr(error.message, '\n')));
    for (int32_t e = 0; !status && e < EDGES; e++)
        require(distances[e] >= 0);
    free(own);
    return 0;
}
