/* What else a mesh has that follows from its points: which vectors are carried with the skin, which rates are recomputed, and
 * which are blocked because they cannot be, since stale ones would shade and blur wrongly. */
#include "stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A primvar that was offered, and is an input like those of the table. */
typedef struct ss_offer {
    ss_input input;
    struct ss_offer *next;
} offer;

typedef struct ss_warning {
    const char *text;
    struct ss_warning *next;
} warning;

/* The input in a row of the table. */
static const ss_input *input_of_row(int32_t row) {
    int32_t count;
    return &ss_inputs(SKINSLIDE_STAGE_DERIVED, &count)[row];
}

static bool is_row(const ss_input *input, int32_t row) {
    return input == input_of_row(row);
}

/* An input of the table, or a primvar that was offered; NULL for any other. */
static const ss_input *find_input(const skinslide_stage_derived *derived, const skinslide_stage_input *shown) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_DERIVED, shown);
    if (row >= 0)
        return input_of_row(row);
    for (const offer *own = derived->offers; own; own = own->next)
        if (&own->input.shown == shown)
            return &own->input;
    return NULL;
}

/* ---- Life ---- */

static skinslide_status copy_times(skinslide_stage_derived *derived, const double *times, int64_t count,
                                   skinslide_error *error) {
    derived->point_times = SS_NEW(&derived->memory, double, count);
    derived->merged = SS_NEW(&derived->memory, double, count);
    if (derived->memory.failed)
        return ss_out_of_memory(error);
    for (int64_t i = 0; i < count; i++)
        derived->point_times[i] = derived->merged[i] = times[i];
    derived->point_time_count = derived->merged_count = count;
    return skinslide_stage_merge_times(derived->merged, &derived->merged_count, error);
}

skinslide_status skinslide_stage_derived_create(const skinslide_stage_mesh *mesh, const double *point_times,
                                                int64_t point_time_count, double rate, skinslide_stage_derived **out,
                                                skinslide_error *error) {
    if (!mesh || !mesh->has_faces || point_time_count < 0 || (point_time_count > 0 && !point_times) || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh with faces, no times, or no place for what is derived");
    skinslide_stage_derived *derived = calloc(1, sizeof *derived);
    if (!derived)
        return ss_out_of_memory(error);
    derived->mesh = mesh;
    derived->rate = rate;
    derived->last = &derived->first, derived->last_warning = &derived->warnings;
    skinslide_status status = copy_times(derived, point_times, point_time_count, error);
    if (status)
        skinslide_stage_derived_destroy(derived);
    else
        *out = derived;
    return status;
}

skinslide_status skinslide_stage_derived_fill(skinslide_stage_derived *derived, skinslide_error *error) {
    if (!derived)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing derived");
    int64_t count = derived->merged_count, more = 0;
    skinslide_status status = skinslide_stage_times_between(derived->merged, count, NULL, &more, error);
    if (status || !more)
        return status;
    double *filled = SS_NEW(&derived->memory, double, count + more);
    if (!filled)
        return ss_out_of_memory(error);
    memcpy(filled, derived->merged, (size_t)count * sizeof *filled);
    status = skinslide_stage_times_between(filled, count, filled + count, &more, error);
    count += more;
    if (!status)
        status = skinslide_stage_merge_times(filled, &count, error);
    if (!status)
        derived->merged = filled, derived->merged_count = count;
    return status;
}

void skinslide_stage_derived_destroy(skinslide_stage_derived *derived) {
    if (!derived)
        return;
    ss_free(&derived->memory);
    free(derived);
}

/* ---- Vectors by element ---- */

/* Which elements have a vector each. Constant vectors do not follow from points. */
static skinslide_status choose_layout(const ss_record *record, const char *interpolation, skinslide_normals_layout *layout,
                                      skinslide_error *error) {
    if (ss_is_by_vertex(interpolation))
        *layout = SKINSLIDE_NORMALS_VERTEX;
    else if (strcmp(interpolation, "faceVarying") == 0)
        *layout = SKINSLIDE_NORMALS_FACE_VARYING;
    else if (strcmp(interpolation, "uniform") == 0)
        *layout = SKINSLIDE_NORMALS_UNIFORM;
    else
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       SS_NAMED " has interpolation " SS_NAMED "; it must be vertex, varying, faceVarying or uniform",
                       SS_NAME(record->value.name), SS_NAME(interpolation));
    return SKINSLIDE_OK;
}

/* ---- Rates of change ---- */

static bool same_times(const skinslide_stage_derived *derived, const double *times, int64_t count) {
    if (count != derived->point_time_count)
        return false;
    for (int64_t i = 0; i < count; i++)
        if (times[i] != derived->point_times[i])
            return false;
    return true;
}

