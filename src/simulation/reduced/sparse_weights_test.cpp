// Non-negative least squares: the conditions of its solution, and that few columns are used.
#include "simulation/reduced/sparse_weights.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim::reduced;

namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed, double low = -1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(low, 1);
    Eigen::MatrixXd matrix(rows, columns);
    for (double& entry : matrix.reshaped()) entry = number(random);
    return matrix;
}

Eigen::VectorXd sum_of(const Eigen::MatrixXd& columns, const SparseWeights& found) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns.rows());
    for (const Weight& one : found.weights) sum += one.weight * columns.col(static_cast<Eigen::Index>(one.column));
    return sum;
}

}  // namespace

TEST_CASE("sparse weights: without a reachable sum, no other weights come nearer") {
    // The conditions of Karush, Kuhn and Tucker: what is missing is orthogonal to the columns in use, and points away
    // from all others.
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Eigen::MatrixXd columns = random_matrix(30, 20, seed);
        const Eigen::VectorXd wanted = random_matrix(30, 1, 100 + seed);
        const SparseWeights found = sparse_weights(columns, wanted, 0);
        const Eigen::VectorXd missing = wanted - sum_of(columns, found);
        CHECK(found.error == near(missing.norm() / wanted.norm(), {.relative = 1e-12}));
        std::vector<bool> used(20);
        for (const Weight& one : found.weights) {
            CHECK(one.weight > 0);
            used[one.column] = true;
            CHECK(columns.col(static_cast<Eigen::Index>(one.column)).dot(missing) == near(0, {.absolute = 1e-11}));
        }
        for (std::size_t k = 0; k < used.size(); ++k) {
            if (!used[k]) CHECK(columns.col(static_cast<Eigen::Index>(k)).dot(missing) < 1e-11);
        }
    }
}

TEST_CASE("sparse weights: the sum of many columns is met with few of them") {
    const Eigen::MatrixXd columns = random_matrix(25, 2000, 7, -0.2);
    const Eigen::VectorXd wanted = columns.rowwise().sum();
    for (const double error : {1e-2, 1e-4, 1e-8}) {
        const SparseWeights found = sparse_weights(columns, wanted, error);
        CHECK((sum_of(columns, found) - wanted).norm() <= error * wanted.norm() * (1 + 1e-9));
        CHECK(found.weights.size() <= 25);
        CHECK(std::ranges::is_sorted(found.weights, {}, &Weight::column));
    }
}

TEST_CASE("sparse weights: nothing, columns of zeros, and columns twice") {
    CHECK(sparse_weights(random_matrix(5, 4, 1), Eigen::VectorXd::Zero(5), 1e-6).weights.empty());
    CHECK(sparse_weights(Eigen::MatrixXd::Zero(5, 4), Eigen::VectorXd::Ones(5), 1e-6).weights.empty());
    Eigen::MatrixXd twice(3, 4);
    twice << 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0;
    const SparseWeights found = sparse_weights(twice, Eigen::Vector3d(2, 3, 0), 1e-9);
    REQUIRE(found.weights.size() == 2);
    CHECK(found.weights[0].weight == near(2, {.relative = 1e-12}));
    CHECK(found.weights[1].weight == near(3, {.relative = 1e-12}));
}

TEST_CASE("sparse weights: the search can be ended") {
    const Eigen::MatrixXd columns = random_matrix(25, 200, 3, -0.2);
    const SparseWeights found = sparse_weights(columns, columns.rowwise().sum(), 1e-12, [](double) { return false; });
    CHECK(found.weights.size() == 1);
}
