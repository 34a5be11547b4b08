#include "sources.h"

#include "cycle.h"
#include "fault.h"
#include "names.h"
#include "params.h"
#include "values.h"

#include "pxr/base/tf/errorMark.h"
#include "pxr/base/tf/fileUtils.h"
#include "pxr/base/tf/pathUtils.h"
#include "pxr/base/tf/stringUtils.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/dictionary.h"
#include "pxr/usd/ar/asset.h"
#include "pxr/usd/ar/packageUtils.h"
#include "pxr/usd/ar/resolvedPath.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/sdf/assetPath.h"
#include "pxr/usd/sdf/fileFormat.h"
#include "pxr/usd/sdf/layerUtils.h"
#include "pxr/usd/sdf/schema.h"
#include "pxr/usd/sdf/variableExpression.h"

#include <algorithm>
#include <deque>
#include <map>

namespace skinslide {
namespace {

std::string readFile(const std::string &resolvedPath) {
    if (isIrregular(resolvedPath))
        throw Fault(skinslide_stage_phrase(SKINSLIDE_PHRASE_IRREGULAR));
    std::shared_ptr<ArAsset> asset = ArGetResolver().OpenAsset(ArResolvedPath(resolvedPath));
    if (!asset)
        throw Fault("cannot be opened");
    std::string text(asset->GetSize(), '\0');
    if (!text.empty() && asset->Read(&text[0], text.size(), 0) != text.size())
        throw Fault(skinslide_stage_phrase(SKINSLIDE_PHRASE_UNREADABLE));
    return text;
}

bool isSkinslide(const std::string &path) {
    return SdfFileFormat::GetFileExtension(path) == "skinslide";
}

} // namespace

std::string evaluate(const std::string &asset, const VtDictionary &variables) {
    if (!SdfVariableExpression::IsExpression(asset))
        return asset;
    VtValue value = SdfVariableExpression(asset).Evaluate(variables).value;
    return value.IsHolding<std::string>() ? value.UncheckedGet<std::string>() : "";
}

// ---- The text ----

SdfLayerRefPtr openText(const std::string &resolvedPath, double timeCodesPerSecond) {
    return SdfLayer::FindOrOpen(resolvedPath, Params::argumentsOfText(timeCodesPerSecond));
}

std::string readText(const std::string &resolvedPath) {
    std::string text = readFile(resolvedPath);
    call(skinslide_stage_text, text.data(), static_cast<int64_t>(text.size()));
    return text;
}

// ---- What it leads to ----

std::string pathFor(const std::string &asset) {
    ArResolvedPath resolved = ArGetResolver().Resolve(asset);
    return (resolved ? resolved : ArGetResolver().ResolveForNewAsset(asset)).GetPathString();
}

bool isIrregular(const std::string &resolvedPath) {
    std::string file = ArSplitPackageRelativePathOuter(resolvedPath).first;
    return TfPathExists(file, true) && !TfIsFile(file, true) && !TfIsDir(file, true);
}

namespace {

// The resolved path of what can be opened without waiting. Throws Fault.
std::string openable(const std::string &identifier) {
    std::string path;
    SdfLayer::FileFormatArguments arguments;
    SdfLayer::SplitIdentifier(identifier, &path, &arguments);
    path = ArGetResolver().Resolve(path).GetPathString();
    if (isIrregular(path))
        throw fault("leads to %s, which %s", path.c_str(), skinslide_stage_phrase(SKINSLIDE_PHRASE_IRREGULAR));
    return path;
}

// The files of a set of value clips, as identifiers.
std::vector<std::string> clipFiles(const SdfLayerRefPtr &layer, const VtDictionary &set) {
    std::vector<std::string> files;
    for (const SdfAssetPath &asset :
         VtDictionaryGet<VtArray<SdfAssetPath>>(set, "assetPaths", VtDefault = VtArray<SdfAssetPath>()))
        files.push_back(SdfComputeAssetPathRelativeToLayer(layer, asset.GetAssetPath()));
    std::string pattern = VtDictionaryGet<std::string>(set, "templateAssetPath", VtDefault = "");
    std::replace(pattern.begin(), pattern.end(), '#', '*');
    if (!pattern.empty())
        for (const std::string &file : TfGlob(SdfComputeAssetPathRelativeToLayer(layer, pattern), 0))
            files.push_back(file);
    return files;
}

// Value clips are not read here, but by the stage, as soon as it has the prim.
void lookAtClips(const SdfLayerRefPtr &layer) {
    layer->Traverse(SdfPath::AbsoluteRootPath(), [&](const SdfPath &path) {
        VtDictionary sets;
        if (!path.IsPrimOrPrimVariantSelectionPath() || !layer->HasField(path, names().clips, &sets))
            return;
        for (const auto &[name, set] : sets) {
            if (!set.IsHolding<VtDictionary>())
                continue;
            for (const std::string &file : clipFiles(layer, set.UncheckedGet<VtDictionary>()))
                openable(file);
        }
    });
}

} // namespace

SdfLayerRefPtr openLayer(const std::string &identifier) {
    Reading::refuse(openable(identifier));
    TfErrorMark mark;
    SdfLayerRefPtr layer = SdfLayer::FindOrOpen(identifier);
    mark.Clear();
    return layer;
}

namespace {

// A layer to look into, with the variables that its expressions are evaluated with.
struct Place {
    SdfLayerRefPtr layer;
    VtDictionary variables;
};

// Finds at least what Pcp would open, and what each .skinslide file on the way would open when it is read.
class Walk {
  public:
    Walk(const SdfLayerRefPtr &root, bool again) : _again(again) {
        enter(root->GetResolvedPath(), {root, root->GetExpressionVariables()});
        while (!_waiting.empty()) {
            Place place = _waiting.front();
            _waiting.pop_front();
            lookAtClips(place.layer);
            for (const std::string &asset : place.layer->GetCompositionAssetDependencies())
                follow(place, asset);
        }
    }
    Sources found;

