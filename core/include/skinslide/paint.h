/* skinslide/paint.h: what artists paint patches with: OpenEXR files, textures, curves, the other side of a symmetric mesh, and
 * the faces that ever stretch.
 *
 * Conventions are those of skinslide.h. */
#ifndef SKINSLIDE_PAINT_H
#define SKINSLIDE_PAINT_H

#include "skinslide.h"

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
extern "C" {
#endif
#endif

/* ---- Images: OpenEXR files as bytes ------------------------------------------------------------------------------------- */

/* What a texture holds beyond its border, as the file's attribute wrapmodes says. */
typedef enum skinslide_wrap {
    SKINSLIDE_WRAP_CLAMP,    /* the texels of the border; also where the file says nothing, or something else */
    SKINSLIDE_WRAP_PERIODIC, /* the image again */
    SKINSLIDE_WRAP_MIRROR,   /* the image turned over, then the image again */
    SKINSLIDE_WRAP_BLACK     /* 0 */
} skinslide_wrap;

/* One channel of an image. Start from SKINSLIDE_IMAGE_DEFAULT. */
typedef struct skinslide_image {
    size_t size;           /* sizeof(skinslide_image) */
    int32_t width, height; /* of the file's display window */
    skinslide_wrap wrap_s; /* along width */
    skinslide_wrap wrap_t; /* along height */
    const float *pixels;   /* [height][width] from the top row on; 0 where the data window has none; may be not finite */
    const char *channel;   /* its name in the file, with the part's name and a dot in front where there are several parts */
} skinslide_image;

#define SKINSLIDE_IMAGE_DEFAULT                                                                                                \
    { sizeof(skinslide_image), 0, 0, SKINSLIDE_WRAP_CLAMP, SKINSLIDE_WRAP_CLAMP, 0, 0 }

/* Reads one channel of an OpenEXR file: scanlines or tiles (the largest level), half or float, of any part that is not deep,
 * compressed as NONE, RLE, ZIPS, ZIP, PIZ or PXR24.
 *   bytes    in  [size] the whole file
 *   channel  in  the name of a channel, in the first part that has it; or PART.CHANNEL; NULL or "": of the first part R, else
 *                Y, else the first in the file's order that is not A; LAYER.R, LAYER.Y, LAYER.A where all are of one layer
 *   out      out, the caller's to destroy
 * Fails with BAD_IMAGE (not OpenEXR, truncated, corrupt, empty, deep, no such channel: names those there are), UNSUPPORTED (a
 * channel of whole numbers or of fewer texels than the image, another compression, more than 16384 * 16384 texels,
 * chunks of more than 1 GiB or more than 4194304 of them), OUT_OF_MEMORY. Nothing is allocated for texels before the header is
 * known to fit the file. */
SKINSLIDE_API skinslide_status skinslide_exr_decode(const uint8_t *bytes, int64_t size, const char *channel,
                                                    skinslide_image **out, skinslide_error *error);

/* The same for an open file; no more of it is read, or in memory at a time, than is needed.
 *   descriptor  in  that of the file, which is read by pread(): its file offset stays
 *   offset      in  where the OpenEXR file begins in it: above 0 in a package
 *   size        in  bytes of the OpenEXR file; where the file has fewer by now, it counts as truncated */
SKINSLIDE_API skinslide_status skinslide_exr_read(int32_t descriptor, int64_t offset, int64_t size, const char *channel,
                                                  skinslide_image **out, skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_image_destroy(skinslide_image *image);

/* A channel to write. Start from SKINSLIDE_CHANNEL_DEFAULT. */
typedef struct skinslide_channel {
    size_t size;         /* sizeof(skinslide_channel) */
    const char *name;    /* such as "R" */
    const float *pixels; /* [height][width] from the top row on */
} skinslide_channel;

#define SKINSLIDE_CHANNEL_DEFAULT                                                                                              \
    { sizeof(skinslide_channel), 0, 0 }

/* Bytes that the library made; skinslide_bytes_destroy frees them. */
typedef struct skinslide_bytes {
    int64_t size; /* of data */
    const uint8_t *data;
} skinslide_bytes;

/* Makes an OpenEXR file of float channels: scanlines, compressed without loss (ZIP), the same bytes for the same pixels.
 *   channels   in  [channel_count], each name once
 *   wrap       in  the file's wrapmodes, in both directions
 *   out        out, the caller's to destroy
 * Fails with BAD_ARGUMENT (no channels, a name that cannot be one or comes twice, a size that is not 1 to 16384), BAD_IMAGE,
 * OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_exr_encode(const skinslide_channel *channels, int32_t channel_count, int32_t width,
                                                    int32_t height, skinslide_wrap wrap, skinslide_bytes **out,
                                                    skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_bytes_destroy(skinslide_bytes *bytes);

/* ---- Textures: images painted in a mesh's texture coordinates ----------------------------------------------------------- */

/* Where faces of a mesh lie in its texture. Start from SKINSLIDE_TEXTURE_LAYOUT_DEFAULT. */
typedef struct skinslide_texture_layout {
    size_t size;                /* sizeof(skinslide_texture_layout) */
    const skinslide_mesh *mesh; /* rest_points are not read */
    const int32_t *faces;       /* [face_count] mesh faces */
    int32_t face_count;
    const float *st; /* [index_count][2] texture coordinates of the mesh's corners, face by face */
} skinslide_texture_layout;

#define SKINSLIDE_TEXTURE_LAYOUT_DEFAULT                                                                                       \
    { sizeof(skinslide_texture_layout), 0, 0, 0, 0 }

/* The image of one tile of a UDIM, or the image that covers every texture coordinate by its wraps. Start from
 * SKINSLIDE_TEXTURE_TILE_DEFAULT. */
typedef struct skinslide_texture_tile {
    size_t size; /* sizeof(skinslide_texture_tile) */
    const skinslide_image *image;
    int32_t number; /* 1001 + u + 10 v, clamped at its border; 0 for the image that covers all, which is then the only one */
} skinslide_texture_tile;

#define SKINSLIDE_TEXTURE_TILE_DEFAULT                                                                                         \
    { sizeof(skinslide_texture_tile), 0, 0 }

/* Which tile of a UDIM each corner of some faces lies in. A corner on the border of two tiles lies in its face's.
 *   tiles  out [index_count] 1001 + u + 10 v; 0 at the corners of other faces
 * Fails with BAD_MESH, BAD_ARGUMENT, BAD_CONTROL (st not finite, or in no tile: s outside 0 to 10, t outside 0 to 900; names
 * the face), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_texture_tiles(const skinslide_texture_layout *layout, int32_t *tiles,
                                                       skinslide_error *error);

/* Samples a texture, bilinearly between the centres of texels, with (0, 0) at the image's lower left corner. A vertex takes the
 * mean over its corners in the faces.
 *   tiles   in  [tile_count]
 *   values  out [vertex_count]; 1 at vertices of none of the faces
 * Fails with BAD_MESH, BAD_ARGUMENT, BAD_CONTROL (st not finite, a tile that is missing, a texture that is not finite at a
 * corner: names the face and its st), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_texture_sample(const skinslide_texture_layout *layout,
                                                        const skinslide_texture_tile *tiles, int32_t tile_count, float *values,
                                                        skinslide_error *error);

/* ---- What painting needs of geometry ------------------------------------------------------------------------------------ */

/* Curves as UsdGeomBasisCurves has them; tokens linear for type linear, else the basis. */
typedef enum skinslide_curve_basis {
    SKINSLIDE_CURVE_BASIS_LINEAR,
    SKINSLIDE_CURVE_BASIS_BEZIER,
    SKINSLIDE_CURVE_BASIS_BSPLINE,
    SKINSLIDE_CURVE_BASIS_CATMULL_ROM
} skinslide_curve_basis;

typedef enum skinslide_curve_wrap {
    SKINSLIDE_CURVE_WRAP_NONPERIODIC,
    SKINSLIDE_CURVE_WRAP_PERIODIC,
    SKINSLIDE_CURVE_WRAP_PINNED /* B-splines and Catmull-Rom curves reach their first and last points */
} skinslide_curve_wrap;

/* Curves of a prim. Start from SKINSLIDE_CURVES_DEFAULT. */
typedef struct skinslide_curves {
    size_t size; /* sizeof(skinslide_curves) */
    int32_t curve_count;
    const int32_t *vertex_counts; /* [curve_count] control points of each */
    int32_t point_count;          /* the sum of vertex_counts */
    const float *points;          /* [point_count][3] */
    const double *to_mesh;        /* [4][4] takes points, as rows, to the mesh's object space; NULL: they are in it */
    skinslide_curve_basis basis;
    skinslide_curve_wrap wrap;
} skinslide_curves;

#define SKINSLIDE_CURVES_DEFAULT                                                                                               \
    { sizeof(skinslide_curves), 0, 0, 0, 0, 0, SKINSLIDE_CURVE_BASIS_LINEAR, SKINSLIDE_CURVE_WRAP_NONPERIODIC }

/* Which edges near a curve count, by their angle with the curve where it is nearest. Edges of no length are across. */
typedef enum skinslide_direction {
    SKINSLIDE_DIRECTION_ANY,
    SKINSLIDE_DIRECTION_ALONG, /* 45 degrees or less between them */
    SKINSLIDE_DIRECTION_ACROSS /* more */
} skinslide_direction;

/* Measures how far edges are from curves. Each cubic segment is taken as 16 straight pieces.
 *   points     in  [vertex_count][3]
 *   edges      in  [edge_count][2] vertices
 *   distances  out [edge_count] of each edge's middle from the nearest curve; infinite if the edge does not run in that
 *              direction, or no curve has a length
 * Fails with BAD_ARGUMENT (curves whose counts do not fit: names the curve; an edge's vertex out of range), BAD_POINTS (not
 * finite), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_edge_distances(const float *points, int32_t vertex_count, const int32_t *edges,
                                                        int32_t edge_count, const skinslide_curves *curves,
                                                        skinslide_direction direction, double *distances,
                                                        skinslide_error *error);

/* What a mesh at rest is symmetric about: the plane where coordinate `axis` is `plane`. Start from
 * SKINSLIDE_MIRROR_OPTIONS_DEFAULT. */
typedef struct skinslide_mirror_options {
    size_t size;  /* sizeof(skinslide_mirror_options) */
    int32_t axis; /* 0 x, 1 y, 2 z */
    double plane;
    double tolerance; /* how far a mirror image may be from what it is of; below 0: 1e-4 of the largest extent at rest */
} skinslide_mirror_options;

#define SKINSLIDE_MIRROR_OPTIONS_DEFAULT                                                                                       \
    { sizeof(skinslide_mirror_options), 0, 0, -1.0 }

/* Finds the faces on the other side of a symmetric mesh, and the vertices that correspond. Vertices correspond where one's
 * mirror image is within tolerance of the other and both are at the same place in faces that do; so vertices in one place are
 * told apart by their faces.
 *   options          in, or NULL: the default
 *   faces            in  [face_count] mesh faces
 *   mirror_faces     out [face_count]
 *   mirror_vertices  out [vertex_count]; -1 for vertices of none of the faces
 * Fails with BAD_MESH (vertices or a face without a counterpart: names them), BAD_POINTS, BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_mirror(const skinslide_mesh *mesh, const skinslide_mirror_options *options,
                                                const int32_t *faces, int32_t face_count, int32_t *mirror_faces,
                                                int32_t *mirror_vertices, skinslide_error *error);

/* The same by nearest place, for a mesh whose surface is symmetric, but whose faces have no counterparts, such as quads
 * cut along the other diagonal. A face is found if the mirror image of its middle is nearer to one of `faces` than to any
 * other.
 *   options         in, or NULL: the default; tolerance is how far a mirror image may be from the mesh
 *   faces           in  [face_count] mesh faces
 *   face_sources    out [mesh face_count] for each face found, the one of `faces` that it is nearest to; -1 for others
 *   vertex_sources  out [vertex_count] for each vertex of a face found, the vertex nearest to its mirror image; -1 for others
 *   worst           out the largest distance of a mirror image from the mesh
 * Fails with BAD_MESH (a vertex of either side whose mirror image is too far from the mesh: names it; no face found),
 * BAD_POINTS, BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_mirror_nearest(const skinslide_mesh *mesh, const skinslide_mirror_options *options,
                                                        const int32_t *faces, int32_t face_count, int32_t *face_sources,
                                                        int32_t *vertex_sources, double *worst, skinslide_error *error);

/* ---- A set-up that nobody painted: where skin stretches ----------------------------------------------------------------- */

/* Notes how far the sides of faces are from their rest lengths in a pose, on top of what was noted of earlier poses.
 *   points   in       [vertex_count][3]
 *   stretch  in, out  [index_count] the largest |log(length / rest length)| of the side from each corner to the next; all 0
 *                     before the first pose. A side of no length at rest has none
 * Fails with BAD_MESH, BAD_POINTS (not finite: names the vertex), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_note_stretch(const skinslide_mesh *mesh, const float *points, float *stretch,
                                                      skinslide_error *error);

/* How a mask is made of what was noted. Start from SKINSLIDE_MASK_OPTIONS_DEFAULT. */
typedef struct skinslide_mask_options {
    size_t size;   /* sizeof(skinslide_mask_options) */
    double least;  /* a side counts if its stretch is above this */
    double grow;   /* how far a region grows, as a share of its radius: the square root of its area at rest over pi */
    int64_t rings; /* and by at least how many rings of faces */
} skinslide_mask_options;

#define SKINSLIDE_MASK_OPTIONS_DEFAULT                                                                                         \
    { sizeof(skinslide_mask_options), 0.02, 0.5, 3 }

/* Chooses the faces that a patch needs so that skin may slide wherever it stretched: regions of connected faces that have an
 * end of a side that counts, and the faces near them on the mesh at rest. Growing gains more from the skin around than the pins
 * at the new border cost.
 *   stretch  in   [index_count] of skinslide_note_stretch
 *   options  in, or NULL: the default
 *   faces    out  [face_count] 1 for those chosen, else 0
 * Fails with BAD_MESH, BAD_POINTS (rest points not finite), BAD_ARGUMENT (a stretch or an option below 0), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_mask_stretched(const skinslide_mesh *mesh, const float *stretch,
                                                        const skinslide_mask_options *options, uint8_t *faces,
                                                        skinslide_error *error);

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
}
#endif
#endif

#endif
