/* Interpolation LIMIT: moves the cage so that the limit surface keeps its shape and only its parameters slide.
 *
 * Samples of the limit surface are the limit points of the free vertices, and the middles of the patch's faces, which keep the
 * surface from ringing in between. Starting from the linear result, each sample is brought to the tangent plane of the limit
 * surface of Md at the point where it is looked up (for a middle, the mean of its corners' queries), while edges keep their
 * linear length:
 *
 *     d = argmin  sum (n.(L d - (t - L Md)))^2 + E(edges)      in fit.c
 *
 * A row of L has the weights of the free vertices that make a sample; t is the point looked up, and n the normal there, shorter
 * where the pose crumples the surface: there samples are drawn to t itself, see fit.c. If all were, they would slide by exactly
 * what was looked up, but the surface would ring where the slide changes within a few faces, and the texture would bunch up. L
 * depends only on the mesh, so that it is factored once for a shot.
 *
 * The unknowns are displacements, so that where nothing slides nothing moves, to the last bit; points are offsets from a vertex
 * near the one looked up, so that the mesh's place in space does not matter. */
#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where a sample is on the patch when nothing slides. */
typedef struct sample {
    int32_t face;       /* patch face */
    ss_parameter at;    /* in that face */
    int32_t free_index; /* of the vertex whose limit point it is; -1 for the middle of the face */
} sample;

struct ss_cage {
    ss_memory memory;
    const ss_patch *patch;
    bool loop; /* whether the scheme is loop */
    ss_limit_surfaces *surfaces;
    ss_fit *fit;
    ss_crumple *crumple;
    int32_t sample_count; /* free_count limit points, then face_count middles */
    sample *samples;
    double *square;      /* [sample_count] how far from one line the tangents are at rest */
    double *edge_share;  /* [vertex_count] 1 / number of edges at the vertex */
    int32_t *free_index; /* [vertex_count] place in free_vertex, -1 if held */
    ss_rows stencils;    /* [sample_count] columns are mesh vertices */
    ss_rows free_rows;   /* [sample_count] L: the same with free vertices only, by place in free_vertex */
};

struct ss_cage_work {
    ss_memory memory;
    const ss_cage *cage;
    ss_fit_work *fit;
    ss_middles *middles;
    ss_place *place;       /* [sample_count] where the sample is looked up */
    int32_t *face_start;   /* [face_count + 1] where samples looked up in a face begin in by_face */
    int32_t *by_face;      /* [sample_count] */
    double (*residual)[3]; /* [sample_count] t - L Md */
    double (*normal)[3];   /* [sample_count] n, shorter where the pose crumples the surface */
    double *part;          /* [free_count] scratch for that */
    double *around;        /* [vertex_count] mean length of the edges at the vertex */
    double (*solution)[3]; /* [free_count] d */
    double *scratch;       /* [ss_limit_surfaces_scratch] */
};

/* ---- Samples ---- */

static void list_samples(ss_cage *cage) {
    const ss_patch *patch = cage->patch;
    const ss_faces *faces = &patch->faces;
    sample *next = cage->samples;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        cage->free_index[v] = -1;
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t vertex = patch->free_vertex[i], corner = patch->vertex_corner[vertex], face = faces->corner_face[corner];
        ss_parameter at = ss_limit_parameter(cage->surfaces, face, corner - faces->face_start[face], 0, 0);
        cage->free_index[vertex] = i;
        *next++ = (sample){face, at, i};
    }
    for (int32_t f = 0; f < faces->face_count; f++)
        *next++ = (sample){f, ss_limit_parameter(cage->surfaces, f, 0, 1, 1), -1};
}

static void count_edges(ss_cage *cage) {
    const ss_patch *patch = cage->patch;
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        for (int k = 0; k < 2; k++)
            cage->edge_share[patch->edge_vertex[e][k]]++;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        cage->edge_share[v] = 1 / cage->edge_share[v];
}

/* ---- The system ---- */

static const double negligible = 1e-13; /* smaller weights are rounding of OpenSubdiv's */

/* Adds value to a column of the row from begin to end, after which there is room for one more. Returns the new end. */
static int32_t add_entry(ss_rows *rows, int32_t begin, int32_t end, int32_t column, double value) {
    int32_t place = begin;
    while (place < end && rows->column[place] != column)
        place++;
    if (place == end)
        rows->column[end] = column, rows->value[end++] = 0;
    rows->value[place] += value;
    return end;
}

/* Appends row s of the stencils to rows, which has room for it. */
static void append_stencil(const ss_cage *cage, int32_t s, double *weights, ss_rows *rows) {
    const sample *own = &cage->samples[s];
    const int32_t *vertices;
    int32_t count = ss_limit_stencil(cage->surfaces, own->face, &own->at, &vertices, weights);
    int32_t begin = rows->start[s], end = begin;
    for (int32_t k = 0; k < count; k++)
        if (fabs(weights[k]) >= negligible)
            end = add_entry(rows, begin, end, vertices[k], weights[k]);
    rows->start[s + 1] = end;
}

