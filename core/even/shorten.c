/* Shortens steps so that they turn no face over. In the plane of each face at rest, its corners slide on straight lines, so
 * that its area is quadratic in the part of the step that is taken. No face may lose more than a share of what it has over the
 * least, which is a share of its area at rest; the part at which it does is its reach. First, each vertex's part is a smooth
 * function of the reaches around it, so that steps shrink before they must. A face that would still lose too much then cuts the
 * steps at its corners, less from neighbour to neighbour, so that one bad finger does not stop the knee; only in the end are
 * all vertices cut alike. At half and at twice of FAR, NEAR, ROUNDS and PASSES, the examples elbow, sleeve and face lose the
 * same stretch, to a thousandth. */
#include "even.h"

#define FAR    30.0 /* a face with a larger reach has no effect: it would shorten a step by less than a millionth */
#define NEAR   1e-6 /* smaller reaches count as this, whose powers are finite */
#define ROUNDS 4    /* of cutting, before all vertices are cut alike */
#define PASSES 10   /* of easing off, at most 1 / EASE: as many edges lie between parts of 0 and of 1 */
#define EASE   0.1 /* how much more of its step a neighbour may take; at half, a face moves 1.4 times as roughly as its cache */

/* ---- Some faces ---- */

enum { AT_ONCE = 256 };

/* What some faces have to spare, and how much of it a part of the step takes: slope part + bend part^2, of which terms that
 * enlarge the face are left out. reach is the part that takes all there is to spare. */
typedef struct losses {
    int32_t count, face[AT_ONCE];
    double spare[AT_ONCE], slope[AT_ONCE], bend[AT_ONCE], reach[AT_ONCE];
} losses;

static inline void subtract(const ss_pair a[3], const ss_pair b[3], ss_pair out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* The area of a face as seen along its normal, and the slope and bend with which it grows. Two triangles of the fan at a time:
 * the area of their quad is half the cross product of its diagonals. */
static inline void measure(const ss_evener *evener, int32_t face, double *area, double *slope, double *bend) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    const int32_t *v = faces->corner_vertex + faces->face_start[face];
    int32_t count = faces->face_start[face + 1] - faces->face_start[face];
    const double *n = evener->sheet->normal[face];
    const ss_pair(*corner)[3] = (const ss_pair(*)[3])evener->straight, *origin = corner[v[0]];
    ss_pair areas = {0, 0}, slopes = {0, 0};
    for (int32_t c = 2; c < count; c += 2) {
        ss_pair p[3], q[3];
        subtract(corner[v[c]], origin, p);
        subtract(c + 1 < count ? corner[v[c + 1]] : origin, corner[v[c - 1]], q);
        for (int k = 0; k < 3; k++) {
            ss_pair across = n[(k + 1) % 3] * p[(k + 2) % 3] - n[(k + 2) % 3] * p[(k + 1) % 3];
            areas += across * q[k];
            slopes += across * (ss_pair){q[k][1], q[k][0]};
        }
    }
    *area = areas[0], *slope = slopes[0] + slopes[1], *bend = areas[1];
}

/* Finds what the listed faces have to spare and lose. A face without area at rest has no normal, and loses nothing. The second
 * loop has no branch, since a processor cannot predict whether a face grows or shrinks. */
static void find_losses(const ss_evener *evener, losses *l) {
    const ss_caution caution = evener->caution;
    const int32_t count = l->count;
    double least[AT_ONCE];
    for (int32_t i = 0; i < count; i++) {
        measure(evener, l->face[i], &l->spare[i], &l->slope[i], &l->bend[i]);
        least[i] = caution.least_area * evener->sheet->area[l->face[i]];
    }
    for (int32_t i = 0; i < count; i++) {
        l->spare[i] = caution.most_lost * ss_most(l->spare[i] - least[i], 0);
        l->slope[i] = ss_most(-l->slope[i], 0), l->bend[i] = ss_most(-l->bend[i], 0);
    }
}

/* Takes faces off the list that can spare this part of the step, and finds the reaches of the others. */
static void find_reaches(losses *l, double part) {
    int32_t count = 0;
    for (int32_t i = 0; i < l->count; i++) {
        bool spares = l->slope[i] * part + l->bend[i] * part * part <= l->spare[i];
        l->face[count] = l->face[i], l->spare[count] = l->spare[i];
        l->slope[count] = l->slope[i], l->bend[count] = l->bend[i];
        count += !spares;
    }
    l->count = count;
    for (int32_t i = 0; i < count; i++)
        l->reach[i] = 2 * l->spare[i] / (l->slope[i] + sqrt(l->slope[i] * l->slope[i] + 4 * l->bend[i] * l->spare[i]));
}

/* ---- All of them ---- */

static void fill_parts(ss_evener *evener, double part) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        evener->part[v] = part;
}

