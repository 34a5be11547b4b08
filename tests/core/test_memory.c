/* Each allocation fails in turn: OUT_OF_MEMORY, nothing written, nothing lost. The linker sends the core's calloc and free here
 * (--wrap); the solver's ordering takes its functions from SuiteSparse_config. */
#include "records.h"
#include "skinslide/paint.h"
#include "skinslide/picture.h"
#include "support.h"

#include <SuiteSparse_config.h>
#include <stdlib.h>
#include <string.h>

void *__real_calloc(size_t count, size_t size);
void __real_free(void *memory);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *memory);

static bool watching;
static int32_t left_to_give; /* allocations before one fails; below 0: none does */
static int32_t live;
static size_t largest; /* that the core asked for */

static bool refuse(void) {
    return watching && left_to_give >= 0 && left_to_give-- == 0;
}

static void *give(size_t count, size_t size) {
    void *memory = refuse() ? NULL : __real_calloc(count, size);
    live += watching && memory;
    return memory;
}

void *__wrap_calloc(size_t count, size_t size) {
    largest = watching && count * size > largest ? count * size : largest;
    return give(count, size);
}

void __wrap_free(void *memory) {
    live -= watching && memory;
    __real_free(memory);
}

static void *solver_malloc(size_t size) {
    return give(1, size);
}

/* ---- Memory of the core itself ---- */

static void counts_that_are_too_large_fail(void **state) {
    (void)state;
    ss_memory memory = {0};
    assert_non_null(ss_new(&memory, 0, 8));
    assert_false(memory.failed);
    assert_null(ss_new(&memory, INT64_MAX, 8));
    assert_true(memory.failed);
    assert_null(ss_new(&memory, 1, 8)); /* once failed, always failed */
    ss_free(&memory);
    memory = (ss_memory){0};
    assert_null(ss_new(&memory, -1, 8));
    assert_true(memory.failed);
    ss_free(&memory);
    ss_free(&memory);
}

static void memory_is_zero_and_aligned(void **state) {
    (void)state;
    ss_memory memory = {0};
    for (int32_t count = 1; count < 100; count++) {
        char *bytes = SS_NEW(&memory, char, count);
        assert_int_equal((uintptr_t)bytes % _Alignof(max_align_t), 0);
        for (int32_t i = 0; i < count; i++)
            assert_int_equal(bytes[i], 0);
        memset(bytes, 1, (size_t)count);
    }
    ss_free(&memory);
}

/* ---- Every call, with every allocation failing ---- */

enum { SETUPS = 3 };

typedef struct scene {
    test_mesh mesh;
    int32_t *faces;
    skinslide_patch_setup setups[SETUPS];
    skinslide_controls controls[SETUPS];
    painted paint;
    float *points, *slid, *slide, *turns, *normals, *limits;
    int32_t *one;
} scene;

/* Three set-ups, one of them relaxed and one even, of two grids and holes; painted and limited by the frame, with edges. */
static void make_scene(scene *s) {
    static const int32_t edges[2] = {0, 1};
    static const float factors[1] = {2};
    test_mesh sheet = quad_grid(5, 5), holed = grid_with_holes(false);
    s->mesh = join_meshes(&sheet, &holed);
    s->faces = all_faces(&s->mesh);
    s->setups[0] = setup_of(s->faces, s->mesh.face_count), s->setups[1] = setup_of(s->faces, 20);
    s->setups[2] = s->setups[1];
    s->setups[1].rule = SKINSLIDE_RULE_RELAXED, s->setups[2].rule = SKINSLIDE_RULE_EVEN;
    s->paint = paint_at_random(&s->mesh, 1);
    s->limits = malloc((size_t)s->mesh.vertex_count * sizeof(float));
    for (int32_t v = 0; v < s->mesh.vertex_count; v++)
        s->limits[v] = 0.01f;
    s->paint.controls.max_distance = s->limits;
    s->controls[0] = s->controls[1] = s->controls[2] = s->paint.controls;
    s->controls[0].edges = edges, s->controls[0].edge_density = factors, s->controls[0].edge_count = 1;
    s->points = random_pose(&s->mesh, 1);
    s->slid = malloc(POINT_BYTES(&s->mesh)), s->slide = malloc(POINT_BYTES(&s->mesh));
    s->turns = malloc(POINT_BYTES(&s->mesh));
    s->normals = calloc((size_t)s->mesh.index_count, sizeof(float[3]));
    s->one = calloc((size_t)s->mesh.vertex_count, sizeof *s->one);
    memcpy(s->slid, s->points, POINT_BYTES(&s->mesh));
    free_mesh(&sheet), free_mesh(&holed);
}

