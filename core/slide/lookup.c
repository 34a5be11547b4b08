/* Which lookup a workspace has: what its options lead to on this machine. */
#include "slide.h"

#include <stdio.h>
#include <string.h>

static skinslide_status check_options(const skinslide_workspace_options *options, skinslide_error *error) {
    if ((unsigned)options->lookup > SKINSLIDE_LOOKUP_EXACT)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such lookup: %d", (int)options->lookup);
    if (options->resolution < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such resolution: %d", options->resolution);
    return ss_egl_check_device(options->device, error);
}

/* Makes the buffer that options ask for, or none if AUTO leads to EXACT, and says so in info. For AUTO, any fault of EGL is as
 * if there were none, and so is a resolution that its device lacks; but a lack of memory is an error. */
static skinslide_status open_lookup(const skinslide_workspace_options *options, ss_egl_loader load, const ss_id_patch *patches,
                                    int32_t patch_count, ss_idbuffer **out, skinslide_lookup_info *info,
                                    skinslide_error *error) {
    skinslide_workspace_options own = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    skinslide_status status = ss_take(options, "skinslide_workspace_options", &own, sizeof own, error);
    if (!status)
        status = check_options(&own, error);
    if (status)
        return status;
    *info = (skinslide_lookup_info)SKINSLIDE_LOOKUP_INFO_DEFAULT;
    if (own.lookup == SKINSLIDE_LOOKUP_EXACT)
        return SKINSLIDE_OK;
    ss_device_request request = {load, own.device, own.lookup == SKINSLIDE_LOOKUP_AUTO};
    skinslide_error why = {0};
    status = ss_idbuffer_create(&request, patches, patch_count, own.resolution, out, &why);
    if (!status)
        info->lookup = SKINSLIDE_LOOKUP_EGL;
    bool absent = status == SKINSLIDE_NO_DEVICE || status == SKINSLIDE_DEVICE_FAILED || status == SKINSLIDE_BAD_ARGUMENT;
    if (own.lookup == SKINSLIDE_LOOKUP_AUTO && absent) {
        memcpy(info->reason, why.message, sizeof info->reason);
        return SKINSLIDE_OK;
    }
    if (status == SKINSLIDE_OUT_OF_MEMORY)
        return ss_out_of_memory(error);
    const char *name = own.lookup == SKINSLIDE_LOOKUP_EGL ? "egl" : "auto";
    return status ? ss_fail(error, status, "lookup %s: %s", name, why.message) : SKINSLIDE_OK;
}

static skinslide_status check_places(const skinslide_lookup_info *info, const skinslide_device_info *device,
                                     skinslide_error *error) {
    skinslide_status status = ss_check_size(info, "skinslide_lookup_info", error);
    return status || !device ? status : ss_check_size(device, "skinslide_device_info", error);
}

/* buffer is NULL where the lookup is EXACT. */
static void answer(const skinslide_lookup_info *chosen, const ss_idbuffer *buffer, skinslide_lookup_info *info,
                   skinslide_device_info *device) {
    const skinslide_device_info none = SKINSLIDE_DEVICE_INFO_DEFAULT;
    skinslide_lookup_info own = *chosen;
    if (buffer)
        snprintf(own.reason, sizeof own.reason, "%s", ss_idbuffer_reason(buffer));
    ss_give(&own, sizeof own, info);
    if (device)
        ss_give(buffer ? ss_idbuffer_device(buffer) : &none, sizeof none, device);
}

skinslide_status skinslide_choose_lookup(const skinslide_workspace_options *options, skinslide_lookup_info *info,
                                         skinslide_device_info *device, skinslide_error *error) {
    ss_idbuffer *buffer = NULL;
    skinslide_lookup_info chosen;
    if (!info)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the answer");
    skinslide_status status = check_places(info, device, error);
    if (!status)
        status = open_lookup(options, ss_egl_load, NULL, 0, &buffer, &chosen, error);
    if (!status)
        answer(&chosen, buffer, info, device);
    ss_idbuffer_destroy(buffer);
    return status;
}

skinslide_status skinslide_workspace_lookup(const skinslide_workspace *workspace, skinslide_lookup_info *info,
                                            skinslide_device_info *device, skinslide_error *error) {
    if (!workspace || !info)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no workspace, or no place for the answer");
    skinslide_status status = check_places(info, device, error);
    if (!status)
        answer(&workspace->lookup, workspace->idbuffer, info, device);
    return status;
}

/* Of each patch what is drawn: [part_count]. A patch without a plane has the smallest texture, and nothing in it. */
static void describe_patches(const skinslide_slider *slider, ss_id_patch *patches) {
    for (int32_t p = 0; p < slider->part_count; p++) {
        const ss_part *part = &slider->parts[p];
        int32_t side = part->rest->uv ? ss_id_side(part->patch, part->rest->uv) : 1;
        patches[p] = (ss_id_patch){&part->patch->faces, part->patch->free_count, side};
    }
}

skinslide_status ss_workspace_open_lookup(skinslide_workspace *workspace, const skinslide_workspace_options *options,
                                          ss_egl_loader load, skinslide_error *error) {
    const skinslide_slider *slider = workspace->slider;
    ss_memory scratch = {0};
    ss_id_patch *patches = SS_NEW(&scratch, ss_id_patch, slider->part_count);
    if (!patches)
        return ss_out_of_memory(error);
    describe_patches(slider, patches);
    skinslide_status status =
        open_lookup(options, load, patches, slider->part_count, &workspace->idbuffer, &workspace->lookup, error);
    ss_free(&scratch);
    return status;
}
