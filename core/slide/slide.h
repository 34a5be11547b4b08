/* What is made once for a shot, what is made once for each thread, and what a frame uses of them. */
#ifndef SKINSLIDE_SLIDE_H
#define SKINSLIDE_SLIDE_H

#include "even.h"
#include "limit.h"
#include "relax.h"

/* One patch, ready to slide: immutable. */
typedef struct ss_part {
    ss_patch *patch;
    ss_rest *rest;
    double *paint;   /* [edge_count] of the set-up's controls */
    double *weights; /* [free_count] weight times envelope of the set-up's controls */
    double *limits;  /* [free_count] largest distances of the set-up's controls; NULL where they have none */
    double *holds;   /* [vertex_count] of the set-up's controls */
    bool limited;    /* whether any largest distance is finite */
    double stretch_response, compression_response;
    int32_t clamped_weights;
    ss_layout rest_layout; /* of U0; all 0 if the rule has no plane */
    ss_cage *cage;         /* NULL unless its interpolation is LIMIT */
} ss_part;

/* Vertices of the mesh that follow each other, up to end. */
typedef struct ss_span {
    int32_t first, end;
} ss_span;

static inline int32_t ss_span_size(const ss_span *span) {
    return span->end - span->first;
}

typedef struct ss_list {
    int32_t count; /* vertices */
    int32_t span_count;
    ss_span *spans; /* [span_count] ascending, with others between them */
} ss_list;

/* The matrices to where lengths are measured, and back. */
typedef struct ss_space {
    double to[9], back[9];
} ss_space;

struct skinslide_slider {
    ss_memory memory;
    int32_t vertex_count, face_count, setup_count, part_count;
    skinslide_patch_setup
        *setups;         /* [setup_count] names copied, interpolation not AUTO; their arrays are the caller's, and not kept */
    ss_part *parts;      /* [part_count] those of each set-up follow each other */
    int32_t *first_part; /* [setup_count + 1] */
    int32_t *weld;       /* [vertex_count] the mesh's; NULL: none */
    ss_around around;    /* the patches' vertices, for smooth normals */
    ss_list own;         /* the patches' vertices, and what is one with them */
    ss_list reads;       /* vertices of all faces that touch a patch */
    ss_space *space;     /* NULL: the mesh's own */
};

/* What a set-up has become; nothing before that. */
typedef struct ss_built {
    ss_memory memory;
    ss_part *parts; /* [part_count] a piece each */
    int32_t part_count;
    bool done;
} ss_built;

struct skinslide_build {
    ss_memory memory;
    ss_taken_mesh taken;      /* rest is where lengths are taken */
    skinslide_slider *slider; /* with all but its parts and what is known of them; NULL once it is given away */
    const int32_t *face_start;
    ss_topology *topology; /* where a set-up needs it */
    skinslide_status topology_status;
    skinslide_error topology_error;
    ss_built *built; /* [setup_count] */
};

/* What is painted on an edge by its vertices, perhaps on several copies of it. */
typedef struct ss_edge_paint {
    double sum;
    int32_t count;
} ss_edge_paint;

/* What one thread needs to slide one patch. */
typedef struct ss_patch_work {
    ss_slide *slide;
    ss_frame frame;                   /* paint, weights, limits and holds are the part's, or those below */
    double *lengths;                  /* [edge_count] */
    double *own_paint;                /* [edge_count] this and what follows is there once a frame has had controls of its own */
    double *own_weights, *own_limits; /* [free_count] */
    double *own_holds;                /* [vertex_count] */
    int32_t largest_face;             /* its corners */
    double (*displacement)[3];        /* [free_count] in the room, once the rule has finished */
    double *corner_weights;           /* [largest face] likewise */
    ss_cage_work *cage;               /* NULL unless the part has one */
} ss_patch_work;

struct skinslide_workspace {
    ss_memory memory;
    const skinslide_slider *slider;
    ss_patch_work *patches;          /* [part_count] */
    ss_room room;                    /* scratch of one patch after the other */
    skinslide_patch_result *results; /* [part_count] */
    skinslide_controls *controls;    /* [setup_count] of the frame */
    double (*sum)[4];                /* [vertex_count] weighted displacement, weight */
    float (*landed)[3];              /* [own vertices of the slider] where each slides to */
    float *before, *after;           /* [vertex_count][3] points where lengths are taken; NULL where that is the mesh's space */
    bool has_frame;
    int stop;              /* a flag that other threads set, see base.h */
    ss_idbuffer *idbuffer; /* NULL with lookup EXACT */
    skinslide_lookup_info lookup;
    ss_memory controlling;             /* the patches' own paint and the like */
    bool has_controls;                 /* whether controlling is made */
    ss_memory turning;                 /* made when turns are first asked for: */
    double (*normal)[3], (*target)[3]; /* [vertex_count] the cache's, and where each vertex slid to; normals of unit length */
};

