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
    double weight[3]; /* of the triangle's vertices: they sum to 1, and exactly 1 is the vertex itself */
    double uv[2];     /* the same in a plane that the patch is laid out in */
} ss_place;

/* uv [vertex_count][2] is that plane everywhere; NULL where there is none, and uv of the place is 0. */
ss_place ss_place_of_vertex(const ss_patch *patch, const double (*uv)[2], int32_t vertex);
/* Keeps its own place. */
ss_place ss_place_staying(const double own[2]);
/* The point p of the plane in a triangle: outside of it by rounding at most, but where it has no area. */
void ss_place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2], ss_place *out);
/* The same, given where the corners of the triangle are. */
void ss_place_between(const double *corners[3], int32_t triangle, const double p[2], ss_place *out);
/* Where the weights are in the plane. */
void ss_place_in_plane(const ss_patch *patch, const double (*uv)[2], const ss_place *place, double out[2]);
/* Ends a walk: sets uv, and the weights to what a place found at that point has, unless the triangle is too thin to tell them. */
void ss_place_settle(const ss_patch *patch, const double (*uv)[2], ss_place *place);
/* Which vertex of its triangle the place is, or -1. */
int ss_place_corner(const ss_place *place);

/* ---- flat.c: faces laid flat ---- */

/* All of them in one plane, by vertex, or each in a plane of its own, by corner. */
typedef struct ss_flat {
    const double (*uv)[2];     /* [vertex_count], or NULL */
    const double (*corner)[2]; /* [corner_count] where there is no uv */
} ss_flat;

static inline const double *ss_flat_corner(const ss_patch *patch, const ss_flat *flat, int32_t corner) {
    return flat->uv ? flat->uv[patch->faces.corner_vertex[corner]] : flat->corner[corner];
}
/* Where a place is there. */
void ss_flat_place(const ss_patch *patch, const ss_flat *flat, const ss_place *place, double out[2]);
/* The mean of a face's corners: in the triangle of its fan that holds it, or most nearly does. */
ss_place ss_flat_middle(const ss_patch *patch, const ss_flat *flat, int32_t face);

/* ---- facets.c: triangles in a pose ---- */

typedef struct ss_facet {
    double gram[3];   /* the inverse of the products of its sides: 11, 12, 22 */
    double normal[3]; /* of unit length */
} ss_facet;

/* Of one without, the gram is 0. */
static inline bool ss_has_area(const ss_facet *facet) {
    return facet->gram[0] > 0;
}

typedef struct ss_posed {
    const ss_patch *patch;
    double (*point)[3]; /* [vertex_count] */
    ss_facet *facet;    /* [triangle_count] */
} ss_posed;

/* From a triangle's vertex 0 to 1 and 2. */
static inline void ss_sides(const ss_posed *pose, int32_t triangle, double first[3], double second[3]) {
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    ss_subtract(pose->point[v[1]], pose->point[v[0]], first);
    ss_subtract(pose->point[v[2]], pose->point[v[0]], second);
}
bool ss_posed_allocate(ss_memory *memory, const ss_patch *patch, ss_posed *pose);
void ss_posed_lay_out(ss_posed *pose, const ss_patch *patch, ss_room *room);
/* points is the whole mesh's. */
void ss_posed_set(ss_posed *pose, const float *points);
/* The plane as a pose: an embedding uv [vertex_count][2], to walk straight in. */
void ss_posed_set_plane(ss_posed *pose, const double (*uv)[2]);
/* The sine of half the angle at a corner of a triangle, which plain arithmetic gives. */
double ss_half_angle(const ss_posed *pose, int32_t triangle, int corner);
/* At a vertex, that to the bit. */
static inline void ss_place_point(const ss_posed *pose, const ss_place *place, double out[3]) {
    const int32_t *v = pose->patch->triangles.vertex[place->triangle];
    const double *first = pose->point[v[0]], *second = pose->point[v[1]], *third = pose->point[v[2]], *weight = place->weight;
    const double *from = weight[1] == 1 ? second : weight[2] == 1 ? third : first;
    for (int k = 0; k < 3; k++)
        out[k] = from[k] + weight[1] * (second[k] - from[k]) + weight[2] * (third[k] - from[k]);
}

