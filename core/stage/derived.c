/* What else a mesh has that follows from its points: which vectors are carried with the skin, which rates are recomputed, and
 * which are blocked because they cannot be, since stale ones would shade and blur wrongly. */
#include "stage.h"

#include "mesh.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_POSES = 3 };

typedef struct derivation {
    skinslide_stage_output output;
    const ss_input *input;
    skinslide_normals_layout layout; /* of vectors that are carried */
    struct derivation *next;
} derivation;

/* A primvar that was offered, and is an input like those of the table. */
typedef struct offer {
    ss_input input;
    struct offer *next;
} offer;

typedef struct warning {
    const char *text;
    struct warning *next;
} warning;

struct skinslide_stage_derived {
    ss_memory memory;
    const skinslide_stage_mesh *mesh;
    double *point_times; /* [point_time_count] as authored; merged they are fewer */
    int64_t point_time_count;
    double *merged; /* point_times merged and, once filled, with the frames between */
    int64_t merged_count;
    double rate;
    bool primvar_counts;       /* primvars:normals win over normals */
    derivation *first, **last; /* outputs */
    offer *offers;
    warning *warnings, **last_warning;
};

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

static int32_t length_of_mesh(const skinslide_stage_mesh *mesh, skinslide_normals_layout layout) {
    const skinslide_mesh faces = ss_faces_of(mesh);
    return ss_element_count(&faces, layout);
}

static const char *element_of(skinslide_normals_layout layout) {
    return layout == SKINSLIDE_NORMALS_VERTEX ? "points" : layout == SKINSLIDE_NORMALS_FACE_VARYING ? "face corners" : "faces";
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

static skinslide_status check_shape(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_normals_layout layout,
                                    skinslide_error *error) {
    if (!ss_has_value(record))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "there is no value");
    skinslide_status status = ss_check_triples(record, SKINSLIDE_BAD_POINTS, error);
    return status ? status
                  : ss_check_length(record, length_of_mesh(mesh, layout), element_of(layout), SKINSLIDE_BAD_POINTS, error);
}

/* A primvar keeps its type; the types of attributes are USD's. */
static bool is_written_double(const ss_input *input, const ss_record *record) {
    return input->shown.is_primvar && record->value.type == SKINSLIDE_VALUE_DOUBLE;
}

/* Vectors that are too long block an output at all times, whether or not the skin under them slides. */
static skinslide_status check_lengths(const ss_input *input, const ss_record *record, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    bool is_double = is_written_double(input, record);
    for (int64_t i = 0; i < record->length && !status; i++) {
        double vector[3] = {ss_number(record, i, 0), ss_number(record, i, 1), ss_number(record, i, 2)};
        status = ss_check_vector(vector, is_double, i, error);
    }
    return status;
}

static skinslide_status check_value(const skinslide_stage_mesh *mesh, const ss_input *input, const ss_record *record,
                                    skinslide_normals_layout layout, skinslide_error *error) {
    skinslide_status status = check_shape(mesh, record, layout, error);
    if (!status)
        status = ss_check_indices(record, SKINSLIDE_BAD_POINTS, error);
    return status || input->kind != SS_KIND_CARRIED ? status : check_lengths(input, record, error);
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

static skinslide_status refuse_count(int64_t count, int32_t wanted, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_POINTS, "that takes %d samples of points, and there are %lld", wanted,
                   (long long)count);
}

static skinslide_status check_rate(const skinslide_stage_derived *derived, int32_t pose_count, const double *times,
                                   int64_t time_count, skinslide_error *error) {
    if (!(isfinite(derived->rate) && derived->rate > 0))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "the stage has %g time codes per second", derived->rate);
    if (derived->merged_count < pose_count)
        return refuse_count(derived->merged_count, pose_count, error);
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
    skinslide_error said;
    ss_fail(&said, SKINSLIDE_BAD_POINTS,
            SS_NAMED " has one value for all frames, but points moves: it belongs to one pose alone", SS_NAME(name));
    warn(derived, said.message);
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
static derivation *append(skinslide_stage_derived *derived, const ss_input *input) {
    derivation *made = SS_NEW(&derived->memory, derivation, 1);
    if (!made)
        return NULL;
    made->input = input;
    *derived->last = made, derived->last = &made->next;
    return made;
}

