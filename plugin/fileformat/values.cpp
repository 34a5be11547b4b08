#include "values.h"

#include "fault.h"
#include "names.h"

#include "pxr/base/gf/half.h"
#include "pxr/base/gf/vec2d.h"
#include "pxr/base/gf/vec2f.h"
#include "pxr/base/gf/vec2h.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3h.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace skinslide {
namespace {

template <class T, class Out> bool copyArray(const VtValue &value, Out *out) {
    if (!value.IsHolding<VtArray<T>>())
        return false;
    const VtArray<T> &array = value.UncheckedGet<VtArray<T>>();
    out->reserve(array.size());
    for (const T &element : array)
        out->push_back(static_cast<typename Out::value_type>(element));
    return true;
}

template <class T> bool copyPairs(const VtValue &value, std::vector<float> *out) {
    if (!value.IsHolding<VtArray<T>>())
        return false;
    for (const T &pair : value.UncheckedGet<VtArray<T>>()) {
        out->push_back(static_cast<float>(pair[0]));
        out->push_back(static_cast<float>(pair[1]));
    }
    return true;
}

template <class T> bool copyPositive(const VtValue &value, const std::string &what, std::vector<bool> *out) {
    if (!value.IsHolding<VtArray<T>>())
        return false;
    const VtArray<T> &array = value.UncheckedGet<VtArray<T>>();
    for (size_t i = 0; i < array.size(); i++) {
        if (!std::isfinite(static_cast<double>(array.cdata()[i])))
            throw fault("%s[%zu] is %g", what.c_str(), i, static_cast<double>(array.cdata()[i]));
        out->push_back(array.cdata()[i] > T(0));
    }
    return true;
}

template <class T> bool gather(const std::vector<int32_t> &indices, const std::string &name, VtValue *value) {
    if (!value->IsHolding<VtArray<T>>())
        return false;
    const VtArray<T> &from = value->UncheckedGet<VtArray<T>>();
    VtArray<T> to(indices.size());
    for (size_t i = 0; i < indices.size(); i++) {
        if (indices[i] < 0 || static_cast<size_t>(indices[i]) >= from.size())
            throw fault("%s:indices[%zu] is %d, but %s has %zu values", name.c_str(), i, indices[i], name.c_str(), from.size());
        to[i] = from.cdata()[indices[i]];
    }
    *value = VtValue::Take(to);
    return true;
}

} // namespace

std::vector<int32_t> integers(const VtValue &value, const std::string &what) {
    std::vector<int32_t> out;
    if (!value.IsEmpty() && !copyArray<int>(value, &out) && !copyArray<unsigned>(value, &out) &&
        !copyArray<int64_t>(value, &out) && !copyArray<uint64_t>(value, &out) && !copyArray<unsigned char>(value, &out))
        throw fault("%s is not an array of int", what.c_str());
    return out;
}

std::vector<float> floats(const VtValue &value, const std::string &what) {
    std::vector<float> out;
    if (value.IsHolding<float>())
        out.push_back(value.UncheckedGet<float>());
    else if (!value.IsEmpty() && !copyArray<float>(value, &out) && !copyArray<double>(value, &out) &&
             !copyArray<GfHalf>(value, &out))
        throw fault("%s is not an array of float", what.c_str());
    return out;
}

VtVec3fArray positions(const VtValue &value, const std::string &what) {
    VtVec3fArray out;
    if (value.IsHolding<VtVec3fArray>())
        return value.UncheckedGet<VtVec3fArray>();
    auto convert = [&](const auto &array) {
        for (const auto &point : array)
            out.push_back(GfVec3f(point));
    };
    if (value.IsHolding<VtArray<GfVec3d>>())
        convert(value.UncheckedGet<VtArray<GfVec3d>>());
    else if (value.IsHolding<VtArray<GfVec3h>>())
        convert(value.UncheckedGet<VtArray<GfVec3h>>());
    else if (!value.IsEmpty())
        throw fault("%s is not an array of points", what.c_str());
    return out;
}

std::vector<float> pairs(const VtValue &value, const std::string &what, const TfToken &type) {
    std::vector<float> out;
    if (!value.IsEmpty() && !copyPairs<GfVec2f>(value, &out) && !copyPairs<GfVec2d>(value, &out) &&
        !copyPairs<GfVec2h>(value, &out))
        throw fault("%s is %s; a map needs pairs of floats", what.c_str(), type.GetText());
    return out;
}

std::vector<bool> positive(const VtValue &value, const std::string &what) {
    std::vector<bool> out;
    if (!copyPositive<bool>(value, what, &out) && !copyPositive<int>(value, what, &out) &&
        !copyPositive<float>(value, what, &out))
        throw fault("%s must be bool[], int[] or float[]", what.c_str());
    return out;
}

void checkLength(const std::string &what, size_t got, size_t count, const char *of) {
    if (got != count)
        throw fault("%s has %zu values, but the mesh has %zu %s", what.c_str(), got, count, of);
}

VtValue unchanging(const Attribute &attribute, const std::string &what) {
    VtValue first = attribute.at(Attribute::first);
    if (attribute.varies()) {
        for (double time : attribute.times()) {
            if (attribute.at(time) != first)
                throw fault("%s changes at frame %s; it must stay the same over time", what.c_str(), frameText(time).c_str());
        }
    }
    return first;
}

std::vector<double> mergedTimes(const std::vector<double> &times) {
    std::vector<size_t> order(times.size()), kept;
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return times[a] < times[b]; });
    for (size_t given : order) {
        if (kept.empty() || times[given] - times[kept.back()] > sameTime)
            kept.push_back(given);
        else if (given < kept.back())
            kept.back() = given;
    }
    std::vector<double> merged;
    for (size_t given : kept)
        merged.push_back(times[given]);
    return merged;
}

std::string frameText(double time) {
    if (std::isnan(time))
        return "default";
    std::string text = TfStringPrintf("%.6f", time);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text == "-0" ? "0" : text;
}

Primvar::Primvar(const Prim &prim, const TfToken &name)
    : _values(prim.attribute(name)), _indices(prim.attribute(TfToken(name.GetString() + ":indices"))) {
}

TfToken Primvar::interpolation() const {
    return _values.token(names().interpolation, names().constant);
}

std::vector<double> Primvar::times() const {
    std::vector<double> times;
    for (const Attribute *source : {&_values, &_indices}) {
        if (source->varies()) {
            std::vector<double> own = source->times();
            times.insert(times.end(), own.begin(), own.end());
        }
    }
    return times;
}

VtValue Primvar::flattened(double time) const {
    VtValue value = _values.at(time);
    if (value.IsEmpty() || !indexed())
        return value;
    std::vector<int32_t> indices = integers(_indices.at(time), name() + ":indices");
    if (!gather<float>(indices, name(), &value) && !gather<GfVec3f>(indices, name(), &value) &&
        !gather<bool>(indices, name(), &value) && !gather<int>(indices, name(), &value) &&
        !gather<GfVec3d>(indices, name(), &value) && !gather<GfVec3h>(indices, name(), &value) &&
        !gather<GfVec2f>(indices, name(), &value) && !gather<GfVec2d>(indices, name(), &value) &&
        !gather<GfVec2h>(indices, name(), &value))
        throw fault("%s has indices, which its type cannot have here", name().c_str());
    return value;
}

} // namespace skinslide
