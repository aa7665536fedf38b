// A share as bytes, to be sent to its rank. All ranks run the same program on the same kind of machine, so numbers are
// written as they are in memory.
#pragma once

#include <string>

#include "simulation/distributed/share.hpp"

namespace pliant::sim::distributed {

[[nodiscard]] std::string packed(const Share& share);
/// Precondition: of packed().
[[nodiscard]] Share unpacked(const std::string& bytes);

}  // namespace pliant::sim::distributed
