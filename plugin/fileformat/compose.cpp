#include "compose.h"

#include "names.h"
#include "sources.h"

#include "skinslide/stage.h"

#include "pxr/base/gf/half.h"
#include "pxr/base/gf/math.h"
#include "pxr/base/gf/vec2d.h"
#include "pxr/base/gf/vec2f.h"
#include "pxr/base/gf/vec2h.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3f.h"
#include "pxr/base/gf/vec3h.h"
#include "pxr/base/tf/stringUtils.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/dictionary.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/ar/resolverContext.h"
#include "pxr/usd/pcp/layerStack.h"
#include "pxr/usd/pcp/layerStackIdentifier.h"
#include "pxr/usd/pcp/mapExpression.h"
#include "pxr/usd/pcp/node.h"
#include "pxr/usd/pcp/primIndex.h"
#include "pxr/usd/sdf/assetPath.h"
#include "pxr/usd/sdf/layerUtils.h"
#include "pxr/usd/sdf/listOp.h"
#include "pxr/usd/sdf/schema.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace skinslide {
namespace {

// ---- Interpolation: the arithmetic of Usd, so that a bake and a layer read the same bits ----

template <class T> bool lerpScalar(double alpha, const VtValue &lower, const VtValue &upper, VtValue *out) {
    if (!lower.IsHolding<T>() || !upper.IsHolding<T>())
        return false;
    *out = T(GfLerp(alpha, lower.UncheckedGet<T>(), upper.UncheckedGet<T>()));
    return true;
}

template <class T> bool lerpArray(double alpha, const VtValue &lower, const VtValue &upper, VtValue *out) {
    if (!lower.IsHolding<VtArray<T>>() || !upper.IsHolding<VtArray<T>>())
        return false;
    const VtArray<T> &a = lower.UncheckedGet<VtArray<T>>(), &b = upper.UncheckedGet<VtArray<T>>();
    if (a.size() != b.size())
        return false;
    VtArray<T> result(a.size());
    T *values = result.data();
    for (size_t i = 0; i < a.size(); i++)
        values[i] = T(GfLerp(alpha, a.cdata()[i], b.cdata()[i]));
    *out = VtValue::Take(result);
    return true;
}

// Values of types that Usd does not interpolate, and arrays of different lengths, are held.
VtValue lerp(double alpha, const VtValue &lower, const VtValue &upper) {
    VtValue value;
    if (alpha == 0)
        return lower;
    if (alpha == 1)
        return upper;
    if (lerpArray<GfVec3f>(alpha, lower, upper, &value) || lerpArray<GfVec2f>(alpha, lower, upper, &value) ||
        lerpArray<GfVec2d>(alpha, lower, upper, &value) || lerpArray<GfVec2h>(alpha, lower, upper, &value) ||
        lerpArray<float>(alpha, lower, upper, &value) || lerpScalar<float>(alpha, lower, upper, &value) ||
        lerpScalar<double>(alpha, lower, upper, &value) || lerpScalar<GfHalf>(alpha, lower, upper, &value) ||
        lerpScalar<GfVec3d>(alpha, lower, upper, &value) || lerpScalar<GfVec3f>(alpha, lower, upper, &value) ||
        lerpScalar<GfVec3h>(alpha, lower, upper, &value) || lerpArray<double>(alpha, lower, upper, &value) ||
        lerpArray<GfHalf>(alpha, lower, upper, &value) || lerpArray<GfVec3d>(alpha, lower, upper, &value) ||
        lerpArray<GfVec3h>(alpha, lower, upper, &value))
        return value;
    return lower;
}

VtValue unblocked(const VtValue &value) {
    return value.IsHolding<SdfValueBlock>() ? VtValue() : value;
}

VtValue sample(const SdfLayerRefPtr &layer, const SdfPath &path, double time) {
    VtValue value;
    layer->QueryTimeSample(path, time, &value);
    return unblocked(value);
}

// As Usd: sought in the layer's time, interpolated in the root's, in which a sample is where it is listed to be.
VtValue sampleAt(const SdfLayerRefPtr &layer, const SdfPath &path, const SdfLayerOffset &toRoot, double time) {
    double lower = 0, upper = 0;
    // The first sample answers for every time before it.
    double local = std::isinf(time) ? std::numeric_limits<double>::lowest() : toRoot.GetInverse() * time;
    if (!layer->GetBracketingTimeSamplesForPath(path, local, &lower, &upper))
        return VtValue();
    VtValue below = sample(layer, path, lower);
    if (GfIsClose(lower, upper, 1e-6) || below.IsEmpty())
        return below;
    VtValue above = sample(layer, path, upper);
    double begin = toRoot * lower, end = toRoot * upper;
    return above.IsEmpty() ? below : lerp((time - begin) / (end - begin), below, above);
}

bool isSampled(const SdfLayerRefPtr &layer, const SdfPath &path) {
    return layer->GetNumTimeSamplesForPath(path) > 0;
}

} // namespace

