/* Which grids outside a patch may hide some of it from the camera: those that reach into its box on the screen, and nearer than its
 * farthest vertex. Few do, and only they are drawn again as shadows. */
#include "canvas.h"

#include <math.h>

/* On the screen, x and y, and depth. */
typedef struct box {
    float low[3], high[3];
} box;

static const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* A vertex behind the camera may be anywhere. */
static void add_vertex(const ss_drawing *drawn, int32_t vertex, box *to) {
    const float *m = drawn->view.to_clip, *place = drawn->work.vertices[vertex].place;
    float clip[4];
    for (int i = 0; i < 4; i++)
        clip[i] = m[12 + i] + m[i] * place[0] + m[4 + i] * place[1] + m[8 + i] * place[2];
    for (int i = 0; i < 3; i++) {
        to->low[i] = fminf(to->low[i], clip[3] > 0 ? clip[i] / clip[3] : -INFINITY);
        to->high[i] = fmaxf(to->high[i], clip[3] > 0 ? clip[i] / clip[3] : INFINITY);
    }
}

static void add_grid(const ss_drawing *drawn, const ss_grid *grid, box *to) {
    for (int32_t v = grid->first_vertex; v < grid->first_vertex + ss_grid_size(drawn->mesh, grid); v++)
        add_vertex(drawn, v, to);
}

static bool may_hide(const box *own, const box *patch) {
    return own->low[0] <= patch->high[0] && own->high[0] >= patch->low[0] && own->low[1] <= patch->high[1] &&
           own->high[1] >= patch->low[1] && own->low[2] <= patch->high[2];
}

void ss_find_hiding(ss_drawing *drawn) {
    box patch = nothing;
    for (int32_t p = 0; p < drawn->mesh->grid_count; p++)
        if (drawn->outline->inside[drawn->mesh->grids[p].face])
            add_grid(drawn, &drawn->mesh->grids[p], &patch);
    for (int32_t p = 0; p < drawn->mesh->grid_count; p++) {
        const ss_grid *grid = &drawn->mesh->grids[p];
        if (!drawn->in_sight[p] || drawn->outline->inside[grid->face])
            continue;
        box own = nothing;
        add_grid(drawn, grid, &own);
        drawn->hides[p] = may_hide(&own, &patch);
    }
}
