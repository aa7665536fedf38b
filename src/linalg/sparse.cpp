#include "linalg/sparse.hpp"

#include <algorithm>
#include <cassert>

namespace pliant::linalg {
namespace {

/// Adds factor * B v_j to r_i and, off the diagonal, factor * B^T v_i to r_j.
template <int block>
void add_block_product(const double* B, double factor, bool diagonal, const double* vi, const double* vj, double* ri,
                       double* rj) {
    for (int c = 0; c < block; ++c) {
        double transposed = 0;
        for (int r = diagonal ? c : 0; r < block; ++r) {
            ri[r] += factor * B[block * c + r] * vj[c];
            if (!diagonal || r > c) transposed += B[block * c + r] * vi[r];
        }
        rj[c] += factor * transposed;
    }
}

template <int block>
void add_product_of(const SymmetricPattern& p, std::span<const double> values, std::span<const double> v, double factor,
                    std::span<double> result) {
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
            const std::size_t i = static_cast<std::size_t>(p.node_row[k]) * block;
            const std::size_t column = static_cast<std::size_t>(j) * block;
            add_block_product<block>(values.data() + static_cast<std::size_t>(k) * block * block, factor, i == column,
                                     v.data() + i, v.data() + column, result.data() + i, result.data() + column);
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

bool SymmetricPattern::holds(int i, int j) const {
    return std::binary_search(node_row.begin() + node_start[j], node_row.begin() + node_start[j + 1], i);
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
    return pattern;
}

void add_product(const SymmetricPattern& pattern, std::span<const double> values, std::span<const double> v,
                 double factor, std::span<double> result) {
    assert(pattern.block == 1 || pattern.block == 3);
    if (pattern.block == 1)
        add_product_of<1>(pattern, values, v, factor, result);
    else
        add_product_of<3>(pattern, values, v, factor, result);
}

}  // namespace pliant::linalg
