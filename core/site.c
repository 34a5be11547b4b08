/* Sites: points that slide on the surface.
 *
 * A walk is straight: where it crosses a side it goes on in the next triangle at the same angle to that side, as if the two
 * were unfolded flat. At the border of the patch what is left of it goes along the border. So a site never leaves the surface.
 *
 * In the round manner a site's place is on the rounded surface (Phong tessellation; Boubekeur and Alexa 2008), its normal is
 * blended from those of the vertices, and a step ends where the surface is met along the normal there (Phong projection;
 * Panozzo and others 2013). All three go on continuously from triangle to triangle, so that a slide is smooth in time. */
#include "site.h"

#define MOST_CROSSED   1000
#define MOST_CORRECTED 4

ss_site ss_site_of_vertex(const ss_surface *surface, int32_t vertex) {
    ss_site site = {surface->vertex_triangle[vertex], {0, 0, 0}};
    for (int k = 0; k < 3; k++)
        site.weight[k] = surface->vertex[site.triangle][k] == vertex;
    return site;
}

int ss_site_corner(const ss_site *site) {
    for (int k = 0; k < 3; k++)
        if (site->weight[k] == 1)
            return k;
    return -1;
}

void ss_site_blend(const ss_surface *surface, const ss_site *site, const double (*values)[2], double out[2]) {
    const int32_t *v = surface->vertex[site->triangle];
    for (int k = 0; k < 2; k++)
        out[k] = site->weight[0] * values[v[0]][k] + site->weight[1] * values[v[1]][k] + site->weight[2] * values[v[2]][k];
}

ss_location ss_site_location(const ss_surface *surface, const ss_site *site, const double (*uv)[2]) {
    ss_location location = {surface->face[site->triangle], 0, {0, 0}};
    location.triangle = site->triangle - surface->first_triangle[location.face];
    ss_site_blend(surface, site, uv, location.uv);
    return location;
}

ss_site ss_location_site(const ss_surface *surface, const ss_location *location, const double (*uv)[2]) {
    ss_site site = {surface->first_triangle[location->face] + location->triangle, {0, 0, 0}};
    ss_linear_weights(&surface->patch->faces, uv, location, site.weight);
    return site;
}

static void flat_place(const ss_shape *pose, const ss_site *site, double out[3]) {
    const int32_t *v = pose->surface->vertex[site->triangle];
    int corner = ss_site_corner(site);
    const double *from = pose->point[v[corner < 0 ? 0 : corner]];
    for (int k = 0; k < 3; k++)
        out[k] = from[k];
    if (corner >= 0)
        return;
    ss_add(site->weight[1], pose->facet[site->triangle].first, out);
    ss_add(site->weight[2], pose->facet[site->triangle].second, out);
}

/* Halfway from the flat place to where its projections on the tangent planes of the three vertices average. */
void ss_site_place(const ss_shape *pose, const ss_site *site, double out[3]) {
    const int32_t *v = pose->surface->vertex[site->triangle];
    double flat[3], from[3];
    flat_place(pose, site, flat);
    for (int k = 0; k < 3; k++)
        out[k] = flat[k];
    for (int j = 0; j < 3 && pose->manner == SS_ROUND; j++) {
        ss_subtract(flat, pose->point[v[j]], from);
        ss_add(-0.5 * site->weight[j] * ss_dot(from, pose->normal[v[j]]), pose->normal[v[j]], out);
    }
}

/* How the place moves with the second and third weight, in the round manner. */
static void round_tangents(const ss_shape *pose, const ss_site *site, double first[3], double second[3]) {
    const int32_t *v = pose->surface->vertex[site->triangle];
    const ss_facet *facet = &pose->facet[site->triangle];
    double flat[3], from[3];
    flat_place(pose, site, flat);
    for (int k = 0; k < 3; k++)
        first[k] = facet->first[k], second[k] = facet->second[k];
    for (int j = 0; j < 3; j++) {
        const double *normal = pose->normal[v[j]];
        ss_subtract(flat, pose->point[v[j]], from);
        double height = ss_dot(from, normal);
        ss_add(-0.5 * (site->weight[j] * ss_dot(facet->first, normal) + ((j == 1) - (j == 0)) * height), normal, first);
        ss_add(-0.5 * (site->weight[j] * ss_dot(facet->second, normal) + ((j == 2) - (j == 0)) * height), normal, second);
    }
}

