/* Rest points: the pose in which nothing slides. Of several candidates the first that is authored counts, good or bad. */
#include "stage.h"

#include <math.h>
#include <stdio.h>

const char *skinslide_stage_mesh_rest_source(const skinslide_stage_mesh *mesh) {
    return mesh->rest ? mesh->rest_source : "";
}

const char *skinslide_stage_mesh_rest_warning(const skinslide_stage_mesh *mesh) {
    return mesh ? mesh->rest_warning : NULL;
}

static skinslide_status none_found(skinslide_error *error) {
    int32_t count;
    const ss_input *inputs = ss_inputs(SKINSLIDE_STAGE_MESH, &count);
    const skinslide_stage_input *own = &inputs[SS_ROW_REST_POINTS].shown, *primvar = &inputs[SS_ROW_REST].shown;
    return ss_fail(error, SKINSLIDE_BAD_POINTS,
                   "has no rest points: points has samples but no default value, so author the rest pose as %s%s or %s%s "
                   "(point3f[], vertex)",
                   own->prefix, own->name, primvar->prefix, primvar->name);
}

static skinslide_status refuse(const float *rest, int32_t vertex, const char *source, skinslide_error *error) {
    const float *at = rest + 3 * (int64_t)vertex;
    return ss_fail(error, SKINSLIDE_BAD_POINTS, "rest points: " SS_NAMED "[%d] is (%g, %g, %g)", SS_NAME(source), vertex,
                   (double)at[0], (double)at[1], (double)at[2]);
}

/* Checks the points that faces use: without faces nothing slides. */
static skinslide_status check_faces(const skinslide_stage_mesh *mesh, const float *rest, const char *source,
                                    skinslide_error *error) {
    const ss_array *corners = &mesh->taken[SS_ROW_FACE_INDICES].array;
    int32_t first = INT32_MAX;
    for (int32_t c = 0; mesh->has_faces && c < corners->count; c++) {
        int32_t v = ((const int32_t *)corners->values)[c];
        first = v < first && !ss_is_finite(rest + 3 * (int64_t)v) ? v : first;
    }
    return first == INT32_MAX ? SKINSLIDE_OK : refuse(rest, first, source, error);
}

/* Warns of other points that are not finite, once those that faces use are known to be. */
static skinslide_status warn_of_others(skinslide_stage_mesh *mesh, const float *rest, const char *source,
                                       skinslide_error *error) {
    int32_t count = 0, first = 0;
    for (int32_t v = 0; mesh->has_faces && v < mesh->vertex_count; v++)
        if (!ss_is_finite(rest + 3 * (int64_t)v))
            first = count++ ? first : v;
    if (!count)
        return SKINSLIDE_OK;
    skinslide_error refusal;
    refuse(rest, first, source, &refusal);
    char *warning = SS_NEW(&mesh->memory, char, sizeof refusal.message + 96);
    if (!warning)
        return ss_out_of_memory(error);
    char more[32] = "";
    if (count > 1)
        snprintf(more, sizeof more, ", and %d more like it", count - 1);
    snprintf(warning, sizeof refusal.message + 96, "%s, which counts for nothing, since no face has it%s", refusal.message,
             more);
    mesh->rest_warning = warning;
    return SKINSLIDE_OK;
}

static skinslide_status copy_rest(skinslide_stage_mesh *mesh, const ss_record *record, const char *source,
                                  skinslide_error *error) {
    if (record->length != mesh->vertex_count)
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "rest points: " SS_NAMED " has %lld values, but points has %d",
                       SS_NAME(source), (long long)record->length, mesh->vertex_count);
    float *rest = SS_NEW(&mesh->memory, float, 3 * record->length);
    mesh->rest_source = ss_copy_text(&mesh->memory, source);
    if (mesh->memory.failed)
        return ss_out_of_memory(error);
    ss_copy_floats(record, rest);
    skinslide_status status = check_faces(mesh, rest, source, error);
    if (!status)
        status = warn_of_others(mesh, rest, source, error);
    if (!status)
        mesh->rest = rest;
    return status;
}

static bool is_other(float a, float b) {
    return a != b && !(isnan(a) && isnan(b));
}

/* Whether a later value of the candidate that is used comes to the rest points that were taken. */
static bool is_same_rest(const skinslide_stage_mesh *mesh, const ss_record *record) {
    if (record->length != mesh->vertex_count)
        return false;
    for (int64_t i = 0; i < 3 * record->length; i++)
        if (is_other((float)ss_number(record, i / 3, (int32_t)(i % 3)), mesh->rest[i]))
            return false;
    return true;
}

skinslide_status ss_check_rest_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, double frame,
                                     skinslide_error *error) {
    if (row != mesh->rest_row || !mesh->rest)
        return SKINSLIDE_OK;
    skinslide_status status = ss_has_value(record) ? ss_check_positions(record, SKINSLIDE_BAD_POINTS, error) : SKINSLIDE_OK;
    if (!status && (!ss_has_value(record) || !is_same_rest(mesh, record)))
        status = ss_changes(record, frame, SKINSLIDE_BAD_POINTS, error);
    return status;
}

skinslide_status ss_take_rest(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error) {
    char source[256];
    bool is_last = row == SS_ROW_DEFAULT_POINTS, is_primvar = row > SS_ROW_REST_POINTS && !is_last;
    if (mesh->rest_row >= 0 && mesh->rest_row < row)
        return SKINSLIDE_OK;
    if (record->value.type == SKINSLIDE_VALUE_NONE)
        return is_last ? none_found(error) : SKINSLIDE_OK;
    snprintf(source, sizeof source, SS_NAMED "%s", SS_NAME(record->value.name), is_last ? " (default)" : "");
    mesh->rest_row = row;
    mesh->rest = NULL, mesh->rest_warning = NULL;
    skinslide_status status =
        is_primvar ? ss_check_by_vertex(record, "rest points: ", SKINSLIDE_BAD_POINTS, error) : SKINSLIDE_OK;
    if (!status && !ss_has_value(record))
        status = none_found(error);
    if (!status)
        status = ss_check_positions(record, SKINSLIDE_BAD_POINTS, error);
    return status ? status : copy_rest(mesh, record, source, error);
}
