/* A canvas from inside: canvas.c makes, clears and reads it, figure.c draws figures on it with what shading.c makes. */
#ifndef SKINSLIDE_CANVAS_H
#define SKINSLIDE_CANVAS_H

#include "draw.h"
#include "egl.h"

/* Objects that draw figures. */
typedef struct ss_figure_objects {
    GLuint surface_program, outline_program;
    GLuint surface_array, outline_array;
    GLuint fixed_buffer, posed_buffer, triangle_buffer, segment_buffer;
    GLint surface_to_camera, surface_to_clip, turn_normal, coordinates, scale, colours, encoded, chequered; /* uniforms */
    GLint outline_to_clip, half_width, line_colour;
} ss_figure_objects;

struct skinslide_canvas {
    ss_egl *egl;
    int32_t width, height;
    skinslide_pixels pixels;
    GLuint drawn, resolved; /* framebuffers: of several samples a pixel, and of one */
    ss_figure_objects objects;
};

/* The context is current. */
skinslide_status ss_figure_objects_create(const ss_egl_api *gl, ss_figure_objects *objects, skinslide_error *error);

/* The program that draws surfaces is in use. */
void ss_set_scale_colours(const ss_egl_api *gl, const ss_figure_objects *objects);

/* What a colour of linear light is in the canvas's pixels. */
void ss_canvas_colour(const skinslide_canvas *canvas, const float light[3], float out[3]);
/* Tests give loaders that fail. */
skinslide_status ss_canvas_create(const skinslide_canvas_options *options, ss_egl_loader load, skinslide_canvas **out,
                                  skinslide_error *error);

#endif
