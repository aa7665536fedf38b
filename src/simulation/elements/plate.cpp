#include "simulation/elements/plate.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/node_blocks.hpp"

namespace pliant::sim {

Plate::Plate(std::vector<int> nodes, double stiffness_N_m, std::span<const double> rest)
    : nodes_(std::move(nodes)), stiffness_(stiffness_N_m) {
    linalg::Vector3 mean = linalg::Vector3::Zero();
    for (const int node : nodes_) mean += linalg::view(rest, node) / static_cast<double>(nodes_.size());
    for (const int node : nodes_) rest_.emplace_back(linalg::view(rest, node) - mean);
}

Plate::Pose Plate::pose(std::span<const double> x) const {
    Pose pose{linalg::Vector3::Zero(), linalg::Matrix3::Zero()};
    for (const int node : nodes_) pose.mean += linalg::view(x, node) / static_cast<double>(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) pose.A += linalg::view(x, nodes_[i]) * rest_[i].transpose();
    return pose;
}

double Plate::energy(std::span<const double> x) const {
    const Pose p = pose(x);
    const linalg::Matrix3 R = linalg::nearest_rotation(p.A);
    double sum = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        sum += (linalg::view(x, nodes_[i]) - p.mean - R * rest_[i]).squaredNorm();
    return 0.5 * stiffness_ * sum;
}

void Plate::add_gradient(std::span<const double> x, std::span<double> forces) const {
    const Pose p = pose(x);
    const linalg::Matrix3 R = linalg::nearest_rotation(p.A);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Eigen::Map<linalg::Vector3> force(forces.data() + 3 * static_cast<std::size_t>(nodes_[i]));
        force += stiffness_ * (linalg::view(x, nodes_[i]) - p.mean - R * rest_[i]);
    }
}

void Plate::add_hessian(std::span<const double> x, const std::vector<int>& free_index,
                        const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    linalg::Matrix9 dR = linalg::nearest_rotation_gradient(linalg::signed_svd(pose(x).A));
    if (project) dR = without_negative_curvature(dR);
    const double share = 1.0 / static_cast<double>(nodes_.size());
    // d(R X_i) = dR (dx_j X_j^T) X_i; vec() stacks columns, so that vec(a b^T) = b (x) a.
    std::vector<Eigen::Matrix<double, 3, 9>> turned(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        turned[i].setZero();
        for (int c = 0; c < 3; ++c) turned[i] += rest_[i][c] * dR.middleRows<3>(3 * c);
    }
    for (std::size_t b = 0; b < nodes_.size(); ++b) {
        const int j = free_index[static_cast<std::size_t>(nodes_[b])];
        if (j < 0) continue;
        for (std::size_t a = 0; a < nodes_.size(); ++a) {
            const int i = free_index[static_cast<std::size_t>(nodes_[a])];
            if (i < j) continue;
            linalg::Matrix3 block = (a == b ? 1 - share : -share) * linalg::Matrix3::Identity();
            for (int c = 0; c < 3; ++c) block -= rest_[b][c] * turned[a].middleCols<3>(3 * c);
            pattern.add_block(values, i, j, [&](int r, int c) { return stiffness_ * block(r, c); });
        }
    }
}

