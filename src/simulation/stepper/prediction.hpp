// Initial state of a step: extrapolated from the last states, or the last one with moved supports.
#pragma once

#include <optional>
#include <string>

#include "base/core/progress.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim {

struct Prediction {
    State state;
    Evaluation evaluation;  ///< of `state` at the wanted controls
    std::string reason;     ///< why there is no prediction; otherwise empty
};

/// Extrapolates the last states to `along` or, if that inverts a tet or intersects something (or no `along` is given),
/// takes the last state with the supports at their new position, or with the robot pushed away by what approaches.
[[nodiscard]] Prediction predict(const Equilibrium& system, const FactoredLaplacian& laplacian, const RobotState& from,
                                 const Controls& wanted, std::optional<double> along, const Progress& progress);

/// An expected state, with the supports at their positions. Empty: it is far from equilibrium, it inverts a tet, or the
/// straight path to it intersects something.
[[nodiscard]] std::optional<Prediction> start_from(const Equilibrium& system, const RobotState& from,
                                                   const State& expected, const Controls& wanted);

/// A state with the supports positioned by `controls` and all other nodes following as smoothly as possible.
[[nodiscard]] State follow_supports(const Equilibrium& system, const FactoredLaplacian& laplacian, const State& from,
                                    const Controls& controls);

/// True if the straight path from one state to another has no intersection.
[[nodiscard]] bool passes(const Equilibrium& system, const RobotState& from, const State& next,
                          const Controls& controls);

}  // namespace pliant::sim
