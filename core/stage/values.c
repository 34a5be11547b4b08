/* Records: what a reader hands over, as arrays of one type, checked, and with the sentences that say what is wrong with
 * them. */
#include "stage.h"

#include "base.h"

#include <stdio.h>
#include <string.h>

/* ---- Opening ---- */

static bool is_whole(skinslide_value_type type) {
    return type >= SKINSLIDE_VALUE_UINT8 && type <= SKINSLIDE_VALUE_UINT64;
}

static bool is_real(skinslide_value_type type) {
    return type >= SKINSLIDE_VALUE_HALF && type <= SKINSLIDE_VALUE_DOUBLE;
}

bool ss_is_real(const skinslide_value *value) {
    return is_real(value->type);
}

static bool is_text(skinslide_value_type type) {
    return type == SKINSLIDE_VALUE_TEXT || type == SKINSLIDE_VALUE_ASSET;
}

static const char *name_of_type(const skinslide_value *value) {
    static const char *const singles[] = {"nothing", "nothing", "bool",  "uchar",  "int",   "uint",  "int64",
                                          "uint64",  "half",    "float", "double", "token", "asset", "a value of another kind"};
    static const char *const arrays[] = {
        "nothing",  "nothing", "bool[]",  "uchar[]",  "int[]",   "uint[]",  "int64[]",
        "uint64[]", "half[]",  "float[]", "double[]", "token[]", "asset[]", "an array of another kind"};
    return (value->is_array ? arrays : singles)[value->type];
}

/* A caller's record, completed. */
static skinslide_status complete(const skinslide_value *given, skinslide_value *out, skinslide_error *error) {
    *out = (skinslide_value)SKINSLIDE_VALUE_DEFAULT;
    out->name = "the value";
    skinslide_status status = ss_take(given, "skinslide_value", out, sizeof *out, error);
    if (status)
        return status;
    if (!out->name)
        out->name = "the value";
    if ((unsigned)out->type > SKINSLIDE_VALUE_OTHER)
        out->type = SKINSLIDE_VALUE_OTHER;
    if (out->type == SKINSLIDE_VALUE_NONE || out->type == SKINSLIDE_VALUE_BLOCKED)
        out->count = 0;
    else if (!out->is_array)
        out->count = 1;
    if (!out->type_name)
        out->type_name = name_of_type(out);
    bool needs_data =
        is_text(out->type) || (out->count > 0 && out->type >= SKINSLIDE_VALUE_BOOL && out->type < SKINSLIDE_VALUE_OTHER);
    if (out->count < 0 || out->width < 1 || (needs_data && !out->data))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, SS_NAMED ": the record has no data, or a count of none",
                       SS_NAME(out->name));
    return SKINSLIDE_OK;
}

skinslide_status ss_open(const skinslide_value *given, ss_record *record, skinslide_error *error) {
    skinslide_status status = complete(given, &record->value, error);
    if (!status) /* a single value has no indices */
        status = complete(record->value.is_array ? record->value.indices : NULL, &record->indices, error);
    if (status)
        return status;
    record->length = record->value.count;
    if (ss_has_value(record) && record->indices.type != SKINSLIDE_VALUE_NONE)
        record->length = record->indices.count;
    return SKINSLIDE_OK;
}

bool ss_has_value(const ss_record *record) {
    return record->value.type > SKINSLIDE_VALUE_BLOCKED;
}

const char *ss_interpolation(const ss_record *record) {
    return record->value.interpolation ? record->value.interpolation : "constant";
}

bool ss_is_by_vertex(const char *interpolation) {
    return strcmp(interpolation, "vertex") == 0 || strcmp(interpolation, "varying") == 0;
}

bool ss_is_number(const ss_record *record) {
    const skinslide_value *value = &record->value;
    return !value->is_array && value->width == 1 && value->type >= SKINSLIDE_VALUE_BOOL &&
           value->type <= SKINSLIDE_VALUE_DOUBLE;
}

/* ---- Numbers ---- */

static int64_t whole(const skinslide_value *value, int64_t i) {
    switch (value->type) {
    case SKINSLIDE_VALUE_BOOL:
    case SKINSLIDE_VALUE_UINT8:
        return ((const uint8_t *)value->data)[i];
    case SKINSLIDE_VALUE_INT32:
        return ((const int32_t *)value->data)[i];
    case SKINSLIDE_VALUE_UINT32:
        return ((const uint32_t *)value->data)[i];
    case SKINSLIDE_VALUE_INT64:
        return ((const int64_t *)value->data)[i];
    default: { /* what is too large for an int64_t is too large for an int as well */
        uint64_t large = ((const uint64_t *)value->data)[i];
        return large > INT64_MAX ? INT64_MAX : (int64_t)large;
    }
    }
}

