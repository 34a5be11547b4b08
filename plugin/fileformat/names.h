// The names of SkinSlideAPI and of what it reads and writes on a mesh, and the fallbacks that its schema declares.
#ifndef SKINSLIDE_FORMAT_NAMES_H
#define SKINSLIDE_FORMAT_NAMES_H

#include "pxr/pxr.h"

#include "pxr/base/tf/token.h"

#include <string>
#include <vector>

namespace skinslide {
using namespace PXR_NS;

struct Names {
    const std::string schemaPrefix{"SkinSlideAPI:"};
    const std::string nameSpace{"skinSlide:"};
    const std::string primvars{"primvars:"};

    const TfToken mesh{"Mesh"}, geomSubset{"GeomSubset"}, pointInstancer{"PointInstancer"};
    const TfToken points{"points"}, extent{"extent"}, velocities{"velocities"}, accelerations{"accelerations"};
    const TfToken normals{"normals"}, normalsPrimvar{"primvars:normals"};
    const TfToken faceCounts{"faceVertexCounts"}, faceIndices{"faceVertexIndices"}, orientation{"orientation"};
    const TfToken indices{"indices"}, elementType{"elementType"}, face{"face"}, leftHanded{"leftHanded"};
    const TfToken prototypes{"prototypes"};
    const TfToken jointIndices{"primvars:skel:jointIndices"}, blendShapes{"skel:blendShapeTargets"};
    const TfToken interpolation{"interpolation"}, apiSchemas{"apiSchemas"}, clips{"clips"};
    const TfToken vertex{"vertex"}, varying{"varying"}, uniform{"uniform"}, faceVarying{"faceVarying"}, constant{"constant"};

    // Where rest points are looked for, before the default value of points.
    const TfToken restPoints{"skinSlide:restPoints"};
    const std::vector<TfToken> restPrimvars{TfToken("primvars:rest"), TfToken("primvars:pref"), TfToken("primvars:Pref"),
                                            TfToken("primvars:__Pref")};

    // On a prim that payloads a .skinslide file, and the arguments of the format that they become.
    const TfToken liveEnvelope{"skinSlide:live:envelope"}, liveInterpolation{"skinSlide:live:interpolation"},
        liveLookup{"skinSlide:live:lookup"};
    const std::string envelopeArgument{"envelope"}, interpolationArgument{"interpolation"}, lookupArgument{"lookup"},
        liveArgument{"live"};

    // skinSlide:PATCH:NAME
    TfToken property(const std::string &patch, const char *name) const {
        return TfToken(nameSpace + patch + ":" + name);
    }
    // primvars:skinSlide:PATCH:NAME
    TfToken primvar(const std::string &patch, const char *name) const {
        return TfToken(primvars + nameSpace + patch + ":" + name);
    }
};

inline const Names &names() {
    static const Names all;
    return all;
}

// Tokens in the order of the core's enums.
inline const std::vector<std::string> boundaryTokens{"auto", "square", "circle"};
inline const std::vector<std::string> holesTokens{"pinned", "free"};
inline const std::vector<std::string> ruleTokens{"unit", "fast", "relaxed"};
inline const std::vector<std::string> interpolationTokens{"auto", "linear", "meanValue", "limit"};
inline const std::vector<std::string> schemeTokens{"none", "catmullClark", "loop", "bilinear"};
inline const std::vector<std::string> boundaryRuleTokens{"edgeAndCorner", "edgeOnly", "none"};
inline const std::vector<std::string> triangleRuleTokens{"catmullClark", "smooth"};
inline const std::vector<std::string> lookupTokens{"auto", "egl", "exact"};

} // namespace skinslide

#endif
