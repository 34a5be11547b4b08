/* Where the outer boundary goes (paper, section 3.2): onto the unit square between four corners, or onto its inscribed circle,
 * each vertex at its share of the arc length at rest. Rest and all frames have the same places. */
#include "plane.h"

#include <math.h>
#include <stdio.h>

/* cos and sin of |angle| <= pi/4 by their series, whose remainder is under 1e-17 there. */
static void small_circle(double angle, double out[2]) {
    double square = angle * angle, cosine = 1, sine = 1;
    for (int k = 9; k > 0; k--) {
        cosine = 1 - cosine * square / ((2 * k) * (2 * k - 1));
        sine = 1 - sine * square / ((2 * k) * (2 * k + 1));
    }
    out[0] = cosine, out[1] = sine * angle;
}

void ss_circle(double turns, double out[2]) {
    double quarter = floor(4 * turns + 0.5), p[2];
    small_circle((4 * turns - quarter) * (SS_PI / 2), p);
    switch ((int)quarter & 3) {
    case 0:
        out[0] = p[0], out[1] = p[1];
        break;
    case 1:
        out[0] = -p[1], out[1] = p[0];
        break;
    case 2:
        out[0] = -p[0], out[1] = -p[1];
        break;
    default:
        out[0] = p[1], out[1] = -p[0];
    }
}

/* ---- The outer loop: vertex i of it, and the side that leaves it ---- */

static int32_t outer_count(const ss_patch *patch) {
    return patch->loop_start[1];
}

static int32_t outer_vertex(const ss_patch *patch, int32_t i) {
    return patch->loop_vertex[i % outer_count(patch)];
}

static double side_length(const ss_patch *patch, int32_t i) {
    return patch->rest_length[patch->faces.corner_edge[patch->vertex_corner[outer_vertex(patch, i)]]];
}

static double arc_length(const ss_patch *patch, int32_t from, int32_t to) {
    double length = 0;
    for (int32_t i = from; i < to; i++)
        length += side_length(patch, i);
    return length;
}

static void place_on_circle(const ss_patch *patch, double (*uv)[2]) {
    double whole = arc_length(patch, 0, outer_count(patch)), walked = 0;
    for (int32_t i = 0; i < outer_count(patch); i++) {
        double *at = uv[outer_vertex(patch, i)], direction[2];
        ss_circle(walked / whole, direction);
        at[0] = 0.5 + 0.5 * direction[0], at[1] = 0.5 + 0.5 * direction[1];
        walked += side_length(patch, i);
    }
}

/* ---- The square ---- */

/* Places the vertices from the corner numbered side, at loop position from, up to the next corner, at position to. */
static void place_on_side(const ss_patch *patch, int side, int32_t from, int32_t to, double (*uv)[2]) {
    static const double corners[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    const double *a = corners[side], *b = corners[side + 1];
    double whole = arc_length(patch, from, to), walked = 0;
    for (int32_t i = from; i < to; i++) {
        double share = walked / whole, *at = uv[outer_vertex(patch, i)];
        for (int k = 0; k < 2; k++)
            at[k] = a[k] == b[k] ? a[k] : a[k] < b[k] ? share : 1 - share;
        walked += side_length(patch, i);
    }
}

/* corners: loop positions, ascending; the first goes to (0,0). */
static void place_on_square(const ss_patch *patch, const int32_t corners[4], double (*uv)[2]) {
    for (int side = 0; side < 4; side++)
        place_on_side(patch, side, corners[side], side < 3 ? corners[side + 1] : corners[0] + outer_count(patch), uv);
}

static void sort4(int32_t values[4]) {
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && values[k] < values[k - 1]; k--) {
            int32_t swap = values[k];
            values[k] = values[k - 1], values[k - 1] = swap;
        }
}

/* Loop positions of the artist's corners. */
static skinslide_status find_corners(const ss_patch *patch, int32_t positions[4], skinslide_error *error) {
    for (int k = 0; k < 4; k++) {
        int32_t vertex = ss_patch_vertex(patch, patch->setup->corners[k]);
        positions[k] = -1;
        for (int32_t i = 0; vertex >= 0 && i < outer_count(patch); i++)
            if (patch->loop_vertex[i] == vertex)
                positions[k] = i;
        if (positions[k] < 0)
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, "%s: corner %d is not on its outer boundary", patch->label,
                           patch->setup->corners[k]);
    }
    sort4(positions);
    for (int k = 1; k < 4; k++)
        if (positions[k] == positions[k - 1]) {
            char corner[24];
            snprintf(corner, sizeof corner, "corner %d", patch->mesh_vertex[patch->loop_vertex[positions[k]]]);
            return ss_refuse_repeated(patch->label, corner, SKINSLIDE_BAD_CONTROL, error);
        }
    return SKINSLIDE_OK;
}

