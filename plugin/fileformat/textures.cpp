#include "textures.h"

#include "sources.h"

#include "pxr/usd/ar/asset.h"
#include "pxr/usd/ar/resolver.h"

namespace skinslide {
namespace {

// A file that appears later is a change too.
std::string pathFor(const std::string &asset) {
    ArResolvedPath resolved = ArGetResolver().Resolve(asset);
    return (resolved ? resolved : ArGetResolver().ResolveForNewAsset(asset)).GetPathString();
}

// The bytes of a resolved file; false where it cannot be read. Those of one that is too large are not read.
bool readBytes(const ArResolvedPath &path, int64_t largest, std::vector<uint8_t> *bytes, int64_t *size) {
    std::shared_ptr<ArAsset> asset = isIrregular(path) ? nullptr : ArGetResolver().OpenAsset(path);
    if (!asset)
        return false;
    *size = static_cast<int64_t>(asset->GetSize());
    if (*size > largest)
        return false;
    bytes->resize(asset->GetSize());
    return bytes->empty() || asset->Read(bytes->data(), bytes->size(), 0) == bytes->size();
}

} // namespace

void giveFiles(skinslide_stage_controls *controls, std::set<std::string> *files) {
    while (const skinslide_stage_need *need = skinslide_stage_controls_need(controls)) {
        ArResolvedPath resolved = ArGetResolver().Resolve(need->path);
        if (files)
            files->insert(pathFor(need->path));
        std::vector<uint8_t> bytes;
        static const uint8_t nothing = 0;
        std::string path = resolved.GetPathString();
        skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
        file.path = resolved ? path.c_str() : nullptr;
        if (resolved && !skinslide_stage_controls_holds(controls, path.c_str()) &&
            readBytes(resolved, need->largest, &bytes, &file.byte_count))
            file.bytes = bytes.empty() ? &nothing : bytes.data();
        call(skinslide_stage_controls_give, controls, &file);
    }
}

void addUntiled(const Property &texture, double time, std::set<std::string> *files) {
    VtValue value = texture.attribute().at(time);
    std::string path =
        value.IsHolding<SdfAssetPath>() ? texture.anchor().path(texture.attribute(), value.UncheckedGet<SdfAssetPath>()) : "";
    if (!path.empty() && path.find("<UDIM>") == std::string::npos)
        files->insert(pathFor(path));
}

} // namespace skinslide
