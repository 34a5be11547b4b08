/* Builds a slider: what its set-ups share, then the parts of each, by any thread, and in the end what is known of all of
 * them. */
#include "slide.h"

#include <stdlib.h>
#include <string.h>

/* ---- What set-ups share ---- */

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
    return slider->space ? ss_check_used(mesh, mesh->rest_points, "rest points where lengths are taken", error) : SKINSLIDE_OK;
}

/* Drops pointers to what is the caller's. */
static void forget_arrays(skinslide_slider *slider) {
    for (int32_t i = 0; i < slider->setup_count; i++) {
        slider->setups[i].faces = slider->setups[i].corners = NULL;
        slider->setups[i].controls = NULL;
        slider->setups[i].held = NULL;
    }
}

/* A fault is that of the first set-up that wants it. */
static void take_topology(skinslide_build *build) {
    const skinslide_slider *slider = build->slider;
    const skinslide_mesh *mesh = &build->taken.mesh;
    bool wanted = false;
    for (int32_t i = 0; i < slider->setup_count; i++)
        wanted = wanted || slider->setups[i].interpolation == SKINSLIDE_INTERPOLATION_LIMIT;
    if (!wanted || !ss_is_subdivided(mesh))
        return;
    build->topology_status = ss_check_subdivision(mesh, &build->topology_error);
    if (!build->topology_status)
        build->topology_status = ss_topology_create(mesh, &build->topology, &build->topology_error);
}

/* All of a slider but its parts; the mesh is taken. */
static skinslide_status begin(skinslide_build *build, const skinslide_patch_setup *setups, int32_t setup_count,
                              skinslide_error *error) {
    skinslide_mesh *mesh = &build->taken.mesh;
    skinslide_slider *slider = build->slider = calloc(1, sizeof *slider);
    build->built = SS_NEW(&build->memory, ss_built, setup_count);
    if (!slider || !build->built)
        return ss_out_of_memory(error);
    slider->vertex_count = mesh->vertex_count, slider->face_count = mesh->face_count, slider->setup_count = setup_count;
    skinslide_status status = copy_weld(slider, mesh, error);
    if (!status)
        status = ss_take_space(slider, mesh, error);
    if (!status)
        status = bring_rest(slider, mesh, &build->memory, error);
    if (!status)
        status = copy_setups(slider, mesh, setups, error);
    if (!status && !(build->face_start = ss_list_starts(mesh, &build->memory)))
        status = ss_out_of_memory(error);
    if (!status)
        take_topology(build);
    return status;
}

skinslide_status skinslide_build_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t setup_count,
                                        skinslide_build **out, skinslide_error *error) {
    if (!out || setup_count < 0 || (setup_count > 0 && !setups))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the slider, or no patches");
    skinslide_build *build = calloc(1, sizeof *build);
    if (!build)
        return ss_out_of_memory(error);
    skinslide_status status = ss_take_mesh(&mesh, &build->taken, error);
    if (!status)
        status = ss_check_used(mesh, mesh->rest_points, "rest points", error);
    if (!status)
        status = begin(build, setups, setup_count, error);
    if (status)
        skinslide_build_destroy(build);
    else
        *out = build;
    return status;
}

/* ---- Set-ups ---- */

void skinslide_build_setup(skinslide_build *build, int32_t setup) {
    bool is_there = build && build->slider && setup >= 0 && setup < build->slider->setup_count;
    if (is_there && !build->built[setup].done)
        ss_build_setup(build, setup, &build->built[setup], NULL);
}

/* Those that are not built, or failed, in order: what is wrong is said of the first. */
static skinslide_status build_others(skinslide_build *build, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t i = 0; i < build->slider->setup_count && !status; i++)
        if (!build->built[i].done)
            status = ss_build_setup(build, i, &build->built[i], error);
    return status;
}

/* ---- The whole ---- */

/* The slider has all parts from here on. */
static skinslide_status gather(skinslide_build *build, skinslide_error *error) {
    skinslide_slider *slider = build->slider;
    for (int32_t i = 0; i < slider->setup_count; i++)
        slider->first_part[i + 1] = slider->first_part[i] + build->built[i].part_count;
    slider->parts = SS_NEW(&slider->memory, ss_part, slider->first_part[slider->setup_count]);
    if (!slider->parts)
        return ss_out_of_memory(error);
    for (int32_t i = 0; i < slider->setup_count; i++) {
        ss_built *built = &build->built[i];
        memcpy(slider->parts + slider->first_part[i], built->parts, (size_t)built->part_count * sizeof *built->parts);
        ss_adopt(&slider->memory, &built->memory);
        *built = (ss_built){0};
    }
    slider->part_count = slider->first_part[slider->setup_count];
    return SKINSLIDE_OK;
}

skinslide_status skinslide_build_finish(skinslide_build *build, skinslide_slider **out, skinslide_error *error) {
    if (!build || !build->slider || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing that is being built, or no place for it");
    skinslide_status status = build_others(build, error);
    if (!status)
        status = gather(build, error);
    if (!status)
        status = take_around(build->slider, &build->taken.mesh, error);
    if (status)
        return status;
    forget_arrays(build->slider);
    *out = build->slider;
    build->slider = NULL;
    return SKINSLIDE_OK;
}

skinslide_status skinslide_slider_create(const skinslide_mesh *mesh, const skinslide_patch_setup *setups, int32_t setup_count,
                                         skinslide_slider **out, skinslide_error *error) {
    skinslide_build *build = NULL;
    skinslide_status status = skinslide_build_create(mesh, setups, setup_count, out ? &build : NULL, error);
    if (!status)
        status = skinslide_build_finish(build, out, error);
    skinslide_build_destroy(build);
    return status;
}

/* ---- The end ---- */

void ss_destroy_parts(ss_part *parts, int32_t count) {
    for (int32_t p = 0; p < count; p++) {
        ss_cage_destroy(parts[p].cage);
        if (parts[p].rest)
            parts[p].rest->rule->destroy(parts[p].rest);
        ss_patch_destroy(parts[p].patch);
    }
}

void skinslide_slider_destroy(skinslide_slider *slider) {
    if (!slider)
        return;
    ss_destroy_parts(slider->parts, slider->part_count);
    ss_free(&slider->memory);
    free(slider);
}

void skinslide_build_destroy(skinslide_build *build) {
    if (!build)
        return;
    for (int32_t i = 0; build->slider && build->built && i < build->slider->setup_count; i++) {
        ss_destroy_parts(build->built[i].parts, build->built[i].part_count);
        ss_free(&build->built[i].memory);
    }
    skinslide_slider_destroy(build->slider);
    ss_topology_destroy(build->topology);
    ss_free(&build->memory);
    free(build);
}
