/* Rooms of arrays that are taken by turns. */
#include "support.h"

#include <string.h>

/* Of two turns, in which other arrays are taken: each begins a line of its own, and the last ends within the room. */
static void arrays_begin_lines(void **state) {
    (void)state;
    static const int64_t counts[2][3] = {{1, 7, 100}, {300, 1, 9}};
    ss_room room = {0};
    for (int turn = 0; turn < 2; turn++) {
        ss_room counted = {0};
        for (int i = 0; i < 3; i++)
            assert_null(SS_TAKE(&counted, double, counts[turn][i]));
        ss_ask_room(&room, &counted);
    }
    assert_true(ss_make_room(&room));
    for (int turn = 0; turn < 2; turn++) {
        const char *end = room.bytes;
        ss_begin_turn(&room);
        for (int i = 0; i < 3; i++) {
            double *array = SS_TAKE(&room, double, counts[turn][i]);
            assert_true((const char *)array >= end && (uintptr_t)array % 64 == 0);
            memset(array, 1, (size_t)counts[turn][i] * sizeof *array);
            end = (const char *)(array + counts[turn][i]);
        }
        assert_true(end <= room.bytes + room.size);
    }
    ss_free(&room.memory);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_begin_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
