/* L D L' front by front (multifrontal, Duff and Reid 1983): the columns of a front are assembled from the matrix and from its
 * children's updates, and eliminated densely; what that adds to the rows below is the front's own update, for its parent. If
 * the matrix is dominant, its slack and two right sides are eliminated with it, as rows below the others. */
#include "linear.h"

#include <stdlib.h>
#include <string.h>

/* ---- Creation ---- */

static int32_t tiles_of(int32_t count) {
    return (count + 3) / 4;
}

ss_shape ss_shape_of(const ss_frontal *frontal, const ss_front *front) {
    int32_t used = frontal->block * front->count, below = frontal->block * front->row_count;
    ss_shape s = {.used = used, .below = below, .own_tiles = tiles_of(used), .below_tiles = tiles_of(below)};
    s.columns = 4 * s.own_tiles;
    s.tiles = s.own_tiles + s.below_tiles + frontal->dominant;
    s.height = 4 * ((size_t)s.below_tiles + frontal->dominant);
    return s;
}

/* The distance from column c of an update to the next in its tile. */
static ptrdiff_t next_in_update(const ss_shape *s, int32_t c) {
    return (ptrdiff_t)s->height - 4 * (ptrdiff_t)(c / 4);
}

/* Where column c of an update begins, so that row r is r numbers further; columns are stored only from their own tile of four
 * on. */
static ptrdiff_t place_in_update(const ss_shape *s, int32_t c) {
    ptrdiff_t tile = c / 4, height = (ptrdiff_t)s->height;
    return 4 * tile * height - 8 * tile * (tile - 1) + c % 4 * next_in_update(s, c) - 4 * tile;
}

/* How many numbers are in an update. */
static int64_t size_of_update(const ss_shape *s) {
    return 4 * (int64_t)s->below_tiles * (int64_t)s->height - 8 * (int64_t)s->below_tiles * (s->below_tiles - 1);
}

/* Where a row of a front begins in its panel: first the rows of its columns, then those below. */
static size_t place_in_panel(const ss_front *front, const ss_shape *s, int32_t block, int32_t row) {
    int32_t place = row < front->count ? block * row : s->columns + block * (row - front->count);
    return ss_tile_start(s, place / 4) + (size_t)(place % 4);
}

static int64_t most(int64_t a, int64_t b) {
    return a > b ? a : b;
}

/* Places a front's panel after the others, and its update at the end of its stack. */
static void place_front(ss_frontal *frontal, int32_t f, int64_t end[2]) {
    ss_extent *room = &frontal->extent;
    ss_shape s = ss_shape_of(frontal, &frontal->system->fronts[f]);
    int64_t size = (int64_t)ss_tile_start(&s, s.tiles), *own = &end[frontal->odd[f]];
    frontal->panel[f] = room->panels, room->panels += size;
    frontal->update[f] = *own, *own += size_of_update(&s);
    room->panel = most(size, room->panel);
    room->stack[frontal->odd[f]] = most(*own, room->stack[frontal->odd[f]]);
    room->columns = (int32_t)most(s.columns, room->columns);
    room->below = (int32_t)most(4 * (int64_t)s.below_tiles, room->below);
}

/* Updates are in two stacks, one for fronts at even depths and one for those at odd depths. So when a front's own update is
 * begun, its children's are at the end of the other stack, and are taken off it. */
static void place_fronts(ss_frontal *frontal) {
    const ss_front *fronts = frontal->system->fronts;
    int64_t end[2] = {0, 0};
    for (int32_t f = frontal->system->front_count - 1; f >= 0; f--)
        frontal->odd[f] = fronts[f].parent >= 0 && !frontal->odd[fronts[f].parent];
    for (int32_t f = 0; f < frontal->system->front_count; f++) {
        place_front(frontal, f, end);
        for (int32_t child = fronts[f].child; child >= 0; child = fronts[child].next)
            end[!frontal->odd[f]] = frontal->update[child];
    }
}

static void place_entries(ss_frontal *frontal) {
    const ss_system *system = frontal->system;
    for (int32_t f = 0; f < system->front_count; f++) {
        const ss_front *front = &system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        for (int32_t i = front->entry_start; i < front->entry_start + front->entry_count; i++) {
            size_t row = place_in_panel(front, &s, frontal->block, system->entries[i].row);
            frontal->entry_place[i] = (int32_t)row + 4 * frontal->block * system->entries[i].column;
        }
    }
}

static void place_rows(ss_frontal *frontal) {
    const ss_system *system = frontal->system;
    for (int32_t f = 0; f < system->front_count; f++) {
        const ss_front *own = &system->fronts[f], *parent = &system->fronts[own->parent < 0 ? f : own->parent];
        ss_shape s = ss_shape_of(frontal, parent);
        for (int32_t i = own->row_start; i < own->row_start + own->row_count; i++)
            frontal->row_place[i] = (int32_t)place_in_panel(parent, &s, frontal->block, system->place[i]);
    }
}

