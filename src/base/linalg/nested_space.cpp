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
    coarse_.resize(pattern_.entries());
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

void NestedSpace::set(const Fine& fine) {
    positions_.resize(3 * corner_.size());
    const std::size_t at_once = std::max(least_columns, (corner_.size() + column_pieces - 1) / column_pieces);
    parallel_for(corner_.size(), at_once, [&](std::size_t begin, std::size_t end) {
        std::vector<int> place(corner_.size());  // of each row in its column
        std::vector<double> mirrored;
        for (std::size_t c = begin; c < end; ++c) {
            std::copy_n(fine.positions.data() + 3 * static_cast<std::size_t>(corner_[c]), 3, positions_.data() + 3 * c);
            const int first = pattern_.node_start[c], count = pattern_.node_start[c + 1] - first;
            for (int p = 0; p < count; ++p) place[pattern_.node_row[first + p]] = p;
            const std::span<double> sums = std::span(coarse_).subspan(9 * static_cast<std::size_t>(first), 9 * count);
            std::ranges::fill(sums, 0.0);
            mirrored.assign(sums.size(), 0.0);
            const CornerSums to{static_cast<int>(c), place.data(), sums.data(), mirrored.data()};
            for (const int i : on_[c]) add_to_corners(fine.matrix.triangle(), i, share(i), followers(), to);
            for (std::size_t at = 0; at < sums.size(); at += 9)
                Eigen::Map<Eigen::Matrix3d>(sums.data() + at) +=
                    Eigen::Map<const Eigen::Matrix3d>(mirrored.data() + at).transpose();
        }
    });
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
