// The names of USD that this reader itself needs. Those of what it reads are the core's to ask for.
#ifndef SKINSLIDE_FORMAT_NAMES_H
#define SKINSLIDE_FORMAT_NAMES_H

#include "pxr/pxr.h"

#include "pxr/base/tf/token.h"

namespace skinslide {
using namespace PXR_NS;

struct Names {
    const TfToken mesh{"Mesh"}, geomSubset{"GeomSubset"}, pointInstancer{"PointInstancer"};
    const TfToken points{"points"}, extent{"extent"}, indices{"indices"}, elementType{"elementType"};
    const TfToken prototypes{"prototypes"}, apiSchemas{"apiSchemas"}, clips{"clips"};
    const TfToken spline{"spline"}; // a field that USD has since 25.05: before, there is none of that name
    const TfToken jointIndices{"primvars:skel:jointIndices"}, jointWeights{"primvars:skel:jointWeights"};
    const TfToken blendShapes{"skel:blendShapeTargets"}, boundSkeleton{"skel:skeleton"};
    const TfToken skelRoot{"SkelRoot"}, skeleton{"Skeleton"};
    const TfToken xformOpOrder{"xformOpOrder"};
    const TfToken interpolation{"interpolation"}, constant{"constant"}, elementSize{"elementSize"};
};

inline const Names &names() {
    static const Names all;
    return all;
}

} // namespace skinslide

#endif
