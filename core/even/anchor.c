/* What weights below 1 come to: springs that hold vertices at their own place, so stiff that a region of weight w all over slides
 * about w as far as it would without. A region is free vertices that edges join. Its springs are
 *
 *     2 (1 / w - 1) sum of k / L^2,     L = sqrt(area / pi)
 *
 * over the edges at the vertex: what moves over a distance L resists as much, however fine the mesh. */
#include "even.h"

#define PI 3.14159265358979323846

/* The vertex that stands for the region of one. */
static int32_t find(int32_t *region, int32_t v) {
    while (region[v] != v)
        v = region[v] = region[region[v]];
    return v;
}

/* The lower of two stands for both. */
static void join_regions(const ss_evener *evener, int32_t *region) {
    const ss_sheet *sheet = evener->sheet;
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        region[v] = v;
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const int32_t *v = sheet->springs[i].end;
        if (evener->weight[v[0]] == 0 || evener->weight[v[1]] == 0)
            continue;
        int32_t a = find(region, v[0]), b = find(region, v[1]);
        region[a > b ? a : b] = a > b ? b : a;
    }
}

/* Of each region, at the vertex that stands for it. The free corners of a triangle are of one. */
static void add_areas(const ss_evener *evener, int32_t *region, double *area) {
    const ss_triangles *triangles = &evener->sheet->patch->triangles;
    for (int32_t t = 0; t < triangles->count; t++) {
        const ss_facet *facet = &evener->sheet->ground.pose.facet[t];
        const int32_t *v = triangles->vertex[t];
        double product[3];
        ss_cross(facet->first, facet->second, product);
        for (int k = 0; k < 3; k++)
            if (evener->weight[v[k]] > 0) {
                area[find(region, v[k])] += 0.5 * ss_length(product);
                break;
            }
    }
}

static void add_edges(const ss_evener *evener, double *sum) {
    for (int32_t i = 0; i < evener->sheet->spring_count; i++)
        for (int end = 0; end < 2 && evener->sheet->springs[i].square > 0; end++)
            sum[evener->sheet->springs[i].end[end]] += evener->paint[evener->sheet->springs[i].edge];
}

void ss_find_anchors(const ss_evener *evener, int32_t *region, double *area, double *anchor) {
    int32_t count = evener->sheet->patch->vertex_count;
    for (int32_t v = 0; v < count; v++)
        area[v] = anchor[v] = 0;
    join_regions(evener, region);
    add_areas(evener, region, area);
    add_edges(evener, anchor);
    for (int32_t v = 0; v < count; v++) {
        double weight = evener->weight[v], square = area[find(region, v)] / PI;
        anchor[v] *= weight > 0 && square > 0 ? 2 * (1 / weight - 1) / square : 0;
    }
}
