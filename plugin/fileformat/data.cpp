#include "data.h"

#include "names.h"

#include "pxr/usd/sdf/schema.h"
#include "pxr/usd/sdf/types.h"

#include <algorithm>

namespace skinslide {

// ---- What is declared ----

namespace {

// Into the data itself: a layer would announce each edit.
void addChild(SdfData *data, const SdfPath &parent, const TfToken &children, const TfToken &name) {
    VtValue value = data->Get(parent, children);
    TfTokenVector names = value.IsHolding<TfTokenVector>() ? value.UncheckedGet<TfTokenVector>() : TfTokenVector();
    names.push_back(name);
    data->Set(parent, children, VtValue(names));
}

void declarePrim(SdfData *data, const SdfPath &path) {
    if (data->HasSpec(path))
        return;
    declarePrim(data, path.GetParentPath());
    addChild(data, path.GetParentPath(), SdfChildrenKeys->PrimChildren, path.GetNameToken());
    data->CreateSpec(path, SdfSpecTypePrim);
    data->Set(path, SdfFieldKeys->Specifier, VtValue(SdfSpecifierOver));
}

// The attribute, of that type where it is not there, and with no values over time.
SdfPath declare(SdfData *data, const SdfPath &prim, const TfToken &name, const TfToken &type) {
    SdfPath path = prim.AppendProperty(name);
    if (!data->HasSpec(path)) {
        declarePrim(data, prim);
        addChild(data, prim, SdfChildrenKeys->PropertyChildren, name);
        data->CreateSpec(path, SdfSpecTypeAttribute);
        data->Set(path, SdfFieldKeys->Custom, VtValue(false));
        data->Set(path, SdfFieldKeys->Variability, VtValue(SdfVariabilityVarying));
        data->Set(path, SdfFieldKeys->TypeName, VtValue(type));
    }
    for (const TfToken &field : {SdfFieldKeys->TimeSamples, names().spline})
        data->Erase(path, field);
    return path;
}

} // namespace

DataRefPtr Data::create(const SdfAbstractDataConstPtr &text, const std::vector<std::shared_ptr<LiveMesh>> &meshes) {
    DataRefPtr data = TfCreateRefPtr(new Data);
    data->CopyFrom(text);
    for (const std::shared_ptr<LiveMesh> &mesh : meshes)
        data->addMesh(mesh);
    return data;
}

void Data::add(const SdfPath &prim, const TfToken &name, const TfToken &type, const std::vector<double> &times, Compute at) {
    SdfPath path = declare(this, prim, name, type);
    if (times.empty()) // the computed default stands for that of the text
        Erase(path, SdfFieldKeys->Default);
    _computed[path] = {times, std::move(at), SdfSchema::GetInstance().FindType(type).GetDefaultValue()};
}

void Data::addMesh(const std::shared_ptr<LiveMesh> &live) {
    const PatchedMesh &mesh = live->mesh();
    auto compute = [&](const TfToken &name, const char *type, const std::vector<double> &times, Compute at) {
        add(mesh.path, name, TfToken(type), times, std::move(at));
    };
    compute(names().points, "point3f[]", mesh.times, [live](double time) { return live->points(time); });
    compute(names().extent, "float3[]", mesh.times, [live](double time) { return live->extent(time); });
    for (const Derived &derived : mesh.derived) {
        TfToken name(derived.output->name);
        if (!derived.output->pose_count) { // no value, so that none of a weaker layer is read
            Set(declare(this, mesh.path, name, TfToken(derived.output->type_name)), SdfFieldKeys->Default,
                VtValue(SdfValueBlock()));
            continue;
        }
        // Normals may move over points that do not.
        const Attribute &cached = derived.cached.attribute();
        compute(name, derived.output->type_name, mesh.times.empty() ? derived.cached.samples() : mesh.times,
                [live, &derived](double time) { return live->derived(derived, time); });
        VtValue interpolation = cached.metadata(names().interpolation);
        if (!interpolation.IsEmpty())
            Set(mesh.path.AppendProperty(name), names().interpolation, interpolation);
    }
}

// ---- Which attributes and fields are computed ----

const Data::Computed *Data::computed(const SdfPath &path) const {
    auto found = _computed.find(path);
    return found == _computed.end() ? nullptr : &found->second;
}

const Data::Computed *Data::computedField(const SdfPath &path, const TfToken &field) const {
    if (field != SdfFieldKeys->TimeSamples && field != SdfFieldKeys->Default)
        return nullptr;
    const Computed *attribute = computed(path);
    return attribute && attribute->times.empty() == (field == SdfFieldKeys->Default) ? attribute : nullptr;
}

// Of the declared type, but for a block, and where the cache has something else that could not be slid.
VtValue Data::valueAt(const Computed &attribute, double time) {
    VtValue value = attribute.at(time), cast = VtValue::CastToTypeOf(value, attribute.standard);
    return cast.IsEmpty() ? value : cast;
}

VtValue Data::fieldValue(const Computed &attribute) {
    if (attribute.times.empty())
        return valueAt(attribute, Attribute::defaultTime);
    SdfTimeSampleMap samples;
    for (double time : attribute.times)
        samples[time] = valueAt(attribute, time);
    return VtValue::Take(samples);
}

bool Data::hasSample(const Computed &attribute, double time) {
    return std::binary_search(attribute.times.begin(), attribute.times.end(), time);
}

// ---- SdfAbstractData ----

bool Data::StreamsData() const {
    return true;
}

bool Data::IsDetached() const {
    return false;
}

bool Data::Has(const SdfPath &path, const TfToken &field, SdfAbstractDataValue *value) const {
    const Computed *attribute = computedField(path, field);
    if (!attribute)
        return SdfData::Has(path, field, value);
    return !value || value->StoreValue(fieldValue(*attribute));
}

bool Data::Has(const SdfPath &path, const TfToken &field, VtValue *value) const {
    const Computed *attribute = computedField(path, field);
    if (!attribute)
        return SdfData::Has(path, field, value);
    if (value)
        *value = fieldValue(*attribute);
    return true;
}

bool Data::HasSpecAndField(const SdfPath &path, const TfToken &field, SdfAbstractDataValue *value, SdfSpecType *type) const {
    *type = GetSpecType(path);
    return *type != SdfSpecTypeUnknown && Has(path, field, value);
}

bool Data::HasSpecAndField(const SdfPath &path, const TfToken &field, VtValue *value, SdfSpecType *type) const {
    *type = GetSpecType(path);
    return *type != SdfSpecTypeUnknown && Has(path, field, value);
}

VtValue Data::Get(const SdfPath &path, const TfToken &field) const {
    const Computed *attribute = computedField(path, field);
    return attribute ? fieldValue(*attribute) : SdfData::Get(path, field);
}

const std::type_info &Data::GetTypeid(const SdfPath &path, const TfToken &field) const {
    const Computed *attribute = computedField(path, field);
    if (!attribute)
        return SdfData::GetTypeid(path, field);
    return field == SdfFieldKeys->Default ? attribute->standard.GetTypeid() : typeid(SdfTimeSampleMap);
}

std::vector<TfToken> Data::List(const SdfPath &path) const {
    std::vector<TfToken> fields = SdfData::List(path);
    if (const Computed *attribute = computed(path))
        fields.push_back(attribute->times.empty() ? SdfFieldKeys->Default : SdfFieldKeys->TimeSamples);
    return fields;
}

// ---- Samples ----

namespace {

// The times on either side, both the same at a sample and outside the first and last.
bool bracket(const std::vector<double> &times, double time, double *lower, double *upper) {
    if (times.empty())
        return false;
    auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after == times.end())
        *lower = *upper = times.back();
    else if (after == times.begin() || *after == time)
        *lower = *upper = *after;
    else
        *lower = *(after - 1), *upper = *after;
    return true;
}

} // namespace

