/* Values of what follows from points, at a time: vectors turned with the skin, rates of change from the poses around it. */
#include "stage.h"

#include "mesh.h"

#include <math.h>

enum { MOST_POSES = 3 };

/* ---- What can be used ---- */

int32_t ss_derived_length(const skinslide_stage_mesh *mesh, skinslide_normals_layout layout) {
    const skinslide_mesh faces = ss_faces_of(mesh);
    return ss_element_count(&faces, layout);
}

static const char *element_of(skinslide_normals_layout layout) {
    return layout == SKINSLIDE_NORMALS_VERTEX ? "points" : layout == SKINSLIDE_NORMALS_FACE_VARYING ? "face corners" : "faces";
}

static skinslide_status check_shape(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_normals_layout layout,
                                    skinslide_error *error) {
    if (!ss_has_value(record))
        return ss_fail(error, SKINSLIDE_BAD_POINTS, "there is no value");
    skinslide_status status = ss_check_triples(record, SKINSLIDE_BAD_POINTS, error);
    return status ? status
                  : ss_check_length(record, ss_derived_length(mesh, layout), element_of(layout), SKINSLIDE_BAD_POINTS, error);
}

/* A primvar keeps its type; the types of attributes are USD's. */
bool ss_is_written_double(const ss_input *input, const ss_record *record) {
    return input->shown.is_primvar && record->value.type == SKINSLIDE_VALUE_DOUBLE;
}

/* Vectors that are too long block an output at all times, whether or not the skin under them slides. */
static skinslide_status check_lengths(const ss_input *input, const ss_record *record, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    bool is_double = ss_is_written_double(input, record);
    for (int64_t i = 0; i < record->length && !status; i++) {
        double vector[3] = {ss_number(record, i, 0), ss_number(record, i, 1), ss_number(record, i, 2)};
        status = ss_check_vector(vector, is_double, i, error);
    }
    return status;
}

skinslide_status ss_check_derived(const skinslide_stage_mesh *mesh, const ss_input *input, const ss_record *record,
                                  skinslide_normals_layout layout, skinslide_error *error) {
    skinslide_status status = check_shape(mesh, record, layout, error);
    if (!status)
        status = ss_check_indices(record, SKINSLIDE_BAD_POINTS, error);
    return status || input->kind != SS_KIND_CARRIED ? status : check_lengths(input, record, error);
}

skinslide_status ss_refuse_poses(int64_t count, int32_t wanted, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_POINTS, "that takes %d samples of points, and there are %lld", wanted,
                   (long long)count);
}

/* ---- Values ---- */

static const ss_derivation *find(const skinslide_stage_derived *derived, const skinslide_stage_output *output) {
    for (const ss_derivation *own = derived ? derived->first : NULL; own; own = own->next)
        if (&own->output == output && output->pose_count)
            return own;
    return NULL;
}

int32_t skinslide_stage_derived_times(const skinslide_stage_derived *derived, const skinslide_stage_output *output, double time,
                                      double times[3]) {
    const ss_derivation *own = find(derived, output);
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
static skinslide_status compute(const skinslide_stage_derived *derived, const ss_derivation *own,
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
    const ss_derivation *own = find(derived, output);
    if (!own || pose_count < 0 || (pose_count && !poses) || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such output, no poses, or no place for the value");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = ss_check_derived(derived->mesh, own->input, &record, own->layout, error);
    if (!status && pose_count != output->pose_count)
        status = ss_refuse_poses(pose_count, output->pose_count, error);
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

static void warn(skinslide_error *warning, const ss_record *record, int32_t count, int32_t first) {
    bool several = count > 1;
    ss_fail(warning, SKINSLIDE_BAD_POINTS,
            SS_NAMED " has %d value%s not finite, which pass%s as %s: number %d%s is (%g, %g, %g)", SS_NAME(record->value.name),
            count, several ? "s that are" : " that is", several ? "" : "es", several ? "they are" : "it is", first,
            several ? ", the first," : "", ss_number(record, first, 0), ss_number(record, first, 1),
            ss_number(record, first, 2));
}

skinslide_status skinslide_stage_derived_faults(const skinslide_stage_derived *derived, const skinslide_stage_output *output,
                                                const skinslide_value *value, int32_t *faults, skinslide_error *warning,
                                                skinslide_error *error) {
    const ss_derivation *own = find(derived, output);
    if (!own || !faults)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such output, or no place for how many faults it has");
    ss_record record;
    skinslide_error why;
    skinslide_status status = ss_open(value, &record, error);
    bool can_be_used = !status && !ss_check_derived(derived->mesh, own->input, &record, own->layout, &why);
    int32_t count = 0, first = -1;
    for (int64_t i = 0; can_be_used && i < record.length; i++)
        if (!is_finite(&record, i))
            first = count++ ? first : (int32_t)i;
    if (!status)
        *faults = count;
    if (!status && count)
        warn(warning, &record, count, first);
    return status;
}
