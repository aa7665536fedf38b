// Describes an equilibrium state as a step of a trajectory; used by simulate() and Live alike.
#pragma once

#include <span>

#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Fills in residual, min_J, energy, actuators, supports, contact, markers, sensors and positions; `evaluation` must be
/// that of `state` under `controls`. Fields about how the state was reached (index, time, iterations, wall time) are
/// left unchanged.
void describe(const Model& model, const Equilibrium& system, const State& state, const Controls& controls,
              const Evaluation& evaluation, Step& step);

[[nodiscard]] JointState joint_state(const Equilibrium& system, std::size_t joint, const State& state,
                                     const Controls& controls);
/// State of object `k` at node positions x (3n), without forces.
[[nodiscard]] ObjectState object_state(const Model& model, std::size_t k, std::span<const double> x);

}  // namespace pliant::sim
