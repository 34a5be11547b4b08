/* skinslide/picture.h: skin drawn offscreen: pictures of what a slide did to it, before and after, and maps of that in texture
 * coordinates. No display and no GPU are needed: pictures need EGL with OpenGL ES 3, for which a software rasteriser will do;
 * maps need nothing.
 *
 *     skinslide_tessellation  a mesh made into triangles, along its limit surface where it is subdivided; immutable
 *     skinslide_canvas        what pictures are drawn on, with an OpenGL ES context of its own; for one thread at a time
 *
 * Conventions are those of skinslide.h. Matrices are double [16] as USD has them: row by row, for points as rows. */
#ifndef SKINSLIDE_PICTURE_H
#define SKINSLIDE_PICTURE_H

#include "paint.h"

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
extern "C" {
#endif
#endif

/* ---- What is drawn ------------------------------------------------------------------------------------------------------ */

typedef struct skinslide_tessellation skinslide_tessellation;

/* What there is to draw. Start from SKINSLIDE_TESSELLATION_INFO_DEFAULT. */
typedef struct skinslide_tessellation_info {
    size_t size; /* sizeof(skinslide_tessellation_info) */
    int32_t vertex_count;
    int32_t triangle_count;
    int32_t flat_faces; /* of a subdivided mesh, drawn flat: OpenSubdiv before 3.5.1 cannot subdivide them */
} skinslide_tessellation_info;

#define SKINSLIDE_TESSELLATION_INFO_DEFAULT                                                                                    \
    { sizeof(skinslide_tessellation_info), 0, 0, 0 }

/* Makes a mesh into triangles: the fans of its faces, or, where it is subdivided, grids on its limit surface: 2 by 2 cells a
 * quad; in the patch and two rings of faces around it up to 16 by 16, as far as 32,768 cells there in all allow. Grids meet
 * without a gap, whatever their cells. Faces that are not rendered (holeIndices, and with boundary rule NONE those at the
 * boundary) are left out, and so are faces of fewer than three vertices. Within a face, texture coordinates and values are
 * linear, as in USD with faceVaryingLinearInterpolation "all".
 *   mesh   in  outlines are those of the welded mesh
 *   st     in  [index_count][2] texture coordinates of the mesh's corners, face by face; NULL: the chequer is of cubes in
 *              space, by rest_points
 *   faces  in  [face_count] mesh faces: those of a patch, or of several, in any order, of any shape
 * Fails with BAD_MESH, BAD_POINTS, BAD_CONTROL (st not finite: names the face), BAD_ARGUMENT, UNSUPPORTED, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_tessellation_create(const skinslide_mesh *mesh, const float *st, const int32_t *faces,
                                                             int32_t face_count, skinslide_tessellation **out,
                                                             skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_tessellation_destroy(skinslide_tessellation *tessellation);

/* Fails with BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_tessellation_describe(const skinslide_tessellation *tessellation,
                                                               skinslide_tessellation_info *info, skinslide_error *error);

typedef struct skinslide_outline skinslide_outline;

/* Outlines some faces of a tessellated mesh; what is outside is drawn paler. Immutable; the tessellation must outlive it.
 *   faces  in  [face_count] mesh faces, as above
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_outline_create(const skinslide_tessellation *tessellation, const int32_t *faces,
                                                        int32_t face_count, skinslide_outline **out, skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_outline_destroy(skinslide_outline *outline);

/* One tile of a mesh's own texture, or all of it. Start from SKINSLIDE_COLOUR_TILE_DEFAULT. */
typedef struct skinslide_colour_tile {
    size_t size;           /* sizeof(skinslide_colour_tile) */
    const uint8_t *pixels; /* [height][width][4] sRGB from the top row on; the fourth is not read */
    int32_t width, height; /* 1 to SKINSLIDE_LARGEST_MAP, and within the device's limit */
    int32_t number;        /* 1001 + u + 10 v; 1001 where the texture is no UDIM */
} skinslide_colour_tile;

#define SKINSLIDE_COLOUR_TILE_DEFAULT                                                                                          \
    { sizeof(skinslide_colour_tile), 0, 0, 0, 1001 }

/* How the surface of a figure is coloured on one target of a canvas; members mean what they mean in skinslide_figure. Start
 * from SKINSLIDE_LOOK_DEFAULT. */
typedef struct skinslide_look {
    size_t size; /* sizeof(skinslide_look) */
    const float *values;
    float lowest, highest;
    const skinslide_colour_tile *tiles;
    int32_t tile_count;
} skinslide_look;

#define SKINSLIDE_LOOK_DEFAULT                                                                                                 \
    { sizeof(skinslide_look), 0, 0, 1.0f, 0, 0 }

/* A mesh in one pose, and its look. Start from SKINSLIDE_FIGURE_DEFAULT. */
typedef struct skinslide_figure {
    size_t size; /* sizeof(skinslide_figure) */
    const skinslide_tessellation *tessellation;
    const skinslide_outline *outline; /* of the tessellation; NULL: of the faces that it was made for */
    const float *points;              /* [mesh vertex_count][3] */
    const double *to_world;           /* [16] from the mesh's object space; NULL: it is the world's */
    const float *values;         /* [mesh vertex_count] drawn in false colours from lowest to highest; NULL: a chequer is */
    float lowest, highest;       /* the ends of the scale of colours: lowest < highest, by 1e-37 to 1e37 */
    float squares;               /* of the chequer, for each unit of st or of length at rest; > 0 */
    skinslide_bool double_sided; /* no: faces turned away from the camera are left out, as USD has it */
    skinslide_bool left_handed;  /* the mesh's orientation is leftHanded */
    const skinslide_colour_tile *tiles; /* [tile_count] drawn over the chequer, where st is in them; but values hide them */
    const float *ways;     /* [mesh vertex_count][3] how each vertex slid, in object units: a line is drawn to each one of the
                            patch from where it came; NULL: no lines */
    const uint8_t *pins;   /* [mesh vertex_count] not 0: a vertex of the patch gets a dot; NULL: none */
    int32_t tile_count;    /* 0 to 1000 */
    skinslide_bool wire;   /* the sides of the patch's faces are drawn */
    skinslide_bool ghosts; /* what is nearer than the patch, and not of it, is drawn as a mere shadow */
    float line;            /* the width of lines and dots, times the usual; 0: 1 */
    const skinslide_look *others; /* [other_count] its looks on further targets of the canvas */
    int32_t other_count;          /* fewer than the canvas has targets */
    int32_t edge_count;
    const int32_t *edges;     /* [edge_count][2] mesh vertices: lines are drawn along those that are edges of the patch */
    const float *edge_values; /* [edge_count] drawn as the colours of these lines, from lowest to highest */
} skinslide_figure;

#define SKINSLIDE_FIGURE_DEFAULT                                                                                               \
    { sizeof(skinslide_figure), 0, 0, 0, 0, 0, 0, 1.0f, 1.0f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* A colour of the scale of false colours.
 *   share   in  0 for lowest to 1 for highest; clamped
 *   colour  out linear light
 */
SKINSLIDE_API void skinslide_false_colour(float share, float colour[3]);

/* ---- From where --------------------------------------------------------------------------------------------------------- */

typedef struct skinslide_camera {
    double to_camera[16]; /* from the world; the camera looks along -z */
    double to_screen[16]; /* the projection: to clip space, -1..1 in all of x/w, y/w, z/w */
} skinslide_camera;

/* Faces of a mesh in some poses. Start from SKINSLIDE_SUBJECT_DEFAULT. */
typedef struct skinslide_subject {
    size_t size;                /* sizeof(skinslide_subject) */
    const skinslide_mesh *mesh; /* rest_points are not read */
    const int32_t *faces;       /* [face_count] mesh faces */
    int32_t face_count;         /* > 0 */
    int32_t pose_count;         /* > 0 */
    const float *const *poses;  /* [pose_count] each [mesh vertex_count][3] */
    const double *to_world;     /* [pose_count][16], or NULL: poses are in the world */
    skinslide_bool left_handed; /* the mesh's orientation is leftHanded */
} skinslide_subject;

#define SKINSLIDE_SUBJECT_DEFAULT                                                                                              \
    { sizeof(skinslide_subject), 0, 0, 0, 0, 0, 0, 0 }

/* Finds a camera that has a subject in sight in each of its poses: as near as all of it fits, but with none of it nearer than
 * half the diagonal of its box, whose sides run along the picture and into it. It looks against the mean of the faces' normals
 * over the poses; where those cancel out, as round a limb, from where the faces are widest. Where some pose would then be
 * turned to the camera less than half as far as is possible along the normal of a pose, or along one halfway between two, it
 * looks against that one. Whether other faces of the mesh hide these does not count: a figure with ghosts shows them.
 *   up      in  the world's, a direction
 *   aspect  in  width of the picture by its height
 * Fails with BAD_ARGUMENT, BAD_MESH, BAD_POINTS (not finite: names the pose; or no camera can see them: all in one place),
 * OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_frame_faces(const skinslide_subject *subject, const double up[3], double aspect,
                                                     skinslide_camera *camera, skinslide_error *error);

/* ---- On what ------------------------------------------------------------------------------------------------------------ */

/* How a canvas holds colours. */
typedef enum skinslide_pixels {
    SKINSLIDE_PIXELS_BYTES, /* sRGB, 8 bits: read as uint8_t */
    SKINSLIDE_PIXELS_FLOATS /* linear light, half floats: read as float */
} skinslide_pixels;

enum { SKINSLIDE_MOST_TARGETS = 4 };

/* What a canvas is to be. Start from SKINSLIDE_CANVAS_OPTIONS_DEFAULT. */
typedef struct skinslide_canvas_options {
    size_t size;           /* sizeof(skinslide_canvas_options) */
    int32_t width, height; /* pixels, each 1 to 16384 and within the device's limit; 67,108,864 in all */
    skinslide_pixels pixels;
    int32_t device;  /* as in skinslide_workspace_options */
    int32_t targets; /* render targets: pictures that figures are drawn on at once, each in a look of its own; 0: 1;
                        SKINSLIDE_MOST_TARGETS at most */
} skinslide_canvas_options;

#define SKINSLIDE_CANVAS_OPTIONS_DEFAULT                                                                                       \
    { sizeof(skinslide_canvas_options), 1920, 1080, SKINSLIDE_PIXELS_BYTES, SKINSLIDE_ANY_DEVICE, 0 }

typedef struct skinslide_canvas skinslide_canvas;

/* Makes a canvas. Its context is current only within calls, as a workspace's is (see skinslide_workspace_create).
 *   options  in, or NULL: the default
 * Fails with BAD_ARGUMENT (sizes, targets, no such pixels or device, above the device's limit), NO_DEVICE (names all that was
 * tried), DEVICE_FAILED, UNSUPPORTED (the device draws no floats), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_canvas_create(const skinslide_canvas_options *options, skinslide_canvas **out,
                                                       skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_canvas_destroy(skinslide_canvas *canvas);

/* The device that draws. Fails with BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_canvas_device(const skinslide_canvas *canvas, skinslide_device_info *info,
                                                       skinslide_error *error);

/* Fills all targets of a canvas with a colour, linear light, and forgets what was drawn and how near it was.
 * Fails with BAD_ARGUMENT, DEVICE_FAILED. */
SKINSLIDE_API skinslide_status skinslide_canvas_clear(skinslide_canvas *canvas, const float colour[3], skinslide_error *error);

/* Part of a canvas, in pixels from its lower left corner. */
typedef struct skinslide_viewport {
    int32_t x, y, width, height;
} skinslide_viewport;

/* Draws a figure, four samples a pixel, hidden by what is nearer of what was drawn before. It is shaded by a light beside the
 * camera, in which a surface that faces the camera has its own colour. The first target has the figure's own look, the targets
 * that follow have its others, all with the same lines and dots: targets cost much less than as many drawings.
 * Fails with BAD_ARGUMENT (no such viewport; sizes of the chequer, of the scale or of a tile; tiles on a mesh without st; edges
 * without values), BAD_POINTS (points, values, ways or matrices not finite), DEVICE_FAILED, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_canvas_draw(skinslide_canvas *canvas, const skinslide_viewport *viewport,
                                                     const skinslide_camera *camera, const skinslide_figure *figure,
                                                     skinslide_error *error);

/* Reads the picture on the first target.
 *   pixels  out [height][width][4] red, green, blue, and 1, from the top row on; uint8_t or float, as the canvas has them
 * Fails with BAD_ARGUMENT, DEVICE_FAILED. */
SKINSLIDE_API skinslide_status skinslide_canvas_read(skinslide_canvas *canvas, void *pixels, skinslide_error *error);

/* The same for any target, numbered from 0. */
SKINSLIDE_API skinslide_status skinslide_canvas_read_target(skinslide_canvas *canvas, int32_t target, void *pixels,
                                                            skinslide_error *error);

/* ---- Maps: values drawn in a mesh's texture coordinates ----------------------------------------------------------------- */

enum { SKINSLIDE_LARGEST_MAP = 16384 }; /* texels along each side */

/* Draws values of a mesh's vertices over one tile of its texture: linearly over the triangles of each face's fan; where faces
 * overlap, the later in the layout wins. A texel is covered where its centre is in a triangle; a centre on the border of a
 * triangle is in it on its left and lower sides only, so that of triangles which share a side exactly one has it. Then, four
 * times over, each texel that is not covered but touches covered ones, if only at a corner, takes their mean and counts as
 * covered, so that bilinear samples at the border of an island find its values. The others are 0. Faces with corners in several
 * tiles are drawn in each of these. This runs on the processor, in one thread: the same bytes on every machine.
 *   tile          in  1001 + u + 10 v; 1001 where the texture is no UDIM
 *   values        in  [vertex_count] of the mesh
 *   side          in  texels along each side, 1 to SKINSLIDE_LARGEST_MAP
 *   texels        out [side][side] from the top row on, with (0, 0) of the tile at the lower left corner
 *   missed_faces  out, or NULL: faces of this tile that cover no texel
 * Fails with BAD_ARGUMENT (NULL, no such tile or side, a face out of range), BAD_MESH, BAD_CONTROL (st not finite or in no
 * tile: names the face), BAD_POINTS (a value of the faces is not finite: names the vertex), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_map_draw(const skinslide_texture_layout *layout, int32_t tile, const float *values,
                                                  int32_t side, float *texels, int32_t *missed_faces, skinslide_error *error);

/* The same of values at the corners of faces, which may differ from face to face at a vertex.
 *   values  in  [index_count] of the mesh
 * Fails likewise. */
SKINSLIDE_API skinslide_status skinslide_map_draw_corners(const skinslide_texture_layout *layout, int32_t tile,
                                                          const float *values, int32_t side, float *texels,
                                                          int32_t *missed_faces, skinslide_error *error);

/* ---- Stretch with its sign, for wrinkles -------------------------------------------------------------------------------- */

/* The principal stretches of a pose: lengths over lengths at rest, above 1 where skin is drawn out, below 1 where it is pressed
 * together; and their direction. Any of the arrays may be NULL: it is not wanted. Start from SKINSLIDE_STRAIN_DEFAULT. */
typedef struct skinslide_strain {
    size_t size;       /* sizeof(skinslide_strain) */
    float *largest;    /* out [vertex_count] in the direction that is stretched most */
    float *smallest;   /* out [vertex_count] and across it */
    float *area_ratio; /* out [vertex_count] area over area at rest: the product of both */
    float *direction;  /* out [index_count][2] of the largest, in the texture coordinates of each corner of the mesh: cos 2a and
                          sin 2a, a its angle from s towards t, so that opposite directions are the same and values may be
                          blended; 0 where stretch is the same in all directions */
} skinslide_strain;

#define SKINSLIDE_STRAIN_DEFAULT                                                                                               \
    { sizeof(skinslide_strain), 0, 0, 0, 0 }

/* Measures a pose at each vertex: the mean of the strain tensors at the corners of its faces, weighted by area at rest. Where
 * nothing is stretched, and at vertices of none of the faces, stretches and area are 1. The same bytes on every machine.
 *   mesh    in  rest_points too; what is welded is one vertex
 *   st      in  [index_count][2] texture coordinates of the mesh's corners, face by face; NULL where no direction is wanted
 *   faces   in  [face_count] mesh faces that count
 *   points  in  [vertex_count][3] the pose
 *   strain  in, its arrays out
 * Fails with BAD_ARGUMENT, BAD_MESH, BAD_POINTS (not finite, or stretched more than a float can hold: names the vertex),
 * BAD_CONTROL (st not finite: names the face), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_measure_strain(const skinslide_mesh *mesh, const float *st, const int32_t *faces,
                                                        int32_t face_count, const float *points, const skinslide_strain *strain,
                                                        skinslide_error *error);

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
}
#endif
#endif

#endif
