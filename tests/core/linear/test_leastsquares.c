/* Normal equations: they hold, a square system is solved, what cannot be is refused. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A random matrix with a dominant entry in each of its first rows, so that its columns are independent. */
static ss_rows random_rows(int32_t row_count, int32_t column_count, uint64_t seed) {
    enum { EXTRA = 3 };
    dice d = {seed};
    ss_rows rows = {.row_count = row_count, .column_count = column_count};
    rows.start = calloc((size_t)row_count + 1, sizeof *rows.start);
    rows.column = malloc((size_t)row_count * (EXTRA + 1) * sizeof *rows.column);
    rows.value = malloc((size_t)row_count * (EXTRA + 1) * sizeof *rows.value);
    for (int32_t i = 0, end = 0; i < row_count; i++) {
        rows.column[end] = i % column_count, rows.value[end++] = roll_between(&d, 2, 3);
        for (int32_t k = 1; k <= EXTRA && k < column_count; k++)
            rows.column[end] = (i + 7 * k * k) % column_count, rows.value[end++] = roll_between(&d, -0.5, 0.5);
        rows.start[i + 1] = end;
    }
    return rows;
}

static void free_rows(ss_rows *rows) {
    free(rows->start), free(rows->column), free(rows->value);
}

/* out = A x, or A'x */
static void multiply(const ss_rows *rows, bool transposed, const double *x, double *out) {
    memset(out, 0, (size_t)(transposed ? rows->column_count : rows->row_count) * sizeof *out);
    for (int32_t i = 0; i < rows->row_count; i++)
        for (int32_t k = rows->start[i]; k < rows->start[i + 1]; k++)
            out[transposed ? rows->column[k] : i] += rows->value[k] * x[transposed ? i : rows->column[k]];
}

/* A'A x = b to rounding, for several b at a time. */
static void check(int32_t row_count, int32_t column_count, int32_t count, uint64_t seed) {
    ss_rows rows = random_rows(row_count, column_count, seed);
    dice d = {seed};
    ss_least_squares *sparse;
    ss_least_squares_work *work;
    skinslide_error error;
    assert_ok(ss_least_squares_create(&rows, "all", &sparse, &error), &error);
    assert_ok(ss_least_squares_work_create(sparse, &work, &error), &error);
    size_t size = (size_t)(count * column_count) * sizeof(double);
    double *b = malloc(size), *x = malloc(size), *image = malloc((size_t)row_count * sizeof *image), *again = malloc(size);
    for (int32_t i = 0; i < count * column_count; i++)
        b[i] = x[i] = roll_between(&d, -1, 1);
    ss_least_squares_solve(work, x, count);
    for (int32_t k = 0; k < count; k++) {
        multiply(&rows, false, x + k * column_count, image);
        multiply(&rows, true, image, again + k * column_count);
    }
    for (int32_t i = 0; i < count * column_count; i++)
        assert_near(again[i], b[i], 1e-12);
    free(b), free(x), free(image), free(again);
    ss_least_squares_work_destroy(work);
    ss_least_squares_destroy(sparse);
    free_rows(&rows);
}

static void normal_equations_hold(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 20; seed++) {
        check(1, 1, 1, seed);
        check(40, 40, 3, seed);
        check(90, 31, 1, seed);
        check(500, 200, 3, seed);
    }
}

static void no_columns_are_no_work(void **state) {
    (void)state;
    int32_t start[3] = {0, 0, 0}, column[1] = {0};
    double value[1] = {0};
    ss_rows rows = {2, 0, start, column, value};
    ss_least_squares *sparse;
    ss_least_squares_work *work;
    skinslide_error error;
    assert_ok(ss_least_squares_create(&rows, "all", &sparse, &error), &error);
    assert_ok(ss_least_squares_work_create(sparse, &work, &error), &error);
    ss_least_squares_solve(work, value, 1);
    assert_true(value[0] == 0);
    ss_least_squares_work_destroy(work);
    ss_least_squares_destroy(sparse);
}

/* Two columns that are the same, nearly the same, or empty. */
static void dependent_columns_are_refused(void **state) {
    (void)state;
    int32_t start[3] = {0, 2, 4}, column[4] = {0, 1, 0, 1};
    ss_least_squares *sparse = NULL;
    skinslide_error error;
    for (int i = 0; i < 3; i++) {
        double value[4] = {1, 1, 1, i == 0 ? 1 : 1 + 1e-7};
        ss_rows rows = {2, i == 2 ? 3 : 2, start, column, value};
        assert_fails(ss_least_squares_create(&rows, "patch all", &sparse, &error), &error, SKINSLIDE_SINGULAR,
                     "patch all: its vertices do not follow from points of its limit surface");
        assert_null(sparse);
    }
}

/* A row of 46,341 entries, whose square has more than an int counts. */
static void a_square_that_is_too_large(void **state) {
    (void)state;
    enum { COLUMNS = 46341 };
    int32_t start[2] = {0, COLUMNS}, *column = malloc(COLUMNS * sizeof *column);
    double *value = malloc(COLUMNS * sizeof *value);
    for (int32_t j = 0; j < COLUMNS; j++)
        column[j] = j, value[j] = 1;
    const ss_rows rows = {1, COLUMNS, start, column, value};
    ss_least_squares *sparse = NULL;
    skinslide_error error;
    assert_fails(ss_least_squares_create(&rows, "patch all", &sparse, &error), &error, SKINSLIDE_UNSUPPORTED,
                 "patch all: its limit system is too large");
    assert_null(sparse);
    free(column), free(value);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normal_equations_hold),
        cmocka_unit_test(no_columns_are_no_work),
        cmocka_unit_test(dependent_columns_are_refused),
        cmocka_unit_test(a_square_that_is_too_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
