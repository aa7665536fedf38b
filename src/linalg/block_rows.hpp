// A stiffness matrix row by row, both triangles: as it is, and a copy in single precision for what needs few digits.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/aligned_array.hpp"
#include "linalg/sparse.hpp"

namespace pliant::linalg {

/// Blocks of 3 by 3. Row i has entries start[i] .. start[i + 1], in ascending order of `column`.
class BlockRows {
public:
    /// Precondition: blocks of 3.
    explicit BlockRows(const SymmetricPattern& pattern);

    /// Takes the values of the pattern, which must live on until the next call.
    void set(std::span<const double> values);

    [[nodiscard]] int rows() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] Eigen::Matrix3d block(int entry) const;
    [[nodiscard]] Eigen::Matrix3d diagonal(int row) const { return block(diagonal_[row]); }
    /// y (3 rows) <- A x. On all cores; the same bits on any number.
    void multiply(const double* x, double* y) const;
    void multiply(const float* x, float* y) const;

    std::vector<int> start;   ///< (rows + 1)
    std::vector<int> column;  ///< (entries)

private:
    /// Of the pattern; the lower triangle of a block on the diagonal counts.
    struct Source {
        int pair;
        enum Kind : char { as_it_is, transposed, diagonal } kind;
    };
    std::vector<Source> source_;  ///< (entries) where the values come from
    std::vector<int> diagonal_;   ///< (rows) entries
    std::span<const double> values_;
    AlignedArray<float> rounded_;  ///< (entries, 9) each block by columns
};

}  // namespace pliant::linalg
