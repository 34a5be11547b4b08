/* Structs that grow: three versions of one, each with what the others know of it. */
#include "support.h"

#include <string.h>

typedef struct older {
    size_t size;
    int32_t first, second;
} older;

typedef struct ours {
    size_t size;
    int32_t first, second;
    double third;
} ours;

typedef struct newer {
    size_t size;
    int32_t first, second;
    double third;
    const char *fourth;
} newer;

static const ours standard = {sizeof(ours), 1, 2, 3};
static skinslide_error error;

static void what_an_older_one_lacks_has_its_default(void **state) {
    (void)state;
    const older given = {sizeof given, 10, 20};
    ours own = standard;
    assert_ok(ss_take(&given, "struct", &own, sizeof own, &error), &error);
    assert_true(own.size == sizeof own && own.first == 10 && own.second == 20 && own.third == 3);
}

static void what_a_newer_one_has_more_must_be_nothing(void **state) {
    (void)state;
    newer given = {sizeof given, 10, 20, 30, NULL};
    ours own = standard;
    assert_ok(ss_take(&given, "struct", &own, sizeof own, &error), &error);
    assert_true(own.size == sizeof own && own.first == 10 && own.second == 20 && own.third == 30);
    given.fourth = "";
    assert_fails(ss_take(&given, "struct", &own, sizeof own, &error), &error, SKINSLIDE_UNSUPPORTED,
                 "struct: it has something that version " SKINSLIDE_VERSION_TEXT " does not know");
}

static void sizes_that_were_never_set(void **state) {
    (void)state;
    const size_t sizes[] = {0, 1, sizeof(size_t), 4097, (size_t)-1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const ours given = {sizes[i], 10, 20, 30};
        ours own = standard;
        assert_int_equal(ss_take(&given, "struct", &own, sizeof own, &error), SKINSLIDE_BAD_ARGUMENT);
        assert_int_equal(ss_check_size(&given, "struct", &error), SKINSLIDE_BAD_ARGUMENT);
        assert_same_bytes(&own, &standard, sizeof own);
    }
    const ours unset = {0, 10, 20, 30};
    assert_fails(ss_check_size(&unset, "struct", &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "struct: its size is 0; start from its default");
}

static void none_is_the_default(void **state) {
    (void)state;
    ours own = standard;
    assert_ok(ss_take(NULL, "struct", &own, sizeof own, &error), &error);
    assert_same_bytes(&own, &standard, sizeof own);
}

static void arrays_of_any_version(void **state) {
    (void)state;
    const older before[2] = {{sizeof *before, 10, 20}, {sizeof *before, 11, 21}};
    newer after[2] = {{sizeof *after, 10, 20, 30, NULL}, {sizeof *after, 11, 21, 31, NULL}};
    ours own[2];
    assert_ok(ss_take_all(before, 2, "struct", own, sizeof *own, &standard, &error), &error);
    assert_true(own[0].second == 20 && own[0].third == 3 && own[1].first == 11 && own[1].second == 21 && own[1].third == 3);
    assert_ok(ss_take_all(after, 2, "struct", own, sizeof *own, &standard, &error), &error);
    assert_true(own[0].third == 30 && own[1].size == sizeof *own && own[1].first == 11 && own[1].third == 31);
    after[1].size = sizeof(ours);
    assert_fails(ss_take_all(after, 2, "struct", own, sizeof *own, &standard, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "struct: number 1 has size 24, the first has 32");
}

/* Nothing is written beyond the caller's struct, and members that only a newer caller has become 0. */
static void answers_fit_every_version(void **state) {
    (void)state;
    const ours own[2] = {{sizeof *own, 10, 20, 30}, {sizeof *own, 11, 21, 31}};
    struct {
        older answers[2];
        double after;
    } before = {{{sizeof(older), 0, 0}, {0, 0, 0}}, 77};
    newer after[2] = {{sizeof *after, 0, 0, 0, "left"}, {0, 0, 0, 0, "left"}};
    ss_give_all(own, 2, sizeof *own, before.answers);
    assert_true(before.answers[0].second == 20 && before.answers[1].size == sizeof(older) && before.answers[1].first == 11);
    assert_true(before.after == 77);
    ss_give_all(own, 2, sizeof *own, after);
    for (int i = 0; i < 2; i++) {
        assert_true(after[i].size == sizeof *after && after[i].first == 10 + i && after[i].third == 30 + i);
        assert_null(after[i].fourth);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_an_older_one_lacks_has_its_default),
        cmocka_unit_test(what_a_newer_one_has_more_must_be_nothing),
        cmocka_unit_test(sizes_that_were_never_set),
        cmocka_unit_test(none_is_the_default),
        cmocka_unit_test(arrays_of_any_version),
        cmocka_unit_test(answers_fit_every_version),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