static bool is_shorter(const ss_evener *evener, int32_t face) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    bool shorter = false;
    for (int32_t c = faces->face_start[face]; c < faces->face_start[face + 1]; c++)
        shorter |= evener->part[faces->corner_vertex[c]] != 1;
    return shorter;
}

static void set_straight(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    for (int32_t v = 0; v < sheet->patch->vertex_count; v++) {
        ss_pair first = {evener->slide[v][0], evener->step[v][0]}, second = {evener->slide[v][1], evener->step[v][1]};
        for (int k = 0; k < 3; k++)
            evener->straight[v][k] = (ss_pair){sheet->ground.pose.point[v][k], 0} + sheet->tangent[v][0][k] * first +
                                     sheet->tangent[v][1][k] * second;
    }
}

static void take_parts(ss_evener *evener) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++) {
        if (evener->part[v] == 1)
            continue;
        for (int j = 0; j < 2; j++)
            evener->step[v][j] *= evener->part[v];
        for (int k = 0; k < 3; k++)
            evener->straight[v][k][1] *= evener->part[v];
    }
}

/* Scales the step by the parts, and finds reaches anew where a corner is shortened. Returns the least of all. */
static double scale_step(ss_evener *evener) {
    int32_t faces = evener->sheet->patch->faces.face_count;
    double least = 1;
    losses l;
    take_parts(evener);
    for (int32_t f = 0; f < faces;) {
        for (l.count = 0; f < faces && l.count < AT_ONCE; f++) {
            if (is_shorter(evener, f))
                l.face[l.count++] = f, evener->reach[f] = 1;
            else
                least = ss_least(evener->reach[f], least);
        }
        find_losses(evener, &l);
        find_reaches(&l, 1);
        for (int32_t i = 0; i < l.count; i++)
            evener->reach[l.face[i]] = l.reach[i], least = ss_least(l.reach[i], least);
    }
    return least;
}

/* Leaves each vertex (1 + sum of r^-4)^(-1/4) of its step, r the reaches of its faces. Returns the least reach after that. */
static double share_reaches(ss_evener *evener) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    double *part = evener->part;
    losses l;
    set_straight(evener);
    fill_parts(evener, 1);
    for (int32_t f = 0; f < faces->face_count;) {
        for (l.count = 0; f < faces->face_count && l.count < AT_ONCE; f++)
            l.face[l.count++] = f, evener->reach[f] = 1;
        find_losses(evener, &l);
        find_reaches(&l, FAR);
        for (int32_t i = 0; i < l.count; i++) {
            double reach = ss_most(l.reach[i], NEAR), square = 1 / (reach * reach);
            for (int32_t c = faces->face_start[l.face[i]]; c < faces->face_start[l.face[i] + 1]; c++)
                part[faces->corner_vertex[c]] += square * square;
        }
    }
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        if (part[v] != 1)
            part[v] = 1 / sqrt(sqrt(part[v]));
    return scale_step(evener);
}

/* Lowers the parts of a face's corners to its reach, if that is less than the whole step. */
static void lower_parts(ss_evener *evener) {
    const ss_faces *faces = &evener->sheet->patch->faces;
    fill_parts(evener, 1);
    for (int32_t f = 0; f < faces->face_count; f++) {
        double reach = evener->reach[f];
        for (int32_t c = faces->face_start[f]; c < faces->face_start[f + 1] && reach < 1; c++)
            evener->part[faces->corner_vertex[c]] = ss_least(evener->part[faces->corner_vertex[c]], reach);
    }
}

/* Lowers the part of a spring's end that is too far above the other's. */
static inline bool ease(const ss_spring *spring, double *part) {
    double *a = &part[spring->end[0]], *b = &part[spring->end[1]];
    if (*a > *b + EASE)
        *a = *b + EASE;
    else if (*b > *a + EASE)
        *b = *a + EASE;
    else
        return false;
    return true;
}

/* Over the springs and back, until nothing is left to lower. */
static void ease_off(ss_evener *evener) {
    const ss_spring *springs = evener->sheet->springs;
    int32_t count = evener->sheet->spring_count;
    bool eased = true;
    for (int pass = 0; pass < PASSES && eased; pass++) {
        eased = false;
        for (int32_t i = 0; i < count; i++)
            eased |= ease(&springs[pass % 2 ? count - 1 - i : i], evener->part);
    }
}

bool ss_shorten_step(ss_evener *evener, ss_caution caution) {
    evener->caution = caution;
    double least = share_reaches(evener);
    for (int round = 0; round < ROUNDS; round++) {
        if (least >= 1)
            return round > 0;
        lower_parts(evener);
        ease_off(evener);
        least = scale_step(evener);
    }
    if (least < 1) {
        fill_parts(evener, least);
        scale_step(evener);
    }
    return true;
}
