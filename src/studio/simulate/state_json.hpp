// A state of a robot as the JSON head of a frame.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "simulation/run/trajectory.hpp"

namespace pliant::studio {

/// time, residual, min_J, energy_mJ, cables, chambers, markers, supports, contacts (obstacles, then objects: N),
/// self_contact_N; docs/reference/studio.md.
[[nodiscard]] nlohmann::json state_json(const sim::Step& step);

}  // namespace pliant::studio
