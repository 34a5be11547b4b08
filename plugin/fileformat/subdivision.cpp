#include "subdivision.h"

#include "fault.h"
#include "names.h"

#include <algorithm>

namespace skinslide {
namespace {

// The place of a token among those of the core's enum.
int readToken(const Prim &mesh, const char *name, const std::vector<std::string> &tokens, int fallback) {
    VtValue value = unchanging(mesh.attribute(TfToken(name)), name);
    if (value.IsEmpty())
        return fallback;
    std::string token = TfStringify(value);
    auto found = std::find(tokens.begin(), tokens.end(), token);
    if (found == tokens.end())
        throw fault("%s is '%s'; it must be one of %s", name, token.c_str(),
                    TfStringJoin(tokens.begin(), tokens.end(), ", ").c_str());
    return static_cast<int>(found - tokens.begin());
}

std::vector<int32_t> readIntegers(const Prim &mesh, const char *name) {
    return integers(unchanging(mesh.attribute(TfToken(name)), name), name);
}

std::vector<float> readFloats(const Prim &mesh, const char *name) {
    return floats(unchanging(mesh.attribute(TfToken(name)), name), name);
}

template <class T> const T *pointerTo(const std::vector<T> &values) {
    return values.empty() ? nullptr : values.data();
}

} // namespace

Subdivision::Subdivision(const Prim &mesh)
    : _scheme(readToken(mesh, "subdivisionScheme", schemeTokens, SKINSLIDE_SCHEME_CATMULL_CLARK)) {
    if (!any())
        return;
    _boundaryRule = readToken(mesh, "interpolateBoundary", boundaryRuleTokens, 0);
    _triangleRule = readToken(mesh, "triangleSubdivisionRule", triangleRuleTokens, 0);
    _creaseLengths = readIntegers(mesh, "creaseLengths");
    _creaseIndices = readIntegers(mesh, "creaseIndices");
    _creaseSharpnesses = readFloats(mesh, "creaseSharpnesses");
    _cornerIndices = readIntegers(mesh, "cornerIndices");
    _cornerSharpnesses = readFloats(mesh, "cornerSharpnesses");
    _holeIndices = readIntegers(mesh, "holeIndices");
    if (_cornerIndices.size() != _cornerSharpnesses.size())
        throw fault("corner sharpnesses: %zu values for %zu corners", _cornerSharpnesses.size(), _cornerIndices.size());
}

skinslide_subdivision Subdivision::native() const {
    skinslide_subdivision native = SKINSLIDE_SUBDIVISION_DEFAULT;
    native.scheme = static_cast<skinslide_scheme>(_scheme);
    native.boundary_rule = static_cast<skinslide_boundary_rule>(_boundaryRule);
    native.triangle_rule = static_cast<skinslide_triangle_rule>(_triangleRule);
    native.crease_count = static_cast<int32_t>(_creaseLengths.size());
    native.crease_index_count = static_cast<int32_t>(_creaseIndices.size());
    native.crease_sharpness_count = static_cast<int32_t>(_creaseSharpnesses.size());
    native.crease_lengths = pointerTo(_creaseLengths);
    native.crease_indices = pointerTo(_creaseIndices);
    native.crease_sharpnesses = pointerTo(_creaseSharpnesses);
    native.corner_count = static_cast<int32_t>(_cornerIndices.size());
    native.corner_indices = pointerTo(_cornerIndices);
    native.corner_sharpnesses = pointerTo(_cornerSharpnesses);
    native.hole_count = static_cast<int32_t>(_holeIndices.size());
    native.hole_indices = pointerTo(_holeIndices);
    return native;
}

} // namespace skinslide
