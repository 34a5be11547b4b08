/* The relaxed slide: from the cache's own places to where every edge is as near its rest length as the deformed surface allows,
 * by Newton's method in the tangent planes, two unknowns a vertex. E is in stretch.c, what keeps faces from turning over in
 * folds.c, the surface and walks on it in triangles.c and site.c.
 *
 * Done when the model says that a step would lower E by less than a thousandth of what it was in the cache. Steps that would
 * lower it by less than ten times that are taken in part, the less the nearer the end: so the answer does not jump where one
 * frame takes a step more than the next. Crumpled skin, such as the inside of a sharp elbow, can stop the steps early: then two
 * more searches start from the cache, which do not mind creases but are not smooth in time, and the lowest answer counts. */
#include "relax.h"

#include <stdlib.h>
#include <string.h>

#define TOLERANCE         1e-3 /* of E in the cache */
#define EASE              10   /* times the tolerance, where steps begin to be taken in part */
#define LEAST_PART        0.01
#define HOLD              0.003
#define LEAST_DAMPING     0.01
#define MOST_HALVINGS     6
#define MOST_STEPS        30
#define STOPPED_EARLY     0.02 /* of E in the cache, still to be gained */
#define MOST_CREASE_STEPS 60
#define STANDSTILL        2e-3 /* of E, lowered by one of the search's steps; four end it */

/* ---- Creation ---- */

skinslide_status ss_relaxer_create(const ss_surface *surface, const ss_system *system, ss_relaxer **out,
                                   skinslide_error *error) {
    ss_relaxer *relaxer = calloc(1, sizeof *relaxer);
    if (!relaxer)
        return ss_out_of_memory(error);
    ss_memory *memory = &relaxer->memory;
    int32_t vertices = surface->patch->vertex_count, faces = surface->patch->faces.face_count;
    relaxer->surface = surface;
    relaxer->now = SS_NEW(memory, ss_stand, vertices);
    relaxer->trial = SS_NEW(memory, ss_stand, vertices);
    relaxer->best = SS_NEW(memory, ss_site, vertices);
    relaxer->axis = ss_new(memory, vertices, sizeof *relaxer->axis);
    relaxer->part = SS_NEW(memory, double, vertices);
    relaxer->before = SS_NEW(memory, double, vertices);
    relaxer->after = SS_NEW(memory, double, vertices);
    relaxer->slope = ss_new(memory, vertices, sizeof *relaxer->slope);
    relaxer->area = SS_NEW(memory, double, faces);
    relaxer->trial_area = SS_NEW(memory, double, faces);
    relaxer->cache_area = SS_NEW(memory, double, faces);
    relaxer->cache_chart_area = SS_NEW(memory, double, faces);
    bool allocated = ss_shape_allocate(memory, surface, &relaxer->pose);
    skinslide_status status = allocated ? ss_blocks_create(system, &relaxer->blocks, error) : ss_out_of_memory(error);
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
    ss_free(&relaxer->memory);
    free(relaxer);
}

/* ---- Where vertices are ---- */

static void set_stand(const ss_relaxer *relaxer, ss_stand *stand) {
    ss_manner manner = relaxer->pose.manner == SS_BLUNT ? SS_FLAT : relaxer->pose.manner;
    ss_site_place(&relaxer->pose, &stand->site, stand->place);
    ss_site_normal(&relaxer->pose, manner, &stand->site, stand->normal);
    ss_site_blend(relaxer->surface, &stand->site, relaxer->chart, stand->uv);
}

/* Where they are now, after a change of manner. */
static void set_stands(ss_relaxer *relaxer) {
    for (int32_t v = 0; v < relaxer->surface->patch->vertex_count; v++) {
        set_stand(relaxer, &relaxer->now[v]);
        relaxer->trial[v] = relaxer->now[v];
    }
}

/* ---- A step ---- */

/* Two unit vectors at right angles to a normal and to each other. */
static void span_plane(const double normal[3], double axis[2][3]) {
    int least = 0;
    for (int k = 1; k < 3; k++)
        least = fabs(normal[k]) < fabs(normal[least]) ? k : least;
    double other[3] = {least == 0, least == 1, least == 2};
    ss_cross(normal, other, axis[0]);
    ss_normalise(axis[0]);
    ss_cross(normal, axis[0], axis[1]);
}

