/* The maps of controls: textures that multiply paint, the texture coordinates at which they are sampled, and the files that
 * they need. A map that is the base's becomes the controls' own when its asset or its coordinates change. */
#include "stage.h"

/* Makes a texture its own. */
static skinslide_status own_texture(skinslide_stage_controls *controls, int32_t row, skinslide_error *error) {
    ss_control *own = &controls->controls[row];
    if (!own->own_texture)
        own->own_texture = ss_texture_create(ss_control_input(row), controls->patch);
    own->texture = own->own_texture;
    own->unplaced = true;
    return own->own_texture ? SKINSLIDE_OK : ss_out_of_memory(error);
}

skinslide_status ss_take_texture(skinslide_stage_controls *controls, int32_t row, const ss_record *record,
                                 skinslide_error *error) {
    ss_control *own = &controls->controls[row];
    own->base_texture = NULL;
    skinslide_status status = own_texture(controls, row, error);
    return status ? status : ss_texture_take(own->own_texture, record, error);
}

const skinslide_stage_input *skinslide_stage_controls_coordinates(const skinslide_stage_controls *controls) {
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++)
        if (ss_texture_authored(controls->controls[row].texture))
            return &controls->patch->coordinates;
    return NULL;
}

static skinslide_status copy_coordinates(skinslide_stage_controls *controls, const skinslide_value *value,
                                         skinslide_error *error) {
    const skinslide_stage_mesh *mesh = controls->patch->mesh;
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status && record.value.type == SKINSLIDE_VALUE_NONE) {
        char setting[256];
        ss_name_property(SKINSLIDE_STAGE_PATCH, SS_ROW_ST, controls->patch->name, setting);
        const char *there = skinslide_stage_mesh_coordinates(mesh);
        return ss_fail(error, SKINSLIDE_BAD_CONTROL,
                       "has a map, but the mesh has no " SS_NAMED "; name one in %s: there %s" SS_NAMED,
                       SS_NAME(controls->patch->st), setting, *there ? "are " : "are none", SS_NAME(there));
    }
    if (!status && !controls->own_st)
        controls->own_st = SS_NEW(&controls->memory, float, 2 * (int64_t)ss_faces_of(mesh).index_count);
    if (!status && !controls->own_st)
        return ss_out_of_memory(error);
    return status ? status : skinslide_stage_coordinates(mesh, value, controls->own_st, error);
}

/* Marks a map as unusable. */
static void refuse(ss_control *own) {
    ss_texture_drop(own->own_texture);
    own->refused = true;
}

/* Moves a map to other coordinates: the base's map becomes the controls' own. */
static skinslide_status move_map(skinslide_stage_controls *controls, int32_t row, skinslide_error *error) {
    ss_control *own = &controls->controls[row];
    controls->controls[ss_control_input(row)->multiplies].product = NULL;
    own->unplaced = true;
    if (!ss_texture_wanted(own->base_texture))
        return SKINSLIDE_OK;
    skinslide_status status = own_texture(controls, row, error);
    if (!status)
        status = ss_texture_repeat(own->own_texture, own->base_texture, error);
    own->refused = status != SKINSLIDE_OK;
    return status;
}

/* An error in them is kept, and reported only once a map needs them, perhaps at a later time. */
skinslide_status ss_take_coordinates(skinslide_stage_controls *controls, const skinslide_value *value, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    controls->st_status = copy_coordinates(controls, value, &controls->st_error);
    controls->st = controls->st_status ? NULL : controls->own_st;
    for (int32_t row = 0; !status && row < SS_CONTROL_ROWS; row++)
        if (controls->controls[row].texture)
            status = move_map(controls, row, error);
    return status;
}

static ss_control *needing(const skinslide_stage_controls *controls) {
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++)
        if (ss_texture_need(controls->controls[row].own_texture))
            return (ss_control *)&controls->controls[row];
    return NULL;
}

static skinslide_status place_map(const skinslide_stage_controls *controls, ss_control *own, skinslide_error *error) {
    own->unplaced = false;
    if (controls->st)
        return ss_texture_find_tiles(own->own_texture, controls->st, error);
    if (error)
        *error = controls->st_error;
    return controls->st_status;
}

/* Finds the tiles of the maps that have a new asset, or new coordinates. */
static skinslide_status place_maps(skinslide_stage_controls *controls, skinslide_error *error) {
    skinslide_status first = SKINSLIDE_OK;
    bool are_taken = controls->st || controls->st_status;
    for (int32_t row = 0; are_taken && row < SS_CONTROL_ROWS; row++) {
        ss_control *own = &controls->controls[row];
        if (!own->unplaced || !ss_texture_wanted(own->own_texture))
            continue;
        skinslide_status status = place_map(controls, own, first ? NULL : error);
        if (status)
            refuse(own);
        first = first ? first : status;
    }
    return first;
}

skinslide_status skinslide_stage_controls_need(skinslide_stage_controls *controls, const skinslide_stage_need **need,
                                               skinslide_error *error) {
    if (!controls || !need)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no controls, or no place for what they need");
    skinslide_status status = place_maps(controls, error);
    if (status)
        return status;
    const ss_control *own = needing(controls);
    *need = own ? ss_texture_need(own->own_texture) : NULL;
    return SKINSLIDE_OK;
}

skinslide_bool skinslide_stage_controls_holds(const skinslide_stage_controls *controls, const char *path) {
    const ss_control *own = needing(controls);
    return own && path && ss_texture_holds(own->own_texture, path);
}

skinslide_status skinslide_stage_controls_give(skinslide_stage_controls *controls, const skinslide_stage_file *file,
                                               skinslide_error *error) {
    ss_control *own = controls ? needing(controls) : NULL;
    skinslide_stage_file given = SKINSLIDE_STAGE_FILE_DEFAULT;
    if (!own)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no file is asked for");
    skinslide_status status = ss_take(file, "skinslide_stage_file", &given, sizeof given, error);
    if (status)
        return status;
    status = ss_texture_give(own->own_texture, controls->st, &given, error);
    if (status)
        refuse(own);
    return status;
}

const skinslide_stage_texture *skinslide_stage_controls_texture(const skinslide_stage_controls *controls,
                                                                const skinslide_stage_input *input) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_CONTROLS, input);
    return row < 0 ? NULL : ss_texture_shown(controls->controls[row].texture);
}
