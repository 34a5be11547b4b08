/* What a shot sets for every patch of a file: arguments that scale or replace each patch's own settings. */
#include "stage.h"

skinslide_status skinslide_stage_live_take(skinslide_stage_live *live, const skinslide_stage_input *input,
                                           const skinslide_value *value, skinslide_error *error) {
    int32_t count, row = ss_row_of(SKINSLIDE_STAGE_LIVE, input);
    if (!live || row < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "nothing that is live, or no input of it");
    const ss_input *input_of = &ss_inputs(SKINSLIDE_STAGE_LIVE, &count)[row];
    skinslide_stage_live own = SKINSLIDE_STAGE_LIVE_DEFAULT;
    ss_record record;
    ss_taken taken = {0};
    skinslide_status status = ss_take(live, "skinslide_stage_live", &own, sizeof own, error);
    if (!status)
        status = ss_open(value, &record, error);
    if (status || !ss_has_value(&record))
        return status;
    if (row == SS_ROW_LIVE_ENVELOPE)
        status = ss_take_number(input_of, &record, &own.envelope, error);
    else
        status = ss_take_plain(input_of, &record, SKINSLIDE_BAD_CONTROL, NULL, &taken, error);
    if (row == SS_ROW_LIVE_INTERPOLATION)
        own.interpolation = taken.choice;
    if (row == SS_ROW_LIVE_LOOKUP)
        own.lookup = (skinslide_lookup)taken.choice;
    if (!status)
        ss_give(&own, sizeof own, live);
    return status;
}
