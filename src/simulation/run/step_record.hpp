// Serialises a step of a trajectory.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim {

struct StepRecord {
    Step step;
    std::vector<IterationRecord> iterations;  ///< iterations of that step
};

[[nodiscard]] std::string step_bytes(const Step& step, std::span<const IterationRecord> iterations);
/// Errors: damaged, or not for `nodes` nodes.
[[nodiscard]] Result<StepRecord> step_from_bytes(std::string_view bytes, std::size_t nodes);

}  // namespace pliant::sim
