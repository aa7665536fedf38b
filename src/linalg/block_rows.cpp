#include "linalg/block_rows.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t grain = 1024;  // rows that one core takes at a time

}  // namespace

BlockRows::BlockRows(const SymmetricPattern& pattern) : start(static_cast<std::size_t>(pattern.nodes) + 1, 0) {
    assert(pattern.block == 3);
    const auto visit = [&](const auto& use) {
        // Columns of the lower triangle in order: each row meets its entries left of the diagonal before those right of
        // it, both ascending.
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
    rounded_.resize(9 * column.size() + 1);  // columns are read four rows at a time
    rounded_[9 * column.size()] = 0;
}

Eigen::Matrix3d BlockRows::block(int entry) const {
    const Source source = source_[entry];
    const Eigen::Map<const Eigen::Matrix3d> given(values_.data() + 9 * static_cast<std::size_t>(source.pair));
    if (source.kind == Source::as_it_is) return given;
    if (source.kind == Source::transposed) return given.transpose();
    return given.selfadjointView<Eigen::Lower>();
}

void BlockRows::set(std::span<const double> values) {
    values_ = values;
    parallel_for(diagonal_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (int k = start[begin]; k < start[end]; ++k)
            Eigen::Map<Eigen::Matrix3f>(rounded_.data() + 9 * static_cast<std::size_t>(k)) = block(k).cast<float>();
    });
}

void BlockRows::multiply(const double* x, double* y) const {
    parallel_for(diagonal_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int k = start[i]; k < start[i + 1]; ++k)
                sum.noalias() +=
                    block(k) * Eigen::Map<const Eigen::Vector3d>(x + 3 * static_cast<std::size_t>(column[k]));
            Eigen::Map<Eigen::Vector3d>(y + 3 * i) = sum;
        }
    });
}

void BlockRows::multiply(const float* x, float* y) const {
    using Four = Eigen::Vector4f;
    parallel_for(diagonal_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Four sum = Four::Zero();  // the fourth is of no use
            for (int k = start[i]; k < start[i + 1]; ++k) {
                const float* b = rounded_.data() + 9 * static_cast<std::size_t>(k);
                const float* v = x + 3 * static_cast<std::size_t>(column[k]);
                sum += Eigen::Map<const Four>(b) * v[0] + Eigen::Map<const Four>(b + 3) * v[1] +
                       Eigen::Map<const Four>(b + 6) * v[2];
            }
            std::copy_n(sum.data(), 3, y + 3 * i);
        }
    });
}

}  // namespace pliant::linalg
