/* What is wrong with an edge. On a surface it has at most two faces, which go along it in opposite directions. Where two go the
 * same way, they are the same face twice, or one of them must be turned over, or no choice of turning helps, as on a Moebius
 * strip. */
#include "mesh.h"

/* Whether the faces of two corners, whose sides are the same edge, go round the same vertices. */
static bool same_face(const ss_faces *faces, int32_t first, int32_t second) {
    int32_t count = ss_fan_size(faces, faces->corner_face[first]) + 2;
    bool alike = faces->corner_vertex[first] == faces->corner_vertex[second];
    if (ss_fan_size(faces, faces->corner_face[second]) + 2 != count)
        return false;
    if (!alike)
        second = ss_next_corner(faces, second);
    for (int32_t k = 0; k < count; k++) {
        if (faces->corner_vertex[first] != faces->corner_vertex[second])
            return false;
        first = ss_next_corner(faces, first);
        second = alike ? ss_next_corner(faces, second) : ss_previous_corner(faces, second);
    }
    return true;
}

/* Faces joined over edges that two of them share, and whether each must be turned over to be wound like the first of its
 * piece. */
typedef struct joined {
    int32_t *parent;    /* [face_count] itself for the first of a piece */
    uint8_t *turned;    /* [face_count] whether it is wound against its parent */
    uint8_t *one_sided; /* [face_count] of the first of a piece: no choice of turning will do */
} joined;

/* The first face of a face's piece; *turned: whether the face must be turned over. Compresses the path. */
static int32_t root_of(joined *j, int32_t face, uint8_t *turned) {
    int32_t root = face;
    uint8_t all = 0;
    for (; j->parent[root] != root; root = j->parent[root])
        all ^= j->turned[root];
    *turned = all;
    while (j->parent[face] != root) {
        int32_t next = j->parent[face];
        uint8_t own = j->turned[face];
        j->parent[face] = root, j->turned[face] = all;
        face = next, all ^= own;
    }
    return root;
}

static void join(joined *j, const ss_faces *faces, int32_t first, int32_t second) {
    uint8_t turned[2], against = faces->corner_vertex[first] == faces->corner_vertex[second];
    int32_t a = root_of(j, faces->corner_face[first], &turned[0]), b = root_of(j, faces->corner_face[second], &turned[1]);
    against ^= turned[0] ^ turned[1];
    if (a == b) {
        j->one_sided[a] |= against;
        return;
    }
    j->parent[b] = a, j->turned[b] = against;
    j->one_sided[a] |= j->one_sided[b];
}

/* Joins the faces of every edge that has two. corners is scratch [2][edge_count], count [edge_count]. */
static void join_all(joined *j, const ss_faces *faces, int32_t (*corners)[2], int32_t *count) {
    for (int32_t f = 0; f < faces->face_count; f++)
        j->parent[f] = f;
    for (int32_t c = 0; c < faces->corner_count; c++) {
        int32_t edge = faces->corner_edge[c];
        if (count[edge] < 2)
            corners[edge][count[edge]] = c;
        count[edge]++;
    }
    for (int32_t e = 0; e < faces->edge_count; e++)
        if (count[e] == 2)
            join(j, faces, corners[e][0], corners[e][1]);
}

/* Whether the piece of a face has one side only; false in *known where memory is short. */
static bool is_one_sided(ss_faces *faces, int32_t face, bool *known) {
    ss_memory scratch = {0};
    *known = ss_number_edges(faces);
    joined j = {SS_NEW(&scratch, int32_t, faces->face_count), SS_NEW(&scratch, uint8_t, faces->face_count),
                SS_NEW(&scratch, uint8_t, faces->face_count)};
    int32_t(*corners)[2] = ss_new(&scratch, faces->edge_count, sizeof *corners);
    int32_t *count = SS_NEW(&scratch, int32_t, faces->edge_count);
    *known = *known && !scratch.failed;
    bool one_sided = false;
    if (*known) {
        uint8_t turned;
        join_all(&j, faces, corners, count);
        one_sided = j.one_sided[root_of(&j, face, &turned)];
    }
    ss_free(&scratch);
    return one_sided;
}

static skinslide_status refuse_winding(ss_faces *faces, const ss_side *sides, const int32_t *mesh_face, const char *label,
                                       skinslide_error *error) {
    int32_t first = faces->corner_face[sides[0].corner], second = faces->corner_face[sides[1].corner];
    bool known, one_sided = is_one_sided(faces, first, &known);
    if (!known)
        return ss_out_of_memory(error);
    if (one_sided)
        return ss_fail(error, SKINSLIDE_BAD_PATCH,
                       "%s: it has one side only, like a Moebius strip: faces cannot be wound alike at edge %d-%d", label,
                       sides->low, sides->high);
    return ss_fail(error, SKINSLIDE_BAD_PATCH, "%s: faces %d and %d are wound against each other at edge %d-%d", label,
                   mesh_face[first], mesh_face[second], sides->low, sides->high);
}

skinslide_status ss_refuse_edge(ss_faces *faces, const ss_side *sides, int32_t count, const int32_t *mesh_face,
                                const char *label, skinslide_error *error) {
    enum { COMPARED = 4 }; /* enough to tell two faces, each of them twice */
    for (int32_t i = 0; i < count && i < COMPARED; i++)
        for (int32_t k = 0; k < i; k++)
            if (same_face(faces, sides[k].corner, sides[i].corner))
                return ss_fail(error, SKINSLIDE_BAD_PATCH, "%s: faces %d and %d have the same vertices", label,
                               mesh_face[faces->corner_face[sides[k].corner]], mesh_face[faces->corner_face[sides[i].corner]]);
    if (count > 2)
        return ss_fail(error, SKINSLIDE_BAD_PATCH, "%s: edge %d-%d has %d faces", label, sides->low, sides->high, count);
    return refuse_winding(faces, sides, mesh_face, label, error);
}
