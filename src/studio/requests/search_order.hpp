// Search requests from a page: inputs that bring a marker somewhere, or parameters that explain measurements.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

/// An actuator that may be moved, in the display units of the page.
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

/// {"inputs": [{"name", "low", "high"}, ...], "side": 9, "between": 50}: the workspace of the markers.
struct WorkspaceOrder {
    std::vector<InputRange> inputs;  ///< at least one
    int side = 9;                    ///< samples along each input, 2 to 60
    int between = 50;                ///< 0 to 2000
};

/// A number of the robot file, by its key as for --set, and the values that it takes.
struct SweepAxis {
    std::string key;
    std::string unit;            ///< "" if dimensionless
    std::vector<double> values;  ///< at least one
};

/// {"axes": [{"key": "material.soft.youngs_modulus", "unit": "MPa", "values": [1, 2]}, ...]}, one or two of them.
struct SweepOrder {
    std::vector<SweepAxis> axes;
};

/// More runs than this are refused.
inline constexpr std::size_t most_sweep_runs = 400;

/// Errors name the key. Lists hold at most 256 entries.
[[nodiscard]] Result<GoalOrder> parse_goal_order(std::string_view json);
[[nodiscard]] Result<IdentifyOrder> parse_identify_order(std::string_view json);
[[nodiscard]] Result<WorkspaceOrder> parse_workspace_order(std::string_view json);
[[nodiscard]] Result<SweepOrder> parse_sweep_order(std::string_view json);

}  // namespace pliant::studio
