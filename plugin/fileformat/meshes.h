// The meshes that a composed layer slides: found, fetched, and handed to the core.
#ifndef SKINSLIDE_FORMAT_MESHES_H
#define SKINSLIDE_FORMAT_MESHES_H

#include "params.h"
#include "patches.h"

namespace skinslide {

// An attribute that follows from points.
struct Derived {
    const skinslide_stage_output *output; // of the mesh's handle
    Property cached;                      // of the cache; of what is only blocked, nothing
};

// One mesh with its patches: immutable, and free of the composition it was read from. Times are the layer's.
struct PatchedMesh {
    SdfPath path;
    MeshHandle mesh;
    std::vector<Patch> patches;
    Property points;
    std::vector<double> times; // the authored samples of points and of animated controls; none where there are only defaults
    DerivedHandle derivation;
    std::vector<Derived> derived;

    bool controlsVary() const;
    bool carries() const; // whether anything depends on how the skin turned
};

// Every mesh that can be slid. `problems` says of every other why not, each a line that begins with the prim.
std::vector<std::shared_ptr<const PatchedMesh>> readMeshes(Composition &composition, const Params &params,
                                                           std::vector<std::string> *problems);

} // namespace skinslide

#endif
