// The checks of a model without the model: of what becomes many models, each of a part.
#pragma once

#include "base/core/error.hpp"
#include "simulation/model/held_nodes.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// What Model::create() refuses, but for flat tets, is an error here too; else which nodes are held.
[[nodiscard]] Result<HeldNodes> check(const Description& description);

}  // namespace pliant::sim
