/* What a slider holds and what a workspace did last: copies of it, patch by patch. */
#include "slide.h"

#include <string.h>

/* The part of a patch number, or NULL, which is BAD_ARGUMENT. */
static const ss_part *find_part(const skinslide_slider *slider, int32_t patch, const void *out, skinslide_error *error) {
    if (slider && out && patch >= 0 && patch < slider->part_count)
        return &slider->parts[patch];
    if (!slider || !out)
        ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no slider or workspace, or no place for the answer");
    else
        ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "there is no patch %d: the slider has %d", patch, slider->part_count);
    return NULL;
}

int32_t skinslide_slider_patch_count(const skinslide_slider *slider) {
    return slider ? slider->part_count : 0;
}

skinslide_status skinslide_slider_patch_info(const skinslide_slider *slider, int32_t patch, skinslide_patch_info *info,
                                             skinslide_error *error) {
    const ss_part *part = find_part(slider, patch, info, error);
    if (!part)
        return SKINSLIDE_BAD_ARGUMENT;
    skinslide_status status = ss_check_size(info, "skinslide_patch_info", error);
    if (status)
        return status;
    const ss_patch *own = part->patch;
    const skinslide_patch_info answer = {
        .size = sizeof answer,
        .name = own->setup->name,
        .setup = own->setup_index,
        .piece = own->piece,
        .piece_count = own->piece_count,
        .vertex_count = own->vertex_count,
        .edge_count = own->faces.edge_count,
        .face_count = own->faces.face_count,
        .free_count = own->free_count,
        .hole_count = own->loop_count > 0 ? own->loop_count - 1 : 0,
        .zero_length_edges = own->zero_length_edges,
        .collapsed_faces = part->rest_layout.collapsed,
        .folded_faces = part->rest_layout.folded,
        .held_count = own->held_count,
    };
    ss_give(&answer, sizeof answer, info);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_slider_patch_vertices(const skinslide_slider *slider, int32_t patch, int32_t *vertices,
                                                 skinslide_error *error) {
    const ss_part *part = find_part(slider, patch, vertices, error);
    if (!part)
        return SKINSLIDE_BAD_ARGUMENT;
    memcpy(vertices, part->patch->mesh_vertex, (size_t)part->patch->vertex_count * sizeof *vertices);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_slider_patch_faces(const skinslide_slider *slider, int32_t patch, int32_t *faces,
                                              skinslide_error *error) {
    const ss_part *part = find_part(slider, patch, faces, error);
    if (!part)
        return SKINSLIDE_BAD_ARGUMENT;
    memcpy(faces, part->patch->mesh_face, (size_t)part->patch->faces.face_count * sizeof *faces);
    return SKINSLIDE_OK;
}

/* How many of a patch's vertices that are fixed, or not, other points meet. */
static skinslide_status count_met(const ss_patch *patch, const float *points, const float *others, int32_t other_count,
                                  double tolerance, int32_t counts[2], skinslide_error *error) {
    ss_memory scratch = {0};
    float *own = SS_NEW(&scratch, float, 3 * (int64_t)patch->vertex_count);
    uint8_t *met = SS_NEW(&scratch, uint8_t, patch->vertex_count);
    for (int32_t v = 0; v < patch->vertex_count && !scratch.failed; v++)
        memcpy(own + 3 * (int64_t)v, points + 3 * (int64_t)patch->mesh_vertex[v], sizeof(float[3]));
    bool done = !scratch.failed && ss_find_met(own, patch->vertex_count, others, other_count, tolerance, met);
    for (int32_t v = 0; v < patch->vertex_count && done; v++)
        counts[patch->fixed[v]] += met[v];
    ss_free(&scratch);
    return done ? SKINSLIDE_OK : ss_out_of_memory(error);
}

skinslide_status skinslide_slider_neighbours(const skinslide_slider *slider, int32_t patch, const float *points,
                                             const float *others, int32_t other_count, double tolerance,
                                             skinslide_neighbours *found, skinslide_error *error) {
    const ss_part *part = find_part(slider, patch, found, error);
    if (!part)
        return SKINSLIDE_BAD_ARGUMENT;
    if (other_count < 0 || !(tolerance >= 0) || part->patch->vertex_count > INT32_MAX - other_count)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "tolerance %g, and %d points of the other mesh", tolerance, other_count);
    skinslide_status status = ss_check_size(found, "skinslide_neighbours", error);
    if (!status)
        status = ss_check_reads(slider, points, "points", error);
    if (!status)
        status = ss_check_points(others, other_count, "points of the other mesh", error);
    int32_t counts[2] = {0, 0};
    if (!status)
        status = count_met(part->patch, points, others, other_count, tolerance, counts, error);
    const skinslide_neighbours answer = {.size = sizeof answer, .held = counts[1], .loose = counts[0]};
    if (!status)
        ss_give(&answer, sizeof answer, found);
    return status;
}

/* The same, of a rule that lays patches out in the plane: else UNSUPPORTED. */
static skinslide_status find_plane(const skinslide_slider *slider, int32_t patch, const void *out, const ss_part **part,
                                   skinslide_error *error) {
    *part = find_part(slider, patch, out, error);
    if (!*part)
        return SKINSLIDE_BAD_ARGUMENT;
    if (!(*part)->rest->uv)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: its rule has no embedding", (*part)->patch->label);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_slider_embedding(const skinslide_slider *slider, int32_t patch, double *uv, skinslide_error *error) {
    const ss_part *part;
    skinslide_status status = find_plane(slider, patch, uv, &part, error);
    if (status)
        return status;
    memcpy(uv, part->rest->uv, (size_t)part->patch->vertex_count * sizeof *part->rest->uv);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_frame(const skinslide_workspace *workspace, skinslide_error *error) {
    if (workspace->has_frame)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the workspace has slid no frame yet");
}

skinslide_status skinslide_workspace_embedding(const skinslide_workspace *workspace, int32_t patch, double *uv,
                                               skinslide_error *error) {
    const ss_part *part;
    skinslide_status status = find_plane(workspace ? workspace->slider : NULL, patch, uv, &part, error);
    if (status)
        return status;
    if ((status = ss_check_frame(workspace, error)))
        return status;
    memcpy(uv, workspace->patches[patch].slide->flat.uv, (size_t)part->patch->vertex_count * sizeof *part->rest->uv);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_workspace_id_buffer(skinslide_workspace *workspace, int32_t patch, int32_t *side, uint32_t *texels,
                                               skinslide_error *error) {
    const ss_part *part;
    skinslide_status status = find_plane(workspace ? workspace->slider : NULL, patch, side, &part, error);
    if (status)
        return status;
    if (!workspace->idbuffer)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "the workspace's lookup is exact: it draws no ID buffer");
    if ((status = ss_check_frame(workspace, error)))
        return status;
    const double(*uv)[2] = workspace->patches[patch].slide->flat.uv;
    if (texels)
        status = ss_idbuffer_read(workspace->idbuffer, patch, uv, texels, error);
    if (!status)
        *side = ss_idbuffer_side(workspace->idbuffer, patch);
    return status;
}
