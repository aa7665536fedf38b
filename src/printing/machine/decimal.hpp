// Short decimal notation of numbers, for people and firmware.
#pragma once

#include <fmt/format.h>

#include <string>

namespace pliant::machine {

/// With at most four decimals, and no trailing zeros.
[[nodiscard]] inline std::string decimal(double value) {
    std::string text = fmt::format("{:.4f}", value);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

}  // namespace pliant::machine
