/* The least stretch that skin can have on a pose, as far as a search finds it: every free vertex may go anywhere on the patch,
 * and faces may turn over. From where the cache has vertices and from where a frame left them, it goes downhill along
 *
 *     K^-1 g,   g_v = sum over the edges at v of log(L / l) / L^2 times the edge,   K = the springs of 1 / l^2 of the edges
 *
 * and from there to the nearest point of the pose, only where that lowers the stretch, with steps that halve until it does. */
#include "slide.h"

#include <math.h>
#include <string.h>

#define MOST_STEPS 400
#define LEAST_GAIN 1e-9 /* of the square of stretch, by one step */
#define SHORTEST   1e-7 /* of a step */
#define GROUNDING  1e-3 /* of a vertex's springs, which hold it where it is: none need be fixed */

typedef struct search {
    ss_memory memory;
    const ss_patch *patch;
    const int *stop;
    ss_posed pose;
    uint8_t *held; /* [vertex_count] fixed, or on a loop: those stay where a frame left them */
    ss_system *system;
    ss_factor *factor;
    ss_place *place, *tried;     /* [vertex_count] */
    double (*at)[3], (*pull)[3]; /* [vertex_count] where the places tried are; the gradient, then the step */
    double stretch;              /* at place */
} search;

/* ---- The nearest point of the pose ---- */

static double distance_square(const search *s, int32_t triangle, const double weight[3], const double target[3]) {
    double way[3] = {-target[0], -target[1], -target[2]};
    for (int k = 0; k < 3; k++)
        ss_add(weight[k], s->pose.point[s->patch->triangles.vertex[triangle][k]], way);
    return ss_dot(way, way);
}

/* Of a side: how far along it, 0 to 1. */
static double along_side(const search *s, int32_t triangle, int side, const double target[3]) {
    const int32_t *v = s->patch->triangles.vertex[triangle];
    double way[3], to[3];
    ss_subtract(s->pose.point[v[(side + 1) % 3]], s->pose.point[v[side]], way);
    ss_subtract(target, s->pose.point[v[side]], to);
    double square = ss_dot(way, way);
    return square > 0 ? fmin(1, fmax(0, ss_dot(to, way) / square)) : 0;
}

/* The square of the distance of a triangle, and the weights of its nearest point. */
static double nearest_of(const search *s, int32_t triangle, const double target[3], double weight[3]) {
    const ss_facet *facet = &s->pose.facet[triangle];
    double to[3], best = INFINITY;
    ss_subtract(target, s->pose.point[s->patch->triangles.vertex[triangle][0]], to);
    ss_rates_along(&s->pose, triangle, to, weight);
    weight[0] += 1;
    if (ss_has_area(facet) && fmin(weight[0], fmin(weight[1], weight[2])) >= 0)
        return distance_square(s, triangle, weight, target);
    for (int side = 0; side < 3; side++) {
        double own[3] = {0, 0, 0};
        own[(side + 1) % 3] = along_side(s, triangle, side, target), own[side] = 1 - own[(side + 1) % 3];
        double square = distance_square(s, triangle, own, target);
        if (square < best)
            best = square, memcpy(weight, own, sizeof own);
    }
    return best;
}

/* Takes the nearest point of the triangles around a vertex, where it is nearer than *square. */
static void try_around(const search *s, int32_t vertex, const double target[3], ss_place *place, double *square) {
    const ss_triangles *triangles = &s->patch->triangles;
    int32_t first = triangles->vertex_triangle[vertex], t = first;
    do {
        double weight[3], own = nearest_of(s, t, target, weight);
        if (own < *square)
            *square = own, ss_place_put(place, t, weight);
        t = triangles->neighbour[t][(ss_triangle_corner(s->patch, t, vertex) + 2) % 3];
    } while (t >= 0 && t != first);
}

