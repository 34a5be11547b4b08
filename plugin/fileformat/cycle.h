// The .skinslide files that the running thread is reading: reading one opens those that it leads to, which are read in turn.
#ifndef SKINSLIDE_FORMAT_CYCLE_H
#define SKINSLIDE_FORMAT_CYCLE_H

#include <cstddef>
#include <string>

namespace skinslide {

// A file is being read for as long as this lives.
class Reading {
  public:
    static constexpr size_t mostAtOnce = 32;

    // Throws Fault where the thread is reading the file already, or too many.
    explicit Reading(const std::string &resolvedPath);
    ~Reading();
    Reading(const Reading &) = delete;
    Reading &operator=(const Reading &) = delete;

    // Throws Fault where the thread is reading the file.
    static void refuse(const std::string &resolvedPath);
    // Whether the thread is reading a file, by whatever path: a folder that links to itself gives each file any number of them.
    static bool isRead(const std::string &resolvedPath);
};

} // namespace skinslide

#endif
