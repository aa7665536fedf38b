// A torque on nodes that move as one: those of a rigid plate or object.
#pragma once

#include <span>
#include <vector>

#include "base/linalg/lists.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

/// The forces w x r_i on the nodes, with r_i from their mean and w such that sum r_i x (w x r_i) is the torque: they
/// sum to zero, and do the work of the torque in every rigid motion. The torque keeps its direction in space, so it has
/// no energy except in motions about one axis (Ziegler 1968, Principles of Structural Stability, 2.1): its tangent has
/// a skew part.
class TorqueForces {
public:
    /// At least three nodes, never collinear.
    explicit TorqueForces(std::vector<int> nodes) : nodes_(std::move(nodes)) {}

    /// forces (3n) -= forces of the torque, N m, at positions x (3n).
    void subtract_from(std::span<const double> x, const linalg::Vector3& torque_Nm, std::span<double> forces) const;
    /// Part of the tangent K = d(-forces)/dx: (K + K^T)/2 or (K - K^T)/2.
    enum class Part { symmetric, skew };
    /// For a pattern (block 3) that holds the clique; `index` (n) of each node in it, or -1.
    void add_tangent(std::span<const double> x, const linalg::Vector3& torque_Nm, Part part,
                     const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values) const;
    void append_clique(const std::vector<int>& index, linalg::Lists& cliques) const;

private:
    struct Arms {
        std::vector<linalg::Vector3> r;  ///< (nodes) from their mean
        linalg::Matrix3 inverse;         ///< of sum (|r|^2 1 - r r^T)
        linalg::Vector3 w;
    };
    [[nodiscard]] Arms arms(std::span<const double> x, const linalg::Vector3& torque_Nm) const;

    std::vector<int> nodes_;
};

}  // namespace pliant::sim
