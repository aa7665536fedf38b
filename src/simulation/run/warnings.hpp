// Where the answer should not be trusted, in words.
#pragma once

#include <string>
#include <vector>

#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// What is wrong with one state, a sentence each; without its step.
[[nodiscard]] std::vector<std::string> warnings_of(const Step& step);

/// What is odd about the robot before anything moves: its notes, and whether it passes through itself already.
[[nodiscard]] std::vector<std::string> warnings_at_rest(const Model& model);
/// Of a robot at rest at every instant: what neither supports nor joints hold, in a sentence; empty if there is none.
[[nodiscard]] std::string held_by_nothing(const Model& model);

/// The guide points at both ends of `segment` of a cable have met.
struct ClosedGap {
    std::size_t cable = 0;
    int segment = 0;
};
/// One of each cable at most; none where contact keeps the robot from passing through itself. `x` (3n).
[[nodiscard]] std::vector<ClosedGap> closed_gaps(const Equilibrium& system, const Eigen::VectorXd& x);
/// What it means.
[[nodiscard]] std::string closed_gap_text(const Model& model, const ClosedGap& gap);

/// Adds to the trajectory's warnings what is wrong with its steps: each kind once, with the number of the first step
/// and, where it is one of degree, how many there are.
void add_warnings(Trajectory& trajectory);

}  // namespace pliant::sim
