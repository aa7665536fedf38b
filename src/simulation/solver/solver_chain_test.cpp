// Fallback solvers for one that stalls, the record of iterations, and pressures that cannot be reached.
#include "simulation/solver/solver_chain.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/run/test_bar.hpp"
#include "simulation/run/test_problems.hpp"
#include "simulation/solver/pressure_limit.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::bar_side;
using testing::solve;

namespace {

/// A bar of 4 x 1 x 1 cm whose free end is moved sideways.
Description pushed_bar() {
    Description d;
    d.mesh = reference::kuhn_box({4 * bar_side, bar_side, bar_side}, 8, 2, 2, [](Vec3) { return 0; });
    d.materials = {{"A", material::neo_hookean(1e6, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}},
                  {"grip",
                   reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 4 * bar_side - 1e-9; }),
                   {0, 0, 0.5 * bar_side}}};
    return d;
}

/// The bar with a cable along its upper side.
Description pulled_bar(double length_ratio) {
    Description d = pushed_bar();
    d.supports.pop_back();
    d.cables = {testing::flexor(d.mesh, {CableTarget::Kind::length_ratio, length_ratio})};
    return d;
}

/// The same with two more cables, of which one stays slack.
Description pulled_from_three_sides() {
    Description d = pulled_bar(0.92);
    for (const double across : {0.0, 1.0}) {
        Cable cable{across == 0 ? "left" : "right", {}, {CableTarget::Kind::length_ratio, across == 0 ? 0.96 : 1.0}};
        for (int k = 0; k <= 4; ++k)
            cable.points.push_back(reference::mean_of(reference::nodes_where(d.mesh, [&](Vec3 p) {
                return norm(p - Vec3{k * bar_side, across * bar_side, bar_side / 2}) < 1e-9;
            })));
        d.cables.push_back(std::move(cable));
    }
    return d;
}

Description hollow_block(ChamberTarget target) {
    Description d = testing::hollow_block(1);
    d.chambers[0].target = std::move(target);
    return d;
}

/// A solver that fails, or makes little progress.
class StallingSolver final : public Curvature {
public:
    StallingSolver(const FactoredLaplacian& laplacian, bool slow, int& asked)
        : laplacian_(&laplacian), slow_(slow), asked_(&asked) {}
    [[nodiscard]] Solver solver() const override { return Solver::newton; }
    [[nodiscard]] int default_iteration_limit() const override { return 1000; }
    [[nodiscard]] bool refresh(const State&, const Controls&, TangentChoice, Errors) override {
        ++*asked_;
        return slow_;
    }
    void solve(Eigen::MatrixXd& columns) override {
        laplacian_->solve(columns);
        columns *= 1e-6;
    }

private:
    const FactoredLaplacian* laplacian_;
    bool slow_;
    int* asked_;
};

}  // namespace

TEST_CASE("if the first solver stalls the next one finishes the step, and the next step starts with the first") {
    const auto model = Model::create(pushed_bar());
    REQUIRE(model);
    const Equilibrium system(*model);
    const FactoredLaplacian laplacian(system);
    const Controls controls = system.controls(0.2);
    Progress silent;
    for (const bool slow : {false, true}) {
        int asked = 0;
        SolverChain chain({{Solver::newton, [&] { return std::make_unique<StallingSolver>(laplacian, slow, asked); }},
                           {Solver::quasi_newton, [&] { return make_quasi_newton(laplacian); }}});
        int before = 0;
        for (int round = 0; round < 2; ++round) {
            State state = system.rest();
            system.place_supports(controls, state.x);
            system.add_free(laplacian.follow(system, state.x - system.rest().x), 1, state.x);
            chain.restart();
            const StepOutcome outcome = chain.solve(system, controls, {1e-6, 0}, state, silent);
            REQUIRE_MESSAGE(outcome.converged, outcome.reason);
            CHECK(outcome.solver == Solver::quasi_newton);
            CHECK(outcome.evaluation.residual <= 1e-6);
            CHECK(asked - before == (slow ? 30 : 3));  // once with each tangent, or until patience ends
            before = asked;
            const auto first_of = [&](Solver solver) {
                return std::ranges::find(outcome.history, solver, &IterationRecord::solver);
            };
            CHECK(first_of(Solver::newton) == outcome.history.begin());
            CHECK(first_of(Solver::quasi_newton)->iteration == 0);
            CHECK(outcome.history.back().iteration + (slow ? 30 : 1) == outcome.iterations);
        }
    }
}

