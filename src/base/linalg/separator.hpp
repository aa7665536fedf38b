// Separators: nodes of a graph without which two sides of it do not touch.
#pragma once

#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

enum class Side : char { left, right, separator };

/// Makes a separator smaller where nodes of it can be exchanged for fewer neighbours on one side, until none can; no
/// side gets smaller than `least` nodes by it. Precondition: no left node is next to a right one, which stays so.
/// Ashcraft and Liu 1998, "Applications of the Dulmage-Mendelsohn decomposition and network flow to graph bisection
/// improvement".
void shrink_separator(const Graph& graph, std::vector<Side>& sides, int least);

}  // namespace pliant::linalg
