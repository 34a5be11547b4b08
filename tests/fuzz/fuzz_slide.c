/* A mesh, a patch and frames of any bytes: set up or refused, and slid to finite points or refused; by rules without a plane
 * never because of the matrix. What is not finite off the patch passes. Then the same with points put in one place, and
 * welded. */
#include "skinslide/skinslide.h"
#include "stream.h"

#include <math.h>

enum { MOST_VERTICES = 64, MOST_FACES = 48, FRAMES = 2 };

typedef struct input {
    skinslide_mesh mesh;
    skinslide_subdivision subdivision;
    int32_t counts[MOST_FACES], indices[MOST_FACES * 8], faces[MOST_FACES], corners[4], crease_length, *crease;
    float *rest, sharpness;
} input;

/* Counts from 0 to 7 and indices that are rarely out of range; USD's shapes of arrays, a patch of all faces or of some. */
static void take_mesh(input *in, stream *s) {
    in->mesh = (skinslide_mesh)SKINSLIDE_MESH_DEFAULT;
    in->mesh.vertex_count = 3 + take_below(s, MOST_VERTICES - 3), in->mesh.face_count = 1 + take_below(s, MOST_FACES);
    for (int32_t f = 0; f < in->mesh.face_count; f++)
        in->mesh.index_count += in->counts[f] = (take_below(s, 8) + 3) % 8;
    for (int32_t c = 0; c < in->mesh.index_count; c++)
        in->indices[c] = take_below(s, 255) % (in->mesh.vertex_count + 1);
    in->mesh.face_counts = in->counts, in->mesh.face_indices = in->indices;
    in->mesh.rest_points = in->rest = take_new(s, (size_t)in->mesh.vertex_count * sizeof(float[3]));
    in->subdivision = (skinslide_subdivision)SKINSLIDE_SUBDIVISION_DEFAULT;
    in->subdivision.scheme = (skinslide_scheme)take_below(s, 5);
    in->subdivision.boundary_rule = (skinslide_boundary_rule)take_below(s, 4);
    in->subdivision.triangle_rule = (skinslide_triangle_rule)take_below(s, 3);
    take(s, &in->sharpness, sizeof in->sharpness);
    in->crease_length = take_below(s, 4), in->crease = in->indices + take_below(s, 200);
    in->subdivision.crease_count = in->subdivision.crease_sharpness_count = in->crease_length > 1;
    in->subdivision.crease_index_count = in->crease_length > 1 ? in->crease_length : 0;
    in->subdivision.crease_lengths = &in->crease_length, in->subdivision.crease_indices = in->crease;
    in->subdivision.crease_sharpnesses = &in->sharpness;
    in->mesh.subdivision = take_below(s, 2) ? &in->subdivision : NULL;
}

static skinslide_patch_setup take_setup(input *in, stream *s) {
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    setup.name = "p", setup.faces = in->faces;
    int32_t out_of = take_below(s, 4);
    for (int32_t f = 0; f < in->mesh.face_count; f++)
        if (!out_of || take_below(s, out_of + 1))
            in->faces[setup.face_count++] = f;
    setup.boundary = (skinslide_boundary)take_below(s, 4), setup.holes = (skinslide_holes)take_below(s, 3);
    setup.rule = (skinslide_rule)take_below(s, 4);
    setup.interpolation = (skinslide_interpolation)take_below(s, 5);
    for (int k = 0; k < 4; k++)
        in->corners[k] = take_below(s, 255) % in->mesh.vertex_count;
    setup.corners = take_below(s, 2) ? in->corners : NULL;
    return setup;
}

/* Those of the default, unless there are others. */
static void take_responses(skinslide_controls *controls, stream *s) {
    if (take_below(s, 2)) {
        take(s, &controls->stretch_response, sizeof controls->stretch_response);
        take(s, &controls->compression_response, sizeof controls->compression_response);
    }
}

/* A power of two for each vertex, of all that floats have, or NULL. To be freed. */
static float *take_powers(stream *s, int32_t vertex_count) {
    float *powers = take_below(s, 2) ? malloc((size_t)vertex_count * sizeof *powers) : NULL;
    for (int32_t v = 0; v < vertex_count && powers; v++)
        powers[v] = ldexpf(1, take_below(s, 256) - 128);
    return powers;
}

