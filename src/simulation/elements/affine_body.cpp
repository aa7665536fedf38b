#include "simulation/elements/affine_body.hpp"

#include <Eigen/LU>
#include <cmath>

#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/node_blocks.hpp"

namespace pliant::sim {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::Vector3;

AffineBody::AffineBody(std::array<int, 4> nodes, double stiffness_J, std::span<const double> rest)
    : nodes_(nodes), stiffness_(stiffness_J), centre_(centre(rest)) {
    Matrix3 arms;
    for (int k = 0; k < 3; ++k)
        arms.col(k) = linalg::view(rest, nodes[static_cast<std::size_t>(k) + 1]) - linalg::view(rest, nodes[0]);
    const Matrix3 inverse = arms.inverse();
    for (int k = 0; k < 3; ++k) gradients_[static_cast<std::size_t>(k) + 1] = inverse.row(k).transpose();
    gradients_[0] = -(gradients_[1] + gradients_[2] + gradients_[3]);
}

Matrix3 AffineBody::deformation(std::span<const double> x) const {
    Matrix3 A = Matrix3::Zero();
    for (std::size_t a = 0; a < 4; ++a) A += linalg::view(x, nodes_[a]) * gradients_[a].transpose();
    return A;
}

Vector3 AffineBody::centre(std::span<const double> x) const {
    Vector3 mean = Vector3::Zero();
    for (const int node : nodes_) mean += 0.25 * linalg::view(x, node);
    return mean;
}

std::array<double, 4> AffineBody::shares(const Vector3& rest_point) const {
    std::array<double, 4> shares{};
    for (std::size_t a = 0; a < 4; ++a) shares[a] = 0.25 + gradients_[a].dot(rest_point - centre_);
    return shares;
}

double AffineBody::node_stiffness() const {
    double sum = 0;
    for (const Vector3& g : gradients_) sum += 0.25 * g.squaredNorm();
    return 2 * stiffness_ * sum;
}

double AffineBody::energy(std::span<const double> x) const {
    const Matrix3 A = deformation(x);
    return 0.25 * stiffness_ * (A.transpose() * A - Matrix3::Identity()).squaredNorm();
}

Matrix3 AffineBody::stress(const Matrix3& A) const {
    return stiffness_ * A * (A.transpose() * A - Matrix3::Identity());
}

Matrix3 AffineBody::stress_change(const Matrix3& A, const Matrix3& dA) const {
    const Matrix3 C = A.transpose() * A - Matrix3::Identity();
    return stiffness_ * (dA * C + A * (dA.transpose() * A + A.transpose() * dA));
}

/// forces += P gₐ.
void AffineBody::add(const Matrix3& P, std::span<double> forces) const {
    for (std::size_t a = 0; a < 4; ++a) {
        Eigen::Map<Vector3> force(forces.data() + 3 * static_cast<std::size_t>(nodes_[a]));
        force += P * gradients_[a];
    }
}

void AffineBody::add_gradient(std::span<const double> x, std::span<double> forces) const {
    add(stress(deformation(x)), forces);
}

/// With L the gradient of the motion, gₐ changes by −Lᵀ gₐ, A by −A L and the relative stiffness by tr L.
void AffineBody::add_rest_product(std::span<const double> x, std::span<const double> motion,
                                  std::span<double> forces) const {
    const Matrix3 A = deformation(x), L = deformation(motion), P = stress(A);
    add(L.trace() * P + stress_change(A, -A * L) - P * L.transpose(), forces);
}

/// The change of the stress is symmetric in the perturbation and the weights.
void AffineBody::add_rest_weights(std::span<const double> x, std::span<const double> weights,
                                  std::span<double> result) const {
    const Matrix3 A = deformation(x), G = deformation(weights), P = stress(A);
    add(P.cwiseProduct(G).sum() * Matrix3::Identity() - A.transpose() * stress_change(A, G) - G.transpose() * P,
        result);
}

void AffineBody::add_hessian(std::span<const double> x, const std::vector<int>& index,
                             const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    const Matrix3 A = deformation(x);
    add_blocks([&](const Matrix3& dA) { return stress_change(A, dA); }, index, pattern, values, project);
}

Matrix3 AffineBody::mean_stress(std::span<const double> start, std::span<const double> x) const {
    const Matrix3 A = deformation(x), begin = deformation(start);
    return stiffness_ * (0.5 * (A.transpose() * A + begin.transpose() * begin) - Matrix3::Identity());
}

double AffineBody::mean_energy(std::span<const double> start, std::span<const double> x, const Matrix3& stress) const {
    const Matrix3 change = deformation(x) - deformation(start);
    return mean_stress(start, x).squaredNorm() / (2 * stiffness_) - 0.25 * change.cwiseProduct(change * stress).sum();
}

void AffineBody::add_mean_gradient(std::span<const double> start, std::span<const double> x, const Matrix3& stress,
                                   std::span<double> forces) const {
    const Matrix3 A = deformation(x);
    add(A * mean_stress(start, x) - 0.5 * (A - deformation(start)) * stress, forces);
}

void AffineBody::add_mean_hessian(std::span<const double> start, std::span<const double> x, const Matrix3& stress,
                                  const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                                  std::span<double> values, bool project) const {
    const Matrix3 A = deformation(x), mean = mean_stress(start, x);
    const auto change = [&](const Matrix3& dA) -> Matrix3 {
        return dA * mean + 0.5 * stiffness_ * A * (dA.transpose() * A + A.transpose() * dA) - 0.5 * dA * stress;
    };
    add_blocks(change, index, pattern, values, project);
}

void AffineBody::add_blocks(const std::function<Matrix3(const Matrix3&)>& change, const std::vector<int>& index,
                            const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    Matrix9 H;
    for (int k = 0; k < 9; ++k) {
        Matrix3 dA = Matrix3::Zero();
        dA(k % 3, k / 3) = 1;
        const Matrix3 dP = change(dA);
        H.col(k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dP.data());
    }
    if (project) H = linalg::positive_part(0.5 * (H + H.transpose()));
    add_node_blocks(nodes_, index, pattern, values, [&](std::size_t a, std::size_t b) {
        Matrix3 block = Matrix3::Zero();
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) block += gradients_[a][k] * gradients_[b][l] * H.block<3, 3>(3 * k, 3 * l);
        }
        return block;
    });
}

void AffineBody::add_hold(double stiffness_N_m, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                          std::span<double> values) const {
    constexpr double share = 1.0 / 4;  // of each node in their mean
    add_node_blocks(nodes_, index, pattern, values, [&](std::size_t a, std::size_t b) -> Matrix3 {
        return stiffness_N_m * ((a == b ? 1 : 0) - share) * Matrix3::Identity();
    });
}

double AffineBody::size(std::span<const double> x) const {
    const Vector3 mean = centre(x);
    double sum = 0;
    for (const int node : nodes_) sum += (linalg::view(x, node) - mean).squaredNorm();
    return std::sqrt(sum / 4);
}

void AffineBody::append_clique(const std::vector<int>& index, linalg::Lists& cliques) const {
    append_node_clique(nodes_, index, cliques);
}

}  // namespace pliant::sim
