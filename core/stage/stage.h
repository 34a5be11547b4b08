/* What the files of this room share: records, the table of all that is read, and the handles.
 *
 *     finding                                          a prim
 *     inputs ─► values ─► topology, rest, scheme       a mesh
 *                         settings (faces)             a patch
 *                         controls (maps, textures)    a frame
 *                         follows ─► derived (times)
 *                         outputs                      what follows from points */
#ifndef SS_STAGE_H
#define SS_STAGE_H

#include "base.h"
#include "skinslide/stage.h"

/* ---- values.c: records ---- */

/* A caller's record, completed: its names are not NULL, and its type is NONE or BLOCKED if it has no value. */
typedef struct ss_record {
    skinslide_value value;
    skinslide_value indices; /* of type NONE if it is not indexed */
    int64_t length;          /* elements, indices applied */
} ss_record;

/* NULL opens as no value. Fails with BAD_ARGUMENT if the record is malformed. */
skinslide_status ss_open(const skinslide_value *given, ss_record *record, skinslide_error *error);
bool ss_has_value(const ss_record *record);
/* Whether its type is half, float or double. */
bool ss_is_real(const skinslide_value *value);
/* Whether it is a single number, not an array. */
bool ss_is_number(const ss_record *record);
/* The interpolation as authored, else constant, USD's default. */
const char *ss_interpolation(const ss_record *record);
/* Whether it is vertex, or varying, which on a mesh is the same. */
bool ss_is_by_vertex(const char *interpolation);
/* Fails if an index is out of range, and names the first. */
skinslide_status ss_check_indices(const ss_record *record, skinslide_status status, skinslide_error *error);
/* Number k of an element, indices applied, as a double. */
double ss_number(const ss_record *record, int64_t element, int32_t k);
/* Which elements [length] have a first number above 0. */
void ss_mark_positive(const ss_record *record, uint8_t *marked);

