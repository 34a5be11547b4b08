/* An incomplete factor of the normal equations of a sparse A, to precondition conjugate gradients with:
 *
 *     L L' = A'A     except for entries where A'A has none, which are dropped (Meijerink and van der Vorst 1977)
 *
 * found in double, kept and solved with in float. If a pivot vanishes because of what was dropped, the diagonal is enlarged
 * until none does; A'A itself must then be well enough conditioned. */
#include "linear.h"

#include <math.h>
#include <stdlib.h>

#define WORST_CONDITION 1e10 /* leaves six digits of a double, as many as a float has */
#define FIRST_SHIFT     1e-3 /* share by which the diagonal is enlarged first, then four times as much, and so on */
#define MOST_SHIFTS     20

/* The entries of L off the diagonal, by rows or by columns. */
typedef struct lines {
    int32_t *start; /* [n + 1] */
    int32_t *other;
    float *value;
} lines;

struct ss_incomplete {
    ss_memory memory;
    int32_t n;
    lines rows, columns;
    float *inverse; /* [n] 1 / the diagonal */
};

/* ---- A'A ---- */

static void new_rows(ss_memory *memory, int32_t row_count, int32_t column_count, int64_t entries, ss_rows *rows) {
    *rows = (ss_rows){.row_count = row_count, .column_count = column_count};
    rows->start = SS_NEW(memory, int32_t, (int64_t)row_count + 1);
    rows->column = SS_NEW(memory, int32_t, entries);
    rows->value = SS_NEW(memory, double, entries);
}

/* The columns of each row of out are ascending, whatever they were in rows. */
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

/* Writes row j of A'A, up to its diagonal, to out's column and value from out->start[j] on; if out is NULL, only counts it.
 * place [columns] must be -1 everywhere, and is again after. */
