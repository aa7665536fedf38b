#include "base/linalg/dense.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::linalg;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Pseudo-random numbers in [-1, 1].
MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
    MatrixXd A(rows, columns);
    for (double& a : A.reshaped()) {
        seed = seed * 1664525U + 1013904223U;
        a = static_cast<double>(seed >> 8) / (1U << 23) - 1;
    }
    return A;
}

double off(const MatrixXd& a, const MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("eigenpairs of a symmetric matrix give it back") {
    const MatrixXd A = random_matrix(7, 7, 1), S = A + A.transpose();
    const Eigenpairs found = symmetric_eigenpairs(S);
    CHECK(off(found.vectors * found.values.asDiagonal() * found.vectors.transpose(), S) < 1e-13);
    CHECK(off(found.vectors.transpose() * found.vectors, MatrixXd::Identity(7, 7)) < 1e-13);
    for (Eigen::Index k = 1; k < 7; ++k) CHECK(found.values[k] >= found.values[k - 1]);
}

TEST_CASE("a positive definite matrix is solved with, any other is refused") {
    const MatrixXd B = random_matrix(9, 5, 3), M = B.transpose() * B, A = random_matrix(5, 5, 2);
    const VectorXd b = A.col(0);
    const auto x = positive_solution(M, b);
    REQUIRE(x);
    CHECK(off(M * *x, b) < 1e-13);
    const auto inverse = positive_inverse(M);
    REQUIRE(inverse);
    CHECK(off(M * *inverse, MatrixXd::Identity(5, 5)) < 1e-13);
    MatrixXd indefinite = M;
    indefinite(3, 3) = -1;
    CHECK(!positive_solution(indefinite, b));
    CHECK(!positive_inverse(indefinite));
}

TEST_CASE("generalized eigenpairs satisfy their equation, and need a positive definite M") {
    const MatrixXd A = random_matrix(5, 5, 2), B = random_matrix(9, 5, 3), K = A + A.transpose(), M = B.transpose() * B;
    const auto found = generalized_eigenpairs(K, M);
    REQUIRE(found);
    CHECK(off(K * found->vectors, M * found->vectors * found->values.asDiagonal()) < 1e-12);
    CHECK(off(found->vectors.transpose() * M * found->vectors, MatrixXd::Identity(5, 5)) < 1e-12);
    CHECK(!generalized_eigenpairs(K, -M));
}

TEST_CASE("the positive part keeps positive eigenvalues and drops the others") {
    const MatrixXd Q = symmetric_eigenpairs(random_matrix(4, 4, 4) + random_matrix(4, 4, 4).transpose()).vectors;
    const auto with = [&](Eigen::Vector4d values) -> MatrixXd { return Q * values.asDiagonal() * Q.transpose(); };
    CHECK(off(positive_part(with({-3, -1, 2, 5})), with({0, 0, 2, 5})) < 1e-13);
    CHECK(off(positive_part(with({1, 2, 3, 4})), with({1, 2, 3, 4})) < 1e-13);
}

TEST_CASE("a singular value decomposition gives the matrix back, with the parts that were asked for") {
    for (const auto& [rows, columns] : {std::pair{6, 3}, {3, 6}}) {
        const MatrixXd A = random_matrix(rows, columns, 5);
        const Svd square = svd(A, SvdParts::square);
        MatrixXd sigma = MatrixXd::Zero(rows, columns);
        sigma.diagonal() = square.sigma;
        CHECK(off(square.U * sigma * square.V.transpose(), A) < 1e-13);
        const Svd values = svd(A, SvdParts::values), left = svd(A, SvdParts::thin_left);
        CHECK(values.U.size() + values.V.size() == 0);
        CHECK(off(values.sigma, square.sigma) < 1e-13);
        CHECK(left.V.size() == 0);
        CHECK(left.U.cols() == 3);
        CHECK(off(left.U * left.U.transpose() * A, A) < 1e-13);
        const Svd right = svd(A, SvdParts::square_right);
        CHECK(right.U.size() == 0);
        CHECK(off(right.V * right.V.transpose(), MatrixXd::Identity(columns, columns)) < 1e-13);
    }
}

TEST_CASE("least squares: the remainder is orthogonal to all columns") {
    const MatrixXd A = random_matrix(8, 3, 6);
    const VectorXd b = random_matrix(8, 1, 7);
    const VectorXd x = least_squares(A, b);
    CHECK((A.transpose() * (A * x - b)).norm() < 1e-13);
    const auto unique = unique_least_squares(A, b);
    REQUIRE(unique);
    CHECK(off(*unique, x) < 1e-13);
    CHECK(off(pseudo_inverse(A) * b, x) < 1e-13);
}

TEST_CASE("dependent columns: no unique solution, and the shortest one shares the load") {
    MatrixXd A(3, 2);
    A << 1, 1, 2, 2, 2, 2;
    const VectorXd b = Eigen::Vector3d(9, 18, 18);
    CHECK(!unique_least_squares(A, b));
    CHECK((A * least_squares(A, b) - b).norm() < 1e-12);
    CHECK(off(shortest_least_squares(A, b), Eigen::Vector2d(4.5, 4.5)) < 1e-12);
    A(0, 1) += 1e-6;
    CHECK(off(pseudo_inverse(A, 1e-3) * b, Eigen::Vector2d(4.5, 4.5)) < 1e-5);
    CHECK(pseudo_inverse(A).norm() > 1e5);
}

TEST_CASE("a column basis leaves out what is within the threshold") {
    MatrixXd A(3, 2);
    A << 1, 1, 0, 1e-4, 0, 0;
    CHECK(column_basis(A, 1e-3).cols() == 1);
    const MatrixXd both = column_basis(A, 1e-6);
    REQUIRE(both.cols() == 2);
    CHECK(off(both * both.transpose() * A, A) < 1e-15);
    CHECK(off(both.transpose() * both, MatrixXd::Identity(2, 2)) < 1e-13);
}
