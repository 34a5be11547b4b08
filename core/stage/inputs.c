/* All that is read, in one table: what SkinSlideAPI declares, what is painted, and what USD has of a mesh. To add an attribute,
 * add it to the schema, add a row here, and give it a member of skinslide_controls or skinslide_patch_setup. */
#include "stage.h"

#include "schema.inc"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TOKENS(...)                                                                                                            \
    (const char *const[]) {                                                                                                    \
        __VA_ARGS__, NULL                                                                                                      \
    }

/* ---- A mesh ---- */

#define USD(name, type, tokens, group, when) .shown = {name, type, NULL, tokens, group, "", when, 0, 0}
#define OF_MESH(name, type, when)            USD(name, type, NULL, SKINSLIDE_STAGE_MESH, when)
#define OF_SUBDIVISION(name, type)           USD(name, type, NULL, SKINSLIDE_STAGE_SUBDIVISION, SKINSLIDE_STAGE_STILL)

#define MESH_SETTING(declared) .shown = {declared, SKINSLIDE_STAGE_MESH, SS_NAMESPACE, SKINSLIDE_STAGE_STILL, 0, 0}

#define REST_PRIMVAR(name)                                                                                                     \
    .kind = SS_KIND_REST,                                                                                                      \
    .shown = {name, "point3f[]", NULL, NULL, SKINSLIDE_STAGE_MESH, SS_PRIMVARS, SKINSLIDE_STAGE_STILL, 1, 0}

static const char positive[] = "finite and above 0", not_negative[] = "0 or more";

static const ss_input mesh_inputs[SS_MESH_ROWS] = {
    [SS_ROW_POINTS] = {OF_MESH("points", "point3f[]", SKINSLIDE_STAGE_FIRST), .kind = SS_KIND_POINTS},
    [SS_ROW_FACE_COUNTS] = {OF_MESH("faceVertexCounts", "int[]", SKINSLIDE_STAGE_STILL), .kind = SS_KIND_FACE_COUNTS},
    [SS_ROW_FACE_INDICES] = {OF_MESH("faceVertexIndices", "int[]", SKINSLIDE_STAGE_STILL), .kind = SS_KIND_FACE_INDICES},
    [SS_ROW_ORIENTATION] = {OF_MESH("orientation", "token", SKINSLIDE_STAGE_STILL), .kind = SS_KIND_ORIENTATION},
    [SS_ROW_REST_POINTS] = {MESH_SETTING(SS_MESH_REST_POINTS), .kind = SS_KIND_REST},
    [SS_ROW_REST] = {REST_PRIMVAR("rest")},
    [SS_ROW_PREF] = {REST_PRIMVAR("pref")},
    [SS_ROW_CAPITAL_PREF] = {REST_PRIMVAR("Pref")},
    [SS_ROW_PRIVATE_PREF] = {REST_PRIMVAR("__Pref")},
    [SS_ROW_DEFAULT_POINTS] = {OF_MESH("points", "point3f[]", SKINSLIDE_STAGE_DEFAULT_TIME), .kind = SS_KIND_REST},
    [SS_ROW_WELD] = {MESH_SETTING(SS_MESH_WELD), .kind = SS_KIND_NUMBER, .fallback = SS_MESH_WELD_NUMBER},
    [SS_ROW_WELD_TOLERANCE] = {MESH_SETTING(SS_MESH_WELD_TOLERANCE), .kind = SS_KIND_NUMBER, .range = SS_RANGE_NOT_NEGATIVE,
                               .wanted = not_negative, .fallback = SS_MESH_WELD_TOLERANCE_NUMBER},
    [SS_ROW_WORLD_SPACE] = {MESH_SETTING(SS_MESH_WORLD_SPACE), .kind = SS_KIND_NUMBER, .fallback = SS_MESH_WORLD_SPACE_NUMBER},
    [SS_ROW_FOLD_CASE] = {MESH_SETTING(SS_MESH_FOLD_CASE), .kind = SS_KIND_NUMBER, .fallback = SS_MESH_FOLD_CASE_NUMBER},
    [SS_ROW_COMPARE_REST] = {MESH_SETTING(SS_MESH_COMPARE_REST), .kind = SS_KIND_NUMBER,
                             .fallback = SS_MESH_COMPARE_REST_NUMBER},
};

