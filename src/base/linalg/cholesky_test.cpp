#include "base/linalg/cholesky.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <numeric>
#include <random>

#include "base/linalg/simd_targets.hpp"

using namespace pliant::linalg;

namespace {

/// A chain of nodes with random symmetric blocks, made diagonally dominant; returned dense as the independent answer.
Eigen::MatrixXd fill_with_random_blocks(const SymmetricPattern& pattern, std::vector<double>& values, double diagonal) {
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

/// Grid cells as cliques, as in a hexahedral mesh; large enough for branches, a trunk and wide panels.
SymmetricPattern hexahedra(int nx, int ny, int nz, int block) {
    std::vector<std::vector<int>> cliques;
    const auto node = [&](int i, int j, int k) { return (i * ny + j) * nz + k; };
    for (int i = 0; i + 1 < nx; ++i) {
        for (int j = 0; j + 1 < ny; ++j) {
            for (int k = 0; k + 1 < nz; ++k) {
                cliques.emplace_back();
                for (int corner = 0; corner < 8; ++corner)
                    cliques.back().push_back(node(i + corner % 2, j + corner / 2 % 2, k + corner / 4));
            }
        }
    }
    return make_pattern(nx * ny * nz, block, cliques);
}

/// A stiffness-like matrix: positive definite, only just if `shift` is small; also as an Eigen matrix.
Eigen::SparseMatrix<double> springs(const SymmetricPattern& pattern, std::vector<double>& values, double shift) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int b = pattern.block;
    values.assign(pattern.entries(), 0.0);
    std::vector<Eigen::Triplet<double>> triplets;
    const auto add = [&](int i, int j, const Eigen::MatrixXd& m) {
        pattern.add_block(values, i, j, [&](int r, int c) { return m(r, c); });
        for (int c = 0; c < b; ++c) {
            for (int r = i == j ? c : 0; r < b; ++r) triplets.emplace_back(i * b + r, j * b + c, m(r, c));
        }
    };
    for (int j = 0; j < pattern.nodes; ++j) {
        add(j, j, shift * Eigen::MatrixXd::Identity(b, b));
        for (int k = pattern.node_start[j] + 1; k < pattern.node_start[j + 1]; ++k) {
            const int i = pattern.node_row[k];
            const Eigen::VectorXd v = Eigen::VectorXd::NullaryExpr(b, [&] { return uniform(random); });
            const Eigen::MatrixXd spring = v * v.transpose();
            add(i, i, spring);
            add(j, j, spring);
            add(i, j, -spring);
        }
    }
    Eigen::SparseMatrix<double> matrix(pattern.size(), pattern.size());
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
}

}  // namespace

TEST_CASE("grids of many shapes agree with Eigen's solver, for one to seven right-hand sides") {
    struct Shape {
        int nx, ny, nz, block;
    };
    int count = 1;
    for (const Shape& g : {Shape{2, 2, 2, 3}, {40, 3, 3, 3}, {13, 12, 11, 3}, {30, 30, 2, 1}, {17, 16, 15, 1}}) {
        const auto pattern = hexahedra(g.nx, g.ny, g.nz, g.block);
        std::vector<double> values;
        const auto matrix = springs(pattern, values, 1e-3);
        const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> independent(matrix);
        Cholesky cholesky(pattern);
        REQUIRE(cholesky.factorise(values));
        Eigen::MatrixXd x = Eigen::MatrixXd::Random(pattern.size(), count);
        const Eigen::MatrixXd right = x;
        const Eigen::MatrixXd expected = independent.solve(right);
        cholesky.solve({x.data(), static_cast<std::size_t>(x.size())}, count);
        CHECK((x - expected).norm() < 1e-9 * expected.norm());

        Eigen::MatrixXd product = Eigen::MatrixXd::Zero(pattern.size(), count);
        const auto n = static_cast<std::size_t>(pattern.size());
        for (int c = 0; c < count; ++c)
            add_product(pattern, values, {x.col(c).data(), n}, 1, {product.col(c).data(), n});
        CHECK((product - right).norm() < 1e-9 * right.norm());
        count = count % 7 + 2;
    }
}

