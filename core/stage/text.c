/* Whether USDA text may be parsed. USD's parser calls itself for each bracket that is open, until it has no stack left. */
#include "stage.h"

#include <string.h>

enum { MOST_NESTED = 500 };

/* A kind of span in which brackets do not count, such as a comment. */
typedef struct span_kind {
    const char *begin, *end;
    bool has_escapes, may_be_expression;
} span_kind;

static const span_kind spans[] = {{"\"\"\"", "\"\"\"", true, true}, {"'''", "'''", true, true}, {"\"", "\"", true, true},
                                  {"'", "'", true, true},           {"@@@", "@@@", true, true}, {"@", "@", false, true},
                                  {"#", "\n", false, false},        {"//", "\n", false, false}, {"/*", "*/", false, false}};
enum { SPANS = sizeof spans / sizeof *spans };

static bool begins_with(const char *text, const char *stop, const char *word) {
    size_t length = strlen(word);
    return (size_t)(stop - text) >= length && memcmp(text, word, length) == 0;
}

static const span_kind *span_at(const char *text, const char *stop) {
    if (!strchr("\"'@#/", *text))
        return NULL;
    for (int32_t i = 0; i < SPANS; i++) {
        if (begins_with(text, stop, spans[i].begin))
            return &spans[i];
    }
    return NULL;
}

/* Returns the place behind the end of a span whose inside begins at `text`. */
static const char *behind(const span_kind *span, const char *text, const char *stop) {
    for (; text < stop; text++) {
        if (begins_with(text, stop, span->end))
            return text + strlen(span->end);
        text += span->has_escapes && *text == '\\' && text + 1 < stop;
    }
    return stop;
}

/* At least how deep an expression nests: quotes inside it would have to be told apart as well. */
static int32_t openings(const span_kind *span, const char *text, const char *stop) {
    int32_t count = 0;
    if (!span->may_be_expression || text == stop || *text != '`')
        return 0;
    for (; text < stop && count <= MOST_NESTED; text++)
        count += *text == '(' || *text == '[';
    return count;
}

/* Returns where text nests too deep, or stop if it does not. */
static const char *too_deep(const char *text, const char *stop) {
    int32_t open = 0;
    while (text < stop) {
        const span_kind *span = span_at(text, stop);
        const char *next = span ? behind(span, text + strlen(span->begin), stop) : text + 1;
        if (!span)
            open += *text == '{' || *text == '(' || *text == '[';
        if (open + (span ? openings(span, text + strlen(span->begin), next) : 0) > MOST_NESTED)
            return text;
        open -= !span && open > 0 && (*text == '}' || *text == ')' || *text == ']');
        text = next;
    }
    return stop;
}

skinslide_status skinslide_stage_text(const char *text, int64_t byte_count, skinslide_error *error) {
    if (!text || byte_count < 0)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no text");
    const char *stop = text + byte_count;
    if (!begins_with(text, stop, "#usda"))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "is not USDA text: the first line must be #usda 1.0");
    /* The parser stops there, and would take what is before it for the whole. */
    if (memchr(text, 0, (size_t)byte_count))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "is not USDA text: it holds a zero byte");
    const char *deep = too_deep(text, stop);
    if (deep == stop)
        return SKINSLIDE_OK;
    int64_t line = 1;
    for (const char *at = text; at < deep; at++)
        line += *at == '\n';
    return ss_fail(error, SKINSLIDE_UNSUPPORTED, "nests brackets more than %d deep, in line %lld", MOST_NESTED,
                   (long long)line);
}
