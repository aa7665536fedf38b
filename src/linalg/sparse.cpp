#include "linalg/sparse.hpp"

#include <algorithm>
#include <cassert>

namespace pliant::linalg {
namespace {

void expand_to_unknowns(SymmetricPattern& p) {
    p.column_start.assign(static_cast<std::size_t>(p.size()) + 1, 0);
    for (int j = 0; j < p.nodes; ++j) {
        const int pairs = p.node_start[j + 1] - p.node_start[j];
        for (int c = 0; c < p.block; ++c) {
            const int column = j * p.block + c;
            p.column_start[column + 1] = p.column_start[column] + pairs * p.block - c;
        }
    }
    p.row.reserve(p.column_start.back());
    for (int j = 0; j < p.nodes; ++j) {
        for (int c = 0; c < p.block; ++c) {
            for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
                for (int r = k == p.node_start[j] ? c : 0; r < p.block; ++r) {
                    p.row.push_back(p.node_row[k] * p.block + r);
                }
            }
        }
    }
}

}  // namespace

int SymmetricPattern::find(int i, int j) const {
    const auto begin = node_row.begin() + node_start[j];
    const auto end = node_row.begin() + node_start[j + 1];
    const auto found = std::lower_bound(begin, end, i);
    assert(found != end && *found == i);
    return static_cast<int>(found - node_row.begin());
}

SymmetricPattern make_pattern(int nodes, int block, const std::vector<std::vector<int>>& cliques) {
    std::vector<std::vector<int>> below(nodes);
    const auto tidy = [](std::vector<int>& list) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    for (int j = 0; j < nodes; ++j) below[j].push_back(j);
    for (const auto& clique : cliques) {
        for (const int j : clique) {
            if (j < 0) continue;
            for (const int i : clique) {
                if (i > j) below[j].push_back(i);
            }
            // Repeats are dropped as they pile up, so that memory follows the result, not the input.
            if (below[j].size() > 256 && below[j].size() == below[j].capacity()) tidy(below[j]);
        }
    }
    SymmetricPattern pattern;
    pattern.block = block;
    pattern.nodes = nodes;
    pattern.node_start.assign(1, 0);
    for (auto& list : below) {
        tidy(list);
        pattern.node_row.insert(pattern.node_row.end(), list.begin(), list.end());
        pattern.node_start.push_back(static_cast<int>(pattern.node_row.size()));
        std::vector<int>().swap(list);
    }
    expand_to_unknowns(pattern);
    return pattern;
}

}  // namespace pliant::linalg
