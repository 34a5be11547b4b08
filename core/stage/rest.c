/* Rest points: the pose in which nothing slides. Of several candidates the first that is authored counts, good or bad. */
#include "stage.h"

#include <stdio.h>
#include <string.h>

const char *skinslide_stage_mesh_rest_source(const skinslide_stage_mesh *mesh) {
    return mesh->rest ? mesh->rest_source : "";
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

static skinslide_status check_finite(const float *rest, int64_t count, const char *source, skinslide_error *error) {
    for (int64_t i = 0; i < count; i++, rest += 3)
        if (!ss_is_finite(rest))
            return ss_fail(error, SKINSLIDE_BAD_POINTS, "rest points: " SS_NAMED "[%lld] is (%g, %g, %g)", SS_NAME(source),
                           (long long)i, (double)rest[0], (double)rest[1], (double)rest[2]);
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
    skinslide_status status = check_finite(rest, record->length, source, error);
    if (!status)
        mesh->rest = rest;
    return status;
}

/* Of one that counts. */
static bool is_same_rest(const skinslide_stage_mesh *mesh, const ss_record *record) {
    if (record->length != mesh->vertex_count)
        return false;
    for (int64_t i = 0; i < 3 * record->length; i++)
        if ((float)ss_number(record, i / 3, (int32_t)(i % 3)) != mesh->rest[i])
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
    mesh->rest = NULL;
    skinslide_status status =
        is_primvar ? ss_check_by_vertex(record, "rest points: ", SKINSLIDE_BAD_POINTS, error) : SKINSLIDE_OK;
    if (!status && !ss_has_value(record))
        status = none_found(error);
    if (!status)
        status = ss_check_positions(record, SKINSLIDE_BAD_POINTS, error);
    return status ? status : copy_rest(mesh, record, source, error);
}
