/* Statuses and their messages. */
#include "base.h"

#include <stdarg.h>
#include <stdio.h>

/* One line of what a caller may print: names and tokens that a message quotes can hold what moves a terminal's cursor. */
static void copy_line(char *out, size_t size, const char *text) {
    size_t end = 0;
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        const char *named = c == '\n' ? "\\n" : c == '\r' ? "\\r" : c == '\t' ? "\\t" : NULL;
        const char *format = named ? named : c < ' ' || c == 127 ? "\\x%02x" : "%c";
        int length = snprintf(out + end, size - end, format, c);
        if ((size_t)length >= size - end)
            break; /* what does not fit whole is left out */
        end += (size_t)length;
    }
    out[end] = 0;
}

skinslide_status ss_fail(skinslide_error *error, skinslide_status status, const char *format, ...) {
    if (error) {
        char text[sizeof error->message];
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(text, sizeof text, format, arguments);
        va_end(arguments);
        copy_line(error->message, sizeof error->message, text);
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
