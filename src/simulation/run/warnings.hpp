// Warnings about results, as text.
#pragma once

#include <string>
#include <vector>

#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Warnings about one state, one sentence each; without the step number.
[[nodiscard]] std::vector<std::string> warnings_of(const Step& step);

/// Warnings about the robot before any step: its notes, and whether it intersects itself.
[[nodiscard]] std::vector<std::string> warnings_at_rest(const Model& model);
/// For a quasi-static robot: what neither supports nor joints hold, as a sentence; empty if nothing.
[[nodiscard]] std::string held_by_nothing(const Model& model);

/// The guide points at both ends of `segment` of a cable have met.
struct ClosedGap {
    std::size_t cable = 0;
    int segment = 0;
};
/// At most one per cable; none if contact prevents self-intersection. `x` (3n).
[[nodiscard]] std::vector<ClosedGap> closed_gaps(const Equilibrium& system, const Eigen::VectorXd& x);
/// Explanation for people.
[[nodiscard]] std::string closed_gap_text(const Model& model, const ClosedGap& gap);

/// Names the object that turns the most in a step of a motion in time while it touches something or a torque acts on
/// it, where that is so much that the time integration renders the effect badly; empty if none does.
[[nodiscard]] std::string braked_turns(const Model& model, const Program& program, const std::vector<Step>& steps);

/// Names the chambers whose pressure falls below a vacuum, which no air can do.
[[nodiscard]] std::vector<std::string> impossible_vacuums(const Model& model, const std::vector<Step>& steps);

/// Names the objects that are meant to be rigid but are noticeably stretched or squeezed.
[[nodiscard]] std::vector<std::string> squeezed_objects(const Model& model, const std::vector<Step>& steps);

/// Adds warnings about the steps to those of the trajectory: each kind once, with the number of the first step and, for
/// kinds of varying severity, the number of steps.
void add_warnings(Trajectory& trajectory);

}  // namespace pliant::sim
