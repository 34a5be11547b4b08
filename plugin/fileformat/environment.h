// Whole numbers from the environment.
#ifndef SKINSLIDE_FORMAT_ENVIRONMENT_H
#define SKINSLIDE_FORMAT_ENVIRONMENT_H

namespace skinslide {

// Throws Fault, which names the variable, where it is set to anything but a whole number from 0 on that an int can hold.
int countFromEnvironment(const char *variable, int fallback);

} // namespace skinslide

#endif
