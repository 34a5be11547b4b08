/* Whether rest is of the cache: edges are compared, each with its length at rest, in the first pose of the cache:
 *
 *     r = |edge in the cache| / |edge at rest|
 *
 * The median over a mesh is the scale between the two, since most of a mesh turns and does not stretch. The mean of
 * |log(r / median)| is the spread, and the RMS of log r how far apart the two are. A patch of other points, or of points in
 * another order, has much of both: a spread of 0.45 on a sheet of squares and more on a body, and 1 to 5 of the other. Poses
 * have little: the most extreme of the examples, a sleeve at an elbow bent by 110 degrees, has 0.3 or less of either. */
#include "stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Rest is of another scale beyond this factor, either way: an inch has 2.54 cm, and a character that grows by less only
 * stretches. */
static const double other_scale = 2;
/* As factors: the spread from which rest resembles the cache poorly and its scale means nothing, and how far apart the two are
 * when sliding is senseless. */
static const double poor = 1.4, senseless = 2;
/* The most that one edge adds to the spread: one stray point does not mean that points are in another order. */
static const double most_of_one = 4;

typedef struct ratios {
    const skinslide_stage_mesh *mesh;
    double *values; /* finite, above 0 */
    int32_t count;
} ratios;

/* Leaves out sides that have no length in either pose; points that are not finite are reported when they are slid. */
static void add_face(ratios *own, int32_t face) {
    const skinslide_stage_mesh *mesh = own->mesh;
    const int32_t *indices = mesh->taken[SS_ROW_FACE_INDICES].array.values;
    int32_t first = mesh->face_start[face], end = mesh->face_start[face + 1];
    for (int32_t c = first; c < end; c++) {
        int32_t a = indices[c], b = indices[c + 1 < end ? c + 1 : first];
        double at_rest = ss_distance(mesh->rest, a, b), cached = ss_distance(mesh->first, a, b);
        if (at_rest > 0 && cached > 0 && isfinite(cached))
            own->values[own->count++] = cached / at_rest;
    }
}

typedef struct likeness {
    double median, spread, apart; /* factors */
} likeness;

/* The value at place k if all were sorted, found byte by byte from the highest on: positive doubles are in the order of their
 * bits. */
static double ranked(const double *values, int64_t count, int64_t k) {
    uint64_t found = 0, bits;
    for (int shift = 56; shift >= 0; shift -= 8) {
        int64_t counts[256] = {0};
        for (int64_t i = 0; i < count; i++) {
            memcpy(&bits, &values[i], sizeof bits);
            counts[bits >> shift & 255] += ((bits ^ found) >> shift) < 256;
        }
        int byte = 0;
        while (k >= counts[byte])
            k -= counts[byte++];
        found |= (uint64_t)byte << shift;
    }
    double value;
    memcpy(&value, &found, sizeof value);
    return value;
}

/* Finds the median, the spread and how far apart the two are. Replaces the values by their logarithms. */
static likeness compare(ratios *own) {
    if (!own->count)
        return (likeness){1, 1, 1};
    double median = ranked(own->values, own->count, own->count / 2), spread = 0, apart = 0;
    double middle = ss_log(median), most = ss_log(most_of_one);
    ss_logs(own->count, own->values);
    for (int32_t i = 0; i < own->count; i++) {
        double off = own->values[i];
        spread += ss_least(fabs(off - middle), most);
        apart += off * off;
    }
    return (likeness){median, ss_exp(spread / own->count), ss_exp(sqrt(apart / own->count))};
}

static bool can_compare(const skinslide_stage_mesh *mesh) {
    return mesh->has_faces && mesh->rest && mesh->first && mesh->compare_rest != 0;
}

