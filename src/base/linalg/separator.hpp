// Vertex separators: nodes of a graph whose removal disconnects its two sides.
#pragma once

#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

enum class Side : char { left, right, separator };

/// Shrinks a separator by exchanging some of its nodes for fewer neighbours on one side, until no exchange helps; no
/// side drops below `least` nodes. Precondition: no left node is adjacent to a right one; this is maintained. Ashcraft
/// and Liu 1998, "Applications of the Dulmage-Mendelsohn decomposition and network flow to graph bisection
/// improvement".
void shrink_separator(const Graph& graph, std::vector<Side>& sides, int least);

}  // namespace pliant::linalg
