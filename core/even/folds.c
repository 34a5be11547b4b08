/* Counts the faces that sliding turns over: those whose area vector, between the places of their corners on the rest surface,
 * points against the normals there. A face that does so at rest does not count. */
#include "even.h"

#include <string.h>

bool ss_is_turned(const ss_patch *patch, int32_t face, const double (*at)[3], const double (*normal)[3]) {
    const ss_faces *faces = &patch->faces;
    const int32_t *v = faces->corner_vertex + faces->face_start[face];
    int32_t count = ss_fan_size(faces, face) + 2;
    double sum[3] = {0, 0, 0}, area = 0;
    for (int32_t k = 0; k < count; k++)
        ss_add(1, normal[v[k]], sum);
    for (int32_t k = 1; k + 1 < count; k++) {
        double first[3], second[3], product[3];
        ss_subtract(at[v[k]], at[v[0]], first);
        ss_subtract(at[v[k + 1]], at[v[0]], second);
        ss_cross(first, second, product);
        area += ss_dot(product, sum);
    }
    return !(area > 0);
}

int32_t ss_count_turned_over(const ss_sheet *sheet, const ss_place *places, double (*at)[3], double (*normal)[3]) {
    const ss_patch *patch = sheet->patch;
    const ss_ground *ground = &sheet->ground;
    int32_t turned = 0;
    memcpy(at, ground->pose.point, (size_t)patch->vertex_count * sizeof *at);
    memcpy(normal, ground->normal, (size_t)patch->vertex_count * sizeof *normal);
    for (int32_t i = 0; i < patch->free_count; i++) {
        if (places[i].triangle == SS_STAYS)
            continue;
        ss_place_point(&ground->pose, &places[i], at[patch->free_vertex[i]]);
        ss_ground_normal(ground, &places[i], normal[patch->free_vertex[i]]);
    }
    for (int32_t f = 0; f < patch->faces.face_count; f++)
        turned += !sheet->turned[f] && ss_is_turned(patch, f, (const double(*)[3])at, (const double(*)[3])normal);
    return turned;
}
