/* Limit surfaces of a subdivided mesh, face by face, and the weights of mesh vertices that make a point of them. The only file
 * that knows OpenSubdiv, whose Bfr surfaces need no refined mesh. All is behind C functions: no exception leaves this file. */
#include "limit.h"

#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <memory>
#include <new>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/version.h>
#include <vector>

using namespace OpenSubdiv;
using Surface = Bfr::Surface<double>;
/* Caches what faces alike share; for one thread at a time. */
using SurfaceFactory = Bfr::RefinerSurfaceFactory<>;

struct ss_topology {
    const skinslide_mesh *mesh;
    std::vector<uint8_t> is_hole; /* [face_count] listed in holeIndices */
    std::unique_ptr<Far::TopologyRefiner> refiner;
};

struct ss_limit_surfaces {
    std::vector<Surface> faces;
    std::vector<int32_t> vertex_start; /* [face count + 1] control points of each face ... */
    std::vector<int32_t> vertices;     /* ... as mesh vertices, in the order of the surface */
    int32_t most_patch_points = 0, most_vertices = 0;
};

namespace {

/* Runs body, which returns a status. What it throws becomes a status too. */
template <typename Body> skinslide_status guarded(skinslide_error *error, Body body) {
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return ss_out_of_memory(error);
    } catch (...) {
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "OpenSubdiv could not subdivide the mesh");
    }
}

/* ---- Topology ---- */

Sdc::SchemeType scheme_of(const skinslide_subdivision &own) {
    switch (own.scheme) {
    case SKINSLIDE_SCHEME_LOOP:
        return Sdc::SCHEME_LOOP;
    case SKINSLIDE_SCHEME_BILINEAR:
        return Sdc::SCHEME_BILINEAR;
    default:
        return Sdc::SCHEME_CATMARK;
    }
}