static void add(skinslide_stage_derived *derived, const ss_input *input, const ss_record *record,
                skinslide_normals_layout layout, const char *reason) {
    bool is_primvar = input->shown.is_primvar, is_carried = input->kind == SS_KIND_CARRIED && !reason;
    derivation *made = append(derived, input);
    if (!made)
        return;
    made->layout = layout;
    made->output = (skinslide_stage_output){
        .name = property_name(derived, &input->shown, ""),
        .type_name = is_primvar ? ss_copy_text(&derived->memory, record->value.type_name) : input->shown.type_name,
        .pose_count = reason ? 0 : input->pose_count,
        .count = length_of_mesh(derived->mesh, layout),
        .reason = reason ? ss_copy_text(&derived->memory, reason) : NULL,
        .is_carried = is_carried,
        .is_double = is_carried && is_written_double(input, record),
    };
}

/* Blocks an attribute in whose place another is written, or blocked. */
static void block(skinslide_stage_derived *derived, const ss_input *input, const char *suffix, const char *type_name) {
    derivation *made = append(derived, input);
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
    return status ? status : check_value(derived->mesh, input, record, *layout, error);
}

/* If the primvar is blocked, also blocks the normals that it hides, since they would be read again. */
static void block_hidden(skinslide_stage_derived *derived) {
    const ss_input *normals = input_of_row(SS_ROW_NORMALS);
    block(derived, normals, "", normals->shown.type_name);
}

