/* Distances over a mesh at rest, and the faces that are near others. Ways go straight from corner to corner of a face, and
 * treat points in one place, such as those of a seam, as one point. */
#include "mesh.h"

/* The faces at each place of a mesh. */
typedef struct star {
    int32_t *place;       /* [vertex_count] the lowest vertex in the same place */
    int32_t *face_start;  /* [face_count + 1] */
    int32_t *place_start; /* [vertex_count + 1] */
    int32_t *face;        /* [index_count] of place v from place_start[v] on */
} star;

static void list_faces(const skinslide_mesh *mesh, star *stars, int32_t *next) {
    ss_start_faces(mesh, stars->face_start);
    for (int32_t c = 0; c < mesh->index_count; c++)
        stars->place_start[stars->place[mesh->face_indices[c]] + 1]++;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        next[v] = stars->place_start[v];
        stars->place_start[v + 1] += next[v];
    }
    for (int32_t f = 0; f < mesh->face_count; f++)
        for (int32_t c = stars->face_start[f]; c < stars->face_start[f + 1]; c++)
            stars->face[next[stars->place[mesh->face_indices[c]]]++] = f;
}

static bool list_stars(const skinslide_mesh *mesh, ss_memory *memory, star *stars) {
    int32_t *scratch = SS_NEW(memory, int32_t, mesh->vertex_count);
    stars->place = SS_NEW(memory, int32_t, mesh->vertex_count);
    stars->face_start = SS_NEW(memory, int32_t, (int64_t)mesh->face_count + 1);
    stars->place_start = SS_NEW(memory, int32_t, (int64_t)mesh->vertex_count + 1);
    stars->face = SS_NEW(memory, int32_t, mesh->index_count);
    if (memory->failed || !ss_find_places(mesh->rest_points, 0, mesh->vertex_count, stars->place))
        return false;
    list_faces(mesh, stars, scratch);
    return true;
}

/* Places from which ways may go on, in the order in which they were reached: a ring, with each at most once. */
typedef struct queue {
    int32_t *place; /* [size] */
    uint8_t *waits; /* [size] */
    int32_t size, first, count;
} queue;

static void push(queue *q, int32_t place) {
    if (q->waits[place])
        return;
    q->waits[place] = 1;
    q->place[((int64_t)q->first + q->count++) % q->size] = place;
}

static int32_t pop(queue *q) {
    int32_t place = q->place[q->first];
    q->first = q->first + 1 < q->size ? q->first + 1 : 0, q->count--;
    q->waits[place] = 0;
    return place;
}

/* Continues the ways at a place to all other corners of its faces. */
static void go_on(const skinslide_mesh *mesh, const star *stars, int32_t from, double *left, queue *q) {
    for (int32_t i = stars->place_start[from]; i < stars->place_start[from + 1]; i++)
        for (int32_t c = stars->face_start[stars->face[i]]; c < stars->face_start[stars->face[i] + 1]; c++) {
            int32_t to = stars->place[mesh->face_indices[c]];
            double there = left[from] - ss_distance(mesh->rest_points, from, to);
            if (there >= 0 && there > left[to]) {
                left[to] = there;
                push(q, to);
            }
        }
}

static void spread(const skinslide_mesh *mesh, const star *stars, queue *q, double *left) {
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t place = stars->place[v];
        left[place] = left[v] > left[place] ? left[v] : left[place];
        if (left[place] >= 0)
            push(q, place);
    }
    while (q->count)
        go_on(mesh, stars, pop(q), left, q);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        left[v] = left[stars->place[v]];
}

bool ss_spread(const skinslide_mesh *mesh, double *left) {
    ss_memory scratch = {0};
    star stars = {0};
    queue q = {.size = mesh->vertex_count};
    q.place = SS_NEW(&scratch, int32_t, q.size);
    q.waits = SS_NEW(&scratch, uint8_t, q.size);
    bool done = list_stars(mesh, &scratch, &stars);
    if (done)
        spread(mesh, &stars, &q, left);
    ss_free(&scratch);
    return done;
}

/* ---- Faces ---- */

void ss_start_at(const skinslide_mesh *mesh, const uint8_t *inside, double way, double *left) {
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        left[v] = -1;
    for (int32_t f = 0, c = 0; f < mesh->face_count; f++)
        for (int32_t k = 0; k < mesh->face_counts[f]; k++, c++)
            if (inside[f])
                left[mesh->face_indices[c]] = way;
}

void ss_add_reached(const skinslide_mesh *mesh, const double *left, uint8_t *inside) {
    for (int32_t f = 0, c = 0; f < mesh->face_count; f++) {
        bool reached = mesh->face_counts[f] > 0;
        for (int32_t k = 0; k < mesh->face_counts[f]; k++, c++)
            reached = reached && left[mesh->face_indices[c]] >= 0;
        inside[f] = inside[f] || reached;
    }
}

bool ss_add_near_faces(const skinslide_mesh *mesh, double way, uint8_t *inside) {
    ss_memory scratch = {0};
    double *left = SS_NEW(&scratch, double, mesh->vertex_count);
    if (left)
        ss_start_at(mesh, inside, way, left);
    bool done = left && ss_spread(mesh, left);
    if (done)
        ss_add_reached(mesh, left, inside);
    ss_free(&scratch);
    return done;
}
