/* A patch as a surface to slide on: how its triangles lie, places on it, and ways over it. */
#ifndef SKINSLIDE_SURFACE_H
#define SKINSLIDE_SURFACE_H

#include "base.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- place.c ---- */

#define SS_STAYS (-1)

/* Where a vertex is. */
typedef struct ss_place {
    int32_t triangle; /* or SS_STAYS: the vertex keeps its own place */
    double weight[3]; /* of the triangle's vertices: they sum to 1; one of exactly 1 is the vertex itself */
    double uv[2];     /* the same point in the plane that the patch is laid out in */
} ss_place;

/* uv [vertex_count][2] is the layout in that plane; NULL if there is none, and then uv of a place is 0. */
ss_place ss_place_of_vertex(const ss_patch *patch, const double (*uv)[2], int32_t vertex);
/* The place of a vertex that stays; own is where that is in the plane. */
ss_place ss_place_staying(const double own[2]);
/* The place in a triangle of a point p of the plane, which is outside the triangle by rounding at most, unless that has no
 * area. */
void ss_place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2], ss_place *out);
/* The same, given the corners of the triangle in the plane. */
void ss_place_between(const double *corners[3], int32_t triangle, const double p[2], ss_place *out);
/* The point of the plane that the weights of a place give. */
void ss_place_in_plane(const ss_patch *patch, const double (*uv)[2], const ss_place *place, double out[2]);
/* Ends a walk: sets uv from the weights, and the weights to those that ss_place_at finds there, unless the triangle is too thin
 * for them to agree. */
void ss_place_settle(const ss_patch *patch, const double (*uv)[2], ss_place *place);
/* Which vertex of its triangle the place is, or -1. */
int ss_place_corner(const ss_place *place);

/* ---- flat.c: faces laid flat ---- */

/* All faces in one plane, by vertex, or each in a plane of its own, by corner. */
typedef struct ss_flat {
    const double (*uv)[2];     /* [vertex_count], or NULL */
    const double (*corner)[2]; /* [corner_count], read if there is no uv */
} ss_flat;

static inline const double *ss_flat_corner(const ss_patch *patch, const ss_flat *flat, int32_t corner) {
    return flat->uv ? flat->uv[patch->faces.corner_vertex[corner]] : flat->corner[corner];
}
/* Where a place is in the plane of its face. */
void ss_flat_place(const ss_patch *patch, const ss_flat *flat, const ss_place *place, double out[2]);
/* The mean of a face's corners, as a place in the triangle of its fan that holds it or is nearest to it. */
ss_place ss_flat_middle(const ss_patch *patch, const ss_flat *flat, int32_t face);

/* ---- facets.c: triangles in a pose ---- */

typedef struct ss_facet {
    double gram[3];   /* the inverse of the dot products of its sides: 11, 12, 22; 0 without area */
    double normal[3]; /* unit */
} ss_facet;

static inline bool ss_has_area(const ss_facet *facet) {
    return facet->gram[0] > 0;
}

typedef struct ss_posed {
    const ss_patch *patch;
    double (*point)[3]; /* [vertex_count] */
    ss_facet *facet;    /* [triangle_count] */
} ss_posed;

/* The sides of a triangle from vertex 0 to 1 and to 2. */
static inline void ss_sides(const ss_posed *pose, int32_t triangle, double first[3], double second[3]) {
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    ss_subtract(pose->point[v[1]], pose->point[v[0]], first);
    ss_subtract(pose->point[v[2]], pose->point[v[0]], second);
}
bool ss_posed_allocate(ss_memory *memory, const ss_patch *patch, ss_posed *pose);
void ss_posed_lay_out(ss_posed *pose, const ss_patch *patch, ss_room *room);
/* points are the whole mesh's. */
void ss_posed_set(ss_posed *pose, const float *points);
/* Takes an embedding uv [vertex_count][2] as the pose, so that walks are straight in the plane. */
void ss_posed_set_plane(ss_posed *pose, const double (*uv)[2]);
/* The sine of half the angle at a corner of a triangle, which needs no function that differs between C libraries. */
double ss_half_angle(const ss_posed *pose, int32_t triangle, int corner);
/* The point of a pose at a place; if that is a vertex, the vertex's to the bit. */
static inline void ss_place_point(const ss_posed *pose, const ss_place *place, double out[3]) {
    const int32_t *v = pose->patch->triangles.vertex[place->triangle];
    const double *first = pose->point[v[0]], *second = pose->point[v[1]], *third = pose->point[v[2]], *weight = place->weight;
    const double *from = weight[1] == 1 ? second : weight[2] == 1 ? third : first;
    for (int k = 0; k < 3; k++)
        out[k] = from[k] + weight[1] * (second[k] - from[k]) + weight[2] * (third[k] - from[k]);
}

/* ---- Steps of a walk: inside a triangle, by the rates at which the weights change; and over a side into the next ---- */

