#include "space.h"

#include "names.h"

#include "pxr/base/gf/quatd.h"
#include "pxr/base/gf/quatf.h"
#include "pxr/base/gf/quath.h"
#include "pxr/base/gf/rotation.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3f.h"
#include "pxr/base/gf/vec3h.h"
#include "pxr/base/tf/stringUtils.h"

#include <algorithm>

namespace skinslide {
namespace {

const char inverse[] = "!invert!", reset[] = "!resetXformStack!", prefix[] = "xformOp:";

// ---- Values of any precision ----

double numberOf(const VtValue &value) {
    const VtValue number = VtValue::Cast<double>(value);
    return number.IsHolding<double>() ? number.UncheckedGet<double>() : 0;
}

GfVec3d vectorOf(const VtValue &value, double otherwise) {
    return value.IsHolding<GfVec3d>()   ? value.UncheckedGet<GfVec3d>()
           : value.IsHolding<GfVec3f>() ? GfVec3d(value.UncheckedGet<GfVec3f>())
           : value.IsHolding<GfVec3h>() ? GfVec3d(value.UncheckedGet<GfVec3h>())
                                        : GfVec3d(otherwise);
}

GfQuatd quaternionOf(const VtValue &value) {
    return value.IsHolding<GfQuatd>()   ? value.UncheckedGet<GfQuatd>()
           : value.IsHolding<GfQuatf>() ? GfQuatd(value.UncheckedGet<GfQuatf>())
           : value.IsHolding<GfQuath>() ? GfQuatd(value.UncheckedGet<GfQuath>())
                                        : GfQuatd::GetIdentity();
}

// ---- One operation ----

GfMatrix4d turned(const GfRotation &rotation) {
    return GfMatrix4d(1).SetRotate(rotation);
}

GfMatrix4d turnedAbout(int axis, double degrees) {
    return turned(GfRotation(GfVec3d::Axis(axis), degrees));
}

// A vector of which one part is given: "translateX".
GfVec3d alone(int axis, double number, double otherwise) {
    GfVec3d vector(otherwise);
    vector[axis] = number;
    return vector;
}

// "ZYX": about z first. The inverse of a product of turns is that of their inverses, the other way round.
GfMatrix4d turnedInOrder(const std::string &axes, const GfVec3d &degrees) {
    GfMatrix4d made(1);
    for (char axis : axes)
        made = made * turnedAbout(axis - 'X', degrees[axis - 'X']);
    return made;
}

bool isOneAxis(const std::string &axes) {
    return axes.size() == 1 && axes[0] >= 'X' && axes[0] <= 'Z';
}

// The type of an operation: "rotateXYZ" of "xformOp:rotateXYZ:tail".
GfMatrix4d operation(const std::string &type, const VtValue &value) {
    const std::string axes = type.substr(type.find_last_not_of("XYZ") + 1), stem = type.substr(0, type.size() - axes.size());
    int axis = isOneAxis(axes) ? axes[0] - 'X' : -1;
    if (type == "transform")
        return value.IsHolding<GfMatrix4d>() ? value.UncheckedGet<GfMatrix4d>() : GfMatrix4d(1);
    if (type == "orient")
        return turned(GfRotation(quaternionOf(value)));
    if (stem == "translate")
        return GfMatrix4d(1).SetTranslate(axis < 0 ? vectorOf(value, 0) : alone(axis, numberOf(value), 0));
    if (stem == "scale")
        return GfMatrix4d(1).SetScale(axis < 0 ? vectorOf(value, 1) : alone(axis, numberOf(value), 1));
    if (stem == "rotate" && axis >= 0)
        return turnedAbout(axis, numberOf(value));
    return stem == "rotate" ? turnedInOrder(axes, vectorOf(value, 0)) : GfMatrix4d(1);
}

GfMatrix4d operation(const std::string &type, const VtValue &value, bool inverted) {
    GfMatrix4d own = value.IsEmpty() ? GfMatrix4d(1) : operation(type, value);
    return inverted ? own.GetInverse() : own;
}

} // namespace

// Those that count, and whether they begin in the world.
std::vector<ToWorld::Step> ToWorld::steps(const Prim &prim, bool *resets) {
    VtValue order = prim.attribute(names().xformOpOrder).at(Attribute::first);
    std::vector<Step> found;
    if (!order.IsHolding<VtTokenArray>())
        return found;
    for (const TfToken &token : order.UncheckedGet<VtTokenArray>()) {
        std::string name = token.GetString();
        if (name == reset) {
            *resets = true;
            found.clear();
            continue;
        }
        bool inverted = TfStringStartsWith(name, inverse);
        name = inverted ? name.substr(sizeof inverse - 1) : name;
        std::string type = TfStringStartsWith(name, prefix) ? TfStringSplit(name, ":")[1] : "";
        if (!SdfPath::IsValidNamespacedIdentifier(name))
            continue;
        found.push_back({prim.attribute(TfToken(name)), type, inverted});
    }
    return found;
}

ToWorld::ToWorld(Composition &composition, const SdfPath &path) {
    for (const SdfPath &each : path.GetPrefixes()) {
        bool resets = false;
        std::vector<Step> own = steps(composition.prim(each), &resets);
        if (resets)
            _locals.clear();
        _locals.push_back(own);
    }
}

GfMatrix4d ToWorld::at(double time) const {
    GfMatrix4d matrix(1);
    for (const std::vector<Step> &own : _locals) {
        GfMatrix4d local(1);
        for (const Step &step : own)
            local = operation(step.type, step.attribute.at(time), step.inverted) * local;
        matrix = local * matrix;
    }
    return matrix;
}

std::vector<double> ToWorld::times() const {
    std::vector<double> times;
    for (const std::vector<Step> &own : _locals) {
        for (const Step &step : own) {
            std::vector<double> authored = step.attribute.times();
            times.insert(times.end(), authored.begin(), authored.end());
        }
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

} // namespace skinslide
