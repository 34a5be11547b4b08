/* One-line makers of records as readers hand them over, and of a scene's mesh, patch and controls. */
#ifndef SKINSLIDE_TEST_RECORDS_H
#define SKINSLIDE_TEST_RECORDS_H

#include "skinslide/stage.h"
#include "support.h"

/* An array of `count` elements of `width` numbers. data must outlive the record. */
skinslide_value array_of(const char *name, skinslide_value_type type, int32_t width, int64_t count, const void *data);
#define INTS(name, ...) array_of(name, SKINSLIDE_VALUE_INT32, 1, sizeof((int32_t[]){__VA_ARGS__}) / 4, (int32_t[]){__VA_ARGS__})

#define FLOATS(name, ...) array_of(name, SKINSLIDE_VALUE_FLOAT, 1, sizeof((float[]){__VA_ARGS__}) / 4, (float[]){__VA_ARGS__})
/* One value. */
skinslide_value text_of(const char *name, const char *text);
skinslide_value asset_of(const char *name, const char *path);
#define NUMBER(name, number) single_of(name, SKINSLIDE_VALUE_FLOAT, &(float){number})
skinslide_value single_of(const char *name, skinslide_value_type type, const void *data);
skinslide_value nothing_of(const char *name);
skinslide_value blocked_of(const char *name);
/* A value of a type that nothing here takes. */
skinslide_value other_of(const char *name, const char *type_name);
/* The value with an interpolation, or with indices. */
skinslide_value painted_as(skinslide_value value, const char *interpolation);
skinslide_value indexed_by(skinslide_value value, const skinslide_value *indices);

/* The input of a group by its name and, unless that is NULL, its prefix. */
const skinslide_stage_input *input_of(skinslide_stage_group group, const char *prefix, const char *name);

/* Take a value by the name of its input. */
skinslide_status mesh_takes(skinslide_stage_mesh *mesh, const char *name, skinslide_value value, skinslide_error *error);
skinslide_status patch_takes(skinslide_stage_patch *patch, const char *name, skinslide_value value, skinslide_error *error);
skinslide_status controls_take(skinslide_stage_controls *controls, const char *name, skinslide_value value,
                               skinslide_error *error);

/* A mesh of a scene, with its points as rest points. */
skinslide_stage_mesh *scene_mesh(const test_mesh *mesh);
/* A patch "elbow" of it, of the faces chosen [face_count], or all for NULL; and controls with nothing authored. */
skinslide_stage_patch *scene_patch(const skinslide_stage_mesh *mesh, const test_mesh *of, const uint8_t *chosen);
skinslide_stage_controls *scene_controls(const skinslide_stage_patch *patch);

/* A grid with a patch and its controls. */
typedef struct patch_scene {
    test_mesh grid;
    skinslide_stage_mesh *mesh;
    skinslide_stage_patch *patch;
    skinslide_stage_controls *controls;
} patch_scene;

void end_scene(patch_scene *scene);

#endif
