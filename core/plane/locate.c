/* Looks rest vertices up in the frame's embedding (paper, section 3.3), exactly.
 *
 * A point is in the lowest face with area that holds it, border included. All tests are exact, so that the answer depends only
 * on the embedding, and not on how it was found. A vertex whose point is its own place stays, whatever else is there. The
 * search begins with the first face that holds the point among those that a texture proposed; else with a walk over triangles,
 * see paving.c, from where the neighbour before it landed, whose two steps or so are mostly made beforehand, see approach.c. If
 * faces may overlap, or a walk goes round or runs into a hole, a tree of faces is asked. A point in no face is put on the
 * nearest, and counted. */
#include "plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ss_locator {
    ss_memory memory;
    const ss_patch *patch;
    ss_face_tree *tree;
    bool tree_built; /* for the current embedding */
    ss_paving paving;
    int32_t *own;    /* [free_count] a slab at each vertex */
    int32_t *landed; /* [free_count] a slab near where each query was found */
    int32_t *stack;  /* [face_count] */
    uint8_t *seen;   /* [face_count] zero between calls */
    bool regular;
    const double (*uv)[2];
};

skinslide_status ss_locator_create(const ss_patch *patch, ss_locator **out, skinslide_error *error) {
    ss_locator *locator = calloc(1, sizeof *locator);
    if (!locator)
        return ss_out_of_memory(error);
    locator->patch = patch;
    locator->own = SS_NEW(&locator->memory, int32_t, patch->free_count);
    locator->landed = SS_NEW(&locator->memory, int32_t, patch->free_count);
    locator->stack = SS_NEW(&locator->memory, int32_t, patch->faces.face_count);
    locator->seen = SS_NEW(&locator->memory, uint8_t, patch->faces.face_count);
    bool paved = ss_pave(&locator->memory, patch, &locator->paving) && !locator->memory.failed;
    skinslide_status status = paved ? SKINSLIDE_OK : ss_out_of_memory(error);
    for (int32_t i = 0; i < patch->free_count && paved; i++)
        locator->own[i] = locator->paving.slab_of[patch->triangles.vertex_triangle[patch->free_vertex[i]]];
    if (!status)
        status = ss_face_tree_create(patch, &locator->tree, error);
    if (status)
        ss_locator_destroy(locator);
    else
        *out = locator;
    return status;
}

void ss_locator_destroy(ss_locator *locator) {
    if (!locator)
        return;
    ss_face_tree_destroy(locator->tree);
    ss_free(&locator->memory);
    free(locator);
}

static const double *corner_uv(const ss_locator *locator, int32_t corner) {
    return locator->uv[locator->patch->faces.corner_vertex[corner]];
}

/* Where p is relative to the side that begins at a corner: 1 inside, 0 on its line, -1 outside. */
static int side_of(const ss_locator *locator, int32_t corner, const double p[2]) {
    return ss_orient(corner_uv(locator, corner), corner_uv(locator, ss_next_corner(&locator->patch->faces, corner)), p);
}

/* ---- The tie rule ---- */

static bool touches(const ss_locator *locator, int32_t face, const double p[2], bool *on_border) {
    const ss_faces *faces = &locator->patch->faces;
    bool left = false, right = false, below = false, above = false;
    *on_border = false;
    for (int32_t c = faces->face_start[face]; c < faces->face_start[face + 1]; c++) {
        const double *q = corner_uv(locator, c);
        left |= q[0] <= p[0], right |= q[0] >= p[0], below |= q[1] <= p[1], above |= q[1] >= p[1];
        int side = side_of(locator, c, p);
        if (side < 0)
            return false;
        *on_border |= side == 0;
    }
    return left && right && below && above; /* for a face without area, the whole line would be inside */
}

/* Given a face whose border p is on, gathers all such faces, going over the sides that p is on. Returns their count, or -1 if p
 * is on the boundary, since there may be more beyond a hole without area. */
