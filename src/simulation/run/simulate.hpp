// Runs a program: from rest to the targets, step by step.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "base/core/progress.hpp"
#include "simulation/elements/inertia.hpp"
#include "simulation/model/model.hpp"
#include "simulation/parts/robot_names.hpp"
#include "simulation/run/run_checks.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim {

/// A run between two steps: everything needed to continue it.
struct RunState {
    int step = 0;  ///< the last completed one; 0: none
    RobotState robot;
    ChecksState checks;
    Trajectory so_far;  ///< the rest state and `step` steps
};

struct RunOptions {
    /// Called with each step as soon as it is solved, the rest state first. May be empty.
    std::function<void(const Step&)> on_step{};
    /// Called after every `checkpoint_every` steps; an error ends the run. May be empty.
    std::function<Status(const RunState&)> on_checkpoint{};
    int checkpoint_every = 1;
    /// Memory limit for the positions of all steps; beyond it they are stored in an unnamed file.
    std::size_t memory_bytes = std::size_t{256} << 20U;
    /// Starts from this state instead of from rest: one of a run of the same model and program.
    std::optional<RunState> begin{};
};

/// With dynamics, time is in seconds: the robot starts at rest and undeformed, with mass and damping. A step that does
/// not converge is halved repeatedly, down to 1/64 of a step. A program that cannot finish keeps the steps that
/// converged; Trajectory::message says at which step it stopped and why. Warnings tell whether the last equilibrium is
/// unstable, and since which step (see Stability), and where the robot jumped. A resumed run gives the same bits,
/// except for wall times, as an uninterrupted one.
[[nodiscard]] Trajectory run(const Model& model, const Program& program, Progress& progress, RunOptions options = {});

/// The stepper options of a program; and the path of its step k, from 1, for a robot at the end of the previous step.
/// The path refers to stepper and robot.
[[nodiscard]] StepperOptions stepper_options(const Program& program);
[[nodiscard]] StepPath program_path(const Stepper& stepper, const Program& program, const RobotState& robot, int k);

/// Positions of the points of every cable at node positions (n, 3): [cable][point].
[[nodiscard]] std::vector<std::vector<Vec3>> cable_points(const Model& model, std::span<const Vec3> positions);

}  // namespace pliant::sim
