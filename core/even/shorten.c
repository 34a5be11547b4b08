/* Steps that turn no face over. In the plane of each face at rest, where its corners slide on straight lines, its area is
 * quadratic in the part of the step that is taken: no face may lose more than half of what it has over a tenth of its area at
 * rest. What that leaves a face is shared with all faces about each vertex, smoothly, so that steps shrink before they must;
 * what is still too far is cut, easing off over the neighbours, and in the end for all vertices alike. */
#include "even.h"

#define MOST_LOST  0.5  /* of what a face has over the least, by one step */
#define LEAST_AREA 0.1  /* of that at rest */
#define FAR        30.0 /* parts of a step beyond which a face has no say */
#define NEAR       1e-6 /* parts that count as no less */
#define ROUNDS     4    /* of cutting */
#define PASSES     10   /* of easing off */
#define EASE       0.1  /* a neighbour may take as much more */

/* ---- One face ---- */

typedef struct moving_point {
    double at[2], by[2];
} moving_point;

static moving_point corner_of(const ss_sheet *sheet, int32_t corner, const double (*slide)[2], const double (*step)[2]) {
    const ss_flat_corner *own = &sheet->corner[corner];
    int32_t v = sheet->patch->faces.corner_vertex[corner];
    moving_point p;
    for (int i = 0; i < 2; i++) {
        p.at[i] = own->at[i] + own->along[i][0] * slide[v][0] + own->along[i][1] * slide[v][1];
        p.by[i] = own->along[i][0] * step[v][0] + own->along[i][1] * step[v][1];
    }
    return p;
}

static moving_point from(moving_point origin, moving_point p) {
    for (int i = 0; i < 2; i++)
        p.at[i] -= origin.at[i], p.by[i] -= origin.by[i];
    return p;
}

static double cross(const double a[2], const double b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

/* The part of the step at which a face has lost what it may, or more: what makes it larger is left out. */
static double face_reach(const ss_sheet *sheet, int32_t face, const double (*slide)[2], const double (*step)[2]) {
    const int32_t *start = sheet->patch->faces.face_start;
    double now = 0, slope = 0, bend = 0;
    moving_point origin = corner_of(sheet, start[face], slide, step);
    moving_point p = from(origin, corner_of(sheet, start[face] + 1, slide, step));
    for (int32_t c = start[face] + 2; c < start[face + 1]; c++) {
        moving_point q = from(origin, corner_of(sheet, c, slide, step));
        now += cross(p.at, q.at), bend += cross(p.by, q.by);
        slope += cross(p.at, q.by) + cross(p.by, q.at);
        p = q;
    }
    double spare = MOST_LOST * fmax(0, now - LEAST_AREA * sheet->area[face]);
    slope = fmax(0, -slope), bend = fmax(0, -bend);
    double loss = slope + sqrt(slope * slope + 4 * bend * spare);
    return loss > 0 && sheet->area[face] > 0 ? 2 * spare / loss : INFINITY;
}

/* ---- All of them ---- */

static void scale_steps(const ss_sheet *sheet, double (*step)[2], const double *part) {
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        step[v][0] *= part[v], step[v][1] *= part[v];
}

/* Every step by (1 + sum of r^-4)^(-1/4), r the reaches of the faces at its vertex. */
static void share_reaches(const ss_sheet *sheet, const double (*slide)[2], double (*step)[2], double *part) {
    const ss_faces *faces = &sheet->patch->faces;
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        part[v] = 1;
    for (int32_t f = 0; f < faces->face_count; f++) {
        double reach = face_reach(sheet, f, slide, (const double(*)[2])step);
        if (reach > FAR)
            continue;
        double square = 1 / (fmax(reach, NEAR) * fmax(reach, NEAR));
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1]; c++)
            part[faces->corner_vertex[c]] += square * square;
    }
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        part[v] = 1 / sqrt(sqrt(part[v]));
    scale_steps(sheet, step, part);
}

/* Lowers the parts of a face's corners to its reach, where it has less than a step; returns the least reach. */
static double lower_parts(const ss_sheet *sheet, const double (*slide)[2], const double (*step)[2], double *part) {
    const ss_faces *faces = &sheet->patch->faces;
    double least = 1;
    for (int32_t f = 0; f < faces->face_count; f++) {
        double reach = face_reach(sheet, f, slide, step);
        least = fmin(least, reach);
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1] && reach < 1; c++)
            part[faces->corner_vertex[c]] = fmin(part[faces->corner_vertex[c]], reach);
    }
    return least;
}

static void ease_off(const ss_sheet *sheet, double *part) {
    for (int pass = 0; pass < PASSES; pass++)
        for (int32_t i = 0; i < sheet->spring_count; i++) {
            double *a = &part[sheet->springs[i].end[0]], *b = &part[sheet->springs[i].end[1]];
            *a = fmin(*a, *b + EASE), *b = fmin(*b, *a + EASE);
        }
}

bool ss_shorten_steps(const ss_sheet *sheet, const double (*slide)[2], double (*step)[2], double *part) {
    share_reaches(sheet, slide, step, part);
    double least = 0;
    for (int round = 0; round <= ROUNDS; round++) {
        for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
            part[v] = 1;
        least = lower_parts(sheet, slide, (const double(*)[2])step, part);
        if (least >= 1)
            return round > 0;
        if (round < ROUNDS) {
            ease_off(sheet, part);
            scale_steps(sheet, step, part);
        }
    }
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++)
        part[v] = least;
    scale_steps(sheet, step, part);
    return true;
}
