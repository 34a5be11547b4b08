/* Cameras: that they have all of their subject in sight and little else, from its outside, wherever it is and however large;
 * and the matrices that are drawn with. */
#include "picture.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double y_up[3] = {0, 1, 0};
static const double margin = 1.12;

typedef struct framed {
    test_mesh mesh;
    skinslide_mesh view;
    int32_t *faces;
    const float *poses[3];
    skinslide_subject subject;
    skinslide_camera camera;
} framed;

/* All faces of a mesh, in its own pose and two at random; or in its own alone. */
static void start_framing(framed *f, test_mesh mesh, bool posed) {
    *f = (framed){.mesh = mesh, .faces = all_faces(&mesh)};
    f->view = view_of(&f->mesh);
    f->poses[0] = f->mesh.points;
    for (int i = 1; i < 3 && posed; i++)
        f->poses[i] = random_pose(&f->mesh, (uint64_t)i);
    f->subject = (skinslide_subject){.size = sizeof(skinslide_subject),
                                     .mesh = &f->view,
                                     .faces = f->faces,
                                     .face_count = mesh.face_count,
                                     .pose_count = posed ? 3 : 1,
                                     .poses = f->poses};
}

static void end_framing(framed *f) {
    free((float *)f->poses[1]), free((float *)f->poses[2]);
    free(f->faces);
    free_mesh(&f->mesh);
}

static void look(framed *f, const double up[3], double aspect) {
    skinslide_error error;
    assert_ok(skinslide_frame_faces(&f->subject, up, aspect, &f->camera, &error), &error);
}

/* A row times a matrix of rows. */
static void through(const double *matrix, const double in[4], double out[4]) {
    for (int k = 0; k < 4; k++)
        out[k] = in[0] * matrix[k] + in[1] * matrix[4 + k] + in[2] * matrix[8 + k] + in[3] * matrix[12 + k];
}

static void to_camera(const framed *f, const float *point, const double *to_world, double out[4]) {
    const double p[4] = {point[0], point[1], point[2], 1};
    double world[4];
    if (to_world)
        through(to_world, p, world);
    else
        memcpy(world, p, sizeof p);
    through(f->camera.to_camera, world, out);
}

typedef struct seen {
    double side;      /* the largest of |x/w| and |y/w| */
    double low, high; /* z/w */
    double nearest;   /* distance along the view */
    double low_x, high_x;
} seen;

/* Vertices of faces, in each pose. */
static seen see(const framed *f) {
    seen s = {.low = INFINITY, .high = -INFINITY, .nearest = INFINITY, .low_x = INFINITY, .high_x = -INFINITY};
    for (int32_t pose = 0; pose < f->subject.pose_count; pose++)
        for (int32_t c = 0; c < f->mesh.index_count; c++) {
            double at[4], clip[4];
            to_camera(f, f->poses[pose] + 3 * (int64_t)f->mesh.face_indices[c],
                      f->subject.to_world ? f->subject.to_world + 16 * pose : NULL, at);
            through(f->camera.to_screen, at, clip);
            assert_true(clip[3] > 0);
            s.side = fmax(s.side, fmax(fabs(clip[0] / clip[3]), fabs(clip[1] / clip[3])));
            s.low = fmin(s.low, clip[2] / clip[3]), s.high = fmax(s.high, clip[2] / clip[3]);
            s.low_x = fmin(s.low_x, clip[0] / clip[3]), s.high_x = fmax(s.high_x, clip[0] / clip[3]);
            s.nearest = fmin(s.nearest, -at[2]);
        }
    return s;
}

/* The direction to the camera, in the world. */
static void towards(const framed *f, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = f->camera.to_camera[4 * k + 2];
}

/* The diagonal of the box of all poses, along the axes of the camera. */
static double diagonal(const framed *f) {
    double sum = 0, low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t pose = 0; pose < f->subject.pose_count; pose++)
        for (int32_t c = 0; c < f->mesh.index_count; c++) {
            double at[4];
            to_camera(f, f->poses[pose] + 3 * (int64_t)f->mesh.face_indices[c], NULL, at);
            for (int k = 0; k < 3; k++)
                low[k] = fmin(low[k], at[k]), high[k] = fmax(high[k], at[k]);
        }
    for (int k = 0; k < 3; k++)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(sum);
}

/* ---- In sight ---- */

