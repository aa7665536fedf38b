// The thesis' gap and air elements: their derivatives, and the same bending as with the true constraint.
#include "simulation/elements/actuated_space.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>

#include "base/core/near.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/peers/comparison_problems.hpp"
#include "simulation/run/live.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

using Act = comparison::Drive;

const material::Law rubber = material::neo_hookean(1e6, 0.45);

Model made(Description d) {
    auto model = Model::create(std::move(d));
    REQUIRE_MESSAGE(model, model.error().message);
    return std::move(*model);
}

Description finger(int order, double ratio, Act drive) {
    return comparison::cable_finger(order, rubber, {CableTarget::Kind::length_ratio, ratio}, drive);
}

Description block(int order, double ratio, Act drive) {
    return comparison::air_block(order, rubber, {ChamberTarget::Kind::volume_ratio, ratio}, drive);
}

Trajectory run_to_the_end(const Description& d, Solver solver = Solver::automatic, double tolerance = 1e-4) {
    Progress silent;
    Trajectory t = run(made(d), {.steps = 8, .tolerance = tolerance, .solver = solver}, silent);
    REQUIRE_MESSAGE(t.converged, t.message);
    return t;
}

/// Distance of the tip from its position with the true constraint, relative to the motion of that.
double tip_error(const Description& with_elements, const Description& with_constraint) {
    const Vec3 u = comparison::tip_displacement(with_elements, run_to_the_end(with_elements).steps.back());
    const Vec3 v = comparison::tip_displacement(with_constraint, run_to_the_end(with_constraint).steps.back());
    return norm(u - v) / norm(v);
}

/// Gap elements of a small box of linear tets in a state that is far from rest.
struct Case {
    Case() {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> shift(-0.08, 0.08);
        for (const Vec3& p : model.mesh().points) {
            rest.insert(rest.end(), {p.x, p.y, p.z});
            x.insert(x.end(), {0.7 * p.x + shift(random) * 2e-3, p.y + 0.1 * p.x, p.z + shift(random) * 2e-3});
        }
        std::vector<GapElements::Gap> list(2);
        list[0] = {{}, {1, 0, 0}, 4e-3, 1e5};
        list[1] = {{}, {0.6, 0.8, 0}, 2e-3, 3e5};
        for (std::size_t t = 0; t < 60; ++t) list[t % 2].tets.push_back(t);
        gaps = std::make_unique<GapElements>(model.elements(), list);
    }
    [[nodiscard]] std::vector<double> force(const std::vector<double>& at, double m) const {
        std::vector<double> f(at.size(), 0.0);
        gaps->add_gradient(at, f);
        gaps->add_pull(at, m, f);
        return f;
    }
    [[nodiscard]] Eigen::MatrixXd hessian(double m, bool project) const {
        std::vector<int> free(rest.size() / 3);
        std::iota(free.begin(), free.end(), 0);
        const auto pattern = linalg::make_pattern(static_cast<int>(free.size()), 3, model.elements().cliques(free));
        std::vector<double> values(pattern.entries(), 0.0);
        gaps->add_hessian(x, m, free, pattern, values, project);
        const auto n = static_cast<Eigen::Index>(x.size());
        Eigen::MatrixXd H(n, n);
        for (Eigen::Index k = 0; k < n; ++k) {
            std::vector<double> unit(x.size(), 0.0), column(x.size(), 0.0);
            unit[static_cast<std::size_t>(k)] = 1;
            linalg::add_product(pattern, values, unit, 1, column);
            H.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), n);
        }
        return H;
    }

    Model model = made(block(1, 1.1, Act::constraint));
    std::vector<double> rest, x;
    std::unique_ptr<GapElements> gaps;
};

}  // namespace

TEST_CASE("gap elements: forces and stiffness agree with finite differences of the energy") {
    const Case c;
    const double h = 1e-8, m = 0.3;
    const std::vector<double> gradient = c.force(c.x, 0);
    const Eigen::MatrixXd H = c.hessian(m, false);
    for (const std::size_t k : {0u, 17u, 40u, 91u, 100u}) {
        std::vector<double> ahead = c.x, behind = c.x;
        ahead[k] += h;
        behind[k] -= h;
        const double slope = (c.gaps->energy(ahead) - c.gaps->energy(behind)) / (2 * h);
        CHECK(std::fabs(slope - gradient[k]) <
              1e-6 * Eigen::Map<const Eigen::VectorXd>(gradient.data(), H.rows()).norm());
        const std::vector<double> f = c.force(ahead, m), g = c.force(behind, m);
        for (std::size_t i = 0; i < f.size(); ++i)
            CHECK(std::fabs((f[i] - g[i]) / (2 * h) - H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k))) <
                  1e-6 * H.norm());
    }
    const Eigen::MatrixXd P = c.hessian(0, true);
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues()[0] > -1e-9 * P.norm());
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(c.hessian(0, false)).eigenvalues()[0] < -1e-3 * P.norm());
}