Sdc::Options options_of(const skinslide_subdivision &own) {
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(own.boundary_rule == SKINSLIDE_BOUNDARY_RULE_NONE ? Sdc::Options::VTX_BOUNDARY_NONE
                                        : own.boundary_rule == SKINSLIDE_BOUNDARY_RULE_EDGE_ONLY
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetTriangleSubdivision(own.triangle_rule == SKINSLIDE_TRIANGLE_RULE_SMOOTH ? Sdc::Options::TRI_SUB_SMOOTH
                                                                                       : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

float sharpness_of(float sharpness) {
    return std::min(sharpness, float(Sdc::Crease::SHARPNESS_INFINITE));
}

/* Creases, edge by edge, and corners, with sharpnesses in OpenSubdiv's range. */
struct Sharp {
    std::vector<int> pairs;
    std::vector<float> edges, corners;

    explicit Sharp(const skinslide_subdivision &own) {
        bool by_edge = own.crease_sharpness_count != own.crease_count;
        for (int32_t i = 0, start = 0, edge = 0; i < own.crease_count; start += own.crease_lengths[i++])
            for (int32_t k = start; k + 1 < start + own.crease_lengths[i]; k++, edge++) {
                pairs.insert(pairs.end(), {own.crease_indices[k], own.crease_indices[k + 1]});
                edges.push_back(sharpness_of(own.crease_sharpnesses[by_edge ? edge : i]));
            }
        for (int32_t i = 0; i < own.corner_count; i++)
            corners.push_back(sharpness_of(own.corner_sharpnesses[i]));
    }
};

std::unique_ptr<Far::TopologyRefiner> refine(const skinslide_mesh &mesh) {
    const skinslide_subdivision &own = *mesh.subdivision;
    Sharp sharp(own);
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = mesh.vertex_count;
    descriptor.numFaces = mesh.face_count;
    descriptor.numVertsPerFace = mesh.face_counts;
    descriptor.vertIndicesPerFace = mesh.face_indices;
    descriptor.numCreases = int(sharp.edges.size());
    descriptor.creaseVertexIndexPairs = sharp.pairs.data();
    descriptor.creaseWeights = sharp.edges.data();
    descriptor.numCorners = own.corner_count;
    descriptor.cornerVertexIndices = own.corner_indices;
    descriptor.cornerWeights = sharp.corners.data();
    descriptor.numHoles = own.hole_count;
    descriptor.holeIndices = own.hole_indices;
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    return std::unique_ptr<Far::TopologyRefiner>(
        Factory::Create(descriptor, Factory::Options(scheme_of(own), options_of(own))));
}

skinslide_status build_topology(const skinslide_mesh &mesh, ss_topology &topology, skinslide_error *error) {
    const skinslide_subdivision &own = *mesh.subdivision;
    topology.mesh = &mesh;
    topology.is_hole.assign(size_t(mesh.face_count), 0);
    for (int32_t i = 0; i < own.hole_count; i++)
        topology.is_hole[size_t(own.hole_indices[i])] = 1;
    topology.refiner = refine(mesh);
    if (!topology.refiner)
        return ss_fail(error, SKINSLIDE_BAD_MESH, "OpenSubdiv refuses the mesh");
    return SKINSLIDE_OK;
}

/* ---- Surfaces ---- */

bool any_of(const Far::ConstIndexArray &indices, bool (*is)(const Far::TopologyLevel &, int), const Far::TopologyLevel &level) {
    return std::any_of(indices.begin(), indices.end(), [&](int index) { return is(level, index); });
}

bool has_two_faces_around(const Far::TopologyLevel &level, int vertex) {
    return level.GetVertexFaces(vertex).size() == 2 && level.GetVertexEdges(vertex).size() == 2;
}

bool is_on_boundary(const Far::TopologyLevel &level, int vertex) {
    return level.IsVertexBoundary(vertex) || level.IsVertexNonManifold(vertex);
}

bool is_crease(const Far::TopologyLevel &level, int edge) {
    return !level.IsEdgeBoundary(edge) && !level.IsEdgeNonManifold(edge) && level.GetEdgeSharpness(edge) > 0;
}

bool is_creased(const Far::TopologyLevel &level, int vertex) {
    return any_of(level.GetVertexEdges(vertex), is_crease, level);
}

/* Whether a face around a face's vertices has a vertex or an edge at which the mesh is not manifold. */
bool is_near_non_manifold(const Far::TopologyLevel &level, const Far::ConstIndexArray &vertices) {
    auto vertex_is = [](const Far::TopologyLevel &own, int vertex) { return own.IsVertexNonManifold(vertex); };
    auto edge_is = [](const Far::TopologyLevel &own, int edge) { return own.IsEdgeNonManifold(edge); };
    for (int vertex : vertices)
        for (int face : level.GetVertexFaces(vertex))
            if (any_of(level.GetFaceVertices(face), vertex_is, level) || any_of(level.GetFaceEdges(face), edge_is, level))
                return true;
    return false;
}

/* Why OpenSubdiv before 3.5.1 crashes at a face, or NULL. Around a creased vertex it reads creases that were never written if
 * the face has both a boundary vertex and a vertex of two faces, and looks for edges that do not exist where the mesh is not
 * manifold. */
const char *crash_at(const ss_topology &topology, int32_t face) {
    Far::TopologyLevel level = topology.refiner->GetLevel(0);
    Far::ConstIndexArray vertices = level.GetFaceVertices(face);
    if (OPENSUBDIV_VERSION_NUMBER >= 30501 || !any_of(vertices, is_creased, level))
        return nullptr;
    if (any_of(vertices, has_two_faces_around, level) && any_of(vertices, is_on_boundary, level))
        return "a crease, the mesh's boundary and a vertex of two faces";
    return is_near_non_manifold(level, vertices) ? "a crease, near where the mesh is not manifold" : nullptr;
}

/* The most faces around a vertex, and vertices of a face, for which surfaces are made: their cost grows with the cube. 256 take
 * a third of a second a frame, and 2 GB if creases make all of them differ. */
const int most_around = 256;

/* The first vertex of a face with more faces around it than that, or -1. */
int crowded_vertex(const ss_topology &topology, const Far::ConstIndexArray &vertices) {
    Far::TopologyLevel level = topology.refiner->GetLevel(0);
    auto is_crowded = [&](int vertex) { return level.GetVertexFaces(vertex).size() > most_around; };
    auto found = std::find_if(vertices.begin(), vertices.end(), is_crowded);
    return found == vertices.end() || topology.refiner->GetSchemeType() == Sdc::SCHEME_BILINEAR ? -1 : *found;
}

skinslide_status refuse_crowd(const ss_topology &topology, int32_t face, const char *label, skinslide_error *error) {
    Far::TopologyLevel level = topology.refiner->GetLevel(0);
    Far::ConstIndexArray vertices = level.GetFaceVertices(face);
    int vertex = crowded_vertex(topology, vertices);
    bool is_face = vertices.size() > most_around;
    if (!is_face && vertex < 0)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: %s %d has %d %s; limit surfaces are made for %d at most", label,
                   is_face ? "face" : "vertex", is_face ? face : vertex,
                   is_face ? vertices.size() : level.GetVertexFaces(vertex).size(), is_face ? "vertices" : "faces",
                   most_around);
}

/* OpenSubdiv is asked last, since asking may be what crashes it. */
ss_face_surface kind_of(const ss_topology &topology, const SurfaceFactory &factory, int32_t face) {
    if (topology.is_hole[size_t(face)])
        return SS_SURFACE_NONE;
    if (refuse_crowd(topology, face, "", nullptr) || crash_at(topology, face))
        return SS_SURFACE_REFUSED;
    return factory.FaceHasLimitSurface(face) ? SS_SURFACE : SS_SURFACE_NONE;
}

skinslide_status refuse_hole(const ss_topology &topology, int32_t face, const char *label, skinslide_error *error) {
    const char *why = topology.is_hole[size_t(face)] ? "it is one of holeIndices"
                      : topology.mesh->subdivision->boundary_rule == SKINSLIDE_BOUNDARY_RULE_NONE
                          ? "interpolateBoundary none leaves the faces at the boundary of the mesh out"
                          : "OpenSubdiv has none for it";
    return ss_fail(error, SKINSLIDE_BAD_PATCH, "%s: face %d has no limit surface: %s", label, face, why);
}

skinslide_status build_surfaces(const ss_topology &topology, const int32_t *faces, int32_t count, const char *label,
                                ss_limit_surfaces &surfaces, skinslide_error *error) {
    SurfaceFactory factory(*topology.refiner);
    surfaces.faces.resize(size_t(count));
    surfaces.vertex_start.assign(1, 0);
    for (int32_t f = 0; f < count; f++) {
        Surface &surface = surfaces.faces[size_t(f)];
        if (skinslide_status status = refuse_crowd(topology, faces[f], label, error))
            return status;
        if (const char *why = crash_at(topology, faces[f]))
            return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: face %d has %s; OpenSubdiv before 3.5.1 cannot subdivide it",
                           label, faces[f], why);
        if (!factory.InitVertexSurface(faces[f], &surface))
            return refuse_hole(topology, faces[f], label, error);
        int32_t start = surfaces.vertex_start.back(), own = surface.GetNumControlPoints();
        surfaces.vertices.resize(size_t(start + own));
        surface.GetControlPointIndices(surfaces.vertices.data() + start);
        surfaces.vertex_start.push_back(start + own);
        surfaces.most_vertices = std::max(surfaces.most_vertices, own);
        surfaces.most_patch_points = std::max(surfaces.most_patch_points, int32_t(surface.GetNumPatchPoints()));
    }
    return SKINSLIDE_OK;
}

/* From our parameters to OpenSubdiv's, which lays the quads at a polygon's corners out in a grid. */
glm::dvec2 coordinates(const Surface &surface, const ss_parameter &at) {
    glm::dvec2 uv(at.st[0], at.st[1]);
    if (at.corner >= 0)
        surface.GetParameterization().ConvertNormalizedSubFaceToCoord(at.corner, at.st, &uv.x);
    return uv;
}

/* A place in the quad at a corner, in parameters of the face, which in triangles of the loop scheme are barycentric. */
ss_parameter place_in_face(const Surface &surface, int32_t corner, double s, double t) {
    Bfr::Parameterization parameters = surface.GetParameterization();
    if (parameters.GetType() == Bfr::Parameterization::QUAD_SUBFACES)
        return {corner, {s, t}};
    int32_t n = parameters.GetFaceSize();
    glm::dvec2 here, next, previous, middle;
    parameters.GetVertexCoord(corner, &here.x);
    parameters.GetVertexCoord((corner + 1) % n, &next.x);
    parameters.GetVertexCoord((corner + n - 1) % n, &previous.x);
    parameters.GetCenterCoord(&middle.x);
    glm::dvec2 near = glm::mix(here, 0.5 * (here + next), s), far = glm::mix(0.5 * (here + previous), middle, s);
    glm::dvec2 uv = glm::mix(near, far, t);
    return {-1, {uv.x, uv.y}};
}

} // namespace

