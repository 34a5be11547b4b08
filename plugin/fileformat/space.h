// Where a prim is: the transforms above it, composed as Usd composes them.
#ifndef SKINSLIDE_FORMAT_SPACE_H
#define SKINSLIDE_FORMAT_SPACE_H

#include "compose.h"

#include "pxr/base/gf/matrix4d.h"

#include <vector>

namespace skinslide {

// The way of a prim to the world at a time: points are rows. Operations that Usd would not know count for nothing.
GfMatrix4d toWorld(Composition &composition, const SdfPath &path, double time);

// When any transform above a prim, or its own, was authored: ascending, each once.
std::vector<double> toWorldTimes(Composition &composition, const SdfPath &path);

} // namespace skinslide

#endif
