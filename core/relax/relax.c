/* The relaxed slide: from the cache's own places to where every edge is as near its rest length as the deformed surface allows.
 * E and its models are in stretch.c, what keeps faces from turning over in folds.c, the plane that all of it happens in in
 * chart.c.
 *
 * Crumpled skin, such as the inside of a sharp elbow, has many places where E is least, and a search for one of them jumps from
 * one to another in the course of a motion. So nothing is searched for: the slide is a fixed number of damped Newton steps, each
 * a continuous function of what it starts from, and so of the pose. The first is that of skin at rest whose edges are as long
 * as the cache has them, which knows nothing of how the pose is crumpled and leads out of there. The others take forces from
 * where the vertices are, and what moves them from gradients that change continuously over the patch.
 *
 * A step that the model has lower E by less than ten times a tolerance is taken in part, the less the nearer the end, and so
 * there is no jump either where one frame takes a step more than the next. */
#include "relax.h"

#include <stdlib.h>
#include <string.h>

#define MOST_STEPS 13
#define TOLERANCE  3e-4 /* of E in the cache */
#define EASE       10   /* times the tolerance, where steps begin to be taken in part */
#define LEAST_PART 0.01

/* ---- Creation ---- */

skinslide_status ss_relaxer_create(const ss_chart *chart, const ss_system *system, ss_relaxer **out, skinslide_error *error) {
    ss_relaxer *relaxer = calloc(1, sizeof *relaxer);
    if (!relaxer)
        return ss_out_of_memory(error);
    ss_memory *memory = &relaxer->memory;
    int32_t vertices = chart->patch->vertex_count;
    relaxer->chart = chart;
    relaxer->point = ss_new(memory, vertices, sizeof *relaxer->point);
    relaxer->gradient = ss_new(memory, vertices, sizeof *relaxer->gradient);
    relaxer->place = SS_NEW(memory, ss_place, vertices);
    relaxer->before = SS_NEW(memory, ss_place, vertices);
    relaxer->uv = ss_new(memory, vertices, sizeof *relaxer->uv);
    relaxer->at = ss_new(memory, vertices, sizeof *relaxer->at);
    relaxer->way = ss_new(memory, vertices, sizeof *relaxer->way);
    relaxer->axis = ss_new(memory, vertices, sizeof *relaxer->axis);
    relaxer->slope = ss_new(memory, vertices, sizeof *relaxer->slope);
    relaxer->step = ss_new(memory, vertices, sizeof *relaxer->step);
    relaxer->reach = SS_NEW(memory, double, vertices);
    relaxer->rest_paint = SS_NEW(memory, double, chart->patch->faces.edge_count);
    skinslide_status status = memory->failed ? ss_out_of_memory(error) : ss_blocks_create(system, &relaxer->blocks, error);
    if (!status)
        status = ss_blocks_create(system, &relaxer->rest, error);
    if (status)
        ss_relaxer_destroy(relaxer);
    else
        *out = relaxer;
    return status;
}

void ss_relaxer_destroy(ss_relaxer *relaxer) {
    if (!relaxer)
        return;
    ss_blocks_destroy(relaxer->blocks);
    ss_blocks_destroy(relaxer->rest);
    ss_free(&relaxer->memory);
    free(relaxer);
}

/* ---- Where vertices are ---- */

/* How the place moves with u and v: blended from the gradients of the triangle's vertices. */
static void blend_gradient(const ss_relaxer *relaxer, const ss_place *place, double out[2][3]) {
    const int32_t *v = relaxer->chart->patch->triangles.vertex[place->triangle];
    memset(out, 0, sizeof(double[2][3]));
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 2; k++)
            ss_add(place->weight[j], relaxer->gradient[v[j]][k], out[k]);
}

/* How far the place on the rounded surface is above that on the triangle, along the normal: halfway to where the planes that
 * touch the surface at the triangle's vertices average, as in Phong tessellation (Boubekeur and Alexa 2008). */
static void lift(const ss_relaxer *relaxer, int32_t vertex, double out[3]) {
    const ss_place *place = &relaxer->place[vertex];
    const int32_t *v = relaxer->chart->patch->triangles.vertex[place->triangle];
    double off[3] = {0, 0, 0}, gradient[2][3], normal[3];
    blend_gradient(relaxer, place, gradient);
    ss_cross(gradient[0], gradient[1], normal);
    ss_normalise(normal);
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 2; k++)
            ss_add(place->weight[j] * (relaxer->uv[vertex][k] - relaxer->chart->uv[v[j]][k]), relaxer->gradient[v[j]][k], off);
    ss_add(0.5 * ss_dot(off, normal), normal, out);
}

