// The text of a .skinslide file, and the layers that it leads to.
#ifndef SKINSLIDE_FORMAT_SOURCES_H
#define SKINSLIDE_FORMAT_SOURCES_H

#include "pxr/pxr.h"

#include "pxr/base/vt/dictionary.h"
#include "pxr/usd/sdf/layer.h"

#include <set>
#include <string>
#include <vector>

namespace skinslide {
using namespace PXR_NS;

// The USDA text of a file as an anonymous layer, as it stands. Throws Fault where it is not USDA text.
SdfLayerRefPtr readText(const std::string &resolvedPath);

// An asset path, evaluated where it is an expression; empty where that fails.
std::string evaluate(const std::string &asset, const VtDictionary &variables);

// A copy in which relative asset paths mean what they mean in the file: in an anonymous layer they mean nothing.
SdfLayerRefPtr anchoredCopy(const SdfLayerRefPtr &text, const std::string &resolvedPath);

// What a layer leads to, through any number of others.
struct Sources {
    std::vector<SdfLayerRefPtr> layers; // those of other formats, nearest first
    std::set<std::string> paths;        // resolved, of every file, also of those that could not be read
};

// Follows every composition arc of a file's text, in the resolver context that is bound. Throws Fault where it leads back to a
// file that this thread is reading: a layer that is opened while it is being read waits for itself for ever, so .skinslide
// files on the way are read as text and never opened.
Sources findSources(const SdfLayerRefPtr &text, const std::string &resolvedPath);

// A layer without a rate counts as 24 a second, and what it leads to is scaled to that: gives it the rate of the first source.
void adoptRate(const SdfLayerRefPtr &layer, const Sources &sources);

} // namespace skinslide

#endif
