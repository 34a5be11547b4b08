/* Which vertices of a mesh are one: points in one place, in every pose, whose faces meet there edge to edge.
 *
 * Places come first: sets of points that coincide at rest and in each pose shown. Then faces of the patches are sewn together
 * where a side of one and a side of another run between the same two places, opposite ways: ends of the sides are then one, and
 * no other points of a place are, so that the welded patch has no edge of three faces and no vertex that only points touch at.
 * Points off the patches follow where all points of the patches in their place are one. */
#include "mesh.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A corner of a face of a patch, and the next: at least one of the two points shares its place at rest. */
typedef struct seam_corner {
    int32_t face, vertex, next;
} seam_corner;

struct skinslide_weld {
    ss_memory memory;
    int32_t vertex_count;
    double tolerance;
    int32_t *place;     /* [vertex_count] the lowest vertex in the same place, in all poses so far */
    int32_t *rest_weld; /* [vertex_count] the weld by the rest points alone */
    uint8_t *in_patch;  /* [vertex_count] a face of a patch has it */
    int32_t shared_count;
    int32_t *shared; /* [shared_count] vertices that share a place at rest with one of a patch, ascending */
    ss_spot *spots;  /* [shared_count] */
    int32_t corner_count;
    seam_corner *corners; /* [corner_count] in the order of faces */
    bool parted;
    int32_t parted_vertex, parted_from;
    double parted_frame;
};

/* ---- Sewing ---- */

/* A side between two places. */
typedef struct seam_side {
    int32_t low, high;   /* places */
    int32_t vertices[2]; /* at low, at high */
    int32_t face;
    bool upwards; /* the face goes from low to high */
} seam_side;

typedef struct sewing {
    ss_memory memory;
    const skinslide_weld *weld;
    int32_t side_count;
    seam_side *sides; /* [corner_count] */
    uint8_t *refused; /* [vertex_count] by place */
    int32_t *face;    /* [vertex_count] by place: 1 + the last face with a corner there */
    int32_t *vertex;  /* [vertex_count] by place: that corner; then the root of the patches' points there, -2 for several */
    int32_t *one;     /* [vertex_count] a forest */
    char why[160];    /* of the first refusal */
} sewing;

__attribute__((format(printf, 3, 4))) static void refuse(sewing *s, int32_t place, const char *format, ...);

static void refuse(sewing *s, int32_t place, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (!*s->why)
        vsnprintf(s->why, sizeof s->why, format, arguments);
    va_end(arguments);
    s->refused[place] = 1;
}

/* Refuses places in which a face has two corners: welding would collapse an edge, or fold the face. */
static void refuse_folded_faces(sewing *s) {
    const skinslide_weld *weld = s->weld;
    for (int32_t c = 0; c < weld->corner_count; c++) {
        const seam_corner *own = &weld->corners[c];
        int32_t place = weld->place[own->vertex];
        if (s->face[place] == own->face + 1 && s->vertex[place] != own->vertex)
            refuse(s, place, "vertices %d and %d are both corners of face %d", s->vertex[place], own->vertex, own->face);
        s->face[place] = own->face + 1, s->vertex[place] = own->vertex;
    }
}

static int by_places(const void *a, const void *b) {
    const seam_side *x = a, *y = b;
    if (x->low != y->low)
        return ss_ascending(&x->low, &y->low);
    return x->high != y->high ? ss_ascending(&x->high, &y->high) : ss_ascending(&x->face, &y->face);
}

static void list_sides(sewing *s) {
    const int32_t *place = s->weld->place;
    for (int32_t c = 0; c < s->weld->corner_count; c++) {
        const seam_corner *own = &s->weld->corners[c];
        if (place[own->vertex] == place[own->next])
            continue;
        bool upwards = place[own->vertex] < place[own->next];
        int32_t low = upwards ? own->vertex : own->next, high = upwards ? own->next : own->vertex;
        s->sides[s->side_count++] = (seam_side){place[low], place[high], {low, high}, own->face, upwards};
    }
    qsort(s->sides, (size_t)s->side_count, sizeof *s->sides, by_places);
}

/* The end of the sides that run between the same places as the first. */
static int32_t end_of_sides(const sewing *s, int32_t first) {
    int32_t end = first + 1;
    while (end < s->side_count && s->sides[end].low == s->sides[first].low && s->sides[end].high == s->sides[first].high)
        end++;
    return end;
}

/* Refuses places between which more than two faces have sides, as in a doubled sheet, since nothing says which belong together;
 * and those between which faces are wound alike. */
static void refuse_sides(sewing *s) {
    for (int32_t i = 0, end; i < s->side_count; i = end) {
        const seam_side *first = &s->sides[i], *second = first + 1;
        end = end_of_sides(s, i);
        if (end - i < 2 || (end - i == 2 && first->upwards != second->upwards))
            continue;
        for (int k = 0; k < 2; k++)
            if (end - i > 2)
                refuse(s, k ? first->high : first->low, "edge %d-%d would have %d faces", first->vertices[0],
                       first->vertices[1], end - i);
            else
                refuse(s, k ? first->high : first->low, "faces %d and %d are wound against each other along edge %d-%d",
                       first->face, second->face, first->vertices[0], first->vertices[1]);
    }
}

