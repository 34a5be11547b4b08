/* Calls what takes a struct that may grow, and says what came of it. test_abi.py compiles it with headers of other versions: of
 * an older one, where WITHOUT_struct lacks its last member, and of a NEWER one, where structs have a member more. */
#include <skinslide/picture.h>
#include <skinslide/stage.h>
#include <stdio.h>

#ifdef NEWER
#define UNKNOWN(answer) printf("%s: %g\n", #answer, (double)(answer).later)
#else
#define UNKNOWN(answer) (void)(answer)
#endif

enum { VERTICES = 9, FACES = 4, CORNERS = 16 };
static const int32_t counts[FACES] = {4, 4, 4, 4};
static const int32_t indices[CORNERS] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7};
static const int32_t faces[FACES] = {0, 1, 2, 3};
static const float rest[3 * VERTICES] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 0, 2, 0, 1, 2, 0, 2, 2, 0};
static float points[3 * VERTICES], slid[3 * VERTICES], st[2 * CORNERS];
static skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
static skinslide_error error;

static int said(const char *what, skinslide_status status) {
    if (status)
        printf("%s: %s: %s\n", what, skinslide_status_name(status), error.message);
    return status == SKINSLIDE_OK;
}

static void fill(void) {
    mesh.vertex_count = VERTICES, mesh.face_count = FACES, mesh.index_count = CORNERS;
    mesh.face_counts = counts, mesh.face_indices = indices, mesh.rest_points = rest;
    for (int i = 0; i < 3 * VERTICES; i++)
        slid[i] = points[i] = rest[i] + (i == 12 ? 0.5f : 0);
    for (int c = 0; c < CORNERS; c++)
        st[2 * c] = rest[3 * indices[c]] / 2, st[2 * c + 1] = rest[3 * indices[c] + 1] / 2;
}

/* ---- Sliding ---- */

static void slide(skinslide_workspace *workspace) {
    /* Two patches, so that arrays have a stride. */
    skinslide_patch_result results[2] = {SKINSLIDE_PATCH_RESULT_DEFAULT, SKINSLIDE_PATCH_RESULT_DEFAULT};
    skinslide_controls frame[2] = {SKINSLIDE_CONTROLS_DEFAULT, SKINSLIDE_CONTROLS_DEFAULT};
    frame[1].envelope = 0.5f;
    if (said("slide", skinslide_slide(workspace, points, frame, slid, results, &error)))
        printf("slid %g, %d and %d vertices, stretch %g and %g\n", slid[12], results[0].slid_vertices, results[1].slid_vertices,
               results[0].stretch_after, results[1].stretch_after);
    UNKNOWN(results[0]), UNKNOWN(results[1]);
}

static void measure(const skinslide_slider *slider) {
    float after[VERTICES] = {0};
    skinslide_neighbours met = SKINSLIDE_NEIGHBOURS_DEFAULT;
    skinslide_diagnostics diagnostics = SKINSLIDE_DIAGNOSTICS_DEFAULT;
    skinslide_patch_info info = SKINSLIDE_PATCH_INFO_DEFAULT;
    diagnostics.stretch_after = after;
    if (said("diagnose", skinslide_diagnose(slider, NULL, NULL, points, slid, &diagnostics, &error)))
        printf("stretch at the middle %g\n", after[4]);
    if (said("patch info", skinslide_slider_patch_info(slider, 1, &info, &error)))
        printf("%s: %d faces, %d free\n", info.name, info.face_count, info.free_count);
    if (said("neighbours", skinslide_slider_neighbours(slider, 1, points, points, VERTICES, 0, &met, &error)))
        printf("neighbours %d and %d\n", met.held, met.loose);
    UNKNOWN(info), UNKNOWN(met);
}

