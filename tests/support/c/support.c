/* See support.h. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void assert_ok_at(skinslide_status status, const skinslide_error *error, const char *file, int line) {
    if (status == SKINSLIDE_OK)
        return;
    print_error("%s: %s\n", skinslide_status_name(status), error ? error->message : "");
    _fail(file, line);
}

void assert_near_at(double actual, double expected, double tolerance, const char *file, int line) {
    if (fabs(actual - expected) <= tolerance)
        return;
    print_error("%.17g is not %.17g: off by %.3g, more than %.3g\n", actual, expected, fabs(actual - expected), tolerance);
    _fail(file, line);
}

void assert_fails_at(skinslide_status status, const skinslide_error *error, skinslide_status expected, const char *text,
                     const char *file, int line) {
    size_t length = strlen(text);
    bool beginning = length >= 3 && strcmp(text + length - 3, "...") == 0;
    bool same = beginning ? strncmp(error->message, text, length - 3) == 0 : strcmp(error->message, text) == 0;
    if (status == expected && error->status == expected && same)
        return;
    print_error("%s: %s\nexpected %s: %s\n", skinslide_status_name(status), error->message, skinslide_status_name(expected),
                text);
    _fail(file, line);
}

skinslide_patch_setup setup_of(const int32_t *faces, int32_t face_count) {
    return (skinslide_patch_setup){
        .size = sizeof(skinslide_patch_setup), .name = "all", .faces = faces, .face_count = face_count};
}

ss_patch *patch_of(const test_mesh *mesh, skinslide_patch_setup choices) {
    static _Thread_local skinslide_patch_setup kept; /* patches refer to their set-up */
    kept = choices, kept.size = sizeof kept;
    if (!kept.name)
        kept.name = "all";
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    skinslide_error error;
    ss_patch *patch = NULL;
    const ss_piece piece = {.faces = faces, .face_count = mesh->face_count, .count = 1};
    skinslide_status status = ss_patch_create(&view, NULL, &kept, 0, &piece, &patch, &error);
    free(faces);
    assert_ok(status, &error);
    return patch;
}

rig rig_of_setups(const test_mesh *mesh, const skinslide_patch_setup *setups, int32_t count) {
    rig r = {0};
    skinslide_mesh view = view_of(mesh);
    skinslide_error error;
    assert_ok(skinslide_slider_create(&view, setups, count, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, NULL, &r.workspace, &error), &error);
    return r;
}

rig rig_of(const test_mesh *mesh, skinslide_patch_setup choices) {
    int32_t *faces = all_faces(mesh);
    choices.size = sizeof choices, choices.name = "all", choices.faces = faces, choices.face_count = mesh->face_count;
    rig r = rig_of_setups(mesh, &choices, 1);
    free(faces);
    return r;
}

void free_rig(rig *r) {
    skinslide_workspace_destroy(r->workspace);
    skinslide_slider_destroy(r->slider);
}

float *slide_with(const rig *r, const test_mesh *mesh, const float *points, const skinslide_controls *controls,
                  skinslide_patch_result *results) {
    float *slid = malloc(POINT_BYTES(mesh));
    assert_non_null(slid);
    skinslide_error error;
    if (results)
        results->size = sizeof *results;
    assert_ok(skinslide_slide(r->workspace, points, controls, slid, results, &error), &error);
    return slid;
}

