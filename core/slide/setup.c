/* From a set-up to its parts: checked, in connected pieces, and what its rule makes of each at rest. */
#include "slide.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Checks of a set-up ---- */

static skinslide_status check_choices(const skinslide_mesh *mesh, const skinslide_patch_setup *setup, skinslide_error *error) {
    if ((unsigned)setup->boundary > SKINSLIDE_BOUNDARY_CIRCLE || (unsigned)setup->holes > SKINSLIDE_HOLES_FREE_ALL ||
        (unsigned)setup->rule > SKINSLIDE_RULE_EVEN || (unsigned)setup->interpolation > SKINSLIDE_INTERPOLATION_LIMIT)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "patch %s: no such boundary, holes, rule or interpolation", setup->name);
    if (setup->interpolation == SKINSLIDE_INTERPOLATION_LIMIT && !ss_is_subdivided(mesh))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: interpolation limit needs a mesh that is subdivided",
                       setup->name);
    if (setup->holes == SKINSLIDE_HOLES_FREE_ALL && ss_has_plane(setup->rule))
        return ss_fail(error, SKINSLIDE_UNSUPPORTED,
                       "patch %s: holes freeAll, which frees the outer boundary too, needs rule relaxed or even", setup->name);
    return SKINSLIDE_OK;
}

/* Sorts the set-up's faces into sorted [face_count]. */
static skinslide_status sort_faces(const skinslide_mesh *mesh, const skinslide_patch_setup *setup, int32_t *sorted,
                                   skinslide_error *error) {
    char label[160], what[sizeof label + 8], element[24];
    ss_label(setup, 0, 1, label, sizeof label);
    snprintf(what, sizeof what, "%s: face ", label);
    skinslide_status status =
        ss_check_members(setup->faces, setup->face_count, mesh->face_count, what, SKINSLIDE_BAD_PATCH, error);
    if (status)
        return status;
    memcpy(sorted, setup->faces, (size_t)setup->face_count * sizeof *sorted);
    qsort(sorted, (size_t)setup->face_count, sizeof *sorted, ss_ascending);
    for (int32_t i = 1; i < setup->face_count && !status; i++)
        if (sorted[i] == sorted[i - 1]) {
            snprintf(element, sizeof element, "face %d", sorted[i]);
            status = ss_refuse_repeated(label, element, SKINSLIDE_BAD_PATCH, error);
        }
    return status;
}

static bool is_edge_of(const ss_part *parts, int32_t part_count, int32_t a, int32_t b) {
    for (int32_t p = 0; p < part_count; p++)
        if (ss_patch_mesh_edge(parts[p].patch, a, b) >= 0)
            return true;
    return false;
}

/* Every pair must be an edge of a piece of the set-up, and be there once. */
static skinslide_status check_edges(const skinslide_patch_setup *setup, const ss_part *parts, int32_t part_count,
                                    const skinslide_controls *controls, skinslide_error *error) {
    ss_memory scratch = {0};
    if (controls->edge_count == 0)
        return SKINSLIDE_OK;
    int32_t(*pairs)[2] = ss_new(&scratch, controls->edge_count, sizeof *pairs);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t i = 0; i < controls->edge_count && !status; i++) {
        int32_t a = controls->edges[2 * i], b = controls->edges[2 * i + 1];
        pairs[i][0] = a < b ? a : b, pairs[i][1] = a < b ? b : a;
        if (!is_edge_of(parts, part_count, a, b))
            status = ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: %d-%d is not an edge of the patch", setup->name, a, b);
    }
    if (!status)
        qsort(pairs, (size_t)controls->edge_count, sizeof *pairs, ss_ascending_pairs);
    for (int32_t i = 1; i < controls->edge_count && !status; i++)
        if (ss_ascending_pairs(pairs[i], pairs[i - 1]) == 0) {
            char label[160], edge[40];
            ss_label(setup, 0, 1, label, sizeof label);
            snprintf(edge, sizeof edge, "edge %d-%d", pairs[i][0], pairs[i][1]);
            status = ss_refuse_repeated(label, edge, SKINSLIDE_BAD_CONTROL, error);
        }
    ss_free(&scratch);
    return status;
}

skinslide_status ss_take_frame_controls(const skinslide_slider *slider, const skinslide_controls *given,
                                        skinslide_controls *controls, skinslide_error *error) {
    const skinslide_controls standard = SKINSLIDE_CONTROLS_DEFAULT;
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    mesh.vertex_count = slider->vertex_count, mesh.face_count = slider->face_count;
    skinslide_status status =
        ss_take_all(given, slider->setup_count, "skinslide_controls", controls, sizeof standard, &standard, error);
    for (int32_t i = 0; i < slider->setup_count && !status; i++) {
        const int32_t *first = &slider->first_part[i];
        status = ss_check_controls(&mesh, slider->setups[i].name, &controls[i], error);
        if (!status)
            status = check_edges(&slider->setups[i], slider->parts + first[0], first[1] - first[0], &controls[i], error);
    }
    return status;
}

