/* Walks over a surface in a direction that depends only on the place, so that the end of a walk does not jump when its way
 * comes to pass a vertex on the other side. The walk begins, mostly at a vertex, with a tangent vector. At each place this is
 * turned by the least rotation from the normal where the walk began to the blended normal here, projected along that normal
 * into the plane of the triangle, and given the length that is left of the walk. A walk ends at the border. */
#include "surface.h"

#define MOST_CROSSED     1000
#define MOST_TURNED_BACK 100
#define LEAST_SLANT      0.1 /* of the cosine between the normals of place and triangle, by which projecting divides */

enum { WALKERS = 32 }; /* walks that take their steps in turn */

typedef struct walker {
    const ss_ground *ground;
    const double *up;      /* normal where it began */
    double heading[3];     /* unit, tangent there */
    double left, whole;    /* of its length; and the whole length */
    double rates[3];       /* of the weights of its place, for what is left */
    int came, turned_back; /* corner opposite the side that it came over, or -1; how often the direction led back */
} walker;

/* Sets the rates in a triangle, from the blended normal at the place, of any length. False if there is no direction. The
 * heading turned is heading - turn (up + n); its part along n is left to carry, which projecting along n removes anyway. */
static inline bool aim(walker *w, int32_t triangle, const double blended[3]) {
    const ss_facet *facet = &w->ground->pose.facet[triangle];
    double length = ss_length(blended), share = length > 0 ? 1 / length : 0; /* n = share blended */
    double whole = 1 + share * ss_dot(w->up, blended), turn = share * ss_dot(blended, w->heading) / whole;
    double slant = share * ss_dot(blended, facet->normal), along[3] = {w->heading[0], w->heading[1], w->heading[2]};
    ss_add(-turn, w->up, along);
    double carry = turn + (ss_dot(along, facet->normal) - turn * slant) / ss_most(slant, LEAST_SLANT);
    ss_add(-carry * share, blended, along);
    double scale = w->left / ss_rates_along(&w->ground->pose, triangle, along, w->rates);
    for (int k = 0; k < 3; k++)
        w->rates[k] *= scale;
    return whole > SS_LEAST_TURN && isfinite(w->rates[1]) && isfinite(w->rates[2]);
}

/* ---- From the vertex ---- */

/* The shares of a way along the sides of a wedge. Returns the smaller one. */
static inline double share_way(const ss_wedge *wedge, const double way[2], double rates[2]) {
    rates[0] = wedge->first[0] * way[0] + wedge->first[1] * way[1];
    rates[1] = wedge->second[0] * way[0] + wedge->second[1] * way[1];
    return ss_least(rates[0], rates[1]);
}

/* The wedge nearest to a way that is in none, or NULL. */
static const ss_wedge *nearest_wedge(const ss_wedge *wedges, int32_t count, const double way[2], double rates[2]) {
    const ss_wedge *chosen = NULL;
    double best = -INFINITY, own[2];
    for (int32_t i = 0; i < count; i++) {
        double least = share_way(&wedges[i], way, own);
        if (least > best)
            best = least, chosen = &wedges[i], rates[0] = own[0], rates[1] = own[1];
    }
    return chosen;
}

/* The first wedge that the way is in; else the nearest, or NULL. */
static inline const ss_wedge *choose_wedge(const ss_ground *ground, int32_t vertex, const double way[2], double rates[2]) {
    const ss_wedge *wedges = ground->wedges + ground->wedge_start[vertex];
    int32_t count = ground->wedge_start[vertex + 1] - ground->wedge_start[vertex];
    for (int32_t i = 0; i < count; i++)
        if (share_way(&wedges[i], way, rates) >= 0)
            return &wedges[i];
    return nearest_wedge(wedges, count, way, rates);
}

/* Scales shares of a way as seen along the normal so that the way keeps its length in the triangle, where it is slanted. square
 * is that length squared. */
static inline void scale_shares(const ss_wedge *wedge, const double way[2], double square, double rates[2]) {
    double rise = wedge->lean[0] * way[0] + wedge->lean[1] * way[1], scale = sqrt(square / (square + rise * rise));
    rates[0] = ss_most(scale * rates[0], 0), rates[1] = ss_most(scale * rates[1], 0);
}

/* The end of a walk that does not leave its first triangle. */
static void end_at_once(const ss_wedge *wedge, const double rates[2], ss_place *place) {
    double weight[3];
    int k = (int)(wedge->corner & 3);
    weight[k] = 1 - (rates[0] + rates[1]);
    weight[k == 2 ? 0 : k + 1] = rates[0], weight[k == 0 ? 2 : k - 1] = rates[1];
    double sum = weight[1] + weight[2];
    if (sum > 1)
        weight[1] /= sum, weight[2] = 1 - weight[1];
    weight[0] = ss_most(1 - weight[1] - weight[2], 0);
    ss_place_put(place, (int32_t)(wedge->corner >> 2), weight);
}

static void aim_in_wedge(const ss_wedge *wedge, const double rates[2], walker *w, ss_place *place) {
    int k = (int)(wedge->corner & 3), next = (k + 1) % 3, last = (k + 2) % 3;
    w->rates[next] = rates[0], w->rates[last] = rates[1], w->rates[k] = -rates[0] - rates[1];
    ss_place_put(place, (int32_t)(wedge->corner >> 2), (double[3]){k == 0, k == 1, k == 2});
}

/* ---- Over sides ---- */