/* ---- C ---- */

skinslide_status ss_topology_create(const skinslide_mesh *mesh, ss_topology **out, skinslide_error *error) {
    return guarded(error, [&] {
        auto topology = std::make_unique<ss_topology>();
        skinslide_status status = build_topology(*mesh, *topology, error);
        if (!status)
            *out = topology.release();
        return status;
    });
}

void ss_topology_destroy(ss_topology *topology) {
    delete topology;
}

skinslide_status ss_face_surfaces(const ss_topology *topology, ss_face_surface *kinds, skinslide_error *error) {
    return guarded(error, [&] {
        SurfaceFactory factory(*topology->refiner);
        for (int32_t face = 0; face < topology->mesh->face_count; face++)
            kinds[face] = kind_of(*topology, factory, face);
        return SKINSLIDE_OK;
    });
}

skinslide_status ss_limit_surfaces_create(const ss_topology *topology, const int32_t *mesh_faces, int32_t count,
                                          const char *label, ss_limit_surfaces **out, skinslide_error *error) {
    return guarded(error, [&] {
        auto surfaces = std::make_unique<ss_limit_surfaces>();
        skinslide_status status = build_surfaces(*topology, mesh_faces, count, label, *surfaces, error);
        if (!status)
            *out = surfaces.release();
        return status;
    });
}

