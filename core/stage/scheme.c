/* How a mesh is subdivided when it is rendered: scheme, rules, creases, corners and holes. Whether its arrays fit each other
 * and the mesh is checked when limit surfaces are built. */
#include "stage.h"

static const ss_input *inputs(void) {
    int32_t count;
    return ss_inputs(SKINSLIDE_STAGE_SUBDIVISION, &count);
}

static bool is_none(const skinslide_stage_mesh *mesh) {
    return mesh->subdivision[SS_ROW_SCHEME].choice == SKINSLIDE_SCHEME_NONE;
}

static void fill(skinslide_stage_mesh *mesh) {
    const ss_taken *taken = mesh->subdivision;
    mesh->subdivided = (skinslide_subdivision){
        .size = sizeof(skinslide_subdivision),
        .scheme = (skinslide_scheme)taken[SS_ROW_SCHEME].choice,
        .boundary_rule = (skinslide_boundary_rule)taken[SS_ROW_BOUNDARY_RULE].choice,
        .triangle_rule = (skinslide_triangle_rule)taken[SS_ROW_TRIANGLE_RULE].choice,
        .crease_count = taken[SS_ROW_CREASE_LENGTHS].array.count,
        .crease_index_count = taken[SS_ROW_CREASE_INDICES].array.count,
        .crease_sharpness_count = taken[SS_ROW_CREASE_SHARPNESSES].array.count,
        .crease_lengths = taken[SS_ROW_CREASE_LENGTHS].array.values,
        .crease_indices = taken[SS_ROW_CREASE_INDICES].array.values,
        .crease_sharpnesses = taken[SS_ROW_CREASE_SHARPNESSES].array.values,
        .corner_count = taken[SS_ROW_CORNER_INDICES].array.count,
        .corner_indices = taken[SS_ROW_CORNER_INDICES].array.values,
        .corner_sharpnesses = taken[SS_ROW_CORNER_SHARPNESSES].array.values,
        .hole_count = taken[SS_ROW_HOLE_INDICES].array.count,
        .hole_indices = taken[SS_ROW_HOLE_INDICES].array.values,
    };
}

/* The only arrays that share one count in skinslide_subdivision, so that they must be compared here. */
static skinslide_status check_corners(const skinslide_stage_mesh *mesh, skinslide_error *error) {
    int32_t corners = mesh->subdivision[SS_ROW_CORNER_INDICES].array.count;
    int32_t sharpnesses = mesh->subdivision[SS_ROW_CORNER_SHARPNESSES].array.count;
    if (corners == sharpnesses)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_MESH, "corner sharpnesses: %d values for %d corners", sharpnesses, corners);
}

skinslide_status ss_take_subdivision(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error) {
    if (row != SS_ROW_SCHEME && is_none(mesh))
        return SKINSLIDE_OK;
    skinslide_status status =
        ss_take_plain(&inputs()[row], record, SKINSLIDE_BAD_MESH, &mesh->memory, &mesh->subdivision[row], error);
    if (!status && row == SS_ROW_CORNER_SHARPNESSES)
        status = check_corners(mesh, error);
    if (!status)
        fill(mesh);
    return status;
}

skinslide_status ss_check_subdivision_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record,
                                            double frame, skinslide_error *error) {
    if ((row != SS_ROW_SCHEME && is_none(mesh)) || mesh->subdivision[row].refused)
        return SKINSLIDE_OK;
    return ss_check_plain(&inputs()[row], record, &mesh->subdivision[row], frame, SKINSLIDE_BAD_MESH, error);
}
