#include "base/linalg/factor_size.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/linalg/aggregates.hpp"
#include "base/linalg/elimination.hpp"
#include "base/linalg/graph.hpp"
#include "base/linalg/multifrontal.hpp"

namespace pliant::linalg {
namespace {

/// Both triangles, and the diagonal.
Graph whole_graph(const SymmetricPattern& pattern) {
    return graph_of(pattern.nodes, [&](const auto& add) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k) {
                const int i = pattern.node_row[k];
                add(i, j);
                if (i != j) add(j, i);
            }
        }
    });
}

/// The pattern of the groups: two are coupled if nodes of them are.
SymmetricPattern pattern_of(const Aggregates& groups, const Graph& nodes, const SymmetricPattern& fine) {
    const Lists members = members_of(groups.of_node, groups.count);
    SymmetricPattern pattern;
    pattern.nodes = groups.count;
    pattern.node_start.assign(1, 0);
    std::vector<int> later;
    for (int g = 0; g < groups.count; ++g) {
        later.assign(1, g);
        for (const int i : members[static_cast<std::size_t>(g)]) {
            for (int e = nodes.start[i]; e < nodes.start[i + 1]; ++e) {
                const int other = groups.of_node[nodes.other[e]];
                if (other > g) later.push_back(other);
            }
        }
        std::sort(later.begin(), later.end());
        later.erase(std::unique(later.begin(), later.end()), later.end());
        pattern.node_row.insert(pattern.node_row.end(), later.begin(), later.end());
        pattern.node_start.push_back(static_cast<int>(pattern.node_row.size()));
        if (!fine.points.empty()) pattern.points.push_back(fine.points[members[static_cast<std::size_t>(g)].front()]);
    }
    return pattern;
}

}  // namespace

FactorSize estimate_factor_size(const SymmetricPattern& pattern) {
    const Graph nodes = whole_graph(pattern);
    const Aggregates groups = take_neighbourhoods({nodes.start, nodes.other});
    const FrontLayout layout = lay_out(eliminate(pattern_of(groups, nodes, pattern)), 1, 1);
    const double in_group = static_cast<double>(pattern.nodes) / std::max(groups.count, 1);
    return {static_cast<double>(layout.panel.back()) * std::pow(in_group, 4.0 / 3), layout.work * in_group * in_group};
}

}  // namespace pliant::linalg
