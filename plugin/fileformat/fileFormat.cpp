#include "fileFormat.h"

#include "cycle.h"
#include "data.h"
#include "fault.h"
#include "names.h"
#include "sources.h"

#include "pxr/base/tf/diagnostic.h"
#include "pxr/base/tf/pathUtils.h"
#include "pxr/base/tf/registryManager.h"
#include "pxr/base/tf/type.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/ar/resolverContextBinder.h"
#include "pxr/usd/pcp/dynamicFileFormatContext.h"
#include "pxr/usd/sdf/layer.h"

// With the headers of another TBB than USD was built with, classes that hold its containers have other sizes.
#if !defined(SKINSLIDE_SYSTEM_USD)
#include <tbb/tbb_stddef.h>
static_assert(TBB_INTERFACE_VERSION < 12000, "the wheel usd-core is built with TBB 2020; put its headers first");
#endif

PXR_NAMESPACE_OPEN_SCOPE

using namespace skinslide;

TF_REGISTRY_FUNCTION(TfType) {
    SDF_DEFINE_FILE_FORMAT(SkinSlideFileFormat, SdfFileFormat);
}

SkinSlideFileFormat::SkinSlideFileFormat()
    : SdfFileFormat(TfToken("skinslide"), TfToken("1.0"), TfToken("usd"), std::string("skinslide")) {
}

bool SkinSlideFileFormat::CanRead(const std::string &file) const {
    return SdfFileFormat::GetFileExtension(file) == "skinslide";
}

bool SkinSlideFileFormat::Read(SdfLayer *layer, const std::string &resolvedPath, bool metadataOnly) const {
    try {
        read(layer, resolvedPath, metadataOnly);
        return true;
    } catch (const std::exception &bad) {
        TF_RUNTIME_ERROR("%s %s", resolvedPath.c_str(), bad.what());
        return false;
    }
}

namespace {

// So that an asset path means the same to everything that resolves it here.
ArResolverContext contextFor(const std::string &resolvedPath) {
    ArResolverContext bound = ArGetResolver().GetCurrentContext();
    return bound.IsEmpty() ? ArGetResolver().CreateDefaultContextForAsset(resolvedPath) : bound;
}

// On a reload, the layers that this one leads to may be reloaded after it. Unsaved edits are the user's to throw away.
void reloadUnedited(const std::vector<SdfLayerRefPtr> &layers) {
    std::set<SdfLayerHandle> unedited;
    for (const SdfLayerRefPtr &layer : layers) {
        if (!layer->IsDirty())
            unedited.insert(layer);
    }
    SdfLayer::ReloadLayers(unedited);
}

std::vector<SdfLayerRefPtr> nestedIn(const Composition &composition) {
    std::vector<SdfLayerRefPtr> nested;
    for (const SdfLayerHandle &layer : composition.usedLayers()) {
        if (layer->GetFileFormat()->GetFormatId() == "skinslide")
            nested.push_back(layer);
    }
    return nested;
}

} // namespace

void SkinSlideFileFormat::read(SdfLayer *layer, const std::string &resolvedPath, bool metadataOnly) const {
    std::vector<std::string> problems;
    Params params = Params::fromArguments(layer->GetFileFormatArguments(), &problems);
    Reading reading(resolvedPath);
    ArResolverContextBinder bound(contextFor(resolvedPath));
    SdfLayerRefPtr shown = readText(resolvedPath), anchored = anchoredCopy(shown, resolvedPath);
    std::vector<std::shared_ptr<LiveMesh>> meshes;
    Sources sources;
    std::vector<SdfLayerRefPtr> nested;
    if (!metadataOnly) {
        sources = findSources(shown, resolvedPath);
        if (auto before = TfDynamic_cast<TfWeakPtr<const Data>>(_GetLayerData(*layer))) {
            reloadUnedited(sources.layers);
            reloadUnedited(before->nested);
        }
        adoptRate(shown, sources);
        adoptRate(anchored, sources);
    }
    if (!metadataOnly && params.computes) {
        Composition composition(anchored, resolvedPath);
        std::string name = TfGetBaseName(resolvedPath);
        for (const std::shared_ptr<const PatchedMesh> &mesh : readMeshes(composition, params, &problems)) {
            meshes.push_back(std::make_shared<LiveMesh>(mesh, params.live.lookup, name));
            for (const Patch &patch : mesh->patches)
                sources.paths.insert(patch.files().begin(), patch.files().end());
        }
        nested = nestedIn(composition);
    }
    DataRefPtr data = Data::create(meshes, shown, [](const SdfLayer &from) { return _GetLayerData(from); });
    data->dependencies = std::move(sources.paths);
    data->sources = std::move(sources.layers);
    data->nested = std::move(nested);
    for (const std::string &problem : problems)
        TF_WARN("%s: %s", resolvedPath.c_str(), problem.c_str());
    SdfAbstractDataRefPtr content = data;
    _SetLayerData(layer, content);
    // An edit would not be composed, and what is computed hides it.
    layer->SetPermissionToEdit(false);
}

bool SkinSlideFileFormat::WriteToString(const SdfLayer &layer, std::string *text, const std::string &comment) const {
    return SdfFileFormat::FindById(TfToken("usda"))->WriteToString(layer, text, comment);
}

bool SkinSlideFileFormat::WriteToStream(const SdfSpecHandle &spec, std::ostream &out, size_t indent) const {
    return SdfFileFormat::FindById(TfToken("usda"))->WriteToStream(spec, out, indent);
}

std::set<std::string> SkinSlideFileFormat::GetExternalAssetDependencies(const SdfLayer &layer) const {
    auto data = TfDynamic_cast<TfWeakPtr<const Data>>(_GetLayerData(layer));
    return data ? data->dependencies : std::set<std::string>();
}

void SkinSlideFileFormat::ComposeFieldsForFileFormatArguments(const std::string &, const PcpDynamicFileFormatContext &context,
                                                              FileFormatArguments *arguments, VtValue *) const {
    for (const auto &[name, value] : Params::argumentsFromAttributes([&](const TfToken &attribute, VtValue *composed) {
             return context.ComposeAttributeDefaultValue(attribute, composed);
         }))
        (*arguments)[name] = value;
}

bool SkinSlideFileFormat::CanAttributeDefaultValueChangeAffectFileFormatArguments(const TfToken &name, const VtValue &oldValue,
                                                                                  const VtValue &newValue,
                                                                                  const VtValue &) const {
    return Params::isAttribute(name) && oldValue != newValue;
}

PXR_NAMESPACE_CLOSE_SCOPE