bool all_finite(const float *values, int64_t count) {
    for (int64_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

void expect_finite_slides(const test_mesh *mesh, skinslide_patch_setup choices, uint64_t poses) {
    rig r = rig_of(mesh, choices);
    float *slid = slide_with(&r, mesh, mesh->points, NULL, NULL);
    assert_same_bytes(slid, mesh->points, POINT_BYTES(mesh));
    free(slid);
    for (uint64_t seed = 0; seed < poses; seed++) {
        float *points = random_pose(mesh, seed);
        slid = slide_with(&r, mesh, points, NULL, NULL);
        assert_true(all_finite(slid, 3 * (int64_t)mesh->vertex_count));
        free(points), free(slid);
    }
    free_rig(&r);
}

double (*held_uv_of(const ss_patch *patch, const float *rest_points))[2] {
    double(*uv)[2] = calloc((size_t)patch->vertex_count, sizeof *uv);
    skinslide_error error;
    assert_ok(ss_place_boundary(patch, patch->setup->boundary, rest_points, uv, &error), &error);
    if (patch->setup->holes == SKINSLIDE_HOLES_PINNED)
        assert_ok(ss_place_holes(patch, rest_points, uv, &error), &error);
    return uv;
}

double (*embedding_of(const ss_patch *patch, const float *rest_points, const float *points))[2] {
    size_t edges = (size_t)patch->faces.edge_count;
    double *lengths = malloc(edges * sizeof *lengths), *density = malloc(edges * sizeof *density);
    double(*uv)[2] = held_uv_of(patch, rest_points);
    ss_net net = ss_net_of(patch, patch->fixed);
    skinslide_error error;
    ss_edge_lengths(patch, points, lengths);
    ss_force_density(patch, lengths, NULL, density);
    assert_ok(ss_embed_once(&net, patch->label, density, uv, &error), &error);
    free(lengths), free(density);
    return uv;
}

/* The matrix, with unknowns in the order of the net's vertices, and two right sides last: [n][n + 2]. */
static double *fill_dense(const ss_net *net, const double *density, const double (*uv)[2], const int32_t *unknown, int32_t n) {
    double *rows = calloc((size_t)n * (size_t)(n + 2) + 1, sizeof *rows);
    for (int32_t e = 0; e < net->edge_count; e++)
        for (int end = 0; end < 2; end++) {
            int32_t a = net->edge_vertex[e][end], b = net->edge_vertex[e][1 - end];
            if (net->fixed[a])
                continue;
            double *row = rows + (int64_t)unknown[a] * (n + 2);
            row[unknown[a]] += density[e];
            for (int k = 0; k < 2 && net->fixed[b]; k++)
                row[n + k] += density[e] * uv[b][k];
            if (!net->fixed[b])
                row[unknown[b]] -= density[e];
        }
    return rows;
}

static void exchange_rows(double *rows, int32_t n, int32_t i, int32_t j) {
    for (int32_t k = 0; k < n + 2; k++) {
        double swap = rows[(int64_t)i * (n + 2) + k];
        rows[(int64_t)i * (n + 2) + k] = rows[(int64_t)j * (n + 2) + k];
        rows[(int64_t)j * (n + 2) + k] = swap;
    }
}

/* Gauss-Jordan elimination, with row exchanges. */
static void eliminate(double *rows, int32_t n) {
    for (int32_t i = 0; i < n; i++) {
        int32_t best = i;
        for (int32_t j = i + 1; j < n; j++)
            if (fabs(rows[(int64_t)j * (n + 2) + i]) > fabs(rows[(int64_t)best * (n + 2) + i]))
                best = j;
        exchange_rows(rows, n, i, best);
        double *row = rows + (int64_t)i * (n + 2);
        for (int32_t j = 0; j < n; j++) {
            double *other = rows + (int64_t)j * (n + 2), share = other[i] / row[i];
            for (int32_t k = i; k < n + 2 && j != i && share != 0; k++)
                other[k] -= share * row[k];
        }
    }
}

void embed_densely(const ss_net *net, const double *density, double (*uv)[2]) {
    int32_t *unknown = calloc((size_t)net->vertex_count, sizeof *unknown), n = 0;
    for (int32_t v = 0; v < net->vertex_count; v++)
        unknown[v] = net->fixed[v] ? -1 : n++;
    double *rows = fill_dense(net, density, (const double(*)[2])uv, unknown, n);
    eliminate(rows, n);
    for (int32_t v = 0; v < net->vertex_count; v++)
        for (int k = 0; k < 2 && unknown[v] >= 0; k++)
            uv[v][k] = rows[(int64_t)unknown[v] * (n + 2) + n + k] / rows[(int64_t)unknown[v] * (n + 3)];
    free(rows), free(unknown);
}

ss_place place_at(const ss_patch *patch, const double (*uv)[2], int32_t triangle, const double p[2]) {
    ss_place place;
    ss_place_at(patch, uv, triangle, p, &place);
    return place;
}

ss_place search_all(const ss_patch *patch, const double (*uv)[2], const double p[2], bool *inside) {
    const ss_faces *faces = &patch->faces;
    *inside = true;
    for (int32_t f = 0; f < faces->face_count; f++) {
        int32_t triangle = ss_triangle_holding(patch, f, uv, p);
        if (triangle >= 0)
            return place_at(patch, uv, triangle, p);
    }
    *inside = false;
    double best = INFINITY, at[2], nearest[2] = {0, 0};
    int32_t corner = 0;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        double square = ss_nearest_on_side(faces, uv, c, p, at);
        if (square < best)
            best = square, corner = c, nearest[0] = at[0], nearest[1] = at[1];
    }
    return place_at(patch, uv, ss_triangle_of_side(patch, corner), nearest);
}

void assert_same_place(const ss_place *a, const ss_place *b) {
    assert_int_equal(a->triangle, b->triangle);
    assert_same_bytes(a->weight, b->weight, sizeof a->weight);
    assert_same_bytes(a->uv, b->uv, sizeof a->uv);
}

bool choose_way(const fixture *f, int32_t way, skinslide_patch_setup *choices) {
    *choices = setup_of(NULL, 0);
    choices->boundary = way & 1 ? SKINSLIDE_BOUNDARY_SQUARE : SKINSLIDE_BOUNDARY_CIRCLE;
    choices->holes = way & 2 ? SKINSLIDE_HOLES_FREE : SKINSLIDE_HOLES_PINNED;
    choices->interpolation = way & 4 ? SKINSLIDE_INTERPOLATION_MEAN_VALUE : SKINSLIDE_INTERPOLATION_LINEAR;
    choices->rule = (skinslide_rule)(way / 8);
    return (f->square || !(way & 1)) && (f->holes || !(way & 2));
}

static float *random_floats(int32_t count, dice *d, double low, double high) {
    float *values = malloc((size_t)count * sizeof *values);
    for (int32_t i = 0; i < count; i++)
        values[i] = (float)roll_between(d, low, high);
    return values;
}

painted paint_at_random(const test_mesh *mesh, uint64_t seed) {
    dice d = {seed};
    painted p = {.controls = SKINSLIDE_CONTROLS_DEFAULT};
    p.controls.vertex_density = p.vertex_density = random_floats(mesh->vertex_count, &d, 0.2, 5);
    p.controls.face_density = p.face_density = random_floats(mesh->face_count, &d, 0.2, 5);
    p.controls.weight = p.weight = random_floats(mesh->vertex_count, &d, 0, 1);
    p.controls.envelope = 0.75f;
    return p;
}

void free_painted(painted *p) {
    free(p->vertex_density);
    free(p->face_density);
    free(p->weight);
}

double largest_difference(const float *a, const float *b, int64_t count) {
    double largest = 0;
    for (int64_t i = 0; i < count; i++)
        largest = fmax(largest, fabs((double)a[i] - b[i]));
    return largest;
}
