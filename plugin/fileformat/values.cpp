#include "values.h"

#include "names.h"

#include "pxr/base/gf/half.h"
#include "pxr/base/gf/vec2d.h"
#include "pxr/base/gf/vec2f.h"
#include "pxr/base/gf/vec2h.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3h.h"
#include "pxr/base/gf/vec4d.h"
#include "pxr/base/gf/vec4f.h"
#include "pxr/base/gf/vec4h.h"
#include "pxr/usd/sdf/assetPath.h"

#include <cmath>

namespace skinslide {

// ---- Records ----

namespace {

template <class T> bool takeNumbers(skinslide_value_type type, int32_t width, const VtValue &value, skinslide_value *record) {
    if (value.IsHolding<VtArray<T>>()) {
        const VtArray<T> &array = value.UncheckedGet<VtArray<T>>();
        record->data = array.cdata(), record->count = static_cast<int64_t>(array.size()), record->is_array = 1;
    } else if (value.IsHolding<T>()) {
        record->data = &value.UncheckedGet<T>(), record->count = 1, record->is_array = 0;
    } else {
        return false;
    }
    record->type = type, record->width = width;
    return true;
}

bool takeNumbers(const VtValue &value, skinslide_value *record) {
    return takeNumbers<float>(SKINSLIDE_VALUE_FLOAT, 1, value, record) ||
           takeNumbers<GfVec3f>(SKINSLIDE_VALUE_FLOAT, 3, value, record) ||
           takeNumbers<int>(SKINSLIDE_VALUE_INT32, 1, value, record) ||
           takeNumbers<bool>(SKINSLIDE_VALUE_BOOL, 1, value, record) ||
           takeNumbers<double>(SKINSLIDE_VALUE_DOUBLE, 1, value, record) ||
           takeNumbers<GfHalf>(SKINSLIDE_VALUE_HALF, 1, value, record) ||
           takeNumbers<unsigned char>(SKINSLIDE_VALUE_UINT8, 1, value, record) ||
           takeNumbers<unsigned>(SKINSLIDE_VALUE_UINT32, 1, value, record) ||
           takeNumbers<int64_t>(SKINSLIDE_VALUE_INT64, 1, value, record) ||
           takeNumbers<uint64_t>(SKINSLIDE_VALUE_UINT64, 1, value, record) ||
           takeNumbers<GfVec2f>(SKINSLIDE_VALUE_FLOAT, 2, value, record) ||
           takeNumbers<GfVec2d>(SKINSLIDE_VALUE_DOUBLE, 2, value, record) ||
           takeNumbers<GfVec2h>(SKINSLIDE_VALUE_HALF, 2, value, record) ||
           takeNumbers<GfVec3d>(SKINSLIDE_VALUE_DOUBLE, 3, value, record) ||
           takeNumbers<GfVec3h>(SKINSLIDE_VALUE_HALF, 3, value, record) ||
           takeNumbers<GfVec4f>(SKINSLIDE_VALUE_FLOAT, 4, value, record) ||
           takeNumbers<GfVec4d>(SKINSLIDE_VALUE_DOUBLE, 4, value, record) ||
           takeNumbers<GfVec4h>(SKINSLIDE_VALUE_HALF, 4, value, record);
}

} // namespace

Record::Record(const Attribute &attribute, double time, const Anchor *anchor, const Attribute *indices)
    : _value(attribute.at(time)), _name(attribute.name()), _typeName(attribute.typeName().GetString()) {
    if (_value.IsHolding<SdfAssetPath>() && anchor)
        _text = anchor->path(attribute, _value.UncheckedGet<SdfAssetPath>());
    take();
    if (_value.IsEmpty() && attribute.authored() && !std::isnan(time))
        _record.type = SKINSLIDE_VALUE_BLOCKED;
    _interpolation = attribute.token(names().interpolation, TfToken());
    _record.interpolation = _interpolation.IsEmpty() ? nullptr : _interpolation.GetText();
    if (indices) {
        _indices = std::make_unique<Record>(*indices, time);
        _record.indices = *_indices;
    }
}

Record::Record(const std::string &name, const VtValue &value) : _value(value), _name(name) {
    if (!value.IsEmpty())
        _typeName = SdfSchema::GetInstance().FindType(value).GetAsToken().GetString();
    take();
}

void Record::rename(const std::string &name) {
    _name = name;
    _record.name = _name.c_str();
}

void Record::take() {
    _record.name = _name.c_str();
    _record.type_name = _typeName.empty() ? nullptr : _typeName.c_str();
    if (_value.IsEmpty() || takeNumbers(_value, &_record))
        return;
    bool isAsset = _value.IsHolding<SdfAssetPath>(), isToken = _value.IsHolding<TfToken>();
    if (isToken || _value.IsHolding<std::string>())
        _text = isToken ? _value.UncheckedGet<TfToken>().GetString() : _value.UncheckedGet<std::string>();
    if (isAsset || isToken || _value.IsHolding<std::string>()) {
        _record.type = isAsset ? SKINSLIDE_VALUE_ASSET : SKINSLIDE_VALUE_TEXT;
        _record.data = _text.c_str(), _record.count = 1;
        return;
    }
    _record.type = SKINSLIDE_VALUE_OTHER;
    _record.is_array = _value.IsArrayValued();
    _record.count = _value.IsArrayValued() ? static_cast<int64_t>(_value.GetArraySize()) : 1;
}

// ---- Properties ----

namespace {

TfToken indicesOf(const TfToken &primvar) {
    return TfToken(primvar.GetString() + ":indices");
}

} // namespace

Property::Property(Composition &composition, const Prim &prim, const skinslide_stage_input *input, const std::string &patch)
    : _input(input), _anchor(composition.anchor()) {
    TfToken name(input->prefix + (patch.empty() ? "" : patch + ":") + input->name);
    Prim owner = input->is_inherited ? ownerOf(composition, prim, name) : prim;
    _values = owner.attribute(name);
    if (input->is_primvar)
        _indices = owner.attribute(indicesOf(name));
    refuseWhatCannotBeRead();
}

Property::Property(Composition &composition, const Prim &prim, const TfToken &primvar)
    : _values(prim.attribute(primvar)), _indices(prim.attribute(indicesOf(primvar))), _anchor(composition.anchor()) {
    refuseWhatCannotBeRead();
}

void Property::refuseWhatCannotBeRead() const {
    for (const Attribute *attribute : {&_values, &_indices}) {
        const char *name = attribute->name().c_str();
        if (attribute->clipped())
            throw fault("%s %s from value clips, which a .skinslide file cannot read; bake the stage instead", name,
                        attribute->name() == names().points ? "come" : "comes");
        if (attribute->source() == Attribute::Source::Spline)
            throw fault("%s is a spline, which a .skinslide file cannot read; bake the stage instead, or sample it", name);
    }
}

std::vector<double> Property::times() const {
    std::vector<double> times;
    for (const Attribute *attribute : {&_values, &_indices}) {
        if (_values.authored() && attribute->varies()) {
            std::vector<double> own = attribute->times();
            times.insert(times.end(), own.begin(), own.end());
        }
    }
    return times;
}

std::vector<Property> properties(Composition &composition, const Prim &prim, skinslide_stage_group group,
                                 const std::string &patch) {
    std::vector<Property> found;
    const skinslide_stage_input *input = nullptr;
    while ((input = skinslide_stage_next_input(group, input)))
        found.emplace_back(composition, prim, input, patch);
    return found;
}

Prim ownerOf(Composition &composition, const Prim &prim, const TfToken &primvar) {
    if (prim.attribute(primvar).authored())
        return prim;
    for (SdfPath path = prim.path().GetParentPath(); path.IsPrimPath(); path = path.GetParentPath()) {
        Prim ancestor = composition.prim(path);
        Attribute found = ancestor.attribute(primvar);
        if (found.authored())
            return found.token(names().interpolation, names().constant) == names().constant ? ancestor : prim;
    }
    return prim;
}

// ---- Times ----

std::vector<double> mergedTimes(std::vector<double> times) {
    int64_t count = static_cast<int64_t>(times.size());
    call(skinslide_stage_merge_times, times.data(), &count);
    times.resize(static_cast<size_t>(count));
    return times;
}

std::string frameText(double time) {
    char text[32] = "default";
    if (!std::isnan(time))
        skinslide_stage_frame_text(time, text);
    return text;
}

} // namespace skinslide
