/* What a picture of 1920 by 1080 pixels costs, a mesh before a slide beside the same after, with all that is done for each. By
 * time of processors, of which a software rasteriser takes several; a machine that does other work too, does not tell in it. */
#define _POSIX_C_SOURCE 199309L
#include "canvas.h"
#include "meshes.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

enum { WIDTH = 1920, HEIGHT = 1080, PICTURES = 12 };

static void stop_unless(skinslide_status status, const skinslide_error *error) {
    if (status == SKINSLIDE_OK)
        return;
    fprintf(stderr, "%s\n", error->message);
    exit(1);
}

/* The seconds that this process has had of all processors. */
static double spent(void) {
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

typedef struct scene {
    test_mesh mesh;
    skinslide_tessellation *tessellation;
    skinslide_camera camera;
    skinslide_canvas *canvas;
    float *before, *after;
    double create; /* seconds, of the tessellation */
} scene;

/* A sheet with a bump, seen as a whole, or from so near that most of it is out of sight. The patch is a fifth of it along each
 * side. */
static scene set_scene(int32_t side, skinslide_scheme scheme, bool near) {
    scene s = {.mesh = quad_grid(side, side)};
    const skinslide_subdivision own = {.size = sizeof(skinslide_subdivision), .scheme = scheme};
    const double up[3] = {0, 1, 0};
    skinslide_mesh view = view_of(&s.mesh);
    int32_t *all = all_faces(&s.mesh), *patch = calloc((size_t)s.mesh.face_count, sizeof *patch), count = 0;
    skinslide_error error;
    view.subdivision = &own;
    for (int32_t f = 0; f < s.mesh.face_count; f++)
        if (abs(f % side - side / 2) * 10 < side && abs(f / side - side / 2) * 10 < side)
            patch[count++] = f;
    s.before = bumped(&s.mesh, 0.5 * side, 0.5 * side, 0.1 * side, 0.1 * side);
    s.after = bumped(&s.mesh, 0.51 * side, 0.5 * side, 0.1 * side, 0.1 * side);
    double start = spent();
    stop_unless(skinslide_tessellation_create(&view, NULL, patch, count, &s.tessellation, &error), &error);
    s.create = spent() - start;
    const float *poses[2] = {s.before, s.after};
    const skinslide_subject subject = {.size = sizeof(skinslide_subject),
                                       .mesh = &view,
                                       .faces = near ? patch : all,
                                       .face_count = near ? count : s.mesh.face_count,
                                       .pose_count = 2,
                                       .poses = poses};
    stop_unless(skinslide_frame_faces(&subject, up, 0.5 * WIDTH / HEIGHT, &s.camera, &error), &error);
    stop_unless(skinslide_canvas_create(NULL, &s.canvas, &error), &error);
    free(all), free(patch);
    return s;
}

static void end_scene(scene *s) {
    skinslide_canvas_destroy(s->canvas);
    skinslide_tessellation_destroy(s->tessellation);
    free(s->before), free(s->after);
    free_mesh(&s->mesh);
}

/* The seconds of one pose that is not drawn. */
static double tessellate(const scene *s) {
    const double nowhere[3] = {0, 0, 0};
    ss_tessellation_work work = {0};
    if (!ss_tessellation_work_allocate(s->tessellation, &work))
        exit(1);
    double start = spent();
    ss_tessellate(s->tessellation, s->before, nowhere, &work);
    double taken = spent() - start;
    ss_free(&work.memory);
    return taken;
}

/* Adds the seconds to draw and those to read: a device may draw as late as when its pixels are read. */
static void draw(const scene *s, void *pixels, double seconds[2]) {
    const float grey[3] = {0.2f, 0.2f, 0.2f};
    const skinslide_viewport left = {0, 0, WIDTH / 2, HEIGHT}, right = {WIDTH / 2, 0, WIDTH / 2, HEIGHT};
    skinslide_figure figure = {.size = sizeof(skinslide_figure),
                               .tessellation = s->tessellation,
                               .points = s->before,
                               .squares = 0.5f,
                               .double_sided = 1};
    skinslide_error error;
    double start = spent();
    stop_unless(skinslide_canvas_clear(s->canvas, grey, &error), &error);
    stop_unless(skinslide_canvas_draw(s->canvas, &left, &s->camera, &figure, &error), &error);
    figure.points = s->after;
    stop_unless(skinslide_canvas_draw(s->canvas, &right, &s->camera, &figure, &error), &error);
    double drawn = spent();
    stop_unless(skinslide_canvas_read(s->canvas, pixels, &error), &error);
    seconds[0] += drawn - start, seconds[1] += spent() - drawn;
}

static void print_costs(const char *kind, int32_t side, skinslide_scheme scheme, bool near) {
    scene s = set_scene(side, scheme, near);
    void *pixels = malloc((size_t)WIDTH * HEIGHT * 4);
    double seconds[2] = {0, 0}, posed = 0;
    for (int i = 0; i < 2; i++)
        draw(&s, pixels, seconds); /* programs are compiled when first used */
    seconds[0] = seconds[1] = 0;
    double start = now();
    for (int i = 0; i < PICTURES; i++)
        draw(&s, pixels, seconds);
    double taken = now() - start;
    for (int i = 0; i < PICTURES; i++)
        posed += tessellate(&s);
    printf("| %s | %d | %d | %.0f | %.1f | %.1f | %.1f | %.1f |\n", kind, s.mesh.vertex_count, s.tessellation->triangle_count,
           1e3 * s.create, 1e3 * posed / PICTURES, 1e3 * seconds[0] / PICTURES, 1e3 * seconds[1] / PICTURES, PICTURES / taken);
    free(pixels);
    end_scene(&s);
}

int main(void) {
    printf("| mesh | vertices | triangles | prepare once | tessellate, one pose | draw two | read | pictures a second |\n");
    printf("|---|---|---|---|---|---|---|---|\n");
    print_costs("faces, whole", 115, SKINSLIDE_SCHEME_NONE, false);
    print_costs("Catmull-Clark, whole", 115, SKINSLIDE_SCHEME_CATMULL_CLARK, false);
    print_costs("Catmull-Clark, patch", 115, SKINSLIDE_SCHEME_CATMULL_CLARK, true);
    print_costs("Catmull-Clark, whole", 350, SKINSLIDE_SCHEME_CATMULL_CLARK, false);
    print_costs("Catmull-Clark, patch", 350, SKINSLIDE_SCHEME_CATMULL_CLARK, true);
    return 0;
}
