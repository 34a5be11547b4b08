/* Where pictures are seen from: the matrices for drawing, and a camera that has faces in sight. C++ behind C functions; nothing
 * here throws. */
#include "picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

const double field_of_view = 0.5;       /* radians, up and down */
const double margin = 1.12;             /* how much wider than what is framed the view is */
const double least_distance = 0.5;      /* of the nearest point, in diagonals of the box */
const double cancelled = 0.25;          /* as a share of the area: normals whose sum is less cancel out */
const double much_less = 0.5;           /* as a share of how far a pose could be turned to the camera */
const double in_front = 4, behind = 40; /* in diagonals of the box: how far around what is framed other things are drawn */
const double nearest = 0.1;             /* as a share of the distance to what is framed: the near plane is no nearer */
const double no_area = 1e-14;           /* in diagonals squared: faces of less are lines */

/* USD's matrices are for points as rows, GLM's for points as columns: the rows of one are the columns of the other. */
dmat4 matrix_of(const double *rows) {
    return rows ? glm::make_mat4(rows) : dmat4(1);
}

template <typename Number> bool all_finite(const Number *values, size_t count) {
    return std::all_of(values, values + count, [](Number x) { return std::isfinite(x); });
}

double largest(const dmat3 &matrix) {
    double most = 0;
    for (int i = 0; i < 9; i++)
        most = std::max(most, std::abs(matrix[i / 3][i % 3]));
    return most;
}

/* ---- What is framed ---- */

struct Subject {
    const skinslide_subject &own;
    int32_t *start; /* [mesh face_count] first corner of each face */
    dvec3 *turns;   /* [pose_count] scratch */
};

/* The faces in a pose, in the world. Calls body(vertices, n, place of a vertex, -1 where faces turn right seen from outside,
 * else 1). */
template <typename Body> void each_face_of(const Subject &subject, int32_t pose, Body body) {
    const skinslide_subject &own = subject.own;
    dmat4 matrix = matrix_of(own.to_world ? own.to_world + 16 * int64_t(pose) : nullptr);
    double turn = (glm::determinant(dmat3(matrix)) < 0) == (own.left_handed != 0) ? 1 : -1;
    auto place = [&](int32_t vertex) {
        const float *p = own.poses[pose] + 3 * int64_t(vertex);
        return dvec3(matrix * glm::dvec4(p[0], p[1], p[2], 1));
    };
    for (int32_t i = 0; i < own.face_count; i++)
        body(own.mesh->face_indices + subject.start[own.faces[i]], own.mesh->face_counts[own.faces[i]], place, turn);
}

/* The same in each pose. */
template <typename Body> void each_face(const Subject &subject, Body body) {
    for (int32_t pose = 0; pose < subject.own.pose_count; pose++)
        each_face_of(subject, pose, body);
}

/* Half the sum of the cross products of a fan: its length is the area, and it points outwards where the fan turns left. */
template <typename Place> dvec3 area_of(const int32_t *v, int32_t n, Place place) {
    dvec3 sum(0);
    for (int32_t k = 1; k + 1 < n; k++)
        sum += 0.5 * glm::cross(place(v[k]) - place(v[0]), place(v[k + 1]) - place(v[0]));
    return sum;
}

struct Box {
    dvec3 low{INFINITY}, high{-INFINITY};

    void add(dvec3 p) {
        low = glm::min(low, p), high = glm::max(high, p);
    }
    dvec3 middle() const {
        return 0.5 * (low + high);
    }
    double size() const {
        return glm::length(high - low);
    }
};

/* What is known of the faces in all poses at once. */
struct Shape {
    Box box;
    dvec3 normal{0}; /* the sum of area vectors, outwards */
    double area = 0;
    dmat3 spread{0}; /* the sum of squares of area vectors: small along directions in which little of the faces is seen */
    dvec3 first{NAN}, farthest{NAN}; /* corners: the first, and the one farthest from it */

    explicit Shape(const Subject &subject) {
        each_face(subject, [&](const int32_t *v, int32_t n, auto place, double turn) {
            for (int32_t k = 0; k < n; k++) {
                dvec3 p = place(v[k]);
                if (std::isnan(first.x))
                    first = farthest = p;
                if (glm::distance(p, first) >= glm::distance(farthest, first))
                    farthest = p;
                box.add(p);
            }
            dvec3 sum = area_of(v, n, place);
            normal += turn * sum;
            area += glm::length(sum);
            if (glm::length(sum) > 0)
                spread += glm::outerProduct(sum, sum) / glm::length(sum);
        });
    }

