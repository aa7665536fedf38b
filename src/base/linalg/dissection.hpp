// Nested dissection: in which order the nodes of a graph are eliminated so that little fills.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

/// Where each node comes. `points` (nodes, or none): where the nodes are in space, in any unit. Nodes are cut in two by
/// the plane that leaves the least to do (George 1973; planes as Heath and Raghavan 1995), and the two parts again;
/// without points, by the distance along edges from a few nodes that are far apart. Takes a fifth to a third of the
/// time of METIS, and fills as little (docs/decisions/0012); on all cores, the same order on any number of them.
[[nodiscard]] std::vector<int> dissect(const Graph& graph, std::span<const std::array<double, 3>> points = {});

}  // namespace pliant::linalg
