/* Faces of the slid patch must not turn over in the chart. An energy keeps their areas there from coming near zero, and steps
 * are shortened so that none loses most of what it has. Faces that have no area at rest are let alone. */
#include "relax.h"

#define LOW_AREA   0.2 /* of that at rest, where the energy sets in */
#define STIFFNESS  0.1
#define LEAST_AREA 0.01 /* of that at rest, which steps never take a face to */
#define LEAST_KEPT 0.2  /* by one step, of what a face has more than that */

static const int32_t *corners_of(const ss_relaxer *relaxer, int32_t face, int32_t *count) {
    const ss_faces *faces = &relaxer->chart->patch->faces;
    *count = ss_fan_size(faces, face) + 2;
    return faces->corner_vertex + faces->face_start[face];
}

static double area_now(const ss_relaxer *relaxer, int32_t face) {
    return ss_chart_area(relaxer->chart, face, (const double(*)[2])relaxer->uv);
}

/* ---- The energy: c (r - low)^2 log(low / r) of each area r, as a share of that at rest ---- */

/* One corner of a face: d1 and d2 are the halved derivatives of its energy by r. The corners of a face are coupled through its
 * area; count times their own blocks bounds that from above, and keeps the pattern. */
static void add_corner(ss_relaxer *relaxer, int32_t vertex, const double gradient[2], double d1, double d2, int32_t count) {
    int32_t unknown = ss_blocks_unknown(relaxer->blocks, vertex);
    if (unknown < 0)
        return;
    double *own = ss_blocks_own(relaxer->blocks, unknown), slope[2];
    for (int j = 0; j < 2; j++)
        slope[j] = relaxer->way[vertex][j][0] * gradient[0] + relaxer->way[vertex][j][1] * gradient[1];
    for (int j = 0; j < 2; j++) {
        relaxer->blocks->right[unknown][j] -= d1 * slope[j];
        for (int k = 0; k < 2; k++)
            own[2 * j + k] += count * d2 * slope[j] * slope[k];
    }
}

static void add_face(ss_relaxer *relaxer, int32_t face, double r) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    double off = r - LOW_AREA, log_r = log(r / LOW_AREA), half = 0.5 / relaxer->chart->area[face];
    double d1 = 0.5 * STIFFNESS * (-2 * off * log_r - off * off / r);
    double d2 = 0.5 * STIFFNESS * (-2 * log_r - 4 * off / r + off * off / (r * r));
    for (int32_t k = 0; k < count; k++) {
        const double *next = relaxer->uv[v[(k + 1) % count]], *last = relaxer->uv[v[(k + count - 1) % count]];
        double gradient[2] = {half * (next[1] - last[1]), half * (last[0] - next[0])};
        add_corner(relaxer, v[k], gradient, d1, d2, count);
    }
}

void ss_fold_model(ss_relaxer *relaxer) {
    for (int32_t f = 0; f < relaxer->chart->patch->faces.face_count; f++) {
        double rest = relaxer->chart->area[f], r = rest > 0 ? area_now(relaxer, f) / rest : 1;
        if (r > 0 && r < LOW_AREA)
            add_face(relaxer, f, r);
    }
}

/* ---- Shorter steps ---- */

static double cross(const double a[2], const double b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

/* How much of the steps a face can take and surely keep its least share. Its area is quadratic in that; what makes it larger is
 * left out, since where that only just saves a face the first root of the area is not continuous. */
static double face_reach(const ss_relaxer *relaxer, int32_t face) {
    int32_t count;
    const int32_t *v = corners_of(relaxer, face, &count);
    double now = 0, slope = 0, bend = 0;
    for (int32_t k = 1; k + 1 < count; k++) {
        double p[2], q[2], dp[2], dq[2];
        for (int j = 0; j < 2; j++) {
            p[j] = relaxer->uv[v[k]][j] - relaxer->uv[v[0]][j], q[j] = relaxer->uv[v[k + 1]][j] - relaxer->uv[v[0]][j];
            dp[j] = relaxer->step[v[k]][j] - relaxer->step[v[0]][j];
            dq[j] = relaxer->step[v[k + 1]][j] - relaxer->step[v[0]][j];
        }
        now += cross(p, q), slope += cross(p, dq) + cross(dp, q), bend += cross(dp, dq);
    }
    if (!(now > 0) || !(relaxer->chart->area[face] > 0))
        return INFINITY;
    now = (1 - LEAST_KEPT) * fmax(0, now - 2 * LEAST_AREA * relaxer->chart->area[face]);
    slope = fmax(0, -slope), bend = fmax(0, -bend);
    return 2 * now / (slope + sqrt(slope * slope + 4 * bend * now));
}

/* Each vertex goes about as far as its faces let all go together, (1 + sum r^-4)^-1/4 of the step: a smooth minimum of the
 * whole and of the r of its faces. Then all go as far as the shortened steps let them. */
void ss_limit_steps(ss_relaxer *relaxer) {
    const ss_patch *patch = relaxer->chart->patch;
    double all = 1;
    for (int32_t v = 0; v < patch->vertex_count; v++)
        relaxer->reach[v] = 1;
    for (int32_t f = 0; f < patch->faces.face_count; f++) {
        int32_t count;
        const int32_t *v = corners_of(relaxer, f, &count);
        double reach = face_reach(relaxer, f);
        for (int32_t k = 0; k < count; k++)
            relaxer->reach[v[k]] += 1 / (reach * reach * reach * reach);
    }
    for (int32_t v = 0; v < patch->vertex_count; v++) {
        double part = 1 / sqrt(sqrt(relaxer->reach[v]));
        relaxer->step[v][0] *= part, relaxer->step[v][1] *= part;
    }
    for (int32_t f = 0; f < patch->faces.face_count; f++)
        all = fmin(all, face_reach(relaxer, f));
    for (int32_t v = 0; v < patch->vertex_count; v++)
        relaxer->step[v][0] *= all, relaxer->step[v][1] *= all;
}

bool ss_has_turned(const ss_relaxer *relaxer, int32_t face) {
    double rest = relaxer->chart->area[face];
    return rest > 0 && area_now(relaxer, face) < 0.5 * LEAST_AREA * rest;
}

/* ---- The result ---- */

int32_t ss_count_turned(ss_relaxer *relaxer, const ss_place *places) {
    const ss_patch *patch = relaxer->chart->patch;
    int32_t turned = 0;
    for (int32_t i = 0; i < patch->free_count; i++) {
        double *uv = relaxer->uv[patch->free_vertex[i]];
        uv[0] = places[i].uv[0], uv[1] = places[i].uv[1];
    }
    for (int32_t f = 0; f < patch->faces.face_count; f++)
        turned += relaxer->chart->area[f] > 0 && area_now(relaxer, f) <= 0;
    return turned;
}
