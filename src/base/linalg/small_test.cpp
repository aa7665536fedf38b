#include "base/linalg/small.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>

#include "base/core/near.hpp"

using namespace pliant::linalg;
using pliant::near;

TEST_CASE("the signed SVD rebuilds F from two rotations, mirrored and flat matrices too") {
    std::srand(3);
    for (int trial = 0; trial < 200; ++trial) {
        Matrix3 F = Matrix3::Random();
        if (trial % 5 == 0) F.col(2) = F.col(1);
        if (trial % 7 == 0) F.setZero();
        const Svd3 svd = signed_svd(F);
        CHECK((svd.U * svd.sigma.asDiagonal() * svd.V.transpose() - F).norm() < 1e-12);
        CHECK(svd.U.determinant() == near(1, {.relative = 1e-12}));
        CHECK(svd.V.determinant() == near(1, {.relative = 1e-12}));
        CHECK(svd.sigma[0] >= svd.sigma[1]);
        CHECK(svd.sigma[1] >= std::fabs(svd.sigma[2]) - 1e-15);
        CHECK(nearest_rotation(F).determinant() == near(1, {.relative = 1e-12}));
    }
}

TEST_CASE("the signed SVD finds the singular values of matrices of any scale and condition") {
    std::srand(4);
    for (int trial = 0; trial < 300; ++trial) {
        Matrix3 F = Matrix3::Random();
        F.col(trial % 3) *= std::pow(10, -(trial % 9));
        F *= std::pow(10, 20 * (trial % 5) - 40);
        const Svd3 svd = signed_svd(F);
        const Eigen::JacobiSVD<Matrix3> other(F);
        for (int k = 0; k < 3; ++k)
            CHECK(std::fabs(svd.sigma[k]) ==
                  near(other.singularValues()[k], {.absolute = 1e-14 * other.singularValues()[0]}));
        CHECK(svd.sigma.prod() * F.determinant() >= 0);
        CHECK((svd.U.transpose() * svd.U - Matrix3::Identity()).norm() < 1e-12);
        // Where two signed singular values nearly cancel each other, the nearest rotation is not well defined.
        if (svd.sigma[1] + svd.sigma[2] > 1e-3 * svd.sigma[0])
            CHECK((nearest_rotation(F) - svd.U * svd.V.transpose()).norm() < 1e-11);
    }
}

TEST_CASE("the gradient of the nearest rotation agrees with differences") {
    std::srand(5);
    for (int trial = 0; trial < 20; ++trial) {
        const Matrix3 F = Matrix3::Identity() + 0.5 * Matrix3::Random();
        const Matrix3 dF = Matrix3::Random();
        const double h = 1e-6;
        const Matrix3 difference = (nearest_rotation(F + h * dF) - nearest_rotation(F - h * dF)) / (2 * h);
        Eigen::Matrix<double, 9, 1> step = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dF.data());
        const Eigen::Matrix<double, 9, 1> dR = nearest_rotation_gradient(signed_svd(F)) * step;
        CHECK((Eigen::Map<const Matrix3>(dR.data()) - difference).norm() < 1e-6 * (1 + difference.norm()));
    }
}

TEST_CASE("positive eigenvalues stay, negative ones become small positive ones") {
    std::srand(9);
    const Matrix9 A = Matrix9::Random();
    const Matrix9 positive = A * A.transpose();
    CHECK((with_positive_eigenvalues(positive) - positive).norm() < 1e-12 * positive.norm());
    const Matrix9 mixed = 0.5 * (A + A.transpose());
    const Matrix9 projected = with_positive_eigenvalues(mixed);
    CHECK(Eigen::SelfAdjointEigenSolver<Matrix9>(projected).eigenvalues().minCoeff() > -1e-12);
    const Eigen::SelfAdjointEigenSolver<Matrix9> before(mixed), after(projected);
    for (int k = 0; k < 9; ++k) {
        const auto v = before.eigenvectors().col(k);
        const double value = before.eigenvalues()[k];
        CHECK((projected * v - (value > 0 ? value : -weak_share * value) * v).norm() < 1e-12 * mixed.norm());
    }
    CHECK(after.eigenvalues()[0] > 0);
}
