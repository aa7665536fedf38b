#include "base/linalg/gmres.hpp"

#include <Eigen/Jacobi>
#include <vector>

namespace pliant::linalg {

Eigen::VectorXd gmres(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& multiply, const Eigen::VectorXd& b,
                      double tolerance, int limit) {
    const double size = b.norm();
    if (!(size > 0)) return Eigen::VectorXd::Zero(b.size());
    std::vector<Eigen::VectorXd> basis = {b / size};  // of the Krylov space, orthonormal
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(limit + 1, limit);
    Eigen::VectorXd rest = Eigen::VectorXd::Zero(limit + 1);  // b in the basis, rotated like H
    rest[0] = size;
    std::vector<Eigen::JacobiRotation<double>> rotations;
    Eigen::Index k = 0;
    while (k < limit && std::abs(rest[k]) > tolerance * size) {
        Eigen::VectorXd next = multiply(basis.back());
        for (Eigen::Index i = 0; i <= k; ++i) {
            H(i, k) = basis[static_cast<std::size_t>(i)].dot(next);
            next -= H(i, k) * basis[static_cast<std::size_t>(i)];
        }
        H(k + 1, k) = next.norm();
        const bool exhausted = !(H(k + 1, k) > 1e-14 * size);
        if (!exhausted) basis.push_back(next / H(k + 1, k));
        for (Eigen::Index i = 0; i < k; ++i) H.col(k).applyOnTheLeft(i, i + 1, rotations[static_cast<std::size_t>(i)]);
        Eigen::JacobiRotation<double> rotation;
        rotation.makeGivens(H(k, k), H(k + 1, k));
        H.col(k).applyOnTheLeft(k, k + 1, rotation.adjoint());
        rest.applyOnTheLeft(k, k + 1, rotation.adjoint());
        rotations.push_back(rotation.adjoint());
        ++k;
        if (exhausted) break;
    }
    if (k == 0) return Eigen::VectorXd::Zero(b.size());
    const Eigen::VectorXd y = H.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(rest.head(k));
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(b.size());
    for (Eigen::Index i = 0; i < k; ++i) sum += y[i] * basis[static_cast<std::size_t>(i)];
    return sum;
}

}  // namespace pliant::linalg
