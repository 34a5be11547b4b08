/* Sites: points that slide on a patch, in the plane that it is laid out in.
 *
 * A walk is straight: where it crosses a side it goes on in the next triangle at the same angle to that side. It ends at the
 * border of the patch, so a site never leaves it. */
#include "site.h"

#define MOST_CROSSED 1000

ss_site ss_site_of_vertex(const ss_triangles *triangles, int32_t vertex) {
    ss_site site = {triangles->vertex_triangle[vertex], {0, 0, 0}};
    for (int k = 0; k < 3; k++)
        site.weight[k] = triangles->vertex[site.triangle][k] == vertex;
    return site;
}

int ss_site_corner(const ss_site *site) {
    for (int k = 0; k < 3; k++)
        if (site->weight[k] == 1)
            return k;
    return -1;
}

void ss_site_blend(const ss_triangles *triangles, const ss_site *site, const double (*values)[2], double out[2]) {
    const int32_t *v = triangles->vertex[site->triangle];
    for (int k = 0; k < 2; k++)
        out[k] = site->weight[0] * values[v[0]][k] + site->weight[1] * values[v[1]][k] + site->weight[2] * values[v[2]][k];
}

ss_location ss_site_location(const ss_triangles *triangles, const ss_site *site, const double (*uv)[2]) {
    ss_location location = {triangles->face[site->triangle], 0, {0, 0}};
    location.triangle = site->triangle - triangles->first_triangle[location.face];
    ss_site_blend(triangles, site, uv, location.uv);
    return location;
}

ss_site ss_location_site(const ss_triangles *triangles, const ss_location *location, const double (*uv)[2]) {
    ss_site site = {triangles->first_triangle[location->face] + location->triangle, {0, 0, 0}};
    ss_linear_weights(&triangles->patch->faces, uv, location, site.weight);
    return site;
}

void ss_site_place(const ss_posed *pose, const ss_site *site, double out[3]) {
    const int32_t *v = pose->triangles->vertex[site->triangle];
    int corner = ss_site_corner(site);
    const double *from = pose->point[v[corner < 0 ? 0 : corner]];
    for (int k = 0; k < 3; k++)
        out[k] = from[k];
    if (corner >= 0)
        return;
    ss_add(site->weight[1], pose->facet[site->triangle].first, out);
    ss_add(site->weight[2], pose->facet[site->triangle].second, out);
}

/* ---- Setting out: a step as rates of the weights ---- */

/* How fast the weights change along a vector, which is projected into the plane of the triangle. */
static void rates_along(const ss_facet *facet, const double vector[3], double rates[3]) {
    double first = ss_dot(facet->first, vector), second = ss_dot(facet->second, vector);
    rates[1] = facet->gram[0] * first + facet->gram[1] * second;
    rates[2] = facet->gram[1] * first + facet->gram[2] * second;
    rates[0] = -rates[1] - rates[2];
}

static void vector_of(const ss_facet *facet, const double rates[3], double vector[3]) {
    for (int k = 0; k < 3; k++)
        vector[k] = rates[1] * facet->first[k] + rates[2] * facet->second[k];
}

/* Solves step = a p + b q; false where p and q turn right or make no angle. */
static bool split(const double p[3], const double q[3], const double step[3], double out[2]) {
    double area = p[0] * q[1] - p[1] * q[0];
    out[0] = (step[0] * q[1] - step[1] * q[0]) / area;
    out[1] = (p[0] * step[1] - p[1] * step[0]) / area;
    return area > 0 && isfinite(out[0]) && isfinite(out[1]);
}

/* From a vertex: into the triangle that the step points into; where none is, the one that it nearly does. */
static void leave_vertex(const ss_posed *plane, ss_site *site, const double step[3], double rates[3]) {
    const ss_triangles *triangles = plane->triangles;
    int32_t vertex = triangles->vertex[site->triangle][ss_site_corner(site)], first = triangles->vertex_triangle[vertex],
            t = first;
    double best = -INFINITY;
    do {
        const int32_t *v = triangles->vertex[t];
        int k = ss_triangle_corner(triangles, t, vertex), next = (k + 1) % 3, last = (k + 2) % 3;
        double p[3], q[3], along[2];
        ss_subtract(plane->point[v[next]], plane->point[vertex], p);
        ss_subtract(plane->point[v[last]], plane->point[vertex], q);
        if (split(p, q, step, along) && fmin(along[0], along[1]) > best) {
            best = fmin(along[0], along[1]);
            *site = (ss_site){t, {k == 0, k == 1, k == 2}};
            rates[next] = fmax(along[0], 0), rates[last] = fmax(along[1], 0), rates[k] = -rates[next] - rates[last];
        }
        t = triangles->neighbour[t][last];
    } while (best < 0 && t >= 0 && t != first);
}

