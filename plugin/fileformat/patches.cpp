#include "patches.h"

#include "names.h"
#include "textures.h"

#include "pxr/usd/sdf/assetPath.h"

#include <algorithm>

namespace skinslide {

Patch::Patch(Composition &composition, const Prim &prim, const skinslide_stage_mesh *mesh, const std::string &name,
             const skinslide_stage_live &live)
    : _name(name) {
    skinslide_stage_patch *patch = nullptr;
    call(skinslide_stage_patch_create, mesh, name.c_str(), &live, &patch);
    _patch.reset(patch);
    for (const Property &setting : properties(composition, prim, SKINSLIDE_STAGE_PATCH, name))
        setting.give(patch, skinslide_stage_patch_take, skinslide_stage_patch_check);
    giveSubset(composition, prim);
    skinslide_stage_controls *first = nullptr;
    call(skinslide_stage_controls_create, patch, nullptr, &first);
    _first.reset(first);
    _controls = properties(composition, prim, SKINSLIDE_STAGE_CONTROLS, name);
    for (const Property &control : _controls)
        call(skinslide_stage_controls_take, first, control.input(), control.first());
    findTextures(composition, prim);
    giveTextures(Attribute::first, first, &_files);
    setup();
}

// The child prim of the patch's name, where there is one that counts.
void Patch::giveSubset(Composition &composition, const Prim &prim) {
    TfTokenVector children = prim.childNames();
    TfToken name(_name);
    bool isThere = std::find(children.begin(), children.end(), name) != children.end();
    std::optional<Prim> child;
    if (isThere)
        child = composition.prim(prim.path().AppendChild(name), prim.clips());
    if (!child || !child->active()) {
        call(skinslide_stage_patch_take_subset, _patch.get(), nullptr);
        return;
    }
    std::string path = child->path().GetString();
    TfToken type = child->typeName();
    Attribute indices = child->attribute(names().indices);
    Record element(child->attribute(names().elementType), Attribute::defaultTime), first(indices, Attribute::first);
    first.rename(path + ".indices");
    skinslide_stage_subset subset = SKINSLIDE_STAGE_SUBSET_DEFAULT;
    subset.path = path.c_str(), subset.type_name = type.GetText(), subset.is_subset = type == names().geomSubset;
    subset.element_type = element, subset.indices = first;
    call(skinslide_stage_patch_take_subset, _patch.get(), &subset);
    for (double time : indices.varies() ? indices.times() : std::vector<double>()) {
        Record later(indices, time);
        later.rename(path + ".indices");
        call(skinslide_stage_patch_check_subset, _patch.get(), later, time);
    }
}

void Patch::findTextures(Composition &composition, const Prim &prim) {
    for (const Property &control : _controls) {
        if (std::string(control.input()->type_name) != "asset" || !control.attribute().authored())
            continue;
        _textures.push_back(control);
        for (double time : control.times())
            addUntiled(control, time, &_files);
    }
    if (const char *name = skinslide_stage_controls_coordinates(_first.get()))
        _coordinates.emplace(composition, prim, TfToken(name));
}

bool Patch::texturesVary() const {
    auto varies = [](const Property &property) { return property.varies(); };
    return std::any_of(_textures.begin(), _textures.end(), varies) || (_coordinates && _coordinates->varies());
}

void Patch::giveTextures(double time, skinslide_stage_controls *controls, std::set<std::string> *files) const {
    if (!_coordinates || !skinslide_stage_controls_coordinates(controls))
        return;
    call(skinslide_stage_controls_take_coordinates, controls, _coordinates->at(time));
    giveFiles(controls, files);
}

skinslide_patch_setup Patch::setup() const {
    skinslide_patch_setup setup = SKINSLIDE_PATCH_SETUP_DEFAULT;
    call(skinslide_stage_patch_get, _patch.get(), _first.get(), &setup);
    return setup;
}

// ---- Controls over time ----

bool Patch::varies() const {
    return texturesVary() ||
           std::any_of(_controls.begin(), _controls.end(), [](const Property &control) { return control.varies(); });
}

std::vector<double> Patch::times() const {
    std::vector<double> times;
    auto append = [&](const std::vector<double> &more) { times.insert(times.end(), more.begin(), more.end()); };
    for (const Property &control : _controls)
        append(control.times());
    if (_coordinates)
        append(_coordinates->times());
    return times;
}

ControlsHandle Patch::frames() const {
    skinslide_stage_controls *frames = nullptr;
    call(skinslide_stage_controls_create, _patch.get(), _first.get(), &frames);
    return ControlsHandle(frames);
}

skinslide_controls Patch::controlsAt(double time, skinslide_stage_controls *frames) const {
    bool textures = texturesVary();
    for (const Property &control : _controls) {
        bool isTexture = std::string(control.input()->type_name) == "asset";
        if (isTexture ? textures : control.varies())
            call(skinslide_stage_controls_take, frames, control.input(), control.at(time));
    }
    if (textures)
        giveTextures(time, frames, nullptr);
    skinslide_controls controls = SKINSLIDE_CONTROLS_DEFAULT;
    call(skinslide_stage_controls_get, frames, &controls);
    return controls;
}

} // namespace skinslide
