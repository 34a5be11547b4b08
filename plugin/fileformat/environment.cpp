#include "environment.h"

#include "fault.h"

#include "pxr/base/tf/getenv.h"

#include <charconv>

namespace skinslide {

int countFromEnvironment(const char *variable, int fallback) {
    std::string text = TfGetenv(variable);
    if (text.empty())
        return fallback;
    int count = 0;
    auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error == std::errc::result_out_of_range)
        throw fault("%s: '%s' is too large", variable, text.c_str());
    if (error != std::errc() || end != text.data() + text.size() || count < 0)
        throw fault("%s: '%s' is not a whole number from 0 on", variable, text.c_str());
    return count;
}

} // namespace skinslide