static int32_t multiply_row(const ss_rows *rows, const ss_rows *transposed, int32_t j, int32_t *place, int32_t *touched,
                            ss_rows *out) {
    int32_t count = 0;
    for (int32_t k = transposed->start[j]; k < transposed->start[j + 1]; k++) {
        int32_t i = transposed->column[k];
        for (int32_t l = rows->start[i]; l < rows->start[i + 1]; l++) {
            int32_t column = rows->column[l];
            if (column > j)
                continue;
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

static skinslide_status refuse_singular(const char *label, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_SINGULAR, "%s: its vertices do not follow from points of its limit surface", label);
}

/* The lower half of A'A. Transposing twice sorts its rows. */
static skinslide_status multiply(const ss_rows *rows, const char *label, ss_memory *memory, ss_rows *out,
                                 skinslide_error *error) {
    int32_t n = rows->column_count;
    int64_t entries = 0;
    ss_rows transposed, unsorted, columns;
    new_rows(memory, n, rows->row_count, rows->start[rows->row_count], &transposed);
    int32_t *place = SS_NEW(memory, int32_t, n), *touched = SS_NEW(memory, int32_t, n);
    if (memory->failed)
        return ss_out_of_memory(error);
    transpose(rows, &transposed);
    for (int32_t j = 0; j < n; j++)
        place[j] = -1;
    for (int32_t j = 0; j < n; j++)
        entries += multiply_row(rows, &transposed, j, place, touched, NULL);
    if (2 * entries - n > INT32_MAX) /* both halves, and the diagonal once */
        return ss_refuse_large(label, error);
    new_rows(memory, n, n, entries, &unsorted);
    new_rows(memory, n, n, entries, &columns);
    new_rows(memory, n, n, entries, out);
    if (memory->failed)
        return ss_out_of_memory(error);
    for (int32_t j = 0; j < n; j++)
        unsorted.start[j + 1] = unsorted.start[j] + multiply_row(rows, &transposed, j, place, touched, &unsorted);
    transpose(&unsorted, &columns);
    transpose(&columns, out);
    return SKINSLIDE_OK;
}

/* ---- The factor ---- */

/* Finds row i of L, whose pattern is that of A'A; its last entry is the diagonal, enlarged by shift. at [n] is where row i has
 * each column, or -1. False if the pivot is too small. */
static bool factor_row(const ss_rows *square, int32_t i, double shift, const int32_t *at, ss_rows *L) {
    int32_t begin = L->start[i], last = L->start[i + 1] - 1;
    double whole = square->value[last], pivot = (1 + shift) * whole;
    for (int32_t p = begin; p < last; p++) {
        int32_t j = L->column[p], end = L->start[j + 1] - 1;
        double sum = square->value[p];
        for (int32_t q = L->start[j]; q < end; q++)
            if (at[L->column[q]] >= 0)
                sum -= L->value[at[L->column[q]]] * L->value[q];
        L->value[p] = sum / L->value[end];
        pivot -= L->value[p] * L->value[p];
    }
    L->value[last] = sqrt(pivot);
    return pivot * WORST_CONDITION > whole && isfinite(pivot);
}

/* False if a row has no diagonal, or a pivot is too small. */
static bool factor(const ss_rows *square, double shift, int32_t *at, ss_rows *L) {
    bool good = true;
    for (int32_t i = 0; i < square->row_count && good; i++) {
        int32_t begin = L->start[i], end = L->start[i + 1];
        if (begin == end || L->column[end - 1] != i)
            return false;
        for (int32_t p = begin; p < end; p++)
            at[L->column[p]] = p;
        good = factor_row(square, i, shift, at, L);
        for (int32_t p = begin; p < end; p++)
            at[L->column[p]] = -1;
    }
    return good;
}

/* ---- If a pivot vanishes ---- */

/* Fills blocks with A'A, scaled so that its diagonal is 1, less the smallest eigenvalue that its condition allows; each number
 * twice. */
static void fill_blocks(const ss_rows *square, ss_blocks *blocks) {
    int32_t edge = 0;
    ss_blocks_clear(blocks);
    for (int32_t i = 0; i < square->row_count; i++) {
        double *own = ss_blocks_own(blocks, ss_blocks_unknown(blocks, i)), whole = square->value[square->start[i + 1] - 1];
        own[0] = own[3] = 1 - 1 / WORST_CONDITION;
        for (int32_t p = square->start[i]; p + 1 < square->start[i + 1]; p++) {
            int32_t j = square->column[p];
            bool first_is_row;
            double *between = ss_blocks_between(blocks, edge++, &first_is_row);
            between[0] = between[3] = square->value[p] / sqrt(whole * square->value[square->start[j + 1] - 1]);
        }
    }
}

/* Fails with SINGULAR if that is not positive definite. */
static skinslide_status check_blocks(const ss_rows *square, const ss_net *net, const char *label, skinslide_error *error) {
    const int going_on = 0;
    ss_system *system = NULL;
    ss_blocks *blocks = NULL;
    skinslide_status status = ss_system_create(net, label, &system, error);
    if (!status)
        status = ss_blocks_create(system, false, NULL, &blocks, error);
    if (!status) {
        fill_blocks(square, blocks);
        if (!ss_blocks_factor(blocks, &going_on))
            status = refuse_singular(label, error);
    }
    ss_blocks_destroy(blocks);
    ss_system_destroy(system);
    return status;
}

static skinslide_status check_condition(const ss_rows *square, const char *label, skinslide_error *error) {
    ss_memory scratch = {0};
    int32_t n = square->row_count, count = 0, entries = square->start[n];
    int32_t(*edges)[2] = ss_new(&scratch, entries, sizeof *edges);
    uint8_t *fixed = SS_NEW(&scratch, uint8_t, n);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t i = 0; i < n && !status; i++) {
        int32_t last = square->start[i + 1] - 1;
        if (last < square->start[i] || square->column[last] != i || !(square->value[last] > 0))
            status = refuse_singular(label, error);
        for (int32_t p = square->start[i]; p < last && !status; p++)
            edges[count][0] = i, edges[count++][1] = square->column[p];
    }
    if (!status)
        status = check_blocks(square, &(ss_net){n, count, (const int32_t(*)[2])edges, fixed}, label, error);
    ss_free(&scratch);
    return status;
}

/* ---- Creation ---- */

static skinslide_status find_factor(const ss_rows *square, const char *label, int32_t *at, ss_rows *L, skinslide_error *error) {
    if (factor(square, 0, at, L))
        return SKINSLIDE_OK;
    skinslide_status status = check_condition(square, label, error);
    double shift = FIRST_SHIFT;
    for (int k = 0; k < MOST_SHIFTS && !status; k++, shift *= 4)
        if (factor(square, shift, at, L))
            return SKINSLIDE_OK;
    return status ? status : refuse_singular(label, error);
}

static void new_lines(ss_memory *memory, int32_t n, int64_t entries, lines *out) {
    out->start = SS_NEW(memory, int32_t, (int64_t)n + 1);
    out->other = SS_NEW(memory, int32_t, entries);
    out->value = SS_NEW(memory, float, entries);
}

/* L without its diagonal, by rows and by columns. */
static void keep(const ss_rows *L, ss_incomplete *incomplete) {
    lines *rows = &incomplete->rows, *columns = &incomplete->columns;
    int32_t n = incomplete->n, end = 0;
    for (int32_t i = 0; i < n; rows->start[++i] = end) {
        int32_t last = L->start[i + 1] - 1;
        incomplete->inverse[i] = (float)(1 / L->value[last]);
        for (int32_t p = L->start[i]; p < last; p++) {
            rows->other[end] = L->column[p], rows->value[end++] = (float)L->value[p];
            columns->start[L->column[p] + 1]++;
        }
    }
    for (int32_t j = 0; j < n; j++)
        columns->start[j + 1] += columns->start[j];
    for (int32_t i = n - 1; i >= 0; i--)
        for (int32_t p = rows->start[i]; p < rows->start[i + 1]; p++) {
            int32_t place = --columns->start[rows->other[p] + 1];
            columns->other[place] = i, columns->value[place] = rows->value[p];
        }
    for (int32_t j = 0; j < n; j++)
        columns->start[j] = columns->start[j + 1];
    columns->start[n] = end;
}

static skinslide_status build(const ss_rows *rows, const char *label, ss_incomplete *incomplete, skinslide_error *error) {
    ss_memory scratch = {0};
    ss_rows square;
    int32_t n = incomplete->n = rows->column_count;
    skinslide_status status = multiply(rows, label, &scratch, &square, error);
    int64_t entries = status ? 0 : square.start[n];
    ss_rows L = square;
    int32_t *at = SS_NEW(&scratch, int32_t, n);
    L.value = SS_NEW(&scratch, double, entries);
    incomplete->inverse = SS_NEW(&incomplete->memory, float, n);
    new_lines(&incomplete->memory, n, entries, &incomplete->rows);
    new_lines(&incomplete->memory, n, entries, &incomplete->columns);
    if (!status && (scratch.failed || incomplete->memory.failed))
        status = ss_out_of_memory(error);
    for (int32_t j = 0; j < n && !status; j++)
        at[j] = -1;
    if (!status)
        status = find_factor(&square, label, at, &L, error);
    if (!status)
        keep(&L, incomplete);
    ss_free(&scratch);
    return status;
}

skinslide_status ss_incomplete_create(const ss_rows *rows, const char *label, ss_incomplete **out, skinslide_error *error) {
    ss_incomplete *incomplete = calloc(1, sizeof *incomplete);
    if (!incomplete)
        return ss_out_of_memory(error);
    skinslide_status status = build(rows, label, incomplete, error);
    if (status)
        ss_incomplete_destroy(incomplete);
    else
        *out = incomplete;
    return status;
}

void ss_incomplete_destroy(ss_incomplete *incomplete) {
    if (!incomplete)
        return;
    ss_free(&incomplete->memory);
    free(incomplete);
}

/* ---- Solving ---- */

/* The product of line i with x, in two sums that need not wait for each other. */
static inline float product(const lines *of, int32_t i, const float *x) {
    int32_t p = of->start[i], end = of->start[i + 1];
    float even = 0, odd = 0;
    for (; p + 1 < end; p += 2) {
        even += of->value[p] * x[of->other[p]];
        odd += of->value[p + 1] * x[of->other[p + 1]];
    }
    return even + odd + (p < end ? of->value[p] * x[of->other[p]] : 0);
}

void ss_incomplete_solve(const ss_incomplete *incomplete, float *x) {
    for (int32_t i = 0; i < incomplete->n; i++)
        x[i] = (x[i] - product(&incomplete->rows, i, x)) * incomplete->inverse[i];
    for (int32_t i = incomplete->n - 1; i >= 0; i--)
        x[i] = (x[i] - product(&incomplete->columns, i, x)) * incomplete->inverse[i];
}
