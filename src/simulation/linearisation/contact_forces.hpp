// Forces between what touches, on the nodes of the robot and on those of the obstacles, and how they change.
#pragma once

#include <Eigen/Core>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Nodes of the obstacles; 0 without contact.
[[nodiscard]] Eigen::Index obstacle_nodes(const Equilibrium& system);

/// Forces (3 robot nodes, then 3 obstacle nodes), as they enter the out-of-balance force: minus what acts on the node,
/// so that those of an obstacle's nodes add up to what it does to the robot. N.
struct ContactForces {
    Eigen::VectorXd pressure;  ///< of the surfaces on each other
    Eigen::VectorXd friction;  ///< as it is frozen in the controls; zero where there is none
};
[[nodiscard]] ContactForces contact_forces(const Equilibrium& system, const State& state, const Controls& controls);

/// The change of both together with a motion of the same nodes, or of friction alone: symmetric matrices times `motion`
/// (3 robot nodes, then 3 obstacle nodes). Where the step begins moves friction the other way.
[[nodiscard]] Eigen::VectorXd contact_stiffness_times(const Equilibrium& system, const State& state,
                                                      const Controls& controls, const Eigen::VectorXd& motion);
[[nodiscard]] Eigen::VectorXd friction_stiffness_times(const Equilibrium& system, const State& state,
                                                       const Controls& controls, const Eigen::VectorXd& motion);

}  // namespace pliant::sim