/// A motion u of the nodes, with dA = sum_i u_i X_i^T, has the curvature k (|u|^2 - dA : dR dA), at least if u has the
/// mean zero. Of all motions with this dA the shortest has |u|^2 = |dA S^(-1/2)|^2, S = sum_i X_i X_i^T; so the
/// eigenvalues of S^(1/2) dR S^(1/2) must not exceed 1.
linalg::Matrix9 Plate::without_negative_curvature(const linalg::Matrix9& rotation_gradient) const {
    linalg::Matrix3 S = linalg::Matrix3::Zero();
    for (const linalg::Vector3& X : rest_) S += X * X.transpose();
    const Eigen::SelfAdjointEigenSolver<linalg::Matrix3> axes(S);
    constexpr double flat = 1e-12;  // nodes in a plane span no third direction
    Eigen::Vector3d root, inverse;
    for (int i = 0; i < 3; ++i) {
        const double value = axes.eigenvalues()[i];
        root[i] = value > flat * axes.eigenvalues()[2] ? std::sqrt(value) : 0;
        inverse[i] = root[i] > 0 ? 1 / root[i] : 0;
    }
    // (B (x) I) vec(M) = vec(M B) for symmetric B.
    const auto on_columns = [&](const Eigen::Vector3d& factors) {
        const linalg::Matrix3 B = axes.eigenvectors() * factors.asDiagonal() * axes.eigenvectors().transpose();
        linalg::Matrix9 product;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) product.block<3, 3>(3 * r, 3 * c) = B(r, c) * linalg::Matrix3::Identity();
        return product;
    };
    const linalg::Matrix9 K = on_columns(root), K_inverse = on_columns(inverse);
    const Eigen::SelfAdjointEigenSolver<linalg::Matrix9> modes(K * rotation_gradient * K);
    if (!(modes.eigenvalues()[8] > 1)) return rotation_gradient;
    const linalg::Matrix9 kept =
        modes.eigenvectors() * modes.eigenvalues().cwiseMin(1.0).asDiagonal() * modes.eigenvectors().transpose();
    return K_inverse * kept * K_inverse;
}

void Plate::add_rest_product(std::span<const double> x, std::span<const double> motion,
                             std::span<double> forces) const {
    const Pose p = pose(x);
    linalg::Vector3 mean = linalg::Vector3::Zero();
    for (const int node : nodes_) mean += linalg::view(motion, node) / static_cast<double>(nodes_.size());
    linalg::Matrix3 dA = linalg::Matrix3::Zero();
    for (const int node : nodes_) dA += linalg::view(x, node) * (linalg::view(motion, node) - mean).transpose();
    const linalg::Matrix3 R = linalg::nearest_rotation(p.A);
    const Eigen::Matrix<double, 9, 1> change = linalg::nearest_rotation_gradient(linalg::signed_svd(p.A)) *
                                               Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dA.data());
    const linalg::Matrix3 dR = Eigen::Map<const linalg::Matrix3>(change.data());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Eigen::Map<linalg::Vector3> force(forces.data() + 3 * static_cast<std::size_t>(nodes_[i]));
        force -= stiffness_ * (R * (linalg::view(motion, nodes_[i]) - mean) + dR * rest_[i]);
    }
}

void Plate::add_rest_weights(std::span<const double> x, std::span<const double> weights,
                             std::span<double> result) const {
    const Pose p = pose(x);
    linalg::Matrix3 W = linalg::Matrix3::Zero();
    for (std::size_t i = 0; i < nodes_.size(); ++i) W += linalg::view(weights, nodes_[i]) * rest_[i].transpose();
    const linalg::Matrix3 R = linalg::nearest_rotation(p.A);
    const Eigen::Matrix<double, 9, 1> pulled = linalg::nearest_rotation_gradient(linalg::signed_svd(p.A)).transpose() *
                                               Eigen::Map<const Eigen::Matrix<double, 9, 1>>(W.data());
    const linalg::Matrix3 Z = Eigen::Map<const linalg::Matrix3>(pulled.data());
    std::vector<linalg::Vector3> change;
    linalg::Vector3 mean = linalg::Vector3::Zero();
    for (const int node : nodes_) {
        change.emplace_back(-stiffness_ *
                            (R.transpose() * linalg::view(weights, node) + Z.transpose() * linalg::view(x, node)));
        mean += change.back() / static_cast<double>(nodes_.size());
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Eigen::Map<linalg::Vector3> sum(result.data() + 3 * static_cast<std::size_t>(nodes_[i]));
        sum += change[i] - mean;
    }
}

void Plate::append_clique(const std::vector<int>& free_index, linalg::Lists& cliques) const {
    append_node_clique(nodes_, free_index, cliques);
}

}  // namespace pliant::sim
