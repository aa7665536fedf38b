#include "base/linalg/sparse.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

#include "base/core/aligned_array.hpp"
#include "base/linalg/graph.hpp"
#include "base/linalg/symmetric_product.hpp"

namespace pliant::linalg {
namespace {

constexpr std::ptrdiff_t most_counted = 32;  // rows of a column up to which counting the smaller ones, without
                                             // branches, is used

void add_scalar_product(const SymmetricPattern& p, std::span<const double> values, std::span<const double> v,
                        double factor, std::span<double> result) {
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
            const int i = p.node_row[k];
            result[i] += factor * values[k] * v[j];
            if (i != j) result[j] += factor * values[k] * v[i];
        }
    }
}

/// In arrays with four numbers for each node, which suit SIMD.
void add_block_product(const SymmetricPattern& p, std::span<const double> values, std::span<const double> v,
                       double factor, std::span<double> result) {
    const auto nodes = static_cast<std::size_t>(p.nodes);
    AlignedArray<double> padded(8 * nodes);
    double *from = padded.data(), *to = from + 4 * nodes;
    for (std::size_t i = 0; i < nodes; ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
            from[4 * i + c] = c < 3 ? v[3 * i + c] : 0;
            to[4 * i + c] = 0;
        }
    }
    add_symmetric_product({nodes, p.node_start.data(), p.node_row.data()}, values.data(), from, to);
    for (std::size_t i = 0; i < nodes; ++i) {
        for (std::size_t c = 0; c < 3; ++c) result[3 * i + c] += factor * to[4 * i + c];
    }
}

}  // namespace

int SymmetricPattern::find(int i, int j) const {
    const int* begin = node_row.data() + node_start[j];
    const int* end = node_row.data() + node_start[j + 1];
    const int* found = begin;
    if (end - begin > most_counted) {
        found = std::lower_bound(begin, end, i);
    } else {
        for (const int* row = begin; row != end; ++row) found += *row < i ? 1 : 0;
    }
    assert(found != end && *found == i);
    return static_cast<int>(found - node_row.data());
}

bool SymmetricPattern::holds(int i, int j) const {
    return std::binary_search(node_row.begin() + node_start[j], node_row.begin() + node_start[j + 1], i);
}

SymmetricPattern make_pattern(int nodes, int block, const Lists& cliques) {
    const Graph member_of = graph_of(nodes, [&](const auto& use) {
        for (int c = 0; c < cliques.count(); ++c) {
            for (const int node : cliques[static_cast<std::size_t>(c)]) {
                if (node >= 0) use(node, c);
            }
        }
    });
    Lists rows = make_lists(nodes, [&] {
        return [&, seen = std::vector<int>(static_cast<std::size_t>(nodes), -1)](int j, std::vector<int>& row) mutable {
            const auto begin = static_cast<std::ptrdiff_t>(row.size());
            row.push_back(j);
            for (int k = member_of.start[j]; k < member_of.start[j + 1]; ++k) {
                for (const int i : cliques[static_cast<std::size_t>(member_of.other[k])]) {
                    if (i > j && std::exchange(seen[i], j) != j) row.push_back(i);
                }
            }
            std::sort(row.begin() + begin, row.end());
        };
    });
    SymmetricPattern pattern;
    pattern.block = block;
    pattern.nodes = nodes;
    pattern.node_start = std::move(rows.start);
    pattern.node_row = std::move(rows.item);
    return pattern;
}

LeftBlocks blocks_left_of_diagonal(const SymmetricPattern& pattern) {
    const auto by_rows = [&](const auto& what) {
        return graph_of(pattern.nodes, [&](const auto& use) {
            for (int j = 0; j < pattern.nodes; ++j)
                for (int k = pattern.node_start[j] + 1; k < pattern.node_start[j + 1]; ++k)
                    use(pattern.node_row[k], what(j, k));
        });
    };
    Graph columns = by_rows([](int column, int) { return column; });
    LeftBlocks left;
    left.column.start = std::move(columns.start);
    left.column.item = std::move(columns.other);
    left.pair = by_rows([](int, int pair) { return pair; }).other;
    return left;
}

void add_product(const SymmetricPattern& pattern, std::span<const double> values, std::span<const double> v,
                 double factor, std::span<double> result) {
    assert(pattern.block == 1 || pattern.block == 3);
    if (pattern.block == 1)
        add_scalar_product(pattern, values, v, factor, result);
    else
        add_block_product(pattern, values, v, factor, result);
}

}  // namespace pliant::linalg