std::set<double> Data::ListAllTimeSamples() const {
    std::set<double> times = SdfData::ListAllTimeSamples();
    for (const auto &[path, attribute] : _computed)
        times.insert(attribute.times.begin(), attribute.times.end());
    return times;
}

std::set<double> Data::ListTimeSamplesForPath(const SdfPath &path) const {
    const Computed *attribute = computed(path);
    return attribute ? std::set<double>(attribute->times.begin(), attribute->times.end())
                     : SdfData::ListTimeSamplesForPath(path);
}

bool Data::GetBracketingTimeSamples(double time, double *lower, double *upper) const {
    std::set<double> all = ListAllTimeSamples();
    return bracket(std::vector<double>(all.begin(), all.end()), time, lower, upper);
}

size_t Data::GetNumTimeSamplesForPath(const SdfPath &path) const {
    const Computed *attribute = computed(path);
    return attribute ? attribute->times.size() : SdfData::GetNumTimeSamplesForPath(path);
}

bool Data::GetBracketingTimeSamplesForPath(const SdfPath &path, double time, double *lower, double *upper) const {
    const Computed *attribute = computed(path);
    return attribute ? bracket(attribute->times, time, lower, upper)
                     : SdfData::GetBracketingTimeSamplesForPath(path, time, lower, upper);
}

#if PXR_VERSION >= 2505
bool Data::GetPreviousTimeSampleForPath(const SdfPath &path, double time, double *previous) const {
    const Computed *attribute = computed(path);
    if (!attribute)
        return SdfData::GetPreviousTimeSampleForPath(path, time, previous);
    auto at = std::lower_bound(attribute->times.begin(), attribute->times.end(), time);
    if (at == attribute->times.begin())
        return false;
    *previous = *(at - 1);
    return true;
}
#endif

bool Data::QueryTimeSample(const SdfPath &path, double time, SdfAbstractDataValue *value) const {
    const Computed *attribute = computed(path);
    if (!attribute)
        return SdfData::QueryTimeSample(path, time, value);
    return hasSample(*attribute, time) && (!value || value->StoreValue(valueAt(*attribute, time)));
}

bool Data::QueryTimeSample(const SdfPath &path, double time, VtValue *value) const {
    const Computed *attribute = computed(path);
    if (!attribute)
        return SdfData::QueryTimeSample(path, time, value);
    if (!hasSample(*attribute, time))
        return false;
    if (value)
        *value = valueAt(*attribute, time);
    return true;
}

#if PXR_VERSION >= 2505
const std::type_info &Data::QueryTimeSampleTypeid(const SdfPath &path, double time) const {
    const Computed *attribute = computed(path);
    if (!attribute)
        return SdfData::QueryTimeSampleTypeid(path, time);
    return hasSample(*attribute, time) ? attribute->standard.GetTypeid() : typeid(void);
}
#endif

} // namespace skinslide
