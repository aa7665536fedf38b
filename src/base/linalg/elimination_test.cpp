#include "base/linalg/elimination.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

using namespace pliant::linalg;

namespace {

/// Fill of each column, by naive elimination.
std::vector<std::set<int>> rows_of_factor(const SymmetricPattern& pattern, const std::vector<int>& position) {
    std::vector<std::set<int>> rows(position.size());
    for (int j = 0; j < pattern.nodes; ++j) {
        for (int k = pattern.node_start[j] + 1; k < pattern.node_start[j + 1]; ++k) {
            const auto [low, high] = std::minmax(position[j], position[pattern.node_row[k]]);
            rows[low].insert(high);
        }
    }
    for (std::set<int>& column : rows) {
        if (!column.empty()) rows[*column.begin()].insert(std::next(column.begin()), column.end());
    }
    return rows;
}

/// Number of stored zeros allowed for this many unknowns (see `eliminate`).
double allowed_zeros(int unknowns) {
    return unknowns <= 24 ? 0.4 : unknowns <= 48 ? 0.2 : unknowns <= 96 ? 0.08 : 0.02;
}

void check(const SymmetricPattern& pattern) {
    const Elimination e = eliminate(pattern);
    std::vector<int> sorted = e.position;
    std::sort(sorted.begin(), sorted.end());
    for (int k = 0; k < pattern.nodes; ++k) REQUIRE(sorted[k] == k);
    const auto rows = rows_of_factor(pattern, e.position);
    for (int s = 0; s < e.supernodes(); ++s) {
        std::set<int> below;
        double filled = 0;
        for (int j = e.first[s]; j < e.first[s + 1]; ++j) {
            below.insert(rows[j].lower_bound(e.first[s + 1]), rows[j].end());
            filled += static_cast<double>(rows[j].size());
        }
        REQUIRE(
            std::equal(below.begin(), below.end(), e.row.begin() + e.row_start[s], e.row.begin() + e.row_start[s + 1]));
        const double columns = e.columns(s);
        const double stored = columns * (columns - 1) / 2 + columns * e.rows_below(s);
        const double all = columns * (columns + 1) / 2 + columns * e.rows_below(s);
        CHECK(stored - filled <= allowed_zeros(e.columns(s) * pattern.block) * all + 1e-9);
    }
}

}  // namespace

TEST_CASE("supernodes have the rows of naive elimination, with few zeros") {
    std::mt19937 random(11);
    for (const int nodes : {1, 2, 30, 400}) {
        for (const double cliques_per_node : {0.3, 1.0, 2.5}) {
            std::uniform_int_distribution<int> node(0, nodes - 1), reach(0, 12);
            Lists cliques;
            for (int c = 0; c < cliques_per_node * nodes; ++c) {
                const int first = node(random);  // mostly close in number, as in a mesh
                cliques.push_back(std::vector<int>{first, std::min(nodes - 1, first + reach(random)),
                                                   std::min(nodes - 1, first + reach(random)),
                                                   c % 9 == 0 ? node(random) : first});
            }
            for (const int block : {1, 3}) check(make_pattern(nodes, block, cliques));
        }
    }
}
