// Minimum-degree ordering of a few nodes.
#pragma once

#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

/// Two adjacent nodes, one of which is not eliminated.
struct Rim {
    int outside, node;
};

/// The nodes of a graph ordered by minimum degree (Tinney and Walker 1967); nodes outside of it count as neighbours and
/// are not eliminated. Degrees are exact, held in bit sets: for up to a few hundred nodes.
[[nodiscard]] std::vector<int> by_minimum_degree(const Graph& graph, std::vector<Rim> rim);

}  // namespace pliant::linalg
