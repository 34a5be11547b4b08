/* What else a mesh has that follows from its points: which normals, velocities and accelerations count, which are recomputed,
 * and which are blocked because they cannot be, since stale ones would shade and blur wrongly. */
#include "stage.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_OUTPUTS = 2 * SS_DERIVED_ROWS, MOST_POSES = 3 };

typedef struct derivation {
    skinslide_stage_output output;
    int32_t row;
    skinslide_normals_layout layout; /* of normals */
} derivation;

struct skinslide_stage_derived {
    ss_memory memory;
    const skinslide_stage_mesh *mesh;
    double *point_times; /* [point_time_count] as authored; merged they are fewer */
    int64_t point_time_count;
    double *merged;
    int64_t merged_count;
    double rate;
    bool primvar_counts; /* primvars:normals win over normals */
    derivation derivations[MOST_OUTPUTS];
    int32_t count;
};

static const ss_input *inputs(void) {
    int32_t count;
    return ss_inputs(SKINSLIDE_STAGE_DERIVED, &count);
}

static int64_t length_of_mesh(const skinslide_stage_mesh *mesh, skinslide_normals_layout layout) {
    skinslide_mesh faces = ss_faces_of(mesh);
    return layout == SKINSLIDE_NORMALS_VERTEX         ? faces.vertex_count
           : layout == SKINSLIDE_NORMALS_FACE_VARYING ? faces.index_count
                                                      : faces.face_count;
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
    skinslide_status status = copy_times(derived, point_times, point_time_count, error);
    if (status)
        skinslide_stage_derived_destroy(derived);
    else
        *out = derived;
    return status;
}

void skinslide_stage_derived_destroy(skinslide_stage_derived *derived) {
    if (!derived)
        return;
    ss_free(&derived->memory);
    free(derived);
}

/* ---- Normals ---- */

/* Which elements carry a normal. Constant ones do not follow from points. */
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

static skinslide_status check_value(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_normals_layout layout,
                                    skinslide_error *error) {
    skinslide_status status = check_shape(mesh, record, layout, error);
    return status ? status : ss_check_indices(record, SKINSLIDE_BAD_POINTS, error);
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
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "that takes %d samples of points, and there are %lld", pose_count,
                       (long long)derived->merged_count);
    if (!same_times(derived, times, time_count))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "their samples are at other times than those of points");
    return SKINSLIDE_OK;
}

/* ---- Outputs ---- */

static const char *property_name(skinslide_stage_derived *derived, const skinslide_stage_input *input, const char *suffix) {
    char name[64];
    snprintf(name, sizeof name, "%s%s%s", input->prefix, input->name, suffix);
    return ss_copy_text(&derived->memory, name);
}

/* A primvar keeps the type that it has; of the others USD says which. */
static void add(skinslide_stage_derived *derived, int32_t row, const ss_record *record, skinslide_normals_layout layout,
                const char *reason) {
    const ss_input *input = &inputs()[row];
    derivation *made = &derived->derivations[derived->count++];
    made->row = row, made->layout = layout;
    made->output = (skinslide_stage_output){
        .name = property_name(derived, &input->shown, ""),
        .type_name = input->shown.is_primvar ? ss_copy_text(&derived->memory, record->value.type_name) : input->shown.type_name,
        .pose_count = reason ? 0 : input->pose_count,
        .count = (int32_t)length_of_mesh(derived->mesh, layout),
        .reason = reason ? ss_copy_text(&derived->memory, reason) : NULL,
    };
}

/* What is blocked because something else is written, or blocked, in its place. */
static void block(skinslide_stage_derived *derived, int32_t row, const char *suffix, const char *type_name) {
    derivation *made = &derived->derivations[derived->count++];
    *made = (derivation){.row = row};
    made->output.name = property_name(derived, &inputs()[row].shown, suffix);
    made->output.type_name = type_name;
}

static skinslide_status judge(const skinslide_stage_derived *derived, int32_t row, const ss_record *record,
                              const char *interpolation, const double *times, int64_t time_count,
                              skinslide_normals_layout *layout, skinslide_error *error) {
    const ss_input *input = &inputs()[row];
    skinslide_status status = input->kind == SS_KIND_NORMALS ? choose_layout(record, interpolation, layout, error)
                                                             : check_rate(derived, input->pose_count, times, time_count, error);
    return status ? status : check_value(derived->mesh, record, *layout, error);
}

/* Normals that the primvar hides are read again where it has to be blocked. */
static void block_hidden(skinslide_stage_derived *derived) {
    block(derived, SS_ROW_NORMALS, "", inputs()[SS_ROW_NORMALS].shown.type_name);
}

static void hide(skinslide_stage_derived *derived) {
    derivation *primvar = &derived->derivations[0];
    primvar->output.hidden = property_name(derived, &inputs()[SS_ROW_NORMALS].shown, "");
    if (!primvar->output.pose_count)
        block_hidden(derived);
}

