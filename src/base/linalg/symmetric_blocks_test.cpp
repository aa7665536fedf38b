#include "base/linalg/symmetric_blocks.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "base/linalg/simd_targets.hpp"

using namespace pliant;
using namespace pliant::linalg;

namespace {

struct Filled {
    SymmetricPattern pattern;
    std::vector<double> values;
    Eigen::MatrixXd dense;  ///< the same matrix

    Filled(int nodes, const std::vector<std::vector<int>>& cliques, std::mt19937& random)
        : pattern(make_pattern(nodes, 3, cliques)),
          values(pattern.entries(), 0.0),
          dense(Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes)) {
        std::uniform_real_distribution<double> number(-1, 1);
        const auto add = [&](int i, int j, const Eigen::Matrix3d& block) {
            pattern.add_block(values, i, j, block);
            dense.block<3, 3>(3 * i, 3 * j) += block;
            if (i != j) dense.block<3, 3>(3 * j, 3 * i) += block.transpose();
        };
        for (int j = 0; j < nodes; ++j) {
            for (int i = j; i < nodes; ++i) {
                if (!pattern.holds(i, j)) continue;
                // Of very different magnitudes, as for different materials.
                const double size = std::pow(10.0, 6 * number(random));
                const Eigen::Matrix3d block = size * Eigen::Matrix3d::NullaryExpr([&] { return number(random); });
                add(i, j, i == j ? Eigen::Matrix3d(block + block.transpose()) : block);
            }
        }
    }
};

std::vector<std::vector<int>> random_cliques(int nodes, std::mt19937& random) {
    std::uniform_int_distribution<int> node(0, nodes - 1);
    std::vector<std::vector<int>> cliques;
    for (int c = 0; c < 3 * nodes; ++c) {
        std::vector<int> clique;
        for (int k = 0; k < 4; ++k) {
            const int n = node(random);
            if (std::find(clique.begin(), clique.end(), n) == clique.end()) clique.push_back(n);
        }
        cliques.push_back(clique);
    }
    return cliques;
}

/// Every pair of the triangle and every block left of the diagonal is that of the dense matrix, times `factor`.
void check_blocks(const SymmetricBlocks& blocks, const Eigen::MatrixXd& dense, double factor) {
    const LowerTriangle m = blocks.triangle();
    const auto check = [&](int pair, int row, int column) {
        const Eigen::Matrix3d given = factor * dense.block<3, 3>(3 * row, 3 * column);
        CHECK((blocks.block(pair) - given).norm() <= 2e-14 * given.norm());
    };
    for (int i = 0; i < blocks.nodes(); ++i) {
        check(m.start[i], i, i);
        CHECK(blocks.diagonal(i) == blocks.block(m.start[i]));
        std::vector<int> neighbours;
        for (int e = m.left_start[i]; e < m.left_start[i + 1]; ++e) {
            check(m.left_pair[e], i, m.left_column[e]);
            neighbours.push_back(m.left_column[e]);
        }
        for (int k = m.start[i]; k < m.start[i + 1]; ++k) {
            check(k, m.row[k], i);
            neighbours.push_back(m.row[k]);
        }
        CHECK(std::ranges::equal(neighbours, blocks.neighbours()[static_cast<std::size_t>(i)]));
        for (int j = 0; j < blocks.nodes(); ++j)
            CHECK(std::ranges::binary_search(neighbours, j) == (i == j || !dense.block<3, 3>(3 * i, 3 * j).isZero(0)));
    }
}

/// With both precisions, one column and two.
template <class Real>
void check_products(SymmetricBlocks& blocks, const Eigen::MatrixXd& dense, std::mt19937& random, double digits) {
    using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    std::uniform_real_distribution<double> number(-1, 1);
    const Eigen::Index size = dense.rows();
    const auto any = [&] { return static_cast<Real>(number(random)); };
    const Vector x = Vector::NullaryExpr(size, any), other = Vector::NullaryExpr(size, any);
    // The rounding error of a sum scales with the magnitudes of its terms.
    const Eigen::VectorXd product = dense * x.template cast<double>();
    const Eigen::VectorXd sizes = dense.cwiseAbs() * x.template cast<double>().cwiseAbs();
    Vector y(size), other_y(size), both(2 * size), both_y(2 * size);
    blocks.multiply(x.data(), y.data());
    CHECK(((y.template cast<double>() - product).array().abs() <= digits * sizes.array()).all());
    blocks.multiply(other.data(), other_y.data());
    for (Eigen::Index i = 0; i < size; ++i) both.template segment<2>(2 * i) << x[i], other[i];
    blocks.multiply(both.data(), both_y.data(), 2);
    for (Eigen::Index i = 0; i < size; ++i) {
        CHECK(both_y[2 * i] == y[i]);
        CHECK(both_y[2 * i + 1] == other_y[i]);
    }
}

void check_blocks_and_products() {
    std::mt19937 random(7);
    for (const int nodes : {1, 2, 9, 150}) {
        const Filled m(nodes, random_cliques(nodes, random), random);
        SymmetricBlocks blocks(m.pattern);
        blocks.set(m.values);
        check_blocks(blocks, m.dense, 1);
        check_products<double>(blocks, m.dense, random, 1e-14);
        check_products<float>(blocks, m.dense, random, 1e-6);

        std::vector<double> other_values = m.values;
        for (double& v : other_values) v *= 3;
        blocks.move_towards(other_values, 0.25);
        check_blocks(blocks, m.dense, 1.5);
    }
}

/// A chain that is coupled over 700 nodes: longer than a piece of a product.
SymmetricPattern long_chain() {
    std::vector<std::vector<int>> cliques;
    for (int i = 0; i + 701 < 5000; ++i) cliques.push_back({i, i + 1, i + 30, i + 701});
    cliques.push_back({0, 1500, 4999});
    return make_pattern(5000, 3, cliques);
}

}  // namespace

TEST_CASE("blocks and products are those of the matrix: 14 digits in double precision, 6 in single") {
    on_each_simd_target([](const char* target) {
        CAPTURE(target);
        check_blocks_and_products();
    });
}

TEST_CASE("a product in pieces is that of the whole, and the same bits on any number of threads") {
    const SymmetricPattern pattern = long_chain();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> values(pattern.entries());
    for (double& v : values) v = number(random);
    const auto size = static_cast<std::size_t>(pattern.size());
    std::vector<double> x(2 * size), whole(size), first, y(2 * size), one(size);
    for (double& v : x) v = number(random);
    add_product(pattern, values, std::span(x).first(size), 1, whole);
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        SymmetricBlocks blocks(pattern);
        blocks.set(values);
        blocks.multiply(x.data(), one.data());
        for (std::size_t i = 0; i < size; ++i) CHECK(std::fabs(one[i] - whole[i]) < 1e-12);
        blocks.multiply(x.data(), y.data(), 2);
        if (threads == 1) first = y;
        CHECK(y == first);
        std::vector<float> short_x(x.begin(), x.end()), short_y(size);
        blocks.multiply(short_x.data(), short_y.data());
        for (std::size_t i = 0; i < size; ++i) CHECK(std::fabs(static_cast<double>(short_y[i]) - whole[i]) < 1e-4);
    }
}
