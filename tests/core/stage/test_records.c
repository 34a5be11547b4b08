/* Random records to every call, valid and not: never a crash, a sentence for each refusal, and what is given comes out whole.
 * Seeded, so every run is the same. */
#include "records.h"
#include "skinslide/paint.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 20000, MOST_NUMBERS = 64 };

static skinslide_error error;

/* Numbers of every type, in memory of just their size, so that a sanitizer sees one read too many. */
typedef struct random_value {
    skinslide_value value, indices;
    void *data, *index_data;
    char text[16];
} random_value;

static size_t size_of(skinslide_value_type type) {
    static const size_t sizes[] = {0, 0, 1, 1, 4, 4, 8, 8, 2, 4, 8, 1, 1, 0};
    return sizes[type];
}

static void *random_numbers(dice *d, skinslide_value_type type, int64_t count) {
    size_t size = size_of(type) * (size_t)count;
    uint8_t *bytes = malloc(size ? size : 1);
    int32_t style = roll_below(d, 3);
    for (size_t i = 0; i < size; i++)
        bytes[i] = style ? 0 : (uint8_t)roll(d);
    for (int64_t i = 0; style && i < count; i++) {
        int32_t small = roll_below(d, style == 1 ? 10 : 3);
        if (type == SKINSLIDE_VALUE_FLOAT)
            ((float *)bytes)[i] = roll_below(d, 40) ? (float)small / 2 : NAN;
        else if (type == SKINSLIDE_VALUE_DOUBLE)
            ((double *)bytes)[i] = roll_below(d, 40) ? small / 2.0 : DBL_MAX;
        else if (size_of(type))
            bytes[(size_t)i * size_of(type)] = (uint8_t)small; /* of the lowest byte, where that comes first */
    }
    if (type == SKINSLIDE_VALUE_BOOL)
        for (size_t i = 0; i < size; i++)
            bytes[i] &= 1;
    return bytes;
}

static int64_t random_count(dice *d, const test_mesh *mesh) {
    const int64_t fit[] = {mesh->vertex_count, mesh->face_count, mesh->index_count, 1, 0, 4, 2};
    return roll_below(d, 4) ? fit[roll_below(d, 7)] : roll_below(d, MOST_NUMBERS);
}

static const char *random_interpolation(dice *d) {
    static const char *const all[] = {NULL, "constant", "uniform", "vertex", "varying", "faceVarying", "nonsense"};
    return all[roll_below(d, 7)];
}

static void make_value(random_value *v, dice *d, const test_mesh *mesh, const skinslide_stage_input *input) {
    static const char *const words[] = {"", "face", "st", "circle", "limit", "none", "m.<UDIM>.exr", "m.exr"};
    skinslide_value_type likely[] = {SKINSLIDE_VALUE_FLOAT, SKINSLIDE_VALUE_INT32, SKINSLIDE_VALUE_BOOL};
    skinslide_value_type type = roll_below(d, 2) ? likely[roll_below(d, 3)] : (skinslide_value_type)roll_below(d, 14);
    memset(v, 0, sizeof *v);
    v->value = array_of(roll_below(d, 20) ? input->name : NULL, type, 1 + (roll_below(d, 3) ? 0 : roll_below(d, 3)),
                        random_count(d, mesh), NULL);
    v->value.is_array = roll_below(d, 4) > 0;
    v->value.count = v->value.is_array ? v->value.count : 1;
    v->value.interpolation = random_interpolation(d);
    if (type == SKINSLIDE_VALUE_TEXT || type == SKINSLIDE_VALUE_ASSET) {
        strcpy(v->text, input->tokens && roll_below(d, 2) ? input->tokens[0] : words[roll_below(d, 8)]);
        v->value.data = v->text, v->value.count = 1;
    } else {
        v->value.data = v->data = random_numbers(d, type, v->value.count * v->value.width);
    }
    if (roll_below(d, 5) == 0) {
        type = roll_below(d, 5) ? SKINSLIDE_VALUE_INT32 : (skinslide_value_type)roll_below(d, 11);
        v->indices = array_of("indices", type, 1, random_count(d, mesh), NULL);
        v->indices.data = v->index_data = random_numbers(d, type, v->indices.count);
        v->value.indices = &v->indices;
    }
}

