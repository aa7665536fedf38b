// Reduced models beside the whole robot: positions, tensions and pressures, the estimated error, and the way back.
#include "simulation/reduced/reduced_model.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/inverse/test_robots.hpp"
#include "simulation/reduced/error_estimate.hpp"
#include "simulation/reduced/reduced_solver.hpp"
#include "simulation/reduced/sampled_robot.hpp"
#include "simulation/reduced/self_contact.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::reduced;
using inverse::InputSpace;
using inverse::testing::bar;
using inverse::testing::hollow;
using inverse::testing::made;
using inverse::testing::task_for;
using inverse::testing::tight;

namespace {

ReducedModel reduced_of(const Model& model, const InverseTask& task, const ReductionOptions& options = {}) {
    Progress silent;
    Result<Reduction> reduction = reduce(model, tight, task, options, silent);
    REQUIRE_MESSAGE(reduction, (reduction ? "" : reduction.error().message));
    Result<ReducedModel> reduced = ReducedModel::create(model, std::move(*reduction));
    REQUIRE_MESSAGE(reduced, (reduced ? "" : reduced.error().message));
    return std::move(*reduced);
}

struct Errors {
    double positions = 0;                           ///< largest of a node, relative to the largest motion
    double multipliers = 0;                         ///< largest, relative to the largest multiplier
    double least_ratio = 1e300, largest_ratio = 0;  ///< of the estimated to the true error of positions
};

/// Compares at inputs that are no samples.
Errors compared(const Model& model, const InverseTask& task, const ReducedModel& reduced, int count) {
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    ReducedSolver solver(reduced);
    ErrorEstimator estimator(reduced, stepper);
    Errors errors;
    double reach = 0, largest = 0;
    for (const Sample& sample : reduced.reduction().samples) {
        reach = std::max(reach, (sample.state.x - stepper.system().rest().x).cwiseAbs().maxCoeff());
        largest = std::max(largest, sample.state.multiplier.cwiseAbs().maxCoeff());
    }
    for (int k = 0; k < count; ++k) {
        const Inputs inputs = space.inputs(inverse::spread_point(1001 + 7 * k, space.size()), 1);
        ReducedState state = solver.start(inputs);
        REQUIRE(solver.solve(state, inputs).found);
        RobotState exact = stepper.rest();
        REQUIRE(stepper.drive(exact, inputs, {}).arrived);
        const Eigen::VectorXd off = reduced.positions(state.at.amplitudes) - exact.x();
        double error = 0;
        for (Eigen::Index n = 0; n < off.size(); n += 3) error = std::max(error, off.segment<3>(n).norm());
        errors.positions = std::max(errors.positions, error / reach);
        errors.multipliers = std::max(
            errors.multipliers, (state.at.multipliers - exact.now.state.multiplier).cwiseAbs().maxCoeff() / largest);
        const double ratio = estimator.estimate(state).error_m / error;
        errors.least_ratio = std::min(errors.least_ratio, ratio);
        errors.largest_ratio = std::max(errors.largest_ratio, ratio);
    }
    return errors;
}

void check_accurate(const Errors& errors) {
    CHECK(errors.positions < 0.01);
    CHECK(errors.multipliers < 0.02);
    CHECK(errors.least_ratio > 0.5);
    CHECK(errors.largest_ratio < 2);
}

}  // namespace

TEST_CASE("reduced model: two cables, linear and quadratic tets") {
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const Model model = made(bar(2, order));
        const InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}});
        const ReducedModel reduced = reduced_of(model, task);
        MESSAGE("modes ", reduced.mode_count(), ", tets ", reduced.reduction().tets.size(), " of ",
                model.mesh().tet_count());
        CHECK(reduced.reduction().tets.size() < model.mesh().tet_count() / 2);
        check_accurate(compared(model, task, reduced, 12));
    }
}

