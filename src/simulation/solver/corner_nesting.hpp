// The linear tets nested in quadratic ones.
#pragma once

#include <optional>

#include "base/linalg/nested_space.hpp"
#include "simulation/model/model.hpp"

namespace pliant::sim {

/// For the free nodes: those between two corners of a quadratic tet are nested in these, all others in themselves.
/// Empty for linear tets.
[[nodiscard]] std::optional<linalg::Nesting> nest_in_corners(const Model& model);

}  // namespace pliant::sim