static void free_value(random_value *v) {
    free(v->data), free(v->index_data);
}

/* A refusal has a sentence of one line. */
static void expect_said(skinslide_status status) {
    if (!status)
        return;
    assert_int_equal(error.status, status);
    assert_true(*error.message && !strchr(error.message, '\n'));
    error.message[0] = 0;
}

typedef skinslide_status (*taker)(void *handle, const skinslide_stage_input *input, const skinslide_value *value);

static skinslide_status take_mesh(void *handle, const skinslide_stage_input *input, const skinslide_value *value) {
    skinslide_status status = skinslide_stage_mesh_take(handle, input, value, &error);
    if (!status && input->when == SKINSLIDE_STAGE_STILL)
        assert_ok(skinslide_stage_mesh_check(handle, input, value, 1, &error), &error);
    return status;
}

static skinslide_status take_patch(void *handle, const skinslide_stage_input *input, const skinslide_value *value) {
    skinslide_status status = skinslide_stage_patch_take(handle, input, value, &error);
    if (!status && value->type != SKINSLIDE_VALUE_NONE && input->when != SKINSLIDE_STAGE_DEFAULT_TIME)
        assert_ok(skinslide_stage_patch_check(handle, input, value, 1, &error), &error);
    return status;
}

static skinslide_status take_controls(void *handle, const skinslide_stage_input *input, const skinslide_value *value) {
    return skinslide_stage_controls_take(handle, input, value, &error);
}

static skinslide_status take_derived(void *handle, const skinslide_stage_input *input, const skinslide_value *value) {
    static const double times[] = {1, 2, 3};
    return skinslide_stage_derived_take(handle, input, value, times, 3, &error);
}

/* Takes a value for each input of a group, mostly none at all where `sparse`. */
static void take_all(dice *d, const test_mesh *mesh, skinslide_stage_group group, taker take, void *handle, int32_t sparse) {
    const skinslide_stage_input *input = NULL;
    while ((input = skinslide_stage_next_input(group, input)) != NULL) {
        random_value v;
        make_value(&v, d, mesh, input);
        if (sparse && roll_below(d, sparse))
            v.value.type = SKINSLIDE_VALUE_NONE, v.value.indices = NULL;
        expect_said(take(handle, input, &v.value));
        free_value(&v);
    }
}

/* ---- Textures ---- */

static void give_files(dice *d, const test_mesh *mesh, skinslide_stage_controls *controls) {
    if (!skinslide_stage_controls_coordinates(controls))
        return;
    random_value st;
    make_value(&st, d, mesh, input_of(SKINSLIDE_STAGE_PATCH, NULL, "mapSt"));
    if (roll_below(d, 2))
        st.value.type = SKINSLIDE_VALUE_FLOAT, st.value.width = 2, st.value.is_array = 1, st.value.indices = NULL,
        free(st.data), st.value.count = mesh->vertex_count, st.value.interpolation = "vertex",
        st.value.data = st.data = random_numbers(d, SKINSLIDE_VALUE_FLOAT, 2 * st.value.count);
    expect_said(skinslide_stage_controls_take(controls, skinslide_stage_controls_coordinates(controls), &st.value, &error));
    free_value(&st);
    const float texel = (float)roll_between(d, -0.5, 2);
    const skinslide_channel channel = {sizeof(skinslide_channel), "R", &texel};
    skinslide_bytes *bytes = NULL;
    assert_ok(skinslide_exr_encode(&channel, 1, 1, 1, SKINSLIDE_WRAP_CLAMP, &bytes, &error), &error);
    const skinslide_stage_need *need = NULL;
    expect_said(skinslide_stage_controls_need(controls, &need, &error));
    for (int32_t i = 0; need && i < MOST_NUMBERS; i++) {
        skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
        file.path = roll_below(d, 20) ? need->path : NULL;
        file.bytes = roll_below(d, 20) ? bytes->data : NULL;
        file.byte_count = roll_below(d, 20) ? bytes->size : roll_below(d, (int32_t)bytes->size);
        expect_said(skinslide_stage_controls_give(controls, &file, &error));
        expect_said(skinslide_stage_controls_need(controls, &need, &error));
    }
    skinslide_bytes_destroy(bytes);
}

