/* Which faces of a mesh a patch is made of: those that a primvar chooses, else those of the GeomSubset child of its name. */
#include "stage.h"

#include "mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int32_t face_count_of(const skinslide_stage_patch *patch) {
    return patch->mesh->taken[SS_ROW_FACE_COUNTS].array.count;
}

/* Lists the elements that are marked, of count. False if memory is short. */
static bool list_marked(ss_memory *memory, const uint8_t *marked, int32_t count, ss_array *out) {
    int32_t found = 0, *list;
    for (int32_t i = 0; i < count; i++)
        found += marked[i];
    list = SS_NEW(memory, int32_t, found);
    *out = (ss_array){list, 0};
    for (int32_t i = 0; list && i < count; i++)
        if (marked[i])
            list[out->count++] = i;
    return list != NULL;
}

/* ---- Chosen by a primvar ---- */

static skinslide_status check_finite(const ss_record *record, skinslide_error *error) {
    for (int64_t i = 0; ss_is_real(&record->value) && i < record->length; i++)
        if (!isfinite(ss_number(record, i, 0)))
            return ss_fail(error, SKINSLIDE_BAD_PATCH, SS_NAMED "[%lld] is %g", SS_NAME(record->value.name), (long long)i,
                           ss_number(record, i, 0));
    return SKINSLIDE_OK;
}

static skinslide_status check_primvar(const skinslide_stage_patch *patch, const ss_record *record, bool *by_face,
                                      skinslide_error *error) {
    const skinslide_value *value = &record->value;
    const char *interpolation = ss_interpolation(record);
    skinslide_status status = ss_check_paint_type(patch, record, true, SKINSLIDE_BAD_PATCH, error);
    if (status)
        return status;
    *by_face = strcmp(interpolation, "uniform") == 0;
    if (!*by_face && !ss_is_painted_by_vertex(record))
        return ss_fail(error, SKINSLIDE_BAD_PATCH,
                       SS_NAMED " has interpolation " SS_NAMED "; it must be uniform (by face), vertex or faceVarying",
                       SS_NAME(value->name), SS_NAME(interpolation));
    if (!ss_has_value(record))
        return ss_refuse_empty(record, SKINSLIDE_BAD_PATCH, error);
    status = ss_check_indices(record, SKINSLIDE_BAD_PATCH, error);
    if (status)
        return status;
    return *by_face ? ss_check_length(record, face_count_of(patch), "faces", SKINSLIDE_BAD_PATCH, error)
                    : ss_check_painted_vertices(patch->mesh, record, SKINSLIDE_BAD_PATCH, error);
}

/* Marks faces [face_count] of whose points all are chosen [vertex_count]. */
static void mark_faces_of(const skinslide_stage_mesh *mesh, const uint8_t *chosen, uint8_t *marked) {
    const int32_t *indices = mesh->taken[SS_ROW_FACE_INDICES].array.values, *start = mesh->face_start;
    for (int32_t face = 0; face < mesh->taken[SS_ROW_FACE_COUNTS].array.count; face++) {
        marked[face] = start[face] < start[face + 1];
        for (int32_t c = start[face]; c < start[face + 1]; c++)
            marked[face] &= chosen[indices[c]];
    }
}

static bool list_chosen(const skinslide_stage_mesh *mesh, const ss_record *record, bool by_face, ss_memory *memory,
                        ss_array *out) {
    ss_memory scratch = {0};
    int32_t count = mesh->taken[SS_ROW_FACE_COUNTS].array.count;
    uint8_t *chosen = SS_NEW(&scratch, uint8_t, record->length), *marked = by_face ? chosen : SS_NEW(&scratch, uint8_t, count);
    bool done = !scratch.failed;
    if (done)
        ss_mark_positive(record, chosen);
    if (done && !by_face)
        mark_faces_of(mesh, chosen, marked);
    done = done && list_marked(memory, marked, count, out);
    ss_free(&scratch);
    return done;
}