/* A vertex that has not moved has its place in the cache, to the bit. */
static void set_place(ss_relaxer *relaxer, int32_t vertex) {
    const ss_place *place = &relaxer->place[vertex];
    const int32_t *v = relaxer->chart->patch->triangles.vertex[place->triangle];
    int corner = ss_place_corner(place);
    ss_place_in_plane(relaxer->chart->patch, relaxer->chart->uv, place, relaxer->uv[vertex]);
    memset(relaxer->at[vertex], 0, sizeof relaxer->at[vertex]);
    for (int j = 0; j < 3; j++)
        ss_add(place->weight[j], relaxer->point[v[j]], relaxer->at[vertex]);
    if (corner < 0)
        lift(relaxer, vertex, relaxer->at[vertex]);
}

/* The ways are those of u and v; of a vertex of a free loop, that along it. */
static void set_axes(ss_relaxer *relaxer, int32_t vertex) {
    double(*way)[2] = relaxer->way[vertex], (*axis)[3] = relaxer->axis[vertex], gradient[2][3], border[3];
    memset(way, 0, sizeof relaxer->way[vertex]);
    memset(axis, 0, sizeof relaxer->axis[vertex]);
    way[0][0] = way[1][1] = 1;
    if (relaxer->chart->patch->vertex_loop[vertex] >= 0) {
        ss_border_way(&relaxer->chart->plane, &relaxer->place[vertex], border);
        way[0][0] = border[0], way[0][1] = border[1], way[1][1] = 0;
    }
    blend_gradient(relaxer, &relaxer->place[vertex], gradient);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            ss_add(way[i][k], gradient[k], axis[i]);
}

/* The cache. */
static void start(ss_relaxer *relaxer, const float *points) {
    const ss_patch *patch = relaxer->chart->patch;
    ss_take_points(patch, points, relaxer->point);
    ss_chart_gradient(relaxer->chart, (const double(*)[3])relaxer->point, relaxer->gradient);
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        relaxer->place[v] = ss_place_of_vertex(relaxer->chart->patch, relaxer->chart->uv, v);
        relaxer->step[v][0] = relaxer->step[v][1] = 0;
        set_place(relaxer, v);
    }
}

/* ---- A step ---- */

/* Empties the blocks. The second unknown of a vertex of a free loop, which does nothing, gets a stiffness. */
static void clear(const ss_relaxer *relaxer, ss_blocks *blocks) {
    const ss_patch *patch = relaxer->chart->patch;
    ss_blocks_clear(blocks);
    for (int32_t i = 0; i < patch->free_count; i++)
        if (patch->vertex_loop[patch->free_vertex[i]] >= 0)
            ss_blocks_own(blocks, ss_blocks_unknown(blocks, patch->free_vertex[i]))[3] = 1;
}

/* Turns forces into the step, whole. Returns what the model says it lowers E by. */
static double solve(ss_relaxer *relaxer, ss_blocks *blocks) {
    int32_t count = relaxer->chart->patch->free_count;
    double lowers = 0;
    memcpy(relaxer->slope, blocks->right, (size_t)count * sizeof *blocks->right);
    ss_blocks_solve(blocks);
    for (int32_t i = 0; i < count; i++)
        lowers += relaxer->slope[i][0] * blocks->right[i][0] + relaxer->slope[i][1] * blocks->right[i][1];
    return lowers;
}

/* The first step: its matrix is the same in every frame with the same paint. */
static double solve_rest(ss_relaxer *relaxer, const int *stop) {
    const ss_patch *patch = relaxer->chart->patch;
    size_t bytes = (size_t)patch->faces.edge_count * sizeof *relaxer->rest_paint;
    if (memcmp(relaxer->rest_paint, relaxer->paint, bytes) != 0) {
        memset(relaxer->rest_paint, 0, bytes);
        clear(relaxer, relaxer->rest);
        ss_rest_stiffness(relaxer);
        if (!ss_blocks_factor(relaxer->rest, stop))
            return 0;
        memcpy(relaxer->rest_paint, relaxer->paint, bytes);
    }
    memset(relaxer->rest->right, 0, (size_t)patch->free_count * sizeof *relaxer->rest->right);
    ss_rest_forces(relaxer);
    return solve(relaxer, relaxer->rest);
}

