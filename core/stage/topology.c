/* A mesh of a scene: how its points make faces, and what else it has of its own. */
#include "mesh.h"
#include "stage.h"

#include "schema.inc"

#include <stdlib.h>
#include <string.h>

static const ss_input *mesh_inputs(skinslide_stage_group group) {
    int32_t count;
    return ss_inputs(group, &count);
}

static skinslide_status fill_mesh(skinslide_stage_mesh *mesh, skinslide_error *error) {
    mesh->vertex_count = -1;
    mesh->rest_row = -1;
    mesh->weld = SS_MESH_WELD_NUMBER, mesh->weld_tolerance = SS_MESH_WELD_TOLERANCE_NUMBER;
    mesh->world_space = SS_MESH_WORLD_SPACE_NUMBER;
    mesh->fold_case = SS_MESH_FOLD_CASE_NUMBER, mesh->compare_rest = SS_MESH_COMPARE_REST_NUMBER;
    skinslide_status status = ss_take_fallbacks(mesh_inputs(SKINSLIDE_STAGE_SUBDIVISION), SS_SUBDIVISION_ROWS, &mesh->memory,
                                                mesh->subdivision, error);
    mesh->subdivision[SS_ROW_SCHEME].choice = SKINSLIDE_SCHEME_NONE; /* until it is taken */
    return status;
}

skinslide_status skinslide_stage_mesh_create(skinslide_stage_mesh **out, skinslide_error *error) {
    if (!out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the mesh");
    skinslide_stage_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh)
        return ss_out_of_memory(error);
    skinslide_status status = fill_mesh(mesh, error);
    if (status)
        skinslide_stage_mesh_destroy(mesh);
    else
        *out = mesh;
    return status;
}

void skinslide_stage_mesh_destroy(skinslide_stage_mesh *mesh) {
    if (!mesh)
        return;
    ss_free(&mesh->memory);
    free(mesh);
}

/* ---- Points ---- */

static skinslide_status check_points(const ss_record *record, skinslide_error *error) {
    skinslide_status status = ss_check_positions(record, SKINSLIDE_BAD_POINTS, error);
    if (!status && !record->length)
        status = ss_refuse_empty(record, SKINSLIDE_BAD_POINTS, error);
    if (!status && record->length > INT32_MAX)
        status = ss_fail(error, SKINSLIDE_BAD_POINTS, SS_NAMED " has %lld values; there may be %d", SS_NAME(record->value.name),
                         (long long)record->length, INT32_MAX);
    return status;
}

static skinslide_status take_points(skinslide_stage_mesh *mesh, const ss_record *record, skinslide_error *error) {
    skinslide_status status = check_points(record, error);
    if (status)
        return status;
    mesh->first = SS_NEW(&mesh->memory, float, 3 * record->length);
    if (!mesh->first)
        return ss_out_of_memory(error);
    ss_copy_floats(record, mesh->first);
    mesh->vertex_count = (int32_t)record->length;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_points(const skinslide_stage_mesh *mesh, const skinslide_value *value, float *points,
                                        skinslide_error *error) {
    if (!mesh)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = check_points(&record, error);
    if (!status && record.length != mesh->vertex_count)
        status =
            ss_fail(error, SKINSLIDE_BAD_POINTS, SS_NAMED " has %lld values, but %d at first; the count must stay the same",
                    SS_NAME(record.value.name), (long long)record.length, mesh->vertex_count);
    if (!status && points)
        ss_copy_floats(&record, points);
    return status;
}

skinslide_status skinslide_stage_check_points(const skinslide_stage_mesh *mesh, const float *points, skinslide_error *error) {
    return mesh ? ss_check_points(points, mesh->vertex_count, "points", error)
                : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh");
}

/* ---- Faces ---- */

static skinslide_status take_array(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error) {
    const ss_input *input = &mesh_inputs(SKINSLIDE_STAGE_MESH)[row];
    skinslide_status status = ss_take_plain(input, record, SKINSLIDE_BAD_MESH, &mesh->memory, &mesh->taken[row], error);
    if (!status && !mesh->taken[row].array.count)
        status = ss_refuse_empty(record, SKINSLIDE_BAD_MESH, error);
    return status;
}

static skinslide_status take_face_counts(skinslide_stage_mesh *mesh, const ss_record *record, skinslide_error *error) {
    skinslide_status status = take_array(mesh, SS_ROW_FACE_COUNTS, record, error);
    const ss_array *counts = &mesh->taken[SS_ROW_FACE_COUNTS].array;
    return status ? status : ss_check_face_counts(counts->values, counts->count, error);
}

/* Finds where the corners of each face begin. Fails if the counts do not add up to the indices. */
static skinslide_status add_up(skinslide_stage_mesh *mesh, skinslide_error *error) {
    const ss_array *counts = &mesh->taken[SS_ROW_FACE_COUNTS].array, *indices = &mesh->taken[SS_ROW_FACE_INDICES].array;
    const int32_t *count = counts->values;
    int64_t total = 0;
    for (int32_t face = 0; face < counts->count; face++)
        total += count[face];
    if (total != indices->count)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "faceVertexCounts add up to %lld, but faceVertexIndices has %d values",
                       (long long)total, indices->count);
    mesh->face_start = SS_NEW(&mesh->memory, int32_t, (int64_t)counts->count + 1);
    if (!mesh->face_start)
        return ss_out_of_memory(error);
    for (int32_t face = 0; face < counts->count; face++)
        mesh->face_start[face + 1] = mesh->face_start[face] + count[face];
    return SKINSLIDE_OK;
}

