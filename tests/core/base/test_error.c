/* Messages: one line of UTF-8, whatever they quote. */
#include "base.h"
#include "support.h"

#include <string.h>

static void says(const char *quoted, const char *message) {
    skinslide_error error = {0};
    assert_int_equal(ss_fail(&error, SKINSLIDE_BAD_IMAGE, "%s", quoted), SKINSLIDE_BAD_IMAGE);
    assert_string_equal(error.message, message);
}

static void text_stays(void **state) {
    (void)state;
    static const char *const texts[] = {
        "", "elbow_L", "\xc3\xa9", "\xc2\xa0", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xf0\x9f\x92\xaa", "\xf4\x8f\xbf\xbf"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        says(texts[i], texts[i]);
}

static void controls_are_escaped(void **state) {
    (void)state;
    says("a\nb\rc\td", "a\\nb\\rc\\td");
    says("\x1b[2J\x7f", "\\x1b[2J\\x7f");
    says("\xc2\x9b"
         "1m", /* what begins a command to a terminal, in one character */
         "\\xc2\\x9b1m");
}

static void bytes_that_are_no_text_are_escaped(void **state) {
    (void)state;
    says("\xe9t\xe9", "\\xe9t\\xe9"); /* Latin-1 */
    says("a\xc3", "a\\xc3");          /* cut */
    says("\xe2\x82z\xf0\x9f\x92", "\\xe2\\x82z\\xf0\\x9f\\x92");
    says("\xc0\xaf\xe0\x80\xaf", "\\xc0\\xaf\\xe0\\x80\\xaf");                            /* longer than need be */
    says("\xed\xa0\x80\xf4\x90\x80\x80\xff", "\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80\\xff"); /* no characters */
}

/* A message that is too long ends with a whole character, whether that is escaped or not. */
static void what_does_not_fit_is_left_out(void **state) {
    (void)state;
    static const char *const filling[] = {"\x1b", "\xc3\xa9", "\xe2\x82\xac"};
    static const size_t widths[] = {4, 2, 3};
    skinslide_error error;
    for (int k = 0; k < 3; k++)
        for (size_t before = 0; before < 5; before++) {
            char text[2 * sizeof error.message] = "";
            memset(text, 'x', before);
            while (strlen(text) + 4 < sizeof text)
                strcat(text, filling[k]);
            ss_fail(&error, SKINSLIDE_BAD_IMAGE, "%s", text);
            size_t length = strlen(error.message);
            assert_true(length < sizeof error.message && length + widths[k] >= sizeof error.message);
            assert_int_equal((length - before) % widths[k], 0);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_stays),
        cmocka_unit_test(controls_are_escaped),
        cmocka_unit_test(bytes_that_are_no_text_are_escaped),
        cmocka_unit_test(what_does_not_fit_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
