// Gradients of whole programs against programs of slightly different robots.
#include "simulation/gradient/program_gradient.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "base/core/near.hpp"
#include "simulation/gradient/test_reconverged.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

/// A block that a cable bends, under gravity, its clamp pushed aside, all of it by `end`.
Description bender(int order = 1, double end = 1) {
    Description d = plain(order);
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.96})};
    d.gravity_m_s2 = {0, 2, -9.81};
    d.supports[0].move_m = {0, 0.02 * edge, 0};
    d.markers = {{"tip", d.cables[0].points.back()}};
    d.cables[0].target.keys = Curve{{0, end}, {1, 0.96}};
    d.supports[0].share = d.gravity_share = Curve{{0, end}, {0, 1}};
    return d;
}

ProgramGradient gradient_of(const Description& d, const Program& program, const Objective& objective,
                            const GradientOptions& options = {}) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, model.error().message);
    Progress silent;
    auto result = program_gradient(*model, program, objective, options, silent);
    REQUIRE_MESSAGE(result, result.error().message);
    return std::move(*result);
}

/// Position of the tip and tension of the cable, summed over all steps.
Objective wanted_motion(int steps) {
    Objective objective;
    objective.measures = along_axes({Measure::Kind::marker, 0});
    objective.measures.push_back({Measure::Kind::tension, 0});
    objective.measures.push_back({Measure::Kind::reaction, 0, {0.3, -0.5, 0.8}});
    objective.judge = [steps](int step, std::span<const double> at) {
        const double share = static_cast<double>(step) / steps;
        return squared_distance(at, std::vector<double>{2.9 * edge, 0.5 * edge, edge, 3 * share, 0.1},
                                std::vector<double>{1e4, 2e4, 1e4 * share, 0.5, 0.3});
    };
    return objective;
}

/// The same objective, from the results of a run of the program.
double value_of_run(const Description& d, const Program& program, const Objective& objective) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, model.error().message);
    Progress silent;
    const Trajectory t = run(*model, program, silent);
    REQUIRE_MESSAGE(t.converged, t.message);
    double sum = 0;
    for (const Step& step : t.steps) {
        if (step.index == 0) continue;
        const Vec3 tip = step.markers[0].position_m;
        const double force = dot(step.supports[0].force_N, {0.3, -0.5, 0.8});
        sum += objective.judge(step.index, std::vector<double>{tip.x, tip.y, tip.z, step.cables[0].tension_N, force})
                   .value;
    }
    return sum;
}

/// Relative error of a derivative against four-point differences, the best of several steps.
double error_of(double told, double size, const std::function<double(double change)>& value) {
    return best_error(0.02 * size, [&](double h) {
        const double found = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
        return std::fabs(told - found) / std::fabs(found);
    });
}

/// With respect to all numbers of the robot, its cable target, and rest positions.
double worst_error(const Description& d, const Program& program) {
    const Objective objective = wanted_motion(program.steps);
    const ProgramGradient found = gradient_of(d, program, objective, {.by = {.rest = true}});
    CHECK(found.value == near(value_of_run(d, program, objective), {.relative = 1e-9}));
    Case c(d);
    Controls controls = c.system.controls(program.duration);
    if (program.dynamics) {
        const State rest = c.system.rest();
        const Eigen::VectorXd still = Eigen::VectorXd::Zero(rest.x.size());
        controls.inertia = std::make_shared<const Inertia>(c.model.elements(), c.model.free_index(),
                                                           History{rest.x, still, rest.x, still, 0}, 1,
                                                           program.dynamics->damping, nullptr);
    }
    const std::vector<Parameter> all = parameters(c.at(c.system.rest(), controls));
    double worst = 0;
    const auto note = [&](const std::string& name, double told, double size, const auto& value) {
        const double error = error_of(told, size, value);
        INFO(name);
        CHECK(error < 1e-6);
        worst = std::max(worst, error);
    };
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Parameter& p = all[k];
        note(p.name, found.by.parameters[static_cast<Eigen::Index>(k)], size_of(p), [&](double change) {
            Program other = program;
            if (p.kind == Parameter::Kind::mass_damping) other.dynamics->damping.mass_per_s += change;
            if (p.kind == Parameter::Kind::stiffness_damping) other.dynamics->damping.stiffness_s += change;
            return value_of_run(with_value(d, p, p.value + change), other, objective);
        });
    }
    double by_target = 0;  // what is wanted goes from 1 to it in a straight line
    for (const ProgramGradient::Instant& instant : found.instants) {
        if (instant.by_inputs.size() > 0)
            by_target +=
                instant.by_inputs[0] * instant.time / program.duration * c.system.actuators()[0].rest_measure();
    }
    note("target", by_target, 0.1, [&](double change) {
        Description other = d;
        other.cables[0].target.keys->value[1] += change;
        return value_of_run(other, program, objective);
    });
    Noise noise(3);
    const Eigen::VectorXd motion = noise.vector(found.by.rest.size());
    note("rest positions", found.by.rest.dot(motion), 0.1 * edge, [&](double change) {
        Description other = d;
        for (std::size_t n = 0; n < other.mesh.points.size(); ++n) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                other.mesh.points[n][axis] += change * motion[static_cast<Eigen::Index>(3 * n + axis)];
        }
        return value_of_run(other, program, objective);
    });
    return worst;
}

}  // namespace

