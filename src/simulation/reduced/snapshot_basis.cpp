#include "simulation/reduced/snapshot_basis.hpp"

#include <algorithm>

#include "base/linalg/dense.hpp"

namespace pliant::sim::reduced {
namespace {

constexpr double rounding = 1e-12;  // of the largest eigenvalue: modes below it are noise

/// Makes the columns orthonormal again: the eigenvectors of the small matrix lose digits for weak modes.
void orthonormalise(Eigen::MatrixXd& basis) {
    for (int round = 0; round < 2; ++round) {
        for (Eigen::Index k = 0; k < basis.cols(); ++k) {
            for (Eigen::Index j = 0; j < k; ++j) basis.col(k) -= basis.col(j).dot(basis.col(k)) * basis.col(j);
            basis.col(k).normalize();
        }
    }
}

}  // namespace

Eigen::MatrixXd snapshot_basis(const Eigen::MatrixXd& snapshots, double error, int most) {
    if (snapshots.cols() == 0) return Eigen::MatrixXd(snapshots.rows(), 0);
    const linalg::Eigenpairs pairs = linalg::symmetric_eigenpairs(snapshots.transpose() * snapshots);
    const Eigen::Index count = pairs.values.size();
    const double all = std::max(0.0, pairs.values.sum());
    const double least = rounding * (count > 0 ? pairs.values[count - 1] : 0);
    double left = all;
    Eigen::Index modes = 0;
    while (modes < std::min<Eigen::Index>(count, most) && left > error * error * all) {
        const double value = pairs.values[count - 1 - modes];
        if (!(value > least)) break;
        left -= value;
        ++modes;
    }
    Eigen::MatrixXd basis(snapshots.rows(), modes);
    for (Eigen::Index k = 0; k < modes; ++k) basis.col(k) = snapshots * pairs.vectors.col(count - 1 - k);
    orthonormalise(basis);
    return basis;
}

}  // namespace pliant::sim::reduced
