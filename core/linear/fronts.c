/* The fronts of a factor: columns whose rows below them are the same, or so nearly that storing some zeros pays (relaxed
 * supernodes, Ashcraft and Grimes 1989). They make a tree: a front's update is added into its parent (Duff and Reid 1983).
 * Given unknowns in an order with little fill, renumbers them so that the columns of a front follow each other, and fronts
 * follow their children. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

/* A child is merged into its parent if the two have few columns, or few zeros. Blocks count for two columns each, and may have
 * half the share of zeros: solving with them is bound by memory, and a step of `relaxed` factored a tenth faster so. */
#define ALWAYS_COLUMNS 12 /* up to so many, any child is */
#define OFTEN_COLUMNS  32 /* up to so many, with this share of zeros: */
#define OFTEN_ZEROS    0.3
#define SELDOM_ZEROS   0.05 /* with more columns, with this */

/* The elimination tree. A node has the number of its last column. A node that was merged into another is no node any more. */
typedef struct tree {
    int32_t n, block;
    int32_t *parent;       /* [n] -1 of a root */
    int32_t *below;        /* [n] rows below its columns */
    int32_t *count;        /* [n] columns */
    int32_t *child, *next; /* [n] first child, and next child of the same parent; or -1 */
    int32_t *more, *least; /* [n] the column before in its node, or -1; the first column of a node */
    int32_t *mark;         /* [n] */
    double *zeros;         /* [n] stored in the node */
} tree;

static bool allocate(ss_memory *memory, int32_t n, tree *t) {
    int32_t **arrays[] = {&t->parent, &t->below, &t->count, &t->child, &t->next, &t->more, &t->least, &t->mark};
    t->n = n;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = SS_NEW(memory, int32_t, n);
    t->zeros = SS_NEW(memory, double, n);
    return !memory->failed;
}

/* ---- The tree of columns ---- */

/* Counts the entries of L, row by row: from each entry of the matrix in a row up the tree (Liu 1990). */
static void find_columns(const ss_graph *graph, tree *t) {
    for (int32_t k = 0; k < t->n; k++) {
        t->parent[k] = t->more[k] = -1, t->count[k] = 1, t->below[k] = 0, t->mark[k] = t->least[k] = k;
        for (int32_t p = graph->start[k]; p < graph->start[k + 1]; p++)
            for (int32_t i = graph->neighbour[p]; i < k && t->mark[i] != k; i = t->parent[i]) {
                if (t->parent[i] < 0)
                    t->parent[i] = k;
                t->below[i]++;
                t->mark[i] = k;
            }
    }
}

static void list_children(tree *t) {
    for (int32_t k = 0; k < t->n; k++)
        t->child[k] = -1;
    for (int32_t k = t->n - 1; k >= 0; k--)
        if (t->parent[k] >= 0) {
            t->next[k] = t->child[t->parent[k]];
            t->child[t->parent[k]] = k;
        }
}

/* ---- Nodes ---- */

/* Entries below the diagonal. */
static double entries_of(int32_t columns, int32_t below) {
    return (double)columns * below + 0.5 * columns * (columns - 1.0);
}

/* Zeros of a child and its parent as one front, given that a child's rows are among those of its parent. */
static double zeros_together(const tree *t, int32_t child, int32_t parent) {
    double apart = entries_of(t->count[child], t->below[child]) + entries_of(t->count[parent], t->below[parent]);
    double together = entries_of(t->count[child] + t->count[parent], t->below[parent]);
    return t->zeros[child] + t->zeros[parent] + together - apart;
}

static bool is_worth(const tree *t, int32_t child, int32_t parent) {
    int32_t columns = t->count[child] + t->count[parent];
    double most = (t->block * columns <= OFTEN_COLUMNS ? OFTEN_ZEROS : SELDOM_ZEROS) / t->block;
    return t->block * columns <= ALWAYS_COLUMNS ||
           zeros_together(t, child, parent) <= most * entries_of(columns, t->below[parent]);
}