static double number(const skinslide_value *value, int64_t i) {
    switch (value->type) {
    case SKINSLIDE_VALUE_HALF:
        return (double)ss_half_to_float(((const uint16_t *)value->data)[i]);
    case SKINSLIDE_VALUE_FLOAT:
        return (double)((const float *)value->data)[i];
    case SKINSLIDE_VALUE_DOUBLE:
        return ((const double *)value->data)[i];
    default:
        return (double)whole(value, i);
    }
}

static int64_t place(const ss_record *record, int64_t element) {
    return record->indices.type == SKINSLIDE_VALUE_NONE ? element : whole(&record->indices, element);
}

double ss_number(const ss_record *record, int64_t element, int32_t k) {
    return number(&record->value, place(record, element) * record->value.width + k);
}

void ss_mark_positive(const ss_record *record, uint8_t *marked) {
    const skinslide_value *value = &record->value;
    if (value->type == SKINSLIDE_VALUE_BOOL && value->width == 1 && record->indices.type == SKINSLIDE_VALUE_NONE)
        for (int64_t i = 0; i < record->length; i++) /* as faces are mostly chosen; many at once */
            marked[i] = ((const uint8_t *)value->data)[i] > 0;
    else
        for (int64_t i = 0; i < record->length; i++)
            marked[i] = ss_number(record, i, 0) > 0;
}

/* ---- Checks ---- */

static bool is_array_of(const skinslide_value *value, bool (*is_type)(skinslide_value_type), int32_t width) {
    return value->count == 0 || (value->is_array && value->width == width && is_type(value->type));
}

skinslide_status ss_refuse_empty(const ss_record *record, skinslide_status status, skinslide_error *error) {
    return ss_fail(error, status, SS_NAMED " has no value", SS_NAME(record->value.name));
}

skinslide_status ss_check_by_vertex(const ss_record *record, const char *of, skinslide_status status, skinslide_error *error) {
    const char *interpolation = ss_interpolation(record);
    if (ss_is_by_vertex(interpolation))
        return SKINSLIDE_OK;
    return ss_fail(error, status, "%s" SS_NAMED " has interpolation " SS_NAMED "; it must be vertex", of,
                   SS_NAME(record->value.name), SS_NAME(interpolation));
}