static void join_sides(sewing *s) {
    for (int32_t i = 0, end; i < s->side_count; i = end) {
        const seam_side *own = &s->sides[i];
        end = end_of_sides(s, i);
        for (int k = 0; k < 2 && end - i == 2; k++)
            if (!s->refused[own->low] && !s->refused[own->high])
                ss_join(s->one, own[0].vertices[k], own[1].vertices[k]);
    }
}

/* Points off the patches join those of the patches in their place, if these are one. */
static void join_followers(sewing *s) {
    const skinslide_weld *weld = s->weld;
    for (int32_t v = 0; v < weld->vertex_count; v++)
        s->vertex[v] = -1;
    for (int32_t i = 0; i < weld->shared_count; i++) {
        int32_t v = weld->shared[i], *root = &s->vertex[weld->place[v]];
        if (weld->in_patch[v])
            *root = *root == -1 || *root == ss_root(s->one, v) ? ss_root(s->one, v) : -2;
    }
    for (int32_t i = 0; i < weld->shared_count; i++) {
        int32_t v = weld->shared[i], place = weld->place[v];
        if (!weld->in_patch[v] && s->vertex[place] >= 0 && !s->refused[place])
            ss_join(s->one, v, s->vertex[place]);
    }
}

static skinslide_status sew(sewing *s, const skinslide_weld *weld, skinslide_error *error) {
    *s = (sewing){.weld = weld};
    s->sides = SS_NEW(&s->memory, seam_side, weld->corner_count);
    s->refused = SS_NEW(&s->memory, uint8_t, weld->vertex_count);
    s->face = SS_NEW(&s->memory, int32_t, weld->vertex_count);
    s->vertex = SS_NEW(&s->memory, int32_t, weld->vertex_count);
    s->one = SS_NEW(&s->memory, int32_t, weld->vertex_count);
    if (s->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t v = 0; v < weld->vertex_count; v++)
        s->one[v] = v;
    refuse_folded_faces(s);
    list_sides(s);
    refuse_sides(s);
    join_sides(s);
    join_followers(s);
    return SKINSLIDE_OK;
}

/* The vertex that stands for each set: its lowest vertex of a patch. Uses s->vertex as scratch. */
static void write_weld(sewing *s, int32_t *out) {
    const skinslide_weld *weld = s->weld;
    for (int32_t v = 0; v < weld->vertex_count; v++)
        out[v] = v, s->vertex[v] = -1;
    for (int32_t i = 0; i < weld->shared_count; i++) {
        int32_t v = weld->shared[i], *lowest = &s->vertex[ss_root(s->one, v)];
        if (weld->in_patch[v] && *lowest < 0)
            *lowest = v;
    }
    for (int32_t i = 0; i < weld->shared_count; i++) {
        int32_t v = weld->shared[i], lowest = s->vertex[ss_root(s->one, v)];
        out[v] = lowest >= 0 ? lowest : v;
    }
}

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
                weld->in_patch[mesh->face_indices[c]] = 1;
}

/* Lists the vertices in places that several vertices share, one of a patch among them. share is scratch [vertex_count], of
 * zeros. */
static void list_shared(skinslide_weld *weld, uint8_t *share) {
    enum { ONE = 1, SEVERAL = 2, PATCH = 4 };
    for (int32_t v = 0; v < weld->vertex_count; v++)
        share[weld->place[v]] |= (uint8_t)((share[weld->place[v]] ? SEVERAL : ONE) | (weld->in_patch[v] ? PATCH : 0));
    for (int32_t v = 0; v < weld->vertex_count; v++)
        if ((share[weld->place[v]] & SEVERAL) && (share[weld->place[v]] & PATCH))
            weld->shared[weld->shared_count++] = v;
}

