/* The normal equations of a sparse A, factored once:
 *
 *     (A'A) x = b
 *
 * Solved by KLU (Davis and Palamadai Natarajan 2010). */
#include "linear.h"

#include <klu.h>
#include <stdlib.h>
#include <string.h>

struct ss_least_squares {
    int32_t column_count;
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
};

/* klu_solve works in memory of the factor's: each thread has a copy of the factor's head with memory of its own. That the head
 * can be copied, and that Xwork alone is written, holds for KLU 1 and 2. */
_Static_assert(KLU_MAIN_VERSION == 1 || KLU_MAIN_VERSION == 2, "see whether klu_solve of this KLU writes more than Xwork");
struct ss_least_squares_work {
    ss_memory memory;
    const ss_least_squares *sparse;
    klu_common common;
    klu_numeric numeric;
};

static const double worst_condition = 1e10; /* leaves six digits of a double, as many as a float has */

/* ---- A'A ---- */

typedef struct product {
    ss_memory memory;
    ss_rows transpose, square; /* A', A'A */
} product;

static void new_rows(ss_memory *memory, int32_t row_count, int32_t column_count, int64_t entries, ss_rows *rows) {
    *rows = (ss_rows){.row_count = row_count, .column_count = column_count};
    rows->start = SS_NEW(memory, int32_t, (int64_t)row_count + 1);
    rows->column = SS_NEW(memory, int32_t, entries);
    rows->value = SS_NEW(memory, double, entries);
}

static void transpose(const ss_rows *rows, ss_rows *out) {
    int32_t entries = rows->start[rows->row_count];
    for (int32_t k = 0; k < entries; k++)
        out->start[rows->column[k] + 1]++;
    for (int32_t j = 0; j < out->row_count; j++)
        out->start[j + 1] += out->start[j];
    for (int32_t i = rows->row_count - 1; i >= 0; i--)
        for (int32_t k = rows->start[i]; k < rows->start[i + 1]; k++) {
            int32_t place = --out->start[rows->column[k] + 1];
            out->column[place] = i, out->value[place] = rows->value[k];
        }
    for (int32_t j = 0; j < out->row_count; j++)
        out->start[j] = out->start[j + 1];
    out->start[out->row_count] = entries;
}

/* Row j of A'A, to out->column and value from out->start[j] on, or where out is NULL only counted. place [columns] is -1
 * throughout, before and after. */
static int32_t multiply_row(const ss_rows *rows, const ss_rows *transposed, int32_t j, int32_t *place, int32_t *touched,
                            ss_rows *out) {
    int32_t count = 0;
    for (int32_t k = transposed->start[j]; k < transposed->start[j + 1]; k++) {
        int32_t i = transposed->column[k];
        for (int32_t l = rows->start[i]; l < rows->start[i + 1]; l++) {
            int32_t column = rows->column[l];
            if (place[column] < 0) {
                touched[count] = column;
                place[column] = count++;
            }
            if (out) {
                out->column[out->start[j] + place[column]] = column;
                out->value[out->start[j] + place[column]] += transposed->value[k] * rows->value[l];
            }
        }
    }
    for (int32_t k = 0; k < count; k++)
        place[touched[k]] = -1;
    return count;
}

skinslide_status ss_refuse_large(const char *label, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: its limit system is too large", label);
}

static skinslide_status multiply(const ss_rows *rows, const char *label, product *out, skinslide_error *error) {
    ss_memory *memory = &out->memory;
    int32_t n = rows->column_count;
    int64_t entries = 0;
    new_rows(memory, n, rows->row_count, rows->start[rows->row_count], &out->transpose);
    int32_t *place = SS_NEW(memory, int32_t, n), *touched = SS_NEW(memory, int32_t, n);
    if (memory->failed)
        return ss_out_of_memory(error);
    transpose(rows, &out->transpose);
    for (int32_t j = 0; j < n; j++)
        place[j] = -1;
    for (int32_t j = 0; j < n; j++)
        entries += multiply_row(rows, &out->transpose, j, place, touched, NULL);
    if (entries > INT32_MAX)
        return ss_refuse_large(label, error);
    new_rows(memory, n, n, entries, &out->square);
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t j = 0; j < n; j++)
        out->square.start[j + 1] = out->square.start[j] + multiply_row(rows, &out->transpose, j, place, touched, &out->square);
    return SKINSLIDE_OK;
}

