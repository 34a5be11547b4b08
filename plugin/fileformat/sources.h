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

// The USDA text of a file as a layer: a new one each time, which nobody else has, and in which asset paths mean what they mean
// in the file. It has the given rate, or if that is 0 its own. Null where the text cannot be read; the error is posted.
//
// It is opened, with an argument of the file format, and not made anonymous and filled, since writing into an open layer sends
// notices. Sending one may free the listeners of stages that are gone: it then holds the lock of all listeners and waits for
// Python's, while a thread with Python's lock waits for that of the listeners. Opening a layer sends no notice.
SdfLayerRefPtr openText(const std::string &resolvedPath, double timeCodesPerSecond = 0);

// The text that openText() fills the layer with. Throws Fault where it is not USDA text.
std::string readText(const std::string &resolvedPath);

// An asset path, evaluated where it is an expression; empty where that fails.
std::string evaluate(const std::string &asset, const VtDictionary &variables);

// The resolved path of an asset; if there is none, the path where it would be, since a file that appears later is a change too.
std::string pathFor(const std::string &asset);

// Whether a path is that of a pipe, a socket or a device: opening it may never return.
bool isIrregular(const std::string &resolvedPath);

// A layer of any format; null where it cannot be opened. Throws Fault where it is irregular.
SdfLayerRefPtr openLayer(const std::string &identifier);

// What a layer leads to, through any number of others.
struct Sources {
    std::vector<SdfLayerRefPtr> layers; // those of other formats, nearest first
    std::set<std::string> paths;        // resolved, of every file, also of those that could not be read
};

// The text as openText() returns it. One without a rate gets that of its first source: it would count as 24 a second, and its
// sources would be scaled to that.
//
// Follows every composition arc, in the resolver context that is bound. Throws Fault where that leads back to a file that this
// thread is reading: opening a layer while it is being read waits for ever, so .skinslide files on the way are read as text and
// never opened.
// again  whether sources that are open already are read again if their files have changed, except those with unsaved edits,
//        which are for the user to discard
SdfLayerRefPtr openWithSources(const std::string &resolvedPath, bool again, Sources *sources);

} // namespace skinslide

#endif
