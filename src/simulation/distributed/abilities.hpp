// What a robot may not ask of many ranks.
#pragma once

#include "base/core/error.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim::distributed {

/// An error names the first key that pliant-mpi does not know what to do with.
[[nodiscard]] Status check_able(const Description& description, const Program& program);

}  // namespace pliant::sim::distributed
