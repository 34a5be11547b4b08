/* Which patches a prim carries, why they cannot be slid, and which of its properties seem misnamed. */
#include "stage.h"

#include "schema.inc"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char schema_prefix[] = SS_SCHEMA ":";
static const char *const spaces[] = {SS_NAMESPACE, SS_PRIMVARS SS_NAMESPACE};
enum { SPACES = 2 };

/* A patch, and its number in the order in which they are applied. */
typedef struct patch_name {
    const char *name;
    int32_t patch;
} patch_name;

typedef struct search {
    skinslide_stage_finding finding; /* the first member, which is what callers get */
    ss_memory memory;
    skinslide_stage_prim prim;
    const char **patches;
    patch_name *by_name; /* [patch_count] */
    ss_paint_names paint;
    const skinslide_stage_problem **problems;
    int32_t room; /* how many problems there is room for */
} search;

/* ---- Saying ---- */

static bool make_room(search *own) {
    int32_t count = own->finding.problem_count, room = own->room ? 2 * own->room : 8;
    if (count < own->room)
        return true;
    const skinslide_stage_problem **problems = SS_NEW(&own->memory, const skinslide_stage_problem *, room);
    if (!problems)
        return false;
    if (count)
        memcpy(problems, own->problems, (size_t)count * sizeof *problems);
    own->problems = problems, own->room = room;
    return true;
}

__attribute__((format(printf, 4, 5))) static void report(search *own, skinslide_severity severity, const char *patch,
                                                         const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *message = SS_NEW(&own->memory, char, (int64_t)length + 1);
    skinslide_stage_problem *problem = SS_NEW(&own->memory, skinslide_stage_problem, 1);
    if (message && problem && make_room(own)) {
        vsnprintf(message, (size_t)length + 1, format, again);
        *problem = (skinslide_stage_problem){severity, patch, message};
        own->problems[own->finding.problem_count++] = problem;
    }
    va_end(again);
}

/* ---- Names ---- */

/* "elbow" of "SkinSlideAPI:elbow", "" of the schema alone, NULL of another. */
static const char *patch_of_schema(const char *schema) {
    if (strcmp(schema, SS_SCHEMA) == 0)
        return "";
    return strncmp(schema, schema_prefix, sizeof schema_prefix - 1) == 0 ? schema + sizeof schema_prefix - 1 : NULL;
}

static int by_name(const void *a, const void *b) {
    const patch_name *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    return order ? order : x->patch - y->patch;
}

/* Sorts the patches by name. False if memory is short. */
static bool sort_patches(search *own) {
    int32_t count = own->finding.patch_count;
    own->by_name = SS_NEW(&own->memory, patch_name, count);
    if (own->memory.failed)
        return false;
    for (int32_t i = 0; i < count; i++)
        own->by_name[i] = (patch_name){own->patches[i], i};
    qsort(own->by_name, (size_t)count, sizeof *own->by_name, by_name);
    return true;
}

/* Lists the patches. Returns whether each application of the schema names one. */
static bool list_patches(search *own) {
    bool nameless = false;
    for (int32_t i = 0; i < own->prim.schema_count; i++) {
        const char *patch = patch_of_schema(own->prim.schemas[i]);
        if (patch && *patch)
            own->patches[own->finding.patch_count++] = ss_copy_text(&own->memory, patch);
        nameless = nameless || (patch && !*patch);
    }
    if (nameless)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL, "%s is applied without a patch's name; apply %s:NAME", SS_SCHEMA,
               SS_SCHEMA);
    return !nameless;
}

/* A property in a namespace of patches, "skinSlide:left:elbow:envelope": of left:elbow, its envelope. */
typedef struct place {
    int32_t space;
    const char *patch;
    size_t patch_length; /* 0: of no patch */
    const char *name;
    size_t name_length;
} place;

/* How long a name is without the ending of indices of a primvar. */
static size_t without_indices(const char *property) {
    size_t length = strlen(property), ending = sizeof SS_INDICES - 1;
    return length > ending && strcmp(property + length - ending, SS_INDICES) == 0 ? length - ending : length;
}