static void free_scene(scene *s) {
    free(s->faces), free(s->points), free(s->slid), free(s->slide), free(s->turns), free(s->normals), free(s->limits);
    free(s->one);
    free_painted(&s->paint);
    free_mesh(&s->mesh);
}

/* Subdivided, so that its patches have limit surfaces and their factor. */
static skinslide_mesh view_of_scene(const scene *s) {
    static const skinslide_subdivision catmull_clark = {.size = sizeof(skinslide_subdivision),
                                                        .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    skinslide_mesh view = view_of(&s->mesh);
    view.subdivision = &catmull_clark;
    return view;
}

/* Runs until no allocation fails, of which there are so many at least. */
static void fail_in_turn(skinslide_status (*run)(void *subject, skinslide_error *error), void *subject, int32_t least) {
    skinslide_status status = SKINSLIDE_OUT_OF_MEMORY;
    int32_t n = 0;
    for (; status != SKINSLIDE_OK && n < 10000; n++) {
        skinslide_error error;
        left_to_give = n, live = 0, watching = true;
        status = run(subject, &error);
        watching = false;
        assert_int_equal(live, 0);
        if (status != SKINSLIDE_OK)
            assert_fails(status, &error, SKINSLIDE_OUT_OF_MEMORY, "out of memory");
    }
    assert_in_range(n, least, 9999);
}

static skinslide_status run_weld(void *subject, skinslide_error *error) {
    scene *s = subject;
    skinslide_mesh view = view_of(&s->mesh);
    skinslide_weld *weld = NULL;
    skinslide_slider *slider = NULL;
    int32_t *one = s->one;
    skinslide_status status = skinslide_weld_create(&view, s->setups, SETUPS, 0, &weld, error);
    if (!status)
        status = skinslide_weld_show(weld, 1, s->points, error);
    if (!status)
        status = skinslide_weld_get(weld, one, NULL, error);
    view.weld = one;
    if (!status)
        status = skinslide_slider_create(&view, s->setups, SETUPS, &slider, error);
    skinslide_weld_destroy(weld);
    skinslide_slider_destroy(slider);
    return status;
}

static skinslide_status run_all(void *subject, skinslide_error *error) {
    scene *s = subject;
    const skinslide_workspace_options options = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EGL,
                                                 SKINSLIDE_ANY_DEVICE, 64};
    skinslide_slider *slider = NULL;
    skinslide_workspace *workspace = NULL;
    const skinslide_limit_place place = {5, 0.5f, 0.5f};
    float point[3];
    uint8_t has_surface[128];
    const skinslide_diagnostics diagnostics = {.size = sizeof(skinslide_diagnostics), .slide = s->slide};
    static const double space[9] = {2, 0, 0, 0, 1, 0, 0, 0, 1};
    skinslide_mesh view = view_of_scene(s);
    view.space = space;
    assert_true(view.face_count <= (int32_t)sizeof has_surface);
    skinslide_status status = skinslide_slider_create(&view, s->setups, SETUPS, &slider, error);
    if (!status)
        status = skinslide_workspace_create(slider, &options, &workspace, error);
    if (!status)
        status = skinslide_slide(workspace, s->points, s->controls, s->slid, NULL, error);
    if (!status)
        status = skinslide_diagnose(slider, s->controls, NULL, s->points, s->slid, &diagnostics, error);
    if (!status)
        status = skinslide_workspace_turns(workspace, s->points, s->turns, error);
    if (!status)
        status = skinslide_carry(&view, s->turns, SKINSLIDE_NORMALS_FACE_VARYING, s->normals, error);
    if (!status)
        status = skinslide_limit_points(&view, s->points, &place, 1, point, error);
    if (!status)
        status = skinslide_limit_faces(&view, has_surface, error);
    skinslide_workspace_destroy(workspace);
    skinslide_slider_destroy(slider);
    return status;
}

