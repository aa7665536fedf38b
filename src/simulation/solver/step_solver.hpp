// Solves for equilibrium at fixed controls: sequential quadratic programming with prescribed lengths and volumes as
// constraints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/iteration_record.hpp"

namespace pliant::sim {

struct StepSettings {
    double tolerance = 1e-4;
    int iteration_limit = 0;  ///< 0: that of the curvature
    int patience = 0;         ///< gives up after this many iterations without reducing the error by a tenth; 0: never
};

struct StepOutcome {
    bool converged = false;
    bool loose = false;     ///< converged only at a looser tolerance: friction_rounds.hpp
    bool no_start = false;  ///< the prescribed motion is impossible: there was no state to begin with
    int iterations = 0;
    Evaluation evaluation;                 ///< of the final state
    std::string reason;                    ///< why it did not converge, or only at a looser tolerance
    Solver solver = Solver::automatic;     ///< the one that reached the state
    std::vector<IterationRecord> history;  ///< the initial state and every iteration; step and time are not filled in
};

/// Minimises the energy subject to length <= prescribed length for every cable driven by length and volume = prescribed
/// volume for every chamber driven by volume; the multipliers are tension, which is never negative, and pressure. Every
/// accepted state is physically possible and has a lower merit (energy plus a penalty for constraint violation) or, if
/// the forces have no energy, an error not above the last ones. `known`: the evaluation of `state` at these controls,
/// if available. Precondition: `state` is physically possible. Source of the constraint step: Nocedal and Wright,
/// Numerical Optimization, chapter 18.
[[nodiscard]] StepOutcome solve_step(const Equilibrium& system, Curvature& curvature, const Controls& controls,
                                     const StepSettings& settings, State& state, const Progress& progress,
                                     std::optional<Evaluation> known = {});

/// Record of an iteration that ended with this evaluation.
[[nodiscard]] IterationRecord record(Solver solver, int iteration, const Evaluation& e, double alpha);
/// Reasons for StepOutcome: the iterations were not enough; or no step of the line search was accepted.
[[nodiscard]] std::string no_convergence(int iterations, double residual);
[[nodiscard]] std::string no_step(Evaluation::Flaw obstacle, double residual);

}  // namespace pliant::sim
