/* What the files that read painted textures, and those that draw maps, share. */
#ifndef SS_PAINT_H
#define SS_PAINT_H

#include "mesh.h"
#include "skinslide/paint.h"

/* UDIM tiles, numbered by rows of ten: 1001 to 10000. */
enum { SS_FIRST_TILE = 1001, SS_TILE_COLUMNS = 10, SS_TILE_ROWS = 900 };

/* Texels along each side of the largest OpenEXR file that is written; one that is read has no more than its square in all. */
enum { SS_LARGEST_IMAGE = 16384 };

/* ---- mirror.c ---- */

/* Takes the caller's options, and checks what skinslide_mirror and skinslide_mirror_nearest share; own holds the default. */
skinslide_status ss_take_mirror(const skinslide_mesh *mesh, const skinslide_mirror_options *options, const int32_t *faces,
                                int32_t face_count, skinslide_mirror_options *own, skinslide_error *error);
/* The axis in the plane across `axis` along which a mesh at rest is longest: sorted along it, the fewest vertices and faces
 * share a coordinate. A tolerance below 0 becomes the default. */
int ss_sort_along(const skinslide_mesh *mesh, int axis, double *tolerance);
/* For messages: x, y or z. */
static inline char ss_axis_name(int32_t axis) {
    return (char)('x' + axis);
}

/* ---- texture.c ---- */

/* A caller's layout as ours. */
typedef struct ss_taken_layout {
    skinslide_texture_layout layout;
    ss_taken_mesh mesh;
} ss_taken_layout;
/* Takes the caller's layout, makes *layout point to that, and checks it. */
skinslide_status ss_take_layout(const skinslide_texture_layout **layout, ss_taken_layout *own, skinslide_error *error);
/* Texture coordinates of a corner of a face must be finite. */
skinslide_status ss_check_st(const float st[2], int32_t face, skinslide_error *error);

/* ---- exrheader.c ---- */

#define SS_LARGEST_CHUNK ((uint64_t)1 << 30) /* bytes */

typedef struct ss_exr_window {
    int64_t x, y, width, height;
} ss_exr_window;

/* What the header of an OpenEXR file says of the channel that is read. */
typedef struct ss_exr_header {
    int part;
    int32_t channel;                      /* of the part */
    const char *part_name, *channel_name; /* the file's; the part's is "" if there is one part */
    ss_exr_window data, display;
    bool tiled;
    int32_t chunk_width, chunk_height; /* of tiles, or of chunks of scanlines */
    skinslide_wrap wrap_s, wrap_t;
} ss_exr_header;

/* Reads and checks the header of an open file, OpenEXR's exr_const_context_t. wanted is a channel, as for skinslide_exr_decode,
 * or "". Takes no memory. */
skinslide_status ss_exr_read_header(const void *file, const char *wanted, int64_t file_size, ss_exr_header *out,
                                    skinslide_error *error);

/* Fails with a status where a count that a file claims is too large: "has " 5000000000 "bytes". */
skinslide_status ss_check_most(const char *before, uint64_t count, const char *of, uint64_t most, skinslide_status status,
                               skinslide_error *error);

#endif
