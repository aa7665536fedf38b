// The values of a key: listed, or from a range.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/config.hpp"

namespace pliant::study {

/// "12.5 MPa" as 12.5 and "MPa"; a pure number has no unit. Nothing if the text is not a finite number, alone or before
/// one unit.
struct Measure {
    double number = 0;
    std::string unit;
    std::string written{};  ///< the number as it stands in the text, such as "001"
    std::string gap{};      ///< what stands between the two
};
[[nodiscard]] std::optional<Measure> read_measure(std::string_view text);

/// The shortest text that parses to the same number.
[[nodiscard]] std::string number_text(double number);

/// The values of a key as given in its table of the study file.
struct Choice {
    std::vector<std::string> values;  ///< listed, as written, without the common unit; if empty, from `low` to `high`
    double low = 0, high = 0;
    std::string unit;
    std::string gap = " ";  ///< between a value and its unit
    bool numeric = true;
    bool log = false;    ///< equal ratios instead of equal steps
    bool whole = false;  ///< rounded to integers, all equally likely
    int levels = 0;      ///< of a grid; 0: not given
};

/// Reads range, scale, whole, levels or values from a key's table; mistakes become problems of the reader.
[[nodiscard]] Choice read_choice(config::Reader& table);

/// The value for u in [0, 1): along the range, or one of the list.
[[nodiscard]] std::string value_at(const Choice& choice, double u);
/// The levels of a grid, from end to end.
[[nodiscard]] std::vector<std::string> levels_of(const Choice& choice);

}  // namespace pliant::study