/* Moves from triangle to triangle as long as a nearer one is around. */
static void go_nearest(const search *s, const double target[3], ss_place *place) {
    double square = INFINITY, before;
    do {
        int32_t vertices[3];
        memcpy(vertices, s->patch->triangles.vertex[place->triangle], sizeof vertices);
        before = square;
        for (int k = 0; k < 3; k++)
            try_around(s, vertices[k], target, place, &square);
    } while (square < before);
}

/* ---- Where vertices are ---- */

static double find_stretch(search *s) {
    const ss_patch *patch = s->patch;
    double sum = 0;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        ss_place_point(&s->pose, &s->tried[v], s->at[v]);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double way[3];
        ss_subtract(s->at[patch->edge_vertex[e][1]], s->at[patch->edge_vertex[e][0]], way);
        double own = ss_log(fmax(ss_length(way), patch->shortest) / patch->rest_length[e]);
        sum += own * own;
    }
    return sqrt(sum / patch->faces.edge_count);
}

static void move(const search *s, int32_t vertex, double size) {
    double target[3];
    ss_place_point(&s->pose, &s->tried[vertex], target);
    ss_add(-size, s->pull[vertex], target);
    go_nearest(s, target, &s->tried[vertex]);
}

/* Where a step of that size leads; returns the stretch there. */
static double try_step(search *s, double size) {
    memcpy(s->tried, s->place, (size_t)s->patch->vertex_count * sizeof *s->tried);
    for (int32_t v = 0; v < s->patch->vertex_count; v++)
        if (!s->held[v] && size > 0)
            move(s, v, size);
    return find_stretch(s);
}

/* ---- Downhill ---- */

static void find_gradient(search *s) {
    const ss_patch *patch = s->patch;
    memset(s->pull, 0, (size_t)patch->vertex_count * sizeof *s->pull);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        int32_t a = patch->edge_vertex[e][0], b = patch->edge_vertex[e][1];
        double way[3];
        ss_subtract(s->at[b], s->at[a], way);
        double length = fmax(ss_length(way), patch->shortest),
               force = ss_log(length / patch->rest_length[e]) / (length * length);
        ss_add(-force, way, s->pull[a]);
        ss_add(force, way, s->pull[b]);
    }
}

/* Solves for two coordinates at once; the last one is solved alone. */
static void precondition(search *s, int first, int count) {
    for (int32_t v = 0; v < s->patch->vertex_count; v++)
        for (int k = 0; k < 2 && s->system->unknown[v] >= 0; k++)
            s->factor->right[s->system->unknown[v]][k] = k < count ? s->pull[v][first + k] : 0;
    ss_solve(s->factor);
    for (int32_t v = 0; v < s->patch->vertex_count; v++)
        for (int k = 0; k < count && s->system->unknown[v] >= 0; k++)
            s->pull[v][first + k] = s->factor->right[s->system->unknown[v]][k];
}

/* Takes the first step of halving sizes that lowers the stretch; false where none does. */
static bool step_down(search *s, double *size) {
    find_stretch(s);
    find_gradient(s);
    precondition(s, 0, 2);
    precondition(s, 2, 1);
    for (; *size > SHORTEST && !ss_is_set(s->stop); *size /= 2) {
        double stretch = try_step(s, *size);
        if (stretch < s->stretch) {
            memcpy(s->place, s->tried, (size_t)s->patch->vertex_count * sizeof *s->place);
            s->stretch = stretch, *size = fmin(1, 2 * *size);
            return true;
        }
    }
    return false;
}

/* The stretch where the walk from s->place ends. */
static double walk_down(search *s) {
    double size = 1;
    s->stretch = try_step(s, 0);
    for (int steps = 0; steps < MOST_STEPS; steps++) {
        double before = s->stretch;
        memcpy(s->tried, s->place, (size_t)s->patch->vertex_count * sizeof *s->tried);
        if (!step_down(s, &size) || before * before - s->stretch * s->stretch < LEAST_GAIN * before * before)
            break;
    }
    return s->stretch;
}

/* ---- One patch ---- */