static skinslide_status take_face_indices(skinslide_stage_mesh *mesh, const ss_record *record, skinslide_error *error) {
    skinslide_status status = take_array(mesh, SS_ROW_FACE_INDICES, record, error);
    if (status || !mesh->taken[SS_ROW_FACE_COUNTS].array.count || mesh->taken[SS_ROW_FACE_COUNTS].refused)
        return status;
    status = add_up(mesh, error);
    const int32_t *indices = mesh->taken[SS_ROW_FACE_INDICES].array.values;
    for (int32_t face = 0; !status && face < mesh->taken[SS_ROW_FACE_COUNTS].array.count; face++)
        for (int32_t c = mesh->face_start[face]; c < mesh->face_start[face + 1] && !status; c++)
            if (indices[c] < 0 || indices[c] >= mesh->vertex_count)
                status = ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has point %d, but the mesh has %d points", face,
                                 indices[c], mesh->vertex_count);
    mesh->has_faces = !status;
    return status;
}

static bool is_left_handed(const ss_record *record) {
    const skinslide_value *value = &record->value;
    return value->type == SKINSLIDE_VALUE_TEXT && !value->is_array && strcmp(value->data, "leftHanded") == 0;
}

skinslide_mesh ss_faces_of(const skinslide_stage_mesh *mesh) {
    const ss_array *counts = &mesh->taken[SS_ROW_FACE_COUNTS].array, *indices = &mesh->taken[SS_ROW_FACE_INDICES].array;
    return (skinslide_mesh){.size = sizeof(skinslide_mesh),
                            .vertex_count = mesh->vertex_count,
                            .face_count = counts->count,
                            .index_count = indices->count,
                            .face_counts = counts->values,
                            .face_indices = indices->values};
}

/* ---- The mesh ---- */

static skinslide_status take_number(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error) {
    double *numbers[] = {&mesh->weld, &mesh->weld_tolerance, &mesh->world_space, &mesh->fold_case, &mesh->compare_rest};
    skinslide_status status =
        ss_take_number(&mesh_inputs(SKINSLIDE_STAGE_MESH)[row], record, numbers[row - SS_ROW_WELD], error);
    return status || row != SS_ROW_COMPARE_REST ? status : ss_compare_mesh(mesh, error);
}

static skinslide_status take_of_mesh(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error) {
    switch (mesh_inputs(SKINSLIDE_STAGE_MESH)[row].kind) {
    case SS_KIND_POINTS:
        return take_points(mesh, record, error);
    case SS_KIND_FACE_COUNTS:
        return take_face_counts(mesh, record, error);
    case SS_KIND_FACE_INDICES:
        return take_face_indices(mesh, record, error);
    case SS_KIND_ORIENTATION:
        mesh->left_handed = is_left_handed(record);
        return SKINSLIDE_OK;
    case SS_KIND_NUMBER:
        return take_number(mesh, row, record, error);
    default:
        return ss_take_rest(mesh, row, record, error);
    }
}

skinslide_status skinslide_stage_mesh_take(skinslide_stage_mesh *mesh, const skinslide_stage_input *input,
                                           const skinslide_value *value, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_MESH, input), of_surface = ss_row_of(SKINSLIDE_STAGE_SUBDIVISION, input);
    if (!mesh || (row < 0 && of_surface < 0))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or no input of one");
    if (row > SS_ROW_POINTS && mesh->vertex_count < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the points of the mesh come first");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = row >= 0 ? take_of_mesh(mesh, row, &record, error) : ss_take_subdivision(mesh, of_surface, &record, error);
    (row >= 0 ? &mesh->taken[row] : &mesh->subdivision[of_surface])->refused = status != SKINSLIDE_OK;
    return status;
}

