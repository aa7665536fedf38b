// How equations and measures change with a number that the robot is drawn with: by differences of two robots that have
// a little more and a little less of it, at one and the same state. Whatever follows from the number is in them: rest
// shape, places where cables and markers are tied, loads, constants, what is wanted of actuators.
#pragma once

#include <Eigen/Core>
#include <span>

#include "simulation/gradient/measure.hpp"
#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// Two robots on one mesh whose nodes have moved along. Both must outlive what uses it.
struct NumberChange {
    const Equilibrium* more = nullptr;
    const Equilibrium* less = nullptr;
    double step = 0;  ///< by how much they differ, above zero
};

/// (measures, numbers) d(measure)/dp with the unknowns as they are, where the program drives the robot at the controls'
/// time. Preconditions: nothing rubs, and the robot is at rest.
[[nodiscard]] Eigen::MatrixXd measures_by_numbers(std::span<const NumberChange> numbers, const State& state,
                                                  const Controls& controls, std::span<const Measure> measures);

/// (numbers) what the equations' change with each number is worth by these weights: -weights . dF/dp.
[[nodiscard]] Eigen::VectorXd worth_of_numbers(const Linearisation& at, const Adjoint& adjoint,
                                               std::span<const NumberChange> numbers);

}  // namespace pliant::sim