static void each_allocation_fails_in_turn(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    fail_in_turn(run_all, &s, 100);
    fail_in_turn(run_weld, &s, 20);
    assert_true(memcmp(s.slid, s.points, POINT_BYTES(&s.mesh)) != 0);
    free_scene(&s);
}

static skinslide_status run_build(const scene *s, skinslide_error *error) {
    skinslide_mesh view = view_of_scene(s);
    skinslide_build *build = NULL;
    skinslide_slider *slider = NULL;
    skinslide_status status = skinslide_build_create(&view, s->setups, SETUPS, &build, error);
    for (int32_t i = SETUPS - 1; i > 0; i--)
        skinslide_build_setup(build, i);
    if (!status)
        status = skinslide_build_finish(build, &slider, error);
    skinslide_build_destroy(build);
    skinslide_slider_destroy(slider);
    return status;
}

/* A set-up that failed for want of memory is built at the end, if there is memory again. */
static void each_allocation_of_a_build_fails_in_turn(void **state) {
    (void)state;
    scene s;
    skinslide_error error;
    int32_t failed = 0, n = -1;
    make_scene(&s);
    do {
        left_to_give = ++n, live = 0, watching = true;
        skinslide_status status = run_build(&s, &error);
        watching = false;
        assert_int_equal(live, 0);
        if (status)
            assert_fails(status, &error, SKINSLIDE_OUT_OF_MEMORY, "out of memory");
        failed += status != SKINSLIDE_OK;
    } while (left_to_give < 0);
    assert_in_range(failed, 10, n - 10);
    free_scene(&s);
}

/* The functions of paint.h. */
static skinslide_status run_geometry(void *subject, skinslide_error *error) {
    const test_mesh *grid = subject;
    static const float line[6] = {0, 0, 0, 2, 2, 0};
    static const int32_t faces[2] = {0, 2}, edges[2] = {0, 1}, two = 2;
    const skinslide_curves curves = {
        .size = sizeof curves, .curve_count = 1, .vertex_counts = &two, .point_count = 2, .points = line};
    skinslide_mesh view = view_of(grid);
    int32_t across[4], vertices[9];
    const skinslide_mirror_options options = {sizeof options, 0, 1, -1};
    double distance;
    skinslide_status status = skinslide_mirror(&view, &options, faces, 2, across, vertices, error);
    if (!status)
        status = skinslide_mirror_nearest(&view, &options, faces, 2, across, vertices, &distance, error);
    return status ? status
                  : skinslide_edge_distances(grid->points, 9, edges, 1, &curves, SKINSLIDE_DIRECTION_ANY, &distance, error);
}

static void each_allocation_for_geometry_fails_in_turn(void **state) {
    (void)state;
    test_mesh grid = quad_grid(2, 2);
    fail_in_turn(run_geometry, &grid, 15);
    free_mesh(&grid);
}

static skinslide_status run_images(void *subject, skinslide_error *error) {
    const float *pixels = subject;
    enum { SIDE = 40 };
    const skinslide_channel channels[2] = {{sizeof(skinslide_channel), "R", pixels}, {sizeof(skinslide_channel), "G", pixels}};
    const int32_t counts[1] = {3}, indices[3] = {0, 1, 2}, faces[1] = {0};
    const skinslide_mesh mesh = {sizeof(skinslide_mesh), 3, 1, 3, counts, indices, NULL, NULL, NULL, NULL};
    const float st[6] = {0, 0, 1, 0, 1, 1};
    skinslide_bytes *made = NULL;
    skinslide_image *image = NULL;
    int32_t tiles[3];
    float values[3], texels[16];
    const skinslide_texture_layout layout = {sizeof(skinslide_texture_layout), &mesh, faces, 1, st};
    skinslide_status status = skinslide_exr_encode(channels, 2, SIDE, SIDE, SKINSLIDE_WRAP_CLAMP, &made, error);
    if (!status)
        status = skinslide_exr_decode(made->data, made->size, "G", &image, error);
    if (!status)
        status = skinslide_texture_tiles(&layout, tiles, error);
    const skinslide_texture_tile tile = {sizeof(skinslide_texture_tile), image, 0};
    if (!status)
        status = skinslide_texture_sample(&layout, &tile, 1, values, error);
    if (!status)
        status = skinslide_map_draw(&layout, 1001, values, 4, texels, NULL, error);
    skinslide_image_destroy(image);
    skinslide_bytes_destroy(made);
    return status;
}

