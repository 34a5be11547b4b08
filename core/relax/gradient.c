/* How points of the pose move as their places slide over rest. For a triangle that is a linear map; a vertex has the mean of
 * its triangles' maps, weighted by their area at rest, and places between vertices a blend by their weights. The blend is
 * continuous across edges, which the triangles' own maps are not: with those, vertices jump as they cross an edge. */
#include "relax.h"

#include <string.h>

/* p g' + q h', times twice the area at rest, which is returned too: p and q are sides on the pose, g and h dual to those at
 * rest. */
static void weigh_triangle(const ss_posed *pose, int32_t triangle, const double p[3], const double q[3], double *area,
                           double out[3][3]) {
    const ss_facet *rest = &pose->facet[triangle];
    double first[3], second[3], product[3];
    ss_sides(pose, triangle, first, second);
    ss_cross(first, second, product);
    *area = ss_length(product);
    for (int k = 0; k < 3; k++) {
        double g = rest->gram[0] * first[k] + rest->gram[1] * second[k];
        double h = rest->gram[1] * first[k] + rest->gram[2] * second[k];
        for (int j = 0; j < 3; j++)
            out[j][k] = *area * (p[j] * g + q[j] * h);
    }
}

void ss_find_gradients(ss_relaxer *relaxer) {
    const ss_sheet *sheet = relaxer->evener->sheet;
    const ss_triangles *triangles = &sheet->patch->triangles;
    int32_t vertices = sheet->patch->vertex_count;
    const double(*point)[3] = (const double(*)[3])relaxer->evener->pose.point;
    double *sum = relaxer->evener->part;
    memset(relaxer->gradient, 0, (size_t)vertices * sizeof *relaxer->gradient);
    memset(sum, 0, (size_t)vertices * sizeof *sum);
    for (int32_t t = 0; t < triangles->count; t++) {
        const int32_t *v = triangles->vertex[t];
        double first[3], second[3], own[3][3], area;
        if (!ss_has_area(&sheet->ground.pose.facet[t]))
            continue;
        ss_subtract(point[v[1]], point[v[0]], first);
        ss_subtract(point[v[2]], point[v[0]], second);
        weigh_triangle(&sheet->ground.pose, t, first, second, &area, own);
        for (int k = 0; k < 3; k++) {
            sum[v[k]] += area;
            for (int j = 0; j < 3; j++)
                ss_add(1, own[j], relaxer->gradient[v[k]][j]);
        }
    }
    for (int32_t v = 0; v < vertices; v++)
        for (int k = 0; k < 9 && sum[v] > 0; k++)
            relaxer->gradient[v][k / 3][k % 3] /= sum[v];
}

static void blend(const ss_relaxer *relaxer, const ss_place *place, double out[3][3]) {
    const int32_t *v = relaxer->evener->sheet->patch->triangles.vertex[place->triangle];
    for (int k = 0; k < 9; k++) {
        out[k / 3][k % 3] = 0;
        for (int j = 0; j < 3; j++)
            out[k / 3][k % 3] += place->weight[j] * relaxer->gradient[v[j]][k / 3][k % 3];
    }
}

/* Turns two tangents at a unit normal by the least rotation that takes this normal to another, of any length. False if the
 * normals are nearly opposite. */
static bool turn_both(const double from[3], const double to[3], const double tangent[2][3], ss_pair out[3]) {
    double length = ss_length(to), inverse = length > 0 ? 1 / length : 0, whole = 1 + inverse * ss_dot(from, to);
    ss_pair share = {ss_dot(to, tangent[0]), ss_dot(to, tangent[1])};
    share *= inverse / whole;
    for (int k = 0; k < 3; k++)
        out[k] = (ss_pair){tangent[0][k], tangent[1][k]} - (from[k] + inverse * to[k]) * share;
    return whole > SS_LEAST_TURN;
}

/* The vertex's tangents, turned to the normal at its place and taken into the pose there. */
static void set_axes(ss_relaxer *relaxer, int32_t vertex) {
    const ss_sheet *sheet = relaxer->evener->sheet;
    const ss_place *place = &relaxer->evener->place[vertex];
    double normal[3], gradient[3][3];
    ss_pair way[3], *axis = relaxer->axis[vertex];
    ss_ground_blend(&sheet->ground, place, normal);
    bool turns = turn_both(sheet->ground.normal[vertex], normal, (const double(*)[3])sheet->tangent[vertex], way);
    blend(relaxer, place, gradient);
    for (int k = 0; k < 3; k++)
        axis[k] = gradient[k][0] * way[0] + gradient[k][1] * way[1] + gradient[k][2] * way[2];
    if (!turns)
        memset(axis, 0, sizeof relaxer->axis[vertex]);
}

void ss_find_axes(ss_relaxer *relaxer) {
    for (int32_t v = 0; v < relaxer->evener->sheet->patch->vertex_count; v++)
        if (relaxer->evener->weight[v] > 0)
            set_axes(relaxer, v);
        else
            memset(relaxer->axis[v], 0, sizeof relaxer->axis[v]);
}
