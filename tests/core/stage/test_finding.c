/* Facts of a prim: its patches, why they cannot be slid, in the order in which reasons count, and names that are none. */
#include "records.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static skinslide_error error;

static skinslide_stage_prim mesh_with(int32_t schema_count, const char *const *schemas) {
    skinslide_stage_prim prim = SKINSLIDE_STAGE_PRIM_DEFAULT;
    prim.type_name = "Mesh", prim.is_mesh = 1, prim.is_defined = 1, prim.point_samples = 3;
    prim.schema_count = schema_count, prim.schemas = schemas;
    return prim;
}

#define WITH(...) mesh_with(sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *), (const char *[]){__VA_ARGS__})

static void has(skinslide_stage_prim *prim, int32_t count, const char *const *properties) {
    prim->property_count = count, prim->properties = properties;
}

#define HAS(prim, ...) has(prim, sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *), (const char *[]){__VA_ARGS__})

static skinslide_stage_finding *find(const skinslide_stage_prim *prim) {
    skinslide_stage_finding *finding = NULL;
    assert_ok(skinslide_stage_find(prim, &finding, &error), &error);
    return finding;
}

static void expect_problem(const skinslide_stage_finding *finding, int32_t number, skinslide_severity severity,
                           const char *patch, const char *message) {
    assert_true(number < finding->problem_count);
    const skinslide_stage_problem *problem = finding->problems[number];
    assert_int_equal(problem->severity, severity);
    assert_string_equal(problem->message, message);
    if (patch)
        assert_string_equal(problem->patch, patch);
    else
        assert_null(problem->patch);
}

static void patches_in_their_order(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("MaterialBindingAPI", "SkinSlideAPI:wrist", "SkinSlideMeshAPI", "SkinSlideAPI:left:elbow");
    skinslide_stage_finding *finding = find(&prim);
    assert_true(finding->slides && finding->patch_count == 2 && finding->problem_count == 0);
    assert_string_equal(finding->patches[0], "wrist");
    assert_string_equal(finding->patches[1], "left:elbow");
    skinslide_stage_finding_destroy(finding);
    prim = mesh_with(0, NULL);
    finding = find(&prim);
    assert_true(!finding->slides && finding->patch_count == 0 && finding->problem_count == 0);
    skinslide_stage_finding_destroy(finding);
}

#define SKINNED                                                                                                                \
    "points are skinned by UsdSkel, which a .skinslide file cannot do; bake the stage instead, or write the skinned points "   \
    "into a layer to sublayer: skinslide cache STAGE -o cache.usdc"

/* Facts are taken away one by one, from the reason that counts first to none. */
static void reasons_in_the_order_in_which_they_count(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
    static const char *const said[] = {
        "is inside an instance, whose points are shared; author instanceable = false on /copy",
        "is a prototype of the point instancer /crowd, whose instances share its points; slide a mesh outside it, or put the "
        "baked mesh in its place",
        "is not defined, there are only overs; is the path right, and does the cache below it open?",
        "is a Xform; SkinSlideAPI applies to Mesh only",
        "is a prim without a type; SkinSlideAPI applies to Mesh only",
        "is slid already, by x.skinslide; bake that file, or put the cache in its place",
        "points are slid already, by the bake in out.usdc; slide the cache instead: open the stage without that layer, or "
        "remove "
        "the baked attributes from it",
        SKINNED,
        SKINNED,
    };
    prim.instance = "/copy", prim.instancer = "/crowd", prim.is_defined = 0, prim.is_mesh = 0, prim.type_name = "Xform";
    prim.slid_by = "x.skinslide", prim.baked_by = "out.usdc", prim.point_samples = 0, prim.has_joint_indices = 1;
    prim.has_joint_weights = 1, prim.blend_shape_count = 2, prim.skel_root = "/char", prim.skeleton = "/char/rig";
    for (int32_t step = 0; step < 9; step++) {
        skinslide_stage_finding *finding = find(&prim);
        assert_false(finding->slides);
        assert_int_equal(finding->problem_count, 1);
        expect_problem(finding, 0, step == 5 ? SKINSLIDE_SEVERITY_WARNING : SKINSLIDE_SEVERITY_ERROR, NULL, said[step]);
        skinslide_stage_finding_destroy(finding);
        prim.instance = step >= 0 ? NULL : prim.instance;
        prim.instancer = step >= 1 ? NULL : prim.instancer;
        prim.is_defined = step >= 2;
        prim.type_name = step >= 3 ? NULL : prim.type_name;
        prim.is_mesh = step >= 4;
        prim.slid_by = step >= 5 ? NULL : prim.slid_by;
        prim.baked_by = step >= 6 ? NULL : prim.baked_by;
        prim.has_joint_indices = step < 7;
        prim.blend_shape_count = step < 8;
    }
    skinslide_stage_finding *finding = find(&prim);
    assert_true(finding->slides && finding->problem_count == 0);
    skinslide_stage_finding_destroy(finding);
}

