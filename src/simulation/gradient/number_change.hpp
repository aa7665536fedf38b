// Derivatives of the equations and measures with respect to a number that the robot is drawn with, by central
// differences of two robots with slightly larger and smaller values, at the same state. They include everything that
// follows from the number: rest shape, attachment of cables and markers, loads, constants, actuator targets.
#pragma once

#include <Eigen/Core>
#include <span>

#include "simulation/gradient/measure.hpp"
#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// Two robots on the same mesh, whose nodes follow the number. Both must outlive their users.
struct NumberChange {
    const Equilibrium* more = nullptr;
    const Equilibrium* less = nullptr;
    double step = 0;  ///< difference between their values, above zero
};

/// (measures, numbers) d(measure)/dp at fixed unknowns, with the robot driven by the program at the controls' time.
/// Preconditions: no friction, and the robot is at rest.
[[nodiscard]] Eigen::MatrixXd measures_by_numbers(std::span<const NumberChange> numbers, const State& state,
                                                  const Controls& controls, std::span<const Measure> measures);

/// (numbers) contribution of the equations' change with each number, for these adjoint weights: -weights . dF/dp.
[[nodiscard]] Eigen::VectorXd worth_of_numbers(const Linearisation& at, const Adjoint& adjoint,
                                               std::span<const NumberChange> numbers);

}  // namespace pliant::sim
