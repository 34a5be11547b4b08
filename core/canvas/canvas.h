/* A canvas from inside: canvas.c makes, clears and reads it, figure.c draws figures on it with what shading.c makes. */
#ifndef SKINSLIDE_CANVAS_H
#define SKINSLIDE_CANVAS_H

#include "egl.h"
#include "picture.h"

/* A program and its uniforms. */
typedef struct ss_surface_program {
    GLuint program;
    GLint to_clip, turn_normal, scale, encoded, colours;
} ss_surface_program;

/* Objects that draw figures. */
typedef struct ss_figure_objects {
    ss_surface_program chequer, false_colours;
    GLuint outline_program;
    GLint outline_to_clip, half_width, line_colour; /* its uniforms */
    GLuint surface_array, outline_array;
    GLuint fixed_buffer, posed_buffer, triangle_buffer, segment_buffer;
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

/* What a colour of linear light is in the canvas's pixels. */
void ss_canvas_colour(const skinslide_canvas *canvas, const float light[3], float out[3]);
/* Tests give loaders that fail. */
skinslide_status ss_canvas_create(const skinslide_canvas_options *options, ss_egl_loader load, skinslide_canvas **out,
                                  skinslide_error *error);

#endif
