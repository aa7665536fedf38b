// The order of elimination of a few nodes.
#pragma once

#include <vector>

#include "base/linalg/graph.hpp"

namespace pliant::linalg {

/// Two neighbours of which one stays.
struct Rim {
    int outside, node;
};

/// The nodes of a graph in the order in which each has the fewest neighbours that are left (Tinney and Walker 1967);
/// those outside of it count and stay. Degrees are exact, in bits: for up to a few hundred nodes.
[[nodiscard]] std::vector<int> by_minimum_degree(const Graph& graph, std::vector<Rim> rim);

}  // namespace pliant::linalg
