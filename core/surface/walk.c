/* Walks over a patch: straight in the plane that it is laid out in, or along its border in a pose. Straight means that a walk
 * that crosses a side goes on in the next triangle at the same angle to that side. Walks end at the border, so that a place
 * never leaves the patch. */
#include "surface.h"

#define MOST_CROSSED 1000

/* ---- Beginning: a step as rates of the weights ---- */

/* Solves step = a p + b q. False if p and q turn right or make no angle. */
static bool split(const double p[3], const double q[3], const double step[3], double out[2]) {
    double area = p[0] * q[1] - p[1] * q[0];
    out[0] = (step[0] * q[1] - step[1] * q[0]) / area;
    out[1] = (p[0] * step[1] - p[1] * step[0]) / area;
    return area > 0 && isfinite(out[0]) && isfinite(out[1]);
}

/* From a vertex, into the triangle that the step points into, else the one nearest to that. */
static void leave_vertex(const ss_posed *plane, ss_place *place, const double step[3], double rates[3]) {
    const ss_patch *patch = plane->patch;
    int32_t vertex = patch->triangles.vertex[place->triangle][ss_place_corner(place)];
    int32_t first = patch->triangles.vertex_triangle[vertex], t = first;
    double best = -INFINITY;
    do {
        const int32_t *v = patch->triangles.vertex[t];
        int k = ss_triangle_corner(patch, t, vertex), next = (k + 1) % 3, last = (k + 2) % 3;
        double p[3], q[3], along[2];
        ss_subtract(plane->point[v[next]], plane->point[vertex], p);
        ss_subtract(plane->point[v[last]], plane->point[vertex], q);
        if (split(p, q, step, along) && fmin(along[0], along[1]) > best) {
            best = fmin(along[0], along[1]);
            ss_place_put(place, t, (double[3]){k == 0, k == 1, k == 2});
            rates[next] = fmax(along[0], 0), rates[last] = fmax(along[1], 0), rates[k] = -rates[next] - rates[last];
        }
        t = patch->triangles.neighbour[t][last];
    } while (best < 0 && t >= 0 && t != first);
}

static void leave(const ss_posed *plane, ss_place *place, const double step[3], double rates[3]) {
    rates[0] = rates[1] = rates[2] = 0;
    if (ss_place_corner(place) >= 0)
        leave_vertex(plane, place, step, rates);
    else
        ss_rates_along(plane, place->triangle, step, rates);
}

/* ---- Walking ---- */

/* Goes over the side opposite a corner into the next triangle, at the same angle to the side. */
static void go_over(const ss_posed *pose, ss_place *place, int corner, double rates[3]) {
    const ss_patch *patch = pose->patch;
    int32_t here = place->triangle, there = patch->triangles.neighbour[here][(corner + 1) % 3];
    int32_t a = patch->triangles.vertex[here][(corner + 1) % 3], b = patch->triangles.vertex[here][(corner + 2) % 3];
    double side[3], out[3], in[3], vector[3];
    ss_subtract(pose->point[b], pose->point[a], side);
    ss_normalise(side);
    ss_cross(side, pose->facet[here].normal, out);
    ss_cross(side, pose->facet[there].normal, in);
    ss_vector_along(pose, here, rates, vector);
    double along = ss_dot(vector, side), over = ss_dot(vector, out);
    for (int k = 0; k < 3; k++)
        vector[k] = along * side[k] + over * in[k];
    ss_rates_along(pose, there, vector, rates);
    ss_cross_side(patch, place, corner);
}

/* One straight walk. It ends at the border, and at a triangle without area. */
static void walk(const ss_posed *plane, ss_place *place, const double step[3], ss_meter *meter) {
    double rates[3];
    leave(plane, place, step, rates);
    for (int crossed = 0; crossed < MOST_CROSSED; crossed++) {
        int corner;
        double whole = ss_reach(place, rates, -1, &corner), part = ss_measure(meter, place->triangle, rates, whole);
        ss_advance(place, rates, part, part < whole ? -1 : corner);
        if (corner < 0 || part < whole)
            return;
        int32_t there = plane->patch->triangles.neighbour[place->triangle][(corner + 1) % 3];
        if (there < 0 || !ss_has_area(&plane->facet[there]))
            return;
        go_over(plane, place, corner, rates);
    }
}

static void step_to(const ss_posed *plane, const ss_place *place, const double uv[2], double step[3]) {
    double here[3];
    ss_place_point(plane, place, here);
    step[0] = uv[0] - here[0], step[1] = uv[1] - here[1], step[2] = 0;
}

