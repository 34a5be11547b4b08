/* What a slide did, vertex by vertex, for maps and primvars that artists look at. With e over the edges at vertex v that are of
 * a patch, each once whatever patches it is in, and paint k_e:
 *
 *     stretch(v) = sqrt(mean of log^2(length_e / rest length_e))     the report's measure, about one vertex
 *     slide(v)   = |slid(v) - cached(v)|
 *     density(v) = mean of k_e over the edges of a patch; where patches overlap, the mean of theirs
 */
#include "slide.h"

#include <math.h>

/* Sums of one mesh vertex. */
typedef struct tally {
    double before, after; /* of log^2 over its edges */
    double density;       /* of its means over patches */
    int32_t edge_count, patch_count;
} tally;

typedef struct diagnosis {
    ss_memory memory;
    const skinslide_slider *slider;
    skinslide_controls *controls; /* [setup_count] of the frame; NULL: the set-ups' own */
    const uint8_t *chosen;
    tally *tallies;            /* [vertex_count] */
    double *before, *after;    /* [most edges of a patch] lengths */
    double *own_paint;         /* [most edges] */
    ss_edge_paint *edge_paint; /* [most edges] scratch */
    double *paint_sum;         /* [most vertices] over the edges of one patch */
    int32_t *degree;           /* [most vertices] those edges */
    float *brought[2];         /* [vertex_count][3] points where lengths are taken, if that is not the mesh's space */
} diagnosis;

static bool counts(const diagnosis *d, int32_t part) {
    return !d->chosen || d->chosen[d->slider->parts[part].patch->setup_index];
}

