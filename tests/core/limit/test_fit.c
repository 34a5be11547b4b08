/* The least squares of interpolation LIMIT: what is asked for nothing stays, what is asked for more comes near the least that
 * there is, which is found densely and with derivatives by differences. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double edge_stiffness = 0.023, direction_stiffness = 0.05, all_ways_stiffness = 0.3;

enum { MOST_FREE = 12, MOST_SAMPLES = 40, MOST_EDGES = 60, MOST_UNKNOWNS = 3 * MOST_FREE };
enum { MOST_TERMS = 4 * (MOST_SAMPLES + MOST_EDGES) };

typedef struct problem {
    test_mesh mesh;
    ss_patch *patch;
    float *points;
    int32_t *free_index;
    ss_rows samples;
    double linear[MOST_FREE][3], residual[MOST_SAMPLES][3], normal[MOST_SAMPLES][3];
    ss_fit *fit;
    ss_fit_work *work;
} problem;

/* Sample i is mostly free vertex i, then as many again are means of several: normals lean from z by up to a half. */
static void put_samples(problem *p, dice *d) {
    int32_t count = p->patch->free_count, end = 0;
    ss_rows *rows = &p->samples;
    *rows = (ss_rows){.row_count = 2 * count, .column_count = count};
    rows->start = calloc(2 * (size_t)count + 1, sizeof *rows->start);
    rows->column = malloc(6 * (size_t)count * sizeof *rows->column);
    rows->value = malloc(6 * (size_t)count * sizeof *rows->value);
    for (int32_t s = 0; s < 2 * count; s++) {
        for (int k = 0; k < (count > 4 ? 3 : 1); k++)
            rows->column[end] = (s + 2 * k) % count, rows->value[end++] = s < count && k == 0 ? 0.6 : roll_between(d, 0.1, 0.3);
        rows->start[s + 1] = end;
        double lean[3] = {roll_between(d, -0.5, 0.5), roll_between(d, -0.5, 0.5), 1};
        double length = sqrt(lean[0] * lean[0] + lean[1] * lean[1] + 1);
        for (int axis = 0; axis < 3; axis++)
            p->normal[s][axis] = lean[axis] / length, p->residual[s][axis] = roll_between(d, -0.3, 0.3);
    }
}

/* From unit normals, which the fit is made with, to some of any length. */
static void shorten(problem *p, dice *d) {
    for (int32_t s = 0; s < p->samples.row_count; s++) {
        double length = roll_between(d, 0, 1);
        for (int axis = 0; axis < 3; axis++)
            p->normal[s][axis] *= length;
    }
}

/* The fit keeps the problem's samples, so it is filled where it stays. */
static void fill_problem(problem *p, int32_t columns, int32_t rows, uint64_t seed) {
    dice d = {seed};
    p->mesh = quad_grid(columns, rows);
    int32_t *faces = all_faces(&p->mesh);
    p->patch = patch_of(&p->mesh, setup_of(faces, p->mesh.face_count));
    p->points = shaken(&p->mesh, seed, 0.2);
    p->free_index = malloc((size_t)p->patch->vertex_count * sizeof *p->free_index);
    for (int32_t v = 0; v < p->patch->vertex_count; v++)
        p->free_index[v] = -1;
    for (int32_t i = 0; i < p->patch->free_count; i++)
        p->free_index[p->patch->free_vertex[i]] = i;
    put_samples(p, &d);
    for (int32_t i = 0; i < p->patch->free_count; i++)
        for (int axis = 0; axis < 3; axis++)
            p->linear[i][axis] = roll_between(&d, -0.2, 0.2);
    skinslide_error error;
    assert_ok(ss_fit_create(p->patch, p->free_index, &p->samples, (const double(*)[3])p->normal, &p->fit, &error), &error);
    assert_ok(ss_fit_work_create(p->fit, &p->work, &error), &error);
    if (seed % 2)
        shorten(p, &d);
    free(faces);
}

static void fit_until(const problem *p, int stop, double (*displacement)[3]) {
    ss_frame frame = {.points = p->points, .stop = &stop};
    ss_fit_samples(p->work, &frame, p->residual, p->normal, displacement);
}

static void fit(const problem *p, double (*displacement)[3]) {
    fit_until(p, 0, displacement);
}

static void free_problem(problem *p) {
    ss_fit_work_destroy(p->work);
    ss_fit_destroy(p->fit);
    ss_patch_destroy(p->patch);
    free(p->points), free(p->free_index);
    free(p->samples.start), free(p->samples.column), free(p->samples.value);
    free_mesh(&p->mesh);
}

