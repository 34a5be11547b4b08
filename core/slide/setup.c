/* Builds a slider from its set-ups. */
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

static bool is_edge_of(const skinslide_slider *slider, int32_t setup, int32_t a, int32_t b) {
    for (int32_t p = slider->first_part[setup]; p < slider->first_part[setup + 1]; p++)
        if (ss_patch_mesh_edge(slider->parts[p].patch, a, b) >= 0)
            return true;
    return false;
}

/* Every pair must be an edge of a piece of the set-up, and be there once. */
static skinslide_status check_edges(const skinslide_slider *slider, int32_t setup, const skinslide_controls *controls,
                                    skinslide_error *error) {
    const char *name = slider->setups[setup].name;
    ss_memory scratch = {0};
    if (controls->edge_count == 0)
        return SKINSLIDE_OK;
    int32_t(*pairs)[2] = ss_new(&scratch, controls->edge_count, sizeof *pairs);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t i = 0; i < controls->edge_count && !status; i++) {
        int32_t a = controls->edges[2 * i], b = controls->edges[2 * i + 1];
        pairs[i][0] = a < b ? a : b, pairs[i][1] = a < b ? b : a;
        if (!is_edge_of(slider, setup, a, b))
            status = ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: %d-%d is not an edge of the patch", name, a, b);
    }
    if (!status)
        qsort(pairs, (size_t)controls->edge_count, sizeof *pairs, ss_ascending_pairs);
    for (int32_t i = 1; i < controls->edge_count && !status; i++)
        if (ss_ascending_pairs(pairs[i], pairs[i - 1]) == 0) {
            char label[160], edge[40];
            ss_label(&slider->setups[setup], 0, 1, label, sizeof label);
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
        status = ss_check_controls(&mesh, slider->setups[i].name, &controls[i], error);
        if (!status)
            status = check_edges(slider, i, &controls[i], error);
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

/* False where memory is short. */
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

static skinslide_status split(const skinslide_slider *slider, const skinslide_mesh *mesh, const skinslide_patch_setup *setup,
                              split_faces *out, skinslide_error *error) {
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
    status = ss_take_faces(mesh, slider->face_start, sorted, setup->face_count, label, memory, &faces, error);
    if (status)
        return status;
    out->count = ss_number_pieces(&faces, piece_of_face, stack);
    return sort_by_piece(sorted, piece_of_face, setup->face_count, out, error);
}

/* What the limit surface asks for beyond prepare(). */
static skinslide_status add_cage(const skinslide_slider *slider, const skinslide_mesh *mesh, ss_part *part,
                                 skinslide_error *error) {
    if (part->patch->setup->interpolation != SKINSLIDE_INTERPOLATION_LIMIT)
        return SKINSLIDE_OK;
    return ss_cage_create(slider->topology, part->patch, mesh->rest_points, mesh->subdivision->scheme == SKINSLIDE_SCHEME_LOOP,
                          &part->cage, error);
}

/* Appends a part to the slider for one piece of a set-up. */
static skinslide_status add_piece(skinslide_slider *slider, const skinslide_mesh *mesh, int32_t setup,
                                  const split_faces *pieces, int32_t piece, skinslide_error *error) {
    const int32_t *faces = pieces->faces + pieces->start[piece];
    int32_t face_count = pieces->start[piece + 1] - pieces->start[piece];
    ss_part *part = &slider->parts[slider->part_count];
    skinslide_status status = ss_patch_create(mesh, slider->face_start, &slider->setups[setup], setup, faces, face_count, piece,
                                              pieces->count, &part->patch, error);
    if (!status) {
        slider->part_count++;
        status = prepare(&slider->memory, part, mesh, slider->setups[setup].controls, error);
    }
    if (!status)
        status = add_cage(slider, mesh, part, error);
    return status;
}

/* Corners must be those of one of the set-up's pieces. */
static skinslide_status check_corners(const skinslide_slider *slider, int32_t setup, skinslide_error *error) {
    const int32_t *corners = slider->setups[setup].corners;
    if (!corners)
        return SKINSLIDE_OK;
    for (int32_t p = slider->first_part[setup]; p < slider->part_count; p++)
        if (ss_has_corners(slider->parts[p].patch))
            return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_CONTROL, "patch %s: corners %d, %d, %d and %d are not all on one of its pieces",
                   slider->setups[setup].name, corners[0], corners[1], corners[2], corners[3]);
}

