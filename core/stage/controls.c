/* Controls: what is painted and animated on a patch, at one time. Values off the patch do not count, since paint is often 0
 * there: they are replaced by ones that the core accepts. */
#include "stage.h"

#include <stdlib.h>
#include <string.h>

const ss_input *ss_control_input(int32_t row) {
    int32_t count;
    return &ss_inputs(SKINSLIDE_STAGE_CONTROLS, &count)[row];
}

/* ---- Life ---- */

static void start(skinslide_stage_controls *controls, const skinslide_stage_controls *base) {
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++) {
        ss_control *own = &controls->controls[row];
        own->number = ss_control_input(row)->fallback;
        if (!base)
            continue;
        *own = base->controls[row];
        own->own = own->own_product = NULL, own->plain = NULL;
        own->base_texture = own->texture, own->own_texture = NULL;
    }
    if (base)
        controls->st = base->st, controls->st_status = base->st_status, controls->st_error = base->st_error;
}

skinslide_status skinslide_stage_controls_create(const skinslide_stage_patch *patch, const skinslide_stage_controls *base,
                                                 skinslide_stage_controls **out, skinslide_error *error) {
    if (!patch || !out || (base && base->patch != patch))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch, a base of another, or no place for the controls");
    skinslide_stage_controls *controls = calloc(1, sizeof *controls);
    if (!controls)
        return ss_out_of_memory(error);
    controls->patch = patch;
    start(controls, base);
    *out = controls;
    return SKINSLIDE_OK;
}

void skinslide_stage_controls_destroy(skinslide_stage_controls *controls) {
    if (!controls)
        return;
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++)
        ss_texture_destroy(controls->controls[row].own_texture);
    ss_free(&controls->memory);
    free(controls);
}

/* ---- Paint ---- */

static skinslide_status check_paint(const skinslide_stage_patch *patch, const ss_input *input, const ss_record *record,
                                    ss_paint_layout *found, skinslide_error *error) {
    const char *interpolation = ss_interpolation(record);
    skinslide_status status = ss_check_paint_type(patch, record, false, SKINSLIDE_BAD_CONTROL, error);
    if (status)
        return status;
    bool is_constant = strcmp(interpolation, "constant") == 0, by_face = strcmp(interpolation, "uniform") == 0;
    if (!is_constant && !ss_is_painted_by_vertex(record) && !(by_face && input->face_place))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL,
                       SS_NAMED " has interpolation " SS_NAMED "; it must be vertex, faceVarying%s or constant",
                       SS_NAME(record->value.name), SS_NAME(interpolation), input->face_place ? ", uniform" : "");
    *found = is_constant ? SS_LAYOUT_NONE : by_face ? SS_LAYOUT_FACE : SS_LAYOUT_VERTEX;
    if (!ss_has_value(record))
        return ss_refuse_empty(record, SKINSLIDE_BAD_CONTROL, error);
    return ss_check_indices(record, SKINSLIDE_BAD_CONTROL, error);
}

static skinslide_status check_count(const skinslide_stage_patch *patch, const ss_record *record, ss_paint_layout found,
                                    skinslide_error *error) {
    if (found == SS_LAYOUT_VERTEX)
        return ss_check_painted_vertices(patch->mesh, record, SKINSLIDE_BAD_CONTROL, error);
    if (found == SS_LAYOUT_FACE)
        return ss_check_length(record, patch->mesh->taken[SS_ROW_FACE_COUNTS].array.count, "faces", SKINSLIDE_BAD_CONTROL,
                               error);
    if (record->length != 1)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " has interpolation constant but %lld values; is vertex missing?",
                       SS_NAME(record->value.name), (long long)record->length);
    return SKINSLIDE_OK;
}

/* Returns memory for the values of an input in any layout, which is kept from frame to frame. */
static float *own_values(skinslide_stage_controls *controls, int32_t row) {
    const skinslide_stage_mesh *mesh = controls->patch->mesh;
    int32_t faces = mesh->taken[SS_ROW_FACE_COUNTS].array.count;
    ss_control *own = &controls->controls[row];
    if (!own->own)
        own->own = SS_NEW(&controls->memory, float, mesh->vertex_count > faces ? mesh->vertex_count : faces);
    return own->own;
}

/* Gives paint one number for each point or face: the record as it is, or a converted one, in memory that is kept as well. */
static skinslide_status make_plain(skinslide_stage_controls *controls, int32_t row, ss_record *record, skinslide_error *error) {
    ss_control *own = &controls->controls[row];
    if (ss_is_plain_paint(record))
        return SKINSLIDE_OK;
    if (!own->plain)
        own->plain = SS_NEW(&controls->memory, double, ss_plain_paint_room(controls->patch->mesh));
    if (!own->plain)
        return ss_out_of_memory(error);
    *record = ss_plain_paint(controls->patch, record, own->plain);
    return SKINSLIDE_OK;
}

static skinslide_status bad_number(const ss_input *input, const ss_record *record, int64_t i, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED "[%lld] is %g; it must be %s", SS_NAME(record->value.name),
                   (long long)i, ss_number(record, i, 0), input->wanted);
}

