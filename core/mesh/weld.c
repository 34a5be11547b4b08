/* Which vertices of a mesh are one: points in one place, in every pose, whose faces meet there edge to edge.
 *
 * Places come first: sets of points that coincide at rest and in each pose shown. Then faces of the patches are sewn together
 * by sew.c. */
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

struct skinslide_weld {
    ss_memory memory;
    ss_seams seams; /* with the places of all poses so far */
    double tolerance;
    int32_t *rest_weld; /* [vertex_count] the weld by the rest points alone */
    ss_spot *spots;     /* [shared_count] */
    bool parted;
    int32_t parted_vertex, parted_from;
    double parted_frame;
};

/* ---- Creation ---- */

static skinslide_status check_tolerance(const skinslide_mesh *mesh, double tolerance, skinslide_error *error) {
    double box[3];
    ss_measure_rest(mesh, box);
    double most = 1e-3 * ss_length(box);
    if (tolerance >= 0 && (tolerance == 0 || tolerance <= most))
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT,
                   "weld: the tolerance is %g; it must be 0 to %g, a thousandth of the size of the mesh", tolerance, most);
}

/* The mesh without its weld, which is to be found here. */
static skinslide_status take_bare(const skinslide_mesh **mesh, ss_taken_mesh *taken, skinslide_error *error) {
    skinslide_mesh bare = SKINSLIDE_MESH_DEFAULT;
    skinslide_status status = ss_take(*mesh, "skinslide_mesh", &bare, sizeof bare, error);
    bare.weld = NULL;
    const skinslide_mesh *given = *mesh ? &bare : NULL;
    if (!status)
        status = ss_take_mesh(&given, taken, error);
    *mesh = given ? &taken->mesh : NULL;
    return status;
}

/* Faces that the mesh does not have are ignored here: the slider names them. */
static void mark_faces(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t setup_count, uint8_t *chosen) {
    for (int32_t i = 0; i < setup_count; i++)
        for (int32_t k = 0; k < setups[i].face_count && setups[i].faces; k++)
            if (setups[i].faces[k] >= 0 && setups[i].faces[k] < mesh->face_count)
                chosen[setups[i].faces[k]] = 1;
}

static void mark_vertices(skinslide_weld *weld, const skinslide_mesh *mesh, const uint8_t *chosen) {
    for (int32_t f = 0, c = 0; f < mesh->face_count; f++)
        for (int32_t end = c + mesh->face_counts[f]; c < end; c++)
            if (chosen[f])
                weld->seams.in_patch[mesh->face_indices[c]] = 1;
}

/* Lists the vertices in places that several vertices share, one of a patch among them. share is scratch [vertex_count], of
 * zeros. */
static void list_shared(skinslide_weld *weld, uint8_t *share) {
    enum { ONE = 1, SEVERAL = 2, PATCH = 4 };
    for (int32_t v = 0; v < weld->seams.vertex_count; v++)
        share[weld->seams.place[v]] |=
            (uint8_t)((share[weld->seams.place[v]] ? SEVERAL : ONE) | (weld->seams.in_patch[v] ? PATCH : 0));
    for (int32_t v = 0; v < weld->seams.vertex_count; v++)
        if ((share[weld->seams.place[v]] & SEVERAL) && (share[weld->seams.place[v]] & PATCH))
            weld->seams.shared[weld->seams.shared_count++] = v;
}

/* is_shared [vertex_count] */
static void list_corners(skinslide_weld *weld, const skinslide_mesh *mesh, const uint8_t *chosen, const uint8_t *is_shared) {
    for (int32_t f = 0, start = 0; f < mesh->face_count; start += mesh->face_counts[f++])
        for (int32_t k = 0, n = mesh->face_counts[f]; k < n && chosen[f]; k++) {
            int32_t vertex = mesh->face_indices[start + k], next = mesh->face_indices[start + (k + 1) % n];
            if (is_shared[vertex] || is_shared[next])
                weld->seams.corners[weld->seams.corner_count++] = (ss_seam_corner){f, vertex, next};
        }
}