// ---- Attribute ----

void Attribute::takeOpinion(const SdfLayerRefPtr &layer, const SdfPath &path, const SdfLayerOffset &toRoot) {
    _specs.emplace_back(layer, path);
    if (_typeName.IsEmpty())
        layer->HasField(path, SdfFieldKeys->TypeName, &_typeName);
    VtValue value;
    bool hasDefault = layer->HasField(path, SdfFieldKeys->Default, &value);
    if (hasDefault && !_defaultResolved) {
        _defaultResolved = true;
        _defaultLayer = layer, _defaultPath = path;
    }
    if (_resolved)
        return;
    Source source = isSampled(layer, path)                            ? Source::Samples
                    : layer->HasField(path, names().spline)           ? Source::Spline
                    : hasDefault && !value.IsHolding<SdfValueBlock>() ? Source::Default
                                                                      : Source::None;
    if (source == Source::None && !hasDefault)
        return;
    _resolved = true, _source = source;
    _layer = layer, _path = path, _toRoot = toRoot;
}

bool Attribute::hasDefault() const {
    return !authoredAt(defaultTime).IsEmpty();
}

bool Attribute::varies() const {
    return _source == Source::Spline || (_source == Source::Samples && _layer->GetNumTimeSamplesForPath(_path) > 1);
}

std::vector<double> Attribute::times() const {
    std::vector<double> times;
    if (_source == Source::Samples) {
        for (double time : _layer->ListTimeSamplesForPath(_path))
            times.push_back(_toRoot * time);
    }
    std::sort(times.begin(), times.end());
    return times;
}

VtValue Attribute::at(double time) const {
    VtValue value = authoredAt(time);
    if (!value.IsHolding<SdfAssetPath>())
        return value;
    std::string path = evaluate(value.UncheckedGet<SdfAssetPath>().GetAssetPath(), _root->GetExpressionVariables());
    return VtValue(SdfAssetPath(path.empty() ? path : SdfComputeAssetPathRelativeToLayer(_layer, path)));
}

VtValue Attribute::authoredAt(double time) const {
    if (std::isnan(time))
        return _defaultResolved ? unblocked(_defaultLayer->GetField(_defaultPath, SdfFieldKeys->Default)) : VtValue();
    if (_source == Source::Default)
        return unblocked(_layer->GetField(_path, SdfFieldKeys->Default));
    if (_source != Source::Samples)
        return VtValue();
    return sampleAt(_layer, _path, _toRoot, time);
}

SdfLayerRefPtr Attribute::bakedLayer() const {
    static const std::string mark = "skinslide"; // as the tool writes it
    const std::pair<SdfLayerRefPtr, SdfPath> opinions[] = {{_layer, _path}, {_defaultLayer, _defaultPath}};
    for (const auto &[layer, path] : opinions) {
        VtDictionary data;
        if (layer && layer->HasField(path, SdfFieldKeys->CustomData, &data) && data.count(mark))
            return layer;
    }
    return nullptr;
}

VtValue Attribute::metadata(const TfToken &field) const {
    VtValue value;
    for (const auto &[layer, path] : _specs) {
        if (layer->HasField(path, field, &value))
            return value;
    }
    return VtValue();
}

TfToken Attribute::token(const TfToken &field, const TfToken &fallback) const {
    VtValue value = metadata(field);
    return value.IsHolding<TfToken>() ? value.UncheckedGet<TfToken>() : fallback;
}

// ---- Clips ----

