#include "linalg/cholesky.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

using namespace pliant::linalg;

namespace {

/// A chain of nodes with random symmetric blocks, made diagonally dominant; returned dense as the independent answer.
Eigen::MatrixXd fill(const SymmetricPattern& pattern, std::vector<double>& values, double diagonal) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int b = pattern.block;
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(pattern.size(), pattern.size());
    values.assign(pattern.entries(), 0.0);
    for (int j = 0; j < pattern.nodes; ++j) {
        for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k) {
            const int i = pattern.node_row[k];
            Eigen::MatrixXd block = Eigen::MatrixXd::NullaryExpr(b, b, [&] { return uniform(random); });
            if (i == j) block = (block + block.transpose()).eval() + diagonal * Eigen::MatrixXd::Identity(b, b);
            pattern.add_block(values, i, j, [&](int r, int c) { return block(r, c); });
            dense.block(i * b, j * b, b, b) = block;
            dense.block(j * b, i * b, b, b) = block.transpose();
        }
    }
    return dense;
}

}  // namespace

TEST_CASE("solutions agree with a dense solver, for blocks of 1 and 3") {
    for (const int block : {1, 3}) {
        const auto pattern = make_pattern(9, block, {{0, 4, 2}, {4, 5, 8, 2}, {-1, 7, 6}, {1, 3, 0}, {6, 5, 3}});
        std::vector<double> values;
        const Eigen::MatrixXd dense = fill(pattern, values, 12.0);
        Cholesky cholesky(pattern);
        REQUIRE(cholesky.factorise(values));
        Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(pattern.size(), 4);
        const Eigen::MatrixXd expected = dense.llt().solve(rhs);
        cholesky.solve({rhs.data(), static_cast<std::size_t>(rhs.size())}, 4);
        CHECK((rhs - expected).norm() < 1e-12 * expected.norm());
    }
}

TEST_CASE("an indefinite matrix is reported, and the object can be used again") {
    const auto pattern = make_pattern(4, 3, {{0, 1, 2, 3}});
    std::vector<double> values;
    Cholesky cholesky(pattern);
    fill(pattern, values, -1.0);
    CHECK_FALSE(cholesky.factorise(values));
    const Eigen::MatrixXd dense = fill(pattern, values, 15.0);
    REQUIRE(cholesky.factorise(values));
    Eigen::VectorXd rhs = Eigen::VectorXd::Ones(12);
    const Eigen::VectorXd expected = dense.llt().solve(rhs);
    cholesky.solve({rhs.data(), 12}, 1);
    CHECK((rhs - expected).norm() < 1e-12);
}
