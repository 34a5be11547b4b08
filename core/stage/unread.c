/* Finds the inputs of a patch that would have an effect, but that its rule does not read. */
#include "stage.h"

static bool patch_has(const skinslide_stage_patch *patch, const ss_input *input, int32_t row) {
    const ss_taken *taken = &patch->taken[row];
    switch (input->kind) {
    case SS_KIND_CHOICE:
        return taken->choice != 0; /* tokens begin with the fallback */
    case SS_KIND_NUMBER:
        return taken->number != input->fallback;
    default:
        return taken->array.count > 0;
    }
}

static bool has(const skinslide_stage_patch *patch, const skinslide_stage_controls *controls, const ss_input *input,
                int32_t row) {
    return input->shown.group == SKINSLIDE_STAGE_PATCH ? patch_has(patch, input, row) : ss_controls_have(controls, row);
}

const skinslide_stage_input *skinslide_stage_next_unread(const skinslide_stage_patch *patch,
                                                         const skinslide_stage_controls *controls,
                                                         const skinslide_stage_input *before) {
    if (!patch || !controls)
        return NULL;
    for (skinslide_stage_group group = before ? before->group : SKINSLIDE_STAGE_PATCH; group <= SKINSLIDE_STAGE_CONTROLS;
         group++) {
        int32_t count, row = before && before->group == group ? ss_row_of(group, before) + 1 : 0;
        for (const ss_input *inputs = ss_inputs(group, &count); row < count; row++)
            if (!ss_is_read_by(&inputs[row], patch->taken[SS_ROW_RULE].choice) && has(patch, controls, &inputs[row], row))
                return &inputs[row].shown;
    }
    return NULL;
}
