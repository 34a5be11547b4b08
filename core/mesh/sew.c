/* Sews faces of patches together where a side of one and a side of another run between the same two places, opposite ways: ends
 * of the sides are then one, and no other points of a place are, so that the welded patch has no edge of three faces and no
 * vertex that only points touch at. Points off the patches follow if all points of the patches in their place are one. */
#include "mesh.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* A side between two places. */
typedef struct seam_side {
    int32_t low, high;   /* places */
    int32_t vertices[2]; /* at low, at high */
    int32_t face;
    bool upwards; /* the face goes from low to high */
} seam_side;

typedef struct sewing {
    const ss_seams *seams;
    int32_t side_count;
    seam_side *sides; /* [corner_count] */
    int32_t *face;    /* [vertex_count] by place: 1 + the last face with a corner there */
    int32_t *vertex;  /* [vertex_count] by place: that corner; then the root of the patches' points there, -2 for several */
    int32_t *one;     /* [vertex_count] a forest */
    ss_sewn *sewn;
} sewing;

__attribute__((format(printf, 3, 4))) static void refuse(sewing *s, int32_t place, const char *format, ...);

static void refuse(sewing *s, int32_t place, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (!*s->sewn->why)
        vsnprintf(s->sewn->why, sizeof s->sewn->why, format, arguments);
    va_end(arguments);
    s->sewn->refused[place] = 1;
}

/* Refuses places in which a face has two corners: welding would collapse an edge, or fold the face. */
static void refuse_folded_faces(sewing *s) {
    const ss_seams *seams = s->seams;
    for (int32_t c = 0; c < seams->corner_count; c++) {
        const ss_seam_corner *own = &seams->corners[c];
        int32_t place = seams->place[own->vertex];
        if (s->face[place] == own->face + 1 && s->vertex[place] != own->vertex)
            refuse(s, place, "vertices %d and %d are both corners of face %d", s->vertex[place], own->vertex, own->face);
        s->face[place] = own->face + 1, s->vertex[place] = own->vertex;
    }
}

static int by_places(const void *a, const void *b) {
    const seam_side *x = a, *y = b;
    if (x->low != y->low)
        return ss_ascending(&x->low, &y->low);
    return x->high != y->high ? ss_ascending(&x->high, &y->high) : ss_ascending(&x->face, &y->face);
}

static void list_sides(sewing *s) {
    const int32_t *place = s->seams->place;
    for (int32_t c = 0; c < s->seams->corner_count; c++) {
        const ss_seam_corner *own = &s->seams->corners[c];
        if (place[own->vertex] == place[own->next])
            continue;
        bool upwards = place[own->vertex] < place[own->next];
        int32_t low = upwards ? own->vertex : own->next, high = upwards ? own->next : own->vertex;
        s->sides[s->side_count++] = (seam_side){place[low], place[high], {low, high}, own->face, upwards};
    }
    qsort(s->sides, (size_t)s->side_count, sizeof *s->sides, by_places);
}

/* The end of the sides that run between the same places as the first. */
static int32_t end_of_sides(const sewing *s, int32_t first) {
    int32_t end = first + 1;
    while (end < s->side_count && s->sides[end].low == s->sides[first].low && s->sides[end].high == s->sides[first].high)
        end++;
    return end;
}

/* Refuses places between which more than two faces have sides, as in a doubled sheet, since nothing says which belong together;
 * and those between which faces are wound alike. */
static void refuse_sides(sewing *s) {
    for (int32_t i = 0, end; i < s->side_count; i = end) {
        const seam_side *first = &s->sides[i], *second = first + 1;
        end = end_of_sides(s, i);
        if (end - i < 2 || (end - i == 2 && first->upwards != second->upwards))
            continue;
        for (int k = 0; k < 2; k++)
            if (end - i > 2)
                refuse(s, k ? first->high : first->low, "edge %d-%d would have %d faces", first->vertices[0],
                       first->vertices[1], end - i);
            else
                refuse(s, k ? first->high : first->low, "faces %d and %d are wound against each other along edge %d-%d",
                       first->face, second->face, first->vertices[0], first->vertices[1]);
    }
}

static void join_sides(sewing *s) {
    for (int32_t i = 0, end; i < s->side_count; i = end) {
        const seam_side *own = &s->sides[i];
        end = end_of_sides(s, i);
        for (int k = 0; k < 2 && end - i == 2; k++)
            if (!s->sewn->refused[own->low] && !s->sewn->refused[own->high])
                ss_join(s->one, own[0].vertices[k], own[1].vertices[k]);
    }
}

/* Points off the patches join those of the patches in their place, if these are one. */
static void join_followers(sewing *s) {
    const ss_seams *seams = s->seams;
    for (int32_t v = 0; v < seams->vertex_count; v++)
        s->vertex[v] = -1;
    for (int32_t i = 0; i < seams->shared_count; i++) {
        int32_t v = seams->shared[i], *root = &s->vertex[seams->place[v]];
        if (seams->in_patch[v])
            *root = *root == -1 || *root == ss_root(s->one, v) ? ss_root(s->one, v) : -2;
    }
    for (int32_t i = 0; i < seams->shared_count; i++) {
        int32_t v = seams->shared[i], place = seams->place[v];
        if (!seams->in_patch[v] && s->vertex[place] >= 0 && !s->sewn->refused[place])
            ss_join(s->one, v, s->vertex[place]);
    }
}

/* The vertex that stands for each set: its lowest vertex of a patch. Uses s->vertex as scratch. */
static void write_vertices(sewing *s) {
    int32_t *out = s->sewn->vertex;
    const ss_seams *seams = s->seams;
    for (int32_t v = 0; v < seams->vertex_count; v++)
        out[v] = v, s->vertex[v] = -1;
    for (int32_t i = 0; i < seams->shared_count; i++) {
        int32_t v = seams->shared[i], *lowest = &s->vertex[ss_root(s->one, v)];
        if (seams->in_patch[v] && *lowest < 0)
            *lowest = v;
    }
    for (int32_t i = 0; i < seams->shared_count; i++) {
        int32_t v = seams->shared[i], lowest = s->vertex[ss_root(s->one, v)];
        out[v] = lowest >= 0 ? lowest : v;
    }
}

bool ss_sew(const ss_seams *seams, ss_sewn *out) {
    *out = (ss_sewn){0};
    ss_memory scratch = {0};
    sewing s = {.seams = seams, .sewn = out};
    out->vertex = SS_NEW(&out->memory, int32_t, seams->vertex_count);
    out->refused = SS_NEW(&out->memory, uint8_t, seams->vertex_count);
    s.sides = SS_NEW(&scratch, seam_side, seams->corner_count);
    s.face = SS_NEW(&scratch, int32_t, seams->vertex_count);
    s.vertex = SS_NEW(&scratch, int32_t, seams->vertex_count);
    s.one = SS_NEW(&scratch, int32_t, seams->vertex_count);
    bool done = !scratch.failed && !out->memory.failed;
    for (int32_t v = 0; done && v < seams->vertex_count; v++)
        s.one[v] = v;
    if (done) {
        refuse_folded_faces(&s);
        list_sides(&s);
        refuse_sides(&s);
        join_sides(&s);
        join_followers(&s);
        write_vertices(&s);
    }
    ss_free(&scratch);
    return done;
}
