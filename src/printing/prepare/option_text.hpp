// Parses options of a slice as numbers.
#pragma once

#include <string>

#include "base/core/error.hpp"

namespace pliant::prepare {

/// A length with its unit, in micrometres; `otherwise` if the text is empty. Errors name the option.
[[nodiscard]] Result<double> length_um(const char* option, const std::string& text, double otherwise);

/// The same, from `least_um` to `most_um`.
[[nodiscard]] Result<double> length_um(const char* option, const std::string& text, double otherwise, double least_um,
                                       double most_um);

/// A whole number of micrometres from 1 to 1000.
[[nodiscard]] Result<int> layer_height_um(const char* option, const std::string& text);

/// A non-negative integer with nothing around it; -1 for anything else.
[[nodiscard]] int plain_number(const std::string& text);

/// A number with nothing around it. Errors: anything else, infinity included.
[[nodiscard]] Result<double> plain_degrees(const char* option, const std::string& text);

}  // namespace pliant::prepare
