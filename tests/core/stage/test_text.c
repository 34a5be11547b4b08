/* Text that USD's parser would run out of stack over, or would read half of; and brackets that do not count. */
#include "support.h"

#include "skinslide/stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 500 };

static skinslide_error error;

static skinslide_status check(const char *text) {
    return skinslide_stage_text(text, (int64_t)strlen(text), &error);
}

/* The first line, then `before` and `after` so often around `inside`. */
static skinslide_status check_nested(int32_t count, const char *before, const char *inside, const char *after) {
    size_t length = 16 + strlen(inside) + (size_t)count * (strlen(before) + strlen(after));
    char *text = malloc(length), *end = text;
    assert_non_null(text);
    end += sprintf(end, "#usda 1.0\n");
    for (int32_t i = 0; i < count; i++)
        end += sprintf(end, "%s", before);
    end += sprintf(end, "%s", inside);
    for (int32_t i = 0; i < count; i++)
        end += sprintf(end, "%s", after);
    skinslide_status status = check(text);
    free(text);
    return status;
}

static void what_is_not_usda_is_refused(void **state) {
    (void)state;
    assert_ok(check("#usda 1.0\n"), &error);
    assert_fails(check(""), &error, SKINSLIDE_BAD_ARGUMENT, "is not USDA text: the first line must be #usda 1.0");
    assert_fails(check("#usd"), &error, SKINSLIDE_BAD_ARGUMENT, "is not USDA text: the first line must be #usda 1.0");
    assert_fails(check("PXR-USDC"), &error, SKINSLIDE_BAD_ARGUMENT, "is not USDA text: the first line must be #usda 1.0");
    assert_fails(skinslide_stage_text("#usda 1.0\n\0def", 14, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "is not USDA text: it holds a zero byte");
    assert_int_equal(skinslide_stage_text(NULL, 0, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_stage_text("#usda", -1, &error), SKINSLIDE_BAD_ARGUMENT);
}

static void what_nests_too_deep_is_refused(void **state) {
    (void)state;
    const char *const nesting[][2] = {
        {"def \"a\" {\n", "}\n"}, {"dictionary d = {", "}"}, {"(", ")"}, {"[", "]"}, {"variantSet \"v\" = { \"x\" (", ")}"}};
    for (size_t i = 0; i < sizeof nesting / sizeof *nesting; i++) {
        int32_t each = i == 4 ? 2 : 1;
        assert_ok(check_nested(DEEPEST / each, nesting[i][0], "", nesting[i][1]), &error);
        assert_fails(check_nested(DEEPEST / each + 1, nesting[i][0], "", nesting[i][1]), &error, SKINSLIDE_UNSUPPORTED,
                     "nests brackets more than 500 deep, in line...");
    }
    assert_fails(check_nested(DEEPEST + 1, "over \"a\"\n{", "", "}"), &error, SKINSLIDE_UNSUPPORTED,
                 "nests brackets more than 500 deep, in line 503");
    assert_fails(check_nested(20000, "{", "", ""), &error, SKINSLIDE_UNSUPPORTED,
                 "nests brackets more than 500 deep, in line 2");
}

/* As many as there may be side by side. */
static void what_is_closed_does_not_count(void **state) {
    (void)state;
    assert_ok(check_nested(5000, "def \"a\" (kind = \"x\") { float3[] p = [(0, 0, 0), (1, 1, 1)] }\n", "", ""), &error);
}

static void what_is_no_bracket_does_not_count(void **state) {
    (void)state;
    const char *const spans[][2] = {{"\"{\" ", ""},        {"'{' ", ""},           {"\"\"\"{\n\"{\"\"\" ", ""},
                                    {"'''{\n'{''' ", ""},  {"@{@ ", ""},           {"@@@{@{@@@ ", ""},
                                    {"# {\n", ""},         {"// {\n", ""},         {"/* {\n{ */ ", ""},
                                    {"\"\\\"{\" ", ""},    {"'\\'{' ", ""},        {"'''\\'''{''' ", ""},
                                    {"@@@\\@@@{@@@ ", ""}, {"@C:\\@ {", "} "},     {"\"\\\\\" {", "} "},
                                    {"# \" '\n{", "} "},   {"/* \"\"\" */ {", "}"}};
    for (size_t i = 0; i < sizeof spans / sizeof *spans; i++) {
        int32_t opens = *spans[i][1] ? 1 : 0;
        assert_ok(check_nested(DEEPEST * (opens ? 1 : 4), spans[i][0], "", spans[i][1]), &error);
        assert_int_equal(check_nested(DEEPEST + 1, spans[i][0], "{", spans[i][1]),
                         opens ? SKINSLIDE_UNSUPPORTED : SKINSLIDE_OK);
    }
}

/* A bracket that is quoted closes none. */
static void quotes_hide_nothing(void **state) {
    (void)state;
    const char *const before[] = {"{ \"}\" ", "{ '}' ", "{ @}@ ", "{ # }\n", "{ // }\n", "{ /* } */ ", "{ \"\"\"}\"}\"\"\" "};
    for (size_t i = 0; i < sizeof before / sizeof *before; i++)
        assert_int_equal(check_nested(DEEPEST + 1, before[i], "", ""), SKINSLIDE_UNSUPPORTED);
}

static void expressions_nest_too(void **state) {
    (void)state;
    assert_ok(check_nested(DEEPEST, "", "@`if(${X}, \"a\", \"b\")`@", ""), &error);
    const char *const quotes[] = {"@", "\"", "'", "\"\"\"", "@@@"};
    for (size_t i = 0; i < sizeof quotes / sizeof *quotes; i++) {
        char text[4096] = "#usda 1.0\n";
        strcat(strcat(text, quotes[i]), "`");
        for (int32_t k = 0; k <= DEEPEST; k++)
            strcat(text, "if(");
        strcat(strcat(text, "`"), quotes[i]);
        assert_fails(check(text), &error, SKINSLIDE_UNSUPPORTED, "nests brackets more than 500 deep, in line 2");
    }
}

static void what_does_not_end_is_checked_to_its_end(void **state) {
    (void)state;
    const char *const texts[] = {"#usda 1.0\n\"", "#usda 1.0\n\"\\", "#usda 1.0\n@@@",
                                 "#usda 1.0\n/*", "#usda 1.0\n#",    "#usda /"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        size_t length = strlen(texts[i]);
        char *exact = malloc(length); /* so that a byte too far is found */
        assert_non_null(exact);
        memcpy(exact, texts[i], length);
        assert_ok(skinslide_stage_text(exact, (int64_t)length, &error), &error);
        free(exact);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_usda_is_refused),
        cmocka_unit_test(what_nests_too_deep_is_refused),
        cmocka_unit_test(what_is_closed_does_not_count),
        cmocka_unit_test(what_is_no_bracket_does_not_count),
        cmocka_unit_test(quotes_hide_nothing),
        cmocka_unit_test(expressions_nest_too),
        cmocka_unit_test(what_does_not_end_is_checked_to_its_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
