// Proper orthogonal decomposition: orthonormal modes that leave out no more than asked.
#include "simulation/reduced/snapshot_basis.hpp"

#include <doctest/doctest.h>

#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim::reduced;

namespace {

/// (size, count) of the given rank, each further direction a tenth as strong.
Eigen::MatrixXd snapshots_of_rank(Eigen::Index size, Eigen::Index count, Eigen::Index rank) {
    std::mt19937 random(5);
    std::normal_distribution<double> number;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, count);
    double strength = 1;
    for (Eigen::Index k = 0; k < rank; ++k, strength /= 10) {
        Eigen::VectorXd direction(size), share(count);
        for (double& entry : direction) entry = number(random);
        for (double& entry : share) entry = number(random);
        sum += strength * direction * share.transpose();
    }
    return sum;
}

}  // namespace

TEST_CASE("snapshot basis: orthonormal, as few modes as the error allows") {
    const Eigen::MatrixXd snapshots = snapshots_of_rank(200, 30, 6);
    Eigen::Index before = 0;
    for (const double error : {0.5, 1e-1, 1e-2, 1e-3, 1e-4}) {
        const Eigen::MatrixXd basis = snapshot_basis(snapshots, error, 30);
        const Eigen::MatrixXd products = basis.transpose() * basis;
        CHECK((products - Eigen::MatrixXd::Identity(basis.cols(), basis.cols())).norm() < 1e-12);
        const auto left_out = [&](const Eigen::MatrixXd& modes) {
            return (snapshots - modes * (modes.transpose() * snapshots)).norm() / snapshots.norm();
        };
        CHECK(left_out(basis) <= error);
        if (basis.cols() > 1) CHECK(left_out(basis.leftCols(basis.cols() - 1)) > error);
        CHECK(basis.cols() >= before);
        before = basis.cols();
    }
    CHECK(before <= 6);
    CHECK(snapshot_basis(snapshots, 0, 30).cols() == 6);  // what is beyond the rank is rounding
    CHECK(snapshot_basis(snapshots, 0, 3).cols() == 3);
}

TEST_CASE("snapshot basis: of no motion there are no modes") {
    CHECK(snapshot_basis(Eigen::MatrixXd::Zero(12, 4), 1e-3, 10).cols() == 0);
    CHECK(snapshot_basis(Eigen::MatrixXd(12, 0), 1e-3, 10).cols() == 0);
}