/* ---- What is given ---- */

/* Every number that the slider will read is there. */
static void read_controls(const skinslide_controls *controls, const test_mesh *mesh) {
    double sum = (double)controls->envelope;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        sum += controls->weight ? (double)controls->weight[v] : 0;
        sum += controls->vertex_density ? (double)controls->vertex_density[v] : 0;
        sum += controls->max_distance ? (double)controls->max_distance[v] : 0;
        assert_false(controls->vertex_density && !(controls->vertex_density[v] > 0));
    }
    for (int32_t f = 0; f < mesh->face_count; f++)
        assert_false(controls->face_density && !(controls->face_density[f] > 0));
    for (int32_t e = 0; e < controls->edge_count; e++)
        assert_true(controls->edge_density[e] > 0 && controls->edges[2 * e] == controls->edges[2 * e]);
    assert_false(isnan(sum));
}

static void use_patch(dice *d, const test_mesh *mesh, const skinslide_stage_mesh *scene, int32_t *made) {
    skinslide_stage_patch *patch = NULL;
    skinslide_stage_controls *first = NULL, *frame = NULL;
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    assert_ok(skinslide_stage_patch_create(scene, "elbow", NULL, &patch, &error), &error);
    take_all(d, mesh, SKINSLIDE_STAGE_PATCH, take_patch, patch, 16);
    if (roll_below(d, 2))
        expect_said(patch_takes(
            patch, "patch",
            painted_as(array_of("patch", SKINSLIDE_VALUE_INT32, 1, mesh->face_count, mesh->face_counts), "uniform"), &error));
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    subset.path = "/mesh/elbow", subset.is_subset = 1;
    expect_said(skinslide_stage_patch_take_subset(patch, roll_below(d, 2) ? &subset : NULL, &error));
    take_all(d, mesh, SKINSLIDE_STAGE_SUBSET, take_patch, patch, 0);
    assert_ok(skinslide_stage_controls_create(patch, NULL, &first, &error), &error);
    take_all(d, mesh, SKINSLIDE_STAGE_CONTROLS, take_controls, first, 9);
    give_files(d, mesh, first);
    skinslide_status status = skinslide_stage_patch_get(patch, first, &setup, &error);
    expect_said(status);
    if (!status) {
        assert_true(setup.face_count > 0 && setup.faces[setup.face_count - 1] < mesh->face_count);
        read_controls(setup.controls, mesh);
        ++*made;
    }
    assert_ok(skinslide_stage_controls_create(patch, first, &frame, &error), &error);
    for (int32_t i = 0; i < 3; i++) {
        take_all(d, mesh, SKINSLIDE_STAGE_CONTROLS, take_controls, frame, 4);
        give_files(d, mesh, frame);
        status = skinslide_stage_controls_get(frame, &controls, &error);
        expect_said(status);
        if (!status)
            read_controls(&controls, mesh);
    }
    skinslide_stage_controls_destroy(frame), skinslide_stage_controls_destroy(first);
    skinslide_stage_patch_destroy(patch);
}

static void take_offered(dice *d, const test_mesh *mesh, skinslide_stage_derived *derived) {
    static const char *const names[] = {"primvars:tangents", "primvars:v", "primvars:flow", "primvars:", "", "primvars:a:N"};
    static const char *const types[] = {"vector3f[]", "double3[]", "normal3h[]", "float4[]", "quatf[]", "", "float"};
    static const char *const interpolations[] = {"vertex", "faceVarying", "uniform", "constant", "bumpy"};
    for (int i = 0; i < 8; i++) {
        const skinslide_stage_input *input = NULL;
        random_value v;
        assert_ok(skinslide_stage_derived_offer(derived, names[roll_below(d, 6)], types[roll_below(d, 7)],
                                                interpolations[roll_below(d, 5)], roll_below(d, 3), &input, &error),
                  &error);
        make_value(&v, d, mesh, input_of(SKINSLIDE_STAGE_DERIVED, NULL, "normals"));
        if (input)
            expect_said(take_derived(derived, input, &v.value));
        free_value(&v);
    }
}

