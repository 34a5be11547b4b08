/* What a texture proposes is only a help: whatever faces it names, each vertex is found where it is found without. */
#include "queries.h"

#include <stdlib.h>
#include <string.h>

/* Proposes nothing, any faces, or for half of the queries a face that holds them, which is often not the lowest that does. */
static void propose(const ss_patch *patch, const double (*uv)[2], const double query[2], dice *d, ss_candidates out) {
    const ss_faces *faces = &patch->faces;
    for (int k = 0; k < SS_CANDIDATES; k++)
        out[k] = roll_below(d, 8) ? roll_below(d, faces->face_count) : -1;
    int32_t first = roll_below(d, faces->face_count);
    for (int32_t i = 0; i < faces->face_count && roll_below(d, 2) == 0; i++) {
        int32_t face = (first + i) % faces->face_count;
        if (ss_triangle_holding(patch, face, uv, query) < 0)
            continue;
        out[roll_below(d, SS_CANDIDATES)] = face;
        break;
    }
}

static void compare(const ss_patch *patch, const double (*uv)[2], dice *d) {
    size_t count = (size_t)patch->free_count + 1;
    double(*queries)[2] = malloc(count * sizeof *queries);
    ss_place *without = calloc(count, sizeof *without), *with = calloc(count, sizeof *with);
    ss_candidates *candidates = calloc(count, sizeof *candidates);
    ss_locator *locator = NULL;
    skinslide_error error;
    bool regular = ss_lay_out(patch, uv).regular;
    for (int32_t i = 0; i < patch->free_count; i++) {
        random_query(&patch->faces, uv, d, queries[i]);
        propose(patch, uv, queries[i], d, candidates[i]);
    }
    assert_ok(ss_locator_create(patch, &locator, &error), &error);
    ss_located a = ss_locate(locator, uv, regular, (const double(*)[2])queries, NULL, without);
    ss_located b = ss_locate(locator, uv, regular, (const double(*)[2])queries, (const ss_candidates *)candidates, with);
    for (int32_t i = 0; i < patch->free_count; i++)
        assert_same_place(&with[i], &without[i]);
    assert_int_equal(a.centre + a.around, 0);
    assert_int_equal(a.walked + a.searched, b.centre + b.around + b.walked + b.searched);
    assert_int_equal(a.clamped, b.clamped);
    assert_true(regular || b.centre + b.around == 0);
    ss_locator_destroy(locator);
    free(queries), free(without), free(with), free(candidates);
}

static void any_candidates_give_the_same(void **state) {
    (void)state;
    dice d = {1};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int32_t round = 0; round < 40; round++) {
            fixture f = make_fixture(i);
            ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){0});
            float *pose = random_pose(&f.mesh, (uint64_t)round);
            double(*uv)[2] = round % 8 == 7 ? tangled(patch, (uint64_t)round) : embedding_of(patch, f.mesh.points, pose);
            compare(patch, (const double(*)[2])uv, &d);
            free(uv), free(pose);
            ss_patch_destroy(patch);
            free_mesh(&f.mesh);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(any_candidates_give_the_same)};
    return cmocka_run_group_tests_name("candidates", tests, NULL, NULL);
}
