/* Settings: tokens, words and arrays that stay the same over time; and a patch, which is made of them and of its faces. */
#include "stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Any setting ---- */

static int32_t find_token(const char *const *tokens, const char *token) {
    for (int32_t i = 0; tokens[i]; i++)
        if (strcmp(tokens[i], token) == 0)
            return i;
    return -1;
}

/* "auto, square, circle" */
static void list_tokens(const char *const *tokens, char *text, size_t size) {
    *text = 0;
    for (int32_t i = 0; tokens[i]; i++) {
        size_t length = strlen(text);
        snprintf(text + length, size - length, "%s%s", i ? ", " : "", tokens[i]);
    }
}

static skinslide_status take_choice(const ss_input *input, const ss_record *record, skinslide_status status, ss_taken *taken,
                                    skinslide_error *error) {
    const skinslide_stage_input *own = &input->shown;
    const char *token = ss_has_value(record) ? NULL : own->fallback ? own->fallback : own->tokens[0];
    if (record->value.type == SKINSLIDE_VALUE_TEXT && !record->value.is_array)
        token = record->value.data;
    int32_t found = token ? find_token(own->tokens, token) : -1;
    if (found < 0) {
        char allowed[160], shown[256];
        const char *quote = ss_is_number(record) ? "'" : "";
        list_tokens(own->tokens, allowed, sizeof allowed);
        return ss_fail(error, status, SS_NAMED " is %s%s%s; it must be one of %s", SS_NAME(record->value.name), quote,
                       ss_shown(record, shown), quote, allowed);
    }
    taken->choice = found;
    return SKINSLIDE_OK;
}

static skinslide_status take_word(const ss_input *input, const ss_record *record, skinslide_status status, ss_memory *memory,
                                  ss_taken *taken, skinslide_error *error) {
    char shown[256];
    const char *word = input->shown.fallback ? input->shown.fallback : "";
    if (ss_has_value(record)) {
        if (record->value.type != SKINSLIDE_VALUE_TEXT || record->value.is_array)
            return ss_fail(error, status, SS_NAMED " is %s; it must be a token", SS_NAME(record->value.name),
                           ss_shown(record, shown));
        const char *said = record->value.data;
        word = *said ? said : word;
    }
    taken->word = ss_copy_text(memory, word);
    return memory->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

/* Copies an array of int32_t or of float, whose elements have the same size. */
static skinslide_status copy_array(const ss_input *input, const ss_record *record, skinslide_status status, ss_memory *memory,
                                   ss_array *array, skinslide_error *error) {
    bool is_float = input->kind == SS_KIND_FLOATS;
    status = is_float ? ss_check_floats(record, status, error) : ss_check_integers(record, status, error);
    if (status)
        return status;
    void *values = record->length > INT32_MAX ? NULL : ss_new(memory, record->length, sizeof(int32_t));
    if (!values)
        return ss_out_of_memory(error);
    if (is_float)
        ss_copy_floats(record, values);
    else
        ss_copy_integers(record, values);
    *array = (ss_array){values, (int32_t)record->length};
    return SKINSLIDE_OK;
}

skinslide_status ss_take_number(const ss_input *input, const ss_record *record, double *number, skinslide_error *error) {
    char shown[256];
    double found = ss_is_number(record) ? ss_number(record, 0, 0) : input->fallback;
    if (ss_has_value(record) && !ss_is_number(record))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " is %s; it must be a %s", SS_NAME(record->value.name),
                       ss_shown(record, shown), input->shown.type_name);
    if (!ss_in_range(input->range, found))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " is %g%s%s", SS_NAME(record->value.name), found,
                       input->wanted ? "; it must be " : "", input->wanted ? input->wanted : "");
    *number = found;
    return SKINSLIDE_OK;
}

skinslide_status ss_take_plain(const ss_input *input, const ss_record *record, skinslide_status status, ss_memory *memory,
                               ss_taken *taken, skinslide_error *error) {
    switch (input->kind) {
    case SS_KIND_CHOICE:
        return take_choice(input, record, status, taken, error);
    case SS_KIND_WORD:
        return take_word(input, record, status, memory, taken, error);
    case SS_KIND_NUMBER:
        return ss_take_number(input, record, &taken->number, error);
    default:
        return copy_array(input, record, status, memory, &taken->array, error);
    }
}

