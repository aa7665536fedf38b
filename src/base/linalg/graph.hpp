// Adjacency of the nodes of a graph.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant::linalg {

/// Neighbours of each node, compressed: those of i are other[start[i]] .. other[start[i + 1]].
struct Graph {
    std::vector<int> start;  ///< (nodes + 1)
    std::vector<int> other;

    [[nodiscard]] int nodes() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] int degree(int i) const { return start[i + 1] - start[i]; }
};

/// The graph of the pairs (node, other) that `visit` passes to a function; `visit` is called twice and must pass the
/// same pairs both times.
template <class Visit>
[[nodiscard]] Graph graph_of(int nodes, const Visit& visit) {
    Graph graph;
    graph.start.assign(static_cast<std::size_t>(nodes) + 1, 0);
    visit([&](int i, int) { ++graph.start[i + 1]; });
    std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
    graph.other.resize(graph.start.back());
    std::vector<int> next(graph.start.begin(), graph.start.end() - 1);
    visit([&](int i, int j) { graph.other[next[i]++] = j; });
    return graph;
}

}  // namespace pliant::linalg
