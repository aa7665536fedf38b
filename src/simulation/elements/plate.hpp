// A rigid plate glued to the body: its nodes keep their shape and move as one.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

/// A rigid target shape (thesis, 3.2) for a whole set of nodes, stiff enough to count as rigid:
///   E = k/2 min over R, t of sum_i |x_i - R X_i - t|^2,    f_i = -k (x_i - x_mean - R X_i),
/// with rest positions X from their mean and R the rotation nearest to A = sum_i x_i X_i^T (Horn 1988; Müller et al.
/// 2005, "Meshless deformations based on shape matching"). The Hessian is exact:
///   H_ij = k (delta_ij I - I/n - d(R X_i)/dA X_j).
class Plate {
public:
    /// `rest` (3n). Preconditions: at least three nodes that are not on one line, stiffness above zero.
    Plate(std::vector<int> nodes, double stiffness_N_m, std::span<const double> rest);

    [[nodiscard]] double energy(std::span<const double> x) const;
    /// forces (3n) += gradient of the energy.
    void add_gradient(std::span<const double> x, std::span<double> forces) const;
    /// For a pattern over free nodes (block 3) that holds all pairs of the plate's nodes. `project`: without the
    /// negative curvature that rotations have where the nodes are nearer to their mean than at rest.
    void add_hessian(std::span<const double> x, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;
    /// forces (3n) += the change of that gradient with a motion (3n) of the rest positions, at the same stiffness.
    void add_rest_product(std::span<const double> x, std::span<const double> motion, std::span<double> forces) const;
    /// result (3n) += the transpose of that product with `weights` (3n) of the forces.
    void add_rest_weights(std::span<const double> x, std::span<const double> weights, std::span<double> result) const;
    void append_clique(const std::vector<int>& free_index, linalg::Lists& cliques) const;
    [[nodiscard]] std::size_t node_count() const { return nodes_.size(); }
    [[nodiscard]] double stiffness_N_m() const { return stiffness_; }

private:
    struct Pose {
        linalg::Vector3 mean;
        linalg::Matrix3 A;  ///< sum of x_i X_i^T
    };
    [[nodiscard]] Pose pose(std::span<const double> x) const;
    [[nodiscard]] linalg::Matrix9 without_negative_curvature(const linalg::Matrix9& rotation_gradient) const;

    std::vector<int> nodes_;
    std::vector<linalg::Vector3> rest_;  ///< from their mean
    double stiffness_;
};

}  // namespace pliant::sim
