/* Splits vertices at which faces meet only in a point, such as the middle of a bow tie: faces there that follow each other
 * over shared edges are a fan, and each fan gets a patch vertex of its own. As these are one point of the mesh, they do not
 * slide. */
#include "mesh.h"

typedef struct fans {
    ss_memory memory;
    int32_t *fan;   /* [corner_count] the number of the corner's fan at its vertex; -1 before it is known */
    int32_t *count; /* [vertex_count] fans at the vertex */
    int32_t *first; /* [vertex_count] its first copy */
} fans;

/* From a corner to the ends of its fan, or once round. */
static void number_fan(const ss_faces *faces, int32_t corner, int32_t number, int32_t *fan) {
    int32_t c = corner;
    do {
        fan[c] = number;
        c = faces->corner_twin[ss_previous_corner(faces, c)];
    } while (c >= 0 && c != corner);
    if (c == corner)
        return;
    for (int32_t twin = faces->corner_twin[corner]; twin >= 0; twin = faces->corner_twin[c]) {
        c = ss_next_corner(faces, twin);
        fan[c] = number;
    }
}

/* Returns how many patch vertices there are to be. */
static int32_t number_fans(const ss_patch *patch, fans *own) {
    const ss_faces *faces = &patch->faces;
    int32_t copies = 0;
    for (int32_t c = 0; c < faces->corner_count; c++)
        own->fan[c] = -1;
    for (int32_t c = 0; c < faces->corner_count; c++)
        if (own->fan[c] < 0)
            number_fan(faces, c, own->count[faces->corner_vertex[c]]++, own->fan);
    for (int32_t v = 0; v < patch->vertex_count; copies += own->count[v++])
        own->first[v] = copies;
    return copies;
}

/* From the last vertex down, since a copy is never in front of its original. */
static void copy_vertices(ss_patch *patch, const fans *own, int32_t copies) {
    for (int32_t v = patch->vertex_count; v-- > 0;)
        for (int32_t k = own->count[v]; k-- > 0;) {
            patch->mesh_vertex[own->first[v] + k] = patch->mesh_vertex[v];
            patch->split[own->first[v] + k] = own->count[v] > 1;
        }
    for (int32_t c = 0; c < patch->faces.corner_count; c++)
        patch->faces.corner_vertex[c] = own->first[patch->faces.corner_vertex[c]] + own->fan[c];
    patch->vertex_count = copies;
}

bool ss_split_vertices(ss_patch *patch) {
    fans own = {0};
    own.fan = SS_NEW(&own.memory, int32_t, patch->faces.corner_count);
    own.count = SS_NEW(&own.memory, int32_t, patch->vertex_count);
    own.first = SS_NEW(&own.memory, int32_t, patch->vertex_count);
    bool good = !own.memory.failed;
    if (good) {
        int32_t copies = number_fans(patch, &own);
        bool any = copies > patch->vertex_count;
        copy_vertices(patch, &own, copies);
        good = !any || ss_number_edges(&patch->faces);
    }
    ss_free(&own.memory);
    return good;
}
