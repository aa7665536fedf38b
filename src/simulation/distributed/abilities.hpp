// What pliant-mpi does not support.
#pragma once

#include "base/core/error.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim::distributed {

/// An error names the first key that is not supported.
[[nodiscard]] Status check_able(const Description& description, const Program& program);

}  // namespace pliant::sim::distributed