/* Cosine and sine of the angle between the two sides at a corner; 1 and 0 if a side has no length. */
static void corner_angle(const ss_patch *patch, int32_t corner, const float *points, double out[2]) {
    const ss_faces *faces = &patch->faces;
    const float *here = points + 3 * (int64_t)patch->mesh_vertex[faces->corner_vertex[corner]];
    const float *before = points + 3 * (int64_t)patch->mesh_vertex[faces->corner_vertex[ss_previous_corner(faces, corner)]];
    const float *after = points + 3 * (int64_t)patch->mesh_vertex[faces->corner_vertex[ss_next_corner(faces, corner)]];
    double dot = 0, cross = 0;
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        double a = (double)before[k] - here[k], b = (double)after[k] - here[k];
        double c = (double)before[l] - here[l], d = (double)after[l] - here[l];
        dot += a * b;
        cross += (a * d - c * b) * (a * d - c * b);
    }
    double length = sqrt(dot * dot + cross);
    out[0] = length > 0 ? dot / length : 1, out[1] = length > 0 ? sqrt(cross) / length : 0;
}

/* A number that grows with the interior angle of the patch at a boundary vertex, which several faces may share: 2 for every
 * half turn, plus 1 - cosine of the rest. Angles are added by multiplying complex numbers. */
static double opening(const ss_patch *patch, int32_t vertex, const float *points) {
    double cosine = 1, sine = 0, half_turns = 0;
    for (int32_t c = patch->vertex_corner[vertex]; c >= 0; c = patch->faces.corner_twin[ss_previous_corner(&patch->faces, c)]) {
        double angle[2], turned = cosine;
        corner_angle(patch, c, points, angle);
        cosine = cosine * angle[0] - sine * angle[1];
        sine = turned * angle[1] + sine * angle[0];
        if (sine < 0)
            cosine = -cosine, sine = -sine, half_turns++;
    }
    return 2 * half_turns + 1 - cosine;
}

/* The sharpest vertex of the loop, then those nearest to a quarter, half and three quarters of the arc from it. */
static void choose_corners(const ss_patch *patch, const float *rest_points, int32_t positions[4]) {
    int32_t count = outer_count(patch), sharpest = 0;
    for (int32_t i = 1; i < count; i++)
        if (opening(patch, outer_vertex(patch, i), rest_points) < opening(patch, outer_vertex(patch, sharpest), rest_points))
            sharpest = i;
    double whole = arc_length(patch, 0, count), walked = 0;
    int32_t i = 0;
    positions[0] = sharpest;
    for (int k = 1; k < 4; k++) {
        do /* at least one step from the last corner, leaving a vertex for each corner to come */
            walked += side_length(patch, sharpest + i++);
        while (walked + 0.5 * side_length(patch, sharpest + i) < 0.25 * k * whole && count - i > 4 - k);
        positions[k] = (sharpest + i) % count;
    }
    sort4(positions);
}

bool ss_has_corners(const ss_patch *patch) {
    for (int k = 0; k < 4 && patch->setup->corners && patch->piece_count > 1; k++)
        if (ss_patch_vertex(patch, patch->setup->corners[k]) < 0)
            return false;
    return patch->setup->corners;
}

skinslide_status ss_place_boundary(const ss_patch *patch, skinslide_boundary boundary, const float *rest_points,
                                   double (*uv)[2], skinslide_error *error) {
    bool given = ss_has_corners(patch);
    if (boundary == SKINSLIDE_BOUNDARY_AUTO)
        boundary = given ? SKINSLIDE_BOUNDARY_SQUARE : SKINSLIDE_BOUNDARY_CIRCLE;
    int32_t corners[4];
    skinslide_status status = given ? find_corners(patch, corners, error) : SKINSLIDE_OK;
    if (status)
        return status;
    if (boundary == SKINSLIDE_BOUNDARY_CIRCLE) {
        place_on_circle(patch, uv);
        return SKINSLIDE_OK;
    }
    if (outer_count(patch) < 4)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, "%s: a square boundary needs 4 vertices on the outer loop, which has %d",
                       patch->label, outer_count(patch));
    if (!given)
        choose_corners(patch, rest_points, corners);
    place_on_square(patch, corners, uv);
    return SKINSLIDE_OK;
}
