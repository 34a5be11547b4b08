/* How much a pose stretches skin at each vertex and which way, with its sign: for wrinkles across what is pressed together.
 *
 * At a corner of a face, between the sides e1, e2 at rest and d1, d2 in the pose, the map F of rest to pose takes e to d. In a
 * frame (a, b) of the tangent plane of the vertex at rest, turned into the face's plane by the least rotation,
 *
 *     C = F^T F = E^-T [d_i . d_j] E^-1        E: e1 and e2 in the frame
 *
 * is the identity where nothing is stretched, whatever the mesh's shape. Of a vertex C is the mean over its corners, by their
 * areas at rest, and
 *
 *     largest, smallest = sqrt(eigenvalues of C)        area ratio = sqrt(det C)
 *
 * The eigenvector of the largest is taken to the texture by each corner's own S E^-1, S: its sides in st. */
#include "picture.h"

#include "paint.h"

#include <math.h>

static const double alike = 1e-5;   /* relative: principal stretches whose squares differ by less have no direction */
static const double no_area = 1e-9; /* relative to the product of its sides: a corner of less is a line */

/* Symmetric, 2 by 2: aa, ab, bb. */
typedef struct tensor {
    double a, ab, b;
} tensor;

typedef struct tally {
    double normal[3]; /* sum of area vectors at rest */
    tensor sum;       /* of area C */
    double area;
} tally;

typedef struct strain {
    const skinslide_mesh *mesh;
    const float *points, *st;
    tally *at; /* [vertex_count] of welded vertices, the one that the others are one with has it */
} strain;

/* A corner of a face, with those before and after it, as corners of the mesh. */
typedef struct corner {
    int32_t before, here, after;
} corner;

static int32_t vertex_at(const strain *s, int32_t index) {
    int32_t vertex = s->mesh->face_indices[index];
    return s->mesh->weld ? s->mesh->weld[vertex] : vertex;
}

static corner corner_at(int32_t first, int32_t n, int32_t k) {
    return (corner){first + (k + n - 1) % n, first + k, first + (k + 1) % n};
}

static void sides_of(const strain *s, const float *points, corner at, double sides[2][3]) {
    const int32_t ends[2] = {at.after, at.before};
    const float *here = points + 3 * (int64_t)s->mesh->face_indices[at.here];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            sides[i][k] = (double)points[3 * (int64_t)s->mesh->face_indices[ends[i]] + k] - here[k];
}

/* ---- Frames ---- */

/* Two directions across a normal, of length 1. */
static void frame_of(const double normal[3], double frame[2][3]) {
    double axis[3] = {0, 0, 0};
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    axis[fabs(normal[2]) < fabs(normal[least]) ? 2 : least] = 1;
    ss_cross(axis, normal, frame[0]);
    double length = ss_length(frame[0]);
    for (int k = 0; k < 3; k++)
        frame[0][k] /= length;
    ss_cross(normal, frame[0], frame[1]);
}

/* By the least rotation that takes a normal to another, which is less than a right angle away:
 * x - (x . to) / (1 + n . to) (n + to) where x . n = 0. */
static void turn_frame(const double normal[3], const double to[3], double frame[2][3]) {
    double whole = 1 + ss_dot(normal, to);
    for (int i = 0; i < 2; i++) {
        double share = ss_dot(frame[i], to) / whole;
        for (int k = 0; k < 3; k++)
            frame[i][k] -= share * (normal[k] + to[k]);
    }
}

/* Columns e1, e2 in the frame of a corner's vertex, inverted; the area of both. False for a corner that is a line, or where the
 * vertex has no normal. */