static void measure_motion(const skinslide_slider *slider) {
    skinslide_sample samples[3] = {SKINSLIDE_SAMPLE_DEFAULT, SKINSLIDE_SAMPLE_DEFAULT, SKINSLIDE_SAMPLE_DEFAULT};
    skinslide_roughness roughness[2] = {SKINSLIDE_ROUGHNESS_DEFAULT, SKINSLIDE_ROUGHNESS_DEFAULT};
    for (int i = 0; i < 3; i++)
        samples[i].seconds = i, samples[i].cached = i == 1 ? points : rest, samples[i].slid = i == 1 ? slid : rest;
    if (said("roughness", skinslide_measure_roughness(slider, samples, roughness, &error)))
        printf("roughness %g and %g\n", roughness[0].before, roughness[1].after);
    UNKNOWN(roughness[0]), UNKNOWN(roughness[1]);
}

static void look_up(const skinslide_workspace *workspace) {
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_device_info device = SKINSLIDE_DEVICE_INFO_DEFAULT;
    if (said("lookup", skinslide_workspace_lookup(workspace, &info, &device, &error)))
        printf("lookup %d, device %d\n", (int)info.lookup, device.device);
    UNKNOWN(info), UNKNOWN(device);
}

static void slide_all(void) {
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    skinslide_patch_setup setups[2] = {SKINSLIDE_PATCH_SETUP_DEFAULT, SKINSLIDE_PATCH_SETUP_DEFAULT};
    skinslide_workspace_options options = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    skinslide_slider *slider;
    skinslide_workspace *workspace;
    options.lookup = SKINSLIDE_LOOKUP_EXACT;
    for (int i = 0; i < 2; i++)
        setups[i].name = i ? "second" : "first", setups[i].faces = faces, setups[i].face_count = FACES;
    setups[1].rule = SKINSLIDE_RULE_FAST;
#ifndef WITHOUT_skinslide_patch_setup
    setups[0].controls = &controls;
#endif
    (void)controls;
    if (!said("slider", skinslide_slider_create(&mesh, setups, 2, &slider, &error)))
        return;
    if (said("workspace", skinslide_workspace_create(slider, &options, &workspace, &error))) {
        slide(workspace);
        measure(slider);
        measure_motion(slider);
        look_up(workspace);
        skinslide_workspace_destroy(workspace);
    }
    skinslide_slider_destroy(slider);
}

static void take_rates(void) {
    skinslide_sample samples[2] = {SKINSLIDE_SAMPLE_DEFAULT, SKINSLIDE_SAMPLE_DEFAULT};
    float rates[3 * VERTICES] = {0};
    for (int i = 0; i < 2; i++)
        samples[i].seconds = i, samples[i].cached = rest, samples[i].slid = i ? points : rest;
    if (said("velocities", skinslide_velocities(VERTICES, samples, rates, &error)))
        printf("rate %g\n", rates[12]);
}

/* ---- Painting ---- */

static void sample_texture(void) {
    skinslide_texture_layout layout = SKINSLIDE_TEXTURE_LAYOUT_DEFAULT;
    skinslide_texture_tile tile = SKINSLIDE_TEXTURE_TILE_DEFAULT;
    skinslide_image image = SKINSLIDE_IMAGE_DEFAULT;
    const float pixels[4] = {1, 2, 3, 4};
    float values[VERTICES], texels[16];
    image.width = image.height = 2, image.pixels = pixels;
    tile.image = &image;
    layout.mesh = &mesh, layout.faces = faces, layout.face_count = FACES, layout.st = st;
    if (said("texture", skinslide_texture_sample(&layout, &tile, 1, values, &error)) &&
        said("map", skinslide_map_draw(&layout, 1001, values, 4, texels, NULL, &error)))
        printf("texture %g and %g, map %g\n", values[0], values[4], texels[5]);
}

