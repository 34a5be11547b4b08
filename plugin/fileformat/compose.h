// Composes a layer with PcpCache, and resolves values as a UsdStage would, except those of value clips and splines.
//
//     nodes strong to weak, layers strong to weak; in each layer timeSamples, else spline, else default: the first opinion wins
//
// Times are those of the root layer.
#ifndef SKINSLIDE_FORMAT_COMPOSE_H
#define SKINSLIDE_FORMAT_COMPOSE_H

#include "pxr/pxr.h"

#include "pxr/base/tf/token.h"
#include "pxr/base/vt/value.h"
#include "pxr/usd/pcp/cache.h"
#include "pxr/usd/pcp/errors.h"
#include "pxr/usd/sdf/layer.h"
#include "pxr/usd/sdf/layerOffset.h"
#include "pxr/usd/sdf/path.h"

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace skinslide {
using namespace PXR_NS;

// A composed attribute: where its value comes from. Keeps the layers it needs, but nothing of the composition.
class Attribute {
  public:
    enum class Source { None, Default, Samples, Spline };
    // As Usd.TimeCode.EarliestTime and Default.
    static constexpr double first = -std::numeric_limits<double>::infinity();
    static constexpr double defaultTime = std::numeric_limits<double>::quiet_NaN();

    const std::string &name() const {
        return _name;
    }
    const TfToken &typeName() const { // of the strongest opinion; empty where there is none
        return _typeName;
    }
    Source source() const {
        return _source;
    }
    bool authored() const { // has a value that is not blocked
        return _source != Source::None;
    }
    bool blocked() const {
        return _resolved && _source == Source::None;
    }
    // Whether value clips may give its value, which only a stage can read.
    bool clipped() const {
        return _clipped;
    }
    bool hasDefault() const; // even if samples hide it
    bool varies() const;     // may have different values at different times
    std::vector<double> times() const;
    // The value at a time, interpolated linearly between samples as Usd does; empty where there is none. The path of an asset
    // is evaluated, and anchored to the layer that authors it.
    VtValue at(double time) const;
    // The strongest opinion's layer: null where there is none.
    const SdfLayerRefPtr &layer() const {
        return _layer;
    }
    // The layer of an earlier bake that its value, or its default, comes from; null where there is none.
    SdfLayerRefPtr bakedLayer() const;
    // The variant that its value comes from, as set and name; empty where there is none.
    const std::pair<std::string, std::string> &variant() const {
        return _variant;
    }
    VtValue metadata(const TfToken &field) const;
    TfToken token(const TfToken &field, const TfToken &fallback) const;

  private:
    friend class Prim;
    VtValue authoredAt(double time) const;
    void takeOpinion(const SdfLayerRefPtr &layer, const SdfPath &path, const SdfLayerOffset &toRoot);

    std::string _name;
    TfToken _typeName;
    Source _source = Source::None;
    bool _resolved = false, _defaultResolved = false, _clipped = false;
    SdfLayerRefPtr _root, _layer, _defaultLayer; // root: of the composition
    SdfPath _path, _defaultPath;
    std::pair<std::string, std::string> _variant;
    SdfLayerOffset _toRoot;
    std::vector<std::pair<SdfLayerRefPtr, SdfPath>> _specs; // strong to weak
};

// Value clips, which hold for the site where they were authored and below.
struct ClipSite {
    PcpLayerStackRefPtr layerStack;
    SdfPath path;
    // For each set of clips its manifest, which says what it has values of, and the prim that stands for the site there. A set
    // without a manifest is taken to have points.
    std::vector<std::pair<SdfLayerRefPtr, SdfPath>> manifests;

    bool mayHave(const SdfPath &attribute) const; // below the site
};

// A composed prim, for as long as its Composition lives.
class Prim {
  public:
    Prim(const PcpPrimIndex &index, std::vector<ClipSite> inheritedClips);

    const SdfPath &path() const {
        return _index->GetPath();
    }
    TfToken typeName() const;
    SdfSpecifier specifier() const;
    bool active() const;
    bool instanceable() const {
        return _index->IsInstanceable();
    }
    std::vector<std::string> apiSchemas() const;
    TfTokenVector childNames() const;
    TfTokenVector propertyNames() const;
    Attribute attribute(const TfToken &name) const;
    const std::vector<ClipSite> &clips() const {
        return _clips;
    }

  private:
    using Visit = std::function<bool(const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &node)>;
    void visit(const Visit &visit) const; // strong to weak, until it returns false
    bool clipsApply(const PcpNodeRef &node, const SdfPath &attribute) const;

    const PcpPrimIndex *_index;
    std::vector<ClipSite> _clips;
};

class Composition {
  public:
    // Asset paths are resolved in the context that is bound.
    explicit Composition(const SdfLayerRefPtr &root);

    // Visits every prim, parents first; `visit` returns whether to go below its prim.
    void traverse(const std::function<bool(const Prim &)> &visit);
    // inheritedClips  those of its parent
    Prim prim(const SdfPath &path, std::vector<ClipSite> inheritedClips = {});
    SdfPathVector targets(const SdfPath &relationship);
    const SdfLayerRefPtr &root() const {
        return _root;
    }
    // The names of a prim's properties, as skinslide_stage_sort_names has them: found once.
    const std::vector<const char *> &sortedNames(const Prim &prim);
    // What could not be composed, each once, with the prim.
    std::vector<std::pair<SdfPath, std::string>> errors() const;
    SdfLayerHandleSet usedLayers() const {
        return _cache->GetUsedLayers();
    }

  private:
    void traverseBelow(const Prim &prim, const std::function<bool(const Prim &)> &visit);

    SdfLayerRefPtr _root;
    std::unique_ptr<PcpCache> _cache;
    PcpErrorVector _errors;
    struct Names {
        TfTokenVector held;
        std::vector<const char *> sorted;
    };
    std::map<SdfPath, Names> _names;
};

} // namespace skinslide

#endif