/* Fails: the record is empty. */
skinslide_status ss_refuse_empty(const ss_record *record, skinslide_status status, skinslide_error *error);
/* Fails if it is not by vertex; of begins the message. */
skinslide_status ss_check_by_vertex(const ss_record *record, const char *of, skinslide_status status, skinslide_error *error);
/* Check what the record is an array of. Fail with status. */
skinslide_status ss_check_integers(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_floats(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_positions(const ss_record *record, skinslide_status status, skinslide_error *error);
/* The same without checking indices, of which there may be many. */
skinslide_status ss_check_triples(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_length(const ss_record *record, int64_t count, const char *of, skinslide_status status,
                                 skinslide_error *error);
/* Copy a record that was checked: out [length], and out [length][width]. */
void ss_copy_integers(const ss_record *record, int32_t *out);
void ss_copy_floats(const ss_record *record, float *out);

/* A value as it is shown in a sentence: 'x' for text, a number, [1, 2, ...], or the name of another type. */
const char *ss_shown(const ss_record *record, char text[256]);

/* Shortens names and paths to fit a sentence: a name keeps its beginning, a path its end.
 *     ss_fail(error, status, SS_NAMED " has no value", SS_NAME(name)) */
#define SS_NAMED      "%.*s%s"
#define SS_NAME(name) ss_name_length(name), (name), ss_name_more(name)
#define SS_FILED      "%s%s"
#define SS_FILE(path) ss_file_less(path), ss_file_tail(path)
int ss_name_length(const char *name);
const char *ss_name_more(const char *name);
const char *ss_file_less(const char *path);
const char *ss_file_tail(const char *path);

/* The type of a prim as it is shown in a sentence; it may have none. */
const char *ss_type_of(const char *type_name);

/* Copies text into memory. NULL if memory is short. */
char *ss_copy_text(ss_memory *memory, const char *text);

/* ---- inputs.c: the table ---- */

typedef enum ss_kind {
    SS_KIND_POINTS,
    SS_KIND_FACE_COUNTS,
    SS_KIND_FACE_INDICES,
    SS_KIND_ORIENTATION,
    SS_KIND_REST,
    SS_KIND_CHOICE, /* one of its tokens */
    SS_KIND_WORD,   /* any token */
    SS_KIND_INTEGERS,
    SS_KIND_FLOATS,
    SS_KIND_FACES,
    SS_KIND_CORNERS,
    SS_KIND_EDGES,
    SS_KIND_NUMBER,  /* one number for the patch or the mesh */
    SS_KIND_PAINT,   /* by point, by face or constant */
    SS_KIND_FACTORS, /* by painted edge */
    SS_KIND_TEXTURE, /* multiplies paint by point */
    SS_KIND_CARRIED, /* vectors that turn with the skin */
    SS_KIND_RATE     /* rates of change of the points */
} ss_kind;

/* The rules that read an input, as bits. */
#define SS_RULE(rule) (1u << SKINSLIDE_RULE_##rule)
enum { SS_PLANE = SS_RULE(UNIT) | SS_RULE(FAST), SS_NO_PLANE = SS_RULE(RELAXED) | SS_RULE(EVEN) };

/* What a number must be. */
typedef enum ss_range { SS_RANGE_FINITE, SS_RANGE_NOT_NEGATIVE, SS_RANGE_SHARE, SS_RANGE_DENSITY } ss_range;

typedef struct ss_input {
    skinslide_stage_input shown;
    ss_kind kind;
    ss_range range;
    const char *wanted;  /* the range in words */
    double fallback;     /* of a number */
    size_t place;        /* in skinslide_controls: of the number, or of the array by point */
    size_t face_place;   /* likewise of the array by face; 0: it cannot be by face */
    bool drops_constant; /* a constant has no effect */
    float off_patch;     /* the value that replaces paint off the patch */
    int32_t multiplies;  /* of a texture: the row of the paint in its group */
    int32_t channel;     /* of a texture: the row of its channel in the patch's group */
    int32_t pose_count;  /* poses that a derived input needs */
    unsigned rules;      /* the rules that read it, as bits; 0: all */
} ss_input;

static inline bool ss_is_read_by(const ss_input *input, int32_t rule) {
    return !input->rules || input->rules & 1u << rule;
}

/* Rows of the tables, by group. */
enum {
    SS_ROW_POINTS,
    SS_ROW_FACE_COUNTS,
    SS_ROW_FACE_INDICES,
    SS_ROW_ORIENTATION,
    SS_ROW_REST_POINTS,
    SS_ROW_REST,
    SS_ROW_PREF,
    SS_ROW_CAPITAL_PREF,
    SS_ROW_PRIVATE_PREF,
    SS_ROW_DEFAULT_POINTS,
    SS_ROW_WELD,
    SS_ROW_WELD_TOLERANCE,
    SS_ROW_WORLD_SPACE,
    SS_ROW_FOLD_CASE,
    SS_ROW_COMPARE_REST, /* after everything that is compared */
    SS_MESH_ROWS
};
enum {
    SS_ROW_SCHEME,
    SS_ROW_BOUNDARY_RULE,
    SS_ROW_TRIANGLE_RULE,
    SS_ROW_CREASE_LENGTHS,
    SS_ROW_CREASE_INDICES,
    SS_ROW_CREASE_SHARPNESSES,
    SS_ROW_CORNER_INDICES,
    SS_ROW_CORNER_SHARPNESSES,
    SS_ROW_HOLE_INDICES,
    SS_SUBDIVISION_ROWS
};
enum {
    SS_ROW_CHANNEL, /* before the paint that it applies to */
    SS_ROW_FACES,
    SS_ROW_BOUNDARY,
    SS_ROW_HOLES,
    SS_ROW_RULE,
    SS_ROW_INTERPOLATION,
    SS_ROW_GROW,
    SS_ROW_CORNERS,
    SS_ROW_EDGES,
    SS_ROW_WEIGHT_CHANNEL,
    SS_ROW_DENSITY_CHANNEL,
    SS_ROW_HOLD_CHANNEL,
    SS_ROW_ST,
    SS_PATCH_ROWS
};
enum {
    SS_ROW_ENVELOPE,
    SS_ROW_WEIGHT,
    SS_ROW_WEIGHT_MAP,
    SS_ROW_MAX_DISTANCE,
    SS_ROW_DENSITY,
    SS_ROW_DENSITY_MAP,
    SS_ROW_EDGE_DENSITIES,
    SS_ROW_HOLD,
    SS_ROW_HOLD_MAP,
    SS_ROW_STRETCH_RESPONSE,
    SS_ROW_COMPRESSION_RESPONSE,
    SS_CONTROL_ROWS
};
enum { SS_ROW_NORMALS_PRIMVAR, SS_ROW_NORMALS, SS_ROW_VELOCITIES, SS_ROW_ACCELERATIONS, SS_DERIVED_ROWS };
enum { SS_ROW_ELEMENT_TYPE, SS_ROW_SUBSET_INDICES, SS_SUBSET_ROWS };
enum { SS_ROW_LIVE_ENVELOPE, SS_ROW_LIVE_INTERPOLATION, SS_ROW_LIVE_LOOKUP, SS_LIVE_ROWS };

/* The table of a group; out its length. */
const ss_input *ss_inputs(skinslide_stage_group group, int32_t *count);
/* The row of an input in the table of a group; -1 if it is not in it. */
int32_t ss_row_of(skinslide_stage_group group, const skinslide_stage_input *input);
/* Whether a name, in the place of a patch's, has a meaning of its own. */
bool ss_is_reserved(const char *name, size_t length);
/* The name of a patch's property, for a sentence. */
void ss_name_property(skinslide_stage_group group, int32_t row, const char *patch, char text[256]);
/* Whether a number is within a range. */
bool ss_in_range(ss_range range, double number);

/* ---- What was taken ---- */

/* An array of int32_t or of float: both have four bytes. */
typedef struct ss_array {
    void *values;
    int32_t count;
} ss_array;

/* What the value of an input came to: one of these, by its kind. */
typedef struct ss_taken {
    ss_array array;
    const char *word;
    double number;
    int32_t choice;
    bool refused;
} ss_taken;

/* settings.c: takes a record of kind CHOICE, WORD, INTEGERS or FLOATS, or the fallback if it has no value. */
skinslide_status ss_take_plain(const ss_input *input, const ss_record *record, skinslide_status status, ss_memory *memory,
                               ss_taken *taken, skinslide_error *error);
/* Takes one number, or the fallback if there is none. */
skinslide_status ss_take_number(const ss_input *input, const ss_record *record, double *number, skinslide_error *error);
/* Takes the fallbacks of a table. */
skinslide_status ss_take_fallbacks(const ss_input *inputs, int32_t count, ss_memory *memory, ss_taken *taken,
                                   skinslide_error *error);
/* Fails: the record's value changes over time. */
skinslide_status ss_changes(const ss_record *record, double frame, skinslide_status status, skinslide_error *error);
/* Fails if a record does not come to what was taken, and names the frame. */
skinslide_status ss_check_plain(const ss_input *input, const ss_record *record, const ss_taken *taken, double frame,
                                skinslide_status status, skinslide_error *error);
/* Fails if one of them was refused. */
skinslide_status ss_check_refused(const ss_input *inputs, const ss_taken *taken, int32_t count, skinslide_error *error);

/* ---- Handles ---- */

struct skinslide_stage_mesh {
    ss_memory memory;
    ss_taken taken[SS_MESH_ROWS]; /* arrays of face counts and indices */
    ss_taken subdivision[SS_SUBDIVISION_ROWS];
    skinslide_subdivision subdivided; /* points into subdivision; for skinslide_stage_mesh_get */
    int32_t vertex_count;             /* -1: no points yet */
    bool has_faces;                   /* counts and indices fit each other and the points */
    int32_t *face_start;              /* [face_count + 1] */
    float *rest;                      /* NULL: none yet */
    const char *rest_source;
    const char *rest_warning; /* NULL: none */
    int32_t rest_row;         /* the row of the candidate that is used, good or bad; -1: none yet */
    bool left_handed;
    double weld, weld_tolerance; /* whether points in one place are welded, and how near they must be */
    double world_space;          /* whether lengths are measured in world space */
    double fold_case;            /* whether names of paint match in any case */
    double compare_rest;         /* whether rest is to be compared with the cache */
    float *first;                /* [vertex_count][3] points of the first time */
    const char *warning;         /* NULL: none */
    const char *coordinates;     /* primvars that could be texture coordinates, with commas; NULL: none */
    bool has_space;              /* the transform to world space at the first time is known */
    double gram[9], space[9];    /* its G, see scaled.c, and the map to lengths in world space */
    double unevenness;           /* the largest that was warned of; 0: none */
    const char *space_warning;   /* NULL: none */
};

/* The mesh as the core's functions take it, without rest points. */
skinslide_mesh ss_faces_of(const skinslide_stage_mesh *mesh);

/* rest.c, scheme.c: what skinslide_stage_mesh_take and *_check do for their inputs. */
skinslide_status ss_take_rest(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_rest_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, double frame,
                                     skinslide_error *error);
skinslide_status ss_take_subdivision(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_subdivision_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record,
                                            double frame, skinslide_error *error);

/* resemble.c: once both are known, compares rest with the first pose of the cache, and scales it to the cache. */
skinslide_status ss_compare_mesh(skinslide_stage_mesh *mesh, skinslide_error *error);
/* The same over the faces of a patch, which keeps the result. */
skinslide_status ss_compare_patch(skinslide_stage_patch *patch, skinslide_error *error);
/* Fails with BAD_POINTS if the two are so unlike that nothing can slide. */
skinslide_status ss_check_likeness(const skinslide_stage_patch *patch, skinslide_error *error);

struct skinslide_stage_patch {
    ss_memory memory;
    const skinslide_stage_mesh *mesh;
    const char *name;
    skinslide_stage_live live;
    ss_taken taken[SS_PATCH_ROWS];
    const char *st;                    /* such as "primvars:st" */
    skinslide_stage_input coordinates; /* the input of that name */
    bool faces_by_primvar;
    ss_array painted;   /* the chosen faces, ascending */
    ss_array faces;     /* the chosen faces, grown; ascending; none: all faces */
    const char *subset; /* the path of the child that has the faces; NULL: none */
    const char *indices_name;
    ss_array indices;    /* of the subset, as authored */
    ss_array vertices;   /* of faces; ascending */
    ss_memory settled;   /* owns faces and vertices, unless they are authored */
    double way;          /* the distance by which the faces have been grown */
    uint8_t *held;       /* [vertex_count] where other meshes have points; NULL: nowhere */
    double unlike;       /* the factor by which rest differs, if too much to slide; else 0 */
    const char *warning; /* NULL: none */
};

/* ---- paint.c ---- */

/* The properties of a prim whose names begin like those of paint, whatever their case and underscores; sorted. */
typedef struct ss_paint_names {
    int32_t count;
    const char **names;
    const char **patches;  /* [count] whose paint it is, whatever its case and underscores; NULL: nobody's */
    bool *in_another_case; /* [count] */
} ss_paint_names;

/* Empty if memory is short. */
ss_paint_names ss_list_paint(ss_memory *memory, const char *const *properties, int32_t count, const char *const *patches,
                             int32_t patch_count);
/* Whether a property is paint of a patch, or its indices, whatever its case and underscores. */
bool ss_is_paint(const ss_paint_names *all, const char *property);

/* Checks that a record has real numbers, or what may choose faces, and one number for each element, which may be a channel of
 * several. patch names the channel; NULL: none is named. */
skinslide_status ss_check_paint_type(const skinslide_stage_patch *patch, const ss_record *record, bool of_faces,
                                     skinslide_status status, skinslide_error *error);
/* Whether it is by point, or by face corner, which is averaged to points; and a check that its length is right for that. */
bool ss_is_painted_by_vertex(const ss_record *record);
skinslide_status ss_check_painted_vertices(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_status status,
                                           skinslide_error *error);
/* Whether it has, unconverted, one number for each point, for each face or for all. */
bool ss_is_plain_paint(const ss_record *record);
/* Converts a record to one that has, as doubles in room; and how many doubles that takes. */
ss_record ss_plain_paint(const skinslide_stage_patch *patch, const ss_record *record, double *room);
int64_t ss_plain_paint_room(const skinslide_stage_mesh *mesh);

/* faces.c */
skinslide_status ss_take_primvar_faces(skinslide_stage_patch *patch, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_primvar_faces(const skinslide_stage_patch *patch, const ss_record *record, double frame,
                                        skinslide_error *error);
/* The same for an input of the subset. */
skinslide_status ss_take_subset_faces(skinslide_stage_patch *patch, int32_t row, const ss_record *record,
                                      skinslide_error *error);
skinslide_status ss_check_subset_faces(const skinslide_stage_patch *patch, int32_t row, const ss_record *record, double frame,
                                       skinslide_error *error);
/* Lists the faces and vertices of the patch: those chosen, if any are yet, and, under a rule that takes any faces, those
 * connected to them within grow. */
skinslide_status ss_settle_faces(skinslide_stage_patch *patch, skinslide_error *error);
/* The same if the distance by which it grows has changed. */
skinslide_status ss_settle_way(skinslide_stage_patch *patch, skinslide_error *error);

/* ---- textures.c: one map ---- */

typedef struct ss_texture ss_texture;

/* NULL if memory is short. */
ss_texture *ss_texture_create(const ss_input *input, const skinslide_stage_patch *patch);
void ss_texture_destroy(ss_texture *texture);
/* Takes the asset of a time. Its files are not known yet, but images of the time before are still held. */
skinslide_status ss_texture_take(ss_texture *texture, const ss_record *record, skinslide_error *error);
/* Takes the asset of another texture in the same way. */
skinslide_status ss_texture_repeat(ss_texture *texture, const ss_texture *of, skinslide_error *error);
/* Whether, as far as is known, a file is named at some time. */
bool ss_texture_authored(const ss_texture *texture);
/* Whether there is a map. */
bool ss_texture_wanted(const ss_texture *texture);
/* Finds the tiles that the patch needs; st [index_count][2] are the mesh's. A failure here or below drops the map. */
skinslide_status ss_texture_find_tiles(ss_texture *texture, const float *st, skinslide_error *error);
/* The next file that is needed, or NULL. */
const skinslide_stage_need *ss_texture_need(const ss_texture *texture);
bool ss_texture_holds(const ss_texture *texture, const char *path);
/* Fails if value is not allowed for the paint at a vertex. multiplied: whether it is a product of paint and map, or the map's
 * own. */
skinslide_status ss_texture_check(const ss_texture *texture, bool multiplied, int32_t vertex, float value,
                                  skinslide_error *error);
/* Takes the file that was needed. With the last one, samples the map, and checks it as the paint that it multiplies. */
skinslide_status ss_texture_give(ss_texture *texture, const float *st, const skinslide_stage_file *file,
                                 skinslide_error *error);
/* Drops the map. */
void ss_texture_drop(ss_texture *texture);
/* By vertex, 1 off the patch; NULL if there is no map, or not yet. */
const float *ss_texture_values(const ss_texture *texture);
const skinslide_stage_texture *ss_texture_shown(const ss_texture *texture);

/* ---- controls.c ---- */

typedef enum ss_paint_layout { SS_LAYOUT_NONE, SS_LAYOUT_VERTEX, SS_LAYOUT_FACE, SS_LAYOUT_EDGE } ss_paint_layout;

/* What an input's values have become. They are in memory of these controls, which is kept from frame to frame, or of the
 * base. */
typedef struct ss_control {
    double number;
    ss_paint_layout layout; /* of values */
    const float *values;
    float *own;
    double *plain;        /* paint converted to one number for each element */
    const float *product; /* paint by vertex times its map; NULL: not multiplied yet */
    float *own_product;
    const ss_texture *texture;
    const ss_texture *base_texture; /* the base's texture, until another is taken */
    ss_texture *own_texture;
    bool unplaced; /* own_texture must find its tiles anew, since its asset or the coordinates are new */
    bool refused;
} ss_control;

struct skinslide_stage_controls {
    ss_memory memory;
    const skinslide_stage_patch *patch;
    ss_control controls[SS_CONTROL_ROWS];
    const float *st; /* [index_count][2] of this or of the base; NULL: none was taken */
    float *own_st;
    skinslide_status st_status; /* why there is no st, for when a map needs it */
    skinslide_error st_error;
    skinslide_controls given; /* what skinslide_stage_controls_get gave last */
};

/* The input in a row of the table. */
const ss_input *ss_control_input(int32_t row);
/* Whether an input has an effect at the time of the controls. */
bool ss_controls_have(const skinslide_stage_controls *controls, int32_t row);
/* The controls as the slider takes them, owned by the handle. */
skinslide_status ss_give_controls(skinslide_stage_controls *controls, const skinslide_controls **given, skinslide_error *error);

/* ---- maps.c ---- */

/* Takes a texture's asset. */
skinslide_status ss_take_texture(skinslide_stage_controls *controls, int32_t row, const ss_record *record,
                                 skinslide_error *error);
/* Takes the texture coordinates. */
skinslide_status ss_take_coordinates(skinslide_stage_controls *controls, const skinslide_value *value, skinslide_error *error);

/* ---- follows.c: primvars that follow the skin ---- */

#define SS_PRIMVARS "primvars:"
#define SS_INDICES  ":indices" /* the ending of the name of a primvar's indices */

/* A primvar of a mesh as it is declared. */
typedef struct ss_primvar {
    const char *name; /* "primvars:tangents" */
    const char *type_name, *interpolation;
    int32_t element_size;
} ss_primvar;

typedef enum ss_following {
    SS_FOLLOWS_NOT,
    SS_FOLLOWS,         /* as an input of kind, which needs pose_count poses */
    SS_FOLLOWS_UNKNOWN, /* seems to, but cannot be carried: warning says why */
} ss_following;

/* Whether a primvar follows the skin, and as what. SS_FOLLOWS_NOT also for other properties, and for inputs of a table. */
ss_following ss_follows(const ss_primvar *primvar, ss_kind *kind, int32_t *pose_count, skinslide_error *warning);

/* ---- derived.c ---- */

/* An output, in a list. */
typedef struct ss_derivation {
    skinslide_stage_output output;
    const ss_input *input;
    skinslide_normals_layout layout; /* of vectors that are carried */
    struct ss_derivation *next;
} ss_derivation;

struct skinslide_stage_derived {
    ss_memory memory;
    const skinslide_stage_mesh *mesh;
    double *point_times; /* [point_time_count] as authored; merged they are fewer */
    int64_t point_time_count;
    double *merged; /* point_times merged and, once filled, with the frames between */
    int64_t merged_count;
    double rate;
    bool primvar_counts;          /* primvars:normals win over normals */
    ss_derivation *first, **last; /* outputs */
    struct ss_offer *offers;
    struct ss_warning *warnings, **last_warning;
};

/* ---- outputs.c ---- */

/* How many elements a value has. */
int32_t ss_derived_length(const skinslide_stage_mesh *mesh, skinslide_normals_layout layout);
/* Whether the values of an output are doubles. */
bool ss_is_written_double(const ss_input *input, const ss_record *record);
/* Fails if a value of an input cannot be used: its type, its length, indices, vectors that are too long to be turned. */
skinslide_status ss_check_derived(const skinslide_stage_mesh *mesh, const ss_input *input, const ss_record *record,
                                  skinslide_normals_layout layout, skinslide_error *error);
/* Fails: there are too few samples of points for a rate. */
skinslide_status ss_refuse_poses(int64_t count, int32_t wanted, skinslide_error *error);

/* ---- times.c ---- */

/* Finds up to `count` of the times next to a time, including it where a difference needs it; ascending. */
int32_t ss_samples_around(const double *times, int64_t time_count, double time, int32_t count, double around[3]);

#endif
