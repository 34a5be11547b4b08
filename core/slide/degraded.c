/* What a frame of a patch is less by than it should be, in words: each kind is a count of its result. */
#include "slide.h"

#include <stddef.h>

typedef struct degradation {
    const char *member;
    size_t at; /* in the result */
    const char *one, *many, *text;
} degradation;

#define COUNT_OF(member, one, many, text)                                                                                      \
    { #member, offsetof(skinslide_patch_result, member), one, many, text }

static const degradation kinds[] = {
    COUNT_OF(clamped_vertices, "vertex", "vertices", "looked up outside every face, put on the nearest"),
    COUNT_OF(clamped_weights, "weight or envelope", "weights or envelopes", "outside 0..1, clamped"),
    COUNT_OF(damped_vertices, "vertex", "vertices", "brought back towards the flat faces, where the limit surface rings"),
    COUNT_OF(folded_faces, "face", "faces", "turned over in the embedding"),
    COUNT_OF(zero_length_edges, "edge", "edges", "of no length, taken as 1e-6 of the mean rest edge"),
    COUNT_OF(lost_textures, "texture", "textures", "lost by a failing device, each vertex walked for instead"),
};

static const degradation *find_kind(int32_t kind) {
    return kind >= 0 && (size_t)kind < sizeof kinds / sizeof *kinds ? &kinds[kind] : NULL;
}

static void warn(const degradation *own, const char *of, int32_t count, skinslide_error *warning) {
    ss_fail(warning, SKINSLIDE_OK, "%s%s%d %s %s", of, *of ? ": " : "", count, count == 1 ? own->one : own->many, own->text);
}

const char *skinslide_degradation(int32_t kind, int32_t count, skinslide_error *warning) {
    const degradation *own = find_kind(kind);
    if (own)
        warn(own, "", count, warning);
    return own ? own->member : NULL;
}

int32_t skinslide_workspace_degraded(const skinslide_workspace *workspace, int32_t patch, int32_t kind,
                                     skinslide_error *warning) {
    const degradation *own = find_kind(kind);
    if (!own || !workspace || !workspace->has_frame || patch < 0 || patch >= workspace->slider->part_count)
        return -1;
    int32_t count = *(const int32_t *)((const char *)&workspace->results[patch] + own->at);
    if (count > 0)
        warn(own, workspace->slider->parts[patch].patch->label, count, warning);
    return count;
}
