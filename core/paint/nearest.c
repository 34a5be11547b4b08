/* The other side of a mesh whose faces are not symmetric, though its surface is: quads cut along other diagonals, say. A face
 * is of the other side where the mirror image of its middle is nearest to a face of this one, and its points are where theirs
 * are nearest to the mesh.
 *
 * Faces are sorted along an axis of the plane, and looked at from where a place is outwards, as far as any nearer one can
 * be. */
#include "paint.h"

#include <math.h>
#include <stdlib.h>

/* A face, by the place of its middle. */
typedef struct spot {
    double along;
    int32_t face;
} spot;

typedef struct search {
    const skinslide_mesh *mesh;
    int axis, along;
    double plane, tolerance, reach; /* reach: how far a point of a face is from its middle, along, at most */
    int32_t *face_start;            /* [face_count + 1] */
    spot *spots;                    /* [face_count] ascending */
    uint8_t *is_chosen, *is_found;  /* [face_count] */
    double worst;
} search;

/* The nearest place to another. */
typedef struct found {
    int32_t face, vertex; /* vertex: the corner of the face that is nearest */
    double distance;
} found;

/* ---- Distances ---- */

static void point_of(const search *s, int32_t vertex, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = s->mesh->rest_points[3 * (int64_t)vertex + k];
}

static double apart(const double a[3], const double b[3]) {
    double way[3];
    ss_subtract(a, b, way);
    return ss_length(way);
}

static double to_side(const double at[3], const double a[3], const double b[3]) {
    double side[3], off[3];
    ss_subtract(b, a, side), ss_subtract(at, a, off);
    double length = ss_dot(side, side), share = length > 0 ? fmin(fmax(ss_dot(side, off) / length, 0), 1) : 0;
    ss_add(-share, side, off);
    return ss_length(off);
}

/* The distance to a triangle: along its normal where that meets the triangle, else to its sides. */
static double to_triangle(const double at[3], double corners[3][3]) {
    double a[3], b[3], off[3], normal[3], inside[3];
    ss_subtract(corners[1], corners[0], a), ss_subtract(corners[2], corners[0], b), ss_subtract(at, corners[0], off);
    ss_cross(a, b, normal);
    double area = ss_dot(normal, normal), least = INFINITY;
    ss_cross(off, b, inside);
    double v = ss_dot(inside, normal) / area;
    ss_cross(a, off, inside);
    double w = ss_dot(inside, normal) / area;
    if (area > 0 && v >= 0 && w >= 0 && v + w <= 1)
        return fabs(ss_dot(off, normal)) / sqrt(area);
    for (int k = 0; k < 3; k++)
        least = fmin(least, to_side(at, corners[k], corners[(k + 1) % 3]));
    return least;
}

/* The distance to the fan of a face. */
static double to_face(const search *s, const double at[3], int32_t face) {
    double corners[3][3], least = INFINITY;
    int32_t start = s->face_start[face], end = s->face_start[face + 1];
    point_of(s, s->mesh->face_indices[start], corners[0]);
    for (int32_t c = start + 1; c + 1 < end; c++) {
        point_of(s, s->mesh->face_indices[c], corners[1]), point_of(s, s->mesh->face_indices[c + 1], corners[2]);
        least = fmin(least, to_triangle(at, corners));
    }
    return least;
}

/* ---- Faces by place ---- */

static void middle_of(const search *s, int32_t face, double out[3]) {
    int32_t start = s->face_start[face], count = s->face_start[face + 1] - start;
    out[0] = out[1] = out[2] = 0;
    for (int32_t c = start; c < start + count; c++)
        for (int k = 0; k < 3; k++)
            out[k] += s->mesh->rest_points[3 * (int64_t)s->mesh->face_indices[c] + k] / (double)count;
}

static int by_place(const void *a, const void *b) {
    const spot *x = a, *y = b;
    if (x->along != y->along)
        return x->along < y->along ? -1 : 1;
    return ss_ascending(&x->face, &y->face);
}

static void sort_faces(search *s) {
    for (int32_t f = 0; f < s->mesh->face_count; f++) {
        double middle[3];
        middle_of(s, f, middle);
        s->spots[f] = (spot){middle[s->along], f};
        for (int32_t c = s->face_start[f]; c < s->face_start[f + 1]; c++) {
            double here = s->mesh->rest_points[3 * (int64_t)s->mesh->face_indices[c] + s->along];
            s->reach = fmax(s->reach, fabs(here - middle[s->along]));
        }
    }
    qsort(s->spots, (size_t)s->mesh->face_count, sizeof *s->spots, by_place);
}

