/* A canvas from inside: canvas.c makes, clears and reads it; figure.c draws figures on it, surface.c their surfaces, of which
 * sight.c finds what is seen, in what paints.c takes, and strokes.c what is drawn on these, edges that edges.c finds among it, all
 * with what shading.c makes. */
#ifndef SKINSLIDE_CANVAS_H
#define SKINSLIDE_CANVAS_H

#include "egl.h"
#include "picture.h"

/* A program and its uniforms. */
typedef struct ss_surface_program {
    GLuint program; /* 0: not made yet */
    GLint to_clip, turn_normal, scale, encoded;
} ss_surface_program;

/* Objects that draw figures. */
typedef struct ss_figure_objects {
    ss_surface_program painted[2 << SKINSLIDE_MOST_LAYERS]; /* see ss_painted_program */
    ss_surface_program tile;
    GLuint stroke_program;
    GLint stroke_to_clip, pen; /* its uniforms */
    GLuint surface_array, stroke_array;
    GLuint vertex_buffer, triangle_buffer, segment_buffer;
} ss_figure_objects;

struct skinslide_canvas {
    ss_memory memory;
    ss_egl *egl;
    int32_t width, height, layers, largest_texture;
    skinslide_pixels pixels;
    uint8_t *rows;          /* scratch for all pixels: memory of its own would be new to the machine at each read */
    GLint marks;            /* that figures have left in the stencil, each its own */
    GLuint drawn, resolved; /* framebuffers: of several samples a pixel, and of one */
    ss_figure_objects objects;
};

/* A vertex as programs have it. */
typedef struct ss_shown_vertex {
    float coordinates[3], place[3], normal[3];
    float inside; /* 1 in the patch, else 0 */
    float values[SKINSLIDE_MOST_LAYERS];
} ss_shown_vertex;

/* What is on one layer. */
typedef struct ss_layer_paint {
    skinslide_paint own;
    skinslide_colour_tile *tiles; /* [own.tile_count] */
    GLuint *textures;             /* [own.tile_count] */
} ss_layer_paint;

/* A line as programs have it. */
typedef struct ss_segment {
    float ends[2][3]; /* less the origin; where both are one, a dot */
    float colour[3];  /* in the canvas's pixels */
} ss_segment;

/* Lines of one kind. */
typedef struct ss_stroke {
    int32_t count;
    ss_segment *segments; /* [count] */
    float width;          /* in lines of the outline */
    float nearer;         /* brought towards the camera, in its depth */
    float light[3];
    float colour[3]; /* in the canvas's pixels: of segments that are added */
} ss_stroke;

enum { SS_WIRE, SS_OUTLINE, SS_EDGE_BORDERS, SS_EDGES, SS_WAYS, SS_ENDS_OF_WAYS, SS_PINS, SS_STROKES };

/* One call of skinslide_canvas_draw. */
typedef struct ss_drawing {
    const skinslide_canvas *canvas;
    GLint mark; /* in the stencil, where its patch is */
    const skinslide_viewport *viewport;
    const skinslide_figure *figure;
    const skinslide_tessellation *mesh;
    const skinslide_outline *outline;
    ss_layer_paint paints[SKINSLIDE_MOST_LAYERS]; /* [paint_count] */
    int32_t paint_count;
    const ss_surface_program *painted, *plain; /* with all paints; with what is outside the patch in false colours */
    ss_view view;
    ss_tessellation_work work;
    double origin[3];
    uint8_t *in_sight;         /* [mesh->grid_count] */
    ss_shown_vertex *vertices; /* [vertex_count] of the triangles */
    uint32_t (*triangles)[3];  /* [triangle_count] that are seen: the patch's come first, then what hides none of it */
    int32_t vertex_count, triangle_count, inside_count, hiding_first;
    float *edge_value;             /* [edge_count] of the mesh's skin: NaN where no edge is painted; NULL: none is */
    ss_stroke strokes[SS_STROKES]; /* drawn in order */
    float line;                    /* pixels that the outline is wide */
} ss_drawing;

/* Checks them; with what memory they need. */
skinslide_status ss_take_paints(ss_drawing *drawn, skinslide_error *error);
/* Whether there are colours from lowest to highest. */
skinslide_status ss_check_scale(float lowest, float highest, skinslide_error *error);
/* Checks them; fills edge_value. */
skinslide_status ss_take_edges(ss_drawing *drawn, skinslide_error *error);
/* Once vertices are posed. False where memory is short. */
bool ss_list_seen(ss_drawing *drawn);
/* In the work's memory, from its vertices. False where memory is short. */
bool ss_list_strokes(ss_drawing *drawn);
void ss_draw_strokes(const ss_drawing *drawn);
/* With ghosts, the strokes too, which are under these. */
void ss_draw_surface(const ss_drawing *drawn);

/* Only layers [first, end) are drawn on. */
void ss_draw_on_layers(const skinslide_canvas *canvas, int32_t first, int32_t end);
/* The context is current. */
skinslide_status ss_figure_objects_create(const ss_egl_api *gl, ss_figure_objects *objects, skinslide_error *error);
/* The program that draws on so many layers, false colours on those whose bit is set and chequers on the others. Made when it is
 * first asked for; the context is current. */
skinslide_status ss_painted_program(skinslide_canvas *canvas, int32_t layers, unsigned false_colours,
                                    const ss_surface_program **out, skinslide_error *error);

/* What a colour of linear light is in the canvas's pixels. */
void ss_canvas_colour(const skinslide_canvas *canvas, const float light[3], float out[3]);
/* Tests give loaders that fail. */
skinslide_status ss_canvas_create(const skinslide_canvas_options *options, ss_egl_loader load, skinslide_canvas **out,
                                  skinslide_error *error);

#endif
