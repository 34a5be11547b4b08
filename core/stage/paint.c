/* Paint as any tool leaves it: under the schema's name or one like it; as halves, floats, doubles or a channel of colours; by
 * point, by face, or by face corner. */
#include "stage.h"

#include "schema.inc"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Names ---- */

/* How much a name is like the schema's, the best last. Underscores stand for colons, which some tools do not allow in names. */
typedef enum likeness { LIKE_NOTHING, LIKE_FOLDED, LIKE_UNDERSCORED, LIKE_ITSELF } likeness;

static char folded(char letter) {
    char lower = letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
    return lower == ':' ? '_' : lower;
}

/* For two letters that are equal when folded. */
static likeness like_letter(char wanted, char letter) {
    return letter == wanted ? LIKE_ITSELF : wanted == ':' && letter == '_' ? LIKE_UNDERSCORED : LIKE_FOLDED;
}

/* The parts of the schema's name for an input of a patch. more: an ending, such as SS_INDICES. */
enum { PARTS = 5 };
#define PARTS_OF(patch, input, more)                                                                                           \
    { (input)->prefix, patch, ":", (input)->name, more }

/* Like strcmp, folded, for the parts joined and a name; a NULL name is empty. */
static int compare(const char *const *parts, int count, const char *name) {
    name = name ? name : "";
    for (int i = 0; i < count; i++)
        for (const char *letter = parts[i]; *letter; letter++, name++)
            if (folded(*letter) != folded(*name))
                return (unsigned char)folded(*letter) - (unsigned char)folded(*name);
    return -(*name != 0);
}

static int by_folded(const void *a, const void *b) {
    const char *x = *(const char *const *)a, *y = *(const char *const *)b;
    x = x ? x : "", y = y ? y : "";
    int order = compare(&x, 1, y);
    return order ? order : strcmp(x, y);
}

void skinslide_stage_sort_names(const char **names, int32_t count) {
    if (names && count > 0)
        qsort(names, (size_t)count, sizeof *names, by_folded);
}

static likeness like_parts(const char *const *parts, const char *name) {
    if (!name || strncmp(name, SS_PRIMVARS, strlen(SS_PRIMVARS)) != 0 || compare(parts, PARTS, name) != 0)
        return LIKE_NOTHING;
    likeness found = LIKE_ITSELF;
    for (int i = 0; i < PARTS; i++)
        for (const char *letter = parts[i]; *letter; letter++, name++) {
            likeness own = like_letter(*letter, *name);
            found = own < found ? own : found;
        }
    return found;
}