static int32_t first_spot(const search *s, double along) {
    int32_t begin = 0, end = s->mesh->face_count;
    while (begin < end) {
        int32_t middle = begin + (end - begin) / 2;
        if (s->spots[middle].along < along)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static void look_at(const search *s, const double at[3], int32_t face, found *best) {
    double distance = to_face(s, at, face);
    if (distance < best->distance || (distance == best->distance && face < best->face))
        *best = (found){face, -1, distance};
}

/* The face nearest to a place, the lowest of several. */
static found nearest_to(const search *s, const double at[3]) {
    found best = {-1, -1, INFINITY};
    int32_t after = first_spot(s, at[s->along]), before = after - 1, count = s->mesh->face_count;
    for (bool more = true; more;) {
        more = false;
        if (after < count && s->spots[after].along - at[s->along] <= best.distance + s->reach)
            look_at(s, at, s->spots[after++].face, &best), more = true;
        if (before >= 0 && at[s->along] - s->spots[before].along <= best.distance + s->reach)
            look_at(s, at, s->spots[before--].face, &best), more = true;
    }
    double least = INFINITY;
    for (int32_t c = best.face < 0 ? 0 : s->face_start[best.face]; best.face >= 0 && c < s->face_start[best.face + 1]; c++) {
        double corner[3];
        point_of(s, s->mesh->face_indices[c], corner);
        if (apart(at, corner) < least)
            least = apart(at, corner), best.vertex = s->mesh->face_indices[c];
    }
    return best;
}

static void mirror_point(const search *s, double at[3]) {
    at[s->axis] = 2 * s->plane - at[s->axis];
}

/* ---- The other side ---- */

static void find_faces(search *s, int32_t *sources) {
    for (int32_t f = 0; f < s->mesh->face_count; f++) {
        double middle[3];
        middle_of(s, f, middle);
        mirror_point(s, middle);
        found source = s->mesh->face_counts[f] > 2 ? nearest_to(s, middle) : (found){-1, -1, INFINITY};
        s->is_found[f] = source.face >= 0 && s->is_chosen[source.face];
        sources[f] = s->is_found[f] ? source.face : -1;
    }
}

/* Finds the mirror images of the points of one side's faces on the mesh, and fails where one is too far from it. sources
 * [vertex_count], or NULL. */
static skinslide_status find_points(search *s, const uint8_t *side, int32_t *sources, skinslide_error *error) {
    for (int32_t f = 0; f < s->mesh->face_count; f++)
        for (int32_t c = s->face_start[f]; side[f] && c < s->face_start[f + 1]; c++) {
            int32_t vertex = s->mesh->face_indices[c];
            double at[3];
            point_of(s, vertex, at);
            mirror_point(s, at);
            found source = nearest_to(s, at);
            if (!(source.distance <= s->tolerance))
                return ss_fail(error, SKINSLIDE_BAD_MESH, "the mirror image of point %d beyond %c = %g is %g from the mesh",
                               vertex, ss_axis_name(s->axis), s->plane, source.distance);
            s->worst = fmax(s->worst, source.distance);
            if (sources)
                sources[vertex] = source.vertex;
        }
    return SKINSLIDE_OK;
}

static bool allocate(search *s, ss_memory *memory) {
    s->face_start = SS_NEW(memory, int32_t, (int64_t)s->mesh->face_count + 1);
    s->spots = SS_NEW(memory, spot, s->mesh->face_count);
    s->is_chosen = SS_NEW(memory, uint8_t, s->mesh->face_count);
    s->is_found = SS_NEW(memory, uint8_t, s->mesh->face_count);
    return !memory->failed;
}

static skinslide_status run(search *s, const int32_t *faces, int32_t face_count, int32_t *face_sources, int32_t *sources,
                            skinslide_error *error) {
    int32_t count = 0;
    ss_start_faces(s->mesh, s->face_start);
    s->along = ss_sort_along(s->mesh, s->axis, &s->tolerance);
    sort_faces(s);
    for (int32_t i = 0; i < face_count; i++)
        s->is_chosen[faces[i]] = 1;
    for (int32_t v = 0; v < s->mesh->vertex_count; v++)
        sources[v] = -1;
    find_faces(s, face_sources);
    for (int32_t f = 0; f < s->mesh->face_count; f++)
        count += s->is_found[f];
    skinslide_status status = find_points(s, s->is_chosen, NULL, error);
    if (!status && !count)
        status =
            ss_fail(error, SKINSLIDE_BAD_MESH, "no face is beyond %c = %g where these are", ss_axis_name(s->axis), s->plane);
    return status ? status : find_points(s, s->is_found, sources, error);
}

skinslide_status skinslide_mirror_nearest(const skinslide_mesh *mesh, const skinslide_mirror_options *options,
                                          const int32_t *faces, int32_t face_count, int32_t *face_sources,
                                          int32_t *vertex_sources, double *worst, skinslide_error *error) {
    ss_taken_mesh taken;
    skinslide_mirror_options about = SKINSLIDE_MIRROR_OPTIONS_DEFAULT;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (!status)
        status = ss_take_mirror(mesh, options, faces, face_count, &about, error);
    if (status || !face_sources || !vertex_sources || !worst)
        return status ? status : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for what is nearest");
    ss_memory memory = {0};
    search s = {.mesh = mesh, .axis = about.axis, .plane = about.plane, .tolerance = about.tolerance};
    int32_t *own_faces = SS_NEW(&memory, int32_t, mesh->face_count), *own = SS_NEW(&memory, int32_t, mesh->vertex_count);
    status = allocate(&s, &memory) ? run(&s, faces, face_count, own_faces, own, error) : ss_out_of_memory(error);
    for (int32_t f = 0; !status && f < mesh->face_count; f++)
        face_sources[f] = own_faces[f];
    for (int32_t v = 0; !status && v < mesh->vertex_count; v++)
        vertex_sources[v] = own[v];
    if (!status)
        *worst = s.worst;
    ss_free(&memory);
    return status;
}