static void take(skinslide_stage_derived *derived, int32_t row, const ss_record *record, const double *times,
                 int64_t time_count) {
    skinslide_error why;
    skinslide_normals_layout layout = SKINSLIDE_NORMALS_VERTEX;
    const char *interpolation = row == SS_ROW_NORMALS && !record->value.interpolation ? "vertex" : ss_interpolation(record);
    bool is_constant = inputs()[row].kind == SS_KIND_NORMALS && strcmp(interpolation, "constant") == 0;
    if (row == SS_ROW_NORMALS && derived->primvar_counts) {
        if (derived->count)
            hide(derived);
        return;
    }
    derived->primvar_counts = derived->primvar_counts || row == SS_ROW_NORMALS_PRIMVAR;
    if (is_constant)
        return;
    skinslide_status status = judge(derived, row, record, interpolation, times, time_count, &layout, &why);
    add(derived, row, record, layout, status ? why.message : NULL);
    if (record->indices.type != SKINSLIDE_VALUE_NONE)
        block(derived, row, ":indices", "int[]");
}

skinslide_status skinslide_stage_derived_take(skinslide_stage_derived *derived, const skinslide_stage_input *input,
                                              const skinslide_value *value, const double *times, int64_t time_count,
                                              skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_DERIVED, input);
    if (!derived || row < 0 || time_count < 0 || (time_count > 0 && !times) || derived->count + 2 > MOST_OUTPUTS)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing to derive into, no input of that, one taken twice, or no times");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status && record.value.type != SKINSLIDE_VALUE_NONE)
        take(derived, row, &record, times, time_count);
    return status ? status : derived->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

skinslide_status skinslide_stage_derived_check(skinslide_stage_derived *derived, const skinslide_stage_input *input,
                                               const skinslide_value *value, skinslide_error *error) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_DERIVED, input);
    if (!derived || row < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing derived, or no input of that");
    ss_record record;
    skinslide_error why;
    skinslide_status status = ss_open(value, &record, error);
    for (int32_t i = 0; !status && i < derived->count; i++) {
        derivation *own = &derived->derivations[i];
        if (own->row != row || !own->output.pose_count || !check_shape(derived->mesh, &record, own->layout, &why))
            continue;
        own->output.pose_count = 0;
        own->output.reason = ss_copy_text(&derived->memory, why.message);
        if (own->output.hidden)
            block_hidden(derived);
    }
    return status ? status : derived->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

const skinslide_stage_output *skinslide_stage_derived_output(const skinslide_stage_derived *derived, int32_t number) {
    return number >= 0 && number < derived->count ? &derived->derivations[number].output : NULL;
}

/* ---- Values ---- */

static const derivation *find(const skinslide_stage_derived *derived, const skinslide_stage_output *output) {
    for (int32_t i = 0; derived && i < derived->count; i++)
        if (&derived->derivations[i].output == output && output->pose_count)
            return &derived->derivations[i];
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

static skinslide_status compute(const skinslide_stage_derived *derived, const derivation *own,
                                const skinslide_stage_pose *poses, float *out, skinslide_error *error) {
    skinslide_mesh mesh = ss_faces_of(derived->mesh);
    skinslide_sample samples[MOST_POSES];
    if (own->output.pose_count == 1)
        return skinslide_normals(&mesh, poses[0].cached, poses[0].slid, own->layout, derived->mesh->left_handed, out, error);
    for (int32_t i = 0; i < own->output.pose_count; i++)
        samples[i] =
            (skinslide_sample){sizeof(skinslide_sample), poses[i].time / derived->rate, poses[i].cached, poses[i].slid};
    return own->output.pose_count == 2 ? skinslide_velocities(mesh.vertex_count, samples, out, error)
                                       : skinslide_accelerations(mesh.vertex_count, samples, out, error);
}

skinslide_status skinslide_stage_derived_value(const skinslide_stage_derived *derived, const skinslide_stage_output *output,
                                               const skinslide_value *value, const skinslide_stage_pose *poses,
                                               int32_t pose_count, float *out, skinslide_error *error) {
    const derivation *own = find(derived, output);
    if (!own || pose_count < 0 || (pose_count && !poses) || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such output, no poses, or no place for the value");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = check_value(derived->mesh, &record, own->layout, error);
    if (!status && pose_count != output->pose_count)
        status = ss_fail(error, SKINSLIDE_BAD_POINTS, "that takes %d samples of points, and there are %d", output->pose_count,
                         pose_count);
    const skinslide_stage_pose standard = SKINSLIDE_STAGE_POSE_DEFAULT;
    skinslide_stage_pose taken[MOST_POSES];
    if (!status)
        status = ss_take_all(poses, pose_count, "skinslide_stage_pose", taken, sizeof standard, &standard, error);
    if (status)
        return status;
    ss_copy_floats(&record, out);
    return compute(derived, own, taken, out, error);
}
