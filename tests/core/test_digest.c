/* The bytes that come out, as recorded in digests.txt: of slid points, and of what a slide did, a line for each fixture, rule
 * and interpolation, over boundaries, holes, poses and paint. Where a change means to change them: test_digest --record */
#include "support.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POSES = 3, LINE = 128 };

static const char *const rules[] = {"unit", "fast", "relaxed", "even"};
static const char *const interpolations[] = {"linear", "meanValue", "limit"};
static const skinslide_interpolation interpolation_values[] = {
    SKINSLIDE_INTERPOLATION_LINEAR, SKINSLIDE_INTERPOLATION_MEAN_VALUE, SKINSLIDE_INTERPOLATION_LIMIT};

/* FNV-1a. */
static void take(uint64_t *digest, const void *bytes, size_t size) {
    for (size_t i = 0; i < size; i++)
        *digest = (*digest ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001b3);
}

static void take_pose(uint64_t *digest, const rig *r, const test_mesh *mesh, uint64_t seed,
                      const skinslide_controls *controls) {
    skinslide_error error;
    float *points = random_pose(mesh, seed), *slid = slide_with(r, mesh, points, controls, NULL);
    size_t size = (size_t)mesh->vertex_count * sizeof(float);
    float *stretch = malloc(size), *slide = malloc(size);
    skinslide_diagnostics diagnostics = {.size = sizeof(skinslide_diagnostics), .stretch_after = stretch, .slide = slide};
    assert_ok(skinslide_diagnose(r->slider, controls, NULL, points, slid, &diagnostics, &error), &error);
    take(digest, slid, 3 * size);
    take(digest, stretch, size);
    take(digest, slide, size);
    free(points), free(slid), free(stretch), free(slide);
}

static void take_way(uint64_t *digest, const fixture *f, skinslide_patch_setup choices) {
    static const skinslide_subdivision catmull_clark = {.size = sizeof(skinslide_subdivision),
                                                        .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    int32_t *faces = all_faces(&f->mesh);
    choices.name = "all", choices.faces = faces, choices.face_count = f->mesh.face_count;
    skinslide_mesh view = view_of(&f->mesh);
    view.subdivision = &catmull_clark;
    rig r = {NULL, NULL};
    skinslide_error error;
    assert_ok(skinslide_slider_create(&view, &choices, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    for (uint64_t seed = 0; seed < POSES; seed++) {
        painted p = paint_at_random(&f->mesh, seed);
        take_pose(digest, &r, &f->mesh, seed, NULL);
        take_pose(digest, &r, &f->mesh, seed, &p.controls);
        free_painted(&p);
    }
    free_rig(&r);
    free(faces);
}

/* Over both boundaries and both ways with holes, where the fixture can have them. */
static uint64_t digest_of(const fixture *f, int rule, int interpolation) {
    uint64_t digest = UINT64_C(0xcbf29ce484222325);
    for (int32_t way = 0; way < 4; way++) {
        skinslide_patch_setup choices = SKINSLIDE_PATCH_SETUP_DEFAULT;
        if (!choose_way(f, way, &choices))
            continue;
        choices.rule = (skinslide_rule)rule;
        choices.interpolation = interpolation_values[interpolation];
        take_way(&digest, f, choices);
    }
    return digest;
}

/* Writes a line, or tells whether it is the file's next. */
static bool settle(FILE *file, bool record, const char *line) {
    char recorded[LINE] = "nothing\n";
    if (record)
        return fputs(line, file) >= 0;
    if (fgets(recorded, LINE, file) && strcmp(recorded, line) == 0)
        return true;
    print_error("was %sis  %s", recorded, line);
    return false;
}

static int settle_fixture(FILE *file, bool record, const fixture *f) {
    int differ = 0;
    for (int rule = 0; rule < 4; rule++)
        for (int interpolation = 0; interpolation < 3; interpolation++) {
            char line[LINE];
            snprintf(line, LINE, "%s | %s %s | %016" PRIx64 "\n", f->name, rules[rule], interpolations[interpolation],
                     digest_of(f, rule, interpolation));
            differ += !settle(file, record, line);
        }
    return differ;
}

static void every_byte_is_as_recorded(void **state) {
    const bool record = *(bool *)*state;
    int differ = 0;
    FILE *file = fopen(DIGESTS, record ? "w" : "r");
    assert_non_null(file);
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        differ += settle_fixture(file, record, &f);
        free_mesh(&f.mesh);
    }
    assert_true(record || fgetc(file) == EOF);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(differ, 0);
}

int main(int argc, char **argv) {
    bool record = argc == 2 && strcmp(argv[1], "--record") == 0;
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(every_byte_is_as_recorded, &record)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
