/* The texture of faces, and what is gathered from it, against the same done on the host. */
#include "faults.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const ss_device_request plain = {.load = ss_egl_load, .device = SKINSLIDE_ANY_DEVICE};

typedef struct drawn {
    fixture f;
    ss_patch *patch;
    double (*uv)[2], (*queries)[2];
} drawn;

/* A fixture in a random pose, with queries anywhere in the square and on its border. */
static drawn draw_fixture(int32_t index, uint64_t seed) {
    drawn d = {.f = make_fixture(index)};
    dice at = {seed};
    float *pose = random_pose(&d.f.mesh, seed);
    d.patch = patch_of(&d.f.mesh, (skinslide_patch_setup){0});
    d.uv = embedding_of(d.patch, d.f.mesh.points, pose);
    d.queries = calloc((size_t)d.patch->free_count + 1, sizeof *d.queries);
    for (int32_t i = 0; i < d.patch->free_count; i++)
        for (int k = 0; k < 2; k++)
            d.queries[i][k] = fmin(1, fmax(0, roll_between(&at, -0.1, 1.1)));
    free(pose);
    return d;
}

static void free_drawn(drawn *d) {
    ss_patch_destroy(d->patch);
    free(d->uv), free(d->queries);
    free_mesh(&d->f.mesh);
}

static ss_idbuffer *buffer_for(const drawn *d, int32_t count, int32_t side) {
    ss_id_patch patches[FIXTURE_COUNT];
    ss_idbuffer *buffer = NULL;
    skinslide_error error;
    for (int32_t i = 0; i < count; i++)
        patches[i] = (ss_id_patch){&d[i].patch->faces, d[i].patch->free_count, side};
    assert_ok(ss_idbuffer_create(&plain, patches, count, 0, &buffer, &error), &error);
    return buffer;
}

/* ---- The gathering ---- */

/* As the shader does it, on texels that were read back. */
static void gather(const uint32_t *texels, int32_t side, const double query[2], ss_candidates out) {
    int32_t x = (int32_t)((float)query[0] * (float)side), y = (int32_t)((float)query[1] * (float)side), count = 1;
    x = x < side ? x : side - 1, y = y < side ? y : side - 1;
    for (int k = 0; k < SS_CANDIDATES; k++)
        out[k] = -1;
    out[0] = (int32_t)texels[(int64_t)y * side + x] - 1;
    for (int i = 0; i < 9; i++) {
        int32_t u = x + i % 3 - 1, v = y + i / 3 - 1;
        if (u < 0 || v < 0 || u >= side || v >= side)
            continue;
        int32_t face = (int32_t)texels[(int64_t)v * side + u] - 1;
        bool seen = face < 0;
        for (int k = 0; k < count; k++)
            seen = seen || out[k] == face;
        if (!seen)
            out[count++] = face;
    }
}

static bool among(const ss_candidates candidates, int32_t face) {
    for (int k = 0; k < SS_CANDIDATES; k++)
        if (candidates[k] == face)
            return true;
    return false;
}

/* The own texel's face first, and the same set behind it: at the border of the square the order of the others is the device's.
 */
static void compare_gathered(const drawn *d, const uint32_t *texels, int32_t side, const ss_candidates *found) {
    for (int32_t i = 0; i < d->patch->free_count; i++) {
        ss_candidates expected;
        gather(texels, side, d->queries[i], expected);
        assert_int_equal(found[i][0], expected[0]);
        for (int k = 0; k < SS_CANDIDATES; k++)
            assert_true(among(found[i], expected[k]) && among(expected, found[i][k]));
    }
}

/* All patches are drawn before the first is asked for, as a frame does. */
static void candidates_are_those_of_the_texels(void **state) {
    (void)state;
    static const int32_t sides[] = {1, 2, 37, 256};
    drawn all[FIXTURE_COUNT];
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        all[i] = draw_fixture(i, (uint64_t)i + 1);
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
        int32_t side = sides[s];
        ss_idbuffer *buffer = buffer_for(all, FIXTURE_COUNT, side);
        uint32_t *texels = malloc((size_t)side * (size_t)side * sizeof *texels);
        for (int32_t i = 0; i < FIXTURE_COUNT; i++)
            ss_idbuffer_draw(buffer, i, (const double(*)[2])all[i].uv, (const double(*)[2])all[i].queries);
        for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
            skinslide_error error;
            ss_candidates *found = calloc((size_t)all[i].patch->free_count + 1, sizeof *found);
            assert_true(all[i].patch->free_count == 0 || ss_idbuffer_candidates(buffer, i, found));
            assert_ok(ss_idbuffer_read(buffer, i, (const double(*)[2])all[i].uv, texels, &error), &error);
            compare_gathered(&all[i], texels, side, (const ss_candidates *)found);
            free(found);
        }
        free(texels);
        ss_idbuffer_destroy(buffer);
    }
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        free_drawn(&all[i]);
}