    /* The direction in which most of the area is seen: the largest eigenvector of the spread, by squaring it. Where several are
     * as large, as round a limb, the nearest of theirs to the sum of the normals, if that is any. */
    dvec3 widest() const {
        dmat3 power = spread / area;
        for (int i = 0; i < 40; i++) {
            power = power * power;
            power /= power[0][0] + power[1][1] + power[2][2];
        }
        int most = 0;
        for (int i = 1; i < 3; i++)
            most = glm::length(power[i]) > glm::length(power[most]) ? i : most;
        dvec3 leaning = power * normal;
        return glm::length(leaning) > 1e-3 * area ? leaning : power[most];
    }

    /* Towards the camera. */
    dvec3 direction(dvec3 up) const {
        if (area > no_area * box.size() * box.size())
            return glm::normalize(glm::length(normal) > cancelled * area ? normal : widest());
        dvec3 along = glm::normalize(farthest - first), aside = glm::cross(along, up);
        if (glm::length(aside) < 0.05)
            aside = glm::cross(along, std::abs(along.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0));
        return glm::normalize(aside);
    }
};

/* ---- From where ---- */

/* The direction that a pose faces: the sum of the faces' area vectors as a share of their area; 0 where they cancel out, as
 * round a limb, of which some is seen from any side. */
dvec3 turn_of(const Subject &subject, int32_t pose) {
    dvec3 sum(0);
    double area = 0;
    each_face_of(subject, pose, [&](const int32_t *v, int32_t n, auto place, double turn) {
        dvec3 own = area_of(v, n, place);
        sum += turn * own, area += glm::length(own);
    });
    return glm::length(sum) > cancelled * area ? sum / area : dvec3(0);
}

/* How much the pose that is turned away most is turned to a direction. */
double least_turned(const Subject &subject, dvec3 direction) {
    double least = 1;
    for (int32_t pose = 0; pose < subject.own.pose_count; pose++)
        if (subject.turns[pose] != dvec3(0))
            least = std::min(least, glm::dot(subject.turns[pose], direction));
    return least;
}

/* The direction of all poses together; but if a direction halfway between two poses is much better for the pose that is turned
 * away most, as when a character turns round, that one. */
dvec3 choose_direction(const Subject &subject, const Shape &shape, dvec3 up) {
    int32_t count = subject.own.pose_count;
    for (int32_t pose = 0; pose < count; pose++)
        subject.turns[pose] = turn_of(subject, pose);
    dvec3 common = shape.direction(up), best = common;
    double enough = least_turned(subject, common), most = enough;
    for (int32_t first = 0; first < count; first++)
        for (int32_t second = 0; second <= first; second++) {
            dvec3 sum = subject.turns[first] + subject.turns[second];
            if (!(glm::length(sum) > cancelled))
                continue;
            dvec3 between = glm::normalize(sum);
            double least = least_turned(subject, between);
            if (least > most)
                most = least, best = between;
        }
    return enough < much_less * most ? best : common;
}

/* ---- Framing ---- */

/* A direction that is up and not along the view. */
dvec3 up_for(dvec3 direction, dvec3 up) {
    if (glm::length(glm::cross(direction, up)) > 0.05)
        return up;
    return std::abs(direction.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
}

/* How far back from the middle, and the depths of what is seen from there. */
struct Distance {
    double back = -INFINITY, near = INFINITY, far = -INFINITY;
};

/* Drawn back until every corner is within the field of view. turned: from the world, less the distance back. */
Distance draw_back(const Subject &subject, const dmat4 &turned, double aspect, double size) {
    double tall = std::tan(field_of_view / 2) / margin, wide = tall * aspect;
    Distance found;
    each_face(subject, [&](const int32_t *v, int32_t n, auto place, double) {
        for (int32_t k = 0; k < n; k++) {
            dvec3 p = dvec3(turned * glm::dvec4(place(v[k]), 1));
            found.back = std::max(found.back, p.z + std::max(std::abs(p.x) / wide, std::abs(p.y) / tall));
            found.near = std::min(found.near, -p.z), found.far = std::max(found.far, -p.z);
        }
    });
    found.back = std::max(found.back, least_distance * size - found.near);
    found.near += found.back, found.far += found.back;
    return found;
}

/* Looks against a direction. */
skinslide_camera look(const Subject &subject, const Shape &shape, dvec3 direction, dvec3 up, double aspect) {
    dmat4 turned(dmat3(glm::lookAt(direction, dvec3(0), up_for(direction, up))));
    turned = glm::translate(turned, -shape.box.middle());
    Box seen;
    each_face(subject, [&](const int32_t *v, int32_t n, auto place, double) {
        for (int32_t k = 0; k < n; k++)
            seen.add(dvec3(turned * glm::dvec4(place(v[k]), 1)));
    });
    turned = glm::translate(dmat4(1), -seen.middle()) * turned;
    double size = seen.size(); /* of the box in the camera's axes, which turns with subject and camera, as the world's does
                                  not */
    Distance away = draw_back(subject, turned, aspect, size);
    dmat4 to_camera = glm::translate(dmat4(1), dvec3(0, 0, -away.back)) * turned;
    dmat4 to_screen = glm::perspective(field_of_view, aspect, std::max(away.near - in_front * size, nearest * away.near),
                                       away.far + behind * size);
    skinslide_camera camera;
    std::copy_n(glm::value_ptr(to_camera), 16, camera.to_camera);
    std::copy_n(glm::value_ptr(to_screen), 16, camera.to_screen);
    return camera;
}

skinslide_status frame(const Subject &subject, dvec3 up, double aspect, skinslide_camera *camera, skinslide_error *error) {
    Shape shape(subject);
    double size = shape.box.size();
    skinslide_camera found = {};
    if (size > 0 && std::isfinite(size))
        found = look(subject, shape, choose_direction(subject, shape, up), up, aspect);
    if (!(size > 0) || !std::isfinite(size) || !all_finite(found.to_camera, 16) || !all_finite(found.to_screen, 16))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "no camera can have the faces in sight: they are all in one place, or endless");
    *camera = found;
    return SKINSLIDE_OK;
}

