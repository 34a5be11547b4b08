/* skinslide/stage.h: what SkinSlideAPI means. Values as a scene holds them become what skinslide.h takes, or one sentence.
 *
 * A reader of scenes (of USD, of a host application) fetches values and hands each over as a record: names, numbers and tokens
 * as they were authored. It checks nothing, expands nothing and has no defaults: all of that is done here, so that a scene
 * means the same in every reader. It asks here what there is to fetch, so that it need not change when the schema grows.
 *
 * How a reader uses it, in order
 *     1. A prim that mentions the schema: its facts to skinslide_stage_find, which gives the patches it carries, why they
 *        cannot be slid, and what to warn of.
 *     2. skinslide_stage_mesh_create, and each input of the group MESH to skinslide_stage_mesh_take; its primvars to
 *        skinslide_stage_mesh_offer, its way to the world to skinslide_stage_mesh_space.
 *     3. For each patch skinslide_stage_patch_create, each input of the group PATCH to skinslide_stage_patch_take, the child
 *        prim of the patch's name to skinslide_stage_patch_take_subset and, where there is one, each input of the group SUBSET
 *        to skinslide_stage_patch_take. Paint, here and in 4, is found by skinslide_stage_patch_property.
 *        If skinslide_stage_patch_wants_neighbours says so, the other meshes in its space to skinslide_stage_patch_meet.
 *     4. Its controls at the first time: skinslide_stage_controls_create, each input of the group CONTROLS to
 *        skinslide_stage_controls_take; then, for textures, the input that skinslide_stage_controls_coordinates gives, and the
 *        files that skinslide_stage_controls_need asks for.
 *     5. If skinslide_stage_patch_needs_subdivision says so of any patch, the inputs of the group SUBDIVISION to
 *        skinslide_stage_mesh_take.
 *     6. skinslide_stage_mesh_get and skinslide_stage_patch_get: what skinslide_slider_create takes, with the weld that
 *        skinslide_stage_mesh_weld begins and that is shown every sample of points.
 *     7. For each frame, its points to skinslide_stage_points. Where controls vary, each thread makes a controls handle from
 *        that of step 4 and hands those that vary to it; skinslide_stage_controls_get gives what skinslide_slide takes.
 *     8. What follows from points: skinslide_stage_derived_create, each input of the group DERIVED and each primvar that
 *        skinslide_stage_derived_offer accepts to skinslide_stage_derived_take, its later samples to
 *        skinslide_stage_derived_check, then skinslide_stage_derived_value for each of its outputs at each time.
 * Every message names the property, by the name in its record, and the element; the reader puts prim, patch and frame in front.
 * A handle that refused a value may still be given the others, so that a reader can report all errors; it then gives nothing
 * until a value that it can use replaces the refused one.
 *
 * Conventions are those of skinslide.h. Records, and what they point to, are read during the call only. A handle may be read by
 * any number of threads, but changed by one at a time, while no other uses it.
 */
#ifndef SKINSLIDE_STAGE_H
#define SKINSLIDE_STAGE_H

#include "skinslide.h"

