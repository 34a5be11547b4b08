/* What lives on the skin is carried with it: vectors, such as normals and tangents, turn as the skin under them turns.
 *
 *     t = axis sin(angle / 2)        a turn, the least rotation from one normal to another, so w = cos(angle / 2) >= 0
 *     x' = x + 2 w (t x x) + 2 t x (t x x)
 *
 * Where t is 0 no arithmetic is done, and x keeps its bits. */
#include "mesh.h"

#include <float.h>

/* 1 + cosine of the rotation: below this the normals are opposite, and no rotation is the least. */
static const double least_turn = 1e-9;

void ss_least_turn(const double from[3], const double to[3], double turn[3]) {
    double whole = 1 + ss_dot(from, to), scale = whole > least_turn ? 1 / sqrt(2 * whole) : 0;
    ss_cross(from, to, turn);
    for (int k = 0; k < 3; k++)
        turn[k] *= scale;
}

static void turn_vector(const double turn[3], double vector[3]) {
    double w = sqrt(fmax(0, 1 - ss_dot(turn, turn))), once[3], twice[3];
    ss_cross(turn, vector, once);
    ss_cross(turn, once, twice);
    ss_add(2 * w, once, vector);
    ss_add(2, twice, vector);
}

/* ---- Elements ---- */

/* Vertices of which an element has the mean turn: its own, or those of its face. */
typedef struct element {
    int32_t own;
    const int32_t *vertices;
    int32_t count;
} element;

int32_t ss_element_count(const skinslide_mesh *mesh, skinslide_normals_layout layout) {
    return layout == SKINSLIDE_NORMALS_VERTEX         ? mesh->vertex_count
           : layout == SKINSLIDE_NORMALS_FACE_VARYING ? mesh->index_count
                                                      : mesh->face_count;
}

/* The element e, which begins at a corner of the mesh. */
static element element_at(const skinslide_mesh *mesh, skinslide_normals_layout layout, int32_t e, int32_t corner) {
    if (layout == SKINSLIDE_NORMALS_UNIFORM)
        return (element){0, mesh->face_indices + corner, mesh->face_counts[e]};
    return (element){layout == SKINSLIDE_NORMALS_VERTEX ? e : mesh->face_indices[e], NULL, 1};
}

/* The mean turn of an element's vertices. False where none of them turns. */
static bool find_turn(const element *of, const float *turns, double turn[3]) {
    bool turns_at_all = false;
    turn[0] = turn[1] = turn[2] = 0;
    for (int32_t i = 0; i < of->count; i++) {
        const float *own = turns + 3 * (int64_t)(of->vertices ? of->vertices[i] : of->own);
        for (int k = 0; k < 3; k++) {
            turns_at_all = turns_at_all || own[k] != 0;
            turn[k] += (double)own[k] / of->count;
        }
    }
    return turns_at_all;
}

/* ---- Vectors ---- */

static double part(ss_vectors vectors, int64_t e, int k) {
    return vectors.doubles ? vectors.doubles[3 * e + k] : (double)vectors.floats[3 * e + k];
}

/* Turning may make each component as large as the length of the vector. */
skinslide_status ss_check_vector(const double vector[3], bool is_double, int64_t number, skinslide_error *error) {
    double most = is_double ? DBL_MAX / 8 : (double)FLT_MAX / 2;
    for (int k = 0; k < 3; k++)
        if (isfinite(vector[k]) && fabs(vector[k]) > most)
            return ss_fail(error, SKINSLIDE_BAD_POINTS, "vector %lld is too long to be carried: (%g, %g, %g)",
                           (long long)number, vector[0], vector[1], vector[2]);
    return SKINSLIDE_OK;
}

static void turn_element(ss_vectors vectors, int64_t e, const double turn[3]) {
    double vector[3] = {part(vectors, e, 0), part(vectors, e, 1), part(vectors, e, 2)};
    turn_vector(turn, vector);
    for (int k = 0; k < 3; k++)
        if (vectors.doubles)
            vectors.doubles[3 * e + k] = vector[k];
        else
            vectors.floats[3 * e + k] = (float)vector[k];
}

/* Turns the elements, or only checks that all can be turned. */
static skinslide_status go_through(const skinslide_mesh *mesh, const float *turns, skinslide_normals_layout layout,
                                   ss_vectors vectors, bool turning, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    int32_t count = ss_element_count(mesh, layout);
    for (int32_t e = 0, corner = 0; e < count && !status; e++) {
        element own = element_at(mesh, layout, e, corner);
        double turn[3], vector[3] = {part(vectors, e, 0), part(vectors, e, 1), part(vectors, e, 2)};
        corner += own.count;
        if (!find_turn(&own, turns, turn))
            continue;
        if (turning)
            turn_element(vectors, e, turn);
        else
            status = ss_check_vector(vector, vectors.doubles, e, error);
    }
    return status;
}

skinslide_status ss_carry(const skinslide_mesh *mesh, const float *turns, skinslide_normals_layout layout, ss_vectors vectors,
                          skinslide_error *error) {
    skinslide_status status = go_through(mesh, turns, layout, vectors, false, error);
    return status ? status : go_through(mesh, turns, layout, vectors, true, error);
}

skinslide_status skinslide_carry(const skinslide_mesh *mesh, const float *turns, skinslide_normals_layout layout,
                                 float *vectors, skinslide_error *error) {
    ss_taken_mesh taken;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (status)
        return status;
    if (!turns || !vectors || (unsigned)layout > SKINSLIDE_NORMALS_UNIFORM)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no turns or vectors, or no such layout of them");
    return ss_carry(mesh, turns, layout, (ss_vectors){vectors, NULL}, error);
}