static int32_t gather_touching(ss_locator *locator, int32_t face, const double p[2]) {
    const ss_faces *faces = &locator->patch->faces;
    int32_t count = 0;
    bool bounded = false, on_border;
    locator->stack[count++] = face;
    locator->seen[face] = 1;
    for (int32_t i = 0; i < count; i++)
        for (int32_t c = faces->face_start[locator->stack[i]]; c < faces->face_start[locator->stack[i] + 1]; c++) {
            if (side_of(locator, c, p) != 0)
                continue;
            int32_t other = faces->corner_twin[c] < 0 ? -1 : faces->corner_face[faces->corner_twin[c]];
            bounded |= other < 0;
            if (other < 0 || locator->seen[other] || !touches(locator, other, p, &on_border))
                continue;
            locator->seen[other] = 1;
            locator->stack[count++] = other;
        }
    for (int32_t i = 0; i < count; i++)
        locator->seen[locator->stack[i]] = 0;
    return bounded ? -1 : count;
}

/* Finds the lowest face with area that holds p, given one that does. False if that is not certain. */
static bool settle(ss_locator *locator, int32_t face, const double p[2], bool on_border, ss_place *out) {
    int32_t count = 1, lowest = INT32_MAX, holding = -1;
    locator->stack[0] = face;
    if (on_border)
        count = gather_touching(locator, face, p);
    for (int32_t i = 0; i < count; i++) {
        int32_t candidate = locator->stack[i];
        int32_t triangle = candidate < lowest ? ss_triangle_holding(locator->patch, candidate, locator->uv, p) : -1;
        if (triangle >= 0)
            lowest = candidate, holding = triangle;
    }
    if (holding >= 0)
        ss_place_at(locator->patch, locator->uv, holding, p, out);
    return holding >= 0;
}

/* ---- What a texture proposed ---- */

/* Finds p's place with the first candidate that holds it. Returns which that is, or -1. Faces must be convex. */
static int32_t try_candidates(ss_locator *locator, const ss_candidates *candidates, const double p[2], ss_place *out) {
    for (int32_t k = 0; candidates && k < SS_CANDIDATES; k++) {
        bool on_border;
        int32_t face = (*candidates)[k];
        if (face < 0 && k > 0)
            break;
        if (face >= 0 && touches(locator, face, p, &on_border) && settle(locator, face, p, on_border, out))
            return k;
    }
    return -1;
}

/* ---- What the walk cannot reach ---- */

static void search(ss_locator *locator, const double p[2], ss_place *out, ss_located *located) {
    if (!locator->tree_built)
        ss_face_tree_build(locator->tree, locator->uv);
    locator->tree_built = true;
    located->searched++;
    if (!ss_face_tree_holding(locator->tree, p, out))
        located->clamped += ss_face_tree_nearest(locator->tree, p, out) > 0;
}

/* A point on the border. */
typedef struct border_point {
    int32_t corner;       /* where its side begins */
    double at[2], square; /* the point; the distance squared */
} border_point;

/* Takes the nearest point of side i of a loop, counted cyclically, if that is nearer to p. Returns whether it was. */
static bool try_side(const ss_locator *locator, int32_t loop, int32_t i, const double p[2], border_point *nearest) {
    const ss_patch *patch = locator->patch;
    int32_t begin = patch->loop_start[loop], count = patch->loop_start[loop + 1] - begin;
    int32_t corner = patch->vertex_corner[patch->loop_vertex[begin + (i % count + count) % count]];
    double at[2], square = ss_nearest_on_side(&patch->faces, locator->uv, corner, p, at);
    if (square >= nearest->square)
        return false;
    *nearest = (border_point){corner, {at[0], at[1]}, square};
    return true;
}

/* A vertex on a free loop slides along it, from its own sides one way or the other for as long as that comes nearer to p, so
 * that it never jumps across the hole. */
static void slide_on_loop(const ss_locator *locator, int32_t vertex, const double p[2], ss_place *out) {
    const ss_patch *patch = locator->patch;
    int32_t loop = patch->vertex_loop[vertex], own = patch->loop_place[vertex] - patch->loop_start[loop];
    border_point nearest = {.square = INFINITY};
    try_side(locator, loop, own, p, &nearest);
    int32_t way = try_side(locator, loop, own - 1, p, &nearest) ? -1 : 1;
    int32_t next = way < 0 ? own - 2 : own + 1;
    while (try_side(locator, loop, next, p, &nearest))
        next += way;
    ss_place_at(patch, locator->uv, ss_triangle_of_side(patch, nearest.corner), nearest.at, out);
}

