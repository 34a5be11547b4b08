/* Steps that turn no face over. In the plane of each face at rest, where its corners slide on straight lines, its area is
 * quadratic in the part of the step that is taken: no face may lose more than a share of what it has over the least, which is a
 * share of its area at rest. What that leaves a face is shared with all faces about each vertex, smoothly, so that steps shrink
 * before they must; what is still too far is cut, easing off over the neighbours, and in the end for all vertices alike. */
#include "even.h"

#define FAR    30.0 /* parts of a step beyond which a face has no say */
#define NEAR   1e-6 /* parts that count as no less */
#define ROUNDS 4    /* of cutting */
#define PASSES 10   /* of easing off */
#define EASE   0.1  /* a neighbour may take as much more */

/* ---- One face ---- */

typedef struct moving_point {
    double at[2], by[2];
} moving_point;

static inline moving_point corner_of(const ss_evener *evener, int32_t corner) {
    const double *at = evener->sheet->flat[corner], (*along)[2] = (const double(*)[2])evener->sheet->along[corner];
    int32_t v = evener->sheet->patch->faces.corner_vertex[corner];
    const double *slide = evener->slide[v], *step = evener->step[v];
    moving_point p;
    for (int i = 0; i < 2; i++) {
        p.at[i] = at[i] + along[i][0] * slide[0] + along[i][1] * slide[1];
        p.by[i] = along[i][0] * step[0] + along[i][1] * step[1];
    }
    return p;
}

static inline moving_point from(moving_point origin, moving_point p) {
    for (int i = 0; i < 2; i++)
        p.at[i] -= origin.at[i], p.by[i] -= origin.by[i];
    return p;
}

static inline double cross(const double a[2], const double b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

/* The part of the step at which a face has lost what it may, or more: what makes it larger is left out. Two triangles of the fan
 * have the area between the diagonals of their quad. */
static double face_reach(const ss_evener *evener, int32_t face) {
    int32_t begin = evener->sheet->patch->faces.face_start[face], end = evener->sheet->patch->faces.face_start[face + 1];
    double now = 0, slope = 0, bend = 0, rest = evener->sheet->area[face];
    moving_point origin = corner_of(evener, begin), before = corner_of(evener, begin + 1);
    for (int32_t c = begin + 2; c < end; c += 2) {
        moving_point after = c + 1 < end ? corner_of(evener, c + 1) : origin;
        moving_point p = from(origin, corner_of(evener, c)), q = from(before, after);
        now += cross(p.at, q.at), bend += cross(p.by, q.by);
        slope += cross(p.at, q.by) + cross(p.by, q.at);
        before = after;
    }
    double spare = evener->temper.most_lost * ss_most(now - evener->temper.least_area * rest, 0);
    slope = ss_most(-slope, 0), bend = ss_most(-bend, 0);
    double loss = slope + sqrt(slope * slope + 4 * bend * spare);
    return loss > 0 && rest > 0 ? 2 * spare / loss : INFINITY;
}

/* ---- All of them ---- */

static void fill_parts(ss_evener *evener, double part) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        evener->part[v] = part;
}

static bool is_shorter(const ss_evener *evener, int32_t face) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    for (int32_t c = faces->face_start[face]; c < faces->face_start[face + 1]; c++)
        if (evener->part[faces->corner_vertex[c]] != 1)
            return true;
    return false;
}

/* Takes the parts of the step; faces none of whose corners have a part keep their reaches. */
static void scale_step(ss_evener *evener) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        evener->step[v][0] *= evener->part[v], evener->step[v][1] *= evener->part[v];
    for (int32_t f = 0; f < evener->sheet->patch->faces.face_count; f++)
        if (is_shorter(evener, f))
            evener->reach[f] = face_reach(evener, f);
}

/* Every vertex goes (1 + sum of r^-4)^(-1/4) of its step, r the reaches of the faces there. */
static void share_reaches(ss_evener *evener) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    double *part = evener->part;
    fill_parts(evener, 1);
    for (int32_t f = 0; f < faces->face_count; f++) {
        double reach = evener->reach[f] = face_reach(evener, f);
        if (reach > FAR)
            continue;
        double square = 1 / (ss_most(reach, NEAR) * ss_most(reach, NEAR));
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1]; c++)
            part[faces->corner_vertex[c]] += square * square;
    }
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        part[v] = 1 / sqrt(sqrt(part[v]));
    scale_step(evener);
}

/* Lowers the parts of a face's corners to its reach, where it has less than a step; returns the least reach. */
static double lower_parts(ss_evener *evener) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    double least = 1;
    for (int32_t f = 0; f < faces->face_count; f++) {
        double reach = evener->reach[f];
        least = ss_least(reach, least);
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1] && reach < 1; c++)
            evener->part[faces->corner_vertex[c]] = ss_least(evener->part[faces->corner_vertex[c]], reach);
    }
    return least;
}

static void ease_off(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    for (int pass = 0; pass < PASSES; pass++)
        for (int32_t i = 0; i < sheet->spring_count; i++) {
            double *a = &evener->part[sheet->springs[i].end[0]], *b = &evener->part[sheet->springs[i].end[1]];
            *a = ss_least(*a, *b + EASE), *b = ss_least(*b, *a + EASE);
        }
}

bool ss_shorten_step(ss_evener *evener) {
    share_reaches(evener);
    double least = 0;
    for (int round = 0; round <= ROUNDS; round++) {
        fill_parts(evener, 1);
        least = lower_parts(evener);
        if (least >= 1)
            return round > 0;
        if (round < ROUNDS) {
            ease_off(evener);
            scale_step(evener);
        }
    }
    fill_parts(evener, least);
    scale_step(evener);
    return true;
}
