/* A tree of boxes around the faces of an embedding, for points that a walk cannot reach. Faces are sorted along a Z-order curve
 * and halved, so that the depth is the logarithm of their number however unevenly they lie, and a patch whose faces crowd
 * together (a finger tip in a circle) cannot stall a frame. */
#include "plane.h"

#include <math.h>
#include <stdlib.h>

enum { LEAF = 4, STACK = 64 };

typedef struct node {
    double low[2], high[2];
    int32_t lowest; /* face in this node */
} node;

typedef struct key {
    uint64_t code;
    int32_t face;
} key;

struct ss_face_tree {
    ss_memory memory;
    const ss_patch *patch;
    const double (*uv)[2];
    key *keys;   /* [face_count] in Z-order */
    key *others; /* [face_count] scratch */
    node *nodes; /* node i has children 2i + 1 and 2i + 2, with half of its keys each */
};

static int32_t node_count(int32_t faces) {
    int32_t nodes = 1;
    for (int32_t width = faces; width > LEAF; width = (width + 1) / 2)
        nodes = 2 * nodes + 1;
    return nodes;
}

skinslide_status ss_face_tree_create(const ss_patch *patch, ss_face_tree **out, skinslide_error *error) {
    ss_face_tree *tree = calloc(1, sizeof *tree);
    if (!tree)
        return ss_out_of_memory(error);
    tree->patch = patch;
    tree->keys = SS_NEW(&tree->memory, key, patch->faces.face_count);
    tree->others = SS_NEW(&tree->memory, key, patch->faces.face_count);
    tree->nodes = SS_NEW(&tree->memory, node, node_count(patch->faces.face_count));
    if (tree->memory.failed) {
        ss_face_tree_destroy(tree);
        return ss_out_of_memory(error);
    }
    *out = tree;
    return SKINSLIDE_OK;
}

void ss_face_tree_destroy(ss_face_tree *tree) {
    if (!tree)
        return;
    ss_free(&tree->memory);
    free(tree);
}

/* ---- Building ---- */

/* Spreads the low 31 bits to the even bits. */
static uint64_t spread(uint64_t bits) {
    bits = (bits | bits << 16) & 0x0000ffff0000ffff;
    bits = (bits | bits << 8) & 0x00ff00ff00ff00ff;
    bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0f;
    bits = (bits | bits << 2) & 0x3333333333333333;
    return (bits | bits << 1) & 0x5555555555555555;
}

static uint64_t quantized(double share) {
    return (uint64_t)((share < 0 ? 0 : share > 1 ? 1 : share) * 2147483647.0);
}

static uint64_t z_order(const ss_face_tree *tree, int32_t face) {
    double sum[2] = {0, 0};
    int32_t begin = tree->patch->faces.face_start[face], end = tree->patch->faces.face_start[face + 1];
    for (int32_t c = begin; c < end; c++)
        for (int k = 0; k < 2; k++)
            sum[k] += tree->uv[tree->patch->faces.corner_vertex[c]][k];
    return spread(quantized(sum[0] / (end - begin))) | spread(quantized(sum[1] / (end - begin))) << 1;
}

/* Sorts by code, byte by byte from the lowest on; keys of one code keep their order. */
static void sort_keys(ss_face_tree *tree) {
    enum { BITS = 8, DIGITS = 1 << BITS };
    int32_t count = tree->patch->faces.face_count;
    for (int shift = 0; shift < 64; shift += BITS) {
        int32_t start[DIGITS + 1] = {0};
        key *from = tree->keys, *to = tree->others;
        for (int32_t i = 0; i < count; i++)
            start[(from[i].code >> shift) % DIGITS + 1]++;
        for (int32_t digit = 0; digit < DIGITS; digit++)
            start[digit + 1] += start[digit];
        for (int32_t i = 0; i < count; i++)
            to[start[(from[i].code >> shift) % DIGITS]++] = from[i];
        tree->keys = to, tree->others = from;
    }
}

static node empty_node(void) {
    return (node){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INT32_MAX};
}

static void add_face(const ss_face_tree *tree, node *box, int32_t face) {
    for (int32_t c = tree->patch->faces.face_start[face]; c < tree->patch->faces.face_start[face + 1]; c++)
        for (int k = 0; k < 2; k++) {
            double x = tree->uv[tree->patch->faces.corner_vertex[c]][k];
            box->low[k] = x < box->low[k] ? x : box->low[k];
            box->high[k] = x > box->high[k] ? x : box->high[k];
        }
    box->lowest = face < box->lowest ? face : box->lowest;
}

static void add_node(node *box, const node *part) {
    for (int k = 0; k < 2; k++) {
        box->low[k] = part->low[k] < box->low[k] ? part->low[k] : box->low[k];
        box->high[k] = part->high[k] > box->high[k] ? part->high[k] : box->high[k];
    }
    box->lowest = part->lowest < box->lowest ? part->lowest : box->lowest;
}