/* ---- The terms of E, and their least sum of squares ---- */

static void edge_at(const problem *p, int32_t e, const double (*displacement)[3], double out[3]) {
    const int32_t *v = p->patch->edge_vertex[e];
    for (int axis = 0; axis < 3; axis++) {
        double end[2];
        for (int k = 0; k < 2; k++)
            end[k] = p->points[3 * p->patch->mesh_vertex[v[k]] + axis] +
                     (p->free_index[v[k]] < 0 ? 0 : displacement[p->free_index[v[k]]][axis]);
        out[axis] = end[1] - end[0];
    }
}

static double norm(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static int32_t list_terms(const problem *p, const double (*displacement)[3], double *terms) {
    int32_t count = 0;
    for (int32_t s = 0; s < p->samples.row_count; s++) {
        double sum = 0, square = norm(p->normal[s]) * norm(p->normal[s]);
        for (int axis = 0; axis < 3; axis++) {
            double moved = -p->residual[s][axis];
            for (int32_t k = p->samples.start[s]; k < p->samples.start[s + 1]; k++)
                moved += p->samples.value[k] * displacement[p->samples.column[k]][axis];
            sum += moved * p->normal[s][axis];
            terms[count++] = sqrt(all_ways_stiffness) * (1 - square) * moved;
        }
        terms[count++] = sum;
    }
    for (int32_t e = 0; e < p->patch->faces.edge_count; e++) {
        double now[3], before[3];
        edge_at(p, e, displacement, now), edge_at(p, e, p->linear, before);
        terms[count++] = sqrt(edge_stiffness) * (norm(now) - norm(before));
        for (int axis = 0; axis < 3; axis++)
            terms[count++] = sqrt(edge_stiffness * direction_stiffness) * (now[axis] - before[axis]);
    }
    return count;
}

static double energy(const problem *p, const double (*displacement)[3]) {
    double terms[MOST_TERMS], sum = 0;
    for (int32_t k = list_terms(p, displacement, terms) - 1; k >= 0; k--)
        sum += terms[k] * terms[k];
    return sum;
}

/* Gauss, without exchanges: the matrix is positive definite. */
static void solve_densely(double (*matrix)[MOST_UNKNOWNS + 1], int32_t n, double *x) {
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i + 1; j < n; j++) {
            double share = matrix[j][i] / matrix[i][i];
            for (int32_t k = i; k <= n; k++)
                matrix[j][k] -= share * matrix[i][k];
        }
    for (int32_t i = n - 1; i >= 0; i--) {
        x[i] = matrix[i][n];
        for (int32_t k = i + 1; k < n; k++)
            x[i] -= matrix[i][k] * x[k];
        x[i] /= matrix[i][i];
    }
}

static void step_densely(const problem *p, double *unknown) {
    enum { H = 10000 }; /* 1 / the step of differences, whose error is its square times a curvature of about 1 */
    static double slope[MOST_UNKNOWNS][MOST_TERMS], matrix[MOST_UNKNOWNS][MOST_UNKNOWNS + 1];
    double terms[MOST_TERMS], ahead[MOST_TERMS], behind[MOST_TERMS], x[MOST_UNKNOWNS];
    int32_t n = 3 * p->patch->free_count, count = list_terms(p, (const double(*)[3])unknown, terms);
    for (int32_t i = 0; i < n; i++) {
        double here = unknown[i];
        unknown[i] = here + 1.0 / H, list_terms(p, (const double(*)[3])unknown, ahead);
        unknown[i] = here - 1.0 / H, list_terms(p, (const double(*)[3])unknown, behind);
        unknown[i] = here;
        for (int32_t k = 0; k < count; k++)
            slope[i][k] = 0.5 * H * (ahead[k] - behind[k]);
    }
    memset(matrix, 0, sizeof matrix);
    for (int32_t k = 0; k < count; k++)
        for (int32_t i = 0; i < n; i++) {
            for (int32_t j = 0; j < n; j++)
                matrix[i][j] += slope[i][k] * slope[j][k];
            matrix[i][n] -= slope[i][k] * terms[k];
        }
    solve_densely(matrix, n, x);
    for (int32_t i = 0; i < n; i++)
        unknown[i] += x[i];
}

/* ---- Properties ---- */

/* One free vertex has three unknowns, which five steps of conjugate gradients find: two of Gauss-Newton, to rounding and the
 * error of the differences. */
