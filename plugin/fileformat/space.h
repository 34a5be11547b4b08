// Where a prim is: the transforms above it, composed as Usd composes them.
#ifndef SKINSLIDE_FORMAT_SPACE_H
#define SKINSLIDE_FORMAT_SPACE_H

#include "compose.h"

#include "pxr/base/gf/matrix4d.h"

#include <string>
#include <vector>

namespace skinslide {

// The way of a prim to the world over time: points are rows. Operations that Usd would not know count for nothing. Composed
// once, and free of the composition.
class ToWorld {
  public:
    ToWorld(Composition &composition, const SdfPath &path);

    GfMatrix4d at(double time) const;
    std::vector<double> times() const; // at which any transform above the prim, or its own, was authored: ascending, each once

  private:
    // One operation of a prim's.
    struct Step {
        Attribute attribute;
        std::string type; // "rotateXYZ" of "xformOp:rotateXYZ:tail"
        bool inverted;
    };
    static std::vector<Step> steps(const Prim &prim, bool *resets);

    std::vector<std::vector<Step>> _locals; // of each prim, from the world, or from what begins in it again, on
};

} // namespace skinslide

#endif
