// Derivatives with respect to the parameters of a robot, against robots with other values.
#include "simulation/linearisation/parameters.hpp"

#include <doctest/doctest.h>

#include <set>

#include "base/core/near.hpp"
#include "simulation/linearisation/test_parameters.hpp"
#include "simulation/linearisation/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

using Kind = Parameter::Kind;

/// The controls of a robot at the state that is looked at, in motion with so much more damping.
using DampedControlsOf = std::function<Controls(Equilibrium&, const Damping& more)>;

/// Of a robot with another value of p: the equations at the same unknowns.
Eigen::VectorXd equations_at_value(const Linearisation& at, const Parameter& p, double value,
                                   const DampedControlsOf& controls_of) {
    Case other(with_value(at.system().model().description(), p, value));
    Damping more;
    if (p.kind == Kind::mass_damping) more.mass_per_s = value - p.value;
    if (p.kind == Kind::stiffness_damping) more.stiffness_s = value - p.value;
    Controls controls = controls_of(other.system, more);
    if (p.kind == Kind::ambient_pressure) controls.drives = at.controls().drives;
    State state = at.state();
    other.system.place_supports(controls, state.x);
    return at.equations(other.system, state, controls);
}

/// Worst relative error of all parameters of a state; and derivatives of a quantity by all of them at once.
double worst_parameter_error(Case& c, State state, const DampedControlsOf& controls_of, std::set<Kind>& seen) {
    c.system.place_supports(controls_of(c.system, {}), state.x);
    Linearisation at = c.at(state, controls_of(c.system, {}));
    Noise noise(9);
    const Eigen::VectorXd weights = some_direction(at, Side::transposed, noise);
    const Quantity none{Eigen::VectorXd::Zero(state.x.size()), Eigen::VectorXd::Zero(state.multiplier.size())};
    const std::vector<Parameter> all = parameters(at);
    const Eigen::VectorXd products = derivatives(at, {none, weights}, all);
    double worst = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Parameter& p = all[k];
        seen.insert(p.kind);
        CAPTURE(p.name);
        const Eigen::VectorXd by = derivative(at, p).equations;
        CHECK(-weights.dot(by) == near(products[static_cast<Eigen::Index>(k)],
                                       {.absolute = 1e-12 * weights.cwiseAbs().dot(by.cwiseAbs())}));
        const Eigen::VectorXd least =
            Eigen::VectorXd::Constant(static_cast<Eigen::Index>(at.solved().size()), 1e-6 * by.norm() * edge);
        const double error = best_error(0.02 * size_of(p), [&](double h) {
            return relative_error(
                at,
                difference([&](double change) { return equations_at_value(at, p, p.value + change, controls_of); }, h),
                by, least);
        });
        CHECK(error < 1e-7);
        worst = std::max(worst, error);
    }
    return worst;
}

}  // namespace

TEST_CASE("derivatives by every law's constants and by density, both orders") {
    double worst = 0;
    std::set<Kind> seen;
    for (const int order : {1, 2}) {
        for (std::size_t k = 0; k < laws.size(); ++k) {
            CAPTURE(laws[k].first);
            Description d = plain(order);
            for (std::size_t t = 0; t < d.mesh.tet_count(); ++t) d.mesh.region[t] = t % 3 == 0 ? 1 : 0;
            d.mesh.region_names = {"A", "B"};
            d.materials = {{"A", laws[k].second, 1000}, {"B", material::neo_hookean(0.37e6, 0.35), 1200}};
            d.material_of_region = {0, 1};
            d.gravity_m_s2 = {0, 3, -9.81};
            d.plates = {{"plate", end_of(d.mesh)}};
            Case c(std::move(d));
            worst =
                std::max(worst, worst_parameter_error(
                                    c, disturbed(c.system, 0, 0),
                                    [](Equilibrium& system, const Damping&) { return system.controls(0.7); }, seen));
        }
    }
    MESSAGE("laws: ", worst);
}