/* A vertex of a free loop has only the way along it. */
static void set_axes(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->surface->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        double normal[3];
        memset(relaxer->axis[v], 0, sizeof *relaxer->axis);
        if (patch->vertex_loop[v] >= 0) {
            ss_site_border(&relaxer->pose, &relaxer->now[v].site, relaxer->axis[v][0]);
        } else {
            ss_site_normal(&relaxer->pose, relaxer->pose.manner, &relaxer->now[v].site, normal);
            span_plane(normal, relaxer->axis[v]);
        }
    }
}

/* Finds the step along the axes, in blocks->right. Returns what the model says it lowers E by. */
static double solve_step(ss_relaxer *relaxer) {
    int32_t count = relaxer->surface->patch->free_count;
    double lowers = 0;
    set_axes(relaxer);
    ss_blocks_clear(relaxer->blocks);
    ss_stretch_model(relaxer);
    ss_fold_model(relaxer);
    memcpy(relaxer->slope, relaxer->blocks->right, (size_t)count * sizeof *relaxer->slope);
    if (!ss_blocks_factor(relaxer->blocks))
        return 0;
    ss_blocks_solve(relaxer->blocks);
    for (int32_t i = 0; i < count; i++)
        lowers += relaxer->slope[i][0] * relaxer->blocks->right[i][0] + relaxer->slope[i][1] * relaxer->blocks->right[i][1];
    return lowers;
}

void ss_walk_trial(ss_relaxer *relaxer, int32_t vertex) {
    const double *along = relaxer->blocks->right[ss_blocks_unknown(relaxer->blocks, vertex)];
    double step[3] = {0, 0, 0}, part = relaxer->part[vertex];
    ss_stand *trial = &relaxer->trial[vertex];
    trial->site = relaxer->now[vertex].site;
    ss_add(part * along[0], relaxer->axis[vertex][0], step);
    ss_add(part * along[1], relaxer->axis[vertex][1], step);
    if (relaxer->surface->patch->vertex_loop[vertex] >= 0)
        ss_site_walk_border(&relaxer->pose, &trial->site, part * along[0]);
    else if (part > 0)
        ss_site_walk(&relaxer->pose, &trial->site, step);
    set_stand(relaxer, trial);
}

static double trial_energy(ss_relaxer *relaxer) {
    ss_cut_back(relaxer);
    return ss_stretch_energy(relaxer, relaxer->trial) + ss_fold_energy(relaxer, relaxer->trial_area);
}

static double try_step(ss_relaxer *relaxer, double part) {
    const ss_patch *patch = relaxer->surface->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        relaxer->part[patch->free_vertex[i]] = part;
        ss_walk_trial(relaxer, patch->free_vertex[i]);
    }
    return trial_energy(relaxer);
}

/* Half as far where the trial raised E. */
static double try_less(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->surface->patch;
    ss_stretch_by_vertex(relaxer, relaxer->now, relaxer->before);
    ss_stretch_by_vertex(relaxer, relaxer->trial, relaxer->after);
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        if (relaxer->after[v] <= relaxer->before[v])
            continue;
        relaxer->part[v] /= 2;
        ss_walk_trial(relaxer, v);
    }
    return trial_energy(relaxer);
}

/* Takes the step that solve_step found, where it or a shorter one lowers E from *now. Returns whether all of it was taken. */
static bool take_step(ss_relaxer *relaxer, double part, double *now) {
    const ss_patch *patch = relaxer->surface->patch;
    double then = try_step(relaxer, part);
    int halved = 0;
    for (; !(then < *now) && halved < MOST_HALVINGS; halved++)
        then = try_less(relaxer);
    relaxer->damping = halved > 0 ? fmin(8 * relaxer->damping, 1) : fmax(relaxer->damping / 4, LEAST_DAMPING);
    if (!(then < *now))
        return false;
    *now = then;
    memcpy(relaxer->now, relaxer->trial, (size_t)patch->vertex_count * sizeof *relaxer->now);
    memcpy(relaxer->area, relaxer->trial_area, (size_t)patch->faces.face_count * sizeof *relaxer->area);
    return halved == 0;
}

