// Aggregates on lattices.
#include "base/linalg/aggregates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/linalg/symmetric_blocks.hpp"

using namespace pliant::linalg;

namespace {

/// Cells of a box, each a clique of its eight corners.
Lists box(int along, int across) {
    const int side = across + 1;
    const auto node = [&](int i, int j, int k) { return (i * side + j) * side + k; };
    std::vector<std::vector<int>> cliques;
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < across; ++j) {
            for (int k = 0; k < across; ++k) {
                std::vector<int>& clique = cliques.emplace_back();
                for (int corner = 0; corner < 8; ++corner)
                    clique.push_back(node(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)));
            }
        }
    }
    return SymmetricBlocks(make_pattern((along + 1) * side * side, 3, cliques)).neighbours();
}

/// Number of nodes of a group reachable from its first one within the group.
std::size_t reached(const Lists& neighbours, const Aggregates& groups, const std::vector<int>& nodes) {
    std::vector<int> found{nodes.front()};
    for (std::size_t k = 0; k < found.size(); ++k) {
        for (const int j : neighbours[static_cast<std::size_t>(found[k])]) {
            if (groups.of_node[j] == groups.of_node[nodes.front()] &&
                std::find(found.begin(), found.end(), j) == found.end())
                found.push_back(j);
        }
    }
    return found.size();
}

}  // namespace

TEST_CASE("every node is in one connected group, and the number of groups is limited") {
    for (const auto& [along, across] : {std::pair{1, 1}, {40, 2}, {30, 12}, {60, 30}}) {
        CAPTURE(along);
        const Lists neighbours = box(along, across);
        const Aggregates groups = aggregate({neighbours.start, neighbours.item});
        CHECK(groups.count <= std::max(1.0, 4 * std::sqrt(neighbours.count())));
        CHECK(groups.count * 400 >= neighbours.count());
        const Lists members = members_of(groups.of_node, groups.count);
        REQUIRE(members.item.size() == static_cast<std::size_t>(neighbours.count()));
        for (int g = 0; g < groups.count; ++g) {
            const std::vector<int> nodes(members.item.begin() + members.start[g],
                                         members.item.begin() + members.start[g + 1]);
            REQUIRE(!nodes.empty());
            CHECK(std::is_sorted(nodes.begin(), nodes.end()));
            CHECK(reached(neighbours, groups, nodes) == nodes.size());
        }
    }
}

TEST_CASE("isolated nodes stay alone, however many they are") {
    const Lists alone = SymmetricBlocks(make_pattern(1000, 3, {})).neighbours();
    CHECK(aggregate({alone.start, alone.item}).count == 1000);
}
