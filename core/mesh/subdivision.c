/* Checks the subdivision of a mesh, so that OpenSubdiv is given only what it accepts: its own complaints go to stderr and name
 * no element. */
#include "mesh.h"

#include <stdio.h>
#include <stdlib.h>

enum { MOST_CORNERS = 65535 }; /* of a face, and faces at a vertex: OpenSubdiv's limit */

/* ---- Faces ---- */

static skinslide_status check_faces(const skinslide_mesh *mesh, skinslide_error *error) {
    bool loop = mesh->subdivision->scheme == SKINSLIDE_SCHEME_LOOP;
    for (int32_t f = 0; f < mesh->face_count; f++) {
        int32_t n = mesh->face_counts[f];
        if (loop && n != 3)
            return ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has %d vertices; the loop scheme needs triangles", f, n);
        if (n < 3 || n > MOST_CORNERS)
            return ss_fail(error, SKINSLIDE_BAD_MESH, "face %d has %d vertices; a face that is subdivided has 3 to %d", f, n,
                           (int)MOST_CORNERS);
    }
    return SKINSLIDE_OK;
}

static skinslide_status check_valences(const skinslide_mesh *mesh, skinslide_error *error) {
    ss_memory scratch = {0};
    int32_t *valence = SS_NEW(&scratch, int32_t, mesh->vertex_count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    for (int32_t c = 0; c < mesh->index_count && !status; c++)
        if (++valence[mesh->face_indices[c]] > MOST_CORNERS)
            status = ss_fail(error, SKINSLIDE_BAD_MESH, "vertex %d has more than %d faces, which cannot be subdivided",
                             mesh->face_indices[c], (int)MOST_CORNERS);
    ss_free(&scratch);
    return status;
}

/* ---- Edges ---- */

static uint64_t edge_key(int32_t a, int32_t b) {
    return a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
}

static int ascending(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static void list_edges(const skinslide_mesh *mesh, uint64_t *edges) {
    for (int32_t f = 0, start = 0; f < mesh->face_count; start += mesh->face_counts[f++])
        for (int32_t k = 0, n = mesh->face_counts[f]; k < n; k++)
            edges[start + k] = edge_key(mesh->face_indices[start + k], mesh->face_indices[start + (k + 1) % n]);
    qsort(edges, (size_t)mesh->index_count, sizeof *edges, ascending);
}

/* Successive vertices of every crease must share an edge. */
static skinslide_status check_crease_edges(const skinslide_mesh *mesh, skinslide_error *error) {
    const skinslide_subdivision *own = mesh->subdivision;
    ss_memory scratch = {0};
    uint64_t *edges = SS_NEW(&scratch, uint64_t, mesh->index_count);
    skinslide_status status = scratch.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
    if (!status)
        list_edges(mesh, edges);
    for (int32_t i = 0, start = 0; i < own->crease_count && !status; start += own->crease_lengths[i++])
        for (int32_t k = start; k + 1 < start + own->crease_lengths[i] && !status; k++) {
            uint64_t key = edge_key(own->crease_indices[k], own->crease_indices[k + 1]);
            if (!bsearch(&key, edges, (size_t)mesh->index_count, sizeof *edges, ascending))
                status = ss_fail(error, SKINSLIDE_BAD_MESH, "crease %d: %d-%d is not an edge of the mesh", i,
                                 own->crease_indices[k], own->crease_indices[k + 1]);
        }
    ss_free(&scratch);
    return status;
}

/* ---- Creases, corners, holes ---- */

static skinslide_status refuse_array(const char *what, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no array of %s, or a negative count of them", what);
}

static skinslide_status check_indices(const int32_t *indices, int32_t count, int32_t end, const char *what,
                                      skinslide_error *error) {
    if (count < 0 || (count > 0 && !indices))
        return refuse_array(what, error);
    char label[32];
    snprintf(label, sizeof label, "%s: ", what);
    return ss_check_members(indices, count, end, label, SKINSLIDE_BAD_MESH, error);
}

static skinslide_status check_sharpness(const float *sharpnesses, int32_t count, const char *what, skinslide_error *error) {
    if (count < 0 || (count > 0 && !sharpnesses))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no array of %s sharpnesses, or a negative count of them", what);
    for (int32_t i = 0; i < count; i++)
        if (!(sharpnesses[i] >= 0))
            return ss_fail(error, SKINSLIDE_BAD_MESH, "%s sharpness %d is %g; it must be 0 or more", what, i, sharpnesses[i]);
    return SKINSLIDE_OK;
}

static skinslide_status check_crease_lengths(const skinslide_subdivision *own, skinslide_error *error) {
    int64_t sum = 0;
    if (own->crease_count < 0 || (own->crease_count > 0 && !own->crease_lengths))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no array of crease lengths, or a negative count of them");
    for (int32_t i = 0; i < own->crease_count; i++) {
        if (own->crease_lengths[i] < 2)
            return ss_fail(error, SKINSLIDE_BAD_MESH, "crease %d has %d vertices; a crease has 2 or more", i,
                           own->crease_lengths[i]);
        sum += own->crease_lengths[i];
    }
    if (sum != own->crease_index_count)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "crease lengths add up to %lld, but there are %d crease indices",
                       (long long)sum, own->crease_index_count);
    if (own->crease_sharpness_count != own->crease_count && own->crease_sharpness_count != sum - own->crease_count)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "%d crease sharpnesses fit neither %d creases nor their %lld edges",
                       own->crease_sharpness_count, own->crease_count, (long long)sum - own->crease_count);
    return SKINSLIDE_OK;
}

static skinslide_status check_creases(const skinslide_mesh *mesh, skinslide_error *error) {
    const skinslide_subdivision *own = mesh->subdivision;
    skinslide_status status = check_crease_lengths(own, error);
    if (!status)
        status = check_indices(own->crease_indices, own->crease_index_count, mesh->vertex_count, "crease indices", error);
    if (!status)
        status = check_sharpness(own->crease_sharpnesses, own->crease_sharpness_count, "crease", error);
    return status || own->crease_count == 0 ? status : check_crease_edges(mesh, error);
}

bool ss_is_subdivided(const skinslide_mesh *mesh) {
    return mesh->subdivision && mesh->subdivision->scheme != SKINSLIDE_SCHEME_NONE;
}

skinslide_status ss_check_subdivision(const skinslide_mesh *mesh, skinslide_error *error) {
    const skinslide_subdivision *own = mesh->subdivision;
    if ((unsigned)own->scheme > SKINSLIDE_SCHEME_BILINEAR || (unsigned)own->boundary_rule > SKINSLIDE_BOUNDARY_RULE_NONE ||
        (unsigned)own->triangle_rule > SKINSLIDE_TRIANGLE_RULE_SMOOTH)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no such subdivision scheme, boundary rule or triangle rule");
    skinslide_status status = check_faces(mesh, error);
    if (!status)
        status = check_valences(mesh, error);
    if (!status)
        status = check_creases(mesh, error);
    if (!status)
        status = check_indices(own->corner_indices, own->corner_count, mesh->vertex_count, "corner indices", error);
    if (!status)
        status = check_sharpness(own->corner_sharpnesses, own->corner_count, "corner", error);
    return status ? status : check_indices(own->hole_indices, own->hole_count, mesh->face_count, "hole indices", error);
}
