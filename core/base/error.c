/* Statuses and their messages. */
#include "base.h"

#include <stdarg.h>
#include <stdio.h>

/* How many bytes the UTF-8 character at text has; 0 if none begins there, or it is a control character. */
static int character_size(const char *text) {
    const unsigned char *c = (const unsigned char *)text;
    int size = c[0] < 0x80                   ? 1
               : c[0] >= 0xC2 && c[0] < 0xE0 ? 2
               : (c[0] & 0xF0) == 0xE0       ? 3
               : c[0] >= 0xF0 && c[0] < 0xF5 ? 4
                                             : 0;
    for (int i = 1; i < size; i++)
        if ((c[i] & 0xC0) != 0x80)
            return 0;
    bool is_control = size == 1 ? c[0] < ' ' || c[0] == 127 : c[0] == 0xC2 && c[1] < 0xA0;
    bool is_longer_than_need_be = (c[0] == 0xE0 && c[1] < 0xA0) || (c[0] == 0xF0 && c[1] < 0x90);
    bool is_none = (c[0] == 0xED && c[1] >= 0xA0) || (c[0] == 0xF4 && c[1] >= 0x90); /* a surrogate, or beyond the last */
    return is_control || is_longer_than_need_be || is_none ? 0 : size;
}

/* Copies text as one line that is safe to print: names that a message quotes may hold control characters, and those from files
 * any bytes. */
static void copy_line(char *out, size_t size, const char *text) {
    size_t end = 0;
    for (int whole; *text; text += whole ? whole : 1) {
        unsigned char c = (unsigned char)*text;
        const char *named = c == '\n' ? "\\n" : c == '\r' ? "\\r" : c == '\t' ? "\\t" : NULL;
        whole = character_size(text);
        int length = whole ? snprintf(out + end, size - end, "%.*s", whole, text)
                           : snprintf(out + end, size - end, named ? named : "\\x%02x", c);
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
