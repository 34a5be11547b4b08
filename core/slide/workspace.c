/* What one thread needs to slide the patches of a slider. */
#include "slide.h"

#include <stdlib.h>

void ss_lay_out_displacement(ss_patch_work *work, const ss_patch *patch, ss_room *room) {
    work->displacement = ss_take_room(room, patch->free_count, sizeof *work->displacement);
    work->corner_weights = SS_TAKE(room, double, work->largest_face);
}

static skinslide_status make_patch_work(skinslide_workspace *workspace, int32_t p, skinslide_error *error) {
    const ss_part *part = &workspace->slider->parts[p];
    ss_memory *memory = &workspace->memory;
    ss_patch_work *work = &workspace->patches[p];
    int32_t edges = part->patch->faces.edge_count;
    work->lengths = SS_NEW(memory, double, edges);
    if (memory->failed)
        return ss_out_of_memory(error);
    ss_room counted = {0};
    work->largest_face = ss_largest_face(&part->patch->faces);
    ss_lay_out_displacement(work, part->patch, &counted);
    ss_ask_room(&workspace->room, &counted);
    ss_begin_turn(&counted);
    ss_take_room(&counted, edges, sizeof(ss_edge_paint));
    ss_ask_room(&workspace->room, &counted);
    ss_begin_turn(&counted);
    ss_take_room(&counted, part->patch->vertex_count, sizeof(double[4]));
    SS_TAKE(&counted, double, edges);
    ss_ask_room(&workspace->room, &counted);
    skinslide_status status = part->rest->rule->open(part->rest, &workspace->room, workspace->idbuffer, p, &work->slide, error);
    if (!status && part->cage)
        status = ss_cage_work_create(part->cage, &work->cage, error);
    return status;
}

skinslide_status ss_need_controls(skinslide_workspace *workspace, skinslide_error *error) {
    ss_memory *memory = &workspace->controlling;
    for (int32_t p = 0; p < workspace->slider->part_count && !workspace->has_controls; p++) {
        const ss_patch *patch = workspace->slider->parts[p].patch;
        ss_patch_work *work = &workspace->patches[p];
        work->own_paint = SS_NEW(memory, double, patch->faces.edge_count);
        work->own_weights = SS_NEW(memory, double, patch->free_count);
        work->own_limits = SS_NEW(memory, double, patch->free_count);
        work->own_holds = SS_NEW(memory, double, patch->vertex_count);
    }
    workspace->has_controls = !memory->failed;
    if (memory->failed)
        ss_free(memory), memory->failed = false;
    return workspace->has_controls ? SKINSLIDE_OK : ss_out_of_memory(error);
}

skinslide_status ss_workspace_create(const skinslide_slider *slider, const skinslide_workspace_options *options,
                                     ss_egl_loader load, skinslide_workspace **out, skinslide_error *error) {
    if (!slider || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no slider, or no place for the workspace");
    skinslide_workspace *workspace = calloc(1, sizeof *workspace);
    if (!workspace)
        return ss_out_of_memory(error);
    workspace->slider = slider;
    workspace->patches = SS_NEW(&workspace->memory, ss_patch_work, slider->part_count);
    workspace->results = SS_NEW(&workspace->memory, skinslide_patch_result, slider->part_count);
    workspace->controls = SS_NEW(&workspace->memory, skinslide_controls, slider->setup_count);
    if (slider->space) {
        workspace->before = SS_NEW(&workspace->memory, float, 3 * (int64_t)slider->vertex_count);
        workspace->after = SS_NEW(&workspace->memory, float, 3 * (int64_t)slider->vertex_count);
    }
    workspace->sum = ss_new(&workspace->memory, slider->vertex_count, sizeof *workspace->sum);
    workspace->landed = ss_new(&workspace->memory, slider->own.count, sizeof *workspace->landed);
    skinslide_status status = workspace->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        status = ss_workspace_open_lookup(workspace, options, load, error);
    for (int32_t p = 0; p < slider->part_count && !status; p++)
        status = make_patch_work(workspace, p, error);
    if (!status && !ss_make_room(&workspace->room))
        status = ss_out_of_memory(error);
    if (status)
        skinslide_workspace_destroy(workspace);
    else
        *out = workspace;
    return status;
}

skinslide_status skinslide_workspace_create(const skinslide_slider *slider, const skinslide_workspace_options *options,
                                            skinslide_workspace **out, skinslide_error *error) {
    return ss_workspace_create(slider, options, ss_egl_load, out, error);
}

void skinslide_workspace_interrupt(skinslide_workspace *workspace) {
    if (workspace)
        ss_set(&workspace->stop, 1);
}

void skinslide_workspace_destroy(skinslide_workspace *workspace) {
    if (!workspace)
        return;
    for (int32_t p = 0; workspace->patches && p < workspace->slider->part_count; p++) {
        ss_cage_work_destroy(workspace->patches[p].cage);
        if (workspace->patches[p].slide)
            workspace->slider->parts[p].rest->rule->close(workspace->patches[p].slide);
    }
    ss_idbuffer_destroy(workspace->idbuffer);
    ss_free(&workspace->room.memory);
    ss_free(&workspace->controlling);
    ss_free(&workspace->turning);
    ss_free(&workspace->memory);
    free(workspace);
}
