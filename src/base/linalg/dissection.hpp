// Nested dissection: a fill-reducing elimination order for the nodes of a graph.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

/// The position of each node in the order. `points` (nodes, or none): where the nodes are in space, in any unit. The
/// nodes are split recursively by the plane with the least elimination work (George 1973; planes as Heath and Raghavan
/// 1995); without points, by the distance along edges from a few nodes that are far apart. Takes a fifth to a third of
/// the time of METIS with as little fill (docs/decisions/0012); on all cores, the same order on any number of them.
[[nodiscard]] std::vector<int> dissect(const Graph& graph, std::span<const std::array<double, 3>> points = {});

}  // namespace pliant::linalg
