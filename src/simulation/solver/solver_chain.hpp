// The solver of a program and its fallbacks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/solver/step_solver.hpp"

namespace pliant::sim {

/// Solves with the first solver and, if it stalls, with the next one on the same step. The next step starts with the
/// first again. Deterministic: nothing depends on a clock.
class SolverChain {
public:
    using Make = std::function<std::unique_ptr<Curvature>()>;
    struct Link {
        Solver solver;
        Make make;  ///< called on first use
    };
    /// At least one link.
    explicit SolverChain(std::vector<Link> links);

    [[nodiscard]] Solver first() const { return links_.front().solver; }
    /// Called at the start of each step of the program.
    void restart();
    /// State of the first solver to carry over into the next step, and its restoration: see Curvature. The others start
    /// anew whenever they are used.
    [[nodiscard]] std::shared_ptr<const SolverMemory> memory() const;
    void recall(const SolverMemory* memory);
    /// Frees the solvers with their factors; the next use makes them anew.
    void release();
    /// As solve_step. A fallback starts from the best state of the one before it, and may cost about as much as that
    /// one did. With `settings.patience` 0 a chain of several uses its own patience. `iterations` and `history` cover
    /// all solvers used, `solver` and `evaluation` the last one.
    [[nodiscard]] StepOutcome solve(const Equilibrium& system, const Controls& controls, const StepSettings& settings,
                                    State& state, const Progress& progress, std::optional<Evaluation> known = {});

private:
    [[nodiscard]] Curvature& at(std::size_t link);
    [[nodiscard]] StepSettings settings_of(std::size_t link, const StepSettings& asked, int spent) const;

    std::vector<Link> links_;
    std::vector<std::unique_ptr<Curvature>> made_;  ///< (links)
};

/// The solver `asked` alone or, for automatic, newton with quasi-newton as fallback. If the laws have no energy and
/// there are no gap or air elements: quasi-newton, then anderson, then newton; newton first if there are plates, or for
/// steps `in_time`.
[[nodiscard]] SolverChain make_chain(Solver asked, const Equilibrium& system, const FactoredLaplacian& laplacian,
                                     bool in_time = false);

}  // namespace pliant::sim
