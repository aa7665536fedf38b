#include "base/linalg/block_rows.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t grain = 1024;  // rows per parallel piece

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
    source_.resize(column.size());
    diagonal_.resize(static_cast<std::size_t>(pattern.nodes));
    std::vector<int> next(start.begin(), start.end() - 1);
    const auto put = [&](int row, int at, int pair, Source::Kind kind) {
        column[next[row]] = at;
        source_[next[row]++] = {pair, kind};
    };
    visit([&](int i, int j, int k) {
        if (i == j) diagonal_[i] = next[i];
        put(i, j, k, i == j ? Source::diagonal : Source::as_it_is);
        if (i != j) put(j, i, k, Source::transposed);
    });
    for (AlignedArray<float>* numbers : {&rounded_, &rest_}) {
        numbers->resize(9 * column.size() + 1);  // kernels read columns four rows at a time
        (*numbers)[9 * column.size()] = 0;
    }
}

void BlockRows::set(std::span<const double> values) {
    using Rounded = Eigen::Map<Eigen::Matrix3f>;
    const auto block_at = [&](Source source) -> Eigen::Matrix3d {
        const Eigen::Map<const Eigen::Matrix3d> given(values.data() + 9 * static_cast<std::size_t>(source.pair));
        if (source.kind == Source::as_it_is) return given;
        if (source.kind == Source::transposed) return given.transpose();
        return given.selfadjointView<Eigen::Lower>();
    };
    parallel_for(diagonal_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (int k = start[begin]; k < start[end]; ++k) {
            const Eigen::Matrix3d block = block_at(source_[k]);
            const Eigen::Matrix3f rounded = block.cast<float>();
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            Rounded(rounded_.data() + at) = rounded;
            Rounded(rest_.data() + at) = (block - rounded.cast<double>()).cast<float>();
        }
    });
}

void BlockRows::multiply(const double* x, double* y, int columns) const {
    parallel_for(diagonal_.size(), grain,
                 [&](std::size_t begin, std::size_t end) { multiply_rows(blocks(), begin, end, columns, x, y); });
}

void BlockRows::multiply(const float* x, float* y, int columns) const {
    parallel_for(diagonal_.size(), grain,
                 [&](std::size_t begin, std::size_t end) { multiply_rows(blocks(), begin, end, columns, x, y); });
}

}  // namespace pliant::linalg