static void fill_springs(search *s) {
    const ss_patch *patch = s->patch;
    ss_factor_clear(s->factor);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        double spring = 1 / (patch->rest_length[e] * patch->rest_length[e]);
        const int32_t *v = patch->edge_vertex[e], unknown[2] = {s->system->unknown[v[0]], s->system->unknown[v[1]]};
        s->factor->entry[e] = spring;
        for (int end = 0; end < 2; end++)
            if (unknown[end] >= 0)
                s->factor->slack[unknown[end]] += unknown[1 - end] >= 0 ? GROUNDING * spring : spring;
    }
}

static skinslide_status open_search(search *s, const ss_patch *patch, skinslide_error *error) {
    int32_t vertices = patch->vertex_count;
    s->patch = patch;
    s->held = SS_NEW(&s->memory, uint8_t, vertices);
    s->place = SS_NEW(&s->memory, ss_place, vertices);
    s->tried = SS_NEW(&s->memory, ss_place, vertices);
    s->at = ss_new(&s->memory, vertices, sizeof *s->at);
    s->pull = ss_new(&s->memory, vertices, sizeof *s->pull);
    if (!ss_posed_allocate(&s->memory, patch, &s->pose))
        return ss_out_of_memory(error);
    for (int32_t v = 0; v < vertices; v++)
        s->held[v] = patch->fixed[v] || patch->vertex_loop[v] >= 0;
    const ss_net net = {vertices, patch->faces.edge_count, (const int32_t(*)[2])patch->edge_vertex, s->held};
    skinslide_status status = ss_system_create(&net, patch->label, &s->system, error);
    return status ? status : ss_factor_create(s->system, NULL, &s->factor, error);
}

static void close_search(search *s) {
    ss_factor_destroy(s->factor);
    ss_system_destroy(s->system);
    ss_free(&s->memory);
}

/* Where the cache has every vertex, or where the frame left it. */
static void start(search *s, const ss_slide *slide) {
    const ss_patch *patch = s->patch;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        s->place[v] = ss_place_of_vertex(patch, NULL, v);
    for (int32_t i = 0; slide && i < patch->free_count; i++)
        if (slide->places[i].triangle != SS_STAYS)
            s->place[patch->free_vertex[i]] = slide->places[i];
}

static skinslide_status search_patch(const skinslide_workspace *workspace, int32_t p, const float *points, double *least,
                                     skinslide_error *error) {
    search s = {.stop = &workspace->stop};
    skinslide_status status = open_search(&s, workspace->slider->parts[p].patch, error);
    if (!status) {
        ss_posed_set(&s.pose, points);
        fill_springs(&s);
        if (!ss_factorise(s.factor))
            status =
                ss_fail(error, SKINSLIDE_SINGULAR, "%s: its edges differ too much in length for a search", s.system->label);
    }
    if (!status) {
        start(&s, NULL);
        *least = walk_down(&s);
        start(&s, workspace->patches[p].slide);
        *least = fmin(*least, walk_down(&s));
    }
    close_search(&s);
    return status;
}

skinslide_status skinslide_workspace_least_stretch(skinslide_workspace *workspace, const float *points, double *least,
                                                   skinslide_error *error) {
    if (!workspace || !points || !least)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no workspace, points, or place for the least stretch");
    skinslide_status status = ss_check_frame(workspace, error);
    if (!status)
        status = ss_check_reads(workspace->slider, points, "points", error);
    ss_memory memory = {0};
    double *own = SS_NEW(&memory, double, workspace->slider->part_count);
    if (!status && memory.failed)
        status = ss_out_of_memory(error);
    if (!status)
        ss_bring(workspace->slider, &points, workspace->before);
    for (int32_t p = 0; p < workspace->slider->part_count && !status; p++)
        status = ss_go_on(workspace, search_patch(workspace, p, points, &own[p], error), error);
    for (int32_t p = 0; p < workspace->slider->part_count && !status; p++)
        least[p] = own[p];
    ss_free(&memory);
    return status;
}