/* Copies of setups as the library knows them. */
static skinslide_status take_setups(const skinslide_patch_setup *setups, int32_t count, ss_memory *scratch,
                                    skinslide_patch_setup **own, skinslide_error *error) {
    const skinslide_patch_setup standard = SKINSLIDE_PATCH_SETUP_DEFAULT;
    *own = SS_NEW(scratch, skinslide_patch_setup, count);
    if (scratch->failed)
        return ss_out_of_memory(error);
    return ss_take_all(setups, count, "skinslide_patch_setup", *own, sizeof standard, &standard, error);
}

static bool allocate(skinslide_weld *weld, const skinslide_mesh *mesh) {
    weld->seams.vertex_count = mesh->vertex_count;
    weld->seams.place = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    weld->rest_weld = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    weld->seams.in_patch = SS_NEW(&weld->memory, uint8_t, mesh->vertex_count);
    weld->seams.shared = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    return !weld->memory.failed;
}

static skinslide_status sew_rest(skinslide_weld *weld, skinslide_error *error) {
    ss_sewn sewn;
    bool done = ss_sew(&weld->seams, &sewn);
    if (done)
        memcpy(weld->rest_weld, sewn.vertex, (size_t)weld->seams.vertex_count * sizeof *sewn.vertex);
    ss_free(&sewn.memory);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}

static skinslide_status build(skinslide_weld *weld, const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                              int32_t setup_count, ss_memory *scratch, skinslide_error *error) {
    skinslide_patch_setup *own;
    uint8_t *chosen = SS_NEW(scratch, uint8_t, mesh->face_count), *marks = SS_NEW(scratch, uint8_t, mesh->vertex_count);
    skinslide_status status = scratch->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = take_setups(setups, setup_count, scratch, &own, error);
    if (!status && !ss_find_places(mesh->rest_points, weld->tolerance, mesh->vertex_count, weld->seams.place))
        status = ss_out_of_memory(error);
    if (status)
        return status;
    mark_faces(mesh, own, setup_count, chosen);
    mark_vertices(weld, mesh, chosen);
    list_shared(weld, marks);
    weld->spots = SS_NEW(&weld->memory, ss_spot, weld->seams.shared_count);
    weld->seams.corners = SS_NEW(&weld->memory, ss_seam_corner, weld->seams.shared_count ? mesh->index_count : 0);
    if (weld->memory.failed)
        return ss_out_of_memory(error);
    memset(marks, 0, (size_t)mesh->vertex_count);
    for (int32_t i = 0; i < weld->seams.shared_count; i++)
        marks[weld->seams.shared[i]] = 1;
    if (weld->seams.shared_count)
        list_corners(weld, mesh, chosen, marks);
    return sew_rest(weld, error);
}

skinslide_status skinslide_weld_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t setup_count,
                                       double tolerance, skinslide_weld **out, skinslide_error *error) {
    if (!out || setup_count < 0 || (setup_count > 0 && !setups))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the weld, or no patches");
    ss_taken_mesh taken;
    skinslide_status status = take_bare(&mesh, &taken, error);
    if (!status)
        status = ss_check_used(mesh, mesh->rest_points, "rest points", error);
    if (!status)
        status = check_tolerance(mesh, tolerance, error);
    if (status)
        return status;
    skinslide_weld *weld = calloc(1, sizeof *weld);
    ss_memory scratch = {0};
    if (!weld)
        return ss_out_of_memory(error);
    weld->tolerance = tolerance;
    status = allocate(weld, mesh) ? build(weld, mesh, setups, setup_count, &scratch, error) : ss_out_of_memory(error);
    ss_free(&scratch);
    if (status)
        skinslide_weld_destroy(weld);
    else
        *out = weld;
    return status;
}

void skinslide_weld_destroy(skinslide_weld *weld) {
    if (!weld)
        return;
    ss_free(&weld->memory);
    free(weld);
}