/* False if memory is short. */
bool prepare(Subject &subject, ss_memory *memory) {
    const skinslide_mesh &mesh = *subject.own.mesh;
    subject.start = SS_NEW(memory, int32_t, mesh.face_count);
    subject.turns = SS_NEW(memory, dvec3, subject.own.pose_count);
    for (int32_t f = 0, c = 0; subject.start && f < mesh.face_count; c += mesh.face_counts[f++])
        subject.start[f] = c;
    return !memory->failed;
}

/* ---- Bad input ---- */

skinslide_status check_poses(const skinslide_subject &own, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    char what[32];
    for (int32_t pose = 0; pose < own.pose_count && !status; pose++) {
        std::snprintf(what, sizeof what, "pose %d: points", pose);
        status = ss_check_points(own.poses[pose], own.mesh->vertex_count, what, error);
    }
    for (int32_t pose = 0; pose < own.pose_count && own.to_world && !status; pose++)
        if (!all_finite(own.to_world + 16 * int64_t(pose), 16))
            status = ss_fail(error, SKINSLIDE_BAD_POINTS, "pose %d: its way to the world is not finite", pose);
    return status;
}

skinslide_status check(const skinslide_subject &own, const double *up, double aspect, skinslide_error *error) {
    double length = up ? glm::length(glm::make_vec3(up)) : 0;
    if (!(length > 0) || !std::isfinite(length) || !(aspect > 0) || !std::isfinite(aspect))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no way up, or no shape of picture");
    skinslide_status status = ss_check_faces(own.mesh->face_count, own.faces, own.face_count, error);
    return status ? status : check_poses(own, error);
}

} // namespace

/* ---- C ---- */

bool ss_view_of(const skinslide_camera *camera, const double *to_world, const double origin[3], ss_view *view) {
    dmat4 world = glm::translate(matrix_of(to_world), dvec3(origin[0], origin[1], origin[2]));
    dmat4 to_camera = matrix_of(camera->to_camera) * world, to_clip = matrix_of(camera->to_screen) * to_camera;
    dmat3 normal = glm::transpose(glm::inverse(dmat3(to_camera)));
    std::copy_n(glm::value_ptr(glm::mat4(to_clip)), 16, view->to_clip);
    std::copy_n(glm::value_ptr(glm::mat3(normal / largest(normal))), 9, view->turn_normal);
    view->mirrored = glm::determinant(to_clip) > 0; /* below 0 unless it is: depth in clip space goes away from the camera */
    return all_finite(view->to_clip, 16) && all_finite(view->turn_normal, 9);
}

skinslide_status skinslide_frame_faces(const skinslide_subject *subject, const double up[3], double aspect,
                                       skinslide_camera *camera, skinslide_error *error) {
    if (!subject || !camera)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no subject, or no place for the camera");
    skinslide_subject own = SKINSLIDE_SUBJECT_DEFAULT;
    ss_taken_mesh taken;
    skinslide_status status = ss_take(subject, "skinslide_subject", &own, sizeof own, error);
    if (!status && (own.face_count < 1 || !own.faces || own.pose_count < 1 || !own.poses))
        status = ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no faces, or no poses");
    if (!status)
        status = ss_take_mesh(&own.mesh, &taken, error);
    if (!status)
        status = check(own, up, aspect, error);
    if (status)
        return status;
    ss_memory scratch = {};
    Subject all{own, nullptr, nullptr};
    status = prepare(all, &scratch) ? frame(all, glm::normalize(glm::make_vec3(up)), aspect, camera, error)
                                    : ss_out_of_memory(error);
    ss_free(&scratch);
    return status;
}