static skinslide_status check_rate(const skinslide_stage_derived *derived, int32_t pose_count, const double *times,
                                   int64_t time_count, skinslide_error *error) {
    if (!(isfinite(derived->rate) && derived->rate > 0))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "the stage has %g time codes per second", derived->rate);
    if (derived->merged_count < pose_count)
        return ss_refuse_poses(derived->merged_count, pose_count, error);
    if (!same_times(derived, times, time_count))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "their samples are at other times than those of points");
    return SKINSLIDE_OK;
}

/* ---- Warnings ---- */

static void warn(skinslide_stage_derived *derived, const char *text) {
    warning *made = SS_NEW(&derived->memory, warning, 1);
    if (!made)
        return;
    made->text = ss_copy_text(&derived->memory, text);
    *derived->last_warning = made, derived->last_warning = &made->next;
}

/* Warns of vectors of one pose on points that move. */
static void warn_of_static(skinslide_stage_derived *derived, const char *name) {
    skinslide_error made;
    ss_fail(&made, SKINSLIDE_BAD_POINTS,
            SS_NAMED " has one value for all frames, but points moves: it belongs to one pose alone", SS_NAME(name));
    warn(derived, made.message);
}

const char *skinslide_stage_derived_warning(const skinslide_stage_derived *derived, int32_t number) {
    const warning *own = derived && number >= 0 ? derived->warnings : NULL;
    while (own && number-- > 0)
        own = own->next;
    return own ? own->text : NULL;
}

/* ---- Outputs ---- */

static const char *property_name(skinslide_stage_derived *derived, const skinslide_stage_input *input, const char *suffix) {
    size_t size = strlen(input->prefix) + strlen(input->name) + strlen(suffix) + 1;
    char *name = SS_NEW(&derived->memory, char, (int64_t)size);
    if (name)
        snprintf(name, size, "%s%s%s", input->prefix, input->name, suffix);
    return name;
}

/* Appends an output, still empty. NULL if memory is short. */
static ss_derivation *append(skinslide_stage_derived *derived, const ss_input *input) {
    ss_derivation *made = SS_NEW(&derived->memory, ss_derivation, 1);
    if (!made)
        return NULL;
    made->input = input;
    *derived->last = made, derived->last = &made->next;
    return made;
}

static void add(skinslide_stage_derived *derived, const ss_input *input, const ss_record *record,
                skinslide_normals_layout layout, const char *reason) {
    bool is_primvar = input->shown.is_primvar, is_carried = input->kind == SS_KIND_CARRIED && !reason;
    ss_derivation *made = append(derived, input);
    if (!made)
        return;
    made->layout = layout;
    made->output = (skinslide_stage_output){
        .name = property_name(derived, &input->shown, ""),
        .type_name = is_primvar ? ss_copy_text(&derived->memory, record->value.type_name) : input->shown.type_name,
        .pose_count = reason ? 0 : input->pose_count,
        .count = ss_derived_length(derived->mesh, layout),
        .reason = reason ? ss_copy_text(&derived->memory, reason) : NULL,
        .is_carried = is_carried,
        .is_double = is_carried && ss_is_written_double(input, record),
    };
}

/* Blocks an attribute in whose place another is written, or blocked. */
static void block(skinslide_stage_derived *derived, const ss_input *input, const char *suffix, const char *type_name) {
    ss_derivation *made = append(derived, input);
    if (!made)
        return;
    made->output.name = property_name(derived, &input->shown, suffix);
    made->output.type_name = type_name;
}

static skinslide_status judge(const skinslide_stage_derived *derived, const ss_input *input, const ss_record *record,
                              const char *interpolation, const double *times, int64_t time_count,
                              skinslide_normals_layout *layout, skinslide_error *error) {
    skinslide_status status = input->kind == SS_KIND_CARRIED ? choose_layout(record, interpolation, layout, error)
                                                             : check_rate(derived, input->pose_count, times, time_count, error);
    return status ? status : ss_check_derived(derived->mesh, input, record, *layout, error);
}

/* If the primvar is blocked, also blocks the normals that it hides, since they would be read again. */
static void block_hidden(skinslide_stage_derived *derived) {
    const ss_input *normals = input_of_row(SS_ROW_NORMALS);
    block(derived, normals, "", normals->shown.type_name);
}

static void hide(skinslide_stage_derived *derived) {
    ss_derivation *primvar = derived->first;
    primvar->output.hidden = property_name(derived, &input_of_row(SS_ROW_NORMALS)->shown, "");
    if (!primvar->output.pose_count)
        block_hidden(derived);
}

