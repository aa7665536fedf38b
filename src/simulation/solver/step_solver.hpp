// Brings one state to equilibrium at fixed controls: sequential quadratic programming with lengths and volumes as
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
    int iteration_limit = 0;  ///< 0: the curvature's own
    int patience = 0;         ///< gives up after so many iterations without a tenth less error; 0: never
};

struct StepOutcome {
    bool converged = false;
    bool loose = false;  ///< converged only on looser terms than the tolerance: friction_rounds.hpp
    int iterations = 0;
    Evaluation evaluation;                 ///< of the state that is left behind
    std::string reason;                    ///< why it did not converge, or did only on looser terms
    Solver solver = Solver::automatic;     ///< that led to the state
    std::vector<IterationRecord> history;  ///< where it began and every iteration; step and time are not filled
};

/// Minimises the energy subject to length <= allowed length for every cable driven by length and volume = wanted volume
/// for every chamber driven by volume; the multipliers are tension, so that a cable only pulls, and pressure. Every
/// accepted state is possible and has a lower merit (energy plus a penalty for constraint violation) or, where the
/// forces have no energy, an error that is not above the last ones. `known`: the evaluation of `state` at these
/// controls, if it is at hand. Precondition: `state` is possible. Source of the constraint step: Nocedal and Wright,
/// Numerical Optimization, chapter 18.
[[nodiscard]] StepOutcome solve_step(const Equilibrium& system, Curvature& curvature, const Controls& controls,
                                     const StepSettings& settings, State& state, const Progress& progress,
                                     std::optional<Evaluation> known = {});

}  // namespace pliant::sim
