#include "base/linalg/block_rows.hpp"

#include <doctest/doctest.h>

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

void check_blocks_and_products() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1, 1);
    for (const int nodes : {1, 2, 9, 150}) {
        const Filled m(nodes, random_cliques(nodes, random), random);
        BlockRows rows(m.pattern);
        rows.set(m.values);
        for (int i = 0; i < nodes; ++i) {
            CHECK((rows.diagonal(i) - m.dense.block<3, 3>(3 * i, 3 * i)).norm() <= 1e-14 * rows.diagonal(i).norm());
            for (int k = rows.start[i]; k < rows.start[i + 1]; ++k) {
                const Eigen::Matrix3d given = m.dense.block<3, 3>(3 * i, 3 * rows.column[k]);
                CHECK((rows.block(k) - given).norm() <= 1e-14 * given.norm());
            }
        }
        const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(3 * nodes, [&] { return number(random); });
        // The rounding error of a sum scales with the magnitudes of its terms.
        const Eigen::VectorXd product = m.dense * x, sizes = m.dense.cwiseAbs() * x.cwiseAbs();
        Eigen::VectorXd y(3 * nodes);
        rows.multiply(x.data(), y.data());
        CHECK(((y - product).array().abs() <= 1e-14 * sizes.array()).all());
        const Eigen::VectorXf short_x = x.cast<float>();
        Eigen::VectorXf short_y(3 * nodes);
        rows.multiply(short_x.data(), short_y.data());
        CHECK(((short_y.cast<double>() - product).array().abs() <= 1e-6 * sizes.array()).all());

        std::vector<double> other_values = m.values;
        for (double& v : other_values) v *= 3;
        rows.move_towards(other_values, 0.25);
        for (int i = 0; i < nodes; ++i) {
            for (int k = rows.start[i]; k < rows.start[i + 1]; ++k) {
                const Eigen::Matrix3d moved = 1.5 * m.dense.block<3, 3>(3 * i, 3 * rows.column[k]);
                CHECK((rows.block(k) - moved).norm() <= 2e-14 * moved.norm());
            }
        }
        rows.set(m.values);

        // Two interleaved vectors give the same as each alone; two numbers past the end are read.
        Eigen::VectorXd both = Eigen::VectorXd::Zero(6 * nodes + 2), both_y(6 * nodes);
        const Eigen::VectorXd other = Eigen::VectorXd::NullaryExpr(3 * nodes, [&] { return number(random); });
        for (int i = 0; i < 3 * nodes; ++i) both.segment<2>(2 * i) << x[i], other[i];
        rows.multiply(both.data(), both_y.data(), 2);
        Eigen::VectorXd other_y(3 * nodes);
        rows.multiply(other.data(), other_y.data());
        for (int i = 0; i < 3 * nodes; ++i) CHECK(both_y.segment<2>(2 * i) == Eigen::Vector2d(y[i], other_y[i]));
        const Eigen::VectorXf short_both = both.cast<float>(), short_other = other.cast<float>();
        Eigen::VectorXf short_both_y(6 * nodes), short_other_y(3 * nodes);
        rows.multiply(short_both.data(), short_both_y.data(), 2);
        rows.multiply(short_other.data(), short_other_y.data());
        for (int i = 0; i < 3 * nodes; ++i)
            CHECK(short_both_y.segment<2>(2 * i) == Eigen::Vector2f(short_y[i], short_other_y[i]));
    }
}

}  // namespace

TEST_CASE("blocks and products are those of the matrix: 14 digits in double precision, 6 in single") {
    on_each_simd_target([](const char* target) {
        CAPTURE(target);
        check_blocks_and_products();
    });
}
