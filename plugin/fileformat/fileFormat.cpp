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
#include "pxr/usd/sdf/schema.h"

// With the headers of a TBB that USD was not built with, classes that hold TBB's containers have another size.
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
        Params params = Params::fromArguments(layer->GetFileFormatArguments(), nullptr);
        if (!params.readsOnly)
            return compose(layer, resolvedPath, metadataOnly);
        readText(layer, resolvedPath, params.timeCodesPerSecond);
        return true;
    } catch (const std::exception &bad) {
        TF_RUNTIME_ERROR("%s %s", resolvedPath.c_str(), bad.what());
        return false;
    }
}

namespace {

// The context that everything here resolves asset paths in, so that they mean the same throughout.
ArResolverContext contextFor(const std::string &resolvedPath) {
    ArResolverContext bound = ArGetResolver().GetCurrentContext();
    return bound.IsEmpty() ? ArGetResolver().CreateDefaultContextForAsset(resolvedPath) : bound;
}

// Reloads layers that this one leads to, which USD may reload only after it; except those with unsaved edits, which are for the
// user to discard.
void reloadUnedited(const std::vector<SdfLayerRefPtr> &layers) {
    std::set<SdfLayerHandle> unedited;
    for (const SdfLayerRefPtr &layer : layers) {
        if (!layer->IsDirty())
            unedited.insert(layer);
    }
    SdfLayer::ReloadLayers(unedited);
}

// What can be slid above a text.
struct Slid {
    std::vector<std::shared_ptr<LiveMesh>> meshes;
    std::set<std::string> textures;
    std::vector<SdfLayerRefPtr> nested; // .skinslide files
};

Slid slide(const SdfLayerRefPtr &text, const Params &params, std::vector<std::string> *problems) {
    Slid slid;
    Composition composition(text);
    std::string name = TfGetBaseName(text->GetResolvedPath());
    for (const std::shared_ptr<const PatchedMesh> &mesh : readMeshes(composition, params, problems)) {
        slid.meshes.push_back(std::make_shared<LiveMesh>(mesh, params.live.lookup, name));
        for (const Patch &patch : mesh->patches)
            slid.textures.insert(patch.files().begin(), patch.files().end());
    }
    for (const SdfLayerHandle &layer : composition.usedLayers()) {
        if (layer != text && layer->GetFileFormat()->GetFormatId() == "skinslide")
            slid.nested.push_back(layer);
    }
    return slid;
}

} // namespace

void SkinSlideFileFormat::readText(SdfLayer *layer, const std::string &resolvedPath, double timeCodesPerSecond) const {
    if (!SdfFileFormat::FindById(TfToken("usda"))->ReadFromString(layer, skinslide::readText(resolvedPath)))
        throw Fault("is not valid USDA text");
    if (timeCodesPerSecond > 0) {
        SdfAbstractDataRefPtr data = InitData(layer->GetFileFormatArguments());
        data->CopyFrom(_GetLayerData(*layer));
        data->Set(SdfPath::AbsoluteRootPath(), SdfFieldKeys->TimeCodesPerSecond, VtValue(timeCodesPerSecond));
        _SetLayerData(layer, data);
    }
    layer->SetPermissionToEdit(false);
}

// False where the text cannot be read, which has posted an error.
bool SkinSlideFileFormat::compose(SdfLayer *layer, const std::string &resolvedPath, bool metadataOnly) const {
    std::vector<std::string> problems;
    Params params = Params::fromArguments(layer->GetFileFormatArguments(), &problems);
    Reading reading(resolvedPath);
    ArResolverContextBinder bound(contextFor(resolvedPath));
    auto before = TfDynamic_cast<TfWeakPtr<const Data>>(_GetLayerData(*layer));
    Sources sources;
    SdfLayerRefPtr text = metadataOnly ? openText(resolvedPath) : openWithSources(resolvedPath, bool(before), &sources);
    if (!text)
        return false;
    Slid slid;
    if (!metadataOnly && params.computes) {
        if (before)
            reloadUnedited(before->nested);
        slid = slide(text, params, &problems);
    }
    DataRefPtr data = Data::create(_GetLayerData(*text), slid.meshes);
    data->dependencies = std::move(sources.paths);
    data->dependencies.merge(slid.textures);
    data->sources = std::move(sources.layers);
    data->nested = std::move(slid.nested);
    for (const std::string &problem : problems)
        TF_WARN("%s: %s", resolvedPath.c_str(), problem.c_str());
    SdfAbstractDataRefPtr content = data;
    _SetLayerData(layer, content);
    // Edits would not be composed, and computed values would hide them.
    layer->SetPermissionToEdit(false);
    return true;
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
