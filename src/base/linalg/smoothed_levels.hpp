// The preconditioner of TwoLevel: smoothing on the fine level, a factorised coarse level.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/block_rows.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/coarse_level.hpp"
#include "base/linalg/interleaved.hpp"

namespace pliant::linalg {

constexpr std::size_t most_columns = 2;  ///< solved for together: each number of the matrix is read for both

/// M^-1, symmetric and positive definite: smooths with Chebyshev polynomials of D^-1 A (Adams, Brezina, Hu and Tuminaro
/// 2003), corrects on the coarse level, smooths again.
class SmoothedLevels {
public:
    enum class Kind { groups, corners };
    /// Preconditions: `matrix` has the blocks of `pattern`, which are 3 by 3, and `space` was made for them.
    SmoothedLevels(const SymmetricPattern& pattern, BlockRows matrix, std::unique_ptr<CoarseLevel> space, Kind kind);

    /// See TwoLevel::set(); `values` must stay valid until the next call. False: not positive definite.
    [[nodiscard]] bool set(std::span<const double> values, std::span<const double> positions);
    /// Builds the coarse level for the present matrix and positions; false: not positive definite.
    [[nodiscard]] bool build();
    /// True if the coarse level was made for an earlier matrix, and rotated.
    [[nodiscard]] bool is_turned() const { return turned_; }

    /// M^-1 right, of `columns` interleaved columns (up to most_columns); valid until the next call.
    [[nodiscard]] const Interleaved<float>& apply(const Interleaved<double>& right, std::size_t columns);

    [[nodiscard]] const BlockRows& matrix() const { return matrix_; }
    [[nodiscard]] std::size_t size() const { return size_; }  ///< of one column

private:
    using Rough = Interleaved<float>;
    enum class Start { zero, where_it_is };
    void set_columns(std::size_t count);
    [[nodiscard]] bool invert_diagonal();
    void apply_inverse_diagonal(const Rough& from, Rough& to) const;
    void find_largest_by_powers();
    void find_largest_by_lanczos();
    /// Upper end of the spectrum of D^-1 A.
    [[nodiscard]] float upper() const;
    void smoothe(Rough& x, Start start);
    void advance(Rough& x, Start start, float keep, float share);
    template <std::size_t count>
    void advance_columns(Rough& x, Start start, float keep, float share);
    void correct();

    std::size_t size_;
    Kind kind_;
    std::size_t columns_ = 1;
    BlockRows matrix_;
    std::unique_ptr<CoarseLevel> space_;
    Cholesky coarse_;
    AlignedArray<float> inverse_diagonal_;
    std::size_t coarse_size_;
    std::vector<double> coarse_side_;  ///< (columns, coarse unknowns)
    Rough top_;                        ///< groups: approximate eigenvector of D^-1 A for the largest eigenvalue
    float largest_ = 0;                ///< that eigenvalue
    bool powered_ = false;             ///< both were found for an earlier matrix
    Rough side_, correction_, step_, rest_;
    Rough one_;                       ///< work space for a single column
    std::span<const double> values_;  ///< of the matrix
    std::vector<double> positions_;   ///< current node positions
    bool built_ = false;              ///< the coarse level exists,
    bool turned_ = false;             ///< but was made for an earlier state
};

}  // namespace pliant::linalg
