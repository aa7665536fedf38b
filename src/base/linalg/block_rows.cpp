#include "base/linalg/block_rows.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t rows_at_once = 1024;  // in a parallel piece

}  // namespace

BlockRows::BlockRows(const SymmetricPattern& pattern) : start(static_cast<std::size_t>(pattern.nodes) + 1, 0) {
    assert(pattern.block == 3);
    const auto visit = [&](const auto& use) {
        // Columns of the lower triangle in order: so each row gets its entries left of the diagonal before those right
        // of it, both ascending.
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k) use(pattern.node_row[k], j, k);
        }
    };
    visit([&](int i, int j, int) {
        ++start[i + 1];
        if (i != j) ++start[j + 1];
    });
    std::partial_sum(start.begin(), start.end(), start.begin());
    column.resize(static_cast<std::size_t>(start.back()));
    diagonal_.resize(static_cast<std::size_t>(pattern.nodes));
    first_pair_.assign(pattern.node_start.begin(), pattern.node_start.end() - 1);
    left_.resize(pattern.node_row.size() - diagonal_.size());
    std::vector<int> next(start.begin(), start.end() - 1);
    visit([&](int i, int j, int k) {
        if (i == j) diagonal_[i] = next[i];
        if (i != j) left_[next[i] - first_pair_[i]] = k;
        column[next[i]++] = j;
        if (i != j) column[next[j]++] = i;
    });
    for (AlignedArray<float>* numbers : {&rounded_, &rest_}) {
        numbers->resize(9 * column.size() + 1);  // kernels read columns four rows at a time
        (*numbers)[9 * column.size()] = 0;
    }
}

/// Calls visit(entry, block of the matrix with these values) for all entries, on all cores. Of a diagonal block the
/// lower triangle is used.
template <class Visit>
void BlockRows::for_blocks(std::span<const double> values, const Visit& visit) const {
    const auto given = [&](int pair) -> Eigen::Matrix3d {
        return Eigen::Map<const Eigen::Matrix3d>(values.data() + 9 * static_cast<std::size_t>(pair));
    };
    const auto symmetric = [](const Eigen::Matrix3d& block) -> Eigen::Matrix3d {
        return block.selfadjointView<Eigen::Lower>();
    };
    parallel_for(diagonal_.size(), rows_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const int diagonal = diagonal_[i], first = first_pair_[i];
            for (int k = start[i]; k < diagonal; ++k) visit(k, given(left_[k - first]));
            visit(diagonal, symmetric(given(first)));
            for (int k = diagonal + 1; k < start[i + 1]; ++k)
                visit(k, Eigen::Matrix3d(given(first + k - diagonal).transpose()));
        }
    });
}

void BlockRows::put(int entry, const Eigen::Matrix3d& block) const {
    using Rounded = Eigen::Map<Eigen::Matrix3f>;
    const Eigen::Matrix3f rounded = block.cast<float>();
    const std::size_t at = 9 * static_cast<std::size_t>(entry);
    Rounded(rounded_.data() + at) = rounded;
    Rounded(rest_.data() + at) = (block - rounded.cast<double>()).cast<float>();
}

void BlockRows::set(std::span<const double> values) {
    for_blocks(values, [&](int entry, const Eigen::Matrix3d& given) { put(entry, given); });
}

void BlockRows::move_towards(std::span<const double> values, double share) {
    for_blocks(values, [&](int entry, const Eigen::Matrix3d& given) {
        const Eigen::Matrix3d now = block(entry);
        put(entry, now + share * (given - now));
    });
}

void BlockRows::multiply(const double* x, double* y, int columns) const {
    parallel_for(diagonal_.size(), rows_at_once,
                 [&](std::size_t begin, std::size_t end) { multiply_rows(blocks(), begin, end, columns, x, y); });
}

void BlockRows::multiply(const float* x, float* y, int columns) const {
    parallel_for(diagonal_.size(), rows_at_once,
                 [&](std::size_t begin, std::size_t end) { multiply_rows(blocks(), begin, end, columns, x, y); });
}

}  // namespace pliant::linalg
