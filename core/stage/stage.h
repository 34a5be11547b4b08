/* What the files of this room know of each other: records, the table of all that is read, and the handles.
 *
 *     finding                                          a prim
 *     inputs ─► values ─► topology, rest, scheme       a mesh
 *                         settings (faces)             a patch
 *                         controls (textures)          a frame
 *                         follows ─► derived (times)   what follows from points */
#ifndef SS_STAGE_H
#define SS_STAGE_H

#include "base.h"
#include "skinslide/stage.h"

/* ---- values.c: records ---- */

/* A record that is whole: with its names, and of no value where there is none. */
typedef struct ss_record {
    skinslide_value value;
    skinslide_value indices; /* of type NONE where it is not indexed */
    int64_t length;          /* elements, indices applied */
} ss_record;

/* NULL opens as no value. Fails with BAD_ARGUMENT where the record itself is none. */
skinslide_status ss_open(const skinslide_value *given, ss_record *record, skinslide_error *error);
bool ss_has_value(const ss_record *record);
/* Whether it is of half, float or double. */
bool ss_is_real(const skinslide_value *value);
/* Whether it is one number, and no array. */
bool ss_is_number(const ss_record *record);
/* As authored, else constant, which is USD's. */
const char *ss_interpolation(const ss_record *record);
/* vertex, or varying, which on a mesh is the same. */
bool ss_is_by_vertex(const char *interpolation);
/* Names the first index that is out of range. */
skinslide_status ss_check_indices(const ss_record *record, skinslide_status status, skinslide_error *error);
/* Number k of an element, indices applied, as a double. */
double ss_number(const ss_record *record, int64_t element, int32_t k);
/* Which elements [length] have a first number above 0. */
void ss_mark_positive(const ss_record *record, uint8_t *marked);