/* The recursion is as deep as the tree: under 32 calls. */
static void build_node(ss_face_tree *tree, int32_t index, int32_t begin, int32_t end) {
    node box = empty_node();
    if (end - begin <= LEAF) {
        for (int32_t i = begin; i < end; i++)
            add_face(tree, &box, tree->keys[i].face);
    } else {
        int32_t middle = begin + (end - begin + 1) / 2;
        build_node(tree, 2 * index + 1, begin, middle);
        build_node(tree, 2 * index + 2, middle, end);
        add_node(&box, &tree->nodes[2 * index + 1]);
        add_node(&box, &tree->nodes[2 * index + 2]);
    }
    tree->nodes[index] = box;
}

void ss_face_tree_build(ss_face_tree *tree, const double (*uv)[2]) {
    tree->uv = uv;
    for (int32_t f = 0; f < tree->patch->faces.face_count; f++)
        tree->keys[f] = (key){z_order(tree, f), f};
    sort_keys(tree);
    build_node(tree, 0, 0, tree->patch->faces.face_count);
}

/* ---- Queries: depth first, with a stack of ranges still to be visited ---- */

typedef struct range {
    int32_t node, begin, end;
} range;

static int push_children(range *stack, int top, range r) {
    int32_t middle = r.begin + (r.end - r.begin + 1) / 2;
    stack[top++] = (range){2 * r.node + 2, middle, r.end};
    stack[top++] = (range){2 * r.node + 1, r.begin, middle};
    return top;
}

static bool box_holds(const node *box, const double p[2]) {
    return box->low[0] <= p[0] && p[0] <= box->high[0] && box->low[1] <= p[1] && p[1] <= box->high[1];
}

bool ss_face_tree_holding(const ss_face_tree *tree, const double p[2], ss_place *out) {
    range stack[STACK] = {{0, 0, tree->patch->faces.face_count}};
    int32_t lowest = INT32_MAX, holding = -1;
    for (int top = 1; top > 0;) {
        range r = stack[--top];
        const node *box = &tree->nodes[r.node];
        if (box->lowest >= lowest || !box_holds(box, p))
            continue;
        if (r.end - r.begin > LEAF) {
            top = push_children(stack, top, r);
            continue;
        }
        for (int32_t i = r.begin; i < r.end; i++) {
            int32_t face = tree->keys[i].face;
            int32_t triangle = face < lowest ? ss_triangle_holding(tree->patch, face, tree->uv, p) : -1;
            if (triangle >= 0)
                lowest = face, holding = triangle;
        }
    }
    if (holding >= 0)
        ss_place_at(tree->patch, tree->uv, holding, p, out);
    return holding >= 0;
}

double ss_nearest_on_side(const ss_faces *faces, const double (*uv)[2], int32_t corner, const double p[2], double out[2]) {
    const double *a = uv[faces->corner_vertex[corner]], *b = uv[faces->corner_vertex[ss_next_corner(faces, corner)]];
    double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
    double t = square > 0 ? ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 2; k++)
        out[k] = t == 1 ? b[k] : a[k] + t * (b[k] - a[k]);
    double dx = p[0] - out[0], dy = p[1] - out[1];
    return dx * dx + dy * dy;
}

static double box_distance(const node *box, const double p[2]) {
    double square = 0;
    for (int k = 0; k < 2; k++) {
        double off = p[k] < box->low[k] ? box->low[k] - p[k] : p[k] > box->high[k] ? p[k] - box->high[k] : 0;
        square += off * off;
    }
    return square;
}

/* The nearest side so far. */
typedef struct nearest {
    int32_t face, corner;
    double square, at[2]; /* the distance squared; the point */
} nearest;

static void nearest_on_face(const ss_face_tree *tree, int32_t face, const double p[2], nearest *best) {
    for (int32_t c = tree->patch->faces.face_start[face]; c < tree->patch->faces.face_start[face + 1]; c++) {
        double at[2], square = ss_nearest_on_side(&tree->patch->faces, tree->uv, c, p, at);
        if (square < best->square || (square == best->square && face < best->face))
            *best = (nearest){face, c, square, {at[0], at[1]}};
    }
}

double ss_face_tree_nearest(const ss_face_tree *tree, const double p[2], ss_place *out) {
    range stack[STACK] = {{0, 0, tree->patch->faces.face_count}};
    nearest best = {.face = INT32_MAX, .square = INFINITY};
    for (int top = 1; top > 0;) {
        range r = stack[--top];
        if (box_distance(&tree->nodes[r.node], p) > best.square)
            continue;
        if (r.end - r.begin > LEAF)
            top = push_children(stack, top, r);
        else
            for (int32_t i = r.begin; i < r.end; i++)
                nearest_on_face(tree, tree->keys[i].face, p, &best);
    }
    ss_place_at(tree->patch, tree->uv, ss_triangle_of_side(tree->patch, best.corner), best.at, out);
    return sqrt(best.square);
}
