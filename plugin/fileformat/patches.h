// The patches of a mesh: what is fetched of each, and handed to the core.
#ifndef SKINSLIDE_FORMAT_PATCHES_H
#define SKINSLIDE_FORMAT_PATCHES_H

#include "values.h"

#include <set>

namespace skinslide {

// One patch: its settings, and its controls over time.
class Patch {
  public:
    // mesh  outlives the patch. Throws Fault.
    Patch(Composition &composition, const Prim &prim, const skinslide_stage_mesh *mesh, const std::string &name,
          const skinslide_stage_live &live);

    const std::string &name() const {
        return _name;
    }
    bool varies() const;               // whether any control does
    std::vector<double> times() const; // of controls that vary
    bool needsSubdivision() const {
        return skinslide_stage_patch_needs_subdivision(_patch.get());
    }
    // What to warn of; null: nothing.
    const char *warning() const {
        return skinslide_stage_patch_warning(_patch.get());
    }
    // Whether it is to meet the other meshes in its space before it is set up.
    bool wantsNeighbours() const {
        return skinslide_stage_patch_wants_neighbours(_patch.get());
    }
    // Takes the points of one at the first time. Throws Fault.
    void meet(const VtVec3fArray &others) {
        call(skinslide_stage_patch_meet, _patch.get(), floatsOf(others), static_cast<int32_t>(others.size()));
    }
    // Resolved paths of the files of its textures, but for tiles that only later times lie in.
    const std::set<std::string> &files() const {
        return _files;
    }
    // With the controls of the first time. Points into this. Throws Fault.
    skinslide_patch_setup setup() const;
    // Memory for the controls of frames, of one thread at a time.
    ControlsHandle frames() const;
    // The controls of a frame. Points into `frames` and into this. Throws Fault.
    skinslide_controls controlsAt(double time, skinslide_stage_controls *frames) const;

  private:
    void giveSubset(Composition &composition, const Prim &prim);

    std::string _name;
    PatchHandle _patch;
    ControlsHandle _first;
    std::vector<Property> _controls; // with the coordinates of textures, where there are any
    std::set<std::string> _files;
};

} // namespace skinslide

#endif