/* That there is nothing in it. */
skinslide_status ss_refuse_empty(const ss_record *record, skinslide_status status, skinslide_error *error);
/* Fails where it is not by vertex; of begins the message. */
skinslide_status ss_check_by_vertex(const ss_record *record, const char *of, skinslide_status status, skinslide_error *error);
/* Checks what the record is an array of. status is what a fault is called. Fails with it. */
skinslide_status ss_check_integers(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_floats(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_positions(const ss_record *record, skinslide_status status, skinslide_error *error);
/* The same but for indices, which may be many. */
skinslide_status ss_check_triples(const ss_record *record, skinslide_status status, skinslide_error *error);
skinslide_status ss_check_length(const ss_record *record, int64_t count, const char *of, skinslide_status status,
                                 skinslide_error *error);
/* Copies a record that was checked: [length], and [length][width]. */
void ss_copy_integers(const ss_record *record, int32_t *out);
void ss_copy_floats(const ss_record *record, float *out);

/* A value in a sentence: 'x' of text, a number, [1, 2, ...], the name of another type. */
const char *ss_shown(const ss_record *record, char text[256]);

/* Names and paths of any length in a sentence of a limited one: the head of a name, the tail of a path.
 *     ss_fail(error, status, SS_NAMED " has no value", SS_NAME(name)) */
#define SS_NAMED      "%.*s%s"
#define SS_NAME(name) ss_name_length(name), (name), ss_name_more(name)
#define SS_FILED      "%s%s"
#define SS_FILE(path) ss_file_less(path), ss_file_tail(path)
int ss_name_length(const char *name);
const char *ss_name_more(const char *name);
const char *ss_file_less(const char *path);
const char *ss_file_tail(const char *path);

/* The type of a prim in a sentence, which it may lack. */
const char *ss_type_of(const char *type_name);

/* A copy of text in memory; NULL where that failed. */
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
    SS_KIND_NUMBER,  /* one for the patch, or the mesh */
    SS_KIND_PAINT,   /* by point, by face or constant */
    SS_KIND_FACTORS, /* by painted edge */
    SS_KIND_TEXTURE, /* multiplies paint by point */
    SS_KIND_CARRIED, /* turns as the skin does */
    SS_KIND_RATE     /* of change of the points */
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
    size_t place;        /* of numbers, in skinslide_controls: the number, or the array by point */
    size_t face_place;   /* the array by face; 0: not by face */
    bool drops_constant; /* a constant makes no difference */
    float off_patch;     /* what paint is taken for off the patch */
    int32_t multiplies;  /* of a texture: the paint, among the inputs of its group */
    int32_t channel;     /* of a texture: its channel, among the inputs of the patch */
    int32_t pose_count;  /* of what is derived */
    unsigned rules;      /* that read it; 0: all */
} ss_input;

static inline bool ss_is_read_by(const ss_input *input, int32_t rule) {
    return !input->rules || input->rules & 1u << rule;
}

/* Places in the tables of the groups. */
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
    SS_ROW_COMPARE_REST, /* after all that it compares */
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
    SS_ROW_CHANNEL, /* before the paint that it is of */
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

/* The table of a group and its length. */
const ss_input *ss_inputs(skinslide_stage_group group, int32_t *count);
/* The place of an input in the table of a group; -1 where it is not of that. */
int32_t ss_row_of(skinslide_stage_group group, const skinslide_stage_input *input);
/* Names that stand where a patch's would. */
bool ss_is_reserved(const char *name, size_t length);
/* The property of a patch, in a sentence. */
void ss_name_property(skinslide_stage_group group, int32_t row, const char *patch, char text[256]);
/* What a number must be for a range. */
bool ss_in_range(ss_range range, double number);

/* ---- What was taken ---- */

/* An array of int32_t or of float: both have four bytes. */
typedef struct ss_array {
    void *values;
    int32_t count;
} ss_array;

/* What an input of fixed meaning came to. */
typedef struct ss_taken {
    ss_array array;
    const char *word;
    double number;
    int32_t choice;
    bool refused;
} ss_taken;

/* settings.c: takes a record of the kinds CHOICE, WORD, INTEGERS and FLOATS; the fallback where it has no value. */
skinslide_status ss_take_plain(const ss_input *input, const ss_record *record, skinslide_status status, ss_memory *memory,
                               ss_taken *taken, skinslide_error *error);
/* Takes one number, the fallback where there is none. */
skinslide_status ss_take_number(const ss_input *input, const ss_record *record, double *number, skinslide_error *error);
/* Takes the fallbacks of a table. */
skinslide_status ss_take_fallbacks(const ss_input *inputs, int32_t count, ss_memory *memory, ss_taken *taken,
                                   skinslide_error *error);
/* Fails: the record is not what it was at first. */
skinslide_status ss_changes(const ss_record *record, double frame, skinslide_status status, skinslide_error *error);
/* Whether a record comes to what was taken; names the frame where it does not. */
skinslide_status ss_check_plain(const ss_input *input, const ss_record *record, const ss_taken *taken, double frame,
                                skinslide_status status, skinslide_error *error);
/* Fails where one of some was refused. */
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
    int32_t rest_row; /* of the candidate that counts, good or bad; -1: none yet */
    bool left_handed;
    double weld, weld_tolerance; /* whether points in one place are one, and how near that is */
    double world_space;          /* whether lengths are those in the world */
    double fold_case;            /* whether names of paint count in any case */
    double compare_rest;         /* whether rest is to be compared with the cache */
    float *first;                /* [vertex_count][3] points of the first time */
    const char *warning;         /* NULL: none */
    const char *coordinates;     /* primvars that could be texture coordinates, with commas; NULL: none */
    bool has_space;              /* the way to the world is known at first */
    double gram[9], space[9];    /* of that, if lengths are taken there, and the map that does it */
    double unevenness;           /* the most that was warned of; 0: none */
    const char *space_warning;   /* NULL: none */
};

/* The mesh as the core's own functions take it, without rest points. */
skinslide_mesh ss_faces_of(const skinslide_stage_mesh *mesh);

