// A stiffness matrix by rows, both triangles, for products in double and, where low accuracy suffices, single
// precision.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/row_products.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Blocks of 3 by 3. Row i has entries start[i] .. start[i + 1], in ascending order of `column`. Each number is stored
/// as the sum of two floats, the second being the rounding error of the first: about 14 digits. Products in single
/// precision read the first float only.
class BlockRows {
public:
    /// Precondition: blocks of 3.
    explicit BlockRows(const SymmetricPattern& pattern);

    /// Copies the values of the pattern.
    void set(std::span<const double> values);
    /// Adds `share` of the difference from the present matrix to `values`.
    void move_towards(std::span<const double> values, double share);

    [[nodiscard]] int rows() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] Eigen::Matrix3d block(int entry) const {
        const std::size_t at = 9 * static_cast<std::size_t>(entry);
        return Eigen::Map<const Eigen::Matrix3f>(rounded_.data() + at).cast<double>() +
               Eigen::Map<const Eigen::Matrix3f>(rest_.data() + at).cast<double>();
    }
    /// For kernels; valid as long as this is.
    [[nodiscard]] RowBlocks blocks() const { return {start.data(), column.data(), rounded_.data(), rest_.data()}; }
    [[nodiscard]] Eigen::Matrix3d diagonal(int row) const { return block(diagonal_[row]); }
    /// y (3 rows, columns) <- A x, for one column or two interleaved ones (multiply_rows). On all cores; bit-identical
    /// on any number of them.
    void multiply(const double* x, double* y, int columns = 1) const;
    void multiply(const float* x, float* y, int columns = 1) const;

    std::vector<int> start;   ///< (rows + 1)
    std::vector<int> column;  ///< (entries)

private:
    template <class Visit>
    void for_blocks(std::span<const double> values, const Visit& visit) const;
    void put(int entry, const Eigen::Matrix3d& block) const;
    // Entries from the diagonal on have the order of the pattern's column of the same node; the others do not.
    std::vector<int> diagonal_;    ///< (rows) entry of the diagonal block
    std::vector<int> first_pair_;  ///< (rows) its pair in the pattern
    std::vector<int> left_;        ///< (entries left of the diagonal) pair in the pattern
    AlignedArray<float> rounded_;  ///< (entries, 9) each block by columns
    AlignedArray<float> rest_;     ///< (entries, 9) rounding errors of `rounded_`
};

}  // namespace pliant::linalg
