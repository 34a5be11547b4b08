#include "cycle.h"

#include "fault.h"

#include "pxr/base/tf/pathUtils.h"

#include <algorithm>
#include <vector>

namespace skinslide {
namespace {

thread_local std::vector<std::string> files;

// What is inside a package has no path of its own in the file system.
std::string fileAt(const std::string &resolvedPath) {
    std::string real = TfRealPath(resolvedPath);
    return real.empty() ? resolvedPath : real;
}

} // namespace

Reading::Reading(const std::string &resolvedPath) {
    refuse(resolvedPath);
    if (files.size() >= mostAtOnce)
        throw fault("is reached through %zu .skinslide files, one after another; longer chains are not read", mostAtOnce);
    files.push_back(fileAt(resolvedPath));
}

Reading::~Reading() {
    files.pop_back();
}

void Reading::refuse(const std::string &resolvedPath) {
    if (isRead(resolvedPath))
        throw Fault("leads back to itself");
}

bool Reading::isRead(const std::string &resolvedPath) {
    return !files.empty() && std::find(files.begin(), files.end(), fileAt(resolvedPath)) != files.end();
}

} // namespace skinslide
