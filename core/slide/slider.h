/* What is made once a shot, once a thread, and used in every frame. */
#ifndef SKINSLIDE_SLIDER_H
#define SKINSLIDE_SLIDER_H

#include "device.h"
#include "limit.h"
#include "relax.h"
#include "travel.h"

/* One patch, ready to slide: immutable. */
typedef struct ss_part {
    ss_patch *patch;
    ss_system *system;
    double *paint;        /* [edge_count] of the set-up's controls */
    double (*rest_uv)[2]; /* [vertex_count] U0 with that paint */
    double *weights;      /* [free_count] weight times envelope of the set-up's controls */
    double *limits;       /* [free_count] largest distances of the set-up's controls */
    bool limited;         /* whether any is finite */
    int32_t clamped_weights;
    ss_layout rest_layout;
    ss_cage *cage; /* NULL unless its interpolation is LIMIT */
    ss_triangles *triangles;
    ss_chart *chart; /* NULL unless the rule is RELAXED */
} ss_part;

struct skinslide_slider {
    ss_memory memory;
    int32_t vertex_count, face_count, setup_count, part_count;
    skinslide_patch_setup
        *setups;           /* [setup_count] names copied, interpolation not AUTO; their arrays are the caller's, and not kept */
    ss_part *parts;        /* [part_count] */
    ss_topology *topology; /* while the slider is built, once a set-up needs it */
};

/* What one thread needs to slide one patch. */
typedef struct ss_patch_work {
    ss_factor *factor;
    ss_locator *locator;
    ss_relaxer *relaxer; /* NULL unless the rule is RELAXED */
    ss_traveller *traveller;
    const double *paint;            /* the part's, or own_paint [edge_count] */
    const double *weights, *limits; /* the part's, or own_weights and own_limits [free_count] */
    bool limited;
    const double (*rest_uv)[2]; /* the part's, or own_rest_uv */
    double *own_paint, *own_weights, *own_limits, (*own_rest_uv)[2];
    double *lengths, *density; /* [edge_count] */
    double (*uv)[2];           /* [vertex_count] Ud, fixed vertices in place */
    double (*queries)[2];      /* [free_count] */
    ss_location *locations;    /* [free_count] */
    double (*displacement)[3]; /* [free_count] */
    double *corner_weights;    /* [largest face] */
    ss_cage_work *cage;        /* NULL unless the part has one */
    bool regular;              /* this frame's layout */
    ss_candidates *candidates; /* [free_count], NULL with lookup EXACT */
} ss_patch_work;

struct skinslide_workspace {
    ss_memory memory;
    const skinslide_slider *slider;
    ss_patch_work *patches;          /* [part_count] */
    skinslide_patch_result *results; /* [part_count] */
    double (*sum)[4];                /* [vertex_count] weighted displacement, weight */
    bool has_frame;
    ss_idbuffer *idbuffer; /* NULL with lookup EXACT */
    skinslide_lookup_info lookup;
};

/* Controls of one frame, [setup_count]. */
skinslide_status ss_check_frame_controls(const skinslide_slider *slider, const skinslide_controls *controls,
                                         skinslide_error *error);

/* ---- lookup.c ---- */

/* skinslide_workspace_create, with EGL by another loader. */
skinslide_status ss_workspace_create(const skinslide_slider *slider, const skinslide_workspace_options *options,
                                     ss_egl_loader load, skinslide_workspace **out, skinslide_error *error);
/* Makes the workspace's ID buffer, where its options come to EGL. */
skinslide_status ss_workspace_open_lookup(skinslide_workspace *workspace, const skinslide_workspace_options *options,
                                          ss_egl_loader load, skinslide_error *error);

#endif
