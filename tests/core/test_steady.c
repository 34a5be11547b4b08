/* Once a workspace has slid a frame of a kind, no other asks the system for anything: no memory, and no call of the kernel.
 * Frames are slid in a process that the kernel kills at any call but to end, and the program's own malloc counts. Only what a
 * frame's controls name by edges is checked in memory of its own. */
#define _GNU_SOURCE
#include "support.h"

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- The C library's, by the names that it gives them ---- */

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

static int64_t asked; /* for memory */

void *malloc(size_t size) {
    asked++;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    asked++;
    return __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size) {
    asked++;
    return __libc_realloc(memory, size);
}

/* ---- One process ---- */

enum { POSES = 3, ENDED_WELL, ASKED, REFUSED };

typedef struct shot {
    const rig *r;
    float *points[POSES], *slid;
    const skinslide_controls *controls;
} shot;

static bool slide_all(const shot *s) {
    bool good = true;
    for (int i = 0; i < POSES; i++) {
        good = good && !skinslide_slide(s->r->workspace, s->points[i], NULL, s->slid, NULL, NULL);
        good = good && !skinslide_slide(s->r->workspace, s->points[i], s->controls, s->slid, NULL, NULL);
    }
    return good;
}

/* Reads a clock. Some virtual machines have none that needs no call of the kernel. */
static void tick(const shot *s) {
    (void)s;
    ss_now();
}

static void slide_again(const shot *s) {
    asked = 0;
    bool good = slide_all(s);
    syscall(SYS_exit, !good ? REFUSED : asked ? ASKED : ENDED_WELL);
}

/* From here on the kernel kills this thread at any call but to exit; false where it does not take such orders. */
static bool renounce_calls(void) {
    struct sock_filter only_exit[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 0, 1),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL)};
    struct sock_fprog program = {sizeof only_exit / sizeof *only_exit, only_exit};
    return !prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) && !prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

/* Runs work in a process that may do nothing else. Returns its exit status, or 0 if it was killed. */
static int end_of(void (*work)(const shot *s), const shot *s) {
    int status = 0;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (renounce_calls())
            work(s);
        syscall(SYS_exit, ENDED_WELL);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 0;
}

/* ---- Every way ---- */

static rig subdivided(const test_mesh *mesh, skinslide_patch_setup choices) {
    static const skinslide_subdivision catmull_clark = {.size = sizeof(skinslide_subdivision),
                                                        .scheme = SKINSLIDE_SCHEME_CATMULL_CLARK};
    static const skinslide_workspace_options exact = {sizeof(skinslide_workspace_options), SKINSLIDE_LOOKUP_EXACT,
                                                      SKINSLIDE_ANY_DEVICE, 0};
    skinslide_mesh view = view_of(mesh);
    int32_t *faces = all_faces(mesh);
    skinslide_error error;
    rig r;
    view.subdivision = &catmull_clark;
    choices.faces = faces, choices.face_count = mesh->face_count;
    assert_ok(skinslide_slider_create(&view, &choices, 1, &r.slider, &error), &error);
    assert_ok(skinslide_workspace_create(r.slider, &exact, &r.workspace, &error), &error);
    free(faces);
    return r;
}

static void expect_steady(const fixture *f, skinslide_patch_setup choices) {
    rig r = subdivided(&f->mesh, choices);
    painted p = paint_at_random(&f->mesh, 1);
    float *limits = malloc((size_t)f->mesh.vertex_count * sizeof *limits);
    for (int32_t v = 0; v < f->mesh.vertex_count; v++)
        limits[v] = 0.1f;
    p.controls.max_distance = limits;
    shot s = {.r = &r, .slid = malloc(POINT_BYTES(&f->mesh)), .controls = &p.controls};
    for (int i = 0; i < POSES; i++)
        s.points[i] = random_pose(&f->mesh, (uint64_t)i);
    assert_true(slide_all(&s));
    int end = end_of(slide_again, &s);
    if (end != ENDED_WELL)
        print_error("%s, rule %d, interpolation %d, holes %d: %s\n", f->name, (int)choices.rule, (int)choices.interpolation,
                    (int)choices.holes, end == ASKED ? "memory is asked for" : "the kernel is called");
    assert_int_equal(end, ENDED_WELL);
    for (int i = 0; i < POSES; i++)
        free(s.points[i]);
    free(s.slid), free(limits);
    free_painted(&p);
    free_rig(&r);
}

static void expect_ways_steady(const fixture *f) {
    for (int32_t way = 0; way < WAY_COUNT; way++) {
        skinslide_patch_setup choices;
        if (!choose_way(f, way, &choices))
            continue;
        expect_steady(f, choices);
        choices.interpolation = SKINSLIDE_INTERPOLATION_LIMIT;
        if (way % 8 < 4)
            expect_steady(f, choices);
    }
}

static void a_frame_asks_for_nothing(void **state) {
    (void)state;
    if (end_of(tick, NULL) != ENDED_WELL)
        skip();
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        fixture f = make_fixture(i);
        expect_ways_steady(&f);
        free_mesh(&f.mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_frame_asks_for_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
