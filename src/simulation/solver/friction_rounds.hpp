// Iterates lagged friction, of contact and of cables in their guides, over several solutions of one step.
#pragma once

#include <optional>
#include <span>

#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {

/// The equilibrium at the start of a step.
struct StepStart {
    const State& state;
    const Controls& controls;
    std::span<const Drive> drives;  ///< (actuators) prescribed values there; `controls` may hold weighted lengths
                                    ///< instead
};

/// Friction depends on the forces, which depend on friction: it is frozen, the step solved, and frozen again until both
/// agree, at most `rounds` times (lagging, Li et al. 2020, section 5; likewise for cable friction in guides). Without
/// friction one solution is enough. A round is solved to a share of what the friction of the one before was off by, the
/// last one to the tolerance. `evaluation` of the outcome is that with the friction of the state itself.
///
/// Sliding contact may alternate between two states for ever. If the state is then within ten times the tolerance, and
/// its cables within the tolerance, it is accepted as `loose`, and `reason` gives the error; otherwise the step did not
/// converge. Rounds end early where the last ones show that those left would not lead there. `controls`: prescribed
/// values; friction and weighted lengths are filled in. `known`: the evaluation of `next`, used if there is no
/// friction.
[[nodiscard]] StepOutcome settle_friction(const Equilibrium& system, SolverChain& solvers, const StepSettings& settings,
                                          int rounds, const StepStart& start, Controls& controls, State& next,
                                          const Progress& progress, std::optional<Evaluation> known = {});

/// True if the error of friction after each round so far, which goes on as in the last two, will not come down to
/// `wanted` in `most` rounds: contact that alternates between two states may do so for ever. False for few rounds.
[[nodiscard]] bool rounds_are_vain(std::span<const double> misfits, int most, double wanted);

}  // namespace pliant::sim
