// Runs a program: from rest to the targets, step by step.
#pragma once

#include <optional>
#include <string>

#include "core/progress.hpp"
#include "sim/inertia.hpp"
#include "sim/model.hpp"
#include "sim/solver.hpp"
#include "sim/trajectory.hpp"

namespace pliant::sim {

/// Motion in time instead of rest at every instant.
struct Dynamics {
    Damping damping;
};

struct Program {
    int steps = 30;
    double duration = 1;  ///< time at the end; steps are equally long
    double tolerance = 1e-4;
    Solver solver = Solver::automatic;
    std::optional<Dynamics> dynamics = std::nullopt;
    int iteration_limit = 0;  ///< per solved step; 0: the solver's own
    /// Where an equilibrium turns out to be unstable: it is left by this largest motion of a node, for the stable one
    /// that the energy then falls to. 0: only a warning.
    double imperfection_m = 0;
    /// Whether the results are looked at for instability and for surfaces that cross, which takes as long as a few
    /// steps. Off only to time the solver.
    bool checks = true;
};

/// With dynamics, time is in seconds: the robot starts at rest and undeformed, and its mass and damping take part.
/// A step that does not converge is halved, and halved again, down to 1/64 of a step. A program that cannot finish
/// keeps the steps that converged and says in Trajectory::message at which step it stopped and why. Warnings tell
/// whether the last equilibrium is unstable, and since which step (see Stability), and where the robot jumped.
[[nodiscard]] Trajectory run(const Model& model, const Program& program, Progress& progress);

/// Positions of the points of every cable for node positions (n, 3): [cable][point].
[[nodiscard]] std::vector<std::vector<Vec3>> cable_points(const Model& model, std::span<const Vec3> positions);

}  // namespace pliant::sim
