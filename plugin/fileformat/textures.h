// The maps of a patch: OpenEXR images, sampled at a primvar of the mesh by the core.
#ifndef SKINSLIDE_FORMAT_TEXTURES_H
#define SKINSLIDE_FORMAT_TEXTURES_H

#include "values.h"

#include "skinslide/paint.h"

#include <memory>
#include <set>

namespace skinslide {

struct Topology;

// The map of one control of a patch, weight or forceDensity, over time.
class Texture {
  public:
    // Throws Fault.
    Texture(const Composition &composition, const Prim &mesh, const std::string &patch, const std::string &control);

    const std::string &name() const {
        return _map.name();
    }
    bool varies() const;
    std::vector<double> times() const; // where it varies
    // Samples it at the first time, and for good where it does not vary. Throws Fault.
    void settle(const Topology &topology, const std::vector<int32_t> &faces);
    // Values by vertex, 1 off the faces; none where there is no map. Throws Fault.
    std::vector<float> at(double time, const Topology &topology, const std::vector<int32_t> &faces) const;
    // Resolved paths of its files, but for tiles that only later times lie in.
    const std::set<std::string> &files() const {
        return _files;
    }

  private:
    using Image = std::unique_ptr<skinslide_image, void (*)(skinslide_image *)>;
    using Files = std::set<std::string>;
    struct Corners; // of the mesh, with their texture coordinates

    std::string path(double time) const; // anchored, with <UDIM> as it is; empty where there is none
    Corners corners(double time, const Topology &topology, const std::vector<int32_t> &faces) const;
    std::vector<int32_t> tiles(const Corners &corners, const std::string &path) const;
    std::vector<float> sample(const std::string &path, const Corners &corners, Files *files) const;
    Image read(const std::string &path, Files *files) const;

    Attribute _map;
    Primvar _st;
    std::string _channel, _setting, _resolvedPath;
    SdfLayerRefPtr _root;
    std::shared_ptr<const std::vector<float>> _still;
    Files _files;
};

} // namespace skinslide

#endif
