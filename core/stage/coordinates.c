/* Texture coordinates of a mesh's corners, and which primvars have some. */
#include "stage.h"

#include <stdio.h>
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

/* ---- Those that there are ---- */

static bool is_pairs(const char *type_name) {
    static const char *const types[] = {"texCoord2f[]", "texCoord2h[]", "texCoord2d[]", "float2[]", "half2[]", "double2[]"};
    bool found = false;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        found = found || strcmp(type_name, types[i]) == 0;
    return found;
}

skinslide_status skinslide_stage_mesh_offer(skinslide_stage_mesh *mesh, const char *name, const char *type_name,
                                            const char *interpolation, skinslide_error *error) {
    if (!mesh || !name || !type_name)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or no name or type of what it has");
    const char *by = interpolation ? interpolation : "constant", *before = mesh->coordinates ? mesh->coordinates : "";
    if (!is_pairs(type_name) || !(ss_is_by_vertex(by) || strcmp(by, "faceVarying") == 0))
        return SKINSLIDE_OK;
    size_t size = strlen(before) + sizeof ", " + strlen(name);
    char *names = SS_NEW(&mesh->memory, char, (int64_t)size);
    if (!names)
        return ss_out_of_memory(error);
    snprintf(names, size, "%s%s%s", before, *before ? ", " : "", name);
    mesh->coordinates = names;
    return SKINSLIDE_OK;
}

const char *skinslide_stage_mesh_coordinates(const skinslide_stage_mesh *mesh) {
    return mesh && mesh->coordinates ? mesh->coordinates : "";
}