TEST_CASE("if all solvers fail all reasons are given, and each has used its own iterations") {
    const auto model = Model::create(pushed_bar());
    REQUIRE(model);
    const Equilibrium system(*model);
    const FactoredLaplacian laplacian(system);
    const Controls controls = system.controls(0.2);
    int asked = 0;
    SolverChain chain({{Solver::newton, [&] { return std::make_unique<StallingSolver>(laplacian, false, asked); }},
                       {Solver::local_global, [&] { return make_local_global(laplacian); }}});
    State state = system.rest();
    system.place_supports(controls, state.x);
    system.add_free(laplacian.follow(system, state.x - system.rest().x), 1, state.x);
    Progress silent;
    const StepOutcome outcome = chain.solve(system, controls, {1e-9, 0}, state, silent);
    CHECK_FALSE(outcome.converged);
    CHECK(outcome.iterations == 101);
    CHECK(outcome.reason.starts_with("no step lowers the energy"));
    CHECK(outcome.reason.find("; with local-global: no convergence in 100 iterations") != std::string::npos);
}

TEST_CASE("several cables: Newton, which keeps the body's responses to them, ends where quasi-Newton does") {
    const Description d = pulled_from_three_sides();
    const Trajectory newton = solve(d, {.steps = 6, .tolerance = 1e-8, .solver = Solver::newton});
    const Trajectory other = solve(d, {.steps = 6, .tolerance = 1e-8, .solver = Solver::quasi_newton});
    REQUIRE_MESSAGE(newton.converged, newton.message);
    REQUIRE_MESSAGE(other.converged, other.message);
    REQUIRE(newton.steps.back().cables[0].tension_N > 0.1);
    CHECK(newton.steps.back().cables[2].tension_N == 0);  // slack
    for (std::size_t k = 0; k < newton.steps.size(); ++k) {
        CAPTURE(k);
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(newton.steps[k].cables[c].tension_N ==
                  near(other.steps[k].cables[c].tension_N, {.relative = 1e-5, .absolute = 1e-6}));
            CHECK(newton.steps[k].cables[c].length_m == near(other.steps[k].cables[c].length_m, {.relative = 1e-7}));
        }
    }
}

TEST_CASE("the body's responses to constraints are kept for one factor and one set of actuators") {
    const auto model = Model::create(pulled_from_three_sides());
    REQUIRE(model);
    const Equilibrium system(*model);
    const FactoredLaplacian laplacian(system);
    const auto newton = make_newton(system, laplacian);
    const State state = system.rest();
    const Controls controls = system.controls(0.2);
    REQUIRE(newton->refresh(state, controls, TangentChoice::quickest, {}));
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Constant(3 * model->free_count(), 1, 1e-3);
    newton->solve(gradient);
    int asked = 0;
    const auto yielding_to = [&](const std::vector<Eigen::Index>& actuators) {
        const auto forces = [&](const Eigen::VectorXd& x, const Controls&) {
            ++asked;
            Eigen::MatrixXd columns(3 * model->free_count(), static_cast<Eigen::Index>(actuators.size()));
            for (std::size_t k = 0; k < actuators.size(); ++k) {
                Eigen::VectorXd force = Eigen::VectorXd::Zero(x.size());
                system.actuators()[static_cast<std::size_t>(actuators[k])].add_gradient(linalg::view(x), 1,
                                                                                        linalg::view(force));
                columns.col(static_cast<Eigen::Index>(k)) = system.restrict_to_free(force);
            }
            return columns;
        };
        const Curvature::Yielding* yielding = newton->yielding_to({actuators, forces});
        REQUIRE(yielding != nullptr);
        Eigen::MatrixXd expected = forces(state.x, controls);
        --asked;
        newton->solve(expected);
        CHECK((yielding->motions - expected).norm() < 1e-3 * expected.norm());
        CHECK(yielding->compliance.cols() == static_cast<Eigen::Index>(actuators.size()));
    };
    yielding_to({0, 1});
    yielding_to({0, 1});
    CHECK(asked == 1);
    yielding_to({0, 2});
    yielding_to({0, 1, 2});
    CHECK(asked == 3);
}

TEST_CASE("a solver chosen by name is used alone") {
    const Trajectory result =
        solve(pulled_bar(0.7), {.steps = 1, .tolerance = 1e-6, .solver = Solver::newton, .iteration_limit = 4});
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.steps.back().substeps > 1);  // it needed several substeps
    for (const IterationRecord& record : result.iterations) CHECK(record.solver == Solver::newton);
    CHECK(result.steps.back().solver == Solver::newton);
}

