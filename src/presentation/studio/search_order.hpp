// What a page asks the studio to look for: inputs that bring a marker somewhere, or numbers that explain measurements.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

/// An actuator that may be moved, in the units that the page shows it in.
struct InputRange {
    std::string name;
    double low = 0, high = 0;
};

/// {"marker": "tip", "path": [[x, y, z], ...], "tolerance": 0.1, "inputs": [{"name", "low", "high"}, ...]}, mm.
struct GoalOrder {
    std::string marker;
    std::vector<std::array<double, 3>> path_mm;  ///< at least one
    double tolerance_mm = 0.1;                   ///< above zero
    std::vector<InputRange> inputs;              ///< at least one
};

/// {"unknowns": ["material.soft.youngs_modulus", ...], "csv": "...", "file": "measured.csv", "judge": "every-second"}
struct IdentifyOrder {
    std::vector<std::string> unknowns;  ///< keys, or KEY=LOW..HIGH; at least one
    std::string csv, file;
    std::string judge;  ///< "", "every-second" or "second-half"
};

/// Errors name the key. Lists hold at most 256 entries.
[[nodiscard]] Result<GoalOrder> parse_goal_order(std::string_view json);
[[nodiscard]] Result<IdentifyOrder> parse_identify_order(std::string_view json);

}  // namespace pliant::studio