/* Scales the rest points, so that lengths and what follows from them are on the cache's scale. */
static skinslide_status take_scale(skinslide_stage_mesh *mesh, double scale, skinslide_error *error) {
    char *warning = SS_NEW(&mesh->memory, char, 128);
    if (!warning)
        return ss_out_of_memory(error);
    for (int64_t i = 0; i < 3 * (int64_t)mesh->vertex_count; i++)
        mesh->rest[i] = (float)(scale * mesh->rest[i]);
    snprintf(warning, 128, "rest is %.3g times the size of the cache: lengths are taken at that scale", 1 / scale);
    mesh->warning = warning;
    return SKINSLIDE_OK;
}

static int32_t corners_of(const skinslide_stage_mesh *mesh, int32_t face) {
    return mesh->face_start[face + 1] - mesh->face_start[face];
}

/* Compares the faces that were chosen, or if that is NULL, all of the mesh. */
static skinslide_status compare_faces(const skinslide_stage_mesh *mesh, const ss_array *faces, likeness *out,
                                      skinslide_error *error) {
    ss_memory scratch = {0};
    int32_t count = faces ? faces->count : mesh->taken[SS_ROW_FACE_COUNTS].array.count;
    int64_t corners = 0;
    for (int32_t i = 0; i < count; i++)
        corners += corners_of(mesh, faces ? ((const int32_t *)faces->values)[i] : i);
    ratios own = {mesh, SS_NEW(&scratch, double, corners), 0};
    if (!own.values)
        return ss_out_of_memory(error);
    for (int32_t i = 0; i < count; i++)
        add_face(&own, faces ? ((const int32_t *)faces->values)[i] : i);
    *out = compare(&own);
    ss_free(&scratch);
    return SKINSLIDE_OK;
}

/* Edges that do not agree give no scale. */
skinslide_status ss_compare_mesh(skinslide_stage_mesh *mesh, skinslide_error *error) {
    likeness own;
    mesh->warning = NULL;
    if (!can_compare(mesh))
        return SKINSLIDE_OK;
    skinslide_status status = compare_faces(mesh, NULL, &own, error);
    bool is_other = !status && own.spread <= poor && (own.median > other_scale || own.median < 1 / other_scale);
    return is_other ? take_scale(mesh, own.median, error) : status;
}

static skinslide_status warn(skinslide_stage_patch *patch, double spread, skinslide_error *error) {
    char *warning = SS_NEW(&patch->memory, char, 160);
    if (!warning)
        return ss_out_of_memory(error);
    snprintf(warning, 160, "rest resembles the cache poorly at first: lengths of edges differ by a factor of %.3g on average",
             spread);
    patch->warning = warning;
    return SKINSLIDE_OK;
}

skinslide_status ss_compare_patch(skinslide_stage_patch *patch, skinslide_error *error) {
    likeness own;
    patch->unlike = 0, patch->warning = NULL;
    if (!can_compare(patch->mesh))
        return SKINSLIDE_OK;
    skinslide_status status = compare_faces(patch->mesh, &patch->faces, &own, error);
    if (status || own.spread <= poor)
        return status;
    patch->unlike = own.apart > senseless ? own.apart : 0;
    return patch->unlike > 0 ? SKINSLIDE_OK : warn(patch, own.spread, error);
}

skinslide_status ss_check_likeness(const skinslide_stage_patch *patch, skinslide_error *error) {
    int32_t count;
    const skinslide_stage_input *option = &ss_inputs(SKINSLIDE_STAGE_MESH, &count)[SS_ROW_COMPARE_REST].shown;
    if (!(patch->unlike > 0))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_POINTS,
                   "rest is not that of the cache: lengths of edges differ by a factor of %.3g (RMS) at first, and %g is the "
                   "most; are its points in another order? %s%s = false takes it as it is",
                   patch->unlike, senseless, option->prefix, option->name);
}

const char *skinslide_stage_mesh_warning(const skinslide_stage_mesh *mesh) {
    return mesh ? mesh->warning : NULL;
}

const char *skinslide_stage_patch_warning(const skinslide_stage_patch *patch) {
    return patch ? patch->warning : NULL;
}