/* ---- Creation ---- */

static skinslide_status refuse(const ss_least_squares *sparse, const char *label, skinslide_error *error) {
    if (sparse->common.status == KLU_OUT_OF_MEMORY)
        return ss_out_of_memory(error);
    if (sparse->common.status == KLU_TOO_LARGE)
        return ss_refuse_large(label, error);
    return ss_fail(error, SKINSLIDE_SINGULAR, "%s: its vertices do not follow from points of its limit surface", label);
}

/* A'A is symmetric: its rows serve as the columns that KLU takes. */
static skinslide_status factor(ss_least_squares *sparse, const ss_rows *square, const char *label, skinslide_error *error) {
    klu_common *common = &sparse->common;
    sparse->symbolic = klu_analyze(square->row_count, square->start, square->column, common);
    if (!sparse->symbolic)
        return refuse(sparse, label, error);
    sparse->numeric = klu_factor(square->start, square->column, square->value, sparse->symbolic, common);
    if (!sparse->numeric || !klu_condest(square->start, square->value, sparse->symbolic, sparse->numeric, common))
        return refuse(sparse, label, error);
    return common->condest < worst_condition ? SKINSLIDE_OK : refuse(sparse, label, error);
}

skinslide_status ss_least_squares_create(const ss_rows *rows, const char *label, ss_least_squares **out,
                                         skinslide_error *error) {
    ss_least_squares *sparse = calloc(1, sizeof *sparse);
    if (!sparse)
        return ss_out_of_memory(error);
    product square = {0};
    klu_defaults(&sparse->common);
    sparse->common.btf = 0; /* it permutes rows alone, and off the diagonal of A'A pivots are small */
    sparse->column_count = rows->column_count;
    skinslide_status status = SKINSLIDE_OK;
    if (rows->column_count > 0)
        status = multiply(rows, label, &square, error);
    if (!status && rows->column_count > 0)
        status = factor(sparse, &square.square, label, error);
    ss_free(&square.memory);
    if (status)
        ss_least_squares_destroy(sparse);
    else
        *out = sparse;
    return status;
}

void ss_least_squares_destroy(ss_least_squares *sparse) {
    if (!sparse)
        return;
    klu_free_numeric(&sparse->numeric, &sparse->common); /* both take NULL */
    klu_free_symbolic(&sparse->symbolic, &sparse->common);
    free(sparse);
}

skinslide_status ss_least_squares_work_create(const ss_least_squares *sparse, ss_least_squares_work **out,
                                              skinslide_error *error) {
    ss_least_squares_work *work = calloc(1, sizeof *work);
    if (!work)
        return ss_out_of_memory(error);
    work->sparse = sparse;
    work->common = sparse->common;
    if (sparse->numeric) {
        work->numeric = *sparse->numeric;
        work->numeric.Xwork = SS_NEW(&work->memory, double, 4 * (int64_t)sparse->column_count);
    }
    if (work->memory.failed) {
        ss_least_squares_work_destroy(work);
        return ss_out_of_memory(error);
    }
    *out = work;
    return SKINSLIDE_OK;
}

void ss_least_squares_work_destroy(ss_least_squares_work *work) {
    if (!work)
        return;
    ss_free(&work->memory);
    free(work);
}

void ss_least_squares_solve(ss_least_squares_work *work, double *right, int32_t count) {
    int32_t n = work->sparse->column_count;
    if (n > 0)
        klu_solve(work->sparse->symbolic, &work->numeric, n, count, right, &work->common);
}