static void leave(const ss_posed *plane, ss_site *site, const double step[3], double rates[3]) {
    rates[0] = rates[1] = rates[2] = 0;
    if (ss_site_corner(site) >= 0)
        leave_vertex(plane, site, step, rates);
    else
        rates_along(&plane->facet[site->triangle], step, rates);
}

/* ---- Walking ---- */

/* The part of the rates that can be gone before a weight is 0: 1 where none gets there; *corner is the weight. */
static double reach(const ss_site *site, const double rates[3], int *corner) {
    double most = 1;
    *corner = -1;
    for (int k = 0; k < 3; k++)
        if (rates[k] < 0 && site->weight[k] < -rates[k] * most) {
            most = site->weight[k] / -rates[k];
            *corner = k;
        }
    return most;
}

static void advance(ss_site *site, double rates[3], double part, int corner) {
    double second = fmin(1, fmax(0, site->weight[1] + part * rates[1]));
    double third = fmin(1, fmax(0, site->weight[2] + part * rates[2])), sum = second + third;
    second = corner == 1 ? 0 : second, third = corner == 2 ? 0 : third;
    if (corner == 0 || second + third > 1)
        second /= sum, third = 1 - second;
    *site = (ss_site){site->triangle, {corner == 0 ? 0 : 1 - second - third, second, third}};
    for (int k = 0; k < 3; k++)
        rates[k] *= 1 - part;
}

/* Over the side opposite a corner into the next triangle, at the same angle to it. */
static void cross_side(const ss_posed *pose, ss_site *site, int corner, double rates[3]) {
    const ss_triangles *triangles = pose->triangles;
    int32_t here = site->triangle, there = triangles->neighbour[here][(corner + 1) % 3];
    int32_t a = triangles->vertex[here][(corner + 1) % 3], b = triangles->vertex[here][(corner + 2) % 3];
    double side[3], out[3], in[3], vector[3], weights[2] = {site->weight[(corner + 1) % 3], site->weight[(corner + 2) % 3]};
    ss_subtract(pose->point[b], pose->point[a], side);
    ss_normalise(side);
    ss_cross(side, pose->facet[here].normal, out);
    ss_cross(side, pose->facet[there].normal, in);
    vector_of(&pose->facet[here], rates, vector);
    double along = ss_dot(vector, side), over = ss_dot(vector, out);
    for (int k = 0; k < 3; k++)
        vector[k] = along * side[k] + over * in[k];
    rates_along(&pose->facet[there], vector, rates);
    site->triangle = there;
    for (int k = 0; k < 3; k++) {
        int32_t v = triangles->vertex[there][k];
        site->weight[k] = v == a ? weights[0] : v == b ? weights[1] : 0;
    }
}

/* What a walk is measured with: the way in another pose, and how far it may go there. */
typedef struct ss_meter {
    const ss_posed *pose;
    double walked, limit;
} ss_meter;

/* How much of a part of the rates the limit allows; adds its length. */
static double measure(ss_meter *meter, int32_t triangle, const double rates[3], double part) {
    double vector[3];
    vector_of(&meter->pose->facet[triangle], rates, vector);
    double length = part * ss_length(vector), allowed = meter->limit - meter->walked;
    bool too_far = length > allowed;
    meter->walked += too_far ? allowed : length;
    return too_far ? part * (allowed / length) : part;
}

/* One straight walk. A facet without area ends it, and so does the border. */
static void walk(const ss_posed *plane, ss_site *site, const double step[3], ss_meter *meter) {
    double rates[3];
    leave(plane, site, step, rates);
    for (int crossed = 0; crossed < MOST_CROSSED; crossed++) {
        int corner;
        double whole = reach(site, rates, &corner), part = meter ? measure(meter, site->triangle, rates, whole) : whole;
        advance(site, rates, part, part < whole ? -1 : corner);
        if (corner < 0 || part < whole)
            return;
        int32_t there = plane->triangles->neighbour[site->triangle][(corner + 1) % 3];
        if (there < 0 || !plane->facet[there].has_area)
            return;
        cross_side(plane, site, corner, rates);
    }
}

