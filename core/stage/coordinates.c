/* Texture coordinates of a mesh's corners. */
#include "stage.h"

#include <string.h>

static skinslide_status check(const skinslide_stage_mesh *mesh, const ss_record *record, bool *by_corner,
                              skinslide_error *error) {
    const skinslide_value *value = &record->value;
    const char *interpolation = ss_interpolation(record);
    bool is_pairs =
        value->type >= SKINSLIDE_VALUE_HALF && value->type <= SKINSLIDE_VALUE_DOUBLE && value->is_array && value->width == 2;
    *by_corner = strcmp(interpolation, "faceVarying") == 0;
    if (!*by_corner && !ss_is_by_vertex(interpolation))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL,
                       SS_NAMED " has interpolation " SS_NAMED "; a map needs faceVarying, vertex or varying",
                       SS_NAME(value->name), SS_NAME(interpolation));
    if (value->count > 0 && !is_pairs)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " is " SS_NAMED "; a map needs pairs of floats",
                       SS_NAME(value->name), SS_NAME(value->type_name));
    skinslide_status status = ss_check_indices(record, SKINSLIDE_BAD_CONTROL, error);
    if (status)
        return status;
    return *by_corner ? ss_check_length(record, ss_faces_of(mesh).index_count, "face corners", SKINSLIDE_BAD_CONTROL, error)
                      : ss_check_length(record, mesh->vertex_count, "points", SKINSLIDE_BAD_CONTROL, error);
}

skinslide_status skinslide_stage_coordinates(const skinslide_stage_mesh *mesh, const skinslide_value *value, float *st,
                                             skinslide_error *error) {
    if (!mesh || !mesh->has_faces || !st)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh with faces, or no place for the coordinates");
    ss_record record;
    bool by_corner = false;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = check(mesh, &record, &by_corner, error);
    if (status)
        return status;
    skinslide_mesh faces = ss_faces_of(mesh);
    for (int32_t c = 0; c < faces.index_count; c++)
        for (int32_t k = 0; k < 2; k++)
            st[2 * (int64_t)c + k] = (float)ss_number(&record, by_corner ? c : faces.face_indices[c], k);
    return SKINSLIDE_OK;
}
