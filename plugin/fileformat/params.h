// What a shot may set from outside: attributes of a prim that payloads a .skinslide file, or arguments of the file format.
#ifndef SKINSLIDE_FORMAT_PARAMS_H
#define SKINSLIDE_FORMAT_PARAMS_H

#include "pxr/pxr.h"

#include "pxr/base/tf/token.h"
#include "pxr/base/vt/value.h"
#include "pxr/usd/sdf/fileFormat.h"

#include "skinslide/stage.h"

#include <functional>
#include <string>
#include <vector>

namespace skinslide {
using namespace PXR_NS;

struct Params {
    bool computes = true;          // false: the layer is its text, with nothing computed
    bool readsOnly = false;        // nor is it composed: see openText()
    double timeCodesPerSecond = 0; // in place of none, where it is above 0
    skinslide_stage_live live = SKINSLIDE_STAGE_LIVE_DEFAULT;

    // Values that cannot be used are left out, and said in `problems`, which may be null.
    static Params fromArguments(const SdfFileFormat::FileFormatArguments &arguments, std::vector<std::string> *problems);

    // Of a text that is only read, other ones each time.
    static SdfFileFormat::FileFormatArguments argumentsOfText(double timeCodesPerSecond);

    using ComposeAttribute = std::function<bool(const TfToken &name, VtValue *value)>;
    // The arguments that a payload gets from the attributes of its prim; those that are not authored are left out. Values are
    // percent-encoded, as an identifier of a layer takes them as they are.
    static SdfFileFormat::FileFormatArguments argumentsFromAttributes(const ComposeAttribute &compose);
    static bool isAttribute(const TfToken &name);
};

} // namespace skinslide

#endif