static void slide(const skinslide_slider *slider, int32_t vertex_count, skinslide_rule rule, stream *s) {
    skinslide_workspace_options options = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    options.lookup = SKINSLIDE_LOOKUP_EXACT;
    require(!skinslide_workspace_create(slider, &options, &workspace, &error));
    for (int frame = 0; frame < FRAMES; frame++) {
        size_t size = (size_t)vertex_count * sizeof(float[3]);
        float *points = take_new(s, size), *slid = malloc(size);
        skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
        take(s, &controls.envelope, sizeof controls.envelope);
        take_responses(&controls, s);
        float *hold = take_below(s, 2) ? take_new(s, (size_t)vertex_count * sizeof *hold) : NULL;
        float *density = take_powers(s, vertex_count), *held = take_powers(s, vertex_count);
        controls.hold = held ? held : hold, controls.vertex_density = density;
        skinslide_status status = skinslide_slide(workspace, points, &controls, slid, NULL, &error);
        for (int32_t i = 0; !status && i < 3 * vertex_count; i++)
            require(isfinite(slid[i]) || !isfinite(points[i]));
        require(!status || (error.message[0] && !strchr(error.message, '\n')));
        require(status != SKINSLIDE_SINGULAR || rule == SKINSLIDE_RULE_UNIT || rule == SKINSLIDE_RULE_FAST);
        free(points), free(slid), free(hold), free(held), free(density);
    }
    skinslide_workspace_destroy(workspace);
}

static void try_to_slide(const skinslide_mesh *mesh, const skinslide_patch_setup *setup, stream *s) {
    skinslide_slider *slider = NULL;
    skinslide_error error;
    skinslide_status status = skinslide_slider_create(mesh, setup, 1, &slider, &error);
    if (status)
        require(!slider && error.message[0] && !strchr(error.message, '\n'));
    else
        slide(slider, mesh->vertex_count, setup->rule, s);
    skinslide_slider_destroy(slider);
}

/* Each point in the place of another, by the bytes from the first on; and in a pose in that of a third. */
static void put_together(const skinslide_mesh *mesh, const float *points, stream s, float *out) {
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        memcpy(out + 3 * v, points + 3 * (take_below(&s, 2) ? v : take_below(&s, 255) % mesh->vertex_count), sizeof(float[3]));
}

/* What is one is one with itself, and lowest. */
static void require_weld(const skinslide_mesh *mesh, const int32_t *weld) {
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        require(weld[v] >= 0 && weld[v] < mesh->vertex_count && weld[weld[v]] == weld[v]);
}

static void weld_and_slide(input *in, const skinslide_patch_setup *setup, stream all, stream *s) {
    size_t size = (size_t)in->mesh.vertex_count * sizeof(float[3]);
    float *rest = malloc(size), *pose = malloc(size);
    int32_t *vertices = malloc((size_t)in->mesh.vertex_count * sizeof *vertices);
    skinslide_weld *weld = NULL;
    skinslide_error error;
    put_together(&in->mesh, in->rest, all, rest);
    put_together(&in->mesh, rest, *s, pose);
    in->mesh.rest_points = rest;
    if (!skinslide_weld_create(&in->mesh, setup, 1, 0, &weld, &error)) {
        skinslide_status status = skinslide_weld_show(weld, 1, pose, &error);
        require(!status || (error.message[0] && !strchr(error.message, '\n')));
        require(!skinslide_weld_get(weld, vertices, NULL, &error));
        require_weld(&in->mesh, vertices);
        in->mesh.weld = vertices;
        try_to_slide(&in->mesh, setup, s);
    }
    skinslide_weld_destroy(weld);
    free(rest), free(pose), free(vertices);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const input none;
    stream s = {data, size}, all = s;
    input in = none;
    take_mesh(&in, &s);
    skinslide_patch_setup setup = take_setup(&in, &s);
    stream after = s;
    try_to_slide(&in.mesh, &setup, &s);
    weld_and_slide(&in, &setup, all, &after);
    free(in.rest);
    return 0;
}
