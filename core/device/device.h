/* Faces of embeddings drawn as numbers by a device. */
#ifndef SKINSLIDE_DEVICE_H
#define SKINSLIDE_DEVICE_H

#include "egl.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is drawn of one patch. */
typedef struct ss_id_patch {
    const ss_faces *faces;
    int32_t query_count;
    int32_t side; /* texels; at least 1 */
} ss_id_patch;

enum { SS_CANDIDATES = 9 };

/* Faces of the texels around a query: that of its own texel or -1, then the other distinct ones, then -1. */
typedef int32_t ss_candidates[SS_CANDIDATES];

typedef struct ss_idbuffer ss_idbuffer;
/* patches are copied, their faces are kept. resolution 0: patches[].side, or the device's limit where that is less.
 * Fails with NO_DEVICE, DEVICE_FAILED, OUT_OF_MEMORY, BAD_ARGUMENT (resolution above the device's limit). */
skinslide_status ss_idbuffer_create(const ss_device_request *request, const ss_id_patch *patches, int32_t patch_count,
                                    int32_t resolution, ss_idbuffer **out, skinslide_error *error);
void ss_idbuffer_destroy(ss_idbuffer *buffer);
const skinslide_device_info *ss_idbuffer_device(const ss_idbuffer *buffer);
/* How it failed last; "" if it never did. */
const char *ss_idbuffer_reason(const ss_idbuffer *buffer);
int32_t ss_idbuffer_side(const ss_idbuffer *buffer, int32_t patch);
/* Starts to draw the faces of uv and to gather the candidates of the queries [query_count][2], without waiting for the device.
 * A failure shows in the next call. */
void ss_idbuffer_draw(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], const double (*queries)[2]);
/* The candidates of what was drawn last of the patch: [query_count]. False where the device failed. */
bool ss_idbuffer_candidates(ss_idbuffer *buffer, int32_t patch, ss_candidates *candidates);
/* Draws uv and reads the texels: [side][side], 1 + patch face, 0 where there is none. */
skinslide_status ss_idbuffer_read(ss_idbuffer *buffer, int32_t patch, const double (*uv)[2], uint32_t *texels,
                                  skinslide_error *error);
/* The resolution that suits a patch: see skinslide_workspace_options. */
int32_t ss_id_side(const ss_patch *patch, const double (*rest_uv)[2]);

#ifdef __cplusplus
}
#endif

#endif
