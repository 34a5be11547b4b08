/* How the triangles of a patch lie in a pose, or in a plane. */
#include "surface.h"

bool ss_posed_allocate(ss_memory *memory, const ss_patch *patch, ss_posed *pose) {
    pose->patch = patch;
    pose->point = ss_new(memory, patch->vertex_count, sizeof *pose->point);
    pose->facet = SS_NEW(memory, ss_facet, patch->triangles.count);
    return !memory->failed;
}

void ss_posed_lay_out(ss_posed *pose, const ss_patch *patch, ss_room *room) {
    pose->patch = patch;
    pose->point = ss_take_room(room, patch->vertex_count, sizeof *pose->point);
    pose->facet = SS_TAKE(room, ss_facet, patch->triangles.count);
}

static void measure_facet(const ss_posed *pose, int32_t triangle, ss_facet *facet) {
    double first[3], second[3];
    ss_sides(pose, triangle, first, second);
    ss_cross(first, second, facet->normal);
    double square = ss_dot(facet->normal, facet->normal);
    bool has_area = square > 0 && isfinite(1 / square);
    facet->gram[0] = has_area ? ss_dot(second, second) / square : 0;
    facet->gram[1] = has_area ? -ss_dot(first, second) / square : 0;
    facet->gram[2] = has_area ? ss_dot(first, first) / square : 0;
    ss_normalise(facet->normal);
}

static void set_facets(ss_posed *pose) {
    for (int32_t t = 0; t < pose->patch->triangles.count; t++)
        measure_facet(pose, t, &pose->facet[t]);
}

void ss_posed_set(ss_posed *pose, const float *points) {
    ss_take_points(pose->patch, points, pose->point);
    set_facets(pose);
}

void ss_posed_set_plane(ss_posed *pose, const double (*uv)[2]) {
    for (int32_t v = 0; v < pose->patch->vertex_count; v++)
        pose->point[v][0] = uv[v][0], pose->point[v][1] = uv[v][1], pose->point[v][2] = 0;
    set_facets(pose);
}

double ss_half_angle(const ss_posed *pose, int32_t triangle, int corner) {
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    double a[3], b[3];
    ss_subtract(pose->point[v[(corner + 1) % 3]], pose->point[v[corner]], a);
    ss_subtract(pose->point[v[(corner + 2) % 3]], pose->point[v[corner]], b);
    ss_normalise(a);
    ss_normalise(b);
    return sqrt(fmax(0, 0.5 - 0.5 * ss_dot(a, b)));
}