double ss_walk_measured(const ss_posed *plane, const ss_posed *pose, ss_place *place, const double uv[2], double limit) {
    double step[3];
    ss_meter meter = {pose, 0, limit};
    step_to(plane, place, uv, step);
    walk(plane, place, step, &meter);
    return meter.walked;
}

/* ---- Along the border ---- */

/* A place on the border, given in the triangle whose side it is on; at a vertex, in that of the side that begins there. */
static ss_place on_border(const ss_patch *patch, const ss_place *place) {
    int corner = ss_place_corner(place);
    return corner < 0 ? *place : ss_place_of_vertex(patch, NULL, patch->triangles.vertex[place->triangle][corner]);
}

/* The border side that the place is on, up to rounding; at a vertex, the one that begins there. */
static int border_side(const ss_patch *patch, const ss_place *place) {
    int nearest = 0;
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        double off = place->weight[(k + 2) % 3];
        if (patch->triangles.neighbour[place->triangle][k] < 0 && place->weight[k] > 0 && off < least)
            nearest = k, least = off;
    }
    return nearest;
}

static double side_vector(const ss_posed *pose, int32_t triangle, int side, double out[3]) {
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    ss_subtract(pose->point[v[(side + 1) % 3]], pose->point[v[side]], out);
    return sqrt(ss_dot(out, out));
}

/* The border side that ends where one begins. */
static void side_before(const ss_patch *patch, int32_t *triangle, int *side) {
    int32_t vertex = patch->triangles.vertex[*triangle][*side], t = *triangle;
    int incoming = (*side + 2) % 3;
    while (patch->triangles.neighbour[t][incoming] >= 0) {
        t = patch->triangles.neighbour[t][incoming];
        incoming = (ss_triangle_corner(patch, t, vertex) + 2) % 3;
    }
    *triangle = t, *side = incoming;
}

static void side_after(const ss_patch *patch, int32_t *triangle, int *side) {
    int32_t vertex = patch->triangles.vertex[*triangle][(*side + 1) % 3];
    *triangle = patch->triangles.vertex_triangle[vertex];
    *side = ss_triangle_corner(patch, *triangle, vertex);
}

void ss_border_way(const ss_posed *pose, const ss_place *place, double out[3]) {
    ss_place from = on_border(pose->patch, place);
    int side = border_side(pose->patch, &from);
    side_vector(pose, from.triangle, side, out);
    ss_normalise(out);
    if (from.weight[side] != 1)
        return;
    int32_t triangle = from.triangle;
    double before[3];
    side_before(pose->patch, &triangle, &side);
    side_vector(pose, triangle, side, before);
    ss_normalise(before);
    for (int k = 0; k < 3; k++)
        out[k] += before[k];
    ss_normalise(out);
}

void ss_walk_border(const ss_posed *pose, ss_place *place, double distance) {
    const ss_patch *patch = pose->patch;
    if (distance == 0) /* else it would go on over sides without length */
        return;
    ss_place from = on_border(patch, place);
    int32_t triangle = from.triangle;
    int side = border_side(patch, &from);
    double vector[3], length = side_vector(pose, triangle, side, vector);
    double along = from.weight[(side + 1) % 3] * length + distance;
    for (int walked = 0; along < 0 && walked < 1000; walked++) {
        side_before(patch, &triangle, &side);
        along += length = side_vector(pose, triangle, side, vector);
    }
    for (int walked = 0; along >= length && walked < 1000; walked++) {
        along -= length;
        side_after(patch, &triangle, &side);
        length = side_vector(pose, triangle, side, vector);
    }
    double share = length > 0 ? fmin(1, fmax(0, along / length)) : 0;
    ss_place_put(place, triangle, (double[3]){0, 0, 0});
    place->weight[side] = 1 - share;
    place->weight[(side + 1) % 3] = share;
}

double ss_border_distance(const ss_posed *pose, int32_t vertex, const ss_place *place) {
    const ss_patch *patch = pose->patch;
    int32_t triangle = patch->triangles.vertex_triangle[vertex];
    ss_place end = on_border(patch, place);
    int side = ss_triangle_corner(patch, triangle, vertex), goal = border_side(patch, &end);
    double walked = 0, there = 0, vector[3];
    do {
        double length = side_vector(pose, triangle, side, vector);
        if (triangle == end.triangle && side == goal)
            there = walked + end.weight[(side + 1) % 3] * length;
        walked += length;
        side_after(patch, &triangle, &side);
    } while (patch->triangles.vertex[triangle][side] != vertex);
    return there <= walked / 2 ? there : there - walked;
}
