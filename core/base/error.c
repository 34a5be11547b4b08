/* Statuses and their messages. */
#include "base.h"

#include <stdarg.h>
#include <stdio.h>

skinslide_status ss_fail(skinslide_error *error, skinslide_status status, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

skinslide_status ss_out_of_memory(skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_OUT_OF_MEMORY, "%s", skinslide_status_text(SKINSLIDE_OUT_OF_MEMORY));
}

#define NAME(name, text) #name,
#define TEXT(name, text) text,
static const char *const names[] = {SKINSLIDE_STATUSES(NAME)};
static const char *const texts[] = {SKINSLIDE_STATUSES(TEXT)};

static const char *look_up(const char *const *table, skinslide_status status) {
    return (unsigned)status < SKINSLIDE_STATUS_COUNT ? table[status] : "?";
}

const char *skinslide_status_name(skinslide_status status) {
    return look_up(names, status);
}

const char *skinslide_status_text(skinslide_status status) {
    return look_up(texts, status);
}

const char *skinslide_version(void) {
    return SKINSLIDE_VERSION_TEXT;
}
