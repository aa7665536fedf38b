// Gradients of programs with objects, masses and free bodies, in time, against the same steps converged anew for
// slightly different robots. Lagged quantities are held fixed: normal forces and tangents of friction; so are the
// reaches of contact, which depend on small distances at rest. At equilibrium: random_gradients_test.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "base/core/near.hpp"
#include "simulation/gradient/program_gradient.hpp"
#include "simulation/gradient/test_reconverged.hpp"
#include "simulation/linearisation/test_random_robots.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

Marker middle_of(const FreeObject& object) {
    return {object.name, {{object.nodes.begin(), object.nodes.end()}, {0.25, 0.25, 0.25, 0.25}, {}}};
}

/// A free soft block on the ground, a box that is thrown onto it, and one beside it on the ground.
Description scene(double friction) {
    Description d = plain();
    d.supports.clear();
    d.may_be_free = true;
    d.gravity_m_s2 = {0.5, 0.2, -9.81};
    d.masses = {{"weight", {end_of(d.mesh), {}, {}}, 0.4e-3}};
    const auto count = d.masses[0].point.nodes.size();
    d.masses[0].point.weights.assign(count, 1.0 / static_cast<double>(count));
    d.materials[0].law = material::neo_hookean(1e5, 0.4);
    ContactRules rules;
    rules.surface = contact::robot_surface(d.mesh);
    rules.settings = {0.05 * edge, 2e4, friction, 1e-5, true};
    const contact::HalfSpace ground{{0, 0, -0.03 * edge}, {0, 0, 1}};
    rules.obstacles.push_back({{"ground", ground, 0.6 * friction}, {0, 0, 0.02 * edge}});
    d.contact = std::move(rules);
    test::add_box(d, "thrown", {0.8 * edge, 0.2 * edge, 1.11 * edge}, {0.6 * edge, 0.5 * edge, 0.4 * edge});
    test::add_box(d, "beside", {3.1 * edge, 0.1 * edge, 0}, {0.5 * edge, 0.7 * edge, 0.6 * edge});
    d.objects[0].velocity_m_s = {0.1, 0.03, -0.2};
    d.objects[0].angular_velocity_rad_s = {2, -3, 4};
    d.objects[0].friction = 1.5 * friction;
    d.objects[1].velocity_m_s = {-0.05, 0, 0};
    d.markers = {{"corner", {{d.mesh.nodes.back()}, {1}, {}}}};
    for (const FreeObject& object : d.objects) d.markers.push_back(middle_of(object));
    return d;
}

Objective at_the_end(const Description& d, int steps) {
    Objective objective;
    const Vec3 some{0.3, -0.5, 0.8};
    for (std::size_t k = 0; k < d.markers.size(); ++k) objective.measures.push_back({Measure::Kind::marker, k, some});
    objective.measures.push_back({Measure::Kind::contact_force, 0, some});
    objective.judge = [steps](int step, std::span<const double> at) {
        Judgement judged{0, std::vector<double>(at.size(), 0.0)};
        const std::vector<double> weights = {100, 80, -60, 0.3};
        for (std::size_t k = 0; step == steps && k < at.size(); ++k) {
            judged.value += weights[k] * at[k];
            judged.slopes[k] = weights[k];
        }
        return judged;
    };
    return objective;
}

/// The steps of a program, and how friction was frozen in each.
struct Steps {
    std::vector<Controls> controls;
    std::vector<State> states;
};

/// As the program takes them.
Steps steps_of_program(const Description& d, const Program& program) {
    const Case c(d);
    Stepper stepper(c.model, stepper_options(program));
    RobotState robot = stepper.rest();
    Progress silent;
    Steps all;
    for (int k = 1; k <= program.steps; ++k) {
        StepPath path = program_path(stepper, program, robot, k);
        int pieces = 0;
        path.after_piece = [&](const RobotState&) { ++pieces; };
        const StepReport report = stepper.step(robot, path, silent);
        REQUIRE_MESSAGE(report.arrived, report.reason);
        REQUIRE(pieces == 1);
        all.states.push_back(robot.now.state);
        all.controls.push_back(robot.controls);
    }
    return all;
}

/// The objective after the same steps of a robot that differs by `change` of a number, or in its initial state. `terms`
/// receives the sum of the magnitudes of its terms, which may largely cancel.
double value_of(const Description& d, const Steps& as, const Objective& objective, const Parameter* p = nullptr,
                double change = 0, std::optional<Damping> damping = std::nullopt, double* terms = nullptr) {
    Case c(d);
    const Inertia& first = *as.controls[0].inertia;
    const MotionInTime motion(c.model, {});
    History history = first.is_tether() ? MotionInTime::still(c.system.rest().x) : motion.at_rest(c.system.rest().x);
    State now = c.system.rest();
    Controls before = c.system.controls(0);
    for (std::size_t k = 0; k < as.states.size(); ++k) {
        const Controls& was = as.controls[k];
        Controls controls = c.system.controls(was.time);
        controls.met = was.met;
        controls.inertia =
            std::make_shared<const Inertia>(c.model.elements(), c.model.free_index(), history, was.inertia->dt(),
                                            damping.value_or(was.inertia->damping()), nullptr, was.inertia->scheme());
        if (was.friction) {
            const contact::Contact& contact = *c.model.contact(was.met);
            const Parameter none{Parameter::Kind::gravity, 0, "", ""};
            auto pairs = pairs_with(contact, *was.friction, p != nullptr ? *p : none,
                                    p != nullptr && p->value != 0 ? 1 + change / p->value : 1);
            const std::vector<double> start = c.system.with_obstacles(now.x, before.obstacles);
            if (before.friction) contact::carry_over(*before.friction, start, pairs);
            controls.friction =
                std::make_shared<const contact::Friction>(std::move(pairs), start, was.friction->slip_m());
        }
        now = as.states[k];
        if (!converge(c.system, controls, now)) return std::numeric_limits<double>::quiet_NaN();
        history = first.is_tether() ? MotionInTime::still(now.x) : MotionInTime::after(*controls.inertia, now.x);
        before = controls;
    }
    std::vector<double> values;
    for (const Measure& measure : objective.measures) values.push_back(slope(c.system, now, before, measure).value);
    const Judgement judged = objective.judge(static_cast<int>(as.states.size()), values);
    for (std::size_t k = 0; terms != nullptr && k < values.size(); ++k)
        *terms += std::fabs(judged.slopes[k] * values[k]);
    return judged.value;
}

