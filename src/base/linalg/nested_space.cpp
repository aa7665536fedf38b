#include "base/linalg/nested_space.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <utility>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t node_grain = 1024;                        // per parallel piece
constexpr std::size_t least_columns = 256, column_pieces = 64;  // each has work space for all columns

/// Calls visit(pair, column, a, b) for each pair of fine nodes, each moving end a of its row and b of its column.
template <class Visit>
void for_pairs(const SymmetricPattern& fine, const Nesting& nesting, const Visit& visit) {
    for (int j = 0; j < fine.nodes; ++j) {
        for (int k = fine.node_start[j]; k < fine.node_start[j + 1]; ++k) {
            for (const int a : nesting.ends[static_cast<std::size_t>(fine.node_row[k])]) {
                for (const int b : nesting.ends[static_cast<std::size_t>(j)]) {
                    if (a >= 0 && b >= 0) visit(k, j, a, b);
                }
            }
        }
    }
}

}  // namespace

NestedSpace::NestedSpace(const SymmetricPattern& fine, Nesting nesting) : nesting_(std::move(nesting)) {
    find_pattern(fine);
    left_ = blocks_left_of_diagonal(pattern_);
    coarse_.resize(pattern_.entries());
    mirrored_.resize(pattern_.entries());
}

void NestedSpace::find_pattern(const SymmetricPattern& fine) {
    const auto ends_of = [&](int node) -> const std::array<int, 2>& {
        return nesting_.ends[static_cast<std::size_t>(node)];
    };
    const auto coarse = static_cast<std::size_t>(nesting_.coarse_nodes);
    std::vector<std::vector<int>> on(coarse), later(coarse);
    corner_.assign(coarse, 0);
    for (int i = 0; i < fine.nodes; ++i) {
        const auto [a, b] = ends_of(i);
        if (a == b && a >= 0) corner_[static_cast<std::size_t>(a)] = i;
        if (a >= 0) on[static_cast<std::size_t>(a)].push_back(i);
        if (b >= 0 && b != a) on[static_cast<std::size_t>(b)].push_back(i);
    }
    on_ = Lists(on);
    for_pairs(fine, nesting_, [&](int, int, int a, int b) {
        std::vector<int>& rows = later[static_cast<std::size_t>(std::min(a, b))];
        const auto place = std::lower_bound(rows.begin(), rows.end(), std::max(a, b));
        if (a != b && (place == rows.end() || *place != std::max(a, b))) rows.insert(place, std::max(a, b));
    });
    pattern_.block = 3;
    pattern_.nodes = nesting_.coarse_nodes;
    pattern_.node_start.assign(1, 0);
    for (std::size_t c = 0; c < coarse; ++c) {
        pattern_.node_row.push_back(static_cast<int>(c));
        pattern_.node_row.insert(pattern_.node_row.end(), later[c].begin(), later[c].end());
        pattern_.node_start.push_back(static_cast<int>(pattern_.node_row.size()));
        if (!fine.points.empty()) pattern_.points.push_back(fine.points[static_cast<std::size_t>(corner_[c])]);
    }
}

/// With A = H + H^T, H its lower triangle with half the diagonal: P^T A P = G + G^T, G = P^T H P.
void NestedSpace::set(const Fine& fine) {
    positions_.resize(3 * corner_.size());
    const std::size_t at_once = std::max(least_columns, (corner_.size() + column_pieces - 1) / column_pieces);
    parallel_for(corner_.size(), at_once, [&](std::size_t begin, std::size_t end) {
        ColumnSums column;
        column.place.resize(corner_.size());
        for (std::size_t c = begin; c < end; ++c) {
            std::copy_n(fine.positions.data() + 3 * static_cast<std::size_t>(corner_[c]), 3, positions_.data() + 3 * c);
            make_column(fine.matrix.triangle(), c, column);
        }
    });
    parallel_for(pattern_.node_row.size(), node_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = 9 * begin; at < 9 * end; at += 9)
            Eigen::Map<Eigen::Matrix3d>(coarse_.data() + at) +=
                Eigen::Map<const Eigen::Matrix3d>(mirrored_.data() + at).transpose();
    });
}

/// Column c of G, from the columns of H of the nodes that follow c: its blocks from the diagonal down go to coarse_,
/// those from the diagonal up to mirrored_, where the pair of the same two nodes is.
void NestedSpace::make_column(const LowerTriangle& matrix, std::size_t c, ColumnSums& column) {
    const int diagonal = pattern_.node_start[c], end = pattern_.node_start[c + 1];
    int coupled = 0;
    for (const int e : left_.column[c]) column.place[e] = coupled++;
    for (int k = diagonal; k < end; ++k) column.place[pattern_.node_row[k]] = coupled++;
    column.sums.assign(9 * static_cast<std::size_t>(coupled), 0.0);
    for (const int i : on_[c])
        add_column_to_corners(matrix, i, share(i), followers(), column.place.data(), column.sums.data());
    const double* from = column.sums.data();
    const auto put = [&](std::vector<double>& to, int pair) {
        std::copy_n(from, 9, to.data() + 9 * static_cast<std::size_t>(pair));
    };
    for (int e = left_.column.start[c]; e < left_.column.start[c + 1]; ++e, from += 9) put(mirrored_, left_.pair[e]);
    put(mirrored_, diagonal);
    for (int k = diagonal; k < end; ++k, from += 9) put(coarse_, k);
}

void NestedSpace::restrict(const float* fine, double* coarse) {
    parallel_for(static_cast<std::size_t>(nesting_.coarse_nodes), node_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            std::array<float, 3> sum{};
            for (const int i : on_[c]) {
                const auto weight = static_cast<float>(share(i));
                for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * fine[3 * static_cast<std::size_t>(i) + k];
            }
            for (std::size_t k = 0; k < 3; ++k) coarse[3 * c + k] = static_cast<double>(sum[k]);
        }
    });
}

void NestedSpace::add_prolonged(const double* coarse, float* fine) const {
    parallel_for(nesting_.ends.size(), node_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (const int c : nesting_.ends[i]) {
                for (std::size_t k = 0; c >= 0 && k < 3; ++k)
                    fine[3 * i + k] += static_cast<float>(0.5 * coarse[3 * static_cast<std::size_t>(c) + k]);
            }
        }
    });
}

}  // namespace pliant::linalg
