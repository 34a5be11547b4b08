/* See records.h. */
#include "records.h"

#include <stdlib.h>
#include <string.h>

skinslide_value array_of(const char *name, skinslide_value_type type, int32_t width, int64_t count, const void *data) {
    skinslide_value value = SKINSLIDE_VALUE_DEFAULT;
    value.name = name, value.type = type, value.is_array = 1, value.width = width, value.count = count, value.data = data;
    return value;
}

skinslide_value single_of(const char *name, skinslide_value_type type, const void *data) {
    skinslide_value value = array_of(name, type, 1, 1, data);
    value.is_array = 0;
    return value;
}

skinslide_value text_of(const char *name, const char *text) {
    return single_of(name, SKINSLIDE_VALUE_TEXT, text);
}

skinslide_value asset_of(const char *name, const char *path) {
    return single_of(name, SKINSLIDE_VALUE_ASSET, path);
}

skinslide_value nothing_of(const char *name) {
    skinslide_value value = SKINSLIDE_VALUE_DEFAULT;
    value.name = name;
    return value;
}

skinslide_value blocked_of(const char *name) {
    skinslide_value value = nothing_of(name);
    value.type = SKINSLIDE_VALUE_BLOCKED;
    return value;
}

skinslide_value other_of(const char *name, const char *type_name) {
    skinslide_value value = array_of(name, SKINSLIDE_VALUE_OTHER, 1, 1, NULL);
    value.type_name = type_name;
    return value;
}

skinslide_value painted_as(skinslide_value value, const char *interpolation) {
    value.interpolation = interpolation;
    return value;
}

skinslide_value indexed_by(skinslide_value value, const skinslide_value *indices) {
    value.indices = indices;
    return value;
}

const skinslide_stage_input *input_of(skinslide_stage_group group, const char *prefix, const char *name) {
    const skinslide_stage_input *input = skinslide_stage_next_input(group, NULL);
    while (input && (strcmp(input->name, name) != 0 || (prefix && strcmp(input->prefix, prefix) != 0)))
        input = skinslide_stage_next_input(group, input);
    assert_non_null(input);
    return input;
}

skinslide_status mesh_takes(skinslide_stage_mesh *mesh, const char *name, skinslide_value value, skinslide_error *error) {
    return skinslide_stage_mesh_take(mesh, input_of(SKINSLIDE_STAGE_MESH, NULL, name), &value, error);
}

skinslide_status patch_takes(skinslide_stage_patch *patch, const char *name, skinslide_value value, skinslide_error *error) {
    return skinslide_stage_patch_take(patch, input_of(SKINSLIDE_STAGE_PATCH, NULL, name), &value, error);
}

skinslide_status controls_take(skinslide_stage_controls *controls, const char *name, skinslide_value value,
                               skinslide_error *error) {
    return skinslide_stage_controls_take(controls, input_of(SKINSLIDE_STAGE_CONTROLS, NULL, name), &value, error);
}

skinslide_stage_mesh *scene_mesh(const test_mesh *mesh) {
    skinslide_stage_mesh *made = NULL;
    skinslide_error error;
    skinslide_value points = array_of("points", SKINSLIDE_VALUE_FLOAT, 3, mesh->vertex_count, mesh->points);
    assert_ok(skinslide_stage_mesh_create(&made, &error), &error);
    assert_ok(mesh_takes(made, "points", points, &error), &error);
    assert_ok(mesh_takes(made, "faceVertexCounts",
                         array_of("faceVertexCounts", SKINSLIDE_VALUE_INT32, 1, mesh->face_count, mesh->face_counts), &error),
              &error);
    assert_ok(mesh_takes(made, "faceVertexIndices",
                         array_of("faceVertexIndices", SKINSLIDE_VALUE_INT32, 1, mesh->index_count, mesh->face_indices),
                         &error),
              &error);
    points.name = "skinSlide:restPoints";
    assert_ok(mesh_takes(made, "restPoints", points, &error), &error);
    return made;
}

skinslide_stage_patch *scene_patch(const skinslide_stage_mesh *mesh, const test_mesh *of, const uint8_t *chosen) {
    skinslide_stage_patch *patch = NULL;
    skinslide_error error;
    uint8_t *all = malloc((size_t)of->face_count);
    memset(all, 1, (size_t)of->face_count);
    skinslide_value faces =
        array_of("primvars:skinSlide:elbow:patch", SKINSLIDE_VALUE_BOOL, 1, of->face_count, chosen ? chosen : all);
    assert_ok(skinslide_stage_patch_create(mesh, "elbow", NULL, &patch, &error), &error);
    assert_ok(patch_takes(patch, "patch", painted_as(faces, "uniform"), &error), &error);
    free(all);
    return patch;
}

skinslide_stage_controls *scene_controls(const skinslide_stage_patch *patch) {
    skinslide_stage_controls *controls = NULL;
    skinslide_error error;
    assert_ok(skinslide_stage_controls_create(patch, NULL, &controls, &error), &error);
    return controls;
}

void end_scene(patch_scene *scene) {
    skinslide_stage_controls_destroy(scene->controls);
    skinslide_stage_patch_destroy(scene->patch);
    skinslide_stage_mesh_destroy(scene->mesh);
    free_mesh(&scene->grid);
}