/* If the direction leads back over the side that the walk came over, goes along that side. False if the walk ends. */
static bool go_along_side(walker *w, int32_t triangle) {
    const ss_posed *pose = &w->ground->pose;
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    int from = (w->came + 1) % 3, to = (w->came + 2) % 3;
    double side[3], way[3];
    ss_subtract(pose->point[v[to]], pose->point[v[from]], side);
    ss_vector_along(pose, triangle, w->rates, way);
    w->rates[to] = ss_dot(way, side) / ss_dot(side, side);
    w->rates[from] = -w->rates[to], w->rates[w->came] = 0;
    return ++w->turned_back <= MOST_TURNED_BACK && isfinite(w->rates[to]);
}

/* Goes over the side opposite a corner. False if the walk ends there. */
static inline bool go_over(walker *w, ss_place *place, int corner) {
    const ss_posed *pose = &w->ground->pose;
    int32_t there = pose->patch->triangles.neighbour[place->triangle][(corner + 1) % 3];
    double blended[3];
    if (there < 0 || !ss_has_area(&pose->facet[there]))
        return false;
    w->came = ss_cross_side(pose->patch, place, corner);
    ss_ground_blend(w->ground, place, blended);
    return aim(w, there, blended) && (w->rates[w->came] >= 0 || go_along_side(w, there));
}

/* Goes to the end of the walk, or over a side. False if it has ended. */
static inline bool go_on(walker *w, ss_meter *meter, ss_place *place) {
    int corner;
    double whole = ss_reach(place, w->rates, w->came, &corner);
    double part = meter ? ss_measure(meter, place->triangle, w->rates, whole) : whole;
    ss_advance(place, w->rates, part, part < whole ? -1 : corner);
    place->weight[0] = ss_most(place->weight[0], 0); /* which is 1 - the others, rounded */
    w->left *= 1 - part;
    return corner >= 0 && part >= whole && go_over(w, place, corner);
}

static void walk(walker *w, ss_meter *meter, ss_place *place) {
    for (int crossed = 0; crossed < MOST_CROSSED && go_on(w, meter, place); crossed++)
        ;
}

/* ---- From the first triangle on ---- */

/* Begins a walk. False if it has ended at once, after *part of it. */
static bool set_out(const ss_ground *ground, int32_t vertex, const double way[2], const ss_meter *meter, walker *w,
                    ss_place *place, double *part) {
    double square = way[0] * way[0] + way[1] * way[1], rates[2];
    const ss_wedge *wedge = square > 0 ? choose_wedge(ground, vertex, way, rates) : NULL;
    if (!wedge) {
        *place = ss_place_of_vertex(ground->pose.patch, NULL, vertex);
        *part = !(square > 0);
        return false;
    }
    scale_shares(wedge, way, square, rates);
    if (!meter && rates[0] + rates[1] <= 1) {
        end_at_once(wedge, rates, place);
        *part = 1;
        return false;
    }
    double length = sqrt(square);
    *w = (walker){.ground = ground, .up = ground->normal[vertex], .left = length, .whole = length, .came = -1};
    for (int j = 0; j < 2; j++)
        ss_add(way[j] / length, ground->tangent[vertex][j], w->heading);
    aim_in_wedge(wedge, rates, w, place);
    return true;
}

double ss_walk_turned(const ss_ground *ground, int32_t vertex, const double way[2], ss_meter *meter, ss_place *place) {
    walker w;
    double part;
    if (!set_out(ground, vertex, way, meter, &w, place, &part))
        return part;
    walk(&w, meter, place);
    return 1 - w.left / w.whole;
}

static void cut(double way[2], double part) {
    way[0] *= part, way[1] *= part;
}

/* Takes all walks to their ends, one step of each in turn. */
static void walk_in_turn(walker *w, int32_t count, const int32_t *vertices, ss_place *place) {
    int32_t going[WALKERS], left = count;
    for (int32_t i = 0; i < count; i++)
        going[i] = i;
    for (int crossed = 0; crossed < MOST_CROSSED && left > 0; crossed++) {
        int32_t turn = left;
        left = 0;
        for (int32_t i = 0; i < turn; i++) {
            going[left] = going[i];
            left += go_on(&w[going[i]], NULL, &place[vertices[going[i]]]);
        }
    }
}

void ss_walk_turned_all(const ss_ground *ground, int32_t count, const int32_t *vertices, double (*way)[2], ss_place *place) {
    walker w[WALKERS];
    int32_t from[WALKERS], walkers = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t v = vertices[i];
        double part;
        if (set_out(ground, v, way[v], NULL, &w[walkers], &place[v], &part))
            from[walkers++] = v;
        else if (part < 1)
            cut(way[v], part);
        if (walkers < WALKERS && i + 1 < count)
            continue;
        walk_in_turn(w, walkers, from, place);
        for (; walkers > 0; walkers--)
            cut(way[from[walkers - 1]], 1 - w[walkers - 1].left / w[walkers - 1].whole);
    }
}

void ss_walk_turned_from(const ss_ground *ground, const double way[3], ss_place *place) {
    double up[3];
    walker w = {.ground = ground, .up = up, .heading = {way[0], way[1], way[2]}, .came = -1};
    ss_ground_normal(ground, place, up);
    ss_add(-ss_dot(way, up), up, w.heading);
    w.left = ss_length(w.heading);
    ss_normalise(w.heading);
    if (w.left > 0 && aim(&w, place->triangle, up))
        walk(&w, NULL, place);
}