/* What is bound by a skeleton, below a SkelRoot, by joints and weights or by blend shapes; any less, and it is not. */
static void what_is_skinned(void **state) {
    (void)state;
    static const char *const reasons[] = {NULL, "UsdSkel does not skin it: there is no SkelRoot above it",
                                          "UsdSkel does not skin it: no Skeleton is bound to it below the SkelRoot",
                                          "UsdSkel does not skin it: its joint indices have no weights"};
    for (int32_t lacking = 0; lacking < 4; lacking++)
        for (int32_t samples = 0; samples < 2; samples++) {
            skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
            prim.point_samples = samples, prim.reads_skinning = 1, prim.has_joint_indices = 1;
            prim.skel_root = lacking == 1 ? NULL : "/char", prim.skeleton = lacking == 2 ? NULL : "/char/rig";
            prim.has_joint_weights = lacking != 3;
            skinslide_stage_finding *finding = find(&prim);
            const char *said =
                lacking   ? (samples ? NULL : reasons[lacking])
                : samples ? "points have samples, but UsdSkel skins them again; remove the skinning where they are baked"
                          : NULL;
            assert_true(finding->slides);
            if (lacking)
                assert_null(finding->skinned_by);
            else
                assert_string_equal(finding->skinned_by, "/char/rig");
            assert_int_equal(finding->problem_count, said != NULL);
            if (said)
                expect_problem(finding, 0, SKINSLIDE_SEVERITY_WARNING, NULL, said);
            skinslide_stage_finding_destroy(finding);
            prim.blend_shape_count = 1, finding = find(&prim);
            assert_true((finding->skinned_by != NULL) == (lacking == 0 || lacking == 3));
            skinslide_stage_finding_destroy(finding);
        }
}

/* Without a patch there is nothing to say, but it is known. */
static void what_is_skinned_without_a_patch(void **state) {
    (void)state;
    skinslide_stage_prim prim = mesh_with(0, NULL);
    prim.blend_shape_count = 1, prim.skel_root = "/char", prim.skeleton = "/char/rig";
    skinslide_stage_finding *finding = find(&prim);
    assert_string_equal(finding->skinned_by, "/char/rig");
    assert_int_equal(finding->problem_count, 0);
    skinslide_stage_finding_destroy(finding);
}

static void a_schema_without_a_name_is_an_error(void **state) {
    (void)state;
    static const char *const bare[] = {"SkinSlideAPI", "SkinSlideAPI:"};
    for (int i = 0; i < 2; i++) {
        skinslide_stage_prim prim = WITH(bare[i], "SkinSlideAPI:elbow");
        skinslide_stage_finding *finding = find(&prim);
        assert_int_equal(finding->patch_count, 1);
        assert_false(finding->slides);
        expect_problem(finding, 0, SKINSLIDE_SEVERITY_ERROR, NULL,
                       "SkinSlideAPI is applied without a patch's name; apply SkinSlideAPI:NAME");
        skinslide_stage_finding_destroy(finding);
    }
}

static void patches_that_are_not_applied(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
    HAS(&prim, "skinSlide:wrist:envelope", "primvars:skinSlide:wrist:weight:indices", "primvars:skinSlide:ankle:patch",
        "skinSlide:elbow:envelope", "skinSlide:restPoints", "skinSlide:live:envelope", "skinSlide:cached:points",
        "skinSlide:cached:primvars:normals", "primvars:skinSlide:stretch", "skinSlide:", "points", "primvars:st");
    skinslide_stage_finding *finding = find(&prim);
    assert_int_equal(finding->problem_count, 2);
    expect_problem(finding, 0, SKINSLIDE_SEVERITY_WARNING, "ankle",
                   "has properties, but SkinSlideAPI:ankle is not applied to the prim, so it does not slide");
    expect_problem(finding, 1, SKINSLIDE_SEVERITY_WARNING, "wrist",
                   "has properties, but SkinSlideAPI:wrist is not applied to the prim, so it does not slide");
    skinslide_stage_finding_destroy(finding);
    prim.is_mesh = 0; /* whose properties nobody expects to count */
    finding = find(&prim);
    assert_int_equal(finding->problem_count, 1);
    skinslide_stage_finding_destroy(finding);
}