TEST_CASE("gap elements: free ones are in equilibrium at s times their length, however sheared") {
    const Case c;
    // All of the box is made s times as long along x and sheared: only the gap along x is at its target.
    const double s = 0.8;
    std::vector<double> x = c.rest;
    for (std::size_t n = 0; n < x.size(); n += 3) {
        x[n] = s * c.rest[n];
        x[n + 1] = 1.3 * c.rest[n + 1] + 0.4 * c.rest[n + 2];
    }
    const std::vector<GapElements::Gap> along_x = {{{0, 1, 2, 3, 4}, {1, 0, 0}, 4e-3, 1e5}};
    const GapElements gaps(c.model.elements(), along_x);
    std::vector<double> force(x.size(), 0.0), at_rest(x.size(), 0.0);
    double m = 1;
    m *= (1 - s) / (1 - gaps.scale(1));  // s decreases linearly with m
    CHECK(gaps.scale(m) == near(s, {.relative = 1e-12}));
    gaps.add_gradient(x, force);
    gaps.add_pull(x, m, force);
    gaps.add_pull(c.rest, m, at_rest);
    const auto largest = [](const std::vector<double>& v) {
        return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).cwiseAbs().maxCoeff();
    };
    CHECK(largest(force) < 1e-9 * largest(at_rest));
    CHECK(std::fabs(gaps.tension(x, m)) < 1e-9 * m);
    CHECK(gaps.tension(c.rest, m) == near(m, {.relative = 1e-12}));
}

TEST_CASE("a finger with gap elements bends like one with a cable of the same length, within 5 %") {
    for (const int order : {1, 2}) {
        for (const double ratio : {0.9, 0.85}) {
            const double error = tip_error(finger(order, ratio, Act::elements), finger(order, ratio, Act::constraint));
            MESSAGE("order " << order << ", length " << ratio << ": tip off by " << error);
            CHECK(error < 0.05);
        }
    }
}

TEST_CASE("a block with air elements bends like one with the same air volume, within 10 %") {
    for (const int order : {1, 2}) {
        for (const double ratio : {1.25, 1.6}) {
            const double error = tip_error(block(order, ratio, Act::elements), block(order, ratio, Act::constraint));
            MESSAGE("order " << order << ", volume " << ratio << ": tip off by " << error);
            CHECK(error < 0.1);
        }
    }
}

TEST_CASE("elements meet their constraint; their pressure is that of the true constraint, their tension is not") {
    const Step cable = run_to_the_end(finger(2, 0.9, Act::elements)).steps.back();
    const Step true_cable = run_to_the_end(finger(2, 0.9, Act::constraint)).steps.back();
    CHECK(cable.cables[0].length_ratio == near(0.9, {.relative = 1e-6}));
    // A measured ratio, which docs/theory.md reports.
    CHECK(cable.cables[0].tension_N / true_cable.cables[0].tension_N == near(1.76, {.relative = 0.01}));
    const Step air = run_to_the_end(block(2, 1.25, Act::elements)).steps.back();
    const Step true_air = run_to_the_end(block(2, 1.25, Act::constraint)).steps.back();
    CHECK(air.chambers[0].volume_ratio == near(1.25, {.relative = 1e-9}));
    CHECK(air.chambers[0].pressure_Pa / true_air.chambers[0].pressure_Pa == near(1, {.relative = 0.1}));
}

TEST_CASE("the thesis' iteration converges to Newton's solution, with gap and air elements") {
    struct {
        Description d;
        double error;
    } const cases[] = {{finger(1, 0.93, Act::elements), 0.03},
                       {block(1, 1.1, Act::elements), 0.2}};  // its tip moves by a small share of what its walls do
    for (const auto& [d, error] : cases) {
        const Vec3 exact = comparison::tip_displacement(d, run_to_the_end(d).steps.back());
        for (const Solver solver : {Solver::local_global, Solver::anderson}) {
            const Step end = run_to_the_end(d, solver, 1e-3).steps.back();
            CHECK(norm(comparison::tip_displacement(d, end) - exact) < error * norm(exact));
        }
    }
}

TEST_CASE("elements under interactive control reach the same state as in a program") {
    const Progress silent;
    for (const Description& d : {finger(1, 0.85, Act::elements), block(1, 1.4, Act::elements)}) {
        const Model model = made(d);
        Live live(model, {.steps = 8, .tolerance = 1e-6});
        const LiveTarget target = live.target_at(1);
        for (int piece = 0; !live.advance(target, silent).arrived; ++piece) REQUIRE(piece < 100);
        const Vec3 steered = comparison::tip_displacement(d, live.describe());
        const Vec3 run_there = comparison::tip_displacement(d, run_to_the_end(d, Solver::automatic, 1e-6).steps.back());
        CHECK(norm(steered - run_there) < 1e-4 * norm(run_there));
    }
}

TEST_CASE("impossible targets of elements are refused") {
    const auto refusal = [](Description d) {
        const auto model = Model::create(std::move(d));
        REQUIRE_FALSE(model);
        return model.error().message;
    };
    Description d = finger(1, 0.9, Act::elements);
    d.cables[0].target.kind = CableTarget::Kind::tension_N;
    CHECK(refusal(d).find("neither tension nor friction") != std::string::npos);
    d = finger(1, 0.9, Act::elements);
    d.growths[0].weight_Pa = 0;
    CHECK(refusal(d).find("weight above zero") != std::string::npos);
    d = block(1, 1.2, Act::elements);
    d.chambers[0].target.kind = ChamberTarget::Kind::pressure_Pa;
    CHECK(refusal(d).find("volumes only") != std::string::npos);
}
