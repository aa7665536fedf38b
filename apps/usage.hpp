// Command lines that are wrong: ranges of numbers, and errors of one line.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <optional>
#include <string>
#include <type_traits>

#include "base/core/error.hpp"

namespace pliant::app {

/// The command that was given, or its subcommand, as in `calibrate tensile`; without one the program itself.
[[nodiscard]] const CLI::App& given_command(const CLI::App& app);

/// After parsing has failed: the first word that is neither a command nor an option of the program, options that stand
/// before the given command, or an option that it does not have, with what may have been meant; empty: it is another
/// mistake.
[[nodiscard]] std::optional<Error> misspelt(const CLI::App& app);

/// The error of CLI11 in one line that begins with the command.
[[nodiscard]] Error usage_error(const CLI::App& command, const CLI::ParseError& error);

/// Accepts numbers from `low` to `high`.
template <class Number>
[[nodiscard]] CLI::Validator between(Number low, Number high) {
    const auto check = [low, high](std::string& text) {
        Number value{};
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("write a {} from {} to {}, not {}", std::is_integral_v<Number> ? "whole number" : "number",
                           low, high, text);
    };
    return {check, fmt::format("{} in [{} - {}]", CLI::detail::type_name<Number>(), low, high)};
}

}  // namespace pliant::app
