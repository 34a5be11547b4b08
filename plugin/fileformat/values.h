// Values of attributes as arrays, checked: what they hold, how many, and how they change over time.
#ifndef SKINSLIDE_FORMAT_VALUES_H
#define SKINSLIDE_FORMAT_VALUES_H

#include "compose.h"

#include "pxr/base/gf/vec3f.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace skinslide {

// Each throws Fault where the value is not such an array. An empty value is an empty array.
std::vector<int32_t> integers(const VtValue &value, const std::string &what);
std::vector<float> floats(const VtValue &value, const std::string &what); // also of one float
VtVec3fArray positions(const VtValue &value, const std::string &what);

// A texCoord2f[], or another array of two numbers each, as twice as many floats. type  is named where it is none.
std::vector<float> pairs(const VtValue &value, const std::string &what, const TfToken &type);

// Values > 0 of a bool[], int[] or float[].
std::vector<bool> positive(const VtValue &value, const std::string &what);

void checkLength(const std::string &what, size_t got, size_t count, const char *of);

// The value of an attribute that must stay the same over time; empty where it has none.
VtValue unchanging(const Attribute &attribute, const std::string &what);

// Times in order; of those that differ by noise of layer offsets only, the one given first.
std::vector<double> mergedTimes(const std::vector<double> &times);
constexpr double sameTime = 1e-6;

// 1012 for 1012.0 and 1012.25 for 1012.25; "default" where it is the default time.
std::string frameText(double time);

// A primvar with its indices.
class Primvar {
  public:
    Primvar() = default;
    Primvar(const Prim &prim, const TfToken &name); // with its primvars: prefix

    const Attribute &attribute() const {
        return _values;
    }
    bool authored() const {
        return _values.authored();
    }
    bool indexed() const {
        return _indices.authored();
    }
    bool varies() const {
        return _values.varies() || _indices.varies();
    }
    std::string name() const {
        return _values.name();
    }
    TfToken interpolation() const;
    std::vector<double> times() const; // of values and of indices, where they vary
    VtValue flattened(double time) const;

  private:
    Attribute _values, _indices;
};

} // namespace skinslide

#endif