/* ---- All queries ---- */

void ss_locator_set(ss_locator *locator, const double (*uv)[2], bool regular) {
    locator->uv = uv, locator->regular = regular;
    locator->tree_built = false;
    ss_paving_lay_out(&locator->paving, uv);
}

/* Walks from a slab to the one that holds p, and finds p's place. Returns that slab, or -1 if the walk fails. */
static int32_t walk_to(ss_locator *locator, int32_t from, const double p[2], int64_t *steps, ss_place *out) {
    bool on_border;
    int32_t slab = ss_paving_walk(&locator->paving, from, p, &on_border, steps);
    if (slab < 0)
        return -1;
    if (on_border)
        return settle(locator, locator->patch->triangles.face[locator->paving.slab[slab].triangle], p, true, out) ? slab : -1;
    ss_paving_place_at(&locator->paving, slab, p, out);
    return slab;
}

ss_place ss_locate_near(ss_locator *locator, int32_t triangle, const double p[2]) {
    ss_located located = {0};
    ss_place place;
    if (!locator->regular || walk_to(locator, locator->paving.slab_of[triangle], p, &located.steps, &place) < 0)
        search(locator, p, &place, &located);
    return place;
}

/* Looks up query i, whose walk begins at the slab from, where it was perhaps found already: then out is its place. */
static void locate_one(ss_locator *locator, int32_t i, int32_t from, bool found, const double p[2],
                       const ss_candidates *candidates, ss_place *out, ss_located *located) {
    const ss_patch *patch = locator->patch;
    const double *own = locator->paving.uv[i];
    int32_t vertex = patch->free_vertex[i], slab = -1;
    if (p[0] == own[0] && p[1] == own[1]) {
        *out = ss_place_staying(p);
        return;
    }
    if (patch->vertex_loop[vertex] >= 0) {
        slide_on_loop(locator, vertex, p, out);
        return;
    }
    if (found) {
        located->walked++;
        locator->landed[i] = from;
        return;
    }
    int32_t candidate = locator->regular ? try_candidates(locator, candidates, p, out) : -1;
    if (candidate < 0 && locator->regular)
        slab = walk_to(locator, from, p, &located->steps, out);
    located->centre += candidate == 0;
    located->around += candidate > 0;
    located->walked += slab >= 0;
    if (candidate < 0 && slab < 0)
        search(locator, p, out, located);
    locator->landed[i] = slab < 0 ? locator->paving.slab_of[out->triangle] : slab;
}

/* Looks up count queries from begin on. Each begins where the neighbour before it landed; if that is among these, at that one's
 * own place. */
static void locate_some(ss_locator *locator, int32_t begin, int32_t count, const double (*query)[2],
                        const ss_candidates *candidates, ss_place *places, ss_located *located) {
    int32_t near[SS_AT_ONCE];
    bool found[SS_AT_ONCE] = {false};
    for (int32_t k = 0; k < count; k++) {
        int32_t before = locator->patch->free_before[begin + k];
        near[k] = locator->landed[before < 0 ? begin + k : before];
    }
    if (count == SS_AT_ONCE && locator->regular && !candidates)
        located->steps += ss_paving_approach(&locator->paving, query + begin, near, places + begin, found);
    for (int32_t k = 0, i = begin; k < count; k++, i++)
        locate_one(locator, i, near[k], found[k], query[i], candidates ? &candidates[i] : NULL, &places[i], located);
}

ss_located ss_locate(ss_locator *locator, const double (*uv)[2], bool regular, const double (*query)[2],
                     const ss_candidates *candidates, ss_place *places) {
    ss_located located = {0};
    int32_t count = locator->patch->free_count;
    ss_locator_set(locator, uv, regular);
    memcpy(locator->landed, locator->own, (size_t)count * sizeof *locator->landed);
    for (int32_t begin = 0; begin < count; begin += SS_AT_ONCE)
        locate_some(locator, begin, count - begin < SS_AT_ONCE ? count - begin : SS_AT_ONCE, query, candidates, places,
                    &located);
    return located;
}
