// Predictions of a linearised state for changes of its inputs, and the number of solves they take.
#include "simulation/inverse/sensitivity.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

using Kind = CableTarget::Kind;

/// A bar with three cables, of which two pull; or with more of them, which are slack.
struct Pulled {
    explicit Pulled(int cables = 3, Kind kind = Kind::length_ratio)
        : model(made(with(cables, kind))),
          task(task_for(model, std::vector<std::pair<double, double>>(
                                   static_cast<std::size_t>(cables),
                                   kind == Kind::length_ratio ? std::pair(0.75, 1.0) : std::pair(0.0, 10.0)))),
          shares(Eigen::VectorXd::Constant(cables, kind == Kind::length_ratio ? 1 : 0)) {
        shares[0] = 0.6;
        shares[2] = 0.5;
        task.goals = {at_point({0.055, 0.005, 0.02})};
        robot = at(shares, nullptr, nullptr);
        REQUIRE(space.is_slack(robot, 1) == (kind == Kind::length_ratio));
    }

    [[nodiscard]] RobotState at(const Eigen::VectorXd& wanted, const State* expected, int* iterations) {
        RobotState to = robot.controls.drives.empty() ? stepper.rest() : robot;
        const StepReport report = stepper.drive(to, space.inputs(wanted, 1), {}, expected);
        REQUIRE_MESSAGE(report.arrived, report.reason);
        if (iterations != nullptr) *iterations = report.iterations;
        return to;
    }

    [[nodiscard]] Sensitivity sensitivity() {
        auto made = Sensitivity::create(stepper, space, robot);
        REQUIRE(made);
        made->use(rows.gradients(made->at(), 0, {}));
        return std::move(*made);
    }

    [[nodiscard]] static Description with(int cables, Kind kind) {
        Description d = bar(std::min(cables, 4), 1, kind);
        for (int k = 4; k < cables; ++k)
            d.cables.push_back(cable_at(d.mesh, fmt::format("cable {}", k), 0.003 + 0.001 * (k - 4), 0.006,
                                        {kind, kind == Kind::length_ratio ? 1.0 : 0.0}));
        return d;
    }

    Model model;
    InverseTask task;
    Stepper stepper{model, tight};
    InputSpace space{stepper, task};
    GoalRows rows{stepper, task, space};
    RobotState robot;
    Eigen::VectorXd shares;
};

}  // namespace

TEST_CASE("few inputs, or few residuals, are solved for at once, and are the same as one by one") {
    Pulled bar(3, Kind::tension_N);
    const Eigen::Vector3d a(1, 0.2, 0), b(0.1, 0, -1);
    Sensitivity by_inputs = bar.sensitivity(), by_rows = bar.sensitivity();
    RowGradients two = bar.rows.gradients(by_rows.at(), 0, {});
    two.by_positions = Eigen::SparseMatrix<double, Eigen::RowMajor>(two.by_positions.topRows(2));
    two.by_multipliers = two.by_multipliers.topRows(2).eval();
    two.by_inputs = two.by_inputs.topRows(2).eval();
    by_rows.use(two);
    const Eigen::VectorXd whole = by_inputs.multiply(a), part = by_rows.multiply(a);
    CHECK(by_inputs.solutions() == 3);
    CHECK(by_rows.solutions() == 2);
    CHECK((whole.head(2) - part).norm() < 1e-3 * part.norm());  // each solution has a residual of 1e-5
    CHECK(a.dot(by_inputs.multiply_transposed(b)) == near(b.dot(whole), {.relative = 1e-12}));
    CHECK(b.head(2).dot(by_rows.multiply(b)) ==
          near(b.dot(by_rows.multiply_transposed(b.head(2))), {.relative = 1e-12}));
    CHECK(by_inputs.solutions() == 3);
    CHECK(by_rows.solutions() == 2);

    // One response after the other, with no batch.
    const std::vector<Derivative> derivatives = bar.space.derivatives(by_inputs.at());
    const RowGradients rows = bar.rows.gradients(by_inputs.at(), 0, {});
    Eigen::VectorXd sum = rows.by_inputs * a;
    for (Eigen::Index i = 0; i < 3; ++i) {
        const Result<Change> change = by_inputs.at().response(derivatives[static_cast<std::size_t>(i)]);
        REQUIRE(change);
        sum += a[i] * (rows.by_positions * change->positions + rows.by_multipliers * change->multipliers);
    }
    CHECK((whole - sum).norm() < 1e-3 * sum.norm());
}

TEST_CASE("lengths only act through the multipliers, whose responses are known without a further solution") {
    Pulled bar(7);
    Sensitivity at = bar.sensitivity();
    const Eigen::VectorXd step = Eigen::VectorXd::LinSpaced(7, -1, 0.2);
    const Eigen::VectorXd rows = at.multiply(step);
    CHECK(at.solutions() == 0);
    const std::vector<Derivative> derivatives = bar.space.derivatives(at.at());
    Derivative sum = derivatives[0];
    for (Eigen::VectorXd* part : {&sum.equations, &sum.direct.positions, &sum.direct.multipliers}) part->setZero();
    for (Eigen::Index i = 0; i < 7; ++i) sum.equations += step[i] * derivatives[static_cast<std::size_t>(i)].equations;
    const RowGradients gradients = bar.rows.gradients(at.at(), 0, {});
    Linearisation exact = *Linearisation::create(bar.stepper.system(), bar.robot.now.state, bar.robot.controls);
    const Result<Change> change = exact.response(sum);
    REQUIRE(change);
    const Eigen::VectorXd one = gradients.by_positions * change->positions;
    CHECK((rows - one).norm() < 1e-4 * one.norm());
}

