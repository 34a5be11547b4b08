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
    LiveMesh(std::shared_ptr<const PatchedMesh> source, const Params &params, std::string layerName);
    ~LiveMesh();
    LiveMesh(const LiveMesh &) = delete;
    LiveMesh &operator=(const LiveMesh &) = delete;

    const PatchedMesh &source() const {
        return *_source;
    }
    // Each gives the value at a time of the layer, Attribute::defaultTime where the mesh has no samples. Where something fails
    // there is one message for the mesh and time, and the cache's own value.
    VtValue points(double time);
    VtValue extent(double time);
    VtValue normals(double time);
    VtValue rate(const Rate &rate, double time);

  private:
    struct Pose {
        VtVec3fArray cached, slid;
    };
    std::shared_ptr<const Frame> frame(double time);
    Frame solve(double time);
    VtVec3fArray slide(double time);
    VtVec3fArray cachedPoints(double time) const;
    bool pose(double time, Pose *pose);
    const skinslide_slider *slider();
    void build();
    [[noreturn]] void giveUp(const std::string &problem);
    skinslide_workspace_options workspaceOptions();
    skinslide_workspace *takeWorkspace();
    void giveBack(skinslide_workspace *workspace);
    skinslide_mesh nativeMesh() const;
    std::vector<double> samplesAround(double time, size_t count) const;
    void say(double time, const std::string &message);

    const std::shared_ptr<const PatchedMesh> _source;
    const std::string _lookup, _layerName;
    std::once_flag _built;
    skinslide_slider *_slider = nullptr;
    std::string _problem; // why there is no slider, or no workspace
    std::mutex _mutex;    // of what follows
    std::vector<skinslide_workspace *> _idle;
    std::set<std::string> _said;
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