static void write_image(void) {
    skinslide_channel channels[2] = {SKINSLIDE_CHANNEL_DEFAULT, SKINSLIDE_CHANNEL_DEFAULT};
    const float pixels[2] = {5, 7};
    skinslide_bytes *bytes;
    skinslide_image *image;
    for (int i = 0; i < 2; i++)
        channels[i].name = i ? "B" : "A", channels[i].pixels = &pixels[i];
    if (!said("exr", skinslide_exr_encode(channels, 2, 1, 1, SKINSLIDE_WRAP_CLAMP, &bytes, &error)))
        return;
    if (said("image", skinslide_exr_decode(bytes->data, bytes->size, "B", &image, &error))) {
        printf("pixel %g\n", image->pixels[0]);
        skinslide_image_destroy(image);
    }
    skinslide_bytes_destroy(bytes);
}

static void find_edges(void) {
    skinslide_curves curves = SKINSLIDE_CURVES_DEFAULT;
    const int32_t count[1] = {2}, edges[4] = {0, 1, 4, 5};
    const float line[6] = {0, 0, 0, 1, 0, 0};
    double distances[2] = {9, 9};
    curves.curve_count = 1, curves.vertex_counts = count, curves.point_count = 2, curves.points = line;
    if (said("curves", skinslide_edge_distances(rest, VERTICES, edges, 2, &curves, SKINSLIDE_DIRECTION_ANY, distances, &error)))
        printf("distances %g and %g\n", distances[0], distances[1]);
}

static void mirror_faces(void) {
    skinslide_mirror_options options = SKINSLIDE_MIRROR_OPTIONS_DEFAULT;
    int32_t across[FACES], vertices[VERTICES];
    options.plane = 1;
    if (said("mirror", skinslide_mirror(&mesh, &options, faces, FACES, across, vertices, &error)))
        printf("across %d is %d\n", across[0], vertices[0]);
}

/* ---- Pictures ---- */

static void draw(skinslide_tessellation *tessellation, const skinslide_camera *camera) {
    skinslide_canvas_options options = SKINSLIDE_CANVAS_OPTIONS_DEFAULT;
    skinslide_figure figure = SKINSLIDE_FIGURE_DEFAULT;
    const skinslide_viewport all = {0, 0, 8, 8};
    skinslide_device_info device = SKINSLIDE_DEVICE_INFO_DEFAULT;
    const float black[3] = {0, 0, 0};
    skinslide_canvas *canvas;
    uint8_t pixels[8 * 8 * 4];
    options.width = options.height = 8;
    skinslide_colour_tile tile = SKINSLIDE_COLOUR_TILE_DEFAULT;
    const uint8_t texel[4] = {255, 255, 255, 255};
    tile.pixels = texel, tile.width = tile.height = 1;
    figure.tessellation = tessellation, figure.points = rest, figure.double_sided = 1;
    figure.tiles = &tile, figure.tile_count = 1;
#if !defined WITHOUT_skinslide_canvas_options && !defined WITHOUT_skinslide_figure
    skinslide_look other = SKINSLIDE_LOOK_DEFAULT;
    options.targets = 2, figure.others = &other, figure.other_count = 1;
#endif
    if (!said("canvas", skinslide_canvas_create(&options, &canvas, &error)))
        return;
    if (said("device", skinslide_canvas_device(canvas, &device, &error)) &&
        said("clear", skinslide_canvas_clear(canvas, black, &error)) &&
        said("figure", skinslide_canvas_draw(canvas, &all, camera, &figure, &error)) &&
        said("target", skinslide_canvas_read_target(canvas, 0, pixels, &error)) &&
        said("read", skinslide_canvas_read(canvas, pixels, &error)))
        printf("drawn %d, largest %d\n", pixels[4 * (8 * 4 + 4)] > 0, device.largest_resolution > 0);
    UNKNOWN(device);
    skinslide_canvas_destroy(canvas);
}

static void strain(void) {
    skinslide_strain own = SKINSLIDE_STRAIN_DEFAULT;
    float largest[VERTICES];
    own.largest = largest;
    if (said("strain", skinslide_measure_strain(&mesh, NULL, faces, FACES, points, &own, &error)))
        printf("stretched by %g\n", largest[4]);
}