/* Copies the chosen faces into memory, ascending. */
static skinslide_status choose(const skinslide_stage_patch *patch, const ss_record *given, ss_memory *memory, ss_array *faces,
                               skinslide_error *error) {
    ss_record plain = *given, *record = &plain;
    bool by_face = false;
    skinslide_status status = check_primvar(patch, record, &by_face, error);
    double *room = status || ss_is_plain_paint(record) ? NULL : SS_NEW(memory, double, ss_plain_paint_room(patch->mesh));
    if (memory->failed)
        return ss_out_of_memory(error);
    if (room)
        plain = ss_plain_paint(patch, record, room);
    if (!status)
        status = check_finite(record, error);
    if (status)
        return status;
    if (!list_chosen(patch->mesh, record, by_face, memory, faces))
        return ss_out_of_memory(error);
    if (faces->count)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_PATCH, "has no faces: " SS_NAMED " is above 0 %s", SS_NAME(record->value.name),
                   by_face ? "on no face" : "on all points of no face");
}

skinslide_status ss_take_primvar_faces(skinslide_stage_patch *patch, const ss_record *record, skinslide_error *error) {
    ss_array faces = {0};
    patch->faces_by_primvar = record->value.type != SKINSLIDE_VALUE_NONE;
    if (!patch->faces_by_primvar)
        return SKINSLIDE_OK;
    skinslide_status status = choose(patch, record, &patch->memory, &faces, error);
    if (!status)
        patch->painted = faces;
    return status;
}

/* Values may vary over time as long as the faces that they choose do not: a tool may have resampled the mesh. */
skinslide_status ss_check_primvar_faces(const skinslide_stage_patch *patch, const ss_record *record, double frame,
                                        skinslide_error *error) {
    ss_memory scratch = {0};
    ss_array faces = {0};
    skinslide_status status = choose(patch, record, &scratch, &faces, error);
    bool same = faces.count == patch->painted.count &&
                (!faces.count || memcmp(faces.values, patch->painted.values, (size_t)faces.count * sizeof(int32_t)) == 0);
    if (!status && !same) {
        char text[32];
        skinslide_stage_frame_text(frame, text);
        status = ss_fail(error, SKINSLIDE_BAD_PATCH, SS_NAMED " chooses other faces at frame %s; patches are fixed",
                         SS_NAME(record->value.name), text);
    }
    ss_free(&scratch);
    return status;
}

/* ---- Painted on points ---- */

static skinslide_status check_painted(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_error *error) {
    if (!ss_has_value(record))
        return ss_refuse_empty(record, SKINSLIDE_BAD_PATCH, error);
    skinslide_status status = ss_check_paint_type(NULL, record, true, SKINSLIDE_BAD_PATCH, error);
    if (!status)
        status = ss_check_by_vertex(record, "", SKINSLIDE_BAD_PATCH, error);
    if (!status)
        status = ss_check_indices(record, SKINSLIDE_BAD_PATCH, error);
    if (!status)
        status = ss_check_length(record, mesh->vertex_count, "points", SKINSLIDE_BAD_PATCH, error);
    return status ? status : check_finite(record, error);
}

skinslide_status skinslide_stage_painted(const skinslide_stage_mesh *mesh, const skinslide_value *value, double *numbers,
                                         skinslide_error *error) {
    if (!mesh || !mesh->has_faces || !numbers)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh with faces, or no place for the numbers");
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = check_painted(mesh, &record, error);
    for (int64_t i = 0; !status && i < record.length; i++)
        numbers[i] = ss_number(&record, i, 0);
    return status;
}

/* ---- Of a GeomSubset ---- */

static skinslide_status check_element(const char *path, const ss_record *element, skinslide_error *error) {
    bool is_text = element->value.type == SKINSLIDE_VALUE_TEXT && !element->value.is_array;
    const char *said = is_text ? element->value.data : element->value.type_name;
    if (ss_has_value(element) && (!is_text || strcmp(said, "face") != 0))
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "the GeomSubset " SS_NAMED " has elementType " SS_NAMED "; it must be face",
                       SS_NAME(path), SS_NAME(said));
    return SKINSLIDE_OK;
}

/* Sorts faces, each once. */
static void sort_faces(ss_array *faces) {
    int32_t *values = faces->values, count = 0;
    qsort(values, (size_t)faces->count, sizeof *values, ss_ascending);
    for (int32_t i = 0; i < faces->count; i++)
        if (!count || values[i] != values[count - 1])
            values[count++] = values[i];
    faces->count = count;
}

