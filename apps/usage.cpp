#include "usage.hpp"

#include <CLI/Error.hpp>
#include <string_view>

namespace pliant::app {
namespace {

/// "pliant calibrate tensile".
std::string full_name(const CLI::App& command) {
    const CLI::App* const above = command.get_parent();
    return above == nullptr ? command.get_name() : full_name(*above) + " " + command.get_name();
}

/// "--speed = fast" as CLI11 shows it.
std::string not_converted(std::string_view shown) {
    const std::size_t sign = shown.find(" = ");
    if (sign == std::string_view::npos) return std::string(shown) + ": is not a number";
    return fmt::format("{}: write a number, not {}", shown.substr(0, sign), shown.substr(sign + 3));
}

std::string reason_of(const CLI::App& command, const CLI::ParseError& error) {
    const std::string_view text = error.what();
    constexpr std::string_view conversion = "Could not convert: ";
    if (text.starts_with(conversion)) return not_converted(text.substr(conversion.size()));
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !command.remaining().empty())
        return fmt::format("\"{}\" is one word too many", command.remaining().front());
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && text.ends_with(" missing"))
        return std::string(text.substr(0, text.find(':'))) + " needs a value";
    return std::string(text);
}

}  // namespace

Error usage_error(const CLI::App& command, const CLI::ParseError& error) {
    const std::string name = full_name(command), reason = reason_of(command, error);
    const bool is_value = dynamic_cast<const CLI::ValidationError*>(&error) != nullptr ||
                          dynamic_cast<const CLI::ConversionError*>(&error) != nullptr;  // says what would be right
    return {Cause::input, is_value ? fmt::format("{}: {}", name, reason)
                                   : fmt::format("{}: {}; {} --help lists what it takes", name, reason, name)};
}

}  // namespace pliant::app
