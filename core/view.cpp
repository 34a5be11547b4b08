/* Where pictures are seen from: matrices for drawing, and a camera that has faces in sight. Behind C functions. */
#include "draw.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace {

using glm::dmat4;
using glm::dvec3;

const double field_of_view = 0.5; /* radians, up and down */
const double margin = 1.12;       /* round what is framed */
const double cancelled = 0.25;    /* of the area: normals that sum to less say nothing */

/* USD's rows of points as rows are the columns of points as columns. */
dmat4 matrix_of(const double *rows) {
    return rows ? glm::make_mat4(rows) : dmat4(1);
}

bool is_finite(const ss_view &view) {
    auto finite = [](float x) { return std::isfinite(x); };
    return std::all_of(view.to_camera, view.to_camera + 16, finite) && std::all_of(view.to_clip, view.to_clip + 16, finite) &&
           std::all_of(view.turn_normal, view.turn_normal + 9, finite);
}

/* ---- Framing ---- */

/* Faces in some poses, in the world. */
struct Subject {
    const skinslide_mesh *mesh;
    const int32_t *faces;
    int32_t face_count;
    const float *const *poses;
    const double *to_world;
    int32_t pose_count;

    /* Calls body(pose, vertices, n, first corner's place, place_of) for each face. */
    template <typename Body> void each_face(Body body) const {
        for (int32_t pose = 0; pose < pose_count; pose++) {
            dmat4 matrix = matrix_of(to_world ? to_world + 16 * int64_t(pose) : nullptr);
            auto place = [&](int32_t vertex) {
                const float *p = poses[pose] + 3 * int64_t(vertex);
                return dvec3(matrix * glm::dvec4(p[0], p[1], p[2], 1));
            };
            int32_t face = 0, start = 0;
            for (int32_t i = 0; i < face_count; i++) {
                if (faces[i] < face)
                    face = start = 0;
                for (; face < faces[i]; face++)
                    start += mesh->face_counts[face];
                body(mesh->face_indices + start, mesh->face_counts[face], place);
            }
        }
    }
};

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
    dvec3 normal{0}; /* the sum of area vectors */
    double area = 0;
    glm::dmat3 spread{0}; /* the sum of area vectors' squares: least along the direction in which the faces are seen least */

    explicit Shape(const Subject &subject) {
        subject.each_face([&](const int32_t *v, int32_t n, auto place) {
            dvec3 sum(0);
            for (int32_t k = 0; k < n; k++)
                box.add(place(v[k]));
            for (int32_t k = 1; k + 1 < n; k++)
                sum += 0.5 * glm::cross(place(v[k]) - place(v[0]), place(v[k + 1]) - place(v[0]));
            normal += sum;
            area += glm::length(sum);
            if (glm::length(sum) > 0)
                spread += glm::outerProduct(sum, sum) / glm::length(sum);
        });
    }

    /* The direction in which most of the area is seen: the largest eigenvector of the spread, by squaring it. */
    dvec3 widest() const {
        glm::dmat3 power = spread / std::max(area, 1e-300);
        for (int i = 0; i < 6; i++) {
            power = power * power;
            power /= std::max(power[0][0] + power[1][1] + power[2][2], 1e-300);
        }
        int most = 0;
        for (int i = 1; i < 3; i++)
            most = glm::length(power[i]) > glm::length(power[most]) ? i : most;
        return power[most];
    }

    /* Towards the camera. */
    dvec3 direction() const {
        dvec3 found = glm::length(normal) > cancelled * area ? normal : widest();
        return glm::length(found) > 0 ? glm::normalize(found) : dvec3(0, 0, 1);
    }
};

