/* A patch that nobody painted: notes where the edges of a mesh stretch over a shot, and chooses the faces that a patch needs so
 * that skin can give there. */
#include "paint.h"

#include <math.h>
#include <string.h>

/* ---- Noting ---- */

static skinslide_status take_posed(const skinslide_mesh **mesh, ss_taken_mesh *taken, skinslide_error *error) {
    skinslide_status status = ss_take_mesh(mesh, taken, error);
    return status ? status : ss_check_used(*mesh, (*mesh)->rest_points, "rest points", error);
}

skinslide_status skinslide_note_stretch(const skinslide_mesh *mesh, const float *points, float *stretch,
                                        skinslide_error *error) {
    ss_taken_mesh taken;
    if (!points || !stretch)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no points, or no place for the stretch");
    skinslide_status status = take_posed(&mesh, &taken, error);
    if (!status)
        status = ss_check_used(mesh, points, "points", error);
    for (int32_t f = 0, begin = 0; !status && f < mesh->face_count; begin += mesh->face_counts[f++])
        for (int32_t k = 0; k < mesh->face_counts[f]; k++) {
            int32_t a = mesh->face_indices[begin + k], b = mesh->face_indices[begin + (k + 1) % mesh->face_counts[f]];
            double rest = ss_distance(mesh->rest_points, a, b), posed = ss_distance(points, a, b);
            if (rest > 0)
                stretch[begin + k] = fmaxf(stretch[begin + k], (float)fabs(ss_log(fmax(posed / rest, 1e-6))));
        }
    return status;
}

/* ---- Regions ---- */

typedef struct masking {
    const skinslide_mesh *mesh;
    int32_t *face_start; /* [face_count + 1] */
    uint8_t *touched;    /* [vertex_count] by place: an end of a side that counts; then, of a face that was reached */
    uint8_t *core;       /* [face_count] of a region, before it grows */
    uint8_t *near;       /* [face_count] of it, or reached by rings */
    int32_t *place;      /* [vertex_count] the lowest vertex in the same place */
    int32_t *region;     /* [vertex_count] a forest of places */
    double *area;        /* [vertex_count] of the region of a root */
    double *left;        /* [vertex_count] how far growth goes on */
} masking;

static bool allocate(masking *m, ss_memory *memory) {
    const skinslide_mesh *mesh = m->mesh;
    m->face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    m->touched = SS_NEW(memory, uint8_t, mesh->vertex_count);
    m->core = SS_NEW(memory, uint8_t, mesh->face_count);
    m->near = SS_NEW(memory, uint8_t, mesh->face_count);
    m->place = SS_NEW(memory, int32_t, mesh->vertex_count);
    m->region = SS_NEW(memory, int32_t, mesh->vertex_count);
    m->area = SS_NEW(memory, double, mesh->vertex_count);
    m->left = SS_NEW(memory, double, mesh->vertex_count);
    if (memory->failed || !ss_find_places(mesh->rest_points, 0, mesh->vertex_count, m->place))
        return false;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        m->region[v] = v;
    ss_start_faces(mesh, m->face_start);
    return true;
}

/* The place at a corner. */
static int32_t place_at(const masking *m, int32_t corner) {
    return m->place[m->mesh->face_indices[corner]];
}

static void touch_ends(masking *m, const float *stretch, double least) {
    for (int32_t f = 0; f < m->mesh->face_count; f++)
        for (int32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++)
            if ((double)stretch[c] > least)
                m->touched[place_at(m, c)] = m->touched[place_at(m, c + 1 < m->face_start[f + 1] ? c + 1 : m->face_start[f])] =
                    1;
}

/* Marks the faces that have a touched corner; those of fewer than three vertices cannot slide. */
static void mark_touched(const masking *m, uint8_t *faces) {
    for (int32_t f = 0; f < m->mesh->face_count; f++)
        for (int32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++)
            if (m->mesh->face_counts[f] >= 3 && m->touched[place_at(m, c)])
                faces[f] = 1;
}

/* Finds the regions, and how far each grows. */
static void find_regions(masking *m, double grow) {
    const skinslide_mesh *mesh = m->mesh;
    for (int32_t f = 0; f < mesh->face_count; f++)
        for (int32_t c = m->face_start[f]; m->core[f] && c < m->face_start[f + 1]; c++)
            ss_join(m->region, place_at(m, m->face_start[f]), place_at(m, c));
    for (int32_t f = 0; f < mesh->face_count; f++) {
        double twice[3];
        if (!m->core[f])
            continue;
        ss_area_vector(mesh->face_indices + m->face_start[f], mesh->face_counts[f], mesh->rest_points, twice);
        m->area[ss_root(m->region, place_at(m, m->face_start[f]))] += ss_length(twice) / 2;
    }
    ss_start_at(mesh, m->core, 0, m->left);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (m->left[v] >= 0)
            m->left[v] = grow * sqrt(m->area[ss_root(m->region, m->place[v])] / SS_PI);
}

/* Adds the faces around those that are near. */
static void add_ring(masking *m) {
    memset(m->touched, 0, (size_t)m->mesh->vertex_count);
    for (int32_t f = 0; f < m->mesh->face_count; f++)
        for (int32_t c = m->face_start[f]; m->near[f] && c < m->face_start[f + 1]; c++)
            m->touched[place_at(m, c)] = 1;
    mark_touched(m, m->near);
}

static skinslide_status mask(masking *m, const float *stretch, const skinslide_mask_options *options, uint8_t *faces,
                             skinslide_error *error) {
    touch_ends(m, stretch, options->least);
    mark_touched(m, m->core);
    memcpy(m->near, m->core, (size_t)m->mesh->face_count);
    find_regions(m, options->grow);
    if (!ss_spread(m->mesh, m->left))
        return ss_out_of_memory(error);
    for (int64_t ring = 0; ring < options->rings && ring < m->mesh->face_count; ring++)
        add_ring(m);
    ss_add_reached(m->mesh, m->left, m->near);
    for (int32_t f = 0; f < m->mesh->face_count; f++)
        faces[f] = m->near[f] && m->mesh->face_counts[f] >= 3;
    return SKINSLIDE_OK;
}

static skinslide_status check(const skinslide_mesh *mesh, const float *stretch, const skinslide_mask_options *options,
                              skinslide_error *error) {
    if (!(options->least >= 0) || !(options->grow >= 0) || options->rings < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "least %g, grow %g, %lld rings: none may be below 0", options->least,
                       options->grow, (long long)options->rings);
    for (int32_t c = 0; c < mesh->index_count; c++)
        if (!(stretch[c] >= 0))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "stretch[%d] is %g; a stretch is 0 or more", c, (double)stretch[c]);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_mask_stretched(const skinslide_mesh *mesh, const float *stretch,
                                          const skinslide_mask_options *options, uint8_t *faces, skinslide_error *error) {
    ss_taken_mesh taken;
    skinslide_mask_options own = SKINSLIDE_MASK_OPTIONS_DEFAULT;
    if (!stretch || !faces)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no stretch, or no place for the faces");
    skinslide_status status = take_posed(&mesh, &taken, error);
    if (!status)
        status = ss_take(options, "skinslide_mask_options", &own, sizeof own, error);
    if (!status)
        status = check(mesh, stretch, &own, error);
    if (status)
        return status;
    ss_memory memory = {0};
    masking m = {.mesh = mesh};
    status = allocate(&m, &memory) ? mask(&m, stretch, &own, faces, error) : ss_out_of_memory(error);
    ss_free(&memory);
    return status;
}
