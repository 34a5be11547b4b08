#include "layers.h"

#include "fault.h"

#include "pxr/base/tf/errorMark.h"
#include "pxr/base/tf/pathUtils.h"
#include "pxr/usd/ar/asset.h"
#include "pxr/usd/ar/resolvedPath.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/sdf/fileFormat.h"
#include "pxr/usd/sdf/layerUtils.h"
#include "pxr/usd/sdf/schema.h"
#include "pxr/usd/sdf/variableExpression.h"

#include <deque>

namespace skinslide {
namespace {

std::string readFile(const std::string &resolvedPath) {
    std::shared_ptr<ArAsset> asset = ArGetResolver().OpenAsset(ArResolvedPath(resolvedPath));
    if (!asset)
        throw Fault("cannot be opened");
    std::string text(asset->GetSize(), '\0');
    if (!text.empty() && asset->Read(&text[0], text.size(), 0) != text.size())
        throw Fault("cannot be read");
    return text;
}

bool isSkinslide(const std::string &path) {
    return SdfFileFormat::GetFileExtension(path) == "skinslide";
}

// Opens or reads a source; null where it cannot be, which composition reports.
SdfLayerRefPtr openSource(const std::string &identifier, const std::string &resolvedPath) {
    TfErrorMark mark;
    SdfLayerRefPtr layer;
    if (!isSkinslide(resolvedPath)) {
        layer = SdfLayer::FindOrOpen(identifier);
    } else {
        try {
            layer = anchoredCopy(readText(resolvedPath), resolvedPath);
        } catch (const Fault &) {
        }
    }
    mark.Clear();
    return layer;
}

} // namespace

std::string evaluate(const std::string &asset, const VtDictionary &variables) {
    if (!SdfVariableExpression::IsExpression(asset))
        return asset;
    VtValue value = SdfVariableExpression(asset).Evaluate(variables).value;
    return value.IsHolding<std::string>() ? value.UncheckedGet<std::string>() : "";
}

SdfLayerRefPtr readText(const std::string &resolvedPath) {
    std::string text = readFile(resolvedPath);
    if (!TfStringStartsWith(text, "#usda"))
        throw Fault("is not USDA text: the first line must be #usda 1.0");
    // The parser stops at a zero, and would take what is before it for the whole.
    if (text.find('\0') != std::string::npos)
        throw Fault("is not USDA text: it holds a zero byte");
    SdfLayerRefPtr layer = SdfLayer::CreateAnonymous(TfGetBaseName(resolvedPath) + ".usda");
    if (!layer->ImportFromString(text))
        throw Fault("is not valid USDA text");
    return layer;
}

SdfLayerRefPtr anchoredCopy(const SdfLayerRefPtr &text, const std::string &resolvedPath) {
    SdfLayerRefPtr layer = SdfLayer::CreateAnonymous(TfGetBaseName(resolvedPath) + ".usda");
    layer->TransferContent(text);
    for (const std::string &asset : layer->GetCompositionAssetDependencies()) {
        std::string evaluated = evaluate(asset, layer->GetExpressionVariables());
        if (evaluated.empty())
            continue;
        std::string anchored = ArGetResolver().CreateIdentifier(evaluated, ArResolvedPath(resolvedPath));
        if (anchored != asset)
            layer->UpdateCompositionAssetDependency(asset, anchored);
    }
    return layer;
}

namespace {

// The asset paths that a layer names, anchored to it. Expressions are evaluated with the variables of the root over its own.
std::vector<std::string> assetsOf(const SdfLayerRefPtr &layer, const SdfLayerRefPtr &root) {
    std::vector<std::string> assets;
    VtDictionary variables = VtDictionaryOver(root->GetExpressionVariables(), layer->GetExpressionVariables());
    for (const std::string &asset : layer->GetCompositionAssetDependencies()) {
        std::string evaluated = evaluate(asset, variables);
        if (!evaluated.empty())
            assets.push_back(SdfComputeAssetPathRelativeToLayer(layer, evaluated));
    }
    return assets;
}

} // namespace

Sources findSources(const SdfLayerRefPtr &anchored, const std::string &resolvedPath) {
    Sources sources;
    std::deque<SdfLayerRefPtr> waiting{anchored};
    while (!waiting.empty()) {
        SdfLayerRefPtr layer = waiting.front();
        waiting.pop_front();
        for (const std::string &identifier : assetsOf(layer, anchored)) {
            std::string bare;
            SdfLayer::FileFormatArguments arguments;
            SdfLayer::SplitIdentifier(identifier, &bare, &arguments);
            ArResolvedPath found = ArGetResolver().Resolve(bare);
            if (found.GetPathString() == resolvedPath)
                throw fault("leads back to itself through %s",
                            layer == anchored ? "its own text" : layer->GetIdentifier().c_str());
            // A file that appears later is a change too.
            std::string path = found ? found.GetPathString() : ArGetResolver().ResolveForNewAsset(bare).GetPathString();
            if (path.empty() || !sources.paths.insert(path).second || !found)
                continue;
            if (SdfLayerRefPtr next = openSource(identifier, path)) {
                waiting.push_back(next);
                if (!isSkinslide(path))
                    sources.layers.push_back(next);
            }
        }
    }
    return sources;
}

void adoptRate(const SdfLayerRefPtr &layer, const Sources &sources) {
    if (layer->HasTimeCodesPerSecond() || layer->HasFramesPerSecond())
        return;
    for (const SdfLayerRefPtr &source : sources.layers) {
        if (source->HasTimeCodesPerSecond() || source->HasFramesPerSecond()) {
            layer->SetTimeCodesPerSecond(source->GetTimeCodesPerSecond());
            return;
        }
    }
}

} // namespace skinslide
