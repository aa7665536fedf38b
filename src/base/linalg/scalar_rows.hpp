// A sparse matrix of single numbers by rows, in single precision, for products with fields.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

class ScalarRows {
public:
    ScalarRows() = default;
    /// Both triangles of a symmetric matrix. Precondition: block 1.
    [[nodiscard]] static ScalarRows of(const SymmetricPattern& pattern, std::span<const double> values);
    /// On all cores: write(i, put) calls put(column, value) for the entries of row i, in any order; those of the same
    /// column are added.
    template <class Write>
    [[nodiscard]] static ScalarRows make(int rows, int columns, const Write& write);

    [[nodiscard]] std::size_t rows() const { return start_.size() - 1; }
    struct Row {
        std::span<const int> columns;  ///< ascending
        std::span<const float> values;
    };
    [[nodiscard]] Row row(std::size_t i) const {
        const auto begin = static_cast<std::size_t>(start_[i]), size = static_cast<std::size_t>(start_[i + 1]) - begin;
        return {{column_.data() + begin, size}, {value_.data() + begin, size}};
    }
    [[nodiscard]] std::span<const int> start() const { return start_; }  ///< (rows + 1) first entry of each row
    [[nodiscard]] std::span<const int> columns() const { return column_.span(); }  ///< of all entries

    /// Row i times `field` (columns, 4), whose numbers are aligned to 16 bytes.
    [[nodiscard]] Eigen::Array4f row_product(std::size_t i, const float* field) const {
        Eigen::Array4f sum = Eigen::Array4f::Zero();
        for (int e = start_[i]; e < start_[i + 1]; ++e) {
            const auto at = static_cast<std::size_t>(e);
            const float* x = field + 4 * static_cast<std::size_t>(column_[at]);
            sum += value_[at] * Eigen::Map<const Eigen::Array4f, Eigen::Aligned16>(x);
        }
        return sum;
    }
    /// 1 / sum of |a| for each row; 0 for one of zeros.
    [[nodiscard]] AlignedArray<float> inverse_absolute_sums() const;
    [[nodiscard]] ScalarRows transposed() const;
    /// Of a symmetric matrix.
    [[nodiscard]] std::pair<SymmetricPattern, std::vector<double>> lower_triangle() const;

private:
    int columns_ = 0;
    std::vector<int> start_{0};
    AlignedArray<int> column_;
    AlignedArray<float> value_;
};

/// P^T A P, where `restriction` is P^T.
[[nodiscard]] ScalarRows coarse_product(const ScalarRows& restriction, const ScalarRows& matrix,
                                        const ScalarRows& prolongation);

/// Sums of one row under way.
class RowSums {
public:
    explicit RowSums(int columns)
        : sum_(static_cast<std::size_t>(columns), 0.0), used_(static_cast<std::size_t>(columns), 0) {}
    void operator()(int column, double value) {
        const auto at = static_cast<std::size_t>(column);
        if (used_[at] == 0) touched_.push_back(column);
        used_[at] = 1;
        sum_[at] += value;
    }
    /// Calls visit(column, sum) in ascending order, and begins the next row.
    template <class Visit>
    void take(const Visit& visit) {
        std::sort(touched_.begin(), touched_.end());
        for (const int column : touched_) {
            const auto at = static_cast<std::size_t>(column);
            visit(column, std::exchange(sum_[at], 0.0));
            used_[at] = 0;
        }
        touched_.clear();
    }

private:
    std::vector<double> sum_;
    std::vector<char> used_;
    std::vector<int> touched_;
};

template <class Write>
ScalarRows ScalarRows::make(int rows, int columns, const Write& write) {
    constexpr std::size_t most_pieces = 16;
    struct Piece {
        std::vector<int> end, column;
        std::vector<float> value;
    };
    const auto all = static_cast<std::size_t>(rows);
    const std::size_t grain = std::max<std::size_t>(1, (all + most_pieces - 1) / most_pieces);
    std::vector<Piece> pieces((all + grain - 1) / grain);
    parallel_for(all, grain, [&](std::size_t begin, std::size_t end) {
        Piece& piece = pieces[begin / grain];
        RowSums sums(columns);
        for (std::size_t i = begin; i < end; ++i) {
            write(static_cast<int>(i), sums);
            sums.take([&](int column, double value) {
                piece.column.push_back(column);
                piece.value.push_back(static_cast<float>(value));
            });
            piece.end.push_back(static_cast<int>(piece.column.size()));
        }
    });
    ScalarRows made;
    made.columns_ = columns;
    made.start_.reserve(all + 1);
    for (const Piece& piece : pieces) {
        const int before = made.start_.back();
        for (const int end : piece.end) made.start_.push_back(before + end);
    }
    made.column_.resize(static_cast<std::size_t>(made.start_.back()));
    made.value_.resize(made.column_.size());
    parallel_for(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const auto first = static_cast<std::size_t>(made.start_[p * grain]);
            std::copy(pieces[p].column.begin(), pieces[p].column.end(), made.column_.data() + first);
            std::copy(pieces[p].value.begin(), pieces[p].value.end(), made.value_.data() + first);
            pieces[p] = {};
        }
    });
    return made;
}

}  // namespace pliant::linalg
