// What is wrong with a value, thrown by code that does not know for which layer, prim, patch and frame it reads it.
#ifndef SKINSLIDE_FORMAT_FAULT_H
#define SKINSLIDE_FORMAT_FAULT_H

#include "pxr/pxr.h"

#include "pxr/base/tf/stringUtils.h"

#include <stdexcept>

namespace skinslide {
using namespace PXR_NS;

class Fault : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// throw fault("%s has %zu values", ...)
template <class... Arguments> Fault fault(const char *format, Arguments... arguments) {
    return Fault(TfStringPrintf(format, arguments...));
}

} // namespace skinslide

#endif
