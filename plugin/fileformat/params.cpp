#include "params.h"

#include "names.h"

#include "pxr/base/tf/diagnostic.h"
#include "pxr/base/tf/stringUtils.h"
#include "pxr/usd/sdf/types.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace skinslide {
namespace {

bool isPlain(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+' || c == '_';
}

std::string encode(const std::string &value) {
    std::string encoded;
    for (char c : value)
        encoded += isPlain(c) ? std::string(1, c) : TfStringPrintf("%%%02X", static_cast<unsigned char>(c));
    return encoded;
}

std::string decode(const std::string &encoded) {
    std::string value;
    for (size_t i = 0; i < encoded.size(); i++) {
        bool escaped = encoded[i] == '%' && i + 2 < encoded.size() &&
                       std::isxdigit(static_cast<unsigned char>(encoded[i + 1])) &&
                       std::isxdigit(static_cast<unsigned char>(encoded[i + 2]));
        value += escaped ? static_cast<char>(std::stoi(encoded.substr(i + 1, 2), nullptr, 16)) : encoded[i];
        i += escaped ? 2 : 0;
    }
    return value;
}

std::string choices(const std::vector<std::string> &tokens) {
    return TfStringJoin(tokens.begin(), tokens.end(), ", ");
}

void takeToken(const std::string &name, const std::string &value, const std::vector<std::string> &allowed, std::string *token,
               std::vector<std::string> *problems) {
    if (std::find(allowed.begin(), allowed.end(), value) != allowed.end())
        *token = value;
    else
        problems->push_back(TfStringPrintf("skinSlide:live:%s is '%s'; it must be one of %s", name.c_str(), value.c_str(),
                                           choices(allowed).c_str()));
}

void takeEnvelope(const std::string &value, double *envelope, std::vector<std::string> *problems) {
    double number = 0;
    auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error == std::errc() && end == value.data() + value.size() && std::isfinite(number))
        *envelope = number;
    else
        problems->push_back(TfStringPrintf("skinSlide:live:envelope is '%s'; it must be a number", value.c_str()));
}

// Said where the prim is composed, as no argument could tell.
void sayType(const TfToken &attribute, const VtValue &value, const char *wanted) {
    if (!value.IsHolding<SdfValueBlock>())
        TF_WARN("%s is a %s; it must be %s", attribute.GetText(), value.GetTypeName().c_str(), wanted);
}

void addEnvelope(const Params::ComposeAttribute &compose, SdfFileFormat::FileFormatArguments *arguments) {
    VtValue value;
    if (!compose(names().liveEnvelope, &value) || value.IsEmpty())
        return;
    if (value.CanCast<double>())
        (*arguments)[names().envelopeArgument] = encode(TfStringify(value.Cast<double>().Get<double>()));
    else
        sayType(names().liveEnvelope, value, "a number");
}

void addToken(const TfToken &attribute, const std::string &argument, const Params::ComposeAttribute &compose,
              SdfFileFormat::FileFormatArguments *arguments) {
    VtValue value;
    if (!compose(attribute, &value) || value.IsEmpty())
        return;
    if (value.IsHolding<TfToken>())
        (*arguments)[argument] = encode(value.UncheckedGet<TfToken>().GetString());
    else if (value.IsHolding<std::string>())
        (*arguments)[argument] = encode(value.UncheckedGet<std::string>());
    else
        sayType(attribute, value, "a token");
}

} // namespace

Params Params::fromArguments(const SdfFileFormat::FileFormatArguments &arguments, std::vector<std::string> *problems) {
    Params params;
    auto given = [&](const std::string &name, std::string *value) {
        auto found = arguments.find(name);
        *value = found == arguments.end() ? "" : decode(found->second);
        return found != arguments.end();
    };
    std::string value;
    if (given(names().liveArgument, &value))
        params.live = value != "0";
    if (given(names().envelopeArgument, &value))
        takeEnvelope(value, &params.envelope, problems);
    if (given(names().interpolationArgument, &value))
        takeToken("interpolation", value, interpolationTokens, &params.interpolation, problems);
    if (given(names().lookupArgument, &value))
        takeToken("lookup", value, lookupTokens, &params.lookup, problems);
    return params;
}

SdfFileFormat::FileFormatArguments Params::argumentsFromAttributes(const ComposeAttribute &compose) {
    SdfFileFormat::FileFormatArguments arguments;
    addEnvelope(compose, &arguments);
    addToken(names().liveInterpolation, names().interpolationArgument, compose, &arguments);
    addToken(names().liveLookup, names().lookupArgument, compose, &arguments);
    return arguments;
}

bool Params::isAttribute(const TfToken &name) {
    return name == names().liveEnvelope || name == names().liveInterpolation || name == names().liveLookup;
}

} // namespace skinslide