static bool invert_sides(const strain *s, corner at, double inverse[2][2], double *area) {
    double sides[2][3], across[3], frame[2][3];
    double normal[3] = {0, 0, 0};
    const double *sum = s->at[vertex_at(s, at.here)].normal;
    double length = ss_length(sum);
    sides_of(s, s->mesh->rest_points, at, sides);
    ss_cross(sides[0], sides[1], across);
    *area = ss_length(across);
    if (!(length > 0) || !(*area > no_area * ss_length(sides[0]) * ss_length(sides[1])))
        return false;
    double sign = ss_dot(across, sum) < 0 ? -1 : 1; /* of a corner that turns inwards */
    for (int k = 0; k < 3; k++)
        normal[k] = sum[k] / length, across[k] *= sign / *area;
    frame_of(normal, frame);
    turn_frame(normal, across, frame);
    double e[2][2] = {{ss_dot(frame[0], sides[0]), ss_dot(frame[0], sides[1])},
                      {ss_dot(frame[1], sides[0]), ss_dot(frame[1], sides[1])}};
    double det = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    inverse[0][0] = e[1][1] / det, inverse[0][1] = -e[0][1] / det;
    inverse[1][0] = -e[1][0] / det, inverse[1][1] = e[0][0] / det;
    return true;
}

/* ---- Sums ---- */

static void add_normal(strain *s, int32_t first, int32_t n) {
    double area[3];
    ss_area_vector(s->mesh->face_indices + first, n, s->mesh->rest_points, area);
    for (int32_t k = first; k < first + n; k++)
        ss_add(1, area, s->at[vertex_at(s, k)].normal);
}

static void add_corner(strain *s, corner at) {
    double inverse[2][2], area, d[2][3];
    if (!invert_sides(s, at, inverse, &area))
        return;
    sides_of(s, s->points, at, d);
    double g[3] = {ss_dot(d[0], d[0]), ss_dot(d[0], d[1]), ss_dot(d[1], d[1])}, c[2][2];
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            c[i][j] = inverse[0][i] * (g[0] * inverse[0][j] + g[1] * inverse[1][j]) +
                      inverse[1][i] * (g[1] * inverse[0][j] + g[2] * inverse[1][j]);
    tally *to = &s->at[vertex_at(s, at.here)];
    to->sum.a += area * c[0][0], to->sum.ab += area * c[0][1], to->sum.b += area * c[1][1];
    to->area += area;
}

/* ---- What is found ---- */

typedef struct principal {
    double largest, smallest, area;
    double way[2]; /* of the largest, in the vertex's frame; 0 where there is none */
} principal;

static principal principal_of(const tally *at) {
    if (!(at->area > 0))
        return (principal){1, 1, 1, {0, 0}};
    double a = at->sum.a / at->area, ab = at->sum.ab / at->area, b = at->sum.b / at->area;
    double middle = (a + b) / 2, half = (a - b) / 2, apart = sqrt(half * half + ab * ab);
    double det = fmax(a * b - ab * ab, 0), most = middle + apart;
    principal own = {.largest = sqrt(most), .smallest = most > 0 ? sqrt(det / most) : 0, .area = sqrt(det)};
    if (apart > alike * middle) {
        double cosine = half / apart; /* of twice the angle from a */
        own.way[0] = sqrt(fmax(1 + cosine, 0) / 2);
        own.way[1] = ab < 0 ? -sqrt(fmax(1 - cosine, 0) / 2) : sqrt(fmax(1 - cosine, 0) / 2);
    }
    return own;
}

/* Of the largest stretch at a corner, in its face's texture coordinates. */
static void find_direction(const strain *s, corner at, float out[2]) {
    double inverse[2][2], area, way[2] = {0, 0};
    principal own = principal_of(&s->at[vertex_at(s, at.here)]);
    if (!invert_sides(s, at, inverse, &area))
        return;
    for (int i = 0; i < 2; i++) {
        double share = inverse[i][0] * own.way[0] + inverse[i][1] * own.way[1];
        for (int k = 0; k < 2; k++)
            way[k] += share * ((double)s->st[2 * (int64_t)(i ? at.before : at.after) + k] - s->st[2 * (int64_t)at.here + k]);
    }
    double squared = way[0] * way[0] + way[1] * way[1];
    if (squared > 0 && isfinite(squared))
        out[0] = (float)((way[0] * way[0] - way[1] * way[1]) / squared), out[1] = (float)(2 * way[0] * way[1] / squared);
}