/* Counts the entries of all rows, since faces around a pole have many more than others. A vertex twice in a row counts
 * twice. */
static int64_t count_entries(const ss_cage *cage, double *weights) {
    int64_t entries = 0;
    for (int32_t s = 0; s < cage->sample_count; s++) {
        const sample *own = &cage->samples[s];
        const int32_t *vertices;
        int32_t count = ss_limit_stencil(cage->surfaces, own->face, &own->at, &vertices, weights);
        for (int32_t k = 0; k < count; k++)
            entries += fabs(weights[k]) >= negligible;
    }
    return entries;
}

static skinslide_status fill_stencils(ss_cage *cage, double *weights, skinslide_error *error) {
    int32_t count = cage->sample_count;
    int64_t entries = count_entries(cage, weights);
    ss_rows *rows = &cage->stencils;
    if (entries > INT32_MAX)
        return ss_refuse_large(cage->patch->label, error);
    rows->row_count = count;
    rows->start = SS_NEW(&cage->memory, int32_t, (int64_t)count + 1);
    rows->column = SS_NEW(&cage->memory, int32_t, entries);
    rows->value = SS_NEW(&cage->memory, double, entries);
    if (cage->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t s = 0; s < count; s++)
        append_stencil(cage, s, weights, rows);
    return SKINSLIDE_OK;
}

static skinslide_status list_stencils(ss_cage *cage, skinslide_error *error) {
    ss_memory scratch = {0};
    double *weights = SS_NEW(&scratch, double, ss_limit_surfaces_most_vertices(cage->surfaces));
    skinslide_status status = weights ? fill_stencils(cage, weights, error) : ss_out_of_memory(error);
    ss_free(&scratch);
    return status;
}

/* Drops the columns of held vertices, which are not displaced, and adds up those of copies of one vertex. */
static skinslide_status restrict_to_free(ss_cage *cage, skinslide_error *error) {
    const ss_rows *all = &cage->stencils;
    ss_rows *rows = &cage->free_rows;
    rows->row_count = all->row_count, rows->column_count = cage->patch->free_count;
    rows->start = SS_NEW(&cage->memory, int32_t, (int64_t)all->row_count + 1);
    rows->column = SS_NEW(&cage->memory, int32_t, all->start[all->row_count]);
    rows->value = SS_NEW(&cage->memory, double, all->start[all->row_count]);
    if (cage->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t s = 0, end = 0; s < all->row_count; s++) {
        for (int32_t k = all->start[s]; k < all->start[s + 1]; k++) {
            int32_t vertex = ss_patch_vertex(cage->patch, all->column[k]);
            if (vertex >= 0 && cage->free_index[vertex] >= 0)
                end = add_entry(rows, rows->start[s], end, cage->free_index[vertex], all->value[k]);
        }
        rows->start[s + 1] = end;
    }
    return SKINSLIDE_OK;
}

/* ---- Creation ---- */

/* Fills scratch with the surface of a patch face, in offsets from one of its vertices, which becomes origin. */
static void prepare_face(const ss_cage *cage, int32_t face, const float *points, double origin[3], double *scratch) {
    const ss_faces *faces = &cage->patch->faces;
    const float *near = points + 3 * (int64_t)cage->patch->mesh_vertex[faces->corner_vertex[faces->face_start[face]]];
    for (int k = 0; k < 3; k++)
        origin[k] = near[k];
    ss_limit_prepare(cage->surfaces, face, points, origin, scratch);
}

/* Makes all that depends on the samples' normals at rest. */
static skinslide_status learn_rest(ss_cage *cage, const float *rest_points, skinslide_error *error) {
    ss_memory memory = {0};
    double(*normal)[3] = ss_new(&memory, cage->sample_count, sizeof *normal), origin[3], point[3];
    double *scratch = SS_NEW(&memory, double, ss_limit_surfaces_scratch(cage->surfaces));
    for (int32_t s = 0; s < cage->sample_count && !memory.failed; s++) {
        const sample *own = &cage->samples[s];
        prepare_face(cage, own->face, rest_points, origin, scratch);
        cage->square[s] = ss_limit_normal(cage->surfaces, own->face, &own->at, scratch, point, normal[s]);
    }
    skinslide_status status = memory.failed ? ss_out_of_memory(error)
                                            : ss_fit_create(cage->patch, cage->free_index, &cage->free_rows,
                                                            (const double(*)[3])normal, &cage->fit, error);
    if (!status)
        status = ss_crumple_create(&cage->free_rows, (const double(*)[3])normal, &cage->crumple, error);
    ss_free(&memory);
    return status;
}