/* ---- The drawing ---- */

/* How far p is inside the fan triangle that it is deepest in; below 0 outside. */
static double depth_in(const ss_faces *faces, int32_t face, const double (*uv)[2], const double p[2]) {
    double deepest = -INFINITY;
    for (int32_t t = 0; t < ss_fan_size(faces, face); t++) {
        int32_t v[3];
        double depth = INFINITY;
        ss_fan(faces, face, t, v);
        for (int k = 0; k < 3; k++) {
            const double *a = uv[v[k]], *b = uv[v[(k + 1) % 3]];
            double x = b[0] - a[0], y = b[1] - a[1];
            depth = fmin(depth, (x * (p[1] - a[1]) - y * (p[0] - a[0])) / fmax(hypot(x, y), 1e-30));
        }
        deepest = fmax(deepest, depth);
    }
    return deepest;
}

/* A texel has a face that its centre is in, and none only where it is in none: to a 128th of a texel, since devices round
 * corners to a 256th along either axis. */
static void every_texel_is_in_its_face(void **state) {
    (void)state;
    enum { SIDE = 64 };
    const double slack = 1.0 / 128 / SIDE;
    static uint32_t texels[SIDE * SIDE];
    for (int32_t index = 0; index < FIXTURE_COUNT; index++) {
        drawn d = draw_fixture(index, 11);
        if (!ss_lay_out(d.patch, (const double(*)[2])d.uv).regular) {
            free_drawn(&d);
            continue;
        }
        ss_idbuffer *buffer = buffer_for(&d, 1, SIDE);
        skinslide_error error;
        assert_ok(ss_idbuffer_read(buffer, 0, (const double(*)[2])d.uv, texels, &error), &error);
        for (int32_t i = 0; i < SIDE * SIDE; i++) {
            const double centre[2] = {(i % SIDE + 0.5) / SIDE, (i / SIDE + 0.5) / SIDE};
            double deepest = -INFINITY;
            for (int32_t f = 0; f < d.patch->faces.face_count && !texels[i]; f++)
                deepest = fmax(deepest, depth_in(&d.patch->faces, f, (const double(*)[2])d.uv, centre));
            if (texels[i])
                assert_true(depth_in(&d.patch->faces, (int32_t)texels[i] - 1, (const double(*)[2])d.uv, centre) > -slack);
            else
                assert_true(deepest < slack);
        }
        ss_idbuffer_destroy(buffer);
        free_drawn(&d);
    }
}

/* ---- Resolution ---- */

static int32_t side_of_grid(int32_t columns, bool squeezed) {
    test_mesh mesh = quad_grid(columns, columns);
    ss_patch *patch = patch_of(&mesh, (skinslide_patch_setup){0});
    double(*uv)[2] = malloc((size_t)patch->vertex_count * sizeof *uv);
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        const float *p = mesh.points + 3 * (int64_t)patch->mesh_vertex[v];
        for (int k = 0; k < 2; k++)
            uv[v][k] = (double)p[k] / columns * (squeezed && k == 0 ? 1e-4 : 1);
    }
    int32_t side = ss_id_side(patch, (const double(*)[2])uv);
    free(uv);
    ss_patch_destroy(patch);
    free_mesh(&mesh);
    return side;
}

/* 4 sqrt(n) for n free vertices, rounded up to a power of two, 256 at least; a triangle of 1/2 / 50^2 needs 71 texels along a
 * side, of a ten thousandth of that 7,071, which is more than four times 196. */
