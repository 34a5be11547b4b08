/* The box around points, which a scene keeps beside them. */
#include "mesh.h"

#include <float.h>
#include <string.h>

/* A number that is none is neither less nor more. Of numbers that are equal, such as 0 and -0, the first stays. */
static void add(const float point[3], float extent[2][3]) {
    for (int k = 0; k < 3; k++) {
        extent[0][k] = point[k] < extent[0][k] ? point[k] : extent[0][k];
        extent[1][k] = point[k] > extent[1][k] ? point[k] : extent[1][k];
    }
}

skinslide_status skinslide_extent(const float *points, int32_t vertex_count, float *extent, skinslide_error *error) {
    if (vertex_count < 0 || (vertex_count > 0 && !points) || !extent)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points, a negative count of them, or no place for their extent");
    float own[2][3] = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (int32_t v = 0; v < vertex_count; v++)
        add(points + 3 * (int64_t)v, own);
    memcpy(extent, own, sizeof own);
    return SKINSLIDE_OK;
}