static place place_of(const char *property) {
    for (int32_t space = 0; space < SPACES; space++) {
        size_t skipped = strlen(spaces[space]), length = without_indices(property);
        if (strncmp(property, spaces[space], skipped) != 0)
            continue;
        if (length < skipped)
            break;
        const char *patch = property + skipped, *name = property + length;
        while (name > patch && name[-1] != ':')
            name--;
        size_t patch_length = name > patch ? (size_t)(name - patch) - 1 : 0;
        return (place){space, patch, patch_length, name, (size_t)(property + length - name)};
    }
    return (place){0};
}

/* Like strcmp, of the first `length` letters of a text and a name. */
static int compare(const char *text, size_t length, const char *name) {
    int order = strncmp(text, name, length);
    return order ? order : -(name[length] != 0);
}

/* The patches in by_name whose name is the first `length` letters of a text: from *first to before the number returned. */
static int32_t find_named(const search *own, const char *text, size_t length, int32_t *first) {
    int32_t low = 0, high = own->finding.patch_count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (compare(text, length, own->by_name[middle].name) > 0)
            low = middle + 1;
        else
            high = middle;
    }
    for (*first = low; low < own->finding.patch_count && compare(text, length, own->by_name[low].name) == 0;)
        low++;
    return low;
}

static bool is_applied(const search *own, const place *at) {
    int32_t first;
    return find_named(own, at->patch, at->patch_length, &first) > first;
}

static bool is_setting(const place *at) {
    for (int32_t group = SKINSLIDE_STAGE_PATCH; group <= SKINSLIDE_STAGE_CONTROLS; group++) {
        int32_t count;
        const ss_input *inputs = ss_inputs((skinslide_stage_group)group, &count);
        for (int32_t i = 0; i < count; i++)
            if (strcmp(inputs[i].shown.prefix, spaces[at->space]) == 0 && strlen(inputs[i].shown.name) == at->name_length &&
                strncmp(inputs[i].shown.name, at->name, at->name_length) == 0)
                return true;
    }
    return false;
}

/* ---- Properties of no patch, and of no setting ---- */

