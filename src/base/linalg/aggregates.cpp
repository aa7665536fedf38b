#include "base/linalg/aggregates.hpp"

#include <cstdint>
#include <span>
#include <utility>

#include "base/linalg/lists.hpp"

namespace pliant::linalg {
namespace {

std::span<const int> neighbours(const Neighbours& all, int node) {
    return all.column.subspan(all.start[node], all.start[node + 1] - all.start[node]);
}

/// Merges each group with the unpaired group it is coupled to most strongly.
Aggregates pair_up(const Neighbours& all, const Aggregates& groups) {
    const Lists nodes = members_of(groups.of_node, groups.count);
    std::vector<int> pair(static_cast<std::size_t>(groups.count), -1), couplings(pair.size(), 0), seen;
    int count = 0;
    for (int g = 0; g < groups.count; ++g) {
        if (pair[g] >= 0) continue;
        pair[g] = count++;
        for (const int i : nodes[static_cast<std::size_t>(g)]) {
            for (const int j : neighbours(all, i)) {
                const int h = groups.of_node[j];
                if (pair[h] < 0 && couplings[h]++ == 0) seen.push_back(h);
            }
        }
        int partner = -1;
        for (const int h : seen) {
            if (partner < 0 || couplings[h] > couplings[partner]) partner = h;
        }
        if (partner >= 0) pair[partner] = pair[g];
        for (const int h : seen) couplings[h] = 0;
        seen.clear();
    }
    Aggregates result{groups.of_node, count};
    for (int& g : result.of_node) g = pair[g];
    return result;
}

/// The time to factorise the coarse level grows with the square of the number of groups, everything else with the
/// number of nodes: balanced by measurements from 12,000 nodes to 190,000.
bool too_many(int groups, int nodes) {
    return static_cast<std::int64_t>(groups) * groups > std::int64_t{16} * nodes;
}

}  // namespace

/// Groups are whole neighbourhoods of which no node is taken yet; remaining nodes join an adjacent group.
Aggregates take_neighbourhoods(const Neighbours& all) {
    const int nodes = static_cast<int>(all.start.size()) - 1;
    Aggregates result{std::vector<int>(static_cast<std::size_t>(nodes), -1)};
    auto& of = result.of_node;
    for (int i = 0; i < nodes; ++i) {
        bool untouched = true;
        for (const int j : neighbours(all, i)) untouched = untouched && of[j] < 0;
        if (!untouched) continue;
        for (const int j : neighbours(all, i)) of[j] = result.count;
        ++result.count;
    }
    const std::vector<int> first = of;
    for (int i = 0; i < nodes; ++i) {
        if (of[i] >= 0) continue;
        for (const int j : neighbours(all, i)) {
            if (of[i] < 0) of[i] = first[j];
        }
    }
    for (int i = 0; i < nodes; ++i) {
        if (of[i] >= 0) continue;
        for (const int j : neighbours(all, i)) {
            if (of[j] < 0) of[j] = result.count;
        }
        ++result.count;
    }
    return result;
}

Aggregates aggregate(const Neighbours& all) {
    Aggregates groups = take_neighbourhoods(all);
    while (too_many(groups.count, static_cast<int>(all.start.size()) - 1)) {
        Aggregates paired = pair_up(all, groups);
        if (paired.count == groups.count) break;  // no groups are adjacent
        groups = std::move(paired);
    }
    return groups;
}

}  // namespace pliant::linalg
