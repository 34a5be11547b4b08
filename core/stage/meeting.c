/* Where other meshes meet a patch: where they have points in the same places at the first time. Borders stay there, so that no
 * crack opens. */
#include "mesh.h"
#include "stage.h"

#include <string.h>

skinslide_bool skinslide_stage_patch_wants_neighbours(const skinslide_stage_patch *patch) {
    return patch && patch->mesh->weld != 0 && patch->faces.count && patch->taken[SS_ROW_HOLES].choice != SKINSLIDE_HOLES_PINNED;
}

/* points and met are [vertices.count] of the patch. A mesh that meets all of them is a copy of it, such as a proxy, and holds
 * none. */
static void hold(const skinslide_stage_patch *patch, const float *points, const uint8_t *met, uint8_t *held) {
    bool all = true;
    for (int32_t i = 0; i < patch->vertices.count; i++)
        all = all && (met[i] || !ss_is_finite(points + 3 * (int64_t)i));
    for (int32_t i = 0; i < patch->vertices.count && !all; i++)
        held[((const int32_t *)patch->vertices.values)[i]] |= met[i];
}

skinslide_status skinslide_stage_patch_meet(skinslide_stage_patch *patch, const float *others, int32_t count,
                                            skinslide_error *error) {
    if (!patch || count < 0 || (count > 0 && !others) || !patch->faces.count)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch with faces, no points, or a negative count of them");
    const skinslide_stage_mesh *mesh = patch->mesh;
    int64_t most = (int64_t)mesh->vertex_count + count;
    if (most > INT32_MAX)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "two meshes have %lld points, and may have %d", (long long)most,
                       INT32_MAX);
    ss_memory scratch = {0};
    float *points = SS_NEW(&scratch, float, 3 * (int64_t)patch->vertices.count);
    uint8_t *met = SS_NEW(&scratch, uint8_t, patch->vertices.count);
    uint8_t *held = patch->held ? patch->held : SS_NEW(&patch->memory, uint8_t, mesh->vertex_count);
    bool done = held && !scratch.failed;
    for (int32_t i = 0; i < patch->vertices.count && done; i++)
        memcpy(points + 3 * (int64_t)i, mesh->first + 3 * (int64_t)((const int32_t *)patch->vertices.values)[i],
               sizeof(float[3]));
    done = done && ss_find_met(points, patch->vertices.count, others, count, mesh->weld_tolerance, met);
    if (done)
        hold(patch, points, met, held), patch->held = held;
    ss_free(&scratch);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}
