/* Words that both the core and its readers say. */
#include "stage.h"

const char *skinslide_stage_say(skinslide_saying saying) {
    static const char *const sayings[] = {
        [SKINSLIDE_SAYING_NO_TYPE] = "prim without a type",
        [SKINSLIDE_SAYING_NO_FILE] = "there is no such file",
        [SKINSLIDE_SAYING_IRREGULAR] = "is not a regular file",
        [SKINSLIDE_SAYING_UNREADABLE] = "cannot be read",
    };
    return (unsigned)saying < sizeof sayings / sizeof *sayings ? sayings[saying] : NULL;
}

const char *ss_type_of(const char *type_name) {
    return type_name && *type_name ? type_name : skinslide_stage_say(SKINSLIDE_SAYING_NO_TYPE);
}