skinslide_status ss_check_indices(const ss_record *record, skinslide_status status, skinslide_error *error) {
    const skinslide_value *indices = &record->indices;
    const char *name = record->value.name;
    if (!is_array_of(indices, is_whole, 1))
        return ss_fail(error, status, SS_NAMED ":indices is not an array of int", SS_NAME(name));
    for (int64_t i = 0; ss_has_value(record) && i < indices->count; i++)
        if (whole(indices, i) < 0 || whole(indices, i) >= record->value.count)
            return ss_fail(error, status, SS_NAMED ":indices[%lld] is %lld, but " SS_NAMED " has %lld values", SS_NAME(name),
                           (long long)i, (long long)whole(indices, i), SS_NAME(name), (long long)record->value.count);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_integers(const ss_record *record, skinslide_status status, skinslide_error *error) {
    const skinslide_value *value = &record->value;
    if (!is_array_of(value, is_whole, 1))
        return ss_fail(error, status, SS_NAMED " is not an array of int", SS_NAME(value->name));
    for (int64_t i = 0; value->type != SKINSLIDE_VALUE_OTHER && i < value->count; i++)
        if (whole(value, i) < INT32_MIN || whole(value, i) > INT32_MAX)
            return ss_fail(error, status, SS_NAMED " has a value that does not fit an int", SS_NAME(value->name));
    return ss_check_indices(record, status, error);
}

skinslide_status ss_check_floats(const ss_record *record, skinslide_status status, skinslide_error *error) {
    if (!is_array_of(&record->value, is_real, 1))
        return ss_fail(error, status, SS_NAMED " is not an array of float", SS_NAME(record->value.name));
    return ss_check_indices(record, status, error);
}

skinslide_status ss_check_triples(const ss_record *record, skinslide_status status, skinslide_error *error) {
    if (is_array_of(&record->value, is_real, 3))
        return SKINSLIDE_OK;
    return ss_fail(error, status, SS_NAMED " is not an array of points", SS_NAME(record->value.name));
}

skinslide_status ss_check_positions(const ss_record *record, skinslide_status status, skinslide_error *error) {
    skinslide_status failed = ss_check_triples(record, status, error);
    return failed ? failed : ss_check_indices(record, status, error);
}

skinslide_status ss_check_length(const ss_record *record, int64_t count, const char *of, skinslide_status status,
                                 skinslide_error *error) {
    if (record->length != count)
        return ss_fail(error, status, SS_NAMED " has %lld values, but the mesh has %lld %s", SS_NAME(record->value.name),
                       (long long)record->length, (long long)count, of);
    return SKINSLIDE_OK;
}

/* ---- Copies ---- */

void ss_copy_integers(const ss_record *record, int32_t *out) {
    for (int64_t i = 0; i < record->length; i++)
        out[i] = (int32_t)whole(&record->value, place(record, i));
}

void ss_copy_floats(const ss_record *record, float *out) {
    int32_t width = record->value.width;
    if (record->value.type == SKINSLIDE_VALUE_FLOAT && record->indices.type == SKINSLIDE_VALUE_NONE) {
        if (record->length > 0)
            memcpy(out, record->value.data, (size_t)record->length * (size_t)width * sizeof *out);
        return;
    }
    for (int64_t i = 0; i < record->length; i++)
        for (int32_t k = 0; k < width; k++)
            out[i * width + k] = (float)ss_number(record, i, k);
}

int64_t skinslide_value_length(const skinslide_value *value) {
    ss_record record;
    return ss_open(value, &record, NULL) ? 0 : record.length;
}

skinslide_status skinslide_value_integers(const skinslide_value *value, int32_t *out, skinslide_error *error) {
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = ss_check_integers(&record, SKINSLIDE_BAD_CONTROL, error);
    if (!status && out)
        ss_copy_integers(&record, out);
    return status;
}

skinslide_status skinslide_value_positions(const skinslide_value *value, float *out, skinslide_error *error) {
    ss_record record;
    skinslide_status status = ss_open(value, &record, error);
    if (!status)
        status = ss_check_positions(&record, SKINSLIDE_BAD_CONTROL, error);
    if (!status && out)
        ss_copy_floats(&record, out);
    return status;
}

/* ---- Sentences ---- */

enum { LONGEST_NAME = 160, LONGEST_PATH = 200 };

static bool continues(char byte) {
    return ((unsigned char)byte & 0xC0) == 0x80; /* a character of UTF-8 that began before */
}

int ss_name_length(const char *name) {
    size_t length = strlen(name);
    if (length <= LONGEST_NAME)
        return (int)length;
    for (length = LONGEST_NAME; length > 0 && continues(name[length]);)
        length--;
    return (int)length;
}

const char *ss_name_more(const char *name) {
    return strlen(name) > LONGEST_NAME ? "..." : "";
}

const char *ss_file_less(const char *path) {
    return strlen(path) > LONGEST_PATH ? "..." : "";
}

const char *ss_file_tail(const char *path) {
    size_t length = strlen(path);
    if (length <= LONGEST_PATH)
        return path;
    for (path += length - LONGEST_PATH; continues(*path);)
        path++;
    return path;
}

/* "[1, 2, 3, 4, ...]" */
static void list_numbers(const skinslide_value *value, char *text, size_t size) {
    enum { MOST = 4 };
    size_t length = (size_t)snprintf(text, size, "[");
    for (int64_t i = 0; i < value->count && i < MOST && length < size; i++)
        length += (size_t)snprintf(text + length, size - length, "%s%g", i ? ", " : "", number(value, i));
    if (length < size)
        snprintf(text + length, size - length, value->count > MOST ? ", ...]" : "]");
}

const char *ss_shown(const ss_record *record, char text[256]) {
    const skinslide_value *value = &record->value;
    bool is_numbers = value->width == 1 && value->type >= SKINSLIDE_VALUE_BOOL && value->type <= SKINSLIDE_VALUE_DOUBLE;
    const char *said = value->data;
    if (is_text(value->type) && !value->is_array)
        snprintf(text, 256, "'" SS_NAMED "'", SS_NAME(said));
    else if (is_numbers && value->is_array)
        list_numbers(value, text, 256);
    else if (is_numbers)
        snprintf(text, 256, "%g", number(value, 0));
    else
        snprintf(text, 256, SS_NAMED, SS_NAME(value->type_name));
    return text;
}

char *ss_copy_text(ss_memory *memory, const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = SS_NEW(memory, char, (int64_t)size);
    if (copy)
        memcpy(copy, text, size);
    return copy;
}
