// The same fields of elements alone: of a part of a robot.
#pragma once

#include <span>

#include "simulation/elements/elements.hpp"
#include "simulation/run/fields.hpp"

namespace pliant::sim {

/// `x` (3n) node positions in metres.
[[nodiscard]] Fields fields_of(const Elements& elements, std::span<const double> x);

}  // namespace pliant::sim
