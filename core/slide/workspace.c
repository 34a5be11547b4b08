/* What one thread needs to slide the patches of a slider. */
#include "slider.h"

#include <stdlib.h>
#include <string.h>

static skinslide_status make_patch_work(ss_memory *memory, const ss_part *part, ss_patch_work *work, skinslide_error *error) {
    const ss_patch *patch = part->patch;
    int32_t edges = patch->faces.edge_count, vertices = patch->vertex_count, free_count = patch->free_count;
    work->own_paint = SS_NEW(memory, double, edges);
    work->own_weights = SS_NEW(memory, double, free_count);
    work->own_limits = SS_NEW(memory, double, free_count);
    work->own_rest_uv = ss_new(memory, vertices, sizeof *work->own_rest_uv);
    work->lengths = SS_NEW(memory, double, edges);
    work->density = SS_NEW(memory, double, edges);
    work->uv = ss_new(memory, vertices, sizeof *work->uv);
    work->queries = ss_new(memory, free_count, sizeof *work->queries);
    work->locations = SS_NEW(memory, ss_location, free_count);
    work->displacement = ss_new(memory, free_count, sizeof *work->displacement);
    work->corner_weights = SS_NEW(memory, double, ss_largest_face(&patch->faces));
    if (memory->failed)
        return ss_out_of_memory(error);
    memcpy(work->uv, patch->fixed_uv, (size_t)vertices * sizeof *work->uv);
    memcpy(work->own_rest_uv, patch->fixed_uv, (size_t)vertices * sizeof *work->own_rest_uv);
    skinslide_status status = ss_factor_create(part->system, &work->factor, error);
    if (!status && part->cage)
        status = ss_cage_work_create(part->cage, &work->cage, error);
    if (!status)
        status = ss_locator_create(patch, &work->locator, error);
    if (!status)
        status = ss_traveller_create(part->triangles, &work->traveller, error);
    if (!status && patch->setup->rule == SKINSLIDE_RULE_RELAXED)
        status = ss_relaxer_create(part->chart, part->system, &work->relaxer, error);
    return status;
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
    workspace->sum = ss_new(&workspace->memory, slider->vertex_count, sizeof *workspace->sum);
    skinslide_status status = workspace->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t p = 0; p < slider->part_count && !status; p++)
        status = make_patch_work(&workspace->memory, &slider->parts[p], &workspace->patches[p], error);
    if (!status)
        status = ss_workspace_open_lookup(workspace, options, load, error);
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

void skinslide_workspace_destroy(skinslide_workspace *workspace) {
    if (!workspace)
        return;
    ss_idbuffer_destroy(workspace->idbuffer);
    for (int32_t p = 0; workspace->patches && p < workspace->slider->part_count; p++) {
        ss_factor_destroy(workspace->patches[p].factor);
        ss_locator_destroy(workspace->patches[p].locator);
        ss_cage_work_destroy(workspace->patches[p].cage);
        ss_relaxer_destroy(workspace->patches[p].relaxer);
        ss_traveller_destroy(workspace->patches[p].traveller);
    }
    ss_free(&workspace->memory);
    free(workspace);
}
