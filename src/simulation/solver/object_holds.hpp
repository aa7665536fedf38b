// Keeps the Newton step of rigid objects within a few radians.
#pragma once

#include <span>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// values (of a layout over the free nodes) += a stiffness against rotations of every object, in proportion to the
/// forces on it that are out of balance.
/// The tangent of an object that hangs from a joint is singular: without tension it may swing freely, and a ball joint
/// lets it spin about its own axis. Where the weight does not yet point along that axis, the tangent couples the spin
/// to the swing, and the Newton step consists of turns that cancel the swing. As the hold ends with the force, it does
/// not slow convergence (Yamashita and Fukushima 2001, "On the rate of convergence of the Levenberg-Marquardt method").
/// In a motion in time the masses hold what turns, and nothing is added.
void add_object_holds(const Equilibrium& system, const State& state, const Controls& controls,
                      const TangentLayout& layout, std::span<double> values);

}  // namespace pliant::sim