skinslide_status ss_take_fallbacks(const ss_input *inputs, int32_t count, ss_memory *memory, ss_taken *taken,
                                   skinslide_error *error) {
    ss_record none;
    skinslide_status status = ss_open(NULL, &none, error);
    for (int32_t row = 0; row < count && !status; row++)
        if (inputs[row].kind == SS_KIND_CHOICE || inputs[row].kind == SS_KIND_WORD || inputs[row].kind == SS_KIND_NUMBER)
            status = ss_take_plain(&inputs[row], &none, SKINSLIDE_BAD_CONTROL, memory, &taken[row], error);
    return status;
}

static bool is_same(const ss_input *input, const ss_taken *a, const ss_taken *b) {
    switch (input->kind) {
    case SS_KIND_CHOICE:
        return a->choice == b->choice;
    case SS_KIND_WORD:
        return strcmp(a->word, b->word) == 0;
    case SS_KIND_NUMBER:
        return a->number == b->number;
    default:
        return a->array.count == b->array.count &&
               (!a->array.count || memcmp(a->array.values, b->array.values, (size_t)a->array.count * sizeof(int32_t)) == 0);
    }
}

skinslide_status ss_changes(const ss_record *record, double frame, skinslide_status status, skinslide_error *error) {
    char text[32];
    skinslide_stage_frame_text(frame, text);
    return ss_fail(error, status, SS_NAMED " changes at frame %s; it must stay the same over time", SS_NAME(record->value.name),
                   text);
}

skinslide_status ss_check_plain(const ss_input *input, const ss_record *record, const ss_taken *taken, double frame,
                                skinslide_status status, skinslide_error *error) {
    ss_memory scratch = {0};
    ss_taken later = {0};
    skinslide_status failed = ss_take_plain(input, record, status, &scratch, &later, error);
    if (!failed && !is_same(input, taken, &later))
        failed = ss_changes(record, frame, status, error);
    ss_free(&scratch);
    return failed;
}

skinslide_status ss_check_refused(const ss_input *inputs, const ss_taken *taken, int32_t count, skinslide_error *error) {
    for (int32_t row = 0; row < count; row++)
        if (taken[row].refused)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%s%s was refused", inputs[row].shown.prefix, inputs[row].shown.name);
    return SKINSLIDE_OK;
}

/* ---- A patch ---- */

static const ss_input *patch_inputs(void) {
    int32_t count;
    return ss_inputs(SKINSLIDE_STAGE_PATCH, &count);
}

static skinslide_status take_live(const skinslide_stage_live *given, skinslide_stage_live *live, skinslide_error *error) {
    *live = (skinslide_stage_live)SKINSLIDE_STAGE_LIVE_DEFAULT;
    return ss_take(given, "skinslide_stage_live", live, sizeof *live, error);
}

/* st is a primvar's full name. */
static void set_coordinates(skinslide_stage_patch *patch, const char *st) {
    patch->st = st;
    patch->coordinates = (skinslide_stage_input){.name = st + strlen(SS_PRIMVARS),
                                                 .type_name = "texCoord2f[]",
                                                 .group = SKINSLIDE_STAGE_COORDINATES,
                                                 .prefix = SS_PRIMVARS,
                                                 .when = SKINSLIDE_STAGE_ANIMATED,
                                                 .is_primvar = 1};
}

static skinslide_status fill_patch(skinslide_stage_patch *patch, const char *name, const skinslide_stage_live *live,
                                   skinslide_error *error) {
    skinslide_status status = take_live(live, &patch->live, error);
    if (status)
        return status;
    patch->name = ss_copy_text(&patch->memory, name);
    if (patch->memory.failed)
        return ss_out_of_memory(error);
    set_coordinates(patch, SS_PRIMVARS "st");
    return ss_take_fallbacks(patch_inputs(), SS_PATCH_ROWS, &patch->memory, patch->taken, error);
}

