#include "base/linalg/scalar_rows.hpp"

#include <cmath>
#include <numeric>

namespace pliant::linalg {

ScalarRows ScalarRows::of(const SymmetricPattern& pattern, std::span<const double> values) {
    ScalarRows made;
    made.columns_ = pattern.nodes;
    const auto nodes = static_cast<std::size_t>(pattern.nodes);
    made.start_.assign(nodes + 1, 0);
    const auto for_pairs = [&](const auto& visit) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[static_cast<std::size_t>(j)];
                 k < pattern.node_start[static_cast<std::size_t>(j) + 1]; ++k)
                visit(pattern.node_row[static_cast<std::size_t>(k)], j, values[static_cast<std::size_t>(k)]);
        }
    };
    for_pairs([&](int i, int j, double) {
        ++made.start_[static_cast<std::size_t>(i) + 1];
        if (i != j) ++made.start_[static_cast<std::size_t>(j) + 1];
    });
    std::partial_sum(made.start_.begin(), made.start_.end(), made.start_.begin());
    made.column_.resize(static_cast<std::size_t>(made.start_.back()));
    made.value_.resize(made.column_.size());
    // Row i receives its columns j < i while those are visited, and the others when column i itself is: in ascending
    // order.
    std::vector<int> next(made.start_.begin(), made.start_.end() - 1);
    for_pairs([&](int i, int j, double value) {
        const auto put = [&](int row, int column) {
            const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++);
            made.column_[at] = column;
            made.value_[at] = static_cast<float>(value);
        };
        put(i, j);
        if (i != j) put(j, i);
    });
    return made;
}

AlignedArray<float> ScalarRows::inverse_absolute_sums() const {
    AlignedArray<float> inverses(rows());
    for (std::size_t i = 0; i < rows(); ++i) {
        float sum = 0;
        for (const float a : row(i).values) sum += std::fabs(a);
        inverses[i] = sum > 0 ? 1 / sum : 0;
    }
    return inverses;
}

ScalarRows ScalarRows::transposed() const {
    ScalarRows made;
    made.columns_ = static_cast<int>(rows());
    made.start_.assign(static_cast<std::size_t>(columns_) + 1, 0);
    for (const int column : columns()) ++made.start_[static_cast<std::size_t>(column) + 1];
    std::partial_sum(made.start_.begin(), made.start_.end(), made.start_.begin());
    made.column_.resize(column_.size());
    made.value_.resize(value_.size());
    std::vector<int> next(made.start_.begin(), made.start_.end() - 1);
    for (std::size_t i = 0; i < rows(); ++i) {
        const Row own = row(i);
        for (std::size_t k = 0; k < own.columns.size(); ++k) {
            const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(own.columns[k])]++);
            made.column_[at] = static_cast<int>(i);
            made.value_[at] = own.values[k];
        }
    }
    return made;
}

std::pair<SymmetricPattern, std::vector<double>> ScalarRows::lower_triangle() const {
    SymmetricPattern pattern;
    pattern.nodes = static_cast<int>(rows());
    pattern.node_start.assign(1, 0);
    std::vector<double> values;
    for (std::size_t i = 0; i < rows(); ++i) {
        const Row own = row(i);
        for (std::size_t k = 0; k < own.columns.size(); ++k) {
            if (own.columns[k] < static_cast<int>(i)) continue;
            pattern.node_row.push_back(own.columns[k]);
            values.push_back(static_cast<double>(own.values[k]));
        }
        pattern.node_start.push_back(static_cast<int>(pattern.node_row.size()));
    }
    return {std::move(pattern), std::move(values)};
}

ScalarRows coarse_product(const ScalarRows& restriction, const ScalarRows& matrix, const ScalarRows& prolongation) {
    const int coarse = static_cast<int>(restriction.rows());
    return ScalarRows::make(coarse, coarse, [&](int c, auto& put) {
        const ScalarRows::Row members = restriction.row(static_cast<std::size_t>(c));
        for (std::size_t m = 0; m < members.columns.size(); ++m) {
            const ScalarRows::Row forces = matrix.row(static_cast<std::size_t>(members.columns[m]));
            for (std::size_t f = 0; f < forces.columns.size(); ++f) {
                const ScalarRows::Row moving = prolongation.row(static_cast<std::size_t>(forces.columns[f]));
                const double share = static_cast<double>(members.values[m]) * static_cast<double>(forces.values[f]);
                for (std::size_t k = 0; k < moving.columns.size(); ++k)
                    put(moving.columns[k], share * static_cast<double>(moving.values[k]));
            }
        }
    });
}

}  // namespace pliant::linalg