TEST_CASE("of many inputs and residuals, combinations of solved directions need no further solution") {
    Pulled bar(7, Kind::tension_N);
    Sensitivity known = bar.sensitivity(), fresh = bar.sensitivity();
    RowGradients many = bar.rows.gradients(known.at(), 0, {});
    const Eigen::SparseMatrix<double, Eigen::RowMajor> three = many.by_positions;
    many.by_positions.resize(9, three.cols());
    for (int block = 0; block < 3; ++block) many.by_positions.middleRows(3 * block, 3) = (1 + block) * three;
    many.by_multipliers = Eigen::MatrixXd::Zero(9, many.by_multipliers.cols());
    many.by_inputs = Eigen::MatrixXd::Zero(9, 7);
    known.use(many);
    const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(7, -1, 0.2), b = Eigen::VectorXd::Unit(7, 2);
    (void)known.multiply(a);
    (void)known.multiply(b);
    CHECK(known.solutions() == 2);
    const Eigen::VectorXd found = known.multiply(0.3 * a - 2 * b), told = fresh.multiply(0.3 * a - 2 * b);
    CHECK(known.solutions() == 2);
    CHECK((found.head(3) - told).norm() < 1e-3 * told.norm());
    CHECK((found.tail(3) - 3 * told).norm() < 3e-3 * told.norm());
    const Eigen::VectorXd c = Eigen::VectorXd::LinSpaced(9, 0, 1);
    const Eigen::VectorXd back = known.multiply_transposed(c), again = known.multiply_transposed(-4 * c);
    CHECK(known.solutions() == 3);
    CHECK((again + 4 * back).norm() < 1e-12 * back.norm());
    CHECK(c.dot(found) == near(back.dot(0.3 * a - 2 * b), {.relative = 1e-3}));
    (void)known.multiply(Eigen::VectorXd::Unit(7, 4));
    CHECK(known.solutions() == 4);
}

TEST_CASE("Broyden updates also apply to stored products") {
    Pulled bar;
    Sensitivity at = bar.sensitivity();
    const Eigen::Vector3d step(0.1, 0, 0.05), miss(1, -2, 3);
    const Eigen::VectorXd before = at.multiply(step);
    at.learn(step, miss);
    CHECK((at.multiply(step) - before - miss).norm() < 1e-12 * (before + miss).norm());
    const Eigen::Vector3d across(0, 1, 0);
    const double straight = bar.sensitivity().multiply(across).dot(miss);
    CHECK(at.multiply_transposed(miss).dot(across) == near(straight, {.relative = 1e-3, .absolute = 1e-6}));
}

TEST_CASE("the predicted state's error is quadratic in the step, and the step from it ends at the same state") {
    Pulled bar;
    Sensitivity at = bar.sensitivity();
    const auto off = [&](double size) {
        const Eigen::Vector3d step = size * Eigen::Vector3d(-1, 0, 0.5);
        (void)at.multiply(step);
        const State expected = at.expected(bar.stepper, bar.robot.now.state, step);
        int from_there = 0, from_here = 0;
        const RobotState there = bar.at(bar.shares + step, &expected, &from_there);
        const RobotState here = bar.at(bar.shares + step, nullptr, &from_here);
        CHECK(from_there < from_here);
        CHECK((there.x() - here.x()).norm() < 1e-5 * (here.x() - bar.robot.x()).norm());
        return (expected.x - here.x()).norm();
    };
    const double whole = off(0.08), half = off(0.04);
    CHECK(half < 0.3 * whole);
}

TEST_CASE("a step that lets a cable go slack is predicted with the cable slack") {
    Pulled bar;
    bar.shares[2] = 0.6;
    bar.robot = bar.at(bar.shares, nullptr, nullptr);
    Eigen::Vector3d step(0, 0, 0);
    step[2] = 0.9 * (1 - bar.shares[2]);  // the third cable is paid out, the first one still pulls
    const RobotState end = bar.at(bar.shares + step, nullptr, nullptr);
    REQUIRE(bar.space.is_slack(end, 2));
    const State& now = bar.robot.now.state;
    Sensitivity at = bar.sensitivity();
    CHECK(at.expected_multipliers(now, step)[2] < 0);
    const double held = (at.expected(bar.stepper, now, step).x - end.x()).norm();
    at.slacken(bar.space, {2});
    at.use(bar.rows.gradients(at.at(), 0, {}));
    const Eigen::VectorXd change = at.release({2}, now);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(3);
    const State expected = at.expected(bar.stepper, now, none);
    CHECK(expected.multiplier[2] == near(0, {.absolute = 1e-9}));
    CHECK((expected.x - end.x()).norm() < 0.2 * held);
    CHECK((expected.x - end.x()).norm() < 0.2 * (end.x() - now.x).norm());
    const Eigen::VectorXd found =
        bar.rows.values(end, bar.shares + step, 0, {}) - bar.rows.values(bar.robot, bar.shares, 0, {});
    CHECK((change - found).norm() < 0.2 * found.norm());
    CHECK(at.release({}, now).isZero(0));
    CHECK(at.expected(bar.stepper, now, none).x == now.x);
}

TEST_CASE("a predicted state far from equilibrium has no effect") {
    Pulled bar;
    State wild = bar.robot.now.state;
    wild.x *= 1.5;
    const Eigen::VectorXd step = bar.shares + Eigen::Vector3d(-0.05, 0, 0);
    const RobotState told = bar.at(step, &wild, nullptr), alone = bar.at(step, nullptr, nullptr);
    CHECK(told.x() == alone.x());
}
