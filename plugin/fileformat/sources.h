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

// The USDA text of a file, as it stands or, where one is given, with a rate: a layer that is new each time, nobody else's, and
// whose asset paths mean what they mean in the file. Null where the text cannot be read; the error is raised.
//
// It is opened, by an argument of the file format, for what is written into a layer that is open is announced. A thread that
// announces something may have to free the listeners of stages that are gone: with the lock of all listeners it then waits for
// Python's, while a thread that has Python's waits for that of the listeners. Opening a layer announces nothing.
SdfLayerRefPtr openText(const std::string &resolvedPath, double timeCodesPerSecond = 0);

// What it is then filled with. Throws Fault where it is not USDA text.
std::string readText(const std::string &resolvedPath);

// An asset path, evaluated where it is an expression; empty where that fails.
std::string evaluate(const std::string &asset, const VtDictionary &variables);

// The path of an asset, resolved: where it would be, where nothing is there, for a file that appears later is a change too.
std::string pathFor(const std::string &asset);

// Whether a path is of a pipe, a socket or a device: opened, it may be waited for without end.
bool isIrregular(const std::string &resolvedPath);

// A layer of any format; null where it cannot be opened. Throws Fault where it is irregular.
SdfLayerRefPtr openLayer(const std::string &identifier);

// What a layer leads to, through any number of others.
struct Sources {
    std::vector<SdfLayerRefPtr> layers; // those of other formats, nearest first
    std::set<std::string> paths;        // resolved, of every file, also of those that could not be read
};

// The text as openText() gives it, but with the rate of the first source where it has none: it would count as 24 a second, and
// what it leads to would be scaled to that.
//
// Follows every composition arc, in the resolver context that is bound. Throws Fault where it leads back to a file that this
// thread is reading: a layer that is opened while it is being read waits for itself for ever, so .skinslide files on the way
// are read as text and never opened.
// again  whether sources that are open already are read again where their files changed; but not those with unsaved edits,
//        which are the user's to throw away
SdfLayerRefPtr openWithSources(const std::string &resolvedPath, bool again, Sources *sources);

} // namespace skinslide

#endif