static int by_text(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The names of patches that have properties but are not applied, each once, in order. */
static void report_unapplied(search *own) {
    const char **names = SS_NEW(&own->memory, const char *, own->prim.property_count);
    int32_t count = 0;
    for (int32_t i = 0; names && i < own->prim.property_count; i++) {
        place at = place_of(own->prim.properties[i]);
        if (!at.patch_length || is_applied(own, &at) || ss_is_reserved(at.patch, strcspn(at.patch, ":")) ||
            ss_is_paint(&own->paint, own->prim.properties[i]))
            continue;
        char *name = SS_NEW(&own->memory, char, (int64_t)at.patch_length + 1);
        if (!name)
            return;
        memcpy(name, at.patch, at.patch_length);
        names[count++] = name;
    }
    if (count)
        qsort(names, (size_t)count, sizeof *names, by_text);
    for (int32_t i = 0; i < count; i++)
        if (!i || strcmp(names[i], names[i - 1]) != 0)
            report(own, SKINSLIDE_SEVERITY_WARNING, names[i],
                   "has properties, but %s:%s is not applied to the prim, so it does not slide", SS_SCHEMA, names[i]);
}

/* A property in the namespace of a patch, at any depth, that is none of its settings. */
typedef struct stray {
    int32_t patch, space, property;
} stray;

static int by_patch(const void *a, const void *b) {
    const stray *x = a, *y = b;
    return x->patch != y->patch ? x->patch - y->patch : x->space != y->space ? x->space - y->space : x->property - y->property;
}

/* The length of a name without its last colon and what follows it. */
static size_t outer(const char *name, size_t length) {
    while (length > 0 && name[length - 1] != ':')
        length--;
    return length > 0 ? length - 1 : 0;
}

/* Lists the patches in whose namespaces a property is stray; out may be NULL. Returns how many. A setting of a patch is not
 * stray in the namespaces that the patch itself lies in. */
static int32_t list_strays(const search *own, int32_t property, stray *out) {
    place at = place_of(own->prim.properties[property]);
    bool applied = at.patch_length && is_applied(own, &at);
    int32_t count = 0;
    if ((applied && is_setting(&at)) || ss_is_paint(&own->paint, own->prim.properties[property]))
        return 0;
    for (size_t length = at.patch_length; length > 0; length = applied ? 0 : outer(at.patch, length)) {
        int32_t first, end = find_named(own, at.patch, length, &first);
        for (int32_t i = first; i < end; i++, count++)
            if (out)
                out[count] = (stray){own->by_name[i].patch, at.space, property};
    }
    return count;
}

static void report_unknown(search *own) {
    int32_t count = 0;
    for (int32_t i = 0; i < own->prim.property_count; i++)
        count += list_strays(own, i, NULL);
    stray *strays = SS_NEW(&own->memory, stray, count);
    if (!strays)
        return;
    count = 0;
    for (int32_t i = 0; i < own->prim.property_count; i++)
        count += list_strays(own, i, strays + count);
    qsort(strays, (size_t)count, sizeof *strays, by_patch);
    for (int32_t i = 0; i < count; i++)
        report(own, SKINSLIDE_SEVERITY_WARNING, own->patches[strays[i].patch],
               "%s is not a setting of a patch, and has no effect", own->prim.properties[strays[i].property]);
}

/* ---- Paint under names that are none ---- */

/* Whether the mesh has an opinion on foldCase. */
static bool says_case(const skinslide_stage_prim *prim) {
    int32_t count;
    const skinslide_stage_input *input = &ss_inputs(SKINSLIDE_STAGE_MESH, &count)[SS_ROW_FOLD_CASE].shown;
    bool found = false;
    for (int32_t i = 0; i < prim->property_count; i++) {
        const char *name = prim->properties[i];
        size_t length = strlen(input->prefix);
        found = found || (strncmp(name, input->prefix, length) == 0 && strcmp(name + length, input->name) == 0);
    }
    return found;
}

/* Whether a name like those of paint has two parts, a patch and an input: the primvars that a bake writes of the skin have
 * one. */
static bool has_parts(const char *name) {
    const char *patch = name + sizeof SS_PRIMVARS SS_NAMESPACE - 1;
    size_t length = strcspn(patch, ":_");
    return patch[length] && !ss_is_reserved(patch, length);
}

static void report_misnamed(search *own) {
    bool case_is_said = says_case(&own->prim);
    for (int32_t i = 0; i < own->paint.count; i++) {
        const char *name = own->paint.names[i], *patch = own->paint.patches[i];
        if (name[without_indices(name)])
            continue; /* the warning is of the primvar that they index */
        if (patch && own->paint.in_another_case[i] && !case_is_said)
            report(own, SKINSLIDE_SEVERITY_WARNING, patch,
                   "%s is paint in another case, and has no effect unless " SS_NAMESPACE "foldCase is on", name);
        else if (!patch && !place_of(name).patch_length && has_parts(name))
            report(own, SKINSLIDE_SEVERITY_WARNING, NULL, "%s is not paint of an applied patch, and has no effect", name);
    }
}

/* ---- UsdSkel ---- */

static bool has_influences(const skinslide_stage_prim *prim) {
    return prim->has_joint_indices || prim->blend_shape_count;
}

/* Why UsdSkel does not skin a mesh that has influences; NULL: it does. */
static const char *why_not_skinned(const skinslide_stage_prim *prim) {
    return !prim->skel_root                                       ? "there is no SkelRoot above it"
           : !prim->skeleton                                      ? "no Skeleton is bound to it below the SkelRoot"
           : !prim->has_joint_weights && !prim->blend_shape_count ? "its joint indices have no weights"
                                                                  : NULL;
}

static void warn_of_skinning(search *own) {
    const skinslide_stage_prim *prim = &own->prim;
    if (own->finding.skinned_by && prim->point_samples)
        report(own, SKINSLIDE_SEVERITY_WARNING, NULL,
               "points have samples, but UsdSkel skins them again; remove the skinning where they are baked");
    if (!own->finding.skinned_by && has_influences(prim) && !prim->point_samples)
        report(own, SKINSLIDE_SEVERITY_WARNING, NULL, "UsdSkel does not skin it: %s", why_not_skinned(prim));
}

/* ---- Why not ---- */

/* Reports why the patches cannot be slid. Returns whether nothing was reported. */
static bool report_why_not(search *own) {
    const skinslide_stage_prim *prim = &own->prim;
    const char *type = ss_type_of(prim->type_name);
    int32_t before = own->finding.problem_count;
    if (prim->instance)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL,
               "is inside an instance, whose points are shared; author instanceable = false on %s", prim->instance);
    else if (prim->instancer)
        report(
            own, SKINSLIDE_SEVERITY_ERROR, NULL,
            "is a prototype of the point instancer %s, whose instances share its points; slide a mesh outside it, or put the "
            "baked mesh in its place",
            prim->instancer);
    else if (!prim->is_defined)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL,
               "is not defined, there are only overs; is the path right, and does the cache below it open?");
    else if (!prim->is_mesh)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL, "is a %s; %s applies to Mesh only", type, SS_SCHEMA);
    else if (prim->slid_by)
        report(own, SKINSLIDE_SEVERITY_WARNING, NULL, "is slid already, by %s; bake that file, or put the cache in its place",
               prim->slid_by);
    else if (prim->baked_by)
        report(
            own, SKINSLIDE_SEVERITY_ERROR, NULL,
            "points are slid already, by the bake in %s; slide the cache instead: open the stage without that layer, or remove "
            "the baked attributes from it",
            prim->baked_by);
    else if (own->finding.skinned_by && !prim->reads_skinning)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL,
               "points are skinned by UsdSkel, which a .skinslide file cannot do; bake the stage instead, or write the skinned "
               "points into a layer to sublayer: skinslide cache STAGE -o cache.usdc");
    return own->finding.problem_count == before;
}

