#include "base/linalg/small.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace pliant::linalg {

Svd3 signed_svd(const Matrix3& F) {
    const Eigen::JacobiSVD<Matrix3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Svd3 result{svd.matrixU(), svd.singularValues(), svd.matrixV()};
    if (result.U.determinant() < 0) {
        result.U.col(2) = -result.U.col(2);
        result.sigma[2] = -result.sigma[2];
    }
    if (result.V.determinant() < 0) {
        result.V.col(2) = -result.V.col(2);
        result.sigma[2] = -result.sigma[2];
    }
    return result;
}

Matrix3 nearest_rotation(const Matrix3& F) {
    const Svd3 svd = signed_svd(F);
    return svd.U * svd.V.transpose();
}

Matrix9 nearest_rotation_gradient(const Svd3& svd) {
    Matrix9 gradient;
    const double floor = 1e-9 * std::fabs(svd.sigma[0]) + 1e-300;
    for (int k = 0; k < 9; ++k) {
        Matrix3 dF = Matrix3::Zero();
        dF(k % 3, k / 3) = 1;
        const Matrix3 A = svd.U.transpose() * dF * svd.V;
        Matrix3 B = Matrix3::Zero();  // skew: the infinitesimal rotation seen in the singular frames
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                if (i == j) continue;
                const double sum = svd.sigma[i] + svd.sigma[j];
                B(i, j) = (A(i, j) - A(j, i)) / (std::fabs(sum) > floor ? sum : floor);
            }
        }
        const Matrix3 dR = svd.U * B * svd.V.transpose();
        gradient.col(k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dR.data());
    }
    return gradient;
}

Matrix9 with_positive_eigenvalues(const Matrix9& H) {
    const Matrix9 symmetric = 0.5 * (H + H.transpose());
    const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(symmetric);
    if (eigen.eigenvalues()[0] >= 0) return symmetric;
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(-weak_share * eigen.eigenvalues()).asDiagonal() *
           eigen.eigenvectors().transpose();
}

}  // namespace pliant::linalg