static skinslide_status copy_indices(const ss_record *indices, ss_memory *memory, ss_array *out, skinslide_error *error) {
    skinslide_status status = ss_check_integers(indices, SKINSLIDE_BAD_PATCH, error);
    if (status)
        return status;
    int32_t *copy = indices->length > INT32_MAX ? NULL : SS_NEW(memory, int32_t, indices->length);
    if (!copy)
        return ss_out_of_memory(error);
    ss_copy_integers(indices, copy);
    *out = (ss_array){copy, (int32_t)indices->length};
    return SKINSLIDE_OK;
}

static skinslide_status check_faces(const ss_array *faces, int32_t face_count, const char *path, skinslide_error *error) {
    const int32_t *values = faces->values;
    if (!faces->count)
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "has no faces: the GeomSubset " SS_NAMED " is empty", SS_NAME(path));
    for (int32_t i = 0; i < faces->count; i++)
        if (values[i] < 0 || values[i] >= face_count)
            return ss_fail(error, SKINSLIDE_BAD_PATCH, "the GeomSubset " SS_NAMED " has face %d, but the mesh has %d faces",
                           SS_NAME(path), values[i], face_count);
    return SKINSLIDE_OK;
}

static skinslide_status take_indices(skinslide_stage_patch *patch, const ss_record *given, skinslide_error *error) {
    ss_array authored = {0}, faces = {0};
    ss_record record = *given;
    record.value.name = patch->indices_name;
    skinslide_status status = copy_indices(&record, &patch->memory, &authored, error);
    if (!status)
        status = copy_indices(&record, &patch->memory, &faces, error);
    if (status)
        return status;
    sort_faces(&faces);
    status = check_faces(&faces, face_count_of(patch), patch->subset, error);
    if (!status)
        patch->indices = authored, patch->painted = faces;
    return status;
}

static skinslide_status none_there(const skinslide_stage_patch *patch, skinslide_error *error) {
    char primvar[256];
    ss_name_property(SKINSLIDE_STAGE_PATCH, SS_ROW_FACES, patch->name, primvar);
    return ss_fail(error, SKINSLIDE_BAD_PATCH, "has no faces: there is neither %s nor a GeomSubset " SS_NAMED " under the mesh",
                   primvar, SS_NAME(patch->name));
}

/* A mesh may have many subsets, so errors name indices by the path of the subset. */
static skinslide_status name_subset(skinslide_stage_patch *patch, const char *path, skinslide_error *error) {
    static const char suffix[] = ".indices";
    char *name = SS_NEW(&patch->memory, char, (int64_t)(strlen(path) + sizeof suffix));
    patch->subset = ss_copy_text(&patch->memory, path);
    if (!name || !patch->subset)
        return ss_out_of_memory(error);
    strcpy(name, path);
    strcat(name, suffix);
    patch->indices_name = name;
    return SKINSLIDE_OK;
}

static skinslide_status take_subset(skinslide_stage_patch *patch, const skinslide_stage_subset *subset,
                                    skinslide_error *error) {
    if (!subset)
        return none_there(patch, error);
    skinslide_stage_subset own = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    skinslide_status status = ss_take(subset, "skinslide_stage_subset", &own, sizeof own, error);
    if (status)
        return status;
    if (!own.path)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "a subset has no path");
    if (!own.is_subset)
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "has no faces: " SS_NAMED " is a " SS_NAMED ", not a GeomSubset",
                       SS_NAME(own.path), SS_NAME(ss_type_of(own.type_name)));
    return name_subset(patch, own.path, error);
}

skinslide_status skinslide_stage_patch_take_subset(skinslide_stage_patch *patch, const skinslide_stage_subset *subset,
                                                   skinslide_error *error) {
    if (!patch)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no patch");
    if (patch->faces_by_primvar)
        return SKINSLIDE_OK;
    skinslide_status status = take_subset(patch, subset, error);
    patch->taken[SS_ROW_FACES].refused = status != SKINSLIDE_OK;
    return status;
}

/* Looks at nothing if the primvar chose faces, or if the subset was refused. */
skinslide_status ss_take_subset_faces(skinslide_stage_patch *patch, int32_t row, const ss_record *record,
                                      skinslide_error *error) {
    if (patch->faces_by_primvar || patch->taken[SS_ROW_FACES].refused)
        return SKINSLIDE_OK;
    if (!patch->subset)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the subset of the patch comes first");
    skinslide_status status =
        row == SS_ROW_ELEMENT_TYPE ? check_element(patch->subset, record, error) : take_indices(patch, record, error);
    patch->taken[SS_ROW_FACES].refused = status != SKINSLIDE_OK;
    return status;
}