static void step_to(const ss_posed *plane, const ss_site *site, const double uv[2], double step[3]) {
    double here[3];
    ss_site_place(plane, site, here);
    step[0] = uv[0] - here[0], step[1] = uv[1] - here[1], step[2] = 0;
}

void ss_site_walk(const ss_posed *plane, ss_site *site, const double uv[2]) {
    double step[3];
    step_to(plane, site, uv, step);
    walk(plane, site, step, NULL);
}

double ss_site_trace(const ss_posed *plane, const ss_posed *pose, ss_site *site, const double uv[2], double limit) {
    double step[3];
    ss_meter meter = {pose, 0, limit};
    step_to(plane, site, uv, step);
    walk(plane, site, step, &meter);
    return meter.walked;
}

/* ---- Along the border ---- */

/* The border side that the site is on, up to rounding: at a vertex the one that leaves it. */
static int border_side(const ss_triangles *triangles, const ss_site *site) {
    int nearest = 0;
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        double off = site->weight[(k + 2) % 3];
        if (triangles->neighbour[site->triangle][k] < 0 && site->weight[k] > 0 && off < least)
            nearest = k, least = off;
    }
    return nearest;
}

static double side_vector(const ss_posed *pose, int32_t triangle, int side, double out[3]) {
    const int32_t *v = pose->triangles->vertex[triangle];
    ss_subtract(pose->point[v[(side + 1) % 3]], pose->point[v[side]], out);
    return sqrt(ss_dot(out, out));
}

/* The border side that ends where one begins. */
static void side_before(const ss_triangles *triangles, int32_t *triangle, int *side) {
    int32_t vertex = triangles->vertex[*triangle][*side], t = *triangle;
    int incoming = (*side + 2) % 3;
    while (triangles->neighbour[t][incoming] >= 0) {
        t = triangles->neighbour[t][incoming];
        incoming = (ss_triangle_corner(triangles, t, vertex) + 2) % 3;
    }
    *triangle = t, *side = incoming;
}

static void side_after(const ss_triangles *triangles, int32_t *triangle, int *side) {
    int32_t vertex = triangles->vertex[*triangle][(*side + 1) % 3];
    *triangle = triangles->vertex_triangle[vertex];
    *side = ss_triangle_corner(triangles, *triangle, vertex);
}

void ss_site_border(const ss_posed *pose, const ss_site *site, double out[3]) {
    int side = border_side(pose->triangles, site);
    side_vector(pose, site->triangle, side, out);
    ss_normalise(out);
    if (site->weight[side] != 1)
        return;
    int32_t triangle = site->triangle;
    double before[3];
    side_before(pose->triangles, &triangle, &side);
    side_vector(pose, triangle, side, before);
    ss_normalise(before);
    for (int k = 0; k < 3; k++)
        out[k] += before[k];
    ss_normalise(out);
}

void ss_site_walk_border(const ss_posed *pose, ss_site *site, double distance) {
    const ss_triangles *triangles = pose->triangles;
    int32_t triangle = site->triangle;
    int side = border_side(triangles, site);
    double vector[3], length = side_vector(pose, triangle, side, vector);
    double along = site->weight[(side + 1) % 3] * length + distance;
    for (int walked = 0; along < 0 && walked < 1000; walked++) {
        side_before(triangles, &triangle, &side);
        along += length = side_vector(pose, triangle, side, vector);
    }
    for (int walked = 0; along >= length && walked < 1000; walked++) {
        along -= length;
        side_after(triangles, &triangle, &side);
        length = side_vector(pose, triangle, side, vector);
    }
    double share = length > 0 ? fmin(1, fmax(0, along / length)) : 0;
    *site = (ss_site){triangle, {0, 0, 0}};
    site->weight[side] = 1 - share;
    site->weight[(side + 1) % 3] = share;
}

double ss_site_border_distance(const ss_posed *pose, int32_t vertex, const ss_site *site) {
    const ss_triangles *triangles = pose->triangles;
    int32_t triangle = triangles->vertex_triangle[vertex];
    int side = ss_triangle_corner(triangles, triangle, vertex), goal = border_side(triangles, site);
    double walked = 0, there = 0, vector[3];
    do {
        double length = side_vector(pose, triangle, side, vector);
        if (triangle == site->triangle && side == goal)
            there = walked + site->weight[(side + 1) % 3] * length;
        walked += length;
        side_after(triangles, &triangle, &side);
    } while (triangles->vertex[triangle][side] != vertex);
    return there <= walked / 2 ? there : there - walked;
}
