/* Along a border: how far apart two of its vertices are is the sum of the sides between them, and a walk that far leads from
 * one to the other, whichever triangle a place is told in. */
#include "queries.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef struct border {
    fixture f;
    ss_patch *patch;
    ss_memory memory;
    ss_posed pose;
} border;

static border open_border(int32_t index) {
    border b = {.f = make_fixture(index)};
    b.patch = patch_of(&b.f.mesh, (skinslide_patch_setup){0});
    assert_true(ss_posed_allocate(&b.memory, b.patch, &b.pose));
    float *points = random_pose(&b.f.mesh, (uint64_t)index);
    ss_posed_set(&b.pose, points);
    free(points);
    return b;
}

static void close_border(border *b) {
    ss_free(&b->memory);
    ss_patch_destroy(b->patch);
    free_mesh(&b->f.mesh);
}

static double side_length(const border *b, int32_t loop, int32_t i) {
    const int32_t *v = b->patch->loop_vertex;
    int32_t begin = b->patch->loop_start[loop], count = b->patch->loop_start[loop + 1] - begin;
    double side[3];
    ss_subtract(b->pose.point[v[begin + (i + 1) % count]], b->pose.point[v[begin + i % count]], side);
    return ss_length(side);
}

/* From the i-th vertex of a loop to the j-th, the faces' way. */
static double way_between(const border *b, int32_t loop, int32_t i, int32_t j) {
    int32_t count = b->patch->loop_start[loop + 1] - b->patch->loop_start[loop];
    double way = 0;
    for (int32_t k = i; k % count != j; k++)
        way += side_length(b, loop, k);
    return way;
}

/* Lengths and sums of them are off by a few eps of the loop's. */
static void check_way(const border *b, int32_t loop, int32_t i, int32_t j, const ss_place *place) {
    const int32_t *vertices = b->patch->loop_vertex + b->patch->loop_start[loop];
    double ahead = way_between(b, loop, i, j), back = way_between(b, loop, j, i), tolerance = 64 * DBL_EPSILON * (ahead + back);
    double found = ss_border_distance(&b->pose, vertices[i], place), point[3];
    assert_near(fabs(found), fmin(ahead, back), tolerance);
    assert_true(fabs(ahead - back) <= tolerance || (found < 0) == (back < ahead));
    ss_place end = ss_place_of_vertex(b->patch, NULL, vertices[i]);
    ss_walk_border(&b->pose, &end, found);
    ss_place_point(&b->pose, &end, point);
    for (int k = 0; k < 3; k++)
        assert_near(point[k], b->pose.point[vertices[j]][k], tolerance);
}

/* The j-th vertex of a loop as each triangle at it has it. */
static void check_ways(const border *b, int32_t loop, int32_t i, int32_t j) {
    int32_t vertex = b->patch->loop_vertex[b->patch->loop_start[loop] + j];
    for (int32_t t = 0; t < b->patch->triangles.count; t++)
        for (int k = 0; k < 3; k++)
            if (b->patch->triangles.vertex[t][k] == vertex)
                check_way(b, loop, i, j, &(ss_place){t, {k == 0, k == 1, k == 2}, {0, 0}});
}

static void a_vertex_is_as_far_in_every_triangle_at_it(void **state) {
    (void)state;
    for (int32_t i = 0; i < FIXTURE_COUNT; i++) {
        border b = open_border(i);
        for (int32_t loop = 0; loop < b.patch->loop_count; loop++) {
            int32_t count = b.patch->loop_start[loop + 1] - b.patch->loop_start[loop];
            for (int32_t k = 0; k < count && k < 8; k++)
                for (int32_t j = 0; j < count && j < 8; j++)
                    check_ways(&b, loop, k, j);
        }
        close_border(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vertex_is_as_far_in_every_triangle_at_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