skinslide_status skinslide_stage_patch_create(const skinslide_stage_mesh *mesh, const char *name,
                                              const skinslide_stage_live *live, skinslide_stage_patch **out,
                                              skinslide_error *error) {
    if (!mesh || !mesh->has_faces || !name || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh with faces, no name, or no place for the patch");
    skinslide_stage_patch *patch = calloc(1, sizeof *patch);
    if (!patch)
        return ss_out_of_memory(error);
    patch->mesh = mesh;
    skinslide_status status = fill_patch(patch, name, live, error);
    if (status)
        skinslide_stage_patch_destroy(patch);
    else
        *out = patch;
    return status;
}

void skinslide_stage_patch_destroy(skinslide_stage_patch *patch) {
    if (!patch)
        return;
    ss_free(&patch->settled);
    ss_free(&patch->memory);
    free(patch);
}

/* ---- Corners and edges ---- */

static skinslide_status check_corners(const ss_record *record, const ss_array *corners, int32_t vertex_count,
                                      skinslide_error *error) {
    const int32_t *points = corners->values;
    const char *name = record->value.name;
    if (corners->count != 0 && corners->count != 4)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " has %d values; it must have 4", SS_NAME(name), corners->count);
    for (int32_t i = 0; i < corners->count; i++) {
        if (points[i] < 0 || points[i] >= vertex_count)
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED "[%d] is %d, but the mesh has %d points", SS_NAME(name), i,
                           points[i], vertex_count);
        for (int32_t k = 0; k < i; k++)
            if (points[k] == points[i])
                return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " has point %d more than once", SS_NAME(name), points[i]);
    }
    return SKINSLIDE_OK;
}

static skinslide_status check_pairs(const ss_record *record, skinslide_error *error) {
    if (record->length % 2)
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED " has %lld values; it must hold pairs of point indices",
                       SS_NAME(record->value.name), (long long)record->length);
    return SKINSLIDE_OK;
}

static skinslide_status check_points(const ss_record *record, const ss_array *points, skinslide_error *error) {
    for (int32_t i = 0; i < points->count; i++)
        if (((const int32_t *)points->values)[i] < 0)
            return ss_fail(error, SKINSLIDE_BAD_CONTROL, SS_NAMED "[%d] is %d; points are numbered from 0",
                           SS_NAME(record->value.name), i, ((const int32_t *)points->values)[i]);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_check_value(const skinslide_stage_input *input, const skinslide_value *value,
                                             skinslide_error *error) {
    int32_t count, patch_row = ss_row_of(SKINSLIDE_STAGE_PATCH, input), live_row = ss_row_of(SKINSLIDE_STAGE_LIVE, input);
    if (patch_row < 0 && live_row < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no input of a patch, or of what is live");
    const ss_input *own = patch_row < 0 ? &ss_inputs(SKINSLIDE_STAGE_LIVE, &count)[live_row] : &patch_inputs()[patch_row];
    bool are_points = own->kind == SS_KIND_CORNERS || own->kind == SS_KIND_EDGES;
    ss_memory scratch = {0};
    ss_taken taken = {0};
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status && (are_points || own->kind == SS_KIND_CHOICE))
        status = ss_take_plain(own, &record, SKINSLIDE_BAD_CONTROL, &scratch, &taken, error);
    if (!status && are_points)
        status = check_points(&record, &taken.array, error);
    if (!status && own->kind == SS_KIND_CORNERS)
        status = check_corners(&record, &taken.array, INT32_MAX, error);
    if (!status && own->kind == SS_KIND_EDGES)
        status = check_pairs(&record, error);
    ss_free(&scratch);
    return status;
}

static skinslide_status take_setting(skinslide_stage_patch *patch, int32_t row, const ss_record *record,
                                     skinslide_error *error) {
    const ss_input *input = &patch_inputs()[row];
    if (input->kind == SS_KIND_FACES)
        return ss_take_primvar_faces(patch, record, error);
    ss_taken taken = {0};
    skinslide_status status = ss_take_plain(input, record, SKINSLIDE_BAD_CONTROL, &patch->memory, &taken, error);
    if (!status && input->kind == SS_KIND_CORNERS)
        status = check_corners(record, &taken.array, patch->mesh->vertex_count, error);
    if (!status && input->kind == SS_KIND_EDGES)
        status = check_pairs(record, error);
    if (!status)
        patch->taken[row] = taken;
    return status;
}

/* "primvars:st" of "st", and of itself. */
static skinslide_status name_coordinates(skinslide_stage_patch *patch, skinslide_error *error) {
    const char *word = patch->taken[SS_ROW_ST].word;
    bool named = strncmp(word, SS_PRIMVARS, strlen(SS_PRIMVARS)) == 0;
    char *name = SS_NEW(&patch->memory, char, (int64_t)(strlen(word) + sizeof SS_PRIMVARS));
    if (!name)
        return ss_out_of_memory(error);
    strcpy(name, SS_PRIMVARS);
    strcpy(name + (named ? 0 : strlen(SS_PRIMVARS)), word);
    set_coordinates(patch, name);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_patch_take(skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                            const skinslide_value *value, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_PATCH, input), of_subset = ss_row_of(SKINSLIDE_STAGE_SUBSET, input);
    if (!patch || (row < 0 && of_subset < 0))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch, or no input of one");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = row < 0 ? ss_take_subset_faces(patch, of_subset, &record, error) : take_setting(patch, row, &record, error);
    if (!status && row == SS_ROW_ST)
        status = name_coordinates(patch, error);
    if (!status && (row < 0 || row == SS_ROW_FACES))
        status = ss_settle_faces(patch, error);
    else if (!status && (row == SS_ROW_RULE || row == SS_ROW_GROW))
        status = ss_settle_way(patch, error);
    if (row >= 0)
        patch->taken[row].refused = status != SKINSLIDE_OK;
    return status;
}

skinslide_status skinslide_stage_patch_check(const skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                             const skinslide_value *value, double frame, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_PATCH, input), of_subset = ss_row_of(SKINSLIDE_STAGE_SUBSET, input);
    if (!patch || (row < 0 && of_subset < 0))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch, or no input of one that must stay the same");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (row < 0)
        return status ? status : ss_check_subset_faces(patch, of_subset, &record, frame, error);
    if (status || patch->taken[row].refused)
        return status;
    if (row == SS_ROW_FACES)
        return ss_check_primvar_faces(patch, &record, frame, error);
    return ss_check_plain(&patch_inputs()[row], &record, &patch->taken[row], frame, SKINSLIDE_BAD_CONTROL, error);
}