/* USD's own tokens, in the order of the core's enums; the fallbacks are USD's. */
#define SUBDIVISION_CHOICE(name, fallback, ...)                                                                                \
    .kind = SS_KIND_CHOICE,                                                                                                    \
    .shown = {name, "token", fallback, TOKENS(__VA_ARGS__), SKINSLIDE_STAGE_SUBDIVISION, "", SKINSLIDE_STAGE_STILL, 0, 0}

static const ss_input subdivision_inputs[SS_SUBDIVISION_ROWS] = {
    [SS_ROW_SCHEME] = {SUBDIVISION_CHOICE("subdivisionScheme", "catmullClark", "none", "catmullClark", "loop", "bilinear")},
    [SS_ROW_BOUNDARY_RULE] = {SUBDIVISION_CHOICE("interpolateBoundary", "edgeAndCorner", "edgeAndCorner", "edgeOnly", "none")},
    [SS_ROW_TRIANGLE_RULE] = {SUBDIVISION_CHOICE("triangleSubdivisionRule", "catmullClark", "catmullClark", "smooth")},
    [SS_ROW_CREASE_LENGTHS] = {OF_SUBDIVISION("creaseLengths", "int[]"), .kind = SS_KIND_INTEGERS},
    [SS_ROW_CREASE_INDICES] = {OF_SUBDIVISION("creaseIndices", "int[]"), .kind = SS_KIND_INTEGERS},
    [SS_ROW_CREASE_SHARPNESSES] = {OF_SUBDIVISION("creaseSharpnesses", "float[]"), .kind = SS_KIND_FLOATS},
    [SS_ROW_CORNER_INDICES] = {OF_SUBDIVISION("cornerIndices", "int[]"), .kind = SS_KIND_INTEGERS},
    [SS_ROW_CORNER_SHARPNESSES] = {OF_SUBDIVISION("cornerSharpnesses", "float[]"), .kind = SS_KIND_FLOATS},
    [SS_ROW_HOLE_INDICES] = {OF_SUBDIVISION("holeIndices", "int[]"), .kind = SS_KIND_INTEGERS},
};

/* ---- A patch ---- */

/* The schema cannot declare what is painted: a declared attribute has one type and a name in the schema's namespace, while
 * paint may have several types, and is in primvars:. */
#define PRIMVAR(name, type, group, when, inherited)                                                                            \
    .shown = {name, type, NULL, NULL, group, SS_PRIMVARS SS_NAMESPACE, when, 1, inherited}
#define SETTING(declared) .shown = {declared, SKINSLIDE_STAGE_PATCH, SS_NAMESPACE, SKINSLIDE_STAGE_FIRST, 0, 0}
#define STEADY(declared)  .shown = {declared, SKINSLIDE_STAGE_PATCH, SS_NAMESPACE, SKINSLIDE_STAGE_STILL, 0, 0}
#define CONTROL(declared) .shown = {declared, SKINSLIDE_STAGE_CONTROLS, SS_NAMESPACE, SKINSLIDE_STAGE_ANIMATED, 0, 0}
#define RESPONSE          .kind = SS_KIND_NUMBER, .range = SS_RANGE_SHARE, .wanted = "0 to 1", .rules = SS_NO_PLANE
#define PAINT(name)       PRIMVAR(name, "float[]", SKINSLIDE_STAGE_CONTROLS, SKINSLIDE_STAGE_ANIMATED, 1), .kind = SS_KIND_PAINT