TEST_CASE("auto: a step that needs more iterations is finished by the other solver, not halved") {
    Description d = pulled_bar(0.95);
    d.materials = {{"A", material::shape_blend(1e6, 0.3), 1000}};  // no energy: quasi-newton, then anderson
    const Trajectory alone = solve(d, {.steps = 1, .tolerance = 1e-5, .solver = Solver::quasi_newton});
    REQUIRE_MESSAGE(alone.converged, alone.message);
    const int needed = alone.steps.back().iterations;
    const Trajectory helped = solve(d, {.steps = 1, .tolerance = 1e-5, .iteration_limit = needed - 1});
    REQUIRE_MESSAGE(helped.converged, helped.message);
    CHECK(helped.solver == "quasi-newton");
    CHECK(helped.steps.back().solver == Solver::anderson);
    CHECK(helped.steps.back().substeps == 1);
    CHECK(helped.steps.back().iterations >= needed);
    CHECK(helped.steps.back().cables[0].tension_N == near(alone.steps.back().cables[0].tension_N, {.relative = 1e-3}));
}

/// The free end of the bar as a plate.
Description with_plate(Description d) {
    d.plates = {{"end", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 4 * bar_side - 1e-9; })}};
    return d;
}

TEST_CASE("auto: a law without an energy, with a plate") {
    Description d = with_plate(testing::bar(2, material::shape_blend(1e6, 0.45)));
    d.gravity_m_s2 = {0, 0, -9.81};
    const Trajectory result = solve(d, {.steps = 1, .tolerance = 1e-6});
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.steps.back().solver == Solver::newton);
    CHECK(result.steps.back().iterations < 30);
}

TEST_CASE("a plate is as accurate as rounding errors of its stiff springs allow") {
    Description d = with_plate(testing::bar(2, material::neo_hookean(1e6, 0.4999)));
    d.gravity_m_s2 = {0, 0, -9.81};
    const Trajectory result = solve(d, {.steps = 1, .tolerance = 1e-9});
    REQUIRE_MESSAGE(result.converged, result.message);
}

TEST_CASE("a torque on a plate bends a bar beyond a right angle, in few iterations") {
    // Its tangent is not symmetric, the more so the further the plate turns.
    constexpr double inertia_m4 = bar_side * bar_side * bar_side * bar_side / 12;
    for (const Vec3 axis : {Vec3{0, -1, 0}, Vec3{0.3, 0.2, 1}}) {
        Description d = with_plate(testing::bar(2, material::neo_hookean(1e6, 0.3)));
        d.torques = {{"turn", d.plates[0].nodes, 1.75 * 1e6 * inertia_m4 / (4 * bar_side) * axis}};
        const Trajectory result = solve(d, {.steps = 5, .tolerance = 1e-7, .solver = Solver::newton});
        REQUIRE_MESSAGE(result.converged, result.message);
        int iterations = 0;
        for (const Step& step : result.steps) iterations += step.iterations;
        CHECK(iterations < 50);
    }
}

TEST_CASE("every iteration is recorded with the state it led to") {
    for (const Solver solver : {Solver::newton, Solver::anderson}) {
        const Trajectory result = solve(pulled_bar(0.9), {.steps = 3, .tolerance = 1e-6, .solver = solver});
        REQUIRE_MESSAGE(result.converged, result.message);
        int step = 1;
        int counted = 0;
        for (std::size_t i = 0; i < result.iterations.size(); ++i) {
            const IterationRecord& r = result.iterations[i];
            CHECK(r.solver == solver);
            CHECK(r.step >= step);
            step = r.step;
            CHECK(r.time == near(step / 3.0, {.relative = 1e-12}));
            CHECK(r.min_J > 0);
            CHECK((r.alpha > 0) == (r.iteration > 0));
            CHECK(r.alpha <= 1);
            if (r.iteration > 0) ++counted;
            const bool last = i + 1 == result.iterations.size() || result.iterations[i + 1].iteration == 0;
            if (!last) continue;
            const Step& reached = result.steps[static_cast<std::size_t>(step)];
            CHECK(r.residual == reached.residual);
            CHECK(r.min_J == reached.min_J);
            CHECK(r.iteration == reached.iterations);
            CHECK(r.violation <= 1e-8);
        }
        int total = 0;
        for (const Step& s : result.steps) total += s.iterations;
        CHECK(counted == total);
        CHECK(result.iterations.front().violation == near(0.1 / 3, {.relative = 1e-12}));
    }
}