static void picture(void) {
    skinslide_subject subject = SKINSLIDE_SUBJECT_DEFAULT;
    skinslide_tessellation_info info = SKINSLIDE_TESSELLATION_INFO_DEFAULT;
    const float *poses[1] = {rest};
    const double up[3] = {0, 1, 0};
    skinslide_camera camera;
    skinslide_tessellation *tessellation;
    subject.mesh = &mesh, subject.faces = faces, subject.face_count = FACES, subject.poses = poses, subject.pose_count = 1;
    if (!said("subject", skinslide_frame_faces(&subject, up, 1, &camera, &error)) ||
        !said("tessellation", skinslide_tessellation_create(&mesh, st, faces, FACES, &tessellation, &error)))
        return;
    if (said("tessellation info", skinslide_tessellation_describe(tessellation, &info, &error)))
        printf("%d triangles\n", info.triangle_count);
    UNKNOWN(info);
    draw(tessellation, &camera);
    skinslide_tessellation_destroy(tessellation);
}

/* ---- Meaning ---- */

static void find_patches(void) {
    skinslide_stage_prim prim = SKINSLIDE_STAGE_PRIM_DEFAULT;
    const char *const schemas[1] = {"SkinSlideAPI:elbow"};
    skinslide_stage_finding *finding;
    prim.type_name = "Mesh", prim.is_mesh = prim.is_defined = 1, prim.schemas = schemas, prim.schema_count = 1;
    if (!said("prim", skinslide_stage_find(&prim, &finding, &error)))
        return;
    printf("patch %s\n", finding->patches[0]);
    skinslide_stage_finding_destroy(finding);
}

static void take_values(void) {
    skinslide_value value = SKINSLIDE_VALUE_DEFAULT;
    skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;
    const float number = 0.25f;
    const skinslide_stage_input *envelope = skinslide_stage_next_input(SKINSLIDE_STAGE_LIVE, NULL);
    value.name = "a number", value.type = SKINSLIDE_VALUE_FLOAT, value.count = 1, value.data = &number;
    if (said("live", skinslide_stage_live_take(&live, envelope, &value, &error)))
        printf("%s %g\n", envelope->name, live.envelope);
}

static void weld(void) {
    skinslide_weld_info info = SKINSLIDE_WELD_INFO_DEFAULT;
    skinslide_weld *weld;
    int32_t one[VERTICES];
    if (!said("weld", skinslide_weld_create(&mesh, NULL, 0, 0, &weld, &error)))
        return;
    if (said("weld", skinslide_weld_get(weld, one, &info, &error)))
        printf("welded %d\n", info.welded_points);
    UNKNOWN(info);
    skinslide_weld_destroy(weld);
}

static void choose_skin(void) {
    skinslide_mask_options options = SKINSLIDE_MASK_OPTIONS_DEFAULT;
    float stretch[CORNERS] = {0};
    uint8_t chosen[FACES];
    if (said("stretch", skinslide_note_stretch(&mesh, points, stretch, &error)) &&
        said("mask", skinslide_mask_stretched(&mesh, stretch, &options, chosen, &error)))
        printf("face 0 is chosen: %d\n", chosen[0]);
}

static void refine(void) {
    skinslide_subdivision subdivision = SKINSLIDE_SUBDIVISION_DEFAULT;
    skinslide_mesh smooth = mesh;
    const skinslide_limit_place middle = {2, 0, 0};
    float out[3];
    uint8_t has[FACES];
    subdivision.scheme = SKINSLIDE_SCHEME_CATMULL_CLARK;
    smooth.subdivision = &subdivision;
    if (said("limit", skinslide_limit_points(&smooth, points, &middle, 1, out, &error)))
        printf("limit %g\n", out[0]);
    if (said("limit faces", skinslide_limit_faces(&smooth, has, &error)))
        printf("face 0 has a surface: %d\n", has[0]);
}

int main(void) {
    fill();
    slide_all();
    take_rates();
    sample_texture();
    write_image();
    find_edges();
    mirror_faces();
    picture();
    strain();
    find_patches();
    take_values();
    refine();
    weld();
    choose_skin();
    return 0;
}