skinslide_status ss_check_subset_faces(const skinslide_stage_patch *patch, int32_t row, const ss_record *record, double frame,
                                       skinslide_error *error) {
    static const ss_input integers = {.kind = SS_KIND_INTEGERS};
    const ss_taken taken = {.array = patch->indices};
    ss_record named = *record;
    if (patch->faces_by_primvar || patch->taken[SS_ROW_FACES].refused || !patch->subset)
        return SKINSLIDE_OK;
    if (row == SS_ROW_ELEMENT_TYPE)
        return check_element(patch->subset, record, NULL) ? ss_changes(record, frame, SKINSLIDE_BAD_PATCH, error)
                                                          : SKINSLIDE_OK;
    named.value.name = patch->indices_name;
    return ss_check_plain(&integers, &named, &taken, frame, SKINSLIDE_BAD_PATCH, error);
}

/* ---- What is inside ---- */

/* How far the patch reaches beyond the faces that were chosen: 0 without rest points. */
static double way_of(const skinslide_stage_patch *patch) {
    int32_t count;
    const ss_input *grow = &ss_inputs(SKINSLIDE_STAGE_PATCH, &count)[SS_ROW_GROW];
    bool counts = patch->mesh->rest && ss_is_read_by(grow, patch->taken[SS_ROW_RULE].choice);
    return counts ? patch->taken[SS_ROW_GROW].number : 0;
}

/* Adds the faces within the distance that the patch grows by. marked is scratch [face_count]. False if memory is short. */
static bool grow(skinslide_stage_patch *patch, uint8_t *marked) {
    skinslide_mesh mesh = ss_faces_of(patch->mesh);
    mesh.rest_points = patch->mesh->rest;
    for (int32_t i = 0; i < patch->painted.count; i++)
        marked[((const int32_t *)patch->painted.values)[i]] = 1;
    return ss_add_near_faces(&mesh, way_of(patch), marked) &&
           list_marked(&patch->settled, marked, face_count_of(patch), &patch->faces);
}

/* marked is scratch [vertex_count]. */
static bool list_vertices(skinslide_stage_patch *patch, uint8_t *marked) {
    const int32_t *indices = patch->mesh->taken[SS_ROW_FACE_INDICES].array.values, *faces = patch->faces.values;
    for (int32_t i = 0; i < patch->faces.count; i++)
        for (int32_t c = patch->mesh->face_start[faces[i]]; c < patch->mesh->face_start[faces[i] + 1]; c++)
            marked[indices[c]] = 1;
    return list_marked(&patch->settled, marked, patch->mesh->vertex_count, &patch->vertices);
}

skinslide_status ss_settle_faces(skinslide_stage_patch *patch, skinslide_error *error) {
    ss_memory scratch = {0};
    ss_free(&patch->settled);
    patch->settled = (ss_memory){0};
    patch->faces = patch->painted, patch->vertices = (ss_array){0};
    if (!patch->painted.count)
        return SKINSLIDE_OK;
    uint8_t *faces = SS_NEW(&scratch, uint8_t, face_count_of(patch));
    uint8_t *vertices = SS_NEW(&scratch, uint8_t, patch->mesh->vertex_count);
    bool done = !scratch.failed && (!(way_of(patch) > 0) || grow(patch, faces)) && list_vertices(patch, vertices);
    ss_free(&scratch);
    skinslide_status status = done ? ss_compare_patch(patch, error) : ss_out_of_memory(error);
    if (!status)
        patch->way = way_of(patch);
    return status;
}

skinslide_status ss_settle_way(skinslide_stage_patch *patch, skinslide_error *error) {
    return way_of(patch) == patch->way ? SKINSLIDE_OK : ss_settle_faces(patch, error);
}

const int32_t *skinslide_stage_patch_faces(const skinslide_stage_patch *patch, int32_t *face_count) {
    if (face_count)
        *face_count = patch->faces.count;
    return patch->faces.count ? patch->faces.values : NULL;
}
