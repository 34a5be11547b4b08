// How a mesh is subdivided: scheme, creases, corners, holes and rules, as UsdGeomMesh has them.
#ifndef SKINSLIDE_FORMAT_SUBDIVISION_H
#define SKINSLIDE_FORMAT_SUBDIVISION_H

#include "values.h"

#include "skinslide/skinslide.h"

namespace skinslide {

class Subdivision {
  public:
    Subdivision() = default; // none: the mesh renders as its faces
    // Throws Fault. The core checks how the arrays fit each other and the mesh.
    explicit Subdivision(const Prim &mesh);

    bool any() const {
        return _scheme != SKINSLIDE_SCHEME_NONE;
    }
    skinslide_subdivision native() const; // points into this

  private:
    int _scheme = SKINSLIDE_SCHEME_NONE, _boundaryRule = 0, _triangleRule = 0;
    std::vector<int32_t> _creaseLengths, _creaseIndices, _cornerIndices, _holeIndices;
    std::vector<float> _creaseSharpnesses, _cornerSharpnesses;
};

} // namespace skinslide

#endif
