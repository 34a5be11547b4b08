/* Normals of a surface: at a vertex the mean of its triangles' normals, weighted by the sine of half the angle of each there;
 * between vertices a blend by the weights of a place. And tangents, and the triangles around a vertex as seen along its
 * normal. */
#include "surface.h"

#include <string.h>

bool ss_ground_allocate(ss_memory *memory, const ss_patch *patch, ss_ground *ground) {
    ground->normal = ss_new(memory, patch->vertex_count, sizeof *ground->normal);
    ground->tangent = ss_new(memory, patch->vertex_count, sizeof *ground->tangent);
    ground->wedges = SS_NEW(memory, ss_wedge, 3 * (int64_t)patch->triangles.count);
    ground->wedge_start = SS_NEW(memory, int32_t, (int64_t)patch->vertex_count + 1);
    return ss_posed_allocate(memory, patch, &ground->pose);
}

/* The first tangent is the axis least along the normal, projected. */
static void set_tangents(const double normal[3], double tangent[2][3]) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        axis = fabs(normal[k]) < fabs(normal[axis]) ? k : axis;
    for (int k = 0; k < 3; k++)
        tangent[0][k] = k == axis;
    ss_add(-normal[axis], normal, tangent[0]);
    ss_normalise(tangent[0]);
    ss_cross(normal, tangent[0], tangent[1]);
}

/* False if the wedge is seen from behind, or has no area. */
static bool see_wedge(const ss_ground *ground, int32_t triangle, int corner, ss_wedge *out) {
    const ss_posed *pose = &ground->pose;
    const int32_t *v = pose->patch->triangles.vertex[triangle];
    const double *here = pose->point[v[corner]], *up = ground->normal[v[corner]];
    double p[3], q[3], product[3], first[3], second[3];
    ss_subtract(pose->point[v[(corner + 1) % 3]], here, p);
    ss_subtract(pose->point[v[(corner + 2) % 3]], here, q);
    ss_cross(p, q, product);
    double share = 1 / ss_dot(product, up);
    ss_cross(q, up, first);
    ss_cross(up, p, second);
    for (int k = 0; k < 3; k++)
        first[k] *= share, second[k] *= share;
    for (int j = 0; j < 2; j++) {
        const double *tangent = ground->tangent[v[corner]][j];
        out->first[j] = ss_dot(first, tangent);
        out->second[j] = ss_dot(second, tangent);
        out->lean[j] = share * ss_dot(product, tangent);
    }
    out->corner = 4 * (uint32_t)triangle + (uint32_t)corner;
    return ss_has_area(&pose->facet[triangle]) && share > 0 && isfinite(out->first[0] + out->first[1]) &&
           isfinite(out->second[0] + out->second[1]) && isfinite(out->lean[0] + out->lean[1]);
}

static void see_wedges(ss_ground *ground) {
    const ss_triangles *triangles = &ground->pose.patch->triangles;
    int32_t count = 0;
    for (int32_t v = 0; v < ground->pose.patch->vertex_count; v++) {
        int32_t first = triangles->vertex_triangle[v], t = first;
        do {
            int corner = ss_triangle_corner(ground->pose.patch, t, v);
            count += see_wedge(ground, t, corner, &ground->wedges[count]);
            t = triangles->neighbour[t][(corner + 2) % 3];
        } while (t >= 0 && t != first);
        ground->wedge_start[v + 1] = count;
    }
}

void ss_ground_set(ss_ground *ground, const float *points) {
    ss_posed *pose = &ground->pose;
    const ss_triangles *triangles = &pose->patch->triangles;
    ss_posed_set(pose, points);
    memset(ground->normal, 0, (size_t)pose->patch->vertex_count * sizeof *ground->normal);
    for (int32_t t = 0; t < triangles->count; t++)
        for (int k = 0; k < 3 && ss_has_area(&pose->facet[t]); k++)
            ss_add(ss_half_angle(pose, t, k), pose->facet[t].normal, ground->normal[triangles->vertex[t][k]]);
    for (int32_t v = 0; v < pose->patch->vertex_count; v++) {
        ss_normalise(ground->normal[v]);
        set_tangents(ground->normal[v], ground->tangent[v]);
    }
    see_wedges(ground);
}
