#include "simulation/linearisation/contact_forces.hpp"

#include <algorithm>
#include <functional>
#include <vector>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

bool has_objects(const Equilibrium& system) {
    return system.model().object_points().count() > 0;
}

/// Calls `visit(of_objects)` for pairs without objects, then for those with them.
void visit_kinds(const Equilibrium& system, const std::function<void(bool of_objects)>& visit) {
    visit(false);
    if (has_objects(system)) visit(true);
}

std::span<const int> nodes_of(const contact::Pair& pair) {
    return {pair.nodes.data(), static_cast<std::size_t>(pair.node_count())};
}
std::span<const int> nodes_of(const contact::FrozenPair& pair) {
    return {pair.nodes.data(), static_cast<std::size_t>(pair.node_count)};
}

/// The pairs of one kind.
template <class Pair>
std::vector<Pair> chosen(const Equilibrium& system, std::span<const Pair> all, bool of_objects) {
    std::vector<Pair> kept;
    std::ranges::copy_if(all, std::back_inserter(kept),
                         [&](const Pair& pair) { return touches_object(system, nodes_of(pair)) == of_objects; });
    return kept;
}
contact::Friction chosen(const Equilibrium& system, const contact::Friction& all, bool of_objects) {
    return {chosen(system, all.pairs(), of_objects), {all.start().begin(), all.start().end()}, all.slip_m()};
}

/// Multiplies `motion` by the blocks that it is given.
contact::BlockVisitor multiplier(const std::vector<double>& motion, std::vector<double>& product) {
    return [&](int a, int b, const linalg::Matrix3& block) {
        Eigen::Map<Eigen::Vector3d> sum(product.data() + 3 * static_cast<std::size_t>(a));
        sum += block * linalg::view(std::span<const double>(motion), b);
    };
}

}  // namespace

Eigen::Index obstacle_nodes(const Equilibrium& system) {
    const contact::Contact* contact = system.model().contact(true);
    return contact == nullptr ? 0 : contact->node_count() - contact->robot_node_count();
}

Eigen::Index force_size(const Equilibrium& system) {
    const Eigen::Index copies = has_objects(system) ? 2 : 1;
    return 3 * (system.model().node_count() + copies * obstacle_nodes(system));
}

Eigen::VectorXd force_on_places(const Equilibrium& system, const Eigen::VectorXd& forces) {
    const Eigen::Index robot = 3 * Eigen::Index{system.model().node_count()}, obstacles = 3 * obstacle_nodes(system);
    Eigen::VectorXd all = forces.head(robot + obstacles);
    if (forces.size() > all.size()) all.tail(obstacles) += forces.tail(obstacles);
    return all;
}

std::vector<double> contact_nodes(const Equilibrium& system, const State& state, const Controls& controls) {
    return system.with_obstacles(state.x, controls.obstacles);
}

std::vector<double> contact_motion(const Equilibrium& system, const Eigen::VectorXd& motion, bool of_objects) {
    const Eigen::Index robot = 3 * Eigen::Index{system.model().node_count()}, obstacles = 3 * obstacle_nodes(system);
    const bool has_both = motion.size() > robot + obstacles;
    return system.with_obstacles(motion.head(robot),
                                 motion.segment(robot + (has_both && of_objects ? obstacles : 0), obstacles));
}

void add_contact_forces(const Equilibrium& system, std::span<const double> on_contact_nodes, bool of_objects,
                        Eigen::VectorXd& forces) {
    const Eigen::Index robot = 3 * Eigen::Index{system.model().node_count()}, obstacles = 3 * obstacle_nodes(system);
    const auto points = static_cast<std::size_t>(system.model().object_points().count());
    const auto first = static_cast<std::size_t>(robot);
    forces.head(robot) += Eigen::Map<const Eigen::VectorXd>(on_contact_nodes.data(), robot);
    if (points > 0)
        system.model().object_points().add_forces(on_contact_nodes.subspan(first, 3 * points), view(forces));
    forces.segment(robot + (of_objects ? obstacles : 0), obstacles) +=
        Eigen::Map<const Eigen::VectorXd>(on_contact_nodes.subspan(first + 3 * points).data(), obstacles);
}

bool touches_object(const Equilibrium& system, std::span<const int> nodes) {
    const int first = system.model().node_count(), end = first + system.model().object_points().count();
    return std::ranges::any_of(nodes, [&](int node) { return node >= first && node < end; });
}

ContactForces contact_forces(const Equilibrium& system, const State& state, const Controls& controls) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(force_size(system));
    ContactForces forces{none, none};
    const contact::Contact* contact = system.model().contact(controls.met);
    if (contact == nullptr) return forces;
    const std::vector<double> x = contact_nodes(system, state, controls);
    const contact::Pairs all = contact->find(x);
    visit_kinds(system, [&](bool of_objects) {
        std::vector<double> pressure(x.size(), 0.0), friction(x.size(), 0.0);
        contact->add_gradient(chosen<contact::Pair>(system, all, of_objects), x, pressure);
        if (controls.friction) chosen(system, *controls.friction, of_objects).add_gradient(x, friction);
        add_contact_forces(system, pressure, of_objects, forces.pressure);
        add_contact_forces(system, friction, of_objects, forces.friction);
    });
    return forces;
}

Eigen::VectorXd contact_stiffness_times(const Equilibrium& system, const State& state, const Controls& controls,
                                        const Eigen::VectorXd& motion) {
    Eigen::VectorXd sum = friction_stiffness_times(system, state, controls, motion);
    const contact::Contact* contact = system.model().contact(controls.met);
    if (contact == nullptr) return sum;
    const std::vector<double> x = contact_nodes(system, state, controls);
    const contact::Pairs all = contact->find(x);
    visit_kinds(system, [&](bool of_objects) {
        const std::vector<double> moved = contact_motion(system, motion, of_objects);
        std::vector<double> product(x.size(), 0.0);
        contact->visit_hessian(chosen<contact::Pair>(system, all, of_objects), x, false, multiplier(moved, product));
        add_contact_forces(system, product, of_objects, sum);
    });
    return sum;
}

Eigen::VectorXd friction_stiffness_times(const Equilibrium& system, const State& state, const Controls& controls,
                                         const Eigen::VectorXd& motion) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(force_size(system));
    if (system.model().contact(controls.met) == nullptr || !controls.friction) return sum;
    const std::vector<double> x = contact_nodes(system, state, controls);
    visit_kinds(system, [&](bool of_objects) {
        const std::vector<double> moved = contact_motion(system, motion, of_objects);
        std::vector<double> product(x.size(), 0.0);
        chosen(system, *controls.friction, of_objects).visit_hessian(x, multiplier(moved, product));
        add_contact_forces(system, product, of_objects, sum);
    });
    return sum;
}

}  // namespace pliant::sim
