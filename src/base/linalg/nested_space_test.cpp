#include "base/linalg/nested_space.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/linalg/simd_targets.hpp"

using namespace pliant;
using namespace pliant::linalg;

namespace {

/// Corners 0, 3, 5 and a fixed one; mid-edge nodes: 1 (0, 3), 2 (3, 0 again), 4 (5, fixed), 6 (fixed, fixed).
const Nesting nesting{3, {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, -1}, {2, 2}, {-1, -1}}};

/// All pairs are coupled except 0 with 5, which are coupled only through mid-edge nodes.
SymmetricPattern pattern() {
    return make_pattern(7, 3, {{0, 1, 2, 3, 4, 6}, {1, 2, 3, 4, 5, 6}});
}

/// Columns of P.
Eigen::MatrixXd prolongation() {
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(21, 9);
    for (int i = 0; i < 7; ++i) {
        for (const int c : nesting.ends[static_cast<std::size_t>(i)]) {
            if (c >= 0) P.block<3, 3>(3 * i, 3 * c) += 0.5 * Eigen::Matrix3d::Identity();
        }
    }
    return P;
}

struct Matrix {
    std::vector<double> values;
    Eigen::MatrixXd dense;
};

/// Pseudo-random values; the upper triangle of diagonal blocks is ignored.
Matrix random_blocks(const SymmetricPattern& p) {
    Matrix m{std::vector<double>(p.entries()), Eigen::MatrixXd::Zero(3 * p.nodes, 3 * p.nodes)};
    for (std::size_t k = 0; k < m.values.size(); ++k) m.values[k] = std::sin(12.9898 * static_cast<double>(k) + 1);
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k)
            m.dense.block<3, 3>(3 * p.node_row[k], 3 * j) = Eigen::Map<const Eigen::Matrix3d>(m.values.data() + 9 * k);
    }
    m.dense = Eigen::MatrixXd(m.dense.selfadjointView<Eigen::Lower>());
    return m;
}

Eigen::MatrixXd dense(const SymmetricPattern& p, std::span<const double> values) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * p.nodes, 3 * p.nodes);
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k)
            result.block<3, 3>(3 * p.node_row[k], 3 * j) = Eigen::Map<const Eigen::Matrix3d>(values.data() + 9 * k);
    }
    return result.selfadjointView<Eigen::Lower>();
}

/// Node i is at (i, 2 i, -i).
void set(NestedSpace& space, const SymmetricPattern& pattern, const Matrix& m) {
    SymmetricBlocks blocks(pattern);
    blocks.set(m.values);
    std::vector<double> positions;
    for (int i = 0; i < pattern.nodes; ++i) positions.insert(positions.end(), {1.0 * i, 2.0 * i, -1.0 * i});
    space.set({blocks, positions, nullptr, 0});
}

}  // namespace

TEST_CASE("the coarse matrix is exact for motions of the corners") {
    const SymmetricPattern fine = pattern();
    const Matrix m = random_blocks(fine);
    const Eigen::MatrixXd P = prolongation();
    const Eigen::MatrixXd expected = P.transpose() * m.dense * P;
    on_each_simd_target([&](const char* target) {
        CAPTURE(target);
        NestedSpace space(fine, nesting);
        set(space, fine, m);
        CHECK((dense(space.pattern(), space.values()) - expected).cwiseAbs().maxCoeff() < 1e-14 * m.dense.norm());
        const std::vector<double> corners = {0, 0, 0, 3, 6, -3, 5, 10, -5};
        CHECK(std::ranges::equal(space.positions(), corners));
    });
}

TEST_CASE("restriction is the transpose of prolongation") {
    NestedSpace space(pattern(), nesting);
    const Eigen::MatrixXd P = prolongation();
    const Eigen::VectorXf fine = Eigen::VectorXf::LinSpaced(21, -1, 2);
    Eigen::VectorXd coarse(9);
    space.restrict(fine.data(), coarse.data());
    CHECK((coarse - P.transpose() * fine.cast<double>()).norm() < 1e-6);
    Eigen::VectorXf back = fine;
    space.add_prolonged(coarse.data(), back.data());
    CHECK((back.cast<double>() - fine.cast<double>() - P * coarse).norm() < 1e-5);
}

TEST_CASE("long sums are the same bits on any number of threads") {
    // A chain of corners with a mid-edge node between each two.
    constexpr int corners = 3000;
    Nesting chain{corners, {}};
    std::vector<std::vector<int>> cliques;
    for (int c = 0; c < corners; ++c) {
        chain.ends.push_back({c, c});
        if (c + 1 < corners) chain.ends.push_back({c, c + 1});
        if (c + 1 < corners) cliques.push_back({2 * c, 2 * c + 1, 2 * c + 2});
    }
    const SymmetricPattern fine = make_pattern(2 * corners - 1, 3, Lists(cliques));
    const Matrix m{[&] {
                       std::vector<double> values(fine.entries());
                       for (std::size_t k = 0; k < values.size(); ++k)
                           values[k] = std::sin(12.9898 * static_cast<double>(k));
                       return values;
                   }(),
                   {}};
    std::vector<double> first;
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        NestedSpace space(fine, chain);
        set(space, fine, m);
        const std::vector<double> values(space.values().begin(), space.values().end());
        if (threads == 1) first = values;
        CHECK(values == first);
    }
}