namespace {

// The manifest and the prim of each set of clips that are authored at a prim.
std::vector<std::pair<SdfLayerRefPtr, SdfPath>> manifestsAt(const SdfLayerRefPtr &layer, const SdfPath &path) {
    std::vector<std::pair<SdfLayerRefPtr, SdfPath>> manifests;
    VtDictionary sets;
    layer->HasField(path, names().clips, &sets);
    for (const auto &[name, value] : sets) {
        const VtDictionary set = value.IsHolding<VtDictionary>() ? value.UncheckedGet<VtDictionary>() : VtDictionary();
        std::string prim = VtDictionaryGet<std::string>(set, "primPath", VtDefault = "");
        std::string file = VtDictionaryGet<SdfAssetPath>(set, "manifestAssetPath", VtDefault = SdfAssetPath()).GetAssetPath();
        SdfLayerRefPtr manifest = file.empty() ? nullptr : openLayer(SdfComputeAssetPathRelativeToLayer(layer, file));
        manifests.emplace_back(manifest, SdfPath::IsValidPathString(prim) ? SdfPath(prim) : SdfPath());
    }
    return manifests;
}

} // namespace

bool ClipSite::mayHave(const SdfPath &attribute) const {
    return std::any_of(manifests.begin(), manifests.end(), [&](const std::pair<SdfLayerRefPtr, SdfPath> &set) {
        const auto &[manifest, prim] = set;
        if (!manifest || prim.IsEmpty())
            return attribute.GetNameToken() == names().points;
        return manifest->GetSpecType(attribute.ReplacePrefix(path, prim)) == SdfSpecTypeAttribute;
    });
}

// ---- Prim ----

Prim::Prim(const PcpPrimIndex &index, std::vector<ClipSite> inheritedClips)
    : _index(&index), _clips(std::move(inheritedClips)) {
    visit([this](const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &node) {
        if (layer->HasField(path, names().clips))
            _clips.push_back({node.GetLayerStack(), path, manifestsAt(layer, path)});
        return true;
    });
}

void Prim::visit(const Visit &visit) const {
    PcpNodeRange range = _index->GetNodeRange();
    for (PcpNodeIterator it = range.first; it != range.second; ++it) {
        PcpNodeRef node = *it;
        if (node.IsInert() || !node.HasSpecs())
            continue;
        for (const SdfLayerRefPtr &layer : node.GetLayerStack()->GetLayers()) {
            if (layer->HasSpec(node.GetPath()) && !visit(layer, node.GetPath(), node))
                return;
        }
    }
}

TfToken Prim::typeName() const {
    TfToken name;
    visit([&](const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &) {
        layer->HasField(path, SdfFieldKeys->TypeName, &name);
        return name.IsEmpty();
    });
    return name;
}

// The strongest that is not `over`; a class that is inherited from does not make a class of what inherits it.
SdfSpecifier Prim::specifier() const {
    SdfSpecifier found = SdfSpecifierOver;
    visit([&](const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &node) {
        SdfSpecifier specifier = SdfSpecifierOver;
        layer->HasField(path, SdfFieldKeys->Specifier, &specifier);
        bool inherited = node.GetArcType() == PcpArcTypeInherit || node.GetArcType() == PcpArcTypeSpecialize;
        if (specifier == SdfSpecifierDef || (specifier == SdfSpecifierClass && !inherited))
            found = specifier;
        return found == SdfSpecifierOver;
    });
    return found;
}

bool Prim::active() const {
    bool active = true;
    visit([&](const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &) {
        return !layer->HasField(path, SdfFieldKeys->Active, &active);
    });
    return active;
}

std::vector<std::string> Prim::apiSchemas() const {
    std::vector<SdfTokenListOp> operations;
    visit([&](const SdfLayerRefPtr &layer, const SdfPath &path, const PcpNodeRef &) {
        SdfTokenListOp operation;
        if (layer->HasField(path, names().apiSchemas, &operation))
            operations.push_back(operation);
        return true;
    });
    TfTokenVector tokens;
    for (auto it = operations.rbegin(); it != operations.rend(); ++it)
        it->ApplyOperations(&tokens);
    return std::vector<std::string>(tokens.begin(), tokens.end());
}

TfTokenVector Prim::childNames() const {
    TfTokenVector order;
    PcpTokenSet prohibited;
    _index->ComputePrimChildNames(&order, &prohibited);
    return order;
}

bool Prim::clipsApply(const PcpNodeRef &node, const SdfPath &attribute) const {
    return std::any_of(_clips.begin(), _clips.end(), [&](const ClipSite &site) {
        return site.layerStack == node.GetLayerStack() && node.GetPath().HasPrefix(site.path) && site.mayHave(attribute);
    });
}

TfTokenVector Prim::propertyNames() const {
    TfTokenVector order;
    _index->ComputePrimPropertyNames(&order);
    return order;
}

