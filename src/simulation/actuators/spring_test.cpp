#include "simulation/actuators/spring.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>

#include "base/core/near.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Four nodes somewhere, and a spring that bends round the mean of two of them.
const std::vector<double> positions = {0, 0.1, 0, 1, 0, 0.2, 1.2, 0.9, 0, 0.1, 1, 1.1};

Spring bent_spring(bool only_pulls, double free_length_m) {
    return {"band",
            {{{0}, {1.0}, {}}, {{1, 2}, {0.3, 0.7}, {}}, {{3}, {1.0}, {}}, {{}, {}, {0, 0, 2}}},
            7,
            free_length_m,
            only_pulls};
}

std::vector<double> gradient_at(const SpringPath& spring, const std::vector<double>& x) {
    std::vector<double> forces(x.size(), 0.0);
    spring.add_gradient(x, forces);
    return forces;
}

/// The whole second gradient, (12, 12).
Eigen::MatrixXd hessian_at(const SpringPath& spring, const std::vector<double>& x, bool project) {
    std::vector<int> free(4);
    std::iota(free.begin(), free.end(), 0);
    linalg::Lists cliques;
    spring.append_clique(free, cliques);
    const linalg::SymmetricPattern pattern = linalg::make_pattern(4, 3, cliques);
    std::vector<double> values(pattern.entries(), 0.0);
    spring.add_hessian(x, free, pattern, values, project);
    Eigen::MatrixXd H(12, 12);
    for (int column = 0; column < 12; ++column) {
        std::vector<double> unit(12, 0.0), product(12, 0.0);
        unit[static_cast<std::size_t>(column)] = 1;
        linalg::add_product(pattern, values, unit, 1, product);
        H.col(column) = Eigen::Map<Eigen::VectorXd>(product.data(), 12);
    }
    return H;
}

}  // namespace

TEST_CASE("gradient and Hessian of a spring agree with its energy, in tension and compression") {
    for (const double free_length : {1.0, 9.0}) {
        const SpringPath spring(bent_spring(false, free_length), positions);
        CHECK((spring.force(positions) > 0) == (free_length < 2));
        const std::vector<double> g = gradient_at(spring, positions);
        const Eigen::MatrixXd H = hessian_at(spring, positions, false);
        constexpr double h = 1e-6;
        for (std::size_t k = 0; k < positions.size(); ++k) {
            auto low = positions, high = positions;
            low[k] -= h;
            high[k] += h;
            CHECK(g[k] == near((spring.energy(high) - spring.energy(low)) / (2 * h), {.relative = 1e-7}));
            const auto before = gradient_at(spring, low), after = gradient_at(spring, high);
            for (std::size_t i = 0; i < positions.size(); ++i)
                CHECK(std::fabs(H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) -
                                (after[i] - before[i]) / (2 * h)) < 1e-6);
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> projected(hessian_at(spring, positions, true));
        CHECK(projected.eigenvalues().minCoeff() > -1e-10);
    }
}

TEST_CASE("a band that only pulls has no force while it is slack") {
    const SpringPath band(bent_spring(true, 9), positions);
    CHECK(band.force(positions) == 0);
    CHECK(band.energy(positions) == 0);
    for (const double force : gradient_at(band, positions)) CHECK(force == 0);
    CHECK(hessian_at(band, positions, false).norm() == 0);
}

TEST_CASE("a spring bends a body as a dead load of its force does") {
    Description d = testing::hollow_block(2);
    d.chambers.clear();
    const Attachment tip = d.markers[0].point;
    const Vec3 anchor{0.03, 0.005, 0.06};
    Description sprung = d;
    sprung.springs = {{"spring", {tip, {{}, {}, anchor}}, 2, 0.02}};
    const Trajectory held = testing::solve(std::move(sprung), {.steps = 2, .tolerance = 1e-8});
    REQUIRE_MESSAGE(held.converged, held.message);
    const Step& last = held.steps.back();
    const Vec3 to_anchor = anchor - last.markers[0].position_m;
    CHECK(last.springs[0].length_m == near(norm(to_anchor), {.relative = 1e-9}));
    CHECK(last.springs[0].force_N == near(2 * (norm(to_anchor) - 0.02), {.relative = 1e-9}));
    CHECK(last.markers[0].position_m.z > 0.01);  // it bends: this is no small motion

    d.loads = {{"pull", tip.nodes, tip.weights, (last.springs[0].force_N / norm(to_anchor)) * to_anchor}};
    const Trajectory loaded = testing::solve(std::move(d), {.steps = 4, .tolerance = 1e-8});
    REQUIRE_MESSAGE(loaded.converged, loaded.message);
    CHECK(norm(loaded.steps.back().markers[0].position_m - last.markers[0].position_m) < 1e-8);
    CHECK(norm(loaded.steps.back().supports[0].force_N - last.supports[0].force_N) < 1e-6);
}