static void settings_that_are_none(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow", "SkinSlideAPI:elbow:inner");
    HAS(&prim, "skinSlide:elbow:envelop", "skinSlide:elbow:weight", "primvars:skinSlide:elbow:weight",
        "primvars:skinSlide:elbow:weight:indices", "primvars:skinSlide:elbow:envelope", "skinSlide:elbow:inner:envelope",
        "skinSlide:elbow:inner:nothing", "skinSlide:elbow:holes");
    skinslide_stage_finding *finding = find(&prim);
    assert_true(finding->slides);
    assert_int_equal(finding->problem_count, 4);
    expect_problem(finding, 0, SKINSLIDE_SEVERITY_WARNING, "elbow",
                   "skinSlide:elbow:envelop is not a setting of a patch, and has no effect");
    expect_problem(finding, 1, SKINSLIDE_SEVERITY_WARNING, "elbow",
                   "skinSlide:elbow:weight is not a setting of a patch, and has no effect");
    expect_problem(finding, 2, SKINSLIDE_SEVERITY_WARNING, "elbow",
                   "primvars:skinSlide:elbow:envelope is not a setting of a patch, and has no effect");
    expect_problem(finding, 3, SKINSLIDE_SEVERITY_WARNING, "elbow:inner",
                   "skinSlide:elbow:inner:nothing is not a setting of a patch, and has no effect");
    skinslide_stage_finding_destroy(finding);
}

#define NO_PAINT "is not paint of an applied patch, and has no effect"
#define CASE     "is paint in another case, and has no effect unless skinSlide:foldCase is on"

/* Paint under names of tools without namespaces, or without case. Primvars that a bake writes are not paint. */
static void paint_that_counts_for_nothing(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow_L", "SkinSlideAPI:left:knee");
    HAS(&prim, "primvars:skinSlide_elbow_L_weight", "primvars:skinSlide_elbow_L_weight:indices",
        "primvars:skinSlide:left_knee:patch", "primvars:skinSlide_stretch", "primvars:skinSlide:areaRatio",
        "primvars:skinSlide_elbow_L_wieght", "primvars:skinSlide_elbow_L_wieght:indices", "primvars:SKINSLIDE:ankle_weight",
        "primvars:skinslide_elbow_l_hold", "primvars:skinslide_elbow_l_hold:indices", "primvars:skinSlide:elbow_l:weight",
        "primvars:st", "primvars:skin", "skinslide_elbow_l_weight");
    skinslide_stage_finding *finding = find(&prim);
    assert_true(finding->slides);
    assert_int_equal(finding->problem_count, 4);
    expect_problem(finding, 0, SKINSLIDE_SEVERITY_WARNING, NULL, "primvars:SKINSLIDE:ankle_weight " NO_PAINT);
    expect_problem(finding, 1, SKINSLIDE_SEVERITY_WARNING, "elbow_L", "primvars:skinslide_elbow_l_hold " CASE);
    expect_problem(finding, 2, SKINSLIDE_SEVERITY_WARNING, "elbow_L", "primvars:skinSlide:elbow_l:weight " CASE);
    expect_problem(finding, 3, SKINSLIDE_SEVERITY_WARNING, NULL, "primvars:skinSlide_elbow_L_wieght " NO_PAINT);
    skinslide_stage_finding_destroy(finding);
}

/* Where the mesh says whether case counts, there is nothing to say; of patches that differ in case each has its own. */
static void paint_in_another_case(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow_L", "SkinSlideAPI:ELBOW_L");
    HAS(&prim, "skinSlide:foldCase", "primvars:skinslide_elbow_l_weight", "primvars:skinSlide:elbow_l:patch:indices",
        "primvars:skinSlide:elbow_L:Hold", "primvars:skinSlide:ELBOW_L:weight");
    for (int32_t said = 1; said >= 0; said--) {
        prim.properties += !said, prim.property_count -= !said;
        skinslide_stage_finding *finding = find(&prim);
        assert_int_equal(finding->problem_count, said ? 0 : 2);
        skinslide_stage_finding_destroy(finding);
    }
}

