/* Textures of a patch: what is asked for, what the values are and multiply, what is held from frame to frame, and what
 * fails. */
#include "records.h"
#include "skinslide/paint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;
#define MAP     "skinSlide:elbow:weightMap"
#define WEIGHT  "primvars:skinSlide:elbow:weight"
#define DENSITY "primvars:skinSlide:elbow:forceDensity"

/* 2 x 2 quads with st from 0 to 1. */
static patch_scene set_up(void) {
    patch_scene s = {quad_grid(2, 2), NULL, NULL, NULL};
    s.mesh = scene_mesh(&s.grid);
    s.patch = scene_patch(s.mesh, &s.grid, NULL);
    s.controls = scene_controls(s.patch);
    return s;
}

/* st of the grid's vertices, times a scale. */
static skinslide_value st_of(float scale) {
    static float st[18];
    for (int v = 0; v < 9; v++)
        st[2 * v] = scale * 0.5f * (float)(v % 3), st[2 * v + 1] = scale * 0.5f * (float)(v / 3);
    return painted_as(array_of("primvars:st", SKINSLIDE_VALUE_FLOAT, 2, 9, st), "vertex");
}

/* An image of one value, as a file. */
static skinslide_bytes *file_of(float value) {
    const skinslide_channel channel = {sizeof(skinslide_channel), "R", &value};
    skinslide_bytes *bytes = NULL;
    assert_ok(skinslide_exr_encode(&channel, 1, 1, 1, SKINSLIDE_WRAP_CLAMP, &bytes, &error), &error);
    return bytes;
}

static skinslide_status take_coordinates(skinslide_stage_controls *controls, skinslide_value st) {
    return skinslide_stage_controls_take(controls, skinslide_stage_controls_coordinates(controls), &st, &error);
}

static const skinslide_stage_need *needed(skinslide_stage_controls *controls) {
    const skinslide_stage_need *need = NULL;
    assert_ok(skinslide_stage_controls_need(controls, &need, &error), &error);
    return need;
}

static skinslide_status give(skinslide_stage_controls *controls, const char *path, float value) {
    skinslide_bytes *bytes = file_of(value);
    skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
    file.path = path, file.bytes = bytes->data, file.byte_count = bytes->size;
    skinslide_status status = skinslide_stage_controls_give(controls, &file, &error);
    skinslide_bytes_destroy(bytes);
    return status;
}

static skinslide_status give_none(skinslide_stage_controls *controls) {
    return skinslide_stage_controls_give(controls, NULL, &error);
}

static void ask(skinslide_stage_controls *controls, const char *name, const char *asset, float scale) {
    skinslide_value st = st_of(scale);
    assert_ok(controls_take(controls, name, asset_of(name, asset), &error), &error);
    assert_string_equal(skinslide_stage_controls_coordinates(controls)->name, "st");
    assert_ok(take_coordinates(controls, st), &error);
    assert_non_null(needed(controls));
}

static skinslide_controls got(skinslide_stage_controls *controls) {
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    assert_ok(skinslide_stage_controls_get(controls, &out, &error), &error);
    return out;
}

static void expect_need(skinslide_stage_controls *controls, const char *name, const char *path, int32_t tile) {
    const skinslide_stage_need *need = needed(controls);
    assert_non_null(need);
    assert_string_equal(need->input->name, name);
    assert_string_equal(need->path, path);
    assert_int_equal(need->tile, tile);
}

/* ---- What comes of them ---- */

static void no_texture_asks_for_nothing(void **state) {
    (void)state;
    patch_scene s = set_up();
    assert_ok(controls_take(s.controls, "weightMap", nothing_of(MAP), &error), &error);
    assert_null(skinslide_stage_controls_coordinates(s.controls));
    assert_ok(controls_take(s.controls, "forceDensityMap", asset_of(MAP, ""), &error), &error);
    assert_null(needed(s.controls));
    assert_int_equal(give_none(s.controls), SKINSLIDE_BAD_ARGUMENT);
    assert_null(skinslide_stage_controls_texture(s.controls, input_of(SKINSLIDE_STAGE_CONTROLS, NULL, "weightMap")));
    assert_null(got(s.controls).weight);
    end_scene(&s);
}