/* A number as the float that it becomes: a double may be too large for one, or too near 0. */
static double as_float(const ss_record *record, int64_t i) {
    return (double)(float)ss_number(record, i, 0);
}

/* Expands the values inside the patch or, if inside is NULL, those of all elements. */
static skinslide_status expand(const ss_input *input, const ss_record *record, const ss_array *inside, float *values,
                               skinslide_error *error) {
    int64_t count = inside ? inside->count : record->length;
    for (int64_t i = 0; inside && i < record->length; i++)
        values[i] = (float)input->off_patch;
    for (int64_t k = 0; k < count; k++) {
        int64_t i = inside ? ((const int32_t *)inside->values)[k] : k;
        double number = as_float(record, i);
        if (!ss_in_range(input->range, number))
            return bad_number(input, record, i, error);
        values[i] = (float)number;
    }
    return SKINSLIDE_OK;
}

static skinslide_status expand_constant(const ss_input *input, const ss_record *record, int32_t count, float *values,
                                        skinslide_error *error) {
    double number = as_float(record, 0);
    if (!ss_in_range(input->range, number))
        return bad_number(input, record, 0, error);
    for (int32_t i = 0; i < count; i++)
        values[i] = (float)number;
    return SKINSLIDE_OK;
}

static skinslide_status take_paint(skinslide_stage_controls *controls, int32_t row, const ss_record *given,
                                   skinslide_error *error) {
    ss_record own_record = *given, *record = &own_record;
    const skinslide_stage_patch *patch = controls->patch;
    const ss_input *input = ss_control_input(row);
    ss_paint_layout found = SS_LAYOUT_NONE;
    ss_control *own = &controls->controls[row];
    own->values = NULL, own->layout = SS_LAYOUT_NONE;
    if (record->value.type == SKINSLIDE_VALUE_NONE)
        return SKINSLIDE_OK;
    skinslide_status status = check_paint(patch, input, record, &found, error);
    if (!status)
        status = check_count(patch, record, found, error);
    if (!status)
        status = make_plain(controls, row, record, error);
    float *values = status ? NULL : own_values(controls, row);
    if (!status && !values)
        status = ss_out_of_memory(error);
    if (status)
        return status;
    bool is_constant = found == SS_LAYOUT_NONE;
    const ss_array *inside = found == SS_LAYOUT_FACE ? &patch->faces : &patch->vertices;
    status = is_constant ? expand_constant(input, record, patch->mesh->vertex_count, values, error)
                         : expand(input, record, patch->faces.count ? inside : NULL, values, error);
    if (!status && !(is_constant && input->drops_constant))
        own->values = values, own->layout = is_constant ? SS_LAYOUT_VERTEX : found;
    return status;
}

/* ---- Painted edges ---- */

static skinslide_status take_factors(skinslide_stage_controls *controls, int32_t row, const ss_record *record,
                                     skinslide_error *error) {
    const ss_input *input = ss_control_input(row);
    const ss_array *edges = &controls->patch->taken[SS_ROW_EDGES].array;
    const char *name = record->value.name;
    char edges_name[256];
    ss_control *own = &controls->controls[row];
    own->values = NULL, own->layout = SS_LAYOUT_NONE;
    ss_name_property(SKINSLIDE_STAGE_PATCH, SS_ROW_EDGES, controls->patch->name, edges_name);
    skinslide_status status = ss_check_floats(record, SKINSLIDE_BAD_CONTROL, error);
    if (controls->patch->taken[SS_ROW_EDGES].refused) /* its error was reported when it was taken */
        return status;
    if (!status && record->length != edges->count / 2)
        status = ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " has %lld values, but %s has %d pairs", SS_NAME(name),
                         (long long)record->length, edges_name, edges->count / 2);
    for (int32_t k = 0; !status && k < edges->count / 2; k++)
        if (!ss_in_range(input->range, ss_number(record, k, 0)))
            status = ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED "[%d], for edge %d-%d, is %g; it must be %s", SS_NAME(name),
                             k, ((const int32_t *)edges->values)[2 * k], ((const int32_t *)edges->values)[2 * k + 1],
                             ss_number(record, k, 0), input->wanted);
    if (status || !edges->count)
        return status;
    if (!own->own)
        own->own = SS_NEW(&controls->memory, float, edges->count / 2);
    if (!own->own)
        return ss_out_of_memory(error);
    ss_copy_floats(record, own->own);
    own->values = own->own, own->layout = SS_LAYOUT_EDGE;
    return SKINSLIDE_OK;
}

/* ---- Any input ---- */

static skinslide_status take(skinslide_stage_controls *controls, int32_t row, const ss_record *record, skinslide_error *error) {
    const ss_input *input = ss_control_input(row);
    controls->controls[input->kind == SS_KIND_TEXTURE ? input->multiplies : row].product = NULL;
    switch (input->kind) {
    case SS_KIND_NUMBER:
        return ss_take_number(input, record, &controls->controls[row].number, error);
    case SS_KIND_FACTORS:
        return take_factors(controls, row, record, error);
    case SS_KIND_TEXTURE:
        return ss_take_texture(controls, row, record, error);
    default:
        return take_paint(controls, row, record, error);
    }
}