static void warn_of_variant(search *own) {
    if (own->prim.variant && own->prim.variant_set)
        report(
            own, SKINSLIDE_SEVERITY_WARNING, NULL,
            "points come from the variant %s of %s, and what is slid stands whichever is selected; bake into that variant, or "
            "keep it selected",
            own->prim.variant, own->prim.variant_set);
}

/* ---- The finding ---- */

static skinslide_status prepare(search *own, const skinslide_stage_prim *prim, skinslide_error *error) {
    own->prim = (skinslide_stage_prim)SKINSLIDE_STAGE_PRIM_DEFAULT;
    skinslide_status status = ss_take(prim, "skinslide_stage_prim", &own->prim, sizeof own->prim, error);
    if (status)
        return status;
    if (own->prim.schema_count < 0 || own->prim.property_count < 0 || (own->prim.schema_count && !own->prim.schemas) ||
        (own->prim.property_count && !own->prim.properties))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no names of schemas or properties, or a negative count of them");
    own->patches = SS_NEW(&own->memory, const char *, own->prim.schema_count);
    return own->memory.failed ? ss_out_of_memory(error) : SKINSLIDE_OK;
}

static void look(search *own) {
    if (own->prim.uncomposed)
        report(own, SKINSLIDE_SEVERITY_ERROR, NULL, "USD could not compose this: %s", own->prim.uncomposed);
    bool named = list_patches(own);
    if (own->memory.failed || !sort_patches(own))
        return;
    if (own->prim.is_mesh) {
        own->paint =
            ss_list_paint(&own->memory, own->prim.properties, own->prim.property_count, own->patches, own->finding.patch_count);
        report_unapplied(own), report_unknown(own), report_misnamed(own);
    }
    if (has_influences(&own->prim) && !why_not_skinned(&own->prim))
        own->finding.skinned_by = ss_copy_text(&own->memory, own->prim.skeleton);
    if (own->finding.patch_count)
        own->finding.slides = report_why_not(own) && named;
    if (own->finding.slides)
        warn_of_variant(own), warn_of_skinning(own);
    own->finding.patches = own->patches;
    own->finding.problems = own->problems;
}

skinslide_status skinslide_stage_find(const skinslide_stage_prim *prim, skinslide_stage_finding **out, skinslide_error *error) {
    if (!prim || !out)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no prim, or no place for the finding");
    search *own = calloc(1, sizeof *own);
    if (!own)
        return ss_out_of_memory(error);
    skinslide_status status = prepare(own, prim, error);
    if (!status)
        look(own);
    if (!status && own->memory.failed)
        status = ss_out_of_memory(error);
    if (status)
        skinslide_stage_finding_destroy(&own->finding);
    else
        *out = &own->finding;
    return status;
}

void skinslide_stage_finding_destroy(skinslide_stage_finding *finding) {
    if (!finding)
        return;
    search *own = (search *)finding;
    ss_free(&own->memory);
    free(own);
}

skinslide_status skinslide_stage_nothing(const char *where, skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_PATCH, "nothing to slide: no mesh%s%.300s has %s applied", where ? " " : "",
                   where ? where : "", SS_SCHEMA);
}