static bool allocate(ss_frontal *frontal) {
    ss_memory *memory = &frontal->memory;
    int32_t count = frontal->system->front_count;
    frontal->panel = SS_NEW(memory, int64_t, count);
    frontal->update = SS_NEW(memory, int64_t, count);
    frontal->odd = SS_NEW(memory, uint8_t, count);
    frontal->entry_place = SS_NEW(memory, int32_t, frontal->system->edge_count);
    frontal->row_place = SS_NEW(memory, int32_t, frontal->system->row_count);
    return !memory->failed;
}

void ss_frontal_lay_out(ss_frontal *frontal, ss_room *room) {
    const ss_extent *extent = &frontal->extent;
    if (!frontal->keeps)
        frontal->L = SS_TAKE(room, double, extent->panels);
    frontal->force = SS_TAKE(room, double, extent->panel);
    for (int k = 0; k < 2; k++)
        frontal->stack[k] = SS_TAKE(room, double, extent->stack[k]);
    frontal->x = SS_TAKE(room, double, 2 * (int64_t)extent->columns);
    frontal->below = SS_TAKE(room, double, 2 * (int64_t)extent->below);
}

skinslide_status ss_frontal_create(const ss_system *system, int32_t block, bool dominant, bool keeps, ss_frontal **out,
                                   skinslide_error *error) {
    ss_frontal *frontal = calloc(1, sizeof *frontal);
    if (!frontal)
        return ss_out_of_memory(error);
    frontal->system = system, frontal->block = block, frontal->dominant = dominant, frontal->keeps = keeps;
    frontal->kernels = ss_kernels_of(true);
    if (allocate(frontal)) {
        place_fronts(frontal);
        place_entries(frontal);
        place_rows(frontal);
        if (keeps)
            frontal->L = SS_NEW(&frontal->memory, double, frontal->extent.panels);
    }
    if (frontal->memory.failed) {
        ss_frontal_destroy(frontal);
        return ss_out_of_memory(error);
    }
    *out = frontal;
    return SKINSLIDE_OK;
}

void ss_frontal_destroy(ss_frontal *frontal) {
    if (!frontal)
        return;
    ss_free(&frontal->memory);
    free(frontal);
}

/* ---- Assembly ---- */

static void assemble_numbers(const ss_frontal *frontal, const ss_front *front, const double *entries, double *panel) {
    for (int32_t i = front->entry_start; i < front->entry_start + front->entry_count; i++)
        panel[frontal->entry_place[i]] = entries[frontal->system->entries[i].edge];
}

static void assemble_extras(const ss_front *front, const ss_shape *s, const double *slack, const double (*right)[2],
                            double *panel) {
    double *extras = panel + ss_tile_start(s, s->tiles - 1);
    for (int32_t k = 0; k < front->count; k++) {
        int32_t unknown = front->first + k;
        extras[4 * k] = slack[unknown], extras[4 * k + 1] = right[unknown][0], extras[4 * k + 2] = right[unknown][1];
    }
}

/* A child's update, and the front that it is added to. */
typedef struct extension {
    const ss_front *front;
    const ss_shape *to;
    ss_shape from;
    const double *origin;
    int32_t count;                   /* rows of the child */
    const int32_t *place, *in_panel; /* [count] */
    double *panel, *update;
    bool dominant;
} extension;

/* A column of a child's update, or the first of a block's two: where it is, where it goes, and how far the other is from
 * each. */
typedef struct column {
    const double *from, *extra;
    double *to, *extras;
    ptrdiff_t from_next, to_next;
} column;

/* in_panel: whether the front has that column, which else goes to its update. */
SS_INLINE column find_column(const extension *e, int block, int32_t row, bool in_panel) {
    const double *from = e->origin + place_in_update(&e->from, block * row);
    column c = {from, from + e->from.height - 4, NULL, NULL, next_in_update(&e->from, block * row), 4};
    if (in_panel) {
        c.to = e->panel + 4 * block * (ptrdiff_t)e->place[row];
        c.extras = c.to + ss_tile_start(e->to, e->to->tiles - 1);
    } else {
        int32_t there = block * (e->place[row] - e->front->count);
        c.to = e->update + place_in_update(e->to, there);
        c.extras = c.to + e->to->height - 4;
        c.to -= block * (ptrdiff_t)e->front->count;
        c.to_next = next_in_update(e->to, there);
    }
    return c;
}

/* Adds the rows of a column, or of a block's two, from one on. What lies above the diagonal of a block is added too, but never
 * read. */
SS_INLINE void add_rows(const extension *e, const column *c, int block, int32_t begin, const int32_t *place, int step) {
    for (int32_t i = begin; i < e->count; i++) {
        ptrdiff_t at = step * (ptrdiff_t)place[i];
        if (block == 2) {
            *(ss_loose_two *)(c->to + at) += *(const ss_loose_two *)(c->from + 2 * i);
            *(ss_loose_two *)(c->to + c->to_next + at) += *(const ss_loose_two *)(c->from + c->from_next + 2 * i);
        } else {
            c->to[at] += c->from[i];
        }
    }
}

SS_INLINE void add_extras(const extension *e, const column *c) {
    for (int k = 0; k < 3 && e->dominant; k++)
        c->extras[k] += c->extra[k];
}