/* rest.c, scheme.c: what skinslide_stage_mesh_take and *_check do for their inputs. */
skinslide_status ss_take_rest(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_rest_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, double frame,
                                     skinslide_error *error);
skinslide_status ss_take_subdivision(skinslide_stage_mesh *mesh, int32_t row, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_subdivision_still(const skinslide_stage_mesh *mesh, int32_t row, const ss_record *record,
                                            double frame, skinslide_error *error);

/* resemble.c: compares rest with the first pose of the cache, once both are there, and takes it at the cache's scale. */
skinslide_status ss_compare_mesh(skinslide_stage_mesh *mesh, skinslide_error *error);
/* The same over the faces of a patch, which keeps what it came to. */
skinslide_status ss_compare_patch(skinslide_stage_patch *patch, skinslide_error *error);
/* Fails with BAD_POINTS where that is so unlike that nothing can slide. */
skinslide_status ss_check_likeness(const skinslide_stage_patch *patch, skinslide_error *error);

struct skinslide_stage_patch {
    ss_memory memory;
    const skinslide_stage_mesh *mesh;
    const char *name;
    skinslide_stage_live live;
    ss_taken taken[SS_PATCH_ROWS];
    const char *st;                    /* "primvars:st" */
    skinslide_stage_input coordinates; /* the same, to be fetched */
    bool faces_by_primvar;
    ss_array painted;   /* those that were chosen, ascending */
    ss_array faces;     /* those, with what grows them; ascending; none: every face counts */
    const char *subset; /* the path of the child that has the faces; NULL: none */
    const char *indices_name;
    ss_array indices;    /* of that, as authored */
    ss_array vertices;   /* of those faces; ascending */
    ss_memory settled;   /* of the two, as far as they are not authored */
    double way;          /* that the faces have been grown by */
    uint8_t *held;       /* [vertex_count] those that other meshes have points at; NULL: none */
    double unlike;       /* the factor by which rest differs, where sliding is senseless; 0: it is not */
    const char *warning; /* NULL: none */
};

/* ---- paint.c ---- */

/* The properties of a prim whose names begin as those of paint do, but for case and underscores; sorted. */
typedef struct ss_paint_names {
    int32_t count;
    const char **names;
    const char **patches;  /* [count] whose paint each is, but for those; NULL: of none */
    bool *in_another_case; /* [count] */
} ss_paint_names;

/* Empty where memory failed. */
ss_paint_names ss_list_paint(ss_memory *memory, const char *const *properties, int32_t count, const char *const *patches,
                             int32_t patch_count);
/* Whether a property is paint of a patch, or indices of it, but for case and underscores. */
bool ss_is_paint(const ss_paint_names *all, const char *property);

/* Checks that a record is of real numbers, or of what chooses faces, of which one counts for each element. patch: which says what
 * channel that is; NULL: none does. */
skinslide_status ss_check_paint_type(const skinslide_stage_patch *patch, const ss_record *record, bool of_faces,
                                     skinslide_status status, skinslide_error *error);
/* Whether it is by point, or by face corner, which is averaged to points; and that it then has one for each. */
bool ss_is_painted_by_vertex(const ss_record *record);
skinslide_status ss_check_painted_vertices(const skinslide_stage_mesh *mesh, const ss_record *record, skinslide_status status,
                                           skinslide_error *error);
/* Whether it has one number for each point, for each face or for all, as it stands. */
bool ss_is_plain_paint(const ss_record *record);
/* The same as a record that has, of doubles in room; and how many of these that takes. */
ss_record ss_plain_paint(const skinslide_stage_patch *patch, const ss_record *record, double *room);
int64_t ss_plain_paint_room(const skinslide_stage_mesh *mesh);

/* faces.c */
skinslide_status ss_take_primvar_faces(skinslide_stage_patch *patch, const ss_record *record, skinslide_error *error);
skinslide_status ss_check_primvar_faces(const skinslide_stage_patch *patch, const ss_record *record, double frame,
                                        skinslide_error *error);
/* The same of an input of the subset. */
skinslide_status ss_take_subset_faces(skinslide_stage_patch *patch, int32_t row, const ss_record *record,
                                      skinslide_error *error);
skinslide_status ss_check_subset_faces(const skinslide_stage_patch *patch, int32_t row, const ss_record *record, double frame,
                                       skinslide_error *error);
/* Lists the faces and vertices of the patch: what was chosen, if anything yet, and what joins that within its grow, under a rule that
 * takes any faces. */
skinslide_status ss_settle_faces(skinslide_stage_patch *patch, skinslide_error *error);
/* The same where the way that it grows is another now. */
skinslide_status ss_settle_way(skinslide_stage_patch *patch, skinslide_error *error);

/* controls.c: whether an input says something, at the time of the controls. */
bool ss_controls_say(const skinslide_stage_controls *controls, int32_t row);
/* As the slider takes them; they are the handle's. */
skinslide_status ss_give_controls(skinslide_stage_controls *controls, const skinslide_controls **given, skinslide_error *error);

/* ---- textures.c: one map ---- */

typedef struct ss_texture ss_texture;

/* NULL where memory is short. */
ss_texture *ss_texture_create(const ss_input *input, const skinslide_stage_patch *patch);
void ss_texture_destroy(ss_texture *texture);
/* Takes the asset of a time. Nothing is known of its files then, but images of the time before are still held. */
skinslide_status ss_texture_take(ss_texture *texture, const ss_record *record, skinslide_error *error);
/* Takes the asset of another texture, likewise. */
skinslide_status ss_texture_repeat(ss_texture *texture, const ss_texture *of, skinslide_error *error);
/* Whether a file is named at some time, for all that is known. */
bool ss_texture_authored(const ss_texture *texture);
/* Whether there is a map. */
bool ss_texture_wanted(const ss_texture *texture);
/* Finds the tiles that the patch needs. st is that of the mesh's corners. What fails here and below drops the map. */
skinslide_status ss_texture_find_tiles(ss_texture *texture, const float *st, skinslide_error *error);
/* The next file, or NULL. */
const skinslide_stage_need *ss_texture_need(const ss_texture *texture);
bool ss_texture_holds(const ss_texture *texture, const char *path);
/* Fails where what the map multiplies cannot be that at a point: the map alone, or multiplied. */
skinslide_status ss_texture_check(const ss_texture *texture, bool multiplied, int32_t vertex, float value,
                                  skinslide_error *error);
/* Takes that file; with the last one samples the map, and checks it as the paint that it multiplies. */
skinslide_status ss_texture_give(ss_texture *texture, const float *st, const skinslide_stage_file *file,
                                 skinslide_error *error);
/* Makes it no map. */
void ss_texture_drop(ss_texture *texture);
/* By vertex, 1 off the patch; NULL where there is no map, or none yet. */
const float *ss_texture_values(const ss_texture *texture);
const skinslide_stage_texture *ss_texture_shown(const ss_texture *texture);

/* ---- follows.c: primvars that follow the skin ---- */

#define SS_PRIMVARS "primvars:"
#define SS_INDICES  ":indices" /* of a primvar: what its name ends in then */

/* A primvar of a mesh as it is declared. */
typedef struct ss_primvar {
    const char *name; /* "primvars:tangents" */
    const char *type_name, *interpolation;
    int32_t element_size;
} ss_primvar;

typedef enum ss_following {
    SS_FOLLOWS_NOT,
    SS_FOLLOWS,         /* as something of a kind that takes that many poses */
    SS_FOLLOWS_UNKNOWN, /* it seems to, but cannot be carried: told says why */
} ss_following;

/* Not what is no primvar, or an input of a table. */
ss_following ss_follows(const ss_primvar *primvar, ss_kind *kind, int32_t *pose_count, skinslide_error *told);

/* ---- times.c ---- */

/* Up to `count` of the times next to a time, itself among them where the difference needs it: ascending. */
int32_t ss_samples_around(const double *times, int64_t time_count, double time, int32_t count, double around[3]);

#endif
