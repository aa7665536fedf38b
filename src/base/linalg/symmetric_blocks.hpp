// A stiffness matrix by its lower triangle, for products in double and, where low accuracy suffices, single precision.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/lists.hpp"
#include "base/linalg/lower_triangle.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Blocks of 3 by 3, each pair of nodes once, in the order of the pattern. Each number is stored as the sum of two
/// floats, the second being the rounding error of the first: about 14 digits. Products in single precision read the
/// first float only.
class SymmetricBlocks {
public:
    /// Precondition: blocks of 3.
    explicit SymmetricBlocks(const SymmetricPattern& pattern);

    /// Copies the values of the pattern.
    void set(std::span<const double> values);
    /// Adds `share` of the difference from the present matrix to `values`.
    void move_towards(std::span<const double> values, double share);

    [[nodiscard]] int nodes() const { return static_cast<int>(start_.size()) - 1; }
    [[nodiscard]] Eigen::Matrix3d block(int pair) const {
        const std::size_t at = 9 * static_cast<std::size_t>(pair);
        return Eigen::Map<const Eigen::Matrix3f>(value_.data() + at).cast<double>() +
               Eigen::Map<const Eigen::Matrix3f>(rest_.data() + at).cast<double>();
    }
    [[nodiscard]] Eigen::Matrix3d diagonal(int node) const { return block(start_[node]); }
    /// For kernels; valid as long as this is.
    [[nodiscard]] LowerTriangle triangle() const {
        return {start_.data(), row_.data(), left_.column.start.data(), left_.column.item.data(), left_.pair.data(),
                value_.data(), rest_.data()};
    }
    /// The nodes to which each node is coupled, itself included, in ascending order.
    [[nodiscard]] Lists neighbours() const;
    /// Calls visit(j) for them.
    template <class Visit>
    void visit_neighbours(int node, const Visit& visit) const {
        for (const int j : left_.column[static_cast<std::size_t>(node)]) visit(j);
        for (int k = start_[node]; k < start_[node + 1]; ++k) visit(row_[k]);
    }

    /// y (3 nodes, columns) <- A x, for one column or two interleaved ones, of which each gets the bits that it would
    /// get alone. On all cores; bit-identical on any number of them. Not const: there is one work space.
    void multiply(const double* x, double* y, int columns = 1);
    void multiply(const float* x, float* y, int columns = 1);

private:
    /// Consecutive columns. A product gives numbers to their own rows and to others further down, the halo, which have
    /// places of their own behind those of the rows.
    struct Piece {
        int begin, end;           ///< columns
        std::size_t first_place;  ///< among the places of all pieces
        std::vector<int> halo;    ///< rows from `end` on, ascending
        [[nodiscard]] std::size_t own() const { return static_cast<std::size_t>(end - begin); }
        [[nodiscard]] std::size_t places() const { return own() + halo.size(); }
    };
    template <class Real>
    struct WorkSpace {
        AlignedArray<Real> from, to;  ///< (places of all pieces, columns, 4)
    };
    void make_pieces();
    void find_halo(Piece& piece);
    void find_receivers();
    template <std::size_t columns, class Real, class Multiply>
    void multiply_pieces(const Real* x, Real* y, WorkSpace<Real>& work, const Multiply& multiply) const;
    void complete_diagonal();
    void put(int pair, const Eigen::Matrix3d& block);

    std::vector<int> start_, row_;  ///< as in the pattern
    LeftBlocks left_;
    AlignedArray<float> value_, rest_;
    std::vector<Piece> pieces_;
    std::vector<int> place_;     ///< (pairs) place of the row in the piece of the column
    std::vector<int> receiver_;  ///< rows that are in the halo of a piece, ascending
    Lists received_;             ///< (receivers) their places among those of all pieces
    WorkSpace<double> double_work_;
    WorkSpace<float> float_work_;
};

}  // namespace pliant::linalg
