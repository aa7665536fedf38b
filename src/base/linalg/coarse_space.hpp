// Coarse space of low-energy motions: rigid motions of small groups of nodes, smoothed by one step with the matrix
// (smoothed aggregation: Vanek, Mandel and Brezina 1996).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/aggregates.hpp"
#include "base/linalg/coarse_level.hpp"
#include "base/linalg/group_products.hpp"
#include "base/linalg/lists.hpp"
#include "base/linalg/sparse.hpp"
#include "base/linalg/symmetric_blocks.hpp"

namespace pliant::linalg {

/// Six unknowns per group, stored as two nodes of three: its translations and its rotations.
class CoarseSpace final : public CoarseLevel {
public:
    explicit CoarseSpace(const SymmetricBlocks& matrix);

    void set(const Fine& fine) override;
    /// Always true: the coarse space of a rotated body is the old one, rotated.
    [[nodiscard]] bool turn(std::span<const double> positions) override;
    [[nodiscard]] bool turn_back() override;
    [[nodiscard]] const SymmetricPattern& pattern() const override { return pattern_; }
    [[nodiscard]] std::span<const double> values() const override { return coarse_; }
    void restrict(const float* fine, double* coarse) override;
    void add_prolonged(const double* coarse, float* fine) const override;

private:
    CoarseSpace(const SymmetricBlocks& matrix, const Lists& neighbours);
    void find_groups(const Lists& neighbours);
    void find_pattern(const SymmetricBlocks& matrix);
    void set_rigid_motions(std::span<const double> positions);
    void smooth(const SymmetricBlocks& matrix, const float* inverse_diagonal, float damping);
    void multiply(const SymmetricBlocks& matrix);
    void put(std::size_t group, std::span<const double> sums);
    [[nodiscard]] std::span<const MotionUse> uses(std::size_t group) const;
    /// Calls visit(node) for the nodes on which the motions of a group exert a force; for some of them several times.
    template <class Visit>
    void visit_reached(const SymmetricBlocks& matrix, std::size_t group, const Visit& visit) const {
        for (const MotionUse& use : uses(group)) matrix.visit_neighbours(use.node, visit);
    }

    Aggregates groups_;
    Lists members_;  ///< nodes of each group
    // P by rows of nodes, in blocks of 3 by 6, each column by column.
    Lists moving_;                        ///< groups in each row of P: their smoothed motions move the node
    std::vector<int> use_start_;          ///< (groups + 1)
    std::vector<MotionUse> use_;          ///< where each group appears in P
    AlignedArray<float> rigid_;           ///< (nodes, 18) rigid motions of the node's own group
    AlignedArray<float> prolongation_;    ///< (entries of P, 18)
    std::vector<double> positions_;       ///< (nodes, 3) at the last set()
    std::vector<Eigen::Matrix3f> turns_;  ///< (groups) rotations since then
    std::vector<float> sums_;             ///< work space
    std::vector<char> dropped_;           ///< (groups, 6) motions that a group has too few nodes for
    SymmetricPattern pattern_;
    std::vector<double> coarse_;
};

}  // namespace pliant::linalg