static skinslide_status build(ss_cage *cage, const float *rest_points, skinslide_error *error) {
    cage->sample_count = cage->patch->free_count + cage->patch->faces.face_count;
    cage->samples = SS_NEW(&cage->memory, sample, cage->sample_count);
    cage->square = SS_NEW(&cage->memory, double, cage->sample_count);
    cage->edge_share = SS_NEW(&cage->memory, double, cage->patch->vertex_count);
    cage->free_index = SS_NEW(&cage->memory, int32_t, cage->patch->vertex_count);
    if (cage->memory.failed)
        return ss_out_of_memory(error);
    list_samples(cage);
    count_edges(cage);
    skinslide_status status = list_stencils(cage, error);
    if (!status)
        status = restrict_to_free(cage, error);
    return status ? status : learn_rest(cage, rest_points, error);
}

skinslide_status ss_cage_create(const ss_topology *topology, const ss_patch *patch, const float *rest_points, bool loop,
                                ss_cage **out, skinslide_error *error) {
    ss_cage *cage = calloc(1, sizeof *cage);
    if (!cage)
        return ss_out_of_memory(error);
    cage->patch = patch, cage->loop = loop;
    skinslide_status status =
        ss_limit_surfaces_create(topology, patch->mesh_face, patch->faces.face_count, patch->label, &cage->surfaces, error);
    if (!status)
        status = build(cage, rest_points, error);
    if (status)
        ss_cage_destroy(cage);
    else
        *out = cage;
    return status;
}

void ss_cage_destroy(ss_cage *cage) {
    if (!cage)
        return;
    ss_fit_destroy(cage->fit);
    ss_crumple_destroy(cage->crumple);
    ss_limit_surfaces_destroy(cage->surfaces);
    ss_free(&cage->memory);
    free(cage);
}

skinslide_status ss_cage_work_create(const ss_cage *cage, ss_cage_work **out, skinslide_error *error) {
    ss_cage_work *work = calloc(1, sizeof *work);
    if (!work)
        return ss_out_of_memory(error);
    work->cage = cage;
    work->place = SS_NEW(&work->memory, ss_place, cage->sample_count);
    work->face_start = SS_NEW(&work->memory, int32_t, (int64_t)cage->patch->faces.face_count + 1);
    work->by_face = SS_NEW(&work->memory, int32_t, cage->sample_count);
    work->residual = ss_new(&work->memory, cage->sample_count, sizeof *work->residual);
    work->normal = ss_new(&work->memory, cage->sample_count, sizeof *work->normal);
    work->part = SS_NEW(&work->memory, double, cage->patch->free_count);
    work->around = SS_NEW(&work->memory, double, cage->patch->vertex_count);
    work->solution = ss_new(&work->memory, cage->patch->free_count, sizeof *work->solution);
    work->scratch = SS_NEW(&work->memory, double, ss_limit_surfaces_scratch(cage->surfaces));
    skinslide_status status = work->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_fit_work_create(cage->fit, &work->fit, error);
    if (!status)
        status = ss_middles_create(cage->patch, cage->free_index, &work->middles, error);
    if (status)
        ss_cage_work_destroy(work);
    else
        *out = work;
    return status;
}

void ss_cage_work_destroy(ss_cage_work *work) {
    if (!work)
        return;
    ss_middles_destroy(work->middles);
    ss_fit_work_destroy(work->fit);
    ss_free(&work->memory);
    free(work);
}

/* ---- Targets of one frame ---- */

/* The face that a sample is looked up in: its own if it stays. */
static int32_t face_of(const ss_cage *cage, int32_t s, const ss_place *place) {
    return place->triangle == SS_STAYS ? cage->samples[s].face : cage->patch->triangles.face[place->triangle];
}

/* Finds where samples are looked up, and sorts them by face, so that each face is prepared once for all its samples. */
static void sort_samples(ss_cage_work *work, const ss_slide *slide) {
    const ss_cage *cage = work->cage;
    int32_t *start = work->face_start, faces = cage->patch->faces.face_count;
    memset(start, 0, ((size_t)faces + 1) * sizeof *start);
    for (int32_t s = 0; s < cage->sample_count; s++) {
        const sample *own = &cage->samples[s];
        work->place[s] = own->free_index < 0 ? ss_middle(work->middles, own->face) : slide->places[own->free_index];
        start[face_of(cage, s, &work->place[s])]++;
    }
    for (int32_t f = 0; f < faces; f++)
        start[f + 1] += start[f];
    for (int32_t s = cage->sample_count - 1; s >= 0; s--)
        work->by_face[--start[face_of(cage, s, &work->place[s])]] = s;
}

