/* Walks over a surface in a direction that depends on the place alone, so that where a walk ends does not jump as the way there
 * comes to pass on the other side of a vertex. The direction is a vector tangent where the walk sets out, a vertex most often, at
 * each place turned by the least rotation that takes the normal there to the blended normal here, then carried along that
 * normal into the plane of the triangle and given the length that is left of the walk. A walk ends at the border. */
#include "surface.h"

#define MOST_CROSSED     1000
#define MOST_TURNED_BACK 100
#define LEAST_SLANT      0.1  /* cosine between the normals of place and triangle, that carrying takes for less */
#define LEAST_TURN       1e-3 /* 1 + cosine of a turn; none is least about half a circle */

typedef struct walker {
    const ss_ground *ground;
    const double *up;      /* normal where it set out */
    double heading[3];     /* unit, tangent there */
    double left;           /* of its length */
    double rates[3];       /* of the weights of its place, to its end */
    int came, turned_back; /* corner opposite the side that it came over, or -1; how often the direction led back over one */
} walker;

/* Turns the heading to a unit normal; false where that is nearly opposite. */
static bool turn(const walker *w, const double normal[3], double out[3]) {
    double whole = 1 + ss_dot(w->up, normal), share = ss_dot(normal, w->heading) / whole;
    for (int k = 0; k < 3; k++)
        out[k] = w->heading[k] - share * (w->up[k] + normal[k]);
    return whole > LEAST_TURN;
}

/* Sets the rates in a triangle for a direction tangent at a unit normal; false where it has none there. */
static bool aim(walker *w, const ss_facet *facet, const double normal[3], const double direction[3]) {
    double along[3] = {direction[0], direction[1], direction[2]};
    ss_add(-ss_dot(direction, facet->normal) / fmax(ss_dot(normal, facet->normal), LEAST_SLANT), normal, along);
    ss_add(-ss_dot(along, facet->normal), facet->normal, along);
    double length = ss_length(along);
    if (!(length > 0))
        return false;
    for (int k = 0; k < 3; k++)
        along[k] *= w->left / length;
    ss_rates_along(facet, along, w->rates);
    return isfinite(w->rates[1]) && isfinite(w->rates[2]);
}

/* ---- From the vertex ---- */

/* How far inside the wedge of a triangle at its corner k the heading points, seen along the normal: less than 0 outside; the
 * least of numbers where the wedge has no area. */
static double inside_wedge(const walker *w, int32_t triangle, int k) {
    const ss_posed *pose = &w->ground->pose;
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    double p[3], q[3], product[3];
    ss_subtract(pose->point[v[(k + 1) % 3]], pose->point[v[k]], p);
    ss_subtract(pose->point[v[(k + 2) % 3]], pose->point[v[k]], q);
    ss_cross(p, q, product);
    double area = ss_dot(product, w->up);
    ss_cross(w->heading, q, product);
    double first = ss_dot(product, w->up) / area;
    ss_cross(p, w->heading, product);
    double second = ss_dot(product, w->up) / area;
    bool sees = area > 0 && isfinite(first) && isfinite(second) && pose->facet[triangle].has_area;
    return sees ? fmin(first, second) : -INFINITY;
}

/* Puts the place at the vertex into the first triangle whose wedge the heading is in; else into the one it is nearest to. */
static bool choose_triangle(const walker *w, int32_t vertex, ss_place *place) {
    const ss_triangles *triangles = &w->ground->pose.patch->triangles;
    int32_t first = triangles->vertex_triangle[vertex], t = first;
    double best = -INFINITY;
    do {
        int k = ss_triangle_corner(w->ground->pose.patch, t, vertex);
        double inside = inside_wedge(w, t, k);
        if (inside > best) {
            best = inside;
            ss_place_put(place, t, (double[3]){k == 0, k == 1, k == 2});
        }
        t = triangles->neighbour[t][(k + 2) % 3];
    } while (best < 0 && t >= 0 && t != first);
    return best > -INFINITY;
}

static bool set_out(walker *w, int32_t vertex, ss_place *place) {
    if (!choose_triangle(w, vertex, place) || !aim(w, &w->ground->pose.facet[place->triangle], w->up, w->heading))
        return false;
    int k = ss_place_corner(place), next = (k + 1) % 3, last = (k + 2) % 3;
    w->rates[next] = fmax(w->rates[next], 0), w->rates[last] = fmax(w->rates[last], 0);
    w->rates[k] = -w->rates[next] - w->rates[last];
    return true;
}

/* ---- Over sides ---- */

/* Where the direction leads back over the side that the walk came over: along that side. */
static bool go_along_side(walker *w, int32_t triangle) {
    const ss_posed *pose = &w->ground->pose;
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    int from = (w->came + 1) % 3, to = (w->came + 2) % 3;
    double side[3], way[3];
    ss_subtract(pose->point[v[to]], pose->point[v[from]], side);
    ss_vector_along(&pose->facet[triangle], w->rates, way);
    w->rates[to] = ss_dot(way, side) / ss_dot(side, side);
    w->rates[from] = -w->rates[to], w->rates[w->came] = 0;
    return ++w->turned_back <= MOST_TURNED_BACK && isfinite(w->rates[to]);
}

/* Over the side opposite a corner; false where the walk ends there. */
static bool go_over(walker *w, ss_place *place, int corner) {
    const ss_posed *pose = &w->ground->pose;
    int32_t there = pose->patch->triangles.neighbour[place->triangle][(corner + 1) % 3];
    double normal[3], direction[3];
    if (there < 0 || !pose->facet[there].has_area)
        return false;
    w->came = ss_cross_side(pose->patch, place, corner);
    ss_ground_normal(w->ground, place, normal);
    if (!turn(w, normal, direction) || !aim(w, &pose->facet[there], normal, direction))
        return false;
    return w->rates[w->came] >= 0 || go_along_side(w, there);
}

/* To the end. */
static void walk(walker *w, ss_meter *meter, ss_place *place) {
    for (int crossed = 0; crossed < MOST_CROSSED; crossed++) {
        int corner;
        double whole = ss_reach(place, w->rates, w->came, &corner);
        double part = meter ? ss_measure(meter, place->triangle, w->rates, whole) : whole;
        ss_advance(place, w->rates, part, part < whole ? -1 : corner);
        place->weight[0] = fmax(0, place->weight[0]); /* which is what rounding leaves of 1 */
        w->left *= 1 - part;
        if (corner < 0 || part < whole || !go_over(w, place, corner))
            break;
    }
}

double ss_walk_turned(const ss_ground *ground, int32_t vertex, const double way[3], ss_meter *meter, ss_place *place) {
    double length = ss_length(way);
    walker w = {.ground = ground, .up = ground->normal[vertex], .left = length, .came = -1};
    *place = ss_place_of_vertex(ground->pose.patch, NULL, vertex);
    if (!(length > 0))
        return 1;
    for (int k = 0; k < 3; k++)
        w.heading[k] = way[k] / length;
    if (!set_out(&w, vertex, place))
        return 0;
    walk(&w, meter, place);
    return 1 - w.left / length;
}

void ss_walk_turned_from(const ss_ground *ground, const double way[3], ss_place *place) {
    double up[3];
    walker w = {.ground = ground, .up = up, .heading = {way[0], way[1], way[2]}, .came = -1};
    ss_ground_normal(ground, place, up);
    ss_add(-ss_dot(way, up), up, w.heading);
    w.left = ss_length(w.heading);
    ss_normalise(w.heading);
    if (w.left > 0 && aim(&w, &ground->pose.facet[place->triangle], up, w.heading))
        walk(&w, NULL, place);
}