TEST_CASE("the gradient of a quasi-static program is the sum over its steps") {
    for (const int order : {1, 2}) {
        const double worst =
            worst_error(bender(order), {.steps = 2, .tolerance = 1e-11, .solver = Solver::newton, .checks = false});
        MESSAGE("order ", order, ": ", worst);
    }
}

TEST_CASE("gas that a program prescribes as a ratio follows the ambient pressure") {
    Description d = block(1, material::neo_hookean(1e6, 0.4));
    d.gravity_m_s2 = {1, -2, -9};  // else the density has no effect
    d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1.3};
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.96})};
    d.cables[0].target.keys = Curve{{0, 1}, {1, 0.96}};
    d.markers = {{"tip", d.cables[0].points.back()}};
    const double worst = worst_error(d, {.steps = 2, .tolerance = 1e-11, .solver = Solver::newton, .checks = false});
    MESSAGE("with sealed gas: ", worst);
}

TEST_CASE("the gradient of a program in dynamics") {
    for (const Damping& damping : {Damping{20, 0}, Damping{20, 0.004}}) {
        const Program program{.steps = 5,
                              .duration = 0.02,
                              .tolerance = 1e-11,
                              .solver = Solver::newton,
                              .dynamics = Dynamics{damping},
                              .checks = false};
        const double worst = worst_error(bender(1, program.duration), program);
        MESSAGE("in time, damped by stiffness ", damping.stiffness_s, " s: ", worst);
    }
}

namespace {

/// The bender over a table that rises, with friction.
Description rubbing() {
    Description d = touching_blocks();
    d.markers = {{"tip", {{static_cast<int>(d.mesh.points.size()) - 1}, {1.0}, {}}}};
    d.gravity_m_s2 = {1, 2, -9.81};
    d.contact->obstacles[0].move_m = {0.05 * edge, 0, 0.32 * edge};
    return d;
}

/// The friction frozen in each step of a program, solved for the given robot with its own starts of steps.
struct Lagged {
    std::vector<Controls> controls;
    std::vector<State> states;
};

/// Runs the steps of a program; with `as`, with the friction frozen there.
Lagged steps_of(const Description& d, int steps, const Lagged* as, const Parameter* p, double value) {
    Case c(d);
    Stepper stepper(c.model, {.solver = Solver::newton, .tolerance = 1e-10});
    Lagged all;
    RobotState robot = stepper.rest();
    Progress silent;
    State now = robot.now.state;
    Controls before = robot.controls;
    for (int k = 1; k <= steps; ++k) {
        const double time = static_cast<double>(k) / steps;
        if (as == nullptr) {
            const StepPath path{time, [&](double t) { return stepper.controls(robot, t); }, 1.0 / 64 / steps};
            REQUIRE(stepper.step(robot, path, silent).arrived);
            REQUIRE(robot.past.size() == static_cast<std::size_t>(std::min(k, 3)));  // in one piece each
            now = robot.now.state;
            before = robot.controls;
        } else {
            const auto u = static_cast<std::size_t>(k - 1);
            Controls controls = c.system.controls(time);
            const contact::Friction& frozen = *as->controls[u].friction;
            std::vector<contact::FrozenPair> pairs(frozen.pairs().begin(), frozen.pairs().end());
            for (contact::FrozenPair& pair : pairs) {
                if (p->kind == Parameter::Kind::contact_stiffness || p->kind == Parameter::Kind::obstacle_friction)
                    pair.limit_N *=
                        p->kind == Parameter::Kind::contact_stiffness || pair.obstacle >= 0 ? value / p->value : 1;
                if (p->kind == Parameter::Kind::self_friction && pair.obstacle < 0) pair.limit_N *= value / p->value;
            }
            std::vector<double> start(now.x.begin(), now.x.end());
            start.insert(start.end(), before.obstacles.begin(), before.obstacles.end());
            if (before.friction) contact::carry_over(*before.friction, start, pairs);
            controls.friction = std::make_shared<const contact::Friction>(pairs, start, frozen.slip_m());
            now = as->states[u];
            REQUIRE(converge(c.system, controls, now));
            before = controls;
        }
        all.states.push_back(now);
        all.controls.push_back(before);
    }
    return all;
}

}  // namespace

