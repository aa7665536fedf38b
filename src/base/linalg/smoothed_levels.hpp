// The preconditioner of TwoLevel: smoothing on the fine level, and a coarse level.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/coarse_level.hpp"
#include "base/linalg/coarse_solver.hpp"
#include "base/linalg/interleaved.hpp"
#include "base/linalg/nested_space.hpp"
#include "base/linalg/symmetric_blocks.hpp"

namespace pliant::linalg {

constexpr std::size_t most_columns = 2;  ///< solved for together: each number of the matrix is read for both

/// M^-1, symmetric and positive definite: smooths with Chebyshev polynomials of D^-1 A (Adams, Brezina, Hu and Tuminaro
/// 2003), corrects on the coarse level, smooths again.
class SmoothedLevels {
public:
    enum class Kind { groups, corners };
    /// Preconditions: `matrix` has the blocks of `pattern`, which are 3 by 3, `space` was made for them, and `coarse`
    /// for the pattern of `space`.
    SmoothedLevels(const SymmetricPattern& pattern, SymmetricBlocks matrix, std::unique_ptr<CoarseLevel> space,
                   std::unique_ptr<CoarseSolver> coarse, Kind kind);

    /// See TwoLevel.
    void take(std::span<const double> values, std::span<const double> positions);
    void move_towards(std::span<const double> values, double share);
    [[nodiscard]] bool prepare(Reuse reuse);
    /// Makes a level that was turned anew; false: not positive definite. Precondition: is_turned().
    [[nodiscard]] bool build();
    /// True if a coarse level was made for an earlier matrix, and rotated.
    [[nodiscard]] bool is_turned() const { return turned_ || coarse_->is_turned(); }

    /// M^-1 right, of `columns` interleaved columns (up to most_columns); valid until the next call.
    [[nodiscard]] const Interleaved<float>& apply(const Interleaved<double>& right, std::size_t columns);

    [[nodiscard]] SymmetricBlocks& matrix() { return matrix_; }
    [[nodiscard]] std::size_t size() const { return size_; }  ///< of one column

private:
    using Rough = Interleaved<float>;
    enum class Start { zero, where_it_is };
    [[nodiscard]] bool set_coarse(Reuse reuse);
    void set_columns(std::size_t count);
    [[nodiscard]] bool invert_diagonal();
    void apply_inverse_diagonal(const Rough& from, Rough& to) const;
    void find_largest();
    void find_largest_by_powers();
    void raise_largest();
    [[nodiscard]] float step_of_powers();
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
    SymmetricBlocks matrix_;
    std::unique_ptr<CoarseLevel> space_;
    std::unique_ptr<CoarseSolver> coarse_;
    AlignedArray<float> inverse_diagonal_;
    std::size_t coarse_size_;
    std::vector<double> coarse_side_;  ///< (columns, coarse unknowns)
    Rough top_;                        ///< groups: approximate eigenvector of D^-1 A for the largest eigenvalue,
    float largest_of_base_ = 0;        ///< and that eigenvalue, both of the matrix that the coarse level was made for
    float largest_ = 0;                ///< that eigenvalue of the present matrix
    Rough side_, correction_, step_, rest_;
    Rough one_;                      ///< work space for a single column
    std::vector<double> positions_;  ///< current node positions
    bool built_ = false;             ///< the coarse level exists,
    bool turned_ = false;            ///< but was made for an earlier state
};

/// With groups of nodes as the coarse level, which is factorised. Precondition: blocks of 3.
[[nodiscard]] SmoothedLevels levels_on_groups(const SymmetricPattern& pattern);
/// With the corners of quadratic tets as the coarse level, which is factorised or, if there are more than
/// `most_factored`, solved on groups.
[[nodiscard]] SmoothedLevels levels_on_corners(const SymmetricPattern& pattern, Nesting corners, int most_factored);

}  // namespace pliant::linalg
