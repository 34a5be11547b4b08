// The set-ups of the patches of a mesh: the one place that reads what section "on the stage" of the schema says of a patch.
#ifndef SKINSLIDE_FORMAT_PATCHES_H
#define SKINSLIDE_FORMAT_PATCHES_H

#include "params.h"
#include "textures.h"
#include "values.h"

#include "skinslide/skinslide.h"

#include <optional>

namespace skinslide {

// How the points of a mesh make faces. Counts and indices fit each other and the number of points.
struct Topology {
    std::vector<int32_t> faceCounts, faceIndices;
    std::vector<size_t> faceStart; // [faces + 1] in faceIndices
    size_t vertexCount = 0;

    size_t faceCount() const {
        return faceCounts.size();
    }
    std::vector<bool> verticesOf(const std::vector<int32_t> &faces) const;
    std::vector<int32_t> facesWithin(const std::vector<bool> &vertices) const; // faces whose vertices are all chosen
};

// The controls of one patch at one time; empty arrays are those that are not painted.
struct Controls {
    std::vector<float> vertexDensity, faceDensity, edgeDensity, weight, maxDistance;
    std::vector<int32_t> edges; // pairs
    float envelope = 1;

    skinslide_controls native() const; // points into this
};

// One patch: its set-up, and its controls over time.
class Patch {
  public:
    // Throws Fault.
    Patch(Composition &composition, const Prim &mesh, const std::string &name, const Topology &topology, const Params &params);

    const std::string &name() const {
        return _name;
    }
    bool varies() const;               // whether any control does
    std::vector<double> times() const; // of controls that vary
    Controls controlsAt(double time, const Topology &topology) const;
    // Whether its interpolation depends on how the mesh is subdivided.
    bool needsSubdivision() const {
        return _interpolation == SKINSLIDE_INTERPOLATION_AUTO || _interpolation == SKINSLIDE_INTERPOLATION_LIMIT;
    }
    // Resolved paths of the files of its maps.
    std::set<std::string> files() const;
    // Points into this patch and into controls.
    skinslide_patch_setup native(const Controls &controls) const;

  private:
    void readFaces(Composition &composition, const Prim &mesh, const Topology &topology);
    void readCorners(const Prim &mesh, const Topology &topology);
    void readEdges(const Prim &mesh);
    int readToken(const Prim &mesh, const char *setting, const std::vector<std::string> &tokens) const;
    std::vector<float> painted(const Primvar &primvar, double time, const Topology &topology, bool byFace) const;
    std::vector<float> paintedByVertex(const Primvar &primvar, double time, const Topology &topology, bool (*isGood)(float),
                                       const char *wanted) const;
    void takeDensity(double time, const Topology &topology, Controls *controls) const;
    void takeEdges(double time, Controls *controls) const;
    void takeEnvelope(double time, Controls *controls) const;

    std::string _name;
    std::vector<int32_t> _faces, _corners, _edges;
    std::vector<bool> _insideVertex, _insideFace;
    int _boundary, _holes, _rule, _interpolation;
    double _liveEnvelope;
    Primvar _weight, _maxDistance, _density;
    Texture _weightMap, _densityMap;
    Attribute _envelope, _edgeDensity;
};

} // namespace skinslide

#endif