static void every_point_is_in_sight(void **state) {
    (void)state;
    const double aspects[] = {0.1, 0.5 * 16 / 9, 1, 16.0 / 9, 20};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int a = 0; a < 5; a++) {
            framed f;
            start_framing(&f, make_fixture(i).mesh, true);
            look(&f, y_up, aspects[a]);
            seen s = see(&f);
            bool near = s.nearest < 0.5 * diagonal(&f) * (1 + 1e-9);
            assert_true(s.low > -1 && s.high < 1);
            assert_true(s.nearest > 0.5 * diagonal(&f) * (1 - 1e-9));
            assert_true(s.side < 1 / margin + 1e-9 && (near || s.side > 1 / margin - 1e-9));
            end_framing(&f);
        }
}

/* A camera for a part of a mesh, in whatever order its faces are given. */
static void only_the_faces_count(void **state) {
    (void)state;
    framed f;
    start_framing(&f, quad_grid(9, 9), false);
    skinslide_camera cameras[2];
    const int32_t orders[2][4] = {{30, 31, 39, 40}, {40, 30, 39, 31}};
    for (int i = 0; i < 2; i++) {
        f.subject.faces = orders[i], f.subject.face_count = 4;
        look(&f, y_up, 1);
        cameras[i] = f.camera;
    }
    for (int k = 0; k < 16; k++)
        assert_near(cameras[0].to_camera[k], cameras[1].to_camera[k], 1e-12);
    assert_near(f.camera.to_camera[12], -4, 1e-12); /* the quads of 3 to 5 by 3 to 5 */
    assert_near(f.camera.to_camera[13], -4, 1e-12);
    assert_near(f.camera.to_camera[14], -margin / tan(0.25), 1e-12);
    end_framing(&f);
}

/* ---- From where ---- */

static void reverse_faces(test_mesh *mesh) {
    for (int32_t f = 0, c = 0; f < mesh->face_count; c += mesh->face_counts[f++])
        for (int32_t i = c, j = c + mesh->face_counts[f] - 1; i < j; i++, j--) {
            int32_t swap = mesh->face_indices[i];
            mesh->face_indices[i] = mesh->face_indices[j], mesh->face_indices[j] = swap;
        }
}

