// Runs a program: from rest to the targets, step by step.
#pragma once

#include <optional>
#include <string>

#include "base/core/progress.hpp"
#include "simulation/elements/inertia.hpp"
#include "simulation/model/model.hpp"
#include "simulation/parts/robot_names.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim {

/// With dynamics, time is in seconds: the robot starts at rest and undeformed, and its mass and damping take part.
/// A step that does not converge is halved, and halved again, down to 1/64 of a step. A program that cannot finish
/// keeps the steps that converged and says in Trajectory::message at which step it stopped and why. Warnings tell
/// whether the last equilibrium is unstable, and since which step (see Stability), and where the robot jumped.
[[nodiscard]] Trajectory run(const Model& model, const Program& program, Progress& progress);

/// Positions of the points of every cable for node positions (n, 3): [cable][point].
[[nodiscard]] std::vector<std::vector<Vec3>> cable_points(const Model& model, std::span<const Vec3> positions);

}  // namespace pliant::sim