static inline void ss_place_put(ss_place *place, int32_t triangle, const double weights[3]) {
    place->triangle = triangle;
    for (int k = 0; k < 3; k++)
        place->weight[k] = weights[k];
}

/* The rates at which the weights change along a vector, which is first projected into the plane of the triangle. Returns the
 * length of the projection. ss_vector_along goes back. */
static inline double ss_rates_along(const ss_posed *pose, int32_t triangle, const double vector[3], double rates[3]) {
    const ss_facet *facet = &pose->facet[triangle];
    double sides[2][3];
    ss_sides(pose, triangle, sides[0], sides[1]);
    double first = ss_dot(sides[0], vector), second = ss_dot(sides[1], vector);
    rates[1] = facet->gram[0] * first + facet->gram[1] * second;
    rates[2] = facet->gram[1] * first + facet->gram[2] * second;
    rates[0] = -rates[1] - rates[2];
    return sqrt(rates[1] * first + rates[2] * second);
}

static inline void ss_vector_along(const ss_posed *pose, int32_t triangle, const double rates[3], double vector[3]) {
    double first[3], second[3];
    ss_sides(pose, triangle, first, second);
    for (int k = 0; k < 3; k++)
        vector[k] = rates[1] * first[k] + rates[2] * second[k];
}

/* How much of the rates, at most 1, can be gone before a weight becomes 0; that of the corner except, or -1, is not looked at.
 * *corner is whose weight it is, or -1. */
static inline double ss_reach(const ss_place *place, const double rates[3], int except, int *corner) {
    double most = 1;
    *corner = -1;
    for (int k = 0; k < 3; k++)
        if (k != except && rates[k] < 0 && place->weight[k] < -rates[k] * most) {
            most = place->weight[k] / -rates[k];
            *corner = k;
        }
    return most;
}

/* Goes that part of the rates, which ends on the side opposite corner unless that is -1. rates become what is left. */
static inline void ss_advance(ss_place *place, double rates[3], double part, int corner) {
    double second = ss_least(ss_most(place->weight[1] + part * rates[1], 0), 1);
    double third = ss_least(ss_most(place->weight[2] + part * rates[2], 0), 1), sum = second + third;
    second = corner == 1 ? 0 : second, third = corner == 2 ? 0 : third;
    if (corner == 0 || second + third > 1)
        second /= sum, third = 1 - second;
    const double weights[3] = {corner == 0 ? 0 : 1 - second - third, second, third};
    ss_place_put(place, place->triangle, weights);
    for (int k = 0; k < 3; k++)
        rates[k] *= 1 - part;
}

/* ---- step.c ---- */

/* Goes over the side opposite a corner into the next triangle. Returns that triangle's corner opposite the side. */
int ss_cross_side(const ss_patch *patch, ss_place *place, int corner);

/* Measures a walk in another pose, and limits it there. */
typedef struct ss_meter {
    const ss_posed *pose;
    double walked, limit;
} ss_meter;
/* Returns how much of a part of the rates the limit allows, and adds its length to walked. */
double ss_measure(ss_meter *meter, int32_t triangle, const double rates[3], double part);

/* ---- walk.c: triangle and weights change; uv only when the place settles ---- */

/* Walks straight in the plane to uv, at most to the border, and no farther than limit measured in the pose. Returns how far. */
double ss_walk_measured(const ss_posed *plane, const ss_posed *pose, ss_place *place, const double uv[2], double limit);
/* For a place on the border. The unit direction in which the faces there go along it; and a walk by distance that way. */
void ss_border_way(const ss_posed *pose, const ss_place *place, double out[3]);
void ss_walk_border(const ss_posed *pose, ss_place *place, double distance);
/* The distance from a vertex of a loop to a place on it, the shorter way round: negative against the direction of the faces. */
double ss_border_distance(const ss_posed *pose, int32_t vertex, const ss_place *place);

/* ---- ground.c: a pose with normals, blended from vertex to vertex ---- */

/* A corner of a triangle as seen along the vertex's normal. A way along the vertex's tangents is first.way times the side to
 * the next corner plus second.way times that to the last: it is inside the wedge if neither is negative. */
typedef struct ss_wedge {
    double first[2], second[2];
    double lean[2];  /* how far the triangle rises along the normal, by unit of a way along each tangent */
    uint32_t corner; /* 4 * triangle + corner */
} ss_wedge;

typedef struct ss_ground {
    ss_posed pose;
    double (*normal)[3];     /* [vertex_count] unit; 0 if no triangle at the vertex has an area */
    double (*tangent)[2][3]; /* [vertex_count] at right angles to it and to each other, of unit length where it is */
    ss_wedge *wedges;        /* those that are visible, vertex by vertex, in the order of the triangles around it */
    int32_t *wedge_start;    /* [vertex_count + 1] */
} ss_ground;