TEST_CASE("fields of three components agree with Eigen's solver, in both precisions, on one core and on several") {
    for (const auto& [nx, ny, nz] : {std::array{2, 2, 2}, {60, 3, 3}, {17, 16, 12}}) {
        const auto pattern = hexahedra(nx, ny, nz, 1);
        std::vector<double> values;
        const auto matrix = springs(pattern, values, 1e-1);
        const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> independent(matrix);
        for (const Precision precision : {Precision::single_, Precision::double_}) {
            Cholesky cholesky(pattern, precision);
            REQUIRE(cholesky.factorise(values));
            for (const int count : {1, 2, 3, 5}) {
                const Eigen::MatrixXd fields = Eigen::MatrixXd::Random(3 * pattern.nodes, count);
                Eigen::MatrixXd found[2] = {fields, fields};
                for (const int threads : {1, 3}) {
                    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                    Eigen::MatrixXd& x = found[threads / 2];
                    cholesky.solve_fields({x.data(), static_cast<std::size_t>(x.size())}, count);
                }
                CHECK(found[0] == found[1]);
                for (int c = 0; c < count; ++c) {
                    const Eigen::MatrixXd expected = independent.solve(
                        Eigen::Map<const Eigen::MatrixXd>(fields.col(c).data(), 3, pattern.nodes).transpose());
                    const Eigen::Map<const Eigen::MatrixXd> x(found[0].col(c).data(), 3, pattern.nodes);
                    CHECK((x.transpose() - expected).norm() <
                          (precision == Precision::single_ ? 1e-4 : 1e-10) * expected.norm());
                }
            }
        }
    }
}

TEST_CASE("a part of the inverse agrees with Eigen's solver, in both precisions, on one core and on several") {
    struct Shape {
        int nx, ny, nz, block;
    };
    for (const Shape& g : {Shape{2, 2, 2, 3}, {40, 3, 3, 3}, {13, 12, 11, 3}, {30, 30, 2, 1}}) {
        const auto pattern = hexahedra(g.nx, g.ny, g.nz, g.block);
        std::vector<double> values;
        const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> independent(springs(pattern, values, 1e-1));
        std::vector<int> unknowns(static_cast<std::size_t>(pattern.size()));
        std::iota(unknowns.begin(), unknowns.end(), 0);
        std::shuffle(unknowns.begin(), unknowns.end(), std::mt19937(3));
        for (const std::size_t count : {0, 1, 8, 21}) {
            const std::span<const int> some = std::span(unknowns).first(count);
            const auto n = static_cast<Eigen::Index>(count);
            Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(pattern.size(), n);
            for (Eigen::Index k = 0; k < n; ++k) columns(some[static_cast<std::size_t>(k)], k) = 1;
            columns = independent.solve(columns).eval();
            Eigen::MatrixXd expected(n, n);
            for (Eigen::Index k = 0; k < n; ++k) expected.row(k) = columns.row(some[static_cast<std::size_t>(k)]);
            for (const Precision precision : {Precision::single_, Precision::double_}) {
                Cholesky cholesky(pattern, precision);
                REQUIRE(cholesky.factorise(values));
                const auto found = [&] {
                    Eigen::MatrixXd part(n, n);
                    cholesky.inverse_part(some, {part.data(), count * count});
                    return part;
                };
                on_each_simd_target([&](const char* target) {
                    CAPTURE(target);
                    CHECK((found() - expected).norm() <=
                          (precision == Precision::single_ ? 1e-4 : 1e-11) * expected.norm());
                });
                const Eigen::MatrixXd on_all = found();
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
                CHECK(found() == on_all);
            }
        }
    }
}