void ss_site_normal(const ss_shape *pose, ss_manner manner, const ss_site *site, double out[3]) {
    const int32_t *v = pose->surface->vertex[site->triangle];
    const double(*normal)[3] = (const double(*)[3])(manner == SS_BLUNT ? pose->blunt_normal : pose->normal);
    bool faceted = manner == SS_FLAT && ss_site_corner(site) < 0;
    out[0] = out[1] = out[2] = 0;
    if (faceted)
        ss_add(1, pose->facet[site->triangle].normal, out);
    for (int j = 0; j < 3 && !faceted; j++)
        ss_add(site->weight[j], normal[v[j]], out);
    ss_normalise(out);
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

static void scale_to(const ss_facet *facet, double length, double rates[3]) {
    double vector[3];
    vector_of(facet, rates, vector);
    double now = ss_length(vector), factor = now > 0 ? length / now : 0;
    for (int k = 0; k < 3; k++)
        rates[k] *= factor;
}

/* Solves step = a p + b q as seen along a normal; false where p and q turn right or make no angle. */
static bool split_along(const double normal[3], const double p[3], const double q[3], const double step[3], double out[2]) {
    double product[3];
    ss_cross(p, q, product);
    double area = ss_dot(normal, product);
    ss_cross(step, q, product);
    out[0] = ss_dot(normal, product) / area;
    ss_cross(p, step, product);
    out[1] = ss_dot(normal, product) / area;
    return area > 0 && isfinite(out[0]) && isfinite(out[1]);
}

/* From a vertex, round manner: into the triangle that the step points into as seen along the normal; where none is, the one
 * that it nearly does. */
static void leave_round_vertex(const ss_shape *pose, ss_site *site, const double step[3], double rates[3]) {
    const ss_surface *surface = pose->surface;
    int32_t vertex = surface->vertex[site->triangle][ss_site_corner(site)], first = surface->vertex_triangle[vertex], t = first;
    double best = -INFINITY;
    do {
        const int32_t *v = surface->vertex[t];
        int k = ss_triangle_corner(surface, t, vertex), next = (k + 1) % 3, last = (k + 2) % 3;
        double p[3], q[3], along[2];
        ss_subtract(pose->point[v[next]], pose->point[vertex], p);
        ss_subtract(pose->point[v[last]], pose->point[vertex], q);
        if (split_along(pose->normal[vertex], p, q, step, along) && fmin(along[0], along[1]) > best) {
            best = fmin(along[0], along[1]);
            *site = (ss_site){t, {k == 0, k == 1, k == 2}};
            rates[next] = fmax(along[0], 0), rates[last] = fmax(along[1], 0), rates[k] = -rates[next] - rates[last];
        }
        t = surface->neighbour[t][last];
    } while (best < 0 && t >= 0 && t != first);
}

/* The way into a triangle from its corner k that is nearest to a step, as rates. Returns how far along the step it leads. */
static double enter(const ss_shape *pose, int32_t triangle, int k, const double step[3], double rates[3]) {
    const ss_facet *facet = &pose->facet[triangle];
    const int32_t *v = pose->surface->vertex[triangle];
    int next = (k + 1) % 3, last = (k + 2) % 3;
    double vector[3], ahead[2];
    rates_along(facet, step, rates);
    if (rates[next] >= 0 && rates[last] >= 0 && facet->has_area) {
        vector_of(facet, rates, vector);
        return ss_length(vector);
    }
    for (int side = 0; side < 2; side++) {
        ss_subtract(pose->point[v[side ? last : next]], pose->point[v[k]], vector);
        ss_normalise(vector);
        ahead[side] = ss_dot(step, vector);
    }
    int side = ahead[1] > ahead[0];
    rates[0] = rates[1] = rates[2] = 0;
    rates[k] = -1, rates[side ? last : next] = 1;
    return ahead[side];
}

/* From a vertex, other manners: into the triangle round it that leads farthest along the step. */
static void leave_flat_vertex(const ss_shape *pose, ss_site *site, const double step[3], double rates[3]) {
    const ss_surface *surface = pose->surface;
    int32_t vertex = surface->vertex[site->triangle][ss_site_corner(site)], first = surface->vertex_triangle[vertex], t = first;
    double best = 0, trial[3];
    do {
        int k = ss_triangle_corner(surface, t, vertex);
        double ahead = enter(pose, t, k, step, trial);
        if (ahead > best) {
            best = ahead;
            *site = (ss_site){t, {k == 0, k == 1, k == 2}};
            rates[0] = trial[0], rates[1] = trial[1], rates[2] = trial[2];
        }
        t = surface->neighbour[t][(k + 2) % 3];
    } while (t >= 0 && t != first);
    scale_to(&pose->facet[site->triangle], pose->manner == SS_BLUNT ? ss_length(step) : best, rates);
}

static void leave(const ss_shape *pose, ss_site *site, const double step[3], double rates[3]) {
    double first[3], second[3], normal[3], along[2];
    rates[0] = rates[1] = rates[2] = 0;
    if (ss_site_corner(site) >= 0) {
        (pose->manner == SS_ROUND ? leave_round_vertex : leave_flat_vertex)(pose, site, step, rates);
        return;
    }
    if (pose->manner != SS_ROUND) {
        rates_along(&pose->facet[site->triangle], step, rates);
        if (pose->manner == SS_BLUNT)
            scale_to(&pose->facet[site->triangle], ss_length(step), rates);
        return;
    }
    round_tangents(pose, site, first, second);
    ss_site_normal(pose, SS_ROUND, site, normal);
    if (split_along(normal, first, second, step, along))
        rates[0] = -along[0] - along[1], rates[1] = along[0], rates[2] = along[1];
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
static void cross_side(const ss_shape *pose, ss_site *site, int corner, double rates[3]) {
    const ss_surface *surface = pose->surface;
    int32_t here = site->triangle, there = surface->neighbour[here][(corner + 1) % 3];
    int32_t a = surface->vertex[here][(corner + 1) % 3], b = surface->vertex[here][(corner + 2) % 3];
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
        int32_t v = surface->vertex[there][k];
        site->weight[k] = v == a ? weights[0] : v == b ? weights[1] : 0;
    }
}

/* Along the border opposite a corner, at most to its end. */
static void follow_border(const ss_shape *pose, ss_site *site, int corner, double rates[3]) {
    const int32_t *v = pose->surface->vertex[site->triangle];
    int a = (corner + 1) % 3, b = (corner + 2) % 3;
    double side[3], vector[3];
    ss_subtract(pose->point[v[b]], pose->point[v[a]], side);
    vector_of(&pose->facet[site->triangle], rates, vector);
    double square = ss_dot(side, side), share = square > 0 ? ss_dot(vector, side) / square : 0;
    site->weight[b] = fmin(1, fmax(0, site->weight[b] + share));
    site->weight[a] = 1 - site->weight[b];
    site->weight[corner] = 0;
}

/* What a walk is measured with: the way in another pose, and how far it may go there. */
typedef struct ss_meter {
    const ss_shape *pose;
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

/* One straight walk. A facet without area ends it. */
static void walk(const ss_shape *pose, ss_site *site, const double step[3], ss_meter *meter) {
    double rates[3];
    leave(pose, site, step, rates);
    for (int crossed = 0; crossed < MOST_CROSSED; crossed++) {
        int corner;
        double whole = reach(site, rates, &corner), part = meter ? measure(meter, site->triangle, rates, whole) : whole;
        corner = part < whole ? -1 : corner;
        advance(site, rates, part, corner);
        if (corner < 0)
            return;
        int32_t there = pose->surface->neighbour[site->triangle][(corner + 1) % 3];
        if (there < 0 && !meter)
            follow_border(pose, site, corner, rates);
        if (there < 0 || !pose->facet[there].has_area)
            return;
        cross_side(pose, site, corner, rates);
    }
}

/* Where the surface is met along its normal from the end of the step: found by walking again for what the walk before has missed
 * by the curvature, until that is nothing to the step. */
void ss_site_walk(const ss_shape *pose, ss_site *site, const double step[3]) {
    double target[3], here[3], missing[3], normal[3];
    ss_site_place(pose, site, target);
    ss_add(1, step, target);
    walk(pose, site, step, NULL);
    for (int again = 0; again < MOST_CORRECTED && pose->manner == SS_ROUND; again++) {
        ss_site_place(pose, site, here);
        ss_subtract(target, here, missing);
        ss_site_normal(pose, SS_ROUND, site, normal);
        ss_add(-ss_dot(missing, normal), normal, missing);
        if (ss_dot(missing, missing) <= 1e-8 * ss_dot(step, step))
            return;
        walk(pose, site, missing, NULL);
    }
}

double ss_site_trace(const ss_shape *plane, const ss_shape *pose, ss_site *site, const double uv[2], double limit) {
    double step[3] = {0, 0, 0}, here[3];
    ss_meter meter = {pose, 0, limit};
    ss_site_place(plane, site, here);
    step[0] = uv[0] - here[0], step[1] = uv[1] - here[1];
    walk(plane, site, step, &meter);
    return meter.walked;
}

/* ---- Along the border ---- */

/* The border side that the site is on, up to rounding: at a vertex the one that leaves it. */
static int border_side(const ss_surface *surface, const ss_site *site) {
    int nearest = 0;
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        double off = site->weight[(k + 2) % 3];
        if (surface->neighbour[site->triangle][k] < 0 && site->weight[k] > 0 && off < least)
            nearest = k, least = off;
    }
    return nearest;
}

static double side_vector(const ss_shape *pose, int32_t triangle, int side, double out[3]) {
    const int32_t *v = pose->surface->vertex[triangle];
    ss_subtract(pose->point[v[(side + 1) % 3]], pose->point[v[side]], out);
    return sqrt(ss_dot(out, out));
}

/* The border side that ends where one begins. */
static void side_before(const ss_surface *surface, int32_t *triangle, int *side) {
    int32_t vertex = surface->vertex[*triangle][*side], t = *triangle;
    int incoming = (*side + 2) % 3;
    while (surface->neighbour[t][incoming] >= 0) {
        t = surface->neighbour[t][incoming];
        incoming = (ss_triangle_corner(surface, t, vertex) + 2) % 3;
    }
    *triangle = t, *side = incoming;
}

static void side_after(const ss_surface *surface, int32_t *triangle, int *side) {
    int32_t vertex = surface->vertex[*triangle][(*side + 1) % 3];
    *triangle = surface->vertex_triangle[vertex];
    *side = ss_triangle_corner(surface, *triangle, vertex);
}

void ss_site_border(const ss_shape *pose, const ss_site *site, double out[3]) {
    int side = border_side(pose->surface, site);
    side_vector(pose, site->triangle, side, out);
    ss_normalise(out);
    if (site->weight[side] != 1)
        return;
    int32_t triangle = site->triangle;
    double before[3];
    side_before(pose->surface, &triangle, &side);
    side_vector(pose, triangle, side, before);
    ss_normalise(before);
    for (int k = 0; k < 3; k++)
        out[k] += before[k];
    ss_normalise(out);
}

void ss_site_walk_border(const ss_shape *pose, ss_site *site, double distance) {
    const ss_surface *surface = pose->surface;
    int32_t triangle = site->triangle;
    int side = border_side(surface, site);
    double vector[3], length = side_vector(pose, triangle, side, vector);
    double along = site->weight[(side + 1) % 3] * length + distance;
    for (int walked = 0; along < 0 && walked < 1000; walked++) {
        side_before(surface, &triangle, &side);
        along += length = side_vector(pose, triangle, side, vector);
    }
    for (int walked = 0; along >= length && walked < 1000; walked++) {
        along -= length;
        side_after(surface, &triangle, &side);
        length = side_vector(pose, triangle, side, vector);
    }
    double share = length > 0 ? fmin(1, fmax(0, along / length)) : 0;
    *site = (ss_site){triangle, {0, 0, 0}};
    site->weight[side] = 1 - share;
    site->weight[(side + 1) % 3] = share;
}

double ss_site_border_distance(const ss_shape *pose, int32_t vertex, const ss_site *site) {
    const ss_surface *surface = pose->surface;
    int32_t triangle = surface->vertex_triangle[vertex];
    int side = ss_triangle_corner(surface, triangle, vertex), goal = border_side(surface, site);
    double walked = 0, there = 0, vector[3];
    do {
        double length = side_vector(pose, triangle, side, vector);
        if (triangle == site->triangle && side == goal)
            there = walked + site->weight[(side + 1) % 3] * length;
        walked += length;
        side_after(surface, &triangle, &side);
    } while (surface->vertex[triangle][side] != vertex);
    return there <= walked / 2 ? there : there - walked;
}
