/* What a shot sets from outside for every patch of a file: arguments that scale or replace what each patch has of its own. */
#include "stage.h"

#include <string.h>

skinslide_status skinslide_stage_live_take(skinslide_stage_live *live, const skinslide_stage_input *input,
                                           const skinslide_value *value, skinslide_error *error) {
    int32_t count, row = ss_row_of(SKINSLIDE_STAGE_LIVE, input);
    if (!live || live->size < sizeof *live || row < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing that is live and begins with its size, or no input of it");
    const ss_input *own = &ss_inputs(SKINSLIDE_STAGE_LIVE, &count)[row];
    ss_record record;
    ss_taken taken = {0};
    skinslide_status status = ss_open(value, &record, error);
    if (status || !ss_has_value(&record))
        return status;
    if (row == SS_ROW_LIVE_ENVELOPE)
        return ss_take_number(own, &record, &live->envelope, error);
    status = ss_take_plain(own, &record, SKINSLIDE_BAD_CONTROL, NULL, &taken, error);
    if (!status && row == SS_ROW_LIVE_INTERPOLATION)
        live->interpolation = taken.choice;
    if (!status && row == SS_ROW_LIVE_LOOKUP)
        live->lookup = (skinslide_lookup)taken.choice;
    return status;
}