/* The first of the sorted names that does not come before an input's. */
static int32_t first_like(const char *const *parts, const char *const *names, int32_t count) {
    int32_t low = 0, high = count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (compare(parts, PARTS, names[middle]) > 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int32_t skinslide_stage_patch_property(const skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                       const char *const *names, int32_t count) {
    if (!patch || !input || !input->is_primvar)
        return -1;
    const char *const parts[PARTS] = PARTS_OF(patch->name, input, "");
    likeness best = patch->mesh->fold_case ? LIKE_NOTHING : LIKE_FOLDED;
    int32_t found = -1;
    for (int32_t i = first_like(parts, names, count); i < count && compare(parts, PARTS, names[i]) == 0; i++) {
        likeness own = like_parts(parts, names[i]);
        if (own > best)
            best = own, found = i;
    }
    return found;
}

/* ---- Names of a prim that are like those of paint ---- */

/* Whether a name, folded, begins like those of paint. */
static bool begins_like_paint(const char *name) {
    static const char start[] = SS_PRIMVARS SS_NAMESPACE;
    size_t i = 0;
    while (start[i] && folded(start[i]) == folded(name[i]))
        i++;
    return strncmp(name, SS_PRIMVARS, strlen(SS_PRIMVARS)) == 0 && !start[i];
}

/* A name that is like paint of several patches is given to the one whose case matches. */
static void match_input(const char *patch, const skinslide_stage_input *input, const char *more, ss_paint_names *all) {
    const char *const parts[PARTS] = PARTS_OF(patch, input, more);
    int32_t first = first_like(parts, all->names, all->count);
    for (int32_t i = first; i < all->count && compare(parts, PARTS, all->names[i]) == 0; i++)
        if (!all->patches[i] || all->in_another_case[i]) {
            all->patches[i] = patch;
            all->in_another_case[i] = like_parts(parts, all->names[i]) == LIKE_FOLDED;
        }
}

static void match_patch(const char *patch, ss_paint_names *all) {
    for (int32_t group = SKINSLIDE_STAGE_PATCH; group <= SKINSLIDE_STAGE_CONTROLS; group++) {
        int32_t count;
        const ss_input *inputs = ss_inputs((skinslide_stage_group)group, &count);
        for (int32_t i = 0; i < count; i++)
            if (inputs[i].shown.is_primvar)
                match_input(patch, &inputs[i].shown, "", all), match_input(patch, &inputs[i].shown, SS_INDICES, all);
    }
}

ss_paint_names ss_list_paint(ss_memory *memory, const char *const *properties, int32_t count, const char *const *patches,
                             int32_t patch_count) {
    ss_paint_names all = {.names = SS_NEW(memory, const char *, count)};
    for (int32_t i = 0; all.names && i < count; i++)
        if (begins_like_paint(properties[i]))
            all.names[all.count++] = properties[i];
    all.patches = SS_NEW(memory, const char *, all.count);
    all.in_another_case = SS_NEW(memory, bool, all.count);
    if (memory->failed)
        return (ss_paint_names){0};
    skinslide_stage_sort_names(all.names, all.count);
    for (int32_t i = 0; all.count && i < patch_count; i++)
        match_patch(patches[i], &all);
    return all;
}

bool ss_is_paint(const ss_paint_names *all, const char *property) {
    const char **found = all->count ? bsearch(&property, all->names, (size_t)all->count, sizeof *all->names, by_folded) : NULL;
    return found && all->patches[found - all->names];
}

/* ---- Types ---- */

static int32_t channel_of(const skinslide_stage_patch *patch) {
    return patch->taken[SS_ROW_CHANNEL].choice - 1; /* -1 if none is named */
}

static const char *name_of_channel(const skinslide_stage_patch *patch) {
    int32_t count;
    return ss_inputs(SKINSLIDE_STAGE_PATCH, &count)[SS_ROW_CHANNEL].shown.tokens[patch->taken[SS_ROW_CHANNEL].choice];
}

static bool is_choice(const skinslide_value *value) {
    return (value->type == SKINSLIDE_VALUE_BOOL || value->type == SKINSLIDE_VALUE_INT32) && value->width == 1;
}

/* Fails: paint is of a wrong type. more lists what else the type may be. */
static skinslide_status refuse_type(const skinslide_value *value, bool of_faces, const char *more, skinslide_status status,
                                    skinslide_error *error) {
    const char *format = of_faces ? SS_NAMED " is " SS_NAMED "; it must be bool[], int[] or float[]%s"
                                  : SS_NAMED " is " SS_NAMED "; it must be float[]%s";
    return ss_fail(error, status, format, SS_NAME(value->name), SS_NAME(value->type_name), more);
}

static skinslide_status check_channel(const skinslide_stage_patch *patch, const skinslide_value *value, bool of_faces,
                                      skinslide_status status, skinslide_error *error) {
    char setting[256], more[320];
    ss_name_property(SKINSLIDE_STAGE_PATCH, SS_ROW_CHANNEL, patch->name, setting);
    snprintf(more, sizeof more, ", or %s must name the channel that counts", setting);
    if (channel_of(patch) < 0)
        return refuse_type(value, of_faces, more, status, error);
    if (channel_of(patch) >= value->width)
        return ss_fail(error, status, SS_NAMED " is " SS_NAMED ", which has no channel %s; %s names it", SS_NAME(value->name),
                       SS_NAME(value->type_name), name_of_channel(patch), setting);
    return SKINSLIDE_OK;
}

skinslide_status ss_check_paint_type(const skinslide_stage_patch *patch, const ss_record *record, bool of_faces,
                                     skinslide_status status, skinslide_error *error) {
    const skinslide_value *value = &record->value;
    if (value->type == SKINSLIDE_VALUE_BLOCKED)
        return SKINSLIDE_OK;
    bool is_wide = value->width > 1, is_single = !value->is_array && (of_faces || is_wide);
    if (is_single || (is_wide && !patch) || (!ss_is_real(value) && !(of_faces && is_choice(value))))
        return refuse_type(value, of_faces, "", status, error);
    return is_wide ? check_channel(patch, value, of_faces, status, error) : SKINSLIDE_OK;
}

/* ---- By point ---- */

static bool is_by_corner(const ss_record *record) {
    return strcmp(ss_interpolation(record), "faceVarying") == 0;
}

bool ss_is_painted_by_vertex(const ss_record *record) {
    return ss_is_by_vertex(ss_interpolation(record)) || is_by_corner(record);
}

skinslide_status ss_check_painted_vertices(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_status status,
                                           skinslide_error *error) {
    return is_by_corner(record) ? ss_check_length(record, ss_faces_of(mesh).index_count, "face corners", status, error)
                                : ss_check_length(record, mesh->vertex_count, "points", status, error);
}

bool ss_is_plain_paint(const ss_record *record) {
    return record->value.width == 1 && !is_by_corner(record);
}

/* The mean over the corners at each vertex; 0 if there are none. */
static void average(const skinslide_mesh *mesh, const ss_record *record, int32_t k, double *means, double *counts) {
    memset(means, 0, (size_t)mesh->vertex_count * sizeof *means);
    memset(counts, 0, (size_t)mesh->vertex_count * sizeof *counts);
    for (int32_t corner = 0; corner < mesh->index_count; corner++) {
        int32_t vertex = mesh->face_indices[corner];
        means[vertex] += ss_number(record, corner, k);
        counts[vertex]++;
    }
    for (int32_t vertex = 0; vertex < mesh->vertex_count; vertex++)
        means[vertex] /= counts[vertex] > 0 ? counts[vertex] : 1;
}

int64_t ss_plain_paint_room(const skinslide_stage_mesh *mesh) {
    int32_t faces = mesh->taken[SS_ROW_FACE_COUNTS].array.count;
    return 2 * (int64_t)(mesh->vertex_count > faces ? mesh->vertex_count : faces);
}

ss_record ss_plain_paint(const skinslide_stage_patch *patch, const ss_record *record, double *room) {
    skinslide_mesh mesh = ss_faces_of(patch->mesh);
    int32_t k = record->value.width > 1 ? channel_of(patch) : 0;
    ss_record plain = *record;
    if (is_by_corner(record)) {
        average(&mesh, record, k, room, room + mesh.vertex_count);
        plain.length = mesh.vertex_count, plain.value.interpolation = "vertex";
    } else {
        for (int64_t i = 0; i < record->length; i++)
            room[i] = ss_number(record, i, k);
    }
    plain.value.type = SKINSLIDE_VALUE_DOUBLE, plain.value.width = 1;
    plain.value.data = room, plain.value.count = plain.length;
    plain.indices.type = SKINSLIDE_VALUE_NONE;
    return plain;
}

/* ---- What was made of it ---- */

skinslide_bool skinslide_stage_patch_describe(const skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                              const skinslide_value *value, char text[512]) {
    ss_record record;
    if (!patch || !input || !input->is_primvar || ss_open(value, &record, NULL) || !ss_has_value(&record))
        return 0;
    const skinslide_value *own = &record.value;
    bool has_channel = own->width > 1 && channel_of(patch) >= 0;
    bool is_plain_type = own->type <= SKINSLIDE_VALUE_INT32 || own->type == SKINSLIDE_VALUE_FLOAT;
    const char *const parts[PARTS] = PARTS_OF(patch->name, input, "");
    bool is_itself = like_parts(parts, own->name) == LIKE_ITSELF;
    if (is_itself && is_plain_type && ss_is_plain_paint(&record))
        return 0;
    snprintf(text, 512, "%s comes from " SS_NAMED ", " SS_NAMED "%s%s%s", input->name, SS_NAME(own->name),
             SS_NAME(own->type_name), has_channel ? ", channel " : "", has_channel ? name_of_channel(patch) : "",
             is_by_corner(&record) ? ", the mean over the face corners at each point" : "");
    return 1;
}
