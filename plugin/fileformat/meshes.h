// The meshes that a composed layer slides, read as `skinslide bake` reads them from a stage.
#ifndef SKINSLIDE_FORMAT_MESHES_H
#define SKINSLIDE_FORMAT_MESHES_H

#include "patches.h"
#include "subdivision.h"

#include <memory>

namespace skinslide {

// Velocities or accelerations that are recomputed: from the difference of displacements over so many samples.
struct Rate {
    Attribute attribute;
    size_t sampleCount;
};

// One mesh with its patches: immutable, and free of the composition it was read from. Times are the layer's.
struct PatchedMesh {
    SdfPath path;
    Topology topology;
    Subdivision subdivision; // none where no patch needs it
    VtVec3fArray rest;
    std::vector<Patch> patches;
    Attribute points;
    std::vector<double> pointsTimes; // the authored samples of points
    std::vector<double> times;       // those, and those of animated controls; none where there are only defaults
    double timeCodesPerSecond;
    bool leftHanded;

    bool hasNormals = false;
    Primvar normals; // or the attribute `normals`, which has no indices
    TfToken normalsInterpolation;
    std::vector<Rate> rates;
    std::vector<std::pair<TfToken, TfToken>> blocked; // name and type: what cannot be recomputed

    bool controlsVary() const;
};

// Every mesh that can be slid. `problems` says of every other why not, each a line that begins with the prim.
std::vector<std::shared_ptr<const PatchedMesh>> readMeshes(Composition &composition, const Params &params,
                                                           std::vector<std::string> *problems);

} // namespace skinslide

#endif
