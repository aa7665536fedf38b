#include "simulation/gradient/step_adjoint.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/contact/contact.hpp"
#include "simulation/gradient/friction_slips.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/damping_stiffness.hpp"

namespace pliant::sim {
namespace {

/// Obstacles are positioned by their shares of a motion: adds the derivative to that of the inputs.
void add_obstacles(const Linearisation& at, const Eigen::VectorXd& by_position, Eigen::VectorXd& by_inputs) {
    if (by_position.isZero(0) || by_inputs.size() == 0) return;
    const contact::Contact& contact = *at.system().model().contact(true);
    const std::vector<Parameter> all = inputs(at);
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k].kind != Parameter::Kind::obstacle_share) continue;
        const std::size_t obstacle = all[k].index;
        const Eigen::Vector3d move =
            linalg::vector(at.system().model().description().contact->obstacles[obstacle].move_m);
        for (int node = contact.first_node(obstacle); node < contact.first_node(obstacle + 1); ++node)
            by_inputs[static_cast<Eigen::Index>(k)] +=
                by_position.segment<3>(3 * static_cast<Eigen::Index>(node - contact.robot_node_count())).dot(move);
    }
}

/// In a motion in time the velocity at the end of a step depends on its end position, and forces depend on its start.
void carry_inertia(const Linearisation& at, const Eigen::VectorXd& force_weights, Carried& carried) {
    const History by = at.controls().inertia->start_weights(force_weights, carried.v);
    carried.x = carried.x_before + by.x;
    carried.v = carried.v_before + by.v;
    carried.x_before = by.x_before;
    carried.v_before = by.v_before;
    const auto damped = damped_step(at);
    if (!damped) return;
    const Inertia::Place place = at.controls().inertia->damping_place();
    const Eigen::VectorXd weights = damping_place_weights(*damped, force_weights);
    carried.x += place.x * weights;
    carried.v += place.v * weights;
    carried.x_before += place.x_before * weights;
}

/// Joint damping acts against the coordinate at the start of the step.
void carry_joints(const Linearisation& at, const Eigen::VectorXd& force_weights, Carried& carried) {
    const Equilibrium& system = at.system();
    const Description& d = system.model().description();
    for (std::size_t j = 0; j < d.joints.size(); ++j) {
        const JointForce& joint = system.joints()[j];
        const double dt = system.joint_drive(at.controls(), j).dt;
        if (!(dt > 0) || !(d.joints[j].law.damping > 0) || !joint.has_coordinate()) continue;
        Eigen::VectorXd now = Eigen::VectorXd::Zero(force_weights.size());
        joint.add_coordinate_gradient(linalg::view(at.state().x), 1, linalg::view(now));
        const Eigen::VectorXd& start = at.controls().inertia->start().x;
        const double worth = -d.joints[j].law.damping / dt * now.dot(force_weights);
        joint.add_coordinate_gradient(linalg::view(start), worth, linalg::view(carried.x));
    }
}

/// A program prescribes gas as a ratio to what the chamber holds at rest: the amount is proportional to the ambient
/// pressure, whose own derivative holds the amount fixed.
void add_gas_amounts(Linearisation& at, const Adjoint& adjoint, Eigen::VectorXd& by_parameters) {
    const std::vector<Parameter> all = parameters(at);
    const auto ambient = std::ranges::find(all, Parameter::Kind::ambient_pressure, &Parameter::kind);
    if (ambient == all.end()) return;
    for (const Parameter& input : inputs(at)) {
        if (input.kind == Parameter::Kind::gas)
            by_parameters[ambient - all.begin()] +=
                input.value / ambient->value * adjoint.derivative(derivative(at, input));
    }
}

void carry_nothing(Carried& carried) {
    carried.x.setZero();
    carried.v.setZero();
}