/* A direction that is up and not along the view. */
dvec3 up_for(dvec3 direction, dvec3 up) {
    if (glm::length(glm::cross(direction, up)) > 0.05)
        return up;
    return std::abs(direction.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
}

/* Looks against a direction, and draws back until every corner is within the field of view. */
skinslide_camera look(const Subject &subject, const Shape &shape, dvec3 direction, dvec3 up, double aspect) {
    dvec3 middle = shape.box.middle();
    dmat4 turned = glm::lookAt(middle + direction, middle, up_for(direction, up));
    double tall = std::tan(field_of_view / 2) / margin, wide = tall * aspect, back = 0, near = INFINITY, far = -INFINITY;
    Box seen;
    subject.each_face([&](const int32_t *v, int32_t n, auto place) {
        for (int32_t k = 0; k < n; k++)
            seen.add(dvec3(turned * glm::dvec4(place(v[k]), 1)));
    });
    dvec3 shift(seen.middle().x, seen.middle().y, 0);
    subject.each_face([&](const int32_t *v, int32_t n, auto place) {
        for (int32_t k = 0; k < n; k++) {
            dvec3 p = dvec3(turned * glm::dvec4(place(v[k]), 1)) - shift;
            back = std::max(back, p.z + std::max(std::abs(p.x) / wide, std::abs(p.y) / tall));
            near = std::min(near, -p.z), far = std::max(far, -p.z);
        }
    });
    dmat4 to_camera = glm::translate(dmat4(1), dvec3(0, 0, -back)) * glm::translate(dmat4(1), -shift) * turned;
    double first = near + back, size = shape.box.size();
    dmat4 to_screen = glm::perspective(field_of_view, aspect, std::max(first - 4 * size, 0.1 * first), far + back + 40 * size);
    skinslide_camera camera;
    std::copy_n(glm::value_ptr(to_camera), 16, camera.to_camera);
    std::copy_n(glm::value_ptr(to_screen), 16, camera.to_screen);
    return camera;
}

skinslide_status check(const Subject &subject, const double *up, double aspect, skinslide_error *error) {
    skinslide_status status = ss_check_mesh(subject.mesh, error);
    if (status)
        return status;
    if (subject.face_count < 1 || !subject.faces || subject.pose_count < 1 || !subject.poses || !up || !(aspect > 0) ||
        !std::isfinite(aspect) || !(glm::length(glm::make_vec3(up)) > 0))
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no faces or poses, no way up, or no shape of picture");
    for (int32_t i = 0; i < subject.face_count; i++)
        if (subject.faces[i] < 0 || subject.faces[i] >= subject.mesh->face_count)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "face %d is not one of the mesh's %d", subject.faces[i],
                           subject.mesh->face_count);
    for (int32_t pose = 0; pose < subject.pose_count && !status; pose++)
        status = ss_check_points(subject.poses[pose], subject.mesh->vertex_count, "points", error);
    return status;
}

} // namespace

bool ss_view_of(const skinslide_camera *camera, const double *to_world, const double origin[3], ss_view *view) {
    dmat4 world = glm::translate(matrix_of(to_world), dvec3(origin[0], origin[1], origin[2]));
    dmat4 to_camera = matrix_of(camera->to_camera) * world, to_clip = matrix_of(camera->to_screen) * to_camera;
    glm::mat3 normal(glm::transpose(glm::inverse(glm::dmat3(to_camera))));
    std::copy_n(glm::value_ptr(glm::mat4(to_camera)), 16, view->to_camera);
    std::copy_n(glm::value_ptr(glm::mat4(to_clip)), 16, view->to_clip);
    std::copy_n(glm::value_ptr(normal), 9, view->turn_normal);
    view->mirrored = glm::determinant(glm::dmat3(to_camera)) < 0;
    return is_finite(*view);
}

skinslide_status skinslide_frame_faces(const skinslide_mesh *mesh, const int32_t *faces, int32_t face_count,
                                       const float *const *poses, const double *to_world, int32_t pose_count,
                                       const double up[3], double aspect, skinslide_camera *camera, skinslide_error *error) {
    Subject subject{mesh, faces, face_count, poses, to_world, pose_count};
    if (!camera)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the camera");
    skinslide_status status = check(subject, up, aspect, error);
    if (status)
        return status;
    Shape shape(subject);
    if (!(shape.box.size() > 0) || !std::isfinite(shape.box.size()))
        return ss_fail(error, SKINSLIDE_BAD_POINTS,
                       "no camera can have the faces in sight: they are all in one place, or endless");
    *camera = look(subject, shape, shape.direction(), glm::normalize(glm::make_vec3(up)), aspect);
    return SKINSLIDE_OK;
}
