// Gradients of whole programs against programs of robots that differ a little.
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

/// Where the tip is and how the cable pulls, all steps together.
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

/// The same of a run of the program, by what the results say.
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
        sum += objective
                   .judge(step.index, std::vector<double>{tip.x, tip.y, tip.z, step.cables[0].tension_N, force})
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

/// By all numbers of the robot, what its cable is wanted to do, and rest positions.
double worst_error(const Description& d, const Program& program) {
    const Objective objective = wanted_motion(program.steps);
    const ProgramGradient found = gradient_of(d, program, objective, {.by = {.rest = true}});
    CHECK(found.value == near(value_of_run(d, program, objective), {.relative = 1e-9}));
    Case c(d);
    Controls controls = c.system.controls(program.duration);
    if (program.dynamics) {
        const State rest = c.system.rest();
        const Eigen::VectorXd still = Eigen::VectorXd::Zero(rest.x.size());
        controls.inertia =
            std::make_shared<const Inertia>(c.model.elements(), c.model.free_index(),
                                            History{rest.x, still, rest.x, still, 0}, 1, program.dynamics->damping,
                                            nullptr);
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
            return value_of_run(with_value(d, p, p.value + change), other, objective);
        });
    }
    double by_target = 0;  // what is wanted goes from 1 to it in a straight line
    for (const ProgramGradient::Instant& instant : found.instants) {
        if (instant.by_inputs.size() > 0)
            by_target += instant.by_inputs[0] * instant.time / program.duration * c.system.actuators()[0].rest_measure();
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

TEST_CASE("a program at rest at every instant, as the sum over its steps") {
    for (const int order : {1, 2}) {
        const double worst =
            worst_error(bender(order), {.steps = 2, .tolerance = 1e-11, .solver = Solver::newton, .checks = false});
        MESSAGE("order ", order, ": ", worst);
    }
}

TEST_CASE("a program in motion through time") {
    const Program program{.steps = 5,
                          .duration = 0.02,
                          .tolerance = 1e-11,
                          .solver = Solver::newton,
                          .dynamics = Dynamics{{20, 0}},
                          .checks = false};
    MESSAGE("in time: ", worst_error(bender(1, program.duration), program));
}