/* Puts a list of children in front of a node's own. */
static void add_children(tree *t, int32_t node, int32_t list) {
    int32_t last = list;
    if (list < 0)
        return;
    while (t->next[last] >= 0)
        last = t->next[last];
    t->next[last] = t->child[node];
    t->child[node] = list;
}

static void take_in(tree *t, int32_t child, int32_t node) {
    t->zeros[node] = zeros_together(t, child, node);
    t->count[node] += t->count[child];
    t->more[t->least[node]] = child, t->least[node] = t->least[child];
    add_children(t, node, t->child[child]);
}

/* Merges children into a node. Their children become the node's own, but are not considered again. */
static void take_children(tree *t, int32_t node) {
    int32_t child = t->child[node], next;
    t->child[node] = -1;
    for (; child >= 0; child = next) {
        next = t->next[child], t->next[child] = -1;
        if (is_worth(t, child, node))
            take_in(t, child, node);
        else
            add_children(t, node, child);
    }
}

/* ---- The order of columns ---- */

/* Numbers the columns of a node after those of its children: place [n] of each column. */
static void number_node(const tree *t, int32_t node, ss_system *system, int32_t *place, int32_t *columns) {
    ss_front *front = &system->fronts[system->front_count++];
    *front = (ss_front){.first = *columns, .count = t->count[node], .row_count = t->below[node]};
    *columns += t->count[node];
    for (int32_t k = node, last = *columns; k >= 0; k = t->more[k])
        place[k] = --last;
}

/* In postorder, without recursion: trees may be as deep as they have columns. */
static void number_columns(tree *t, ss_system *system, int32_t *place) {
    int32_t columns = 0;
    for (int32_t root = 0; root < t->n; root++) {
        if (t->parent[root] >= 0)
            continue;
        int32_t depth = 0, node = root;
        t->next[root] = -1;
        for (;;) {
            while (t->child[node] >= 0) {
                t->mark[depth++] = node;
                node = t->child[node];
            }
            number_node(t, node, system, place, &columns);
            while (t->next[node] < 0 && depth > 0) {
                node = t->mark[--depth];
                number_node(t, node, system, place, &columns);
            }
            if (t->next[node] < 0)
                break;
            node = t->next[node];
        }
    }
}

/* ---- Rows ---- */

static int ascending(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Adds those rows to a front that are below its columns and not marked as its own yet. */
static void add_rows(ss_system *system, int32_t f, const int32_t *rows, int32_t count, int32_t *mark) {
    ss_front *own = &system->fronts[f];
    for (int32_t i = 0; i < count; i++)
        if (rows[i] >= own->first + own->count && mark[rows[i]] != f) {
            mark[rows[i]] = f;
            system->rows[own->row_start + own->row_count++] = rows[i];
        }
}

static void name_fronts(ss_system *system, int32_t *front_of, int32_t *mark) {
    for (int32_t f = 0; f < system->front_count; f++) {
        ss_front *own = &system->fronts[f];
        own->parent = own->child = own->next = -1;
        for (int32_t k = own->first; k < own->first + own->count; k++)
            front_of[k] = f, mark[k] = -1;
    }
}

/* Finds the rows of each front: those of its columns in the matrix, and those of its children. The first row tells the
 * parent. */
static void find_rows(ss_system *system, const ss_graph *graph, const int32_t *front_of, int32_t *mark) {
    int32_t start = 0;
    for (int32_t f = 0; f < system->front_count; f++) {
        ss_front *own = &system->fronts[f];
        own->row_start = start;
        for (int32_t k = own->first; k < own->first + own->count; k++)
            add_rows(system, f, graph->neighbour + graph->start[k], graph->start[k + 1] - graph->start[k], mark);
        for (int32_t c = own->child; c >= 0; c = system->fronts[c].next)
            add_rows(system, f, system->rows + system->fronts[c].row_start, system->fronts[c].row_count, mark);
        start += own->row_count;
        if (own->row_count == 0)
            continue;
        qsort(system->rows + own->row_start, (size_t)own->row_count, sizeof *system->rows, ascending);
        ss_front *parent = &system->fronts[own->parent = front_of[system->rows[own->row_start]]];
        own->next = parent->child, parent->child = f;
    }
}

/* The place of an unknown among the columns of a front, then the rows below them. */
static int32_t place_in(const ss_system *system, const ss_front *front, int32_t unknown) {
    if (unknown < front->first + front->count)
        return unknown - front->first;
    const int32_t *rows = system->rows + front->row_start;
    int32_t low = 0, high = front->row_count - 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (rows[middle] < unknown)
            low = middle + 1;
        else
            high = middle;
    }
    return front->count + low;
}