static double solve_now(ss_relaxer *relaxer, const int *stop) {
    clear(relaxer, relaxer->blocks);
    ss_stretch_model(relaxer);
    ss_fold_model(relaxer);
    return ss_blocks_factor(relaxer->blocks, stop) ? solve(relaxer, relaxer->blocks) : 0;
}

static void walk(ss_relaxer *relaxer, int32_t vertex) {
    const ss_posed *plane = &relaxer->chart->plane;
    const double *step = relaxer->step[vertex], *own = relaxer->uv[vertex], *way = relaxer->way[vertex][0];
    double goal[2] = {own[0] + step[0], own[1] + step[1]};
    relaxer->before[vertex] = relaxer->place[vertex];
    if (relaxer->chart->patch->vertex_loop[vertex] >= 0)
        ss_walk_border(plane, &relaxer->place[vertex], step[0] * way[0] + step[1] * way[1]);
    else
        ss_walk(plane, &relaxer->place[vertex], goal);
    set_place(relaxer, vertex);
}

/* Puts the free vertices of a face back to where they were before the step. Returns whether any was elsewhere. */
static bool put_back(ss_relaxer *relaxer, int32_t face) {
    const ss_faces *faces = &relaxer->chart->patch->faces;
    bool any = false;
    for (int32_t c = faces->face_start[face]; c < faces->face_start[face + 1]; c++) {
        int32_t v = faces->corner_vertex[c];
        if (relaxer->step[v][0] == 0 && relaxer->step[v][1] == 0)
            continue;
        relaxer->step[v][0] = relaxer->step[v][1] = 0;
        relaxer->place[v] = relaxer->before[v];
        set_place(relaxer, v);
        any = true;
    }
    return any;
}

/* Takes a part of the step found. Steps are limited so that no face turns over, but walks end at holes: a face that turns over
 * for that goes back, and so on, until none is left. */
static void take(ss_relaxer *relaxer, const ss_blocks *found, double part) {
    const ss_patch *patch = relaxer->chart->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        const double *along = found->right[ss_blocks_unknown(found, v)];
        for (int k = 0; k < 2; k++)
            relaxer->step[v][k] = part * (along[0] * relaxer->way[v][0][k] + along[1] * relaxer->way[v][1][k]);
    }
    ss_limit_steps(relaxer);
    for (int32_t i = 0; i < patch->free_count; i++)
        walk(relaxer, patch->free_vertex[i]);
    for (bool any = true; any;) {
        any = false;
        for (int32_t f = 0; f < patch->faces.face_count; f++)
            if (ss_has_turned(relaxer, f))
                any |= put_back(relaxer, f);
    }
}

/* ---- The slide ---- */

/* How much of a step to take, given what it lowers E by in tolerances: from none at 1 smoothly to all at EASE. */
static double ease(double lowers) {
    double share = lowers > 1 ? fmin(1, log(lowers) / log(EASE)) : 0;
    return share * share * (3 - 2 * share);
}

static bool stays(const ss_relaxer *relaxer, int32_t vertex) {
    const ss_place *place = &relaxer->place[vertex];
    int corner = ss_place_corner(place);
    return corner >= 0 && relaxer->chart->patch->triangles.vertex[place->triangle][corner] == vertex;
}

static void write_places(const ss_relaxer *relaxer, ss_place *places) {
    const ss_patch *patch = relaxer->chart->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        places[i] = relaxer->place[v];
        if (stays(relaxer, v))
            places[i] = ss_place_staying(relaxer->chart->uv[v]);
        else
            ss_place_settle(patch, relaxer->chart->uv, &places[i]);
    }
}

int32_t ss_relax(ss_relaxer *relaxer, const ss_frame *frame, ss_place *places) {
    const ss_patch *patch = relaxer->chart->patch;
    int32_t steps = 0;
    double part = 1;
    relaxer->paint = frame->paint;
    start(relaxer, frame->points);
    double first = ss_stretch_energy(relaxer);
    for (; first > 0 && steps < MOST_STEPS && !ss_is_set(frame->stop); steps++) {
        for (int32_t i = 0; i < patch->free_count; i++)
            set_axes(relaxer, patch->free_vertex[i]);
        double lowers = (steps == 0 ? solve_rest : solve_now)(relaxer, frame->stop) / first;
        part *= ease(lowers / TOLERANCE);
        if (part < LEAST_PART)
            break;
        take(relaxer, steps == 0 ? relaxer->rest : relaxer->blocks, part);
    }
    write_places(relaxer, places);
    return steps;
}