namespace {

// The innermost variant that a node is in: its set, its name.
std::pair<std::string, std::string> variantOf(PcpNodeRef node) {
    for (; node; node = node.GetParentNode()) {
        if (node.GetArcType() == PcpArcTypeVariant)
            return node.GetPathAtIntroduction().GetVariantSelection();
    }
    return {};
}

} // namespace

Attribute Prim::attribute(const TfToken &name) const {
    Attribute found;
    found._name = name.GetString();
    found._root = _index->GetRootNode().GetLayerStack()->GetIdentifier().rootLayer;
    PcpNodeRange range = _index->GetNodeRange();
    for (PcpNodeIterator it = range.first; it != range.second; ++it) {
        PcpNodeRef node = *it;
        if (node.IsInert() || (!node.HasSpecs() && _clips.empty()))
            continue;
        SdfPath path = node.GetPath().AppendProperty(name);
        bool before = found._resolved;
        for (const SdfLayerRefPtr &layer : node.GetLayerStack()->GetLayers()) {
            if (layer->GetSpecType(path) != SdfSpecTypeAttribute)
                continue;
            SdfLayerOffset toRoot = node.GetMapToRoot().GetTimeOffset();
            if (const SdfLayerOffset *offset = node.GetLayerStack()->GetLayerOffsetForLayer(layer))
                toRoot = toRoot * *offset;
            found.takeOpinion(layer, path, toRoot);
        }
        if (!before && found._resolved)
            found._variant = variantOf(node);
        // Clips are weaker than samples and splines of the site they are authored at, and stronger than its defaults.
        bool timed = found._source == Attribute::Source::Samples || found._source == Attribute::Source::Spline;
        found._clipped = found._clipped || (!before && !(found._resolved && timed) && clipsApply(node, path));
    }
    return found;
}

// ---- Composition ----

Composition::Composition(const SdfLayerRefPtr &root) : _root(root) {
    PcpLayerStackIdentifier identifier(root, SdfLayerHandle(), ArGetResolver().GetCurrentContext());
    _cache = std::make_unique<PcpCache>(identifier, std::string(), /* usd = */ true);
}

Prim Composition::prim(const SdfPath &path, std::vector<ClipSite> inheritedClips) {
    // Payloads are asked for first, so that the index is made with them. Indices are made one at a time, and not in parallel: a
    // thread that waits for its tasks may be given one that opens the layer being read.
    if (path.IsPrimPath())
        _cache->RequestPayloads({path}, {});
    return Prim(_cache->ComputePrimIndex(path, &_errors), std::move(inheritedClips));
}

void Composition::traverse(const std::function<bool(const Prim &)> &visit) {
    traverseBelow(prim(SdfPath::AbsoluteRootPath()), visit);
}

void Composition::traverseBelow(const Prim &parent, const std::function<bool(const Prim &)> &visit) {
    for (const TfToken &name : parent.childNames()) {
        Prim child = prim(parent.path().AppendChild(name), parent.clips());
        if (visit(child))
            traverseBelow(child, visit);
    }
}

const std::vector<const char *> &Composition::sortedNames(const Prim &prim) {
    auto [place, isNew] = _names.try_emplace(prim.path());
    Names &names = place->second;
    if (isNew) {
        names.held = prim.propertyNames();
        for (const TfToken &name : names.held)
            names.sorted.push_back(name.GetText());
        skinslide_stage_sort_names(names.sorted.data(), static_cast<int32_t>(names.sorted.size()));
    }
    return names.sorted;
}

SdfPathVector Composition::targets(const SdfPath &relationship) {
    SdfPathVector paths;
    _cache->ComputeRelationshipTargetPaths(relationship, &paths, false, SdfSpecHandle(), false, nullptr, &_errors);
    return paths;
}

std::vector<std::pair<SdfPath, std::string>> Composition::errors() const {
    std::vector<std::pair<SdfPath, std::string>> errors;
    for (const PcpErrorBasePtr &error : _errors) {
        // The root's identifier is one that openText() made up: name the file instead.
        std::string message = TfStringReplace(error->ToString(), _root->GetIdentifier(), _root->GetResolvedPath());
        std::pair<SdfPath, std::string> reported(error->rootSite.path, message);
        if (std::find(errors.begin(), errors.end(), reported) == errors.end())
            errors.push_back(reported);
    }
    return errors;
}

} // namespace skinslide