TEST_CASE("reduced model: a chamber by volume, pressure and sealed gas, with a cable") {
    using Kind = ChamberTarget::Kind;
    const std::vector<std::pair<ChamberTarget, std::pair<double, double>>> targets = {
        {{Kind::volume_ratio, 1}, {1, 1.4}}, {{Kind::pressure_Pa, 0}, {0, 1e4}}, {{Kind::gas_ratio, 1}, {1, 1.1}}};
    for (const auto& [target, range] : targets) {
        CAPTURE(static_cast<int>(target.kind));
        const Model model = made(hollow(1, target));
        const InverseTask task = task_for(model, {{0.9, 1}, range});
        check_accurate(compared(model, task, reduced_of(model, task), 8));
    }
}

TEST_CASE("reduced model: with all tets and all modes it is the whole robot at the samples") {
    const Model model = made(bar(1));
    const InverseTask task = task_for(model, {{0.85, 1}});
    Progress silent;
    Result<Reduction> reduction =
        reduce(model, tight, task, {.samples = 12, .basis_error = 1e-9, .force_error = 1e-3}, silent);
    REQUIRE(reduction);
    reduction->tets.clear();
    for (std::size_t t = 0; t < model.mesh().tet_count(); ++t) reduction->tets.push_back({t, 1.0});
    reduction->check_tets = reduction->tets;
    const auto reduced = ReducedModel::create(model, *reduction);
    REQUIRE(reduced);
    ReducedSolver solver(*reduced);
    for (const Sample& sample : reduction->samples) {
        ReducedState state = solver.start(reduction->samples.back().inputs);
        REQUIRE(solver.solve(state, sample.inputs).found);
        CHECK((reduced->positions(state.at.amplitudes) - sample.state.x).cwiseAbs().maxCoeff() <
              1e-3 * reduced->reach_m());
        CHECK(state.at.multipliers[0] == near(sample.state.multiplier[0], {.relative = 1e-3, .absolute = 1e-4}));
    }
}

TEST_CASE(
    "reduced model: a robot that would meet itself only on the straight way from one sample to the next is sampled") {
    Description d = bar(2);
    d.contact.emplace();
    d.contact->surface = contact::robot_surface(d.mesh);
    d.contact->settings.self = d.contact->self_when_met = true;
    d.contact->settings.distance_m = 1e-4;
    d.contact->settings.slip_m = 1e-5;
    d.contact->settings.stiffness_Pa = 1e6;
    const Model model = made(d);
    // By turns bent far up and far down: on the straight way between the two the bar is crushed.
    const InverseTask task = task_for(model, {{0.6, 1}, {0.6, 1}});
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    RobotState robot = stepper.rest();
    int met = 0;
    for (const double up : {0.0, 1.0, 0.0, 1.0}) {
        REQUIRE(stepper.drive(robot, space.inputs(Eigen::Vector2d(up, 1 - up), 1), {}).arrived);
        met += robot.controls.met;
        CHECK_FALSE(touches_itself(stepper, robot));
        CHECK_FALSE(robot.controls.met);
    }
    CHECK(met > 0);
    const ReducedModel reduced = reduced_of(model, task, {.samples = 8});
    CHECK(reduced.reduction().touching == 0);
}

TEST_CASE("reduced model: gravity, slack cables and cables by tension") {
    Description d = bar(2);
    d.gravity_m_s2 = {0, 0, -9.81};
    d.gravity_share = ramp(1, 1);
    d.cables[1].target = {CableTarget::Kind::tension_N, 0};
    const Model model = made(std::move(d));
    // Above 1 the first cable is longer than the sagging bar needs: slack.
    const InverseTask task = task_for(model, {{0.9, 1.05}, {0, 2}});
    const ReducedModel reduced = reduced_of(model, task);
    check_accurate(compared(model, task, reduced, 12));
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    ReducedSolver solver(reduced);
    const Inputs slack = space.inputs(Eigen::Vector2d(1, 1), 1);
    ReducedState state = solver.start(slack);
    REQUIRE(solver.solve(state, slack).found);
    CHECK(state.at.multipliers[0] == 0);
    CHECK(state.at.multipliers[1] == near(2, {.relative = 1e-12}));
}

