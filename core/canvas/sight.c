/* What is drawn of a figure: the triangles that face the camera and reach into the picture, and their vertices. The patch's
 * come first, then those that hide none of it, then those that may, which are drawn as shadows: they are nearer than the patch
 * in some cell of the picture in which both are. What is doubtful is kept, and the device decides. */
#include "canvas.h"

#include <math.h>
#include <string.h>

enum { CELLS = 128 }; /* across the picture, and up it */

/* In the order in which figures with ghosts draw them. */
typedef enum part { INSIDE, OUTSIDE, HIDING, UNSEEN } part;

/* A vertex on the screen: x, y and depth from -1 to 1 in the picture. */
typedef struct place {
    float at[3];
    bool ahead; /* in front of the camera; if not, `at` means nothing */
} place;

typedef struct box {
    float low[3], high[3];
    bool ahead, behind; /* all of it */
} box;

/* Scratch of one figure. */
typedef struct sight {
    ss_drawing *drawn;
    place *places;            /* [vertex_count] */
    uint8_t *parts;           /* [triangle_count] */
    int32_t *number;          /* [vertex_count] among those drawn, or -1 */
    float (*farthest)[CELLS]; /* [CELLS] depth of the patch in each cell */
    float pixel[2];           /* how wide and tall one is */
} sight;

/* ---- On the screen ---- */

static void find_place(const float *to_clip, const float *at, place *out) {
    float clip[4];
    for (int i = 0; i < 4; i++)
        clip[i] = to_clip[12 + i] + to_clip[i] * at[0] + to_clip[4 + i] * at[1] + to_clip[8 + i] * at[2];
    out->ahead = clip[3] > 0;
    for (int i = 0; i < 3; i++)
        out->at[i] = clip[i] / clip[3];
}

static void find_places(const sight *own) {
    const skinslide_tessellation *mesh = own->drawn->mesh;
    for (int32_t p = 0; p < mesh->grid_count; p++) {
        int32_t first = mesh->grids[p].first_vertex, end = first + ss_grid_size(mesh, &mesh->grids[p]);
        for (int32_t v = first; v < end && own->drawn->in_sight[p]; v++)
            find_place(own->drawn->view.to_clip, own->drawn->work.vertices[v].place, &own->places[v]);
    }
}

static box box_of(const sight *own, const uint32_t triangle[3]) {
    const place *a = &own->places[triangle[0]], *b = &own->places[triangle[1]], *c = &own->places[triangle[2]];
    box made = {.ahead = a->ahead && b->ahead && c->ahead, .behind = !a->ahead && !b->ahead && !c->ahead};
    for (int i = 0; i < 3; i++) {
        float low = a->at[i] < b->at[i] ? a->at[i] : b->at[i], high = a->at[i] < b->at[i] ? b->at[i] : a->at[i];
        made.low[i] = low < c->at[i] ? low : c->at[i], made.high[i] = high > c->at[i] ? high : c->at[i];
    }
    return made;
}

static bool reaches_into_picture(const box *triangle) {
    const float edge = 1 + 1e-4f;
    bool reaches = true;
    for (int i = 0; i < 3; i++)
        reaches = reaches && triangle->low[i] <= edge && triangle->high[i] >= -edge;
    return reaches;
}