static void place_rows(ss_system *system) {
    for (int32_t f = 0; f < system->front_count; f++) {
        const ss_front *own = &system->fronts[f];
        for (int32_t i = own->row_start; i < own->row_start + own->row_count; i++)
            system->place[i] = place_in(system, &system->fronts[own->parent], system->rows[i]);
    }
}

/* ---- Entries ---- */

/* The unknowns of an edge, the lower first; false if an end is fixed. */
static bool ends_of(const ss_system *system, int32_t edge, int32_t *low, int32_t *high) {
    int32_t a = system->unknown[system->edge_vertex[edge][0]], b = system->unknown[system->edge_vertex[edge][1]];
    *low = a < b ? a : b, *high = a < b ? b : a;
    return *low >= 0;
}

static void list_entries(ss_system *system, const int32_t *front_of) {
    int32_t low, high;
    for (int32_t e = 0; e < system->edge_count; e++)
        if (ends_of(system, e, &low, &high))
            system->fronts[front_of[low]].entry_count++;
    for (int32_t f = 0, start = 0; f < system->front_count; start += system->fronts[f++].entry_count)
        system->fronts[f].entry_start = start;
    for (int32_t f = 0; f < system->front_count; f++)
        system->fronts[f].entry_count = 0;
    for (int32_t e = 0; e < system->edge_count; e++) {
        if (!ends_of(system, e, &low, &high))
            continue;
        ss_front *front = &system->fronts[front_of[low]];
        system->entries[front->entry_start + front->entry_count++] =
            (ss_entry){e, low - front->first, place_in(system, front, high)};
    }
}

/* ---- All of it ---- */

static void find_tree(const ss_graph *graph, tree *t) {
    find_columns(graph, t);
    list_children(t);
    for (int32_t k = 0; k < t->n; k++)
        take_children(t, k);
}

skinslide_status ss_find_fronts(ss_system *system, ss_graph *graph, skinslide_error *error) {
    ss_memory scratch = {0}, *memory = &system->memory;
    int32_t n = system->n, *place = SS_NEW(&scratch, int32_t, n);
    tree t;
    ss_front *fronts = SS_NEW(&scratch, ss_front, n);
    system->entries = SS_NEW(memory, ss_entry, system->edge_count);
    if (!allocate(&scratch, n, &t) || memory->failed) {
        ss_free(&scratch);
        return ss_out_of_memory(error);
    }
    t.block = system->block;
    find_tree(graph, &t);
    system->fronts = fronts;
    number_columns(&t, system, place);
    system->fronts = SS_NEW(memory, ss_front, system->front_count);
    if (system->fronts)
        memcpy(system->fronts, fronts, (size_t)system->front_count * sizeof *fronts);
    for (int32_t f = 0; f < system->front_count && system->fronts; f++)
        system->row_count += system->fronts[f].row_count, system->fronts[f].row_count = 0;
    system->rows = SS_NEW(memory, int32_t, system->row_count);
    system->place = SS_NEW(memory, int32_t, system->row_count);
    if (!memory->failed) {
        ss_renumber(system, place);
        ss_fill_graph(system, graph);
        name_fronts(system, t.parent, t.mark);
        find_rows(system, graph, t.parent, t.mark);
        place_rows(system);
        list_entries(system, t.parent);
    }
    ss_free(&scratch);
    return memory->failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}