static void each_allocation_for_images_fails_in_turn(void **state) {
    (void)state;
    float pixels[1600];
    for (int i = 0; i < 1600; i++)
        pixels[i] = (float)(i % 37);
    fail_in_turn(run_images, pixels, 30);
}

/* A tessellation along a limit surface, a camera for it, and a picture. */
static skinslide_status run_pictures(void *own, skinslide_error *error) {
    const scene *s = own;
    enum { SIDE = 32 };
    static uint8_t pixels[SIDE * SIDE * 4];
    const skinslide_canvas_options options = {
        sizeof(skinslide_canvas_options), SIDE, SIDE, SKINSLIDE_PIXELS_BYTES, SKINSLIDE_ANY_DEVICE, 2};
    const skinslide_viewport all = {0, 0, SIDE, SIDE};
    const double up[3] = {0, 1, 0};
    skinslide_mesh view = view_of_scene(s);
    const skinslide_subject subject = {.size = sizeof(skinslide_subject),
                                       .mesh = &view,
                                       .faces = s->faces,
                                       .face_count = 20,
                                       .pose_count = 1,
                                       .poses = (const float *[]){s->points}};
    skinslide_tessellation *tessellation = NULL;
    skinslide_outline *outline = NULL;
    skinslide_canvas *canvas = NULL;
    skinslide_camera camera;
    skinslide_status status = skinslide_tessellation_create(&view, NULL, s->faces, 20, &tessellation, error);
    if (!status)
        status = skinslide_outline_create(tessellation, s->faces, 10, &outline, error);
    const skinslide_strain strain = SKINSLIDE_STRAIN_DEFAULT;
    skinslide_figure figure = SKINSLIDE_FIGURE_DEFAULT;
    figure.tessellation = tessellation, figure.outline = outline, figure.points = figure.ways = s->points;
    figure.wire = figure.ghosts = 1;
    const skinslide_look other = SKINSLIDE_LOOK_DEFAULT;
    figure.others = &other, figure.other_count = 1;
    if (!status)
        status = skinslide_frame_faces(&subject, up, 1, &camera, error);
    if (!status)
        status = skinslide_canvas_create(&options, &canvas, error);
    if (!status)
        status = skinslide_canvas_draw(canvas, &all, &camera, &figure, error);
    if (!status)
        status = skinslide_measure_strain(&view, NULL, s->faces, 20, s->points, &strain, error);
    if (!status)
        status = skinslide_canvas_read(canvas, pixels, error);
    skinslide_canvas_destroy(canvas);
    skinslide_outline_destroy(outline);
    skinslide_tessellation_destroy(tessellation);
    return status;
}

static void each_allocation_for_pictures_fails_in_turn(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    fail_in_turn(run_pictures, &s, 30);
    free_scene(&s);
}

/* ---- What a scene means ---- */

typedef struct stage_scene {
    test_mesh grid;
    skinslide_bytes *file;
    float st[18];
} stage_scene;

static void make_stage_scene(stage_scene *s) {
    const float texel = 0.5f;
    const skinslide_channel channel = {sizeof(skinslide_channel), "R", &texel};
    skinslide_error error;
    *s = (stage_scene){.grid = quad_grid(2, 2)};
    assert_ok(skinslide_exr_encode(&channel, 1, 1, 1, SKINSLIDE_WRAP_CLAMP, &s->file, &error), &error);
    for (int32_t v = 0; v < 9; v++)
        s->st[2 * v] = (float)(v % 3), s->st[2 * v + 1] = (float)(v / 3);
}

static void free_stage_scene(stage_scene *s) {
    skinslide_bytes_destroy(s->file);
    free_mesh(&s->grid);
}

