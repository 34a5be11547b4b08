/* Faces of the slid patch must not turn over. Two areas tell: that of the face as seen along the normals of the surface where
 * its vertices are, and that of the face in the chart. An energy keeps the first from coming near zero, and steps that would
 * take either there are cut back. Both are measured by what they are in the cache; faces with none there are let alone. */
#include "relax.h"

#define LOW_AREA   0.2  /* where the energy sets in */
#define LEAST_AREA 0.01 /* where a face counts as turned over */
#define STIFFNESS  0.1

static const int32_t *corners_of(const ss_relaxer *relaxer, int32_t face, int32_t *count) {
    const ss_faces *faces = &relaxer->surface->patch->faces;
    *count = ss_fan_size(faces, face) + 2;
    return faces->corner_vertex + faces->face_start[face];
}

/* Along the mean of the normals at the corners, normal. */
static double face_area(const ss_relaxer *relaxer, int32_t face, const ss_stand *stands, double normal[3]) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    double area[3] = {0, 0, 0}, p[3], q[3], product[3];
    normal[0] = normal[1] = normal[2] = 0;
    for (int32_t k = 0; k < count; k++)
        ss_add(1, stands[v[k]].normal, normal);
    ss_normalise(normal);
    for (int32_t k = 1; k + 1 < count; k++) {
        ss_subtract(stands[v[k]].place, stands[v[0]].place, p);
        ss_subtract(stands[v[k + 1]].place, stands[v[0]].place, q);
        ss_cross(p, q, product);
        ss_add(0.5, product, area);
    }
    return ss_dot(area, normal);
}

static double chart_area(const ss_relaxer *relaxer, int32_t face, const ss_stand *stands) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    const double *first = stands[v[0]].uv;
    double area = 0;
    for (int32_t k = 1; k + 1 < count; k++) {
        const double *p = stands[v[k]].uv, *q = stands[v[k + 1]].uv;
        area += 0.5 * ((p[0] - first[0]) * (q[1] - first[1]) - (p[1] - first[1]) * (q[0] - first[0]));
    }
    return area;
}

void ss_measure_cache(ss_relaxer *relaxer) {
    double normal[3];
    for (int32_t f = 0; f < relaxer->surface->patch->faces.face_count; f++) {
        relaxer->cache_area[f] = face_area(relaxer, f, relaxer->now, normal);
        relaxer->cache_chart_area[f] = chart_area(relaxer, f, relaxer->now);
        relaxer->area[f] = 1;
    }
}

/* ---- Cutting back ---- */

static bool turned_over(ss_relaxer *relaxer, int32_t face) {
    double normal[3], cache = relaxer->cache_area[face], cache_chart = relaxer->cache_chart_area[face];
    relaxer->trial_area[face] = cache > 0 ? face_area(relaxer, face, relaxer->trial, normal) / cache : 1;
    return relaxer->trial_area[face] < LEAST_AREA ||
           (cache_chart > 0 && chart_area(relaxer, face, relaxer->trial) < LEAST_AREA * cache_chart);
}

/* Six times half the step, then none. Returns whether anything was left to cut. */
static bool cut_face(ss_relaxer *relaxer, int32_t face, int round) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    bool any = false;
    for (int32_t k = 0; k < count; k++) {
        if (relaxer->surface->patch->fixed[v[k]] || relaxer->part[v[k]] == 0)
            continue;
        relaxer->part[v[k]] = round < 6 ? relaxer->part[v[k]] / 2 : 0;
        ss_walk_trial(relaxer, v[k]);
        any = true;
    }
    return any;
}

/* Ends, since each round leaves fewer vertices to move. */
void ss_cut_back(ss_relaxer *relaxer) {
    bool any = true;
    for (int round = 0; any; round++) {
        any = false;
        for (int32_t f = 0; f < relaxer->surface->patch->faces.face_count; f++)
            if (turned_over(relaxer, f))
                any |= cut_face(relaxer, f, round);
    }
}

/* ---- The energy: c (r - low)^2 log(low / r) of each area r ---- */

double ss_fold_energy(const ss_relaxer *relaxer, const double *area) {
    double sum = 0;
    for (int32_t f = 0; f < relaxer->surface->patch->faces.face_count; f++) {
        double r = area[f];
        if (r < LOW_AREA)
            sum += r > 0 ? STIFFNESS * (r - LOW_AREA) * (r - LOW_AREA) * log(LOW_AREA / r) : INFINITY;
    }
    return sum;
}

/* One corner of a face: d1 and d2 are the halved derivatives of its energy by r. The corners of a face are coupled through its
 * area; count times their own blocks bounds that from above, and keeps the pattern. */
static void add_corner(ss_relaxer *relaxer, int32_t unknown, const double (*axis)[3], const double gradient[3], double d1,
                       double d2, int32_t count) {
    double *own = ss_blocks_own(relaxer->blocks, unknown), slope[2];
    for (int j = 0; j < 2; j++)
        slope[j] = ss_dot(axis[j], gradient);
    for (int j = 0; j < 2; j++) {
        relaxer->blocks->right[unknown][j] -= d1 * slope[j];
        for (int k = 0; k < 2; k++)
            own[2 * j + k] += count * d2 * slope[j] * slope[k];
    }
}

static void add_face(ss_relaxer *relaxer, int32_t face) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    double r = relaxer->area[face], off = r - LOW_AREA, log_r = log(r / LOW_AREA), normal[3], across[3], gradient[3];
    double d1 = 0.5 * STIFFNESS * (-2 * off * log_r - off * off / r);
    double d2 = 0.5 * STIFFNESS * (-2 * log_r - 4 * off / r + off * off / (r * r));
    face_area(relaxer, face, relaxer->now, normal);
    for (int32_t k = 0; k < count; k++) {
        int32_t unknown = ss_blocks_unknown(relaxer->blocks, v[k]);
        if (unknown < 0)
            continue;
        ss_subtract(relaxer->now[v[(k + 1) % count]].place, relaxer->now[v[(k + count - 1) % count]].place, across);
        ss_cross(across, normal, gradient);
        for (int j = 0; j < 3; j++)
            gradient[j] *= 0.5 / relaxer->cache_area[face];
        add_corner(relaxer, unknown, (const double(*)[3])relaxer->axis[v[k]], gradient, d1, d2, count);
    }
}

void ss_fold_model(ss_relaxer *relaxer) {
    for (int32_t f = 0; f < relaxer->surface->patch->faces.face_count; f++)
        if (relaxer->area[f] < LOW_AREA)
            add_face(relaxer, f);
}

/* ---- The result ---- */

int32_t ss_count_turned(ss_relaxer *relaxer, const ss_location *locations) {
    const ss_surface *surface = relaxer->surface;
    int32_t turned = 0;
    for (int32_t i = 0; i < surface->patch->free_count; i++) {
        double *uv = relaxer->now[surface->patch->free_vertex[i]].uv;
        const double *own = relaxer->chart[surface->patch->free_vertex[i]], *there = locations[i].uv;
        for (int k = 0; k < 2; k++)
            uv[k] = locations[i].face == SS_STAYS ? own[k] : there[k];
    }
    for (int32_t f = 0; f < surface->patch->faces.face_count; f++)
        turned += relaxer->cache_chart_area[f] > 0 && chart_area(relaxer, f, relaxer->now) <= 0;
    return turned;
}