/* ---- Parts ---- */

static const ss_rule *rule_of(skinslide_rule rule) {
    static const ss_rule *const rules[] = {[SKINSLIDE_RULE_UNIT] = &ss_plane_rule,
                                           [SKINSLIDE_RULE_FAST] = &ss_plane_rule,
                                           [SKINSLIDE_RULE_RELAXED] = &ss_relaxed_rule,
                                           [SKINSLIDE_RULE_EVEN] = &ss_even_rule};
    return rules[rule];
}

/* False if memory is short. */
static bool paint_part(ss_part *part, const skinslide_controls *controls) {
    ss_memory scratch = {0};
    ss_edge_paint *edges = SS_NEW(&scratch, ss_edge_paint, part->patch->faces.edge_count);
    if (edges)
        ss_paint(part->patch, controls, edges, part->paint);
    ss_free(&scratch);
    return !scratch.failed;
}

/* From a patch to a part: its controls, and what its rule makes of it at rest. */
static skinslide_status prepare(ss_memory *memory, ss_part *part, const skinslide_mesh *mesh,
                                const skinslide_controls *controls, skinslide_error *error) {
    const ss_patch *patch = part->patch;
    part->paint = SS_NEW(memory, double, patch->faces.edge_count);
    part->weights = SS_NEW(memory, double, patch->free_count);
    part->limits = controls->max_distance ? SS_NEW(memory, double, patch->free_count) : NULL;
    part->holds = SS_NEW(memory, double, patch->vertex_count);
    if (memory->failed)
        return ss_out_of_memory(error);
    if (!paint_part(part, controls))
        return ss_out_of_memory(error);
    part->clamped_weights = ss_control_weights(patch, controls, part->weights);
    part->limited = part->limits && ss_control_limits(patch, controls, part->limits);
    ss_control_holds(patch, controls, part->holds);
    part->stretch_response = controls->stretch_response, part->compression_response = controls->compression_response;
    skinslide_status status = rule_of(patch->setup->rule)->create(patch, mesh->rest_points, part->paint, &part->rest, error);
    if (!status && part->rest->uv)
        part->rest_layout = ss_lay_out(patch, part->rest->uv);
    return status;
}

/* ---- From set-ups to pieces ---- */

/* Faces of one set-up, piece by piece, those of each ascending. */
typedef struct split_faces {
    ss_memory memory;
    int32_t count;
    int32_t *start; /* [count + 1] */
    int32_t *faces;
    int32_t *shared; /* [shared_count] vertices of several pieces, ascending */
    int32_t shared_count;
} split_faces;

/* Puts faces [face_count], which ascend, in the order of their pieces. */
static skinslide_status sort_by_piece(const int32_t *faces, const int32_t *piece_of_face, int32_t face_count, split_faces *out,
                                      skinslide_error *error) {
    out->start = SS_NEW(&out->memory, int32_t, (int64_t)out->count + 2);
    out->faces = SS_NEW(&out->memory, int32_t, face_count);
    if (out->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t i = 0; i < face_count; i++)
        out->start[piece_of_face[i] + 2]++;
    for (int32_t piece = 0; piece < out->count; piece++)
        out->start[piece + 2] += out->start[piece + 1];
    for (int32_t i = 0; i < face_count; i++)
        out->faces[out->start[piece_of_face[i] + 1]++] = faces[i];
    return SKINSLIDE_OK;
}

/* Pieces have no edge in common, but may touch in vertices. */
static skinslide_status list_shared(const ss_faces *faces, const int32_t *piece_of_face, split_faces *out,
                                    skinslide_error *error) {
    if (out->count == 1)
        return SKINSLIDE_OK;
    int32_t(*pairs)[2] = ss_new(&out->memory, faces->corner_count, sizeof *pairs);
    out->shared = SS_NEW(&out->memory, int32_t, faces->corner_count);
    if (out->memory.failed)
        return ss_out_of_memory(error);
    for (int32_t c = 0; c < faces->corner_count; c++)
        pairs[c][0] = faces->corner_vertex[c], pairs[c][1] = piece_of_face[faces->corner_face[c]];
    qsort(pairs, (size_t)faces->corner_count, sizeof *pairs, ss_ascending_pairs);
    for (int32_t c = 1, vertex; c < faces->corner_count; c++) {
        bool meets = (vertex = pairs[c][0]) == pairs[c - 1][0] && pairs[c][1] != pairs[c - 1][1];
        if (meets && (out->shared_count == 0 || out->shared[out->shared_count - 1] != vertex))
            out->shared[out->shared_count++] = vertex;
    }
    return SKINSLIDE_OK;
}