static skinslide_status run_stage_mesh(const stage_scene *s, skinslide_stage_mesh **mesh, skinslide_error *error) {
    const test_mesh *grid = &s->grid;
    const skinslide_value points = array_of("points", SKINSLIDE_VALUE_FLOAT, 3, grid->vertex_count, grid->points);
    const skinslide_stage_input *input = NULL;
    skinslide_status status = skinslide_stage_mesh_create(mesh, error);
    if (!status)
        status = mesh_takes(*mesh, "points", points, error);
    if (!status)
        status = mesh_takes(*mesh, "faceVertexCounts", array_of("c", SKINSLIDE_VALUE_INT32, 1, 4, grid->face_counts), error);
    if (!status)
        status = mesh_takes(*mesh, "faceVertexIndices", array_of("i", SKINSLIDE_VALUE_INT32, 1, 16, grid->face_indices), error);
    if (!status)
        status = mesh_takes(*mesh, "restPoints", points, error);
    while (!status && (input = skinslide_stage_next_input(SKINSLIDE_STAGE_SUBDIVISION, input)) != NULL)
        status = skinslide_stage_mesh_take(*mesh, input, NULL, error);
    static const double uneven[16] = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    if (!status)
        status = skinslide_stage_mesh_offer(*mesh, "primvars:map1", "texCoord2f[]", "faceVarying", error);
    return status ? status : skinslide_stage_mesh_space(*mesh, uneven, 1, error);
}

static skinslide_status run_stage_patch(const skinslide_stage_mesh *mesh, skinslide_stage_patch **patch,
                                        skinslide_error *error) {
    const skinslide_value faces = INTS("elbow.indices", 0, 1, 2, 3);
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    const skinslide_stage_input *indices = input_of(SKINSLIDE_STAGE_SUBSET, NULL, "indices");
    subset.path = "/elbow", subset.is_subset = 1;
    skinslide_status status = skinslide_stage_patch_create(mesh, "elbow", NULL, patch, error);
    if (!status)
        status = skinslide_stage_patch_take_subset(*patch, &subset, error);
    if (!status)
        status = skinslide_stage_patch_take(*patch, indices, &faces, error);
    if (!status)
        status = skinslide_stage_patch_check(*patch, indices, &faces, 1, error);
    if (!status)
        status = patch_takes(*patch, "edges", INTS("edges", 0, 1), error);
    if (!status)
        status = skinslide_stage_patch_meet(*patch, (const float[3]){0, 0, 0}, 1, error);
    return status ? status : patch_takes(*patch, "mapSt", text_of("mapSt", "uv"), error);
}

