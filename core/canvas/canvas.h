/* A canvas from inside.
 *
 *     canvas.c   makes, clears and reads it
 *     figure.c   draws a figure: checks it, and calls these in order
 *     looks.c    takes its look on each target
 *     edges.c    takes the edges that are drawn in colours
 *     sight.c    finds the triangles that are seen
 *     strokes.c  lists and draws lines and dots
 *     surface.c  draws the surface
 *     shading.c  makes the programs, and the scale of false colours */
#ifndef SKINSLIDE_CANVAS_H
#define SKINSLIDE_CANVAS_H

#include "egl.h"
#include "picture.h"

/* A program and its uniforms. */
typedef struct ss_surface_program {
    GLuint program; /* 0: not made yet */
    GLint to_clip, turn_normal, scale, encoded;
} ss_surface_program;

/* The objects of the context that draw figures. */
typedef struct ss_figure_objects {
    ss_surface_program looks[2 << SKINSLIDE_MOST_TARGETS]; /* see ss_look_program */
    ss_surface_program tile;
    GLuint stroke_program;
    GLint stroke_to_clip, pen; /* its uniforms */
    GLuint surface_array, stroke_array;
    GLuint vertex_buffer, triangle_buffer, segment_buffer;
} ss_figure_objects;

struct skinslide_canvas {
    ss_memory memory;
    ss_egl *egl;
    int32_t width, height, targets, largest_texture;
    skinslide_pixels pixels;
    uint8_t *rows;          /* scratch for all pixels, kept since fresh memory at each read is slow */
    GLint marks;            /* how many marks figures have left in the stencil */
    GLuint drawn, resolved; /* framebuffers: of several samples a pixel, and of one */
    ss_figure_objects objects;
};

/* A vertex as the programs read it. */
typedef struct ss_vertex_attributes {
    float coordinates[3], place[3], normal[3];
    float inside; /* 1 in the patch, 0 outside */
    float values[SKINSLIDE_MOST_TARGETS];
} ss_vertex_attributes;

/* A figure's look on one target, checked. */
typedef struct ss_target_look {
    skinslide_look own;
    skinslide_colour_tile *tiles; /* [own.tile_count] */
    GLuint *textures;             /* [own.tile_count] */
} ss_target_look;

/* A line as the program reads it. */
typedef struct ss_segment {
    float ends[2][3]; /* relative to the origin; where both are the same, a dot */
    float colour[3];  /* in the canvas's pixels */
} ss_segment;

/* Lines of one kind. */
typedef struct ss_stroke {
    int32_t count;
    ss_segment *segments; /* [count] */
    float width;          /* times that of the outline */
    float nearer;         /* how far it is drawn nearer to the camera, in depth */
    float light[3];
    float colour[3]; /* the same in the canvas's pixels, for the segments that are added next */
} ss_stroke;

enum { SS_WIRE, SS_OUTLINE, SS_EDGE_BORDERS, SS_EDGES, SS_WAYS, SS_ENDS_OF_WAYS, SS_PINS, SS_STROKES };

/* One call of skinslide_canvas_draw. */
typedef struct ss_drawing {
    const skinslide_canvas *canvas;
    GLint mark; /* its value in the stencil, where its patch is seen */
    const skinslide_viewport *viewport;
    const skinslide_figure *figure;
    const skinslide_tessellation *mesh;
    const skinslide_outline *outline;
    ss_target_look looks[SKINSLIDE_MOST_TARGETS]; /* [look_count] */
    int32_t look_count;
    const ss_surface_program *look, *plain; /* the programs that draw it in its looks, and plain */
    ss_view view;
    ss_tessellation_work work;
    double origin[3];
    uint8_t *in_sight;              /* [mesh->grid_count] */
    ss_vertex_attributes *vertices; /* [vertex_count] of the triangles */
    uint32_t (*triangles)[3];       /* [triangle_count] that are seen: first the patch's, then those that hide none of it, then
                                  those that may */
    int32_t vertex_count, triangle_count, inside_count, hiding_first;
    float *edge_value;             /* [edge_count] of the mesh's skin: NaN where the edge has no colour; NULL: none has one */
    ss_stroke strokes[SS_STROKES]; /* drawn in order */
    float line;                    /* pixels that the outline is wide */
} ss_drawing;

/* Checks the figure's looks and fills drawn->looks. */
skinslide_status ss_take_looks(ss_drawing *drawn, skinslide_error *error);
/* Fails with BAD_ARGUMENT unless lowest < highest, and not by too little or too much for float. */
skinslide_status ss_check_scale(float lowest, float highest, skinslide_error *error);
/* Checks the edges that are drawn in colours, and fills drawn->edge_value. */
skinslide_status ss_take_edges(ss_drawing *drawn, skinslide_error *error);
/* Finds the triangles that are seen and their vertices, once the mesh is posed. False if memory is short. */
bool ss_list_seen(ss_drawing *drawn);
/* Lists the lines and dots, once the mesh is posed. False if memory is short. */
bool ss_list_strokes(ss_drawing *drawn);
void ss_draw_strokes(const ss_drawing *drawn);
/* Draws the surface, and the strokes: before the shadows of what hides the patch, if there are any. */
void ss_draw_surface(const ss_drawing *drawn);

/* Makes only targets [first, end) be drawn on. */
void ss_draw_on_targets(const skinslide_canvas *canvas, int32_t first, int32_t end);
/* Makes the programs and buffers. The context is current. */
skinslide_status ss_figure_objects_create(const ss_egl_api *gl, ss_figure_objects *objects, skinslide_error *error);
/* The program that draws on a number of targets: false colours on those whose bit is set, chequers on the others. It is made
 * when it is first asked for. The context is current. */
skinslide_status ss_look_program(skinslide_canvas *canvas, int32_t targets, unsigned false_colours,
                                 const ss_surface_program **out, skinslide_error *error);

/* A colour of linear light in the canvas's pixels: encoded as sRGB where these are bytes. */
void ss_canvas_colour(const skinslide_canvas *canvas, const float light[3], float out[3]);
/* skinslide_canvas_create, with EGL by another loader: tests use loaders that fail. */
skinslide_status ss_canvas_create(const skinslide_canvas_options *options, ss_egl_loader load, skinslide_canvas **out,
                                  skinslide_error *error);

#endif
