// A mesh that is slid when a frame of it is asked for, and what follows from its points. Any number of threads may ask.
#ifndef SKINSLIDE_FORMAT_LIVE_MESH_H
#define SKINSLIDE_FORMAT_LIVE_MESH_H

#include "frameCache.h"
#include "meshes.h"

#include <mutex>
#include <set>

namespace skinslide {

class LiveMesh {
  public:
    // layerName  for messages
    LiveMesh(std::shared_ptr<const PatchedMesh> mesh, skinslide_lookup lookup, std::string layerName);
    ~LiveMesh();
    LiveMesh(const LiveMesh &) = delete;
    LiveMesh &operator=(const LiveMesh &) = delete;

    const PatchedMesh &mesh() const {
        return *_mesh;
    }
    // Each gives the value at a time of the layer, Attribute::defaultTime where the mesh has no samples. Where the points
    // cannot be slid there is one message for the mesh and time, and the cache's own value; where what follows from them cannot
    // be recomputed, a message and a block. What is degraded, such as folded faces, is warned of once for each kind and patch.
    VtValue points(double time);
    VtValue extent(double time);
    VtValue derived(const Derived &derived, double time);

  private:
    // The memory of one thread's work on a frame.
    struct Work {
        std::unique_ptr<skinslide_workspace, Destroyer<skinslide_workspace, skinslide_workspace_destroy>> workspace;
        std::vector<ControlsHandle> controls; // of each patch, where any varies
    };
    std::shared_ptr<const Frame> frame(double time);
    Frame solve(double time);
    Frame slide(double time);
    VtVec3fArray cachedPoints(const Record &record) const;
    std::vector<skinslide_controls> controlsAt(double time, const Work &work) const;
    const skinslide_slider *slider();
    void build();
    std::vector<int32_t> weld(const std::vector<skinslide_patch_setup> &setups) const;
    void showPoses(skinslide_weld *weld) const;
    [[noreturn]] void giveUp(const std::string &problem);
    skinslide_workspace_options workspaceOptions();
    Work takeWork();
    void giveBack(Work work);
    void warnOfFailure(double time, const std::string &message);
    void warn(double time, const std::string &message) const;
    void warnOnce(const std::string &what, double time, const std::string &message);
    void warnOfFaults(double time, const VtVec3fArray &cached);
    void warnOfFaults(const Derived &derived, double time);
    void warnOfDegraded(double time, const skinslide_workspace *workspace);

    const std::shared_ptr<const PatchedMesh> _mesh;
    const skinslide_lookup _lookup;
    const std::string _layerName;
    std::once_flag _built;
    skinslide_slider *_slider = nullptr;
    std::string _problem; // why there is no slider, or no workspace
    std::mutex _mutex;    // of what follows
    std::vector<Work> _idle;
    std::set<std::string> _warned;
};

} // namespace skinslide

// What this process has done, for tests of laziness, of threads and of memory: the frames slid so far, the most that were slid
// at the same time, and the bytes of frames that are kept.
extern "C" {
__attribute__((visibility("default"))) uint64_t skinslideFormatSolveCount();
__attribute__((visibility("default"))) uint64_t skinslideFormatMostAtOnce();
__attribute__((visibility("default"))) uint64_t skinslideFormatCacheBytes();
}

#endif
