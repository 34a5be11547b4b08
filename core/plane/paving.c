/* The triangles of an embedding for walks: renumbered so that neighbours in the patch are near in memory, however its vertices
 * and faces were numbered. Vertices come in the order of free_vertex, in which neighbours follow each other, and then the fixed
 * ones; triangles are sorted by the first of their vertices. */
#include "plane.h"

#include <string.h>

/* ---- Once a thread ---- */

static void number_vertices(const ss_patch *patch, ss_paving *paving, int32_t *number) {
    int32_t count = patch->free_count;
    for (int32_t i = 0; i < count; i++)
        paving->vertex[i] = patch->free_vertex[i];
    for (int32_t v = 0; v < patch->vertex_count; v++)
        if (patch->fixed[v])
            paving->vertex[count++] = v;
    for (int32_t i = 0; i < count; i++)
        number[paving->vertex[i]] = i;
}

static int32_t first_of(const int32_t vertex[3], const int32_t *number) {
    int32_t a = number[vertex[0]], b = number[vertex[1]], c = number[vertex[2]], least = a < b ? a : b;
    return least < c ? least : c;
}

/* start is scratch [vertex_count + 1] of zeros. */
static void number_triangles(const ss_patch *patch, ss_paving *paving, const int32_t *number, int32_t *start) {
    const ss_triangles *triangles = &patch->triangles;
    for (int32_t t = 0; t < triangles->count; t++)
        start[first_of(triangles->vertex[t], number) + 1]++;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        start[v + 1] += start[v];
    for (int32_t t = 0; t < triangles->count; t++)
        paving->slab_of[t] = start[first_of(triangles->vertex[t], number)]++;
}

static void lay_slabs(const ss_patch *patch, ss_paving *paving, const int32_t *number) {
    const ss_triangles *triangles = &patch->triangles;
    for (int32_t t = 0; t < triangles->count; t++) {
        ss_slab *slab = &paving->slab[paving->slab_of[t]];
        slab->triangle = t;
        for (int k = 0; k < 3; k++) {
            int32_t beyond = triangles->neighbour[t][k];
            slab->vertex[k] = number[triangles->vertex[t][k]];
            slab->beyond[k] = beyond < 0 ? -1 : paving->slab_of[beyond];
        }
        slab->beyond[3] = paving->slab_of[t];
    }
}

bool ss_pave(ss_memory *memory, const ss_patch *patch, ss_paving *paving) {
    ss_memory scratch = {0};
    int32_t *number = SS_NEW(&scratch, int32_t, patch->vertex_count);
    int32_t *start = SS_NEW(&scratch, int32_t, (int64_t)patch->vertex_count + 1);
    paving->patch = patch;
    paving->vertex = SS_NEW(memory, int32_t, patch->vertex_count);
    paving->slab = SS_NEW(memory, ss_slab, patch->triangles.count);
    paving->slab_of = SS_NEW(memory, int32_t, patch->triangles.count);
    paving->uv = ss_new(memory, patch->vertex_count, sizeof *paving->uv);
    bool good = !memory->failed && !scratch.failed;
    if (good) {
        number_vertices(patch, paving, number);
        number_triangles(patch, paving, number, start);
        lay_slabs(patch, paving, number);
    }
    ss_free(&scratch);
    return good;
}

/* ---- In every frame ---- */

void ss_paving_lay_out(ss_paving *paving, const double (*uv)[2]) {
    for (int32_t i = 0; i < paving->patch->vertex_count; i++)
        memcpy(paving->uv[i], uv[paving->vertex[i]], sizeof *uv);
}

/* The first side that p is outside of, exactly; -1 if it is outside of none. */
static int exact_side(const ss_paving *paving, const ss_slab *slab, const double p[2], bool *on_border) {
    for (int k = 0; k < 3; k++) {
        int side = ss_orient(paving->uv[slab->vertex[k]], paving->uv[slab->vertex[(k + 1) % 3]], p);
        if (side < 0)
            return k;
        *on_border = *on_border || side == 0;
    }
    return -1;
}

/* The side that p is farthest outside of, by the area of its triangle with p, since walks that leave by the first such side may
 * go round; -1 if it is outside of none. */
static inline int side_to_leave_by(const ss_paving *paving, const ss_slab *slab, const double p[2], bool *on_border) {
    double x[3], y[3], turn[3], sum = 0;
    for (int k = 0; k < 3; k++)
        x[k] = paving->uv[slab->vertex[k]][0] - p[0], y[k] = paving->uv[slab->vertex[k]][1] - p[1];
    for (int k = 0; k < 3; k++) {
        double left = x[k] * y[(k + 1) % 3], right = y[k] * x[(k + 1) % 3];
        turn[k] = left - right;
        sum += fabs(left) + fabs(right);
    }
    int least = turn[0] < turn[1] ? 0 : 1;
    least = turn[least] < turn[2] ? least : 2;
    double doubt = SS_ORIENT_DOUBT * sum;
    if (turn[least] > doubt)
        return -1;
    return turn[least] < -doubt ? least : exact_side(paving, slab, p, on_border);
}

int32_t ss_paving_walk(const ss_paving *paving, int32_t from, const double p[2], bool *on_border, int64_t *steps) {
    int32_t most = 64 + 4 * (int32_t)sqrt(paving->patch->triangles.count), at = from;
    for (int32_t step = 0; step < most && at >= 0; step++, ++*steps) {
        const ss_slab *slab = &paving->slab[at];
        *on_border = false;
        int leave = side_to_leave_by(paving, slab, p, on_border);
        if (leave < 0)
            return at;
        at = slab->beyond[leave];
    }
    return -1;
}

void ss_paving_place_at(const ss_paving *paving, int32_t slab, const double p[2], ss_place *out) {
    const ss_slab *own = &paving->slab[slab];
    const double *corners[3];
    for (int k = 0; k < 3; k++)
        corners[k] = paving->uv[own->vertex[k]];
    ss_place_between(corners, own->triangle, p, out);
}
