// The files that textures are made of: resolved and read, as the core asks for them.
#ifndef SKINSLIDE_FORMAT_TEXTURES_H
#define SKINSLIDE_FORMAT_TEXTURES_H

#include "values.h"

#include <set>

namespace skinslide {

// Gives every file that is asked for, and adds its path, resolved, to `files`, which may be null. Throws Fault.
void giveFiles(skinslide_stage_controls *controls, std::set<std::string> *files);

// Adds the file that a texture names at a time, where it has no tiles, be it there or not.
void addUntiled(const Property &texture, double time, std::set<std::string> *files);

} // namespace skinslide

#endif