/* How much the displacement of a free vertex, or its normal, counts where patches overlap. A vertex of weight 0 follows its
 * neighbours so that its limit point stays, but then counts next to nothing. */
static inline double ss_blend_weight(double weight) {
    return ss_most(weight, 1e-30);
}

/* The vertex that a vertex of the mesh is one with. */
static inline int32_t ss_welded(const skinslide_slider *slider, int32_t vertex) {
    return slider->weld ? slider->weld[vertex] : vertex;
}

/* ---- painted.c ---- */

/* Checks the values of controls: names the mesh element of a bad one. */
skinslide_status ss_check_controls(const skinslide_mesh *mesh, const char *name, const skinslide_controls *controls,
                                   skinslide_error *error);
/* Where several vertices, or edges, are one, the mean of what is painted on each counts, and the smallest of largest
 * distances. */

/* The painted multiplier of every edge: [edge_count]. Controls are checked. edges is scratch [edge_count]. */
void ss_paint(const ss_patch *patch, const skinslide_controls *controls, ss_edge_paint *edges, double *paint);
/* weight times envelope of every free vertex, in their order: [free_count]. Returns how many values were outside 0..1. */
int32_t ss_control_weights(const ss_patch *patch, const skinslide_controls *controls, double *weights);
/* How far every free vertex may slide, in their order: [free_count], infinite where there is no limit. Returns whether any
 * has. */
bool ss_control_limits(const ss_patch *patch, const skinslide_controls *controls, double *limits);
/* How closely every vertex follows its neighbours: [vertex_count]. */
void ss_control_holds(const ss_patch *patch, const skinslide_controls *controls, double *holds);

/* ---- setup.c ---- */

/* Leaves out as it was where it fails. Any thread, for each set-up one. */
skinslide_status ss_build_setup(const skinslide_build *build, int32_t setup, ss_built *out, skinslide_error *error);

/* Copies the caller's controls of one frame to controls [setup_count], and checks them. */
skinslide_status ss_take_frame_controls(const skinslide_slider *slider, const skinslide_controls *given,
                                        skinslide_controls *controls, skinslide_error *error);

/* ---- build.c ---- */

void ss_destroy_parts(ss_part *parts, int32_t count);

/* ---- reads.c ---- */

/* Fills slider->own and slider->reads, for patches of the vertices chosen [vertex_count]. False if memory is short. */
bool ss_list_vertices(skinslide_slider *slider, const skinslide_mesh *mesh, const uint8_t *chosen);
/* Names the first point that sliding reads and that is not finite. */
skinslide_status ss_check_reads(const skinslide_slider *slider, const float *points, const char *what, skinslide_error *error);

/* ---- space.c ---- */

/* Fills slider->space, where the mesh has one. */
skinslide_status ss_take_space(skinslide_slider *slider, const skinslide_mesh *mesh, skinslide_error *error);
/* Makes *points point to the points where lengths are measured: in room [vertex_count][3], which may be NULL if that is the
 * mesh's own space. */
void ss_bring(const skinslide_slider *slider, const float **points, float *room);
/* Takes a displacement from there to the mesh's own space. */
void ss_take_back(const skinslide_slider *slider, const double displacement[3], double out[3]);

/* ---- motion.c ---- */

/* Copies the caller's samples to samples [count], and checks that each has points and times ascend. */
skinslide_status ss_take_samples(const skinslide_sample *given, int count, skinslide_sample *samples, skinslide_error *error);

/* ---- inspect.c ---- */

/* BAD_ARGUMENT before the first frame, and after one that failed. */
skinslide_status ss_check_frame(const skinslide_workspace *workspace, skinslide_error *error);

/* ---- slider.c ---- */

/* Whether a frame goes on: status or, if another thread has asked for it, INTERRUPTED, for which a stage may also have failed.
 * Clears the request, so that the next frame can go on. */
skinslide_status ss_go_on(skinslide_workspace *workspace, skinslide_status status, skinslide_error *error);

/* ---- workspace.c ---- */

/* Makes memory for controls of frames, if there is none yet. */
skinslide_status ss_need_controls(skinslide_workspace *workspace, skinslide_error *error);

void ss_lay_out_displacement(ss_patch_work *work, const ss_patch *patch, ss_room *room);

/* skinslide_workspace_create, with EGL by another loader. */
skinslide_status ss_workspace_create(const skinslide_slider *slider, const skinslide_workspace_options *options,
                                     ss_egl_loader load, skinslide_workspace **out, skinslide_error *error);

/* ---- lookup.c ---- */

/* Makes the workspace's ID buffer, if its options lead to EGL. */
skinslide_status ss_workspace_open_lookup(skinslide_workspace *workspace, const skinslide_workspace_options *options,
                                          ss_egl_loader load, skinslide_error *error);

#endif
