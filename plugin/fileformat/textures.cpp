#include "textures.h"

#include "fault.h"
#include "names.h"
#include "patches.h"
#include "sources.h"

#include "pxr/usd/ar/asset.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/sdf/assetPath.h"
#include "pxr/usd/sdf/layerUtils.h"

#include <algorithm>

namespace skinslide {
namespace {

const std::string udim = "<UDIM>";
constexpr size_t largestFile = size_t{4} << 30;

std::string word(const Prim &mesh, const TfToken &name, const char *fallback) {
    VtValue value = mesh.attribute(name).at(Attribute::first);
    if (value.IsEmpty())
        return fallback;
    if (!value.IsHolding<TfToken>() && !value.IsHolding<std::string>())
        throw fault("%s is %s; it must be a token", name.GetText(), TfStringify(value).c_str());
    return value.IsHolding<TfToken>() ? value.UncheckedGet<TfToken>().GetString() : value.UncheckedGet<std::string>();
}

} // namespace

struct Texture::Corners {
    skinslide_mesh mesh; // without points
    const std::vector<int32_t> &faces;
    std::vector<float> st;

    skinslide_texture_layout layout() const { // points into this
        return {sizeof(skinslide_texture_layout), &mesh, faces.data(), static_cast<int32_t>(faces.size()), st.data()};
    }
};

Texture::Texture(const Composition &composition, const Prim &mesh, const std::string &patch, const std::string &control)
    : _map(mesh.attribute(names().property(patch, (control + "Map").c_str()))),
      _channel(word(mesh, names().property(patch, (control + "MapChannel").c_str()), "")),
      _setting(names().property(patch, "mapSt")), _resolvedPath(composition.resolvedPath()), _root(composition.root()) {
    _st = Primvar(mesh, TfToken(names().primvars + word(mesh, TfToken(_setting), "st")));
}

bool Texture::varies() const {
    return _map.authored() && (_map.varies() || _st.varies());
}

std::vector<double> Texture::times() const {
    std::vector<double> times;
    if (!_map.authored())
        return times;
    if (_map.varies())
        times = _map.times();
    std::vector<double> more = _st.times();
    times.insert(times.end(), more.begin(), more.end());
    return times;
}

// ---- Values ----

void Texture::settle(const Topology &topology, const std::vector<int32_t> &faces) {
    for (double time : times()) {
        std::string later = path(time);
        if (!later.empty() && later.find(udim) == std::string::npos)
            _files.insert(ArGetResolver().ResolveForNewAsset(later).GetPathString());
    }
    std::string first = path(Attribute::first);
    std::vector<float> values;
    if (!first.empty())
        values = sample(first, corners(Attribute::first, topology, faces), &_files);
    if (!varies())
        _still = std::make_shared<const std::vector<float>>(std::move(values));
}

std::vector<float> Texture::at(double time, const Topology &topology, const std::vector<int32_t> &faces) const {
    if (_still)
        return *_still;
    std::string found = path(time);
    return found.empty() ? std::vector<float>() : sample(found, corners(time, topology, faces), nullptr);
}

std::vector<float> Texture::sample(const std::string &path, const Corners &corners, Files *files) const {
    std::vector<Image> images;
    std::vector<skinslide_texture_tile> used;
    for (int32_t number : tiles(corners, path)) {
        std::string file = number ? TfStringReplace(path, udim, std::to_string(number)) : path;
        images.push_back(read(file, files));
        used.push_back({sizeof(skinslide_texture_tile), images.back().get(), number});
    }
    std::vector<float> values(corners.mesh.vertex_count);
    skinslide_texture_layout layout = corners.layout();
    skinslide_error error;
    if (skinslide_texture_sample(&layout, used.data(), static_cast<int32_t>(used.size()), values.data(), &error))
        throw fault("%s: %s: %s", name().c_str(), path.c_str(), error.message);
    return values;
}

// The tiles of a UDIM that the faces lie in; 0 for a file of its own.
std::vector<int32_t> Texture::tiles(const Corners &corners, const std::string &path) const {
    if (path.find(udim) == std::string::npos)
        return {0};
    std::vector<int32_t> numbers(corners.mesh.index_count);
    skinslide_texture_layout layout = corners.layout();
    skinslide_error error;
    if (skinslide_texture_tiles(&layout, numbers.data(), &error))
        throw fault("%s: %s: %s", name().c_str(), path.c_str(), error.message);
    std::set<int32_t> needed(numbers.begin(), numbers.end());
    needed.erase(0);
    return {needed.begin(), needed.end()};
}

// ---- The file ----

// Asset paths are relative to the layer that authors them; the root is an anonymous copy of the file.
std::string Texture::path(double time) const {
    VtValue value = _map.at(time);
    if (value.IsEmpty())
        return "";
    if (!value.IsHolding<SdfAssetPath>())
        throw fault("%s is %s; it must be an asset", name().c_str(), TfStringify(value).c_str());
    std::string asset = evaluate(value.UncheckedGet<SdfAssetPath>().GetAssetPath(), _root->GetExpressionVariables());
    if (asset.empty())
        return "";
    return _map.layer() == _root ? ArGetResolver().CreateIdentifier(asset, ArResolvedPath(_resolvedPath))
                                 : SdfComputeAssetPathRelativeToLayer(_map.layer(), asset);
}

Texture::Image Texture::read(const std::string &path, Files *files) const {
    ArResolvedPath resolved = ArGetResolver().Resolve(path);
    if (files)
        files->insert((resolved ? resolved : ArGetResolver().ResolveForNewAsset(path)).GetPathString());
    std::shared_ptr<ArAsset> asset = resolved ? ArGetResolver().OpenAsset(resolved) : nullptr;
    if (!asset)
        throw fault("%s: %s: %s", name().c_str(), path.c_str(), resolved ? "cannot be read" : "there is no such file");
    if (asset->GetSize() > largestFile)
        throw fault("%s: %s: has %zu bytes; more than %zu are refused", name().c_str(), path.c_str(), asset->GetSize(),
                    largestFile);
    std::vector<uint8_t> bytes(asset->GetSize());
    if (!bytes.empty() && asset->Read(bytes.data(), bytes.size(), 0) != bytes.size())
        throw fault("%s: %s: cannot be read", name().c_str(), path.c_str());
    skinslide_image *image = nullptr;
    skinslide_error error;
    if (skinslide_exr_decode(bytes.data(), static_cast<int64_t>(bytes.size()), _channel.c_str(), &image, &error))
        throw fault("%s: %s: %s", name().c_str(), path.c_str(), error.message);
    return {image, skinslide_image_destroy};
}

// ---- Texture coordinates ----

Texture::Corners Texture::corners(double time, const Topology &topology, const std::vector<int32_t> &faces) const {
    std::string what = _st.name();
    if (!_st.authored())
        throw fault("has a map, but the mesh has no %s; name one in %s", what.c_str(), _setting.c_str());
    TfToken interpolation = _st.interpolation();
    bool byCorner = interpolation == names().faceVarying;
    if (!byCorner && interpolation != names().vertex && interpolation != names().varying)
        throw fault("%s has interpolation %s; a map needs faceVarying, vertex or varying", what.c_str(),
                    interpolation.GetText());
    std::vector<float> st = pairs(_st.flattened(time), what, _st.attribute().typeName());
    size_t count = topology.faceIndices.size();
    checkLength(what, st.size() / 2, byCorner ? count : topology.vertexCount, byCorner ? "face corners" : "points");
    if (!byCorner) {
        std::vector<float> byPoint(2 * count);
        byPoint.swap(st);
        for (size_t corner = 0; corner < count; corner++)
            std::copy_n(byPoint.begin() + 2 * topology.faceIndices[corner], 2, st.begin() + 2 * corner);
    }
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    mesh.vertex_count = static_cast<int32_t>(topology.vertexCount);
    mesh.face_count = static_cast<int32_t>(topology.faceCount());
    mesh.index_count = static_cast<int32_t>(count);
    mesh.face_counts = topology.faceCounts.data(), mesh.face_indices = topology.faceIndices.data();
    return {mesh, faces, std::move(st)};
}

} // namespace skinslide
