#include "simulation/inverse/force_goals.hpp"

#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/contact/pairs.hpp"
#include "simulation/linearisation/contact_forces.hpp"

namespace pliant::sim::inverse {
namespace {

constexpr Eigen::Index dimensions = 3;

contact::Stencil stencil_of(const contact::Pair& pair, const std::vector<double>& x) {
    contact::Stencil stencil;
    for (std::size_t k = 0; k < stencil.size(); ++k) {
        const std::size_t first = 3 * static_cast<std::size_t>(pair.nodes[k]);
        stencil[k] = {x[first], x[first + 1], x[first + 2]};
    }
    return stencil;
}

/// Calls `visit` with each contact pair of the goal's obstacle and the robot.
template <class Visit>
void visit_pairs(const Equilibrium& system, const Controls& controls, const std::vector<double>& x, const Goal& goal,
                 const Visit& visit) {
    const contact::Contact* contact = system.model().contact(controls.met);
    if (contact == nullptr) return;
    for (const contact::Pair& pair : contact->find(x)) {
        if (pair.obstacle == static_cast<int>(goal.on) && !touches_object(system, pair.nodes))
            visit(pair, contact->settings().stiffness_Pa);
    }
}

/// The sum of the magnitudes of the obstacle's normal forces on the robot.
double pressing_force(const Equilibrium& system, const State& state, const Controls& controls, const Goal& goal) {
    const std::vector<double> x = contact_nodes(system, state, controls);
    double sum = 0;
    visit_pairs(system, controls, x, goal, [&](const contact::Pair& pair, double stiffness_Pa) {
        sum += contact::normal_force(pair, stiffness_Pa, stencil_of(pair, x));
    });
    return sum;
}

/// By central differences of each pair's own force, which depends on the four nodes of the pair alone.
Quantity pressing_gradient(const Linearisation& at, const Goal& goal) {
    Quantity quantity{Eigen::VectorXd::Zero(at.state().x.size()), Eigen::VectorXd::Zero(at.state().multiplier.size())};
    const std::vector<double> x = contact_nodes(at.system(), at.state(), at.controls());
    const int robot_nodes = at.system().model().node_count();
    visit_pairs(at.system(), at.controls(), x, goal, [&](const contact::Pair& pair, double stiffness_Pa) {
        constexpr double share = 1e-5;  // of the distance within which the pair acts
        const double step = share * pair.reach_m;
        for (std::size_t k = 0; k < static_cast<std::size_t>(pair.node_count()); ++k) {
            if (pair.nodes[k] >= robot_nodes) continue;
            for (std::size_t axis = 0; axis < dimensions; ++axis) {
                contact::Stencil nearer = stencil_of(pair, x), farther = nearer;
                nearer[k][axis] += step;
                farther[k][axis] -= step;
                quantity.by_positions[3 * pair.nodes[k] + static_cast<Eigen::Index>(axis)] +=
                    (contact::normal_force(pair, stiffness_Pa, nearer) -
                     contact::normal_force(pair, stiffness_Pa, farther)) /
                    (2 * step);
            }
        }
    });
    return quantity;
}

/// The contact energy depends on the obstacle's position as on its nodes: by symmetry, the effect of an obstacle's
/// motion on the forces on the robot equals that of a robot's motion on the force on the obstacle.
std::vector<Quantity> contact_gradients(const Linearisation& at, const Goal& goal) {
    const Equilibrium& system = at.system();
    const contact::Contact& contact = *system.model().contact(true);
    std::vector<Quantity> all;
    for (Eigen::Index axis = 0; axis < dimensions; ++axis) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(force_size(system));
        const Eigen::Index first = system.model().node_count() - contact.robot_node_count();
        for (int node = contact.first_node(goal.on); node < contact.first_node(goal.on + 1); ++node)
            motion[3 * (first + node) + axis] = 1;
        all.push_back({contact_stiffness_times(system, at.state(), at.controls(), motion).head(at.state().x.size()),
                       Eigen::VectorXd::Zero(at.state().multiplier.size())});
    }
    return all;
}

std::vector<Quantity> support_gradients(Linearisation& at, const Goal& goal) {
    const Equilibrium& system = at.system();
    std::vector<Quantity> all;
    for (Eigen::Index axis = 0; axis < dimensions; ++axis) {
        Quantity force{Eigen::VectorXd::Zero(at.state().x.size()), Eigen::VectorXd::Zero(at.state().multiplier.size())};
        force.by_forces = system.model().held().motion([&](std::size_t support, int) -> Eigen::Vector3d {
            return (support == goal.on ? 1.0 : 0.0) * Eigen::Vector3d::Unit(axis);
        });
        Quantity moved = at.with_forces(force);
        all.push_back({std::move(moved.by_positions), std::move(moved.by_multipliers)});
    }
    return all;
}

}  // namespace

Vec3 force_of(const Equilibrium& system, const State& state, const Controls& controls, const Evaluation& evaluation,
              const Goal& goal) {
    const Model& model = system.model();
    if (goal.kind == GoalKind::support_force)
        return model.held().reactions(model.description().supports, evaluation.out_of_balance)[goal.on];
    if (goal.sum_of_sizes) return {pressing_force(system, state, controls, goal), 0, 0};
    if (model.contact(controls.met) == nullptr) return {};
    return system.contact_forces(state, controls).on_robot_N[goal.on];
}

std::vector<Quantity> force_gradients(Linearisation& at, const Goal& goal) {
    if (goal.kind == GoalKind::support_force) return support_gradients(at, goal);
    if (goal.sum_of_sizes) return {pressing_gradient(at, goal)};
    return contact_gradients(at, goal);
}

}  // namespace pliant::sim::inverse
