// What the core asks for, fetched from a composed prim and handed over as its records. Nothing is checked or interpreted here.
#ifndef SKINSLIDE_FORMAT_VALUES_H
#define SKINSLIDE_FORMAT_VALUES_H

#include "compose.h"
#include "fault.h"

#include "pxr/base/gf/vec3f.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/types.h"

#include "skinslide/stage.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace skinslide {

// Owns a handle of the core.
template <class T, void (*destroy)(T *)> struct Destroyer {
    void operator()(T *handle) const {
        destroy(handle);
    }
};
template <class T, void (*destroy)(T *)> using Handle = std::unique_ptr<T, Destroyer<T, destroy>>;
using MeshHandle = Handle<skinslide_stage_mesh, skinslide_stage_mesh_destroy>;
using PatchHandle = Handle<skinslide_stage_patch, skinslide_stage_patch_destroy>;
using ControlsHandle = Handle<skinslide_stage_controls, skinslide_stage_controls_destroy>;
using DerivedHandle = Handle<skinslide_stage_derived, skinslide_stage_derived_destroy>;

// Calls a function of the core; throws Fault with its sentence where it fails.
template <class Function, class... Arguments> void call(Function function, Arguments &&...arguments) {
    skinslide_error error = {};
    if (function(std::forward<Arguments>(arguments)..., &error) != SKINSLIDE_OK)
        throw Fault(error.message);
}

// What a function of the core makes.
template <class Handle, class Function, class... Arguments> Handle make(Function function, Arguments &&...arguments) {
    typename Handle::pointer made = nullptr;
    call(function, std::forward<Arguments>(arguments)..., &made);
    return Handle(made);
}

// What an attribute has at a time, as a record that points into this.
class Record {
  public:
    // indices  those of an indexed primvar, or null
    Record(const Attribute &attribute, double time, const Attribute *indices = nullptr);
    // Of a value that is not an attribute's.
    Record(const std::string &name, const VtValue &value);
    Record(const Record &) = delete;
    Record &operator=(const Record &) = delete;

    operator const skinslide_value *() const {
        return &_record;
    }
    const VtValue &value() const {
        return _value;
    }

  private:
    void take();

    skinslide_value _record = SKINSLIDE_VALUE_DEFAULT;
    VtValue _value;
    std::string _name, _typeName, _text;
    TfToken _interpolation;
    std::unique_ptr<Record> _indices;
};

// A property of a prim that the core asks for, with its indices.
class Property {
  public:
    Property() = default;
    // patch    the patch whose input it is; empty: it is the mesh's own
    // meaning  that patch in the core, which knows under which names its paint may be; null: under the schema's only
    // Throws Fault where it is authored in a way that this reader cannot read.
    Property(Composition &composition, const Prim &prim, const skinslide_stage_input *input, const std::string &patch = "",
             const skinslide_stage_patch *meaning = nullptr);

    const skinslide_stage_input *input() const {
        return _input;
    }
    const Attribute &attribute() const {
        return _values;
    }
    bool varies() const {
        return _values.authored() && (_values.varies() || _indices.varies());
    }
    std::vector<double> times() const;   // of values and of indices, where they vary
    std::vector<double> samples() const; // of both, each once, ascending
    Record at(double time) const {
        return Record(_values, time, _indices.authored() ? &_indices : nullptr);
    }
    Record first() const {
        return at(_input->when == SKINSLIDE_STAGE_DEFAULT_TIME ? Attribute::defaultTime : Attribute::first);
    }
    // Hands over the value and, if it must stay the same over time, its later samples and the default that the first one hides.
    // Throws Fault.
    template <class Handle, class Take, class Check> void give(Handle *handle, Take take, Check check) const {
        call(take, handle, _input, first());
        if (_input->when != SKINSLIDE_STAGE_STILL)
            return;
        std::vector<double> sampled = samples();
        if (!sampled.empty() && hasDefault())
            call(check, handle, _input, at(Attribute::defaultTime), sampled.front());
        for (double time : times())
            call(check, handle, _input, at(time), time);
    }

  private:
    bool hasDefault() const {
        return _values.hasDefault() && (!_indices.authored() || _indices.hasDefault());
    }

    const skinslide_stage_input *_input = nullptr;
    Attribute _values, _indices;
};

// Every property of a group, in the order in which the core wants them. Throws Fault.
std::vector<Property> properties(Composition &composition, const Prim &prim, skinslide_stage_group group,
                                 const std::string &patch = "", const skinslide_stage_patch *meaning = nullptr);

// The prim that an inherited primvar comes from: the nearest ancestor that has any, where that is constant; else the prim
// itself.
Prim ownerOf(Composition &composition, const Prim &prim, const TfToken &primvar);

inline const float *floatsOf(const VtVec3fArray &points) {
    return reinterpret_cast<const float *>(points.cdata());
}

inline float *floatsOf(VtVec3fArray *points) {
    return reinterpret_cast<float *>(points->data());
}

} // namespace skinslide

#endif