static skinslide_status need_topology(skinslide_slider *slider, const skinslide_mesh *mesh, skinslide_error *error) {
    if (slider->topology)
        return SKINSLIDE_OK;
    skinslide_status status = ss_check_subdivision(mesh, error);
    return status ? status : ss_topology_create(mesh, &slider->topology, error);
}

static skinslide_status grow_parts(skinslide_slider *slider, int32_t count, skinslide_error *error) {
    int32_t wanted = slider->part_count + count;
    if (wanted <= slider->part_room)
        return SKINSLIDE_OK;
    slider->part_room = wanted > 2 * slider->part_count ? wanted : 2 * slider->part_count;
    ss_part *parts = SS_NEW(&slider->memory, ss_part, slider->part_room);
    if (!parts)
        return ss_out_of_memory(error);
    if (slider->part_count > 0)
        memcpy(parts, slider->parts, (size_t)slider->part_count * sizeof *parts);
    slider->parts = parts;
    return SKINSLIDE_OK;
}

static skinslide_status add_setup(skinslide_slider *slider, const skinslide_mesh *mesh, int32_t setup, skinslide_error *error) {
    const skinslide_patch_setup *own = &slider->setups[setup];
    split_faces pieces = {0};
    skinslide_status status = check_choices(mesh, own, error);
    if (!status && own->interpolation == SKINSLIDE_INTERPOLATION_LIMIT)
        status = need_topology(slider, mesh, error);
    if (!status)
        status = split(slider, mesh, own, &pieces, error);
    if (!status)
        status = ss_check_controls(mesh, own->name, own->controls, error);
    if (!status)
        status = grow_parts(slider, pieces.count, error);
    for (int32_t piece = 0; piece < pieces.count && !status; piece++)
        status = add_piece(slider, mesh, setup, &pieces, piece, error);
    slider->first_part[setup + 1] = slider->part_count;
    if (!status)
        status = check_corners(slider, setup, error);
    if (!status)
        status = check_edges(slider, setup, own->controls, error);
    ss_free(&pieces.memory);
    return status;
}

/* ---- The slider ---- */

static skinslide_interpolation choose_interpolation(const skinslide_mesh *mesh, const skinslide_patch_setup *setup) {
    if (setup->interpolation != SKINSLIDE_INTERPOLATION_AUTO)
        return setup->interpolation;
    return ss_is_subdivided(mesh) ? SKINSLIDE_INTERPOLATION_LIMIT : SKINSLIDE_INTERPOLATION_LINEAR;
}

static skinslide_status copy_setups(skinslide_slider *slider, const skinslide_mesh *mesh, const skinslide_patch_setup *setups,
                                    skinslide_error *error) {
    const skinslide_patch_setup standard = SKINSLIDE_PATCH_SETUP_DEFAULT;
    int32_t count = slider->setup_count;
    skinslide_controls *controls = SS_NEW(&slider->memory, skinslide_controls, count);
    slider->setups = SS_NEW(&slider->memory, skinslide_patch_setup, count);
    slider->first_part = SS_NEW(&slider->memory, int32_t, (int64_t)count + 1);
    if (slider->memory.failed)
        return ss_out_of_memory(error);
    skinslide_status status =
        ss_take_all(setups, count, "skinslide_patch_setup", slider->setups, sizeof standard, &standard, error);
    for (int32_t i = 0; i < count && !status; i++) {
        skinslide_patch_setup *own = &slider->setups[i];
        const char *name = own->name ? own->name : "";
        char *copy = SS_NEW(&slider->memory, char, (int64_t)strlen(name) + 1);
        controls[i] = (skinslide_controls)SKINSLIDE_CONTROLS_DEFAULT;
        status = copy ? ss_take(own->controls, "skinslide_controls", &controls[i], sizeof *controls, error)
                      : ss_out_of_memory(error);
        own->name = copy ? strcpy(copy, name) : copy;
        own->interpolation = choose_interpolation(mesh, own);
        own->controls = &controls[i];
    }
    return status;
}