/* A sheet that faces +z: each of its orientation, its winding and a mirroring turns the outside over. */
static void the_outside_is_seen(void **state) {
    (void)state;
    const double mirrors[2][16] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                   {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    for (int i = 0; i < 8; i++) {
        framed f;
        double out[3];
        start_framing(&f, quad_grid(3, 3), false);
        f.subject.left_handed = i & 1;
        if (i & 2)
            reverse_faces(&f.mesh);
        f.subject.to_world = mirrors[i >> 2];
        look(&f, y_up, 1);
        towards(&f, out);
        /* Mirrored in x: the sheet turns right seen from +z, and an outside that faced +z still does. */
        assert_near(out[2], (i & 1) == (i >> 1 & 1) ? 1 : -1, 1e-12);
        see(&f);
        end_framing(&f);
    }
}

/* Round a limb normals cancel: it is seen from a side, not along it. */
static void limbs_are_seen_from_the_side(void **state) {
    (void)state;
    test_mesh tube = annulus(16, 5);
    for (int32_t v = 0; v < tube.vertex_count; v++) {
        double angle = 2 * acos(-1) * (v % 16) / 16;
        tube.points[3 * v] = (float)cos(angle), tube.points[3 * v + 1] = (float)sin(angle);
        tube.points[3 * v + 2] = (float)(v / 16);
    }
    framed f;
    double out[3];
    start_framing(&f, tube, false);
    look(&f, y_up, 1);
    towards(&f, out);
    assert_near(out[2], 0, 1e-6);
    end_framing(&f);
}

/* Half a tube, whose normals do not cancel: from its open side's back. */
static void a_bent_sheet_is_seen_from_its_mean_normal(void **state) {
    (void)state;
    framed f;
    double out[3];
    start_framing(&f, quad_grid(12, 3), false);
    for (int32_t v = 0; v < f.mesh.vertex_count; v++) {
        double angle = acos(-1) * (1 - f.mesh.points[3 * v] / 12);
        f.mesh.points[3 * v] = (float)cos(angle), f.mesh.points[3 * v + 2] = (float)sin(angle);
    }
    look(&f, y_up, 1);
    towards(&f, out);
    assert_near(out[0], 0, 1e-6);
    assert_near(out[1], 0, 1e-6);
    assert_near(out[2], 1, 1e-6);
    end_framing(&f);
}

/* A sheet that turns about y, in degrees: a quarter turn is seen from its mean normal, (0, 0, 1) twice and (-1, 0, 0). One of
 * 140 would show its back there, and is seen from halfway. */
static void what_turns_away_is_seen_from_between(void **state) {
    (void)state;
    const double turns[2] = {-90, 140}, degree = acos(-1) / 180, expected[2] = {-atan(0.5), 70 * degree};
    for (int i = 0; i < 2; i++) {
        framed f;
        double out[3];
        start_framing(&f, quad_grid(3, 3), false);
        float *turned = copy_points(&f.mesh);
        for (int32_t v = 0; v < f.mesh.vertex_count; v++) {
            turned[3 * v + 2] = (float)(-sin(turns[i] * degree) * turned[3 * v]);
            turned[3 * v] = (float)(cos(turns[i] * degree) * turned[3 * v]);
        }
        f.poses[1] = f.poses[0], f.poses[2] = turned, f.subject.pose_count = 3;
        look(&f, y_up, 1);
        towards(&f, out);
        assert_near(atan2(out[0], out[2]), expected[i], 1e-6);
        f.poses[1] = NULL;
        end_framing(&f);
    }
}

static void up_along_the_view(void **state) {
    (void)state;
    const double ups[4][3] = {{0, 0, 1}, {0, 0, -5}, {1e-9, 0, 1}, {0, 1e-100, 0}};
    for (int i = 0; i < 4; i++) {
        framed f;
        double out[3];
        start_framing(&f, quad_grid(3, 3), false);
        look(&f, ups[i], 1);
        towards(&f, out);
        assert_near(out[2], 1, 1e-12);
        assert_near(see(&f).side, 1 / margin, 1e-9);
        end_framing(&f);
    }
}

static void up_is_up(void **state) {
    (void)state;
    const double ups[3][3] = {{0, 1, 0}, {3, 0, 0}, {-1, -1, 1}};
    for (int i = 0; i < 3; i++) {
        framed f;
        start_framing(&f, quad_grid(3, 3), false);
        look(&f, ups[i], 1);
        const double way[4] = {ups[i][0], ups[i][1], ups[i][2], 0};
        double at[4];
        through(f.camera.to_camera, way, at);
        assert_near(at[0], 0, 1e-12);
        assert_true(at[1] > 0);
        end_framing(&f);
    }
}

/* ---- Motions ---- */

/* A turn by the angle about an axis (Rodrigues), a scale and a shift, for rows. */
static void motion(double angle, const double axis[3], double scale, const double shift[3], double *out) {
    double s = sin(angle), c = cos(angle), n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double u = axis[i] / n, v = axis[j] / n, cross = i == j ? 0 : axis[3 - i - j] / n * ((j - i + 3) % 3 == 1 ? 1 : -1);
            out[4 * i + j] = scale * ((i == j) * c + (1 - c) * u * v + s * cross);
        }
    for (int k = 0; k < 3; k++)
        out[12 + k] = shift[k], out[4 * k + 3] = 0;
    out[15] = 1;
}

/* The subject moved, and up with it: the same picture. */
static void motions_commute(void **state) {
    (void)state;
    const double axis[3] = {1, -2, 0.5}, sizes[4] = {1, 1e-6, 1e6, 1e-20}, shifts[2][3] = {{0, 0, 0}, {1e6, -2e6, 5e5}};
    for (int32_t i = 0; i < FIXTURE_COUNT; i++)
        for (int k = 0; k < 8; k++) {
            framed f;
            double matrices[3][16], up[4];
            const double way[4] = {0.3, 1, 0.2, 0};
            motion(0.7 + i, axis, sizes[k % 4], shifts[k / 4], matrices[0]);
            start_framing(&f, make_fixture(i).mesh, true);
            look(&f, way, 1.5);
            seen still = see(&f);
            for (int pose = 1; pose < 3; pose++)
                memcpy(matrices[pose], matrices[0], sizeof matrices[0]);
            through(matrices[0], way, up);
            double length = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
            for (int a = 0; a < 3; a++)
                up[a] /= length;
            f.subject.to_world = &matrices[0][0];
            if (k < 4 || sizes[k % 4] > 0.5) { /* else places in the world are rounded together */
                look(&f, up, 1.5);
                seen moved = see(&f);

                assert_near(moved.side, still.side, 1e-6);
                assert_near(moved.low_x, still.low_x, 1e-6);
                assert_near(moved.high_x, still.high_x, 1e-6);
                assert_near(moved.low, still.low, 1e-6);
            }
            end_framing(&f);
        }
}

/* ---- Degenerate ---- */

static void squeeze(test_mesh *mesh, double x, double y, double z, double size) {
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double along = mesh->points[3 * v];
        mesh->points[3 * v] = (float)(x * along * size), mesh->points[3 * v + 1] = (float)(y * along * size);
        mesh->points[3 * v + 2] = (float)(z * along * size);
    }
}

