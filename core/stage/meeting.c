/* Where other meshes meet a patch: points of theirs in the place of its own, at first. Borders stay there, so that nothing cracks. */
#include "mesh.h"
#include "stage.h"

#include <math.h>
#include <string.h>

skinslide_bool skinslide_stage_patch_wants_neighbours(const skinslide_stage_patch *patch) {
    return patch && patch->mesh->weld != 0 && patch->faces.count && patch->taken[SS_ROW_HOLES].choice != SKINSLIDE_HOLES_PINNED;
}

/* Points of the patch, then of another mesh, those that are finite; and the place of each. */
typedef struct meeting {
    ss_memory memory;
    int32_t own_count, count;
    float *points;
    int32_t *vertex; /* [own_count] of the mesh */
    int32_t *place;
    uint8_t *others; /* [count] by place: another mesh has a point there */
} meeting;

static void add(meeting *own, const float *point) {
    if (isfinite(point[0]) && isfinite(point[1]) && isfinite(point[2]))
        memcpy(own->points + 3 * (int64_t)own->count++, point, sizeof(float[3]));
}

/* False where memory is short. */
static bool meet(meeting *own, const skinslide_stage_patch *patch, const float *others, int32_t count) {
    const skinslide_stage_mesh *mesh = patch->mesh;
    for (int32_t i = 0; i < patch->vertices.count; i++) {
        int32_t v = ((const int32_t *)patch->vertices.values)[i];
        add(own, mesh->first + 3 * (int64_t)v);
        if (own->count > own->own_count)
            own->vertex[own->own_count++] = v;
    }
    for (int32_t v = 0; v < count; v++)
        add(own, others + 3 * (int64_t)v);
    if (!ss_find_places(own->points, mesh->weld_tolerance, own->count, own->place))
        return false;
    for (int32_t i = own->own_count; i < own->count; i++)
        own->others[own->place[i]] = 1;
    return true;
}

/* One that has a point at each of the patch is a copy of it, such as a proxy, and holds nothing. */
static void hold(const meeting *own, uint8_t *held) {
    int32_t met = 0;
    for (int32_t i = 0; i < own->own_count; i++)
        met += own->others[own->place[i]];
    for (int32_t i = 0; i < own->own_count && met < own->own_count; i++)
        held[own->vertex[i]] |= own->others[own->place[i]];
}

skinslide_status skinslide_stage_patch_meet(skinslide_stage_patch *patch, const float *others, int32_t count,
                                            skinslide_error *error) {
    if (!patch || count < 0 || (count > 0 && !others) || !patch->faces.count)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch with faces, no points, or a negative count of them");
    int64_t most = (int64_t)patch->mesh->vertex_count + count;
    if (most > INT32_MAX)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "two meshes have %lld points, and may have %d", (long long)most,
                       INT32_MAX);
    meeting own = {0};
    most = (int64_t)patch->vertices.count + count;
    own.points = SS_NEW(&own.memory, float, 3 * most);
    own.vertex = SS_NEW(&own.memory, int32_t, patch->vertices.count);
    own.place = SS_NEW(&own.memory, int32_t, most);
    own.others = SS_NEW(&own.memory, uint8_t, most);
    uint8_t *held = patch->held ? patch->held : SS_NEW(&patch->memory, uint8_t, patch->mesh->vertex_count);
    bool done = held && !own.memory.failed && meet(&own, patch, others, count);
    if (done)
        hold(&own, held), patch->held = held;
    ss_free(&own.memory);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}