/* Every input is a setting, so that none is warned of. */
static void every_input_is_a_setting(void **state) {
    (void)state;
    static const skinslide_stage_group groups[] = {SKINSLIDE_STAGE_PATCH, SKINSLIDE_STAGE_CONTROLS};
    for (int g = 0; g < 2; g++) {
        const skinslide_stage_input *input = NULL;
        while ((input = skinslide_stage_next_input(groups[g], input)) != NULL) {
            char name[128];
            const char *property = name;
            snprintf(name, sizeof name, "%selbow:%s", input->prefix, input->name);
            skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
            has(&prim, 1, &property);
            skinslide_stage_finding *finding = find(&prim);
            assert_int_equal(finding->problem_count, 0);
            skinslide_stage_finding_destroy(finding);
        }
    }
}

/* Any number of problems, and names of any length. */
static void many_and_long_names(void **state) {
    (void)state;
    enum { MANY = 300, LONG = 2000 };
    static char texts[MANY][LONG];
    static const char *properties[MANY];
    for (int i = 0; i < MANY; i++) {
        memset(texts[i], 'a' + i % 26, LONG - 1);
        memcpy(texts[i], "skinSlide:elbow:", 16);
        properties[i] = texts[i];
    }
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
    has(&prim, MANY, properties);
    skinslide_stage_finding *finding = find(&prim);
    assert_int_equal(finding->problem_count, MANY);
    assert_true(strlen(finding->problems[MANY - 1]->message) > LONG);
    skinslide_stage_finding_destroy(finding);
}

/* Names of two letters, so that patches lie within patches, and properties deeper than settings do. */
static void name_at_random(dice *d, char *name) {
    for (int32_t left = 1 + roll_below(d, 3); left > 0; left--)
        strcat(strcat(name, roll_below(d, 2) ? "a" : "b"), left > 1 ? ":" : "");
}

/* Whether text is before, a colon, and more. */
static bool is_inside(const char *text, const char *before, const char **more) {
    size_t length = strlen(before);
    *more = text + length + 1;
    return strncmp(text, before, length) == 0 && text[length] == ':';
}

enum { SOME = 6 };

static bool is_stray(const char *property, const char *patch, char patches[SOME][32]) {
    const char *within, *more;
    if (!is_inside(property, "skinSlide", &within) || !is_inside(within, patch, &more))
        return false;
    for (int i = 0; i < SOME; i++) {
        const char *of_it;
        if (is_inside(within, patches[i], &of_it) && !strchr(of_it, ':') && strcmp(patches[i], patch) != 0)
            return false;
    }
    return strcmp(more, "envelope") != 0;
}

/* Compares with the definition, patch by patch, for random names. */
static void strays_are_those_of_each_patch(void **state) {
    (void)state;
    dice d = {1};
    int32_t all = 0;
    for (int round = 0; round < 200; round++) {
        char names[SOME][32] = {""}, schemas[SOME][64], texts[4 * SOME][64];
        const char *applied[SOME], *properties[4 * SOME];
        for (int i = 0; i < SOME; i++) {
            name_at_random(&d, names[i]);
            snprintf(schemas[i], sizeof schemas[i], "SkinSlideAPI:%s", names[i]);
            applied[i] = schemas[i];
        }
        for (int i = 0; i < 4 * SOME; i++) {
            strcpy(texts[i], "skinSlide:");
            name_at_random(&d, texts[i]);
            strcat(texts[i], roll_below(&d, 2) ? ":envelope" : ":stray");
            properties[i] = texts[i];
        }
        skinslide_stage_prim prim = mesh_with(SOME, applied);
        has(&prim, 4 * SOME, properties);
        skinslide_stage_finding *finding = find(&prim);
        int32_t next = 0;
        while (next < finding->problem_count && !strstr(finding->problems[next]->message, "is not a setting of a patch"))
            next++;
        for (int p = 0; p < SOME; p++)
            for (int i = 0; i < 4 * SOME; i++) {
                char message[1600];
                if (!is_stray(texts[i], names[p], names))
                    continue;
                snprintf(message, sizeof message, "%s is not a setting of a patch, and has no effect", texts[i]);
                expect_problem(finding, next++, SKINSLIDE_SEVERITY_WARNING, names[p], message);
                all++;
            }
        assert_int_equal(next, finding->problem_count);
        skinslide_stage_finding_destroy(finding);
    }
    assert_in_range(all, 200, 100000);
}