TEST_CASE("single precision: accuracy, and refinement to a tolerance") {
    int count = 1;
    for (const int block : {1, 3}) {
        const auto pattern = hexahedra(13, 12, 11, block);
        std::vector<double> values;
        const auto matrix = springs(pattern, values, 1e-1);
        const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> independent(matrix);
        Cholesky cholesky(pattern, Precision::single_);
        REQUIRE(cholesky.factorise(values));
        const Eigen::MatrixXd right = Eigen::MatrixXd::Random(pattern.size(), count);
        const Eigen::MatrixXd expected = independent.solve(right);
        const auto whole = [](Eigen::MatrixXd& m) { return std::span(m.data(), static_cast<std::size_t>(m.size())); };

        Eigen::MatrixXd once = right;
        cholesky.solve(whole(once), count);
        const double error = (once - expected).norm() / expected.norm();
        CHECK(error < 1e-4);
        CHECK(error > 1e-9);
        for (const double tolerance : {1e-3, 1e-8, 1e-12}) {
            Eigen::MatrixXd refined = right;
            CHECK(cholesky.solve_and_refine(values, whole(refined), count, tolerance, 10).has_value());
            CHECK((refined - expected).norm() < 10 * tolerance * expected.norm());
        }
        Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(pattern.size(), 1);
        CHECK(cholesky.solve_and_refine(values, whole(zero), 1, 1e-8, 10).has_value());
        CHECK(zero.norm() == 0);
        Eigen::MatrixXd hasty = right;
        CHECK_FALSE(cholesky.solve_and_refine(values, whole(hasty), count, 1e-14, 0).has_value());

        cholesky.use(Precision::double_);
        REQUIRE(cholesky.factorise(values));
        cholesky.solve(whole(once = right), count);
        CHECK((once - expected).norm() < 1e-11 * expected.norm());
        count += 4;
    }
}

TEST_CASE("a matrix that only double precision can factorise") {
    const auto pattern = make_pattern(2, 1, {{0, 1}});
    const std::vector<double> values{1, 1 - 1e-10, 1};  // condition number 2e10
    Cholesky cholesky(pattern, Precision::single_);
    CHECK_FALSE(cholesky.factorise(values));
    cholesky.use(Precision::double_);
    CHECK(cholesky.factorise(values));
}

TEST_CASE("pieces that are not connected") {
    const auto pattern = make_pattern(7, 3, {{0, 1}, {2, 3, 4}});
    std::vector<double> values;
    const auto matrix = springs(pattern, values, 1);
    Cholesky cholesky(pattern);
    REQUIRE(cholesky.factorise(values));
    Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(21, -1, 2);
    const Eigen::VectorXd right = x;
    cholesky.solve({x.data(), 21}, 1);
    CHECK((matrix.selfadjointView<Eigen::Lower>() * x - right).norm() < 1e-12);
}

TEST_CASE("one bad pivot anywhere is noticed") {
    const auto pattern = hexahedra(14, 12, 10, 3);
    std::vector<double> good;
    springs(pattern, good, 1e-3);
    Cholesky cholesky(pattern);
    for (int node = 0; node < pattern.nodes; node += 97) {
        std::vector<double> values = good;
        pattern.add_block(values, node, node, [](int r, int c) { return r == 1 && c == 1 ? -1e3 : 0.0; });
        CHECK_FALSE(cholesky.factorise(values));
        pattern.add_block(values, node, node, [](int r, int c) { return r == 1 && c == 1 ? std::nan("") : 0.0; });
        CHECK_FALSE(cholesky.factorise(values));
    }
    CHECK(cholesky.factorise(good));
}

TEST_CASE("the same bits on any number of threads") {
    const auto pattern = hexahedra(26, 24, 22, 3);
    std::vector<double> values;
    springs(pattern, values, 1e-3);
    const auto solve_on = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Cholesky cholesky(pattern);
        REQUIRE(cholesky.factorise(values));
        std::vector<double> x(static_cast<std::size_t>(pattern.size()), 1.0);
        cholesky.solve(x, 1);
        return x;
    };
    const std::vector<double> one = solve_on(1);
    CHECK(solve_on(2) == one);
    CHECK(solve_on(4) == one);
}

TEST_CASE("solutions agree with a dense solver, for blocks of 1 and 3") {
    for (const int block : {1, 3}) {
        const auto pattern = make_pattern(9, block, {{0, 4, 2}, {4, 5, 8, 2}, {-1, 7, 6}, {1, 3, 0}, {6, 5, 3}});
        std::vector<double> values;
        const Eigen::MatrixXd dense = fill_with_random_blocks(pattern, values, 12.0);
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
    fill_with_random_blocks(pattern, values, -1.0);
    CHECK_FALSE(cholesky.factorise(values));
    const Eigen::MatrixXd dense = fill_with_random_blocks(pattern, values, 15.0);
    REQUIRE(cholesky.factorise(values));
    Eigen::VectorXd rhs = Eigen::VectorXd::Ones(12);
    const Eigen::VectorXd expected = dense.llt().solve(rhs);
    cholesky.solve({rhs.data(), 12}, 1);
    CHECK((rhs - expected).norm() < 1e-12);
}