  private:
    void follow(const Place &from, const std::string &asset) {
        std::string evaluated = evaluate(asset, from.variables), bare;
        if (evaluated.empty())
            return;
        std::string identifier = SdfComputeAssetPathRelativeToLayer(from.layer, evaluated);
        SdfLayer::FileFormatArguments arguments;
        SdfLayer::SplitIdentifier(identifier, &bare, &arguments);
        ArResolvedPath resolved = ArGetResolver().Resolve(bare);
        if (resolved && Reading::isRead(resolved))
            throw fault("leads back to itself through %s, be it in a variant that is not selected",
                        from.layer->GetResolvedPath().GetPathString().c_str());
        std::string path = pathFor(bare);
        if (path.empty())
            return;
        found.paths.insert(path);
        if (SdfLayerRefPtr next = resolved ? open(identifier, path) : nullptr)
            enterAll(from, asset, path, next);
    }

    // Variables of what refers to a layer are stronger than its own, and a sublayer has none. A .skinslide file is also a root.
    void enterAll(const Place &from, const std::string &asset, const std::string &path, const SdfLayerRefPtr &next) {
        VtDictionary own = next->GetExpressionVariables();
        const auto &sublayers = from.layer->GetSubLayerPaths();
        if (sublayers.Find(asset) != size_t(-1))
            enter(path, {next, from.variables});
        enter(path, {next, VtDictionaryOver(from.variables, own)});
        if (isSkinslide(path))
            enter(path, {next, own});
    }

    void enter(const std::string &path, const Place &place) {
        std::vector<VtDictionary> &seen = _seen[path];
        if (std::find(seen.begin(), seen.end(), place.variables) != seen.end())
            return;
        seen.push_back(place.variables);
        _waiting.push_back(place);
    }

    // Opens a source, or reads it as text; null where it cannot be, which composition reports.
    SdfLayerRefPtr open(const std::string &identifier, const std::string &path) {
        auto [known, isNew] = _opened.try_emplace(path);
        if (!isNew)
            return known->second;
        TfErrorMark mark;
        known->second = isSkinslide(path) ? openText(path) : openSource(identifier);
        mark.Clear();
        return known->second;
    }

    SdfLayerRefPtr openSource(const std::string &identifier) {
        SdfLayerRefPtr layer = openLayer(identifier);
        if (layer && _again && !layer->IsDirty())
            layer->Reload();
        if (layer)
            found.layers.push_back(layer);
        return layer;
    }

    const bool _again;
    std::deque<Place> _waiting;
    std::map<std::string, SdfLayerRefPtr> _opened;
    std::map<std::string, std::vector<VtDictionary>> _seen; // by path
};

bool hasRate(const SdfLayerRefPtr &layer) {
    return layer->HasTimeCodesPerSecond() || layer->HasFramesPerSecond();
}

} // namespace

SdfLayerRefPtr openWithSources(const std::string &resolvedPath, bool again, Sources *sources) {
    SdfLayerRefPtr text = openText(resolvedPath);
    if (!text)
        return text;
    *sources = Walk(text, again).found;
    auto first = std::find_if(sources->layers.begin(), sources->layers.end(), hasRate);
    bool adopts = !hasRate(text) && first != sources->layers.end();
    return adopts ? openText(resolvedPath, (*first)->GetTimeCodesPerSecond()) : text;
}

} // namespace skinslide