/* ---- Poses ---- */

skinslide_bool skinslide_weld_wants_poses(const skinslide_weld *weld) {
    return weld && weld->seams.shared_count > 0;
}

/* Whether a pose has parted a vertex from the one that rest alone would weld it to. */
static bool has_parted(const skinslide_weld *weld, int32_t vertex) {
    return weld->seams.place[vertex] != weld->seams.place[weld->rest_weld[vertex]];
}

/* Only points that share places are looked at, so only they must be finite. */
static skinslide_status check_shared(const skinslide_weld *weld, const float *points, skinslide_error *error) {
    if (!points)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points");
    for (int32_t i = 0; i < weld->seams.shared_count; i++) {
        const float *point = points + 3 * (int64_t)weld->seams.shared[i];
        if (!ss_is_finite(point))
            return ss_refuse_vertex("points", weld->seams.shared[i], point, 3, SKINSLIDE_BAD_POINTS, error);
    }
    return SKINSLIDE_OK;
}

skinslide_status skinslide_weld_show(skinslide_weld *weld, double frame, const float *points, skinslide_error *error) {
    if (!weld)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no weld");
    skinslide_status status = check_shared(weld, points, error);
    if (status)
        return status;
    ss_split_places(points, weld->tolerance, weld->seams.shared, weld->seams.shared_count, weld->spots, weld->seams.place);
    for (int32_t i = 0; i < weld->seams.shared_count && !weld->parted; i++) {
        int32_t v = weld->seams.shared[i];
        if (!has_parted(weld, v))
            continue;
        weld->parted = true, weld->parted_frame = frame;
        weld->parted_vertex = v, weld->parted_from = weld->rest_weld[v];
    }
    return SKINSLIDE_OK;
}

/* ---- The answer ---- */

static void count_parted(const skinslide_weld *weld, skinslide_weld_info *info) {
    for (int32_t i = 0; i < weld->seams.shared_count; i++)
        info->parted_points += has_parted(weld, weld->seams.shared[i]);
    info->parted_vertex = weld->parted_vertex, info->parted_from = weld->parted_from;
    info->parted_frame = weld->parted_frame;
}

/* marks is scratch [vertex_count], of zeros. */
static void count_welded(const skinslide_weld *weld, const ss_sewn *sewn, uint8_t *marks, skinslide_weld_info *info) {
    const int32_t *one = sewn->vertex;
    for (int32_t i = 0; i < weld->seams.shared_count; i++) {
        int32_t v = weld->seams.shared[i];
        bool first = one[v] != v && !marks[one[v]];
        info->welded_points += (one[v] != v) + first, info->welded_places += first;
        marks[one[v]] |= one[v] != v;
        info->refused_points += weld->seams.in_patch[v] && sewn->refused[weld->seams.place[v]];
    }
    memcpy(info->refused, sewn->why, sizeof sewn->why);
}

skinslide_status skinslide_weld_get(const skinslide_weld *weld, int32_t *vertices, skinslide_weld_info *info,
                                    skinslide_error *error) {
    if (!weld || !vertices)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no weld, or no place for its vertices");
    skinslide_status status = info ? ss_check_size(info, "skinslide_weld_info", error) : SKINSLIDE_OK;
    if (status)
        return status;
    skinslide_weld_info answer = SKINSLIDE_WELD_INFO_DEFAULT;
    ss_sewn sewn;
    bool done = ss_sew(&weld->seams, &sewn);
    uint8_t *marks = SS_NEW(&sewn.memory, uint8_t, weld->seams.vertex_count);
    done = done && marks;
    if (done) {
        memcpy(vertices, sewn.vertex, (size_t)weld->seams.vertex_count * sizeof *vertices);
        count_welded(weld, &sewn, marks, &answer);
        count_parted(weld, &answer);
        if (info)
            ss_give(&answer, sizeof answer, info);
    }
    ss_free(&sewn.memory);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}
