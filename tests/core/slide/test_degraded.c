/* What a frame is less by: what its result counts, whether it was measured or not, in words. */
#include "support.h"

#include <stdlib.h>
#include <string.h>

static skinslide_error warning;

static int32_t count_of(const skinslide_patch_result *result, const char *member) {
    return strcmp(member, "clamped_vertices") == 0    ? result->clamped_vertices
           : strcmp(member, "clamped_weights") == 0   ? result->clamped_weights
           : strcmp(member, "damped_vertices") == 0   ? result->damped_vertices
           : strcmp(member, "folded_faces") == 0      ? result->folded_faces
           : strcmp(member, "zero_length_edges") == 0 ? result->zero_length_edges
           : strcmp(member, "lost_textures") == 0     ? result->lost_textures
                                                      : -2;
}

static int32_t kind_count(void) {
    int32_t count = 0;
    while (skinslide_degradation(count, 0, NULL))
        count++;
    return count;
}

/* Two pieces under a rule, posed by chance with a row in one place, with weights out of range. */
static void a_result_says_the_same(void **state) {
    (void)state;
    static const skinslide_rule rules[] = {SKINSLIDE_RULE_UNIT, SKINSLIDE_RULE_EVEN, SKINSLIDE_RULE_RELAXED};
    test_mesh sheet = grid_with_holes(false), mesh = join_meshes(&sheet, &sheet);
    int32_t seen[16] = {0};
    for (int32_t v = mesh.vertex_count / 2; v < mesh.vertex_count; v++)
        mesh.points[3 * v + 2] += 40;
    for (uint64_t seed = 0; seed < 12; seed++) {
        skinslide_patch_setup setup = setup_of(NULL, 0);
        skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
        skinslide_patch_result results[2] = {SKINSLIDE_PATCH_RESULT_DEFAULT, SKINSLIDE_PATCH_RESULT_DEFAULT};
        setup.rule = rules[seed % 3], controls.envelope = seed % 2 ? 3 : 1, setup.controls = &controls;
        rig r = rig_of(&mesh, setup);
        assert_int_equal(skinslide_workspace_degraded(r.workspace, 0, 0, &warning), -1);
        float *points = shaken(&mesh, seed, 4);
        for (int32_t v = 0; v < 4; v++)
            memcpy(points + 3 * v, points, sizeof(float[3]));
        float *measured = slide_with(&r, &mesh, points, NULL, results), *slid = slide_with(&r, &mesh, points, NULL, NULL);
        assert_same_bytes(measured, slid, POINT_BYTES(&mesh));
        for (int32_t patch = 0; patch < 2; patch++)
            for (int32_t kind = 0; kind < kind_count(); kind++) {
                skinslide_error words;
                int32_t count = count_of(&results[patch], skinslide_degradation(kind, 0, NULL));
                assert_int_equal(skinslide_workspace_degraded(r.workspace, patch, kind, &warning), count);
                seen[kind] += count;
                skinslide_degradation(kind, count, &words);
                assert_true(count == 0 || strstr(warning.message, words.message) != NULL);
            }
        assert_int_equal(skinslide_workspace_degraded(r.workspace, 2, 0, NULL), -1);
        assert_int_equal(skinslide_workspace_degraded(r.workspace, -1, 0, NULL), -1);
        assert_int_equal(skinslide_workspace_degraded(r.workspace, 0, kind_count(), NULL), -1);
        assert_int_equal(skinslide_workspace_degraded(r.workspace, 0, -1, NULL), -1);
        free(points), free(measured), free(slid);
        free_rig(&r);
    }
    for (int32_t kind = 0; kind < kind_count(); kind++)
        print_message("%s: %d\n", skinslide_degradation(kind, 0, NULL), seen[kind]);
    assert_true(seen[1] > 0 && seen[4] > 0);
    free_mesh(&sheet), free_mesh(&mesh);
}

static void words_and_pieces(void **state) {
    (void)state;
    skinslide_degradation(3, 1, &warning);
    assert_string_equal(warning.message, "1 face turned over in the embedding");
    skinslide_degradation(3, 2, &warning);
    assert_string_equal(warning.message, "2 faces turned over in the embedding");
    assert_null(skinslide_degradation(-1, 1, &warning));
    assert_int_equal(skinslide_workspace_degraded(NULL, 0, 0, &warning), -1);
    test_mesh sheet = quad_grid(4, 4), mesh = join_meshes(&sheet, &sheet);
    skinslide_patch_setup setup = setup_of(NULL, 0);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    controls.envelope = -1, setup.controls = &controls;
    rig r = rig_of(&mesh, setup);
    float *slid = slide_with(&r, &mesh, mesh.points, NULL, NULL);
    assert_int_equal(skinslide_workspace_degraded(r.workspace, 1, 1, &warning), 1);
    assert_string_equal(warning.message, "patch all (piece 2 of 2): 1 weight or envelope outside 0..1, clamped");
    free(slid);
    free_rig(&r);
    free_mesh(&sheet), free_mesh(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_result_says_the_same), cmocka_unit_test(words_and_pieces)};
    return cmocka_run_group_tests_name("degraded", tests, NULL, NULL);
}