/// Derivatives with respect to the slips at the end of this step, through the next step.
Slips worth_of_slips(const Linearisation& at, std::span<const double> x, const Carried& carried) {
    const auto& friction = at.controls().friction;
    Slips worth(friction ? friction->pairs().size() : 0, Eigen::Vector2d::Zero());
    if (!friction || !carried.friction) return worth;
    for (const contact::Carry& carry : contact::find_carries(friction->pairs(), carried.friction->pairs())) {
        const auto slip = friction->slip(friction->pairs()[carry.from], x);
        worth[carry.from] +=
            contact::kept_slip_gradient(slip, friction->slip_m()) * carry.change.transpose() * carried.slips[carry.to];
    }
    return worth;
}

/// The same with respect to the positions that determine the slips (3 robot nodes, then 3 obstacle nodes).
Eigen::VectorXd by_positions(const Linearisation& at, const Slips& slips) {
    Eigen::VectorXd by = Eigen::VectorXd::Zero(force_size(at.system()));
    if (at.controls().friction) add_to_forces(at.system(), *at.controls().friction, slips, by);
    return force_on_places(at.system(), by);
}

/// Projects the adjoint weights of forces onto the tangents of each pair, times its friction stiffness.
void add_resistance(const Equilibrium& system, const contact::Friction& friction, std::span<const double> x,
                    const Eigen::VectorXd& weights, Slips& slips) {
    const Slips moved = slips_of_motion(system, friction, weights);
    for (std::size_t k = 0; k < slips.size(); ++k) slips[k] += friction.stiffness(k, x) * moved[k];
}

/// Friction depends on the start of the step and on the slip at the end of the previous step.
void carry_friction(const Linearisation& at, std::span<const double> x, const Eigen::VectorXd& force_weights,
                    Slips slips, const Eigen::VectorXd& by_slips, Carried& carried) {
    const Eigen::Index robot = at.state().x.size();
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(force_size(at.system()));
    weights.head(force_weights.size()) = force_weights;
    const Eigen::VectorXd resisted = friction_stiffness_times(at.system(), at.state(), at.controls(), weights);
    const Eigen::VectorXd by = force_on_places(at.system(), resisted) + by_slips;
    carried.x -= by.head(robot);
    carried.obstacles = -by.tail(by.size() - robot);
    carried.friction = at.controls().friction;
    if (carried.friction) add_resistance(at.system(), *carried.friction, x, weights, slips);
    carried.slips = std::move(slips);
}

}  // namespace

Carried Carried::nothing(const Equilibrium& system) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(system.model().node_count()));
    return {none, none, none, none, Eigen::VectorXd::Zero(3 * obstacle_nodes(system))};
}

bool Carried::is_nothing() const {
    return x.isZero(0) && v.isZero(0) && x_before.isZero(0) && v_before.isZero(0) && obstacles.isZero(0) &&
           std::ranges::all_of(slips, [](const Eigen::Vector2d& slip) { return slip.isZero(0); });
}

Result<Variation> go_back_over(Linearisation& at, const Slope& own, const By& by, Carried& carried) {
    const auto& inertia = at.controls().inertia;
    const std::vector<double> x = contact_nodes(at.system(), at.state(), at.controls());
    Slips slips = worth_of_slips(at, x, carried);
    const Eigen::VectorXd by_slips = by_positions(at, slips);
    carried.obstacles += by_slips.tail(carried.obstacles.size());
    Slope worth = own;
    worth.state.by_positions += carried.x + by_slips.head(carried.x.size());
    if (inertia) worth.state.by_positions += inertia->rate() * carried.v;
    const Result<Adjoint> adjoint = at.adjoint(worth.state);
    if (!adjoint) return tl::unexpected(adjoint.error());
    Variation result = gradient(at, *adjoint, worth, by);
    if (by.parameters) add_gas_amounts(at, *adjoint, result.parameters);
    add_obstacles(at, carried.obstacles, result.inputs);
    const Eigen::VectorXd weights = at.force_weights(*adjoint);
    if (inertia)
        carry_inertia(at, weights.head(at.state().x.size()), carried);
    else
        carry_nothing(carried);
    carry_joints(at, weights.head(at.state().x.size()), carried);
    carry_friction(at, x, weights, std::move(slips), by_slips, carried);
    return result;
}

}  // namespace pliant::sim
