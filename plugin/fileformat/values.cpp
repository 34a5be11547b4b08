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

#include <algorithm>
#include <cmath>
#include <iterator>

namespace skinslide {

// ---- Records ----

namespace {

template <class Number, class T> bool takeNumbers(skinslide_value_type type, const VtValue &value, skinslide_value *record) {
    if (value.IsHolding<VtArray<T>>()) {
        const VtArray<T> &array = value.UncheckedGet<VtArray<T>>();
        record->data = array.cdata(), record->count = static_cast<int64_t>(array.size()), record->is_array = 1;
    } else if (value.IsHolding<T>()) {
        record->data = &value.UncheckedGet<T>(), record->count = 1, record->is_array = 0;
    } else {
        return false;
    }
    record->type = type, record->width = sizeof(T) / sizeof(Number);
    return true;
}

template <class Number, class... Vectors>
bool takeAny(skinslide_value_type type, const VtValue &value, skinslide_value *record) {
    return (takeNumbers<Number, Number>(type, value, record) || ... || takeNumbers<Number, Vectors>(type, value, record));
}

bool takeNumbers(const VtValue &value, skinslide_value *record) {
    return takeAny<float, GfVec3f, GfVec2f, GfVec4f>(SKINSLIDE_VALUE_FLOAT, value, record) ||
           takeAny<int>(SKINSLIDE_VALUE_INT32, value, record) || takeAny<bool>(SKINSLIDE_VALUE_BOOL, value, record) ||
           takeAny<double, GfVec2d, GfVec3d, GfVec4d>(SKINSLIDE_VALUE_DOUBLE, value, record) ||
           takeAny<GfHalf, GfVec2h, GfVec3h, GfVec4h>(SKINSLIDE_VALUE_HALF, value, record) ||
           takeAny<unsigned char>(SKINSLIDE_VALUE_UINT8, value, record) ||
           takeAny<unsigned>(SKINSLIDE_VALUE_UINT32, value, record) || takeAny<int64_t>(SKINSLIDE_VALUE_INT64, value, record) ||
           takeAny<uint64_t>(SKINSLIDE_VALUE_UINT64, value, record);
}

// The text of what has one; false where it has none.
bool takeText(const VtValue &value, std::string *text, skinslide_value *record) {
    if (value.IsHolding<SdfAssetPath>())
        *text = value.UncheckedGet<SdfAssetPath>().GetAssetPath();
    else if (value.IsHolding<TfToken>())
        *text = value.UncheckedGet<TfToken>().GetString();
    else if (value.IsHolding<std::string>())
        *text = value.UncheckedGet<std::string>();
    else
        return false;
    record->type = value.IsHolding<SdfAssetPath>() ? SKINSLIDE_VALUE_ASSET : SKINSLIDE_VALUE_TEXT;
    record->data = text->c_str(), record->count = 1;
    return true;
}

} // namespace

Record::Record(const Attribute &attribute, double time, const Attribute *indices)
    : _value(attribute.at(time)), _name(attribute.name()), _typeName(attribute.typeName().GetString()) {
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

void Record::take() {
    _record.name = _name.c_str();
    _record.type_name = _typeName.empty() ? nullptr : _typeName.c_str();
    if (_value.IsEmpty() || takeNumbers(_value, &_record) || takeText(_value, &_text, &_record))
        return;
    _record.type = SKINSLIDE_VALUE_OTHER;
    _record.is_array = _value.IsArrayValued();
    _record.count = _value.IsArrayValued() ? static_cast<int64_t>(_value.GetArraySize()) : 1;
}

// ---- Properties ----

namespace {

// The property of a prim that an input of a patch is; empty where it has none.
TfToken paintedName(Composition &composition, const Prim &prim, const skinslide_stage_input *input,
                    const skinslide_stage_patch *meaning) {
    const std::vector<const char *> *words = &composition.sortedNames(prim);
    std::vector<const char *> left; // of them, where a name without a value was found
    int32_t found = -1;
    while ((found = skinslide_stage_patch_property(meaning, input, words->data(), static_cast<int32_t>(words->size()))) >= 0) {
        Attribute attribute = prim.attribute(TfToken((*words)[static_cast<size_t>(found)]));
        if (attribute.authored() || attribute.blocked() || attribute.clipped())
            return TfToken(attribute.name());
        if (left.empty())
            left = *words;
        left.erase(left.begin() + found);
        words = &left;
    }
    return TfToken();
}

// The same of a prim or, where that is inherited, of the nearest that it is below and that has any; else the schema's own name.
TfToken nameOf(Composition &composition, const Prim &prim, const skinslide_stage_input *input, const std::string &patch,
               const skinslide_stage_patch *meaning) {
    TfToken own(input->prefix + (patch.empty() ? "" : patch + ":") + input->name);
    if (!meaning || !input->is_primvar)
        return own;
    TfToken found = paintedName(composition, prim, input, meaning);
    SdfPath path = input->is_inherited ? prim.path().GetParentPath() : SdfPath();
    for (; found.IsEmpty() && path.IsPrimPath(); path = path.GetParentPath())
        found = paintedName(composition, composition.prim(path), input, meaning);
    return found.IsEmpty() ? own : found;
}

} // namespace

Property::Property(Composition &composition, const Prim &prim, const skinslide_stage_input *input, const std::string &patch,
                   const skinslide_stage_patch *meaning)
    : _input(input) {
    TfToken name = nameOf(composition, prim, input, patch, meaning);
    Prim owner = input->is_inherited ? ownerOf(composition, prim, name) : prim;
    _values = owner.attribute(name);
    if (input->is_primvar)
        _indices = owner.attribute(TfToken(name.GetString() + ":indices"));
    for (const Attribute *attribute : {&_values, &_indices}) {
        const char *authored = attribute->name().c_str();
        if (attribute->clipped())
            throw fault("%s %s from value clips, which a .skinslide file cannot read; bake the stage instead", authored,
                        attribute->name() == names().points ? "come" : "comes");
        if (attribute->source() == Attribute::Source::Spline)
            throw fault("%s is a spline, which a .skinslide file cannot read; bake the stage instead, or sample it", authored);
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

std::vector<double> Property::samples() const {
    std::vector<double> own = _values.times(), indices = _indices.times(), all;
    std::set_union(own.begin(), own.end(), indices.begin(), indices.end(), std::back_inserter(all));
    return all;
}

std::vector<Property> properties(Composition &composition, const Prim &prim, skinslide_stage_group group,
                                 const std::string &patch, const skinslide_stage_patch *meaning) {
    std::vector<Property> found;
    const skinslide_stage_input *input = nullptr;
    while ((input = skinslide_stage_next_input(group, input)))
        found.emplace_back(composition, prim, input, patch, meaning);
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

} // namespace skinslide