TEST_CASE("Anderson mixing needs a fraction of the plain iterations, with a cable and with a chamber") {
    const auto iterations = [](const Description& d, Solver solver) {
        const Trajectory result = solve(d, {.steps = 3, .tolerance = 1e-5, .solver = solver});
        REQUIRE_MESSAGE(result.converged, result.message);
        int sum = 0;
        for (const Step& step : result.steps) sum += step.iterations;
        return sum;
    };
    for (const Description& d :
         {pulled_bar(0.9), hollow_block({ChamberTarget::Kind::volume_ratio, 1.4}), pushed_bar()}) {
        const int plain = iterations(d, Solver::local_global);
        const int mixed = iterations(d, Solver::anderson);
        CAPTURE(plain);
        CHECK(mixed * 3 < plain);
    }
}

TEST_CASE("Anderson mixing inverts the pairs it has learned; the projected tangent gives the plain step") {
    const auto model = Model::create(pushed_bar());
    REQUIRE(model);
    const Equilibrium system(*model);
    const FactoredLaplacian laplacian(system);
    const auto mixing = make_anderson(laplacian);
    const Controls controls = system.controls(0);
    const State state = system.rest();
    const Eigen::Index n = 3 * model->free_count();
    const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(n, -1, 2);
    const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(n, 1, 0.5).array().square();
    Eigen::MatrixXd columns(n, 2);
    columns << u, v;
    Eigen::MatrixXd inverse = columns;
    laplacian.solve(inverse);
    // Learn two exact pairs: y = 5 u for s = L^-1 u, y = 0.2 v for s = L^-1 v.
    mixing->restart();
    mixing->learn(inverse.col(0), 5 * u);
    mixing->learn(inverse.col(1), 0.2 * v);
    REQUIRE(mixing->refresh(state, controls, TangentChoice::quickest, {}));
    Eigen::MatrixXd asked(n, 2);
    asked << 5 * u, u + v;
    Eigen::MatrixXd expected(n, 2);
    expected << inverse.col(0), inverse.col(0) / 5 + inverse.col(1) / 0.2;
    mixing->solve(asked);
    CHECK((asked - expected).norm() < 1e-8 * expected.norm());
    // Projected: the plain step.
    REQUIRE(mixing->refresh(state, controls, TangentChoice::projected, {}));
    Eigen::MatrixXd plain = columns;
    mixing->solve(plain);
    CHECK((plain - inverse).norm() == 0);
    // And the misleading history is discarded.
    REQUIRE(mixing->refresh(state, controls, TangentChoice::quickest, {}));
    plain = columns;
    mixing->solve(plain);
    CHECK((plain - inverse).norm() == 0);
}

TEST_CASE("a pressure beyond a chamber's largest names that limit in its message; driven by volume it passes") {
    const Trajectory by_volume =
        solve(hollow_block({ChamberTarget::Kind::volume_ratio, 12}), {.steps = 60, .tolerance = 1e-5});
    REQUIRE_MESSAGE(by_volume.converged, by_volume.message);
    double largest = 0;
    for (const Step& step : by_volume.steps) largest = std::max(largest, step.chambers[0].pressure_Pa);
    REQUIRE(by_volume.steps.back().chambers[0].pressure_Pa < 0.99 * largest);  // there is a maximum to be found

    const Trajectory by_pressure =
        solve(hollow_block({ChamberTarget::Kind::pressure_Pa, 1.3 * largest}), {.steps = 13, .tolerance = 1e-5});
    CHECK_FALSE(by_pressure.converged);
    CHECK(by_pressure.message.find("No equilibrium was found above") != std::string::npos);
    CHECK(by_pressure.message.find("Drive it by volume_ratio") != std::string::npos);
    const std::string words = "has a maximum of ";
    const std::size_t at = by_pressure.message.find(words);
    REQUIRE_MESSAGE(at != std::string::npos, by_pressure.message);
    CHECK(1e3 * std::stod(by_pressure.message.substr(at + words.size())) == near(largest, {.relative = 5e-3}));
}

TEST_CASE("a program that stops for another reason does not name a pressure limit") {
    Description d = hollow_block({ChamberTarget::Kind::pressure_Pa, 3000});
    const Trajectory result = solve(d, {.steps = 2, .tolerance = 1e-9, .iteration_limit = 1});
    CHECK_FALSE(result.converged);
    CHECK(result.message.find("No equilibrium") == std::string::npos);
}