static void one_vertex_goes_where_gauss_and_newton_send_it(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 30; seed++) {
        problem p;
        fill_problem(&p, 2, 2, seed);
        double expected[1][3], fitted[1][3];
        memcpy(expected, p.linear, sizeof expected), memcpy(fitted, p.linear, sizeof fitted);
        step_densely(&p, expected[0]), step_densely(&p, expected[0]);
        fit(&p, fitted);
        for (int axis = 0; axis < 3; axis++)
            assert_near(fitted[0][axis], expected[0][axis], 1e-7);
        free_problem(&p);
    }
}

/* Of what the energy can fall by, at least 95 %. */
static void the_energy_comes_near_its_least(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 30; seed++) {
        problem p;
        fill_problem(&p, 5, 4, seed);
        double least[MOST_FREE][3], fitted[MOST_FREE][3];
        memcpy(least, p.linear, sizeof least), memcpy(fitted, p.linear, sizeof fitted);
        for (int k = 0; k < 12; k++)
            step_densely(&p, least[0]);
        fit(&p, fitted);
        double before = energy(&p, (const double(*)[3])p.linear), bottom = energy(&p, (const double(*)[3])least);
        assert_true(bottom < 0.9 * before);
        assert_true(before - energy(&p, (const double(*)[3])fitted) > 0.95 * (before - bottom));
        free_problem(&p);
    }
}

/* Residuals of 0, and residuals along the plane: not a bit moves. */
static void samples_in_their_planes_stay(void **state) {
    (void)state;
    problem p;
    fill_problem(&p, 5, 4, 3);
    for (int slipped = 0; slipped < 2; slipped++) {
        for (int32_t s = 0; s < p.samples.row_count; s++)
            for (int axis = 0; axis < 3; axis++)
                p.normal[s][axis] = axis == 2, p.residual[s][axis] = axis < 2 ? slipped * 0.1 * s : 0;
        double none[MOST_FREE][3] = {{0}}, fitted[MOST_FREE][3] = {{0}};
        fit(&p, fitted);
        for (int32_t i = 0; i < p.patch->free_count; i++)
            for (int axis = 0; axis < 3; axis++)
                assert_true(fitted[i][axis] == none[i][axis]);
    }
    free_problem(&p);
}

/* Where the surface has no normal a sample is asked for in every direction, so it comes nearer in each. */
static void samples_without_a_normal_come_nearer(void **state) {
    (void)state;
    problem p;
    fill_problem(&p, 2, 2, 5);
    memset(p.normal, 0, sizeof p.normal);
    for (int32_t s = 0; s < p.samples.row_count; s++)
        for (int axis = 0; axis < 3; axis++)
            p.residual[s][axis] = p.samples.value[s] * (axis + 1);
    double fitted[1][3];
    memcpy(fitted, p.linear, sizeof fitted);
    fit(&p, fitted);
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabs(fitted[0][axis] - (axis + 1)) < 0.5 * fabs(p.linear[0][axis] - (axis + 1)));
    free_problem(&p);
}

/* So what a normal is that is about to vanish, rounding or not, does not matter. */
static void one_with_hardly_a_normal_is_as_one_without(void **state) {
    (void)state;
    problem p;
    double fitted[2][MOST_FREE][3];
    fill_problem(&p, 5, 4, 6);
    for (int hardly = 0; hardly < 2; hardly++) {
        for (int axis = 0; axis < 3; axis++)
            p.normal[3][axis] = hardly * (axis == 1 ? 1e-4 : 0);
        memcpy(fitted[hardly], p.linear, sizeof p.linear);
        fit(&p, fitted[hardly]);
    }
    for (int32_t i = 0; i < p.patch->free_count; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_near(fitted[1][i][axis], fitted[0][i][axis], 1e-6); /* by its square */
    free_problem(&p);
}

static void a_frame_that_is_not_wanted_is_not_fitted(void **state) {
    (void)state;
    problem p;
    double left[MOST_FREE][3];
    fill_problem(&p, 4, 4, 5);
    size_t size = (size_t)p.patch->free_count * sizeof *left;
    memcpy(left, p.linear, size);
    fit_until(&p, 1, left);
    assert_same_bytes(left, p.linear, size);
    free_problem(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_vertex_goes_where_gauss_and_newton_send_it),
        cmocka_unit_test(the_energy_comes_near_its_least),
        cmocka_unit_test(samples_in_their_planes_stay),
        cmocka_unit_test(samples_without_a_normal_come_nearer),
        cmocka_unit_test(one_with_hardly_a_normal_is_as_one_without),
        cmocka_unit_test(a_frame_that_is_not_wanted_is_not_fitted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