/* Twice its area on the screen, below 0 where its vertices turn right. */
static float turned(const sight *own, const uint32_t triangle[3]) {
    const float *a = own->places[triangle[0]].at, *b = own->places[triangle[1]].at, *c = own->places[triangle[2]].at;
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether it is turned away from the camera, and still would be if each vertex moved by a 128th of a pixel: devices round by
 * half of that. */
static bool faces_away(const sight *own, const uint32_t triangle[3], const box *around) {
    float x = own->pixel[0] / 128, y = own->pixel[1] / 128, area = turned(own, triangle);
    float wide = around->high[0] - around->low[0] + x, tall = around->high[1] - around->low[1] + y;
    bool left = own->drawn->view.mirrored == (own->drawn->figure->left_handed != 0);
    return (left ? -area : area) > 4 * (wide * y + tall * x);
}

static bool is_seen(const sight *own, const uint32_t triangle[3], const box *around) {
    if (!around->ahead)
        return !around->behind;
    return reaches_into_picture(around) && (own->drawn->figure->double_sided || !faces_away(own, triangle, around));
}

/* ---- Cells ---- */

static int cell_of(float at) {
    float cell = (at + 1) * 0.5f * CELLS;
    return cell > 0 ? cell < CELLS ? (int)cell : CELLS - 1 : 0;
}

/* The cells in which a box is: columns and rows, first and last. */
static void cells_of(const box *around, int first[2], int last[2]) {
    for (int i = 0; i < 2; i++) {
        first[i] = around->ahead ? cell_of(around->low[i]) : 0;
        last[i] = around->ahead ? cell_of(around->high[i]) : CELLS - 1;
    }
}

static void add_to_cells(const sight *own, const box *around) {
    int first[2], last[2];
    float depth = around->ahead ? around->high[2] : INFINITY;
    cells_of(around, first, last);
    for (int y = first[1]; y <= last[1]; y++)
        for (int x = first[0]; x <= last[0]; x++)
            own->farthest[y][x] = own->farthest[y][x] > depth ? own->farthest[y][x] : depth;
}

static bool may_hide(const sight *own, const box *around) {
    int first[2], last[2];
    float depth = around->ahead ? around->low[2] : -INFINITY;
    bool may = false;
    cells_of(around, first, last);
    for (int y = first[1]; y <= last[1] && !may; y++)
        for (int x = first[0]; x <= last[0] && !may; x++)
            may = own->farthest[y][x] > depth;
    return may;
}

/* ---- Parts ---- */

/* Of the triangles of the patch, or of all others. Call it for the patch first. */
static void find_parts(const sight *own, bool inside) {
    const ss_drawing *drawn = own->drawn;
    for (int32_t p = 0, first = 0; p < drawn->mesh->grid_count; p++) {
        const ss_grid *grid = &drawn->mesh->grids[p];
        int32_t end = first + ss_grid_triangles(drawn->mesh, grid);
        for (int32_t t = first; t < end && drawn->in_sight[p] && drawn->outline->inside[grid->face] == inside; t++) {
            box around = box_of(own, drawn->mesh->triangles[t]);
            if (!is_seen(own, drawn->mesh->triangles[t], &around))
                continue;
            own->parts[t] = inside ? INSIDE : drawn->figure->ghosts && may_hide(own, &around) ? HIDING : OUTSIDE;
            if (inside && drawn->figure->ghosts)
                add_to_cells(own, &around);
        }
        first = end;
    }
}

/* Numbers the vertices of what is seen, and makes room for both. False if memory is short. */
static bool number_vertices(const sight *own) {
    ss_drawing *drawn = own->drawn;
    int32_t triangles = 0;
    for (int32_t t = 0; t < drawn->mesh->triangle_count; t++) {
        bool seen = own->parts[t] != UNSEEN;
        triangles += seen;
        for (int k = 0; seen && k < 3; k++)
            if (own->number[drawn->mesh->triangles[t][k]] < 0)
                own->number[drawn->mesh->triangles[t][k]] = drawn->vertex_count++;
    }
    drawn->vertices = SS_NEW(&drawn->work.memory, ss_vertex_attributes, drawn->vertex_count);
    drawn->triangles = ss_new(&drawn->work.memory, triangles, sizeof *drawn->triangles);
    return !drawn->work.memory.failed;
}

static void list_vertices(const sight *own) {
    const skinslide_tessellation *mesh = own->drawn->mesh;
    for (int32_t p = 0; p < mesh->grid_count; p++)
        for (int32_t v = 0, k = mesh->grids[p].first_vertex; v < ss_grid_size(mesh, &mesh->grids[p]); v++, k++) {
            const ss_posed_vertex *posed = &own->drawn->work.vertices[k];
            if (own->number[k] < 0)
                continue;
            ss_vertex_attributes *shown = &own->drawn->vertices[own->number[k]];
            memcpy(shown->coordinates, mesh->fixed[k].coordinates, sizeof shown->coordinates);
            memcpy(shown->place, posed->place, sizeof shown->place);
            memcpy(shown->normal, posed->normal, sizeof shown->normal);
            memcpy(shown->values, posed->values, sizeof shown->values);
            shown->inside = own->drawn->outline->inside[mesh->grids[p].face];
        }
}

static void list_part(const sight *own, part wanted) {
    ss_drawing *drawn = own->drawn;
    for (int32_t t = 0; t < drawn->mesh->triangle_count; t++)
        if (own->parts[t] == wanted) {
            for (int k = 0; k < 3; k++)
                drawn->triangles[drawn->triangle_count][k] = (uint32_t)own->number[drawn->mesh->triangles[t][k]];
            drawn->triangle_count++;
        }
}

static void list_parts(const sight *own) {
    list_part(own, INSIDE);
    own->drawn->inside_count = own->drawn->triangle_count;
    list_part(own, OUTSIDE);
    own->drawn->hiding_first = own->drawn->triangle_count;
    list_part(own, HIDING);
}

/* ---- All ---- */

static bool allocate(sight *own, ss_memory *scratch) {
    const skinslide_tessellation *mesh = own->drawn->mesh;
    own->places = SS_NEW(scratch, place, mesh->vertex_count);
    own->parts = SS_NEW(scratch, uint8_t, mesh->triangle_count);
    own->number = SS_NEW(scratch, int32_t, mesh->vertex_count);
    own->farthest = ss_new(scratch, CELLS, sizeof *own->farthest);
    return !scratch->failed;
}

bool ss_list_seen(ss_drawing *drawn) {
    ss_memory scratch = {0};
    sight own = {.drawn = drawn, .pixel = {2 / (float)drawn->viewport->width, 2 / (float)drawn->viewport->height}};
    bool allocated = allocate(&own, &scratch);
    if (allocated) {
        memset(own.parts, UNSEEN, (size_t)drawn->mesh->triangle_count);
        memset(own.number, -1, (size_t)drawn->mesh->vertex_count * sizeof *own.number);
        for (int i = 0; i < CELLS * CELLS; i++)
            own.farthest[i / CELLS][i % CELLS] = -INFINITY;
        find_places(&own);
        find_parts(&own, true);
        find_parts(&own, false);
        allocated = number_vertices(&own);
    }
    if (allocated) {
        list_vertices(&own);
        list_parts(&own);
    }
    ss_free(&scratch);
    return allocated;
}