static void take(skinslide_stage_derived *derived, const ss_input *input, const ss_record *record, const double *times,
                 int64_t time_count) {
    skinslide_error why;
    skinslide_normals_layout layout = SKINSLIDE_NORMALS_VERTEX;
    bool is_attribute = is_row(input, SS_ROW_NORMALS), is_carried = input->kind == SS_KIND_CARRIED;
    const char *interpolation = is_attribute && !record->value.interpolation ? "vertex" : ss_interpolation(record);
    if (is_attribute && derived->primvar_counts) {
        if (derived->first)
            hide(derived);
        return;
    }
    derived->primvar_counts = derived->primvar_counts || is_row(input, SS_ROW_NORMALS_PRIMVAR);
    if (is_carried && strcmp(interpolation, "constant") == 0)
        return;
    skinslide_status status = judge(derived, input, record, interpolation, times, time_count, &layout, &why);
    add(derived, input, record, layout, status ? why.message : NULL);
    if (record->indices.type != SKINSLIDE_VALUE_NONE)
        block(derived, input, SS_INDICES, "int[]");
    if (!status && is_carried && time_count < 2 && derived->merged_count > 1)
        warn_of_static(derived, record->value.name);
}

/* Whether an input has made an output. */
static bool is_taken(const skinslide_stage_derived *derived, const ss_input *input) {
    for (const ss_derivation *own = derived->first; own; own = own->next)
        if (own->input == input)
            return true;
    return false;
}

skinslide_status skinslide_stage_derived_take(skinslide_stage_derived *derived, const skinslide_stage_input *input,
                                              const skinslide_value *value, const double *times, int64_t time_count,
                                              skinslide_error *error) {
    const ss_input *own = derived ? find_input(derived, input) : NULL;
    if (!own || time_count < 0 || (time_count > 0 && !times) || is_taken(derived, own))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing to derive into, no input of that, one taken twice, or no times");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status && record.value.type != SKINSLIDE_VALUE_NONE)
        take(derived, own, &record, times, time_count);
    return status ? status : derived->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

skinslide_status skinslide_stage_derived_check(skinslide_stage_derived *derived, const skinslide_stage_input *input,
                                               const skinslide_value *value, skinslide_error *error) {
    const ss_input *of = derived ? find_input(derived, input) : NULL;
    if (!of)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing derived, or no input of that");
    ss_record record;
    skinslide_error why;
    skinslide_status status = ss_open(value, &record, error);
    for (ss_derivation *own = status ? NULL : derived->first; own; own = own->next) {
        if (own->input != of || !own->output.pose_count || !ss_check_derived(derived->mesh, of, &record, own->layout, &why))
            continue;
        own->output.pose_count = 0, own->output.is_carried = false;
        own->output.reason = ss_copy_text(&derived->memory, why.message);
        if (own->output.hidden)
            block_hidden(derived);
    }
    return status ? status : derived->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

const skinslide_stage_output *skinslide_stage_derived_output(const skinslide_stage_derived *derived, int32_t number) {
    const ss_derivation *own = derived && number >= 0 ? derived->first : NULL;
    while (own && number-- > 0)
        own = own->next;
    return own ? &own->output : NULL;
}

/* ---- Primvars that are offered ---- */

static const skinslide_stage_input *accept(skinslide_stage_derived *derived, const ss_primvar *primvar, ss_kind kind,
                                           int32_t pose_count) {
    offer *made = SS_NEW(&derived->memory, offer, 1);
    if (!made)
        return NULL;
    made->input.shown = (skinslide_stage_input){
        .name = ss_copy_text(&derived->memory, primvar->name + strlen(SS_PRIMVARS)),
        .type_name = ss_copy_text(&derived->memory, primvar->type_name),
        .group = SKINSLIDE_STAGE_DERIVED,
        .prefix = SS_PRIMVARS,
        .when = SKINSLIDE_STAGE_ANIMATED,
        .is_primvar = 1,
    };
    made->input.kind = kind, made->input.pose_count = pose_count;
    made->next = derived->offers, derived->offers = made;
    return &made->input.shown;
}

skinslide_status skinslide_stage_derived_offer(skinslide_stage_derived *derived, const char *name, const char *type_name,
                                               const char *interpolation, int32_t element_size,
                                               const skinslide_stage_input **out, skinslide_error *error) {
    if (!derived || !name || !type_name || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing to derive into, no name or type, or no place for the input");
    const ss_primvar primvar = {name, type_name, interpolation ? interpolation : "constant", element_size};
    const skinslide_stage_input *input = NULL;
    skinslide_error why;
    ss_kind kind;
    int32_t pose_count;
    ss_following following = ss_follows(&primvar, &kind, &pose_count, &why);
    if (following == SS_FOLLOWS_UNKNOWN)
        warn(derived, why.message);
    if (following == SS_FOLLOWS)
        input = accept(derived, &primvar, kind, pose_count);
    if (derived->memory.failed)
        return ss_out_of_memory(error);
    *out = input;
    return SKINSLIDE_OK;
}
