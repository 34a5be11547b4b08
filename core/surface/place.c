/* Places on a patch: a triangle, weights of its vertices, and the same point in the plane that the patch is laid out in. */
#include "surface.h"

#include <string.h>

ss_place ss_place_of_vertex(const ss_patch *patch, const double (*uv)[2], int32_t vertex) {
    ss_place place = {patch->triangles.vertex_triangle[vertex], {0, 0, 0}, {0, 0}};
    for (int k = 0; k < 2 && uv; k++)
        place.uv[k] = uv[vertex][k];
    for (int k = 0; k < 3; k++)
        place.weight[k] = patch->triangles.vertex[place.triangle][k] == vertex;
    return place;
}

ss_place ss_place_staying(const double own[2]) {
    return (ss_place){SS_STAYS, {0, 0, 0}, {own[0], own[1]}};
}

int ss_place_corner(const ss_place *place) {
    for (int k = 0; k < 3; k++)
        if (place->weight[k] == 1)
            return k;
    return -1;
}

void ss_place_in_plane(const ss_patch *patch, const double (*uv)[2], const ss_place *place, double out[2]) {
    const int32_t *v = patch->triangles.vertex[place->triangle];
    const double *weight = place->weight;
    for (int k = 0; k < 2; k++)
        out[k] = weight[0] * uv[v[0]][k] + weight[1] * uv[v[1]][k] + weight[2] * uv[v[2]][k];
}

/* ---- From the plane: barycentric weights ---- */

static double cross(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance(const double a[2], const double b[2]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

/* For a triangle without area: weights along its longest side. */
static void weigh_side(const double *corners[3], const double p[2], double weights[3]) {
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (distance(corners[k], corners[(k + 1) % 3]) > distance(corners[longest], corners[(longest + 1) % 3]))
            longest = k;
    double whole = distance(corners[longest], corners[(longest + 1) % 3]);
    double share = whole > 0 ? distance(corners[longest], p) / whole : 0;
    weights[0] = weights[1] = weights[2] = 0;
    weights[(longest + 1) % 3] = share > 1 ? 1 : share;
    weights[longest] = 1 - weights[(longest + 1) % 3];
}

static double clamped(double share, double most) {
    return share > 0 ? (share < most ? share : most) : 0;
}

void ss_place_between(const double *corners[3], int32_t triangle, const double p[2], ss_place *out) {
    double area = cross(corners[0], corners[1], corners[2]);
    double second = cross(corners[0], p, corners[2]) / area, third = cross(corners[0], corners[1], p) / area;
    out->triangle = triangle, out->uv[0] = p[0], out->uv[1] = p[1];
    if (!isfinite(second) || !isfinite(third)) {
        weigh_side(corners, p, out->weight);
        return;
    }
    out->weight[1] = clamped(second, 1);
    out->weight[2] = clamped(third, 1 - out->weight[1]);
    out->weight[0] = 1 - out->weight[1] - out->weight[2];
}

void ss_place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2], ss_place *out) {
    const int32_t *v = patch->triangles.vertex[triangle];
    const double *corners[3] = {uv[v[0]], uv[v[1]], uv[v[2]]};
    ss_place_between(corners, triangle, p, out);
}

void ss_place_settle(const ss_patch *patch, const double (*uv)[2], ss_place *place) {
    static const double most_off = 1e-6;
    ss_place found;
    double at[2];
    ss_place_in_plane(patch, uv, place, at);
    ss_place_at(patch, uv, place->triangle, at, &found);
    memcpy(place->uv, at, sizeof at);
    for (int k = 0; k < 3; k++)
        if (!(fabs(found.weight[k] - place->weight[k]) <= most_off))
            return;
    *place = found;
}

void ss_ask_where_found(ss_slide *slide) {
    for (int32_t i = 0; i < slide->rest->patch->free_count; i++)
        memcpy(slide->asked[i], slide->places[i].uv, sizeof *slide->asked);
}