static const ss_input patch_inputs[SS_PATCH_ROWS] = {
    [SS_ROW_CHANNEL] = {SETTING(SS_PATCH_PAINT_CHANNEL), .kind = SS_KIND_CHOICE},
    [SS_ROW_FACES] = {PRIMVAR("patch", "bool[]", SKINSLIDE_STAGE_PATCH, SKINSLIDE_STAGE_STILL, 0), .kind = SS_KIND_FACES},
    [SS_ROW_BOUNDARY] = {SETTING(SS_PATCH_BOUNDARY), .kind = SS_KIND_CHOICE, .rules = SS_PLANE},
    [SS_ROW_HOLES] = {SETTING(SS_PATCH_HOLES), .kind = SS_KIND_CHOICE},
    [SS_ROW_RULE] = {SETTING(SS_PATCH_FORCE_DENSITY_RULE), .kind = SS_KIND_CHOICE},
    [SS_ROW_INTERPOLATION] = {SETTING(SS_PATCH_INTERPOLATION), .kind = SS_KIND_CHOICE},
    [SS_ROW_GROW] = {STEADY(SS_PATCH_GROW), .kind = SS_KIND_NUMBER, .range = SS_RANGE_NOT_NEGATIVE, .wanted = not_negative,
                     .fallback = SS_PATCH_GROW_NUMBER, .rules = SS_NO_PLANE},
    [SS_ROW_CORNERS] = {STEADY(SS_PATCH_CORNERS), .kind = SS_KIND_CORNERS, .rules = SS_PLANE},
    [SS_ROW_EDGES] = {STEADY(SS_PATCH_EDGES), .kind = SS_KIND_EDGES},
    [SS_ROW_WEIGHT_CHANNEL] = {SETTING(SS_PATCH_WEIGHT_MAP_CHANNEL), .kind = SS_KIND_WORD},
    [SS_ROW_DENSITY_CHANNEL] = {SETTING(SS_PATCH_FORCE_DENSITY_MAP_CHANNEL), .kind = SS_KIND_WORD},
    [SS_ROW_HOLD_CHANNEL] = {SETTING(SS_PATCH_HOLD_MAP_CHANNEL), .kind = SS_KIND_WORD},
    [SS_ROW_ST] = {SETTING(SS_PATCH_MAP_ST), .kind = SS_KIND_WORD},
};

static const ss_input subset_inputs[SS_SUBSET_ROWS] = {
    [SS_ROW_ELEMENT_TYPE] = {USD("elementType", "token", NULL, SKINSLIDE_STAGE_SUBSET, SKINSLIDE_STAGE_STILL),
                             .kind = SS_KIND_WORD},
    [SS_ROW_SUBSET_INDICES] = {USD("indices", "int[]", NULL, SKINSLIDE_STAGE_SUBSET, SKINSLIDE_STAGE_STILL),
                               .kind = SS_KIND_INTEGERS},
};

