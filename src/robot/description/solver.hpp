// The names of the solvers. docs/theory.md, "The step solver", compares them.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace pliant::robot {

enum class Solver { automatic, newton, quasi_newton, anderson, local_global };

/// From the thesis' iteration to the one that converges fastest, then the automatic choice.
inline constexpr std::array<Solver, 5> all_solvers = {Solver::local_global, Solver::anderson, Solver::quasi_newton,
                                                      Solver::newton, Solver::automatic};

/// The name in robot files and results.
[[nodiscard]] constexpr std::string_view name(Solver solver) {
    switch (solver) {
        case Solver::newton:
            return "newton";
        case Solver::quasi_newton:
            return "quasi-newton";
        case Solver::anderson:
            return "anderson";
        case Solver::local_global:
            return "local-global";
        case Solver::automatic:
            break;
    }
    return "auto";
}

[[nodiscard]] constexpr std::optional<Solver> solver_named(std::string_view text) {
    for (const Solver solver : all_solvers) {
        if (name(solver) == text) return solver;
    }
    return std::nullopt;
}

}  // namespace pliant::robot
