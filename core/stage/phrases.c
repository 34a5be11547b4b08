/* Phrases that stand in messages of the core and in those of its readers. */
#include "stage.h"

const char *skinslide_stage_phrase(skinslide_phrase phrase) {
    static const char *const phrases[] = {
        [SKINSLIDE_PHRASE_NO_TYPE] = "prim without a type",
        [SKINSLIDE_PHRASE_NO_FILE] = "there is no such file",
        [SKINSLIDE_PHRASE_IRREGULAR] = "is not a regular file",
        [SKINSLIDE_PHRASE_UNREADABLE] = "cannot be read",
    };
    return (unsigned)phrase < sizeof phrases / sizeof *phrases ? phrases[phrase] : NULL;
}

const char *ss_type_of(const char *type_name) {
    return type_name && *type_name ? type_name : skinslide_stage_phrase(SKINSLIDE_PHRASE_NO_TYPE);
}