static skinslide_status run_stage_controls(const stage_scene *s, skinslide_stage_controls *controls, skinslide_error *error) {
    static const float ones[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    const skinslide_value st = painted_as(array_of("uv", SKINSLIDE_VALUE_FLOAT, 2, 9, s->st), "vertex");
    const skinslide_value paint = painted_as(array_of("weight", SKINSLIDE_VALUE_FLOAT, 1, 9, ones), "vertex");
    skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
    file.path = "/w.1001.exr", file.bytes = s->file->data, file.byte_count = s->file->size;
    skinslide_status status = controls_take(controls, "weight", paint, error);
    if (!status)
        status = controls_take(controls, "edgeForceDensities", FLOATS("factors", 2), error);
    if (!status)
        status = controls_take(controls, "weightMap", asset_of("weightMap", "w.<UDIM>.exr"), error);
    if (!status)
        status = skinslide_stage_controls_take(controls, skinslide_stage_controls_coordinates(controls), &st, error);
    const skinslide_stage_need *need = NULL;
    while (!status && !(status = skinslide_stage_controls_need(controls, &need, error)) && need)
        status = skinslide_stage_controls_give(controls, &file, error);
    return status;
}

static skinslide_status run_stage_derived(const skinslide_stage_mesh *mesh, skinslide_error *error) {
    const double times[] = {1, 3};
    const skinslide_value none = blocked_of("velocities");
    const skinslide_stage_input *input;
    skinslide_stage_derived *derived = NULL;
    skinslide_status status = skinslide_stage_derived_create(mesh, times, 2, 24, &derived, error);
    if (!status)
        status = skinslide_stage_derived_fill(derived, error);
    if (!status)
        status = skinslide_stage_derived_offer(derived, "primvars:tangents", "vector3f[]", "vertex", 1, &input, error);
    if (!status)
        status = skinslide_stage_derived_take(derived, input, &none, times, 2, error);
    if (!status)
        status = skinslide_stage_derived_offer(derived, "primvars:tangents", "float4[]", "vertex", 1, &input, error);
    if (!status)
        status = skinslide_stage_derived_take(derived, input_of(SKINSLIDE_STAGE_DERIVED, NULL, "velocities"), &none, times, 2,
                                              error);
    skinslide_stage_derived_destroy(derived);
    return status;
}

static skinslide_status run_stage_finding(skinslide_error *error) {
    const char *schemas[] = {"SkinSlideAPI:elbow", "SkinSlideAPI"}, *properties[] = {"skinSlide:wrist:envelope"};
    skinslide_stage_prim prim = SKINSLIDE_STAGE_PRIM_DEFAULT;
    skinslide_stage_finding *finding = NULL;
    prim.is_mesh = 1, prim.schema_count = 2, prim.schemas = schemas, prim.property_count = 1, prim.properties = properties;
    skinslide_status status = skinslide_stage_find(&prim, &finding, error);
    skinslide_stage_finding_destroy(finding);
    return status;
}

static skinslide_status run_stage(void *own, skinslide_error *error) {
    skinslide_stage_mesh *mesh = NULL;
    skinslide_stage_patch *patch = NULL;
    skinslide_stage_controls *first = NULL, *frame = NULL;
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    skinslide_status status = run_stage_mesh(own, &mesh, error);
    if (!status)
        status = run_stage_patch(mesh, &patch, error);
    if (!status)
        status = skinslide_stage_controls_create(patch, NULL, &first, error);
    if (!status)
        status = run_stage_controls(own, first, error);
    if (!status)
        status = skinslide_stage_patch_get(patch, first, &setup, error);
    if (!status)
        status = skinslide_stage_controls_create(patch, first, &frame, error);
    if (!status)
        status = run_stage_controls(own, frame, error);
    if (!status)
        status = skinslide_stage_controls_get(frame, &controls, error);
    if (!status)
        status = run_stage_derived(mesh, error);
    skinslide_stage_controls_destroy(frame), skinslide_stage_controls_destroy(first);
    skinslide_stage_patch_destroy(patch), skinslide_stage_mesh_destroy(mesh);
    return status ? status : run_stage_finding(error);
}

static void each_allocation_for_a_stage_fails_in_turn(void **state) {
    (void)state;
    stage_scene s;
    make_stage_scene(&s);
    fail_in_turn(run_stage, &s, 100);
    free_stage_scene(&s);
}

/* Paint of a frame takes the memory of the frame before. */
static void controls_of_a_frame_allocate_nothing(void **state) {
    (void)state;
    test_mesh grid = quad_grid(3, 3);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    skinslide_stage_patch *patch = scene_patch(mesh, &grid, NULL);
    skinslide_stage_controls *controls = scene_controls(patch);
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    skinslide_error error;
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t frame = 0; frame < 3 && !status; frame++) {
        left_to_give = 0, watching = frame > 0;
        status = controls_take(controls, "weight", NUMBER("weight", 0.5f), &error);
        if (!status)
            status = controls_take(controls, "envelope", NUMBER("envelope", 0.5f), &error);
        if (!status)
            status = skinslide_stage_controls_get(controls, &out, &error);
        watching = false;
    }
    assert_ok(status, &error);
    skinslide_stage_controls_destroy(controls);
    skinslide_stage_patch_destroy(patch);
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

/* ---- Frames and sizes ---- */

/* A frame allocates nothing but what checks the edges that its controls name and, at the first limit, what measures ways: so it
 * cannot fail for memory otherwise. */
static void a_frame_allocates_nothing(void **state) {
    (void)state;
    scene s;
    make_scene(&s);
    rig r = {0};
    skinslide_mesh view = view_of_scene(&s);
    skinslide_error error;
    assert_ok(skinslide_slider_create(&view, s.setups, SETUPS, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    left_to_give = 0, watching = true;
    skinslide_status plain = skinslide_slide(r.workspace, s.points, NULL, s.slid, NULL, &error);
    watching = false;
    assert_ok(plain, &error);
    free_rig(&r);
    free_scene(&s);
}

/* Then nothing is written, and the workspace slides the next frame as one that never failed. */
/* As many unknowns as are parted before they are ordered. */
static void each_allocation_for_a_large_system_fails_in_turn(void **state) {
    (void)state;
    enum { COUNT = 2500 };
    static int32_t edges[COUNT - 1][2];
    static const uint8_t fixed[COUNT] = {1};
    const ss_net net = {COUNT, COUNT - 1, (const int32_t(*)[2])edges, fixed};
    for (int32_t i = 0; i + 1 < COUNT; i++)
        edges[i][0] = i, edges[i][1] = i + 1;
    skinslide_status status = SKINSLIDE_OUT_OF_MEMORY;
    for (int32_t allowed = 0; status; allowed++) {
        ss_system *system = NULL;
        ss_factor *factor = NULL;
        skinslide_error error;
        live = 0, left_to_give = allowed, watching = true;
        status = ss_system_create(&net, "path", &system, &error);
        if (!status)
            status = ss_factor_create(system, NULL, &factor, &error);
        ss_factor_destroy(factor);
        ss_system_destroy(system);
        watching = false;
        assert_int_equal(live, 0);
        if (status)
            assert_fails(status, &error, SKINSLIDE_OUT_OF_MEMORY, "out of memory");
    }
}

/* The first limit of a rule in the plane, and edges that are named. */
static void a_frame_may_find_no_memory(void **state) {
    (void)state;
    for (int32_t setup = 0; setup < 2; setup++) {
        scene s;
        make_scene(&s);
        rig r = rig_of_setups(&s.mesh, &s.setups[setup], 1), fresh = rig_of_setups(&s.mesh, &s.setups[setup], 1);
        skinslide_controls limited = SKINSLIDE_CONTROLS_DEFAULT;
        skinslide_error error;
        limited.max_distance = s.limits;
        if (setup == 1)
            limited.edges = s.controls[0].edges, limited.edge_density = s.controls[0].edge_density, limited.edge_count = 1;
        float *expected = slide_with(&fresh, &s.mesh, s.points, &limited, NULL);
        left_to_give = 0, watching = true;
        skinslide_status status = skinslide_slide(r.workspace, s.points, &limited, s.slid, NULL, &error);
        watching = false;
        assert_fails(status, &error, SKINSLIDE_OUT_OF_MEMORY, "out of memory");
        assert_same_bytes(s.slid, s.points, POINT_BYTES(&s.mesh));
        assert_ok(skinslide_slide(r.workspace, s.points, &limited, s.slid, NULL, &error), &error);
        assert_same_bytes(s.slid, expected, POINT_BYTES(&s.mesh));
        free(expected);
        free_rig(&r), free_rig(&fresh);
        free_scene(&s);
    }
}

/* 200 faces around a pole have 200 vertices and more each; the 1,800 others have 16, and no room is taken for more. */
static void a_pole_takes_room_for_itself_alone(void **state) {
    (void)state;
    static const skinslide_subdivision catmull_clark = {.size = sizeof(skinslide_subdivision),
                                                        .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    test_mesh mesh = finger(200, 9);
    skinslide_mesh view = view_of(&mesh);
    view.subdivision = &catmull_clark;
    int32_t *faces = all_faces(&mesh);
    skinslide_patch_setup setup = setup_of(faces, mesh.face_count);
    skinslide_slider *slider = NULL;
    skinslide_error error;
    left_to_give = -1, largest = 0, watching = true;
    skinslide_status status = skinslide_slider_create(&view, &setup, 1, &slider, &error);
    watching = false;
    assert_ok(status, &error);
    print_message("%d faces: at most %zu bytes at once\n", mesh.face_count, largest);
    assert_in_range(largest, 1, 2500000);
    skinslide_slider_destroy(slider);
    free(faces);
    free_mesh(&mesh);
}

int main(void) {
    SuiteSparse_config.malloc_func = solver_malloc;
    SuiteSparse_config.calloc_func = __wrap_calloc;
    SuiteSparse_config.free_func = __wrap_free;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_that_are_too_large_fail),
        cmocka_unit_test(memory_is_zero_and_aligned),
        cmocka_unit_test(each_allocation_fails_in_turn),
        cmocka_unit_test(each_allocation_of_a_build_fails_in_turn),
        cmocka_unit_test(each_allocation_for_geometry_fails_in_turn),
        cmocka_unit_test(each_allocation_for_images_fails_in_turn),
        cmocka_unit_test(each_allocation_for_pictures_fails_in_turn),
        cmocka_unit_test(each_allocation_for_a_stage_fails_in_turn),
        cmocka_unit_test(each_allocation_for_a_large_system_fails_in_turn),
        cmocka_unit_test(controls_of_a_frame_allocate_nothing),
        cmocka_unit_test(a_frame_allocates_nothing),
        cmocka_unit_test(a_frame_may_find_no_memory),
        cmocka_unit_test(a_pole_takes_room_for_itself_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