skinslide_bool skinslide_stage_patch_needs_subdivision(const skinslide_stage_patch *patch) {
    int32_t interpolation =
        patch->live.interpolation < 0 ? patch->taken[SS_ROW_INTERPOLATION].choice : patch->live.interpolation;
    return interpolation == SKINSLIDE_INTERPOLATION_AUTO || interpolation == SKINSLIDE_INTERPOLATION_LIMIT;
}

skinslide_status skinslide_stage_patch_get(const skinslide_stage_patch *patch, skinslide_stage_controls *controls,
                                           skinslide_patch_setup *out, skinslide_error *error) {
    if (!patch || !controls || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch, no controls, or no place for the set-up");
    skinslide_status status = ss_check_refused(patch_inputs(), patch->taken, SS_PATCH_ROWS, error);
    if (!status && !patch->faces.count)
        status = ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the faces of the patch were not given");
    if (!status)
        status = ss_check_likeness(patch, error);
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    if (!status)
        status = ss_check_size(out, "skinslide_patch_setup", error);
    if (!status)
        status = ss_give_controls(controls, &setup.controls, error);
    if (status)
        return status;
    const ss_taken *taken = patch->taken;
    setup.name = patch->name;
    setup.faces = patch->faces.values;
    setup.face_count = patch->faces.count;
    setup.corners = taken[SS_ROW_CORNERS].array.count ? taken[SS_ROW_CORNERS].array.values : NULL;
    setup.boundary = (skinslide_boundary)taken[SS_ROW_BOUNDARY].choice;
    setup.holes = (skinslide_holes)taken[SS_ROW_HOLES].choice;
    setup.rule = (skinslide_rule)taken[SS_ROW_RULE].choice;
    setup.interpolation = (skinslide_interpolation)(patch->live.interpolation < 0 ? taken[SS_ROW_INTERPOLATION].choice
                                                                                  : patch->live.interpolation);
    setup.held = patch->held;
    ss_give(&setup, sizeof setup, out);
    return SKINSLIDE_OK;
}
