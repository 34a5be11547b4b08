/* Points of a limit surface, for pictures and measures, and the faces that have one. */
#include "limit.h"

/* The faces that places are on, in the order of the mesh, and the place of each in that list. */
typedef struct chosen_faces {
    int32_t count;
    int32_t *faces;       /* [count] */
    int32_t *place;       /* [face_count] */
    int32_t *corner_face; /* [index_count] */
    int32_t *face_start;  /* [face_count] */
} chosen_faces;

static bool in_unit(float x) {
    return x >= 0 && x <= 1;
}

static skinslide_status check_places(const skinslide_mesh *mesh, const skinslide_limit_place *places, int32_t count,
                                     skinslide_error *error) {
    for (int32_t i = 0; i < count; i++)
        if (places[i].corner < 0 || places[i].corner >= mesh->index_count || !in_unit(places[i].s) || !in_unit(places[i].t))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "place %d is not on the mesh: corner %d, (%g, %g)", i,
                           places[i].corner, places[i].s, places[i].t);
    return SKINSLIDE_OK;
}

static skinslide_status choose_faces(const skinslide_mesh *mesh, const skinslide_limit_place *places, int32_t count,
                                     ss_memory *memory, chosen_faces *chosen, skinslide_error *error) {
    chosen->faces = SS_NEW(memory, int32_t, mesh->face_count);
    chosen->place = SS_NEW(memory, int32_t, mesh->face_count);
    chosen->corner_face = SS_NEW(memory, int32_t, mesh->index_count);
    chosen->face_start = SS_NEW(memory, int32_t, mesh->face_count);
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t f = 0, c = 0; f < mesh->face_count; f++) {
        chosen->face_start[f] = c;
        for (int32_t end = c + mesh->face_counts[f]; c < end; c++)
            chosen->corner_face[c] = f;
    }
    for (int32_t i = 0; i < count; i++)
        chosen->place[chosen->corner_face[places[i].corner]] = 1;
    for (int32_t f = 0; f < mesh->face_count; f++)
        if (chosen->place[f]) {
            chosen->place[f] = chosen->count;
            chosen->faces[chosen->count++] = f;
        }
    return SKINSLIDE_OK;
}

/* scratch holds the surface of face *prepared, which changes with the face. */
static void evaluate(const ss_limit_surfaces *surfaces, const chosen_faces *chosen, const float *points,
                     const skinslide_limit_place *place, int32_t *prepared, double *scratch, float out[3]) {
    int32_t face = chosen->corner_face[place->corner];
    const double origin[3] = {0, 0, 0};
    double point[3];
    if (face != *prepared)
        ss_limit_prepare(surfaces, chosen->place[face], points, origin, scratch);
    *prepared = face;
    ss_parameter at =
        ss_limit_parameter(surfaces, chosen->place[face], place->corner - chosen->face_start[face], place->s, place->t);
    ss_limit_point(surfaces, chosen->place[face], &at, scratch, point);
    for (int k = 0; k < 3; k++)
        out[k] = (float)point[k];
}

static skinslide_status evaluate_all(const skinslide_mesh *mesh, const chosen_faces *chosen, const float *points,
                                     const skinslide_limit_place *places, int32_t count, float *out, skinslide_error *error) {
    ss_topology *topology = NULL;
    ss_limit_surfaces *surfaces = NULL;
    ss_memory memory = {0};
    skinslide_status status = ss_topology_create(mesh, &topology, error);
    if (!status)
        status = ss_limit_surfaces_create(topology, chosen->faces, chosen->count, "limit points", &surfaces, error);
    ss_topology_destroy(topology);
    double *scratch = status ? NULL : SS_NEW(&memory, double, ss_limit_surfaces_scratch(surfaces));
    if (!status && !scratch)
        status = ss_out_of_memory(error);
    for (int32_t i = 0, prepared = -1; i < count && !status; i++)
        evaluate(surfaces, chosen, points, &places[i], &prepared, scratch, out + 3 * (int64_t)i);
    ss_limit_surfaces_destroy(surfaces);
    ss_free(&memory);
    return status;
}

static skinslide_status take_subdivided(const skinslide_mesh **mesh, ss_taken_mesh *taken, skinslide_error *error) {
    skinslide_status status = ss_take_mesh(mesh, taken, error);
    if (!status && !ss_is_subdivided(*mesh))
        status = ss_fail(error, SKINSLIDE_BAD_MESH, "the mesh is not subdivided: it has no limit surface");
    return status ? status : ss_check_subdivision(*mesh, error);
}

skinslide_status skinslide_limit_faces(const skinslide_mesh *mesh, uint8_t *faces, skinslide_error *error) {
    if (!faces)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the faces");
    ss_taken_mesh taken;
    ss_topology *topology = NULL;
    ss_memory memory = {0};
    skinslide_status status = take_subdivided(&mesh, &taken, error);
    ss_face_surface *kinds = status ? NULL : SS_NEW(&memory, ss_face_surface, mesh->face_count);
    if (!status && !kinds)
        status = ss_out_of_memory(error);
    if (!status)
        status = ss_topology_create(mesh, &topology, error);
    if (!status)
        status = ss_face_surfaces(topology, kinds, error);
    for (int32_t f = 0; !status && f < mesh->face_count; f++)
        faces[f] = kinds[f] == SS_SURFACE;
    ss_topology_destroy(topology);
    ss_free(&memory);
    return status;
}

skinslide_status skinslide_limit_points(const skinslide_mesh *mesh, const float *points, const skinslide_limit_place *places,
                                        int32_t count, float *out, skinslide_error *error) {
    if (count < 0 || (count > 0 && (!places || !out)))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no places, or no room for their points");
    ss_taken_mesh taken;
    skinslide_status status = take_subdivided(&mesh, &taken, error);
    if (!status)
        status = ss_check_points(points, mesh->vertex_count, "points", error);
    if (!status)
        status = check_places(mesh, places, count, error);
    ss_memory memory = {0};
    chosen_faces chosen = {0};
    if (!status)
        status = choose_faces(mesh, places, count, &memory, &chosen, error);
    if (!status)
        status = evaluate_all(mesh, &chosen, points, places, count, out, error);
    ss_free(&memory);
    return status;
}