/// Relative to the derivative or, where rounding hides that, to the change of the objective (`scale`) if the number
/// changed by its full size, as in gradient_error().
double floored_error(double told, double size, double scale, const std::function<double(double change)>& value) {
    return best_error(0.02 * size, [&](double h) {
        const double found = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
        if (!std::isfinite(found)) return std::numeric_limits<double>::infinity();
        return std::fabs(told - found) / std::max(std::fabs(found), 1e-5 * scale / size);
    });
}

/// The object drawn elsewhere, moved by t + r x (X - c) for each unit of change.
Description moved(Description d, std::size_t k, double change, const Vec3& t, const Vec3& r) {
    FreeObject& object = d.objects[k];
    Vec3 centre;
    for (const int node : object.nodes) centre += 0.25 * d.mesh.points[static_cast<std::size_t>(node)];
    const auto place = [&](Vec3& p) { p += change * (t + cross(r, p - centre)); };
    for (const int node : object.nodes) place(d.mesh.points[static_cast<std::size_t>(node)]);
    for (Vec3& p : object.surface.points) place(p);
    return d;
}

struct NamedError {
    double error = 0;
    std::string name;
};

NamedError worst_gradient(const Description& d, const Program& program, bool by_place) {
    const Objective objective = at_the_end(d, program.steps);
    const Case c(d);
    Progress silent;
    auto found = program_gradient(c.model, program, objective, {.by = {.rest = by_place}}, silent);
    REQUIRE_MESSAGE(found, found.error().message);
    const Steps as = steps_of_program(d, program);
    double scale = 0;
    CHECK(found->value == near(value_of(d, as, objective, nullptr, 0, {}, &scale), {.relative = 1e-6}));
    NamedError worst;
    const auto note = [&](const std::string& name, double told, double size, const auto& value) {
        const double error = floored_error(told, size, scale, value);
        INFO(name);
        INFO(told);
        CHECK(error < 1e-6);
        if (error > worst.error) worst = {error, name};
    };
    Controls last = as.controls.back();  // its inertia is that of a model that is gone
    last.inertia = std::make_shared<const Inertia>(c.model.elements(), c.model.free_index(), last.inertia->start(),
                                                   last.inertia->dt(), last.inertia->damping(), nullptr);
    const std::vector<Parameter> all = parameters(c.at(as.states.back(), last));
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Parameter& p = all[k];
        note(p.name, found->by.parameters[static_cast<Eigen::Index>(k)], size_of(p), [&](double change) {
            std::optional<Damping> damping;
            if (p.kind == Parameter::Kind::mass_damping) {
                damping = as.controls[0].inertia->damping();
                damping->mass_per_s += change;
            }
            return value_of(with_value(d, p, p.value + change), as, objective, &p, change, damping);
        });
    }
    for (std::size_t k = 0; k < d.objects.size(); ++k) {
        for (int part = 0; program.dynamics && part < 6; ++part)
            note(d.objects[k].name + " starts", found->by_start(part, static_cast<Eigen::Index>(k)), part < 3 ? 0.1 : 3,
                 [&](double change) {
                     Description other = d;
                     Vec3& v = part < 3 ? other.objects[k].velocity_m_s : other.objects[k].angular_velocity_rad_s;
                     v[static_cast<std::size_t>(part % 3)] += change;
                     return value_of(other, as, objective);
                 });
        if (!by_place) continue;
        const Vec3 t{0.2, -0.5, 0.7}, r{30, 20, -40};
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(found->by.rest.size());
        const Description one = moved(d, k, 1, t, r);
        for (const int node : d.objects[k].nodes)
            motion.segment<3>(3 * node) = linalg::vector(one.mesh.points[static_cast<std::size_t>(node)] -
                                                         d.mesh.points[static_cast<std::size_t>(node)]);
        note(d.objects[k].name + " drawn elsewhere", found->by.rest.dot(motion), 0.1 * edge,
             [&](double change) { return value_of(moved(d, k, change, t, r), as, objective); });
    }
    return worst;
}

Program in_time(int steps) {
    return {.steps = steps,
            .duration = 1e-3 * steps,
            .tolerance = 1e-9,
            .solver = Solver::newton,
            .dynamics = Dynamics{{3, 0}},
            .checks = false};
}

}  // namespace

TEST_CASE("gradients of thrown objects that hit a soft body and the ground, by numbers, velocities and places") {
    const NamedError worst = worst_gradient(scene(0), in_time(6), true);
    MESSAGE("worst: ", worst.error, " (", worst.name, ")");
}

TEST_CASE("gradients of thrown objects with friction whose anchors are kept") {
    const NamedError worst = worst_gradient(scene(0.5), in_time(6), false);
    MESSAGE("worst: ", worst.error, " (", worst.name, ")");
}
