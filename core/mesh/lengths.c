/* Lengths of edges: one by one, or four at once, for which points are first copied to four numbers each. */
#include "mesh.h"

/* From an edge on. */
static int32_t measure(const ss_patch *patch, const float *points, int32_t first, double *lengths) {
    int32_t clamped = 0;
    for (int32_t e = first; e < patch->faces.edge_count; e++) {
        const int32_t *v = patch->edge_vertex[e];
        double length = ss_distance(points, patch->mesh_vertex[v[0]], patch->mesh_vertex[v[1]]);
        clamped += length < patch->shortest;
        lengths[e] = length < patch->shortest ? patch->shortest : length;
    }
    return clamped;
}

int32_t ss_edge_lengths(const ss_patch *patch, const float *points, double *lengths) {
    return measure(patch, points, 0, lengths);
}

#ifdef __x86_64__
typedef int64_t bits __attribute__((vector_size(32)));

typedef float four_floats __attribute__((vector_size(16)));

__attribute__((target("avx2"))) static void lay_out(const ss_patch *patch, const float *points, double (*restrict out)[4]) {
    const int32_t *mesh_vertex = patch->mesh_vertex, count = patch->vertex_count;
    for (int32_t v = 0; v < count; v++) {
        const float *from = points + 3 * (int64_t)mesh_vertex[v];
        four_floats point = {from[0], from[1], from[2], 0};
        *(ss_loose_four *)out[v] = __builtin_convertvector(point, ss_four);
    }
}

/* The squares of four lengths, of edges that follow each other. */
__attribute__((target("avx2"))) SS_INLINE ss_four squares(const int32_t (*edge)[2], const double (*points)[4]) {
    ss_four square[4], first[2], second[2];
    for (int k = 0; k < 4; k++) {
        ss_four way = *(const ss_loose_four *)points[edge[k][1]] - *(const ss_loose_four *)points[edge[k][0]];
        square[k] = way * way;
    }
    for (int k = 0; k < 2; k++) { /* in its halves: x, x, z, z and y, y, 0, 0 */
        first[k] = __builtin_shuffle(square[2 * k], square[2 * k + 1], (bits){0, 4, 2, 6});
        second[k] = first[k] + __builtin_shuffle(square[2 * k], square[2 * k + 1], (bits){1, 5, 3, 7});
    }
    return __builtin_shuffle(second[0], second[1], (bits){0, 1, 4, 5}) +
           __builtin_shuffle(first[0], first[1], (bits){2, 3, 6, 7});
}

/* Of the first edges, whose count is a multiple of four. It has no calls: GCC 12 does not clear the upper halves of registers
 * before one here, and SSE code that runs next is slow then. */
__attribute__((target("avx2"))) static int32_t measure_avx2(const ss_patch *patch, const double (*points)[4], int32_t count,
                                                            double *lengths) {
    const ss_four shortest = {patch->shortest, patch->shortest, patch->shortest, patch->shortest};
    bits clamped = {0};
    for (int32_t e = 0; e < count; e += 4) {
        ss_four square = squares((const int32_t(*)[2])patch->edge_vertex + e, points);
        ss_four length = {sqrt(square[0]), sqrt(square[1]), sqrt(square[2]), sqrt(square[3])};
        bits is_short = length < shortest;
        *(ss_loose_four *)(lengths + e) = (ss_four)(((bits)shortest & is_short) | ((bits)length & ~is_short));
        clamped -= is_short;
    }
    return (int32_t)(clamped[0] + clamped[1] + clamped[2] + clamped[3]);
}
#endif

int32_t ss_edge_lengths_at_once(const ss_patch *patch, const float *points, double (*own)[4], double *lengths) {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        int32_t fours = patch->faces.edge_count / 4 * 4;
        lay_out(patch, points, own);
        return measure_avx2(patch, (const double(*)[4])own, fours, lengths) + measure(patch, points, fours, lengths);
    }
#endif
    (void)own;
    return ss_edge_lengths(patch, points, lengths);
}