/* Faces of no area along a line: seen from its side, from end to end. */
static void lines_are_seen_from_the_side(void **state) {
    (void)state;
    const double lines[5][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, -3}, {0.1, 7, 0.1}};
    for (int i = 0; i < 15; i++) {
        framed f;
        start_framing(&f, quad_grid(3, 1), false);
        squeeze(&f.mesh, lines[i / 3][0], lines[i / 3][1], lines[i / 3][2], i % 3 == 0 ? 1 : i % 3 == 1 ? 1e-6 : 1e6);
        look(&f, y_up, 1);
        seen s = see(&f);
        assert_true(s.side < 1 / margin + 1e-9 && s.side > 0.6);
        assert_true(s.low > -1 && s.high < 1);
        end_framing(&f);
    }
}

static void points_cannot_be_seen(void **state) {
    (void)state;
    framed f;
    skinslide_error error;
    start_framing(&f, quad_grid(2, 2), false);
    squeeze(&f.mesh, 0, 0, 0, 1);
    memset(&f.camera, 7, sizeof f.camera);
    skinslide_camera before = f.camera;
    assert_fails(skinslide_frame_faces(&f.subject, y_up, 1, &f.camera, &error), &error, SKINSLIDE_BAD_POINTS,
                 "no camera can have the faces in sight: they are all in one place, or endless");
    assert_same_bytes(&f.camera, &before, sizeof before);
    end_framing(&f);
}

/* A spike at the camera keeps its distance. */
static void spikes_are_not_too_near(void **state) {
    (void)state;
    framed f;
    start_framing(&f, quad_grid(2, 2), false);
    f.mesh.points[3 * 4 + 2] = 5;
    look(&f, y_up, 1);
    seen s = see(&f);
    assert_near(s.nearest, 0.5 * diagonal(&f), 1e-9);
    assert_true(s.side < 1 / margin && s.low > -1 && s.high < 1);
    end_framing(&f);
}

static void coordinates_far_out(void **state) {
    (void)state;
    const float shifts[2] = {1e6f, -3e7f};
    for (int i = 0; i < 2; i++) {
        framed f;
        start_framing(&f, quad_grid(8, 8), false);
        for (int32_t v = 0; v < 3 * f.mesh.vertex_count; v++)
            f.mesh.points[v] = 4 * f.mesh.points[v] + shifts[i];
        look(&f, y_up, 1);
        assert_near(see(&f).side, 1 / margin, 1e-6);
        end_framing(&f);
    }
}

/* ---- Bad input ---- */

static void refused(framed *f, const double up[3], double aspect, skinslide_status status, const char *text) {
    skinslide_error error;
    assert_fails(skinslide_frame_faces(&f->subject, up, aspect, &f->camera, &error), &error, status, text);
}