static skinslide_status write_vertices(const strain *s, const skinslide_strain *out, skinslide_error *error) {
    for (int32_t v = 0; v < s->mesh->vertex_count; v++) {
        principal own = principal_of(&s->at[s->mesh->weld ? s->mesh->weld[v] : v]);
        const float found[3] = {(float)own.largest, (float)own.smallest, (float)own.area};
        if (!isfinite(found[0]) || !isfinite(found[2]))
            return ss_refuse_vertex("stretch", v, found, 1, SKINSLIDE_BAD_POINTS, error);
        float *const to[3] = {out->largest, out->smallest, out->area_ratio};
        for (int i = 0; i < 3; i++)
            if (to[i])
                to[i][v] = found[i];
    }
    return SKINSLIDE_OK;
}

/* ---- All ---- */

/* The faces that count, of a mesh whose corners begin at start [mesh face_count + 1]. */
typedef struct chosen {
    const int32_t *start, *faces;
    int32_t count;
} chosen;

static void measure(strain *s, const chosen *of) {
    for (int32_t i = 0; i < of->count; i++)
        add_normal(s, of->start[of->faces[i]], s->mesh->face_counts[of->faces[i]]);
    for (int32_t i = 0; i < of->count; i++)
        for (int32_t n = s->mesh->face_counts[of->faces[i]], k = 0; k < n && n >= 3; k++)
            add_corner(s, corner_at(of->start[of->faces[i]], n, k));
}

static void write_directions(const strain *s, const chosen *of, float *out) {
    for (int64_t i = 0; i < 2 * (int64_t)s->mesh->index_count; i++)
        out[i] = 0;
    for (int32_t i = 0; i < of->count; i++)
        for (int32_t n = s->mesh->face_counts[of->faces[i]], k = 0; k < n && n >= 3; k++) {
            corner at = corner_at(of->start[of->faces[i]], n, k);
            find_direction(s, at, out + 2 * (int64_t)at.here);
        }
}

static skinslide_status check(const skinslide_mesh *mesh, const float *st, const int32_t *faces, int32_t face_count,
                              const float *points, skinslide_error *error) {
    skinslide_status status = ss_check_used(mesh, mesh->rest_points, "rest points", error);
    if (!status)
        status = ss_check_used(mesh, points, "points", error);
    if (!status)
        status = ss_check_faces(mesh->face_count, faces, face_count, error);
    for (int32_t f = 0, c = 0; !status && st && f < mesh->face_count; c += mesh->face_counts[f++])
        for (int32_t k = c; k < c + mesh->face_counts[f] && !status; k++)
            status = ss_check_st(st + 2 * (int64_t)k, f, error);
    return status;
}

skinslide_status skinslide_measure_strain(const skinslide_mesh *mesh, const float *st, const int32_t *faces, int32_t face_count,
                                          const float *points, const skinslide_strain *out, skinslide_error *error) {
    ss_taken_mesh taken;
    ss_memory memory = {0};
    skinslide_strain own = SKINSLIDE_STRAIN_DEFAULT;
    if (!points || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points, or no place for the strain");
    skinslide_status status = ss_take(out, "skinslide_strain", &own, sizeof own, error);
    if (!status && own.direction && !st)
        status = ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "there is no st for the direction of strain");
    if (!status)
        status = ss_take_mesh(&mesh, &taken, error);
    if (!status)
        status = check(mesh, st, faces, face_count, points, error);
    if (status)
        return status;
    int32_t *start = SS_NEW(&memory, int32_t, (int64_t)mesh->face_count + 1);
    strain s = {mesh, points, st, SS_NEW(&memory, tally, mesh->vertex_count)};
    if (memory.failed) {
        ss_free(&memory);
        return ss_out_of_memory(error);
    }
    ss_start_faces(mesh, start);
    const chosen of = {start, faces, face_count};
    measure(&s, &of);
    status = write_vertices(&s, &own, error);
    if (!status && own.direction)
        write_directions(&s, &of, own.direction);
    ss_free(&memory);
    return status;
}
