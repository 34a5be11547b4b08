/* How many vertices the texture of lookup egl finds, in the own texel and in the 3x3 around it, and what a frame costs beside
 * lookup exact; for uneven sheets of 10,000 and 100,000 vertices, slides large and under a texel, textures of 256 to 4096. The
 * mean of three frames on one thread. Stops where the lookups differ in a bit. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "meshes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 3 };

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void stop_unless(bool good, const char *message) {
    if (good)
        return;
    fprintf(stderr, "%s\n", message);
    exit(1);
}

/* A sheet of the unit square in gentle waves, its vertices a fifth of a side off their places. */
static test_mesh uneven_sheet(int32_t columns) {
    test_mesh mesh = quad_grid(columns, columns);
    for (int32_t v = 0; v < mesh.vertex_count; v++) {
        float *p = mesh.points + 3 * (int64_t)v;
        double x = p[0], y = p[1];
        p[0] = (float)((x + 0.2 * sin(13 * y + x)) / columns), p[1] = (float)((y + 0.2 * cos(7 * x + 3 * y)) / columns);
        p[2] = (float)(0.05 * sin(9 * p[0]) * cos(7 * p[1]));
    }
    return mesh;
}

/* Draws the sheet out sideways and lifts it, by a share of its side. */
static void deform(const test_mesh *mesh, double amount, float *points) {
    const double pi = 3.14159265358979;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->points + 3 * (int64_t)v;
        float *q = points + 3 * (int64_t)v;
        q[0] = (float)(p[0] + amount * 0.3 * sin(pi * p[0]) * sin(pi * p[1]));
        q[1] = (float)(p[1] + amount * 0.2 * sin(2 * pi * p[0]) * sin(pi * p[1]));
        q[2] = (float)(p[2] + amount * sin(pi * p[0]) * p[1] * p[1]);
    }
}

typedef struct tally {
    int64_t centre, around, walked, searched;
    double locate, frame; /* seconds */
} tally;

/* slid holds the last frame. */
static tally slide_frames(const skinslide_slider *slider, const test_mesh *mesh, double amount, skinslide_lookup lookup,
                          int32_t side, float *slid) {
    skinslide_workspace_options options = {sizeof(skinslide_workspace_options), lookup, SKINSLIDE_ANY_DEVICE, side};
    skinslide_workspace *workspace = NULL;
    skinslide_error error;
    tally sum = {0};
    float *points = copy_points(mesh);
    stop_unless(!skinslide_workspace_create(slider, &options, &workspace, &error), error.message);
    for (int i = -1; i < FRAMES; i++) { /* the first warms up */
        skinslide_patch_result r = SKINSLIDE_PATCH_RESULT_DEFAULT;
        deform(mesh, amount * (i < 0 ? 1 : i + 1) / FRAMES, points);
        double start = now();
        stop_unless(!skinslide_slide(workspace, points, NULL, slid, &r, &error), error.message);
        if (i < 0)
            continue;
        sum.frame += (now() - start) / FRAMES, sum.locate += r.locate_seconds / FRAMES;
        sum.centre += r.found_in_centre, sum.around += r.found_in_3x3;
        sum.walked += r.walked_vertices, sum.searched += r.searched_vertices;
    }
    free(points);
    skinslide_workspace_destroy(workspace);
    return sum;
}

static void print_tally(int32_t vertices, double amount, int32_t side, const tally *t) {
    double all = (double)(t->centre + t->around + t->walked + t->searched) / 100;
    printf("| %d | %g | %d | %.2f %% | %.2f %% | %.2f %% | %.2f %% | %.1f | %.1f |\n", vertices, amount, side,
           (double)t->centre / all, (double)t->around / all, (double)t->walked / all, (double)t->searched / all,
           1e3 * t->locate, 1e3 * t->frame);
}

static void print_sheet(int32_t columns, double amount) {
    test_mesh mesh = uneven_sheet(columns);
    int32_t *faces = all_faces(&mesh);
    skinslide_mesh view = view_of(&mesh);
    skinslide_patch_setup setup = {
        .size = sizeof(skinslide_patch_setup), .name = "sheet", .faces = faces, .face_count = mesh.face_count};
    skinslide_slider *slider = NULL;
    skinslide_error error;
    stop_unless(!skinslide_slider_create(&view, &setup, 1, &slider, &error), error.message);
    float *expected = copy_points(&mesh), *slid = copy_points(&mesh);
    tally exact = slide_frames(slider, &mesh, amount, SKINSLIDE_LOOKUP_EXACT, 0, expected);
    print_tally(mesh.vertex_count, amount, 0, &exact);
    for (int32_t side = 256; side <= 4096; side *= 2) {
        tally egl = slide_frames(slider, &mesh, amount, SKINSLIDE_LOOKUP_EGL, side, slid);
        print_tally(mesh.vertex_count, amount, side, &egl);
        stop_unless(memcmp(slid, expected, (size_t)mesh.vertex_count * sizeof(float[3])) == 0, "the lookups differ");
    }
    free(expected), free(slid), free(faces);
    skinslide_slider_destroy(slider);
    free_mesh(&mesh);
}

int main(void) {
    const skinslide_workspace_options options = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EGL,
                                                 SKINSLIDE_ANY_DEVICE, 0};
    skinslide_lookup_info info = SKINSLIDE_LOOKUP_INFO_DEFAULT;
    skinslide_device_info device = SKINSLIDE_DEVICE_INFO_DEFAULT;
    skinslide_error error;
    stop_unless(!skinslide_choose_lookup(&options, &info, &device, &error), error.message);
    printf("%s: %s, %s\ntexels 0: lookup exact\n\n", device.device_name, device.renderer, device.driver);
    printf("| vertices | amount | texels | own texel | 3x3 | walked | searched | locate ms | frame ms |\n");
    printf("|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < 4; i++)
        print_sheet(i < 2 ? 99 : 315, i % 2 ? 1e-4 : 1.5);
    return 0;
}
