/* Records: every type of number comes to the same arrays, indices are applied, and what cannot be used is named. */
#include "records.h"
#include "stage.h"

#include <float.h>
#include <math.h>
#include <string.h>

static skinslide_error error;

/* As settings take an array of floats. */
static skinslide_status take_floats(const skinslide_value *value, float *out, skinslide_error *into) {
    ss_record record;
    skinslide_status status = ss_open(value, &record, into);
    if (!status)
        status = ss_check_floats(&record, SKINSLIDE_BAD_CONTROL, into);
    if (!status && out)
        ss_copy_floats(&record, out);
    return status;
}

static void whole_numbers_of_every_type(void **state) {
    (void)state;
    const uint8_t bytes[3] = {0, 1, 255};
    const int32_t ints[3] = {0, 1, 255};
    const uint32_t uints[3] = {0, 1, 255};
    const int64_t longs[3] = {0, 1, 255};
    const uint64_t ulongs[3] = {0, 1, 255};
    const void *data[] = {bytes, ints, uints, longs, ulongs};
    for (int i = 0; i < 5; i++) {
        int32_t out[3];
        skinslide_value value = array_of("x", (skinslide_value_type)(SKINSLIDE_VALUE_UINT8 + i), 1, 3, data[i]);
        assert_ok(skinslide_value_integers(&value, out, &error), &error);
        assert_same_bytes(out, ints, sizeof ints);
        value.type_name = "what[]";
        assert_fails(take_floats(&value, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of float");
    }
}

/* 0.5, -2, the smallest and the largest half, infinity and a NaN. */
static void halves_floats_and_doubles(void **state) {
    (void)state;
    const uint16_t halves[6] = {0x3800, 0xC000, 0x0001, 0x7BFF, 0x7C00, 0x7E00};
    const float floats[6] = {0.5f, -2, 5.9604644775390625e-8f, 65504, INFINITY, NAN};
    double doubles[6];
    float out[6];
    for (int i = 0; i < 6; i++)
        doubles[i] = (double)floats[i];
    const void *data[] = {halves, floats, doubles};
    for (int k = 0; k < 3; k++) {
        skinslide_value value = array_of("x", (skinslide_value_type)(SKINSLIDE_VALUE_HALF + k), 1, 6, data[k]);
        assert_ok(take_floats(&value, out, &error), &error);
        for (int i = 0; i < 5; i++)
            assert_true(out[i] == floats[i]);
        assert_true(isnan(out[5]));
        value.width = 3, value.count = 2;
        assert_ok(skinslide_value_positions(&value, out, &error), &error);
        assert_true(out[3] == floats[3]);
        assert_fails(skinslide_value_integers(&value, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of int");
    }
}

static void indices_are_applied(void **state) {
    (void)state;
    float out[4];
    const skinslide_value indices = INTS("x:indices", 1, 1, 0, 2);
    skinslide_value value = indexed_by(FLOATS("x", 5, 6, 7), &indices);
    assert_int_equal(skinslide_value_length(&value), 4);
    assert_ok(take_floats(&value, out, &error), &error);
    assert_same_bytes(out, ((float[]){6, 6, 5, 7}), sizeof out);
    const skinslide_value whole = indexed_by(INTS("x", 5, 6, 7), &indices);
    int32_t ints[4];
    assert_ok(skinslide_value_integers(&whole, ints, &error), &error);
    assert_same_bytes(ints, ((int32_t[]){6, 6, 5, 7}), sizeof ints);
}

static void bad_indices_are_named(void **state) {
    (void)state;
    const skinslide_value outside = INTS("x:indices", 0, 3), below = INTS("x:indices", 0, 0, -1);
    const skinslide_value floats = FLOATS("x:indices", 1);
    skinslide_value value = indexed_by(FLOATS("x", 5, 6, 7), &outside);
    assert_fails(take_floats(&value, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x:indices[1] is 3, but x has 3 values");
    value.indices = &below;
    assert_fails(take_floats(&value, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x:indices[2] is -1, but x has 3 values");
    value.indices = &floats;
    assert_fails(take_floats(&value, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x:indices is not an array of int");
}

static void whole_numbers_that_do_not_fit(void **state) {
    (void)state;
    const int64_t low[1] = {(int64_t)INT32_MIN - 1}, high[1] = {(int64_t)INT32_MAX + 1};
    const uint64_t huge[1] = {UINT64_MAX};
    const skinslide_value values[] = {
        array_of("x", SKINSLIDE_VALUE_INT64, 1, 1, low),
        array_of("x", SKINSLIDE_VALUE_INT64, 1, 1, high),
        array_of("x", SKINSLIDE_VALUE_UINT64, 1, 1, huge),
    };
    for (int i = 0; i < 3; i++)
        assert_fails(skinslide_value_integers(&values[i], NULL, &error), &error, SKINSLIDE_BAD_CONTROL,
                     "x has a value that does not fit an int");
}

/* An empty array is one of any type, as a scene that empties an attribute has it. */
static void no_value_is_an_empty_array(void **state) {
    (void)state;
    const skinslide_value none[] = {nothing_of("x"), blocked_of("x"), array_of("x", SKINSLIDE_VALUE_OTHER, 1, 0, NULL)};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(skinslide_value_length(&none[i]), 0);
        assert_ok(skinslide_value_integers(&none[i], NULL, &error), &error);
        assert_ok(skinslide_value_positions(&none[i], NULL, &error), &error);
    }
    assert_int_equal(skinslide_value_length(NULL), 0);
    assert_ok(take_floats(NULL, NULL, &error), &error);
}

static void other_types_are_named(void **state) {
    (void)state;
    const skinslide_value other = other_of("x", "string[]"), single = NUMBER("x", 1), text = text_of("x", "word");
    assert_fails(skinslide_value_positions(&other, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of points");
    assert_fails(take_floats(&single, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of float");
    assert_fails(skinslide_value_integers(&text, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of int");
}

/* Members that an older reader does not know have their defaults, and those that only a newer one knows are not read. */
static void records_of_other_versions(void **state) {
    (void)state;
    float out[2];
    struct {
        skinslide_value value;
        char more[64];
    } newer = {FLOATS("x", 1, 2), {0}};
    const skinslide_value indices = INTS("x:indices", 1, 0);
    newer.value.size = sizeof newer;
    assert_ok(take_floats(&newer.value, out, &error), &error);
    newer.more[0] = 1;
    assert_int_equal(take_floats(&newer.value, out, &error), SKINSLIDE_UNSUPPORTED);
    skinslide_value older = indexed_by(FLOATS("x", 1, 2), &indices);
    older.size = offsetof(skinslide_value, indices);
    assert_ok(take_floats(&older, out, &error), &error);
    assert_same_bytes(out, ((float[]){1, 2}), sizeof out);
}

static void records_that_are_none(void **state) {
    (void)state;
    skinslide_value bad = FLOATS("x", 1);
    bad.size = 0;
    assert_fails(take_floats(&bad, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "skinslide_value: its size is ...");
    bad = FLOATS("x", 1), bad.count = -1;
    assert_fails(take_floats(&bad, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "x: the record has no data, or a count of none");
    bad = FLOATS(NULL, 1), bad.data = NULL;
    assert_fails(take_floats(&bad, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "the value: the record has no data, or a count of none");
    bad = FLOATS("x", 1), bad.width = 0;
    assert_int_equal(take_floats(&bad, NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    bad = FLOATS("x", 1), bad.type = (skinslide_value_type)99;
    assert_fails(take_floats(&bad, NULL, &error), &error, SKINSLIDE_BAD_CONTROL, "x is not an array of float");
}

/* A name of any length leaves room for what is wrong, and is not cut within a character. */
static void long_names_are_cut(void **state) {
    (void)state;
    char name[2000];
    for (int i = 0; i < 999; i++)
        memcpy(name + 2 * i, "\xc3\xa9", 2); /* an e with an acute accent */
    name[1998] = 0;
    for (int shift = 0; shift < 2; shift++) {
        skinslide_value value = other_of(name + 2 * shift, "x");
        if (shift)
            name[2] = 'a', name[3] = 'b';
        assert_int_equal(take_floats(&value, NULL, &error), SKINSLIDE_BAD_CONTROL);
        const char *cut = strstr(error.message, "...");
        assert_string_equal(cut, "... is not an array of float");
        assert_int_equal((unsigned char)cut[-1], 0xa9);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_of_every_type),   cmocka_unit_test(halves_floats_and_doubles),
        cmocka_unit_test(indices_are_applied),           cmocka_unit_test(bad_indices_are_named),
        cmocka_unit_test(whole_numbers_that_do_not_fit), cmocka_unit_test(no_value_is_an_empty_array),
        cmocka_unit_test(other_types_are_named),         cmocka_unit_test(records_of_other_versions),
        cmocka_unit_test(records_that_are_none),         cmocka_unit_test(long_names_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