TEST_CASE("gradients with friction that slips from the last step's end, by numbers and obstacle motion") {
    const int steps = 3;
    const Description d = rubbing();
    Objective objective = at_end({Measure::Kind::marker, 0, {0.3, -0.5, 0.8}}, steps);
    const Program program{.steps = steps, .tolerance = 1e-10, .solver = Solver::newton, .checks = false};
    const ProgramGradient found = gradient_of(d, program, objective);
    const Lagged lagged = steps_of(d, steps, nullptr, nullptr, 0);
    Case c(d);
    Controls met = lagged.controls.back();
    const std::vector<Parameter> all = parameters(c.at(lagged.states.back(), met));
    double worst = 0;
    bool history = false;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Parameter& p = all[k];
        const double told = found.by.parameters[static_cast<Eigen::Index>(k)];
        INFO(p.name);
        const double error = best_error(0.02 * size_of(p), [&](double h) {
            const auto value = [&](double change) {
                const Description other = with_value(d, p, p.value + change);
                const Lagged taken = steps_of(other, steps, &lagged, &p, p.value + change);
                Case now(other);
                return slope(now.system, taken.states.back(), taken.controls.back(), objective.measures[0]).value;
            };
            const double by_difference = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
            return std::fabs(told - by_difference) /
                   std::max(std::fabs(by_difference), 1e-8 * found.value / size_of(p));
        });
        CHECK(error < 1e-6);
        worst = std::max(worst, error);
        history = history || p.kind == Parameter::Kind::self_friction;
    }
    CHECK(history);
    MESSAGE("friction over ", steps, " steps: ", worst);
    REQUIRE(found.instants.size() == 3);
    CHECK(found.instants[1].by_inputs.norm() > 0);  // through friction only: the objective depends on the end alone
}

TEST_CASE("any number of kept states and threads gives the same bits") {
    const Description d = bender(1, 0.02);
    const Program program{
        .steps = 7, .duration = 0.02, .tolerance = 1e-6, .dynamics = Dynamics{{20, 0.001}}, .checks = false};
    const auto bits = [&](int kept, std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const ProgramGradient found =
            gradient_of(d, program, wanted_motion(7), {.by = {.tets = true, .rest = true}, .kept = kept});
        CHECK(found.instants.size() == 7);
        std::vector<double> all = {found.value};
        const auto keep = [&](const auto& part) { all.insert(all.end(), part.data(), part.data() + part.size()); };
        keep(found.by.parameters);
        keep(found.by.tets.constants);
        keep(found.by.tets.density);
        keep(found.by.rest);
        for (const ProgramGradient::Instant& instant : found.instants) keep(instant.by_inputs);
        return all;
    };
    const std::vector<double> first = bits(8, 1);
    for (const auto& [kept, threads] : {std::pair<int, std::size_t>{0, 2}, {1, 1}, {2, 4}, {8, 4}}) {
        CAPTURE(kept);
        CAPTURE(threads);
        const std::vector<double> again = bits(kept, threads);
        REQUIRE(again.size() == first.size());
        CHECK(std::memcmp(first.data(), again.data(), sizeof(double) * first.size()) == 0);
    }
}

TEST_CASE("steps in time that had to be halved count with all their parts") {
    Program program{.steps = 2,
                    .duration = 0.02,
                    .tolerance = 1e-11,
                    .solver = Solver::newton,
                    .dynamics = Dynamics{{20, 0}},
                    .iteration_limit = 3,
                    .checks = false};
    const Description d = bender(1, 0.02);
    const Objective objective = at_end({Measure::Kind::marker, 0, {0, 0, 1}}, program.steps);
    const ProgramGradient found = gradient_of(d, program, objective);
    REQUIRE(found.instants.size() > 2);
    const double density = d.materials[0].density_kg_m3;
    const Parameter p{Parameter::Kind::density, 0, "", "", density};
    const auto value = [&](double change) {
        const auto model = Model::create(with_value(d, p, density + change));
        Progress silent;
        const Trajectory t = run(*model, program, silent);
        REQUIRE_MESSAGE(t.converged, t.message);
        REQUIRE(t.steps[1].substeps + t.steps[2].substeps == static_cast<int>(found.instants.size()));
        return t.steps.back().markers[0].position_m.z;
    };
    Case c(d);
    const std::vector<Parameter> all = parameters(c.at(c.system.rest(), c.system.controls(1)));
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k].kind == Parameter::Kind::density)
            CHECK(error_of(found.by.parameters[static_cast<Eigen::Index>(k)], density, value) < 1e-6);
    }
}

TEST_CASE("missing measures, steps that do not converge, and cancelling are errors") {
    const auto model = Model::create(bender());
    Progress silent;
    const auto told = [&](const Measure& measure, const Program& program, Progress& progress) {
        const auto found = program_gradient(*model, program, at_end(measure, program.steps), {}, progress);
        REQUIRE_FALSE(found);
        return found.error();
    };
    CHECK(told({Measure::Kind::pressure, 0}, {.steps = 1}, silent).message ==
          "there is no chamber 0: the robot has 0, counted from 0");
    CHECK(told({Measure::Kind::marker, 3, {1, 0, 0}}, {.steps = 1}, silent).message ==
          "there is no marker 3: the robot has 1, counted from 0");
    const Error stopped =
        told({Measure::Kind::marker, 0, {1, 0, 0}},
             {.steps = 1, .tolerance = 1e-11, .solver = Solver::newton, .iteration_limit = 1}, silent);
    CHECK(stopped.cause == Cause::failed);
    CHECK(stopped.message.starts_with("stopped at step 1 of 1: "));
    class Impatient : public Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } impatient;
    CHECK(told({Measure::Kind::marker, 0, {1, 0, 0}}, {.steps = 1}, impatient).cause == Cause::cancelled);
}