bool ss_ground_allocate(ss_memory *memory, const ss_patch *patch, ss_ground *ground);
/* points are the whole mesh's. */
void ss_ground_set(ss_ground *ground, const float *points);
/* The normals of a place's vertices, blended by its weights: of any length. */
static inline void ss_ground_blend(const ss_ground *ground, const ss_place *place, double out[3]) {
    const int32_t *v = ground->pose.patch->triangles.vertex[place->triangle];
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < 3; k++)
        ss_add(place->weight[k], ground->normal[v[k]], out);
}
/* The unit normal at a place. */
static inline void ss_ground_normal(const ss_ground *ground, const ss_place *place, double out[3]) {
    ss_ground_blend(ground, place, out);
    ss_normalise(out);
}

#define SS_LEAST_TURN 1e-3 /* of 1 + cosine of a turn: at half a circle no rotation is the least */

/* ---- turned.c ---- */

/* Walks from a vertex for the length of a way along its tangents, in the direction that the way has at each place that is
 * reached, see turned.c; if there is a meter, no farther than that allows. Returns the part that was walked. */
double ss_walk_turned(const ss_ground *ground, int32_t vertex, const double way[2], ss_meter *meter, ss_place *place);
/* The same for several vertices [count], to the bit, but faster, since walks need not wait for each other's arithmetic. way and
 * place are by vertex. Ways are cut to what was walked. */
void ss_walk_turned_all(const ss_ground *ground, int32_t count, const int32_t *vertices, double (*way)[2], ss_place *place);
/* The same from a place inside a triangle or on its side, by the tangential part of a vector. */
void ss_walk_turned_from(const ss_ground *ground, const double way[3], ss_place *place);

/* ---- travel.c ---- */

typedef struct ss_traveller ss_traveller; /* memory of one thread for one patch */

/* Makes a traveller if there is none yet. */
skinslide_status ss_traveller_need(const ss_patch *patch, ss_traveller **traveller, skinslide_error *error);
void ss_traveller_destroy(ss_traveller *traveller);
/* Cuts ways short. Each leads from a vertex's own place straight through the embedding uv [vertex_count][2], or along its free
 * loop, to places [free_count], and may be no longer than limits [free_count], measured along the surface; infinity is no
 * limit. points are the whole mesh's. Returns how many ways were stopped by a hole. */
int32_t ss_travel(ss_traveller *traveller, const float *points, const double (*uv)[2], const double *limits, ss_place *places);

/* ---- Rules: what each makes of a patch once for a shot, once for each thread and in every frame. A rule is a room with a
 * table of its functions. It is chosen once for a set-up, and nothing after that asks which it is. ---- */

struct ss_idbuffer;
typedef struct ss_rule ss_rule;

/* A patch at rest: immutable. Each rule's own begins with this. */
typedef struct ss_rest {
    const ss_rule *rule;
    const ss_patch *patch;
    const double *paint;     /* [edge_count] of the set-up's controls */
    const double (*uv)[2];   /* [vertex_count] U0, the patch laid out in the plane; NULL if the rule has no plane */
    const ss_ground *ground; /* without a plane: the surface that it slides over */
} ss_rest;

/* One frame of a patch, before it slides. */
typedef struct ss_frame {
    const float *points;   /* [mesh vertex_count][3] */
    const double *lengths; /* [edge_count] */
    const double *paint;   /* [edge_count] the pointer of rest, if it is the same */
    const double *weights; /* [free_count] */
    const double *limits;  /* [free_count] how far each may slide; NULL: no limits */
    const int *stop;       /* set when the frame is not wanted any more */
    const double *holds;   /* [vertex_count] */
    double stretch_response, compression_response;
} ss_frame;

/* Where vertices of one patch slide to: memory of one thread. Each rule's own begins with this. */
typedef struct ss_slide {
    const ss_rest *rest;
    ss_flat flat;       /* what places are in: the plane of the last frame, or without a plane the faces at rest */
    double (*asked)[2]; /* [free_count] where in the plane each was looked up */
    ss_place *places;   /* [free_count] where it was found */
    bool regular;       /* no two faces overlap in the plane and all are convex: places can be walked to */
} ss_slide;

/* Sets asked to where each vertex was found, which differs if it was held back. */
void ss_ask_where_found(ss_slide *slide);

struct ss_rule {
    /* patch and paint must outlive the rest. rest_points are the whole mesh's. */
    skinslide_status (*create)(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error);
    void (*destroy)(ss_rest *rest); /* not NULL */
    /* number is the patch's in the ID buffer, if there is one. Asks the room for its memory, which is made before the first
     * frame. */
    skinslide_status (*open)(const ss_rest *rest, ss_room *room, struct ss_idbuffer *idbuffer, int32_t number, ss_slide **out,
                             skinslide_error *error);
    void (*close)(ss_slide *slide); /* not NULL */
    /* A frame in two steps: other patches start between them, using the room, while a device goes on with the first. Both add
     * to the counts of result. */
    skinslide_status (*start)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
    skinslide_status (*finish)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
};

#ifdef __cplusplus
}
#endif

#endif