TEST_CASE("derivatives by numbers of springs, loads, supports, gas and cable friction") {
    Description d = block(1, material::neo_hookean(1e6, 0.4));
    d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1.2};
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.95})};
    d.cables[0].friction = 0.4;
    d.springs = {{"coil", d.cables[0].points, 300, 0.8 * 3 * edge},
                 {"band", d.cables[0].points, 100, std::nullopt, true}};
    const std::vector<int> end = end_of(d.mesh);
    d.loads = {{"hook", end, std::vector<double>(end.size(), 1.0 / static_cast<double>(end.size())), {0.1, 0, -0.3}}};
    d.pressures = {patch(d.mesh, -1)};
    d.gravity_m_s2 = {0, 3, -9.81};
    d.supports[0].turn = {0.2, {1, 2, 0}, {0, 0, edge}};
    d.supports.push_back({"roller",
                          reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * edge - 1e-9; }),
                          {0.02 * edge, 0, 0.01 * edge},
                          ramp(0, 1),
                          {0.1, {1, 1, 0}, {}},
                          {{0, 1, 1}}});
    Case c(std::move(d));
    State state = disturbed(c.system, 0.5, 2e3);
    c.system.place_supports(c.system.controls(0.3), state.x);  // friction is lagged at these positions
    const auto controls_of = [&](Equilibrium& system, const Damping&) {
        Controls controls = system.controls(0.3);
        std::vector<Drive> wanted = controls.drives;
        wanted[0].value = system.actuators()[0].measure({state.x.data(), static_cast<std::size_t>(state.x.size())});
        system.freeze_cable_friction(state.x, wanted, system.controls(0).drives, controls);
        return controls;
    };
    std::set<Kind> seen;
    MESSAGE("springs and the rest: ", worst_parameter_error(c, state, controls_of, seen));
    for (const Kind kind :
         {Kind::spring_stiffness, Kind::spring_free_length, Kind::cable_friction, Kind::load_force, Kind::load_pressure,
          Kind::gravity, Kind::ambient_pressure, Kind::support_move, Kind::support_angle})
        CHECK(seen.contains(kind));
}

TEST_CASE("derivatives by contact stiffness and friction") {
    Case c(touching_blocks());
    const Settled at = pressed(c.system);
    State start = at.state;
    Noise noise(6);
    for (double& entry : start.x) entry += 0.02 * edge * noise();
    const auto controls_of = [&](Equilibrium& system, const Damping&) {
        Controls controls = system.controls(0.9);
        controls.friction = system.freeze_friction(at.state, start, controls, system.controls(0.8));
        return controls;
    };
    std::set<Kind> seen;
    MESSAGE("contact: ", worst_parameter_error(c, at.state, controls_of, seen));
    for (const Kind kind : {Kind::contact_stiffness, Kind::self_friction, Kind::obstacle_friction})
        CHECK(seen.contains(kind));
}

TEST_CASE("derivatives by the weights of gaps that a cable closes") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    d.mesh.region_names = {"solid", "gap", "wide gap"};
    d.materials.push_back({"gap", gap_law(1e6), 0});
    d.materials.push_back({"wide gap", gap_law(1e6), 0});
    d.material_of_region = {0, 1, 2};
    for (std::size_t t = 0; t < 7; ++t) d.mesh.region[t] = t < 4 ? 1 : 2;
    d.growths = {{1, {1, 0, 0}, 0, 1e5, edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}},
                 {2, {0.8, 0.6, 0}, 0, 3e5, 0.5 * edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}}};
    Case c(std::move(d));
    std::set<Kind> seen;
    MESSAGE("gaps: ", worst_parameter_error(
                          c, disturbed(c.system, 0.5, 0),
                          [](Equilibrium& system, const Damping&) { return system.controls(0.7); }, seen));
    CHECK(seen.contains(Kind::gap_weight));
}

TEST_CASE("derivatives by density and damping in dynamics") {
    Description d = plain(2);
    d.gravity_m_s2 = {0, 3, -9.81};
    Case c(std::move(d));
    const State before = disturbed(c.system, 0, 0, 4), rest = c.system.rest();
    const History history{before.x, before.x - rest.x, rest.x, before.x, 0};
    // Damped by the stiffness that the robot with the changed number has there.
    const auto controls_of = [&](Equilibrium& system, const Damping& more) {
        Controls controls = system.controls(0.7);
        MotionInTime motion(system.model(), {2 + more.mass_per_s, 3e-4 + more.stiffness_s});
        controls.inertia = motion.inertia(history, 1e-3);
        return controls;
    };
    std::set<Kind> seen;
    MESSAGE("in motion: ", worst_parameter_error(c, disturbed(c.system, 0, 0), controls_of, seen));
    CHECK(seen.contains(Kind::mass_damping));
    CHECK(seen.contains(Kind::stiffness_damping));
}

TEST_CASE("every number has a unique name, a unit and its value") {
    Description d = block(1, material::corotated(1e6, 0.4));
    d.pressures = {patch(d.mesh, -1)};
    Case c(std::move(d));
    const Linearisation at = c.at(c.system.rest(), c.system.controls(0.5));
    std::set<std::string> names;
    for (const auto& list : {inputs(at), parameters(at)}) {
        for (const Parameter& p : list) CHECK(names.insert(p.name).second);
    }
    const auto find = [&](const std::string& name) {
        for (const Parameter& p : parameters(at)) {
            if (p.name == name) return p;
        }
        return Parameter{};
    };
    CHECK(find("material \"A\": youngs_modulus").value == near(1e6, {.relative = 1e-12}));
    CHECK(find("material \"A\": youngs_modulus").unit == "Pa");
    CHECK(find("load \"gust\": full pressure").value == 3e3);
    CHECK(inputs(at).back().name == "load \"gust\": pressure");
    CHECK(inputs(at).back().value == 1.5e3);
}
