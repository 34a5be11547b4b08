/* Which primvars of a mesh follow its skin. By name: tangents and normals under the names in use, and rates of points. By role:
 * all normals and vectors. There is a warning for those that seem to follow by their names, but are of a kind that cannot be
 * carried. */
#include "stage.h"

#include "schema.inc"

#include <string.h>

static const struct {
    const char *name; /* the last part of the primvar's name, in lower case */
    ss_kind kind;
    int32_t pose_count;
} known[] = {
    {"normals", SS_KIND_CARRIED, 1},
    {"normal", SS_KIND_CARRIED, 1},
    {"tangents", SS_KIND_CARRIED, 1},
    {"tangent", SS_KIND_CARRIED, 1},
    {"tangentu", SS_KIND_CARRIED, 1},
    {"tangentv", SS_KIND_CARRIED, 1},
    {"bitangents", SS_KIND_CARRIED, 1},
    {"bitangent", SS_KIND_CARRIED, 1},
    {"binormals", SS_KIND_CARRIED, 1},
    {"binormal", SS_KIND_CARRIED, 1},
    {"velocities", SS_KIND_RATE, 2},
    {"velocity", SS_KIND_RATE, 2},
    {"v", SS_KIND_RATE, 2},
    {"accelerations", SS_KIND_RATE, 3},
    {"acceleration", SS_KIND_RATE, 3},
};

static bool begins(const char *text, const char *with) {
    return strncmp(text, with, strlen(with)) == 0;
}

static bool ends(const char *text, const char *with) {
    size_t length = strlen(text), tail = strlen(with);
    return length >= tail && strcmp(text + length - tail, with) == 0;
}

/* ---- Types ---- */

/* normal3f[], vector3h[]: whether a type has a role that turns with the surface. */
static bool has_role(const char *type) {
    return begins(type, "normal3") || begins(type, "vector3");
}

static bool is_triple(const char *type) {
    return has_role(type) || begins(type, "float3") || begins(type, "half3") || begins(type, "double3");
}

/* Whether a type could hold directions or frames. */
static bool is_directional(const char *type) {
    return ends(type, "[]") && (is_triple(type) || begins(type, "float4") || begins(type, "half4") || begins(type, "double4") ||
                                begins(type, "quat"));
}

/* ---- Names ---- */

enum { LONGEST = 64 };

/* Not tolower, which depends on the host's locale: in Turkish, i is not the lower case of I. */
static char lower(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* The last part of a primvar's name, in lower case. */
static void read_name(const char *primvar, char name[LONGEST]) {
    const char *last = strrchr(primvar, ':');
    size_t length = 0;
    for (const char *c = last ? last + 1 : primvar; *c && length + 1 < LONGEST; c++)
        name[length++] = lower(*c);
    name[length] = 0;
}

/* Whether a primvar is an input of a table, or skinslide's or UsdSkel's own. */
static bool is_elsewhere(const char *primvar) {
    static const char *const spaces[] = {SS_PRIMVARS SS_NAMESPACE, SS_PRIMVARS "skel:"};
    bool found = !begins(primvar, SS_PRIMVARS) || strcmp(primvar, SS_PRIMVARS "normals") == 0;
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++)
        found = found || begins(primvar, spaces[i]);
    return found;
}

/* Nref, restNormals, __Nref: whether a name says that the values are of the rest pose. */
static bool is_of_rest(const char *name) {
    name += strspn(name, "_");
    return begins(name, "rest") || begins(name, "reference") || ends(name, "ref") || ends(name, "_rest");
}

static bool sounds_directional(const char *name) {
    return strstr(name, "normal") || strstr(name, "tangent");
}

static int find_known(const char *primvar, const char *name) {
    if (ends(primvar, ":N"))
        return 0;
    for (int i = 0; i < (int)(sizeof known / sizeof *known); i++)
        if (strcmp(name, known[i].name) == 0)
            return i;
    return -1;
}

/* ---- Both ---- */

static ss_following warn_of(const ss_primvar *primvar, ss_kind kind, skinslide_error *warning) {
    static const char stays[] = "and stays as it is while the skin slides";
    if (primvar->element_size != 1)
        ss_fail(warning, SKINSLIDE_UNSUPPORTED, SS_NAMED " has elementSize %d %s", SS_NAME(primvar->name),
                primvar->element_size, stays);
    else if (kind == SS_KIND_RATE)
        ss_fail(warning, SKINSLIDE_UNSUPPORTED, SS_NAMED " has interpolation %s %s", SS_NAME(primvar->name),
                primvar->interpolation, stays);
    else
        ss_fail(warning, SKINSLIDE_UNSUPPORTED,
                SS_NAMED " is %s %s: make it normal3f[] or vector3f[] if it lies along the surface", SS_NAME(primvar->name),
                primvar->type_name, stays);
    return SS_FOLLOWS_UNKNOWN;
}

ss_following ss_follows(const ss_primvar *primvar, ss_kind *kind, int32_t *pose_count, skinslide_error *warning) {
    char name[LONGEST];
    const char *type = primvar->type_name;
    read_name(primvar->name, name);
    int found = find_known(primvar->name, name);
    if (is_elsewhere(primvar->name) || strcmp(primvar->interpolation, "constant") == 0 || !is_directional(type) ||
        is_of_rest(name))
        return SS_FOLLOWS_NOT;
    if (found < 0 && !has_role(type))
        return sounds_directional(name) ? warn_of(primvar, SS_KIND_CARRIED, warning) : SS_FOLLOWS_NOT;
    *kind = found < 0 ? SS_KIND_CARRIED : known[found].kind, *pose_count = found < 0 ? 1 : known[found].pose_count;
    if (!is_triple(type))
        return warn_of(primvar, SS_KIND_CARRIED, warning);
    if (primvar->element_size != 1 || (*kind == SS_KIND_RATE && !ss_is_by_vertex(primvar->interpolation)))
        return warn_of(primvar, *kind, warning);
    return SS_FOLLOWS;
}