/* ---- Searches ---- */

/* Back to the cache. Returns E there. */
static double start(ss_relaxer *relaxer, ss_manner manner, double hold) {
    relaxer->pose.manner = manner, relaxer->hold = hold, relaxer->damping = LEAST_DAMPING;
    for (int32_t v = 0; v < relaxer->surface->patch->vertex_count; v++)
        relaxer->now[v].site = ss_site_of_vertex(relaxer->surface, v);
    set_stands(relaxer);
    ss_measure_cache(relaxer);
    return ss_stretch_energy(relaxer, relaxer->now);
}

/* How much of a step to take, given what it lowers E by in tolerances: from none at 1 smoothly to all at EASE. */
static double ease(double lowers) {
    double share = lowers > 1 ? fmin(1, log(lowers) / log(EASE)) : 0;
    return share * share * (3 - 2 * share);
}

/* Returns what is still to be gained, as a share of E in the cache. */
static double search_smoothly(ss_relaxer *relaxer, int32_t *steps) {
    double first = start(relaxer, SS_ROUND, HOLD), now = first, part = 1, left = 0;
    for (int failed = 0; first > 0 && failed < 4 && *steps < MOST_STEPS; ++*steps) {
        left = solve_step(relaxer) / first;
        part *= ease(left / TOLERANCE);
        if (part < LEAST_PART)
            break;
        double before = now;
        take_step(relaxer, part, &now);
        failed = before - now < TOLERANCE * first ? failed + 1 : 0;
    }
    return left;
}

/* On the flat triangles and with blunted creases by turns, whenever a step has to be cut. */
static void search_creases(ss_relaxer *relaxer, ss_manner manner, int32_t *steps) {
    double now = start(relaxer, manner, 0);
    for (int taken = 0, still = 0; still < 4 && taken < MOST_CREASE_STEPS; taken++, ++*steps) {
        double before = now;
        bool damped = relaxer->damping > LEAST_DAMPING;
        if (solve_step(relaxer) <= 0)
            return;
        bool whole = take_step(relaxer, 1, &now);
        still = before - now < STANDSTILL * before ? still + 1 : 0;
        if (whole && still && !damped)
            return;
        if (!whole)
            relaxer->pose.manner = relaxer->pose.manner == SS_FLAT ? SS_BLUNT : SS_FLAT;
    }
}

/* Keeps the sites where they have the lowest stretch yet. */
static void keep_best(ss_relaxer *relaxer, double *lowest) {
    relaxer->pose.manner = SS_FLAT, relaxer->hold = 0;
    set_stands(relaxer);
    double stretch = ss_stretch_energy(relaxer, relaxer->now);
    if (!(stretch < *lowest))
        return;
    *lowest = stretch;
    for (int32_t v = 0; v < relaxer->surface->patch->vertex_count; v++)
        relaxer->best[v] = relaxer->now[v].site;
}

static bool stays(const ss_relaxer *relaxer, int32_t vertex) {
    const ss_site *site = &relaxer->best[vertex];
    int corner = ss_site_corner(site);
    return corner >= 0 && relaxer->surface->vertex[site->triangle][corner] == vertex;
}

static void write_locations(const ss_relaxer *relaxer, ss_location *locations) {
    const ss_patch *patch = relaxer->surface->patch;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        locations[i] = ss_site_location(relaxer->surface, &relaxer->best[v], relaxer->chart);
        if (stays(relaxer, v))
            locations[i].face = SS_STAYS;
    }
}

int32_t ss_relax(ss_relaxer *relaxer, const float *points, const double (*chart)[2], const double *paint,
                 ss_location *locations) {
    int32_t steps = 0;
    double lowest = INFINITY;
    relaxer->chart = chart, relaxer->paint = paint;
    ss_shape_set(&relaxer->pose, points);
    double left = search_smoothly(relaxer, &steps);
    keep_best(relaxer, &lowest);
    for (int manner = SS_FLAT; manner <= SS_BLUNT && left > STOPPED_EARLY; manner++) {
        search_creases(relaxer, (ss_manner)manner, &steps);
        keep_best(relaxer, &lowest);
    }
    write_locations(relaxer, locations);
    return steps;
}
