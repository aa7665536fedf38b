// Friction of contact and of cables in their guides, settled over several solutions of one step.
#pragma once

#include <optional>
#include <span>

#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {

/// The last state at equilibrium, from which a step leads.
struct StepStart {
    const State& state;
    const Controls& controls;
    std::span<const Drive> drives;  ///< (actuators) what was wanted there: `controls` may hold weighted lengths instead
};

/// Friction depends on the forces, which depend on friction: frozen, solved, and frozen anew until both agree, at most
/// `rounds` times (the lagging of Li et al. 2020, section 5; likewise for cables that drag in their guides). Without
/// friction one solution. `evaluation` of the outcome is that with the friction of the state itself.
///
/// Sliding contact may go back and forth between two states for ever. What is then within ten times the tolerance, its
/// cables within the tolerance, is accepted as `loose`, and `reason` says how far off it is; beyond that the step did
/// not converge. `controls`: as wanted; friction and weighted lengths are filled in. `known`: of `next`, as long as
/// there is no friction.
[[nodiscard]] StepOutcome settle_friction(const Equilibrium& system, SolverChain& solvers, const StepSettings& settings,
                                          int rounds, const StepStart& start, Controls& controls, State& next,
                                          const Progress& progress, std::optional<Evaluation> known = {});

}  // namespace pliant::sim
