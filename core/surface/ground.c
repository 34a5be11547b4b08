/* Normals of a surface: at a vertex the mean of its triangles' by the sine of half the angle that each has there, which plain
 * arithmetic gives, and between vertices blended by the weights of a place. */
#include "surface.h"

#include <string.h>

bool ss_ground_allocate(ss_memory *memory, const ss_patch *patch, ss_ground *ground) {
    ground->normal = ss_new(memory, patch->vertex_count, sizeof *ground->normal);
    return ss_posed_allocate(memory, patch, &ground->pose);
}

void ss_ground_set(ss_ground *ground, const float *points) {
    ss_posed *pose = &ground->pose;
    const ss_triangles *triangles = &pose->patch->triangles;
    ss_posed_set(pose, points);
    memset(ground->normal, 0, (size_t)pose->patch->vertex_count * sizeof *ground->normal);
    for (int32_t t = 0; t < triangles->count; t++)
        for (int k = 0; k < 3 && pose->facet[t].has_area; k++)
            ss_add(ss_half_angle(pose, t, k), pose->facet[t].normal, ground->normal[triangles->vertex[t][k]]);
    for (int32_t v = 0; v < pose->patch->vertex_count; v++)
        ss_normalise(ground->normal[v]);
}

void ss_ground_normal(const ss_ground *ground, const ss_place *place, double out[3]) {
    const int32_t *v = ground->pose.patch->triangles.vertex[place->triangle];
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < 3; k++)
        ss_add(place->weight[k], ground->normal[v[k]], out);
    ss_normalise(out);
}
