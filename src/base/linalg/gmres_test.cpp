#include "base/linalg/gmres.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>

using namespace pliant::linalg;

TEST_CASE("gmres solves an unsymmetric system with a symmetric preconditioner") {
    const int n = 60;
    Eigen::MatrixXd symmetric = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        symmetric(i, i) = 2 + 0.1 * i;
        if (i > 0) symmetric(i, i - 1) = symmetric(i - 1, i) = -1;
    }
    Eigen::MatrixXd skew = Eigen::MatrixXd::Zero(n, n);  // of low rank, as the rim of a pressed patch gives
    for (int i = 10; i < 14; ++i) {
        skew(i, 40) = 3;
        skew(40, i) = -3;
    }
    const Eigen::MatrixXd A = symmetric + skew;
    const Eigen::LDLT<Eigen::MatrixXd> factor(symmetric);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
    int products = 0;
    const auto multiply = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return ++products, A * factor.solve(v); };
    const Eigen::VectorXd x = factor.solve(gmres(multiply, b, 1e-12, 50));
    CHECK((A * x - b).norm() < 1e-11 * b.norm());
    CHECK(products < 8);
    CHECK(gmres(multiply, Eigen::VectorXd::Zero(n), 1e-12, 50).norm() == 0);
}