/* Adds columns from begin to end: of numbers, four at once as long as there are, since a loop that ends costs as much as many
 * sums. */
SS_INLINE void add_columns(const extension *e, int block, int32_t begin, int32_t end, bool in_panel) {
    const int32_t *place = in_panel ? e->in_panel : e->place;
    int step = in_panel ? 1 : block;
    int32_t row = begin;
    for (; block == 1 && row + 4 <= end; row += 4) {
        column four[4];
        for (int k = 0; k < 4; k++) {
            four[k] = find_column(e, 1, row + k, in_panel);
            add_extras(e, &four[k]);
        }
        for (int k = 0; k < 4; k++)
            for (int i = k; i < 4; i++)
                four[k].to[place[row + i]] += four[k].from[row + i];
        for (int32_t i = row + 4; i < e->count; i++)
            for (int k = 0; k < 4; k++)
                four[k].to[place[i]] += four[k].from[i];
    }
    for (; row < end; row++) {
        column one = find_column(e, block, row, in_panel);
        add_rows(e, &one, block, row, place, step);
        add_extras(e, &one);
    }
}

/* Adds a child's update to its parent: to the panel what is in the parent's columns, the rest to the parent's update. */
SS_INLINE void extend(ss_frontal *frontal, int32_t child, const ss_front *front, const ss_shape *s, int block, double *panel,
                      double *update) {
    const ss_front *own = &frontal->system->fronts[child];
    const extension e = {
        .front = front,
        .to = s,
        .from = ss_shape_of(frontal, own),
        .origin = frontal->stack[frontal->odd[child]] + frontal->update[child],
        .count = own->row_count,
        .place = frontal->system->place + own->row_start,
        .in_panel = frontal->row_place + own->row_start,
        .panel = panel,
        .update = update,
        .dominant = frontal->dominant,
    };
    int32_t columns = 0;
    while (columns < e.count && e.place[columns] < front->count)
        columns++;
    add_columns(&e, block, 0, columns, true);
    add_columns(&e, block, columns, e.count, false);
}

static bool eliminate(ss_frontal *frontal, int32_t f, const ss_shape *s) {
    const ss_front *front = &frontal->system->fronts[f];
    double *panel = frontal->L + frontal->panel[f], *update = frontal->stack[frontal->odd[f]] + frontal->update[f];
    if (front->child >= 0)
        memset(update, 0, (size_t)size_of_update(s) * sizeof *update);
    for (int32_t child = front->child; child >= 0; child = frontal->system->fronts[child].next)
        if (frontal->block == 2)
            extend(frontal, child, front, s, 2, panel, update);
        else
            extend(frontal, child, front, s, 1, panel, update);
    bool good = frontal->kernels->factor(s, frontal->dominant, panel, frontal->force);
    if (s->below_tiles > 0)
        frontal->kernels->update(s, panel, frontal->force, front->child < 0, update);
    return good;
}

bool ss_factor_numbers(ss_frontal *frontal, const double *entries, const double *slack, const double (*right)[2]) {
    bool good = true;
    for (int32_t f = 0; f < frontal->system->front_count; f++) {
        const ss_front *front = &frontal->system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        double *panel = frontal->L + frontal->panel[f];
        memset(panel, 0, ss_tile_start(&s, s.tiles) * sizeof *panel);
        assemble_numbers(frontal, front, entries, panel);
        assemble_extras(front, &s, slack, right, panel);
        good = eliminate(frontal, f, &s) && good;
    }
    return good;
}

/* Blocks between have the rows of the higher unknown. */
static void assemble_blocks(const ss_frontal *frontal, const ss_front *front, const ss_shape *s, const double (*own)[4],
                            const double (*between)[4], double *panel) {
    for (int32_t k = 0; k < front->count; k++) {
        double *at = panel + place_in_panel(front, s, 2, k) + 8 * (size_t)k;
        const double *block = own[front->first + k];
        at[0] = -block[0], at[1] = -block[2], at[5] = -block[3];
    }
    for (int32_t i = front->entry_start; i < front->entry_start + front->entry_count; i++) {
        double *at = panel + frontal->entry_place[i];
        const double *block = between[frontal->system->entries[i].edge];
        at[0] = -block[0], at[4] = -block[1], at[1] = -block[2], at[5] = -block[3];
    }
}

bool ss_factor_blocks(ss_frontal *frontal, const double (*own)[4], const double (*between)[4], double (*right)[2],
                      const int *stop) {
    bool good = true;
    for (int32_t f = 0; f < frontal->system->front_count; f++) {
        if (ss_is_set(stop))
            return false;
        const ss_front *front = &frontal->system->fronts[f];
        ss_shape s = ss_shape_of(frontal, front);
        double *panel = frontal->L + frontal->panel[f];
        memset(panel, 0, ss_tile_start(&s, s.tiles) * sizeof *panel);
        assemble_blocks(frontal, front, &s, own, between, panel);
        good = eliminate(frontal, f, &s) && good;
        if (right)
            ss_eliminate_front(frontal, f, right);
    }
    return good;
}