/* Checks that a number that was taken stays the same. */
static skinslide_status check_number(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, double frame,
                                     skinslide_error *error) {
    const double numbers[] = {mesh->weld, mesh->weld_tolerance, mesh->world_space, mesh->fold_case, mesh->compare_rest};
    double number = 0;
    skinslide_status status = ss_take_number(&mesh_inputs(SKINSLIDE_STAGE_MESH)[row], record, &number, error);
    if (!status && number != numbers[row - SS_ROW_WELD])
        status = ss_changes(record, frame, SKINSLIDE_BAD_CONTROL, error);
    return status;
}

static skinslide_status check_of_mesh(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, double frame,
                                      skinslide_error *error) {
    const ss_input *input = &mesh_inputs(SKINSLIDE_STAGE_MESH)[row];
    if (mesh->taken[row].refused)
        return SKINSLIDE_OK;
    switch (input->kind) {
    case SS_KIND_ORIENTATION:
        return is_left_handed(record) == mesh->left_handed ? SKINSLIDE_OK
                                                           : ss_changes(record, frame, SKINSLIDE_BAD_MESH, error);
    case SS_KIND_NUMBER:
        return check_number(mesh, row, record, frame, error);
    case SS_KIND_REST:
        return ss_check_rest_still(mesh, row, record, frame, error);
    default:
        return ss_check_plain(input, record, &mesh->taken[row], frame, SKINSLIDE_BAD_MESH, error);
    }
}

static bool is_still(int32_t row) {
    return row >= 0 && mesh_inputs(SKINSLIDE_STAGE_MESH)[row].shown.when == SKINSLIDE_STAGE_STILL;
}

skinslide_status skinslide_stage_mesh_check(const skinslide_stage_mesh *mesh, const skinslide_stage_input *input,
                                            const skinslide_value *value, double frame, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_MESH, input), of_surface = ss_row_of(SKINSLIDE_STAGE_SUBDIVISION, input);
    if (!mesh || (!is_still(row) && of_surface < 0))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or no input of one that must stay the same");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (status)
        return status;
    return row >= 0 ? check_of_mesh(mesh, row, &record, frame, error)
                    : ss_check_subdivision_still(mesh, of_surface, &record, frame, error);
}

skinslide_status skinslide_stage_mesh_faces(const skinslide_stage_mesh *mesh, skinslide_mesh *out, skinslide_error *error) {
    if (!mesh || !out || !mesh->has_faces)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh with faces, or no place for it");
    skinslide_status status = ss_check_size(out, "skinslide_mesh", error);
    if (status)
        return status;
    skinslide_mesh own = ss_faces_of(mesh);
    own.rest_points = mesh->rest;
    ss_give(&own, sizeof own, out);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_mesh_get(const skinslide_stage_mesh *mesh, skinslide_mesh *out, skinslide_error *error) {
    if (!mesh || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or no place for it");
    skinslide_status status = ss_check_refused(mesh_inputs(SKINSLIDE_STAGE_MESH), mesh->taken, SS_MESH_ROWS, error);
    if (!status)
        status = ss_check_refused(mesh_inputs(SKINSLIDE_STAGE_SUBDIVISION), mesh->subdivision, SS_SUBDIVISION_ROWS, error);
    if (!status && (!mesh->has_faces || !mesh->rest))
        status = ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the faces or the rest points of the mesh were not given");
    if (!status)
        status = ss_check_size(out, "skinslide_mesh", error);
    if (status)
        return status;
    skinslide_mesh own = ss_faces_of(mesh);
    own.rest_points = mesh->rest;
    own.subdivision = mesh->subdivided.scheme == SKINSLIDE_SCHEME_NONE ? NULL : &mesh->subdivided;
    own.space = mesh->world_space != 0 && mesh->has_space ? mesh->space : NULL;
    ss_give(&own, sizeof own, out);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_mesh_weld(const skinslide_stage_mesh *mesh, const skinslide_patch_setup *setups,
                                           int32_t setup_count, skinslide_weld **out, skinslide_error *error) {
    skinslide_mesh own = SKINSLIDE_MESH_DEFAULT;
    skinslide_status status = skinslide_stage_mesh_get(mesh, &own, error);
    if (status || !out)
        return status ? status : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the weld");
    if (mesh->weld == 0) {
        *out = NULL;
        return SKINSLIDE_OK;
    }
    return skinslide_weld_create(&own, setups, setup_count, mesh->weld_tolerance, out, error);
}

skinslide_bool skinslide_stage_mesh_left_handed(const skinslide_stage_mesh *mesh) {
    return mesh->left_handed;
}