/* is_shared [vertex_count] */
static void list_corners(skinslide_weld *weld, const skinslide_mesh *mesh, const uint8_t *chosen, const uint8_t *is_shared) {
    for (int32_t f = 0, start = 0; f < mesh->face_count; start += mesh->face_counts[f++])
        for (int32_t k = 0, n = mesh->face_counts[f]; k < n && chosen[f]; k++) {
            int32_t vertex = mesh->face_indices[start + k], next = mesh->face_indices[start + (k + 1) % n];
            if (is_shared[vertex] || is_shared[next])
                weld->corners[weld->corner_count++] = (seam_corner){f, vertex, next};
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
    weld->vertex_count = mesh->vertex_count;
    weld->place = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    weld->rest_weld = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    weld->in_patch = SS_NEW(&weld->memory, uint8_t, mesh->vertex_count);
    weld->shared = SS_NEW(&weld->memory, int32_t, mesh->vertex_count);
    return !weld->memory.failed;
}

static skinslide_status sew_rest(skinslide_weld *weld, skinslide_error *error) {
    sewing s;
    skinslide_status status = sew(&s, weld, error);
    if (!status)
        write_weld(&s, weld->rest_weld);
    ss_free(&s.memory);
    return status;
}

static skinslide_status build(skinslide_weld *weld, const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                              int32_t setup_count, ss_memory *scratch, skinslide_error *error) {
    skinslide_patch_setup *own;
    uint8_t *chosen = SS_NEW(scratch, uint8_t, mesh->face_count), *marks = SS_NEW(scratch, uint8_t, mesh->vertex_count);
    skinslide_status status = scratch->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = take_setups(setups, setup_count, scratch, &own, error);
    if (!status && !ss_find_places(mesh->rest_points, weld->tolerance, mesh->vertex_count, weld->place))
        status = ss_out_of_memory(error);
    if (status)
        return status;
    mark_faces(mesh, own, setup_count, chosen);
    mark_vertices(weld, mesh, chosen);
    list_shared(weld, marks);
    weld->spots = SS_NEW(&weld->memory, ss_spot, weld->shared_count);
    weld->corners = SS_NEW(&weld->memory, seam_corner, weld->shared_count ? mesh->index_count : 0);
    if (weld->memory.failed)
        return ss_out_of_memory(error);
    memset(marks, 0, (size_t)mesh->vertex_count);
    for (int32_t i = 0; i < weld->shared_count; i++)
        marks[weld->shared[i]] = 1;
    if (weld->shared_count)
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
    return weld && weld->shared_count > 0;
}

/* Whether a pose has parted a vertex from the one that rest alone would weld it to. */
static bool has_parted(const skinslide_weld *weld, int32_t vertex) {
    return weld->place[vertex] != weld->place[weld->rest_weld[vertex]];
}

/* Only points that share places are looked at, so only they must be finite. */
static skinslide_status check_shared(const skinslide_weld *weld, const float *points, skinslide_error *error) {
    if (!points)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points");
    for (int32_t i = 0; i < weld->shared_count; i++) {
        const float *point = points + 3 * (int64_t)weld->shared[i];
        if (!ss_is_finite(point))
            return ss_refuse_vertex("points", weld->shared[i], point, 3, SKINSLIDE_BAD_POINTS, error);
    }
    return SKINSLIDE_OK;
}

skinslide_status skinslide_weld_show(skinslide_weld *weld, double frame, const float *points, skinslide_error *error) {
    if (!weld)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no weld");
    skinslide_status status = check_shared(weld, points, error);
    if (status)
        return status;
    ss_split_places(points, weld->tolerance, weld->shared, weld->shared_count, weld->spots, weld->place);
    for (int32_t i = 0; i < weld->shared_count && !weld->parted; i++) {
        int32_t v = weld->shared[i];
        if (!has_parted(weld, v))
            continue;
        weld->parted = true, weld->parted_frame = frame;
        weld->parted_vertex = v, weld->parted_from = weld->rest_weld[v];
    }
    return SKINSLIDE_OK;
}

/* ---- The answer ---- */

static void count_parted(const skinslide_weld *weld, skinslide_weld_info *info) {
    for (int32_t i = 0; i < weld->shared_count; i++)
        info->parted_points += has_parted(weld, weld->shared[i]);
    info->parted_vertex = weld->parted_vertex, info->parted_from = weld->parted_from;
    info->parted_frame = weld->parted_frame;
}

/* marks is scratch [vertex_count], of zeros. */
static void count_welded(const sewing *s, const int32_t *one, uint8_t *marks, skinslide_weld_info *info) {
    const skinslide_weld *weld = s->weld;
    for (int32_t i = 0; i < weld->shared_count; i++) {
        int32_t v = weld->shared[i];
        bool first = one[v] != v && !marks[one[v]];
        info->welded_points += (one[v] != v) + first, info->welded_places += first;
        marks[one[v]] |= one[v] != v;
        info->refused_points += weld->in_patch[v] && s->refused[weld->place[v]];
    }
    memcpy(info->refused, s->why, sizeof s->why);
}

skinslide_status skinslide_weld_get(const skinslide_weld *weld, int32_t *vertices, skinslide_weld_info *info,
                                    skinslide_error *error) {
    if (!weld || !vertices)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no weld, or no place for its vertices");
    skinslide_status status = info ? ss_check_size(info, "skinslide_weld_info", error) : SKINSLIDE_OK;
    if (status)
        return status;
    skinslide_weld_info answer = SKINSLIDE_WELD_INFO_DEFAULT;
    sewing s;
    status = sew(&s, weld, error);
    uint8_t *marks = status ? NULL : SS_NEW(&s.memory, uint8_t, weld->vertex_count);
    if (!status && !marks)
        status = ss_out_of_memory(error);
    if (!status) {
        write_weld(&s, vertices);
        count_welded(&s, vertices, marks, &answer);
        count_parted(weld, &answer);
        if (info)
            ss_give(&answer, sizeof answer, info);
    }
    ss_free(&s.memory);
    return status;
}
