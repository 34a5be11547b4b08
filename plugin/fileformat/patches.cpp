#include "patches.h"

#include "names.h"
#include "sources.h"

#include "pxr/usd/ar/asset.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/sdf/assetPath.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

namespace skinslide {

// ---- Files of textures ----

namespace {

// A resolved file, open where it can be read.
class Content {
  public:
    // Of one that is larger, nothing is read.
    Content(const ArResolvedPath &path, int64_t largest)
        : _asset(isIrregular(path) ? nullptr : ArGetResolver().OpenAsset(path)) {
        size_t size = _asset ? _asset->GetSize() : 0;
        _size = static_cast<int64_t>(size);
        if (!_asset || _size > largest)
            return;
        auto [file, offset] = _asset->GetFileUnsafe();
        _offset = static_cast<int64_t>(offset);
        if (file)
            _descriptor = fileno(file);
        else if (_bytes.resize(size + 1); _asset->Read(_bytes.data(), size, 0) != size)
            _bytes.clear();
    }

    void describe(skinslide_stage_file *file) const {
        file->byte_count = _size, file->offset = _offset;
        file->bytes = _bytes.empty() ? nullptr : _bytes.data();
        file->descriptor = _descriptor < 0 ? nullptr : &_descriptor;
    }

  private:
    std::shared_ptr<ArAsset> _asset;
    std::vector<uint8_t> _bytes; // and one more, so that there are some
    int32_t _descriptor = -1;
    int64_t _size = 0, _offset = 0;
};

// Gives every file that is asked for, and adds its path, resolved, to `files`, which may be null. Throws Fault.
void giveFiles(skinslide_stage_controls *controls, std::set<std::string> *files) {
    const skinslide_stage_need *need = nullptr;
    while (call(skinslide_stage_controls_need, controls, &need), need) {
        ArResolvedPath resolved = ArGetResolver().Resolve(need->path);
        if (files)
            files->insert(pathFor(need->path));
        std::optional<Content> content;
        std::string path = resolved.GetPathString();
        skinslide_stage_file file = SKINSLIDE_STAGE_FILE_DEFAULT;
        file.path = resolved ? path.c_str() : nullptr;
        if (resolved && !skinslide_stage_controls_holds(controls, path.c_str())) {
            content.emplace(resolved, need->largest);
            content->describe(&file);
        }
        call(skinslide_stage_controls_give, controls, &file);
    }
}

// Adds the files that a texture names over time, where it has no tiles, be they there or not.
void addUntiled(const Property &texture, std::set<std::string> *files) {
    for (double time : texture.times()) {
        VtValue value = texture.attribute().at(time);
        std::string path = value.IsHolding<SdfAssetPath>() ? value.UncheckedGet<SdfAssetPath>().GetAssetPath() : "";
        if (!path.empty() && path.find("<UDIM>") == std::string::npos)
            files->insert(pathFor(path));
    }
}

} // namespace

// ---- The patch ----

Patch::Patch(Composition &composition, const Prim &prim, const skinslide_stage_mesh *mesh, const std::string &name,
             const skinslide_stage_live &live)
    : _name(name), _patch(make<PatchHandle>(skinslide_stage_patch_create, mesh, name.c_str(), &live)) {
    for (const Property &setting : properties(composition, prim, SKINSLIDE_STAGE_PATCH, name, _patch.get()))
        setting.give(_patch.get(), skinslide_stage_patch_take, skinslide_stage_patch_check);
    giveSubset(composition, prim);
    _first = make<ControlsHandle>(skinslide_stage_controls_create, _patch.get(), nullptr);
    _controls = properties(composition, prim, SKINSLIDE_STAGE_CONTROLS, name, _patch.get());
    for (const Property &control : _controls) {
        call(skinslide_stage_controls_take, _first.get(), control.input(), control.first());
        if (skinslide_stage_is_texture(control.input()))
            addUntiled(control, &_files);
    }
    if (const skinslide_stage_input *coordinates = skinslide_stage_controls_coordinates(_first.get())) {
        _controls.emplace_back(composition, prim, coordinates);
        call(skinslide_stage_controls_take, _first.get(), coordinates, _controls.back().first());
    }
    giveFiles(_first.get(), &_files);
    setup();
}

// The child prim of the patch's name, where there is one that counts.
void Patch::giveSubset(Composition &composition, const Prim &prim) {
    TfTokenVector children = prim.childNames();
    bool isThere = std::find(children.begin(), children.end(), TfToken(_name)) != children.end();
    Prim child = isThere ? composition.prim(prim.path().AppendChild(TfToken(_name)), prim.clips()) : prim;
    isThere = isThere && child.active();
    TfToken type = child.typeName();
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    subset.path = child.path().GetText(), subset.type_name = type.GetText(), subset.is_subset = type == names().geomSubset;
    call(skinslide_stage_patch_take_subset, _patch.get(), isThere ? &subset : nullptr);
    for (const Property &property : isThere ? properties(composition, child, SKINSLIDE_STAGE_SUBSET) : std::vector<Property>())
        property.give(_patch.get(), skinslide_stage_patch_take, skinslide_stage_patch_check);
}

skinslide_patch_setup Patch::setup() const {
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    call(skinslide_stage_patch_get, _patch.get(), _first.get(), &setup);
    return setup;
}

// ---- Controls over time ----

bool Patch::varies() const {
    return std::any_of(_controls.begin(), _controls.end(), [](const Property &control) { return control.varies(); });
}

std::vector<double> Patch::times() const {
    std::vector<double> times;
    for (const Property &control : _controls) {
        std::vector<double> own = control.times();
        times.insert(times.end(), own.begin(), own.end());
    }
    return times;
}

ControlsHandle Patch::frames() const {
    return make<ControlsHandle>(skinslide_stage_controls_create, _patch.get(), _first.get());
}

skinslide_controls Patch::controlsAt(double time, skinslide_stage_controls *frames) const {
    for (const Property &control : _controls) {
        if (control.varies())
            call(skinslide_stage_controls_take, frames, control.input(), control.at(time));
    }
    giveFiles(frames, nullptr);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    call(skinslide_stage_controls_get, frames, &controls);
    return controls;
}

} // namespace skinslide