static const ss_input control_inputs[SS_CONTROL_ROWS] = {
    [SS_ROW_ENVELOPE] = {CONTROL(SS_PATCH_ENVELOPE), .kind = SS_KIND_NUMBER, .fallback = SS_PATCH_ENVELOPE_NUMBER,
                         .place = offsetof(skinslide_controls, envelope)},
    [SS_ROW_WEIGHT] = {PAINT("weight"), .wanted = "a number", .place = offsetof(skinslide_controls, weight)},
    [SS_ROW_WEIGHT_MAP] = {CONTROL(SS_PATCH_WEIGHT_MAP), .kind = SS_KIND_TEXTURE, .multiplies = SS_ROW_WEIGHT,
                           .channel = SS_ROW_WEIGHT_CHANNEL},
    [SS_ROW_MAX_DISTANCE] = {PAINT("maxDistance"), .range = SS_RANGE_NOT_NEGATIVE, .wanted = not_negative,
                             .place = offsetof(skinslide_controls, max_distance)},
    [SS_ROW_DENSITY] = {PAINT("forceDensity"), .range = SS_RANGE_DENSITY, .wanted = positive, .off_patch = 1,
                        .drops_constant = true, .place = offsetof(skinslide_controls, vertex_density),
                        .face_place = offsetof(skinslide_controls, face_density)},
    [SS_ROW_DENSITY_MAP] = {CONTROL(SS_PATCH_FORCE_DENSITY_MAP), .kind = SS_KIND_TEXTURE, .multiplies = SS_ROW_DENSITY,
                            .channel = SS_ROW_DENSITY_CHANNEL},
    [SS_ROW_EDGE_DENSITIES] = {CONTROL(SS_PATCH_EDGE_FORCE_DENSITIES), .kind = SS_KIND_FACTORS, .range = SS_RANGE_DENSITY,
                               .wanted = positive, .place = offsetof(skinslide_controls, edge_density)},
    [SS_ROW_HOLD] = {PAINT("hold"), .range = SS_RANGE_DENSITY, .wanted = positive, .off_patch = 1, .rules = SS_NO_PLANE,
                     .place = offsetof(skinslide_controls, hold)},
    [SS_ROW_HOLD_MAP] = {CONTROL(SS_PATCH_HOLD_MAP), .kind = SS_KIND_TEXTURE, .multiplies = SS_ROW_HOLD,
                         .channel = SS_ROW_HOLD_CHANNEL, .rules = SS_NO_PLANE},
    [SS_ROW_STRETCH_RESPONSE] = {CONTROL(SS_PATCH_STRETCH_RESPONSE), RESPONSE, .fallback = SS_PATCH_STRETCH_RESPONSE_NUMBER,
                                 .place = offsetof(skinslide_controls, stretch_response)},
    [SS_ROW_COMPRESSION_RESPONSE] = {CONTROL(SS_PATCH_COMPRESSION_RESPONSE), RESPONSE,
                                     .fallback = SS_PATCH_COMPRESSION_RESPONSE_NUMBER,
                                     .place = offsetof(skinslide_controls, compression_response)},
};

/* ---- What follows from points, and what a shot sets ---- */

#define OF_DERIVED(name, type, prefix, primvar)                                                                                \
    .shown = {name, type, NULL, NULL, SKINSLIDE_STAGE_DERIVED, prefix, SKINSLIDE_STAGE_ANIMATED, primvar, 0}

static const ss_input derived_inputs[SS_DERIVED_ROWS] = {
    [SS_ROW_NORMALS_PRIMVAR] = {OF_DERIVED("normals", "normal3f[]", SS_PRIMVARS, 1), .kind = SS_KIND_CARRIED, .pose_count = 1},
    [SS_ROW_NORMALS] = {OF_DERIVED("normals", "normal3f[]", "", 0), .kind = SS_KIND_CARRIED, .pose_count = 1},
    [SS_ROW_VELOCITIES] = {OF_DERIVED("velocities", "vector3f[]", "", 0), .kind = SS_KIND_RATE, .pose_count = 2},
    [SS_ROW_ACCELERATIONS] = {OF_DERIVED("accelerations", "vector3f[]", "", 0), .kind = SS_KIND_RATE, .pose_count = 3},
};

#define LIVE(declared) .shown = {declared, SKINSLIDE_STAGE_LIVE, SS_NAMESPACE "live:", SKINSLIDE_STAGE_FIRST, 0, 0}

static const ss_input live_inputs[SS_LIVE_ROWS] = {
    [SS_ROW_LIVE_ENVELOPE] = {LIVE(SS_LIVE_ENVELOPE), .kind = SS_KIND_NUMBER},
    [SS_ROW_LIVE_INTERPOLATION] = {LIVE(SS_LIVE_INTERPOLATION), .kind = SS_KIND_CHOICE},
    [SS_ROW_LIVE_LOOKUP] = {LIVE(SS_LIVE_LOOKUP), .kind = SS_KIND_CHOICE},
};