static skinslide_status allocate(diagnosis *d, skinslide_error *error) {
    int32_t most_edges = 0, most_vertices = 0;
    for (int32_t p = 0; p < d->slider->part_count; p++) {
        const ss_patch *patch = d->slider->parts[p].patch;
        most_edges = patch->faces.edge_count > most_edges ? patch->faces.edge_count : most_edges;
        most_vertices = patch->vertex_count > most_vertices ? patch->vertex_count : most_vertices;
    }
    d->tallies = SS_NEW(&d->memory, tally, d->slider->vertex_count);
    d->before = SS_NEW(&d->memory, double, most_edges);
    d->after = SS_NEW(&d->memory, double, most_edges);
    d->own_paint = SS_NEW(&d->memory, double, most_edges);
    d->edge_paint = SS_NEW(&d->memory, ss_edge_paint, most_edges);
    d->paint_sum = SS_NEW(&d->memory, double, most_vertices);
    d->degree = SS_NEW(&d->memory, int32_t, most_vertices);
    for (int k = 0; k < 2 && d->slider->space; k++)
        d->brought[k] = SS_NEW(&d->memory, float, 3 * (int64_t)d->slider->vertex_count);
    return d->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

/* The next patch vertex that is of another mesh vertex: those that one was split into follow each other. */
static int32_t after_split(const ss_patch *patch, int32_t v) {
    int32_t next = v + 1;
    while (next < patch->vertex_count && patch->mesh_vertex[next] == patch->mesh_vertex[v])
        next++;
    return next;
}

static void count_patches(diagnosis *d) {
    for (int32_t p = 0; p < d->slider->part_count; p++) {
        const ss_patch *patch = d->slider->parts[p].patch;
        for (int32_t v = 0; counts(d, p) && v < patch->vertex_count; v = after_split(patch, v))
            d->tallies[patch->mesh_vertex[v]].patch_count++;
    }
}

/* Whether a patch before this one has the edge between two mesh vertices, too. */
static bool counted_before(const diagnosis *d, int32_t part, int32_t first, int32_t second) {
    if (d->tallies[first].patch_count < 2 || d->tallies[second].patch_count < 2)
        return false;
    for (int32_t p = 0; p < part; p++) {
        const ss_patch *patch = d->slider->parts[p].patch;
        if (counts(d, p) && ss_patch_mesh_edge(patch, first, second) >= 0)
            return true;
    }
    return false;
}

static double squared_stretch(double length, double rest) {
    double stretch = ss_log(length / rest);
    return stretch * stretch;
}

static void add_stretch(diagnosis *d, int32_t part, const float *cached, const float *slid) {
    const ss_patch *patch = d->slider->parts[part].patch;
    ss_edge_lengths(patch, cached, d->before);
    ss_edge_lengths(patch, slid, d->after);
    for (int32_t e = 0; e < patch->faces.edge_count; e++) {
        int32_t ends[2] = {patch->mesh_vertex[patch->edge_vertex[e][0]], patch->mesh_vertex[patch->edge_vertex[e][1]]};
        if (counted_before(d, part, ends[0], ends[1]))
            continue;
        for (int k = 0; k < 2; k++) {
            tally *at = &d->tallies[ends[k]];
            at->before += squared_stretch(d->before[e], patch->rest_length[e]);
            at->after += squared_stretch(d->after[e], patch->rest_length[e]);
            at->edge_count++;
        }
    }
}

static void add_density(diagnosis *d, int32_t part) {
    const ss_patch *patch = d->slider->parts[part].patch;
    const double *paint = d->slider->parts[part].paint;
    if (d->controls) {
        ss_paint(patch, &d->controls[patch->setup_index], d->edge_paint, d->own_paint);
        paint = d->own_paint;
    }
    for (int32_t v = 0; v < patch->vertex_count; v++)
        d->paint_sum[v] = 0, d->degree[v] = 0;
    for (int32_t e = 0; e < patch->faces.edge_count; e++)
        for (int k = 0; k < 2; k++) {
            d->paint_sum[patch->edge_vertex[e][k]] += paint[e];
            d->degree[patch->edge_vertex[e][k]]++;
        }
    for (int32_t v = 0, end; v < patch->vertex_count; v = end) {
        double sum = 0, degree = 0;
        end = after_split(patch, v);
        for (int32_t k = v; k < end; k++)
            sum += d->paint_sum[k], degree += d->degree[k];
        d->tallies[patch->mesh_vertex[v]].density += sum / degree;
    }
}

/* What is told of one mesh vertex. */
typedef struct measures {
    float before, after, slide, density;
} measures;

static measures measure(const tally *at, const float *cached, const float *slid, int32_t v) {
    double edges = at->edge_count > 0 ? at->edge_count : 1, way[3];
    for (int k = 0; k < 3; k++) { /* what is not finite passed as it was */
        double from = cached[3 * (int64_t)v + k], to = slid[3 * (int64_t)v + k];
        way[k] = isfinite(from) ? to - from : 0;
    }
    return (measures){
        .before = (float)sqrt(at->before / edges),
        .after = (float)sqrt(at->after / edges),
        .slide = (float)ss_length(way),
        .density = at->patch_count > 0 ? (float)(at->density / at->patch_count) : 1,
    };
}

/* Stretches are logarithms of lengths that floats can say. */
static skinslide_status check_vertex(const measures *own, const skinslide_diagnostics *out, int32_t v, skinslide_error *error) {
    if (out->slide && !isfinite(own->slide))
        return ss_refuse_vertex("slide", v, &own->slide, 1, SKINSLIDE_BAD_POINTS, error);
    if (out->force_density && !isfinite(own->density))
        return ss_refuse_vertex("force density", v, &own->density, 1, SKINSLIDE_BAD_CONTROL, error);
    return SKINSLIDE_OK;
}

static void write_vertex(const measures *own, const skinslide_diagnostics *out, int32_t v) {
    if (out->stretch_before)
        out->stretch_before[v] = own->before;
    if (out->stretch_after)
        out->stretch_after[v] = own->after;
    if (out->slide)
        out->slide[v] = own->slide;
    if (out->force_density)
        out->force_density[v] = own->density;
}

static skinslide_status write(const diagnosis *d, const float *cached, const float *slid, const skinslide_diagnostics *out,
                              skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int32_t v = 0; v < d->slider->vertex_count && !status; v++) {
        measures own = measure(&d->tallies[ss_welded(d->slider, v)], cached, slid, v);
        status = check_vertex(&own, out, v, error);
    }
    for (int32_t v = 0; v < d->slider->vertex_count && !status; v++) {
        measures own = measure(&d->tallies[ss_welded(d->slider, v)], cached, slid, v);
        write_vertex(&own, out, v);
    }
    return status;
}

skinslide_status skinslide_diagnose(const skinslide_slider *slider, const skinslide_controls *controls, const uint8_t *chosen,
                                    const float *cached, const float *slid, const skinslide_diagnostics *diagnostics,
                                    skinslide_error *error) {
    if (!slider || !cached || !slid || !diagnostics)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no slider, points, or place for the diagnostics");
    skinslide_status status = ss_check_reads(slider, cached, "cached points", error);
    if (!status)
        status = ss_check_reads(slider, slid, "slid points", error);
    skinslide_diagnostics out = SKINSLIDE_DIAGNOSTICS_DEFAULT;
    if (!status)
        status = ss_take(diagnostics, "skinslide_diagnostics", &out, sizeof out, error);
    if (status)
        return status;
    diagnosis d = {.slider = slider, .chosen = chosen};
    d.controls = controls ? SS_NEW(&d.memory, skinslide_controls, slider->setup_count) : NULL;
    status = allocate(&d, error);
    if (!status && controls)
        status = ss_take_frame_controls(slider, controls, d.controls, error);
    if (!status)
        count_patches(&d);
    const float *before = cached, *after = slid;
    if (!status)
        ss_bring(slider, &before, d.brought[0]), ss_bring(slider, &after, d.brought[1]);
    for (int32_t p = 0; !status && p < slider->part_count; p++)
        if (counts(&d, p)) {
            add_stretch(&d, p, before, after);
            add_density(&d, p);
        }
    if (!status)
        status = write(&d, cached, slid, &out, error);
    ss_free(&d.memory);
    return status;
}