static void bad_arguments_are_named(void **state) {
    (void)state;
    framed f;
    skinslide_error error;
    const double nan_up[3] = {0, NAN, 0}, endless[3] = {INFINITY, 0, 0}, none[3] = {0, 0, 0};
    const double *ups[4] = {NULL, nan_up, endless, none}, aspects[4] = {0, -1, NAN, INFINITY};
    const int32_t past[2] = {0, 4};
    double matrix[16] = {1, 0, 0, 0, 0, NAN, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const char *shape = "no way up, or no shape of picture", *missing = "no faces, or no poses";
    start_framing(&f, quad_grid(2, 2), false);
    const skinslide_subject good = f.subject;
    assert_fails(skinslide_frame_faces(&good, y_up, 1, NULL, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no subject...");
    assert_fails(skinslide_frame_faces(NULL, y_up, 1, &f.camera, &error), &error, SKINSLIDE_BAD_ARGUMENT, "no subject...");
    for (int i = 0; i < 4; i++) {
        refused(&f, ups[i], 1, SKINSLIDE_BAD_ARGUMENT, shape);
        refused(&f, y_up, aspects[i], SKINSLIDE_BAD_ARGUMENT, shape);
    }
    f.subject.face_count = 0, refused(&f, y_up, 1, SKINSLIDE_BAD_ARGUMENT, missing), f.subject = good;
    f.subject.faces = NULL, refused(&f, y_up, 1, SKINSLIDE_BAD_ARGUMENT, missing), f.subject = good;
    f.subject.pose_count = 0, refused(&f, y_up, 1, SKINSLIDE_BAD_ARGUMENT, missing), f.subject = good;
    f.subject.poses = NULL, refused(&f, y_up, 1, SKINSLIDE_BAD_ARGUMENT, missing), f.subject = good;
    f.subject.faces = past, f.subject.face_count = 2;
    refused(&f, y_up, 1, SKINSLIDE_BAD_ARGUMENT, "face 4 is not one of the mesh's 4"), f.subject = good;
    f.subject.to_world = matrix;
    refused(&f, y_up, 1, SKINSLIDE_BAD_POINTS, "pose 0: its way to the world is not finite");
    matrix[5] = 1e200;
    refused(&f, y_up, 1, SKINSLIDE_BAD_POINTS, "no camera can have..."), f.subject = good;
    f.mesh.points[5] = INFINITY;
    refused(&f, y_up, 1, SKINSLIDE_BAD_POINTS, "pose 0: points: vertex 1 is not finite...");
    f.view.face_count = 0;
    refused(&f, y_up, 1, SKINSLIDE_BAD_MESH, "the mesh has no faces");
    end_framing(&f);
}

/* ---- What is drawn with ---- */

/* A place less the origin by the view's columns is the place itself by the camera's rows; normals stay across the surface. */
static void views_are_the_cameras(void **state) {
    (void)state;
    const double axis[3] = {3, 1, -1}, shift[3] = {5, 4, 3}, origin[3] = {1, 2, 3};
    double world[16];
    framed f;
    ss_view view;
    motion(1, axis, 2, shift, world);
    world[1] *= 3, world[5] *= 3, world[9] *= 3, world[13] *= 3; /* not the same along each axis */
    start_framing(&f, quad_grid(3, 3), false);
    look(&f, y_up, 1.5);
    assert_true(ss_view_of(&f.camera, world, origin, &view));
    assert_false(view.mirrored);
    for (int32_t v = 0; v < f.mesh.vertex_count; v++) {
        const float *p = f.mesh.points + 3 * v;
        double at[4], clip[4];
        to_camera(&f, p, world, at);
        through(f.camera.to_screen, at, clip);
        for (int k = 0; k < 4; k++) {
            double found = view.to_clip[12 + k];
            for (int i = 0; i < 3; i++)
                found += view.to_clip[4 * i + k] * (p[i] - origin[i]);
            assert_near(found, clip[k], 1e-4);
        }
    }
    double dot[2] = {0, 0}; /* of the normal z with what x and y become */
    for (int i = 0; i < 2; i++) {
        const float ends[2][3] = {{0, 0, 0}, {i == 0, i == 1, 0}};
        double from[4], to[4];
        to_camera(&f, ends[0], world, from), to_camera(&f, ends[1], world, to);
        for (int k = 0; k < 3; k++)
            dot[i] += view.turn_normal[6 + k] * (to[k] - from[k]);
    }
    assert_near(dot[0], 0, 1e-5);
    assert_near(dot[1], 0, 1e-5);
    world[0] *= -1, world[4] *= -1, world[8] *= -1, world[12] *= -1;
    assert_true(ss_view_of(&f.camera, world, origin, &view));
    assert_true(view.mirrored);
    end_framing(&f);
}

static void views_that_are_none(void **state) {
    (void)state;
    const double origin[3] = {0, 0, 0};
    double flat[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    framed f;
    ss_view view;
    start_framing(&f, quad_grid(3, 3), false);
    look(&f, y_up, 1.5);
    assert_false(ss_view_of(&f.camera, flat, origin, &view));
    flat[10] = NAN;
    assert_false(ss_view_of(&f.camera, flat, origin, &view));
    flat[10] = 1e300;
    assert_false(ss_view_of(&f.camera, flat, origin, &view));
    flat[10] = 1, f.camera.to_screen[0] = INFINITY;
    assert_false(ss_view_of(&f.camera, flat, origin, &view));
    end_framing(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_point_is_in_sight),
        cmocka_unit_test(only_the_faces_count),
        cmocka_unit_test(the_outside_is_seen),
        cmocka_unit_test(limbs_are_seen_from_the_side),
        cmocka_unit_test(a_bent_sheet_is_seen_from_its_mean_normal),
        cmocka_unit_test(what_turns_away_is_seen_from_between),
        cmocka_unit_test(up_along_the_view),
        cmocka_unit_test(up_is_up),
        cmocka_unit_test(motions_commute),
        cmocka_unit_test(lines_are_seen_from_the_side),
        cmocka_unit_test(points_cannot_be_seen),
        cmocka_unit_test(spikes_are_not_too_near),
        cmocka_unit_test(coordinates_far_out),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(views_are_the_cameras),
        cmocka_unit_test(views_that_are_none),
    };
    return cmocka_run_group_tests_name("view", tests, NULL, NULL);
}