/* ---- Looking up ---- */

const ss_input *ss_inputs(skinslide_stage_group group, int32_t *count) {
    static const struct {
        const ss_input *inputs;
        int32_t count;
    } tables[] = {
        [SKINSLIDE_STAGE_MESH] = {mesh_inputs, SS_MESH_ROWS},
        [SKINSLIDE_STAGE_SUBDIVISION] = {subdivision_inputs, SS_SUBDIVISION_ROWS},
        [SKINSLIDE_STAGE_PATCH] = {patch_inputs, SS_PATCH_ROWS},
        [SKINSLIDE_STAGE_CONTROLS] = {control_inputs, SS_CONTROL_ROWS},
        [SKINSLIDE_STAGE_DERIVED] = {derived_inputs, SS_DERIVED_ROWS},
        [SKINSLIDE_STAGE_LIVE] = {live_inputs, SS_LIVE_ROWS},
        [SKINSLIDE_STAGE_SUBSET] = {subset_inputs, SS_SUBSET_ROWS},
    };
    bool known = (unsigned)group < sizeof tables / sizeof *tables;
    *count = known ? tables[group].count : 0;
    return known ? tables[group].inputs : NULL;
}

int32_t ss_row_of(skinslide_stage_group group, const skinslide_stage_input *input) {
    int32_t count;
    const ss_input *inputs = ss_inputs(group, &count);
    for (int32_t i = 0; i < count; i++)
        if (&inputs[i].shown == input)
            return i;
    return -1;
}

const skinslide_stage_input *skinslide_stage_next_input(skinslide_stage_group group, const skinslide_stage_input *before) {
    int32_t count, next = before ? ss_row_of(group, before) + 1 : 0;
    const ss_input *inputs = ss_inputs(group, &count);
    return next < count && (!before || next > 0) ? &inputs[next].shown : NULL;
}

skinslide_bool skinslide_stage_is_texture(const skinslide_stage_input *input) {
    int32_t row = ss_row_of(SKINSLIDE_STAGE_CONTROLS, input);
    return row >= 0 && control_inputs[row].kind == SS_KIND_TEXTURE;
}

const char *skinslide_stage_schema(void) {
    return SS_SCHEMA;
}

/* ---- Names and ranges ---- */

/* Names that no patch may have: attributes of the mesh, live as in live:envelope, and cached, under which a bake into the
 * cache's own layer keeps the cache's values. */
bool ss_is_reserved(const char *name, size_t length) {
    static const char *const reserved[] = {"live", "cached"};
    bool found = false;
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
        found = found || (strlen(reserved[i]) == length && strncmp(name, reserved[i], length) == 0);
    for (int32_t i = 0; i < SS_MESH_ROWS; i++) {
        const skinslide_stage_input *own = &mesh_inputs[i].shown;
        bool declared = strcmp(own->prefix, SS_NAMESPACE) == 0;
        found = found || (declared && strlen(own->name) == length && strncmp(name, own->name, length) == 0);
    }
    return found;
}

skinslide_bool skinslide_stage_can_name_patch(const char *name) {
    return name && *name && !ss_is_reserved(name, strcspn(name, ":"));
}

void ss_name_property(skinslide_stage_group group, int32_t row, const char *patch, char text[256]) {
    int32_t count;
    const skinslide_stage_input *input = &ss_inputs(group, &count)[row].shown;
    snprintf(text, 256, "%s" SS_NAMED ":%s", input->prefix, SS_NAME(patch), input->name);
}

bool ss_in_range(ss_range range, double number) {
    switch (range) {
    case SS_RANGE_NOT_NEGATIVE:
        return number >= 0;
    case SS_RANGE_SHARE:
        return number >= 0 && number <= 1;
    case SS_RANGE_DENSITY:
        return isfinite(number) && number > 0;
    default:
        return isfinite(number);
    }
}
