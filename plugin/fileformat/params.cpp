#include "params.h"

#include "values.h"

#include "pxr/base/tf/diagnostic.h"
#include "pxr/base/tf/stringUtils.h"
#include "pxr/usd/sdf/types.h"

#include <atomic>
#include <cctype>
#include <charconv>

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

const std::string computesArgument = "live", textArgument = "text", rateArgument = "rate";

// The inputs of the core that are live: each is an argument by its name alone.
template <class Visit> void forEachInput(Visit visit) {
    const skinslide_stage_input *input = nullptr;
    while ((input = skinslide_stage_next_input(SKINSLIDE_STAGE_LIVE, input)))
        visit(input);
}

TfToken attributeOf(const skinslide_stage_input *input) {
    return TfToken(std::string(input->prefix) + input->name);
}

// A number where the text is one and a number is wanted.
VtValue valueOf(const skinslide_stage_input *input, const std::string &text) {
    double number = 0;
    auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    bool isNumber = !input->tokens && error == std::errc() && end == text.data() + text.size();
    return isNumber ? VtValue(number) : VtValue(text);
}

// Text for an argument; false for what has none.
bool textOf(const VtValue &value, std::string *text) {
    const VtValue number = VtValue::Cast<double>(value);
    if (value.IsHolding<TfToken>())
        *text = value.UncheckedGet<TfToken>().GetString();
    else if (value.IsHolding<std::string>())
        *text = value.UncheckedGet<std::string>();
    else if (!number.IsEmpty())
        *text = TfStringify(number.UncheckedGet<double>());
    else
        return false;
    return true;
}

} // namespace

Params Params::fromArguments(const SdfFileFormat::FileFormatArguments &arguments, std::vector<std::string> *problems) {
    Params params;
    auto computes = arguments.find(computesArgument);
    params.computes = computes == arguments.end() || decode(computes->second) != "0";
    params.readsOnly = arguments.count(textArgument) > 0;
    auto rate = arguments.find(rateArgument);
    if (rate != arguments.end())
        params.timeCodesPerSecond = TfUnstringify<double>(rate->second);
    forEachInput([&](const skinslide_stage_input *input) {
        auto given = arguments.find(input->name);
        if (given == arguments.end())
            return;
        try {
            Record record(attributeOf(input).GetString(), valueOf(input, decode(given->second)));
            call(skinslide_stage_live_take, &params.live, input, record);
        } catch (const Fault &bad) {
            if (problems)
                problems->push_back(bad.what());
        }
    });
    return params;
}

SdfFileFormat::FileFormatArguments Params::argumentsOfText(double timeCodesPerSecond) {
    static std::atomic<uint64_t> count{0};
    SdfFileFormat::FileFormatArguments arguments{{computesArgument, "0"}, {textArgument, std::to_string(++count)}};
    if (timeCodesPerSecond > 0)
        arguments[rateArgument] = TfStringify(timeCodesPerSecond);
    return arguments;
}

SdfFileFormat::FileFormatArguments Params::argumentsFromAttributes(const ComposeAttribute &compose) {
    SdfFileFormat::FileFormatArguments arguments;
    forEachInput([&](const skinslide_stage_input *input) {
        VtValue value;
        std::string text;
        if (!compose(attributeOf(input), &value) || value.IsEmpty() || value.IsHolding<SdfValueBlock>())
            return;
        if (textOf(value, &text)) {
            arguments[input->name] = encode(text);
            return;
        }
        try { // said here, as no argument could tell
            skinslide_stage_live unused = SKINSLIDE_STAGE_LIVE_DEFAULT;
            call(skinslide_stage_live_take, &unused, input, Record(attributeOf(input).GetString(), value));
        } catch (const Fault &bad) {
            TF_WARN("%s", bad.what());
        }
    });
    return arguments;
}

bool Params::isAttribute(const TfToken &name) {
    bool is = false;
    forEachInput([&](const skinslide_stage_input *input) { is = is || name == attributeOf(input); });
    return is;
}

} // namespace skinslide