static void a_texture_alone_is_the_weight(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    ask(s.controls, "weightMap", "./w.exr", 1);
    expect_need(s.controls, "weightMap", "./w.exr", 0);
    assert_fails(skinslide_stage_controls_get(s.controls, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the files of weightMap were not given");
    assert_ok(give(s.controls, "/maps/w.exr", 0.25f), &error);
    assert_null(needed(s.controls));
    out = got(s.controls);
    for (int v = 0; v < 9; v++)
        assert_true(out.weight[v] == 0.25f);
    const skinslide_stage_texture *shown =
        skinslide_stage_controls_texture(s.controls, input_of(SKINSLIDE_STAGE_CONTROLS, NULL, "weightMap"));
    assert_string_equal(shown->file, "/maps/w.exr");
    assert_string_equal(shown->channel, "R");
    assert_string_equal(shown->st, "primvars:st");
    assert_true(shown->tile_count == 1 && shown->tiles[0].number == 0 && shown->tiles[0].width == 1);
    end_scene(&s);
}

/* By vertex they multiply; a constant density drops out, one by face stays beside. */
static void textures_multiply_paint(void **state) {
    (void)state;
    patch_scene s = set_up();
    const float numbers[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    skinslide_value by_vertex = painted_as(array_of(DENSITY, SKINSLIDE_VALUE_FLOAT, 1, 9, numbers), "vertex"),
                    by_face = by_vertex;
    by_face.interpolation = "uniform", by_face.count = 4;
    ask(s.controls, "forceDensityMap", "q.exr", 1);
    assert_ok(give(s.controls, "q.exr", 0.5f), &error);
    assert_ok(controls_take(s.controls, "forceDensity", by_vertex, &error), &error);
    skinslide_controls out = got(s.controls);
    for (int v = 0; v < 9; v++)
        assert_true(out.vertex_density[v] == 0.5f * numbers[v]);
    assert_null(out.face_density);
    assert_ok(controls_take(s.controls, "forceDensity", by_face, &error), &error);
    out = got(s.controls);
    assert_true(out.vertex_density[3] == 0.5f && out.face_density[3] == 4);
    assert_ok(controls_take(s.controls, "forceDensity", NUMBER(DENSITY, 7), &error), &error);
    out = got(s.controls);
    assert_true(out.vertex_density[3] == 0.5f && !out.face_density);
    assert_ok(controls_take(s.controls, "forceDensityMap", nothing_of(MAP), &error), &error);
    assert_null(got(s.controls).vertex_density);
    end_scene(&s);
}

/* The grid lies in four tiles; borders between them are in the tile of their face. */
static void tiles_are_asked_for_in_turn(void **state) {
    (void)state;
    patch_scene s = set_up();
    static const int32_t numbers[] = {1001, 1002, 1011, 1012};
    ask(s.controls, "weightMap", "./w.<UDIM>.exr", 2);
    for (int32_t i = 0; i < 4; i++) {
        char path[32], resolved[40];
        snprintf(path, sizeof path, "./w.%d.exr", numbers[i]);
        snprintf(resolved, sizeof resolved, "/1001/w.%d.exr", numbers[i]);
        expect_need(s.controls, "weightMap", path, numbers[i]);
        assert_ok(give(s.controls, resolved, (float)(i + 1)), &error);
    }
    skinslide_controls out = got(s.controls);
    assert_true(out.weight[0] == 1 && out.weight[2] == 2 && out.weight[6] == 3 && out.weight[8] == 4);
    assert_true(out.weight[1] == 1.5f && out.weight[3] == 2 && out.weight[4] == 2.5f);
    const skinslide_stage_texture *shown =
        skinslide_stage_controls_texture(s.controls, input_of(SKINSLIDE_STAGE_CONTROLS, NULL, "weightMap"));
    assert_string_equal(shown->file, "/1001/w.<UDIM>.exr");
    assert_true(shown->tile_count == 4 && shown->tiles[3].number == 1012);
    end_scene(&s);
}

static void coordinates_of_another_name(void **state) {
    (void)state;
    static const char *const words[] = {"uv2", "primvars:uv2"};
    for (int i = 0; i < 2; i++) {
        patch_scene s = set_up();
        assert_ok(patch_takes(s.patch, "mapSt", text_of("mapSt", words[i]), &error), &error);
        assert_ok(controls_take(s.controls, "weightMap", asset_of(MAP, "w.exr"), &error), &error);
        const skinslide_stage_input *st = skinslide_stage_controls_coordinates(s.controls);
        assert_string_equal(st->prefix, "primvars:");
        assert_string_equal(st->name, "uv2");
        assert_true(st->is_primvar && st->when == SKINSLIDE_STAGE_ANIMATED);
        end_scene(&s);
    }
}

static void a_channel_of_its_own(void **state) {
    (void)state;
    patch_scene s = set_up();
    assert_ok(patch_takes(s.patch, "weightMapChannel", text_of("channel", "Q"), &error), &error);
    ask(s.controls, "weightMap", "w.exr", 1);
    assert_fails(give(s.controls, "/w.exr", 1), &error, SKINSLIDE_BAD_IMAGE,
                 "weightMap: /w.exr: there is no channel Q; the file has R");
    end_scene(&s);
}

/* ---- Frames ---- */

static void a_frame_multiplies_the_texture_of_its_base(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_stage_controls *frame = NULL;
    ask(s.controls, "weightMap", "w.exr", 1);
    assert_ok(give(s.controls, "w.exr", 0.5f), &error);
    assert_ok(controls_take(s.controls, "weight", FLOATS(WEIGHT, 1), &error), &error);
    assert_true(got(s.controls).weight[4] == 0.5f);
    assert_ok(skinslide_stage_controls_create(s.patch, s.controls, &frame, &error), &error);
    assert_ptr_equal(got(frame).weight, got(s.controls).weight);
    assert_ok(controls_take(frame, "weight", FLOATS(WEIGHT, 0.5f), &error), &error);
    assert_true(got(frame).weight[4] == 0.25f && got(s.controls).weight[4] == 0.5f);
    skinslide_stage_controls_destroy(frame);
    end_scene(&s);
}

/* From the second frame on an image is held, so that only coordinates that vary are sampled anew. */
static void images_are_held_between_frames(void **state) {
    (void)state;
    patch_scene s = set_up();
    for (int frame = 0; frame < 4; frame++) {
        ask(s.controls, "weightMap", frame == 3 ? "other.exr" : "w.exr", 1);
        assert_int_equal(skinslide_stage_controls_holds(s.controls, "/w.exr"), frame >= 2);
        assert_false(skinslide_stage_controls_holds(s.controls, "/other.exr"));
        if (frame == 2) {
            skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
            file.path = "/w.exr";
            assert_ok(skinslide_stage_controls_give(s.controls, &file, &error), &error);
        } else {
            assert_ok(give(s.controls, frame == 3 ? "/other.exr" : "/w.exr", (float)(frame == 3 ? 3 : 0.5)), &error);
        }
        assert_true(got(s.controls).weight[0] == (frame == 3 ? 3 : 0.5f));
    }
    end_scene(&s);
}

/* The asset is the same, and need not be taken again. */
static void other_coordinates_ask_for_files_again(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_value st;
    for (int32_t taken = 1; taken <= 2; taken++) { /* from the second on, images are held */
        ask(s.controls, "weightMap", "w.<UDIM>.exr", 2);
        for (int32_t tile = 0; tile < 4; tile++)
            assert_ok(give(s.controls, "/w.exr", 1), &error);
        st = st_of(1);
        assert_ok(take_coordinates(s.controls, st), &error);
        expect_need(s.controls, "weightMap", "w.1001.exr", 1001);
        assert_ok(give(s.controls, "/other.exr", 0.5f), &error);
        assert_true(got(s.controls).weight[0] == 0.5f);
        st = st_of(2);
        assert_ok(take_coordinates(s.controls, st), &error);
        expect_need(s.controls, "weightMap", "w.1001.exr", 1001);
    }
    end_scene(&s);
}

/* A frame takes what varies alone: of its base's maps, at other coordinates, nothing else is new. */
static void a_frame_moves_the_texture_of_its_base(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_stage_controls *frame = NULL;
    ask(s.controls, "weightMap", "w.<UDIM>.exr", 2);
    for (int32_t tile = 0; tile < 4; tile++)
        assert_ok(give(s.controls, "/w.exr", 0.5f), &error);
    assert_ok(skinslide_stage_controls_create(s.patch, s.controls, &frame, &error), &error);
    assert_null(needed(frame));
    for (int32_t time = 0; time < 3; time++) {
        const skinslide_stage_need *need;
        assert_ok(take_coordinates(frame, st_of(1)), &error);
        expect_need(frame, "weightMap", "w.1001.exr", 1001);
        assert_int_equal(skinslide_stage_controls_holds(frame, "/other.exr"), time > 1);
        assert_ok(give(frame, "/other.exr", 0.25f), &error);
        assert_true(got(frame).weight[0] == 0.25f && got(s.controls).weight[0] == 0.5f);
        if (time)
            continue; /* a time that fails leaves the next one whole */
        assert_ok(take_coordinates(frame, nothing_of("primvars:st")), &error);
        assert_int_equal(skinslide_stage_controls_need(frame, &need, &error), SKINSLIDE_BAD_CONTROL);
        assert_ok(take_coordinates(frame, st_of(-1)), &error);
        assert_int_equal(skinslide_stage_controls_need(frame, &need, &error), SKINSLIDE_BAD_CONTROL);
    }
    skinslide_stage_controls_destroy(frame);
    end_scene(&s);
}

static void a_frame_takes_one_texture_of_two(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_stage_controls *frame = NULL;
    ask(s.controls, "weightMap", "w.exr", 1);
    assert_ok(give(s.controls, "/w.exr", 0.5f), &error);
    assert_ok(controls_take(s.controls, "forceDensityMap", asset_of(MAP, "d.exr"), &error), &error);
    assert_non_null(needed(s.controls));
    assert_ok(give(s.controls, "/d.exr", 3), &error);
    assert_ok(skinslide_stage_controls_create(s.patch, s.controls, &frame, &error), &error);
    assert_ok(controls_take(frame, "weightMap", asset_of(MAP, "later.exr"), &error), &error);
    expect_need(frame, "weightMap", "later.exr", 0);
    assert_ok(give(frame, "/later.exr", 1), &error);
    assert_null(needed(frame));
    assert_true(got(frame).weight[0] == 1 && got(s.controls).weight[0] == 0.5f);
    assert_ptr_equal(got(frame).vertex_density, got(s.controls).vertex_density);
    skinslide_stage_controls_destroy(frame);
    end_scene(&s);
}

/* ---- What fails ---- */

static void expect_refused(patch_scene *s, skinslide_status status, skinslide_status expected, const char *text) {
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    assert_fails(status, &error, expected, text);
    assert_null(needed(s->controls));
    assert_fails(skinslide_stage_controls_get(s->controls, &out, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "weightMap was refused");
}

static void assets_of_another_type(void **state) {
    (void)state;
    patch_scene s = set_up();
    expect_refused(&s, controls_take(s.controls, "weightMap", text_of(MAP, "m.exr"), &error), SKINSLIDE_BAD_CONTROL,
                   MAP " is 'm.exr'; it must be an asset");
    expect_refused(&s, controls_take(s.controls, "weightMap", other_of(MAP, "asset[]"), &error), SKINSLIDE_BAD_CONTROL,
                   MAP " is asset[]; it must be an asset");
    end_scene(&s);
}

static void expect_no_coordinates(skinslide_value st, const char *asset, const char *text) {
    patch_scene s = set_up();
    const skinslide_stage_need *need;
    assert_ok(controls_take(s.controls, "weightMap", asset_of(MAP, asset), &error), &error);
    assert_ok(take_coordinates(s.controls, st), &error);
    expect_refused(&s, skinslide_stage_controls_need(s.controls, &need, &error), SKINSLIDE_BAD_CONTROL, text);
    end_scene(&s);
}

static void no_coordinates(void **state) {
    (void)state;
    expect_no_coordinates(nothing_of("primvars:st"), "w.exr",
                          "has a map, but the mesh has no primvars:st; name one in skinSlide:elbow:mapSt: there are none");
    expect_no_coordinates(painted_as(st_of(1), "uniform"), "w.exr",
                          "primvars:st has interpolation uniform; a map needs faceVarying, vertex or varying");
    expect_no_coordinates(st_of(-1), "w.<UDIM>.exr", MAP ": w.<UDIM>.exr: face 0 has st (-0, -0), which is in no UDIM tile");
}

/* A map may come later. */
static void coordinates_matter_where_there_is_a_map(void **state) {
    (void)state;
    patch_scene s = set_up();
    const skinslide_stage_need *need;
    skinslide_stage_controls *frame = NULL;
    assert_ok(controls_take(s.controls, "weightMap", blocked_of(MAP), &error), &error);
    assert_ok(take_coordinates(s.controls, nothing_of("primvars:st")), &error);
    assert_null(needed(s.controls));
    assert_null(got(s.controls).weight);
    assert_ok(skinslide_stage_controls_create(s.patch, s.controls, &frame, &error), &error);
    assert_ok(controls_take(frame, "weightMap", asset_of(MAP, "w.exr"), &error), &error);
    assert_fails(skinslide_stage_controls_need(frame, &need, &error), &error, SKINSLIDE_BAD_CONTROL,
                 "has a map, but the mesh has no primvars:st; name one in skinSlide:elbow:mapSt: there are none");
    skinslide_stage_controls_destroy(frame);
    end_scene(&s);
}

static void no_such_file(void **state) {
    (void)state;
    patch_scene s = set_up();
    ask(s.controls, "weightMap", "./w.exr", 1);
    expect_refused(&s, give_none(s.controls), SKINSLIDE_BAD_CONTROL, "weightMap: ./w.exr: there is no such file");
    ask(s.controls, "weightMap", "./w.<UDIM>.exr", 2);
    for (int i = 0; i < 3; i++)
        assert_ok(give_none(s.controls), &error);
    expect_refused(&s, give_none(s.controls), SKINSLIDE_BAD_CONTROL, "weightMap: ./w.<UDIM>.exr: there is no such file");
    ask(s.controls, "weightMap", "./w.<UDIM>.exr", 2);
    assert_ok(give(s.controls, "/w.1001.exr", 1), &error);
    assert_ok(give_none(s.controls), &error);
    assert_ok(give(s.controls, "/w.1011.exr", 1), &error);
    expect_refused(&s, give(s.controls, "/w.1012.exr", 1), SKINSLIDE_BAD_CONTROL,
                   "weightMap: ./w.1002.exr: there is no such file, and the patch has texture coordinates in it");
    end_scene(&s);
}

static void files_that_cannot_be_read(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
    file.path = "/w.exr";
    ask(s.controls, "weightMap", "w.exr", 1);
    expect_refused(&s, skinslide_stage_controls_give(s.controls, &file, &error), SKINSLIDE_BAD_CONTROL,
                   "weightMap: /w.exr: cannot be read");
    ask(s.controls, "weightMap", "w.exr", 1);
    file.reason = "the disk is on fire";
    expect_refused(&s, skinslide_stage_controls_give(s.controls, &file, &error), SKINSLIDE_BAD_CONTROL,
                   "weightMap: /w.exr: cannot be read: the disk is on fire");
    ask(s.controls, "weightMap", "w.exr", 1);
    file.byte_count = needed(s.controls)->largest + 1;
    expect_refused(&s, skinslide_stage_controls_give(s.controls, &file, &error), SKINSLIDE_BAD_CONTROL,
                   "weightMap: /w.exr: has 4294967297 bytes; more than 4294967296 are refused");
    ask(s.controls, "weightMap", "w.exr", 1);
    file.byte_count = 4, file.bytes = (const uint8_t *)"\x89PNG", file.reason = NULL;
    expect_refused(&s, skinslide_stage_controls_give(s.controls, &file, &error), SKINSLIDE_BAD_IMAGE,
                   "weightMap: /w.exr: not an OpenEXR file...");
    end_scene(&s);
}

static void values_that_cannot_be(void **state) {
    (void)state;
    patch_scene s = set_up();
    ask(s.controls, "weightMap", "w.exr", 1);
    expect_refused(&s, give(s.controls, "/w.exr", NAN), SKINSLIDE_BAD_CONTROL, "weightMap: /w.exr: the map is nan at st...");
    assert_ok(controls_take(s.controls, "weightMap", nothing_of(MAP), &error), &error);
    ask(s.controls, "forceDensityMap", "q.exr", 1);
    assert_fails(give(s.controls, "/q.exr", -2), &error, SKINSLIDE_BAD_CONTROL,
                 "forceDensityMap: /q.exr at point 0 is -2; it must be finite and above 0");
    end_scene(&s);
}

static void products_that_cannot_be(void **state) {
    (void)state;
    patch_scene s = set_up();
    skinslide_controls out = SKINSLIDE_CONTROLS_DEFAULT;
    const float numbers[9] = {1, 1, 1, 1, 1e30f, 1, 1, 1, 1};
    ask(s.controls, "forceDensityMap", "q.exr", 1);
    assert_ok(give(s.controls, "/q.exr", 1e30f), &error);
    skinslide_value paint = painted_as(array_of(DENSITY, SKINSLIDE_VALUE_FLOAT, 1, 9, numbers), "vertex");
    assert_ok(controls_take(s.controls, "forceDensity", paint, &error), &error);
    assert_fails(skinslide_stage_controls_get(s.controls, &out, &error), &error, SKINSLIDE_BAD_CONTROL,
                 DENSITY " times forceDensityMap: /q.exr at point 4 is inf; it must be finite and above 0");
    end_scene(&s);
}

/* Primvars that could be coordinates are listed, and no others, in the order in which they are offered. */
static void coordinates_that_there_are_are_listed(void **state) {
    (void)state;
    static const char *const offers[][3] = {{"primvars:map1", "texCoord2f[]", "faceVarying"},
                                            {"primvars:width", "float[]", "vertex"},
                                            {"primvars:flow", "float2[]", "varying"},
                                            {"primvars:one", "texCoord2f[]", "uniform"},
                                            {"primvars:none", "texCoord2f[]", NULL}};
    test_mesh grid = quad_grid(1, 1);
    skinslide_stage_mesh *mesh = scene_mesh(&grid);
    assert_string_equal(skinslide_stage_mesh_coordinates(mesh), "");
    for (size_t i = 0; i < sizeof offers / sizeof *offers; i++)
        assert_ok(skinslide_stage_mesh_offer(mesh, offers[i][0], offers[i][1], offers[i][2], &error), &error);
    assert_string_equal(skinslide_stage_mesh_coordinates(mesh), "primvars:map1, primvars:flow");
    assert_fails(skinslide_stage_mesh_offer(NULL, "primvars:st", "texCoord2f[]", NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no mesh, or no name or type of what it has");
    assert_string_equal(skinslide_stage_mesh_coordinates(NULL), "");
    skinslide_stage_mesh_destroy(mesh);
    free_mesh(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_texture_asks_for_nothing),
        cmocka_unit_test(a_texture_alone_is_the_weight),
        cmocka_unit_test(textures_multiply_paint),
        cmocka_unit_test(tiles_are_asked_for_in_turn),
        cmocka_unit_test(coordinates_of_another_name),
        cmocka_unit_test(a_channel_of_its_own),
        cmocka_unit_test(a_frame_multiplies_the_texture_of_its_base),
        cmocka_unit_test(images_are_held_between_frames),
        cmocka_unit_test(other_coordinates_ask_for_files_again),
        cmocka_unit_test(a_frame_moves_the_texture_of_its_base),
        cmocka_unit_test(a_frame_takes_one_texture_of_two),
        cmocka_unit_test(assets_of_another_type),
        cmocka_unit_test(no_coordinates),
        cmocka_unit_test(coordinates_matter_where_there_is_a_map),
        cmocka_unit_test(no_such_file),
        cmocka_unit_test(files_that_cannot_be_read),
        cmocka_unit_test(values_that_cannot_be),
        cmocka_unit_test(coordinates_that_there_are_are_listed),
        cmocka_unit_test(products_that_cannot_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