/* So many patches that comparing each with each would not end. */
static void patches_without_number(void **state) {
    (void)state;
    enum { MANY = 100000 };
    char(*schemas)[32] = calloc(MANY, sizeof *schemas), (*texts)[32] = calloc(2 * MANY, sizeof *texts);
    const char **applied = calloc(MANY, sizeof *applied), **properties = calloc(2 * MANY, sizeof *properties);
    for (int32_t i = 0; i < MANY; i++) {
        snprintf(schemas[i], sizeof *schemas, "SkinSlideAPI:p%d", i);
        snprintf(texts[2 * i], sizeof *texts, "skinSlide:p%d:envelope", MANY - 1 - i);
        snprintf(texts[2 * i + 1], sizeof *texts, "skinSlide:p%d:stray", MANY - 1 - i);
        applied[i] = schemas[i], properties[2 * i] = texts[2 * i], properties[2 * i + 1] = texts[2 * i + 1];
    }
    skinslide_stage_prim prim = mesh_with(MANY, applied);
    has(&prim, 2 * MANY, properties);
    skinslide_stage_finding *finding = find(&prim);
    assert_int_equal(finding->patch_count, MANY);
    assert_int_equal(finding->problem_count, MANY);
    for (int32_t i = 0; i < MANY; i++)
        assert_string_equal(finding->problems[i]->patch, finding->patches[i]);
    skinslide_stage_finding_destroy(finding);
    free(schemas), free(texts), free(applied), free(properties);
}

static void what_could_not_be_composed_is_said(void **state) {
    (void)state;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
    prim.uncomposed = "Could not open asset @gone.usdc@";
    skinslide_stage_finding *finding = find(&prim);
    assert_true(finding->slides);
    expect_problem(finding, 0, SKINSLIDE_SEVERITY_ERROR, NULL, "USD could not compose this: Could not open asset @gone.usdc@");
    skinslide_stage_finding_destroy(finding);
}

static void facts_that_are_none(void **state) {
    (void)state;
    skinslide_stage_finding *finding = NULL;
    skinslide_stage_prim prim = WITH("SkinSlideAPI:elbow");
    prim.schema_count = -1;
    assert_int_equal(skinslide_stage_find(&prim, &finding, &error), SKINSLIDE_BAD_ARGUMENT);
    prim = mesh_with(1, NULL);
    assert_int_equal(skinslide_stage_find(&prim, &finding, &error), SKINSLIDE_BAD_ARGUMENT);
    prim.size = 0;
    assert_int_equal(skinslide_stage_find(&prim, &finding, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_find(NULL, &finding, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_null(finding);
    skinslide_stage_finding_destroy(NULL);
}

static void nothing_to_slide(void **state) {
    (void)state;
    assert_fails(skinslide_stage_nothing("on the stage", &error), &error, SKINSLIDE_BAD_PATCH,
                 "nothing to slide: no mesh on the stage has SkinSlideAPI applied");
    assert_fails(skinslide_stage_nothing(NULL, &error), &error, SKINSLIDE_BAD_PATCH,
                 "nothing to slide: no mesh has SkinSlideAPI applied");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patches_in_their_order),
        cmocka_unit_test(reasons_in_the_order_in_which_they_count),
        cmocka_unit_test(what_is_skinned),
        cmocka_unit_test(what_is_skinned_without_a_patch),
        cmocka_unit_test(a_schema_without_a_name_is_an_error),
        cmocka_unit_test(patches_that_are_not_applied),
        cmocka_unit_test(settings_that_are_none),
        cmocka_unit_test(paint_that_counts_for_nothing),
        cmocka_unit_test(paint_in_another_case),
        cmocka_unit_test(every_input_is_a_setting),
        cmocka_unit_test(many_and_long_names),
        cmocka_unit_test(strays_are_those_of_each_patch),
        cmocka_unit_test(patches_without_number),
        cmocka_unit_test(what_could_not_be_composed_is_said),
        cmocka_unit_test(facts_that_are_none),
        cmocka_unit_test(nothing_to_slide),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