void ss_limit_surfaces_destroy(ss_limit_surfaces *surfaces) {
    delete surfaces;
}

int32_t ss_limit_surfaces_scratch(const ss_limit_surfaces *surfaces) {
    return 3 * surfaces->most_patch_points;
}

int32_t ss_limit_surfaces_most_vertices(const ss_limit_surfaces *surfaces) {
    return surfaces->most_vertices;
}

int32_t ss_limit_stencil(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const int32_t **vertices,
                         double *weights) {
    const Surface &surface = surfaces->faces[size_t(face)];
    glm::dvec2 uv = coordinates(surface, *at);
    *vertices = surfaces->vertices.data() + surfaces->vertex_start[size_t(face)];
    return surface.EvaluateStencil(&uv.x, weights);
}

int32_t ss_limit_vertices(const ss_limit_surfaces *surfaces, int32_t face, const int32_t **vertices) {
    int32_t begin = surfaces->vertex_start[size_t(face)];
    *vertices = surfaces->vertices.data() + begin;
    return surfaces->vertex_start[size_t(face) + 1] - begin;
}

void ss_limit_prepare(const ss_limit_surfaces *surfaces, int32_t face, const float *points, const double origin[3],
                      double *scratch) {
    int32_t begin = surfaces->vertex_start[size_t(face)], end = surfaces->vertex_start[size_t(face) + 1];
    glm::dvec3 centre(origin[0], origin[1], origin[2]);
    for (int32_t i = begin; i < end; i++) {
        const float *point = points + 3 * int64_t(surfaces->vertices[size_t(i)]);
        glm::dvec3 offset = glm::dvec3(point[0], point[1], point[2]) - centre;
        std::memcpy(scratch + 3 * (i - begin), &offset.x, sizeof offset);
    }
    surfaces->faces[size_t(face)].ComputePatchPoints(scratch, 3);
}

void ss_limit_point(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch,
                    double out[3]) {
    const Surface &surface = surfaces->faces[size_t(face)];
    glm::dvec2 uv = coordinates(surface, *at);
    surface.Evaluate(&uv.x, scratch, 3, out);
}

double ss_limit_normal(const ss_limit_surfaces *surfaces, int32_t face, const ss_parameter *at, const double *scratch,
                       double point[3], double normal[3]) {
    const Surface &surface = surfaces->faces[size_t(face)];
    glm::dvec2 uv = coordinates(surface, *at);
    glm::dvec3 along_u, along_v;
    surface.Evaluate(&uv.x, scratch, 3, point, &along_u.x, &along_v.x);
    glm::dvec3 across = glm::cross(along_u, along_v), unit = glm::normalize(across);
    for (int k = 0; k < 3; k++)
        normal[k] = glm::length(across) > 0 ? unit[k] : 0;
    double squares = glm::dot(along_u, along_u) + glm::dot(along_v, along_v);
    return squares > 0 ? 2 * glm::length(across) / squares : 0;
}

ss_parameter ss_limit_parameter(const ss_limit_surfaces *surfaces, int32_t face, int32_t corner, double s, double t) {
    return place_in_face(surfaces->faces[size_t(face)], corner, s, t);
}
