// The solver of a program and those that stand in for it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/solver/step_solver.hpp"

namespace pliant::sim {

/// Solves with the first of its solvers and, where that one stalls, with the next on the same step. A step afterwards
/// begins with the first again. The same input takes the same way every time: nothing depends on a clock.
class SolverChain {
public:
    using Make = std::function<std::unique_ptr<Curvature>()>;
    struct Link {
        Solver solver;
        Make make;  ///< called when it is needed for the first time
    };
    /// At least one link.
    explicit SolverChain(std::vector<Link> links);

    [[nodiscard]] Solver first() const { return links_.front().solver; }
    /// Called at the start of each step of the program.
    void restart();
    /// What the first solver takes along into the next step, and back again: see Curvature. The others begin anew
    /// wherever they are needed.
    [[nodiscard]] std::shared_ptr<const SolverMemory> memory() const;
    void recall(const SolverMemory* memory);
    /// As solve_step. A stand-in begins where the one before it came nearest, and may cost about as much as that one
    /// did. With `settings.patience` 0 the patience of a chain of several is its own. `iterations` and `history` are of
    /// all that took part, `solver` and `evaluation` of the last.
    [[nodiscard]] StepOutcome solve(const Equilibrium& system, const Controls& controls, const StepSettings& settings,
                                    State& state, const Progress& progress, std::optional<Evaluation> known = {});

private:
    [[nodiscard]] Curvature& at(std::size_t link);
    [[nodiscard]] StepSettings settings_of(std::size_t link, const StepSettings& asked, int spent) const;

    std::vector<Link> links_;
    std::vector<std::unique_ptr<Curvature>> made_;  ///< (links)
};

/// `asked` alone or, for automatic, newton with quasi-newton to stand in; where the laws have no energy and no
/// elements actuate, quasi-newton with anderson.
[[nodiscard]] SolverChain make_chain(Solver asked, const Equilibrium& system, const FactoredLaplacian& laplacian);

}  // namespace pliant::sim