/* ---- Steps of a walk: inside a triangle as rates at which the weights of a place change, and over a side into the next ---- */

static inline void ss_place_put(ss_place *place, int32_t triangle, const double weights[3]) {
    place->triangle = triangle;
    for (int k = 0; k < 3; k++)
        place->weight[k] = weights[k];
}

/* How fast the weights change along a vector, which is projected into the plane of the triangle; and back. Returns the length of what
 * is in the plane. */
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

/* The part of the rates that can be gone before a weight, but that of one corner, or -1, is 0: 1 where none gets there. *corner
 * is the weight, or -1. */
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

/* Goes that part, which ends on the side opposite the corner where that is not -1. rates are then what is left. */
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

/* From the side opposite a corner into the triangle beyond it. Returns that one's corner opposite the side. */
int ss_cross_side(const ss_patch *patch, ss_place *place, int corner);

/* What a walk is measured with: the way in another pose, and how far it may go there. */
typedef struct ss_meter {
    const ss_posed *pose;
    double walked, limit;
} ss_meter;
/* How much of a part of the rates the limit allows; adds its length. */
double ss_measure(ss_meter *meter, int32_t triangle, const double rates[3], double part);

/* ---- walk.c: triangle and weights change, uv does not until the place settles ---- */

/* Walks straight in the plane to uv, or to the border, no farther than limit measured in the pose. Returns how far. */
double ss_walk_measured(const ss_posed *plane, const ss_posed *pose, ss_place *place, const double uv[2], double limit);
/* For a place on the border: the direction in which faces go round it there, and a walk along it that far. */
void ss_border_way(const ss_posed *pose, const ss_place *place, double out[3]);
void ss_walk_border(const ss_posed *pose, ss_place *place, double distance);
/* How far the place is along its loop from a vertex of it, the shorter way: less than 0 against the faces' way. */
double ss_border_distance(const ss_posed *pose, int32_t vertex, const ss_place *place);

/* ---- ground.c: a pose with normals, blended from vertex to vertex ---- */

/* A corner of a triangle as it is seen along the normal of the vertex there. A way along the tangents there is first.way of the side
 * to the next corner and second.way of that to the last: inside, where neither is less than 0. */
typedef struct ss_wedge {
    double first[2], second[2];
    double lean[2];  /* how far the triangle rises along the normal, for a way along each tangent */
    uint32_t corner; /* 4 times the triangle, and which of its corners */
} ss_wedge;

typedef struct ss_ground {
    ss_posed pose;
    double (*normal)[3];     /* [vertex_count] of unit length; 0 where no triangle at the vertex has an area */
    double (*tangent)[2][3]; /* [vertex_count] at right angles to it and to each other, of unit length where it is */
    ss_wedge *wedges;        /* those that are seen, vertex by vertex, each vertex's as its triangles follow each other */
    int32_t *wedge_start;    /* [vertex_count + 1] */
} ss_ground;

bool ss_ground_allocate(ss_memory *memory, const ss_patch *patch, ss_ground *ground);
/* points is the whole mesh's. */
void ss_ground_set(ss_ground *ground, const float *points);
/* The normals about a place, blended by its weights: of any length. */
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

#define SS_LEAST_TURN 1e-3 /* 1 + cosine of a turn; none is least about half a circle */

/* ---- turned.c ---- */

/* Walks from a vertex for the length of a way along the tangents there, in the direction that this has at each place that the walk
 * comes to: see turned.c. With a meter, no farther than that lets it. Returns the part that was walked. */
double ss_walk_turned(const ss_ground *ground, int32_t vertex, const double way[2], ss_meter *meter, ss_place *place);
/* The same of several vertices [count], each with its way and its place by vertex, to the bit: one walk goes on while another waits
 * for a result. Ways are cut to what was walked. */