#ifndef SKINSLIDE_CDEF
#include <stddef.h>
#ifdef __cplusplus
extern "C" {
#endif
#endif

/* ---- Records ------------------------------------------------------------------------------------------------------------- */

/* What a record holds. */
typedef enum skinslide_value_type {
    SKINSLIDE_VALUE_NONE,    /* nothing: not authored, or blocked at all times */
    SKINSLIDE_VALUE_BLOCKED, /* authored, but with no value at this time */
    SKINSLIDE_VALUE_BOOL,    /* uint8_t, 0 or 1 */
    SKINSLIDE_VALUE_UINT8,
    SKINSLIDE_VALUE_INT32,
    SKINSLIDE_VALUE_UINT32,
    SKINSLIDE_VALUE_INT64,
    SKINSLIDE_VALUE_UINT64,
    SKINSLIDE_VALUE_HALF, /* uint16_t, the bits of an IEEE 754 binary16 */
    SKINSLIDE_VALUE_FLOAT,
    SKINSLIDE_VALUE_DOUBLE,
    SKINSLIDE_VALUE_TEXT,  /* a token or a string: data is the text itself, UTF-8 and ended by 0 */
    SKINSLIDE_VALUE_ASSET, /* the path of a file, as TEXT: anchored, so that it does not depend on the layer that authored it */
    SKINSLIDE_VALUE_OTHER  /* a value of another kind: data is not read, and type_name says what it is */
} skinslide_value_type;

/* One value of a property at one time. Start from SKINSLIDE_VALUE_DEFAULT: none. */
typedef struct skinslide_value {
    size_t size;           /* sizeof(skinslide_value) */
    const char *name;      /* of the property, for sentences: "primvars:skinSlide:elbow_L:weight" */
    const char *type_name; /* as the scene declares it: "float[]", "color3f[]"; NULL: after type */
    skinslide_value_type type;
    skinslide_bool is_array;
    int32_t width; /* numbers in an element: 1, 2 of a texCoord2f, 3 of a point3f */
    int64_t count; /* elements; 1 of what is no array */
    const void *data;
    const char *interpolation;             /* as authored; NULL: it is not */
    const struct skinslide_value *indices; /* of an indexed primvar: its int[]; NULL: it is not indexed */
} skinslide_value;

#define SKINSLIDE_VALUE_DEFAULT                                                                                                \
    { sizeof(skinslide_value), 0, 0, SKINSLIDE_VALUE_NONE, 0, 1, 0, 0, 0, 0 }

/* How many elements a record has, indices applied; 0 where it has no value. */
SKINSLIDE_API int64_t skinslide_value_length(const skinslide_value *value);

/* The elements of an array of whole numbers; of a record of no value there are none.
 *   out  out [skinslide_value_length]; NULL: the record is only checked
 * Fails with BAD_CONTROL ("NAME is not an array of int"; a whole number that does not fit; an index that is out of range: names
 * it), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_value_integers(const skinslide_value *value, int32_t *out, skinslide_error *error);

/* The elements of an array of three halves, floats or doubles each, likewise.
 *   out  out [skinslide_value_length][3]; NULL: the record is only checked
 * Fails with BAD_CONTROL ("NAME is not an array of points"; an index that is out of range: names it), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_value_positions(const skinslide_value *value, float *out, skinslide_error *error);

/* ---- What there is to fetch ---------------------------------------------------------------------------------------------- */

typedef enum skinslide_stage_group {
    SKINSLIDE_STAGE_MESH,        /* to skinslide_stage_mesh_take */
    SKINSLIDE_STAGE_SUBDIVISION, /* the same, where a patch needs it */
    SKINSLIDE_STAGE_PATCH,       /* to skinslide_stage_patch_take */
    SKINSLIDE_STAGE_CONTROLS,    /* to skinslide_stage_controls_take */
    SKINSLIDE_STAGE_DERIVED,     /* to skinslide_stage_derived_take */
    SKINSLIDE_STAGE_LIVE,        /* to skinslide_stage_live_take */
    SKINSLIDE_STAGE_SUBSET,      /* of the child prim of a patch's name: to skinslide_stage_patch_take */
    SKINSLIDE_STAGE_COORDINATES  /* no group to list, but what skinslide_stage_controls_coordinates gives */
} skinslide_stage_group;

/* When a value is fetched. The first time is that of the first sample or, without samples, the default time. */
typedef enum skinslide_stage_when {
    SKINSLIDE_STAGE_FIRST,        /* at the first time */
    SKINSLIDE_STAGE_STILL,        /* the same; every later sample goes to the handle's *_check, and so does a default that the
                                   * first sample hides, with the frame of that */
    SKINSLIDE_STAGE_DEFAULT_TIME, /* the default value, whatever samples there are */
    SKINSLIDE_STAGE_ANIMATED      /* at the first time, and at every frame where it varies */
} skinslide_stage_when;

/* A property to fetch. Its name on the prim is prefix and name; of the groups PATCH and CONTROLS, with PATCH: between them. */
typedef struct skinslide_stage_input {
    const char *name;          /* "faceVertexCounts", "weight" */
    const char *type_name;     /* as USD or the schema declares it; of what may have several types, one */
    const char *fallback;      /* what it is where it is not authored, as text; NULL: nothing */
    const char *const *tokens; /* those that it may be, in the order of the core's enum, then NULL; NULL: it is no choice */
    skinslide_stage_group group;
    const char *prefix; /* "", "primvars:", "skinSlide:", "primvars:skinSlide:" */
    skinslide_stage_when when;
    skinslide_bool is_primvar;   /* it may have indices, in NAME:indices */
    skinslide_bool is_inherited; /* if the mesh has none, that of the nearest ancestor that has one counts, if it is constant */
} skinslide_stage_input;

/* Whether the values of an input are paths of files. */
SKINSLIDE_API skinslide_bool skinslide_stage_is_texture(const skinslide_stage_input *input);

/* The first input of a group for NULL, else the one after `before`; NULL after the last. They live as long as the library. Hand
 * their values over in this order. */
SKINSLIDE_API const skinslide_stage_input *skinslide_stage_next_input(skinslide_stage_group group,
                                                                      const skinslide_stage_input *before);

/* Checks a value to be authored for an input of the group PATCH or LIVE, as far as is possible without a mesh: that it is one
 * of its tokens, or that it may be indices of points.
 * Fails with BAD_CONTROL (names it by the record's name), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_check_value(const skinslide_stage_input *input, const skinslide_value *value,
                                                           skinslide_error *error);

/* ---- Prims --------------------------------------------------------------------------------------------------------------- */

/* "SkinSlideAPI": a prim to which it is applied, as SkinSlideAPI:PATCH, carries a patch. A static string. */
SKINSLIDE_API const char *skinslide_stage_schema(void);

/* Whether a name may be a patch's, as far as the schema is concerned: not "", and none that it uses for something else. */
SKINSLIDE_API skinslide_bool skinslide_stage_can_name_patch(const char *name);

/* Words for messages of readers' own. */
typedef enum skinslide_phrase {
    SKINSLIDE_PHRASE_NO_TYPE,   /* in place of the type of a prim that has none */
    SKINSLIDE_PHRASE_NO_FILE,   /* that a file is missing */
    SKINSLIDE_PHRASE_IRREGULAR, /* that a file is a pipe, a socket or a device; behind its name */
    SKINSLIDE_PHRASE_UNREADABLE /* that a file, or a value in one, cannot be read; behind its name */
} skinslide_phrase;

/* A static string; NULL for another number. */
SKINSLIDE_API const char *skinslide_stage_phrase(skinslide_phrase phrase);

/* Facts of a prim. Start from SKINSLIDE_STAGE_PRIM_DEFAULT. */
typedef struct skinslide_stage_prim {
    size_t size;               /* sizeof(skinslide_stage_prim) */
    const char *type_name;     /* "Mesh"; NULL: it has none */
    skinslide_bool is_mesh;    /* a Mesh, or of a type made from it */
    skinslide_bool is_defined; /* it and its ancestors are, by more than overs */
    const char *instance;      /* the path of the instance that it is inside of, or NULL */
    const char *instancer;     /* the path of the point instancer that it, or what it is below, is a prototype of; or NULL */
    const char *slid_by;       /* the file that computes its points as slid already, or NULL */
    const char *baked_by;      /* the layer of an earlier bake that its points, or their default value, come from; or NULL */
    int32_t point_samples;     /* how many samples its points have */
    skinslide_bool has_joint_indices; /* primvars:skel:jointIndices has a value, be it inherited */
    int32_t blend_shape_count;        /* targets of skel:blendShapeTargets */
    int32_t schema_count;             /* of applied schemas */
    int32_t property_count;           /* of authored properties that begin with skinSlide: or primvars: */
    const char *const *schemas;       /* [schema_count] their names, in order */
    const char *const *properties;    /* [property_count] their names */
    const char *uncomposed;           /* what USD could not compose of it, in one line; or NULL */
    const char *variant_set;          /* of the variant that its points come from; NULL: of none, or of the one written into */
    const char *variant;              /* its name */
    const char *skel_root;            /* the path of the nearest SkelRoot, the prim itself or an ancestor; or NULL */
    const char *skeleton;             /* that of the Skeleton that is bound to it, at or below that; NULL: none, or unbound */
    skinslide_bool has_joint_weights; /* primvars:skel:jointWeights has a value, be it inherited */
    skinslide_bool reads_skinning;    /* the reader asks UsdSkel for points, and takes those for the cache */
} skinslide_stage_prim;

#define SKINSLIDE_STAGE_PRIM_DEFAULT                                                                                           \
    { sizeof(skinslide_stage_prim), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

typedef enum skinslide_severity { SKINSLIDE_SEVERITY_WARNING, SKINSLIDE_SEVERITY_ERROR } skinslide_severity;

/* One thing to say about a prim. */
typedef struct skinslide_stage_problem {
    skinslide_severity severity;
    const char *patch; /* NULL: the prim as a whole */
    const char *message;
} skinslide_stage_problem;

typedef struct skinslide_stage_finding {
    skinslide_bool slides; /* it carries patches, and none of these facts stops them from being slid */
    int32_t patch_count;
    int32_t problem_count;
    const char *const *patches;                     /* [patch_count] their names, in the order of the schemas */
    const skinslide_stage_problem *const *problems; /* [problem_count] */
    const char *skinned_by; /* the path of the Skeleton by which UsdSkel moves its points, patches or not; NULL: it does not */
} skinslide_stage_finding;

/* Looks at a prim.
 *   out  out, the caller's to destroy
 * Fails with BAD_ARGUMENT (NULL, a negative count), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_find(const skinslide_stage_prim *prim, skinslide_stage_finding **out,
                                                    skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_stage_finding_destroy(skinslide_stage_finding *finding);

/* The message for a scene in which no mesh carries a patch: always fails, with BAD_PATCH.
 *   where  in  "on the stage"; NULL: nowhere in particular */
SKINSLIDE_API skinslide_status skinslide_stage_nothing(const char *where, skinslide_error *error);

/* ---- Meshes -------------------------------------------------------------------------------------------------------------- */

/* One mesh of a scene: its faces, its rest points, how it is subdivided. */
typedef struct skinslide_stage_mesh skinslide_stage_mesh;

/* Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_create(skinslide_stage_mesh **out, skinslide_error *error);

/* NULL does nothing. Destroy its patches first. */
SKINSLIDE_API void skinslide_stage_mesh_destroy(skinslide_stage_mesh *mesh);

/* Takes the value of an input of the group MESH or SUBDIVISION. What comes later needs points, face counts and face indices,
 * and fails if these were refused. Rest points are the first candidate that is authored.
 * Fails with BAD_POINTS (points and rest points), BAD_CONTROL (numbers), BAD_MESH (the others; each names what it cannot use),
 * BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_take(skinslide_stage_mesh *mesh, const skinslide_stage_input *input,
                                                         const skinslide_value *value, skinslide_error *error);

/* Checks that a later sample of an input that must stay the same does so.
 *   frame  in  its time, for the message
 * Fails as skinslide_stage_mesh_take ("NAME changes at frame 1002; it must stay the same over time"). */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_check(const skinslide_stage_mesh *mesh, const skinslide_stage_input *input,
                                                          const skinslide_value *value, double frame, skinslide_error *error);

/* The mesh as the slider takes it; its arrays are the handle's. subdivision is NULL if it was not taken, or there is none.
 * Fails with BAD_ARGUMENT where something is missing, or was refused. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_get(const skinslide_stage_mesh *mesh, skinslide_mesh *out,
                                                        skinslide_error *error);

/* The same as soon as points and faces are there, which patches need; rest points may be missing, and are then NULL.
 * Fails with BAD_ARGUMENT where points or faces are missing, or were refused. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_faces(const skinslide_stage_mesh *mesh, skinslide_mesh *out,
                                                          skinslide_error *error);

/* Where the rest points were found: "primvars:Pref", "points (default)"; "" before that. Lives as long as the mesh. */
SKINSLIDE_API const char *skinslide_stage_mesh_rest_source(const skinslide_stage_mesh *mesh);

/* A warning of rest points that are not finite, and count for nothing, since no face has them; NULL: none. Lives as long as the
 * mesh. */
SKINSLIDE_API const char *skinslide_stage_mesh_rest_warning(const skinslide_stage_mesh *mesh);

/* A warning of rest points of another scale, which are scaled to the cache's; NULL: none. Lives as long as the mesh. Rest is
 * compared with the points of the first time, edge by edge, unless skinSlide:compareRest is off. */
SKINSLIDE_API const char *skinslide_stage_mesh_warning(const skinslide_stage_mesh *mesh);

/* Takes the transform of the mesh to the world: at the first time, then at those at which the transforms above it were
 * authored. If skinSlide:worldSpace is on, lengths are those in the world.
 *   to_world  in  [4][4] takes points, as rows, to the world
 *   frame     in  its time, for the message
 * If lengths are those in the world, fails with BAD_CONTROL (the mesh is flat there, the transform changes its shape over time
 * and not only its size, not finite), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_space(skinslide_stage_mesh *mesh, const double to_world[16], double frame,
                                                          skinslide_error *error);

/* A warning of transforms that scale the mesh more one way than another, if lengths are those in its own space; NULL: none.
 * Lives as long as the mesh. */
SKINSLIDE_API const char *skinslide_stage_mesh_space_warning(const skinslide_stage_mesh *mesh);

/* Begins to weld points, as skinslide_weld_create does, with skinSlide:weldTolerance.
 *   setups  in   [setup_count] all patches of the mesh
 *   out     out  the caller's to destroy; NULL where skinSlide:weld is off
 * Fails as skinslide_weld_create and skinslide_stage_mesh_get. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_weld(const skinslide_stage_mesh *mesh, const skinslide_patch_setup *setups,
                                                         int32_t setup_count, skinslide_weld **out, skinslide_error *error);

/* Whether the mesh's orientation is leftHanded. */
SKINSLIDE_API skinslide_bool skinslide_stage_mesh_left_handed(const skinslide_stage_mesh *mesh);

/* The points of a frame.
 *   points  out [vertex_count][3]; NULL: the record is only checked, as where its data are floats that can be used as they are
 * Fails with BAD_POINTS (no value, not points, another count than at first), BAD_ARGUMENT. The slider checks whether they are
 * finite. */
SKINSLIDE_API skinslide_status skinslide_stage_points(const skinslide_stage_mesh *mesh, const skinslide_value *value,
                                                      float *points, skinslide_error *error);

/* Fails as skinslide_slide would for the points of a frame, for readers that check frames before they slide them.
 *   points  in  [vertex_count][3]
 * Fails with BAD_POINTS (not finite: names the first vertex), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_stage_check_points(const skinslide_stage_mesh *mesh, const float *points,
                                                            skinslide_error *error);

/* Texture coordinates of the mesh's corners.
 *   value  in  a primvar of pairs of halves, floats or doubles: faceVarying, vertex or varying
 *   st     out [index_count][2]
 * Fails with BAD_CONTROL (another interpolation, type or length, an index out of range), BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_stage_coordinates(const skinslide_stage_mesh *mesh, const skinslide_value *value,
                                                           float *st, skinslide_error *error);

/* Offers a primvar of the mesh itself, so that errors can list those that may be texture coordinates. Offer each that has a
 * value, in the order of their names, before patches are read.
 *   name           in  "primvars:map1"
 *   type_name      in  as the scene declares it: "texCoord2f[]"
 *   interpolation  in  as authored; NULL: it is not
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_mesh_offer(skinslide_stage_mesh *mesh, const char *name, const char *type_name,
                                                          const char *interpolation, skinslide_error *error);

/* The primvars that may be texture coordinates: "primvars:map1, primvars:uv"; "" if there are none. Lives as long as the mesh.
 * */
SKINSLIDE_API const char *skinslide_stage_mesh_coordinates(const skinslide_stage_mesh *mesh);

/* The values by which any primvar chooses points: bools, ints or floats by vertex.
 *   numbers  out [vertex_count]
 * Fails with BAD_PATCH (another type, interpolation or length, an index out of range, a number that is not finite),
 * BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_stage_painted(const skinslide_stage_mesh *mesh, const skinslide_value *value,
                                                       double *numbers, skinslide_error *error);

/* ---- Patches ------------------------------------------------------------------------------------------------------------- */

/* What a shot sets for every patch of a file. Start from SKINSLIDE_STAGE_LIVE_DEFAULT: nothing. */
typedef struct skinslide_stage_live {
    size_t size;           /* sizeof(skinslide_stage_live) */
    double envelope;       /* scales each patch's own */
    int32_t interpolation; /* a skinslide_interpolation in place of each patch's own, or -1: its own */
    skinslide_lookup lookup;
} skinslide_stage_live;

#define SKINSLIDE_STAGE_LIVE_DEFAULT                                                                                           \
    { sizeof(skinslide_stage_live), 1, -1, SKINSLIDE_LOOKUP_AUTO }

/* Takes the value of an input of the group LIVE; one that has no value leaves *live as it is. A number may come as a number or,
 * where it is none, as TEXT.
 * Fails with BAD_CONTROL, BAD_ARGUMENT, and leaves *live alone. */
SKINSLIDE_API skinslide_status skinslide_stage_live_take(skinslide_stage_live *live, const skinslide_stage_input *input,
                                                         const skinslide_value *value, skinslide_error *error);

/* One patch: its faces and its settings, which do not change over time. */
typedef struct skinslide_stage_patch skinslide_stage_patch;

/* Makes a patch with the fallbacks of the schema.
 *   mesh  in  has its face counts and indices; must outlive the patch
 *   name  in  copied
 *   live  in  or NULL: nothing
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_create(const skinslide_stage_mesh *mesh, const char *name,
                                                            const skinslide_stage_live *live, skinslide_stage_patch **out,
                                                            skinslide_error *error);

/* NULL does nothing. Destroy its controls first. */
SKINSLIDE_API void skinslide_stage_patch_destroy(skinslide_stage_patch *patch);

/* Takes the value of an input of the group PATCH or, after its subset was taken, of SUBSET. The primvar of faces may have any
 * name; if it chose faces, those of the subset are ignored.
 * Fails with BAD_PATCH (faces), BAD_CONTROL (the others; each names what it cannot use), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_take(skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                                          const skinslide_value *value, skinslide_error *error);

/* Checks that a later sample of an input that must stay the same does so; of faces, that it chooses the same.
 * Fails as skinslide_stage_patch_take, and with BAD_PATCH or BAD_CONTROL where it changes. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_check(const skinslide_stage_patch *patch,
                                                           const skinslide_stage_input *input, const skinslide_value *value,
                                                           double frame, skinslide_error *error);

/* The child prim of a patch's name. Start from SKINSLIDE_STAGE_SUBSET_DEFAULT. */
typedef struct skinslide_stage_subset {
    size_t size;              /* sizeof(skinslide_stage_subset) */
    const char *path;         /* of the prim, for sentences */
    const char *type_name;    /* of the prim; NULL: it has none */
    skinslide_bool is_subset; /* it is a GeomSubset */
} skinslide_stage_subset;

#define SKINSLIDE_STAGE_SUBSET_DEFAULT                                                                                         \
    { sizeof(skinslide_stage_subset), 0, 0, 0 }

/* Takes the child prim whose inputs follow; NULL: there is none. Does nothing if the primvar chose faces.
 * Fails with BAD_PATCH (no such child, no GeomSubset), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_take_subset(skinslide_stage_patch *patch,
                                                                 const skinslide_stage_subset *subset, skinslide_error *error);

/* Sorts names [count] of properties so that names that differ only in case, or in underscores for colons, are next to each
 * other. */
SKINSLIDE_API void skinslide_stage_sort_names(const char **names, int32_t count);

/* Finds the property that an input of a patch is. Paint may have the schema's name, else that name with underscores for colons,
 * as written by tools that know no namespaces (primvars:skinSlide_elbow_L_weight), else, if skinSlide:foldCase is on, either of
 * these in another case.
 *   input  in  of the group PATCH or CONTROLS
 *   names  in  [count] the properties of a prim that have values or are blocked, sorted by skinslide_stage_sort_names
 * Returns its index in names; -1 where it is none of them, and always if the input is no primvar. */
SKINSLIDE_API int32_t skinslide_stage_patch_property(const skinslide_stage_patch *patch, const skinslide_stage_input *input,
                                                     const char *const *names, int32_t count);

/* Describes paint that is not as the schema has it: its name, its type, the channel that counts, that its mean counts.
 *   value  in   of an input of the group PATCH or CONTROLS
 *   text   out  [512] "weight comes from primvars:skinSlide_elbow_L_weight, color3f[], channel r"
 * Returns 0, and leaves text alone, if it is as the schema has it, or no primvar. */
SKINSLIDE_API skinslide_bool skinslide_stage_patch_describe(const skinslide_stage_patch *patch,
                                                            const skinslide_stage_input *input, const skinslide_value *value,
                                                            char text[512]);

/* The faces of the patch so far, ascending: those chosen and, once its grow and its rule are taken, those that join them. They
 * live as long as the patch, until other faces are taken. NULL and 0 before the first are.
 *   face_count  out, or NULL */
SKINSLIDE_API const int32_t *skinslide_stage_patch_faces(const skinslide_stage_patch *patch, int32_t *face_count);

/* A warning, once its faces are there, of rest points that resemble the cache poorly; NULL: none. Lives as long as the patch,
 * until faces are taken again. */
SKINSLIDE_API const char *skinslide_stage_patch_warning(const skinslide_stage_patch *patch);

/* Whether borders of the patch could slide, but must stay where another mesh meets them: `holes` frees them, and skinSlide:weld
 * is on. */
SKINSLIDE_API skinslide_bool skinslide_stage_patch_wants_neighbours(const skinslide_stage_patch *patch);

/* Takes another mesh in the same space, such as a head above a body: borders stay where it has points in the same places as the
 * patch, to within skinSlide:weldTolerance. A mesh that has a point at each of the patch's is a copy of it, and is ignored.
 *   others  in  [count][3] at the time at which the points of the patch's mesh were taken; those that are not finite are passed
 *               over
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_meet(skinslide_stage_patch *patch, const float *others, int32_t count,
                                                          skinslide_error *error);

/* Whether its interpolation depends on how the mesh is subdivided. */
SKINSLIDE_API skinslide_bool skinslide_stage_patch_needs_subdivision(const skinslide_stage_patch *patch);

/* ---- Controls ------------------------------------------------------------------------------------------------------------ */

/* What is painted and animated on a patch, at one time. The memory is used again for one frame after another. */
typedef struct skinslide_stage_controls skinslide_stage_controls;

/* Makes controls with the fallbacks of the schema.
 *   patch  in  has its faces and settings; must outlive the controls. Without faces, all of the mesh's count as its own
 *   base   in  controls of the patch from whose values these begin, which must outlive them and not change; or NULL. Nothing
 *              is copied, so controls of a thread's own take memory only for what varies
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_controls_create(const skinslide_stage_patch *patch,
                                                               const skinslide_stage_controls *base,
                                                               skinslide_stage_controls **out, skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_stage_controls_destroy(skinslide_stage_controls *controls);

/* Takes the value of an input of the group CONTROLS, or of the input of texture coordinates. Paint is expanded into memory that
 * the controls keep; off the patch, where it is often 0, it does not count.
 * Fails with BAD_CONTROL (names what it cannot use; what is wrong with texture coordinates skinslide_stage_controls_need
 * reports), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_controls_take(skinslide_stage_controls *controls,
                                                             const skinslide_stage_input *input, const skinslide_value *value,
                                                             skinslide_error *error);

/* The primvar with texture coordinates, such as primvars:st, as one more input; NULL if no texture is authored. Textures are
 * sampled once there are the asset, which is an input, this primvar, and each file that skinslide_stage_controls_need asks for;
 * for a frame, those of them that vary. The input lives as long as the patch. */
SKINSLIDE_API const skinslide_stage_input *skinslide_stage_controls_coordinates(const skinslide_stage_controls *controls);

/* A file that a texture is made of. */
typedef struct skinslide_stage_need {
    const skinslide_stage_input *input; /* the texture's */
    const char *path;                   /* that of the asset, with the tile's number where it says <UDIM> */
    int32_t tile;                       /* that number; 0 of a file without tiles */
    int64_t largest;                    /* bytes of the largest file that is accepted: larger ones need not be read */
} skinslide_stage_need;

/* The next file that is needed: the same one until it is given. Ask when all values of a frame are taken.
 *   need  out  NULL if there is none; it lives until the next call that changes the controls
 * Fails with BAD_CONTROL (no texture coordinates: says which setting names them; what skinslide_stage_coordinates fails with;
 * coordinates that are in no tile), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_controls_need(skinslide_stage_controls *controls,
                                                             const skinslide_stage_need **need, skinslide_error *error);

/* A file that was asked for. Start from SKINSLIDE_STAGE_FILE_DEFAULT: a missing one. */
typedef struct skinslide_stage_file {
    size_t size;          /* sizeof(skinslide_stage_file) */
    const char *path;     /* as it was resolved; NULL: there is no such file */
    const uint8_t *bytes; /* [byte_count] all of it; NULL: it is open, unreadable or too large, or its image is held */
    int64_t byte_count;
    const char *reason;        /* why it cannot be read; NULL: that is not known, or it was read */
    const int32_t *descriptor; /* of an open file that has the bytes, as for skinslide_exr_read; NULL: there is none */
    int64_t offset;            /* where the bytes begin in it */
} skinslide_stage_file;

#define SKINSLIDE_STAGE_FILE_DEFAULT                                                                                           \
    { sizeof(skinslide_stage_file), 0, 0, 0, 0, 0, 0 }

/* Whether the texture that is asked for still holds the image of a file from an earlier time: its bytes are then not needed. */
SKINSLIDE_API skinslide_bool skinslide_stage_controls_holds(const skinslide_stage_controls *controls, const char *path);

/* Takes the file that is asked for; with the last file of a texture, samples it. If that fails, its other files are no longer
 * asked for.
 * Fails with BAD_CONTROL (no such file, not readable, too large, coordinates that are not finite, a texture that is not finite
 * or not a force density somewhere), BAD_IMAGE, UNSUPPORTED (as skinslide_exr_decode), BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_controls_give(skinslide_stage_controls *controls,
                                                             const skinslide_stage_file *file, skinslide_error *error);

/* A tile of a texture that was sampled. */
typedef struct skinslide_stage_tile {
    int32_t number; /* 0 of a texture without tiles */
    int32_t width, height;
} skinslide_stage_tile;

/* A texture that was sampled; lives until its controls change. */
typedef struct skinslide_stage_texture {
    const char *name;    /* of the attribute */
    const char *file;    /* resolved, with <UDIM> for the tile's number */
    const char *channel; /* in the file */
    const char *st;      /* the primvar that it was sampled at */
    int32_t tile_count;
    const skinslide_stage_tile *tiles; /* [tile_count], ascending */
} skinslide_stage_texture;

/* The texture of an input, or NULL where there is none. */
SKINSLIDE_API const skinslide_stage_texture *skinslide_stage_controls_texture(const skinslide_stage_controls *controls,
                                                                              const skinslide_stage_input *input);

/* The controls as the slider takes them; the arrays are those of the handle, of its patch or of its base.
 * Fails with BAD_CONTROL (paint times a texture that is no force density: names the point), BAD_ARGUMENT (a value was refused,
 * a texture is not complete), OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_controls_get(skinslide_stage_controls *controls, skinslide_controls *out,
                                                            skinslide_error *error);

/* The inputs of a patch, of the groups PATCH and CONTROLS, that are set but that its rule does not read, such as corners under
 * the rule even: the first for NULL, else the one after `before`; NULL after the last. Inputs with the schema's fallback do not
 * count as set. */
SKINSLIDE_API const skinslide_stage_input *skinslide_stage_next_unread(const skinslide_stage_patch *patch,
                                                                       const skinslide_stage_controls *controls,
                                                                       const skinslide_stage_input *before);

/* The set-up as the slider takes it, with these controls; its arrays, its name and its controls are those of the handles.
 * Fails as skinslide_stage_controls_get does, with BAD_POINTS if rest is so unlike the cache over its faces that sliding would
 * be senseless, and with BAD_ARGUMENT if the patch has no faces, or refused a value. */
SKINSLIDE_API skinslide_status skinslide_stage_patch_get(const skinslide_stage_patch *patch, skinslide_stage_controls *controls,
                                                         skinslide_patch_setup *out, skinslide_error *error);

/* ---- Times --------------------------------------------------------------------------------------------------------------- */

/* Sorts times; of those that differ by no more than the noise that layer offsets leave, 1e-6, the one given first stays. Give
 * the samples of points first, then those of each patch's controls that vary, in the order of its inputs, with the samples of
 * indices and of texture coordinates.
 *   times  in, out  [count], finite; then those that stay
 *   count  in, out
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_merge_times(double *times, int64_t *count, skinslide_error *error);

/* The frames between samples. Cached points go straight from one sample to the next, but slid points do not: where samples are
 * more than 1 apart, the whole times between must be slid too.
 *   times          in   [count] as skinslide_stage_merge_times leaves them
 *   between        out  [*between_count], ascending; NULL: they are only counted
 *   between_count  out
 * Fails with BAD_ARGUMENT (more than 10,000,000: names the frame by which there are). */
SKINSLIDE_API skinslide_status skinslide_stage_times_between(const double *times, int64_t count, double *between,
                                                             int64_t *between_count, skinslide_error *error);

/* "1012" for 1012.0 and "1012.25" for 1012.25, without the noise of layer offsets: how messages write a frame.
 *   text  out [32] */
SKINSLIDE_API void skinslide_stage_frame_text(double frame, char *text);

/* ---- What follows from points -------------------------------------------------------------------------------------------- */

/* What a mesh has, beside its points, that follows from them: normals, tangents and other vectors on the skin, which are
 * carried with it; velocities and accelerations, which are recomputed. */
typedef struct skinslide_stage_derived skinslide_stage_derived;

/* Makes a handle for what follows from the points of a mesh, which is nothing yet.
 *   mesh         in  has its points and faces; must outlive this
 *   point_times  in  [point_time_count] the samples of points, ascending; copied
 *   rate         in  time codes per second
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_create(const skinslide_stage_mesh *mesh, const double *point_times,
                                                              int64_t point_time_count, double rate,
                                                              skinslide_stage_derived **out, skinslide_error *error);

/* Says that the frames between samples of points, as skinslide_stage_times_between lists them, are slid too: rates of change
 * are then those from frame to frame.
 * Fails as skinslide_stage_times_between, and with OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_fill(skinslide_stage_derived *derived, skinslide_error *error);

/* NULL does nothing. */
SKINSLIDE_API void skinslide_stage_derived_destroy(skinslide_stage_derived *derived);

/* Finds whether a primvar of the mesh itself follows from points, by its name or the role of its type. Offer each that has a
 * value, in the order of their names.
 *   name           in  "primvars:tangents"
 *   type_name      in  as the scene declares it: "vector3f[]"
 *   interpolation  in  as authored; NULL: it is not
 *   element_size   in  its elementSize; 1 where that is not authored
 *   input          out  an input to take after those of the group DERIVED, which lives as long as derived; NULL: it does not
 *                  follow, or is not known how to, of which there is then a warning
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_offer(skinslide_stage_derived *derived, const char *name,
                                                             const char *type_name, const char *interpolation,
                                                             int32_t element_size, const skinslide_stage_input **input,
                                                             skinslide_error *error);

/* Takes an input of the group DERIVED, in the order of its inputs, or one that was offered. Each makes outputs, or none if it
 * does not count.
 *   value  in  at its first time
 *   times  in  [time_count] its samples and those of its indices, each once, ascending
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY: what cannot be recomputed becomes an output that is blocked. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_take(skinslide_stage_derived *derived,
                                                            const skinslide_stage_input *input, const skinslide_value *value,
                                                            const double *times, int64_t time_count, skinslide_error *error);

/* Warning `number`, from 0; NULL beyond the last: vectors of one pose on points that move, and primvars whose names say that
 * they follow the skin, but that cannot be carried. Lives as long as derived. */
SKINSLIDE_API const char *skinslide_stage_derived_warning(const skinslide_stage_derived *derived, int32_t number);

/* Checks a later sample of an input, once all inputs are taken: one that cannot be used, since it has another length, or
 * vectors too long to be turned, blocks its output at all times.
 * Fails with BAD_ARGUMENT, OUT_OF_MEMORY. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_check(skinslide_stage_derived *derived,
                                                             const skinslide_stage_input *input, const skinslide_value *value,
                                                             skinslide_error *error);

/* An attribute to write beside the points. */
typedef struct skinslide_stage_output {
    const char *name;          /* "primvars:normals" */
    const char *type_name;     /* "normal3f[]"; of a primvar, as its record says */
    int32_t pose_count;        /* poses that a value of it takes: 1, 2 or 3; 0: it is blocked at all times */
    int32_t count;             /* elements of a value */
    const char *reason;        /* why it is blocked; NULL if it is not, or is without a warning */
    const char *hidden;        /* what would be read in its place if only it were blocked: block that too; or NULL */
    skinslide_bool is_carried; /* its pose needs turns */
    skinslide_bool is_double;  /* its values are doubles, and not floats */
} skinslide_stage_output;

/* Output `number`, from 0; NULL beyond the last. Lives as long as derived. */
SKINSLIDE_API const skinslide_stage_output *skinslide_stage_derived_output(const skinslide_stage_derived *derived,
                                                                           int32_t number);

/* The times of the poses that the value of an output at a time needs: the time itself or, for rates, the samples of points next
 * to it on either side, with the time itself between them for a second difference; at an end, it and those nearest to it.
 *   times  out [pose_count] ascending. Returns how many there are: fewer where there are too few samples. */
SKINSLIDE_API int32_t skinslide_stage_derived_times(const skinslide_stage_derived *derived,
                                                    const skinslide_stage_output *output, double time, double times[3]);

/* Points of one time. Start from SKINSLIDE_STAGE_POSE_DEFAULT. */
typedef struct skinslide_stage_pose {
    size_t size; /* sizeof(skinslide_stage_pose) */
    double time;
    const float *cached; /* [vertex_count][3] before sliding */
    const float *slid;   /* [vertex_count][3] after */
    const float *turns;  /* [vertex_count][3] as skinslide_workspace_turns gives them, for what is carried; NULL: none is */
} skinslide_stage_pose;

#define SKINSLIDE_STAGE_POSE_DEFAULT                                                                                           \
    { sizeof(skinslide_stage_pose), 0, 0, 0, 0 }

/* The value of an output at a time.
 *   value  in  the cache's, of the input that the output is of
 *   poses  in  [pose_count] at the times that skinslide_stage_derived_times gives
 *   out    out [count][3] floats, or doubles where the output says so; indices are applied. Values that do not change keep
 *          their bits
 * Fails with BAD_POINTS (no value, of a wrong type or length, too few samples of points), BAD_ARGUMENT, OUT_OF_MEMORY. Block
 * the output at all times then: if only one sample were missing, its neighbours would be used instead. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_value(const skinslide_stage_derived *derived,
                                                             const skinslide_stage_output *output, const skinslide_value *value,
                                                             const skinslide_stage_pose *poses, int32_t pose_count, void *out,
                                                             skinslide_error *error);

/* Counts the vectors or rates in a value of an output that are not finite: they are copied as they are.
 *   value    in  the cache's, of the input that the output is of
 *   faults   out how many there are; 0 of a value that cannot be used
 *   warning  out, or NULL: if there are any, names the property and the first
 * Fails with BAD_ARGUMENT. */
SKINSLIDE_API skinslide_status skinslide_stage_derived_faults(const skinslide_stage_derived *derived,
                                                              const skinslide_stage_output *output,
                                                              const skinslide_value *value, int32_t *faults,
                                                              skinslide_error *warning, skinslide_error *error);

/* ---- Text ---------------------------------------------------------------------------------------------------------------- */

/* Checks that the text of a .skinslide file may be given to USD, whose parser runs out of stack where brackets nest too deep,
 * and ends at a zero byte as if that were the end.
 *   text  in  [byte_count] USDA, which need not end with 0
 * Fails with BAD_ARGUMENT (it does not begin as USDA does, or holds a zero byte), UNSUPPORTED (brackets nest more than 500
 * deep: names the line). The message goes behind the name of the file. */
SKINSLIDE_API skinslide_status skinslide_stage_text(const char *text, int64_t byte_count, skinslide_error *error);

#ifndef SKINSLIDE_CDEF
#ifdef __cplusplus
}
#endif
#endif

#endif
