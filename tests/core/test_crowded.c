/* Embeddings that crowd together: along a finger each ring is smaller in the plane by a constant factor, until rings are closer
 * to each other than doubles are, and whole stretches of skin are one point. Every query is answered, in time that a frame has.
 */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Bent into an arc of one radian, its middle line as long as before, thicker by up to a tenth in the middle and shaken a
 * little. */
static float *bent(const test_mesh *mesh, uint64_t seed) {
    dice d = {seed};
    float *points = copy_points(mesh);
    double length = points[3 * (mesh->vertex_count - 1) + 2];
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        float *p = points + 3 * v;
        double angle = p[2] / length, radius = length - p[0] * (1 + 0.4 * angle * (1 - angle));
        p[0] = (float)(length - radius * cos(angle) + roll_between(&d, -0.01, 0.01));
        p[2] = (float)(radius * sin(angle) + roll_between(&d, -0.01, 0.01));
        p[1] = (float)(p[1] * (1 + 0.4 * angle * (1 - angle)));
    }
    return points;
}

static bool in_box(const float *points, int32_t vertex_count, const float *p) {
    for (int k = 0; k < 3; k++) {
        bool below = false, above = false;
        for (int32_t v = 0; v < vertex_count; v++)
            below |= points[3 * v + k] <= p[k], above |= points[3 * v + k] >= p[k];
        if (!below || !above)
            return false;
    }
    return true;
}

/* The limit is far above what a frame takes, for slow machines and sanitizers, and far below what a search of all faces for
 * every vertex would. */
static void check_finger(int32_t around, int32_t rings, skinslide_interpolation interpolation) {
    test_mesh mesh = finger(around, rings);
    skinslide_patch_setup choices = setup_of(NULL, 0);
    choices.interpolation = interpolation;
    rig r = rig_of(&mesh, choices);
    skinslide_patch_result result = SKINSLIDE_PATCH_RESULT_DEFAULT;
    float *slid = slide_with(&r, &mesh, mesh.points, NULL, &result);
    assert_same_bytes(slid, mesh.points, POINT_BYTES(&mesh));
    free(slid);
    float *points = bent(&mesh, 1);
    double start = now();
    slid = slide_with(&r, &mesh, points, NULL, &result);
    double seconds = now() - start;
    print_message("%d x %d: %d vertices, %.1f ms (locate %.1f), searched %d, clamped %d, folded %d\n", around, rings,
                  mesh.vertex_count, 1e3 * seconds, 1e3 * result.locate_seconds, result.searched_vertices,
                  result.clamped_vertices, result.folded_faces);
    assert_int_equal(result.folded_faces, 0);
    for (int32_t v = 0; v < mesh.vertex_count; v += 1 + mesh.vertex_count / 500)
        assert_true(in_box(points, mesh.vertex_count, slid + 3 * v));
    assert_true(seconds < 2);
    free(points), free(slid);
    free_rig(&r);
    free_mesh(&mesh);
}

static void fingers(void **state) {
    (void)state;
    check_finger(12, 30, SKINSLIDE_INTERPOLATION_LINEAR);
    check_finger(50, 200, SKINSLIDE_INTERPOLATION_LINEAR);
    check_finger(50, 200, SKINSLIDE_INTERPOLATION_MEAN_VALUE);
}

static void fingers_below_double_precision(void **state) {
    (void)state;
    check_finger(12, 200, SKINSLIDE_INTERPOLATION_LINEAR);
    check_finger(6, 600, SKINSLIDE_INTERPOLATION_MEAN_VALUE);
    check_finger(20, 500, SKINSLIDE_INTERPOLATION_LINEAR);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fingers),
        cmocka_unit_test(fingers_below_double_precision),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