static skinslide_status split(const skinslide_build *build, const skinslide_patch_setup *setup, split_faces *out,
                              skinslide_error *error) {
    const skinslide_mesh *mesh = &build->taken.mesh;
    ss_memory *memory = &out->memory;
    ss_faces faces;
    char label[160];
    if (setup->face_count < 0 || (setup->face_count > 0 && !setup->faces))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "patch %s: no array of faces", setup->name);
    if (setup->face_count == 0)
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "patch %s: it has no faces", setup->name);
    int32_t *sorted = SS_NEW(memory, int32_t, setup->face_count);
    int32_t *piece_of_face = SS_NEW(memory, int32_t, setup->face_count), *stack = SS_NEW(memory, int32_t, setup->face_count);
    if (memory->failed)
        return ss_out_of_memory(error);
    skinslide_status status = sort_faces(mesh, setup, sorted, error);
    if (status)
        return status;
    ss_label(setup, 0, 1, label, sizeof label);
    status = ss_take_faces(mesh, build->face_start, sorted, setup->face_count, label, memory, &faces, error);
    if (status)
        return status;
    out->count = ss_number_pieces(&faces, piece_of_face, stack);
    status = sort_by_piece(sorted, piece_of_face, setup->face_count, out, error);
    return status ? status : list_shared(&faces, piece_of_face, out, error);
}

/* What the limit surface asks for beyond prepare(). */
static skinslide_status add_cage(const skinslide_build *build, ss_part *part, skinslide_error *error) {
    const skinslide_mesh *mesh = &build->taken.mesh;
    if (part->patch->setup->interpolation != SKINSLIDE_INTERPOLATION_LIMIT)
        return SKINSLIDE_OK;
    return ss_cage_create(build->topology, part->patch, mesh->rest_points, mesh->subdivision->scheme == SKINSLIDE_SCHEME_LOOP,
                          &part->cage, error);
}

/* Appends a part for one piece of a set-up. */
static skinslide_status add_piece(const skinslide_build *build, int32_t setup, const split_faces *pieces, ss_built *out,
                                  skinslide_error *error) {
    const skinslide_mesh *mesh = &build->taken.mesh;
    const skinslide_patch_setup *own = &build->slider->setups[setup];
    int32_t number = out->part_count, first = pieces->start[number], face_count = pieces->start[number + 1] - first;
    ss_piece piece = {pieces->faces + first, face_count, number, pieces->count, pieces->shared, pieces->shared_count};
    ss_part *part = &out->parts[number];
    skinslide_status status = ss_patch_create(mesh, build->face_start, own, setup, &piece, &part->patch, error);
    if (!status) {
        out->part_count++;
        status = prepare(&out->memory, part, mesh, own->controls, error);
    }
    if (!status)
        status = add_cage(build, part, error);
    return status;
}

static skinslide_status add_pieces(const skinslide_build *build, int32_t setup, const split_faces *pieces, ss_built *out,
                                   skinslide_error *error) {
    out->parts = SS_NEW(&out->memory, ss_part, pieces->count);
    skinslide_status status = out->parts ? SKINSLIDE_OK : ss_out_of_memory(error);
    for (int32_t piece = 0; piece < pieces->count && !status; piece++)
        status = add_piece(build, setup, pieces, out, error);
    return status;
}

/* Corners must be those of one of the set-up's pieces. */
static skinslide_status check_corners(const skinslide_patch_setup *setup, const ss_built *built, skinslide_error *error) {
    const int32_t *corners = setup->corners;
    if (!corners)
        return SKINSLIDE_OK;
    for (int32_t p = 0; p < built->part_count; p++)
        if (ss_has_corners(built->parts[p].patch))
            return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: corners %d, %d, %d and %d are not all on one of its pieces",
                   setup->name, corners[0], corners[1], corners[2], corners[3]);
}

static skinslide_status need_topology(const skinslide_build *build, skinslide_error *error) {
    if (error && build->topology_status)
        *error = build->topology_error;
    return build->topology_status;
}

static skinslide_status make_parts(const skinslide_build *build, int32_t setup, ss_built *out, skinslide_error *error) {
    const skinslide_patch_setup *own = &build->slider->setups[setup];
    const skinslide_mesh *mesh = &build->taken.mesh;
    split_faces pieces = {0};
    skinslide_status status = check_choices(mesh, own, error);
    if (!status && own->interpolation == SKINSLIDE_INTERPOLATION_LIMIT)
        status = need_topology(build, error);
    if (!status)
        status = split(build, own, &pieces, error);
    if (!status)
        status = ss_check_controls(mesh, own->name, own->controls, error);
    if (!status)
        status = add_pieces(build, setup, &pieces, out, error);
    if (!status)
        status = check_corners(own, out, error);
    if (!status)
        status = check_edges(own, out->parts, out->part_count, own->controls, error);
    ss_free(&pieces.memory);
    return status;
}

skinslide_status ss_build_setup(const skinslide_build *build, int32_t setup, ss_built *out, skinslide_error *error) {
    skinslide_status status = make_parts(build, setup, out, error);
    if (status) {
        ss_destroy_parts(out->parts, out->part_count);
        ss_free(&out->memory);
        *out = (ss_built){0};
    }
    out->done = !status;
    return status;
}