TEST_CASE("reduced model: the way back to the whole robot") {
    const Model model = made(bar(2));
    const InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}});
    const ReducedModel reduced = reduced_of(model, task, {.basis_error = 0.02});  // crude, so that there is an error
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    ReducedSolver solver(reduced);
    ErrorEstimator estimator(reduced, stepper);
    const Inputs inputs = space.inputs(Eigen::Vector2d(0.3, 0.8), 1);
    ReducedState state = solver.start(inputs);
    REQUIRE(solver.solve(state, inputs).found);
    const Estimate estimate = estimator.estimate(state);
    const auto exact = estimator.exact(state, estimate, {});
    REQUIRE(exact);
    RobotState known = stepper.rest();
    REQUIRE(stepper.drive(known, inputs, {}).arrived);
    CHECK((exact->x() - known.x()).cwiseAbs().maxCoeff() < 1e-6);
    CHECK(exact->now.state.multiplier[0] == near(known.now.state.multiplier[0], {.relative = 1e-4, .absolute = 1e-6}));
    const double error = (reduced.positions(state.at.amplitudes) - known.x()).cwiseAbs().maxCoeff();
    CHECK(error > 1e-5);
    CHECK((estimate.corrected.x - known.x()).cwiseAbs().maxCoeff() < 0.5 * error);
}

TEST_CASE("reduced model: the same bits on any number of threads, and from the same state") {
    const Model model = made(bar(2));
    const InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}});
    std::vector<Eigen::VectorXd> amplitudes;
    std::vector<std::vector<Weight>> tets;
    for (const std::size_t threads : {1U, 3U}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const ReducedModel reduced = reduced_of(model, task, {.samples = 20});
        tets.push_back(reduced.reduction().tets);
        Stepper stepper(model, tight);
        const InputSpace space(stepper, task);
        ReducedSolver solver(reduced);
        const Inputs inputs = space.inputs(Eigen::Vector2d(0.3, 0.8), 1);
        for (int run = 0; run < 2; ++run) {  // the second after another solution
            ReducedState state = solver.start(inputs);
            REQUIRE(solver.solve(state, inputs).found);
            amplitudes.push_back(state.at.amplitudes);
            ReducedState other = state;
            REQUIRE(solver.solve(other, space.inputs(Eigen::Vector2d(0.9, 0.1), 1)).found);
        }
    }
    CHECK(tets[0] == tets[1]);
    for (const Eigen::VectorXd& one : amplitudes) CHECK(one == amplitudes[0]);
}

TEST_CASE("reduced model: what it does not cover is refused by name") {
    const auto refusal = [](const std::function<void(Description&)>& change) {
        Description d = bar(1);
        change(d);
        const Status status = check_reducible(d);
        REQUIRE(!status);
        return status.error().message;
    };
    CHECK(refusal([](Description& d) { d.moves_in_time = true; }).find("motion in time") != std::string::npos);
    CHECK(refusal([](Description& d) { d.cables[0].friction = 0.1; }).find("\"above\"") != std::string::npos);
    CHECK(refusal([](Description& d) { d.supports[0].move_m = {0, 0, 0.01}; }).find("\"clamp\"") != std::string::npos);
    CHECK(refusal([](Description& d) { d.contact.emplace(); }).find("[contact]") != std::string::npos);
    CHECK(refusal([](Description& d) { d.fluid.emplace(); }).find("[fluid]") != std::string::npos);
    CHECK(check_reducible(bar(1)));
}

TEST_CASE("reduced model: cancelled work ends at once") {
    class Cancelled final : public Progress {
    public:
        [[nodiscard]] bool cancelled() const override { return true; }
    };
    const Model model = made(bar(1));
    Cancelled progress;
    const auto reduction = reduce(model, tight, task_for(model, {{0.85, 1}}), {}, progress);
    REQUIRE(!reduction);
    CHECK(reduction.error().cause == Cause::cancelled);
}