static void use_derived(dice *d, const test_mesh *mesh, const skinslide_stage_mesh *scene) {
    static const double times[] = {1, 2, 3};
    skinslide_stage_derived *derived = NULL;
    const skinslide_stage_output *output;
    assert_ok(skinslide_stage_derived_create(scene, times, 3, 24, &derived, &error), &error);
    take_all(d, mesh, SKINSLIDE_STAGE_DERIVED, take_derived, derived, 2);
    take_offered(d, mesh, derived);
    for (int32_t i = 0; (output = skinslide_stage_derived_output(derived, i)) != NULL; i++) {
        double around[3];
        int32_t count = skinslide_stage_derived_times(derived, output, 2, around);
        skinslide_stage_pose poses[3];
        double *out = malloc(3 * sizeof *out * (size_t)(output->count ? output->count : 1));
        random_value v;
        for (int32_t k = 0; k < count; k++)
            poses[k] =
                (skinslide_stage_pose){sizeof(skinslide_stage_pose), around[k], mesh->points, mesh->points, mesh->points};
        make_value(&v, d, mesh, input_of(SKINSLIDE_STAGE_DERIVED, NULL, "normals"));
        if (output->pose_count)
            expect_said(skinslide_stage_derived_value(derived, output, &v.value, poses, count, out, &error));
        free_value(&v), free(out);
    }
    skinslide_stage_derived_destroy(derived);
}

static void random_records(void **state) {
    (void)state;
    int32_t made = 0;
    for (int32_t round = 0; round < ROUNDS; round++) {
        dice d = {(uint64_t)round + 1};
        test_mesh mesh = round % 2 ? quad_grid(1 + roll_below(&d, 2), 1 + roll_below(&d, 2)) : annulus(3, 1);
        skinslide_stage_mesh *wild = NULL, *scene = scene_mesh(&mesh);
        skinslide_mesh out = SKINSLIDE_MESH_DEFAULT;
        assert_ok(skinslide_stage_mesh_create(&wild, &error), &error);
        take_all(&d, &mesh, SKINSLIDE_STAGE_MESH, take_mesh, wild, 0);
        expect_said(skinslide_stage_mesh_get(wild, &out, &error));
        take_all(&d, &mesh, SKINSLIDE_STAGE_SUBDIVISION, take_mesh, scene, 2);
        expect_said(skinslide_stage_mesh_get(scene, &out, &error));
        use_patch(&d, &mesh, scene, &made);
        use_derived(&d, &mesh, scene);
        skinslide_stage_mesh_destroy(wild), skinslide_stage_mesh_destroy(scene);
        free_mesh(&mesh);
    }
    print_message("%d of %d patches were whole\n", made, ROUNDS);
    assert_true(made > ROUNDS / 20);
}

/* Names cut, repeated and glued together at random. */
static void random_names(void **state) {
    (void)state;
    static const char *const parts[] = {
        "skinSlide", "primvars", "SkinSlideAPI", "elbow", "envelope", "indices", "live", ":", ":", ":", ""};
    for (int32_t round = 0; round < 5 * ROUNDS; round++) {
        dice d = {(uint64_t)round + 1};
        char texts[8][96] = {{0}};
        const char *names[8];
        for (int32_t i = 0; i < 8; i++) {
            for (int32_t k = roll_below(&d, 7); k > 0; k--)
                strcat(texts[i], parts[roll_below(&d, 11)]);
            names[i] = texts[i];
        }
        skinslide_stage_prim prim = SKINSLIDE_STAGE_PRIM_DEFAULT;
        skinslide_stage_finding *finding = NULL;
        prim.is_mesh = roll_below(&d, 2), prim.is_defined = roll_below(&d, 4), prim.point_samples = roll_below(&d, 2);
        prim.schema_count = roll_below(&d, 5), prim.schemas = names;
        prim.property_count = 8 - prim.schema_count, prim.properties = names + prim.schema_count;
        assert_ok(skinslide_stage_find(&prim, &finding, &error), &error);
        for (int32_t i = 0; i < finding->patch_count; i++)
            assert_true(*finding->patches[i]);
        skinslide_stage_finding_destroy(finding);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_records),
        cmocka_unit_test(random_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