/* Finds residual = t - L Md and n of sample s. face, in which it is looked up, is prepared in offsets from origin. */
static void list_target(const ss_cage_work *work, const float *points, const ss_flat *flat, int32_t s, int32_t face,
                        const double origin[3]) {
    const ss_cage *cage = work->cage;
    const ss_place *place = &work->place[s];
    const ss_rows *stencils = &cage->stencils;
    bool stays = place->triangle == SS_STAYS;
    ss_parameter at = stays ? cage->samples[s].at : ss_parametrise(cage->patch, cage->loop, flat, place);
    double residual[3];
    double square = ss_limit_normal(cage->surfaces, face, &at, work->scratch, residual, work->normal[s]);
    ss_shorten_flat(square, cage->square[s], work->normal[s]);
    for (int32_t k = stencils->start[s]; k < stencils->start[s + 1]; k++)
        for (int axis = 0; axis < 3; axis++)
            residual[axis] -= stencils->value[k] * (points[3 * (int64_t)stencils->column[k] + axis] - origin[axis]);
    for (int axis = 0; axis < 3; axis++)
        work->residual[s][axis] = stays ? 0 : residual[axis];
}

static void list_targets(ss_cage_work *work, const ss_frame *frame, const ss_slide *slide) {
    int32_t faces = work->cage->patch->faces.face_count;
    double origin[3];
    ss_middles_set(work->middles, slide);
    sort_samples(work, slide);
    for (int32_t f = 0; f < faces && !ss_is_set(frame->stop); f++) {
        int32_t end = work->face_start[f + 1];
        if (work->face_start[f] < end)
            prepare_face(work->cage, f, frame->points, origin, work->scratch);
        for (int32_t i = work->face_start[f]; i < end; i++)
            list_target(work, frame->points, &slide->flat, work->by_face[i], f, origin);
    }
}

/* ---- Damping ---- */

static const double most_deviation = 0.5; /* of LIMIT from LINEAR, in mean edges where the vertex slid to */
static const double softness = 0.25; /* of that bound: how far before and behind it vertices begin and cease to slow down */

static void measure_around(const ss_cage *cage, const double *lengths, double *around) {
    const ss_patch *patch = cage->patch;
    memset(around, 0, (size_t)patch->vertex_count * sizeof *around);
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        for (int k = 0; k < 2; k++)
            around[patch->edge_vertex[e][k]] += cage->edge_share[patch->edge_vertex[e][k]] * lengths[e];
}

/* Interpolated linearly between corners, so that it does not jump from face to face, and vertices with it. */
static double bound(const ss_cage *cage, const double *around, const ss_place *place, int32_t i) {
    if (place->triangle == SS_STAYS)
        return most_deviation * around[cage->patch->free_vertex[i]];
    const int32_t *corners = cage->patch->triangles.vertex[place->triangle];
    double mean = 0;
    for (int k = 0; k < 3; k++)
        mean += place->weight[k] * around[corners[k]];
    return most_deviation * mean;
}

/* What is left of a distance: all of it up to 3/4 of most, and most from 5/4 of it on; its slope goes from 1 to 0 in between. A
 * vertex that went on to its bound and stopped there at once would jerk. */
static double damped_distance(double distance, double most) {
    double over = distance - (1 - softness) * most;
    if (over <= 0)
        return distance;
    return over < 2 * softness * most ? distance - over * over / (4 * softness * most) : most;
}

/* Replaces the linear displacement by the solution, but no farther from it than most. Returns whether it was farther. */
static bool take_damped(const double solution[3], double most, double linear[3]) {
    double off[3];
    ss_subtract(solution, linear, off);
    double distance = ss_length(off), left = damped_distance(distance, most);
    for (int k = 0; k < 3; k++)
        linear[k] = left < distance ? linear[k] + left / distance * off[k] : solution[k];
    return distance > most;
}

/* ---- One frame ---- */

static bool any_slides(const ss_slide *slide, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (slide->places[i].triangle != SS_STAYS)
            return true;
    return false;
}

int32_t ss_move_cage(ss_cage_work *work, const ss_frame *frame, const ss_slide *slide, double (*displacement)[3]) {
    int32_t damped = 0, count = work->cage->patch->free_count;
    if (!any_slides(slide, count))
        return 0;
    list_targets(work, frame, slide);
    if (ss_is_set(frame->stop))
        return 0;
    ss_crumple_shorten(work->cage->crumple, work->solution, work->part, work->normal);
    memcpy(work->solution, displacement, (size_t)count * sizeof *displacement);
    ss_fit_samples(work->fit, frame, (const double(*)[3])work->residual, (const double(*)[3])work->normal, work->solution);
    measure_around(work->cage, frame->lengths, work->around);
    for (int32_t i = 0; i < count; i++)
        damped += take_damped(work->solution[i], bound(work->cage, work->around, &slide->places[i], i), displacement[i]);
    return damped;
}
