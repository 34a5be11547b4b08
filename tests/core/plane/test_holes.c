/* Where pinned holes go. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By hand: n vertices around, the outer circle twice as far out as the inner, in space and, at R = 1/2, in the plane. An inner
 * vertex at r is pulled along its ray by the outer one (length 1), by the cap's (length 1) and by its two neighbours (length
 * 2 s, s = sin(pi/n)), which are 2 r s^2 nearer to the centre each:
 *     (R - r) - r - 2 r s^2 (2 / (2 s)) = 0,   r = R / (2 + 2 s).
 * Points are float, so lengths are right to 1e-7 of themselves, and r to a few 1e-8. */
static void the_hole_of_an_annulus_by_hand(void **state) {
    (void)state;
    for (int32_t n = 3; n < 30; n++) {
        test_mesh mesh = annulus(n, 1);
        ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
        double(*uv)[2] = held_uv_of(patch, mesh.points);
        double r = 0.5 / (2 + 2 * sin(acos(-1) / n));
        for (int32_t i = 0; i < n; i++) {
            double angle = 2 * acos(-1) * i / n;
            assert_near(uv[n + i][0], 0.5 + r * cos(angle), 1e-7);
            assert_near(uv[n + i][1], 0.5 + r * sin(angle), 1e-7);
        }
        free(uv);
        ss_patch_destroy(patch);
        free_mesh(&mesh);
    }
}

typedef struct capped {
    ss_net net;
    int32_t (*edges)[2];
    uint8_t *fixed;
    double *density, (*uv)[2];
} capped;

static double between(const double a[3], const float *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static const float *point_of(const ss_patch *patch, const test_mesh *mesh, int32_t vertex) {
    return mesh->points + 3 * (int64_t)patch->mesh_vertex[vertex];
}

static void add_edge(capped *c, int32_t a, int32_t b, double length) {
    int32_t e = c->net.edge_count++;
    c->edges[e][0] = a, c->edges[e][1] = b, c->density[e] = 1 / length;
}

static void add_cap(capped *c, const ss_patch *patch, const test_mesh *mesh, int32_t loop) {
    double centre[3] = {0, 0, 0};
    int32_t begin = patch->loop_start[loop], end = patch->loop_start[loop + 1], cap = c->net.vertex_count++;
    for (int32_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
            centre[k] += (double)point_of(patch, mesh, patch->loop_vertex[i])[k] / (end - begin);
    for (int32_t i = begin; i < end; i++)
        add_edge(c, patch->loop_vertex[i], cap, between(centre, point_of(patch, mesh, patch->loop_vertex[i])));
}

static capped cap_holes(const ss_patch *patch, const test_mesh *mesh, const double (*uv)[2]) {
    size_t vertices = (size_t)(patch->vertex_count + patch->loop_count), edges = (size_t)patch->faces.edge_count + vertices;
    capped c = {.edges = calloc(edges, sizeof *c.edges),
                .fixed = calloc(vertices, 1),
                .density = calloc(edges, sizeof *c.density),
                .uv = calloc(vertices, sizeof *c.uv)};
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        add_edge(&c, patch->edge_vertex[e][0], patch->edge_vertex[e][1], patch->rest_length[e]);
    c.net.vertex_count = patch->vertex_count;
    for (int32_t loop = 1; loop < patch->loop_count; loop++)
        add_cap(&c, patch, mesh, loop);
    for (int32_t i = 0; i < patch->loop_start[1]; i++) {
        int32_t v = patch->loop_vertex[i];
        c.fixed[v] = 1;
        c.uv[v][0] = uv[v][0], c.uv[v][1] = uv[v][1];
    }
    c.net.edge_vertex = (const int32_t(*)[2])c.edges, c.net.fixed = c.fixed;
    return c;
}

static void free_capped(capped *c) {
    free(c->edges), free(c->fixed), free(c->density), free(c->uv);
}

/* Against the definition, solved densely; 1e-12 is the rounding of two ways to solve a system of condition about 1e3. Paint and
 * rule do not matter: holes are pinned before either is applied. */
static void holes_are_where_the_capped_patch_puts_them(void **state) {
    (void)state;
    for (int32_t i = 6; i <= 8; i++) {
        fixture f = make_fixture(i);
        ss_patch *patch = patch_of(&f.mesh, (skinslide_patch_setup){.rule = SKINSLIDE_RULE_FAST});
        double(*uv)[2] = held_uv_of(patch, f.mesh.points);
        capped c = cap_holes(patch, &f.mesh, (const double(*)[2])uv);
        embed_densely(&c.net, c.density, c.uv);
        for (int32_t v = 0; v < patch->vertex_count; v++)
            for (int k = 0; k < 2 && patch->vertex_loop[v] > 0; k++)
                assert_near(uv[v][k], c.uv[v][k], 1e-12);
        free_capped(&c);
        free(uv);
        ss_patch_destroy(patch);
        free_mesh(&f.mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_hole_of_an_annulus_by_hand),
        cmocka_unit_test(holes_are_where_the_capped_patch_puts_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