static void resolution_follows_the_patch(void **state) {
    (void)state;
    assert_int_equal(side_of_grid(2, false), 256);
    assert_int_equal(side_of_grid(50, false), 256);  /* 4 * 49 = 196 */
    assert_int_equal(side_of_grid(100, false), 512); /* 4 * 99 = 396 */
    assert_int_equal(side_of_grid(50, true), 1024);  /* 4 * 196 = 784 */
}

static skinslide_status create_with(fault planned, int32_t side, int32_t resolution, ss_idbuffer **out,
                                    skinslide_error *error) {
    static drawn d; /* outlives the buffer */
    if (!d.patch)
        d = draw_fixture(0, 3);
    ss_id_patch patch = {&d.patch->faces, d.patch->free_count, side};
    ss_device_request request = {.load = load_with_faults, .device = SKINSLIDE_ANY_DEVICE};
    plan_fault(planned);
    *out = NULL;
    return ss_idbuffer_create(&request, &patch, 1, resolution, out, error);
}

static void resolution_within_the_device(void **state) {
    (void)state;
    skinslide_error error;
    ss_idbuffer *buffer;
    fault small = {.devices = -1, .largest = 512};
    assert_ok(create_with(small, 2048, 0, &buffer, &error), &error);
    assert_int_equal(ss_idbuffer_side(buffer, 0), 512);
    ss_idbuffer_destroy(buffer);
    assert_ok(create_with(small, 2048, 300, &buffer, &error), &error);
    assert_int_equal(ss_idbuffer_side(buffer, 0), 300);
    ss_idbuffer_destroy(buffer);
    assert_fails(create_with(small, 256, 513, &buffer, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "resolution 513 is above the device's limit of 512");
    assert_fails(create_with((fault)NO_FAULT, 256, 1 << 20, &buffer, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "resolution 1048576 is above the device's limit of ...");
    assert_null(buffer);
    ss_idbuffer_destroy(NULL);
}

/* Without patches the largest texture is tried that any could ask for. */
static void without_patches_the_largest_is_tried(void **state) {
    (void)state;
    static const struct {
        int32_t resolution, largest;
        const char *text;
    } cases[] = {{0, 0, "the device's framebuffer of 4096 by 4096 texels is not complete..."},
                 {0, 512, "the device's framebuffer of 512 by 512 texels is not complete..."},
                 {300, 0, "the device's framebuffer of 300 by 300 texels is not complete..."}};
    ss_device_request request = {.load = load_with_faults, .device = SKINSLIDE_ANY_DEVICE};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_error error;
        ss_idbuffer *buffer = NULL;
        fault planned = {.call = "glCheckFramebufferStatus", .times = -1, .code = GL_FRAMEBUFFER_UNSUPPORTED, .devices = -1};
        planned.largest = cases[i].largest;
        plan_fault(planned);
        assert_fails(ss_idbuffer_create(&request, NULL, 0, cases[i].resolution, &buffer, &error), &error,
                     SKINSLIDE_DEVICE_FAILED, cases[i].text);
    }
}

/* ---- Devices that cannot ---- */

static void devices_that_cannot(void **state) {
    (void)state;
    static const struct {
        const char *call, *text;
        uint32_t code;
    } cases[] = {
        {"glCheckFramebufferStatus", "the device's framebuffer of 256 by 256 texels is not complete: 0x8cdd",
         GL_FRAMEBUFFER_UNSUPPORTED},
        {"glGetProgramiv", "the device's compiler refuses a program: ...", 0},
        {"glGetError", "the device has no room for the patches: OpenGL error 0x0505", GL_OUT_OF_MEMORY},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        skinslide_error error;
        ss_idbuffer *buffer;
        fault planned = {.call = cases[i].call, .times = -1, .code = cases[i].code, .devices = -1};
        assert_fails(create_with(planned, 256, 0, &buffer, &error), &error, SKINSLIDE_DEVICE_FAILED, cases[i].text);
        assert_null(buffer);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(candidates_are_those_of_the_texels),   cmocka_unit_test(every_texel_is_in_its_face),
        cmocka_unit_test(resolution_follows_the_patch),         cmocka_unit_test(resolution_within_the_device),
        cmocka_unit_test(without_patches_the_largest_is_tried), cmocka_unit_test(devices_that_cannot),
    };
    return cmocka_run_group_tests_name("idbuffer", tests, NULL, NULL);
}
