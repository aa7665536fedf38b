#include "simulation/solver/solver_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

/// Relative cost of an iteration: a Newton iteration factorises, which takes about as long as ten with the factorised
/// Laplacian.
int relative_cost(Solver solver) {
    return solver == Solver::newton ? 10 : 1;
}

constexpr int least_budget = 100;  // iterations of cost 1 that a fallback gets in any case

void append(std::vector<IterationRecord>& to, const std::vector<IterationRecord>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

SolverChain::SolverChain(std::vector<Link> links) : links_(std::move(links)), made_(links_.size()) {}

Curvature& SolverChain::at(std::size_t link) {
    if (!made_[link]) made_[link] = links_[link].make();
    return *made_[link];
}

void SolverChain::restart() {
    at(0).restart();
}

std::shared_ptr<const SolverMemory> SolverChain::memory() const {
    return made_.front() ? made_.front()->memory() : nullptr;
}

void SolverChain::recall(const SolverMemory* memory) {
    if (memory != nullptr || made_.front()) at(0).recall(memory);
}

void SolverChain::release() {
    for (auto& solver : made_) solver.reset();
}

StepSettings SolverChain::settings_of(std::size_t link, const StepSettings& asked, int spent) const {
    StepSettings settings = asked;
    if (links_.size() == 1) return settings;
    const int cost = relative_cost(links_[link].solver);
    if (settings.patience == 0) settings.patience = cost > 1 ? 30 : 300;
    if (link > 0 && asked.iteration_limit == 0)
        settings.iteration_limit = std::max({1, spent / cost, least_budget / cost});
    return settings;
}

StepOutcome SolverChain::solve(const Equilibrium& system, const Controls& controls, const StepSettings& settings,
                               State& state, const Progress& progress, std::optional<Evaluation> known) {
    const State start = state;
    StepOutcome outcome =
        solve_step(system, at(0), controls, settings_of(0, settings, 0), state, progress, std::move(known));
    int spent = outcome.iterations * relative_cost(links_[0].solver);
    for (std::size_t k = 1; k < links_.size() && !outcome.converged && !progress.cancelled(); ++k) {
        // A failed solver may leave a state with a larger error than the initial one.
        if (!(outcome.evaluation.error() < system.evaluate(start, controls).error())) state = start;
        at(k).restart();
        StepOutcome next = solve_step(system, at(k), controls, settings_of(k, settings, spent), state, progress);
        spent += next.iterations * relative_cost(links_[k].solver);
        next.iterations += outcome.iterations;
        if (!next.converged)
            next.reason = fmt::format("{}; with {}: {}", outcome.reason, name(links_[k].solver), next.reason);
        append(outcome.history, next.history);
        next.history = std::move(outcome.history);
        outcome = std::move(next);
    }
    return outcome;
}

SolverChain make_chain(Solver asked, const Equilibrium& system, const FactoredLaplacian& laplacian, bool in_time) {
    const auto link = [&](Solver solver) -> SolverChain::Link {
        return {solver, [&system, &laplacian, solver] {
                    return solver == Solver::local_global   ? make_local_global(laplacian)
                           : solver == Solver::anderson     ? make_anderson(laplacian)
                           : solver == Solver::quasi_newton ? make_quasi_newton(laplacian)
                                                            : make_newton(system, laplacian);
                }};
    };
    if (asked != Solver::automatic) return SolverChain({link(asked)});
    const bool by_elements = !system.model().description().growths.empty();
    if (by_elements || system.model().elements().has_energy())
        return SolverChain({link(Solver::newton), link(Solver::quasi_newton)});
    // The Laplacian that the others start from knows neither plates nor masses.
    if (in_time || !system.plates().empty())
        return SolverChain({link(Solver::newton), link(Solver::quasi_newton), link(Solver::anderson)});
    return SolverChain({link(Solver::quasi_newton), link(Solver::anderson), link(Solver::newton)});
}

}  // namespace pliant::sim
