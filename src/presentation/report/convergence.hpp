// Convergence of solvers: one program run by several of them, compared, and the iterations of one run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::report {

struct SolverRun {
    sim::Solver asked = sim::Solver::automatic;
    sim::Trajectory result;
};

/// One solver compared with the reference: Newton, or the first one if Newton did not take part.
struct SolverRow {
    std::string solver;
    bool converged = false;  ///< the program ran to its end
    int steps = 0;           ///< that converged
    int iterations = 0;      ///< of all steps and attempts, including failed ones
    double solve_s = 0;
    double residual = 0;       ///< this and the next two: at the last step that converged
    double energy_J = 0;       ///< as Step::energy_J
    double difference_mm = 0;  ///< largest distance of a marker (of a node, without markers) from the reference at that
                               ///< step; NaN if the reference has none
    std::string message;       ///< why it stopped early
};
[[nodiscard]] std::vector<SolverRow> compare(std::span<const SolverRun> runs);

/// A table for a terminal.
[[nodiscard]] std::string comparison_text(std::span<const SolverRow> rows);
/// One object per solver, with the names of SolverRow.
[[nodiscard]] std::string comparison_json(std::span<const SolverRow> rows);
/// The same as a table; header line first.
[[nodiscard]] std::string comparison_csv(std::span<const SolverRow> rows);

/// Every iteration of every run: like iterations.csv with a leading column `run`, the requested solver.
[[nodiscard]] std::string convergence_csv(std::span<const SolverRun> runs);

/// Residual over iterations of the first step, which all solvers start from the same state. Both axes are logarithmic.
/// PNG as from plot_png.
[[nodiscard]] Result<std::string> convergence_png(std::span<const SolverRun> runs);

/// For report.html: {"solvers": [names], "rows": [[number, index of solver, residual], ...]}, at most about 4,000 rows;
/// if there are more, an even selection and the last of every attempt.
[[nodiscard]] std::string iterations_json(const sim::Trajectory& result);

}  // namespace pliant::report
