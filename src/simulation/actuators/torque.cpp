#include "simulation/actuators/torque.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/linalg/vectors.hpp"
#include "simulation/actuators/cross_matrix.hpp"
#include "simulation/elements/node_blocks.hpp"

namespace pliant::sim {

using linalg::Matrix3;
using linalg::Vector3;

TorqueForces::Arms TorqueForces::arms(std::span<const double> x, const Vector3& torque_Nm) const {
    Arms arms;
    Vector3 mean = Vector3::Zero();
    for (const int node : nodes_) mean += linalg::view(x, node) / static_cast<double>(nodes_.size());
    Matrix3 inertia = Matrix3::Zero();
    for (const int node : nodes_) {
        const Vector3 r = linalg::view(x, node) - mean;
        inertia += r.squaredNorm() * Matrix3::Identity() - r * r.transpose();
        arms.r.push_back(r);
    }
    arms.inverse = inertia.inverse();
    arms.w = arms.inverse * torque_Nm;
    return arms;
}

void TorqueForces::subtract_from(std::span<const double> x, const Vector3& torque_Nm, std::span<double> forces) const {
    const Arms a = arms(x, torque_Nm);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Eigen::Map<Vector3> force(forces.data() + 3 * static_cast<std::size_t>(nodes_[i]));
        force -= a.w.cross(a.r[i]);
    }
}

/// With J w = torque the change of w is -J^-1 B_j dx_j, B_j = 2 w r_j^T - (r_j . w) 1 - r_j w^T; the mean of dx has no
/// effect because the r sum to zero.
void TorqueForces::add_tangent(std::span<const double> x, const Vector3& torque_Nm, Part part,
                               const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                               std::span<double> values) const {
    const Arms a = arms(x, torque_Nm);
    const Matrix3 turn = cross_matrix(a.w);
    const double share = 1.0 / static_cast<double>(nodes_.size());
    const auto block = [&](std::size_t i, std::size_t j) -> Matrix3 {
        const Vector3& r = a.r[j];
        const Matrix3 change = 2 * a.w * r.transpose() - r.dot(a.w) * Matrix3::Identity() - r * a.w.transpose();
        return -(cross_matrix(a.r[i]) * a.inverse * change + ((i == j ? 1 : 0) - share) * turn);
    };
    const double sign = part == Part::symmetric ? 1 : -1;
    add_node_blocks(nodes_, index, pattern, values, [&](std::size_t i, std::size_t j) -> Matrix3 {
        return 0.5 * (block(i, j) + sign * block(j, i).transpose());
    });
}

void TorqueForces::append_clique(const std::vector<int>& index, linalg::Lists& cliques) const {
    append_node_clique(nodes_, index, cliques);
}

}  // namespace pliant::sim
