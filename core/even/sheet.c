/* Prepares a patch at rest for the rule `even`: tangents to slide along, how edges stretch along them, and each face in its own
 * plane. */
#include "even.h"

#include <stdlib.h>
#include <string.h>

/* ---- Tangents ---- */

static bool on_free_loop(const ss_patch *patch, int32_t vertex) {
    return patch->vertex_loop[vertex] >= 0 && !patch->fixed[vertex];
}

static void set_vertex(ss_sheet *sheet, int32_t v) {
    const double *normal = sheet->ground.normal[v];
    if (on_free_loop(sheet->patch, v)) {
        ss_place own = ss_place_of_vertex(sheet->patch, NULL, v);
        memset(sheet->tangent[v], 0, sizeof sheet->tangent[v]);
        ss_border_way(&sheet->ground.pose, &own, sheet->tangent[v][0]);
    }
    bool has_way = ss_dot(normal, normal) > 0.5 && ss_dot(sheet->tangent[v][0], sheet->tangent[v][0]) > 0.5;
    sheet->held[v] = sheet->patch->fixed[v] || !has_way;
    sheet->slides[v] = !sheet->held[v];
}

/* ---- Edges ---- */

static void add_spring(ss_sheet *sheet, int32_t edge) {
    const int32_t *v = sheet->patch->edge_vertex[edge];
    ss_spring own = {.edge = edge, .end = {v[0], v[1]}};
    double way[3];
    if (sheet->held[v[0]] && sheet->held[v[1]])
        return;
    ss_subtract(sheet->ground.pose.point[v[1]], sheet->ground.pose.point[v[0]], way);
    double square = ss_dot(way, way), shortest = sheet->patch->shortest;
    own.square = square > shortest * shortest ? square : 0;
    for (int end = 0; end < 2; end++)
        for (int j = 0; j < 2 && own.square > 0; j++)
            own.slope[end][j] = (end ? 1 : -1) * ss_dot(way, sheet->tangent[v[end]][j]) / square;
    sheet->springs[sheet->spring_count++] = own;
    sheet->degree[v[0]]++, sheet->degree[v[1]]++;
}

/* ---- Faces ---- */

/* Axes of the plane of a face, the first along a side. For a face without area, and so without a normal, the second is 0. */
static void set_axes(const double normal[3], const double side[3], double axes[2][3]) {
    memcpy(axes[0], side, sizeof axes[0]);
    ss_add(-ss_dot(side, normal), normal, axes[0]);
    ss_normalise(axes[0]);
    ss_cross(normal, axes[0], axes[1]);
}

/* The first side of a face that has a length; 0 if none has. */
static void find_side(const double (*point)[3], const int32_t *v, int32_t count, double side[3]) {
    side[0] = side[1] = side[2] = 0;
    for (int32_t k = 0; k < count && ss_dot(side, side) == 0; k++)
        ss_subtract(point[v[(k + 1) % count]], point[v[k]], side);
}

static void set_face(ss_sheet *sheet, int32_t face) {
    const ss_faces *faces = &sheet->patch->faces;
    const double(*point)[3] = (const double(*)[3])sheet->ground.pose.point;
    int32_t begin = faces->face_start[face], end = faces->face_start[face + 1];
    const int32_t *v = faces->corner_vertex;
    double *area = sheet->normal[face], first[3], second[3], product[3], axes[2][3];
    area[0] = area[1] = area[2] = 0;
    for (int32_t c = begin + 1; c + 1 < end; c++) {
        ss_subtract(point[v[c]], point[v[begin]], first);
        ss_subtract(point[v[c + 1]], point[v[begin]], second);
        ss_cross(first, second, product);
        ss_add(1, product, area);
    }
    sheet->area[face] = ss_length(area);
    ss_normalise(area);
    find_side(point, v + begin, end - begin, first);
    set_axes(area, first, axes);
    for (int32_t c = begin; c < end; c++) {
        ss_subtract(point[v[c]], point[v[begin]], first);
        for (int i = 0; i < 2; i++)
            sheet->flat[c][i] = ss_dot(first, axes[i]);
    }
}

/* ---- Creation ---- */

static bool allocate(ss_sheet *sheet) {
    const ss_patch *patch = sheet->patch;
    ss_memory *memory = &sheet->memory;
    sheet->held = SS_NEW(memory, uint8_t, patch->vertex_count);
    sheet->slides = SS_NEW(memory, double, patch->vertex_count);
    sheet->degree = SS_NEW(memory, int32_t, patch->vertex_count);
    sheet->springs = SS_NEW(memory, ss_spring, patch->faces.edge_count);
    sheet->flat = ss_new(memory, patch->faces.corner_count, sizeof *sheet->flat);
    sheet->normal = ss_new(memory, patch->faces.face_count, sizeof *sheet->normal);
    sheet->area = SS_NEW(memory, double, patch->faces.face_count);
    sheet->turned = SS_NEW(memory, uint8_t, patch->faces.face_count);
    bool done = ss_ground_allocate(memory, patch, &sheet->ground);
    sheet->tangent = sheet->ground.tangent;
    return done;
}

static void fill(ss_sheet *sheet, const float *rest_points) {
    const ss_patch *patch = sheet->patch;
    ss_ground_set(&sheet->ground, rest_points);
    for (int32_t v = 0; v < patch->vertex_count; v++)
        set_vertex(sheet, v);
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        add_spring(sheet, e);
    for (int32_t f = 0; f < patch->faces.face_count; f++) {
        set_face(sheet, f);
        sheet->turned[f] =
            ss_is_turned(patch, f, (const double(*)[3])sheet->ground.pose.point, (const double(*)[3])sheet->ground.normal);
    }
}

skinslide_status ss_sheet_create(const ss_patch *patch, const float *rest_points, ss_sheet **out, skinslide_error *error) {
    ss_sheet *sheet = calloc(1, sizeof *sheet);
    if (!sheet)
        return ss_out_of_memory(error);
    sheet->patch = patch;
    skinslide_status status = allocate(sheet) ? SKINSLIDE_OK : ss_out_of_memory(error);
    if (!status) {
        fill(sheet, rest_points);
        ss_net net = {patch->vertex_count, patch->faces.edge_count, (const int32_t(*)[2])patch->edge_vertex, sheet->held};
        status = ss_block_system_create(&net, patch->label, &sheet->system, error);
    }
    if (status)
        ss_sheet_destroy(sheet);
    else
        *out = sheet;
    return status;
}

bool ss_sheet_multiply(ss_sheet *sheet) {
    sheet->between = ss_new(&sheet->memory, sheet->spring_count, sizeof *sheet->between);
    for (int32_t i = 0; i < sheet->spring_count && sheet->between; i++)
        ss_multiply_tangents(sheet, &sheet->springs[i], sheet->between[i]);
    return sheet->between != NULL;
}

void ss_sheet_destroy(ss_sheet *sheet) {
    if (!sheet)
        return;
    ss_system_destroy(sheet->system);
    ss_free(&sheet->memory);
    free(sheet);
}
