/* See refined.h. Far and Vtr refine by the rules of Sdc; none of it is what the core evaluates patches with. */
#include "refined.h"

#include <memory>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <vector>

using namespace OpenSubdiv;

namespace {

struct Point {
    double x[3] = {0, 0, 0};

    void Clear(void * = nullptr) {
        x[0] = x[1] = x[2] = 0;
    }
    void AddWithWeight(const Point &other, double weight) {
        for (int k = 0; k < 3; k++)
            x[k] += weight * other.x[k];
    }
};

std::unique_ptr<Far::TopologyRefiner> refiner_of(const skinslide_mesh &mesh, int levels) {
    const skinslide_subdivision &own = *mesh.subdivision;
    Sdc::Options options;
    const Sdc::Options::VtxBoundaryInterpolation boundaries[] = {
        Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER, Sdc::Options::VTX_BOUNDARY_EDGE_ONLY, Sdc::Options::VTX_BOUNDARY_NONE};
    const Sdc::SchemeType schemes[] = {Sdc::SCHEME_BILINEAR, Sdc::SCHEME_CATMARK, Sdc::SCHEME_LOOP, Sdc::SCHEME_BILINEAR};
    options.SetVtxBoundaryInterpolation(boundaries[own.boundary_rule]);
    options.SetTriangleSubdivision(own.triangle_rule ? Sdc::Options::TRI_SUB_SMOOTH : Sdc::Options::TRI_SUB_CATMARK);
    std::vector<int> pairs; /* the tests' creases are single edges */
    for (int32_t i = 0; i < own.crease_count; i++)
        pairs.insert(pairs.end(), {own.crease_indices[2 * i], own.crease_indices[2 * i + 1]});
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = mesh.vertex_count;
    descriptor.numFaces = mesh.face_count;
    descriptor.numVertsPerFace = mesh.face_counts;
    descriptor.vertIndicesPerFace = mesh.face_indices;
    descriptor.numCreases = own.crease_count;
    descriptor.creaseVertexIndexPairs = pairs.data();
    descriptor.creaseWeights = own.crease_sharpnesses;
    descriptor.numCorners = own.corner_count;
    descriptor.cornerVertexIndices = own.corner_indices;
    descriptor.cornerWeights = own.corner_sharpnesses;
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(schemes[own.scheme], options)));
    Far::TopologyRefiner::UniformOptions uniform(levels);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    return refiner;
}

/* The limit points of the last level's vertices. */
std::vector<Point> limit_of(const Far::TopologyRefiner &refiner, const float *points) {
    Far::PrimvarRefinerReal<double> primvars(refiner);
    std::vector<Point> level(size_t(refiner.GetLevel(0).GetNumVertices()));
    for (size_t v = 0; v < level.size(); v++)
        for (int k = 0; k < 3; k++)
            level[v].x[k] = points[3 * v + size_t(k)];
    for (int i = 1; i <= refiner.GetMaxLevel(); i++) {
        std::vector<Point> next(size_t(refiner.GetLevel(i).GetNumVertices()));
        Point *from = level.data(), *to = next.data();
        primvars.Interpolate(i, from, to);
        level.swap(next);
    }
    std::vector<Point> limit(level.size());
    Point *from = level.data(), *to = limit.data();
    primvars.Limit(from, to);
    return limit;
}

/* The vertex that a vertex of level 1 has become in the last level. */
int descend(const Far::TopologyRefiner &refiner, int vertex) {
    for (int i = 1; i < refiner.GetMaxLevel(); i++)
        vertex = refiner.GetLevel(i).GetVertexChildVertex(vertex);
    return vertex;
}

/* The middle of a triangle of the loop scheme is not a vertex of any level: the corner stands in for it. */
int middle_of(const Far::TopologyRefiner &refiner, int face, int corner_child) {
    if (refiner.GetSchemeType() == Sdc::SCHEME_LOOP)
        return corner_child;
    return refiner.GetLevel(0).GetFaceChildVertex(face);
}

} // namespace

void refine_to_limit(const skinslide_mesh *mesh, const float *points, int levels, double (*out)[3][3]) {
    auto refiner = refiner_of(*mesh, levels);
    std::vector<Point> limit = limit_of(*refiner, points);
    Far::TopologyLevel base = refiner->GetLevel(0);
    for (int face = 0, corner = 0; face < base.GetNumFaces(); face++) {
        Far::ConstIndexArray vertices = base.GetFaceVertices(face), edges = base.GetFaceEdges(face);
        for (int k = 0; k < vertices.size(); k++, corner++) {
            int own = base.GetVertexChildVertex(vertices[k]);
            int children[3] = {own, base.GetEdgeChildVertex(edges[k]), middle_of(*refiner, face, own)};
            for (int place = 0; place < 3; place++)
                for (int axis = 0; axis < 3; axis++)
                    out[corner][place][axis] = limit[size_t(descend(*refiner, children[place]))].x[axis];
        }
    }
}
