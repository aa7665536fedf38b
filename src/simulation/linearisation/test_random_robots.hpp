// Random robots at one of their states, and slightly modified copies.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "simulation/linearisation/test_differences.hpp"
#include "simulation/linearisation/test_parameters.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/run/test_random_program.hpp"

namespace pliant::sim::testing {

/// A random robot, sometimes with things that random_program leaves out: pressure on a patch with a free rim, a spring,
/// a roller, a rigid plate.
inline Description with_more(Description d, unsigned seed) {
    test::Dice dice(seed + 1000);
    const auto where = [&](const std::function<bool(Vec3)>& inside) { return reference::nodes_where(d.mesh, inside); };
    if (dice.chance(0.4)) {
        d.pressures = {patch(d.mesh, dice.between(0, 2) * test::side)};
        d.pressures[0].pressure_Pa = std::pow(10, dice.between(1, 3));
    }
    if (dice.chance(0.4)) {
        const Cable path = test::random_cable(dice, d.mesh, 0);
        // Not the rest length: the force of a band has a kink where it begins to pull.
        d.springs = {{"spring", path.points, std::pow(10, dice.between(-1, 3)), dice.between(0, 3) * test::side,
                      dice.chance(0.5)}};
    }
    if (dice.chance(0.3))
        d.supports.push_back({"roller",
                              where([](Vec3 p) { return p.y < 1e-9 && p.x > test::side; }),
                              {},
                              ramp(0, 1),
                              {},
                              {{0, dice.between(-1, 1), 1}}});
    if (dice.chance(0.2)) d.plates = {{"plate", where([](Vec3 p) { return p.x > 3 * test::side - 1e-9; })}};
    return d;
}

/// A state of a robot's program or, if its steps do not converge in a few iterations, one slightly off the rest state.
struct RandomState {
    Equilibrium system;
    State state;
    Controls controls;
    bool moved = false;
    RandomState(const Model& model, const test::RandomProgram& p, unsigned seed) : system(model) {
        const bool thrown = p.program.dynamics && !model.objects().empty();  // fast: in its own steps
        const double dt = thrown ? p.program.duration / p.program.steps : 0.03;
        const Damping* damping = p.program.dynamics ? &p.program.dynamics->damping : nullptr;
        Settled settled = settle(system, thrown ? 4 : 2, dt, 1e-6, damping);
        Noise noise(seed);
        State aside = settled.state;
        for (double& x : aside.x) x += 0.003 * test::side * noise();
        system.place_supports(settled.controls, aside.x);
        moved = settled.settled > 0;
        const bool stays = moved || !system.evaluate(aside, settled.controls).possible();
        state = stays ? std::move(settled.state) : std::move(aside);
        controls = std::move(settled.controls);
    }
};

/// If only coefficients of friction or contact stiffness change, frozen forces change in proportion.
inline std::vector<contact::FrozenPair> pairs_with(const contact::Contact& contact, const contact::Friction& frozen,
                                                   const Parameter& p, double factor) {
    using Kind = Parameter::Kind;
    std::vector<contact::FrozenPair> pairs(frozen.pairs().begin(), frozen.pairs().end());
    for (contact::FrozenPair& pair : pairs) {
        const auto owner = contact.friction_owner(
            std::span(pair.nodes).first(static_cast<std::size_t>(pair.node_count)), pair.obstacle);
        const auto index = static_cast<int>(p.index);
        const bool its_own = (p.kind == Kind::self_friction && owner.obstacle < 0 && owner.rigid < 0) ||
                             (p.kind == Kind::obstacle_friction && owner.obstacle == index) ||
                             (p.kind == Kind::object_friction && owner.rigid == index);
        if (its_own || p.kind == Kind::contact_stiffness) pair.limit_N *= factor;
    }
    return pairs;
}
inline std::shared_ptr<const contact::Friction> friction_with(const contact::Contact& contact,
                                                              const contact::Friction& frozen, const Parameter& p,
                                                              double factor) {
    std::vector<contact::FrozenPair> pairs = pairs_with(contact, frozen, p, factor);
    const std::vector<double> start(frozen.start().begin(), frozen.start().end());
    return std::make_shared<const contact::Friction>(std::move(pairs), start, frozen.slip_m());
}

/// The controls of a robot that differs by `change` of a number: prescribed and lagged values are unchanged.
inline Controls controls_with(const Linearisation& at, const Equilibrium& other, const Parameter& p, double change) {
    using Kind = Parameter::Kind;
    const Controls& now = at.controls();
    Controls controls = other.controls(now.time);
    const Description& d = other.model().description();
    const std::size_t steered = d.steered_count();
    for (std::size_t a = 0; a < steered; ++a) controls.drives[a] = now.drives[a];
    controls.shares = now.shares;
    controls.met = now.met;
    controls.joint_wanted = now.joint_wanted;
    controls.joint_start = now.joint_start;
    const double factor = p.value != 0 ? 1 + change / p.value : 1;
    if (now.friction)
        controls.friction = friction_with(*at.system().model().contact(now.met), *now.friction, p, factor);
    if (p.kind == Kind::cable_friction && !now.shares[p.index].empty()) {
        const Actuator& cable = at.system().actuators()[p.index];
        for (double& share : controls.shares[p.index]) share = std::pow(share, factor);
        const auto x = linalg::view(at.state().x);
        if (controls.drives[p.index].kind == Drive::Kind::measure)
            controls.drives[p.index].value +=
                cable.measure(x, controls.shares[p.index]) - cable.measure(x, now.shares[p.index]);
    }
    if (!now.inertia) return controls;
    Damping damping = now.inertia->damping();
    if (p.kind == Kind::mass_damping) damping.mass_per_s += change;
    if (p.kind == Kind::stiffness_damping) damping.stiffness_s += change;
    controls.inertia = MotionInTime(other.model(), damping).inertia(now.inertia->start(), now.inertia->dt());
    return controls;
}

/// The equations of such a robot at the same unknowns.
inline Eigen::VectorXd equations_with(const Linearisation& at, const Parameter& p, double change) {
    const Case other(with_value(at.system().model().description(), p, p.value + change));
    const Controls controls = controls_with(at, other.system, p, change);
    State state = at.state();
    other.system.place_supports(controls, state.x);
    return at.equations(other.system, state, controls);
}

}  // namespace pliant::sim::testing