static void hide(skinslide_stage_derived *derived) {
    derivation *primvar = derived->first;
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
    for (const derivation *own = derived->first; own; own = own->next)
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
    for (derivation *own = status ? NULL : derived->first; own; own = own->next) {
        if (own->input != of || !own->output.pose_count || !check_value(derived->mesh, of, &record, own->layout, &why))
            continue;
        own->output.pose_count = 0, own->output.is_carried = false;
        own->output.reason = ss_copy_text(&derived->memory, why.message);
        if (own->output.hidden)
            block_hidden(derived);
    }
    return status ? status : derived->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

const skinslide_stage_output *skinslide_stage_derived_output(const skinslide_stage_derived *derived, int32_t number) {
    const derivation *own = derived && number >= 0 ? derived->first : NULL;
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
    skinslide_error told;
    ss_kind kind;
    int32_t pose_count;
    ss_following following = ss_follows(&primvar, &kind, &pose_count, &told);
    if (following == SS_FOLLOWS_UNKNOWN)
        warn(derived, told.message);
    if (following == SS_FOLLOWS)
        input = accept(derived, &primvar, kind, pose_count);
    if (derived->memory.failed)
        return ss_out_of_memory(error);
    *out = input;
    return SKINSLIDE_OK;
}

/* ---- Values ---- */

static const derivation *find(const skinslide_stage_derived *derived, const skinslide_stage_output *output) {
    for (const derivation *own = derived ? derived->first : NULL; own; own = own->next)
        if (&own->output == output && output->pose_count)
            return own;
    return NULL;
}

int32_t skinslide_stage_derived_times(const skinslide_stage_derived *derived, const skinslide_stage_output *output, double time,
                                      double times[3]) {
    const derivation *own = find(derived, output);
    if (!own)
        return 0;
    if (output->pose_count > 1)
        return ss_samples_around(derived->merged, derived->merged_count, time, output->pose_count, times);
    times[0] = time;
    return 1;
}

static void copy(const ss_record *record, ss_vectors out) {
    if (out.floats)
        ss_copy_floats(record, out.floats);
    for (int64_t i = 0; out.doubles && i < 3 * record->length; i++)
        out.doubles[i] = ss_number(record, i / 3, (int32_t)(i % 3));
}

/* Computes the value of an output from the cache's vectors. */
static skinslide_status compute(const skinslide_stage_derived *derived, const derivation *own,
                                const skinslide_stage_pose *poses, ss_vectors out, skinslide_error *error) {
    skinslide_mesh mesh = ss_faces_of(derived->mesh);
    skinslide_sample samples[MOST_POSES];
    if (own->output.is_carried)
        return poses[0].turns ? ss_carry(&mesh, poses[0].turns, own->layout, out, error)
                              : ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the pose has no turns");
    for (int32_t i = 0; i < own->output.pose_count; i++)
        samples[i] =
            (skinslide_sample){sizeof(skinslide_sample), poses[i].time / derived->rate, poses[i].cached, poses[i].slid};
    return own->output.pose_count == 2 ? skinslide_velocities(mesh.vertex_count, samples, out.floats, error)
                                       : skinslide_accelerations(mesh.vertex_count, samples, out.floats, error);
}

skinslide_status skinslide_stage_derived_value(const skinslide_stage_derived *derived, const skinslide_stage_output *output,
                                               const skinslide_value *value, const skinslide_stage_pose *poses,
                                               int32_t pose_count, void *out, skinslide_error *error) {
    const derivation *own = find(derived, output);
    if (!own || pose_count < 0 || (pose_count && !poses) || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such output, no poses, or no place for the value");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = check_value(derived->mesh, own->input, &record, own->layout, error);
    if (!status && pose_count != output->pose_count)
        status = refuse_count(pose_count, output->pose_count, error);
    const skinslide_stage_pose standard = SKINSLIDE_STAGE_POSE_DEFAULT;
    skinslide_stage_pose taken[MOST_POSES];
    if (!status)
        status = ss_take_all(poses, pose_count, "skinslide_stage_pose", taken, sizeof standard, &standard, error);
    if (status)
        return status;
    ss_vectors vectors = output->is_double ? (ss_vectors){NULL, out} : (ss_vectors){out, NULL};
    copy(&record, vectors);
    return compute(derived, own, taken, vectors, error);
}

/* ---- What is not finite ---- */

static bool is_finite(const ss_record *record, int64_t element) {
    return isfinite(ss_number(record, element, 0)) && isfinite(ss_number(record, element, 1)) &&
           isfinite(ss_number(record, element, 2));
}

static void tell(skinslide_error *told, const ss_record *record, int32_t count, int32_t first) {
    bool several = count > 1;
    ss_fail(told, SKINSLIDE_BAD_POINTS, SS_NAMED " has %d value%s not finite, which pass%s as %s: number %d%s is (%g, %g, %g)",
            SS_NAME(record->value.name), count, several ? "s that are" : " that is", several ? "" : "es",
            several ? "they are" : "it is", first, several ? ", the first," : "", ss_number(record, first, 0),
            ss_number(record, first, 1), ss_number(record, first, 2));
}

skinslide_status skinslide_stage_derived_look(const skinslide_stage_derived *derived, const skinslide_stage_output *output,
                                              const skinslide_value *value, int32_t *faults, skinslide_error *told,
                                              skinslide_error *error) {
    const derivation *own = find(derived, output);
    if (!own || !faults)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such output, or no place for how many faults it has");
    ss_record record;
    skinslide_error why;
    skinslide_status status = ss_open(value, &record, error);
    bool can_be_used = !status && !check_value(derived->mesh, own->input, &record, own->layout, &why);
    int32_t count = 0, first = -1;
    for (int64_t i = 0; can_be_used && i < record.length; i++)
        if (!is_finite(&record, i))
            first = count++ ? first : (int32_t)i;
    if (!status)
        *faults = count;
    if (!status && count)
        tell(told, &record, count, first);
    return status;
}
