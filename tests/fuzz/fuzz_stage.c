/* Records of any bytes for every input of a mesh, a patch and its controls: taken or refused in one line, and what is given is
 * what a slider can read. */
#include "skinslide/stage.h"
#include "stream.h"

enum { MOST_NUMBERS = 40, MOST_TEXT = 24 };

/* Two quads side by side. */
static const int32_t sound_counts[] = {4, 4}, sound_indices[] = {0, 1, 4, 3, 1, 2, 5, 4};
static const float sound_points[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0};

static skinslide_value array_of(const char *name, skinslide_value_type type, int32_t width, int64_t count, const void *data) {
    skinslide_value value = SKINSLIDE_VALUE_DEFAULT;
    value.name = name, value.type = type, value.is_array = 1, value.width = width, value.count = count, value.data = data;
    return value;
}

/* What the mesh needs to be one; false for the inputs that it can do without. */
static int sound_value(const skinslide_stage_input *input, skinslide_value *out) {
    if (!strcmp(input->name, "points"))
        *out = array_of(input->name, SKINSLIDE_VALUE_FLOAT, 3, 6, sound_points);
    else if (!strcmp(input->name, "faceVertexCounts"))
        *out = array_of(input->name, SKINSLIDE_VALUE_INT32, 1, 2, sound_counts);
    else if (!strcmp(input->name, "faceVertexIndices"))
        *out = array_of(input->name, SKINSLIDE_VALUE_INT32, 1, 8, sound_indices);
    else
        return 0;
    return 1;
}

/* A record and the memory that it points into. */
typedef struct record {
    skinslide_value value, indices;
    void *data, *index_data;
    char text[MOST_TEXT];
} record;

static size_t size_of(skinslide_value_type type) {
    static const size_t sizes[] = {0, 0, 1, 1, 4, 4, 8, 8, 2, 4, 8, 1, 1, 0};
    return sizes[type];
}

static void *take_numbers(stream *s, skinslide_value_type type, int64_t count) {
    size_t size = (size_t)count * size_of(type);
    uint8_t *bytes = take_new(s, size);
    for (size_t i = 0; type == SKINSLIDE_VALUE_BOOL && i < size; i++)
        bytes[i] &= 1;
    return bytes;
}

static const char *any_token(stream *s, const char *const *tokens) {
    int32_t count = 0;
    while (tokens[count])
        count++;
    return tokens[take_below(s, count)];
}

static void take_record(record *r, stream *s, const skinslide_stage_input *input) {
    static const char *const interpolations[] = {NULL, "constant", "uniform", "vertex", "varying", "faceVarying", "nonsense"};
    skinslide_value_type type = (skinslide_value_type)take_below(s, SKINSLIDE_VALUE_OTHER + 1);
    int32_t width = 1 + take_below(s, 3), count = take_below(s, MOST_NUMBERS);
    memset(r, 0, sizeof *r);
    r->value = array_of(take_below(s, 20) ? input->name : NULL, type, width, count, NULL);
    r->value.interpolation = interpolations[take_below(s, 7)];
    if (take_below(s, 4) == 0)
        r->value.is_array = 0, r->value.count = 1;
    if (type == SKINSLIDE_VALUE_TEXT || type == SKINSLIDE_VALUE_ASSET) {
        take(s, r->text, MOST_TEXT - 1);
        if (input->tokens && take_below(s, 2))
            strncpy(r->text, any_token(s, input->tokens), MOST_TEXT - 1);
        r->value.data = r->text, r->value.count = 1;
    } else {
        r->value.data = r->data = take_numbers(s, type, r->value.count * width);
    }
    if (take_below(s, 5) == 1) {
        type = (skinslide_value_type)(SKINSLIDE_VALUE_BOOL + take_below(s, 9));
        r->indices = array_of("indices", type, 1, take_below(s, MOST_NUMBERS), NULL);
        r->indices.data = r->index_data = take_numbers(s, type, r->indices.count);
        r->value.indices = &r->indices;
    }
}

static void expect_said(skinslide_status status, const skinslide_error *error) {
    require(!status || (error->status == status && error->message[0] && !strchr(error->message, '\n')));
}

typedef skinslide_status (*taker)(void *handle, const skinslide_stage_input *input, const skinslide_value *value,
                                  skinslide_error *error);

static skinslide_status take_mesh(void *handle, const skinslide_stage_input *input, const skinslide_value *value,
                                  skinslide_error *error) {
    return skinslide_stage_mesh_take(handle, input, value, error);
}

static skinslide_status take_patch(void *handle, const skinslide_stage_input *input, const skinslide_value *value,
                                   skinslide_error *error) {
    return skinslide_stage_patch_take(handle, input, value, error);
}

static skinslide_status take_controls(void *handle, const skinslide_stage_input *input, const skinslide_value *value,
                                      skinslide_error *error) {
    return skinslide_stage_controls_take(handle, input, value, error);
}

/* A byte for each input says whether it has nothing, what is sound or whatever comes. */
static void take_all(stream *s, skinslide_stage_group group, taker take_one, void *handle) {
    enum { NOTHING, SOUND };
    for (const skinslide_stage_input *input = NULL; (input = skinslide_stage_next_input(group, input)) != NULL;) {
        record r = {.value = SKINSLIDE_VALUE_DEFAULT};
        skinslide_error error;
        int32_t kind = take_below(s, 3);
        r.value.name = input->name;
        if (!sound_value(input, &r.value) || kind > SOUND)
            if (kind != NOTHING)
                take_record(&r, s, input);
        expect_said(take_one(handle, input, &r.value, &error), &error);
        free(r.data), free(r.index_data);
    }
}

static void use_patch(stream *s, const skinslide_stage_mesh *mesh) {
    skinslide_stage_patch *patch = NULL;
    skinslide_stage_controls *controls = NULL;
    skinslide_patch_setup setup;
    skinslide_error error;
    if (skinslide_stage_patch_create(mesh, "elbow", NULL, &patch, &error))
        return;
    take_all(s, SKINSLIDE_STAGE_PATCH, take_patch, patch);
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    subset.path = "/mesh/elbow", subset.is_subset = 1;
    expect_said(skinslide_stage_patch_take_subset(patch, take_below(s, 2) ? &subset : NULL, &error), &error);
    take_all(s, SKINSLIDE_STAGE_SUBSET, take_patch, patch);
    require(!skinslide_stage_controls_create(patch, NULL, &controls, &error));
    take_all(s, SKINSLIDE_STAGE_CONTROLS, take_controls, controls);
    skinslide_status status = skinslide_stage_patch_get(patch, controls, &setup, &error);
    expect_said(status, &error);
    skinslide_mesh whole = SKINSLIDE_MESH_DEFAULT;
    skinslide_slider *slider = NULL;
    if (!status && !skinslide_stage_mesh_get(mesh, &whole, &error))
        expect_said(skinslide_slider_create(&whole, &setup, 1, &slider, &error), &error);
    skinslide_slider_destroy(slider);
    skinslide_stage_controls_destroy(controls);
    skinslide_stage_patch_destroy(patch);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    stream s = {data, size};
    skinslide_stage_mesh *mesh = NULL;
    skinslide_error error;
    require(!skinslide_stage_mesh_create(&mesh, &error));
    take_all(&s, SKINSLIDE_STAGE_MESH, take_mesh, mesh);
    take_all(&s, SKINSLIDE_STAGE_SUBDIVISION, take_mesh, mesh);
    use_patch(&s, mesh);
    skinslide_stage_mesh_destroy(mesh);
    return 0;
}
