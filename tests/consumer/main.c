/* Slides one frame of a sheet of four quads: its middle vertex, pulled aside, goes most of the way back. And makes ready to
 * draw it, which needs no device yet. And asks what there is to read of a scene. */
#include <skinslide/picture.h>
#include <skinslide/stage.h>
#include <stdio.h>

static const int32_t counts[] = {4, 4, 4, 4};
static const int32_t indices[] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7};
static const int32_t faces[] = {0, 1, 2, 3};
static const float rest[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 0, 2, 0, 1, 2, 0, 2, 2, 0};

static int fail(const skinslide_error *error) {
    fprintf(stderr, "%s: %s\n", skinslide_status_name(error->status), error->message);
    return 1;
}

/* Of a patch, the first primvar is its faces. */
static int faces_are_asked_for(void) {
    const skinslide_stage_input *input = skinslide_stage_next_input(SKINSLIDE_STAGE_PATCH, NULL);
    skinslide_value none = SKINSLIDE_VALUE_DEFAULT;
    while (input && !input->is_primvar)
        input = skinslide_stage_next_input(SKINSLIDE_STAGE_PATCH, input);
    return input && skinslide_value_length(&none) == 0;
}

int main(void) {
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    skinslide_patch_setup patch = SKINSLIDE_PATCH_SETUP_DEFAULT;
    skinslide_slider *slider;
    skinslide_workspace *workspace;
    skinslide_tessellation *tessellation;
    skinslide_tessellation_info info = SKINSLIDE_TESSELLATION_INFO_DEFAULT;
    skinslide_canvas_options options = SKINSLIDE_CANVAS_OPTIONS_DEFAULT;
    skinslide_error error;
    float points[27], slid[27];
    int i;

    mesh.vertex_count = 9, mesh.face_count = 4, mesh.index_count = 16;
    mesh.face_counts = counts, mesh.face_indices = indices, mesh.rest_points = rest;
    patch.name = "sheet";
    patch.faces = faces;
    patch.face_count = 4;
    for (i = 0; i < 27; ++i)
        points[i] = rest[i];
    points[12] = 1.5f;
    if (skinslide_slider_create(&mesh, &patch, 1, &slider, &error) != SKINSLIDE_OK)
        return fail(&error);
    if (skinslide_workspace_create(slider, NULL, &workspace, &error) != SKINSLIDE_OK)
        return fail(&error);
    if (skinslide_slide(workspace, points, NULL, slid, NULL, &error) != SKINSLIDE_OK)
        return fail(&error);
    if (skinslide_tessellation_create(&mesh, NULL, faces, 4, &tessellation, &error) != SKINSLIDE_OK ||
        skinslide_tessellation_describe(tessellation, &info, &error) != SKINSLIDE_OK)
        return fail(&error);
    skinslide_tessellation_destroy(tessellation);
    if (info.triangle_count != 8 || options.width != 1920)
        return 1;
    if (!faces_are_asked_for())
        return 1;
    printf("%s %g\n", skinslide_version(), slid[12]);
    skinslide_workspace_destroy(workspace);
    skinslide_slider_destroy(slider);
    return 0;
}
