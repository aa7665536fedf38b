// The values that a key takes: listed, or from a range.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/config.hpp"

namespace pliant::study {

/// "12.5 MPa" as 12.5 and "MPa"; a pure number has no unit. Nothing where the text is no finite number with at most one
/// word behind it.
struct Measure {
    double number = 0;
    std::string unit;
};
[[nodiscard]] std::optional<Measure> read_measure(std::string_view text);

/// The shortest text that reads as the same number.
[[nodiscard]] std::string number_text(double number);

/// What a key's table in the study file says about its values.
struct Choice {
    std::vector<std::string> values;  ///< listed ones, without the common unit; else from `low` to `high`
    double low = 0, high = 0;
    std::string unit;
    bool numeric = true;
    bool log = false;    ///< equal ratios instead of equal steps
    bool whole = false;  ///< rounded to whole numbers, all equally likely
    int levels = 0;      ///< of a grid; 0: not said
};

/// Reads range, scale, whole, levels or values of a key's table; mistakes become problems of the reader.
[[nodiscard]] Choice read_choice(config::Reader& table);

/// The value for u in [0, 1): along the range, or one of the listed.
[[nodiscard]] std::string value_at(const Choice& choice, double u);
/// The levels of a grid, from end to end.
[[nodiscard]] std::vector<std::string> levels_of(const Choice& choice);

}  // namespace pliant::study