/* The faces that smooth normals of the patches are made of, and the points of those. */
static skinslide_status take_around(skinslide_slider *slider, const skinslide_mesh *mesh, skinslide_error *error) {
    ss_memory scratch = {0};
    uint8_t *chosen = SS_NEW(&scratch, uint8_t, mesh->vertex_count);
    for (int32_t p = 0; p < slider->part_count && chosen; p++)
        for (int32_t v = 0; v < slider->parts[p].patch->vertex_count; v++)
            chosen[slider->parts[p].patch->mesh_vertex[v]] = 1;
    bool done =
        chosen && ss_take_around(mesh, chosen, &slider->memory, &slider->around) && ss_list_vertices(slider, mesh, chosen);
    ss_free(&scratch);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}

/* The mesh's weld is the slider's from here on: patches keep it. */
static skinslide_status copy_weld(skinslide_slider *slider, skinslide_mesh *mesh, skinslide_error *error) {
    if (!mesh->weld)
        return SKINSLIDE_OK;
    slider->weld = SS_NEW(&slider->memory, int32_t, mesh->vertex_count);
    if (!slider->weld)
        return ss_out_of_memory(error);
    memcpy(slider->weld, mesh->weld, (size_t)mesh->vertex_count * sizeof *slider->weld);
    mesh->weld = slider->weld;
    return SKINSLIDE_OK;
}

/* Rest is where lengths are taken from here on, in memory of its own. */
static skinslide_status bring_rest(const skinslide_slider *slider, skinslide_mesh *mesh, ss_memory *memory,
                                   skinslide_error *error) {
    float *room = slider->space ? SS_NEW(memory, float, 3 * (int64_t)mesh->vertex_count) : NULL;
    if (memory->failed)
        return ss_out_of_memory(error);
    ss_bring(slider, &mesh->rest_points, room);
    return slider->space ? ss_check_points(mesh->rest_points, mesh->vertex_count, "rest points where lengths are taken", error)
                         : SKINSLIDE_OK;
}

/* Drops pointers to what is the caller's. */
static void forget_arrays(skinslide_slider *slider) {
    for (int32_t i = 0; i < slider->setup_count; i++) {
        slider->setups[i].faces = slider->setups[i].corners = NULL;
        slider->setups[i].controls = NULL;
        slider->setups[i].held = NULL;
    }
}

skinslide_status skinslide_slider_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t setup_count,
                                         skinslide_slider **out, skinslide_error *error) {
    if (!out || setup_count < 0 || (setup_count > 0 && !setups))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the slider, or no patches");
    ss_taken_mesh taken;
    skinslide_status status = ss_take_mesh(&mesh, &taken, error);
    if (!status)
        status = ss_check_points(mesh->rest_points, mesh->vertex_count, "rest points", error);
    if (status)
        return status;
    skinslide_slider *slider = calloc(1, sizeof *slider);
    ss_memory scratch = {0};
    if (!slider)
        return ss_out_of_memory(error);
    slider->vertex_count = mesh->vertex_count, slider->face_count = mesh->face_count, slider->setup_count = setup_count;
    status = copy_weld(slider, &taken.mesh, error);
    if (!status)
        status = ss_take_space(slider, mesh, error);
    if (!status)
        status = bring_rest(slider, &taken.mesh, &scratch, error);
    if (!status)
        status = copy_setups(slider, mesh, setups, error);
    if (!status && !(slider->face_start = ss_list_starts(mesh, &scratch)))
        status = ss_out_of_memory(error);
    for (int32_t i = 0; i < setup_count && !status; i++)
        status = add_setup(slider, mesh, i, error);
    if (!status)
        status = take_around(slider, mesh, error);
    ss_topology_destroy(slider->topology);
    slider->topology = NULL, slider->face_start = NULL;
    ss_free(&scratch);
    if (status) {
        skinslide_slider_destroy(slider);
        return status;
    }
    forget_arrays(slider);
    *out = slider;
    return SKINSLIDE_OK;
}

void skinslide_slider_destroy(skinslide_slider *slider) {
    if (!slider)
        return;
    for (int32_t p = 0; p < slider->part_count; p++) {
        ss_cage_destroy(slider->parts[p].cage);
        if (slider->parts[p].rest)
            slider->parts[p].rest->rule->destroy(slider->parts[p].rest);
        ss_patch_destroy(slider->parts[p].patch);
    }
    ss_free(&slider->memory);
    free(slider);
}