void ss_walk_turned_all(const ss_ground *ground, int32_t count, const int32_t *vertices, double (*way)[2], ss_place *place);
/* The same from a place inside a triangle, or on a side of it, by what of the vector is tangent there. */
void ss_walk_turned_from(const ss_ground *ground, const double way[3], ss_place *place);

/* ---- travel.c ---- */

typedef struct ss_traveller ss_traveller; /* memory of one thread for one patch */

/* Makes one where there is none yet. */
skinslide_status ss_traveller_need(const ss_patch *patch, ss_traveller **traveller, skinslide_error *error);
void ss_traveller_destroy(ss_traveller *traveller);
/* Cuts the ways short. Each leads from the vertex's own place straight through the embedding uv [vertex_count][2], or along its
 * free loop, to its place [free_count], and no farther than its limit [free_count] along the surface, which may be infinite. points
 * is the whole mesh's. Returns how many ways a hole is in: those end at it. */
int32_t ss_travel(ss_traveller *traveller, const float *points, const double (*uv)[2], const double *limits, ss_place *places);

/* ---- Rules: what each makes of a patch once a shot, once a thread and in every frame. Each is a room with a table of its
 * functions; a set-up's is chosen once, and nothing after that asks which it is. ---- */

struct ss_idbuffer;
typedef struct ss_rule ss_rule;

/* A patch at rest: immutable. Each rule's own begins with this. */
typedef struct ss_rest {
    const ss_rule *rule;
    const ss_patch *patch;
    const double *paint;     /* [edge_count] of the set-up's controls */
    const double (*uv)[2];   /* [vertex_count] U0, the patch laid out in the plane; NULL: the rule knows none */
    const ss_ground *ground; /* it slides over instead */
} ss_rest;

/* One frame of a patch, before it slides. */
typedef struct ss_frame {
    const float *points;   /* [mesh vertex_count][3] */
    const double *lengths; /* [edge_count] */
    const double *paint;   /* [edge_count] that of rest, where it is the same */
    const double *weights; /* [free_count] */
    const double *limits;  /* [free_count] how far each may slide; NULL: as far as it goes */
    const int *stop;       /* a flag: the frame is not wanted any more */
    const double *holds;   /* [vertex_count] */
    double stretch_response, compression_response;
} ss_frame;

/* Where vertices of one patch slide to: memory of one thread. Each rule's own begins with this. */
typedef struct ss_slide {
    const ss_rest *rest;
    ss_flat flat;       /* what places are in: the plane of the last frame; where the rule knows none, faces at rest */
    double (*asked)[2]; /* [free_count] where in the plane each was looked up */
    ss_place *places;   /* [free_count] where it was found, settled */
    bool regular;       /* no two faces overlap there and all are convex: places can be walked to */
} ss_slide;

/* Makes asked where each vertex was found: elsewhere than asked where it was held back. */
void ss_ask_where_found(ss_slide *slide);

struct ss_rule {
    /* The arrays must live as long. rest_points is the whole mesh's. */
    skinslide_status (*create)(const ss_patch *patch, const float *rest_points, const double *paint, ss_rest **out,
                               skinslide_error *error);
    void (*destroy)(ss_rest *rest); /* not NULL */
    /* Where there is an ID buffer, the patch has a number in it. The room, of which it asks its part, is made before the first
     * frame. */
    skinslide_status (*open)(const ss_rest *rest, ss_room *room, struct ss_idbuffer *idbuffer, int32_t number, ss_slide **out,
                             skinslide_error *error);
    void (*close)(ss_slide *slide); /* not NULL */
    /* A frame in two steps: a device may go on with the first while other patches start, which use the room. Both add to what
     * result counts. */
    skinslide_status (*start)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
    skinslide_status (*finish)(ss_slide *slide, const ss_frame *frame, skinslide_patch_result *result, skinslide_error *error);
};

#ifdef __cplusplus
}
#endif

#endif
