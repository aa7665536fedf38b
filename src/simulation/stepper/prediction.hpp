// Where a step begins: on from the last states, or from the last one as its supports move.
#pragma once

#include <optional>
#include <string>

#include "base/core/progress.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim {

struct Prediction {
    State state;
    Evaluation evaluation;  ///< of `state` at the controls that are wanted
    std::string reason;     ///< why there is none; empty if there is
};

/// On along the way of the last states to `along` or, where that would turn a tet inside out or pass through something
/// (or no `along` is given), the last state with the supports at their new place, or with the robot pushed out of the
/// way of what comes.
[[nodiscard]] Prediction predict(const Equilibrium& system, const FactoredLaplacian& laplacian, const RobotState& from,
                                 const Controls& wanted, std::optional<double> along, const Progress& progress);

/// A state that somebody expects, with the supports at their place. Nothing: it is far from equilibrium, it turns a tet
/// inside out, or the straight way there passes through something.
[[nodiscard]] std::optional<Prediction> start_from(const Equilibrium& system, const RobotState& from,
                                                   const State& expected, const Controls& wanted);

/// A state whose supports stand as `controls` want, and whose other nodes follow as smoothly as possible.
[[nodiscard]] State follow_supports(const Equilibrium& system, const FactoredLaplacian& laplacian, const State& from,
                                    const Controls& controls);

/// True if the straight way from one state to another meets nothing.
[[nodiscard]] bool passes(const Equilibrium& system, const RobotState& from, const State& next,
                          const Controls& controls);

}  // namespace pliant::sim