skinslide_status skinslide_stage_controls_take(skinslide_stage_controls *controls, const skinslide_stage_input *input,
                                               const skinslide_value *value, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_CONTROLS, input);
    if (!controls || (row < 0 && input != &controls->patch->coordinates))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no controls, or no input of them");
    if (row < 0)
        return ss_take_coordinates(controls, value, error);
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = take(controls, row, &record, error);
    controls->controls[row].refused = status != SKINSLIDE_OK;
    return status;
}

/* ---- What the slider takes ---- */

static skinslide_status check_complete(const skinslide_stage_controls *controls, skinslide_error *error) {
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++) {
        const ss_control *own = &controls->controls[row];
        const char *name = ss_control_input(row)->shown.name;
        if (own->refused)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%s was refused", name);
        if (ss_texture_wanted(own->texture) && !ss_texture_values(own->texture))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the files of %s were not given", name);
    }
    return SKINSLIDE_OK;
}

/* Multiplies paint by vertex by a map, into the paint's product. */
static skinslide_status multiply(skinslide_stage_controls *controls, int32_t map_row, skinslide_error *error) {
    int32_t row = ss_control_input(map_row)->multiplies, count = controls->patch->mesh->vertex_count;
    const ss_texture *texture = controls->controls[map_row].texture;
    const float *map = ss_texture_values(texture);
    ss_control *own = &controls->controls[row];
    if (own->product)
        return SKINSLIDE_OK;
    if (!own->own_product)
        own->own_product = SS_NEW(&controls->memory, float, count);
    if (!own->own_product)
        return ss_out_of_memory(error);
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t v = 0; v < count && !status; v++) {
        own->own_product[v] = own->values[v] * map[v];
        status = ss_texture_check(texture, true, v, own->own_product[v], error);
    }
    own->product = status ? NULL : own->own_product;
    return status;
}

static skinslide_status multiply_all(skinslide_stage_controls *controls, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t row = 0; !status && row < SS_CONTROL_ROWS; row++)
        if (ss_texture_values(controls->controls[row].texture) &&
            controls->controls[ss_control_input(row)->multiplies].layout == SS_LAYOUT_VERTEX)
            status = multiply(controls, row, error);
    return status;
}

static void put_array(skinslide_controls *out, size_t place, const float *values) {
    memcpy((char *)out + place, &values, sizeof values);
}

static void put(const skinslide_stage_controls *controls, int32_t row, skinslide_controls *out) {
    const ss_input *input = ss_control_input(row);
    const ss_control *own = &controls->controls[row];
    if (input->kind == SS_KIND_TEXTURE) {
        const ss_control *paint = &controls->controls[input->multiplies];
        const float *map = ss_texture_values(own->texture);
        if (map)
            put_array(out, ss_control_input(input->multiplies)->place,
                      paint->layout == SS_LAYOUT_VERTEX ? paint->product : map);
    } else if (input->kind != SS_KIND_NUMBER && own->values) {
        put_array(out, own->layout == SS_LAYOUT_FACE ? input->face_place : input->place, own->values);
    }
}

static void put_numbers(const skinslide_stage_controls *controls, skinslide_controls *out) {
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++) {
        double live = row == SS_ROW_ENVELOPE ? controls->patch->live.envelope : 1;
        float number = (float)(controls->controls[row].number * live);
        if (ss_control_input(row)->kind == SS_KIND_NUMBER)
            memcpy((char *)out + ss_control_input(row)->place, &number, sizeof number);
    }
}

bool ss_controls_have(const skinslide_stage_controls *controls, int32_t row) {
    const ss_control *own = &controls->controls[row];
    return own->values || ss_texture_wanted(own->texture) || own->number != ss_control_input(row)->fallback;
}

skinslide_status ss_give_controls(skinslide_stage_controls *controls, const skinslide_controls **given,
                                  skinslide_error *error) {
    skinslide_controls *out = &controls->given;
    skinslide_status status = check_complete(controls, error);
    if (!status)
        status = multiply_all(controls, error);
    if (status)
        return status;
    const ss_array *edges = &controls->patch->taken[SS_ROW_EDGES].array;
    *out = (skinslide_controls)SKINSLIDE_CONTROLS_DEFAULT;
    put_numbers(controls, out);
    for (int32_t row = 0; row < SS_CONTROL_ROWS; row++) /* paint first, then the maps that multiply it */
        put(controls, row, out);
    out->edges = edges->count ? edges->values : NULL;
    out->edge_count = edges->count / 2;
    *given = out;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_controls_get(skinslide_stage_controls *controls, skinslide_controls *out,
                                              skinslide_error *error) {
    const skinslide_controls *given;
    if (!controls || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no controls, or no place for them");
    skinslide_status status = ss_check_size(out, "skinslide_controls", error);
    if (!status)
        status = ss_give_controls(controls, &given, error);
    if (!status)
        ss_give(given, sizeof *given, out);
    return status;
}
