/* What a frame costs in the core, on one thread, by stage, for quads and triangles of about 1,000, 10,000 and 100,000 vertices;
 * what a frame of the rules without a plane costs beside one by force density; and what walking to a face costs beside looking
 * it up in the tree. The median frame of several. Ratios are of one run, so they can be compared where milliseconds cannot. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "meshes.h"
#include "slide.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 9 };
static const skinslide_workspace_options exact = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EXACT,
                                                  SKINSLIDE_ANY_DEVICE, 0};

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void stop_unless(bool good, const char *message) {
    if (good)
        return;
    fprintf(stderr, "%s\n", message);
    exit(1);
}

typedef struct cost { /* seconds */
    double density, embed, locate, interpolate, frame;
    int32_t vertices, free, relax_steps;
    int64_t steps;
} cost;

static int by_frame(const void *a, const void *b) {
    const cost *x = a, *y = b;
    return x->frame < y->frame ? -1 : x->frame > y->frame;
}

static skinslide_slider *slider_of(const test_mesh *mesh, skinslide_rule rule) {
    int32_t *faces = all_faces(mesh);
    skinslide_mesh view = view_of(mesh);
    skinslide_patch_setup setup = {
        .size = sizeof(skinslide_patch_setup), .name = "bench", .faces = faces, .face_count = mesh->face_count, .rule = rule};
    skinslide_slider *slider = NULL;
    skinslide_error error;
    stop_unless(skinslide_slider_create(&view, &setup, 1, &slider, &error) == SKINSLIDE_OK, error.message);
    free(faces);
    return slider;
}

static cost measure(const test_mesh *mesh, int32_t side, skinslide_rule rule) {
    skinslide_slider *slider = slider_of(mesh, rule);
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    stop_unless(skinslide_workspace_create(slider, &exact, &workspace, &error) == SKINSLIDE_OK, error.message);
    float *slid = copy_points(mesh);
    cost costs[FRAMES];
    for (int i = 0; i < FRAMES; i++) { /* a bump that travels under the sheet */
        float *points = bumped(mesh, side * (0.3 + 0.05 * i), 0.5 * side, 0.15 * side, 0.15 * side);
        skinslide_patch_result r = SKINSLIDE_PATCH_RESULT_DEFAULT;
        double start = now();
        stop_unless(skinslide_slide(workspace, points, NULL, slid, &r, &error) == SKINSLIDE_OK, error.message);
        costs[i] = (cost){r.density_seconds,
                          r.embed_seconds,
                          r.locate_seconds,
                          r.interpolate_seconds,
                          now() - start,
                          mesh->vertex_count,
                          slider->parts[0].patch->free_count,
                          r.relax_steps,
                          r.walk_steps};
        free(points);
    }
    free(slid);
    skinslide_workspace_destroy(workspace);
    skinslide_slider_destroy(slider);
    qsort(costs, FRAMES, sizeof *costs, by_frame);
    return costs[FRAMES / 2];
}

static void print_costs(const char *kind, test_mesh (*make)(int32_t columns, int32_t rows)) {
    static const int32_t sides[3] = {31, 99, 315};
    double first = 0;
    for (int i = 0; i < 3; i++) {
        test_mesh mesh = make(sides[i], sides[i]);
        cost c = measure(&mesh, sides[i], SKINSLIDE_RULE_UNIT);
        if (i == 0)
            first = c.frame;
        printf("| %s | %d | %.2f | %.2f | %.2f | %.2f | %.2f | %.1f | %.0f %% | %.1f |\n", kind, c.vertices, 1e3 * c.density,
               1e3 * c.embed, 1e3 * c.locate, 1e3 * c.interpolate, 1e3 * c.frame, c.frame / first, 100 * c.embed / c.frame,
               (double)c.steps / c.free);
        free_mesh(&mesh);
    }
}

static void print_rules(int32_t side) {
    test_mesh mesh = quad_grid(side, side);
    cost unit = measure(&mesh, side, SKINSLIDE_RULE_UNIT), even = measure(&mesh, side, SKINSLIDE_RULE_EVEN),
         relaxed = measure(&mesh, side, SKINSLIDE_RULE_RELAXED);
    printf("%d vertices: unit %.2f ms; even %.2f ms, %.1f times as long; relaxed %.2f ms in %d steps, %.1f times\n",
           unit.vertices, 1e3 * unit.frame, 1e3 * even.frame, even.frame / unit.frame, 1e3 * relaxed.frame, relaxed.relax_steps,
           relaxed.frame / unit.frame);
    free_mesh(&mesh);
}

/* Looks up rest places in the embedding of a bump: by walking, and by the tree alone, which is built first. */
static void print_lookups(int32_t side) {
    test_mesh mesh = quad_grid(side, side);
    skinslide_slider *slider = slider_of(&mesh, SKINSLIDE_RULE_UNIT);
    skinslide_workspace *workspace = NULL;
    const ss_part *part = &slider->parts[0];
    float *points = bumped(&mesh, 0.5 * side, 0.5 * side, 0.15 * side, 0.15 * side), *slid = copy_points(&mesh);
    stop_unless(!skinslide_workspace_create(slider, &exact, &workspace, NULL), "no workspace");
    stop_unless(!skinslide_slide(workspace, points, NULL, slid, NULL, NULL), "no frame");
    const ss_slide *slide = workspace->patches[0].slide;
    ss_locator *locator = NULL;
    stop_unless(!ss_locator_create(part->patch, &locator, NULL), "no locator");
    double seconds[2] = {1e9, 1e9};
    for (int i = 0; i < 2 * FRAMES; i++) {
        double start = now();
        ss_locate(locator, slide->flat.uv, i % 2 == 0, (const double(*)[2])slide->asked, NULL, slide->places);
        double taken = now() - start;
        seconds[i % 2] = taken < seconds[i % 2] ? taken : seconds[i % 2];
    }
    printf("%d queries: walk %.2f ms, tree %.2f ms, %.1f times as long\n", part->patch->free_count, 1e3 * seconds[0],
           1e3 * seconds[1], seconds[1] / seconds[0]);
    free(points), free(slid);
    ss_locator_destroy(locator);
    skinslide_workspace_destroy(workspace);
    skinslide_slider_destroy(slider);
    free_mesh(&mesh);
}

/* Processors that were idle take a while to reach their speed, which would slow the first rows. */
static void warm_up(void) {
    test_mesh mesh = quad_grid(99, 99);
    for (double start = now(); now() - start < 0.5;)
        measure(&mesh, 99, SKINSLIDE_RULE_UNIT);
    free_mesh(&mesh);
}

int main(void) {
    warm_up();
    printf("| mesh | vertices | density | embed | locate | interpolate | frame | to 1k | embed's share | steps a query |\n");
    printf("|---|---|---|---|---|---|---|---|---|---|\n");
    print_costs("quads", quad_grid);
    print_costs("triangles", triangle_grid);
    printf("\n");
    print_rules(9);
    print_rules(19);
    print_rules(31);
    print_rules(99);
    printf("\n");
    print_lookups(31);
    print_lookups(99);
    print_lookups(315);
    return 0;
}
